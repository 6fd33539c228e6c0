//! Order of convergence in time of a whole lattice in fast, large motion.
//!
//! A strip with all forces of a cell is set moving by a tension that rises within one vibration; its
//! positions are compared at time steps h, h/2 and h/4.

use crate::check::{Failure, Setting};
use crate::engine::Engine;
use crate::fit::farthest;
use crate::row::Row;
use myospring::mechanics::Vectors;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{Material, assemble, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::lattice;

const DURATION: f64 = 3.0;

fn order(engine: Engine, damping_ratio: f64, drag_ratio: f64) -> Result<f64, Failure> {
    let mesh = lattice::rectangle(16, 4, 2.0)?;
    let material = Material { damping_ratio, drag_ratio, ..default_material() };
    let fibres: Vec<[f64; 2]> = mesh
        .simplices
        .iter()
        .map(|simplex| (0.5 * (0.1 * mesh.points[0][simplex.nodes[0] as usize]).sin()).sin_cos())
        .map(|(sine, cosine)| [cosine, sine])
        .collect();
    let support = SupportKind::ClampedEnd;
    let (body, system) =
        assemble(&mesh, &material, ActiveLaw::Fibre, &fibres, support, [1.0, 0.0], 32.0);
    let limit = StabilityLimit::of(&system, &body, 50.0).time_step;
    let steps = (DURATION / (0.05 * limit)).ceil() as usize;
    let after = |steps: usize| -> Result<Vectors, Failure> {
        let mut motion = engine.motion(&mesh, &system, body.clone(), DURATION / steps as f64)?;
        motion.advance(steps, [0.0, 50.0].map(Into::into))?;
        Ok(motion.body().positions.clone())
    };
    let shapes = [after(steps)?, after(2 * steps)?, after(4 * steps)?];
    Ok((farthest(&shapes[0], &shapes[1]) / farthest(&shapes[1], &shapes[2])).log2())
}

/// The order without damping, with drag and with dashpots; the worst of all engines.
///
/// # Errors
/// A mesh that cannot be made.
pub fn rows(_: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for (name, damping, drag, expected, reason) in [
        ("no damping", 0.0, 0.0, 2.0, "order 2 of Verlet's method"),
        ("drag", 0.0, 0.3, 2.0, "drag is taken implicitly, which keeps order 2"),
        ("axial dashpots", 0.05, 0.0, 1.0, "dashpots see the velocity of half a step before"),
    ] {
        let mut worst = expected;
        for engine in Engine::ALL {
            let measured = order(engine, damping, drag)?;
            if (measured - expected).abs() >= f64::abs(worst - expected) || measured.is_nan() {
                worst = measured;
            }
        }
        rows.push(Row::about(
            format!("twitching strip, {name}: order in the time step, all positions"),
            "theory of Verlet's method",
            worst,
            expected,
            0.05,
            "",
            reason,
        ));
    }
    Ok(rows)
}
