//! Neighbouring points: predicting a point from its neighbours, and groups of points that agree.

use super::subset::Warp;
use myospring_core::analysis::order;

/// Least number of neighbours from which a point is predicted.
const FEWEST: usize = 3;
/// Least number of points of an affine fit; the standard deviation of its weights, as a part of the
/// reach; and the least spread of its points, relative to the fourth power of that standard
/// deviation (with less, the points are collinear or on one side).
const FEWEST_FITTED: usize = 5;
pub(super) const SMOOTHING: f32 = 2.0;
const LEAST_SPREAD: f64 = 0.02;

/// Distance of neighbours, in spacings of the lattice.
pub(super) const REACH: f32 = 2.6;

/// Lists of points near each other.
#[derive(Debug, Clone)]
pub(super) struct Neighbours {
    reach: f32,
    points: Vec<[f32; 2]>,
    /// Neighbours of each point, the nearest first.
    near: Vec<Vec<u32>>,
    /// How many of them are adjacent to it.
    adjacent: Vec<usize>,
}

/// Shift of a point predicted by a neighbour, and the neighbour's own warp.
type Heard = ([f32; 2], Warp);

/// Prediction of a point by its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hearsay {
    /// Median of the predictions.
    pub(super) warp: Warp,
    /// Standard deviation of the predictions, from their median absolute deviation, pixels.
    pub(super) spread: f32,
}

impl Neighbours {
    /// Lists the points within `reach` of each point as neighbours, and those within `next` as
    /// adjacent.
    pub(super) fn of(points: Vec<[f32; 2]>, reach: f32, next: f32) -> Self {
        let bin = |place: f32| (place / reach).floor() as i32;
        let mut bins = std::collections::HashMap::<[i32; 2], Vec<u32>>::new();
        for (index, point) in points.iter().enumerate() {
            bins.entry(point.map(bin)).or_default().push(index as u32);
        }
        let mut near = Vec::with_capacity(points.len());
        let mut adjacent = Vec::with_capacity(points.len());
        for (index, point) in points.iter().enumerate() {
            let [column, row] = point.map(bin);
            let around = (-1..=1).flat_map(|c| (-1..=1).map(move |r| [column + c, row + r]));
            let mut found: Vec<(f32, u32)> = around
                .filter_map(|bin| bins.get(&bin))
                .flatten()
                .map(|&other| (distance(*point, points[other as usize]), other))
                .filter(|&(distance, other)| distance <= reach && other as usize != index)
                .collect();
            found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            adjacent.push(found.iter().take_while(|(distance, _)| *distance <= next).count());
            near.push(found.into_iter().map(|(_, other)| other).collect());
        }
        Self { reach, points, near, adjacent }
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    /// Shift of a point predicted by the warp of a neighbour.
    fn says(&self, neighbour: usize, warp: &Warp, point: usize) -> [f32; 2] {
        let [from, to] = [self.points[neighbour], self.points[point]];
        warp.at([to[0] - from[0], to[1] - from[1]])
    }

    /// Prediction of a point by those of its neighbours whose warp is known; `None` if they are too
    /// few.
    pub(super) fn hearsay(
        &self,
        point: usize,
        know: impl Fn(usize) -> Option<Warp>,
    ) -> Option<Hearsay> {
        let heard = self.heard(point, know)?;
        let (shift, spread) = shift_and_spread(&heard);
        let slope = |a: usize, b: usize| middle(&heard, |said| said.1.gradient[a][b]);
        let gradient = [[slope(0, 0), slope(0, 1)], [slope(1, 0), slope(1, 1)]];
        Some(Hearsay { warp: Warp { shift, gradient }, spread })
    }

    /// The shift of [`Neighbours::hearsay`] and its spread, without the slopes.
    pub(super) fn heard_shift(
        &self,
        point: usize,
        know: impl Fn(usize) -> Option<Warp>,
    ) -> Option<([f32; 2], f32)> {
        Some(shift_and_spread(&self.heard(point, know)?))
    }

    fn heard(&self, point: usize, know: impl Fn(usize) -> Option<Warp>) -> Option<Vec<Heard>> {
        let heard: Vec<Heard> = (self.near[point].iter())
            .filter_map(|&other| {
                let warp = know(other as usize)?;
                Some((self.says(other as usize, &warp, point), warp))
            })
            .collect();
        (heard.len() >= FEWEST).then_some(heard)
    }

    /// Median shift of those neighbours of a point whose warp is known.
    pub(super) fn shift(
        &self,
        point: usize,
        know: impl Fn(usize) -> Option<Warp>,
    ) -> Option<[f32; 2]> {
        let near = self.near[point].iter();
        let heard: Vec<[f32; 2]> =
            near.filter_map(|&other| Some(know(other as usize)?.shift)).collect();
        (heard.len() >= FEWEST)
            .then(|| [0, 1].map(|a: usize| median(heard.iter().map(|shift| shift[a]).collect())))
    }

    /// The affine motion that best fits a point and its neighbours, with weights that decrease with
    /// distance: it smooths noise and keeps uniform strain. `None` if the points are too few or
    /// collinear.
    pub(super) fn fitted(
        &self,
        point: usize,
        know: impl Fn(usize) -> Option<([f32; 2], f32)>,
    ) -> Option<Warp> {
        let middle = self.points[point];
        let width = self.reach / SMOOTHING;
        // Sums of 1, x, y, xx, xy, yy, and of each shift times 1, x, y.
        let (mut sums, mut moments) = ([0.0_f64; 6], [[0.0_f64; 3]; 2]);
        let mut count = 0;
        for other in self.near[point].iter().copied().chain([point as u32]) {
            let Some((shift, weight)) = know(other as usize) else { continue };
            let [x, y] = [0, 1]
                .map(|a: usize| f64::from((self.points[other as usize][a] - middle[a]) / width));
            let weight = f64::from(weight) * (-0.5 * (x * x + y * y)).exp();
            for (sum, term) in sums.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]) {
                *sum += weight * term;
            }
            for (moments, shift) in moments.iter_mut().zip(shift) {
                for (moment, term) in moments.iter_mut().zip([1.0, x, y]) {
                    *moment += weight * term * f64::from(shift);
                }
            }
            count += 1;
        }
        if count < FEWEST_FITTED {
            return None;
        }
        let [n, x, y, xx, xy, yy] = sums;
        // Cofactors of the symmetric matrix of sums.
        let rows = [
            [xx * yy - xy * xy, xy * y - x * yy, x * xy - xx * y],
            [xy * y - x * yy, n * yy - y * y, x * y - n * xy],
            [x * xy - xx * y, x * y - n * xy, n * xx - x * x],
        ];
        let determinant = n * rows[0][0] + x * rows[0][1] + y * rows[0][2];
        if determinant.is_nan() || determinant <= LEAST_SPREAD * n.powi(3) {
            return None;
        }
        let solved = moments.map(|moments| {
            rows.map(|row| row.iter().zip(moments).map(|(a, b)| a * b).sum::<f64>() / determinant)
        });
        let [u, v] = solved;
        let slope = |value: f64| (value / f64::from(width)) as f32;
        Some(Warp {
            shift: [u[0] as f32, v[0] as f32],
            gradient: [[slope(u[1]), slope(u[2])], [slope(v[1]), slope(v[2])]],
        })
    }

    /// Marks the points of groups that border on a larger group and disagree with it. A group
    /// consists of adjacent points that agree within `tolerance`.
    pub(super) fn at_odds(&self, known: &[Option<Warp>], tolerance: f32) -> Vec<bool> {
        let mut root: Vec<u32> = (0..self.len() as u32).collect();
        let mut torn = Vec::new();
        for (point, warp) in known.iter().enumerate() {
            let Some(warp) = warp else { continue };
            for &other in &self.near[point][..self.adjacent[point]] {
                let Some(others) = &known[other as usize] else { continue };
                if (other as usize) < point {
                    continue;
                }
                let there = self.says(point, warp, other as usize);
                let back = self.says(other as usize, others, point);
                let off = distance(there, others.shift).min(distance(back, warp.shift));
                if off <= tolerance {
                    let [a, b] = [point as u32, other].map(|at| top(&mut root, at));
                    root[a.max(b) as usize] = a.min(b);
                } else {
                    torn.push([point as u32, other]);
                }
            }
        }
        let group: Vec<u32> = (0..self.len() as u32).map(|at| top(&mut root, at)).collect();
        let mut size = vec![0_usize; self.len()];
        for (point, &group) in group.iter().enumerate() {
            size[group as usize] += usize::from(known[point].is_some());
        }
        let mut odd = vec![false; self.len()];
        for pair in torn {
            let [a, b] = pair.map(|point| group[point as usize] as usize);
            if a != b {
                let smaller = if (size[a], b) < (size[b], a) { a } else { b };
                odd[smaller] = true;
            }
        }
        group
            .iter()
            .zip(known)
            .map(|(&group, known)| known.is_some() && odd[group as usize])
            .collect()
    }
}

fn middle(heard: &[Heard], of: impl Fn(&Heard) -> f32) -> f32 {
    median(heard.iter().map(of).collect())
}

/// Median of the shifts that are heard, and their standard deviation.
fn shift_and_spread(heard: &[Heard]) -> ([f32; 2], f32) {
    let shift = [0, 1].map(|a: usize| middle(heard, |said| said.0[a]));
    // For a normal distribution in the plane, the median distance is 1.1774 standard deviations.
    (shift, middle(heard, |said| distance(said.0, shift)) / 1.1774)
}

/// The representative of a point's group.
fn top(root: &mut [u32], mut at: u32) -> u32 {
    while root[at as usize] != at {
        root[at as usize] = root[root[at as usize] as usize];
        at = root[at as usize];
    }
    at
}

pub(super) fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The median, NaN of no values.
pub(super) fn median(values: Vec<f32>) -> f32 {
    order::median(values).unwrap_or(f32::NAN)
}
