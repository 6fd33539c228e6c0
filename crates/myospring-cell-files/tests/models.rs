//! Published models as cell models: many side by side, and beats without a stimulus.
//!
//! Skipped where the files are absent: `../shared/data/cell-models`, or `MYOSPRING_SHARED_DATA`.

#[path = "../../myospring/tests/common/skipped.rs"]
mod skipped;

use myospring_cell_files::{Choices, open};
use myospring_core::analysis::spontaneous::Upstrokes;
use myospring_core::cell::CellModel;
use myospring_core::cell::batch::{self, BatchSettings, Paced};
use myospring_core::cell::equation_model::EquationModel;
use myospring_core::cell::pacing::Protocol;
use myospring_core::cell::solve::{CellMethod, SolverSettings, solve};
use skipped::shared_data;
use std::path::Path;
use std::sync::Arc;

#[allow(clippy::unwrap_used)]
fn model(path: &Path) -> EquationModel {
    EquationModel::new(open(path, &Choices::default()).unwrap()).unwrap()
}

#[test]
fn cells_of_a_file_go_side_by_side_as_they_do_alone() {
    let Some(folder) = shared_data("cell-models") else { return };
    let method = SolverSettings { tolerance: 1e-4, ..SolverSettings::of(CellMethod::Stiff) };
    let settings = BatchSettings { method, sample_interval_ms: Some(5.0) };
    for file in ["mmt/paci-2020.mmt", "cellml/shannon_wang_puglisi_weber_bers_2004.cellml"] {
        let model: Arc<dyn CellModel> = Arc::new(model(&folder.join(file)));
        let protocol = Protocol::once(model.default_stimulus());
        let rows = model.parameters().rows().to_vec();
        let cells: Vec<Paced> = (0..10)
            .map(|k| {
                let mut parameters = model.parameters().clone();
                let row = &rows[7 * k % rows.len()];
                parameters.set(&row.name, 1.01 * row.value).unwrap();
                let model = model.with_parameters(parameters).unwrap();
                Paced::new(model, protocol, 400.0).unwrap()
            })
            .collect();
        let together = batch::run(&cells, &settings).unwrap();
        for (cell, expected) in cells.iter().zip(&together) {
            let outcome = expected.as_ref().unwrap();
            let own = batch::run(std::slice::from_ref(cell), &settings).unwrap().remove(0);
            assert_eq!(own.as_ref(), Ok(outcome));
            let trace = solve(&**cell.model(), protocol, method, 400.0, 5.0).unwrap();
            for (k, sample) in outcome.samples.iter().enumerate() {
                let state: Vec<f64> = trace.states.iter().map(|column| column[k]).collect();
                let alone = model.potential(&state).unwrap();
                let range = if alone.abs() > 1.0 { 100.0 } else { 0.1 };
                // Other roundings, grown through an upstroke.
                assert!((sample.potential.unwrap() - alone).abs() < 1e-6 * range, "{file} {k}");
            }
        }
    }
}

#[allow(clippy::unwrap_used)]
/// The upstrokes of a model over 10 s, with stimuli each `cycle_ms`, or none.
fn beaten(model: &EquationModel, cycle_ms: Option<f64>) -> Option<(Upstrokes, usize)> {
    let protocol = Protocol {
        start_ms: if cycle_ms.is_some() { 100.0 } else { 1e6 },
        cycle_length_ms: cycle_ms.unwrap_or(1000.0),
        beats: cycle_ms.map_or(1, |cycle_ms| (9800.0 / cycle_ms) as u32),
        ..Protocol::once(model.default_stimulus())
    };
    let trace = solve(model, protocol, model.usual_settings(), 10_000.0, 0.5).unwrap();
    let stimuli: Vec<f64> = protocol.stimulus_times().take_while(|time| *time < 1e4).collect();
    let potential: Vec<f64> = (0..trace.time_ms.len())
        .filter_map(|k| {
            let state: Vec<f64> = trace.states.iter().map(|column| column[k]).collect();
            model.membrane_potential_mv(&state)
        })
        .collect();
    let found = Upstrokes::of(&trace.time_ms, &potential, "mV", &stimuli)?;
    Some((found, stimuli.len()))
}

#[test]
fn stem_cell_and_purkinje_models_beat_by_themselves_and_follow_faster_pacing() {
    let Some(folder) = shared_data("cell-models") else { return };
    // Cycle lengths: Paci et al. 2020 about 1.2 to 1.8 s, Kernik et al. 2019 about 1 s, Stewart et
    // al. 2009 about 1.2 s, with which the published ones agree.
    for (file, cycle) in [
        ("paci-2020.mmt", 1000.0..2000.0),
        ("kernik-2019.mmt", 700.0..1300.0),
        ("stewart-2009.mmt", 900.0..1600.0),
    ] {
        let model = model(&folder.join("mmt").join(file));
        let (upstrokes, none) = beaten(&model, None).unwrap();
        let own = upstrokes.rhythm("mV", none);
        println!("{file}: {own:?}");
        let length_ms = own.cycle_length_ms.unwrap();
        assert!(cycle.contains(&length_ms), "{file}: {own:?}");
        assert!(own.maximum_diastolic_potential.unwrap() < -60.0, "{file}: {own:?}");
        // Below its own rate it also beats between the stimuli.
        let (upstrokes, stimuli) = beaten(&model, Some(1.7 * length_ms)).unwrap();
        let slow = upstrokes.rhythm("mV", stimuli);
        assert!(slow.action_potentials > slow.raised_by_stimuli, "{file}: {slow:?}");
        // Above it, the stimuli capture: at most the first beats come by themselves.
        let fast = beaten(&model, Some(0.8 * length_ms));
        let alone = fast.map_or(0, |(upstrokes, stimuli)| {
            let fast = upstrokes.rhythm("mV", stimuli);
            println!("{file}: {fast:?}");
            fast.action_potentials - fast.raised_by_stimuli
        });
        assert!(alone <= 2, "{file}: {alone}");
    }
}
