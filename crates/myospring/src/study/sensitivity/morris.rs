//! Morris's elementary effects: a cheap first ranking of many parameters.

use super::error::SensitivityError;
use super::groups::{OF_95_PERCENT, RESAMPLES, mean, spread, whole};
use crate::study::sampling::Random;
use serde::Serialize;

/// A group of rows of the design.
const GROUP: &str = "trajectories";

/// The effect of one parameter, in units of the answer, for a step over the parameter's whole
/// range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Effect {
    /// Mean of the elementary effects.
    pub mean: f64,
    /// Mean of their sizes, which ranks parameters (Campolongo et al. 2007).
    pub mean_size: f64,
    /// Half of its 95 % confidence interval, by bootstrap over the trajectories.
    pub confidence: f64,
    /// Their standard deviation: high if the effect is nonlinear or depends on other parameters.
    pub spread: f64,
}

/// The effects of all parameters on one answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effects {
    /// Of each parameter.
    pub effects: Vec<Effect>,
    /// Trajectories that were used.
    pub used: usize,
    /// Trajectories that were left out, since a member of theirs failed.
    pub left_out: usize,
}

/// The effects on one answer for the rows of
/// [`Sampler::Morris`](super::super::sampling::Sampler::Morris); `points` are those rows in the
/// unit cube ([`unit_cube`](super::super::sampling::Sampler::unit_cube)), `seed` is that of the
/// resamples of the confidence interval.
///
/// # Errors
/// A wrong number of answers, or fewer than two trajectories without a failure.
pub fn morris(
    points: &[Vec<f64>],
    answers: &[f64],
    parameters: usize,
    seed: u64,
) -> Result<Effects, SensitivityError> {
    let rows = parameters + 1;
    whole(answers, rows, GROUP, parameters)?;
    if points.len() != answers.len() || points.iter().any(|point| point.len() != parameters) {
        return Err(SensitivityError::Rows { answers: answers.len(), of: GROUP, rows, parameters });
    }
    let mut effects: Vec<Vec<f64>> = vec![Vec::new(); parameters];
    let trajectories = points.chunks_exact(rows).zip(answers.chunks_exact(rows));
    let all = trajectories.len();
    let complete = trajectories.filter(|(_, answers)| answers.iter().all(|y| y.is_finite()));
    for (points, answers) in complete {
        for (points, answers) in points.windows(2).zip(answers.windows(2)) {
            let steps = points[0].iter().zip(&points[1]).map(|(from, to)| to - from);
            for (effects, step) in effects.iter_mut().zip(steps).filter(|(_, step)| *step != 0.0) {
                effects.push((answers[1] - answers[0]) / step);
            }
        }
    }
    let used = effects.first().map_or(0, Vec::len);
    let mut random = Random::new(seed, 0);
    let resamples: Vec<Vec<usize>> =
        (0..RESAMPLES).map(|_| (0..used).map(|_| random.below(used)).collect()).collect();
    let effect = |effects: Vec<f64>| {
        let size = |&at: &usize| effects[at].abs();
        let means: Vec<f64> = resamples.iter().map(|list| mean(list.iter().map(size))).collect();
        Effect {
            mean: mean(effects.iter().copied()),
            mean_size: mean(effects.iter().map(|effect| effect.abs())),
            confidence: OF_95_PERCENT * spread(&means),
            spread: spread(&effects),
        }
    };
    Ok(Effects { effects: effects.into_iter().map(effect).collect(), used, left_out: all - used })
}
