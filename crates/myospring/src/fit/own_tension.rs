//! The active tension that a curve asks for, frame by frame.
//!
//! Along equilibria the shortening is a monotone function of the tension, `s = f(T)`, which the table of equilibria has. So
//! each frame has one tension and no parameter is sought:
//! ```text
//! s_i = 1 - L_i / L_rest(t_i),   T_i = f^-1(s_i),   sigma_T = sigma_s / f'(T_i)
//! ```
//! Rest, drift, noise, artefacts and bad frames of the curve are those of `analysis::curve`. The band is the image of
//! `s_i -+ t sigma_s`, with Student's `t`, which keeps its 95 % however curved `f` is; `sigma_s` has the noise of a frame and that of its
//! rest. A cell that is longer than at rest would have to push: its tension counts as 0. Where that is more than noise, the cell
//! was not without tension before its beat, and no tension is where it is longest.
//!
//! The shape of a viscous cell is that of a tension `theta` that lags behind the active one (`cell::tension::lag`), so there
//! ```text
//! theta_i = f^-1(s_i),   T = theta + tau dtheta/dt
//! ```
//! with a penalised spline for `theta` ([`spline`]).
//!
//! The force of the same cell on gels tells its Young's modulus, and so the tension in kPa ([`force`]).

mod baseline;
mod beats;
mod course;
mod force;
mod metrics;
mod seen;
mod spline;

use super::answer::{Estimate, Fit, FittedCurve, Verdict};
use super::error::FitError;
use super::fitter::{Fitter, Loaded};
use super::inverse::Inverse;
use super::likelihood::rise_at_ends;
use super::misfit::Misfit;
use super::observed::Stimuli;
use super::repeat::WRITTEN;
use super::words;
use crate::analysis::monotone::MonotoneCubic;
use crate::cell::CellModel as _;
use crate::cell::given_tension::{GivenTension, TensionClock, TensionCourse};
use crate::cell::pacing::Protocol;
use crate::cell::tension::lag::Lag;
use crate::integrate::Method;
use crate::mechanics::support::SupportKind;
use crate::settings::{Calibration, Run};
use crate::simulation::equilibria::TensionResponse;
use crate::simulation::{Simulation, StretchFelt};
use course::NORMAL;
pub use course::{FILE, MeanBeat, OwnTension, TensionMetric};
use force::Forces;
use seen::Seen;
use spline::Spline;
use std::sync::Arc;

/// Tables are solved for more than the largest shortening that is seen, by this factor.
const MARGIN: f64 = 1.2;
/// Degrees of freedom of the noise by the median of fourth differences, over the number of frames: 0.62 of their mean square
/// (see `OF_VARIANCE` of `misfit`), times 0.37, the efficiency of a median.
const OF_FREEDOM: f64 = 0.23;

impl Fitter {
    /// Of a simulation whose own cell model does not matter: its tension is what curves ask for.
    ///
    /// # Errors
    /// A support under which a length does not determine the tension.
    pub fn of_tension(simulation: Simulation) -> Result<Self, FitError> {
        if let SupportKind::AfterloadedEnds { .. } = simulation.support {
            return Err(FitError::Setting {
                what: "support = \"afterloaded-ends\"",
                why: "a cell at its stop has one length under many tensions; its own tension cannot be read from it",
            });
        }
        Ok(Self::seeking_tension(simulation))
    }

    /// The tension that a curve asks for; other curves are forces of the same cell, which tell its Young's modulus.
    pub(super) fn own_tension(&self, curves: &[Loaded]) -> Result<Fit, FitError> {
        let Some((Loaded { support, observed, .. }, forces)) = curves.split_first() else {
            return Err(FitError::Setting { what: "no curve", why: "there is nothing to fit" });
        };
        let simulation = Simulation { support: *support, ..self.simulation().clone() };
        let seen = Seen::of(observed)?;
        let most = seen.shortening.iter().copied().fold(0.0, f64::max);
        let up_to = (MARGIN * most).clamp(0.02, 0.8);
        let tables = self.shelf().tables(&simulation, up_to, !forces.is_empty())?;
        let retardation_ms = simulation.material.retardation_time;
        let tension =
            |factor: f64| seen.tension(&tables.at(factor), factor * self.modulus(), retardation_ms);
        if forces.is_empty() {
            return Ok(self.fit_of_tension(&seen, tension(1.0), &tables.at(1.0)));
        }
        let peak = |own: &OwnTension| {
            own.metrics.iter().find(|metric| metric.name == "peak_tension").map(|it| it.value)
        };
        let forces = Forces::of(self, &simulation, (&seen, &tables), forces)?;
        let stiffness = forces.stiffness()?;
        let factor = stiffness.value;
        let mut own = tension(factor);
        // How the tension follows the stiffness, at the ends of its interval.
        let at_peak = peak(&own);
        let ends = stiffness.interval().map(|end| Some(peak(&tension(end?))? / at_peak?));
        own.widen(ends);
        let mut fit = self.fit_of_tension(&seen, own, &tables.at(factor));
        for estimate in fit.estimates.iter_mut().filter(|it| is_of_stiffness(&it.unit)) {
            for (end, of_stiffness) in estimate.interval.iter_mut().zip(ends) {
                *end = end.filter(|_| of_stiffness.is_some());
            }
            if stiffness.verdict() != Verdict::Determined {
                estimate.verdict = stiffness.verdict();
            }
        }
        fit.estimates.insert(0, stiffness.estimate(self.modulus()));
        let none = || FitError::NoBeat { name: observed.name.clone() };
        fit.curves.extend(forces.fitted(factor).ok_or_else(none)?);
        fit.judge();
        fit.verdicts = words::of_own_tension(&fit, self.modulus(), self.simulation().support);
        Ok(fit)
    }

    fn fit_of_tension(
        &self,
        seen: &Seen<'_>,
        own: OwnTension,
        response: &dyn TensionResponse,
    ) -> Fit {
        let Seen { observed, times, values, used, noise, .. } = seen;
        let acting = own.shaping(self.simulation().material.retardation_time);
        let fitted: Vec<f64> = times
            .iter()
            .map(|time| seen.value(*time, response.shortening(acting.at(*time - times[0]))[0]))
            .collect();
        let off = values.iter().zip(&fitted).zip(used).filter(|(_, used)| **used);
        let off: Vec<f64> = off.map(|((value, fitted), _)| value - fitted).collect();
        let squares: f64 = off.iter().map(|off| off * off).sum();
        let residual = (squares / off.len().max(1) as f64).sqrt();
        let stimuli_ms = observed.stimuli.times().to_vec();
        let misfit = Misfit::of_residuals(&off, times, values, used, &stimuli_ms);
        let curve = FittedCurve {
            name: observed.name.clone(),
            scale: observed.scale,
            unit: observed.unit.clone(),
            times_ms: times.clone(),
            measured: values.clone(),
            fitted,
            used: used.clone(),
            left_out_ms: observed.gaps(),
            stimuli_ms,
            noise: *noise,
            residual,
            misfit: misfit.size,
            frames_together: misfit.together,
            unexplained: misfit.unexplained,
        };
        let estimates = own.metrics.iter().map(TensionMetric::estimate).collect();
        let mut fit = Fit {
            model: self.simulation().cell.name().to_owned(),
            verdict: curve.verdict(),
            estimates,
            correlations: None,
            correlated: Vec::new(),
            reduced_chi_squared: squares / (noise * noise) / off.len().max(1) as f64,
            curves: vec![curve],
            verdicts: Vec::new(),
            agreeing_starts: [1, 1],
            starts: vec![residual / noise],
            variance_factor: 1.0,
            rise_at_ends: NORMAL * NORMAL,
            beats_before: 0,
            numbers: own.times_ms.len(),
            evaluations: times.len(),
            own_tension: Some(own),
            tried: Vec::new(),
            calcium: None,
        };
        fit.verdicts = words::of_own_tension(&fit, self.modulus(), self.simulation().support);
        fit
    }
}

/// Whether a number of this unit is in proportion to the stiffness of the cell.
fn is_of_stiffness(unit: &str) -> bool {
    unit.starts_with("kPa")
}

impl OwnTension {
    /// Widens all intervals by that of the stiffness: how many times the tension is larger at its ends; `None` sets no end, which
    /// widens nothing here.
    fn widen(&mut self, ends: [Option<f64>; 2]) {
        let [low, high] = ends.map(|end| end.map_or(0.0, |end| (end - 1.0).abs()));
        let wider = |value: f64, end: f64, by: f64| {
            value + (end - value).signum() * (end - value).hypot(by * value)
        };
        let deviation = 0.5 * (low + high) / NORMAL;
        for at in 0..self.tension_kpa.len() {
            let value = self.tension_kpa[at];
            let [from, to] = [self.band_kpa[0][at], self.band_kpa[1][at]];
            self.band_kpa[0][at] = (value - (value - from).hypot(low * value)).max(0.0);
            self.band_kpa[1][at] = value + (to - value).hypot(high * value);
            let own = &mut self.standard_deviation_kpa[at];
            *own = own.hypot(deviation * value);
        }
        let metrics = self.metrics.iter_mut().filter(|metric| is_of_stiffness(metric.unit));
        for metric in metrics {
            let value = metric.value;
            let widened = |[from, to]: [f64; 2]| [wider(value, from, low), wider(value, to, high)];
            metric.interval = widened(metric.interval);
            metric.interval_by_noise = widened(metric.interval_by_noise);
            metric.interval_by_beats = metric.interval_by_beats.map(widened);
            metric.standard_deviation = metric.standard_deviation.hypot(deviation * value);
        }
    }

    /// The tension that shapes the cell at a time since the first frame: the active one, or what lags behind it.
    fn shaping(&self, retardation_ms: f64) -> MonotoneCubic {
        let Self { times_ms, tension_kpa, .. } = self;
        let lag = Lag::by(retardation_ms);
        let mut theta = tension_kpa.clone();
        for at in 1..theta.len() {
            let over = times_ms[at] - times_ms[at - 1];
            theta[at] = lag.over_line(over, theta[at - 1], [tension_kpa[at - 1], tension_kpa[at]]);
        }
        MonotoneCubic::new(times_ms.clone(), theta)
    }

    /// The run that repeats the curve, from one of a cell of this Young's modulus: it reads the tension from `tension.csv`, which is
    /// the caller's to write.
    pub(super) fn run(
        &self,
        mut run: Run,
        fit: &Fit,
        young_modulus_kpa: f64,
    ) -> Result<Run, FitError> {
        let course = TensionCourse::new(&self.times_ms, &self.tension_kpa)
            .map_err(|cause| FitError::NoCourse { cause })?;
        let given = GivenTension::example().with_course(course, TensionClock::Run);
        run.protocol = Protocol::once(given.default_stimulus());
        run.numerics.cell = None;
        run.numerics.method = Method::QuasiStatic;
        run.cell = Arc::new(given);
        run.material.stiffen(self.young_modulus_kpa / young_modulus_kpa);
        (run.tension, run.tension_clock) = (Some(FILE.to_owned()), Some(TensionClock::Run));
        (run.calcium, run.calibration) = (None, Calibration::default());
        (run.steady_state, run.stretch_felt) = (None, StretchFelt::Cell);
        if let Some(curve) = fit.curves.first() {
            let (first, start) = (curve.times_ms[0], curve.stimuli_ms[0]);
            let last = curve.stimuli_ms[curve.stimuli_ms.len() - 1];
            run.protocol.start_ms = (start - first).max(0.0);
            run.protocol.beats = curve.stimuli_ms.len() as u32;
            if curve.stimuli_ms.len() > 1 {
                let cycle = (last - start) / (curve.stimuli_ms.len() - 1) as f64;
                run.protocol.cycle_length_ms = (cycle * WRITTEN).round() / WRITTEN;
            }
            let end = curve.times_ms[curve.times_ms.len() - 1];
            run.duration = (end - first).max(1.0).ceil();
        }
        Ok(run)
    }
}

/// Half the width of a 95 % band in standard deviations of the noise, which was estimated from this number of frames.
fn normal(frames: usize) -> f64 {
    rise_at_ends((OF_FREEDOM * frames as f64).max(2.0)).sqrt()
}

impl Seen<'_> {
    fn tension(
        &self,
        response: &dyn TensionResponse,
        young_modulus_kpa: f64,
        retardation_ms: f64,
    ) -> OwnTension {
        let [most, _] = response.shortening(response.highest());
        let used = || (0..self.times.len()).filter(|&at| self.used[at]);
        let inverse = Inverse::of(response);
        let at = |shift: f64| -> Vec<f64> {
            used().map(|at| inverse.at(self.shortening[at] + shift * self.deviation[at])).collect()
        };
        let normal = normal(self.times.len());
        let theta = at(0.0);
        let slope = |(at, tension): (usize, &f64)| {
            self.deviation[at] / response.shortening(tension.max(0.0))[1]
        };
        let deviation: Vec<f64> = used().zip(&theta).map(slope).collect();
        let times_ms: Vec<f64> = used().map(|at| self.times[at] - self.times[0]).collect();
        let (unclipped_kpa, standard_deviation_kpa, ends) = if retardation_ms > 0.0 {
            let spline = Spline::through(&times_ms, &theta, &deviation);
            let found = times_ms.iter().map(|time| spline.at(*time, retardation_ms));
            let (found, deviation): (Vec<f64>, Vec<f64>) = found.map(|[a, b]| (a, b)).unzip();
            let end = |by: f64| found.iter().zip(&deviation).map(|(t, d)| t + by * d).collect();
            let ends: [Vec<f64>; 2] = [end(-normal), end(normal)];
            (found, deviation, ends)
        } else {
            (theta, deviation, [at(-normal), at(normal)])
        };
        let clipped =
            |end: Vec<f64>| end.into_iter().map(|tension| tension.max(0.0)).collect::<Vec<f64>>();
        let band_kpa = ends.map(clipped);
        let mut own = OwnTension {
            times_ms,
            tension_kpa: unclipped_kpa.iter().map(|tension| tension.max(0.0)).collect(),
            standard_deviation_kpa,
            band_kpa,
            young_modulus_kpa,
            clipped: unclipped_kpa.iter().filter(|tension| **tension < 0.0).count(),
            longer_than_before: self.longer,
            rest_raised: self.raised,
            unclipped_kpa,
            too_short: used().filter(|&at| self.shortening[at] > most).count(),
            mean_beat: None,
            metrics: Vec::new(),
        };
        own.read_beats(&self.stimuli());
        own
    }

    /// Stimuli since the first frame.
    fn stimuli(&self) -> Stimuli {
        match &self.observed.stimuli {
            Stimuli::Given(times) => {
                Stimuli::Given(times.iter().map(|time| time - self.times[0]).collect())
            }
            seen => seen.clone(),
        }
    }
}

impl TensionMetric {
    /// As an estimate of a fit.
    fn estimate(&self) -> Estimate {
        Estimate {
            name: self.name.to_owned(),
            unknown: None,
            unit: self.unit.to_owned(),
            value: self.value,
            interval: [Some(self.interval[0]), Some(self.interval[1]).filter(|_| !self.is_fast)],
            standard_deviation: Some(self.standard_deviation),
            bounds: self.interval,
            profile: Vec::new(),
            verdict: if self.is_fast { Verdict::AtLeast } else { Verdict::Determined },
        }
    }
}
