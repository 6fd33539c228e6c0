//! What a free, undamped lattice keeps: momentum, angular momentum, energy.

use crate::check::{Failure, Setting};
use crate::engine::Engine;
use crate::fit::slope;
use crate::row::Row;
use myospring::integrate::verlet::Integrator;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{Material, assemble, assemble_thick, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::{Support, SupportKind};
use myospring::mechanics::{Body, System, Vectors};
use myospring::mesh::{Mesh, cubes, lattice};
use std::array::from_fn;

/// Blocks of steps after which energy is looked at.
const BLOCKS: usize = 1000;

/// A body that is free and undamped, under its forces without tension.
struct Lattice<const D: usize, const N: usize> {
    mesh: Mesh<D, N>,
    body: Body<D>,
    system: System<D>,
}

fn undamped() -> Material {
    Material { damping_ratio: 0.0, drag_ratio: 0.0, ..default_material() }
}

fn squares() -> Result<Lattice<2, 3>, Failure> {
    let mesh = lattice::rectangle(12, 5, 1.0)?;
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let (kind, axis) = (SupportKind::MassCentre, [1.0, 0.0]);
    let (body, system) = assemble(&mesh, &undamped(), ActiveLaw::Fibre, &fibres, kind, axis, 12.0);
    Ok(Lattice { mesh, body, system })
}

/// Cubes that keep their volumes.
fn cubes() -> Result<Lattice<3, 4>, Failure> {
    let mesh = cubes::block([12, 3, 2], 1.0)?;
    let fibres = vec![[1.0, 0.0, 0.0]; mesh.simplices.len()];
    let (kind, axis) = (SupportKind::MassCentre, [1.0, 0.0, 0.0]);
    let (body, system) = assemble_thick(&mesh, &undamped(), &fibres, kind, axis, 12.0);
    Ok(Lattice { mesh, body, system })
}

fn length<const D: usize>(vector: [f64; D]) -> f64 {
    vector.into_iter().fold(0.0, f64::hypot)
}

/// Angular momentum in each plane of two axes, ug um^2/ms.
fn angular_momentum<const D: usize>(body: &Body<D>) -> Vec<f64> {
    let planes = (0..D).flat_map(|p| (p + 1..D).map(move |q| [p, q]));
    planes.map(|plane| body.angular_momentum_in(plane)).collect()
}

/// Changes over the run: momentum and angular momentum against the sum of the parts' own, the largest
/// departure of the energy, and the slope of the energy times the duration, both against the energy.
fn changes<const D: usize, const N: usize>(
    engine: Engine,
    Lattice { mesh, mut body, mut system }: Lattice<D, N>,
    steps: usize,
) -> Result<[f64; 4], Failure> {
    system.support = Support::Free;
    // Repeatable, irregular velocities: fractional parts of multiples of the golden ratio.
    for axis in 0..D {
        for node in 0..mesh.len() {
            let n = (D * node + axis + 1) as f64;
            body.velocities[axis][node] = (n * 0.618_033_988_749_894_9).fract() - 0.5;
        }
    }
    let step = 0.1 * StabilityLimit::of(&system, &body, 0.0).time_step;
    let before = (body.momentum(), angular_momentum(&body));
    let (mut linear, mut angular) = (0.0, 0.0);
    for node in 0..mesh.len() {
        let of = |vectors: &Vectors<D>| length(from_fn::<_, D, _>(|axis| vectors[axis][node]));
        let (speed, arm) = (of(&body.velocities), of(&body.positions));
        linear += body.masses[node] * speed;
        angular += body.masses[node] * speed * arm;
    }
    let mut motion = engine.motion(&mesh, &system, body, step)?;
    let (mut blocks, mut energies) = (Vec::new(), Vec::new());
    for block in 0..BLOCKS {
        let now = motion.body();
        blocks.push(block as f64 / BLOCKS as f64);
        energies.push(system.elastic_energy(&now.configuration(0.0)) + now.kinetic_energy());
        motion.advance(steps / BLOCKS, [0.0.into(); 2])?;
    }
    let after = (motion.body().momentum(), angular_momentum(motion.body()));
    let start = energies[0];
    let wander = energies.iter().map(|e| (e / start - 1.0).abs()).fold(0.0, f64::max);
    // The body moves on as a whole, so the arm of the momenta grows; count the largest.
    let angular = angular + linear * length(motion.body().mass_centre());
    let turned = after.1.iter().zip(&before.1).map(|(after, before)| after - before);
    Ok([
        length(from_fn::<_, D, _>(|axis| after.0[axis] - before.0[axis])) / linear,
        turned.fold(0.0, f64::hypot) / angular,
        wander,
        slope(&blocks, &energies).abs() / start,
    ])
}

/// A million steps of a free lattice in violent motion.
///
/// # Errors
/// A mesh that cannot be made.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let steps = if setting.quick { 20_000 } else { 1_000_000 };
    let mut rows = Vec::new();
    for (engine, in_space) in [
        (Engine::Plain(Integrator::VelocityVerlet), false),
        (Engine::Plain(Integrator::StoermerVerlet), false),
        (Engine::Fused(1), false),
        (Engine::Fused(1), true),
    ] {
        let (rounding, reason) = if engine == Engine::Plain(Integrator::StoermerVerlet) {
            let reason = "velocities are differences of positions over the step: rounding of the \
                          positions, 1e-15 um, over 1e-3 ms, adds up as the square root of the steps";
            (1e-9, reason)
        } else {
            let reason =
                "rounding of the velocities, 1e-16 a step, adds up as the square root of the steps";
            (1e-12, reason)
        };
        let [momentum, angular_momentum, wander, drift] = if in_space {
            changes(engine, cubes()?, steps)?
        } else {
            changes(engine, squares()?, steps)?
        };
        let of_cubes = if in_space { " of cubes that keep their volumes" } else { "" };
        let name = format!("{steps} undamped steps of a free lattice{of_cubes}, {}", engine.name());
        rows.push(Row::difference(
            format!("{name}: change of momentum"),
            "conservation law",
            momentum,
            rounding,
            "of the sum of m |v|",
            reason,
        ));
        rows.push(Row::difference(
            format!("{name}: change of angular momentum"),
            "conservation law",
            angular_momentum,
            rounding,
            "of the sum of m |v| |x|",
            reason,
        ));
        rows.push(Row::difference(
            format!("{name}: largest departure of the energy"),
            "bound (omega dt)^2/8 of Verlet's method at a tenth of its limit",
            wander,
            5e-3,
            "of the energy",
            "the energy that the method conserves differs by at most this for the fastest vibration",
        ));
        rows.push(Row::difference(
            format!("{name}: drift of the energy over the run"),
            "a symplectic method has none",
            drift,
            3e-4,
            "of the energy",
            "slope of a line through 1000 samples that wander by 0.1 %: three standard errors",
        ));
    }
    Ok(rows)
}
