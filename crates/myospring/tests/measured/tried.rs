//! Which cell model is taken where none is asked for.

use myospring::analysis::monotone::MonotoneCubic;
use myospring::experiment::fit::{FitCell, FittedCell, words};
use myospring::experiment::{Experiment, Files};
use myospring::fit::{Fit, FitVerdict, Fitter};
use myospring::run_file::RunFile;
use myospring::settings::find;
use myospring::study::sampling::{Distribution, Sampler, sample};
use std::fmt::Write as _;

/// Frames per second of the made-up curves, and their length, ms.
const RATE: f64 = 100.0;
const LAST: f64 = 1000.0;

fn times() -> Vec<f64> {
    (0..(LAST * RATE / 1e3) as usize).map(|frame| frame as f64 * 1e3 / RATE).collect()
}

/// The length of a cell of 140 um with a model, stimulated at 50 ms.
fn length(model: &str, times: &[f64]) -> Vec<f64> {
    let text = format!("[cell]\nmodel = \"{model}\"\n[shape]\nspacing = \"5 um\"");
    let run = RunFile::from_text(&text).unwrap().resolve().unwrap();
    Fitter::of(&run, |path| std::fs::read(path)).unwrap().curve(&[], 140.0, times).unwrap()
}

/// A cell that contracts over 500 ms and relaxes within 150, as those from stem cells do.
fn slow_rise(times: &[f64]) -> Vec<f64> {
    let knots = [0.0, 50.0, 150.0, 300.0, 550.0, 600.0, 650.0, 720.0, 1000.0];
    let parts = [0.0, 0.0, 0.25, 0.6, 1.0, 0.9, 0.5, 0.0, 0.0];
    let course = MonotoneCubic::new(knots.to_vec(), parts.to_vec());
    times.iter().map(|time| 140.0 * (1.0 - 0.05 * course.at(*time))).collect()
}

/// The fit of a curve of lengths with noise, um; `settings` are keys with values.
fn fitted(lengths: &[f64], noise: f64, settings: &[(&str, &str)]) -> Fit {
    fitted_as("length (um)", lengths, noise, settings)
}

/// The fit of a curve with noise under this header.
fn fitted_as(header: &str, values: &[f64], noise: f64, settings: &[(&str, &str)]) -> Fit {
    let times = times();
    let normal = Distribution::Normal { mean: 0.0, standard_deviation: noise };
    let drawn = sample(&Sampler::LatinHypercube { size: times.len() }, &[normal], 7).unwrap();
    let mut table = format!("time (ms),{header}\n");
    for ((time, value), draw) in times.iter().zip(values).zip(drawn.iter()) {
        writeln!(table, "{time},{}", value + draw[0]).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cell.csv");
    std::fs::write(&path, table).unwrap();
    let settings = settings.iter().chain(&[("shape.spacing", "5 um")]);
    let settings = settings.map(|(key, value)| (find(key).unwrap(), (*value).into()));
    let fit = FitCell { to: vec![path], settings: settings.collect(), ..FitCell::default() };
    let mut fits = fit.run(&Files::default(), &()).unwrap();
    let FittedCell { found, .. } = fits.cells.remove(0);
    found.unwrap()
}

#[test]
fn a_curve_of_a_model_is_followed_by_that_model_and_no_other_is_taken() {
    for model in ["coelho_2021", "land_2017"] {
        let fit = fitted(&length(model, &times()), 0.05, &[]);
        assert_eq!((fit.model.as_str(), fit.verdict), (model, FitVerdict::Fits));
        assert!(fit.tried[0].taken && fit.tried[0].model == model);
        assert_eq!(fit.tried.iter().filter(|row| row.taken).count(), 1);
        let left: Vec<_> = fit.tried.iter().filter_map(|row| row.left.as_ref()).collect();
        // Seven models are fast; the curve's own tension follows every curve, at one number a frame.
        assert_eq!(left.len(), 8);
        assert!(left.iter().any(|it| it.numbers == it.frames && it.verdict == FitVerdict::Fits));
        // Every frame that all used counts in each: chi squared of the true model is about their number.
        let scatter = 5.0 * (2.0 * left[0].frames as f64).sqrt();
        assert!((left[0].chi_squared - left[0].frames as f64).abs() < scatter, "{:?}", left[0]);
        let slow = fit.tried.iter().find(|row| row.model == "tor_ord_land").unwrap();
        assert!(slow.reason.as_ref().unwrap().contains("--model tor_ord_land"));
        assert!(words::headline(&fit).starts_with(&format!("{model} fits. Of the 7 models")));
    }
}

#[test]
fn where_no_model_follows_a_curve_its_own_tension_is_taken_and_said_to_predict_nothing() {
    let fit = fitted(&slow_rise(&times()), 0.05, &[]);
    assert!(fit.own_tension.is_some() && fit.tried[0].taken);
    let of_models = fit.tried[1..].iter().filter_map(|row| row.left.as_ref());
    assert!(of_models.clone().count() == 7);
    assert!(of_models.clone().all(|left| left.verdict == FitVerdict::DoesNotFit));
    let words = words::headline(&fit);
    assert!(
        words.starts_with(
            "No cell model here follows this curve. This is the tension that it needs"
        )
    );
    assert!(words.contains("predicts nothing beyond this recording"));
}

#[test]
fn a_curve_in_arbitrary_units_that_no_model_follows_has_the_tension_of_a_usual_peak_and_says_so() {
    let motion: Vec<f64> =
        slow_rise(&times()).iter().map(|length| 7.0 * (140.0 - length)).collect();
    let fit = fitted_as("contraction (a.u.)", &motion, 0.35, &[]);
    assert!(fit.own_tension.is_some() && fit.tried[0].taken);
    assert_eq!(fit.curves[0].unit, "%");
    let said = fit.verdicts.join("\n");
    assert!(said.contains("counts as a shortening of 10 %"), "{said}");
    // The models miss the curve by as much as they miss the same curve in um.
    let same = fitted(&slow_rise(&times()), 0.05, &[]);
    let of = |fit: &Fit, at: usize| fit.tried[at].left.as_ref().unwrap().misfit_pct;
    for at in 1..4 {
        assert!((of(&fit, at) / of(&same, at) - 1.0).abs() < 0.5, "{at}");
    }
    // In whatever unit, no more than the noise.
    for fit in [&fit, &same] {
        let left = fit.tried[0].left.as_ref().unwrap();
        assert!(left.chi_squared < left.frames as f64, "{left:?}");
    }
}

#[test]
fn a_noisy_curve_names_the_models_that_it_does_not_tell_apart() {
    // Noise of a sixth of the contraction.
    let fit = fitted(&length("coelho_2021", &times()), 2.5, &[]);
    assert!(fit.own_tension.is_none() && fit.verdict == FitVerdict::Fits);
    let as_good = fit.tried.iter().filter(|row| row.left.as_ref().is_some_and(|it| it.as_good));
    let names: Vec<&str> = as_good.map(|row| row.model.as_str()).collect();
    assert!(!names.is_empty());
    let verdict = &fit.verdicts[0];
    assert!(verdict.contains("does not tell") && names.iter().all(|name| verdict.contains(name)));
    // In a clear curve there are none.
    let clear = fitted(&length("coelho_2021", &times()), 0.05, &[]);
    assert!(!clear.verdicts.iter().any(|verdict| verdict.contains("does not tell")));
}

#[test]
fn a_model_that_is_asked_for_is_the_only_one_and_settings_leave_out_those_that_they_do_not_suit() {
    let curve = length("coelho_2021", &times());
    let asked = fitted(&curve, 0.05, &[("cell.model", "land_2017")]);
    assert!(asked.model == "land_2017" && asked.tried.is_empty());
    // A tension in kPa is not scaled by a peak.
    let relative = fitted(&curve, 0.05, &[("cell.peak_tension", "40 kPa")]);
    assert_eq!(relative.model, "coelho_2021");
    let refused = relative.tried.iter().find(|row| row.model == "land_2017").unwrap();
    assert!(refused.left.is_none());
    assert!(refused.reason.as_ref().unwrap().contains("in kPa"), "{refused:?}");
}
