//! The default beat: balance of energy, independence of mass and time step.

use crate::check::{Failure, Setting};
use crate::row::Row;
use myospring::analysis::trace;
use myospring::integrate::quasi_static::Tolerance;
use myospring::mechanics::material::{Material, default_material};
use myospring::mesh::{Mesh, built_in, lattice};
use myospring::recording::Sample;
use myospring::simulation::{Effort, Outcome, Simulation};

fn cell(spacing: Option<f64>) -> Result<Mesh, Failure> {
    Ok(lattice::from_outline(&built_in::adult_ventricular(), spacing)?.0)
}

fn run(simulation: &Simulation) -> Result<Outcome, Failure> {
    let outcome = simulation.prepare()?.run(|_| true);
    match &outcome.stop {
        None => Ok(outcome),
        Some(reason) => Err(format!("the beat stopped: {reason}").into()),
    }
}

fn peak_shortening(outcome: &Outcome) -> Result<f64, Failure> {
    let samples = &outcome.recording.samples;
    let (times, values): (Vec<f64>, Vec<f64>) =
        samples.iter().map(|s| (s.t_ms, s.shortening_pct)).unzip();
    Ok(trace::peak(&times, &values).ok_or("the beat has no peak")?.value)
}

/// Largest gap in the balance of energy over the largest work of the active force.
fn imbalance(samples: &[Sample]) -> f64 {
    let work = samples.iter().map(|s| s.active_work_fj).fold(0.0, f64::max);
    let gap = |s: &Sample| {
        s.active_work_fj - s.elastic_energy_fj - s.kinetic_energy_fj - s.dissipated_energy_fj
    };
    samples.iter().map(|s| gap(s).abs() / work).fold(0.0, f64::max)
}

/// Largest difference of the shortenings of two runs with the same times, %.
fn largest_difference(one: &Outcome, other: &Outcome) -> Result<f64, Failure> {
    let [one, other] = [one, other].map(|run| &run.recording.samples);
    if one.len() != other.len() {
        return Err("the runs have different times".into());
    }
    let differences =
        one.iter().zip(other).map(|(a, b)| (a.shortening_pct - b.shortening_pct).abs());
    Ok(differences.fold(0.0, f64::max))
}

/// The default beat against itself with other masses and steps, and against its equilibria.
///
/// # Errors
/// A beat that stops.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let spacing = setting.quick.then_some(2.4);
    let simulation = Simulation::new(cell(spacing)?);
    let outcome = run(&simulation)?;
    let default = peak_shortening(&outcome)?;
    let Effort::Verlet { slowest_period_ms: Some(period), lag_pct: Some(lag), .. } = outcome.effort
    else {
        return Err("the beat does not say how far it lags".into());
    };
    let with_mass = |part: f64| -> Result<f64, Failure> {
        let slowest_period = Some(period * part.sqrt());
        let material = Material { slowest_period, ..default_material() };
        peak_shortening(&run(&Simulation { material, ..Simulation::new(cell(spacing)?) })?)
    };
    let path = simulation.run_quasi_static(Tolerance::default(), |_| true)?;
    let mut finer = Simulation::new(cell(spacing)?);
    finer.numerics.time_step = outcome.effort.time_step().map(|step| 0.5 * step);
    Ok(vec![
        Row::difference(
            "default beat: work of the active force minus stored, kinetic and dissipated energy",
            "first law of thermodynamics",
            imbalance(&outcome.recording.samples),
            1e-3,
            "of the largest work",
            "dissipation is summed by the trapezoidal rule every 0.25 ms",
        ),
        Row::difference(
            "default beat: peak shortening with half the mass",
            "the same with the default mass",
            (with_mass(0.5)? / default - 1.0).abs(),
            1e-3,
            "",
            "the mass is numerical, so the result must not depend on it",
        ),
        Row::difference(
            "default beat: peak shortening with a quarter of the mass",
            "the same with the default mass",
            (with_mass(0.25)? / default - 1.0).abs(),
            1e-3,
            "",
            "as above",
        ),
        Row::difference(
            "default beat: largest difference of the shortening from the path of equilibria",
            "the lag that the run states",
            largest_difference(&outcome, &path)? / default,
            0.01 * lag,
            "of the peak",
            "the period of the slowest vibration is chosen such that the stated lag is 1 %",
        ),
        Row::difference(
            "default beat: peak shortening with half the time step",
            "the same with the default step",
            (peak_shortening(&run(&finer)?)? / default - 1.0).abs(),
            1e-5,
            "",
            "the default step is set by stability, far below what the slow contraction needs",
        ),
    ])
}
