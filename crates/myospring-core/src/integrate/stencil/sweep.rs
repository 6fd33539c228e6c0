//! One row of the lattice: forces, kick and drift in a single pass.
//!
//! A lattice square is identified by its lower left corner a; b is to its right, d above, c across:
//!
//! ```text
//! d --- c        east a-b, north a-d, rising diagonal a-c, falling diagonal b-d
//! |  X  |
//! a --- b
//! ```
//!
//! Each square's four springs are evaluated once. Their forces and those of the area law on c and d
//! are carried to the next row's pass; forces of a square sum to zero, so a takes minus the sum of
//! the others. A row's masses move as soon as their force is complete: squares to the right and
//! above still see the old positions.

use super::lanes::{Lanes, prefetch};
use super::plan::{
    AREA, BLOCK, Class, DAMPING, FIBRE, INVERSE_MASS, Plan, RECORD, STIFFNESS, laws,
};
use std::ops::Range;

/// Purpose of a pass over a row.
pub(super) mod purpose {
    /// Kicks and drifts the row's masses.
    pub(in super::super) const MOVE: u8 = 0;
    /// Writes the velocities at the full step, without moving the masses.
    pub(in super::super) const LOOK: u8 = 1;
}

/// Forces on the corner b and by the corner c of a square, x and y each: see [`Row::left`].
pub(super) type Handover = [f64; 4];

/// A pass over some blocks of a row; all rows have the layout of [`Plan`].
pub(super) struct Row<'a> {
    /// Number of the row.
    pub(super) index: usize,
    /// Blocks to visit.
    pub(super) blocks: Range<usize>,
    /// State of the row: x, y, and velocities at the half step.
    pub(super) lower: *mut f64,
    /// State of the row above.
    pub(super) upper: *const f64,
    /// Carried forces, x and y: on entry those from the squares below, on return those on the next
    /// row.
    pub(super) carry: *mut f64,
    /// Those of the square to the left of the first block.
    pub(super) left: Handover,
    /// The same of the last square visited, on return.
    pub(super) right: &'a mut Handover,
    /// Where `LOOK` writes: x, y.
    pub(super) out: *mut f64,
    /// Whether to prefetch the next row's data.
    pub(super) fetch: bool,
}

/// x and y.
#[derive(Clone, Copy)]
struct Pair<V> {
    x: V,
    y: V,
}

/// Coefficients of eight squares.
trait Terms<L: Lanes> {
    /// `k + Ta w` of a spring direction, nN/um.
    unsafe fn stiffness(&self, direction: usize) -> L::V;
    /// `-k r`, nN.
    unsafe fn minus_rest_load(&self, direction: usize) -> L::V;
    /// Dashpot coefficient, nN ms/um.
    unsafe fn damping(&self, direction: usize) -> L::V;
    /// `-kappa/4` of the area law, nN/um^3.
    unsafe fn area(&self) -> L::V;
    /// `dt / (m (1 + g))`, ms/ug.
    unsafe fn inverse_mass(&self) -> L::V;
}

/// The same everywhere.
struct Uniform<L: Lanes> {
    stiffness: [L::V; 4],
    load: [L::V; 4],
    damping: [L::V; 4],
    area: L::V,
    inverse_mass: L::V,
}

impl<L: Lanes> Uniform<L> {
    /// The coefficients of a square inside a uniform cell under a tension.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
    unsafe fn of<const LAWS: u8>(plan: &Plan, tension: f64) -> Self {
        let common = &plan.uniform;
        // SAFETY: the caller has the features of L.
        unsafe {
            let stiffness = |direction: usize| {
                let fibre =
                    if LAWS & laws::FIBRE == 0 { 0.0 } else { tension * common.fibre[direction] };
                L::splat(common.stiffness[direction] + fibre)
            };
            let load = |direction: usize| {
                L::splat(-common.stiffness[direction] * plan.rest_length[direction / 2])
            };
            Self {
                stiffness: [stiffness(0), stiffness(1), stiffness(2), stiffness(3)],
                load: [load(0), load(1), load(2), load(3)],
                damping: common.damping.map(|value| L::splat(value)),
                area: L::splat(common.area),
                inverse_mass: L::splat(common.inverse_mass),
            }
        }
    }
}

#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl<L: Lanes> Terms<L> for Uniform<L> {
    #[inline(always)]
    unsafe fn stiffness(&self, direction: usize) -> L::V {
        self.stiffness[direction]
    }
    #[inline(always)]
    unsafe fn minus_rest_load(&self, direction: usize) -> L::V {
        self.load[direction]
    }
    #[inline(always)]
    unsafe fn damping(&self, direction: usize) -> L::V {
        self.damping[direction]
    }
    #[inline(always)]
    unsafe fn area(&self) -> L::V {
        self.area
    }
    #[inline(always)]
    unsafe fn inverse_mass(&self) -> L::V {
        self.inverse_mass
    }
}

/// One value per square, read from a record of the plan.
struct Field<L: Lanes, const LAWS: u8> {
    record: *const f64,
    tension: L::V,
    minus_rest_length: [L::V; 2],
}

#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl<L: Lanes, const LAWS: u8> Terms<L> for Field<L, LAWS> {
    #[inline(always)]
    unsafe fn stiffness(&self, direction: usize) -> L::V {
        // SAFETY: a record has RECORD blocks; the caller has the features of L.
        unsafe {
            let passive = L::load(self.record.add((STIFFNESS + direction) * BLOCK));
            if LAWS & laws::FIBRE == 0 {
                return passive;
            }
            L::mul_add(self.tension, L::load(self.record.add((FIBRE + direction) * BLOCK)), passive)
        }
    }
    #[inline(always)]
    unsafe fn minus_rest_load(&self, direction: usize) -> L::V {
        // SAFETY: as above.
        unsafe {
            let passive = L::load(self.record.add((STIFFNESS + direction) * BLOCK));
            L::mul(passive, self.minus_rest_length[direction / 2])
        }
    }
    #[inline(always)]
    unsafe fn damping(&self, direction: usize) -> L::V {
        // SAFETY: as above.
        unsafe { L::load(self.record.add((DAMPING + direction) * BLOCK)) }
    }
    #[inline(always)]
    unsafe fn area(&self) -> L::V {
        // SAFETY: as above.
        unsafe { L::load(self.record.add(AREA * BLOCK)) }
    }
    #[inline(always)]
    unsafe fn inverse_mass(&self) -> L::V {
        // SAFETY: as above.
        unsafe { L::load(self.record.add(INVERSE_MASS * BLOCK)) }
    }
}

/// Forces on the corner b of squares and by the corners c and d, from which that on a follows; and
/// the state of a.
struct Corners<V> {
    on_b: Pair<V>,
    by_c: Pair<V>,
    by_d: Pair<V>,
    a: Pair<V>,
    va: Pair<V>,
}

/// A step in time, with `g = gamma dt/2`.
struct Step<L: Lanes> {
    /// `1/2`
    half: L::V,
    /// `1/(1 + g)`
    slowing: L::V,
    /// `(1 - g)/(1 + g)`
    keep: L::V,
    /// `dt`
    time: L::V,
}

#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl<L: Lanes> Step<L> {
    #[inline(always)]
    unsafe fn of(plan: &Plan) -> Self {
        // SAFETY: the caller has the features of L, here and below.
        unsafe {
            let (half, slowing) = (L::splat(0.5), L::splat(plan.slowing));
            Self { half, slowing, keep: L::splat(plan.keep), time: L::splat(plan.time_step) }
        }
    }

    /// Positions `x_{n+1} = x_n + dt v_{n+1/2}` and velocities
    /// `v_{n+1/2} = [(1 - g) v_{n-1/2} + dt f_n/m] / (1 + g)`: `coelho_2021`, Eq. (16).
    #[inline(always)]
    unsafe fn made(
        &self,
        inverse_mass: L::V,
        force: Pair<L::V>,
        a: Pair<L::V>,
        va: Pair<L::V>,
    ) -> (Pair<L::V>, Pair<L::V>) {
        // SAFETY: see above.
        unsafe {
            let v = Pair {
                x: L::mul_add(inverse_mass, force.x, L::mul(self.keep, va.x)),
                y: L::mul_add(inverse_mass, force.y, L::mul(self.keep, va.y)),
            };
            let moved =
                Pair { x: L::mul_add(self.time, v.x, a.x), y: L::mul_add(self.time, v.y, a.y) };
            (moved, v)
        }
    }

    /// Velocities at the full step, `v_n = (v_{n-1/2} + dt/2 f_n/m) / (1 + g)`.
    #[inline(always)]
    unsafe fn halfway(&self, inverse_mass: L::V, force: Pair<L::V>, va: Pair<L::V>) -> Pair<L::V> {
        // SAFETY: see above.
        unsafe {
            let kick = L::mul(self.half, inverse_mass);
            Pair {
                x: L::mul_add(kick, force.x, L::mul(self.slowing, va.x)),
                y: L::mul_add(kick, force.y, L::mul(self.slowing, va.y)),
            }
        }
    }
}

/// `s` such that the force on the spring's first end is `s l`, with `l` and the relative velocity
/// `w` from the first end to the second:
/// `s = k (1 - r/|l|) + c (w.l)/|l|^2 + Ta w_fibre`, `coelho_2021`, Eqs (7) and (8).
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn pull<L: Lanes, T: Terms<L>>(
    terms: &T,
    direction: usize,
    l: Pair<L::V>,
    w: Pair<L::V>,
) -> L::V {
    // SAFETY: the caller has the features of L.
    unsafe {
        let square = L::mul_add(l.y, l.y, L::mul(l.x, l.x));
        let approach = L::mul_add(l.y, w.y, L::mul(l.x, w.x));
        let inverse = L::inverse_sqrt(square);
        // s = (k + Ta w) + (c w.l/|l| - k r)/|l|
        let damping = L::mul(terms.damping(direction), approach);
        let slope = L::mul_add(damping, inverse, terms.minus_rest_load(direction));
        L::mul_add(slope, inverse, terms.stiffness(direction))
    }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn difference<L: Lanes>(to: Pair<L::V>, from: Pair<L::V>) -> Pair<L::V> {
    // SAFETY: the caller has the features of L.
    unsafe { Pair { x: L::sub(to.x, from.x), y: L::sub(to.y, from.y) } }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn cross<L: Lanes>(a: Pair<L::V>, b: Pair<L::V>) -> L::V {
    // SAFETY: the caller has the features of L.
    unsafe { L::mul_sub_from(a.y, b.x, L::mul(a.x, b.y)) }
}

/// Forces of `N` squares from `lower` and `upper` on.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn squares<L: Lanes, T: Terms<L>, const LAWS: u8>(
    terms: &T,
    lower: *const f64,
    upper: *const f64,
    stride: usize,
    rest: L::V,
) -> Corners<L::V> {
    // SAFETY: rows are `4 stride` long and have a block of padding on the right; the caller has
    // the features of L.
    unsafe {
        let position = |row: *const f64| Pair { x: L::load(row), y: L::load(row.add(stride)) };
        let velocity = |row: *const f64| Pair {
            x: L::load(row.add(2 * stride)),
            y: L::load(row.add(3 * stride)),
        };
        let (a, va) = (position(lower), velocity(lower));
        let (b, vb) = (position(lower.add(1)), velocity(lower.add(1)));
        let (c, vc) = (position(upper.add(1)), velocity(upper.add(1)));
        let (d, vd) = (position(upper), velocity(upper));

        let (east, north) = (difference::<L>(b, a), difference::<L>(d, a));
        let (rising, falling) = (difference::<L>(c, a), difference::<L>(d, b));
        let to_b = pull::<L, T>(terms, 0, east, difference::<L>(vb, va));
        let to_d = pull::<L, T>(terms, 1, north, difference::<L>(vd, va));
        let to_c = pull::<L, T>(terms, 2, rising, difference::<L>(vc, va));
        let across = pull::<L, T>(terms, 3, falling, difference::<L>(vd, vb));

        let minus = |s: L::V, l: L::V, f: L::V| L::mul_sub_from(s, l, f);
        let cross_pull = Pair { x: L::mul(across, falling.x), y: L::mul(across, falling.y) };
        let mut on_b =
            Pair { x: minus(to_b, east.x, cross_pull.x), y: minus(to_b, east.y, cross_pull.y) };
        let mut by_c = Pair { x: L::mul(to_c, rising.x), y: L::mul(to_c, rising.y) };
        let mut by_d = Pair {
            x: L::mul_add(to_d, north.x, cross_pull.x),
            y: L::mul_add(to_d, north.y, cross_pull.y),
        };
        if LAWS & laws::AREA != 0 {
            // Energy w (k/2)(A - A0)^2/A0 on the triangles abc, acd, abd, bcd, each with w = 1/2.
            // Twice their areas:
            let abc = cross::<L>(east, rising);
            let abd = cross::<L>(east, north);
            let both = cross::<L>(rising, falling);
            let (acd, bcd) = (L::sub(both, abc), L::sub(both, abd));
            // With q = -(kappa/4)(2A - 2A0) per triangle, the pairs of corners interact by
            // q_abc + q_bcd (b, c), q_abd - q_bcd (b, d), q_acd + q_bcd (c, d).
            let g = terms.area();
            let spare = L::sub(bcd, rest);
            let bc = L::mul(g, L::add(abc, spare));
            let bd = L::mul(g, L::sub(abd, bcd));
            let cd = L::mul(g, L::add(acd, spare));
            // f_b = bc R(c - a) + bd R(d - a) and so on, with R(e) = (e_y, -e_x)
            on_b.x = L::mul_add(bc, rising.y, L::mul_add(bd, north.y, on_b.x));
            on_b.y = minus(bc, rising.x, minus(bd, north.x, on_b.y));
            by_c.x = L::mul_add(bc, east.y, minus(cd, north.y, by_c.x));
            by_c.y = minus(bc, east.x, L::mul_add(cd, north.x, by_c.y));
            by_d.x = L::mul_add(bd, east.y, L::mul_add(cd, rising.y, by_d.x));
            by_d.y = minus(bd, east.x, minus(cd, rising.x, by_d.y));
        }
        Corners { on_b, by_c, by_d, a, va }
    }
}

/// A pass over one row.
///
/// # Safety
/// The pointers of `row` must be good for the layout of `plan`, `lower`, `carry` and `out` not shared with another thread, and the processor must have the features of
/// `L`.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) unsafe fn pass<L: Lanes, const LAWS: u8, const PURPOSE: u8>(
    plan: &Plan,
    tension: f64,
    row: Row<'_>,
) {
    // SAFETY: see above; every offset below stays within the row or record that it belongs to.
    unsafe {
        let stride = plan.stride;
        let uniform = Uniform::<L>::of::<LAWS>(plan, tension);
        let step = Step::<L>::of(plan);
        let minus_rest_length = plan.rest_length.map(|value| L::splat(-value));
        let rest = L::splat(plan.rest_area);
        let zero = L::splat(0.0);
        let pair = |from: *const f64| Pair { x: L::load(from), y: L::load(from.add(stride)) };
        let store = |to: *mut f64, value: Pair<L::V>| {
            L::store(to, value.x);
            L::store(to.add(stride), value.y);
        };

        let [bx, by, cx, cy] = row.left.map(|value| L::splat(value));
        let mut before = (Pair { x: bx, y: by }, Pair { x: cx, y: cy });
        for block in row.blocks {
            let class = plan.classes[row.index * plan.blocks + block];
            if row.fetch {
                fetch_above(plan, row.index, block, row.upper.add(plan.row_len()));
            }
            for part in 0..BLOCK / L::N {
                let at = block * BLOCK + part * L::N;
                let (lower, upper, carry) =
                    (row.lower.add(at), row.upper.add(at), row.carry.add(at));
                let (corners, inverse_mass) = match class {
                    Class::EMPTY => {
                        let by_c = before.1;
                        store(carry, Pair { x: L::shift(zero, by_c.x), y: L::shift(zero, by_c.y) });
                        before = (Pair { x: zero, y: zero }, Pair { x: zero, y: zero });
                        continue;
                    }
                    Class::UNIFORM => (
                        squares::<L, _, LAWS>(&uniform, lower, upper, stride, rest),
                        uniform.inverse_mass,
                    ),
                    class => {
                        let field = Field::<L, LAWS> {
                            record: plan.record(class).add(part * L::N),
                            tension: L::splat(tension),
                            minus_rest_length,
                        };
                        let inverse_mass = Terms::<L>::inverse_mass(&field);
                        (squares::<L, _, LAWS>(&field, lower, upper, stride, rest), inverse_mass)
                    }
                };
                let Corners { on_b, by_c, by_d, a, va } = corners;
                let from_left =
                    Pair { x: L::shift(on_b.x, before.0.x), y: L::shift(on_b.y, before.0.y) };
                let across =
                    Pair { x: L::shift(by_c.x, before.1.x), y: L::shift(by_c.y, before.1.y) };
                before = (on_b, by_c);
                // Force from the squares above, then from those below, which carry its opposite.
                let below = pair(carry);
                let mut force = Pair {
                    x: L::sub(L::add(L::sub(from_left.x, on_b.x), L::add(by_c.x, by_d.x)), below.x),
                    y: L::sub(L::add(L::sub(from_left.y, on_b.y), L::add(by_c.y, by_d.y)), below.y),
                };
                if LAWS & laws::ANCHORS != 0 {
                    let anchor =
                        plan.anchors.as_ptr().cast::<f64>().add(row.index * 3 * stride + at);
                    let (k, rest) = (L::load(anchor), pair(anchor.add(stride)));
                    force.x = L::mul_sub_from(k, L::sub(a.x, rest.x), force.x);
                    force.y = L::mul_sub_from(k, L::sub(a.y, rest.y), force.y);
                }
                if PURPOSE == purpose::MOVE {
                    let (moved, v) = step.made(inverse_mass, force, a, va);
                    store(lower.add(2 * stride), v);
                    store(lower, moved);
                }
                if PURPOSE == purpose::LOOK {
                    store(row.out.add(at), step.halfway(inverse_mass, force, va));
                }
                store(carry, Pair { x: L::add(by_d.x, across.x), y: L::add(by_d.y, across.y) });
            }
        }
        let (b, c) = before;
        *row.right = [last::<L>(b.x), last::<L>(b.y), last::<L>(c.x), last::<L>(c.y)];
    }
}

/// Prefetches what the next row's pass reads at a block: coefficients, and the state of the row
/// above it.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
fn fetch_above(plan: &Plan, row: usize, block: usize, state: *const f64) {
    for component in 0..4 {
        prefetch(state.wrapping_add(component * plan.stride + block * BLOCK));
    }
    if let Some(&class) = plan.classes.get((row + 1) * plan.blocks + block)
        && class.0 > Class::UNIFORM.0
    {
        let record = plan.record(class);
        for term in 0..RECORD {
            prefetch(record.wrapping_add(term * BLOCK));
        }
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
