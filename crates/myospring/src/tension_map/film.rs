//! The map of tension over a whole film, as a few modes: maps times courses.
//!
//! The equilibria under `a` times the map of the peak are a path, and each frame has the `a` of the nearest shape on it.
//! The difference from that shape is linear in the tension, so each frame says what it would measure of its whole
//! tension, `y(t) = A T(t) + noise`. The singular vectors of these numbers that exceed noise are the modes:
//! ```text
//! T(x, t) = sum_k m_k(x) c_k(t)
//! ```
//! with `m_k` as smooth in space as cross-validation finds, each as the map of the peak is, and `c_k` so smooth in
//! time that its expected error is least.
//! The variance of a place in a frame is that of its maps, of its courses, and the systematic error.

use super::TensionMapError;
use super::grid::Grid;
use super::least::not_negative;
use super::map::{SYSTEMATIC, Search, TensionMap, placed};
use super::observed_peak::{ObservedPeak, displacement, rest_frames};
use super::smoothing::Problem;
use crate::integrate::quasi_static::PathError;
use crate::mechanics::Tension;
use crate::microscopy::motion::CellMotion;
use crate::simulation::Simulation;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Largest number of modes, and rounds of the iteration that finds them.
const MOST: usize = 6;
const ROUNDS: usize = 60;
/// Shapes of the path from rest to the peak, and beyond it.
const LEVELS: usize = 8;
const BEYOND: usize = 1;
/// Largest singular value of noise alone, relative to its limit for many numbers.
const EDGE: f64 = 1.1;
/// A course is a mode's if the other frames predict each of its values with less than this part of its mean square.
const PREDICTED: f64 = 0.5;
/// Widths of the smoothing in time that are tried, in intervals between frames, and where its weights end.
const WIDTHS: [f64; 11] = [0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0];
const REACH: f64 = 4.0;
/// A place is known if its standard deviation is below half of its tension, or of this part of the mean at the peak.
const HALF: f64 = 0.5;
const OF_PEAK: f64 = 0.5;

/// Active tension of each place in each frame of a film.
#[derive(Debug, Clone, PartialEq)]
pub struct TensionFilm {
    /// Numbers of the frames in the film.
    pub frames: Vec<usize>,
    /// Their times, ms.
    pub times_ms: Vec<f64>,
    /// Mean over the volume in each frame, kPa.
    pub means_kpa: Vec<f64>,
    /// Standard deviations of these.
    pub mean_deviations_kpa: Vec<f64>,
    /// Number of modes that exceed noise: 1 where the pattern stays the same.
    pub modes: usize,
    /// In each frame, at each point of the grid.
    values: Vec<DVector<f64>>,
    deviations: Vec<DVector<f64>>,
    grid: Grid,
    peak_kpa: f64,
}

impl TensionFilm {
    /// The maps of a film's cell at its peak and in each frame.
    ///
    /// # Errors
    /// Those of [`TensionMap::of`].
    pub fn of(
        simulation: &Simulation,
        motion: &CellMotion,
    ) -> Result<(TensionMap, Self), TensionMapError> {
        let seen = ObservedPeak::at_peak(motion);
        TensionMap::with(simulation, &seen, |search, problem| search.film(motion, problem))
    }

    /// Tension of each triangle in a frame, kPa, by its place in [`TensionFilm::frames`].
    pub fn tensions_kpa(&self, frame: usize) -> Vec<f64> {
        self.grid.in_triangles(self.values[frame].as_slice())
    }

    /// Their standard deviations, kPa.
    pub fn deviations_kpa(&self, frame: usize) -> Vec<f64> {
        self.grid.in_triangles(self.deviations[frame].as_slice())
    }

    /// Which triangles have a tension that the film shows: a standard deviation below half of it, or below a quarter of the
    /// cell's mean at its peak.
    pub fn known(&self, frame: usize) -> Vec<bool> {
        self.doubts(frame).into_iter().map(|doubt| doubt <= HALF).collect()
    }

    /// Standard deviation of each triangle in a frame over its tension, or over half of the cell's mean at its peak where that
    /// is more; above one half a tension is not known.
    pub fn doubts(&self, frame: usize) -> Vec<f64> {
        let both = self.tensions_kpa(frame).into_iter().zip(self.deviations_kpa(frame));
        let enough = |tension: f64| tension.max(OF_PEAK * self.peak_kpa);
        both.map(|(tension, deviation)| deviation / enough(tension)).collect()
    }
}

/// A part of the map of the peak, and positions under it, um.
type Level = (f64, [Vec<f64>; 2]);

/// A pattern of what is measured, and its course.
struct Mode {
    pattern: DVector<f64>,
    course: Vec<f64>,
    /// Standard deviations of the course.
    deviations: Vec<f64>,
}

impl Search<'_> {
    fn film(
        &mut self,
        motion: &CellMotion,
        problem: &Problem,
    ) -> Result<TensionFilm, TensionMapError> {
        let no_answer = || TensionMapError::NoContraction { tension_kpa: f64::NAN };
        let shown = motion.frames_with_cell();
        let measured = self.linear(motion, &shown, problem)?;
        let times_ms: Vec<f64> = shown.iter().map(|&frame| motion.times_ms[frame]).collect();
        let modes = modes(&measured, problem.freedom, &times_ms);
        let count = self.grid.len();
        let total: f64 = self.grid.areas.iter().sum();
        let weights = self.grid.areas.iter().map(|area| area / total);
        let mean_of = DVector::from_iterator(count, weights);
        let zero = || vec![DVector::zeros(count); shown.len()];
        let (mut values, mut variances) = (zero(), zero());
        let (mut means, mut mean_variances) = (vec![0.0; shown.len()], vec![0.0; shown.len()]);
        for (number, mode) in modes.iter().enumerate() {
            self.interruption.check().map_err(PathError::from)?;
            let one = Problem { seen: mode.pattern.clone(), ..problem.clone() };
            let smoothing = one.smoothing().ok_or_else(no_answer)?;
            let hessian = one.hessian(smoothing.lambda);
            let right = one.columns.tr_mul(&one.seen);
            let inverse = hessian.clone().cholesky().ok_or_else(no_answer)?.inverse();
            let free = &inverse * &right;
            // Only the first mode has one sign.
            let map =
                if number > 0 { free } else { not_negative(&hessian, &right).unwrap_or(free) };
            let covariance = inverse * smoothing.noise.powi(2);
            let (of_places, of_mean) =
                (covariance.diagonal(), mean_of.dot(&(&covariance * &mean_of)));
            for frame in 0..shown.len() {
                let (part, deviation) = (mode.course[frame], mode.deviations[frame]);
                values[frame] += &map * part;
                variances[frame] +=
                    &of_places * part.powi(2) + map.map(|value| (value * deviation).powi(2));
                let mean = mean_of.dot(&map);
                means[frame] += mean * part;
                mean_variances[frame] += of_mean * part.powi(2) + (mean * deviation).powi(2);
            }
        }
        // The error of the rest that all frames are measured from does not shrink with the tension.
        let peak_kpa = mean_of.dot(&self.values);
        let sure = |variance: f64, tension: f64| {
            (variance.max(0.0) + (SYSTEMATIC * tension.max(peak_kpa)).powi(2)).sqrt()
        };
        let deviations =
            variances.iter().zip(&values).map(|(of, at)| of.zip_map(at, sure)).collect();
        let mean_deviations_kpa =
            mean_variances.iter().zip(&means).map(|(of, at)| sure(*of, *at)).collect();
        Ok(TensionFilm {
            frames: shown.iter().map(|&frame| motion.frames[frame]).collect(),
            times_ms,
            peak_kpa,
            means_kpa: means.into_iter().map(|mean| mean.max(0.0)).collect(),
            mean_deviations_kpa,
            modes: modes.len(),
            values: values.into_iter().map(|map| map.map(|tension| tension.max(0.0))).collect(),
            deviations,
            grid: self.grid.clone(),
        })
    }

    /// What each frame would measure if it were linear in the tension, column by column.
    fn linear(
        &mut self,
        motion: &CellMotion,
        shown: &[usize],
        problem: &Problem,
    ) -> Result<DMatrix<f64>, TensionMapError> {
        let whole = self.whole();
        let free = |numbers: DVector<f64>| &numbers - &whole * whole.tr_mul(&numbers);
        let path = self.path()?;
        let shapes: Vec<DVector<f64>> = path
            .iter()
            .map(|(_, positions)| {
                let moved = self.moved(positions).map(|axis| self.means.of(&axis));
                free(self.independent(&self.squares.means(&moved)))
            })
            .collect();
        let of_peak = &problem.columns * &self.values;
        let rest = rest_frames(motion);
        let at_rest = displacement(motion, &rest);
        let mut columns = Vec::with_capacity(shown.len());
        for &frame in shown {
            self.interruption.check().map_err(PathError::from)?;
            let target = [0, 1].map(|axis: usize| {
                let here = motion.displacements_um[frame][axis].iter().zip(&at_rest[axis]);
                let points = self.mesh.points[axis].iter();
                points.zip(here).map(|(point, (here, rest))| point + here - rest).collect()
            });
            let mut near = Near { level: 0.0, shape: shapes[0].clone(), from: 0 };
            let mut numbers = DVector::zeros(0);
            // Turned to rest, then to the nearest shape.
            for _ in 0..2 {
                let turned = placed(&target, &path[near.from].1, &self.seen.found);
                let moved = self.moved(&turned);
                numbers = free(self.independent(&self.squares.means(&moved)));
                near = Near::to(&numbers, &path, &shapes);
            }
            columns.push(numbers - near.shape + &of_peak * near.level);
        }
        Ok(DMatrix::from_columns(&columns))
    }

    /// Levels and positions from rest to beyond the peak.
    fn path(&mut self) -> Result<Vec<Level>, TensionMapError> {
        let rest = self.mesh.points.clone();
        if self.seen.cut.iter().any(|cut| *cut) {
            // Points at the cut are held at their measured positions, so the path is the line to the peak.
            return Ok(vec![(0.0, rest), (1.0, self.positions.clone())]);
        }
        let mut path = vec![(0.0, rest)];
        for level in 1..=LEVELS + BEYOND {
            let part = level as f64 / LEVELS as f64;
            let tensions = self.grid.in_triangles((&self.values * part).as_slice());
            let from = if level == LEVELS { &self.positions } else { &path[level - 1].1 };
            match self.equilibrium.find(from, Tension::PerElement(&tensions)) {
                Ok(positions) => path.push((part, positions)),
                Err(error) if level <= LEVELS => return Err(error.into()),
                Err(_) => break,
            }
        }
        Ok(path)
    }

    fn moved(&self, positions: &[Vec<f64>; 2]) -> [Vec<f64>; 2] {
        [0, 1].map(|axis: usize| {
            let rest = &self.mesh.points[axis];
            positions[axis].iter().zip(rest).map(|(now, rest)| now - rest).collect()
        })
    }
}

/// The nearest shape of a path: the level, what it measures, and the shape before it.
struct Near {
    level: f64,
    shape: DVector<f64>,
    from: usize,
}

impl Near {
    /// To what was measured; the path goes on straight beyond its ends.
    fn to(numbers: &DVector<f64>, path: &[Level], shapes: &[DVector<f64>]) -> Self {
        let last = shapes.len() - 2;
        let one = |from: usize| {
            let along = &shapes[from + 1] - &shapes[from];
            let part = (numbers - &shapes[from]).dot(&along) / along.norm_squared();
            let low = if from == 0 { f64::NEG_INFINITY } else { 0.0 };
            let high = if from == last { f64::INFINITY } else { 1.0 };
            let part = part.clamp(low, high);
            let level = path[from].0 + part * (path[from + 1].0 - path[from].0);
            Self { level, shape: &shapes[from] + along * part, from }
        };
        let distance = |near: &Self| (numbers - &near.shape).norm_squared();
        (1..=last)
            .map(one)
            .fold(one(0), |best, next| if distance(&next) < distance(&best) { next } else { best })
    }
}

/// The modes of columns that exceed their noise, the strongest first, with smooth courses; one at least.
fn modes(columns: &DMatrix<f64>, freedom: f64, times_ms: &[f64]) -> Vec<Mode> {
    let frames = columns.ncols();
    let most = MOST.min(frames).min(columns.nrows());
    // Subspace iteration from the columns that differ most from rest.
    let mut order: Vec<usize> = (0..frames).collect();
    let size = |frame: &usize| columns.column(*frame).norm_squared();
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let every = (frames / most).max(1);
    let start: Vec<_> =
        (0..most).map(|at| columns.column(order[at * every]).into_owned()).collect();
    let mut basis = DMatrix::from_columns(&start).qr().q();
    for _ in 0..ROUNDS {
        basis = (columns * columns.tr_mul(&basis)).qr().q();
    }
    let small = basis.tr_mul(columns).transpose().svd(false, true);
    let (Some(turn), values) = (small.v_t, small.singular_values) else { return Vec::new() };
    let mut strongest: Vec<usize> = (0..values.len()).collect();
    strongest.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    let explained: f64 = values.iter().map(|value| value * value).sum();
    let rest = (freedom - most as f64).max(1.0) * (frames as f64 - most as f64).max(1.0);
    let variance = ((columns.norm_squared() - explained) / rest).max(0.0);
    let edge = EDGE * variance.sqrt() * (freedom.sqrt() + (frames as f64).sqrt());
    let patterns = basis * turn.transpose();
    let one = |(number, &at): (usize, &usize)| {
        if number > 0 && values[at] <= edge {
            return None;
        }
        let mut pattern = patterns.column(at).into_owned();
        let mut scores = columns.tr_mul(&pattern);
        // Positive where it is largest.
        if scores[scores.iamax()] < 0.0 {
            (pattern, scores) = (-pattern, -scores);
        }
        let Course { values, deviations, error } = smooth(times_ms, scores.as_slice(), variance);
        let predicted = error < PREDICTED * scores.norm_squared() / frames as f64;
        (number == 0 || predicted).then_some(Mode { pattern, course: values, deviations })
    };
    strongest.iter().enumerate().map_while(one).collect()
}

/// A smooth course.
struct Course {
    values: Vec<f64>,
    /// Their standard deviations.
    deviations: Vec<f64>,
    /// Mean square of the errors with which the others predict each value.
    error: f64,
}

/// A course smoothed by parabolas through its surroundings, as wide as makes the expected error least (Mallows' criterion:
/// cross-validation cannot choose between widths below an interval), and its standard deviations; `variance` is the noise of
/// a value.
fn smooth(times: &[f64], values: &[f64], variance: f64) -> Course {
    let mut between: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    between.sort_by(f64::total_cmp);
    let interval = between.get(between.len() / 2).copied().unwrap_or(1.0);
    let all = WIDTHS.iter().filter_map(|width| smoothed(times, values, width * interval, interval));
    let all: Vec<Smoothed> = all.collect();
    let error = all.iter().map(|it| it.predicted).fold(f64::INFINITY, f64::min);
    let risk = |it: &Smoothed| it.residual + variance * (2.0 * it.trace - 1.0);
    match all.into_iter().min_by(|a, b| risk(a).total_cmp(&risk(b))) {
        Some(best) if risk(&best) < variance => {
            let least = risk(&best);
            let deviations =
                best.gains.iter().map(|gain| (gain * variance).max(least).sqrt()).collect();
            Course { values: best.values, deviations, error }
        }
        _ => Course {
            values: values.to_vec(),
            deviations: vec![variance.sqrt(); values.len()],
            error,
        },
    }
}

/// A smoothed course.
struct Smoothed {
    values: Vec<f64>,
    /// Variance of each over that of a value of the course.
    gains: Vec<f64>,
    /// Mean square of the differences from the course.
    residual: f64,
    /// Mean weight of a value in its own.
    trace: f64,
    /// Mean square of the errors with which the others predict each value.
    predicted: f64,
}

fn smoothed(times: &[f64], values: &[f64], width: f64, interval: f64) -> Option<Smoothed> {
    let reach = (REACH * width).max(2.5 * interval);
    let (mut found, mut gains) = (Vec::new(), Vec::new());
    let (mut residual, mut trace, mut predicted) = (0.0, 0.0, 0.0);
    for (at, time) in times.iter().enumerate() {
        let low = times.partition_point(|other| *other < time - reach);
        let high = times.partition_point(|other| *other <= time + reach);
        if high - low < 4 {
            return None;
        }
        let away = |other: usize| (times[other] - time) / width;
        let weight = |other: usize| (-0.5 * away(other).powi(2)).exp();
        let terms = |other: usize| Vector3::new(1.0, away(other), away(other).powi(2));
        let mut normal = Matrix3::zeros();
        for other in low..high {
            normal += weight(other) * terms(other) * terms(other).transpose();
        }
        let first = normal.try_inverse()?.column(0).into_owned();
        let hat = |other: usize| weight(other) * terms(other).dot(&first);
        let value: f64 = (low..high).map(|other| hat(other) * values[other]).sum();
        let own = 1.0 - hat(at);
        if own < 1e-7 {
            return None;
        }
        residual += (values[at] - value).powi(2);
        trace += 1.0 - own;
        predicted += ((values[at] - value) / own).powi(2);
        found.push(value);
        gains.push((low..high).map(|other| hat(other).powi(2)).sum());
    }
    let count = times.len() as f64;
    let [residual, trace, predicted] = [residual, trace, predicted].map(|sum| sum / count);
    Some(Smoothed { values: found, gains, residual, trace, predicted })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_without_noise_stays_and_one_with_noise_becomes_quieter() {
        let times: Vec<f64> = (0..200).map(|at| 10.0 * f64::from(at)).collect();
        let truth: Vec<f64> = times.iter().map(|t| (t / 150.0).sin()).collect();
        let same = smooth(&times, &truth, 0.0).values;
        for (a, b) in same.iter().zip(&truth) {
            assert!((a - b).abs() < 1e-3, "{a} {b}");
        }
        // Alternating errors of 0.1.
        let noisy: Vec<f64> = truth
            .iter()
            .enumerate()
            .map(|(at, v)| v + if at % 2 == 0 { 0.1 } else { -0.1 })
            .collect();
        let Course { values: quiet, deviations, .. } = smooth(&times, &noisy, 0.01);
        let off: f64 = quiet.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / 200.0;
        assert!(off.sqrt() < 0.05 && deviations.iter().all(|sd| *sd < 0.1), "{}", off.sqrt());
    }

    #[test]
    fn two_patterns_with_courses_of_their_own_are_two_modes() {
        let (rows, frames) = (40, 30);
        let noise = |i: usize, j: usize| 0.01 * ((i * 31 + j * 17) as f64 * 0.618_034).fract();
        let columns = DMatrix::from_fn(rows, frames, |i, j| {
            let (x, t) = (i as f64 / rows as f64, j as f64 / frames as f64);
            t.sin() + x * (6.0 * t).cos() + noise(i, j)
        });
        let times: Vec<f64> = (0..frames).map(|at| at as f64).collect();
        assert_eq!(modes(&columns, rows as f64, &times).len(), 2);
    }
}
