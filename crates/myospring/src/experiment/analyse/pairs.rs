//! Calcium and motion that were recorded together.

use super::curve::AnalysedCurve;
use crate::analysis::kind::Kind;
use crate::analysis::paired::{Paired, Recorded, is_motion, pair};
use crate::measured::Curve;
use std::collections::BTreeSet;

/// Kinds of calcium, the one that is paired first.
const CALCIUM: [Kind; 3] = [Kind::Calcium, Kind::CalciumRatio, Kind::Fluorescence];

/// A curve of calcium and one of motion or tension with the same beats.
#[derive(Debug, Clone)]
pub struct PairedCurves {
    /// Place of calcium among the curves.
    pub calcium: usize,
    /// Place of the motion or tension among the curves.
    pub motion: usize,
    /// Their beats.
    pub paired: Paired,
}

impl PairedCurves {
    /// `calcium and length`, with the file if there are several.
    pub fn title(&self, all: &[AnalysedCurve]) -> String {
        let [calcium, motion] = [&all[self.calcium], &all[self.motion]];
        if calcium.file == motion.file {
            format!("{} and {}", calcium.title(), motion.curve.name)
        } else {
            format!("{} and {}", calcium.title(), motion.title())
        }
    }
}

/// The curves that were recorded together, and what was assumed, as sentences.
///
/// Curves of one file (or of none) are, and those of two files of which one has calcium and the other motion.
pub(super) fn pairs(all: &[AnalysedCurve]) -> (Vec<PairedCurves>, Vec<String>) {
    let (mut pairs, mut notes) = (Vec::new(), Vec::new());
    let files: BTreeSet<&str> = all.iter().map(|read| read.file.as_str()).collect();
    let of = |is: &dyn Fn(&AnalysedCurve) -> bool| -> Vec<usize> {
        (0..all.len()).filter(|&at| all[at].found.is_ok() && is(&all[at])).collect()
    };
    let mut groups: Vec<[Vec<usize>; 2]> = files
        .iter()
        .map(|file| {
            let own = |read: &AnalysedCurve| read.file == **file;
            // The best kind of calcium: a ratio comes with the fluorescences that it was made of.
            let calcium =
                CALCIUM.iter().map(|kind| of(&|read| own(read) && read.curve.kind == *kind));
            let calcium = calcium.into_iter().find(|list| !list.is_empty());
            [calcium.unwrap_or_default(), of(&|read| own(read) && is_motion(read.curve.kind))]
        })
        .collect();
    // Two files: calcium in one, motion in the other.
    let apart = groups.len() == 2
        && groups.iter().all(|[calcium, motion]| calcium.is_empty() != motion.is_empty())
        && groups[0][0].is_empty() != groups[1][0].is_empty();
    let mut clock = None;
    if apart {
        let [calcium, motion] = [0, 1]
            .map(|side| groups.iter().flat_map(|group| &group[side]).copied().collect::<Vec<_>>());
        clock = Some(format!(
            "`{}` and `{}` are taken as recorded together, on one clock",
            all[calcium[0]].file, all[motion[0]].file
        ));
        groups = vec![[calcium, motion]];
    }
    for [calcium, motion] in groups {
        for &motion in &motion {
            match partner(all, &calcium, motion) {
                Partner::None => {}
                Partner::Several => {
                    let names: Vec<String> = calcium
                        .iter()
                        .take(3)
                        .map(|&at| format!("`{}`", all[at].curve.name))
                        .collect();
                    notes.push(format!(
                        "{}: which of the {} curves of calcium ({}, ...) belongs to it is not known, so it is not paired; \
                         choose two with --columns",
                        all[motion].title(),
                        calcium.len(),
                        names.join(", ")
                    ));
                }
                Partner::One(calcium) => match paired(&all[calcium], &all[motion]) {
                    Ok(paired) => pairs.push(PairedCurves { calcium, motion, paired }),
                    Err(why) => notes.push(format!(
                        "{}: not paired with `{}`: {why}",
                        all[motion].title(),
                        all[calcium].curve.name
                    )),
                },
            }
        }
    }
    notes.extend(clock.filter(|_| !pairs.is_empty()));
    (pairs, notes)
}

enum Partner {
    None,
    One(usize),
    Several,
}

/// The calcium that belongs to a motion: the only one or, of several, the one with the same numbers in its name.
fn partner(all: &[AnalysedCurve], calcium: &[usize], motion: usize) -> Partner {
    let numbers = |at: usize| -> Vec<String> {
        let name = &all[at].curve.name;
        let parts = name.split(|letter: char| !letter.is_ascii_digit());
        parts.filter(|part| !part.is_empty()).map(str::to_owned).collect()
    };
    let own = numbers(motion);
    let same: Vec<usize> =
        calcium.iter().copied().filter(|&at| !own.is_empty() && numbers(at) == own).collect();
    match (calcium, &same[..]) {
        ([], _) => Partner::None,
        ([one], _) | (_, [one]) => Partner::One(*one),
        _ => Partner::Several,
    }
}

pub(in crate::experiment) fn paired(
    calcium: &AnalysedCurve,
    motion: &AnalysedCurve,
) -> Result<Paired, String> {
    let [calcium, motion] = [recorded(calcium)?, recorded(motion)?];
    pair(&calcium, &motion).map_err(|error| error.to_string())
}

fn recorded(read: &AnalysedCurve) -> Result<Recorded<'_>, String> {
    let analysis = read.found.as_ref().map_err(Clone::clone)?;
    let Curve { times_ms, kind, unit, .. } = &read.curve;
    Ok(Recorded { times_ms, kind: *kind, unit, analysis })
}
