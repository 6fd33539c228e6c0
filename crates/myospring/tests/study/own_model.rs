//! A cell model that the library does not know, of ten states with calcium: it runs, in a batch, in studies and in fits
//! as those of the list do.

#[path = "../common/own_cell.rs"]
mod own_cell;

use myospring::analysis::beats::Beats;
use myospring::cell::CellModel;
use myospring::cell::batch::{self, BatchSettings, Paced};
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{self, CellMethod};
use myospring::fit::{FitSettings, Fitter, Observed, Scale, Stimuli, Unknown};
use myospring::recording::CALCIUM;
use myospring::run_file::RunFile;
use myospring::settings::{Models, Run};
use myospring::study::cells::{self, PacedCell};
use myospring::study::parameters::{Answer, Common, ParameterStudy, Shard, run};
use myospring::study::{Journal, Threads};
use std::sync::Arc;

/// With a tension in kPa, and with a relative one.
fn models() -> [Arc<dyn CellModel>; 2] {
    let own = own_cell::mild();
    let whole = solve::reference_beat(&own, solve::SolverSettings::default()).unwrap().peak_tension;
    let strongest = own.parameters().get("T_max").unwrap();
    [Arc::new(own.clone()), Arc::new(own.relative(whole / strongest))]
}

fn file(model: &Arc<dyn CellModel>, text: &str) -> RunFile {
    let all = format!(
        "[cell]\nmodel = \"{}\"\nintegrator = \"stiff\"\n[shape]\nspacing = \"6 um\"\n\
         [numerics]\nintegrator = \"quasi-static\"\n{text}",
        model.name()
    );
    RunFile::from_text(&all).unwrap().knowing(Models::new(&[Arc::clone(model)]))
}

fn none(_: &str) -> std::io::Result<Vec<u8>> {
    Err(std::io::ErrorKind::NotFound.into())
}

/// The beats of a run, and what it recorded of calcium.
fn beaten(run: &Run) -> (Beats, Vec<f64>) {
    let shaped = run.shape.mesh(&run.shape.bytes(none).unwrap()).unwrap();
    let outcome = run.make(shaped, none).unwrap().simulation.build().unwrap().run(|_| true);
    assert_eq!(outcome.stop, None);
    let signals = &outcome.recording.signals;
    let calcium = signals.iter().find(|signal| signal.name == CALCIUM).unwrap();
    (outcome.beats(), calcium.values.clone())
}

#[test]
fn a_run_file_names_it_and_the_cell_beats_with_its_tension_and_calcium() {
    for model in models() {
        let run = file(&model, "").resolve().unwrap();
        let (beats, calcium) = beaten(&run);
        let reference = solve::reference_beat(&*model, solve::SolverSettings::default()).unwrap();
        let scale =
            model.tension_kind().published_peak().map_or(1.0, |peak| run.peak_tension / peak);
        let peak = beats[0].value("peak_tension").unwrap();
        // Samples each 0.5 ms miss a flat peak by less.
        assert!((peak / (scale * reference.peak_tension) - 1.0).abs() < 1e-4, "{peak} kPa");
        assert!(beats[0].value("peak_shortening").unwrap() > 5.0);
        assert!(calcium.iter().copied().fold(0.0, f64::max) > 2.0 * calcium[0]);
        let error =
            RunFile::from_text(&file(&model, "").to_toml()).unwrap().resolve().err().unwrap();
        assert!(error.to_string().contains("no cell model is named `own_1`"), "{error}");
    }
}

#[test]
fn in_a_batch_and_a_study_of_cells_it_has_the_bits_that_it_has_alone() {
    let [model, relative] = models();
    let protocol =
        Protocol { beats: 2, cycle_length_ms: 500.0, ..Protocol::once(model.default_stimulus()) };
    let method =
        solve::SolverSettings { tolerance: 1e-6, ..solve::SolverSettings::of(CellMethod::Stiff) };
    let settings = BatchSettings { method, sample_interval_ms: Some(0.1) };
    let paced =
        |model: &Arc<dyn CellModel>| Paced::new(Arc::clone(model), protocol, 1100.0).unwrap();
    // Among cells that go side by side, and some of its own kind.
    let other = myospring::cell::model("tor_ord_endo").unwrap();
    let company = [paced(&model), paced(&other), paced(&relative), paced(&model)];
    let outcomes = batch::run(&company, &settings).unwrap();
    let alone = solve::solve(&*model, protocol, method, 1100.0, 0.1).unwrap();
    let own = outcomes[0].as_ref().unwrap();
    assert_eq!(own.samples.len(), alone.time_ms.len());
    let calcium = alone.variable("Ca_1").unwrap();
    for (k, sample) in own.samples.iter().enumerate() {
        assert_eq!(
            (sample.potential, sample.tension),
            (Some(alone.potential[k]), alone.tension[k])
        );
        assert_eq!(sample.calcium_um, Some(calcium[k]));
    }
    assert_eq!(outcomes[3].as_ref().unwrap(), own);

    let cell = PacedCell { name: "own".to_owned(), model, protocol, duration_ms: 1100.0 };
    let threads = Threads::new(None).unwrap();
    let report = cells::run(&[cell], method, &Journal::in_memory(), &threads, &()).unwrap();
    let beats: Vec<_> = report.rows.iter().map(|row| row.beat.unwrap()).collect();
    assert_eq!(beats, own.beats);
    assert_eq!(beats.len(), 2);
    // One beat by the metrics of runs.
    let apd = beats[0].apd90_ms.unwrap();
    let run = file(&relative, "").resolve().unwrap();
    let of_run = beaten(&run).0[0].value("action_potential_duration_90").unwrap();
    assert!((apd - of_run).abs() < 0.1, "{apd} and {of_run} ms");
}

#[test]
fn studies_vary_its_parameters_with_a_mesh_and_without() {
    let [model, _] = models();
    for kind in ["cell", "beat"] {
        let text = format!(
            "kind = \"{kind}\"\nmetrics = [\"peak_tension\", \"action_potential_duration_90\"]\n\
             [run.cell]\nmodel = \"own_1\"\nintegrator = \"stiff\"\n[run.shape]\nspacing = \"6 um\"\n\
             [parameters]\nT_max = {{ distribution = \"uniform\", low = 0.5, high = 2.0, relative = true }}\n\
             [sampling]\nsampler = \"latin-hypercube\"\nsize = 3\n"
        );
        let own = Models::new(&[Arc::clone(&model)]);
        let study = ParameterStudy::from_toml_knowing(&text, own, none).unwrap();
        let common = Common::new(&study, none).unwrap();
        let (whole, journal) = (Shard::WHOLE, Journal::in_memory());
        let threads = Threads::new(None).unwrap();
        let rows = run(&study, &common, whole, &journal, &threads, &()).unwrap().rows;
        let answer = Answer::new(&study, &common.units, rows);
        assert_eq!(common.usual[1].map(|apd| apd > 100.0), Some(true), "{kind}");
        for row in answer.rows().iter() {
            // Its tension is in proportion to T_max, and its membrane does not know of it.
            let factor = study.members(whole)[row.member - 1].values[0] / 60.0;
            let peak = row.metric(0).unwrap() / common.usual[0].unwrap();
            assert!((peak / factor - 1.0).abs() < 1e-9, "{kind}: {peak} and {factor}");
            assert_eq!(row.metric(1), common.usual[1], "{kind}");
        }
    }
}

#[test]
fn a_fit_finds_the_numbers_of_its_curve() {
    for model in models() {
        let run = file(&model, "").resolve().unwrap();
        let fitter = Fitter::of(&run, none).unwrap();
        let times_ms: Vec<f64> = (0..100).map(|frame| 6.0 * f64::from(frame)).collect();
        let truth = [("tension_over_stiffness", 0.8), ("g_s", 1.1)];
        let values = fitter.curve(&truth, 100.0, &times_ms).unwrap();
        let observed = Observed {
            name: "own".into(),
            times_ms,
            values,
            scale: Scale::Length,
            unit: "um".into(),
            stimuli: Stimuli::Given(vec![50.0]),
        };
        let usual = FitSettings::usual(&*model);
        assert_eq!(usual, [Unknown::TensionOverStiffness, Unknown::Parameter("g_s".to_owned())]);
        let settings = FitSettings { starts: 1, ..FitSettings::default() };
        let fit = fitter.fit(&[observed], &settings, &|_| true).unwrap().unwrap();
        let usual = [fitter.tension_over_stiffness(), model.parameters().get("g_s").unwrap()];
        for ((name, factor), usual) in truth.into_iter().zip(usual) {
            let found = fit.estimate(name).unwrap().value / usual;
            assert!((found / factor - 1.0).abs() < 1e-3, "{name}: {found} and {factor}");
        }
    }
}
