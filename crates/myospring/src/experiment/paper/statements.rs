//! Compares every number that the paper states with ours, with a computed verdict.

use crate::analysis::beat::{Beat, beats};
use crate::recording::Recording;
use serde::Serialize;

/// Whether a statement of the paper is met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StatementVerdict {
    /// Ours agrees within the stated tolerance.
    Met,
    /// Ours does not agree.
    NotMet,
    /// A number for orientation, which no run of ours can meet or miss.
    Context,
}

impl StatementVerdict {
    fn of(met: bool) -> Self {
        if met { Self::Met } else { Self::NotMet }
    }

    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::NotMet => "NOT MET",
            Self::Context => "context",
        }
    }
}

/// One statement of the paper.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// What it is about.
    pub quantity: &'static str,
    /// Where the paper states it.
    pub place: &'static str,
    /// What the paper says.
    pub paper: &'static str,
    /// What we find.
    pub ours: String,
    /// What counts as met.
    pub criterion: &'static str,
    /// Whether it is.
    pub verdict: StatementVerdict,
}

/// One run of the paper's Fig. 6.
#[derive(Debug, Clone, Copy)]
pub(super) struct PaperRun<'a> {
    /// Peak tension asked for, kPa.
    pub(super) peak_tension: f64,
    /// What was recorded.
    pub(super) recording: &'a Recording,
}

/// Peak tensions of the paper's Fig. 6, kPa.
pub(super) const TENSIONS: [f64; 3] = [30.0, 40.0, 50.0];

/// The paper's statements: what each is about, where it is, what it says, and what counts as met.
const STATEMENTS: [[&str; 4]; 11] = [
    ["differential equations of a cell", "section 1, Eqs (18)-(35)", "6", "equal"],
    [
        "action potential, normalised",
        "Fig. 3",
        "0 to 1 and back",
        "rest and end within 1 % of the peak",
    ],
    [
        "time of the tension peak",
        "section 4.2",
        "around 170 ms",
        "171.5 +- 0.5 ms, the converged solution of the paper's equations",
    ],
    ["tension at its peak", "section 4.2", "100 % of stress", "within 0.1 %"],
    ["tension after the beat", "section 4.2", "0 % of stress", "below 1 %"],
    ["maximum deformation", "section 4.2, Fig. 6", "12 % at 50 kPa", "12.0 +- 0.2 %"],
    ["deformation at 30, 40, 50 kPa", "Fig. 6", "grows with tension", "strictly rising"],
    ["contraction peaks when stress does", "section 4.2", "at the same time", "lag at most 1 ms"],
    [
        "return to the initial shape",
        "section 1, Fig. 6",
        "back to its initial configuration",
        "within 0.1 % of the length",
    ],
    ["mass centre", "section 2.1", "fixed", "less than 1e-6 um"],
    [
        "shortening of measured cells",
        "section 5, [9]",
        "8 to 10 %",
        "a measurement to compare with",
    ],
];

/// Compares runs at rising tension, stimulated once at `stimulus_ms`, with `coelho_2021`.
///
/// `equations` is the number of state variables of the cell model, `weights` the masses up to a
/// factor. A number that a run does not have makes its verdict `NotMet`.
pub(super) fn with_paper(
    runs: &[PaperRun<'_>],
    stimulus_ms: f64,
    equations: usize,
    weights: &[f64],
) -> Vec<Finding> {
    let beats: Vec<Beat> =
        runs.iter().flat_map(|run| beats(run.recording, &[stimulus_ms])).collect();
    let column = |name: &str| -> Vec<f64> {
        beats.iter().map(|beat| beat.value(name).unwrap_or(f64::NAN)).collect()
    };
    let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let known = |values: &[f64]| values.len() == runs.len() && values.iter().all(|x| x.is_finite());

    let times = column("time_of_peak_tension");
    let tensions = column("peak_tension");
    let reached: Vec<f64> =
        tensions.iter().zip(runs).map(|(ours, run)| 100.0 * ours / run.peak_tension).collect();
    let at_end = column("tension_at_end");
    let shortening = column("peak_shortening");
    let lags = column("lag_of_shortening");
    let residual = column("residual_shortening");
    let rest = column("resting_potential");
    let peak_u = column("peak_potential");
    let apd = column("action_potential_duration_90");
    let strongest = shortening.last().copied().unwrap_or(f64::NAN);
    let drift = runs.iter().map(|run| centre_drift(run.recording, weights)).fold(0.0, larger);
    let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
    let u_end = runs.last().and_then(|run| run.recording.samples.last()?.u).unwrap_or(f64::NAN);

    // What we find for each statement, and whether that is met; nothing can meet or miss the last.
    let ours = [
        (equations.to_string(), Some(equations == 6)),
        (
            format!(
                "u {:.3} to {:.3}, back to {:.3}; APD90 {:.1} ms",
                last(&rest),
                last(&peak_u),
                u_end,
                last(&apd)
            ),
            Some(
                known(&peak_u)
                    && last(&rest).abs() <= 0.01 * last(&peak_u)
                    && u_end.abs() <= 0.01 * last(&peak_u),
            ),
        ),
        (
            format!("{} ms", list(&times, 2)),
            Some(known(&times) && times.iter().all(|time| (time - 171.5).abs() <= 0.5)),
        ),
        (
            format!("{} %", list(&reached, 2)),
            Some(known(&reached) && reached.iter().all(|part| (part - 100.0).abs() <= 0.1)),
        ),
        (
            format!("{} % at the end", list(&at_end, 2)),
            Some(known(&at_end) && largest(&at_end) < 1.0),
        ),
        (format!("{strongest:.2} %"), Some((strongest - 12.0).abs() <= 0.2)),
        (
            format!("{} %", list(&shortening, 2)),
            Some(known(&shortening) && shortening.windows(2).all(|pair| pair[0] < pair[1])),
        ),
        (format!("{} ms later", list(&lags, 2)), Some(known(&lags) && largest(&lags) <= 1.0)),
        (
            format!("{} % short at the end", list(&residual, 3)),
            Some(known(&residual) && largest(&residual) <= 0.1),
        ),
        (format!("moves {drift:.1e} um"), Some(drift < 1e-6)),
        (format!("{} % at 30, 40, 50 kPa", list(&shortening, 1)), None),
    ];
    let pairs = STATEMENTS.into_iter().zip(ours);
    let findings = pairs.map(|([quantity, place, paper, criterion], (ours, met))| {
        let verdict = met.map_or(StatementVerdict::Context, StatementVerdict::of);
        Finding { quantity, place, paper, ours, criterion, verdict }
    });
    findings.collect()
}

/// Values with this number of decimals, separated by commas; equal ones are listed once.
fn list(values: &[f64], decimals: usize) -> String {
    // No minus before zero.
    let one = |value: &f64| {
        let text = format!("{value:.decimals$}");
        if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
            text.trim_start_matches('-').to_owned()
        } else {
            text
        }
    };
    let texts: Vec<String> = values.iter().map(one).collect();
    match texts.split_first() {
        Some((first, rest)) if rest.iter().all(|text| text == first) => first.clone(),
        _ => texts.join(", "),
    }
}

/// Largest distance of the mass centre from its initial position, um.
fn centre_drift(recording: &Recording, weights: &[f64]) -> f64 {
    let total: f64 = weights.iter().sum();
    let centre = |positions: &[Vec<f64>; 2]| {
        [0, 1].map(|axis| {
            positions[axis].iter().zip(weights).map(|(x, weight)| x * weight).sum::<f64>() / total
        })
    };
    let Some(first) = recording.frames.first() else { return f64::NAN };
    let [x, y] = centre(&first.positions);
    recording
        .frames
        .iter()
        .map(|frame| {
            let [now_x, now_y] = centre(&frame.positions);
            (now_x - x).hypot(now_y - y)
        })
        .fold(0.0, larger)
}

/// The larger number, or NaN if either is NaN, so that an unknown number does not count as met.
fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_show_nothing_meet_nothing() {
        let empty = Recording::default();
        let runs = TENSIONS.map(|peak_tension| PaperRun { peak_tension, recording: &empty });
        for finding in with_paper(&runs, 50.0, 5, &[]) {
            assert_ne!(finding.verdict, StatementVerdict::Met, "{finding:?}");
        }
    }

    #[test]
    fn equal_numbers_are_listed_once_and_zero_has_no_sign() {
        assert_eq!(list(&[1.0, 1.0, 2.0], 1), "1.0, 1.0, 2.0");
        assert_eq!(list(&[-0.001], 2), "0.00");
    }
}
