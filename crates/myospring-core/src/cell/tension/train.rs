//! The tension of a train of beats that follows the potential, Eqs. (32)-(35) of `coelho_2021`, by exact steps, and what
//! of it shapes a viscous cell.
//!
//! The potential depends on none of the rates ([`Rates`]), so it is solved once. Then a curve is two equations, linear
//! between their switches. From one node of the grid to the next the bell `k(V)` of Eq. (34) is a straight line; `Ta_i`
//! and `Ta` are exact there, and a step in which `Ta_i` passes `x_3` is cut there, so that a curve depends smoothly on
//! every rate.

use super::Tension;
use super::step::{Rates, State, Step, Whole};
use crate::cell::CellModel;
use crate::cell::integrator::CellIntegrator;
use crate::cell::pacing::Protocol;
use crate::cell::solve::{SolveError, SolverSettings};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Nodes this far apart while the potential rises, and that long after a stimulus; later ones.
const FINE_MS: f64 = 0.05;
const RISE_MS: f64 = 12.0;
const COARSE_MS: f64 = 0.5;
/// Tolerance of the potential: its error moves a length by less than 1e-5 of the shortening.
const TOLERANCE: f64 = 1e-6;

/// The potential of one beat, from its stimulus on.
#[derive(Debug)]
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
#[derive(Debug)]
pub struct Potential {
    beats: Vec<Beat>,
    /// What widths of the bell make of them, by their bits.
    courses: Mutex<HashMap<u64, Courses>>,
}

/// The steps of each beat.
type Courses = Arc<[Vec<Step>]>;
/// Courses that are remembered: one alone, unless the width of the bell is sought.
const KEPT: usize = 16;
/// After the last bell that is so large a part of the highest the cell rests.
const NOTHING: f64 = 1e-16;
/// For differences, a stimulus is moved so far either way, ms.
const MOVED_MS: f64 = 0.02;
/// States that differ by so small a part of the peak go the same way.
const ALIKE: f64 = 1e-10;

impl Potential {
    /// Solves the cell for this number of stimuli after a number of others, a cycle length apart, the first as long after
    /// the beginning as the protocol says.
    ///
    /// # Errors
    /// A protocol that the cell cannot follow, or a cell that no step takes further.
    pub fn solve(
        cell: &Arc<dyn CellModel>,
        tension: &Tension,
        protocol: Protocol,
        before: usize,
        beats: usize,
        cycle_ms: f64,
    ) -> Result<Self, SolveError> {
        let potential = |state: &[f64]| cell.potential(state).unwrap_or(f64::NAN);
        let normal = |state: &[f64]| tension.normalised_potential(potential(state));
        let x_2 = tension.delayed_above();
        let train = Protocol {
            beats: u32::try_from(before + beats).unwrap_or(u32::MAX),
            cycle_length_ms: cycle_ms,
            ..protocol
        };
        let settings = SolverSettings { tolerance: TOLERANCE, ..cell.usual_settings() };
        let mut moving = CellIntegrator::new(Arc::clone(cell), train, settings)?;
        let mut all = Vec::with_capacity(beats);
        for beat in before..before + beats {
            let start = protocol.start_ms + beat as f64 * cycle_ms;
            let mut nodes: Vec<Node> = Vec::new();
            let mut last: Option<(f64, f64)> = None;
            for time in grid(cycle_ms) {
                // The state at the time of a stimulus includes it; the last node of a beat lies just before the next.
                let until =
                    if time < cycle_ms { start + time } else { start + cycle_ms * (1.0 - 1e-12) };
                moving.advance_to(until, 1.0, 0.0)?;
                let v = normal(moving.state());
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
        Ok(Self { beats: all, courses: Mutex::default() })
    }

    /// What shapes the cell at ascending times, ms, over the peak of `Ta` in the last beat that any of them sees;
    /// `stimuli` are those of the beats, ascending. Before the first stimulus it is 0. Returns that peak.
    pub fn tension(
        &self,
        rates: &Rates,
        stimuli: &[f64],
        times: &[f64],
        into: &mut Vec<f64>,
    ) -> f64 {
        let way = self.way(rates, stimuli, times);
        into.clear();
        into.extend_from_slice(&way.tension);
        if way.peak > 0.0 {
            for value in into.iter_mut() {
                *value /= way.peak;
            }
        }
        way.peak
    }

    /// Derivatives of [`Potential::tension`] by each of the stimuli, 1/ms: from a place in the times on, 0 elsewhere.
    ///
    /// A stimulus that comes earlier cuts the beat before and moves its own; those after them feel it as long as their
    /// start does.
    pub fn by_stimulus(
        &self,
        rates: &Rates,
        stimuli: &[f64],
        times: &[f64],
    ) -> Vec<(usize, Vec<f64>)> {
        let way = self.way(rates, stimuli, times);
        (0..stimuli.len())
            .map(|beat| {
                let [(first, below), (_, above)] =
                    [-MOVED_MS, MOVED_MS].map(|by| way.moved(rates, stimuli, beat, by));
                let count = below.tension.len().max(above.tension.len());
                let value = |moved: &Moved, at: usize| {
                    moved.tension.get(at).copied().unwrap_or(way.tension[first + at])
                };
                let by = 1.0 / (2.0 * MOVED_MS * way.peak);
                let peak = by * (above.peak.unwrap_or(way.peak) - below.peak.unwrap_or(way.peak));
                if way.peak <= 0.0 {
                    return (0, Vec::new());
                }
                let local = (0..count).map(|at| by * (value(&above, at) - value(&below, at)));
                if peak == 0.0 {
                    return (first, local.collect());
                }
                // What all is counted in changes.
                let mut values: Vec<f64> =
                    way.tension.iter().map(|value| -value / way.peak * peak).collect();
                for (value, local) in values[first..].iter_mut().zip(local) {
                    *value += local;
                }
                (0, values)
            })
            .collect()
    }

    /// From beat to beat as far as there are times.
    fn way<'a>(&self, rates: &Rates, stimuli: &[f64], times: &'a [f64]) -> Way<'a> {
        let courses = self.courses(rates);
        let mut way = Way { courses, times, starts: Vec::new(), tension: Vec::new(), peak: 0.0 };
        let first = stimuli.first().copied().unwrap_or(f64::INFINITY);
        way.tension.resize(times.partition_point(|time| *time <= first), 0.0);
        let mut state = State::default();
        for number in 0..stimuli.len() {
            if way.tension.len() == times.len() {
                break;
            }
            way.starts.push(state);
            let left = &times[way.tension.len()..];
            let (course, window) = (course(&way.courses, number), window(stimuli, number));
            (state, way.peak) = one_beat(rates, course, window, state, left, &mut way.tension);
        }
        way
    }

    /// The steps that a width of the bell makes of the nodes.
    fn courses(&self, rates: &Rates) -> Courses {
        let key = rates.sigma.to_bits();
        let known = || self.courses.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(courses) = known().get(&key) {
            return Arc::clone(courses);
        }
        // Not held meanwhile: other threads look for other widths.
        let courses: Courses = self.beats.iter().map(|beat| steps(rates, beat)).collect();
        let mut known = known();
        if known.len() >= KEPT {
            known.clear();
        }
        known.insert(key, Arc::clone(&courses));
        courses
    }
}

/// A train as it went.
struct Way<'a> {
    courses: Courses,
    times: &'a [f64],
    /// The state at the start of each beat that any of the times sees.
    starts: Vec<State>,
    /// At the times.
    tension: Vec<f64>,
    /// Of the last of these beats.
    peak: f64,
}

fn course(courses: &Courses, number: usize) -> &[Step] {
    &courses[number.min(courses.len() - 1)]
}

impl Way<'_> {
    /// The same with one stimulus moved, from the first time that may tell on.
    fn moved(&self, rates: &Rates, stimuli: &[f64], beat: usize, by: f64) -> (usize, Moved) {
        let from = beat.saturating_sub(1);
        let mut stimuli = stimuli.to_vec();
        let earliest = stimuli[from] - if beat == 0 { MOVED_MS } else { 0.0 };
        stimuli[beat] += by;
        let first = self.times.partition_point(|time| *time <= earliest);
        let still = self.times[first..].partition_point(|time| *time <= stimuli[from]);
        let mut moved = Moved { tension: vec![0.0; still], peak: None };
        let Some(mut state) = self.starts.get(from).copied() else { return (first, moved) };
        for number in from..self.starts.len() {
            let off = state.iter().zip(&self.starts[number]).map(|(a, b)| (a - b).abs());
            if number > beat && off.fold(0.0, f64::max) <= ALIKE * self.peak {
                break;
            }
            let left = &self.times[(first + moved.tension.len()).min(self.times.len())..];
            let (course, window) = (course(&self.courses, number), window(&stimuli, number));
            let highest;
            (state, highest) = one_beat(rates, course, window, state, left, &mut moved.tension);
            moved.peak = (number + 1 == self.starts.len()).then_some(highest);
        }
        (first, moved)
    }
}

/// What another stimulus makes of a part of it.
struct Moved {
    tension: Vec<f64>,
    /// Where the last beat is part of it.
    peak: Option<f64>,
}

/// A stimulus and the next.
fn window(stimuli: &[f64], number: usize) -> [f64; 2] {
    [stimuli[number], stimuli.get(number + 1).copied().unwrap_or(f64::INFINITY)]
}

fn grid(cycle_ms: f64) -> impl Iterator<Item = f64> {
    let fine = (RISE_MS / FINE_MS) as usize;
    let coarse = ((cycle_ms - RISE_MS).max(0.0) / COARSE_MS).ceil() as usize;
    let fine = (0..=fine).map(|k| k as f64 * FINE_MS);
    let coarse = (1..=coarse).map(|k| RISE_MS + k as f64 * COARSE_MS);
    fine.chain(coarse).take_while(move |time| *time < cycle_ms).chain([cycle_ms])
}

/// From node to node, until the cell rests.
fn steps(rates: &Rates, beat: &Beat) -> Vec<Step> {
    let bell: Vec<f64> = beat.nodes.iter().map(|node| rates.bell(node.off_peak)).collect();
    let least = NOTHING * rates.bell(0.0);
    let steps = beat.nodes.windows(2).zip(bell.windows(2)).map(|(nodes, bell)| {
        let [from, to] = [nodes[0], nodes[1]];
        let length = to.time - from.time;
        let slope = if length > 0.0 { (bell[1] - bell[0]) / length } else { 0.0 };
        // Lengths of the grid are the same to the last bit, so that they share propagators.
        let on_grid = [FINE_MS, COARSE_MS].into_iter().find(|on| (length - on).abs() < 1e-9);
        let length = on_grid.unwrap_or(length);
        Step { begin: from.time, length, bell: bell[0], slope, above: from.above }
    });
    let mut steps: Vec<Step> = steps.collect();
    let pulls =
        |step: &Step| step.above || step.bell.max(step.bell + step.slope * step.length) > least;
    steps.truncate(steps.iter().rposition(pulls).map_or(0, |last| last + 1));
    steps
}

/// One beat between its stimulus and the next, from a state on: what shapes the cell at the times that are
/// in it, ascending, goes `into`. Returns the state at its end and the largest `Ta`.
fn one_beat(
    rates: &Rates,
    course: &[Step],
    [stimulus, next]: [f64; 2],
    start: State,
    times: &[f64],
    into: &mut Vec<f64>,
) -> (State, f64) {
    let wholes = [FINE_MS, COARSE_MS].map(|length| Whole::new(length, rates));
    let end = next - stimulus;
    let due = due(times, stimulus);
    let highest = start[1];
    let mut walk = Walk { rates, wholes, end, stimulus, times, due, state: start, highest };
    let mut left = walk.pass(course);
    while let Some((step, others)) = left.split_first()
        && step.begin < end
    {
        walk.take(step, into);
        left = walk.pass(others);
    }
    let rests = course.last().map_or(0.0, |last| last.begin + last.length);
    // What lags is found in steps, else rest is one.
    let length = if rates.lag.is_none() { f64::INFINITY } else { COARSE_MS };
    let mut rest = Step { begin: rests, length, bell: 0.0, slope: 0.0, above: false };
    for at in 1.. {
        let has_peaked = walk.state[0] <= walk.state[1];
        let is_over = end == f64::INFINITY && walk.times.is_empty() && has_peaked;
        if rest.begin >= end || is_over {
            break;
        }
        walk.take(&rest, into);
        rest.begin = rests + f64::from(at) * length;
    }
    (walk.state, walk.highest.max(walk.state[1]))
}

/// On the way through a beat.
struct Walk<'a> {
    rates: &'a Rates,
    wholes: [Whole; 2],
    /// When the next beat begins, after the stimulus.
    end: f64,
    stimulus: f64,
    /// Those that are still to come.
    times: &'a [f64],
    /// The first of them, after the stimulus.
    due: f64,
    state: State,
    /// The largest `Ta`.
    highest: f64,
}

impl Walk<'_> {
    /// Goes to the end of a step, or of the beat.
    fn take(&mut self, step: &Step, into: &mut Vec<f64>) {
        let (rates, before) = (self.rates, self.state);
        let until = (step.begin + step.length).min(self.end);
        while self.due <= until
            && let Some((_, left)) = self.times.split_first()
        {
            let there = step.after((self.due - step.begin).max(0.0), before, rates);
            into.push(there[2]);
            self.times = left;
            self.due = due(left, self.stimulus);
        }
        let length = until - step.begin;
        let after = if length < f64::INFINITY {
            step.after(length, before, rates)
        } else {
            State::default()
        };
        self.state = after;
        if before[0] > before[1] && after[0] <= after[1] {
            self.highest = self.highest.max(step.top(length, before, after, rates));
        }
    }

    /// Goes through whole steps in which nothing is asked for and nothing switches, which is nearly all of them, and
    /// returns those from the first other one on.
    fn pass<'s>(&mut self, steps: &'s [Step]) -> &'s [Step] {
        if !self.rates.lag.is_none() {
            return steps;
        }
        // Numbers of their own: arrays would go through memory from each step to the next.
        let [mut ta_i, mut ta, _] = self.state;
        let mut passed = 0;
        for step in steps {
            let end = step.begin + step.length;
            if end >= self.due || end > self.end {
                break;
            }
            let Some(whole) = self.wholes.iter().find(|whole| step.length == whole.length) else {
                break;
            };
            let Some([to_i, to]) = step.whole(whole, [ta_i, ta], self.rates) else { break };
            if ta_i > ta && to_i <= to {
                break;
            }
            (ta_i, ta) = (to_i, to);
            passed += 1;
        }
        self.state = [ta_i, ta, ta];
        &steps[passed..]
    }
}

/// The first of some times, after a stimulus; infinite if there is none.
fn due(times: &[f64], stimulus: f64) -> f64 {
    times.first().map_or(f64::INFINITY, |time| time - stimulus)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::adaptive;
    use crate::cell::coelho_2021;
    use crate::cell::tension::lag::Lag;

    /// So many beats after so many others, of the published cell.
    fn potential(before: usize, beats: usize, cycle_ms: f64) -> Potential {
        let model = coelho_2021::model();
        solve(Protocol::once(model.default_stimulus()), before, beats, cycle_ms)
    }

    fn solve(protocol: Protocol, before: usize, beats: usize, cycle_ms: f64) -> Potential {
        let model = coelho_2021::model();
        let tension = *model.tension_constants();
        let cell: Arc<dyn CellModel> = Arc::new(model);
        Potential::solve(&cell, &tension, protocol, before, beats, cycle_ms).unwrap()
    }

    const BEFORE: usize = 10;
    const PUBLISHED: Rates =
        Rates { c_0: 0.0166016, x_1: 0.0001, x_3: 0.2925, sigma: 0.046875, lag: Lag::NONE };

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
        let whole = adaptive::solve(
            &model,
            protocol,
            adaptive::AdaptiveSettings { tolerance: 1e-7 },
            lasts,
            1.0,
        )
        .unwrap();
        // From the second of the three beats on: what was before the first is not known to the fit.
        let skipped = 500 * (BEFORE + 1);
        let late: Vec<f64> =
            whole.time_ms[skipped..].iter().map(|time| time - 500.0 * BEFORE as f64).collect();
        let potential = solve(protocol, BEFORE, 3, 500.0);
        let mut found = Vec::new();
        let peak = potential.tension(&PUBLISHED, &[0.0, 500.0, 1000.0], &late, &mut found);
        let expected = &whole.tension[skipped..];
        let off = found.iter().zip(expected).map(|(a, b)| (peak * a - b).abs()).fold(0.0, f64::max);
        // What the two grids and tolerances leave; the whole cell's own tolerance moves its peak by 1e-5.
        assert!(off < 1e-4 * peak, "off by {} of the peak", off / peak);
        assert!((found.iter().copied().fold(0.0, f64::max) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn the_peak_of_a_slow_cell_is_found_after_its_bell_and_after_the_last_frame() {
        let potential = potential(0, 2, 1500.0);
        let fine: Vec<f64> = (0..60_000).map(|k| 0.05 * f64::from(k)).collect();
        let few = [10.0, 1510.0];
        for (c_0, lag) in [(0.0166016, 0.0), (0.003, 0.0), (0.001, 0.0), (0.003, 20.0)] {
            let rates = Rates { c_0, lag: Lag::by(lag), ..PUBLISHED };
            let mut curve = Vec::new();
            let peak = potential.tension(
                &Rates { lag: Lag::NONE, ..rates },
                &[0.0, 1500.0],
                &fine,
                &mut curve,
            );
            let highest = curve[30_000..].iter().copied().fold(0.0, f64::max);
            assert!((highest - 1.0).abs() < 1e-6, "{c_0} 1/ms: {highest}");
            let again = potential.tension(&rates, &[0.0, 1500.0], &few, &mut curve);
            assert!(
                (again / peak - 1.0).abs() < 1e-9,
                "{c_0} 1/ms, lag {lag} ms: {again} and {peak}"
            );
        }
    }

    #[test]
    fn shared_propagators_and_rest_change_nothing() {
        let potential = potential(2, 3, 450.0);
        let stimuli = [10.0, 455.0, 930.0];
        let times: Vec<f64> = (0..700).map(|k| 2.1 * f64::from(k)).collect();
        for sigma in [1.0, 4.0] {
            let rates = Rates { sigma: sigma * PUBLISHED.sigma, ..PUBLISHED };
            let mut quick = Vec::new();
            let peak = potential.tension(&rates, &stimuli, &times, &mut quick);
            // Node by node, each with exponentials of its own, to the end of every beat.
            let mut plain = vec![0.0; times.partition_point(|time| *time <= stimuli[0])];
            let mut state = State::default();
            for (beat, stimulus) in potential.beats.iter().zip(stimuli) {
                let next = stimuli.iter().find(|next| **next > stimulus);
                let end = next.map_or(450.0, |next| next - stimulus);
                for nodes in beat.nodes.windows(2) {
                    let [from, to] = [nodes[0], nodes[1]];
                    let [bell, last] = [from, to].map(|node| rates.bell(node.off_peak));
                    let length = to.time - from.time;
                    let slope = if length > 0.0 { (last - bell) / length } else { 0.0 };
                    let step = Step { begin: from.time, length, bell, slope, above: from.above };
                    let until = to.time.min(end);
                    while let Some(time) = times.get(plain.len())
                        && time - stimulus <= until
                        && from.time < end
                    {
                        plain
                            .push(step.after(time - stimulus - from.time, state, &rates)[1] / peak);
                    }
                    if from.time < end {
                        state = step.after(until - from.time, state, &rates);
                    }
                }
                // A pause that is longer than the cycle.
                if let Some(next) = next.filter(|next| **next > stimulus + 450.0) {
                    let length = next - stimulus - 450.0;
                    let step = Step { begin: 450.0, length, bell: 0.0, slope: 0.0, above: false };
                    while let Some(time) = times.get(plain.len()).filter(|time| *time <= next) {
                        let since = time - stimulus - 450.0;
                        plain.push(step.after(since, state, &rates)[1] / peak);
                    }
                    state = step.after(length, state, &rates);
                }
            }
            for ((plain, quick), time) in plain.iter().zip(&quick).zip(&times) {
                assert!((plain - quick).abs() < 1e-12, "{time} ms: {plain} and {quick}");
            }
            assert!(plain.len() > 600);
        }
    }

    #[test]
    fn what_lags_is_the_tension_through_a_filter() {
        let potential = potential(0, 1, 900.0);
        let times: Vec<f64> = (0..36_000).map(|k| 0.025 * f64::from(k)).collect();
        let curve = |lag: f64| {
            let mut curve = Vec::new();
            potential.tension(
                &Rates { lag: Lag::by(lag), ..PUBLISHED },
                &[20.0],
                &times,
                &mut curve,
            );
            curve
        };
        let tension = curve(0.0);
        for lag in [1.0, 30.0, 400.0] {
            let (mut filtered, mut off) = (0.0, 0.0_f64);
            for (place, lagging) in curve(lag).iter().enumerate().skip(1) {
                let mean = f64::midpoint(tension[place - 1], tension[place]);
                filtered = mean + (filtered - mean) * (-0.025 / lag).exp();
                off = off.max((filtered - lagging).abs());
            }
            // The mean stands for a straight line.
            assert!(off < 2e-5, "{lag} ms: {off}");
        }
    }

    #[test]
    fn a_curve_depends_smoothly_on_each_parameter() {
        let potential = potential(0, 1, 600.0);
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
