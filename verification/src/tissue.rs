//! Waves through tissue: conduction velocities that a separate program computed, and the law of the square root.
//!
//! The separate program solves the same equations with finite differences on a cable: 71.0, 75.4 and 72.7 cm/s at 0.25 mm for the
//! epicardial, endocardial and TNNP sets of `bueno_orovio_2008`; 78.2, 83.6 and 80.3 at 0.1 mm; 79.6, 85.3 and 81.8 at 0.025 mm.

use crate::check::{Failure, Setting};
use crate::row::Row;
use myospring::cell::CellModel;
use myospring::cell::bueno_orovio_2008::{Variant, model};
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings};
use myospring::exchange::{Activation, Conduction, Tissue, TissueCells};
use myospring::mesh::lattice;
use std::sync::Arc;

/// Human ventricles with the minimal models, um^2/ms.
const HUMAN: f64 = 1.171e5;
/// Velocities of the separate program, cm/s, of each set at each spacing, um, with the step, ms.
const SETS: [(&str, Variant); 3] =
    [("epicardial", Variant::Epi), ("endocardial", Variant::Endo), ("TNNP", Variant::Tnnp)];
const SPACINGS: [(f64, f64, [f64; 3]); 3] = [
    (250.0, 0.02, [71.0, 75.4, 72.7]),
    (100.0, 0.005, [78.2, 83.6, 80.3]),
    (25.0, 0.001, [79.6, 85.3, 81.8]),
];

/// Velocity of a plane wave along a strip of 10 mm, cm/s, between a half and three quarters of it.
fn velocity(
    variant: Variant,
    spacing: f64,
    step_ms: f64,
    conduction: &Conduction,
) -> Result<f64, Failure> {
    let columns = (10_000.0 / spacing) as usize;
    let mesh = lattice::rectangle(columns, 1, spacing)?;
    let model = model(variant);
    let beat = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let protocol = |node: usize| if mesh.point(node)[0] < 620.0 { beat } else { Protocol::rest() };
    let protocols: Vec<Protocol> = (0..mesh.len()).map(protocol).collect();
    let settings =
        SolverSettings { method: CellMethod::ForwardEuler, step_ms, ..SolverSettings::default() };
    let cells = TissueCells {
        model: Arc::new(model),
        state: None,
        protocols: &protocols,
        settings,
        scale: 1.0,
    };
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let mut strip = Tissue::new(&mesh, &fibres, conduction, cells)?;
    strip.reach(25.0)?;
    let beats = strip.local_beats().ok_or("no beats")?;
    let [from, to] = [columns / 2, 3 * columns / 4];
    let activated = |column: usize| -> Result<f64, Failure> {
        let near = |node: &usize| (mesh.point(*node)[0] - column as f64 * spacing).abs() < 1e-6;
        let node = (0..mesh.len()).find(near).ok_or("no such column")?;
        Ok(beats[node].first().ok_or("a place that was not activated")?.activated_ms)
    };
    Ok(0.1 * (to - from) as f64 * spacing / (activated(to)? - activated(from)?))
}

/// The rows of this check.
///
/// # Errors
/// A wave that does not arrive.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    // The finest lattice takes a minute.
    let spacings = if setting.quick { &SPACINGS[..1] } else { &SPACINGS[..] };
    for (spacing, step, expected) in spacings {
        for ((name, variant), expected) in SETS.into_iter().zip(expected) {
            rows.push(Row::about(
                format!("plane wave of the {name} set on a lattice of {} mm", spacing / 1000.0),
                "finite differences on a cable, a program of its own",
                velocity(variant, *spacing, *step, &Conduction::even(HUMAN))?,
                *expected,
                0.005 * expected,
                "cm/s",
                "0.5 %: both are of first order in the step where the equations jump",
            ));
        }
    }
    let [whole, half] = [(200.0, 1.0), (100.0, 0.25)].map(|(spacing, part)| {
        velocity(Variant::Epi, spacing, 0.01, &Conduction::even(part * HUMAN))
    });
    rows.push(Row::about(
        "a quarter of the diffusion at half of the spacing: how much slower the wave is",
        "the square root",
        whole? / half?,
        2.0,
        2e-3,
        "",
        "rounding of sums, and waves of the same shape",
    ));
    Ok(rows)
}
