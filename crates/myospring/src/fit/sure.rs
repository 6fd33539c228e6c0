//! Intervals of a fit: profiles of its likelihood, and by how much a misfit widens them.

use super::least_squares::Least;
use super::likelihood::{Profile, Top, covariance, profile, rise_at_ends};
use super::problem::Layout;
use super::work::Work;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A local minimum this much worse than the ends of an interval does not affect it.
const FAR: f64 = 4.0;
/// Answers that differ by fewer steps than this in each unknown count as the same.
const ONE_ANSWER: f64 = 10.0;
/// Residuals show only the part of a misfit that the fitted numbers have not absorbed, so intervals
/// are wider by this factor. It was measured with cells that differ from their model
/// (`docs/reference/accuracy.md`).
const TAKEN_UP: f64 = 3.5;
/// Fewest independent stretches of a misfit.
const FEWEST: f64 = 2.0;
/// Part of the work that the search takes.
pub(super) const SEARCH: f64 = 0.6;

/// Profiles of the best of several answers.
pub(super) struct Sure {
    pub(super) profiles: Vec<Profile>,
    pub(super) covariance: Option<Vec<Vec<f64>>>,
    /// Variance of a residual times the factor; estimated from all residuals, since few frames are
    /// at rest.
    pub(super) unit: f64,
    /// Rise of chi squared at the ends of an interval, over that variance.
    pub(super) at_ends: f64,
    /// Chi squared over its degrees of freedom.
    pub(super) reduced: f64,
    /// The variance that intervals use, over that of the residuals.
    pub(super) factor: f64,
}

impl Sure {
    /// Standard deviation of a residual that intervals use; `None` if there is no curve at this answer.
    pub(super) fn deviation(layout: &Layout, least: &Least) -> Option<f64> {
        let Variance { reduced, factor, .. } = Variance::of(layout, least)?;
        Some((factor * reduced).max(f64::MIN_POSITIVE).sqrt())
    }

    /// `ends` are answers, the best first. Profiles are computed for the unknowns that are
    /// reported. `None` if it was stopped.
    pub(super) fn of(
        layout: &Layout,
        ends: &[Least],
        shown: &[usize],
        work: &Work<'_>,
    ) -> Option<Self> {
        let least = &ends[0];
        let Variance { reduced, factor, together, freedom } = Variance::of(layout, least)?;
        let unit = (factor * reduced).max(f64::MIN_POSITIVE);
        let independent = least.residuals.len() as f64 / together - shown.len() as f64;
        let at_ends = rise_at_ends(if together > 1.0 { independent.max(FEWEST) } else { freedom });
        let residuals = layout.counted(work);
        let slopes = |at: &[f64], held: &[bool]| layout.slopes(at, held, work);
        let problem = layout.problem(&residuals, &slopes);
        let covariance = covariance(&problem, least);
        let mut others = others(layout, ends);
        others.retain(|other| (other.sum - least.sum) / unit < FAR * at_ends);
        let top = Top { least, others: &others, unit, at_ends };
        let done = AtomicUsize::new(0);
        let profiles: Vec<Option<Profile>> = shown
            .par_iter()
            .map(|&place| {
                let [low, high] = layout.bounds[place];
                let deviation = covariance.as_ref().map(|all| (all[place][place] * unit).sqrt());
                let guess = deviation.unwrap_or(0.01 * (high - low));
                let profile = profile(&problem, &top, place, 2.0 * guess);
                let part = (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / shown.len() as f64;
                work.done(SEARCH + (1.0 - SEARCH) * part).then_some(profile)
            })
            .collect();
        let profiles = profiles.into_iter().collect::<Option<Vec<_>>>()?;
        Some(Self { profiles, covariance, unit, at_ends, reduced, factor })
    }
}

/// The factor by which a misfit raises the variance that intervals use; `together` frames count as one.
pub(super) fn widened(together: f64) -> f64 {
    if together > 1.0 { together * TAKEN_UP.powi(2) } else { 1.0 }
}

/// The variance of residuals, and by how much a misfit raises it for intervals.
struct Variance {
    reduced: f64,
    factor: f64,
    together: f64,
    freedom: f64,
}

impl Variance {
    fn of(layout: &Layout, least: &Least) -> Option<Self> {
        let freedom = least.residuals.len().saturating_sub(layout.roles.len()).max(1) as f64;
        let together = layout.frames_together(least)?;
        let factor = widened(together);
        Some(Self { reduced: least.sum / freedom, factor, together, freedom })
    }
}

/// All answers but the best, each once.
fn others(layout: &Layout, ends: &[Least]) -> Vec<Least> {
    let is_one = |a: &Least, b: &Least| {
        let mut both = a.at.iter().zip(&b.at).zip(&layout.steps);
        both.all(|((a, b), step)| (a - b).abs() < ONE_ANSWER * step)
    };
    let mut others: Vec<Least> = Vec::new();
    for end in &ends[1..] {
        if !is_one(end, &ends[0]) && !others.iter().any(|other| is_one(end, other)) {
            others.push(end.clone());
        }
    }
    others
}
