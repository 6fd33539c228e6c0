//! The paper's cell against the authors' step, the converged solution and each definition behind.
//!
//! # How the acceptance numbers are defined
//! Found by reproducing their digits:
//! - the stimulus falls before the step that ends at 50 ms, that is at 49.95 ms, in both columns;
//! - V is u over the highest u of the same run (1.135211 and 1.13407);
//! - all times lie on a grid of 0.05 ms: rises and falls of tension are the first sample past the
//!   level, the end of an action potential is the last sample at or above the level, counted from
//!   50 ms; levels are fractions of the peak, not of peak minus rest;
//! - V at a time is the last sample whose time, summed up step by step, is not after it: at 300 ms
//!   the sum exceeds 300 by rounding, so it is the sample before;
//! - the authors' step updates u, v, w, s, then `Ta_i` from the new u, then Ta from the new `Ta_i`;
//! - the converged column is forward Euler with 0.0005 ms for u, v, w, s, sampled every 0.05 ms, and
//!   tension from these samples by the authors' step, so its tension times are 0.05 ms early.

mod common;

use common::{falls_through, rises_through};
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{Method, Settings, solve};
use myospring::cell::trace::CellTrace;
use myospring::cell::{CellModel, coelho_2021, minimal::MinimalModel};

const SAMPLE_MS: f64 = 0.05;

/// The table's rows, as printed.
struct Column {
    u_max: (&'static str, &'static str),
    apd_90_50_30: [&'static str; 3],
    v: [&'static str; 7],
    ta_i_max: &'static str,
    ta_i_crosses_x_3: &'static str,
    ta_max: (&'static str, &'static str),
    ta_rises_10_50: [&'static str; 2],
    ta_falls_50_10: [&'static str; 2],
}

const AUTHORS: Column = Column {
    u_max: ("1.13521", "51.90"),
    apd_90_50_30: ["273.75", "245.00", "201.05"],
    v: ["0.879", "0.824", "0.929", "0.883", "0.809", "0.703", "0.458"],
    ta_i_max: "1.3627",
    ta_i_crosses_x_3: "75.85",
    ta_max: ("0.8692", "171.75"),
    ta_rises_10_50: ["89.0", "116.2"],
    ta_falls_50_10: ["273.6", "406.7"],
};

const CONVERGED: Column = Column {
    u_max: ("1.13407", "51.95"),
    apd_90_50_30: ["273.60", "244.95", "201.20"],
    v: ["0.883", "0.826", "0.930", "0.884", "0.810", "0.703", "0.457"],
    ta_i_max: "1.4058",
    ta_i_crosses_x_3: "54.05",
    ta_max: ("0.9021", "171.45"),
    ta_rises_10_50: ["86.8", "115.5"],
    ta_falls_50_10: ["273.2", "406.5"],
};

const V_TIMES: [f64; 7] = [55.0, 60.0, 100.0, 150.0, 200.0, 250.0, 300.0];

fn first(values: &[f64], from: usize, test: impl Fn(f64) -> bool) -> usize {
    from + values[from..].iter().position(|value| test(*value)).unwrap()
}

fn highest(values: &[f64]) -> usize {
    (0..values.len()).reduce(|best, i| if values[i] > values[best] { i } else { best }).unwrap()
}

/// Compares samples every 0.05 ms with a column, digit by digit.
fn compare(column: &Column, u: &[f64], ta_i: &[f64], ta: &[f64]) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut expect = |what: &str, printed: &str, value: String| {
        if printed != value {
            wrong.push(format!("{what}: {value} instead of {printed}"));
        }
    };
    let time = |index: usize| index as f64 * SAMPLE_MS;
    let top = highest(u);
    expect("u max", column.u_max.0, format!("{:.5}", u[top]));
    expect("u max at", column.u_max.1, format!("{:.2}", time(top)));
    for (printed, level) in column.apd_90_50_30.iter().zip([0.1, 0.5, 0.7]) {
        let end = first(u, top, |value| value < level * u[top]) - 1;
        expect("APD", printed, format!("{:.2}", time(end) - 50.0));
    }
    let mut summed = vec![0.0];
    while summed.len() < u.len() {
        summed.push(summed[summed.len() - 1] + SAMPLE_MS);
    }
    for (printed, at) in column.v.iter().zip(V_TIMES) {
        let index = first(&summed, 0, |time| time > at) - 1;
        expect(&format!("V at {at} ms"), printed, format!("{:.3}", u[index] / u[top]));
    }
    expect("Ta_i max", column.ta_i_max, format!("{:.4}", ta_i[highest(ta_i)]));
    let crossing = first(ta_i, 0, |value| value >= 0.2925);
    expect("Ta_i crosses x_3", column.ta_i_crosses_x_3, format!("{:.2}", time(crossing)));
    let peak = highest(ta);
    expect("Ta max", column.ta_max.0, format!("{:.4}", ta[peak]));
    expect("Ta max at", column.ta_max.1, format!("{:.2}", time(peak)));
    for (printed, level) in column.ta_rises_10_50.iter().zip([0.1, 0.5]) {
        let index = first(ta, 0, |value| value >= level * ta[peak]);
        expect("Ta rises", printed, format!("{:.1}", time(index)));
    }
    for (printed, level) in column.ta_falls_50_10.iter().zip([0.5, 0.1]) {
        let index = first(ta, peak, |value| value < level * ta[peak]);
        expect("Ta falls", printed, format!("{:.1}", time(index)));
    }
    wrong
}

fn run(model: &MinimalModel, protocol: Protocol, settings: Settings) -> CellTrace {
    solve(model, protocol, settings, 600.0, SAMPLE_MS).unwrap()
}

fn with_peak(u_peak: f64) -> MinimalModel {
    let mut parameters = coelho_2021::parameters();
    parameters.set("u_peak", u_peak).unwrap();
    MinimalModel::new(coelho_2021::IDENTITY, parameters).unwrap()
}

#[test]
fn the_authors_step_gives_the_authors_numbers_to_the_printed_digit() {
    let model = coelho_2021::authors_model();
    let trace = run(&model, coelho_2021::authors_protocol(), coelho_2021::authors_step());
    let ta_i = trace.variable("Ta_i").unwrap();
    let wrong = compare(&AUTHORS, &trace.potential, ta_i, &trace.tension);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_authors_model_is_normalised_by_the_peak_of_its_own_run() {
    let model = coelho_2021::authors_model();
    let trace = run(&model, coelho_2021::authors_protocol(), coelho_2021::authors_step());
    let peak = trace.potential[highest(&trace.potential)];
    assert_eq!(format!("{peak:.6}"), model.parameters().get("u_peak").unwrap().to_string());
}

/// The converged column as it was made: see the head of this file.
#[test]
fn the_converged_column_comes_out_to_the_printed_digit_by_its_own_definition() {
    let fine = Settings { method: Method::ForwardEuler, step_ms: 0.0005 };
    let u = run(&coelho_2021::model(), coelho_2021::authors_protocol(), fine).potential;
    let model = with_peak(u[highest(&u)]);
    let (mut ta_i, mut ta) = (vec![0.0], vec![0.0]);
    for i in 1..u.len() {
        let tension = model.tension_constants();
        let next_i = ta_i[i - 1] + SAMPLE_MS * tension.rates(u[i], ta_i[i - 1], ta[i - 1])[0];
        let next = ta[i - 1] + SAMPLE_MS * tension.rates(u[i], next_i, ta[i - 1])[1];
        ta_i.push(next_i);
        ta.push(next);
    }
    let wrong = compare(&CONVERGED, &u, &ta_i, &ta);
    assert!(wrong.is_empty(), "{wrong:#?}");
}
