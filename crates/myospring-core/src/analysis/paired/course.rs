//! The course of two curves over one beat, and the loop that they make.

use super::recorded::Recorded;
use crate::analysis::curve::{Analysis, CurveBeat, State};
use crate::analysis::kind::Kind;
use crate::analysis::monotone::MonotoneCubic;
use crate::analysis::order::median;
use crate::analysis::trace::Point;
use crate::analysis::{Missing, Reading, value};

/// Points of a loop.
const POINTS: usize = 256;

/// A curve as it is read for pairs: interpolated between frames.
pub(super) struct Course<'a> {
    cubic: MonotoneCubic,
    pub(super) times: &'a [f64],
    pub(super) analysis: &'a Analysis,
    pub(super) kind: Kind,
    /// Unit of its heights: `%` of the length at rest for lengths.
    pub(super) unit: &'static str,
    /// Median time between frames, ms.
    pub(super) step: f64,
}

impl<'a> Course<'a> {
    pub(super) fn of(recorded: &Recorded<'a>) -> Self {
        let Recorded { times_ms: times, kind, unit, analysis } = *recorded;
        let cubic = MonotoneCubic::new(times.to_vec(), analysis.read.clone());
        let step = median(times.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(f64::NAN);
        let unit = if kind.is_length() { "%" } else { unit };
        Self { cubic, times, analysis, kind, unit, step }
    }

    /// The value at a time, in the curve's own unit.
    pub(super) fn at(&self, time: f64) -> f64 {
        self.cubic.at(time)
    }

    /// Factor from differences of values to heights: heights rise in a beat; those of lengths are in % of the length at
    /// rest.
    fn scale(&self, beat: &CurveBeat) -> f64 {
        let sign = if self.analysis.treatment.rises { 1.0 } else { -1.0 };
        match value(&beat.metrics, "resting_length").or(beat.baseline.map(|[start, _]| start.value))
        {
            Some(rest) if self.kind.is_length() => 100.0 * sign / rest,
            _ => sign,
        }
    }

    /// The height of a beat at its peak.
    pub(super) fn amplitude(&self, beat: &CurveBeat) -> Reading {
        let ends = beat.baseline.ok_or(Missing::NoRise)?;
        let peak = beat.marks.iter().find(|mark| mark.name == "peak").ok_or(Missing::NoRise)?;
        // The vertex of a parabola, between frames.
        let base =
            self.at(peak.point.time) - self.height(beat, ends, peak.point.time) / self.scale(beat);
        Ok(self.scale(beat) * (peak.point.value - base))
    }

    /// The height above the baseline of a beat at a time.
    pub(super) fn height(&self, beat: &CurveBeat, [start, end]: [Point; 2], time: f64) -> f64 {
        let way = (end.time - start.time).max(f64::MIN_POSITIVE);
        let base = start.value + (end.value - start.value) * (time - start.time) / way;
        self.scale(beat) * (self.at(time) - base)
    }
}

/// Calcium and motion over one beat.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// Times from the onset of calcium, ms.
    pub times_ms: Vec<f64>,
    /// Calcium, without drift, in its own unit.
    pub calcium: Vec<f64>,
    /// Motion or tension above rest, without drift: shortening in % of the length at rest for lengths.
    pub motion: Vec<f64>,
    /// Standard error of its area by the noise of both curves, unit of calcium times that of motion.
    pub area_error: f64,
}

impl Loop {
    /// Its signed area: above 0 if it is run through counter-clockwise with calcium to the right and motion upwards, as
    /// where motion follows calcium.
    pub fn area(&self) -> f64 {
        let Self { calcium, motion, .. } = self;
        let count = calcium.len();
        let corner = |at: usize| {
            let next = (at + 1) % count;
            // From the first point: a large level at rest would cost digits.
            let [x, next_x] = [at, next].map(|at| calcium[at] - calcium[0]);
            x * motion[next] - next_x * motion[at]
        };
        0.5 * (0..count).map(corner).sum::<f64>()
    }

    /// The mean of several loops over the time that all of them show.
    pub(super) fn mean(loops: &[(usize, Self)]) -> Option<Self> {
        let first = |list: &Self| list.times_ms[0];
        let last = |list: &Self| list.times_ms[list.times_ms.len() - 1];
        let from = loops.iter().map(|(_, one)| first(one)).reduce(f64::max)?;
        let to = loops.iter().map(|(_, one)| last(one)).reduce(f64::min)?;
        if from >= to {
            return None;
        }
        let count = loops.len() as f64;
        let times_ms = grid([from, to]);
        let mean = |read: fn(&Self) -> &Vec<f64>| {
            let mut sum = vec![0.0; times_ms.len()];
            for (_, one) in loops {
                let cubic = MonotoneCubic::new(one.times_ms.clone(), read(one).clone());
                sum.iter_mut()
                    .zip(&times_ms)
                    .for_each(|(sum, time)| *sum += cubic.at(*time) / count);
            }
            sum
        };
        let squares: f64 = loops.iter().map(|(_, one)| one.area_error.powi(2)).sum();
        Some(Self {
            calcium: mean(|one| &one.calcium),
            motion: mean(|one| &one.motion),
            area_error: squares.sqrt() / count,
            times_ms,
        })
    }
}

fn grid([from, to]: [f64; 2]) -> Vec<f64> {
    let last = (POINTS - 1) as f64;
    (0..POINTS).map(|at| from + (to - from) * at as f64 / last).collect()
}

/// The loop of a beat of calcium and motion.
pub(super) fn of_beat(courses: [&Course; 2], beats: [&CurveBeat; 2]) -> Result<Loop, Missing> {
    for beat in beats {
        match beat.state {
            State::Whole => {}
            State::Interrupted => return Err(Missing::Hole),
            State::Disturbed => return Err(Missing::Artefact),
            _ => return Err(Missing::Cut),
        }
    }
    let [Some(of_calcium), Some(of_motion)] = beats.map(|beat| beat.baseline) else {
        return Err(Missing::NoRise);
    };
    let [Some(onset), Some(other)] = beats.map(|beat| beat.onset_ms) else {
        return Err(Missing::NoRise);
    };
    let from = of_calcium[0].time.max(of_motion[0].time);
    let to = of_calcium[1].time.min(of_motion[1].time);
    let back = beats.iter().flat_map(|beat| &beat.marks).filter(|mark| mark.name == "90 % down");
    let back = back.map(|mark| mark.point.time).fold(f64::NEG_INFINITY, f64::max);
    // Both begin and end at rest.
    if from > onset.min(other) || to < back {
        return Err(Missing::Cut);
    }
    let times = grid([from, to]);
    let height = |side: usize, ends| {
        let (course, beat) = (courses[side], beats[side]);
        move |time: &f64| course.height(beat, ends, *time)
    };
    let rest = of_calcium[0].value;
    let scale = courses[0].scale(beats[0]);
    let calcium: Vec<f64> =
        times.iter().map(height(0, of_calcium)).map(|height| rest + height / scale).collect();
    let motion: Vec<f64> = times.iter().map(height(1, of_motion)).collect();
    // Half of the way of one curve over the two frames around a frame of the other, times its noise.
    let error = |side: usize, other: &dyn Fn(&f64) -> f64| {
        let course = courses[side];
        let noise = course.analysis.treatment.noise * course.scale(beats[side]).abs();
        let within: Vec<f64> =
            course.times.iter().copied().filter(|time| (from..=to).contains(time)).collect();
        let squares =
            within.windows(3).map(|three| (0.5 * (other(&three[2]) - other(&three[0]))).powi(2));
        noise * squares.sum::<f64>().sqrt()
    };
    let area_error = error(0, &height(1, of_motion)).hypot(error(1, &height(0, of_calcium)));
    let times_ms = times.iter().map(|time| time - onset).collect();
    Ok(Loop { times_ms, calcium, motion, area_error })
}
