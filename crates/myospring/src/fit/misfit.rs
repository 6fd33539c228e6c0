//! Structure in the residuals of a fitted curve: whether there is any, how large it is, and by how
//! much it widens the intervals.
//!
//! Two questions decide, since either alone misleads. *Is there a misfit?* Reduced chi squared
//! rejects a misfit of a thousandth of a beat in a clean curve and accepts one of a tenth in a
//! noisy one. Correlated residuals of neighbouring frames are a misfit, whatever their size. *Is it
//! large?* It is compared with the curve itself: the part of its variance that the misfit leaves
//! unexplained, which depends neither on the noise nor on how long the cell rests between beats.
//!
//! Residuals are averaged over blocks of 1, 2, 4, ... frames (`flyvbjerg_1989`); those of pure
//! noise stay independent of each other, those of a misfit do not as long as a block is shorter
//! than it. Residuals of several beats are also added up at the same time after the stimulus, where
//! a misfit that repeats exceeds the noise.
//!
//! With few frames a beat the residuals of a misfit alternate. Without structure, residuals far above the noise at rest
//! are a misfit, too.
//!
//! Correlated residuals count as fewer: the intervals use their variance over long stretches, not
//! that of a single frame (see also `TAKEN_UP`).

use super::problem::Source;

/// Score above which a correlation is not by chance: one in a thousand.
const NO_CHANCE: f64 = 3.1;
/// Residuals this many times as large as the noise at rest are not noise; that of a moving cell may be somewhat larger.
const LOUDER: f64 = 3.0;
/// Fewest blocks whose correlation is tested.
const FEWEST: usize = 12;
/// Sum of the squares of the coefficients of a fourth difference, 1 -4 6 -4 1.
const FOURTH_DIFFERENCE: f64 = 70.0;
/// Standard deviation of the noise's variance by fourth differences of `n` frames, times the square
/// root of `n`, over that variance; twice this is not by chance.
const OF_VARIANCE: f64 = 1.8;

/// The structure in the residuals of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Misfit {
    /// Its root mean square, in the curve's unit: 0 where the residuals look like noise.
    pub(super) size: f64,
    /// Part of the curve's variance that it leaves unexplained.
    pub(super) unexplained: f64,
    /// Frames that count as one, since their residuals are correlated: 1 for noise.
    pub(super) together: f64,
}

impl Misfit {
    /// The misfit of a source with these stimuli to its fitted curve.
    pub(super) fn of(source: &Source, stimuli: &[f64], fitted: &[f64]) -> Self {
        let Source { frames, used, .. } = source;
        let off = (0..fitted.len()).filter(|&at| used[at]);
        let off: Vec<f64> = off.map(|at| frames.values[at] - fitted[at]).collect();
        let found = Self::of_residuals(&off, &frames.times, &frames.values, used, stimuli);
        if found.size > 0.0 { found } else { Self::beyond(frames.noise, &off, &frames.values) }
    }

    /// Of residuals without a structure: with few frames a beat those of a misfit alternate. Residuals far above the noise
    /// at rest are then no noise, either.
    fn beyond(noise: f64, off: &[f64], values: &[f64]) -> Self {
        let all = mean(off.iter().map(|value| value * value));
        if all <= (LOUDER * noise).powi(2) {
            return Self { size: 0.0, unexplained: 0.0, together: 1.0 };
        }
        let variance = all - noise.powi(2);
        let middle = mean(values.iter().copied());
        let of_curve = mean(values.iter().map(|value| (value - middle).powi(2)));
        let of_curve = of_curve.max(variance).max(f64::MIN_POSITIVE);
        Self { size: variance.sqrt(), unexplained: variance / of_curve, together: 1.0 }
    }

    /// Of residuals of the frames that count, at these times and values of all frames.
    pub(super) fn of_residuals(
        off: &[f64],
        times: &[f64],
        values: &[f64],
        used: &[bool],
        stimuli: &[f64],
    ) -> Self {
        let counted = |of: &[f64]| -> Vec<f64> {
            of.iter().zip(used).filter(|(_, used)| **used).map(|(value, _)| *value).collect()
        };
        Self::in_residuals(off, &beat_upon_beat(off, &counted(times), stimuli), &counted(values))
    }

    fn in_residuals(off: &[f64], folded: &Folded, values: &[f64]) -> Self {
        let none = Self { size: 0.0, unexplained: 0.0, together: 1.0 };
        let all = mean(off.iter().map(|value| value * value));
        let along = Structure::of(off);
        let repeated = Structure::of(&folded.sums);
        if all <= 0.0 || (along.is_none() && repeated.is_none()) {
            return none;
        }
        let white = noise_variance(off);
        let sure = white * (1.0 + 2.0 * OF_VARIANCE / (off.len() as f64).sqrt());
        let variance = along
            .as_ref()
            .map_or(0.0, |found| found.variance.max(all - sure))
            .max(repeated.as_ref().map_or(0.0, |found| found.variance / folded.beats));
        let over_long = [along, repeated].into_iter().flatten().map(|found| found.over_long);
        let middle = mean(values.iter().copied());
        let of_curve = mean(values.iter().map(|value| (value - middle).powi(2)));
        // The variance of the curve without its noise.
        let of_curve = (of_curve - white).max(variance).max(f64::MIN_POSITIVE);
        Self {
            size: variance.sqrt(),
            unexplained: variance / of_curve,
            together: (over_long.fold(0.0, f64::max) / all).max(1.0),
        }
    }
}

/// Residuals at the same time after the stimulus, added up beat upon beat.
struct Folded {
    /// Sums over the square root of how many there are: noise keeps its variance.
    sums: Vec<f64>,
    /// Residuals in each sum, on average.
    beats: f64,
}

fn beat_upon_beat(off: &[f64], times: &[f64], stimuli: &[f64]) -> Folded {
    let nothing = Folded { sums: Vec::new(), beats: 1.0 };
    if stimuli.len() < 2 || times.len() < 2 {
        return nothing;
    }
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let step = steps[steps.len() / 2];
    let mut sums: Vec<(f64, usize)> = Vec::new();
    for (time, off) in times.iter().zip(off) {
        let beat = stimuli.partition_point(|stimulus| stimulus <= time);
        let Some(stimulus) = beat.checked_sub(1).map(|beat| stimuli[beat]) else { continue };
        let place = ((time - stimulus) / step) as usize;
        if place >= times.len() {
            continue;
        }
        if place >= sums.len() {
            sums.resize(place + 1, (0.0, 0));
        }
        sums[place].0 += off;
        sums[place].1 += 1;
    }
    let known = || sums.iter().filter(|(_, count)| *count > 0);
    let count = known().count();
    if count == 0 {
        return nothing;
    }
    Folded {
        beats: known().map(|(_, count)| *count as f64).sum::<f64>() / count as f64,
        sums: known().map(|(sum, count)| sum / (*count as f64).sqrt()).collect(),
    }
}

/// The correlated part of successive values.
struct Structure {
    /// Its variance.
    variance: f64,
    /// Variance of a mean over a long stretch, times the number of values in it.
    over_long: f64,
}

impl Structure {
    /// `None` where the values are independent of each other, as noise is.
    fn of(values: &[f64]) -> Option<Self> {
        let mut blocks = values.to_vec();
        let mut length = 1.0;
        let mut best: Option<(f64, Self)> = None;
        while blocks.len() >= FEWEST {
            let own = together(&blocks, 0);
            let next = together(&blocks, 1);
            let score = next / own * (blocks.len() as f64).sqrt();
            if score > NO_CHANCE && best.as_ref().is_none_or(|(other, _)| score > *other) {
                // Up to the first lag at which they are not correlated.
                let lags = (1..blocks.len()).map(|lag| together(&blocks, lag));
                let ahead: f64 = lags.take_while(|value| *value > 0.0).sum();
                let over_long = length * (own + 2.0 * ahead);
                best = Some((score, Self { variance: next, over_long }));
            }
            blocks = blocks.chunks_exact(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect();
            length *= 2.0;
        }
        best.map(|(_, structure)| structure)
    }
}

/// Mean product of values at this lag.
fn together(values: &[f64], lag: usize) -> f64 {
    let sum: f64 = values.iter().zip(&values[lag..]).map(|(a, b)| a * b).sum();
    sum / values.len() as f64
}

/// Variance of the noise of a frame, by fourth differences, which no smooth misfit has.
fn noise_variance(values: &[f64]) -> f64 {
    let bent = values.windows(5).map(|at| at[0] - 4.0 * at[1] + 6.0 * at[2] - 4.0 * at[3] + at[4]);
    mean(bent.map(|bent| bent * bent)) / FOURTH_DIFFERENCE
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
    sum / count.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::sampling::{Distribution, Sampler, sample};

    /// Frames of a beat that rises and falls, of height 1: `beats` of them, 160 frames each.
    fn curve(beats: usize) -> Vec<f64> {
        let beat = |at: usize| {
            let time = at as f64 / 160.0;
            (time / 0.15).powi(2) * (2.0 * (1.0 - time / 0.15)).exp()
        };
        (0..160 * beats).map(|frame| beat(frame % 160)).collect()
    }

    fn noise(count: usize, deviation: f64, seed: u64) -> Vec<f64> {
        let normal = Distribution::Normal { mean: 0.0, standard_deviation: deviation };
        sample(&Sampler::LatinHypercube { size: count }, &[normal], seed)
            .unwrap()
            .iter()
            .map(|row| row[0])
            .collect()
    }

    fn misfit(beats: usize, deviation: f64, seed: u64, off: impl Fn(f64) -> f64) -> Misfit {
        let measured = curve(beats);
        let noise = noise(measured.len(), deviation, seed);
        let part = |frame: usize| (frame % 160) as f64 / 160.0;
        let off: Vec<f64> =
            noise.iter().enumerate().map(|(frame, noise)| noise + off(part(frame))).collect();
        let values: Vec<f64> = measured.iter().zip(&noise).map(|(a, b)| a + b).collect();
        let times: Vec<f64> = (0..off.len()).map(|frame| 4.0 * frame as f64).collect();
        let stimuli: Vec<f64> = (0..beats).map(|beat| 640.0 * beat as f64).collect();
        Misfit::in_residuals(&off, &beat_upon_beat(&off, &times, &stimuli), &values)
    }

    #[test]
    fn residuals_that_alternate_are_a_misfit_where_they_are_far_above_the_noise() {
        let values = curve(1);
        // Every eighth frame: ten frames in the beat.
        let values: Vec<f64> = values.into_iter().step_by(8).collect();
        let off = |size: f64| -> Vec<f64> {
            (0..values.len()).map(|at| if at % 2 == 0 { size } else { -size }).collect()
        };
        assert!(Misfit::beyond(0.01, &off(0.029), &values).size == 0.0);
        let found = Misfit::beyond(0.01, &off(0.1), &values);
        assert!((found.size - 0.0995).abs() < 1e-4 && found.unexplained > 0.01, "{found:?}");
    }

    #[test]
    fn noise_of_any_size_has_no_structure() {
        for beats in [1, 5] {
            let found = (0..300).filter(|seed| {
                misfit(beats, [1e-6, 0.01, 0.2][*seed as usize % 3], *seed, |_| 0.0).size > 0.0
            });
            // One score in a thousand is so large, of some ten that are looked at, most of which go together.
            let found = found.count();
            assert!(found <= 4, "{found} of 300, {beats} beats");
        }
    }

    #[test]
    fn a_misfit_has_its_size_whatever_the_noise_on_top_of_it() {
        // A wave along the beat: root mean square 0.07, as a beat of height 1 has it that is seen to be off.
        let wave = |part: f64| 0.1 * (std::f64::consts::TAU * 2.0 * part).sin();
        for (deviation, beats) in [(1e-9, 1), (1e-5, 1), (0.01, 1), (0.05, 1), (0.2, 5)] {
            let Misfit { size, unexplained, together } = misfit(beats, deviation, 3, wave);
            assert!((0.05..0.1).contains(&size), "{deviation}: {size}");
            assert!((0.02..0.12).contains(&unexplained), "{deviation}: {unexplained}");
            assert!(together > 2.0, "{deviation}: {together}");
        }
    }

    #[test]
    fn a_misfit_that_repeats_counts_once_however_many_beats_there_are() {
        // Twice the beats tell no more of a model that is off in each of them alike.
        let wave = |part: f64| 0.01 * (std::f64::consts::TAU * 2.0 * part).sin();
        let frames = |beats: usize| 160.0 * beats as f64 / misfit(beats, 1e-4, 5, wave).together;
        let [one, many] = [frames(1), frames(12)];
        assert!((0.5..2.0).contains(&(many / one)), "{one} {many}");
    }

    #[test]
    fn how_long_a_cell_rests_changes_little() {
        let off: Vec<f64> = curve(1).iter().map(|value| 0.1 * value * (1.0 - value)).collect();
        let with_rest = |rest: usize| {
            let pad = |values: &[f64]| [values, &vec![0.0; rest]].concat();
            let nothing = Folded { sums: Vec::new(), beats: 1.0 };
            Misfit::in_residuals(&pad(&off), &nothing, &pad(&curve(1))).unexplained
        };
        let [short, long] = [with_rest(0), with_rest(1600)];
        assert!((0.5..2.0).contains(&(long / short)), "{short} {long}");
    }
}
