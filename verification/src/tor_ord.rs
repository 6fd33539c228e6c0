//! ToR-ORd, alone against Myokit's CVODE on the published files of `CellML`, and with Land's myofilaments against a
//! program that was typed independently.

use crate::check::{Failure, Setting};
use crate::row::Row;
use myospring::cell;
use myospring::cell::Input;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings, solve};

const MYOKIT: &str = "Myokit 1.39.2 (CVODE, 1e-7) on the published CellML, 100 beats";
const PEER: &str = "NumPy and SciPy (LSODA, 1e-7), an independent implementation";
const EACH_MS: f64 = 0.25;

/// Rates at the start, action potential, calcium and tension of beats.
///
/// # Errors
/// A model that is not in the list, or cannot be followed.
pub fn rows(_setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = rates()?;
    // Duration at 90 % from the stimulus, least and largest calcium, nM.
    for (name, apd90, calcium) in [
        ("tor_ord_dyn_cl_endo", 273.191, [74.531, 384.848]),
        ("tor_ord_endo", 272.225, [74.521, 385.277]),
    ] {
        let found = beat(name, 100)?;
        rows.push(Row::about(
            format!("{name}, 1 Hz: action potential duration"),
            MYOKIT,
            found.apd90_ms,
            apd90,
            0.3,
            "ms",
            "sampling, and the change from beat to beat that remains",
        ));
        for (what, found, expected) in
            [("least", found.calcium[0], calcium[0]), ("largest", found.calcium[1], calcium[1])]
        {
            rows.push(Row::about(
                format!("{name}, 1 Hz: {what} calcium"),
                MYOKIT,
                found,
                expected,
                5e-3 * expected,
                "nM",
                "half a per cent",
            ));
        }
    }
    for (name, apd90, largest, tension) in [
        ("tor_ord_land", 271.7, 475.0, 24.0),
        ("tor_ord_land_epi", 239.9, 707.0, 42.5),
        ("tor_ord_land_mid", 343.4, 937.0, 61.9),
    ] {
        let found = beat(name, 20)?;
        let about = |what: &str, found, expected, tolerance, unit, reason: &str| {
            Row::about(format!("{name}: {what}"), PEER, found, expected, tolerance, unit, reason)
        };
        // That program counts from the steepest rise, as the stimulus ends.
        let reason = "the last digit, and the sampling of both";
        rows.push(about("duration at 90 %", found.apd90_ms - 0.9, apd90, 0.3, "ms", reason));
        rows.push(about(
            "largest calcium",
            found.calcium[1],
            largest,
            5e-3 * largest,
            "nM",
            reason,
        ));
        rows.push(about("isometric tension", found.tension, tension, 0.06, "kPa", reason));
    }
    Ok(rows)
}

fn rates() -> Result<Vec<Row>, Failure> {
    let model = cell::model("tor_ord_land")?;
    let state = model.initial_state();
    let mut rates = vec![f64::NAN; state.len()];
    model.derivatives(&state, &Input { stimulus: 53.0, ..Input::REST }, &mut rates);
    let names = model.state_names();
    [("v", 53.000_040_8), ("Ca_cyt", 3.119_567_977e-9), ("Ca_nsr", -2.547_044_888e-5)]
        .into_iter()
        .map(|(name, expected)| {
            let place = names.iter().position(|known| *known == name).ok_or("no such state")?;
            Ok(Row::difference(
                format!("tor_ord_land: rate of {name} at the published start, stimulated"),
                PEER,
                (rates[place] / expected - 1.0).abs(),
                1e-9,
                "",
                "the digits of the other program",
            ))
        })
        .collect()
}

struct Beat {
    /// From the stimulus.
    apd90_ms: f64,
    /// Least and largest, nM.
    calcium: [f64; 2],
    /// Largest, kPa.
    tension: f64,
}

/// The last of some beats at 1 Hz and resting length.
fn beat(name: &str, beats: u32) -> Result<Beat, Failure> {
    let model = cell::model(name)?;
    let stimulus = model.default_stimulus();
    let protocol = Protocol { start_ms: 0.0, beats, ..Protocol::once(stimulus) };
    let settings = SolverSettings { tolerance: 1e-4, ..SolverSettings::of(CellMethod::Stiff) };
    let trace = solve(&*model, protocol, settings, 1000.0 * f64::from(beats), EACH_MS)?;
    let from = trace.time_ms.len() - 1 - (1000.0 / EACH_MS) as usize;
    let last = |name: &str| trace.variable(name).map(|course| &course[from..]);
    let (v, calcium) = (last("v").ok_or("no v")?, last("Ca_cyt").ok_or("no Ca_cyt")?);
    let most = |course: &[f64]| course.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let level = most(v) - 0.9 * (most(v) - v[0]);
    let top = v.iter().position(|value| *value == most(v)).ok_or("no peak")?;
    let fall = (top..v.len() - 1).find(|&k| v[k + 1] < level).ok_or("it stays up")?;
    let part = (v[fall] - level) / (v[fall] - v[fall + 1]);
    Ok(Beat {
        apd90_ms: EACH_MS * (fall as f64 + part),
        calcium: [1e6 * calcium.iter().copied().fold(f64::MAX, f64::min), 1e6 * most(calcium)],
        tension: most(&trace.tension[from..]),
    })
}
