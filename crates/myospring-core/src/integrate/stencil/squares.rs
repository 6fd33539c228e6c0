//! A pass over one row of a flat lattice, see [`super::sweep`].
//!
//! A lattice square is identified by its lower left corner a; b is to its right, d above, c across:
//!
//! ```text
//! d --- c        east a-b, north a-d, rising diagonal a-c, falling diagonal b-d
//! |  X  |
//! a --- b
//! ```

use super::lanes::Lanes;
use super::plan::{BLOCK, Class, Plan};
use super::sweep::{
    Field, Row, Step, Terms, Uniform, difference, fetch_next, held_back, load, pull, purpose, store,
};

/// Forces on the corner b of squares and by the corners c and d, from which that on a follows; and
/// the state of a.
struct Corners<V> {
    on_b: [V; 2],
    by_c: [V; 2],
    by_d: [V; 2],
    a: [V; 2],
    va: [V; 2],
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn cross<L: Lanes>(a: [L::V; 2], b: [L::V; 2]) -> L::V {
    // SAFETY: the caller has the features of L.
    unsafe { L::mul_sub_from(a[1], b[0], L::mul(a[0], b[1])) }
}

/// Forces of `N` squares from `lower` and `upper` on.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn squares<L: Lanes, T: Terms<L>, const LAWS: bool>(
    terms: &T,
    lower: *const f64,
    upper: *const f64,
    stride: usize,
    rest: L::V,
) -> Corners<L::V> {
    // SAFETY: rows are `4 stride` long and have a block of padding on the right; the caller has
    // the features of L.
    unsafe {
        let position = |row: *const f64| load::<L, 2>(row, stride);
        let velocity = |row: *const f64| load::<L, 2>(row.add(2 * stride), stride);
        let (a, va) = (position(lower), velocity(lower));
        let (b, vb) = (position(lower.add(1)), velocity(lower.add(1)));
        let (c, vc) = (position(upper.add(1)), velocity(upper.add(1)));
        let (d, vd) = (position(upper), velocity(upper));

        let (east, north) = (difference::<L, 2>(b, a), difference::<L, 2>(d, a));
        let (rising, falling) = (difference::<L, 2>(c, a), difference::<L, 2>(d, b));
        let to_b = pull::<L, T, 2>(terms, 0, east, difference::<L, 2>(vb, va));
        let to_d = pull::<L, T, 2>(terms, 1, north, difference::<L, 2>(vd, va));
        let to_c = pull::<L, T, 2>(terms, 2, rising, difference::<L, 2>(vc, va));
        let across = pull::<L, T, 2>(terms, 3, falling, difference::<L, 2>(vd, vb));

        let minus = |s: L::V, l: L::V, f: L::V| L::mul_sub_from(s, l, f);
        let cross_pull = [L::mul(across, falling[0]), L::mul(across, falling[1])];
        let mut on_b = [minus(to_b, east[0], cross_pull[0]), minus(to_b, east[1], cross_pull[1])];
        let mut by_c = [L::mul(to_c, rising[0]), L::mul(to_c, rising[1])];
        let mut by_d =
            [L::mul_add(to_d, north[0], cross_pull[0]), L::mul_add(to_d, north[1], cross_pull[1])];
        if LAWS {
            // Energy w (k/2)(A - A0)^2/A0 on the triangles abc, acd, abd, bcd, each with w = 1/2.
            // Twice their areas:
            let abc = cross::<L>(east, rising);
            let abd = cross::<L>(east, north);
            let both = cross::<L>(rising, falling);
            let (acd, bcd) = (L::sub(both, abc), L::sub(both, abd));
            // With q = -(kappa/4)(2A - 2A0) per triangle, the pairs of corners interact by
            // q_abc + q_bcd (b, c), q_abd - q_bcd (b, d), q_acd + q_bcd (c, d).
            let g = terms.measure();
            let spare = L::sub(bcd, rest);
            let bc = L::mul(g, L::add(abc, spare));
            let bd = L::mul(g, L::sub(abd, bcd));
            let cd = L::mul(g, L::add(acd, spare));
            // f_b = bc R(c - a) + bd R(d - a) and so on, with R(e) = (e_y, -e_x)
            on_b[0] = L::mul_add(bc, rising[1], L::mul_add(bd, north[1], on_b[0]));
            on_b[1] = minus(bc, rising[0], minus(bd, north[0], on_b[1]));
            by_c[0] = L::mul_add(bc, east[1], minus(cd, north[1], by_c[0]));
            by_c[1] = minus(bc, east[0], L::mul_add(cd, north[0], by_c[1]));
            by_d[0] = L::mul_add(bd, east[1], L::mul_add(cd, rising[1], by_d[0]));
            by_d[1] = minus(bd, east[0], minus(cd, rising[0], by_d[1]));
        }
        Corners { on_b, by_c, by_d, a, va }
    }
}

/// A pass over one row.
///
/// # Safety
/// The pointers of `row` must be good for the layout of `plan`, with `lag` rows above `lower`. No other thread may use `lower`,
/// `carry` and `out` or write these rows meanwhile. The processor must have the features of `L`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) unsafe fn pass<L: Lanes, const LAWS: bool, const PURPOSE: u8>(
    plan: &Plan,
    tension: f64,
    row: Row<'_>,
) {
    // SAFETY: see above; every offset below stays within the row or record that it belongs to.
    unsafe {
        let stride = plan.stride;
        let uniform = Uniform::<L>::of::<2, LAWS>(plan, tension);
        let step = Step::<L>::of(plan);
        let minus_rest_length = plan.rest_length.map(|value| L::splat(-value));
        let rest = L::splat(plan.rest_measure);
        let zero = L::splat(0.0);
        let anchored = !plan.anchors.is_empty();

        let above = row.lower.cast_const().add(plan.row_len);
        let [bx, by, cx, cy] = row.left.map(|value| L::splat(value));
        let mut before = ([bx, by], [cx, cy]);
        let classes = &plan.classes[row.index * plan.blocks..][row.blocks.clone()];
        for (block, &class) in row.blocks.zip(classes) {
            if row.fetch {
                fetch_next(plan, row.index, block, row.lower);
            }
            for part in 0..BLOCK / L::N {
                let at = block * BLOCK + part * L::N;
                let (lower, upper, carry) = (row.lower.add(at), above.add(at), row.carry.add(at));
                let (corners, inverse_mass) = match class {
                    Class::EMPTY => {
                        let by_c = before.1;
                        store::<L, 2>(
                            carry,
                            stride,
                            [L::shift(zero, by_c[0]), L::shift(zero, by_c[1])],
                        );
                        before = ([zero, zero], [zero, zero]);
                        continue;
                    }
                    Class::UNIFORM => (
                        squares::<L, _, LAWS>(&uniform, lower, upper, stride, rest),
                        Terms::<L>::inverse_mass(&uniform),
                    ),
                    class => {
                        let field = Field::<L, 2, LAWS> {
                            record: plan.record(class).add(part * L::N),
                            tension: L::splat(tension),
                            minus_rest_length,
                        };
                        let inverse_mass = Terms::<L>::inverse_mass(&field);
                        (squares::<L, _, LAWS>(&field, lower, upper, stride, rest), inverse_mass)
                    }
                };
                let Corners { on_b, by_c, by_d, a, va } = corners;
                let from_left = [L::shift(on_b[0], before.0[0]), L::shift(on_b[1], before.0[1])];
                let across = [L::shift(by_c[0], before.1[0]), L::shift(by_c[1], before.1[1])];
                before = (on_b, by_c);
                // Force from the squares above, then from those below, which carry its opposite.
                let below = load::<L, 2>(carry, stride);
                let mut force = [
                    L::sub(
                        L::add(L::sub(from_left[0], on_b[0]), L::add(by_c[0], by_d[0])),
                        below[0],
                    ),
                    L::sub(
                        L::add(L::sub(from_left[1], on_b[1]), L::add(by_c[1], by_d[1])),
                        below[1],
                    ),
                ];
                if LAWS && anchored {
                    force = held_back::<L, 2>(plan, (row.index, at), a, force);
                }
                if PURPOSE == purpose::LOOK {
                    store::<L, 2>(row.out.add(at), stride, step.halfway(inverse_mass, force, va));
                } else {
                    let (moved, v) = step.made(inverse_mass, force, a, va);
                    store::<L, 2>(lower.add(2 * stride), stride, v);
                    store::<L, 2>(lower, stride, moved);
                }
                store::<L, 2>(
                    carry,
                    stride,
                    [L::add(by_d[0], across[0]), L::add(by_d[1], across[1])],
                );
            }
        }
        let (b, c) = before;
        *row.right = [last::<L>(b[0]), last::<L>(b[1]), last::<L>(c[0]), last::<L>(c[1])];
    }
}

/// The last lane.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn last<L: Lanes>(value: L::V) -> f64 {
    let mut lanes = [0.0; BLOCK];
    // SAFETY: no kind has more lanes than a block; the caller has the features of L.
    unsafe { L::store(lanes.as_mut_ptr(), value) };
    lanes[L::N - 1]
}
