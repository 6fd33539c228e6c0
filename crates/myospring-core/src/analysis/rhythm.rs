//! How beats follow their stimuli: capture, capture ratio, alternans.

use super::alternans::{Alternans, alternans};
use super::spontaneous::SpontaneousRhythm;
use serde::Serialize;
use std::fmt::Write as _;

/// Longest pattern of stimuli that may repeat: up to 5:4 capture.
const LONGEST: usize = 5;
/// Largest number of stimuli that a sentence lists.
const LISTED: usize = 6;

/// How beats follow their stimuli.
///
/// # Example
/// ```
/// use myospring::analysis::rhythm::Rhythm;
/// let stimuli = [50.0, 350.0, 650.0, 950.0];
/// let captured = [true, false, true, false].map(Some);
/// let rhythm = Rhythm::of(&stimuli, &captured, &[]);
/// assert_eq!((rhythm.stimuli, rhythm.not_captured), (4, vec![2, 4]));
/// assert!(rhythm.capture_ratio.unwrap().starts_with("2:1 capture"));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Rhythm {
    /// Number of stimuli within the run, without the extra stimulus S2.
    pub stimuli: usize,
    /// Numbers, from 1, of stimuli that raised no action potential.
    pub not_captured: Vec<usize>,
    /// Their times, ms.
    pub not_captured_ms: Vec<f64>,
    /// Ratio of stimuli to action potentials, if a pattern repeats: `2:1 capture ...`.
    pub capture_ratio: Option<String>,
    /// Metrics that are lower in every other beat, in words; `None` without alternans.
    pub alternans: Option<String>,
    /// The rhythm of a cell that beats by itself; `None` if stimuli raised all its beats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spontaneous: Option<SpontaneousRhythm>,
}

/// Name of a metric in words, and its value in each beat that counts.
pub type Heights<'a> = (&'a str, Vec<Option<f64>>);

impl Rhythm {
    /// Determines the rhythm from stimulus times, ms, and whether each was captured; alternans is
    /// searched in `heights`.
    pub fn of(stimuli_ms: &[f64], captured: &[Option<bool>], heights: &[Heights<'_>]) -> Self {
        let missed: Vec<usize> =
            (0..captured.len()).filter(|&at| captured[at] == Some(false)).collect();
        let flags: Vec<bool> = captured.iter().map(|captured| *captured != Some(false)).collect();
        Self {
            stimuli: stimuli_ms.len(),
            not_captured: missed.iter().map(|at| at + 1).collect(),
            not_captured_ms: missed.iter().map(|&at| stimuli_ms[at]).collect(),
            capture_ratio: ratio(&flags),
            alternans: alternating(heights),
            spontaneous: None,
        }
    }

    /// Like [`Rhythm::missed`], including an extra stimulus, in the words of a table's row.
    pub fn no_capture(&self, s2: Option<bool>) -> Option<String> {
        let s2 = (s2 == Some(false)).then(|| "S2 raised no action potential".to_owned());
        let all: Vec<String> = self.missed().into_iter().chain(s2).collect();
        (!all.is_empty()).then(|| format!("no capture: {}", all.join("; ")))
    }

    /// How many stimuli raised no action potential, and which; `None` if all did.
    pub fn missed(&self) -> Option<String> {
        let count = self.not_captured.len();
        let plural = |count: usize| if count == 1 { "stimulus" } else { "stimuli" };
        if count == 0 {
            return None;
        }
        if count == self.stimuli {
            return Some("no stimulus raised an action potential".to_owned());
        }
        let mut text = format!(
            "{count} of {} {} raised no action potential: ",
            self.stimuli,
            plural(self.stimuli)
        );
        text.push_str(if count == 1 { "number " } else { "numbers " });
        let shown = if count > LISTED + 1 { LISTED } else { count };
        for (at, number) in self.not_captured[..shown].iter().enumerate() {
            let last = at + 1 == count;
            text.push_str(match at {
                0 => "",
                _ if last => " and ",
                _ => ", ",
            });
            let _ = write!(text, "{number}");
        }
        if shown < count {
            let _ = write!(text, " and {} others", count - shown);
        }
        Some(text)
    }
}

/// The ratio in which stimuli are captured at the end of a series, if the pattern repeats at least
/// once.
fn ratio(captured: &[bool]) -> Option<String> {
    let count = captured.len();
    if count >= 3 && captured[0] && captured[1..].iter().all(|captured| !captured) {
        return Some("no stimulus after the first was captured".to_owned());
    }
    (2..=LONGEST).find_map(|length| {
        let same = (length..count).rev().take_while(|&at| captured[at] == captured[at - length]);
        let tail = length + same.count();
        let block = captured.get(count.checked_sub(length)?..)?;
        let beats = block.iter().filter(|captured| **captured).count();
        if tail < 2 * length || beats == 0 || beats == length {
            return None;
        }
        let from = match count - tail {
            0 => String::new(),
            before => format!(" from stimulus {} on", before + 1),
        };
        let s = if beats == 1 { "" } else { "s" };
        Some(format!(
            "{length}:{beats} capture{from}: {length} stimuli raise {beats} action potential{s}"
        ))
    })
}

/// The heights that are lower in every other beat, in words.
fn alternating(heights: &[Heights<'_>]) -> Option<String> {
    let lower = heights.iter().filter_map(|(name, values)| {
        let known: Vec<(usize, f64)> =
            values.iter().enumerate().filter_map(|(at, value)| Some((at, (*value)?))).collect();
        let Alternans { percent, .. } = alternans(&known)?;
        Some(format!("{name} by {percent:.1} %"))
    });
    let lower: Vec<String> = lower.collect();
    (!lower.is_empty())
        .then(|| format!("alternans: every other beat has a lower {}", lower.join(", a lower ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rhythm(flags: &str) -> Rhythm {
        let captured: Vec<Option<bool>> = flags.chars().map(|flag| Some(flag == 'x')).collect();
        let times: Vec<f64> = (0..captured.len()).map(|at| 100.0 * at as f64).collect();
        Rhythm::of(&times, &captured, &[])
    }

    #[test]
    fn a_capture_ratio_is_named_where_it_repeats() {
        for (flags, expected) in [
            ("xxxxxx", ""),
            ("x-x", ""),
            ("x-x-", "2:1 capture: "),
            ("xxxx-x-x-x", "2:1 capture from stimulus 4 on: "),
            ("x--x--", "3:1 capture: "),
            ("xx-xx-xx-", "3:2 capture: "),
            ("xxx-xxx-", "4:3 capture: "),
            ("xx-x-xxx", ""),
            ("x---", "no stimulus after the first"),
            ("----", ""),
        ] {
            let found = rhythm(flags).capture_ratio;
            match expected {
                "" => assert_eq!(found, None, "{flags}"),
                _ => assert!(found.as_ref().unwrap().starts_with(expected), "{flags}: {found:?}"),
            }
        }
    }

    #[test]
    fn missed_stimuli_are_counted_and_the_first_few_are_named() {
        assert_eq!(rhythm("xx").missed(), None);
        let of = |flags| rhythm(flags).missed().unwrap();
        assert_eq!(of("x-"), "1 of 2 stimuli raised no action potential: number 2");
        assert_eq!(of("x-x-x-"), "3 of 6 stimuli raised no action potential: numbers 2, 4 and 6");
        assert_eq!(of("--"), "no stimulus raised an action potential");
        assert!(of(&"x-".repeat(50)).ends_with("numbers 2, 4, 6, 8, 10, 12 and 44 others"));
    }
}
