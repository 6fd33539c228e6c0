//! The map of tension, round by round.

use super::TensionMapError;
use super::blur::{Means, Whitening};
use super::cut;
use super::grid::{Grid, Squares};
use super::least::not_negative;
use super::observed_peak::ObservedPeak;
use super::smoothing::{Problem, Smoothing};
use crate::analysis::shape::laid_upon;
use crate::integrate::quasi_static::{Equilibrium, PathError, Tolerance};
use crate::interruption::Interruption;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::{System, Tension, Vectors, zeros};
use crate::mesh::Mesh;
use crate::simulation::Simulation;
use nalgebra::{DMatrix, DVector};

/// Largest chance at which unevenness is reported.
pub const EVEN: f64 = 0.05;

/// The approximate largest number of points of a map's grid, and its finest spacing in spacings of
/// the mesh.
const POINTS: f64 = 240.0;
const FINEST: f64 = 1.5;
/// Fewest squares with an error of their own that a map is made from; the approximate largest number of squares
/// within them, whose errors are alike.
const FEWEST: usize = 6;
const SQUARES: f64 = 1000.0;
/// Error of lengths in a film and on a coarse mesh, relative, which no number of frames averages out.
pub(super) const SYSTEMATIC: f64 = 0.002;
/// Rounds, and the change relative to the mean tension at which they end.
const ROUNDS: usize = 10;
const SETTLED: f64 = 1e-3;
/// Halvings of a step that leads to no equilibrium.
const HALVINGS: usize = 6;

/// Where a cell pulls at the peak of its contraction.
#[derive(Debug, Clone, PartialEq)]
pub struct TensionMap {
    /// Active tension of each triangle, kPa, for the stiffness that the simulation has.
    pub tensions_kpa: Vec<f64>,
    /// Their standard deviations, kPa, at that stiffness.
    pub deviations_kpa: Vec<f64>,
    /// Standard deviation of each tension over the mean tension; independent of the stiffness.
    pub relative_deviations: Vec<f64>,
    /// Resolution around each triangle, um: the side of the square that one number of the map
    /// represents.
    pub resolutions_um: Vec<f64>,
    /// Mean over the volume, kPa.
    pub mean_kpa: f64,
    /// Standard deviation of that.
    pub mean_deviation_kpa: f64,
    /// The uniform tension that fits the film best, kPa.
    pub even_kpa: f64,
    /// Effective number of parameters of the map; 1 for a uniform one.
    pub numbers: f64,
    /// Weight of the smoothness, um^2/kPa^2.
    pub lambda: f64,
    /// Chance that a uniform tension with such noise would look as uneven.
    pub chance_even: f64,
    /// Root mean square distance between the measured positions of the points and those of the map,
    /// um, after the best shift and rotation of the whole cell.
    pub misfit_um: f64,
    /// The same under the uniform tension.
    pub even_misfit_um: f64,
    /// Standard deviation of the mean of a square's points along an axis, um, from the residuals of
    /// the map.
    pub noise_um: f64,
    /// The number of points held at their measured positions, since the frame cuts the cell there.
    pub held_at_cut: usize,
    /// The equilibrium under the map, um, shifted and rotated to the measured positions.
    pub positions_um: [Vec<f64>; 2],
    /// Frames of the film that it was made from.
    pub frames: Vec<usize>,
}

impl TensionMap {
    /// The map of a cell with this stiffness and support, from its measured peak.
    ///
    /// # Errors
    /// Every [`TensionMapError`].
    pub fn of(simulation: &Simulation, seen: &ObservedPeak) -> Result<Self, TensionMapError> {
        Ok(Self::with(simulation, seen, |_, _| Ok(()))?.0)
    }

    /// The map, and what `then` makes of the search that ended at it and of its linear problem.
    pub(super) fn with<R>(
        simulation: &Simulation,
        seen: &ObservedPeak,
        then: impl FnOnce(&mut Search<'_>, &Problem) -> Result<R, TensionMapError>,
    ) -> Result<(Self, R), TensionMapError> {
        let mesh = &simulation.mesh;
        let points = mesh.len();
        let found = seen.displacements_um[0].len().min(seen.found.len());
        if found != points || [seen.displacements_um[1].len(), seen.cut.len()] != [points; 2] {
            return Err(TensionMapError::Mesh { found, points });
        }
        if simulation.active != ActiveLaw::Fibre {
            return Err(TensionMapError::Ends);
        }
        let squares = Squares::new(mesh, seen.alike_um, &seen.found);
        if squares.points.len() < FEWEST {
            return Err(TensionMapError::TooLittle {
                squares: squares.points.len(),
                alike_um: seen.alike_um,
                least: FEWEST,
            });
        }
        let squares = Squares::new(
            mesh,
            (0.5 * seen.alike_um).max((mesh.area() / SQUARES).sqrt()),
            &seen.found,
        );
        let means = Means::new(mesh, seen.blur);
        let averaged = means.summed(&squares.points, &squares.shares());
        let white = Whitening::new(&averaged)
            .ok_or(TensionMapError::NoContraction { tension_kpa: f64::NAN })?;
        let averaged = white.of_columns(&averaged);
        let apart = (mesh.area() / POINTS).sqrt();
        let spacing = mesh.lattice.as_ref().map_or(0.0, |lattice| lattice.spacing);
        let grid = Grid::new(mesh, apart.max(FINEST * spacing));
        let (body, system) = simulation.mechanics();
        let (interruption, tolerance) = (&simulation.interruption, Tolerance::default());
        let equilibrium = Equilibrium::new_interruptible(&system, &body, tolerance, interruption)?;
        let positions = body.positions.clone();
        let values = DVector::zeros(grid.len());
        let mut search = Search {
            mesh,
            system: &system,
            seen,
            squares,
            means,
            averaged,
            white,
            grid,
            equilibrium,
            positions,
            values,
            interruption,
        };
        search.even()?;
        // A cell held at its contracted positions has an equilibrium only under tension, so the
        // uniform tension of the free cell is found first.
        let (mut body, mut system) = simulation.mechanics();
        if cut::hold(mesh, seen, &mut body, &mut system) {
            let mut equilibrium =
                Equilibrium::new_interruptible(&system, &body, tolerance, interruption)?;
            let tensions = search.grid.in_triangles(search.values.as_slice());
            search.positions = equilibrium.find(&body.positions, Tension::PerElement(&tensions))?;
            (search.system, search.equilibrium) = (&system, equilibrium);
        }
        let even_kpa = search.even()?;
        let even_misfit_um = search.misfit();
        let (problem, smoothing) = search.uneven()?;
        let more = then(&mut search, &problem)?;
        Ok((search.answer(&problem, smoothing, even_kpa, even_misfit_um)?, more))
    }

    /// Whether the film shows that the cell pulls unevenly.
    pub fn is_uneven(&self) -> bool {
        self.chance_even <= EVEN
    }

    /// Tension of each triangle over the mean.
    pub fn relative(&self) -> Vec<f64> {
        self.tensions_kpa.iter().map(|tension| tension / self.mean_kpa).collect()
    }
}

/// The state of the iteration.
pub(super) struct Search<'a> {
    pub(super) mesh: &'a Mesh,
    system: &'a System,
    pub(super) seen: &'a ObservedPeak,
    pub(super) squares: Squares,
    pub(super) means: Means,
    /// The independent numbers of the squares of what the film shows of the motion of the points.
    averaged: DMatrix<f64>,
    white: Whitening,
    pub(super) grid: Grid,
    pub(super) equilibrium: Equilibrium<'a>,
    /// The equilibrium under the tensions so far.
    pub(super) positions: Vectors,
    /// These, at the points of the grid, kPa.
    pub(super) values: DVector<f64>,
    pub(super) interruption: &'a Interruption,
}

impl Search<'_> {
    /// Forces of tensions of 1 kPa times these in the triangles.
    fn forces(&self, tensions: &[f64]) -> Vectors {
        let count = self.mesh.len();
        let (mut forces, still) = (zeros(count), zeros(count));
        let at = crate::mechanics::Configuration {
            positions: &self.positions,
            velocities: &still,
            tension: Tension::PerElement(tensions),
        };
        for force in &self.system.active {
            force.add_forces(&at, &mut forces);
        }
        forces
    }

    fn linearise(&mut self) -> Result<(), PathError> {
        let tensions = self.grid.in_triangles(self.values.as_slice());
        self.equilibrium.linearise(&self.positions, Tension::PerElement(&tensions))
    }

    /// The response of the points to 1 kPa times these values of the grid.
    fn response(&mut self, values: &[f64]) -> [DVector<f64>; 2] {
        let forces = self.forces(&self.grid.in_triangles(values));
        self.equilibrium.response(&forces).map(DVector::from_vec)
    }

    /// What the squares show of responses, one below the other in x and in y.
    fn shown(&self, responses: [&DMatrix<f64>; 2]) -> DMatrix<f64> {
        let [x, y] = responses.map(|axis| &self.averaged * axis);
        let mut both = DMatrix::zeros(x.nrows() + y.nrows(), x.ncols());
        both.rows_mut(0, x.nrows()).copy_from(&x);
        both.rows_mut(x.nrows(), y.nrows()).copy_from(&y);
        both
    }

    /// Numbers of the squares, both axes one after the other, so that their errors are independent.
    pub(super) fn independent(&self, numbers: &[f64]) -> DVector<f64> {
        let (x, y) = numbers.split_at(numbers.len() / 2);
        let both = [x, y].map(|axis| self.white.of(axis.to_vec()));
        DVector::from_iterator(numbers.len(), both.iter().flat_map(DVector::iter).copied())
    }

    /// The displacements that the tensions must explain, given the columns.
    fn left(&self, explained: &DVector<f64>) -> DVector<f64> {
        // Rotated to the current positions, so that the remaining rotation is small.
        let target = placed(&self.target(), &self.positions, &self.seen.found);
        let away = [0, 1].map(|axis: usize| {
            let rest = &self.mesh.points[axis];
            let moved: Vec<f64> =
                self.positions[axis].iter().zip(rest).map(|(now, rest)| now - rest).collect();
            let shown = self.means.of(&moved);
            (0..rest.len()).map(|at| target[axis][at] - rest[at] - shown[at]).collect()
        });
        self.independent(&self.squares.means(&away)) + explained
    }

    /// Shifts and rotations of the whole cell in the means of the squares, orthonormal.
    pub(super) fn whole(&self) -> DMatrix<f64> {
        let count = self.mesh.len();
        let [x, y] = &self.positions;
        let ways = [
            [vec![1.0; count], vec![0.0; count]],
            [vec![0.0; count], vec![1.0; count]],
            [y.iter().map(|y| -y).collect(), x.clone()],
        ];
        let columns = ways.map(|way| self.independent(&self.squares.means(&way)));
        DMatrix::from_columns(&columns).qr().q()
    }

    /// The uniform tension: one number, by iteration.
    fn even(&mut self) -> Result<f64, TensionMapError> {
        let count = self.grid.len();
        for _ in 0..ROUNDS {
            self.linearise()?;
            let [x, y] = self.response(&vec![1.0; count]);
            let shown = [x, y].map(|axis| DMatrix::from_columns(&[axis]));
            let column = self.shown(shown.each_ref()).column(0).into_owned();
            let whole = self.whole();
            let column = &column - &whole * whole.tr_mul(&column);
            let left = self.left(&(&column * self.values[0]));
            let tension = column.dot(&left) / column.norm_squared();
            if tension.is_nan() || tension <= 0.0 {
                return Err(TensionMapError::NoContraction { tension_kpa: tension });
            }
            let before = self.values[0];
            self.go_to(&DVector::from_element(count, tension))?;
            if (self.values[0] - before).abs() <= SETTLED * tension {
                break;
            }
        }
        Ok(self.values[0])
    }

    /// The map, by iteration: the last linear problem, and its smoothing.
    fn uneven(&mut self) -> Result<(Problem, Smoothing), TensionMapError> {
        let mut last = None;
        for _ in 0..ROUNDS {
            let problem = self.problem()?;
            let no_answer = || TensionMapError::NoContraction { tension_kpa: f64::NAN };
            let smoothing = problem.smoothing().ok_or_else(no_answer)?;
            let hessian = problem.hessian(smoothing.lambda);
            let b = problem.columns.tr_mul(&problem.seen);
            let values = not_negative(&hessian, &b).ok_or_else(no_answer)?;
            let change = (&values - &self.values).norm() / self.values.norm();
            self.go_to(&values)?;
            last = Some((problem, smoothing));
            if change <= SETTLED {
                break;
            }
        }
        last.ok_or(TensionMapError::NoContraction { tension_kpa: f64::NAN })
    }

    fn problem(&mut self) -> Result<Problem, PathError> {
        let count = self.grid.len();
        self.linearise()?;
        let mut responses = [0, 1].map(|_: usize| DMatrix::zeros(self.mesh.len(), count));
        let mut unit = vec![0.0; count];
        for number in 0..count {
            self.interruption.check()?;
            unit[number] = 1.0;
            for (all, axis) in responses.iter_mut().zip(self.response(&unit)) {
                all.set_column(number, &axis);
            }
            unit[number] = 0.0;
        }
        let columns = self.shown(responses.each_ref());
        let seen = self.left(&(&columns * &self.values));
        let whole = self.whole();
        let columns = &columns - &whole * whole.tr_mul(&columns);
        let seen = &seen - &whole * whole.tr_mul(&seen);
        let mut penalty = DMatrix::zeros(count, count);
        for &[a, b] in &self.grid.sides {
            for (i, j, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                penalty[(i, j)] += sign;
            }
        }
        let freedom = (columns.nrows() - whole.ncols()) as f64;
        let products = columns.transpose() * &columns;
        Ok(Problem { columns, products, seen, freedom, penalty })
    }

    /// Moves to the equilibrium under these values, or as far towards it as equilibria exist.
    fn go_to(&mut self, values: &DVector<f64>) -> Result<(), PathError> {
        let mut part = 1.0;
        for halving in 0..=HALVINGS {
            let tried = &self.values + (values - &self.values) * part;
            let tensions = self.grid.in_triangles(tried.as_slice());
            match self.equilibrium.find(&self.positions, Tension::PerElement(&tensions)) {
                Ok(positions) => {
                    (self.positions, self.values) = (positions, tried);
                    return Ok(());
                }
                Err(error) if halving == HALVINGS => return Err(error),
                Err(_) => part *= 0.5,
            }
        }
        Ok(())
    }

    /// Measured positions of the points, um.
    fn target(&self) -> [Vec<f64>; 2] {
        [0, 1].map(|axis: usize| {
            let rest = &self.mesh.points[axis];
            rest.iter().zip(&self.seen.displacements_um[axis]).map(|(rest, u)| rest + u).collect()
        })
    }

    /// Root mean square distance of the found points from their measured positions, um.
    fn misfit(&self) -> f64 {
        let target = self.target();
        let at = placed(&self.positions, &target, &self.seen.found);
        let off =
            |point: usize| (at[0][point] - target[0][point]).hypot(at[1][point] - target[1][point]);
        let found = (0..self.mesh.len()).filter(|&point| self.seen.found[point]);
        let (sum, count) =
            found.fold((0.0, 0), |(sum, count), point| (sum + off(point).powi(2), count + 1));
        (sum / f64::from(count)).sqrt()
    }

    fn answer(
        self,
        problem: &Problem,
        smoothing: Smoothing,
        even_kpa: f64,
        even_misfit_um: f64,
    ) -> Result<TensionMap, TensionMapError> {
        let Smoothing { lambda, numbers, noise, chance_even } = smoothing;
        let inverse = problem.hessian(lambda).cholesky();
        let inverse =
            inverse.ok_or(TensionMapError::NoContraction { tension_kpa: even_kpa })?.inverse();
        let covariance = &inverse * noise.powi(2);
        // Effective number of parameters at each point of the grid, over its area.
        let shares = &inverse * &problem.products;
        let density = |at: usize| (shares[(at, at)] / self.grid.areas[at]).max(0.0);
        let total: f64 = self.grid.areas.iter().sum();
        let mean_of = DVector::from_iterator(
            self.grid.len(),
            self.grid.areas.iter().map(|area| area / total),
        );
        let mean_kpa = mean_of.dot(&self.values);
        let with_mean = &covariance * &mean_of;
        let mean_variance = mean_of.dot(&with_mean);
        let systematic = |tension: f64| (SYSTEMATIC * tension).powi(2);
        let tensions_kpa = self.grid.in_triangles(self.values.as_slice());
        let deviations: Vec<f64> = (covariance.diagonal().iter().zip(self.values.iter()))
            .map(|(variance, tension)| (variance.max(0.0) + systematic(*tension)).sqrt())
            .collect();
        let relative_deviations: Vec<f64> = (0..self.grid.len())
            .map(|at| {
                let relative = self.values[at] / mean_kpa;
                let variance = covariance[(at, at)] - 2.0 * relative * with_mean[at]
                    + relative.powi(2) * mean_variance;
                variance.max(0.0).sqrt() / mean_kpa
            })
            .collect();
        let densities: Vec<f64> = (0..self.grid.len()).map(density).collect();
        let resolution = |density: f64| density.sqrt().recip();
        Ok(TensionMap {
            tensions_kpa,
            // Between points of the grid the deviations are interpolated as if fully correlated,
            // which slightly overestimates them.
            deviations_kpa: self.grid.in_triangles(&deviations),
            relative_deviations: self.grid.in_triangles(&relative_deviations),
            resolutions_um: self
                .grid
                .in_triangles(&densities)
                .into_iter()
                .map(resolution)
                .collect(),
            mean_kpa,
            mean_deviation_kpa: (mean_variance.max(0.0) + systematic(mean_kpa)).sqrt(),
            even_kpa,
            numbers,
            lambda,
            chance_even,
            misfit_um: self.misfit(),
            even_misfit_um,
            noise_um: noise,
            held_at_cut: self.seen.cut.iter().filter(|cut| **cut).count(),
            positions_um: placed(&self.positions, &self.target(), &self.seen.found),
            frames: self.seen.frames.clone(),
        })
    }
}

/// Points shifted and rotated to others, by least squares over those that were found.
pub(super) fn placed(from: &[Vec<f64>; 2], to: &[Vec<f64>; 2], found: &[bool]) -> [Vec<f64>; 2] {
    let weights: Vec<f64> = found.iter().map(|found| f64::from(u8::from(*found))).collect();
    laid_upon(from, to, &weights)
}
