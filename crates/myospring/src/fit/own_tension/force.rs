//! Young's modulus of a cell whose own tension is sought, from the force of the same cell on gels.
//!
//! At each modulus the shape asks for a tension, and that tension pulls at a gel with a force. The mean beat of the shape gives the
//! force of a beat, `f`, which is laid over the measured force, beat by beat: `F_i = rest_b + a f(t_i - d_b)`. The delays are those
//! of the run's modulus; the height `a` of all beats then depends on the modulus alone, and is 1 where the force is that of the cell:
//! ```text
//! chi^2(E) = sum over the curves of (ln a(E) / sigma_a)^2
//! ```
//! `sigma_a` has the residuals of the force, the error of its scale, and the noise of the shape.

use super::seen::Seen;
use super::spline::Spline;
use crate::analysis::monotone::MonotoneCubic;
use crate::analysis::order;
use crate::fit::answer::{Estimate, FittedCurve, Verdict};
use crate::fit::error::FitError;
use crate::fit::fitter::{Fitter, Loaded, UNKNOWN};
use crate::fit::inverse::Inverse;
use crate::fit::least_squares::Problem;
use crate::fit::likelihood::{OF_95_PERCENT, Profile, Top, covariance, profile};
use crate::fit::misfit::Misfit;
use crate::fit::observed::{Observed, Scale};
use crate::fit::sure::widened;
use crate::fit::table::{STIFFNESS_BOUNDS, Tables};
use crate::fit::unknown::Unknown;
use crate::simulation::Simulation;
use crate::simulation::equilibria::TensionResponse;
use std::sync::Arc;

/// Delays between the beat of the shape and that of the force that are tried, ms either way, and how many.
const LATEST_MS: f64 = 100.0;
const DELAYS: f64 = 80.0;
/// Starts of the search for the stiffness, and the step of its logarithm for a derivative.
const STARTS: u32 = 4;
const STEP: f64 = 1e-3;
/// Points of the mean beat for each frame: it is laid between frames.
const FINER: usize = 8;
/// Shortest beat that is known, frames.
const FEWEST: usize = 4;

/// The forces of one cell.
pub(super) struct Forces<'a> {
    shape: &'a Tables,
    beat: MeanShape,
    curves: Vec<Force<'a>>,
    /// Relative standard deviation of the height of the shape's beats.
    noise: f64,
}

/// Young's modulus as a factor on that of the run.
pub(super) struct Stiffness {
    pub(super) value: f64,
    /// Standard deviation of its logarithm.
    deviation: Option<f64>,
    /// Of its logarithm.
    profile: Profile,
}

/// The mean beat of a shape, from its stimulus.
struct MeanShape {
    times_ms: Vec<f64>,
    /// A part of the length at rest.
    shortening: Vec<f64>,
}

/// A measured force, and the equilibria on its gel.
struct Force<'a> {
    observed: &'a Observed,
    load: &'static str,
    scale_error: f64,
    tables: Arc<Tables>,
    times: Vec<f64>,
    values: Vec<f64>,
    noise: f64,
    /// For each frame its beat.
    beats: Vec<usize>,
    /// The begin of each beat on the clock of this curve.
    starts: Vec<f64>,
}

/// The height of measured beats over that of the cell's, and its relative standard deviation by the residuals.
struct Height {
    ratio: f64,
    error: f64,
    fitted: Vec<f64>,
}

impl<'a> Forces<'a> {
    pub(super) fn of(
        fitter: &Fitter,
        simulation: &Simulation,
        (seen, shape): (&Seen<'_>, &'a Tables),
        loads: &'a [Loaded],
    ) -> Result<Self, FitError> {
        let beat = MeanShape::of(seen)
            .ok_or_else(|| FitError::NoBeat { name: seen.observed.name.clone() })?;
        let curves = loads.iter().map(|loaded| Force::of(fitter, simulation, loaded));
        let noise = seen.noise_of_height();
        let mut forces = Self { shape, beat, curves: curves.collect::<Result<_, _>>()?, noise };
        for at in 0..forces.curves.len() {
            let Some(course) = forces.course(&forces.curves[at], 1.0) else {
                let Force { observed, load, .. } = forces.curves[at];
                return Err(FitError::NoLoad { name: observed.name.clone(), load });
            };
            forces.curves[at].align(&course);
        }
        Ok(forces)
    }

    /// The force of the mean beat on the gel of a curve, above that at rest, at a stiffness of the cell; `None` if the support has no
    /// such force.
    fn course(&self, force: &Force<'_>, stiffness: f64) -> Option<MonotoneCubic> {
        let (shape, gel) = (self.shape.at(stiffness), force.tables.at(stiffness));
        let inverse = Inverse::of(&shape);
        let load = |tension: f64| gel.load(force.load, tension).map(|[load, _]| load);
        let at_rest = load(0.0)?;
        let values = self
            .beat
            .shortening
            .iter()
            .map(|shortening| Some(load(inverse.at(*shortening).max(0.0))? - at_rest));
        Some(MonotoneCubic::new(self.beat.times_ms.clone(), values.collect::<Option<_>>()?))
    }

    /// For each curve the logarithm of `a`, over its standard deviation.
    fn residuals(&self, stiffness: f64) -> Option<Vec<f64>> {
        let residual = |force: &Force<'_>| {
            let Height { ratio, error, .. } = force.height(&self.course(force, stiffness)?)?;
            Some(ratio.ln() / error.hypot(force.scale_error).hypot(self.noise))
        };
        self.curves.iter().map(residual).collect()
    }

    /// The stiffness with which the cell has these forces.
    ///
    /// # Errors
    /// A force that does not rise where the shape contracts.
    pub(super) fn stiffness(&self) -> Result<Stiffness, FitError> {
        let bounds = [STIFFNESS_BOUNDS.map(f64::ln)];
        let residuals = |at: &[f64]| self.residuals(at[0].exp());
        let problem = Problem::plain(&residuals, &bounds, &[STEP]);
        let [low, high] = bounds[0];
        let starts =
            (0..STARTS).map(|at| low + (high - low) * (f64::from(at) + 0.5) / f64::from(STARTS));
        let found = starts.filter_map(|start| problem.minimise(&[start], &[false]));
        let least = found.min_by(|a, b| a.sum.total_cmp(&b.sum));
        let least = least.ok_or_else(|| FitError::NoBeat { name: self.name() })?;
        let deviation = covariance(&problem, &least).map(|all| all[0][0].sqrt());
        let top = Top { least: &least, others: &[], unit: 1.0, at_ends: OF_95_PERCENT };
        let guess = 2.0 * deviation.unwrap_or(0.01 * (high - low));
        Ok(Stiffness {
            value: least.at[0].exp(),
            deviation,
            profile: profile(&problem, &top, 0, guess),
        })
    }

    fn name(&self) -> String {
        self.curves.first().map_or_else(String::new, |force| force.observed.name.clone())
    }

    /// The curves with the forces of a cell of this stiffness.
    pub(super) fn fitted(&self, stiffness: f64) -> Option<Vec<FittedCurve>> {
        let curve = |force: &Force<'_>| {
            Some(force.fitted(force.height(&self.course(force, stiffness)?)?.fitted))
        };
        self.curves.iter().map(curve).collect()
    }
}

impl Stiffness {
    /// Ends of its 95 % interval; `None` where the forces set none.
    pub(super) fn interval(&self) -> [Option<f64>; 2] {
        self.profile.ends.map(|end| end.map(f64::exp))
    }

    pub(super) fn verdict(&self) -> Verdict {
        self.profile.verdict
    }

    pub(super) fn estimate(&self, modulus: f64) -> Estimate {
        let value = |at: f64| modulus * at.exp();
        Estimate {
            name: Unknown::YoungModulus.name().to_owned(),
            unknown: Some(Unknown::YoungModulus),
            unit: "kPa".to_owned(),
            value: modulus * self.value,
            interval: self.profile.ends.map(|end| end.map(value)),
            standard_deviation: self.deviation.map(|deviation| deviation * modulus * self.value),
            bounds: STIFFNESS_BOUNDS.map(|bound| modulus * bound),
            profile: self.profile.points.iter().map(|[at, rise]| [value(*at), *rise]).collect(),
            verdict: self.profile.verdict,
        }
    }
}

impl MeanShape {
    /// `None` if no beat has enough frames.
    fn of(seen: &Seen<'_>) -> Option<Self> {
        let used = || (0..seen.times.len()).filter(|&at| seen.used[at]);
        let times: Vec<f64> = used().map(|at| seen.times[at]).collect();
        let shortening: Vec<f64> = used().map(|at| seen.shortening[at]).collect();
        let step = order::median(times.windows(2).map(|pair| pair[1] - pair[0]))?;
        let fine = step / FINER as f64;
        let stimuli = seen.observed.stimuli.times();
        let (last, first) = (*times.last()?, *stimuli.first()?);
        let between = stimuli.windows(2).map(|pair| pair[1] - pair[0]);
        let span = between.fold(last - first, f64::min);
        let whole: Vec<f64> =
            stimuli.iter().copied().filter(|start| start + span <= last + step).collect();
        let count = (span / step).floor() as usize;
        if whole.is_empty() || count < FEWEST {
            return None;
        }
        let deviation: Vec<f64> = used().map(|at| seen.deviation[at]).collect();
        let course = Spline::through(&times, &shortening, &deviation);
        let times_ms: Vec<f64> = (0..=FINER * count).map(|at| at as f64 * fine).collect();
        let mean = |time: &f64| {
            whole.iter().map(|start| course.at(start + time, 0.0)[0]).sum::<f64>()
                / whole.len() as f64
        };
        Some(Self { shortening: times_ms.iter().map(mean).collect(), times_ms })
    }
}

impl<'a> Force<'a> {
    fn of(fitter: &Fitter, simulation: &Simulation, loaded: &'a Loaded) -> Result<Self, FitError> {
        let Loaded { support, observed, scale_error } = loaded;
        let Scale::Load(load) = observed.scale else {
            return Err(FitError::Setting {
                what: "several curves of one cell",
                why: "each shape has a tension of its own; fit them one by one",
            });
        };
        let on_gel = Simulation { support: *support, ..simulation.clone() };
        let tables = fitter.shelf().tables(&on_gel, UNKNOWN, true)?;
        let frames = observed.frames()?;
        let starts = observed.stimuli.times().to_vec();
        let beat = |time: &f64| starts.partition_point(|start| start <= time).saturating_sub(1);
        let beats = frames.times.iter().map(beat).collect();
        let (times, values, noise) = (frames.times, frames.values, frames.noise);
        let scale_error = *scale_error;
        Ok(Self { observed, load, scale_error, tables, times, values, noise, beats, starts })
    }

    /// Moves the begin of each beat to where this course fits best.
    fn align(&mut self, course: &MonotoneCubic) {
        for beat in 0..self.starts.len() {
            let start = self.starts[beat];
            let left = |delay: f64| {
                let frames = (0..self.times.len()).filter(|&at| self.beats[at] == beat);
                let pairs: Vec<[f64; 2]> = frames
                    .map(|at| [course.at(self.times[at] - start - delay), self.values[at]])
                    .collect();
                let count = pairs.len() as f64;
                let mean = |axis: usize| pairs.iter().map(|pair| pair[axis]).sum::<f64>() / count;
                let means = [mean(0), mean(1)];
                let product = |a: usize, b: usize| -> f64 {
                    pairs.iter().map(|pair| (pair[a] - means[a]) * (pair[b] - means[b])).sum()
                };
                // Of a beat that points down nothing is explained.
                let slope = (product(0, 1) / product(0, 0)).max(0.0);
                if slope.is_finite() {
                    product(1, 1) - slope * (2.0 * product(0, 1) - slope * product(0, 0))
                } else {
                    product(1, 1)
                }
            };
            let mut delay = 0.0;
            for reach in [LATEST_MS, 2.0 * LATEST_MS / DELAYS] {
                let around = delay;
                let delays = (0..=DELAYS as u32)
                    .map(|at| around + reach * (2.0 * f64::from(at) / DELAYS - 1.0));
                delay = delays.min_by(|a, b| left(*a).total_cmp(&left(*b))).unwrap_or(around);
            }
            self.starts[beat] += delay;
        }
    }

    /// `None` if the curve does not rise where the course does.
    fn height(&self, course: &MonotoneCubic) -> Option<Height> {
        let shape: Vec<f64> = (self.times.iter().zip(&self.beats))
            .map(|(time, beat)| course.at(time - self.starts[*beat]))
            .collect();
        let means = |of: &[f64]| -> Vec<f64> {
            let mut sums = vec![[0.0; 2]; self.starts.len()];
            for (value, beat) in of.iter().zip(&self.beats) {
                sums[*beat] = [sums[*beat][0] + value, sums[*beat][1] + 1.0];
            }
            sums.iter().map(|[sum, count]| sum / count.max(1.0)).collect()
        };
        let [mean, level] = [means(&shape), means(&self.values)];
        let (mut both, mut squares) = (0.0, 0.0);
        for at in 0..self.times.len() {
            let off = shape[at] - mean[self.beats[at]];
            both += off * (self.values[at] - level[self.beats[at]]);
            squares += off * off;
        }
        let ratio = both / squares;
        if !(ratio.is_finite() && ratio > 0.0) {
            return None;
        }
        // With the cell's own height, whatever the best one.
        let fitted: Vec<f64> = (shape.iter().zip(&self.beats))
            .map(|(value, beat)| level[*beat] + value - mean[*beat])
            .collect();
        let best = |at: usize| fitted[at] + (ratio - 1.0) * (shape[at] - mean[self.beats[at]]);
        let off: Vec<f64> = (0..self.times.len()).map(|at| self.values[at] - best(at)).collect();
        let misfit = self.misfit(&off);
        let freedom = (off.len() as f64 - self.starts.len() as f64 - 1.0).max(1.0);
        let variance = off.iter().map(|off| off * off).sum::<f64>() / freedom;
        let error = (variance * widened(misfit.together) / squares).sqrt() / ratio;
        Some(Height { ratio, error, fitted })
    }

    fn misfit(&self, off: &[f64]) -> Misfit {
        let used = vec![true; off.len()];
        Misfit::of_residuals(off, &self.times, &self.values, &used, &self.starts)
    }

    fn fitted(&self, fitted: Vec<f64>) -> FittedCurve {
        let off: Vec<f64> = self.values.iter().zip(&fitted).map(|(a, b)| a - b).collect();
        let misfit = self.misfit(&off);
        let squares: f64 = off.iter().map(|off| off * off).sum();
        FittedCurve {
            name: self.observed.name.clone(),
            scale: self.observed.scale,
            unit: self.observed.unit.clone(),
            times_ms: self.times.clone(),
            measured: self.values.clone(),
            used: vec![true; fitted.len()],
            fitted,
            left_out_ms: self.observed.gaps(),
            stimuli_ms: self.starts.clone(),
            noise: self.noise,
            residual: (squares / off.len().max(1) as f64).sqrt(),
            misfit: misfit.size,
            frames_together: misfit.together,
            unexplained: misfit.unexplained,
        }
    }
}
