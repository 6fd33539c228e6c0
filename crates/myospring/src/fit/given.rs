//! The contraction of a cell whose tension follows its potential: Eqs. (32)-(35) of `coelho_2021` along a mesh's
//! equilibria.
//!
//! The potential hangs on none of the parameters that a curve tells, so it is solved once. Then a curve is two
//! equations, linear between their switches, and a look into the table of equilibria. From one node of the grid to the
//! next the bell `k(V)` of Eq. (34) is a straight line; `Ta_i` and `Ta` are exact there, and a step in which
//! `Ta_i` passes `x_3` is cut there, so that a curve depends smoothly on every parameter.

use crate::cell::adaptive::{self, Settings};
use crate::cell::minimal::MinimalModel;
use crate::cell::pacing::Protocol;
use crate::cell::solve::SolveError;
use std::f64::consts::PI;

/// Nodes this far apart while the potential rises, and that long after a stimulus; later ones.
const FINE_MS: f64 = 0.05;
const RISE_MS: f64 = 12.0;
const COARSE_MS: f64 = 0.5;
/// Tolerance of the potential: its error moves a length by less than 1e-5 of the shortening.
const TOLERANCE: f64 = 1e-6;

/// Parameters that act on the tension alone, in the order of [`Rates`].
pub(super) const OF_TENSION: [&str; 4] = ["c_0", "x_1", "x_3", "sigma"];

/// What a curve tells of the tension equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rates {
    /// Rate of both variables, 1/ms.
    pub(super) c_0: f64,
    /// Rate of `Ta` while it waits, 1/ms.
    pub(super) x_1: f64,
    /// `Ta_i` up to which it waits.
    pub(super) x_3: f64,
    /// Width of the bell.
    pub(super) sigma: f64,
}

/// The potential of one beat, from its stimulus on.
#[derive(Debug, Clone)]
struct Beat {
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    /// After the stimulus, ms.
    time: f64,
    /// `V - 1`.
    off_peak: f64,
    /// Whether `V > x_2` from here to the next node.
    above: bool,
}

/// The potential of a train, beat by beat.
#[derive(Debug, Clone)]
pub(super) struct Potential {
    beats: Vec<Beat>,
}

impl Potential {
    /// Solves the cell for so many stimuli after so many others, a cycle length apart, the first as long after the
    /// beginning as the protocol says.
    pub(super) fn solve(
        model: &MinimalModel,
        protocol: Protocol,
        before: usize,
        beats: usize,
        cycle_ms: f64,
    ) -> Result<Self, SolveError> {
        let tension = *model.tension_constants();
        let normal = |u: f64| tension.normalised_potential(u);
        let x_2 = model_value(model, "x_2");
        let train = Protocol {
            beats: u32::try_from(before + beats).unwrap_or(u32::MAX),
            cycle_length_ms: cycle_ms,
            ..protocol
        };
        let mut cell =
            adaptive::AdaptiveIntegrator::new(model, train, Settings { tolerance: TOLERANCE })?;
        let mut all = Vec::with_capacity(beats);
        for beat in before..before + beats {
            let start = protocol.start_ms + beat as f64 * cycle_ms;
            let mut nodes: Vec<Node> = Vec::new();
            let mut last: Option<(f64, f64)> = None;
            for time in grid(cycle_ms) {
                // The state at the time of a stimulus includes it; the last node of a beat lies just before the next.
                let until =
                    if time < cycle_ms { start + time } else { start + cycle_ms * (1.0 - 1e-12) };
                cell.advance_to(until)?;
                let v = normal(cell.state()[0]);
                // A node where V passes x_2, on the straight line between.
                if let Some((last, was)) = last
                    && (was > x_2) != (v > x_2)
                {
                    let part = (x_2 - was) / (v - was);
                    let crossing = last + part * (time - last);
                    nodes.push(Node { time: crossing, off_peak: x_2 - 1.0, above: v > x_2 });
                }
                nodes.push(Node { time, off_peak: v - 1.0, above: v > x_2 });
                last = Some((time, v));
            }
            all.push(Beat { nodes });
        }
        Ok(Self { beats: all })
    }

    /// `Ta` at ascending times, ms, over its peak in the last beat that any of them sees; `stimuli` are those of the
    /// beats, ascending. Before the first stimulus it is 0. Returns that peak.
    pub(super) fn tension(
        &self,
        rates: &Rates,
        stimuli: &[f64],
        times: &[f64],
        into: &mut Vec<f64>,
    ) -> f64 {
        into.clear();
        let mut times = times.iter().copied().peekable();
        let first = stimuli.first().copied().unwrap_or(f64::INFINITY);
        while times.next_if(|time| *time <= first).is_some() {
            into.push(0.0);
        }
        let mut state = [0.0; 2];
        let mut peak = 0.0;
        let mut bell: Vec<f64> = Vec::new();
        for (number, &stimulus) in stimuli.iter().enumerate() {
            if times.peek().is_none() {
                break;
            }
            let beat = &self.beats[number.min(self.beats.len() - 1)];
            let end = stimuli.get(number + 1).copied().unwrap_or(f64::INFINITY) - stimulus;
            bell.clear();
            bell.extend(beat.nodes.iter().map(|node| rates.bell(node.off_peak)));
            let steps = beat.nodes.windows(2).zip(bell.windows(2));
            let mut now = 0.0;
            let mut highest = 0.0_f64;
            for (nodes, bell) in steps {
                let [from, to] = [nodes[0], nodes[1]];
                if from.time >= end {
                    break;
                }
                let step = Step {
                    length: to.time - from.time,
                    bell: bell[0],
                    slope: if to.time > from.time {
                        (bell[1] - bell[0]) / (to.time - from.time)
                    } else {
                        0.0
                    },
                    above: from.above,
                };
                let until = to.time.min(end);
                while let Some(time) = times.next_if(|time| time - stimulus <= until) {
                    let part = time - stimulus - from.time;
                    into.push(step.after(part.max(0.0), state, rates)[1]);
                }
                let before = state;
                state = step.after(until - from.time, state, rates);
                highest =
                    highest.max(state[1]).max(step.top(until - from.time, before, state, rates));
                now = until;
            }
            // After the last node the cell rests.
            let rest = Step { length: f64::INFINITY, bell: 0.0, slope: 0.0, above: false };
            if now < end {
                while let Some(time) = times.next_if(|time| time - stimulus <= end) {
                    into.push(rest.after(time - stimulus - now, state, rates)[1]);
                }
                if end.is_finite() {
                    state = rest.after(end - now, state, rates);
                }
            }
            peak = highest;
        }
        if peak > 0.0 {
            for value in into.iter_mut() {
                *value /= peak;
            }
        }
        peak
    }
}

fn model_value(model: &MinimalModel, name: &str) -> f64 {
    use crate::cell::CellModel as _;
    model.parameters().get(name).unwrap_or(f64::NAN)
}

fn grid(cycle_ms: f64) -> impl Iterator<Item = f64> {
    let fine = (RISE_MS / FINE_MS) as usize;
    let coarse = ((cycle_ms - RISE_MS).max(0.0) / COARSE_MS).ceil() as usize;
    let fine = (0..=fine).map(|k| k as f64 * FINE_MS);
    let coarse = (1..=coarse).map(|k| RISE_MS + k as f64 * COARSE_MS);
    fine.chain(coarse).take_while(move |time| *time < cycle_ms).chain([cycle_ms])
}

impl Rates {
    /// Those of a model.
    pub(super) fn of(model: &MinimalModel) -> Self {
        let [c_0, x_1, x_3, sigma] = OF_TENSION.map(|name| model_value(model, name));
        Self { c_0, x_1, x_3, sigma }
    }

    /// Eq. (34), for `V - 1`.
    fn bell(&self, off_peak: f64) -> f64 {
        let z = off_peak / self.sigma;
        (-0.5 * z * z).exp() / (self.sigma * (2.0 * PI).sqrt())
    }
}

/// A step from node to node.
#[derive(Debug, Clone, Copy)]
struct Step {
    length: f64,
    bell: f64,
    slope: f64,
    above: bool,
}

impl Step {
    /// `Ta_i` and `Ta` so long after the begin of the step.
    fn after(&self, time: f64, [ta_i, ta]: [f64; 2], rates: &Rates) -> [f64; 2] {
        debug_assert!(time <= self.length * (1.0 + 1e-9));
        let later = self.early(time, ta_i, rates.c_0);
        let waits = |ta_i: f64| self.above && ta_i < rates.x_3;
        if waits(ta_i) == waits(later) {
            let rate = if waits(ta_i) { rates.x_1 } else { rates.c_0 };
            return [later, self.late(0.0, time, ta_i, ta, rate, rates.c_0)];
        }
        let switch = self.crossing(time, ta_i, later, rates);
        let [first, second] =
            if waits(ta_i) { [rates.x_1, rates.c_0] } else { [rates.c_0, rates.x_1] };
        let ta = self.late(0.0, switch, ta_i, ta, first, rates.c_0);
        [later, self.late(switch, time, ta_i, ta, second, rates.c_0)]
    }

    /// The largest `Ta` inside of the step, where it has one: it is highest when it meets `Ta_i`.
    fn top(&self, time: f64, from: [f64; 2], to: [f64; 2], rates: &Rates) -> f64 {
        let [before, after] = [from[0] - from[1], to[0] - to[1]];
        if !(before > 0.0 && after <= 0.0) {
            return 0.0;
        }
        self.after(time * before / (before - after), from, rates)[1]
    }

    /// Exact: (32) with a bell that is a straight line.
    fn early(&self, time: f64, ta_i: f64, c_0: f64) -> f64 {
        let lag = self.slope / c_0;
        self.bell - lag + self.slope * time + (ta_i - self.bell + lag) * (-c_0 * time).exp()
    }

    /// (33) from one time to another at a constant rate; `ta` is there at the first.
    fn late(&self, from: f64, to: f64, ta_i: f64, ta: f64, rate: f64, c_0: f64) -> f64 {
        let h = to - from;
        if rate == c_0 {
            // Exact: both equations have the same rate.
            let (lag, bell) = (self.slope / c_0, self.bell + self.slope * from);
            let excess = self.early(from, ta_i, c_0) - bell + lag;
            let steady = bell - 2.0 * lag;
            return steady + self.slope * h + (ta - steady + excess * c_0 * h) * (-c_0 * h).exp();
        }
        // It waits, slowly, for less than a step of the grid: Simpson's rule.
        let at = |time: f64| self.early(time, ta_i, c_0) * (-rate * (to - time)).exp();
        let sum = at(from) + 4.0 * at(f64::midpoint(from, to)) + at(to);
        ta * (-rate * h).exp() + rate * h * sum / 6.0
    }

    /// When `Ta_i` passes `x_3`: regula falsi and Newton's method in one, on a course that hardly bends.
    fn crossing(&self, time: f64, ta_i: f64, later: f64, rates: &Rates) -> f64 {
        let mut at = time * (rates.x_3 - ta_i) / (later - ta_i);
        for _ in 0..4 {
            let value = self.early(at, ta_i, rates.c_0);
            let rate = rates.c_0 * (self.bell + self.slope * at - value);
            if rate == 0.0 {
                break;
            }
            at = (at - (value - rates.x_3) / rate).clamp(0.0, time);
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::coelho_2021;
    use crate::cell::{CellModel as _, pacing::Protocol};

    const BEFORE: usize = 10;
    const PUBLISHED: Rates = Rates { c_0: 0.0166016, x_1: 0.0001, x_3: 0.2925, sigma: 0.046875 };

    #[test]
    fn tension_is_that_of_the_whole_cell_solved_to_a_small_tolerance() {
        let model = coelho_2021::model();
        let beats = BEFORE + 3;
        let protocol = Protocol {
            beats: beats as u32,
            cycle_length_ms: 500.0,
            start_ms: 0.0,
            ..Protocol::once(model.default_stimulus())
        };
        let lasts = 500.0 * beats as f64;
        let whole =
            adaptive::solve(&model, protocol, Settings { tolerance: 1e-7 }, lasts, 1.0).unwrap();
        // From the second of the three beats on: what was before the first is not known to the fit.
        let skipped = 500 * (BEFORE + 1);
        let late: Vec<f64> =
            whole.time_ms[skipped..].iter().map(|time| time - 500.0 * BEFORE as f64).collect();
        let potential = Potential::solve(&model, protocol, BEFORE, 3, 500.0).unwrap();
        let mut found = Vec::new();
        let peak = potential.tension(&PUBLISHED, &[0.0, 500.0, 1000.0], &late, &mut found);
        let expected = &whole.tension[skipped..];
        let off = found.iter().zip(expected).map(|(a, b)| (peak * a - b).abs()).fold(0.0, f64::max);
        // What the two grids and tolerances leave; the whole cell's own tolerance moves its peak by 1e-5.
        assert!(off < 1e-4 * peak, "off by {} of the peak", off / peak);
        assert!((found.iter().copied().fold(0.0, f64::max) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn a_curve_depends_smoothly_on_each_parameter() {
        let model = coelho_2021::model();
        let protocol = Protocol::once(model.default_stimulus());
        let potential = Potential::solve(&model, protocol, 0, 1, 600.0).unwrap();
        let times: Vec<f64> = (0..150).map(|k| 4.0 * f64::from(k)).collect();
        let curve = |c_0: f64, x_3: f64, sigma: f64| {
            let rates = Rates {
                c_0: c_0 * PUBLISHED.c_0,
                x_3: x_3 * PUBLISHED.x_3,
                sigma: sigma * PUBLISHED.sigma,
                ..PUBLISHED
            };
            let mut curve = Vec::new();
            potential.tension(&rates, &[0.0], &times, &mut curve);
            curve
        };
        let slope = |step: f64, of: &dyn Fn(f64) -> Vec<f64>| -> Vec<f64> {
            let (low, high) = (of(1.0 - step), of(1.0 + step));
            low.iter().zip(&high).map(|(low, high)| (high - low) / (2.0 * step)).collect()
        };
        let of: [&dyn Fn(f64) -> Vec<f64>; 3] =
            [&|by| curve(by, 1.0, 1.0), &|by| curve(1.0, by, 1.0), &|by| curve(1.0, 1.0, by)];
        for of in of {
            let (wide, narrow) = (slope(1e-3, of), slope(1e-5, of));
            let size = narrow.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            let off = wide.iter().zip(&narrow).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // A switch that snapped to the grid would make the narrow slope 0 or huge.
            assert!(off < 0.01 * size, "{} of {size}", off / size);
        }
    }
}
