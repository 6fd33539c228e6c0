//! Fits of cells whose calcium was recorded together with their length.

use myospring::cell::calcium::CalciumTrace;
use myospring::experiment::fit::{FitCell, Fits, RecordedCalcium};
use myospring::experiment::{Experiment, ExperimentError, Files};
use myospring::fit::{FitVerdict, Fitter};
use myospring::run_file::RunFile;
use myospring::settings::find;
use myospring::simulation::Simulation;
use myospring::study::sampling::{Distribution, Sampler, sample};
use std::fmt::Write as _;
use std::path::Path;

/// Frames per second, length of a recording, and first beats, ms.
const RATE: f64 = 100.0;
const LAST: f64 = 2600.0;
const BEATS: [f64; 3] = [250.0, 1000.0, 1750.0];
/// Factors on the published `k_ws`, and on tension over stiffness.
const TRUTH: [(&str, f64); 2] = [("k_ws", 0.8), ("tension_over_stiffness", 1.2)];

/// Calcium, uM: slower than that of the model, and lower in the second beat.
fn calcium(t: f64) -> f64 {
    let of = |s: f64| if s > 0.0 { (-s / 190.0).exp() - (-s / 45.0).exp() } else { 0.0 };
    let heights = [0.95, 0.8, 0.95];
    0.09 + BEATS.iter().zip(heights).map(|(beat, height)| height * of(t - beat)).sum::<f64>()
}

fn fitter(model: &str) -> Fitter {
    let text = format!("[cell]\nmodel = \"{model}\"\n[shape]\nspacing = \"5 um\"");
    let run = RunFile::from_text(&text).unwrap().resolve().unwrap();
    Fitter::of(&run, |path| std::fs::read(path)).unwrap()
}

/// Tables `both.csv`, `length.csv`, `ratio.csv` and `later.csv` (another hour) of a cell of 110 um; noise is 1 % of a beat.
fn recorded(folder: &Path) {
    let fine: Vec<f64> = (0..3000).map(f64::from).collect();
    let values: Vec<f64> = fine.iter().map(|time| calcium(*time)).collect();
    let trace = CalciumTrace::new(&fine, &values).unwrap();
    let usual = fitter("land_2017");
    let cell = usual.simulation().cell.with_calcium(&trace).unwrap();
    let truth = Fitter::new(Simulation { cell, ..usual.simulation().clone() }).unwrap();
    let times: Vec<f64> =
        (0..(LAST * RATE / 1e3) as usize).map(|frame| frame as f64 * 1e3 / RATE).collect();
    // The run stimulates at 50 ms.
    let on_clock: Vec<f64> = times.iter().map(|time| 50.0 + time).collect();
    let length = truth.curve(&TRUTH, 110.0, &on_clock).unwrap();
    let normal = Distribution::Normal { mean: 0.0, standard_deviation: 0.01 };
    let draws = sample(&Sampler::LatinHypercube { size: 2 * times.len() }, &[normal], 7).unwrap();
    let draws: Vec<f64> = draws.iter().map(|draw| draw[0]).collect();
    let height = 110.0 - length.iter().copied().fold(f64::INFINITY, f64::min);
    let mut tables = [
        "time (ms),Ca (uM),length (um)\n",
        "time (ms),length (um)\n",
        "time (ms),ratio\n",
        "time (ms),Ca (uM)\n",
    ]
    .map(str::to_owned);
    for (at, (time, length)) in times.iter().zip(&length).enumerate() {
        let um = length + height * draws[2 * at];
        let ca = calcium(*time) + 0.45 * draws[2 * at + 1];
        writeln!(tables[0], "{time},{ca:.5},{um:.5}").unwrap();
        writeln!(tables[1], "{time},{um:.5}").unwrap();
        writeln!(tables[2], "{time},{:.5}", 0.7 + 2.0 * ca).unwrap();
        writeln!(tables[3], "{},{ca:.5}", time + 3.6e6).unwrap();
    }
    let names = ["both.csv", "length.csv", "ratio.csv", "later.csv"];
    for (name, table) in names.into_iter().zip(tables) {
        std::fs::write(folder.join(name), table).unwrap();
    }
}

fn fitted(
    folder: &Path,
    table: &str,
    model: Option<&str>,
    calcium: RecordedCalcium,
) -> Result<Fits, ExperimentError> {
    let set = |key: &str, value: &str| (find(key).unwrap(), value.into());
    let mut settings = vec![set("shape.spacing", "5 um")];
    settings.extend(model.map(|model| set("cell.model", model)));
    let fit = FitCell { to: vec![folder.join(table)], settings, calcium, ..FitCell::default() };
    fit.run(&Files::default(), &())
}

/// How far the numbers of a fit are from the truth, as parts of it.
fn off(fits: &Fits) -> [f64; 2] {
    let usual = fitter("land_2017");
    let (_, fit) = fits.fitted().next().unwrap();
    let k_ws = usual.simulation().cell.parameters().get("k_ws").unwrap();
    let usual = [k_ws, usual.tension_over_stiffness()];
    [0, 1].map(|at| {
        let (name, factor) = TRUTH[at];
        fit.estimate(name).unwrap().value / (factor * usual[at]) - 1.0
    })
}

#[test]
fn calcium_of_the_same_beats_drives_the_model_and_its_parameters_come_out() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path());
    let fits =
        fitted(folder.path(), "both.csv", Some("land_2017"), RecordedCalcium::default()).unwrap();
    let (_, fit) = fits.fitted().next().unwrap();
    assert_eq!(fit.model, "land_2017, measured calcium");
    assert_ne!(fit.verdict, FitVerdict::DoesNotFit, "{:?}", fit.verdicts);
    // The clock of calcium is that of the curve: no delay is sought.
    assert!(fit.estimates.iter().all(|it| !it.name.contains("delay")), "{:?}", fit.estimates);
    // Calcium with noise of 1 % is smoothed over some 40 ms.
    assert!(off(&fits).iter().all(|off| off.abs() < 0.06), "{:?}", off(&fits));
    let (run, _) = fits.fitted_run(fit).unwrap();
    assert_eq!(run.calcium.as_deref(), Some("calcium.csv"));

    // A ratio in another file, with its scale: calcium before, and at the peak of, the mean beat.
    let mean = |of: &dyn Fn(f64) -> f64| BEATS.iter().map(|beat| of(*beat)).sum::<f64>() / 3.0;
    let rest = Some(mean(&calcium));
    let peak = Some(mean(&|beat| calcium(beat + 85.0)));
    let path = Some(folder.path().join("ratio.csv"));
    let scaled = RecordedCalcium { path, rest_um: rest, peak_um: peak };
    let fits = fitted(folder.path(), "length.csv", Some("land_2017"), scaled).unwrap();
    assert!(fits.notes.iter().any(|note| note.contains("the scale is not fitted")));
    assert!(off(&fits).iter().all(|off| off.abs() < 0.15), "{:?}", off(&fits));
}

#[test]
fn without_a_model_the_one_that_recorded_calcium_drives_is_tried_and_taken() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path());
    let fits = fitted(folder.path(), "both.csv", None, RecordedCalcium::default()).unwrap();
    let (_, fit) = fits.fitted().next().unwrap();
    assert_eq!(fit.model, "land_2017, measured calcium", "{:?}", fit.tried);
    let tried: Vec<&str> = fit.tried.iter().map(|row| row.model.as_str()).collect();
    assert!(tried.contains(&"land_2017") && tried.contains(&"given_tension"), "{tried:?}");
}

#[test]
fn calcium_of_other_times_or_without_a_scale_is_refused_where_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path());
    let asked = |name: &str| {
        let path = Some(folder.path().join(name));
        let calcium = RecordedCalcium { path, ..RecordedCalcium::default() };
        let fits = fitted(folder.path(), "length.csv", Some("land_2017"), calcium);
        fits.err().unwrap().to_string()
    };
    let error = asked("later.csv");
    assert!(error.contains("were not recorded together: the times do not overlap"), "{error}");
    let error = asked("ratio.csv");
    assert!(error.contains("not both ends of its scale are given"), "{error}");
    let error = asked("length.csv");
    assert!(error.contains("has no column of calcium"), "{error}");
}
