//! Order of convergence in time of a whole lattice in fast, large motion.
//!
//! A strip or a block of cubes with all forces of a cell is set moving by a tension that rises within one vibration; its
//! positions are compared at time steps h, h/2 and h/4.

use crate::check::{Failure, Setting};
use crate::engine::Engine;
use crate::fit::farthest;
use crate::row::Row;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{Material, assemble, assemble_thick, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::SupportKind;
use myospring::mechanics::{Body, System, Vectors};
use myospring::mesh::{Mesh, Simplex, cubes, lattice};

const DURATION: f64 = 3.0;
const LENGTH: f64 = 32.0;
const KIND: SupportKind = SupportKind::ClampedEnd;

/// A lattice, clamped at one end, with fibres that wind.
struct Twitching<const D: usize, const N: usize> {
    mesh: Mesh<D, N>,
    body: Body<D>,
    system: System<D>,
}

/// Directions that wind to and fro along x, in the plane of x and y.
fn winding<const D: usize, const N: usize>(mesh: &Mesh<D, N>) -> Vec<[f64; D]> {
    let angle = |x: f64| 0.5 * (0.1 * x).sin();
    let along = |angle: f64| {
        let mut direction = [0.0; D];
        [direction[0], direction[1]] = [angle.cos(), angle.sin()];
        direction
    };
    let first = |simplex: &Simplex<N>| mesh.points[0][simplex.nodes[0] as usize];
    mesh.simplices.iter().map(|simplex| along(angle(first(simplex)))).collect()
}

fn strip(material: &Material) -> Result<Twitching<2, 3>, Failure> {
    let mesh = lattice::rectangle(16, 4, 2.0)?;
    let (fibres, axis) = (winding(&mesh), [1.0, 0.0]);
    let (body, system) = assemble(&mesh, material, ActiveLaw::Fibre, &fibres, KIND, axis, LENGTH);
    Ok(Twitching { mesh, body, system })
}

fn block(material: &Material) -> Result<Twitching<3, 4>, Failure> {
    let mesh = cubes::block([16, 4, 2], 2.0)?;
    let (fibres, axis) = (winding(&mesh), [1.0, 0.0, 0.0]);
    let (body, system) = assemble_thick(&mesh, material, &fibres, KIND, axis, LENGTH);
    Ok(Twitching { mesh, body, system })
}

fn order<const D: usize, const N: usize>(
    engine: Engine,
    Twitching { mesh, body, system }: &Twitching<D, N>,
) -> Result<f64, Failure> {
    let limit = StabilityLimit::of(system, body, 50.0).time_step;
    let steps = (DURATION / (0.05 * limit)).ceil() as usize;
    let after = |steps: usize| -> Result<Vectors<D>, Failure> {
        let mut motion = engine.motion(mesh, system, body.clone(), DURATION / steps as f64)?;
        motion.advance(steps, [0.0, 50.0].map(Into::into))?;
        Ok(motion.body().positions.clone())
    };
    let shapes = [after(steps)?, after(2 * steps)?, after(4 * steps)?];
    Ok((farthest(&shapes[0], &shapes[1]) / farthest(&shapes[1], &shapes[2])).log2())
}

/// The order without damping, with drag and with dashpots, of squares and of cubes; the worst of all engines.
///
/// # Errors
/// A mesh that cannot be made.
pub fn rows(_: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let kinds = [
        ("no damping", 0.0, 0.0, 2.0, "order 2 of Verlet's method"),
        ("drag", 0.0, 0.3, 2.0, "drag is taken implicitly, which keeps order 2"),
        ("axial dashpots", 0.05, 0.0, 1.0, "dashpots see the velocity of half a step before"),
    ];
    for what in ["strip", "block of cubes"] {
        for (name, damping_ratio, drag_ratio, expected, reason) in kinds {
            let material = Material { damping_ratio, drag_ratio, ..default_material() };
            let mut worst = expected;
            for engine in Engine::ALL {
                let measured = match what {
                    "strip" => order(engine, &strip(&material)?)?,
                    _ => order(engine, &block(&material)?)?,
                };
                if (measured - expected).abs() >= f64::abs(worst - expected) || measured.is_nan() {
                    worst = measured;
                }
            }
            rows.push(Row::about(
                format!("twitching {what}, {name}: order in the time step, all positions"),
                "theory of Verlet's method",
                worst,
                expected,
                0.05,
                "",
                reason,
            ));
        }
    }
    Ok(rows)
}
