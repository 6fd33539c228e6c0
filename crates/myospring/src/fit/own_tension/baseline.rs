//! The level of a curve at rest over time.
//!
//! Each beat has a rest before it, the mean of some frames (`analysis::curve`). Where all rests agree within their noise, the
//! rest is their mean; else, where a line does, it is that line; else the lines between neighbours. The fewer numbers it
//! has, the less of its noise all frames share.

use crate::analysis::curve::{Analysis, State};

/// Standard deviations of chi squared above its mean beyond which a simpler rest is refused.
const REFUSED: f64 = 3.0;

/// The rest before a beat.
#[derive(Debug, Clone, Copy)]
struct Rest {
    time: f64,
    value: f64,
    deviation: f64,
}

/// The level at rest, and how sure it is.
#[derive(Debug, Clone)]
pub(super) enum Baseline {
    /// A line about a time: level and slope there, with their standard deviations.
    Line { about: f64, level: [f64; 2], slope: [f64; 2] },
    /// Straight from rest to rest, level before the first and after the last.
    Between(Vec<[f64; 3]>),
}

impl Baseline {
    /// `None` without any rest.
    pub(super) fn of(
        times: &[f64],
        values: &[f64],
        used: &[bool],
        analysis: &Analysis,
        noise: f64,
    ) -> Option<Self> {
        let mut rests: Vec<Rest> = Vec::new();
        for beat in analysis.beats.iter().filter(|beat| beat.state != State::CutAtStart) {
            let Some([from, to]) = beat.rest_frames else { continue };
            let frames: Vec<usize> = (from..to).filter(|&at| used[at]).collect();
            let count = frames.len() as f64;
            if frames.is_empty() {
                continue;
            }
            let mean = |of: &[f64]| frames.iter().map(|&at| of[at]).sum::<f64>() / count;
            let deviation = noise / count.sqrt();
            rests.push(Rest { time: mean(times), value: mean(values), deviation });
        }
        let first = *rests.first()?;
        if rests.len() == 1 {
            let (level, slope) = ([first.value, first.deviation], [0.0; 2]);
            return Some(Self::Line { about: first.time, level, slope });
        }
        let lines = [line(&rests, false), line(&rests, true)];
        let simple = lines.into_iter().flatten().find(|(_, excess)| *excess <= REFUSED);
        Some(simple.map_or_else(
            || {
                let point = |rest: &Rest| [rest.time, rest.value, rest.deviation];
                Self::Between(rests.iter().map(point).collect())
            },
            |(line, _)| line,
        ))
    }

    /// Level at a time (ms), and its standard deviation.
    pub(super) fn at(&self, time: f64) -> [f64; 2] {
        match self {
            Self::Line { about, level, slope } => {
                let by = time - about;
                [level[0] + by * slope[0], level[1].hypot(by * slope[1])]
            }
            Self::Between(points) => {
                let after = points.partition_point(|point| point[0] <= time);
                if after == 0 || after == points.len() {
                    let [_, value, deviation] = points[after.saturating_sub(1)];
                    return [value, deviation];
                }
                let ([from, low, of_low], [to, high, of_high]) = (points[after - 1], points[after]);
                let part = (time - from) / (to - from);
                let deviation = ((1.0 - part) * of_low).hypot(part * of_high);
                [low + part * (high - low), deviation]
            }
        }
    }
}

/// The weighted mean of rests, or the line through them, and by how many standard deviations chi squared is above its mean.
fn line(rests: &[Rest], sloped: bool) -> Option<(Baseline, f64)> {
    let freedom = rests.len().checked_sub(1 + usize::from(sloped))?;
    let weight = |rest: &Rest| 1.0 / (rest.deviation * rest.deviation);
    let all: f64 = rests.iter().map(weight).sum();
    let mean = |of: &dyn Fn(&Rest) -> f64| {
        rests.iter().map(|rest| weight(rest) * of(rest)).sum::<f64>() / all
    };
    let (about, level) = (mean(&|rest| rest.time), mean(&|rest| rest.value));
    let spread = mean(&|rest| (rest.time - about).powi(2));
    let slope = if sloped && spread > 0.0 {
        mean(&|rest| (rest.time - about) * rest.value) / spread
    } else {
        0.0
    };
    let off = |rest: &Rest| rest.value - level - slope * (rest.time - about);
    let chi_squared: f64 = rests.iter().map(|rest| weight(rest) * off(rest).powi(2)).sum();
    let freedom_or_one = freedom.max(1) as f64;
    let excess = (chi_squared - freedom as f64) / (2.0 * freedom_or_one).sqrt();
    let of_slope = if sloped { 1.0 / (all * spread).sqrt() } else { 0.0 };
    let line = Baseline::Line { about, level: [level, 1.0 / all.sqrt()], slope: [slope, of_slope] };
    Some((line, excess))
}
