//! A curve whose beats were looked for.

use crate::analysis::curve::{self, Analysis};
use crate::experiment::beats::BeatOptions;
use crate::measured::Curve;
use std::path::Path;

/// A measured curve and what was read of it.
#[derive(Debug, Clone)]
pub struct AnalysedCurve {
    /// The file as it was named; empty of a curve that came from no file.
    pub file: String,
    /// The curve.
    pub curve: Curve,
    /// What was read, or why nothing was.
    pub found: Result<Analysis, String>,
}

impl AnalysedCurve {
    pub(in crate::experiment) fn of(file: &str, curve: Curve, beats: &BeatOptions) -> Self {
        let options = beats.within(&curve);
        let found =
            curve::analyse(&curve.times_ms, &curve.values, curve.kind, curve.unit, &options);
        let found = found.map_err(|error| match error.frame() {
            Some(frame) if !file.is_empty() => {
                format!("{error} (line {} of the file)", curve.lines[frame - 1])
            }
            _ => error.to_string(),
        });
        Self { file: file.to_owned(), curve, found }
    }

    /// File and column.
    #[must_use]
    pub fn title(&self) -> String {
        match Path::new(&self.file).file_name() {
            Some(name) => format!("{}: {}", name.to_string_lossy(), self.curve.name),
            None => self.curve.name.clone(),
        }
    }

    /// What is odd about the curve and its beats.
    pub(super) fn remarks(&self) -> impl Iterator<Item = String> {
        let found = self.found.as_ref().ok();
        let of_curve = found.into_iter().flat_map(|found| found.remarks.iter().cloned());
        // The remark on the curve already says what is said of every single beat.
        let said = ["alternans", "an artefact at", "artefacts at"];
        let beats = found.into_iter().flat_map(|found| &found.beats);
        let of_beats = beats.flat_map(move |beat| {
            let new = beat
                .remarks
                .iter()
                .filter(move |remark| !said.iter().any(|start| remark.starts_with(start)));
            new.map(|remark| format!("beat {}: {remark}", beat.number))
        });
        of_curve.chain(of_beats).map(|remark| format!("{}: {remark}", self.title()))
    }
}
