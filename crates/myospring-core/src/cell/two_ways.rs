//! One beat of a cell model integrated in two ways.

use super::cell_model::CellModel;
use super::description::{Input, TensionKind};
use super::pacing::Protocol;
use super::settings::{CellMethod, SolveError, SolverSettings};
use super::solve::solve;
use super::trace::CellTrace;

/// Between compared samples, ms.
const SAMPLED_MS: f64 = 0.1;
/// Fixed steps of the second way, ms.
const STEP_MS: f64 = 0.001;
/// Largest error of a step where the equations are too fast for fixed steps.
const FINE_TOLERANCE: f64 = 1e-8;

/// How far two ways of integrating one beat lie apart.
#[derive(Debug, Clone, PartialEq)]
pub struct TwoWays {
    /// The usual way of the model, and the other.
    pub ways: [SolverSettings; 2],
    /// Potential, and calcium and tension where the model has them.
    pub differences: Vec<Difference>,
}

/// The largest difference of one curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// What it is: `potential`, `calcium`, `tension`.
    pub name: &'static str,
    /// Its unit.
    pub unit: String,
    /// The largest difference, in that unit.
    pub largest: f64,
    /// When it is that large, ms.
    pub at_ms: f64,
    /// Highest minus lowest value in the beat, in that unit.
    pub range: f64,
}

/// Integrates one beat after the model's own stimulus by its usual method, and by explicit Runge-Kutta steps of
/// 0.001 ms, which share neither Jacobian nor choice of steps with it. Where the equations are too fast for such
/// steps, the other way is that of implicit steps with a tolerance of 1e-8.
///
/// # Errors
/// A beat that cannot be integrated by the usual method.
///
/// # Example
/// ```
/// use myospring::cell::{self, two_ways::two_ways};
/// let checked = two_ways(&*cell::model("bueno_orovio_2008_epi")?, 400.0)?;
/// let potential = &checked.differences[0];
/// assert!(potential.largest < 1e-3 * potential.range);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn two_ways(model: &dyn CellModel, duration_ms: f64) -> Result<TwoWays, SolveError> {
    let protocol = Protocol { start_ms: 10.0, ..Protocol::once(model.default_stimulus()) };
    let beat = |settings| solve(model, protocol, settings, duration_ms, SAMPLED_MS);
    let usual = model.usual_settings();
    let first = beat(usual)?;
    let mut other =
        SolverSettings { step_ms: STEP_MS, ..SolverSettings::of(CellMethod::RungeKutta4) };
    let second = match beat(other) {
        Ok(trace) => trace,
        Err(_) if usual.method.chooses_steps() => {
            other = SolverSettings { tolerance: FINE_TOLERANCE, ..usual };
            beat(other)?
        }
        Err(error) => return Err(error),
    };
    let [first, second] = [first, second].map(|trace| curves(model, &trace));
    let differences = first.iter().zip(&second).map(|(one, two)| difference(one, two)).collect();
    Ok(TwoWays { ways: [usual, other], differences })
}

/// A curve: its name, its unit and its samples.
type Curve = (&'static str, String, Vec<f64>);

fn curves(model: &dyn CellModel, trace: &CellTrace) -> Vec<Curve> {
    let mut all: Vec<Curve> = Vec::new();
    match &trace.membrane_potential_mv {
        Some(potential) => all.push(("potential", "mV".to_owned(), potential.clone())),
        None if !trace.potential.is_empty() => {
            all.push(("potential", String::new(), trace.potential.clone()));
        }
        None => {}
    }
    let calcium: Option<Vec<f64>> = (0..trace.time_ms.len())
        .map(|sample| {
            let state: Vec<f64> = trace.states.iter().map(|column| column[sample]).collect();
            model.calcium_um(&state, &Input::REST)
        })
        .collect();
    all.extend(calcium.map(|calcium| ("calcium", "uM".to_owned(), calcium)));
    let unit = match model.tension_kind() {
        TensionKind::None => return all,
        TensionKind::Kilopascal => "kPa",
        TensionKind::Relative { .. } => "",
    };
    all.push(("tension", unit.to_owned(), trace.tension.clone()));
    all
}

fn difference((name, unit, one): &Curve, (_, _, two): &Curve) -> Difference {
    let apart = one.iter().zip(two).map(|(one, two)| (one - two).abs());
    let (at, largest) =
        apart.enumerate().fold((0, 0.0), |most, own| if own.1 > most.1 { own } else { most });
    let [low, high] = two.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(*value), high.max(*value)]
    });
    let (at_ms, unit) = (at as f64 * SAMPLED_MS, unit.clone());
    Difference { name, unit, largest, at_ms, range: high - low }
}
