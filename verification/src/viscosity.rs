//! A viscous strip, whose shape lags behind its tension, beside another program's.

use crate::check::{Failure, Setting, metric};
use crate::row::Row;
use myospring::integrate::Method;
use myospring::mechanics::material::Stiffness;
use myospring::mesh::lattice;
use myospring::simulation::{Outcome, Simulation};

const PEER: &str = "NumPy and SciPy, a solid block with the same lag";

/// Retardation time (ms), Young's modulus at which that block shortens by 12 % (kPa), its largest rate (lengths/s).
const BLOCK: [(f64, f64, f64); 4] =
    [(0.0, 348.6, 2.02), (10.0, 343.7, 1.92), (20.0, 330.5, 1.77), (30.0, 314.1, 1.65)];

/// How much slower it shortens.
///
/// # Errors
/// A beat that stops, or lacks a number.
pub fn rows(_setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let mut elastic = f64::NAN;
    for (time, modulus, rate) in BLOCK {
        let outcome = beat(modulus / BLOCK[0].1, time)?;
        let fastest = metric(&outcome, "maximum_shortening_rate")?;
        if time == 0.0 {
            elastic = fastest;
            rows.push(Row::about(
                "strip without viscosity: largest rate",
                PEER,
                fastest,
                rate,
                0.015 * rate,
                "lengths/s",
                "the flat sheet has another law than the block",
            ));
            continue;
        }
        rows.push(Row::about(
            format!("retardation time of {time} ms, softened to {modulus} kPa: peak shortening"),
            PEER,
            metric(&outcome, "peak_shortening")?,
            12.0,
            0.01,
            "%",
            "digits of the modulus",
        ));
        rows.push(Row::about(
            "the same: largest rate, of that without viscosity",
            PEER,
            fastest / elastic,
            rate / BLOCK[0].2,
            0.005,
            "",
            "its rates are printed to 0.005 lengths/s, so their ratio to 0.004",
        ));
    }
    Ok(rows)
}

/// A strip whose stiffness is a part of the default one.
fn beat(part: f64, retardation_time: f64) -> Result<Outcome, Failure> {
    let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
    simulation.numerics.method = Method::QuasiStatic;
    let usual = simulation.material.young_modulus();
    simulation.material.stiffness = Stiffness::YoungModulus(part * usual);
    simulation.material.area_modulus *= part;
    simulation.material.retardation_time = retardation_time;
    simulation.duration = 800.0;
    let outcome = simulation.build()?.run(|_progress| true);
    match &outcome.stop {
        Some(reason) => Err(format!("the beat stopped: {reason}").into()),
        None => Ok(outcome),
    }
}
