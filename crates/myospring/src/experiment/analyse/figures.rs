//! The figure of a curve.

use super::curve::AnalysedCurve;
use super::pairs::PairedCurves;
use super::record::means;
use crate::analysis::curve::Analysis;
use crate::output::figure::{self, DrawnLoops, Figure, FigureError, Measured, measured};
use crate::output::page::metric_words;
use std::collections::{BTreeMap, BTreeSet};

/// Letters of a figure's name at most: file systems take 255 bytes, a letter has up to four, and a number and an ending follow.
const LONGEST_NAME: usize = 50;

/// Names of the figures, one for each curve: its column, with its file where there are several
/// files. No two are the same, even on a file system that ignores case.
pub(super) fn names(all: &[AnalysedCurve]) -> Vec<String> {
    let several = all.iter().any(|read| read.file != all[0].file);
    let titles =
        all.iter().map(|read| if several { read.title() } else { read.curve.name.clone() });
    file_names("trace", titles)
}

/// Names of the figures of pairs.
pub(super) fn loop_names<'a>(
    all: &[AnalysedCurve],
    pairs: impl Iterator<Item = &'a PairedCurves>,
) -> Vec<String> {
    let several = all.iter().any(|read| read.file != all[0].file);
    file_names(
        "loop",
        pairs.map(
            |pair| {
                if several { pair.title(all) } else { all[pair.motion].curve.name.clone() }
            },
        ),
    )
}

/// The figure of a pair.
pub(in crate::experiment) fn loops(
    all: &[AnalysedCurve],
    pair: &PairedCurves,
) -> Result<Figure, FigureError> {
    let [calcium, motion] = [&all[pair.calcium].curve, &all[pair.motion].curve];
    figure::loops(&DrawnLoops {
        title: &pair.title(all),
        calcium: (calcium.kind, calcium.unit),
        motion: motion.kind,
        paired: &pair.paired,
    })
}

fn file_names(start: &str, titles: impl Iterator<Item = String>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    // The number that the next curve of a name gets.
    let mut next = BTreeMap::<String, usize>::new();
    let safe = |letter: char| {
        if letter.is_alphanumeric() || "-.".contains(letter) { letter } else { '_' }
    };
    let name = |title: String| {
        let name: String = title.chars().map(safe).take(LONGEST_NAME).collect();
        let name = format!("{start}_{}", name.trim_matches(['_', '.']));
        let number = next.entry(name.to_lowercase()).or_insert(1);
        let mut own = name.clone();
        while !taken.insert(own.to_lowercase()) {
            *number += 1;
            own = format!("{name}_{number}");
        }
        own
    };
    titles.map(name).collect()
}

/// Metrics that are printed next to a figure, if the curve has them.
const BESIDE: [&str; 24] = [
    "interval",
    "resting_length",
    "baseline",
    "resting_tension",
    "diastolic_level",
    "resting_potential",
    "peak_shortening",
    "peak_amplitude",
    "developed_tension",
    "transient_amplitude",
    "amplitude_over_rest",
    "action_potential_amplitude",
    "time_to_peak_from_stimulus",
    "time_to_peak_from_onset",
    "time_to_peak_tension_from_onset",
    "rise_time_10_90",
    "relaxation_time_50",
    "tension_relaxation_time_50",
    "decay_time_50",
    "relaxation_time_90",
    "decay_time_90",
    "action_potential_duration_90",
    "maximum_shortening_rate",
    "relaxation_time_constant",
];

/// The figure of a curve.
pub(super) fn figure(read: &AnalysedCurve, analysis: &Analysis) -> Result<Figure, FigureError> {
    let means = means(analysis);
    let line = |name: &str| {
        let mean = means.iter().find(|mean| mean.name == name)?;
        Some([printed(&metric_words(mean.name)), printed(&mean.in_words()?)])
    };
    let numbers: Vec<[String; 2]> = BESIDE.iter().filter_map(|name| line(name)).collect();
    measured(&Measured {
        title: &read.title(),
        kind: read.curve.kind,
        unit: read.curve.unit,
        times_ms: &read.curve.times_ms,
        values: &read.curve.values,
        analysis,
        numbers: &numbers,
    })
}

/// A text with real minus signs, units as they are printed, and spaces that the font has.
fn printed(value: &str) -> String {
    // The font of figures has no subscript 0.
    [("\u{a0}", " "), ("-", "\u{2212}"), ("um", "\u{b5}m"), ("uM", "\u{b5}M")]
        .iter()
        .fold(value.to_owned(), |text, (written, sign)| text.replace(written, sign))
}

#[cfg(test)]
mod tests {
    use super::printed;

    #[test]
    fn numbers_beside_a_figure_have_the_words_of_people() {
        assert_eq!(printed("rise time 10\u{2013}90\u{a0}%"), "rise time 10\u{2013}90 %");
        assert_eq!(printed("-72.22 mV"), "\u{2212}72.22 mV");
        assert_eq!(printed("1.63 \u{b1} 0.02 um"), "1.63 \u{b1} 0.02 \u{b5}m");
    }
}
