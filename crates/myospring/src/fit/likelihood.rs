//! How sure a fit is: profiles of the likelihood, and the covariance at its top.

use super::answer::Verdict;
use super::least_squares::{Least, Problem, inverse, normal};

/// Rise of chi squared at the ends of a 95 % interval of one parameter.
pub(super) const OF_95_PERCENT: f64 = 3.841_458_820_694_124;
/// Rise that a profile is drawn up to.
const DRAWN: f64 = 8.0;
/// Points of a profile on either side.
const POINTS: usize = 6;
/// Times that the way to an end may double, and refinements of that end.
const DOUBLINGS: usize = 24;
const REFINEMENTS: usize = 12;
/// On a bound, over the distance between the bounds.
const ON_BOUND: f64 = 1e-6;

/// The profile of one unknown.
pub(super) struct Profile {
    /// Ends of its interval; `None` where the bound comes first.
    pub(super) ends: [Option<f64>; 2],
    /// Value and rise.
    pub(super) points: Vec<[f64; 2]>,
    pub(super) verdict: Verdict,
}

/// Covariance of the unknowns, each standard deviation over the noise of one; `None` of what has no curvature.
pub(super) fn covariance(problem: &Problem<'_>, least: &Least) -> Option<Vec<Vec<f64>>> {
    let held = vec![false; least.at.len()];
    let columns = problem.jacobian(&least.at, &held)?;
    inverse(&normal(&columns, &least.residuals).0)
}

/// Follows the likelihood of one unknown away from its top, all others as likely as they can be. `unit` is what chi
/// squared rises by for one standard deviation, `guess` about that deviation.
pub(super) fn profile(
    problem: &Problem<'_>,
    least: &Least,
    place: usize,
    unit: f64,
    guess: f64,
) -> Profile {
    let [low, high] = problem.bounds[place];
    let top = least.at[place];
    let mut held = vec![false; least.at.len()];
    held[place] = true;
    let mut points = vec![[top, 0.0]];
    let mut end_of = |side: usize| {
        let (bound, sign) = if side == 0 { (low, -1.0) } else { (high, 1.0) };
        let mut near = (top, 0.0, least.at.clone());
        let rise = |value: f64, from: &[f64]| {
            let mut start = from.to_vec();
            start[place] = value;
            let found = problem.minimise(&start, &held)?;
            Some((value, (found.sum - least.sum) / unit, found.at))
        };
        let mut width = guess.clamp(1e-9 * (high - low), high - low);
        let mut far = None;
        for _ in 0..DOUBLINGS {
            let value =
                if sign < 0.0 { (top - width).max(bound) } else { (top + width).min(bound) };
            let Some(there) = rise(value, &near.2) else { break };
            points.push([there.0, there.1]);
            if there.1 >= OF_95_PERCENT {
                far = Some(there);
                break;
            }
            near = there;
            if value == bound {
                break;
            }
            width *= 2.0;
        }
        let mut far = far?;
        // The square root of the rise is nearly a straight line.
        for _ in 0..REFINEMENTS {
            let [from, to] = [near.1.max(0.0).sqrt(), far.1.sqrt()];
            let part = ((OF_95_PERCENT.sqrt() - from) / (to - from)).clamp(0.05, 0.95);
            let value = near.0 + part * (far.0 - near.0);
            let Some(there) = rise(value, &near.2) else { break };
            let close = (there.1 - OF_95_PERCENT).abs() < 0.01;
            if there.1 < OF_95_PERCENT {
                near = there;
            } else {
                far = there;
            }
            if close {
                break;
            }
        }
        let end = if (near.1 - OF_95_PERCENT).abs() < (far.1 - OF_95_PERCENT).abs() {
            near.0
        } else {
            far.0
        };
        // What a figure shows.
        let reach = (end - top) * (DRAWN / OF_95_PERCENT).sqrt();
        let mut from = least.at.clone();
        for point in 1..=POINTS {
            let value = (top + reach * point as f64 / POINTS as f64).clamp(low, high);
            if let Some(there) = rise(value, &from) {
                points.push([there.0, there.1]);
                from = there.2;
            }
        }
        Some(end)
    };
    let ends = [end_of(0), end_of(1)];
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points.dedup_by_key(|point| point[0]);
    let margin = ON_BOUND * (high - low);
    let verdict = match ends {
        [None, None] => Verdict::NotDetermined,
        _ if top <= low + margin => Verdict::AtLowerBound,
        _ if top >= high - margin => Verdict::AtUpperBound,
        [Some(_), None] => Verdict::AtLeast,
        [None, Some(_)] => Verdict::AtMost,
        [Some(_), Some(_)] => Verdict::Determined,
    };
    Profile { ends, points, verdict }
}
