//! Least squares within bounds: the method of Levenberg and Marquardt (`more_1978`), for a few unknowns.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Steps at most.
const STEPS: usize = 60;
/// First damping, relative to the diagonal.
const DAMPING: f64 = 1e-3;
/// Factor on the damping after a step that did not lower the sum; doubled after each further one
/// (`nielsen_1999`).
const RAISED: f64 = 4.0;
/// Damping at which no direction lowers the sum any more.
const STUCK: f64 = 1e10;

/// Numbers as a function of the unknowns; `None` where it is not defined.
type Function<'a> = &'a (dyn Fn(&[f64]) -> Option<Vec<f64>> + Sync);

/// Derivatives of residuals, a column for each unknown, empty for fixed ones.
type Slopes<'a> = &'a (dyn Fn(&[f64], &[bool]) -> Option<Vec<Column>> + Sync);

/// Residuals as a function of a few unknowns, each within bounds.
pub(super) struct Problem<'a> {
    pub(super) residuals: Function<'a>,
    /// Their derivatives; `None` leaves them to differences.
    pub(super) slopes: Option<Slopes<'a>>,
    /// Smallest and largest value of each.
    pub(super) bounds: &'a [[f64; 2]],
    /// Step of each for a central difference.
    pub(super) steps: &'a [f64],
    /// It has converged when a step lowers the sum by less than this part of it.
    pub(super) enough: f64,
}

/// A step that lowered the sum, and what was known before it.
struct Taken {
    step: Vec<f64>,
    columns: Vec<Column>,
    straight: Vec<Vec<f64>>,
    gradient: Vec<f64>,
    sum: f64,
}

/// The second-order part of the Hessian that the residuals add to `J^T J`, estimated from step to
/// step (`dennis_1981`). Where a curve cannot be fitted, residuals are large, and without this part
/// each step would be too short.
struct Bend {
    matrix: Vec<Vec<f64>>,
    /// Whether it predicted the last step better than `J^T J` alone.
    helps: bool,
}

impl Bend {
    fn new(count: usize) -> Self {
        Self { matrix: vec![vec![0.0; count]; count], helps: false }
    }

    fn times(&self, step: &[f64]) -> Vec<f64> {
        self.matrix.iter().map(|row| dot(row, step)).collect()
    }

    /// Updates the estimate after a step, from the gradient, the residuals and their sum at its
    /// end.
    fn learn(&mut self, taken: &Taken, gradient: &[f64], residuals: &[f64], sum: f64) {
        let Taken { step, columns, straight, gradient: before, sum: was } = taken;
        let bent = dot(step, &self.times(step));
        let along: f64 = straight.iter().zip(step).map(|(row, by)| by * dot(row, step)).sum();
        let foretold = was + 2.0 * dot(before, step) + along;
        self.helps = (sum - foretold - bent).abs() < (sum - foretold).abs();
        // The change of the gradient, and the part of it that this matrix explains.
        let change: Vec<f64> = gradient.iter().zip(before).map(|(now, was)| now - was).collect();
        let own: Vec<f64> =
            columns.iter().zip(gradient).map(|(old, now)| now - old.along(residuals)).collect();
        let along = dot(&change, step);
        if along <= 0.0 {
            return;
        }
        let size = if bent == 0.0 { 1.0 } else { (dot(step, &own) / bent).abs().min(1.0) };
        let now = self.times(step);
        let off: Vec<f64> = own.iter().zip(&now).map(|(own, now)| own - size * now).collect();
        let part = dot(&off, step) / along;
        for (j, row) in self.matrix.iter_mut().enumerate() {
            for (k, value) in row.iter_mut().enumerate() {
                let both = off[j] * change[k] + change[j] * off[k] - part * change[j] * change[k];
                *value = size * *value + both / along;
            }
        }
    }

    fn added_to(&self, straight: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let part = if self.helps { 1.0 } else { 0.0 };
        let rows = straight.iter().zip(&self.matrix);
        rows.map(|(row, bend)| row.iter().zip(bend).map(|(a, b)| a + part * b).collect()).collect()
    }
}

/// A minimum of the sum of squares.
#[derive(Debug, Clone)]
pub(super) struct Least {
    pub(super) at: Vec<f64>,
    /// The cost: the sum of squared residuals, without the factor 1/2.
    pub(super) sum: f64,
    pub(super) residuals: Vec<f64>,
}

/// Derivatives of all residuals by one unknown, which may affect only a few of them.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Column {
    /// The first residual that it affects.
    pub(super) first: usize,
    /// Derivatives from there on; those after them are 0.
    pub(super) values: Vec<f64>,
}

impl Column {
    /// Its product with the residuals.
    fn along(&self, residuals: &[f64]) -> f64 {
        dot(&self.values, &residuals[self.first..self.first + self.values.len()])
    }

    fn dot(&self, other: &Self) -> f64 {
        let first = self.first.max(other.first);
        let end = (self.first + self.values.len()).min(other.first + other.values.len());
        if first >= end {
            return 0.0;
        }
        let part = |column: &Self| first - column.first..end - column.first;
        dot(&self.values[part(self)], &other.values[part(other)])
    }
}

impl Problem<'_> {
    /// The minimum near a start; unknowns marked in `held` are fixed.
    pub(super) fn minimise(&self, start: &[f64], held: &[bool]) -> Option<Least> {
        let mut at: Vec<f64> =
            start.iter().zip(self.bounds).map(|(x, [low, high])| x.clamp(*low, *high)).collect();
        let mut residuals = (self.residuals)(&at)?;
        let mut sum = squares(&residuals);
        let mut damping = DAMPING;
        let mut bend = Bend::new(at.len());
        let mut last: Option<Taken> = None;
        for _ in 0..STEPS {
            let columns = self.jacobian(&at, held)?;
            let (straight, gradient) = normal(&columns, &residuals);
            if let Some(taken) = last.take() {
                bend.learn(&taken, &gradient, &residuals, sum);
            }
            let normal = bend.added_to(&straight);
            // An unknown that would leave its bounds stays on them.
            let free: Vec<usize> = (0..at.len())
                .filter(|&k| {
                    let [low, high] = self.bounds[k];
                    let outwards =
                        at[k] <= low && gradient[k] > 0.0 || at[k] >= high && gradient[k] < 0.0;
                    !held[k] && !outwards && straight[k][k] > 0.0
                })
                .collect();
            if free.is_empty() {
                break;
            }
            let (mut lowered, mut failed, mut harder) = (None, false, RAISED);
            while damping < STUCK {
                let matrix = free.iter().map(|&j| {
                    let row = free.iter().map(|&k| {
                        normal[j][k] + if j == k { damping * straight[j][j] } else { 0.0 }
                    });
                    row.collect()
                });
                let right: Vec<f64> = free.iter().map(|&k| -gradient[k]).collect();
                let step = solve(&matrix.collect::<Vec<_>>(), &right);
                // After a step that did not lower the sum, a step that promises as little is not
                // tried, and shorter ones promise less.
                let promised = |step: &Vec<f64>| {
                    let all = || free.iter().zip(step);
                    let along = |j: usize| all().map(|(&k, by)| normal[j][k] * by).sum::<f64>();
                    -all().map(|(&j, by)| by * (2.0 * gradient[j] + along(j))).sum::<f64>()
                };
                if failed && step.as_ref().is_some_and(|step| promised(step) < self.enough * sum) {
                    break;
                }
                let tried = step.and_then(|step| {
                    let mut to = at.clone();
                    for (&k, step) in free.iter().zip(&step) {
                        let [low, high] = self.bounds[k];
                        to[k] = (at[k] + step).clamp(low, high);
                    }
                    let residuals = (self.residuals)(&to)?;
                    let sum = squares(&residuals);
                    sum.is_finite().then_some(Least { at: to, sum, residuals })
                });
                match tried {
                    Some(tried) if tried.sum < sum => {
                        damping = (damping / 10.0).max(1e-12);
                        lowered = Some(tried);
                        break;
                    }
                    _ => {
                        damping *= harder;
                        harder *= 2.0;
                        failed = true;
                    }
                }
            }
            let Some(tried) = lowered else { break };
            let gain = (sum - tried.sum) / sum.max(f64::MIN_POSITIVE);
            let step = tried.at.iter().zip(&at).map(|(to, from)| to - from).collect();
            last = Some(Taken { step, columns, straight, gradient, sum });
            (at, sum, residuals) = (tried.at, tried.sum, tried.residuals);
            if gain < self.enough {
                break;
            }
        }
        Some(Least { at, sum, residuals })
    }

    /// Derivatives of the residuals, a column for each unknown, empty for fixed ones.
    pub(super) fn jacobian(&self, at: &[f64], held: &[bool]) -> Option<Vec<Column>> {
        if let Some(slopes) = self.slopes {
            return slopes(at, held);
        }
        let column = |place: usize| {
            if held[place] {
                return Some(Column::default());
            }
            let values = difference(self.residuals, at, place, self.steps[place], self.bounds)?;
            Some(Column { first: 0, values })
        };
        (0..at.len()).map(column).collect()
    }
}

/// The derivative of numbers by one unknown: a central difference, one-sided at a bound.
pub(super) fn difference(
    of: impl Fn(&[f64]) -> Option<Vec<f64>>,
    at: &[f64],
    place: usize,
    step: f64,
    bounds: &[[f64; 2]],
) -> Option<Vec<f64>> {
    let [low, high] = bounds[place];
    let moved = |to: f64| {
        let mut there = at.to_vec();
        there[place] = to.clamp(low, high);
        Some((there[place], of(&there)?))
    };
    let (below, from) = moved(at[place] - step)?;
    let (above, mut to) = moved(at[place] + step)?;
    let width = above - below;
    for (to, from) in to.iter_mut().zip(&from) {
        *to = (*to - from) / width;
    }
    Some(to)
}

pub(super) fn squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `J^T J` and `J^T r`.
pub(super) fn normal(columns: &[Column], residuals: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut matrix = vec![vec![0.0; columns.len()]; columns.len()];
    for (j, a) in columns.iter().enumerate() {
        for (k, b) in columns[..=j].iter().enumerate() {
            matrix[j][k] = a.dot(b);
            matrix[k][j] = matrix[j][k];
        }
    }
    (matrix, columns.iter().map(|column| column.along(residuals)).collect())
}

/// The solution of a symmetric, positive definite system, scaled to a diagonal of ones; `None` if
/// it is not positive definite.
pub(super) fn solve(matrix: &[Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    let (factor, scale) = factorised(matrix)?;
    let scaled = right.iter().zip(scale.iter()).map(|(value, scale)| value / scale);
    let solution = factor.solve(&DVector::from_iterator(right.len(), scaled));
    Some(solution.component_div(&scale).as_slice().to_vec())
}

/// The inverse of a symmetric, positive definite matrix, if it is one.
pub(super) fn inverse(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let (factor, scale) = factorised(matrix)?;
    let inverse = factor.inverse().component_div(&(&scale * scale.transpose()));
    Some(inverse.column_iter().map(|column| column.as_slice().to_vec()).collect())
}

/// The Cholesky factor of a matrix scaled to a diagonal of ones, and the roots of its diagonal.
fn factorised(matrix: &[Vec<f64>]) -> Option<(Cholesky<f64, Dyn>, DVector<f64>)> {
    let scale = DVector::from_fn(matrix.len(), |k, _| matrix[k][k].sqrt());
    if scale.iter().any(|scale| !(*scale > 0.0 && scale.is_finite())) {
        return None;
    }
    let scaled =
        DMatrix::from_fn(matrix.len(), matrix.len(), |j, k| matrix[j][k] / (scale[j] * scale[k]));
    let factor = Cholesky::new(scaled)?;
    // Less is rounding: two unknowns that cannot be distinguished.
    let least = factor.l_dirty().diagonal().min();
    (least * least >= 1e-13).then_some((factor, scale))
}

impl<'a> Problem<'a> {
    /// With differences for derivatives, searched to many digits.
    pub(super) fn plain(residuals: Function<'a>, bounds: &'a [[f64; 2]], steps: &'a [f64]) -> Self {
        Self { residuals, slopes: None, bounds, steps, enough: 1e-10 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn a_bent_valley_is_followed_to_its_floor() {
        // Rosenbrock's, least at (1, 1).
        let residuals = |x: &[f64]| Some(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
        let bounds = [[-5.0, 5.0]; 2];
        let problem = Problem::plain(&residuals, &bounds, &[1e-5; 2]);
        let found = problem.minimise(&[-1.2, 1.0], &[false; 2]).unwrap();
        assert!(found.at.iter().all(|x| (x - 1.0).abs() < 1e-6), "{:?}", found.at);
        assert!(found.sum < 1e-12);
    }

    #[test]
    fn residuals_that_stay_large_are_least_where_brown_and_dennis_say_after_few_steps() {
        // Problem 16 of More, Garbow and Hillstrom (1981): the least sum is 85822.2.
        let steps = AtomicUsize::new(0);
        let residuals = |x: &[f64]| {
            let one = |number: u32| {
                let t = f64::from(number) / 5.0;
                let (a, b) = (x[0] + t * x[1] - t.exp(), x[2] + x[3] * t.sin() - t.cos());
                a * a + b * b
            };
            Some((1..=20).map(one).collect())
        };
        let bounds = [[-1e3, 1e3]; 4];
        let slopes = |at: &[f64], _: &[bool]| {
            steps.fetch_add(1, Ordering::Relaxed);
            let column = |place| difference(residuals, at, place, 1e-5, &bounds);
            (0..4).map(|place| Some(Column { first: 0, values: column(place)? })).collect()
        };
        let plain = Problem::plain(&residuals, &bounds, &[1e-5; 4]);
        let problem = Problem { slopes: Some(&slopes), ..plain };
        let found = problem.minimise(&[25.0, 5.0, -5.0, -1.0], &[false; 4]).unwrap();
        assert!((found.sum - 85_822.2).abs() < 0.05, "{}", found.sum);
        let steps = steps.into_inner();
        assert!(steps < 20, "{steps} steps");
    }

    #[test]
    fn what_lies_past_a_bound_ends_on_it_and_what_is_held_stays() {
        let residuals = |x: &[f64]| Some(vec![x[0] - 7.0, x[1] - 2.0, x[2] + x[1]]);
        let bounds = [[0.0, 5.0], [-9.0, 9.0], [-9.0, 9.0]];
        let problem = Problem::plain(&residuals, &bounds, &[1e-4; 3]);
        let found = problem.minimise(&[1.0, 0.0, 4.0], &[false, false, true]).unwrap();
        // Least of (b - 2)^2 + (4 + b)^2 is at b = -1.
        assert!((found.at[0] - 5.0).abs() < 1e-12 && found.at[2] == 4.0);
        assert!((found.at[1] + 1.0).abs() < 1e-8, "{:?}", found.at);
    }

    #[test]
    fn a_system_is_solved_whatever_the_units_of_its_unknowns() {
        let matrix = vec![vec![4e12, 2e3, 0.0], vec![2e3, 5e-6, 1e-3], vec![0.0, 1e-3, 3.0]];
        let x = [2e-6, 3e3, -1.0];
        let right: Vec<f64> = matrix.iter().map(|row| dot(row, &x)).collect();
        let found = solve(&matrix, &right).unwrap();
        assert!(found.iter().zip(x).all(|(found, x)| (found / x - 1.0).abs() < 1e-9), "{found:?}");
        assert_eq!(solve(&[vec![1.0, 1.0], vec![1.0, 1.0]], &[1.0, 1.0]), None);
        let back = inverse(&matrix).unwrap();
        assert!((dot(&matrix[0], &back[0]) - 1.0).abs() < 1e-9);
    }
}
