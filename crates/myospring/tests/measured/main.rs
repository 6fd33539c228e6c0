//! Measured curves: real files of other programs.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests")]

#[path = "../common/mod.rs"]
mod common;

use myospring::measured::{Column, Kind, Options, read};

fn at_30_per_s() -> Options {
    Options { frame_rate_per_s: Some(30.0), ..Options::default() }
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
    let mean = read(&path, &Options { mean: true, ..at_30_per_s() }).unwrap();
    let tidy = common::shared_data("curves/sarcgraph_e1_curves.csv").unwrap();
    let values = vec![Column::of("mean_norm_sarc_len")];
    let tidy = read(&tidy, &Options { values, ..at_30_per_s() }).unwrap();
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
