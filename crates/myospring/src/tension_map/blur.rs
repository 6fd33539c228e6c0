//! What a film shows of the motion of a point: a mean over the square that is followed, smoothed over its neighbours.
//!
//! A film of a cell with a narrow passive part shows it wider and less passive than it is. The same means taken of a
//! simulated cell make both alike, so the map needs no sharper film to find narrow parts.

use crate::mesh::Mesh;
use nalgebra::{DMatrix, DVector};

/// How the motion of a point is averaged.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Blur {
    /// Side of the square that is followed, um; 0 where points move on their own.
    pub subset_um: f64,
    /// Standard deviation of the Gaussian over the neighbours, um; 0 for none.
    pub smoothing_um: f64,
}

/// Gaussian weights end at this number of standard deviations.
const REACH: f64 = 2.0;

/// A mean over points, for each point of a mesh.
pub(super) struct Means(Vec<Vec<(usize, f64)>>);

impl Means {
    /// Those of the points of a mesh under a blur.
    pub(super) fn new(mesh: &Mesh, blur: Blur) -> Self {
        let half = 0.5 * mesh.lattice.as_ref().map_or(0.0, |lattice| lattice.spacing);
        // The part of the square around a point of the lattice that the subset covers, along one axis.
        let covered = |away: f64| (0.5 * blur.subset_um + half - away.abs()).clamp(0.0, 2.0 * half);
        let subset =
            Self::planes(mesh, 0.5 * blur.subset_um + half, &|[x, y]| covered(x) * covered(y));
        if blur.smoothing_um <= 0.0 {
            return subset;
        }
        let reach = REACH * blur.smoothing_um;
        let gauss = |[x, y]: [f64; 2]| {
            let square = x * x + y * y;
            if square <= reach * reach {
                (-0.5 * square / blur.smoothing_um.powi(2)).exp()
            } else {
                0.0
            }
        };
        Self::planes(mesh, reach, &gauss).after(&subset)
    }

    /// For each point the value there of the plane through the values around it, weighted by `weight` of their offsets.
    fn planes(mesh: &Mesh, reach: f64, weight: &dyn Fn([f64; 2]) -> f64) -> Self {
        let bins = Bins::new(mesh, reach.max(f64::MIN_POSITIVE));
        let one = |point: usize| {
            let place = mesh.point(point);
            let near: Vec<(usize, [f64; 2], f64)> = bins
                .around(place)
                .map(|other| (other, [0, 1].map(|a: usize| mesh.points[a][other] - place[a])))
                .map(|(other, away)| (other, away, weight(away)))
                .filter(|(.., weight)| *weight > 0.0)
                .collect();
            let mut normal = nalgebra::Matrix3::zeros();
            for (_, [x, y], weight) in &near {
                let terms = nalgebra::Vector3::new(1.0, *x, *y);
                normal += *weight * terms * terms.transpose();
            }
            // With too few points for a plane, the point itself.
            match normal.try_inverse() {
                Some(inverse) if near.len() > 3 => near
                    .iter()
                    .map(|(other, [x, y], weight)| {
                        let plane = inverse * nalgebra::Vector3::new(1.0, *x, *y);
                        (*other, weight * plane[0])
                    })
                    .collect(),
                _ => vec![(point, 1.0)],
            }
        };
        Self((0..mesh.len()).map(one).collect())
    }

    /// These means of the means `first`.
    fn after(&self, first: &Self) -> Self {
        let mut row = vec![0.0; self.0.len()];
        let one = |means: &Vec<(usize, f64)>| {
            let mut touched = Vec::new();
            for &(at, weight) in means {
                for &(point, part) in &first.0[at] {
                    if row[point] == 0.0 {
                        touched.push(point);
                    }
                    row[point] += weight * part;
                }
            }
            let mean = |point: &usize| (*point, std::mem::take(&mut row[*point]));
            touched.iter().map(mean).filter(|(_, weight)| *weight != 0.0).collect()
        };
        Self(self.0.iter().map(one).collect())
    }

    /// The means of values of all points.
    pub(super) fn of(&self, values: &[f64]) -> Vec<f64> {
        let mean =
            |row: &Vec<(usize, f64)>| row.iter().map(|(at, weight)| weight * values[*at]).sum();
        self.0.iter().map(mean).collect()
    }

    /// Rows of a matrix: sums of these means over lists of points, each times a weight.
    pub(super) fn summed(&self, lists: &[Vec<usize>], weights: &[f64]) -> DMatrix<f64> {
        let mut rows = DMatrix::zeros(lists.len(), self.0.len());
        for (row, (points, weight)) in lists.iter().zip(weights).enumerate() {
            for point in points {
                for (at, part) in &self.0[*point] {
                    rows[(row, *at)] += weight * part;
                }
            }
        }
        rows
    }
}

/// Points in squares, to find those near a place.
struct Bins {
    side: f64,
    bins: std::collections::HashMap<[i64; 2], Vec<usize>>,
}

impl Bins {
    fn new(mesh: &Mesh, side: f64) -> Self {
        let mut bins = std::collections::HashMap::<[i64; 2], Vec<usize>>::new();
        for point in 0..mesh.len() {
            bins.entry(bin(mesh.point(point), side)).or_default().push(point);
        }
        Self { side, bins }
    }

    /// The points of the squares around that of a place.
    fn around(&self, place: [f64; 2]) -> impl Iterator<Item = usize> {
        let [i, j] = bin(place, self.side);
        let near = (-1..=1).flat_map(move |k| (-1..=1).map(move |l| [i + k, j + l]));
        near.filter_map(|at| self.bins.get(&at)).flatten().copied()
    }
}

fn bin(place: [f64; 2], side: f64) -> [i64; 2] {
    place.map(|at| (at / side).floor() as i64)
}

/// Makes correlated numbers independent: the inverse of the Cholesky factor of their covariance, relative to its mean
/// variance.
pub(super) struct Whitening(DMatrix<f64>);

/// Variance of an error that is each number's own, over the mean variance.
const OWN: f64 = 0.3;

impl Whitening {
    /// Of numbers that are these rows times independent errors of one size, each with an error of its own.
    pub(super) fn new(rows: &DMatrix<f64>) -> Option<Self> {
        let mut covariance = rows * rows.transpose();
        let mean = covariance.trace() / covariance.nrows() as f64;
        covariance /= mean * (1.0 + OWN);
        for at in 0..covariance.nrows() {
            covariance[(at, at)] += OWN / (1.0 + OWN);
        }
        Some(Self(covariance.cholesky()?.unpack()))
    }

    /// The independent numbers.
    pub(super) fn of(&self, numbers: Vec<f64>) -> DVector<f64> {
        let mut numbers = DVector::from_vec(numbers);
        // A factor of Cholesky's has no 0 on its diagonal.
        self.0.solve_lower_triangular_mut(&mut numbers);
        numbers
    }

    /// The independent numbers of each column.
    pub(super) fn of_columns(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut inverse = DMatrix::identity(self.0.nrows(), self.0.nrows());
        self.0.solve_lower_triangular_mut(&mut inverse);
        inverse * columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::lattice;

    #[test]
    fn a_line_has_itself_as_its_means_and_a_narrow_peak_becomes_lower() {
        let mesh = lattice::rectangle(30, 12, 1.0).unwrap();
        let means = Means::new(&mesh, Blur { subset_um: 4.0, smoothing_um: 1.3 });
        let line: Vec<f64> = mesh.points[0].iter().map(|x| 3.0 * x - 2.0).collect();
        for (mean, value) in means.of(&line).iter().zip(&line) {
            assert!((mean - value).abs() < 1e-9, "{mean} {value}");
        }
        let middle = (0..mesh.len()).find(|&at| mesh.point(at) == [15.0, 6.0]).unwrap();
        let mut peak = vec![0.0; mesh.len()];
        peak[middle] = 1.0;
        // A square of four by four points, smoothed.
        assert!(means.of(&peak)[middle] < 1.0 / 16.0);
        let none = Means::new(&mesh, Blur::default());
        assert_eq!(none.of(&line), line);
    }

    #[test]
    fn whitened_numbers_are_independent() {
        let rows = DMatrix::from_row_slice(2, 3, &[1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
        let white = Whitening::new(&rows).unwrap();
        let columns: Vec<DVector<f64>> =
            (0..3).map(|at| white.of(rows.column(at).as_slice().to_vec())).collect();
        let w = DMatrix::from_columns(&columns);
        let covariance = &w * w.transpose();
        // Their own error takes the rest of what was correlated.
        assert!(covariance[(0, 1)].abs() < 0.3 * rows.row(0).norm_squared(), "{covariance}");
    }
}
