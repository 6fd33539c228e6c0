//! How slow the slowest vibration of a run in time may be: the heavier the masses, the larger its steps.
//!
//! The slowest vibration along the cell is taken for one mass on a spring that the tension `Ta` pulls. Its distance `d` from its
//! equilibrium, as a part of that at the peak of tension, follows
//!
//! ```text
//! d'' + gamma d' + omega^2 d = -f'' - gamma f'        f = Ta / max Ta
//! ```
//!
//! with the rate `gamma` of the drag ([`crate::mechanics::drag`]) and `omega = 2 pi / T`. The largest `|d|` is the lag of a run. Faster
//! vibrations, and the stiffness that the area law adds, make the lag of the shortening smaller: measured against the path of
//! equilibria it is 0.56 of that for `coelho_2021` and 0.74 for the epicardial set of Bueno-Orovio et al. 2008, with periods of 2 to 8 ms.

use super::shared_cell::SharedCell;
use super::space::Space;
use super::{SetupError, Simulation};
use crate::exchange::StretchState;
use crate::mechanics::drag::Drag;
use crate::mechanics::material::{USUAL_PERIOD, default_material};
use crate::recording::Sample;
use std::f64::consts::TAU;

/// Largest accepted lag, as a part of the peak.
const ACCEPTED: f64 = 0.01;
/// Longest period that is chosen, ms.
const LONGEST: f64 = 8.0;
/// Time over which the tension is looked at, ms.
const LOOKED_AT: f64 = 1000.0;
/// Smallest tension that counts as a contraction, as a part of the strongest expected one.
const NOTICED: f64 = 0.01;
/// Steps of the mass on its spring in a period.
const STEPS: f64 = 60.0;

/// Tensions and their times, ms.
type Course = [[f64; 2]];

/// Largest distance of a mass on a spring from its equilibrium under tensions, as a part of that at the largest of them; by the
/// implicit midpoint rule. `None` if nothing pulls.
fn lag(course: &Course, period: f64, drag_rate: f64) -> Option<f64> {
    let peak = course.iter().map(|[_, tension]| *tension).fold(0.0, f64::max);
    let square = (TAU / period).powi(2);
    let ([mut distance, mut speed, mut slope], mut largest) = ([0.0; 3], 0.0_f64);
    for pair in course.windows(2) {
        let [[from, start], [to, end]] = [pair[0], pair[1]];
        let steps = ((to - from) * STEPS / period).ceil();
        let (step, before) = ((to - from) / steps, slope);
        slope = (end - start) / (peak * (to - from));
        speed += before - slope;
        let half = 0.5 * step * (drag_rate + 0.5 * step * square);
        for _ in 0..steps as u64 {
            let pull = step * (square * distance + drag_rate * slope);
            let next = ((1.0 - half) * speed - pull) / (1.0 + half);
            distance += 0.5 * step * (speed + next);
            speed = next;
            largest = largest.max(distance.abs());
        }
    }
    (peak > 0.0).then_some(largest)
}

/// The longest period with an accepted lag, ms.
fn longest(lag: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let [mut low, mut high] = [USUAL_PERIOD, LONGEST];
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        if lag(middle)? <= ACCEPTED { low = middle } else { high = middle }
    }
    Some(low)
}

impl Simulation {
    /// How far the shortening is off its equilibria at most with a period of the slowest vibration (ms), as a part of its peak;
    /// `None` if nothing pulls, or if dashpots stronger than those of the default material delay it, too.
    fn lag(&self, course: &Course, period: f64) -> Option<f64> {
        if self.material.damping_ratio > default_material().damping_ratio {
            return None;
        }
        let drag = Drag::of_slowest_mode(period, self.material.drag_ratio, &[]);
        // That of a free cell is half a wave; of a cell that is held at one end a quarter.
        let one_end = self.support.clamps() && !self.support.holds_both_ends();
        let period = if one_end { 2.0 * period } else { period };
        lag(course, period, drag.rate)
    }

    /// The lag of a run in time that recorded these samples, % of the peak shortening.
    pub(super) fn lag_pct(&self, samples: &[Sample]) -> Option<f64> {
        let course: Vec<_> = samples.iter().map(|sample| [sample.t_ms, sample.ta_kpa]).collect();
        let period = self.material.slowest_period.unwrap_or(USUAL_PERIOD);
        self.lag(&course, period).map(|lag| 100.0 * lag)
    }

    /// The same with a period of the slowest vibration: where none is set, the longest with which a run in time lags little. It is
    /// the usual one where the tension depends on the stretch or the place and so is not known before the run.
    pub(super) fn with_period<const D: usize, const N: usize>(
        &self,
        known: &SharedCell,
    ) -> Result<Self, SetupError>
    where
        Self: Space<D, N>,
    {
        let mut chosen = self.clone();
        if chosen.material.slowest_period.is_none() {
            let course = self.course_of_tension::<D, N>(known)?;
            let allowed = course.and_then(|course| longest(|period| self.lag(&course, period)));
            chosen.material.slowest_period = allowed.or(Some(USUAL_PERIOD));
        }
        Ok(chosen)
    }

    /// The tension until it has fallen to half of its peak; `None` if it is not known before the run.
    fn course_of_tension<const D: usize, const N: usize>(
        &self,
        known: &SharedCell,
    ) -> Result<Option<Vec<[f64; 2]>>, SetupError>
    where
        Self: Space<D, N>,
    {
        if self.activation.is_some() || self.stepper.is_some() || self.has_sites_in_triangles() {
            return Ok(None);
        }
        let (mut cell, _) = self.activation::<D, N>(known, &self.volumes())?;
        if cell.tangent().is_some() {
            return Ok(None);
        }
        let (every, mut peak) = (self.numerics.exchange_interval, cell.tension().at(0));
        let noticed = NOTICED * cell.strongest().tension;
        let mut course = vec![[0.0, peak]];
        for interval in 1..=(self.duration.min(LOOKED_AT) / every).round() as u32 {
            let time = f64::from(interval) * every;
            self.interruption.check()?;
            // What is wrong with the cell the run itself says, with what it has until then.
            if cell.advance(time, StretchState { stretch: &[1.0], rate: &[0.0] }).is_err() {
                return Ok(None);
            }
            cell.keep();
            let tension = cell.tension().at(0);
            course.push([time, tension]);
            peak = peak.max(tension);
            // Before the stimulus there may be tension of earlier beats.
            if time > self.protocol.start_ms && peak > noticed && tension < 0.5 * peak {
                break;
            }
        }
        Ok(Some(course))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tension that rises from 0 at 10 ms to 1 kPa, steadily over some milliseconds.
    fn ramp(over: f64) -> Vec<[f64; 2]> {
        let times = (0..4000).map(|k| 0.05 * f64::from(k));
        times.map(|time| [time, ((time - 10.0) / over).clamp(0.0, 1.0)]).collect()
    }

    #[test]
    fn the_lag_is_that_of_the_solution_by_hand() {
        // Far behind the start of a long ramp: gamma/omega^2 times the slope.
        let (period, rate) = (4.0, 8.0);
        let steady = rate * (period / TAU).powi(2) / 100.0;
        let found = lag(&ramp(100.0), period, rate).unwrap();
        assert!((found / steady - 1.0).abs() < 1e-3, "{found}, by hand {steady}");
        // Without drag it swings about a ramp by slope/omega, and as far again behind its end.
        let swing = period / TAU / 50.5;
        let found = lag(&ramp(50.5), period, 0.0).unwrap();
        assert!(found > swing && found < 2.01 * swing, "{found}, by hand {swing} to twice that");
        // A sudden pull leaves it behind by all.
        assert!((lag(&ramp(0.05), period, 0.0).unwrap() - 1.0).abs() < 0.03);
        assert_eq!(lag(&[[0.0, 0.0], [1.0, 0.0]], period, rate), None);
    }
}
