//! Calcium and the motion or tension of the same beats: delays, loops, calcium at half of the motion.
//!
//! Both curves have one clock and were analysed on their own ([`analyse`](super::curve::analyse)); their frames
//! may differ. A beat of one belongs to the beat of the other with the same stimulus or, without stimuli, whose onset
//! is nearest in both directions and closer than half of the interval between beats.

mod answer;
mod course;
mod matching;
mod metrics;
mod recorded;

use super::curve::State;
use super::kind::{Family, Kind};
pub use answer::{Direction, PairError, Paired, PairedBeat};
use course::Course;
pub use course::Loop;
pub use recorded::Recorded;

/// Part of the beats of either curve, while both were recorded, that must be in both.
const TOGETHER: f64 = 0.5;

/// Whether a curve of this kind is motion or tension, which calcium can be paired with.
pub fn is_motion(kind: Kind) -> bool {
    kind != Kind::Unknown && matches!(kind.family(), Family::Contraction | Family::Tension)
}

/// Pairs the beats of calcium with those of a motion or tension that was recorded at the same time.
///
/// # Errors
/// Wrong kinds, times that do not overlap, or fewer than half of the beats in both curves.
///
/// # Example
/// ```
/// use myospring::analysis::curve::{CurveOptions, analyse};
/// use myospring::analysis::kind::Kind;
/// use myospring::analysis::paired::{Recorded, pair};
/// // Three beats a second apart; the cell shortens 30 ms after calcium rises.
/// let pulse = |t: f64| {
///     let t = (t - 200.0).rem_euclid(1000.0);
///     if t < 400.0 { (std::f64::consts::PI * t / 400.0).sin().powi(2) } else { 0.0 }
/// };
/// let times: Vec<f64> = (0..750).map(|i| 4.0 * f64::from(i)).collect();
/// let calcium: Vec<f64> = times.iter().map(|t| 0.1 + 0.4 * pulse(*t)).collect();
/// let length: Vec<f64> = times.iter().map(|t| 100.0 - 10.0 * pulse(t - 30.0)).collect();
/// let options = CurveOptions::default();
/// let [calcium, length] = [(calcium, Kind::Calcium, "uM"), (length, Kind::Length, "um")]
///     .map(|(values, kind, unit)| (analyse(&times, &values, kind, unit, &options).unwrap(), kind, unit));
/// let [calcium, length] = [&calcium, &length]
///     .map(|(analysis, kind, unit)| Recorded { times_ms: &times, kind: *kind, unit, analysis });
/// let paired = pair(&calcium, &length)?;
/// assert!((paired.mean("delay_of_onset").unwrap() - 30.0).abs() < 0.5); // ms
/// assert!(paired.mean("loop_area").unwrap() > 0.0); // counter-clockwise: the cell follows its calcium
/// # Ok::<(), myospring::analysis::paired::PairError>(())
/// ```
pub fn pair(calcium: &Recorded, motion: &Recorded) -> Result<Paired, PairError> {
    if calcium.kind.family() != Family::Calcium {
        return Err(PairError::Kind(calcium.kind));
    }
    if !is_motion(motion.kind) {
        return Err(PairError::Kind(motion.kind));
    }
    let [calcium_ms, motion_ms] = [calcium, motion].map(Recorded::span);
    let both = [calcium_ms[0].max(motion_ms[0]), calcium_ms[1].min(motion_ms[1])];
    if both[0] >= both[1] {
        return Err(PairError::Apart { calcium_ms, motion_ms });
    }
    let matched = matching::beats(calcium.analysis, motion.analysis, both);
    let pairs = matched.iter().filter(|[one, other]| one.is_some() && other.is_some()).count();
    let count = |side: usize| matched.iter().filter(|sides| sides[side].is_some()).count();
    let most = count(0).max(count(1));
    if pairs == 0 || (pairs as f64) < TOGETHER * most as f64 {
        let [calcium, motion] = [count(0), count(1)];
        return Err(PairError::Beats { calcium, motion, matched: pairs });
    }
    let [of_calcium, of_motion] = [calcium, motion].map(Course::of);
    let mut beats = Vec::with_capacity(matched.len());
    let mut loops = Vec::new();
    for (number, sides) in (1..).zip(matched) {
        let [one, other] = [
            sides[0].map(|at| &calcium.analysis.beats[at]),
            sides[1].map(|at| &motion.analysis.beats[at]),
        ];
        let (mut counts, mut metrics) = (false, Vec::new());
        let remark;
        match (one, other) {
            (Some(one), Some(other)) => {
                counts = [one, other]
                    .iter()
                    .all(|beat| matches!(beat.state, State::Whole | State::CutAtEnd));
                let odd = [("calcium", one), (motion.kind.name(), other)];
                let odd = odd.iter().filter(|(_, beat)| beat.state != State::Whole);
                remark = odd
                    .map(|(name, beat)| format!("{name}: {}", beat.state.words()))
                    .collect::<Vec<_>>()
                    .join("; ");
                let course = course::of_beat([&of_calcium, &of_motion], [one, other]);
                metrics = metrics::of_beat(
                    [&of_calcium, &of_motion],
                    [one, other],
                    course.as_ref(),
                    counts,
                );
                if let Ok(course) = course
                    && counts
                {
                    loops.push((number, course));
                }
            }
            (Some(_), None) => remark = format!("only in calcium, not in {}", motion.kind.name()),
            _ => remark = format!("only in {}, not in calcium", motion.kind.name()),
        }
        let [calcium_beat, motion_beat] = [one, other].map(|beat| Some(beat?.number));
        beats.push(PairedBeat { number, calcium_beat, motion_beat, counts, remark, metrics });
    }
    let mean_loop = Loop::mean(&loops);
    let motion_unit = of_motion.unit;
    let mut paired = Paired {
        beats,
        loops,
        mean_loop,
        motion_unit,
        direction: Direction::Unknown,
        remarks: Vec::new(),
    };
    paired.direction = metrics::direction(&paired);
    paired.remarks = metrics::remarks(&paired, calcium, motion);
    Ok(paired)
}
