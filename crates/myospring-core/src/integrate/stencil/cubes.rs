//! A pass over one row of a lattice in space, see [`super::sweep`].
//!
//! A cube is identified by its least corner. Bits 0, 1, 2 of a corner's number are its offsets along x, y, z, so the
//! corners lie in four rows, two in each:
//!
//! ```text
//! 6 7 in y and z    4 5 in z    2 3 in y    0 1
//! ```

use super::lanes::Lanes;
use super::plan::{BLOCK, Class, Plan};
use super::sweep::{
    Field, Row, Step, Terms, Uniform, difference, fetch_next, held_back, load, pull, purpose, store,
};

/// A vector for each corner of `N` cubes.
type Corners<V> = [[V; 3]; 8];

/// Adds the pull of the spring between two corners to both.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn tie<L: Lanes, T: Terms<L>, const DIRECTION: usize, const A: usize, const B: usize>(
    terms: &T,
    [places, velocities]: [&Corners<L::V>; 2],
    pulls: &mut Corners<L::V>,
) {
    // SAFETY: the caller has the features of L, here and below.
    unsafe {
        let l = difference::<L, 3>(places[B], places[A]);
        let w = difference::<L, 3>(velocities[B], velocities[A]);
        let s = pull::<L, T, 3>(terms, DIRECTION, l, w);
        for axis in 0..3 {
            if A > 0 {
                pulls[A][axis] = L::mul_sub_from(s, l[axis], pulls[A][axis]);
            }
            pulls[B][axis] = L::mul_add(s, l[axis], pulls[B][axis]);
        }
    }
}

/// `sum + a x b`
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn cross<L: Lanes>(a: [L::V; 3], b: [L::V; 3], sum: [L::V; 3]) -> [L::V; 3] {
    // SAFETY: see `tie`.
    unsafe {
        let mut product = sum;
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let first = L::mul_add(a[next], b[last], sum[axis]);
            product[axis] = L::mul_sub_from(a[last], b[next], first);
        }
        product
    }
}

/// Adds the pull of the volume law at each corner.
///
/// Averaged over both divisions into five tetrahedra, a cube has the volume of the trilinear cube: a ruled face through four
/// corners halves what lies between its two divisions into triangles. With the sums over the corners `A_x = sum s_x r`, `H_x = sum s_y s_z r` and so on, `s = -1` or `1` on the lower and upper side,
///
/// ```text
/// 64 V = A_x.(A_y x A_z) + [A_x.(H_z x H_y) + A_y.(H_x x H_z) + A_z.(H_y x H_x)]/3
/// ```
///
/// as follows from the integral of the Jacobian over the cube (the terms of the sum over `s_x s_y s_z` cancel).
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn swell<L: Lanes>(
    coefficient: L::V,
    rest: L::V,
    places: &Corners<L::V>,
    pulls: &mut Corners<L::V>,
) {
    // SAFETY: see `tie`.
    unsafe {
        let (zero, third) = ([L::splat(0.0); 3], L::splat(1.0 / 3.0));
        let [mut ax, mut ay, mut az] = [zero; 3];
        let [mut hx, mut hy, mut hz] = [zero; 3];
        for axis in 0..3 {
            // From the least corner on, so that small cubes far from the origin have exact volumes.
            let r = |corner: usize| L::sub(places[corner][axis], places[0][axis]);
            let d0 = r(1);
            let (r2, r4, r6) = (r(2), r(4), r(6));
            let (r3, r5, r7) = (r(3), r(5), r(7));
            let (s1, s2, s3) = (L::add(r2, r3), L::add(r4, r5), L::add(r6, r7));
            let (d1, d2, d3) = (L::sub(r3, r2), L::sub(r5, r4), L::sub(r7, r6));
            let (low, high) = (L::add(d0, d1), L::add(d2, d3));
            ax[axis] = L::add(low, high);
            hy[axis] = L::sub(high, low);
            hz[axis] = L::add(L::sub(d1, d0), L::sub(d3, d2));
            let (low, high) = (L::sub(s1, d0), L::sub(s3, s2));
            ay[axis] = L::add(low, high);
            hx[axis] = L::sub(high, low);
            az[axis] = L::sub(L::add(s2, s3), L::add(d0, s1));
        }
        let bent = [cross::<L>(hz, hy, zero), cross::<L>(hx, hz, zero), cross::<L>(hy, hx, zero)];
        let straight =
            [cross::<L>(ay, az, zero), cross::<L>(az, ax, zero), cross::<L>(ax, ay, zero)];
        // Derivatives of 64 V with respect to the sums A, and three times those to the sums H.
        let mut by_a = straight;
        let by_h = [
            cross::<L>(hz, ay, cross::<L>(az, hy, zero)),
            cross::<L>(hx, az, cross::<L>(ax, hz, zero)),
            cross::<L>(hy, ax, cross::<L>(ay, hx, zero)),
        ];
        let mut bulge = zero[0];
        for axis in 0..3 {
            for (of, part) in [(0, ax), (1, ay), (2, az)] {
                bulge = L::mul_add(part[axis], bent[of][axis], bulge);
                by_a[of][axis] = L::mul_add(third, bent[of][axis], straight[of][axis]);
            }
        }
        let mut volume = L::sub(L::mul(third, bulge), rest);
        for axis in 0..3 {
            volume = L::mul_add(ax[axis], straight[0][axis], volume);
        }
        // kappa (V - V0)/V0 times the derivatives with respect to the corners.
        let q = L::mul(coefficient, volume);
        let p = L::mul(q, third);
        for axis in 0..3 {
            let [a0, a1, a2] = [by_a[0][axis], by_a[1][axis], by_a[2][axis]];
            let [h0, h1, h2] = [by_h[0][axis], by_h[1][axis], by_h[2][axis]];
            let [px, py, pz] = [L::mul(q, a0), L::mul(q, a1), L::mul(q, a2)];
            let (qy, qz) = (L::mul(p, h1), L::mul(p, h2));
            // By the side in z, the parts along x without and with that of the side in y, and those along y.
            let (above, below) = (L::add(px, qy), L::sub(px, qy));
            let (y_above, y_below) = (L::mul_add(p, h0, py), L::mul_sub_from(p, h0, py));
            let sides = [
                (2, L::add(below, qz), L::sub(y_below, pz)),
                (4, L::sub(above, qz), L::sub(pz, y_above)),
                (6, L::add(above, qz), L::add(pz, y_above)),
            ];
            for (corner, along_x, other) in sides {
                let [low, high] = [L::sub(other, along_x), L::add(other, along_x)];
                pulls[corner][axis] = L::sub(pulls[corner][axis], low);
                pulls[corner + 1][axis] = L::sub(pulls[corner + 1][axis], high);
            }
            let (along_x, other) = (L::sub(below, qz), L::add(y_below, pz));
            pulls[1][axis] = L::sub(pulls[1][axis], L::sub(along_x, other));
        }
    }
}

/// Cubes that were evaluated.
struct Pulled<V> {
    /// Minus the forces on the corners 1 to 7. Their sum is the force on corner 0, whose own entry stays zero.
    pulls: Corners<V>,
    /// Place and velocity of corner 0.
    a: [V; 3],
    va: [V; 3],
}

/// The pulls of `N` cubes from `rows` on.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn cubes<L: Lanes, T: Terms<L>, const LAWS: bool>(
    terms: &T,
    rows: [*const f64; 4],
    stride: usize,
    rest: L::V,
) -> Pulled<L::V> {
    // SAFETY: rows are `6 stride` long and have a block of padding on the right; for the rest see `tie`.
    unsafe {
        let zero = [L::splat(0.0); 3];
        let (mut places, mut velocities, mut pulls) = ([zero; 8], [zero; 8], [zero; 8]);
        for row in 0..4 {
            for along in 0..2 {
                let corner = rows[row].add(along);
                places[2 * row + along] = load::<L, 3>(corner, stride);
                velocities[2 * row + along] = load::<L, 3>(corner.add(3 * stride), stride);
            }
        }
        let at = [&places, &velocities];
        tie::<L, T, 0, 0, 1>(terms, at, &mut pulls);
        tie::<L, T, 1, 0, 2>(terms, at, &mut pulls);
        tie::<L, T, 2, 0, 4>(terms, at, &mut pulls);
        tie::<L, T, 3, 0, 3>(terms, at, &mut pulls);
        tie::<L, T, 4, 1, 2>(terms, at, &mut pulls);
        tie::<L, T, 5, 0, 5>(terms, at, &mut pulls);
        tie::<L, T, 6, 1, 4>(terms, at, &mut pulls);
        tie::<L, T, 7, 0, 6>(terms, at, &mut pulls);
        tie::<L, T, 8, 2, 4>(terms, at, &mut pulls);
        if LAWS {
            swell::<L>(terms.measure(), rest, &places, &mut pulls);
        }
        Pulled { pulls, a: places[0], va: velocities[0] }
    }
}

/// A pass over one row.
///
/// # Safety
/// As for the pass over squares.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) unsafe fn pass<L: Lanes, const LAWS: bool, const PURPOSE: u8>(
    plan: &Plan,
    tension: f64,
    row: Row<'_>,
) {
    // SAFETY: see above; every offset below stays within the row or record that it belongs to.
    unsafe {
        let (stride, lag) = (plan.stride, plan.lag);
        let uniform = Uniform::<L>::of::<3, LAWS>(plan, tension);
        let step = Step::<L>::of(plan);
        let minus_rest_length = plan.rest_length.map(|value| L::splat(-value));
        let rest = L::splat(plan.rest_measure);
        let zero = [L::splat(0.0); 3];
        let above = |rows: usize| row.lower.cast_const().add(rows * plan.row_len);
        let upper = [above(0), above(1), above(lag - 1), above(lag)];
        let carried = |rows: usize| row.carry.add((row.index + rows) % lag * 3 * stride);
        let carried = [carried(0), carried(1), carried(lag - 1)];
        let anchored = !plan.anchors.is_empty();
        let mut before = [zero; 4];
        let classes = &plan.classes[row.index * plan.blocks..][row.blocks.clone()];
        for (block, &class) in row.blocks.zip(classes) {
            if row.fetch {
                fetch_next(plan, row.index, block, row.lower);
            }
            for part in 0..BLOCK / L::N {
                let at = block * BLOCK + part * L::N;
                let rows = [upper[0].add(at), upper[1].add(at), upper[2].add(at), upper[3].add(at)];
                let (Pulled { pulls, a, va }, inverse_mass) = match class {
                    Class::EMPTY => {
                        for pull in &mut before {
                            for axis in 0..3 {
                                pull[axis] = L::shift(zero[0], pull[axis]);
                            }
                        }
                        carry::<L>(carried, (stride, at), before);
                        before = [zero; 4];
                        continue;
                    }
                    Class::UNIFORM => (
                        cubes::<L, _, LAWS>(&uniform, rows, stride, rest),
                        Terms::<L>::inverse_mass(&uniform),
                    ),
                    class => {
                        let field = Field::<L, 3, LAWS> {
                            record: plan.record(class).add(part * L::N),
                            tension: L::splat(tension),
                            minus_rest_length,
                        };
                        let inverse_mass = Terms::<L>::inverse_mass(&field);
                        (cubes::<L, _, LAWS>(&field, rows, stride, rest), inverse_mass)
                    }
                };
                // What each row's masses feel of the cubes to their right and left.
                let mut on = [zero; 4];
                let mut force = load::<L, 3>(carried[0].add(at), stride);
                for axis in 0..3 {
                    let mut sum = pulls[1][axis];
                    for corner in 2..8 {
                        sum = L::add(sum, pulls[corner][axis]);
                    }
                    for row in 0..4 {
                        let right = pulls[2 * row + 1][axis];
                        let left = L::shift(right, before[row][axis]);
                        on[row][axis] =
                            if row == 0 { left } else { L::add(pulls[2 * row][axis], left) };
                        before[row][axis] = right;
                    }
                    force[axis] = L::sub(L::sub(sum, on[0][axis]), force[axis]);
                }
                if LAWS && anchored {
                    force = held_back::<L, 3>(plan, (row.index, at), a, force);
                }
                if PURPOSE == purpose::LOOK {
                    store::<L, 3>(row.out.add(at), stride, step.halfway(inverse_mass, force, va));
                } else {
                    let (moved, v) = step.made(inverse_mass, force, a, va);
                    let lower = row.lower.add(at);
                    store::<L, 3>(lower.add(3 * stride), stride, v);
                    store::<L, 3>(lower, stride, moved);
                }
                carry::<L>(carried, (stride, at), on);
            }
        }
    }
}

/// Carries the pulls on the rows above: those on the furthest take the place of those on this one.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn carry<L: Lanes>(
    [own, next, layer]: [*mut f64; 3],
    (stride, at): (usize, usize),
    [_, on_next, on_layer, on_last]: [[L::V; 3]; 4],
) {
    // SAFETY: the caller's.
    unsafe {
        store::<L, 3>(own.add(at), stride, on_last);
        for (to, on) in [(next, on_next), (layer, on_layer)] {
            let mut sum = load::<L, 3>(to.add(at), stride);
            for axis in 0..3 {
                sum[axis] = L::add(sum[axis], on[axis]);
            }
            store::<L, 3>(to.add(at), stride, sum);
        }
    }
}
