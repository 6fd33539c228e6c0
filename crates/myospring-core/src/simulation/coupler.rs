//! The coupling of activation and mesh, interval by interval, in runs and in fits.
//!
//! - **Stretch does not change the tension** (`tangent` is `None`): the activation advances under the stretch at the
//!   start of the interval, and the mesh follows its tension: explicit exchange.
//! - **One site that depends on stretch**: tension and length at the end of the interval are solved together. Trial
//!   tensions start from the same state until the activation returns the trial tension. The returned tension falls as
//!   the trial tension rises (a larger tension shortens the cell, and a shorter cell has less tension), so there is one
//!   solution between them. The secant method finds it, safeguarded by bisection. At equilibrium the tension rises
//!   linearly to it over the interval, which is of order 2. In time it acts over the whole interval (backward Euler); a
//!   linear rise would oscillate where the tension depends steeply on the rate.
//! - **A site for each triangle, in time**: within the interval the tension of each triangle follows its own
//!   stretch and rate by the activation's tangent, in every step of the masses ([`Following`]). The time step
//!   is stable under the steepest tangent that the activation states
//!   ([`crate::exchange::ActivationBounds`]). At the end the activation advances under that stretch. If the tension of
//!   the tangent differs from it by more than a thousandth of the strongest tension, the interval is repeated with the
//!   new tangent.
//! - **A site for each triangle, at equilibrium**: the tangent is added to that of the mesh, and the equilibrium
//!   is iterated until its stretch no longer changes.

use super::StopReason;
use super::held::Held;
use super::observer::{RunObserver, RunPart};
use crate::exchange::{
    Activation, ActivationBounds, ActivationError, ActivationTangent, Sites, StretchState,
};
use crate::mechanics::{Following, Tension};

/// A mesh that takes a shape under a tension: by motion in time, or along equilibria.
pub(super) trait Shaping {
    /// Whether it is always in equilibrium, so that a rate is a difference of two equilibria.
    fn is_static(&self) -> bool;
    /// Follows the tension, linear over an exchange interval that ends at a time (ms).
    fn follow(&mut self, time: f64, tensions: [Tension<'_>; 2]) -> Result<(), StopReason>;
    /// Stores the present state.
    fn mark(&mut self);
    /// Restores the stored state.
    fn back(&mut self);
    /// Stretch of the whole cell now, or that of each triangle along its fibre where the activation has its sites there.
    fn stretch_now(&self) -> Vec<f64>;
}

/// Largest number of iterations of an exchange.
const TRIES: usize = 60;
/// Tolerance between a trial tension and the resulting tension, as a part of the strongest tension.
const AGREED: f64 = 1e-10;
/// Smallest step from which the slope is computed, as a part of the strongest tension.
const ROUNDED: f64 = 1e-6;
/// Tolerance of the tangent for the tension of a triangle at the end of an interval, as a part of
/// the strongest tension.
const FOLLOWED: f64 = 1e-3;
/// Change of a stretch from one equilibrium to the next that ends the iteration.
const STAYED: f64 = 1e-11;

/// The coupling of one activation and one mesh.
pub(super) struct Coupler<'a> {
    pub(super) activation: Box<dyn Activation>,
    /// Tension at the end of the last interval.
    pub(super) tension: Held,
    strongest: ActivationBounds,
    /// Volumes of the triangles, for the mean tension.
    volumes: &'a [f64],
    /// Exchange interval, ms.
    every: f64,
    stretch: Vec<f64>,
    rate: Vec<f64>,
    /// Time over which a change of stretch has its mean rate, ms; endless before the run begins.
    interval: f64,
    /// For one site, the prediction from the last interval.
    last: Option<Last>,
}

/// Prediction of the next interval: the change of the tension, and the derivative of the residual.
#[derive(Debug, Clone, Copy)]
struct Last {
    /// Change of the tension over the interval, kPa, and its difference from that over the interval
    /// before.
    change: [f64; 2],
    /// Derivative of the residual `T_model(T) - T` with respect to `T`, at most -1, and its
    /// difference from that in the interval before.
    slope: [f64; 2],
}

impl Last {
    /// After an interval with this change and slope.
    fn after(before: Option<Self>, change: f64, slope: f64) -> Self {
        let than = |now: f64, before: Option<f64>| [now, now - before.unwrap_or(now)];
        Self {
            change: than(change, before.map(|last| last.change[0])),
            slope: than(slope, before.map(|last| last.slope[0])),
        }
    }

    /// Change and slope of the next.
    fn next(self) -> [f64; 2] {
        [self.change[0] + self.change[1], (self.slope[0] + self.slope[1]).min(-1.0)]
    }
}

impl<'a> Coupler<'a> {
    /// The coupling of an activation with the stated bounds and a mesh, every `every` ms. The mean
    /// tension is weighted by the volumes of the triangles.
    pub(super) fn new(
        activation: Box<dyn Activation>,
        strongest: ActivationBounds,
        every: f64,
        volumes: &'a [f64],
    ) -> Self {
        let sites = activation.sites().count();
        Self {
            tension: Held::of(activation.tension()),
            strongest,
            volumes,
            every,
            stretch: vec![1.0; sites],
            rate: vec![0.0; sites],
            interval: f64::INFINITY,
            last: None,
            activation,
        }
    }

    /// Advances the activation under these stretches and the mean rates that lead to them.
    fn ask(&mut self, time: f64, stretch: &[f64], rate: &[f64]) -> Result<(), StopReason> {
        let failed = |ActivationError(cause)| StopReason::CellModel { cause };
        self.activation.advance(time, StretchState { stretch, rate }).map_err(failed)?;
        self.check_answer(time).map_err(|cause| StopReason::CellModel { cause })
    }

    /// Checks that the activation returns a value for each site, within the bounds that it stated.
    fn check_answer(&self, time: f64) -> Result<(), String> {
        let sites = self.activation.sites();
        match (sites, self.activation.tension()) {
            (Sites::Whole, Tension::Uniform(_)) => return Ok(()),
            (Sites::PerElement(count), Tension::PerElement(list)) if list.len() == count => {}
            (sites, _) => {
                return Err(format!(
                    "at t = {time} ms its tension is not one for each of {sites:?}"
                ));
            }
        }
        let Some(ActivationTangent { per_stretch, per_rate }) = self.activation.tangent() else {
            return Ok(());
        };
        let strongest = self.strongest;
        for (what, slopes, most) in [
            ("stretch", per_stretch, strongest.per_stretch),
            ("rate of stretch", per_rate, strongest.per_rate),
        ] {
            if slopes.len() != sites.count() {
                let found = slopes.len();
                return Err(format!(
                    "at t = {time} ms it has {found} slopes with respect to the {what} for {} sites",
                    sites.count()
                ));
            }
            // A margin for rounding.
            let within = |slope: &f64| (0.0..=most * (1.0 + 1e-9)).contains(slope);
            if let Some(site) = slopes.iter().position(|slope| !within(slope)) {
                return Err(format!(
                    "at t = {time} ms the slope of its tension with respect to the {what} is {} at site {site}, \
                     but it said 0 to {most}, for which the steps are stable",
                    slopes[site]
                ));
            }
        }
        Ok(())
    }

    /// Before the run begins: a mesh along equilibria starts in equilibrium with the activation;
    /// for one in time the activation gets its stretch.
    pub(super) fn begin(&mut self, shaping: &mut impl Shaping) -> Result<(), StopReason> {
        if shaping.is_static() {
            self.activation.at_equilibria();
        }
        self.stretch = shaping.stretch_now();
        if self.activation.tangent().is_some() {
            let (stretch, rate) = (self.stretch.clone(), self.rate.clone());
            self.ask(0.0, &stretch, &rate)?;
            match self.activation.sites() {
                _ if !shaping.is_static() => self.tension = Held::of(self.activation.tension()),
                Sites::Whole => self.find_together(0.0, shaping)?,
                Sites::PerElement(_) => self.rest_together(0.0, shaping)?,
            }
            self.activation.keep();
            self.stretch = shaping.stretch_now();
        }
        self.interval = self.every;
        Ok(())
    }

    /// Advances activation and mesh by one interval.
    pub(super) fn pass(
        &mut self,
        time: f64,
        shaping: &mut impl Shaping,
        observer: &mut dyn RunObserver,
    ) -> Result<(), StopReason> {
        observer.begins(RunPart::Cell);
        let feels = self.activation.tangent().is_some();
        let from_rest_to_rest =
            feels && shaping.is_static() && matches!(self.activation.sites(), Sites::PerElement(_));
        // Along equilibria the activation first advances with the predicted stretch, which needs
        // fewer iterations; a single site advances with each trial tension.
        let tried = feels && matches!(self.activation.sites(), Sites::Whole);
        if !from_rest_to_rest && !tried {
            let (stretch, rate) = (self.stretch.clone(), self.rate.clone());
            self.ask(time, &stretch, &rate)?;
        }
        observer.begins(RunPart::Mechanics);
        match (feels, self.activation.sites()) {
            (false, _) => {
                shaping.follow(time, [self.tension.tension(), self.activation.tension()])?;
                self.tension = Held::of(self.activation.tension());
            }
            (true, Sites::Whole) => self.find_together(time, shaping)?,
            (true, Sites::PerElement(_)) if from_rest_to_rest => {
                self.rest_together(time, shaping)?;
            }
            (true, Sites::PerElement(_)) => self.move_together(time, shaping)?,
        }
        self.activation.keep();
        let now = shaping.stretch_now();
        self.rate = self.rates(&now);
        self.stretch = now;
        Ok(())
    }

    /// Mean rates over the interval that ends with these stretches, 1/ms.
    fn rates(&self, now: &[f64]) -> Vec<f64> {
        let rate = |(now, before): (&f64, &f64)| (now - before) / self.interval;
        now.iter().zip(&self.stretch).map(rate).collect()
    }

    /// One site: the tension that the activation returns at the stretch that this tension causes.
    fn find_together(&mut self, time: f64, shaping: &mut impl Shaping) -> Result<(), StopReason> {
        let start = self.tension.tension().at(0);
        let ActivationBounds { tension: strongest, per_stretch, per_rate } = self.strongest;
        let strongest = strongest.abs();
        // Rounding of two stretches near 1, converted to tension.
        let rounding = 2.0 * f64::EPSILON * (per_stretch.abs() + per_rate.abs() / self.interval);
        let enough = (AGREED * strongest.max(start.abs())).max(rounding);
        shaping.mark();
        let goes_evenly = shaping.is_static() && self.interval.is_finite();
        // The residual `T_model(T) - T`.
        let mut excess = |tension: f64, this: &mut Self| {
            shaping.back();
            let from = if goes_evenly { start } else { tension };
            shaping.follow(time, [from.into(), tension.into()])?;
            let stretch = shaping.stretch_now();
            let rate = this.rates(&stretch);
            this.ask(time, &stretch, &rate)?;
            Ok(this.activation.tension().at(0) - tension)
        };
        let before = self.last.take();
        let foretold = before.map(Last::next);
        let mut tension = start + foretold.map_or(0.0, |[change, _]| change);
        let mut miss = match excess(tension, self) {
            Err(_) if tension != start => {
                tension = start;
                excess(tension, self)?
            }
            miss => miss?,
        };
        // Without a last interval a small step gives the slope, which is at most -1.
        let first = 1e-3 * strongest;
        let mut step = foretold.map_or(miss.clamp(-first, first), |[_, slope]| -miss / slope);
        let mut slope = foretold.map_or(-1.0, |[_, slope]| slope);
        // The highest tension known to be too low, and the lowest known to be too high.
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        // Why there is no shape under a tension, which is then too high.
        let mut refused = None;
        for _ in 0..TRIES {
            // Smaller steps are below the rounding of the length, converted to tension.
            let last = high - low <= AGREED * enough || step.abs() <= f64::EPSILON * tension.abs();
            if miss.abs() <= enough || last {
                self.tension = Held::Uniform(tension);
                if self.interval.is_finite() {
                    self.last = Some(Last::after(before, tension - start, slope));
                }
                return Ok(());
            }
            if miss > 0.0 {
                low = low.max(tension);
            } else {
                high = high.min(tension);
            }
            let mut next = tension + step;
            if !(low < next && next < high) {
                next = if low.is_finite() && high.is_finite() {
                    0.5 * (low + high)
                } else {
                    tension + miss
                };
            }
            let there = match excess(next, self) {
                Ok(there) => there,
                Err(reason) if next > low && low.is_finite() => {
                    high = next;
                    step = 0.5 * (low + high) - tension;
                    refused = Some(reason);
                    continue;
                }
                Err(reason) => return Err(reason),
            };
            let secant = (there - miss) / (next - tension);
            // A slope from a step within the rounding is not used.
            if secant < 0.0 && (next - tension).abs() > ROUNDED * strongest {
                slope = secant;
            }
            (tension, miss) = (next, there);
            step = if secant < 0.0 { -miss / secant } else { miss };
        }
        Err(refused.unwrap_or(StopReason::NoExchange { time, tension, miss }))
    }

    /// The activation's tangent about a stretch, in the form that the forces need.
    fn law(&self, stretch: &[f64], rate: &[f64], whole: bool) -> [Vec<f64>; 5] {
        let tension = Held::of(self.activation.tension());
        let list = (0..stretch.len()).map(|e| tension.tension().at(e)).collect();
        let none = vec![0.0; stretch.len()];
        let tangent = self.activation.tangent();
        let (per_stretch, per_rate) = tangent.map_or_else(
            || (none.clone(), none.clone()),
            |t| (t.per_stretch.to_vec(), t.per_rate.to_vec()),
        );
        if whole {
            // Along equilibria a rate is a difference of stretches over the interval.
            let both =
                per_stretch.iter().zip(&per_rate).map(|(s, r)| s + r / self.interval).collect();
            return [list, both, none.clone(), stretch.to_vec(), none];
        }
        [list, per_stretch, per_rate, stretch.to_vec(), rate.to_vec()]
    }

    /// A site for each triangle, in time.
    fn move_together(&mut self, time: f64, shaping: &mut impl Shaping) -> Result<(), StopReason> {
        let enough = FOLLOWED * self.strongest.tension.abs();
        let (mut about, mut rate) = (self.stretch.clone(), self.rate.clone());
        let mut miss = f64::INFINITY;
        let before = (0..about.len()).map(|e| self.tension.tension().at(e)).collect::<Vec<_>>();
        let (from, from_rate) = (self.stretch.clone(), self.rate.clone());
        shaping.mark();
        for _ in 0..TRIES {
            let law = self.law(&about, &rate, false);
            let law = following(&law);
            let start = Following { tension: &before, stretch: &from, rate: &from_rate, ..law };
            shaping.back();
            shaping.follow(time, [Tension::Following(start), Tension::Following(law)])?;
            about = shaping.stretch_now();
            rate = self.rates(&about);
            self.ask(time, &about, &rate)?;
            let answer = self.activation.tension();
            let off = |e: usize| (law.at(e, about[e], rate[e]) - answer.at(e)).abs();
            miss = (0..about.len()).map(off).fold(0.0, f64::max);
            if miss <= enough {
                self.tension = Held::of(answer);
                return Ok(());
            }
        }
        let tension = self.tension.average(self.volumes);
        Err(StopReason::NoExchange { time, tension, miss })
    }

    /// A site for each triangle, along equilibria.
    fn rest_together(&mut self, time: f64, shaping: &mut impl Shaping) -> Result<(), StopReason> {
        // Before the run begins the interval is endless, and there is no rate.
        let on = if self.interval.is_finite() { self.interval } else { 0.0 };
        let mut about: Vec<f64> = self
            .stretch
            .iter()
            .zip(&self.rate)
            .map(|(stretch, rate)| stretch + rate * on)
            .collect();
        let still = vec![0.0; about.len()];
        let rate = self.rate.clone();
        self.ask(time, &about, &rate)?;
        shaping.mark();
        let mut change = f64::INFINITY;
        for _ in 0..TRIES {
            let law = self.law(&about, &still, true);
            shaping.back();
            shaping.follow(time, [self.tension.tension(), Tension::Following(following(&law))])?;
            let now = shaping.stretch_now();
            change = now.iter().zip(&about).fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()));
            let rate = self.rates(&now);
            self.ask(time, &now, &rate)?;
            about = now;
            if change <= STAYED {
                self.tension = Held::of(self.activation.tension());
                return Ok(());
            }
        }
        let tension = self.tension.average(self.volumes);
        Err(StopReason::NoExchange { time, tension, miss: change })
    }
}

fn following([tension, per_stretch, per_rate, stretch, rate]: &[Vec<f64>; 5]) -> Following<'_> {
    Following { tension, per_stretch, per_rate, stretch, rate }
}
