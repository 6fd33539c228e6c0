//! A longitudinal wave along a free strip.
//!
//! Its speed is `sqrt(E/rho)` for waves long against the width. The standing wave of half a wavelength
//! in a strip of length L has the period `T = 2 L/c`. The strip also moves across: at the distance y from
//! its middle with `-nu y du'/dx`, so its kinetic energy is `rho/2 (u'^2 + nu^2 y^2 (du'/dx)^2)`, and with
//! half width b and wave number `q = pi/L` the speed is `c = sqrt(E/rho) / sqrt(1 + (nu q b)^2/3)`
//! (`rayleigh_1877`, section 157, does it for a round bar). What is left out is of the order of `(q b)^4`.

use crate::check::{Failure, Setting};
use crate::fit::{order, slope};
use crate::row::Row;
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{Material, assemble, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::lattice;
use std::f64::consts::PI;

const LENGTH: f64 = 64.0;
const WIDTH: f64 = 4.0;
const POISSON: f64 = 1.0 / 3.0;
/// Period of the slowest vibration, ms.
const PERIOD: f64 = 2.0;

/// Speed of the wave on a lattice of this many squares across, over `sqrt(E/rho)`.
fn speed(across: usize) -> Result<f64, Failure> {
    let spacing = WIDTH / across as f64;
    let mesh = lattice::rectangle((LENGTH / spacing).round() as usize, across, spacing)?;
    let material = Material {
        area_modulus: 0.0,
        damping_ratio: 0.0,
        slowest_period: Some(PERIOD),
        drag_ratio: 0.0,
        ..default_material()
    };
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let support = SupportKind::MassCentre;
    let (mut body, system) =
        assemble(&mesh, &material, ActiveLaw::Fibre, &fibres, support, [1.0, 0.0], LENGTH);
    // So small that the lattice is linear to 1e-7; across, the strip follows with Poisson's ratio.
    let (q, size) = (PI / LENGTH, 1e-5);
    let shape: Vec<f64> = mesh.points[0].iter().map(|x| (q * x).cos()).collect();
    for node in 0..mesh.len() {
        let [x, y] = mesh.point(node);
        body.positions[0][node] += size * shape[node];
        body.positions[1][node] += size * POISSON * q * (q * x).sin() * (y - 0.5 * WIDTH);
    }
    let amplitude = |positions: &[f64]| -> f64 {
        (0..mesh.len())
            .map(|i| body.masses[i] * shape[i] * (positions[i] - mesh.points[0][i]))
            .sum()
    };
    let step = 0.5 * StabilityLimit::of(&system, &body, 0.0).time_step;
    let steps = (20.0 * PERIOD / step) as usize;
    let mut motion = Motion::new(&system, body.clone(), Integrator::VelocityVerlet, step);
    let (mut before, mut crossings) = (amplitude(&body.positions[0]), Vec::new());
    for n in 1..=steps {
        motion.advance(1, [0.0, 0.0])?;
        let now = amplitude(&motion.body.positions[0]);
        if before * now < 0.0 {
            crossings.push(step * (n as f64 - now / (now - before)));
        }
        before = now;
    }
    let count: Vec<f64> = (0..crossings.len()).map(|n| n as f64).collect();
    let period = 2.0 * slope(&count, &crossings);
    // The density is such that sqrt(E/rho) = 2 L / (slowest period).
    Ok(PERIOD / period)
}

/// Speed of the wave on finer and finer lattices.
///
/// # Errors
/// A mesh that cannot be made.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let first = if setting.quick { 2 } else { 4 };
    let speeds = [speed(first)?, speed(2 * first)?, speed(4 * first)?];
    let limit = speeds[2] + (speeds[2] - speeds[1]) / 3.0;
    let lateral = POISSON * PI / LENGTH * 0.5 * WIDTH;
    let theory = 1.0 / (1.0 + lateral * lateral / 3.0).sqrt();
    Ok(vec![
        Row::about(
            "wave along a strip, 64 x 4 um: order of its speed in spacing and step together",
            "theory of lattices and of Verlet's method",
            order(speeds),
            2.0,
            0.05,
            "",
            "order 2 in space and in time",
        ),
        Row::difference(
            "wave along a strip: its speed, extrapolated to spacing 0, relative to sqrt(E/rho)",
            "sqrt(E/rho) with lateral inertia (Rayleigh 1877, section 157)",
            (limit / theory - 1.0).abs(),
            2e-6,
            "",
            "terms left out of the closed form, (q b)^4 times 0.05, and of the extrapolation",
        ),
    ])
}
