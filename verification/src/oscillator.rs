//! Two masses on a spring: the damped harmonic oscillator, whose motion everyone knows.
//!
//! With `k`, masses `m`, drag rate `gamma` and dashpot `c` the extension obeys
//! `e'' + (gamma + 2 c/m) e' + (2 k/m) e = 0`, so `e(t) = e_0 exp(-d t)(cos w t + d/w sin w t)`,
//! `d = (gamma + 2 c/m)/2`, `w^2 = 2 k/m - d^2`.

use crate::check::{Failure, Setting};
use crate::row::Row;
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::drag::Drag;
use myospring::mechanics::spring::Springs;
use myospring::mechanics::support::Support;
use myospring::mechanics::{Body, System, zeros};

const STIFFNESS: f64 = 3.0;
const MASS: f64 = 0.5;
const EXTENSION: f64 = 0.2;
const DURATION: f64 = 4.0;

/// Extension after the duration, um: computed, and by the closed form.
fn extension(
    integrator: Integrator,
    dashpot: f64,
    drag: f64,
    steps: usize,
) -> Result<[f64; 2], Failure> {
    // Aslant, so that both axes count.
    let direction = [0.6, 0.8];
    let half = 0.5 * (1.0 + EXTENSION);
    let masses = vec![MASS; 2];
    let body = Body {
        positions: direction.map(|d| vec![-half * d, half * d]),
        velocities: zeros(2),
        masses: masses.clone(),
    };
    let springs = Springs::new(vec![[0, 1]], vec![STIFFNESS], vec![1.0], vec![dashpot]);
    let system = System {
        passive: vec![Box::new(springs)],
        active: vec![],
        drag: Drag { rate: drag, masses },
        support: Support::Free,
    };
    let mut motion = Motion::new(&system, body, integrator, DURATION / steps as f64);
    motion.advance(steps, [0.0, 0.0])?;
    let [x, y] = &motion.body.positions;
    let computed = (x[1] - x[0]).hypot(y[1] - y[0]) - 1.0;
    let decay = 0.5 * (drag + 2.0 * dashpot / MASS);
    let omega = (2.0 * STIFFNESS / MASS - decay * decay).sqrt();
    let (sine, cosine) = (omega * DURATION).sin_cos();
    let exact = EXTENSION * (-decay * DURATION).exp() * (cosine + decay / omega * sine);
    Ok([computed, exact])
}

fn error(integrator: Integrator, dashpot: f64, drag: f64, steps: usize) -> Result<f64, Failure> {
    let [computed, exact] = extension(integrator, dashpot, drag, steps)?;
    Ok(computed - exact)
}

/// Orders of convergence to the closed form; the worst of both forms of Verlet's method.
///
/// # Errors
/// A motion that breaks off.
pub fn rows(_: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let against = "closed form of the damped oscillator";
    let mut rows = Vec::new();
    for (name, dashpot, drag, expected, reason) in [
        ("free oscillator", 0.0, 0.0, 2.0, "order 2 of Verlet's method"),
        ("oscillator with drag", 0.0, 1.5, 2.0, "drag is taken implicitly, which keeps order 2"),
        (
            "oscillator with an axial dashpot",
            0.2,
            0.0,
            1.0,
            "dashpots see the velocity of half a step before, which costs an order",
        ),
    ] {
        let order = |form| -> Result<f64, Failure> {
            let coarse = error(form, dashpot, drag, 800)?;
            Ok((coarse / error(form, dashpot, drag, 1600)?).abs().log2())
        };
        let orders = Integrator::ALL.into_iter().map(order).collect::<Result<Vec<_>, _>>()?;
        let worst = orders
            .into_iter()
            .max_by(|a, b| (a - expected).abs().total_cmp(&(b - expected).abs()))
            .unwrap_or(f64::NAN);
        rows.push(Row::about(
            format!("{name}: order in the time step"),
            against,
            worst,
            expected,
            0.05,
            "",
            reason,
        ));
    }
    // Extrapolated to step 0 by the known order, so that the limit itself is checked.
    let at = |steps| extension(Integrator::StoermerVerlet, 0.2, 0.0, steps);
    let [coarse, fine] = [at(6400)?, at(12_800)?];
    rows.push(Row::difference(
        "oscillator with an axial dashpot: extension after 4 ms, extrapolated to step 0",
        against,
        (2.0 * fine[0] - coarse[0] - fine[1]).abs() / EXTENSION,
        1e-6,
        "of the start",
        "the residual after extrapolation is of the order of the step squared, about 1e-7",
    ));
    Ok(rows)
}
