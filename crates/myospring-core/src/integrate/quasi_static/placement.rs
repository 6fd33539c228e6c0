//! The place of a body that nothing holds.
//!
//! A free body has no stiffness against shift and rotation. Three coordinates of two nodes far
//! apart (with three axes six of three nodes) are held instead: internal forces have no resultant,
//! so the holds carry no force and the shape is that of the free body. The body is then moved to
//! where a free body would be: its mass centre at the initial position, and no rotation relative to
//! the start by least squares weighted by mass (the rotation that `analysis::shape::ShapeMeter`
//! removes). A body that outer forces hold, such as an elastic bed, needs none of this.

use crate::mechanics::support::Support;
use crate::mechanics::{Body, System, Vectors};
use std::array::from_fn;

/// Largest number of rounds of removing the rotation with three axes; a few are enough.
const TURNS: usize = 50;

/// The coordinates that a solver moves: `free[axis][node]`.
pub(super) fn free<const D: usize>(system: &System<D>, body: &Body<D>) -> [Vec<bool>; D] {
    let mut free: [Vec<bool>; D] = from_fn(|_| vec![true; body.len()]);
    match &system.support {
        Support::Clamped(nodes) => {
            for axis in &mut free {
                for &node in nodes {
                    axis[node] = false;
                }
            }
        }
        Support::MassCentre | Support::Free if adrift(system) => {
            hold_place(&body.positions, &mut free);
        }
        Support::MassCentre | Support::Free => {}
    }
    free
}

/// Removes translation and rotation relative to the start from positions and from their slope.
///
/// With three axes, rotation is removed plane by plane until none remains: each turn brings the
/// body as near to the start as a rotation in that plane can.
pub(super) fn in_place<const D: usize>(
    body: &Body<D>,
    mut positions: Vectors<D>,
    mut slope: Vectors<D>,
) -> (Vectors<D>, Vectors<D>) {
    let masses = &body.masses;
    let total: f64 = masses.iter().sum();
    let mean = |values: &Vectors<D>| -> [f64; D] {
        from_fn(|axis| values[axis].iter().zip(masses).map(|(x, m)| x * m).sum::<f64>() / total)
    };
    let start = &body.positions;
    let (before, after, drift) = (mean(start), mean(&positions), mean(&slope));
    // An unmoved body is not changed.
    let same = positions == *start;
    for axis in 0..D {
        for node in 0..masses.len() {
            slope[axis][node] -= drift[axis];
            if !same && D > 2 {
                positions[axis][node] += before[axis] - after[axis];
            }
        }
    }
    if D == 2 {
        turn_back(body, [0, 1], [before, after], same, [&mut positions, &mut slope]);
        return (positions, slope);
    }
    for _ in 0..TURNS {
        let mut largest = 0.0_f64;
        for plane in [[0, 1], [1, 2], [2, 0]] {
            let centres = [before, before];
            let turned = turn_back(body, plane, centres, same, [&mut positions, &mut slope]);
            largest = largest.max(turned);
        }
        if largest < 1e-15 {
            break;
        }
    }
    (positions, slope)
}

/// Removes the rotation in a plane from positions and from their slope, and moves the mass
/// centre from the second of two centres to the first. Returns the removed angle and its
/// derivative, relative to that of the slope.
fn turn_back<const D: usize>(
    body: &Body<D>,
    [p, q]: [usize; 2],
    [before, after]: [[f64; D]; 2],
    same: bool,
    [positions, slope]: [&mut Vectors<D>; 2],
) -> f64 {
    let (masses, start) = (&body.masses, &body.positions);
    let old = |i: usize| [start[p][i] - before[p], start[q][i] - before[q]];
    let (mut cosine, mut sine, mut turn, mut size) = (0.0, 0.0, 0.0, 0.0);
    for (i, mass) in masses.iter().enumerate() {
        let old = old(i);
        let new = [positions[p][i] - after[p], positions[q][i] - after[q]];
        cosine += mass * (old[0] * new[0] + old[1] * new[1]);
        sine += mass * (old[0] * new[1] - old[1] * new[0]);
    }
    let angle = sine.atan2(cosine);
    let (s, c) = (-angle).sin_cos();
    for i in 0..masses.len() {
        let new = [positions[p][i] - after[p], positions[q][i] - after[q]];
        let rate = [slope[p][i], slope[q][i]];
        if !same {
            positions[p][i] = before[p] + c * new[0] - s * new[1];
            positions[q][i] = before[q] + s * new[0] + c * new[1];
        }
        slope[p][i] = c * rate[0] - s * rate[1];
        slope[q][i] = s * rate[0] + c * rate[1];
        let old = old(i);
        turn += masses[i] * (old[0] * slope[q][i] - old[1] * slope[p][i]);
        size += masses[i] * (old[0] * slope[q][i]).abs().max((old[1] * slope[p][i]).abs());
    }
    // sum m (old x d new/dTa) = 0: a rotation at the rate w adds w sum m old . new to it
    let rate = -turn / cosine.hypot(sine);
    for i in 0..masses.len() {
        slope[p][i] -= rate * (positions[q][i] - before[q]);
        slope[q][i] += rate * (positions[p][i] - before[p]);
    }
    let relative = if size > 0.0 { turn.abs() / size } else { 0.0 };
    angle.abs().max(1e-3 * relative)
}

/// Whether the body is free: no force holds it as a whole.
pub(super) fn adrift<const D: usize>(system: &System<D>) -> bool {
    system.passive.iter().all(|force| force.is_internal())
}

/// Holds one node, another far from it across the line between them, and with three axes a third one off
/// that line across the plane of the three.
fn hold_place<const D: usize>(positions: &Vectors<D>, free: &mut [Vec<bool>; D]) {
    let count = positions[0].len();
    let arm = |from: usize, to: usize| -> [f64; D] {
        from_fn(|axis| positions[axis][to] - positions[axis][from])
    };
    let farthest = |from: usize, square: &dyn Fn(usize) -> f64| {
        (0..count).max_by(|&a, &b| square(a).total_cmp(&square(b))).unwrap_or(from)
    };
    let square =
        |from: usize, to: usize| arm(from, to).iter().map(|part| part.powi(2)).sum::<f64>();
    if count == 0 {
        return;
    }
    let first = farthest(0, &|node| square(0, node));
    let second = farthest(first, &|node| square(first, node));
    for axis in free.iter_mut() {
        axis[first] = false;
    }
    let line = arm(first, second);
    let along = (0..D).max_by(|&a, &b| line[a].abs().total_cmp(&line[b].abs())).unwrap_or(0);
    if D == 2 {
        free[usize::from(line[0].abs() >= line[1].abs())][second] = false;
        return;
    }
    for axis in (0..D).filter(|axis| *axis != along) {
        free[axis][second] = false;
    }
    // Component of the vector to a third node across the line.
    let off = |node: usize| -> [f64; D] {
        let way = arm(first, node);
        let part = way.iter().zip(line).map(|(w, l)| w * l).sum::<f64>() / square(first, second);
        from_fn(|axis| way[axis] - part * line[axis])
    };
    let third = farthest(first, &|node| off(node).iter().map(|part| part.powi(2)).sum());
    // Rotation about the line moves this node across both; the larger component of that motion is
    // held.
    let out = off(third);
    let normal: [f64; D] = from_fn(|axis| {
        let (next, last) = ((axis + 1) % D, (axis + 2) % D);
        line[next] * out[last] - line[last] * out[next]
    });
    let across = (0..D).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
    free[across][third] = false;
}
