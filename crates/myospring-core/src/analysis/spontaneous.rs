//! Action potentials of a cell that beats by itself, found by their upstrokes.
//!
//! An upstroke is a rise of the potential from its lower third to above three fifths of its range.
//! One that comes at most 50 ms after a stimulus belongs to that stimulus.
//!
//! A cell beats by itself if an upstroke has no stimulus between it and the upstroke before, or if
//! upstrokes come later than 50 ms after their stimuli at delays that differ by more than 50 ms: a
//! weak stimulus may act late, but then always as late. Every action potential of such a cell is a
//! beat, which begins at its stimulus, or else at its take-off.

use super::capture::{LATEST_PEAK_MS, least_height};
use super::rows::row;
use super::{Metric, Missing, Reading};
use serde::Serialize;

/// Parts of the range below and above which an upstroke begins and is sure.
const LOW: f64 = 1.0 / 3.0;
const HIGH: f64 = 0.6;
/// Slope at the take-off, as a part of the largest slope of the upstroke.
const TAKE_OFF: f64 = 0.1;

/// The rhythm of a cell that beats by itself.
///
/// # Example
/// ```
/// use myospring::analysis::spontaneous::Upstrokes;
/// // A potential that falls from 20 to -80 mV and jumps back every 500 ms, without a stimulus.
/// let times: Vec<f64> = (0..4000).map(f64::from).collect();
/// let potential: Vec<f64> = times.iter().map(|t| 20.0 - 0.2 * (t % 500.0)).collect();
/// let upstrokes = Upstrokes::of(&times, &potential, "mV", &[]).unwrap();
/// let rhythm = upstrokes.rhythm("mV", 0);
/// assert_eq!((rhythm.action_potentials, rhythm.cycle_length_ms), (7, Some(500.0)));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpontaneousRhythm {
    /// Number of action potentials.
    pub action_potentials: usize,
    /// Number of them that a stimulus raised.
    pub raised_by_stimuli: usize,
    /// Number of stimuli.
    pub stimuli: usize,
    /// Mean time from upstroke to upstroke where no stimulus raised the second, ms.
    pub cycle_length_ms: Option<f64>,
    /// Mean of the lowest potentials between two upstrokes.
    pub maximum_diastolic_potential: Option<f64>,
    /// Unit of the potential.
    pub unit: &'static str,
}

/// Whether upstrokes do not follow the stimuli.
fn beats_by_itself(upstrokes: &[Upstroke], stimuli_ms: &[f64]) -> bool {
    let (mut shortest, mut longest) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut before_ms = f64::NEG_INFINITY;
    for own in upstrokes {
        if own.stimulus.is_none() {
            let between = |time: &&f64| (before_ms..=own.crossing_ms).contains(*time);
            let Some(stimulus_ms) = stimuli_ms.iter().rfind(between) else { return true };
            let delay = own.crossing_ms - stimulus_ms;
            (shortest, longest) = (shortest.min(delay), longest.max(delay));
        }
        before_ms = own.crossing_ms;
    }
    longest - shortest > LATEST_PEAK_MS
}

/// One upstroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Upstroke {
    /// Its take-off, ms, and the potential there.
    pub take_off_ms: f64,
    /// The potential at the take-off.
    pub potential: f64,
    /// The stimulus that raised it, by index.
    pub stimulus: Option<usize>,
    /// When the potential passes the middle of its range, ms.
    pub crossing_ms: f64,
    /// The lowest potential since the upstroke before, and its time, ms; `None` for the first.
    pub lowest: Option<[f64; 2]>,
}

/// The upstrokes of a cell that beats by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Upstrokes(pub Vec<Upstroke>);

impl Upstrokes {
    /// Finds the upstrokes in samples at ascending times, ms; `None` if nothing shows that the cell
    /// beats by itself.
    pub fn of(times: &[f64], potential: &[f64], unit: &str, stimuli_ms: &[f64]) -> Option<Self> {
        let low = potential.iter().copied().fold(f64::INFINITY, f64::min);
        let range = potential.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low;
        if range.is_nan() || range < least_height(unit) {
            return None;
        }
        let (begin, middle, sure) = (low + LOW * range, low + 0.5 * range, low + HIGH * range);
        let mut found: Vec<Upstroke> = Vec::new();
        let (mut armed, mut from) = (false, 0);
        for at in 0..potential.len() {
            if potential[at] < begin {
                armed = true;
            } else if armed && potential[at] > sure {
                armed = false;
                let after = (from..=at).rfind(|k| potential[*k] <= middle).unwrap_or(from) + 1;
                let own = upstroke([times, potential], [from, after], middle, stimuli_ms);
                let lowest = own.lowest.filter(|_| !found.is_empty());
                found.push(Upstroke { lowest, ..own });
                from = at;
            }
        }
        beats_by_itself(&found, stimuli_ms).then_some(Self(found))
    }

    /// When each beat begins, ms: at its stimulus, or at its take-off.
    pub fn starts(&self, stimuli_ms: &[f64]) -> Vec<f64> {
        let start = |own: &Upstroke| own.stimulus.map_or(own.take_off_ms, |at| stimuli_ms[at]);
        self.0.iter().map(start).collect()
    }

    /// The rhythm; `stimuli` is the number of stimuli.
    pub fn rhythm(&self, unit: &'static str, stimuli: usize) -> SpontaneousRhythm {
        let mean = |values: Vec<f64>| {
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        let cycles = self.0.windows(2).filter(|pair| pair[1].stimulus.is_none());
        let cycles = cycles.map(|pair| pair[1].crossing_ms - pair[0].crossing_ms).collect();
        let lowest = self.0.iter().filter_map(|own| own.lowest).map(|[value, _]| value).collect();
        SpontaneousRhythm {
            action_potentials: self.0.len(),
            raised_by_stimuli: self.0.iter().filter(|own| own.stimulus.is_some()).count(),
            stimuli,
            cycle_length_ms: mean(cycles),
            maximum_diastolic_potential: mean(lowest),
            unit,
        }
    }

    /// Metrics of the beat of an upstroke, by index.
    pub fn metrics(&self, at: usize, unit: &'static str) -> Vec<Metric> {
        let own = self.0[at];
        let before = at.checked_sub(1).and_then(|before| self.0.get(before));
        let cycle = before.map(|before| own.crossing_ms - before.crossing_ms);
        let cycle = cycle.ok_or(Missing::First);
        let lowest = own.lowest.ok_or(Missing::First);
        // From the lowest potential to the take-off.
        let rise = lowest.and_then(|[value, time]| {
            let rate = 1e3 * (own.potential - value) / (own.take_off_ms - time);
            if own.stimulus.is_none() && rate.is_finite() {
                Ok(rate)
            } else {
                Err(Missing::TooSmall)
            }
        });
        rows([cycle, lowest.map(|[value, _]| value), rise], unit)
    }
}

/// The three metrics of a beat that came by itself.
pub(super) fn rows([cycle, lowest, rise]: [Reading; 3], unit: &'static str) -> Vec<Metric> {
    let per_second = if unit == "mV" { "mV/s" } else { "1/s" };
    vec![
        row("spontaneous_cycle_length", cycle, "ms", "from the upstroke before"),
        row(
            "lowest_diastolic_potential",
            lowest,
            unit,
            "maximum diastolic potential: the lowest since the upstroke before",
        ),
        row(
            "diastolic_depolarisation_rate",
            rise,
            per_second,
            "mean slope from the lowest potential to the take-off",
        ),
    ]
}

/// An upstroke whose crossing of the middle lies just before sample `after`; the upstroke before
/// was at sample `from`.
fn upstroke(
    [times, potential]: [&[f64]; 2],
    [from, after]: [usize; 2],
    middle: f64,
    stimuli_ms: &[f64],
) -> Upstroke {
    let before = after.saturating_sub(1);
    let (low, high) = (potential[before], potential[after]);
    let part = if high > low { (middle - low) / (high - low) } else { 0.0 };
    let crossing_ms = times[before] + part * (times[after] - times[before]);
    let slope = |at: usize| (potential[at] - potential[at - 1]) / (times[at] - times[at - 1]);
    // Back from the crossing while the potential rises steeply; the steepest slope lies near it.
    let last = (after + 1).min(potential.len() - 1);
    let steepest = (before.max(1)..=last).map(slope).fold(0.0, f64::max);
    let mut at = after;
    while at > from + 1 && slope(at) > TAKE_OFF * steepest {
        at -= 1;
    }
    let lowest = (from..=at).reduce(|a, b| if potential[b] < potential[a] { b } else { a });
    // A stimulus that makes the potential jump lies at the sample after the jump.
    let stimulus = stimuli_ms.iter().rposition(|stimulus| *stimulus <= times[after]);
    let stimulus = stimulus.filter(|at| crossing_ms - stimuli_ms[*at] <= LATEST_PEAK_MS);
    Upstroke {
        take_off_ms: times[at],
        potential: potential[at],
        stimulus,
        crossing_ms,
        lowest: lowest.map(|at| [potential[at], times[at]]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every 800 ms a slow depolarisation from -80 to -60 mV over 700 ms, an upstroke to 20 mV in
    /// 10 ms, and a fall in 90 ms.
    fn potential(t: f64) -> f64 {
        let phase = t % 800.0;
        if phase < 700.0 {
            -80.0 + 20.0 * phase / 700.0
        } else if phase < 710.0 {
            -60.0 + 8.0 * (phase - 700.0)
        } else {
            20.0 - 100.0 * (phase - 710.0) / 90.0
        }
    }

    fn samples() -> [Vec<f64>; 2] {
        let times: Vec<f64> = (0..8000).map(|k| 0.5 * f64::from(k)).collect();
        let values = times.iter().map(|t| potential(*t)).collect();
        [times, values]
    }

    #[test]
    fn beats_by_itself_are_measured() {
        let [times, values] = samples();
        let upstrokes = Upstrokes::of(&times, &values, "mV", &[]).unwrap();
        assert_eq!(upstrokes.0.len(), 5);
        for (k, own) in upstrokes.0.iter().enumerate() {
            assert!((own.take_off_ms - (700.0 + 800.0 * k as f64)).abs() < 1e-9, "{own:?}");
        }
        let metrics = upstrokes.metrics(2, "mV");
        let values: Vec<f64> = metrics.iter().filter_map(|metric| metric.value).collect();
        let expected = [800.0, -80.0, 20.0 / 0.7];
        for (value, expected) in values.iter().zip(expected) {
            assert!((value - expected).abs() < 1e-9 * expected.abs(), "{metrics:?}");
        }
        assert!(upstrokes.metrics(0, "mV").iter().all(|metric| metric.value.is_none()));
    }

    #[test]
    fn an_upstroke_soon_after_a_stimulus_is_that_stimulus_s() {
        let [times, values] = samples();
        let all: Vec<f64> = (0..5).map(|k| 690.0 + 800.0 * f64::from(k)).collect();
        assert_eq!(Upstrokes::of(&times, &values, "mV", &all), None);
        let upstrokes = Upstrokes::of(&times, &values, "mV", &all[..2]).unwrap();
        let rhythm = upstrokes.rhythm("mV", 2);
        assert_eq!((rhythm.action_potentials, rhythm.raised_by_stimuli), (5, 2));
        assert_eq!(upstrokes.starts(&all)[..3], [690.0, 1490.0, 2300.0]);
        // Small oscillations are no action potentials.
        let small: Vec<f64> = values.iter().map(|value| 0.3 * value).collect();
        assert_eq!(Upstrokes::of(&times, &small, "mV", &[]), None);
    }

    #[test]
    fn an_upstroke_that_always_comes_as_late_after_its_stimulus_follows_it() {
        let [times, values] = samples();
        let each = |first: f64, cycle_ms: f64| -> Vec<f64> {
            (0..5).map(|k| first + cycle_ms * f64::from(k)).collect()
        };
        // The upstrokes are at 700, 1500, 2300 ms and so on.
        assert_eq!(Upstrokes::of(&times, &values, "mV", &each(580.0, 800.0)), None);
        let rhythm = Upstrokes::of(&times, &values, "mV", &each(580.0, 700.0)).unwrap();
        assert_eq!(rhythm.rhythm("mV", 5).raised_by_stimuli, 0);
        // One alone shows nothing.
        let until = times.iter().take_while(|time| **time < 900.0).count();
        assert_eq!(Upstrokes::of(&times[..until], &values[..until], "mV", &[580.0]), None);
        assert!(Upstrokes::of(&times[..until], &values[..until], "mV", &[800.0]).is_some());
    }
}
