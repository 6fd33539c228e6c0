//! Answers in groups of rows, and statistics of numbers.

use super::error::SensitivityError;

/// Resamples of a bootstrap.
pub(super) const RESAMPLES: usize = 200;
/// Standard deviations of a 95 % interval.
pub(super) const OF_95_PERCENT: f64 = 1.959_963_984_540_054;

/// The groups of rows in which every answer is a number.
pub(super) fn whole<'a>(
    answers: &'a [f64],
    rows: usize,
    of: &'static str,
    parameters: usize,
) -> Result<Vec<&'a [f64]>, SensitivityError> {
    if answers.is_empty() || !answers.len().is_multiple_of(rows) {
        return Err(SensitivityError::Rows { answers: answers.len(), of, rows, parameters });
    }
    let all = answers.len() / rows;
    let groups: Vec<&[f64]> = answers
        .chunks_exact(rows)
        .filter(|group| group.iter().all(|answer| answer.is_finite()))
        .collect();
    if groups.len() < 2 {
        return Err(SensitivityError::TooFew { whole: groups.len(), all, of });
    }
    Ok(groups)
}

pub(super) fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

/// Standard deviation of a sample.
pub(super) fn spread(values: &[f64]) -> f64 {
    let middle = mean(values.iter().copied());
    let squares: f64 = values.iter().map(|value| (value - middle).powi(2)).sum();
    (squares / (values.len() as f64 - 1.0)).sqrt()
}
