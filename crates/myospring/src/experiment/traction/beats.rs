//! Beats of the axial force.

use super::frame::TractionFrame;
use crate::analysis::curve::CurveBeat;
use crate::analysis::kind::Kind;
use crate::experiment::BeatOptions;
use crate::experiment::analyse::{AnalysedCurve, Mean, means};
use crate::measured::Curve;
use serde::Serialize;

/// The axial force over time; `None` of one frame, and where times are not known.
pub(super) fn curve(frames: &[TractionFrame]) -> Option<Curve> {
    let times_ms: Option<Vec<f64>> = frames.iter().map(|frame| frame.t_ms).collect();
    let times_ms = times_ms.filter(|times| times.len() > 1)?;
    Some(Curve {
        name: "axial_force_nN".to_owned(),
        kind: Kind::Force,
        unit: "nN",
        values: frames.iter().map(|frame| frame.axial_force_nn).collect(),
        // After the names of the columns.
        lines: (2..).take(frames.len()).collect(),
        times_ms,
        stimuli_ms: Vec::new(),
    })
}

/// The beats of the axial force, as `analyse` finds them in `traction.csv`; `None` where that is no curve.
pub(super) fn of(frames: &[TractionFrame]) -> Option<AnalysedCurve> {
    Some(AnalysedCurve::of("", curve(frames)?, &BeatOptions::default()))
}

/// Beats in `summary.json`.
#[derive(Serialize)]
pub(super) struct BeatsReport<'a> {
    curve: &'a str,
    /// Why no beats were found.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
    remarks: &'a [String],
    metrics: Vec<Mean>,
    beats: &'a [CurveBeat],
}

pub(super) fn report(read: &AnalysedCurve) -> BeatsReport<'_> {
    let found = read.found.as_ref();
    BeatsReport {
        curve: &read.curve.name,
        error: found.err().map(String::as_str),
        remarks: found.map_or(&[], |analysis| &analysis.remarks),
        metrics: found.map_or_else(|_| Vec::new(), means),
        beats: found.map_or(&[], |analysis| &analysis.beats),
    }
}
