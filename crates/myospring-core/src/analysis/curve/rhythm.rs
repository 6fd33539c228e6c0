//! Remarks on a series of beats: missed, early and late ones, alternans, irregular intervals.

use super::answer::{CurveBeat, State};
use crate::analysis::alternans::{self, Alternans};
use crate::analysis::{Missing, value};

/// Largest number of artefacts or beats that a remark lists.
const LISTED: usize = 5;

/// Intervals below or above these multiples of the usual one are early or late.
const EARLY: f64 = 0.8;
const LATE: f64 = 1.2;

/// Relative standard deviation from which on intervals are irregular.
const IRREGULAR: f64 = 0.1;

/// A beat whose area differs by this factor from the others is unlike them; least number of beats
/// for this test.
const UNLIKE: f64 = 1.7;
const LEAST_ALIKE: usize = 4;
const FEW_UNLIKE: usize = 4;

/// Remarks on the series; those on a single beat are added to that beat.
pub(super) fn remarks(beats: &mut [CurveBeat], paced: bool) -> Vec<String> {
    let mut remarks = Vec::new();
    let missed = beats.iter().filter(|beat| beat.state == State::Missed).count();
    if missed > 0 {
        remarks.push(format!("{missed} of {} stimuli were followed by no beat", beats.len()));
    }
    if !paced {
        remarks.extend(intervals(beats));
        remarks.extend(between(beats));
    }
    remarks.extend(UNLIKES.iter().filter_map(|in_what| unlike_in(beats, in_what)));
    remarks.extend(alternans(beats));
    remarks
}

/// Remark if beats and artefacts cannot be distinguished reliably: too many artefacts, too few
/// beats, or other pulses that may be the beats.
pub(super) fn crowded(beats: &[CurveBeat], artefacts: usize, rivalled: bool) -> Option<String> {
    let whole = beats.iter().filter(|beat| beat.state == State::Whole).count();
    if artefacts == 0 || artefacts <= whole && whole > 2 {
        return rivalled.then(|| {
            "the curve has pulses of two lengths: which of them are beats is uncertain; look at the figure"
                .to_owned()
        });
    }
    let plural = |count: usize, word: &str| match count {
        0 => format!("no {word}"),
        1 => format!("1 {word}"),
        count => format!("{count} {word}s"),
    };
    Some(format!(
        "{} and {}: they cannot be distinguished with certainty; look at the figure",
        plural(artefacts, "artefact"),
        plural(whole, "undisturbed beat"),
    ))
}

/// A property in which a beat may be unlike the others.
struct Unlike {
    size: fn(&CurveBeat) -> Option<f64>,
    /// Whether a size differs from the usual one.
    differs: fn(f64, f64) -> bool,
    name: &'static str,
    how: &'static str,
    /// Least difference, in usual deviations of the others.
    deviations: f64,
    /// Whether up to a third of the beats may differ.
    may_be_many: bool,
}

/// Properties of artefacts mistaken for beats. A third of the beats may be far larger than the
/// others, but no beat is far shorter.
const UNLIKES: [Unlike; 2] = [
    Unlike {
        size: area,
        differs: |area, usual| area > UNLIKE * usual,
        name: "its area",
        how: "far larger than",
        deviations: 9.0,
        may_be_many: true,
    },
    Unlike {
        size: duration,
        differs: |own, usual| UNLIKE * own < usual,
        name: "its duration",
        how: "far shorter than",
        deviations: 5.0,
        may_be_many: false,
    },
];

/// Marks beats that differ from all others in a property.
fn unlike_in(beats: &mut [CurveBeat], in_what: &Unlike) -> Option<String> {
    let Unlike { size, differs, name, how, deviations, may_be_many } = *in_what;
    let median = |mut list: Vec<f64>| {
        list.sort_by(f64::total_cmp);
        list.get(list.len() / 2).copied()
    };
    let areas: Vec<(usize, f64)> = beats
        .iter()
        .enumerate()
        .filter(|(_, beat)| beat.state == State::Whole)
        .filter_map(|(at, beat)| Some((at, size(beat)?)))
        .collect();
    if areas.len() < LEAST_ALIKE {
        return None;
    }
    let interval =
        median(beats.iter().filter_map(|beat| value(&beat.metrics, "interval")).collect());
    let mut found = Vec::new();
    for &(at, area) in &areas {
        let others = || areas.iter().filter(|(other, _)| *other != at).map(|(_, area)| *area);
        let usual = median(others().collect())?;
        let spread = median(others().map(|area| (area - usual).abs()).collect())?;
        // After a pause a beat is stronger.
        let rested = value(&beats[at].metrics, "interval").zip(interval);
        let rested = rested.is_some_and(|(own, usual)| own > LATE * usual);
        if differs(area, usual) && (area - usual).abs() > deviations * spread && !rested {
            found.push((at, area / usual));
        }
    }
    if found.len() * FEW_UNLIKE > areas.len() {
        return (!may_be_many).then(|| {
            format!(
                "{} of {} pulses are {how} the others: which of them are beats is uncertain; look at the figure",
                found.len(),
                areas.len()
            )
        });
    }
    let mut odd = Vec::new();
    for (at, times) in found {
        let beat = &mut beats[at];
        beat.state = State::Disturbed;
        beat.remarks.push(format!(
            "{name} is {times:.1} times that of the others: it may be an artefact and does not count in means"
        ));
        odd.push(beat.number);
        // The interval after a short one, which may not be a beat, does not count either.
        let next = beats.get_mut(at + 1).filter(|next| next.stimulus_ms.is_none() && !may_be_many);
        let metrics = next.into_iter().flat_map(|next| &mut next.metrics);
        for interval in metrics.filter(|metric| metric.name == "interval") {
            interval.lose(Missing::Artefact);
        }
    }
    let is = if odd.len() == 1 { "is" } else { "are" };
    (!odd.is_empty()).then(|| asked(&odd, &format!("{is} {how} all others")))
}

/// A remark that some beats are unusual and may not be beats.
fn asked(numbers: &[usize], what: &str) -> String {
    let numbers_listed = listed(numbers.iter().map(usize::to_string));
    let [beats, whether] =
        if numbers.len() == 1 { ["beat", "it is a beat"] } else { ["beats", "they are beats"] };
    format!("{beats} {numbers_listed} {what}: whether {whether} is uncertain; look at the figure")
}

/// The first of some items, and the number of the others.
pub(super) fn listed(items: impl ExactSizeIterator<Item = String>) -> String {
    let more = match items.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    items.take(LISTED).collect::<Vec<_>>().join(", ") + &more
}

/// Interquartile range relative to the median interval from which on pulses come by chance: random
/// pulses have 1.6, an irregular rhythm with a standard deviation of a third of the mean about
/// half.
const BY_CHANCE: f64 = 0.9;

/// Least number of intervals for this test.
const LEAST_BY_CHANCE: usize = 5;

/// Largest relative deviation of an interval from the usual one in a regular rhythm.
const REGULAR: f64 = 0.08;

/// Least number of intervals that show a regular rhythm.
const LEAST_REGULAR: usize = 3;

/// Remark on beats between two others that are one usual interval apart; these may be artefacts.
fn between(beats: &[CurveBeat]) -> Option<String> {
    let of = |beat: &CurveBeat| value(&beat.metrics, "interval").unwrap_or(f64::NAN);
    let intervals: Vec<f64> = beats.iter().map(of).collect();
    let near = |interval: f64, usual: f64| (interval - usual).abs() < REGULAR * usual;
    let split = |at: usize, usual: f64| {
        let &[before, after] = &intervals[at..at + 2] else { return false };
        before.max(after) < EARLY * usual && near(before + after, usual)
    };
    let places = || 0..intervals.len().saturating_sub(1);
    let whole = |usual: f64| intervals.iter().filter(|own| near(**own, usual)).count();
    let usual = intervals
        .iter()
        .copied()
        .filter(|own| whole(*own) >= LEAST_REGULAR)
        .max_by_key(|own| whole(*own) + places().filter(|at| split(*at, *own)).count())?;
    let found: Vec<usize> =
        places().filter(|at| split(*at, usual)).map(|at| beats[at].number).collect();
    let come = if found.len() == 1 { "comes" } else { "come" };
    (!found.is_empty())
        .then(|| asked(&found, &format!("{come} between two that are one usual interval apart")))
}

/// The area of a beat over its baseline; height times duration at half of it if its kind has no
/// area.
fn area(beat: &CurveBeat) -> Option<f64> {
    let areas = ["area_under_curve", "tension_time_integral"];
    if let Some(area) = areas.into_iter().find_map(|name| value(&beat.metrics, name)) {
        return Some(area);
    }
    Some(height(beat)? * duration(beat)?)
}

/// How long a beat stays above half of its height, ms.
fn duration(beat: &CurveBeat) -> Option<f64> {
    let durations = [
        "contraction_duration_50",
        "twitch_duration_50",
        "transient_duration_50",
        "action_potential_duration_50",
    ];
    durations.into_iter().find_map(|name| value(&beat.metrics, name))
}

fn intervals(beats: &mut [CurveBeat]) -> Vec<String> {
    let mut remarks = Vec::new();
    let intervals: Vec<Option<f64>> =
        beats.iter().map(|beat| value(&beat.metrics, "interval")).collect();
    let mut sorted: Vec<f64> = intervals.iter().flatten().copied().collect();
    if sorted.len() < 2 {
        return remarks;
    }
    sorted.sort_by(f64::total_cmp);
    // The usual interval is one of the measured ones; of the two in the middle the shorter, since
    // long ones may contain missing beats.
    let usual = sorted[(sorted.len() - 1) / 2];
    let (mut missing, mut early, mut late) = (0, 0, 0);
    for (beat, interval) in beats.iter_mut().zip(&intervals) {
        let Some(interval) = *interval else { continue };
        let cycles = (interval / usual).round();
        let off = (interval / usual / cycles.max(1.0) - 1.0).abs();
        if cycles >= 2.0 && off < 0.1 {
            missing += cycles as usize - 1;
            beat.remarks.push(format!(
                "{} beat{} missing before it: {interval:.0} ms are {cycles} intervals",
                cycles as usize - 1,
                if cycles > 2.0 { "s are" } else { " is" }
            ));
        } else if interval < EARLY * usual {
            early += 1;
            beat.remarks
                .push(format!("early: {interval:.0} ms after the last, usually {usual:.0}"));
        } else if interval > LATE * usual {
            late += 1;
            beat.remarks.push(format!("late: {interval:.0} ms after the last, usually {usual:.0}"));
        }
    }
    let beats_word = |count: usize| if count == 1 { "beat" } else { "beats" };
    if missing > 0 {
        remarks.push(format!("{missing} {} missing, by the intervals", beats_word(missing)));
    }
    let count = sorted.len() as f64;
    let mean = sorted.iter().sum::<f64>() / count;
    let spread = (sorted.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    if early + late > 0 || (missing == 0 && spread > IRREGULAR * mean) {
        let odd = |count: usize, word: &str| match count {
            0 => String::new(),
            _ => format!("; {count} {word} {}", beats_word(count)),
        };
        remarks.push(format!(
            "irregular: intervals of {mean:.0} +- {spread:.0} ms, {:.0} to {:.0}{}{}",
            sorted[0],
            sorted[sorted.len() - 1],
            odd(early, "early"),
            odd(late, "late")
        ));
    }
    let part = |part: f64| sorted[((count - 1.0) * part).round() as usize];
    if sorted.len() >= LEAST_BY_CHANCE && part(0.75) - part(0.25) > BY_CHANCE * part(0.5) {
        remarks.push(
            "the pulses come as irregularly as random ones: whether all of them are beats is \
             uncertain; look at the figure"
                .to_owned(),
        );
    }
    remarks
}

/// The metric of a beat's height.
fn height(beat: &CurveBeat) -> Option<f64> {
    if !matches!(beat.state, State::Whole | State::CutAtEnd) {
        return None;
    }
    let names = [
        "peak_shortening",
        "peak_amplitude",
        "developed_tension",
        "transient_amplitude",
        "action_potential_amplitude",
    ];
    names.into_iter().find_map(|name| value(&beat.metrics, name))
}

/// Remark if every other beat is higher, by more than chance.
fn alternans(beats: &mut [CurveBeat]) -> Option<String> {
    let heights: Vec<(usize, f64)> =
        beats.iter().enumerate().filter_map(|(at, beat)| Some((at, height(beat)?))).collect();
    let Alternans { higher, percent } = alternans::alternans(&heights)?;
    for (at, _) in &heights {
        let word = if at % 2 == higher { "high" } else { "low" };
        beats[*at].remarks.push(format!("alternans: a {word} beat"));
    }
    Some(format!("alternans: every other beat is lower, by {percent:.1} % of the higher ones"))
}
