//! Profiles of the likelihood, and the covariance at its maximum.

use super::answer::Verdict;
use super::least_squares::{Least, Problem, inverse, normal};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Rise of chi squared at the ends of a 95 % interval of one parameter where the noise is known.
pub(super) const OF_95_PERCENT: f64 = 3.841_458_820_694_124;
/// The largest rise that is drawn, relative to that at the ends of the interval.
const DRAWN: f64 = 2.0;
/// Points of a profile on either side.
const POINTS: usize = 6;
/// Largest number of doublings of the search for an end, of refinements of that end, and of ends
/// found further out.
const DOUBLINGS: usize = 24;
const REFINEMENTS: usize = 12;
const ROUNDS: usize = 3;
/// Tolerance of the rise at an end.
const CLOSE: f64 = 0.01;
/// On a bound, over the distance between the bounds.
const ON_BOUND: f64 = 1e-6;

/// The maximum of the likelihood.
pub(super) struct Top<'a> {
    pub(super) least: &'a Least,
    /// Other local maxima.
    pub(super) others: &'a [Least],
    /// Rise of the sum of squares at one standard deviation: the variance of a residual.
    pub(super) unit: f64,
    /// Rise at the ends of an interval.
    pub(super) at_ends: f64,
}

/// The profile of one unknown.
pub(super) struct Profile {
    /// Ends of its interval; `None` where the bound comes first.
    pub(super) ends: [Option<f64>; 2],
    /// Value and rise.
    pub(super) points: Vec<[f64; 2]>,
    pub(super) verdict: Verdict,
    /// The lowest point and its rise, which is below 0 if it is better than the answer.
    pub(super) lowest: (f64, Vec<f64>),
}

/// Covariance of the unknowns, each standard deviation over the noise of one; `None` of what has no curvature.
pub(super) fn covariance(problem: &Problem<'_>, least: &Least) -> Option<Vec<Vec<f64>>> {
    let held = vec![false; least.at.len()];
    let columns = problem.jacobian(&least.at, &held)?;
    inverse(&normal(&columns, &least.residuals).0)
}

/// Rise of chi squared at the ends of a 95 % interval, in units of the variance of a residual,
/// which was estimated with `freedom` degrees of freedom: the square of Student's quantile, 3.84 for
/// many.
pub(super) fn rise_at_ends(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom)
        .map_or(OF_95_PERCENT, |student| student.inverse_cdf(0.975).powi(2))
}

/// A value of the unknown, how far chi squared has risen there, and all unknowns.
#[derive(Clone)]
struct Point {
    value: f64,
    rise: f64,
    at: Vec<f64>,
}

/// The profile of one unknown in one direction: all others are fitted again at each value.
struct Way<'a> {
    problem: &'a Problem<'a>,
    top: &'a Top<'a>,
    place: usize,
    held: Vec<bool>,
    sign: f64,
    bound: f64,
}

/// The profile of one unknown; `guess` is about two standard deviations.
pub(super) fn profile(problem: &Problem<'_>, top: &Top<'_>, place: usize, guess: f64) -> Profile {
    let [low, high] = problem.bounds[place];
    let peak = top.least.at[place];
    let mut held = vec![false; top.least.at.len()];
    held[place] = true;
    let side = |sign: f64| {
        let bound = if sign < 0.0 { low } else { high };
        Way { problem, top, place, held: held.clone(), sign, bound }.follow(guess, high - low)
    };
    let ((lower, mut below), (upper, above)) = rayon::join(|| side(-1.0), || side(1.0));
    below.reverse();
    below.pop();
    below.extend(above);
    let ends = [lower, upper];
    let lowest = below.iter().min_by(|a, b| a.rise.total_cmp(&b.rise));
    let lowest = lowest.map_or((0.0, top.least.at.clone()), |point| (point.rise, point.at.clone()));
    let mut points: Vec<[f64; 2]> = below.iter().map(|point| [point.value, point.rise]).collect();
    points.dedup_by_key(|point| point[0]);
    let margin = ON_BOUND * (high - low);
    let verdict = match ends {
        [None, None] => Verdict::NotDetermined,
        _ if peak <= low + margin => Verdict::AtLowerBound,
        _ if peak >= high - margin => Verdict::AtUpperBound,
        [Some(_), None] => Verdict::AtLeast,
        [None, Some(_)] => Verdict::AtMost,
        [Some(_), Some(_)] => Verdict::Determined,
    };
    Profile { ends, points, verdict, lowest }
}

impl Way<'_> {
    /// The end of the interval and the points on the way, outwards from the top.
    fn follow(&self, guess: f64, range: f64) -> (Option<f64>, Vec<Point>) {
        let Top { least, others, at_ends, .. } = *self.top;
        let top = least.at[self.place];
        let mut points = vec![Point { value: top, rise: 0.0, at: least.at.clone() }];
        for other in others {
            let value = other.at[self.place];
            let rise = self.rise(other);
            if self.sign * (value - top) > 0.0 && rise < at_ends {
                points.push(Point { value, rise, at: other.at.clone() });
            }
        }
        self.order(&mut points);
        let mut end = None;
        for round in 0..ROUNDS {
            // The outermost point within the interval: a profile may fall again after it rose.
            let Some(near) = points.iter().rposition(|point| point.rise < at_ends) else { break };
            if near + 1 == points.len() && !self.go_out(&mut points, guess, range) {
                end = None;
                self.come_back(&mut points);
                break;
            }
            let found = self.refine(&mut points);
            let was = end.replace(found);
            if round == 0 {
                self.draw(&mut points, found);
            }
            self.come_back(&mut points);
            let outermost = points.iter().rfind(|point| point.rise < at_ends - CLOSE);
            let within =
                |end: f64| outermost.is_none_or(|point| self.sign * (point.value - end) <= 0.0);
            if was == end || within(found) {
                break;
            }
        }
        (end, points)
    }

    fn rise(&self, at: &Least) -> f64 {
        (at.sum - self.top.least.sum) / self.top.unit
    }

    fn order(&self, points: &mut [Point]) {
        points.sort_by(|a, b| (self.sign * a.value).total_cmp(&(self.sign * b.value)));
    }

    /// Fits all other unknowns at a value, starting from a nearby point.
    fn at(&self, value: f64, near: &[f64]) -> Option<Point> {
        let Top { least, others, .. } = *self.top;
        let distance = |other: &&Least| (other.at[self.place] - value).abs();
        let known = (!others.is_empty()).then(|| {
            let all = others.iter().chain([least]);
            all.min_by(|a, b| distance(a).total_cmp(&distance(b)))
        });
        let from = [Some(near), known.flatten().map(|known| known.at.as_slice())];
        let found = from.into_iter().flatten().filter_map(|from| {
            let mut start = from.to_vec();
            start[self.place] = value;
            self.problem.minimise(&start, &self.held)
        });
        let least = found.min_by(|a, b| a.sum.total_cmp(&b.sum))?;
        Some(Point { value, rise: self.rise(&least), at: least.at })
    }

    /// Moves outwards in doubling steps until the rise is too large; `false` if the bound comes
    /// first.
    fn go_out(&self, points: &mut Vec<Point>, guess: f64, range: f64) -> bool {
        let top = self.top.least.at[self.place];
        let last = points.last().map_or(top, |point| point.value);
        let mut width = guess.clamp(1e-9 * range, range);
        while width <= (last - top).abs() {
            width *= 2.0;
        }
        for _ in 0..DOUBLINGS {
            let value = top + self.sign * width;
            let beyond = self.sign * (value - self.bound) >= 0.0;
            let value = if beyond { self.bound } else { value };
            let Some(from) = points.last().cloned() else { return false };
            if from.value == value {
                return false;
            }
            let Some(there) = self.at(value, &from.at) else { return false };
            let unlikely = there.rise >= self.top.at_ends;
            points.push(there);
            if unlikely || beyond {
                return unlikely;
            }
            width *= 2.0;
        }
        false
    }

    /// The end between the outermost point within the interval and the next.
    fn refine(&self, points: &mut Vec<Point>) -> f64 {
        let at_ends = self.top.at_ends;
        let is_near = |point: &Point| point.rise < at_ends;
        let place = points.iter().rposition(is_near).unwrap_or(0);
        let mut near = points[place].clone();
        let mut far = points[(place + 1).min(points.len() - 1)].clone();
        for _ in 0..REFINEMENTS {
            if [&near, &far].iter().any(|point| (point.rise - at_ends).abs() < CLOSE) {
                break;
            }
            // The square root of the rise is nearly linear.
            let [from, to] = [near.rise.max(0.0).sqrt(), far.rise.sqrt()];
            let part = ((at_ends.sqrt() - from) / (to - from)).clamp(0.05, 0.95);
            let value = near.value + part * (far.value - near.value);
            let Some(there) = self.at(value, &near.at) else { break };
            points.push(there.clone());
            if is_near(&there) {
                near = there;
            } else {
                far = there;
            }
        }
        self.order(points);
        if (near.rise - at_ends).abs() < (far.rise - at_ends).abs() {
            near.value
        } else {
            far.value
        }
    }

    /// Adds the points that a figure shows.
    fn draw(&self, points: &mut Vec<Point>, end: f64) {
        let least = self.top.least;
        let top = least.at[self.place];
        let reach = (end - top) * DRAWN.sqrt();
        let mut from = least.at.clone();
        let bounds = self.problem.bounds[self.place];
        for point in 1..=POINTS {
            let value = top + reach * point as f64 / POINTS as f64;
            if let Some(there) = self.at(value.clamp(bounds[0], bounds[1]), &from) {
                from.clone_from(&there.at);
                points.push(there);
            }
        }
        self.order(points);
    }

    /// Fits the points again inwards, each from the one beyond it, which finds other branches.
    fn come_back(&self, points: &mut [Point]) {
        // A single minimum with a rise that only grows has no other branch.
        if self.top.others.is_empty() && points.is_sorted_by(|a, b| a.rise <= b.rise) {
            return;
        }
        for place in (1..points.len().saturating_sub(1)).rev() {
            let mut start = points[place + 1].at.clone();
            start[self.place] = points[place].value;
            let Some(least) = self.problem.minimise(&start, &self.held) else { continue };
            let rise = self.rise(&least);
            if rise < points[place].rise {
                points[place] = Point { value: points[place].value, rise, at: least.at };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn top(problem: &Problem<'_>, start: &[f64], others: &[Least]) -> Profile {
        let least = problem.minimise(start, &vec![false; start.len()]).unwrap();
        let top = Top { least: &least, others, unit: 1.0, at_ends: OF_95_PERCENT };
        profile(problem, &top, 0, 0.5)
    }

    #[test]
    fn ends_of_a_parabola_are_where_normal_statistics_put_them() {
        // Standard deviation 1 of the first, whatever becomes of the second.
        let residuals = |x: &[f64]| Some(vec![x[0] - 2.0, 3.0 * (x[1] - x[0])]);
        let bounds = [[-50.0, 50.0]; 2];
        let problem = Problem::plain(&residuals, &bounds, &[1e-4; 2]);
        let found = top(&problem, &[0.0, 0.0], &[]);
        let [Some(low), Some(high)] = found.ends else { panic!("{:?}", found.ends) };
        assert!((low - 0.04).abs() < 0.01 && (high - 3.96).abs() < 0.01, "{low} {high}");
        assert_eq!(found.verdict, Verdict::Determined);
        assert!(found.points.is_sorted_by(|a, b| a[0] < b[0]));
    }

    #[test]
    fn an_interval_reaches_the_second_valley_that_is_as_likely() {
        // Chi squared of sin^2 and a slope: valleys at 0 and 1, 0.01 apart in depth; between them it rises to 25.
        let residuals = |x: &[f64]| {
            Some(vec![5.0 * (std::f64::consts::PI * x[0]).sin(), 0.1 * x[0], 4.0 * (x[0] - 0.5)])
        };
        let bounds = [[-3.0, 3.0]];
        let problem = Problem::plain(&residuals, &bounds, &[1e-5]);
        let other = problem.minimise(&[0.9], &[false]).unwrap();
        let found = top(&problem, &[0.1], &[other]);
        let [Some(low), Some(high)] = found.ends else { panic!("{:?}", found.ends) };
        assert!((-0.3..0.0).contains(&low) && (1.0..1.3).contains(&high), "{low} {high}");
    }

    #[test]
    fn a_profile_tells_of_a_place_that_is_lower_than_its_top() {
        let residuals =
            |x: &[f64]| Some(vec![2.0 * (std::f64::consts::PI * x[0]).sin(), 0.6 * (x[0] - 1.0)]);
        let bounds = [[-3.0, 3.0]];
        let problem = Problem::plain(&residuals, &bounds, &[1e-5]);
        let found = top(&problem, &[0.0], &[]);
        assert!(found.lowest.0 < -0.05, "{:?}", found.lowest);
        let lower = problem.minimise(&found.lowest.1, &[false]).unwrap();
        assert!((lower.at[0] - 1.0).abs() < 1e-3);
    }

    #[test]
    fn few_frames_widen_an_interval_as_students_distribution_says() {
        // Tables: 2.228 of 10 degrees of freedom, 1.960 of many.
        assert!((rise_at_ends(10.0).sqrt() - 2.228).abs() < 1e-3);
        assert!((rise_at_ends(1e5) - OF_95_PERCENT).abs() < 1e-3);
    }
}
