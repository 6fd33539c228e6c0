//! Measured curves: real files of other programs.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests")]

#[path = "../common/mod.rs"]
mod common;
mod film_shapes;
mod fit;
#[path = "../common/known_tension.rs"]
mod known_tension;
mod numbers;
mod own_runs;
mod own_tension;
#[path = "../common/pulled_film.rs"]
mod pulled_film;
mod recorded_calcium;
#[path = "../common/synthetic_cell.rs"]
mod synthetic_cell;
#[path = "../common/synthetic_film.rs"]
mod synthetic_film;
mod tension_map;
mod tried;
#[path = "../common/workbook_bytes.rs"]
mod workbook_bytes;
mod workbooks;

use myospring::analysis::curve::{self, CurveBeat, State};
use myospring::analysis::value;
use myospring::measured::{Column, Kind, TableOptions, read};

fn at_30_per_s() -> TableOptions {
    TableOptions { frame_rate_per_s: Some(30.0), ..TableOptions::default() }
}

#[test]
fn sarc_graphs_sarcomeres_by_frames_are_read_as_they_stand() {
    let file = "curves/E1_sarcomere_norm_length_timeseries.csv";
    let Some(path) = common::shared_data(file) else { return };
    let table = read(&path, &at_30_per_s()).unwrap();
    assert_eq!(table.curves.len(), 74);
    for curve in &table.curves {
        assert_eq!((curve.kind, curve.values.len()), (Kind::NormalisedLength, 146));
        // (L - mean) / mean has a mean of 0.
        let mean = curve.values.iter().sum::<f64>() / 146.0;
        assert!((mean - 1.0).abs() < 0.02, "{}: {mean}", curve.name);
    }
    let mean = read(&path, &TableOptions { mean: true, ..at_30_per_s() }).unwrap();
    let tidy = common::shared_data("curves/sarcgraph_e1_curves.csv").unwrap();
    let values = vec![Column::of("mean_norm_sarc_len")];
    let tidy = read(&tidy, &TableOptions { values, ..at_30_per_s() }).unwrap();
    assert_eq!(tidy.curves[0].kind, Kind::NormalisedLength);
    assert_eq!(tidy.curves[0].times_ms, mean.curves[0].times_ms);
    // Six digits of the tidy file.
    for (a, b) in tidy.curves[0].values.iter().zip(&mean.curves[0].values) {
        assert!((a - b).abs() < 1e-6);
    }
}

#[test]
fn a_tidy_table_of_stretches_has_a_curve_in_each_column() {
    let Some(path) = common::shared_data("curves/sarcgraph_e1_curves.csv") else { return };
    let table = read(&path, &at_30_per_s()).unwrap();
    let names: Vec<&str> = table.curves.iter().map(|curve| &*curve.name).collect();
    assert_eq!(names, ["lambda1", "lambda2", "mean_norm_sarc_len"]);
    assert!(table.curves.iter().all(|curve| curve.kind == Kind::NormalisedLength));
    assert!((table.curves[0].frame_rate_per_s().unwrap() - 30.0).abs() < 1e-9);
}

#[test]
fn the_three_beats_of_a_real_cell_are_found_in_every_curve_of_its_authors() {
    let file = "curves/E1_sarcomere_norm_length_timeseries.csv";
    let Some(path) = common::shared_data(file) else { return };
    let mean = read(&path, &TableOptions { mean: true, ..at_30_per_s() }).unwrap();
    let tidy = common::shared_data("curves/sarcgraph_e1_curves.csv").unwrap();
    let values = vec![Column::of("lambda1")];
    let tidy = read(&tidy, &TableOptions { values, ..at_30_per_s() }).unwrap();
    for table in [mean, tidy] {
        let curve = &table.curves[0];
        let analysis = curve::analyse(
            &curve.times_ms,
            &curve.values,
            curve.kind,
            curve.unit,
            &curve::CurveOptions::default(),
        );
        let analysis = analysis.unwrap();
        let whole = |beat: &&CurveBeat| beat.state == State::Whole;
        assert_eq!(analysis.beats.iter().filter(whole).count(), 3, "{}", curve.name);
        let peaks: Vec<f64> = analysis
            .beats
            .iter()
            .map(|beat| value(&beat.metrics, "time_of_peak").unwrap())
            .collect();
        // The shortest frames of both curves, read by eye: they plateau for some 200 ms.
        for (peak, seen) in peaks.iter().zip([600.0, 2270.0, 3850.0]) {
            assert!((peak - seen).abs() < 200.0, "{}: {peaks:?}", curve.name);
        }
        let shortening = analysis.mean("peak_shortening").unwrap();
        assert!((2.0..5.0).contains(&shortening), "{}: {shortening} %", curve.name);
    }
}

/// Something passed by before the second of five beats, so its rest is too low and its area too large.
#[test]
fn the_beat_after_a_real_artefact_is_found_named_and_counts_in_no_mean() {
    let Some(path) = common::shared_data("curves/mm_ref.tsv") else { return };
    let table = read(&path, &TableOptions::default()).unwrap();
    let curve = &table.curves[0];
    let options = curve::CurveOptions::default();
    let found =
        curve::analyse(&curve.times_ms, &curve.values, curve.kind, curve.unit, &options).unwrap();
    assert!(found.treatment.rises);
    let disturbed: Vec<bool> =
        found.beats.iter().map(|beat| beat.state == State::Disturbed).collect();
    assert_eq!(disturbed, [false, true, false, false, false]);
    assert!(found.remarks.iter().any(|remark| remark.contains("beat 2")), "{:?}", found.remarks);
}
