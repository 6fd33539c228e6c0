//! A run along the path of equilibria.
//!
//! The cell model runs in time and feels the stretch as in any run; the mesh takes at once the shape
//! that belongs to the tension ([`Path`]). So length, width, area and energies are functions of the
//! tension alone. They are computed at nine tensions in each load step and interpolated by cubics
//! through four of them: exact for lengths, which are cubic polynomials of the tension as long as the
//! same nodes are outermost. A frame is the path's own shape.
//!
//! Nothing moves, so momenta and kinetic energy are 0, and nothing is dissipated: the work of the active force is
//! the elastic energy, added up on its own as in a run in time.

use super::{Observed, Progress, Setup, SetupError, Shaping, Simulation, StopReason};
use super::{fault, projected_area};
use crate::integrate::quasi_static::{Path, PathError, Tolerance};
use crate::mechanics::{Configuration, Vectors, zeros};
use crate::recording::Recording;

/// Intervals at whose ends a load step is measured.
const PARTS: usize = 8;

/// Part of the tension by which a path is solved in advance: a beat's peak differs from the reference
/// beat's by some 1e-4, a train of beats may go on rising.
const MARGIN: f64 = 1e-3;

/// What came of a quasi-static run.
#[derive(Debug, Clone, PartialEq)]
pub struct QuasiStaticOutcome {
    /// All that was recorded, up to the stop.
    pub recording: Recording,
    /// Why it stopped early, if it did.
    pub stop: Option<StopReason>,
    /// Load steps of the path.
    pub load_steps: usize,
    /// Iterations of Newton's method; each factorises one matrix.
    pub newton_iterations: usize,
    /// Largest estimated error of a position, um.
    pub error: f64,
    /// Time by which a run in time with the same dampings lags behind, ms.
    pub delay: f64,
}

impl Simulation {
    /// Runs along the path of equilibria, to the end or to the first thing that goes wrong; time step
    /// and integrator of the numerical settings do not matter. `observe` is called at each recorded
    /// sample and stops the run by returning `false`.
    ///
    /// # Errors
    /// Forces for which there is no such path, or a cell model without tension. A path that ends
    /// before the largest tension of the run is no error but a [`StopReason`].
    ///
    /// # Example
    /// ```
    /// use myospring::integrate::quasi_static::Tolerance;
    /// use myospring::mesh::lattice;
    /// use myospring::simulation::Simulation;
    ///
    /// let simulation = Simulation::coelho_2021(lattice::rectangle(20, 4, 5.0)?);
    /// let outcome = simulation.run_quasi_static(Tolerance::default(), |_progress| true)?;
    /// assert!(outcome.stop.is_none());
    /// let peak = outcome.recording.samples.iter().map(|s| s.shortening_pct).fold(0.0, f64::max);
    /// assert!((peak - 12.0).abs() < 0.1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run_quasi_static(
        &self,
        tolerance: Tolerance,
        observe: impl FnMut(Progress) -> bool,
    ) -> Result<QuasiStaticOutcome, SetupError> {
        let setup = self.set_up()?;
        let path = Path::start(&setup.system, &setup.body, tolerance)?;
        let start = setup.tension_at_start();
        let mut shaping =
            AlongPath { setup: &setup, path, curve: Curve::default(), tension: start, offset: 0.0 };
        // Should the path end before the peak, the run goes as far as it can and tells then.
        let _ = shaping.extend((1.0 + MARGIN) * self.peak_tension);
        let (recording, stop) = match shaping.follow(0.0, [start; 2]) {
            Ok(()) => {
                shaping.offset = shaping.curve.at(start)[WORK];
                setup.run(&mut shaping, observe)
            }
            Err(reason) => (Recording::default(), Some(reason)),
        };
        Ok(QuasiStaticOutcome {
            recording,
            stop,
            load_steps: shaping.path.load_steps(),
            newton_iterations: shaping.path.newton_iterations(),
            error: shaping.path.error(),
            delay: shaping.path.delay(),
        })
    }
}

/// Length, width, area, elastic energy and work of the active forces since tension 0.
type Quantities = [f64; 5];
const WORK: usize = 4;

/// Quantities as functions of the tension.
#[derive(Debug, Default)]
struct Curve {
    /// kPa, ascending; `PARTS` intervals to a load step.
    tensions: Vec<f64>,
    values: Vec<Quantities>,
    /// Lowest and highest tension, kPa, up to which the measured shapes are without fault.
    intact: [f64; 2],
}

impl Curve {
    fn of(path: &Path<'_>, setup: &Setup<'_>) -> Self {
        let knots = path.tensions();
        let mut tensions: Vec<f64> = knots
            .windows(2)
            .flat_map(|pair| {
                (0..PARTS)
                    .map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / PARTS as f64)
                    .collect::<Vec<f64>>()
            })
            .collect();
        tensions.extend(knots.last());
        let Setup { simulation, system, meter, body, .. } = setup;
        let mesh = &simulation.mesh;
        let still = zeros(body.len());
        let mut curve = Self { tensions, ..Self::default() };
        let mut sound = Vec::new();
        let mut before: Option<(f64, Vectors)> = None;
        let mut work = 0.0;
        for &tension in &curve.tensions {
            let Some(positions) = path.positions(tension) else { break };
            let energy = |positions: &Vectors, tension: f64| {
                let at = Configuration { positions, velocities: &still, tension };
                system.active_energy(&at)
            };
            // W = -int grad E(x; Ta) dx by the mean tension of each part
            if let Some((last, from)) = &before {
                let mean = 0.5 * (last + tension);
                work += energy(from, mean) - energy(&positions, mean);
            }
            let extent = meter.measure(&positions);
            let at = Configuration { positions: &positions, velocities: &still, tension };
            curve.values.push([
                extent.length,
                extent.width,
                projected_area(mesh, &positions),
                system.elastic_energy(&at),
                work,
            ]);
            sound.push(fault(mesh, &positions, 0.0, tension).is_none());
            before = Some((tension, positions));
        }
        // Work counts from tension 0, which is a knot.
        let rest = curve.tensions.partition_point(|tension| *tension < 0.0);
        let zero = curve.values[rest][WORK];
        for value in &mut curve.values {
            value[WORK] -= zero;
        }
        let up = sound[rest..].iter().take_while(|sound| **sound).count();
        let down = sound[..=rest].iter().rev().take_while(|sound| **sound).count();
        curve.intact =
            [curve.tensions[rest + 1 - down.max(1)], curve.tensions[rest + up.max(1) - 1]];
        curve
    }

    /// Cubic through the four nearest tensions of the load step (Lagrange's).
    fn at(&self, tension: f64) -> Quantities {
        if self.tensions.len() <= PARTS {
            return self.values[0];
        }
        let parts = self.tensions.len() - 1;
        let part = self.tensions.partition_point(|t| *t <= tension).clamp(1, parts) - 1;
        let first = part - part % PARTS;
        let start = (part.max(first + 1) - 1).min(first + PARTS - 3);
        let nodes = &self.tensions[start..start + 4];
        let mut sum = [0.0; 5];
        for (k, values) in self.values[start..start + 4].iter().enumerate() {
            let mut weight = 1.0;
            for (j, node) in nodes.iter().enumerate() {
                if j != k {
                    weight *= (tension - node) / (nodes[k] - node);
                }
            }
            for (total, value) in sum.iter_mut().zip(values) {
                *total += weight * value;
            }
        }
        sum
    }
}

/// A mesh that takes the shape of the path at each tension.
struct AlongPath<'a> {
    setup: &'a Setup<'a>,
    path: Path<'a>,
    curve: Curve,
    /// kPa.
    tension: f64,
    /// Work between tension 0 and the start of the run, fJ.
    offset: f64,
}

impl AlongPath<'_> {
    fn extend(&mut self, tension: f64) -> Result<(), PathError> {
        let reached = self.path.extend(tension);
        self.curve = Curve::of(&self.path, self.setup);
        reached
    }

    fn reaches(&self, tension: f64) -> bool {
        let [lowest, highest] = self.path.range();
        (lowest..=highest).contains(&tension)
    }
}

impl Shaping for AlongPath<'_> {
    fn follow(&mut self, time: f64, tensions: [f64; 2]) -> Result<(), StopReason> {
        let tension = tensions[1];
        if !self.reaches(tension)
            && let Err(cause) = self.extend((1.0 + MARGIN) * tension)
            && !self.reaches(tension)
        {
            let cause = cause.to_string();
            return Err(StopReason::NoEquilibrium { time, tension, cause });
        }
        self.tension = tension;
        let [lowest, highest] = self.curve.intact;
        if !(lowest..=highest).contains(&tension) {
            let positions = self.positions();
            if let Some(reason) = fault(&self.setup.simulation.mesh, &positions, time, tension) {
                return Err(reason);
            }
        }
        Ok(())
    }

    fn length(&self) -> f64 {
        self.curve.at(self.tension)[0]
    }

    fn observe(&self) -> Observed {
        let [length, width, area, elastic_energy, work] = self.curve.at(self.tension);
        Observed {
            length,
            width,
            area,
            elastic_energy,
            kinetic_energy: 0.0,
            active_work: work - self.offset,
            dissipated_energy: 0.0,
            momentum: 0.0,
            angular_momentum: 0.0,
        }
    }

    /// The path reaches every tension that was followed.
    fn positions(&self) -> Vectors {
        self.path.positions(self.tension).unwrap_or_else(|| self.setup.body.positions.clone())
    }
}
