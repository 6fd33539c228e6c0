//! The conformance suite of forces.

use crate::mechanics::stiffness::StiffnessMatrix;
use crate::mechanics::{Configuration, Force, Vectors, zeros};
use std::array::from_fn;

/// Checks everything that a [`Force`] promises, at one configuration.
///
/// - it adds to the forces it is given;
/// - where it has an energy, the force at zero velocity is minus its gradient;
/// - where it has a stiffness, that is minus the derivative of the force at zero velocity;
/// - its velocity-dependent part removes exactly the energy that `dissipation` states, and never
///   adds any;
/// - if it is internal: no resultant force, no torque (Newton's third law), and rotating and shifting
///   the whole body rotates the forces with it and does not change the energy.
///
/// # Panics
/// With a sentence, if the force breaks one of its promises.
///
/// # Example
/// ```
/// use myospring::mechanics::{Configuration, spring::Springs};
/// use myospring::testing::force::check;
/// let springs = Springs::new(vec![[0, 1], [1, 2]], vec![3.0, 1.0], vec![1.0, 2.0], vec![0.1; 2]);
/// let positions = [vec![0.0, 1.2, 2.0], vec![0.0, 0.1, 1.5]];
/// let velocities = [vec![0.3, -0.2, 0.1], vec![0.0, 0.5, -0.1]];
/// let (positions, velocities, tension) = (&positions, &velocities, 0.0.into());
/// check(&springs, &Configuration { positions, velocities, tension });
/// ```
pub fn check<const D: usize>(force: &dyn Force<D>, at: &Configuration<'_, D>) {
    adds_to_what_is_there(force, at);
    is_minus_the_gradient_of_its_energy(force, at);
    has_the_stiffness_that_it_says(force, at);
    dissipates_what_it_says(force, at);
    if force.is_internal() {
        has_no_resultant(force, at);
        turns_with_the_body(force, at);
    }
}

fn evaluate<const D: usize>(force: &dyn Force<D>, at: &Configuration<'_, D>) -> Vectors<D> {
    let mut forces = zeros(at.positions[0].len());
    force.add_forces(at, &mut forces);
    forces
}

fn largest<const D: usize>(forces: &Vectors<D>) -> f64 {
    forces.iter().flatten().fold(f64::MIN_POSITIVE, |size, value| size.max(value.abs()))
}

fn dot<const D: usize>(a: &Vectors<D>, b: &Vectors<D>) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}

fn adds_to_what_is_there<const D: usize>(force: &dyn Force<D>, at: &Configuration<'_, D>) {
    let once = evaluate(force, at);
    let mut twice = once.clone();
    force.add_forces(at, &mut twice);
    for (one, two) in once.iter().flatten().zip(twice.iter().flatten()) {
        let error = (two - 2.0 * one).abs();
        assert!(error <= 1e-9 * largest(&once), "{} overwrites forces", force.name());
    }
}

fn is_minus_the_gradient_of_its_energy<const D: usize>(
    force: &dyn Force<D>,
    at: &Configuration<'_, D>,
) {
    let count = at.positions[0].len();
    let still = zeros(count);
    let at = Configuration { velocities: &still, ..*at };
    let Some(energy) = force.energy(&at) else { return };
    let forces = evaluate(force, &at);
    let mut moved = at.positions.clone();
    let step = 1e-5;
    // The accuracy of a central difference is limited by rounding in the energy and by third
    // derivatives.
    let tolerance = 1e-6 * largest(&forces) + 64.0 * f64::EPSILON * energy.abs() / step;
    for axis in 0..D {
        for node in 0..count {
            let place = at.positions[axis][node];
            let mut energy_at = |x: f64| {
                moved[axis][node] = x;
                let there = Configuration { positions: &moved, ..at };
                let energy = force.energy(&there).unwrap_or(f64::NAN);
                moved[axis][node] = place;
                energy
            };
            let gradient = (energy_at(place + step) - energy_at(place - step)) / (2.0 * step);
            let error = (forces[axis][node] + gradient).abs();
            assert!(
                error <= tolerance,
                "{}: force {} on node {node} along axis {axis} is not minus the energy's gradient \
                 {gradient}",
                force.name(),
                forces[axis][node],
            );
        }
    }
}

fn has_the_stiffness_that_it_says<const D: usize>(force: &dyn Force<D>, at: &Configuration<'_, D>) {
    let count = at.positions[0].len();
    let still = zeros(count);
    let at = Configuration { velocities: &still, ..*at };
    let mut stiffness = StiffnessMatrix::new(count);
    if !force.add_stiffness(&at, &mut stiffness) {
        assert_eq!(stiffness.blocks(), 0, "{} adds a stiffness but denies it", force.name());
        return;
    }
    assert!(force.energy(&at).is_some(), "{} has a stiffness but no energy", force.name());
    let step = 1e-5;
    let mut scale = largest(&evaluate(force, &at));
    // Three irregular directions, so that no entry hides behind another.
    for turn in 1..=3 {
        let direction: Vectors<D> = from_fn(|axis| {
            (0..count)
                .map(|i| ((D * i + axis + turn) as f64 * 0.618_033_988_749_894_9).fract() - 0.5)
                .collect()
        });
        let at_distance = |by: f64| {
            let moved = from_fn(|axis| {
                let both = at.positions[axis].iter().zip(&direction[axis]);
                both.map(|(x, d)| x + by * d).collect()
            });
            evaluate(force, &Configuration { positions: &moved, ..at })
        };
        let (plus, minus) = (at_distance(step), at_distance(-step));
        let product = stiffness.times(&direction);
        scale = scale.max(largest(&product));
        // The accuracy of a difference is limited by rounding in the forces and by their third
        // derivatives.
        let tolerance = 1e-6 * scale;
        for axis in 0..D {
            for node in 0..count {
                let slope = (minus[axis][node] - plus[axis][node]) / (2.0 * step);
                let error = (product[axis][node] - slope).abs();
                assert!(
                    error <= tolerance,
                    "{}: stiffness gives {} on node {node} along axis {axis}, differences of the \
                     force {slope}",
                    force.name(),
                    product[axis][node],
                );
            }
        }
    }
}

fn dissipates_what_it_says<const D: usize>(force: &dyn Force<D>, at: &Configuration<'_, D>) {
    let still = zeros(at.positions[0].len());
    let moving = evaluate(force, at);
    let resting = evaluate(force, &Configuration { velocities: &still, ..*at });
    let taken = dot(&resting, at.velocities) - dot(&moving, at.velocities);
    let said = force.dissipation(at);
    let scale = largest(&moving) * at.velocities.iter().flatten().map(|v| v.abs()).sum::<f64>();
    assert!(said >= 0.0, "{} gives energy: dissipation {said} fJ/ms", force.name());
    assert!(
        (taken - said).abs() <= 1e-11 * scale,
        "{} takes {taken} fJ/ms but says {said}",
        force.name()
    );
}

fn has_no_resultant<const D: usize>(force: &dyn Force<D>, at: &Configuration<'_, D>) {
    let forces = evaluate(force, at);
    let count = at.positions[0].len() as f64;
    let reach = at.positions.iter().flatten().fold(1.0_f64, |size, x| size.max(x.abs()));
    let tolerance = 1e-12 * largest(&forces) * count;
    for axis in &forces {
        let resultant: f64 = axis.iter().sum();
        assert!(resultant.abs() <= tolerance, "{} has a resultant of {resultant} nN", force.name());
    }
    for p in 0..D {
        for q in p + 1..D {
            let torque: f64 = (0..at.positions[0].len())
                .map(|i| at.positions[p][i] * forces[q][i] - at.positions[q][i] * forces[p][i])
                .sum();
            assert!(
                torque.abs() <= tolerance * reach,
                "{} has a torque of {torque} nN um",
                force.name()
            );
        }
    }
}

fn turns_with_the_body<const D: usize>(force: &dyn Force<D>, at: &Configuration<'_, D>) {
    let (sine, cosine) = 0.7_f64.sin_cos();
    // In one plane after the other: with three axes about no axis of the lattice.
    let turn = |v: &Vectors<D>, shift: f64| -> Vectors<D> {
        let mut turned = v.clone();
        for axis in 1..D {
            for i in 0..v[0].len() {
                let (x, y) = (turned[axis - 1][i], turned[axis][i]);
                turned[axis - 1][i] = cosine * x - sine * y;
                turned[axis][i] = sine * x + cosine * y;
            }
        }
        for (axis, values) in turned.iter_mut().enumerate() {
            for x in values {
                *x += shift * (3.0 - 11.0 * axis as f64);
            }
        }
        turned
    };
    let (positions, velocities) = (turn(at.positions, 1.0), turn(at.velocities, 0.0));
    let there = Configuration { positions: &positions, velocities: &velocities, ..*at };
    let before = evaluate(force, at);
    let (expected, turned) = (turn(&before, 0.0), evaluate(force, &there));
    let stiffest = largest(&before);
    for (a, b) in expected.iter().flatten().zip(turned.iter().flatten()) {
        assert!((a - b).abs() <= 1e-9 * stiffest, "{} does not turn with the body", force.name());
    }
    if let (Some(a), Some(b)) = (force.energy(at), force.energy(&there)) {
        let error = (a - b).abs();
        assert!(error <= 1e-10 * a.abs(), "{}: energy {a} fJ becomes {b} fJ", force.name());
    }
}
