//! Sobol's indices: the part of an answer's variance that each parameter causes.

use super::error::SensitivityError;
use super::groups::{OF_95_PERCENT, RESAMPLES, mean, spread, whole};
use crate::study::sampling::Random;
use serde::Serialize;

/// A group of rows of the design.
const GROUP: &str = "base points";

/// An index with its confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Index {
    /// Part of the variance, 0 to 1 up to the error of sampling.
    pub value: f64,
    /// Half of the 95 % confidence interval, by bootstrap over the base points.
    pub confidence: f64,
}

/// The interaction of two parameters beyond the effects of each alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pair {
    /// The two parameters, by their columns.
    pub of: [usize; 2],
    /// Its index.
    pub index: Index,
}

/// Sobol's indices of one answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Indices {
    /// For each parameter: the part of the variance that would vanish if it alone were known
    /// (Saltelli et al. 2010, Table 2 b).
    pub first: Vec<Index>,
    /// For each parameter: the part of the variance that would remain if all others were known
    /// (Jansen 1999).
    pub total: Vec<Index>,
    /// For each pair of parameters, if the design has them (Saltelli 2002).
    pub pairs: Vec<Pair>,
    /// Base points that were used.
    pub used: usize,
    /// Base points that were left out, since a member of theirs failed.
    pub left_out: usize,
}

/// The indices of one answer for the rows of
/// [`Sampler::Saltelli`](super::super::sampling::Sampler::Saltelli); `seed` is that of the
/// resamples of the confidence intervals.
///
/// Estimators are those of SALib 1.6, so that the same rows give the same indices.
///
/// # Errors
/// A wrong number of answers, fewer than two base points without a failure, or answers that do not
/// vary.
pub fn sobol(
    answers: &[f64],
    parameters: usize,
    pairs: bool,
    seed: u64,
) -> Result<Indices, SensitivityError> {
    let rows = if pairs { 2 * parameters + 2 } else { parameters + 2 };
    let groups = whole(answers, rows, GROUP, parameters)?;
    let all = groups.len() * rows;
    let middle = groups.iter().flat_map(|group| group.iter()).sum::<f64>() / all as f64;
    let square = |group: &&[f64]| group.iter().map(|y| (y - middle).powi(2)).sum::<f64>();
    let scale = (groups.iter().map(square).sum::<f64>() / all as f64).sqrt();
    if scale <= 1e-14 * middle.abs() {
        return Err(SensitivityError::Constant { value: middle });
    }
    // Centred, which makes the estimators more exact.
    let groups: Vec<Vec<f64>> =
        groups.iter().map(|group| group.iter().map(|y| (y - middle) / scale).collect()).collect();
    let every: Vec<usize> = (0..groups.len()).collect();
    let mut random = Random::new(seed, 0);
    let resamples: Vec<Vec<usize>> =
        (0..RESAMPLES).map(|_| every.iter().map(|_| random.below(every.len())).collect()).collect();
    let index = |estimate: &dyn Fn(&[usize]) -> f64| {
        let spread_of: Vec<f64> = resamples.iter().map(|list| estimate(list)).collect();
        Index { value: estimate(&every), confidence: OF_95_PERCENT * spread(&spread_of) }
    };
    let design = Design { groups: &groups, parameters };
    let of_all = |estimate: &dyn Fn(&[usize], usize) -> f64| {
        (0..parameters).map(|at| index(&|list| estimate(list, at))).collect()
    };
    let mut couples = Vec::new();
    for first in (0..parameters).filter(|_| pairs) {
        for second in first + 1..parameters {
            let of = [first, second];
            couples.push(Pair { of, index: index(&|list| design.pair(list, of)) });
        }
    }
    Ok(Indices {
        first: of_all(&|list, at| design.first(list, at)),
        total: of_all(&|list, at| design.total(list, at)),
        pairs: couples,
        used: groups.len(),
        left_out: answers.len() / rows - groups.len(),
    })
}

/// Answers, base point by base point.
struct Design<'a> {
    groups: &'a [Vec<f64>],
    parameters: usize,
}

impl Design<'_> {
    fn a(&self, group: usize) -> f64 {
        self.groups[group][0]
    }

    fn b(&self, group: usize) -> f64 {
        self.groups[group].last().copied().unwrap_or(f64::NAN)
    }

    /// A with one column of B.
    fn ab(&self, group: usize, column: usize) -> f64 {
        self.groups[group][1 + column]
    }

    /// B with one column of A.
    fn ba(&self, group: usize, column: usize) -> f64 {
        self.groups[group][1 + self.parameters + column]
    }

    /// Variance over the rows A and B.
    fn variance(&self, list: &[usize]) -> f64 {
        let both = || list.iter().flat_map(|&group| [self.a(group), self.b(group)]);
        let count = 2.0 * list.len() as f64;
        let middle = both().sum::<f64>() / count;
        both().map(|y| (y - middle).powi(2)).sum::<f64>() / count
    }

    fn first(&self, list: &[usize], column: usize) -> f64 {
        let of = |&group: &usize| self.b(group) * (self.ab(group, column) - self.a(group));
        mean(list.iter().map(of)) / self.variance(list)
    }

    fn total(&self, list: &[usize], column: usize) -> f64 {
        let of = |&group: &usize| (self.a(group) - self.ab(group, column)).powi(2);
        0.5 * mean(list.iter().map(of)) / self.variance(list)
    }

    fn pair(&self, list: &[usize], [one, other]: [usize; 2]) -> f64 {
        let of = |&group: &usize| {
            self.ba(group, one) * self.ab(group, other) - self.a(group) * self.b(group)
        };
        let both = mean(list.iter().map(of)) / self.variance(list);
        both - self.first(list, one) - self.first(list, other)
    }
}
