//! Recognises impossible values: a column whose kind was stated wrongly.
//!
//! Typical values decide, the median of all frames or of the beats that count, never a single
//! frame: artefacts are listed elsewhere, and noise around zero is not negative calcium.

use super::answer::{CurveBeat, CurveError, State};
use super::noise::median;
use crate::analysis::kind::Kind;
use crate::analysis::value;

/// Range of sarcomere lengths, um, with a wide margin.
const SARCOMERES_UM: [f64; 2] = [0.5, 5.0];

/// Largest negative calcium at rest, as a part of the transient: slightly too much background may
/// have been subtracted.
const BELOW_ZERO: f64 = 0.1;

/// Largest plausible shortening, %.
const MOST_SHORTENING: f64 = 50.0;

const ABOVE_ZERO: &str = "a length is above 0";

/// Likely meaning of a column of kind length with values around zero.
const CHANGE: &str = "it seems to be a change of length, whose baseline was subtracted: add the length at rest, or measure it as a \
                      motion (--kind unknown)";

/// Rejects values that are impossible for this kind of curve.
pub(super) fn check_values(
    values: &[f64],
    kind: Kind,
    unit: &'static str,
) -> Result<(), CurveError> {
    if !kind.is_length() {
        return Ok(());
    }
    let typical = median(values.to_vec());
    let frame = 1 + values.iter().position(|value| *value == typical).unwrap_or(0);
    let refuse = |of, bound, seems| {
        Err(CurveError::Impossible { of, frame, value: typical, unit, bound, seems })
    };
    if typical <= 0.0 {
        return refuse("half of all frames are at most", ABOVE_ZERO, CHANGE);
    }
    let is_sarcomere = kind == Kind::SarcomereLength && unit == "um";
    if is_sarcomere && !(SARCOMERES_UM[0]..=SARCOMERES_UM[1]).contains(&typical) {
        return refuse(
            "the median of all frames is",
            "sarcomeres are 0.5 to 5 um long",
            "its unit seems to be another one: --unit nm, or --unit px with --pixel-size; the length of a cell is \
             --kind length",
        );
    }
    Ok(())
}

/// Rejects beats that are impossible for this kind of curve.
pub(super) fn check_beats(
    beats: &[CurveBeat],
    times: &[f64],
    kind: Kind,
    unit: &'static str,
) -> Result<(), CurveError> {
    let (name, of, bound, seems) = match kind {
        _ if kind.is_length() => {
            ("minimum_length", "half of the beats go down to or below", ABOVE_ZERO, CHANGE)
        }
        Kind::Shortening => (
            "peak_amplitude",
            "half of the beats reach or pass",
            "no cell shortens by more than 100 %",
            "its unit seems to be another one: measure it as a motion (--kind contraction --unit um)",
        ),
        Kind::Calcium | Kind::CalciumRatio => (
            "diastolic_level",
            "half of the beats rest at or below",
            "it is not below 0",
            "the level at rest seems to have been subtracted: add it, or measure it as fluorescence (--kind fluorescence)",
        ),
        _ => return Ok(()),
    };
    let counts = |beat: &&CurveBeat| matches!(beat.state, State::Whole | State::CutAtEnd);
    let all = |name| -> Vec<f64> {
        beats.iter().filter(counts).filter_map(|beat| value(&beat.metrics, name)).collect()
    };
    let values = all(name);
    if values.is_empty() {
        return Ok(());
    }
    let typical = median(values);
    let impossible = match kind {
        Kind::Shortening => typical > 100.0,
        Kind::Calcium | Kind::CalciumRatio => {
            typical < -BELOW_ZERO * median(all("transient_amplitude"))
        }
        _ => typical <= 0.0,
    };
    if !impossible {
        return Ok(());
    }
    let own = beats.iter().find(|beat| value(&beat.metrics, name) == Some(typical));
    let time = own.and_then(|beat| match kind {
        Kind::Calcium | Kind::CalciumRatio => beat.stimulus_ms.or(beat.onset_ms),
        _ => value(&beat.metrics, "time_of_peak"),
    });
    let time = time.unwrap_or(times[0]);
    let frame = 1 + times.partition_point(|other| *other < time).min(times.len() - 1);
    Err(CurveError::Impossible { of, frame, value: typical, unit, bound, seems })
}

/// Remark on beats that are possible but implausible.
pub(super) fn doubt(beats: &[CurveBeat], kind: Kind) -> Option<String> {
    let name = if kind.is_length() { "peak_shortening" } else { "peak_amplitude" };
    if !kind.is_length() && kind != Kind::Shortening {
        return None;
    }
    let peaks: Vec<f64> = beats.iter().filter_map(|beat| value(&beat.metrics, name)).collect();
    let typical = median(peaks);
    (typical > MOST_SHORTENING).then(|| {
        format!(
            "the beats shorten by {typical:.0} %, more than any heart cell: was a baseline subtracted, or is the unit another one?"
        )
    })
}
