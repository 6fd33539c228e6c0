//! A block of muscle that feels its own length: free, against a load, and between fibres, as programs of others have it.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common::Sample;
use myospring::cell::calcium::CalciumTrace;
use myospring::cell::integrator::CellIntegrator;
use myospring::cell::land_2017::Land2017;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::solve;
use myospring::cell::tomek_2019::{Layer, TomekModel, Variant};
use myospring::cell::{CellModel, Input};
use std::sync::Arc;

/// Young's modulus of the passive cell, kPa, and Poisson's ratio.
pub(crate) const YOUNG: f64 = 100.6;
const POISSON: f64 = 0.49;

/// What pulls at the ends of the block.
pub(crate) enum Load {
    /// Nothing.
    None,
    /// Held at its length until it pulls harder than this stress, kPa of the section at rest, then shortening
    /// against it.
    Afterload(f64),
    /// Fibres of this stiffness at either end, nN/um, of a block 140 um long with a section of 157 um^2.
    Fibres(f64),
}

/// Stretch of a block of the cubic lattice (springs along sides and diagonals of faces, a volume law) that
/// pulls itself together by a tension along its fibre, kPa, and is pulled at by a stress that depends on its
/// stretch: homogeneous, so two equations.
pub(crate) fn rest(tension: f64, young: f64, outside: &dyn Fn(f64) -> f64) -> f64 {
    let shear = young / (2.0 * (1.0 + POISSON));
    let bulk = young * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)) - shear;
    let root2 = 2f64.sqrt();
    // W = mu/2 sum (l_i - 1)^2 + mu sum_ij (sqrt(l_i^2 + l_j^2) - sqrt 2)^2 + kappa/2 (J - 1)^2 + Ta/2 l_1^2
    let slopes = |l: f64, m: f64| {
        let (long, across) = (l.hypot(m), m * root2);
        let volume = bulk * (l * m * m - 1.0);
        let by_l = shear * (l - 1.0)
            + 4.0 * shear * (long - root2) * l / long
            + volume * m * m
            + tension * l
            - outside(l);
        let by_m = 2.0 * shear * (m - 1.0)
            + 4.0 * shear * (long - root2) * m / long
            + 2.0 * shear * (across - root2) * root2
            + 2.0 * volume * l * m;
        [by_l, by_m]
    };
    let (mut l, mut m) = (1.0, 1.0);
    for _ in 0..50 {
        let [f, g] = slopes(l, m);
        let d = 1e-7;
        let [fl, gl] = slopes(l + d, m);
        let [fm, gm] = slopes(l, m + d);
        let [a, b, c, e] = [(fl - f) / d, (fm - f) / d, (gl - g) / d, (gm - g) / d];
        let det = a * e - b * c;
        let step = [(f * e - g * b) / det, (g * a - f * c) / det];
        l -= step[0];
        m -= step[1];
        if step.iter().all(|part| part.abs() < 1e-13) {
            break;
        }
    }
    l
}

/// A twitch of one stimulus at 0 ms.
pub(crate) struct Twitch {
    pub(crate) interval_ms: f64,
    /// Per cent of the length at the start, which calcium at rest has shortened a little.
    pub(crate) shortening: Vec<f64>,
    pub(crate) tension: Vec<f64>,
}

impl Twitch {
    pub(crate) fn peak(&self) -> f64 {
        self.shortening.iter().copied().fold(0.0, f64::max)
    }

    pub(crate) fn time_of_peak(&self) -> f64 {
        let at = self.shortening.iter().position(|value| *value == self.peak()).unwrap();
        self.interval_ms * at as f64
    }

    /// Lengths per s.
    fn rates(&self) -> impl Iterator<Item = f64> {
        let rate = |pair: &[f64]| (pair[1] - pair[0]) / self.interval_ms * 10.0;
        self.shortening.windows(2).map(rate)
    }

    pub(crate) fn largest_rate(&self) -> f64 {
        self.rates().fold(0.0, f64::max)
    }

    pub(crate) fn largest_relengthening(&self) -> f64 {
        -self.rates().fold(0.0, f64::min)
    }

    /// From the peak until a part is relengthened, ms.
    pub(crate) fn relaxation(&self, part: f64) -> f64 {
        let start = (self.time_of_peak() / self.interval_ms) as usize;
        let level = (1.0 - part) * self.peak();
        let after = self.shortening[start..].iter();
        self.interval_ms * after.take_while(|value| **value > level).count() as f64
    }
}

/// At the end of each interval the stretch is that of the block under the tension, which has a lag in ms (a filter; 0
/// for none), found by bisection.
pub(crate) fn twitch<M: CellModel + 'static>(
    model: &Arc<M>,
    load: &Load,
    interval_ms: f64,
    lag_ms: f64,
    young: f64,
) -> Twitch {
    let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let cell: Arc<dyn CellModel> = Arc::<M>::clone(model);
    let cell = CellIntegrator::new(cell, protocol, model.usual_settings()).unwrap();
    follow(cell, load, interval_ms, lag_ms, young)
}

/// The same, of a cell that may have beaten before: from its time on for 600 ms.
fn follow(
    mut cell: CellIntegrator,
    load: &Load,
    interval_ms: f64,
    lag_ms: f64,
    young: f64,
) -> Twitch {
    let outside = |stretch: f64| match load {
        Load::None => 0.0,
        Load::Afterload(stress) => *stress,
        Load::Fibres(stiffness) => stiffness * 140.0 * (1.0 - stretch) / 2.0 / 157.0,
    };
    let most = if matches!(load, Load::Afterload(_)) { 1.0 } else { 1.2 };
    let (mut lengths, mut tensions) = (Vec::new(), Vec::new());
    let (mut stretch, mut felt) = (1.0, 0.0);
    let start = cell.time();
    for step in 0..=(600.0 / interval_ms).round() as usize {
        let time = start + step as f64 * interval_ms;
        let (over, kept) = match step {
            0 => (f64::INFINITY, 0.0),
            _ if lag_ms == 0.0 => (interval_ms, 0.0),
            _ => (interval_ms, f64::exp(-interval_ms / lag_ms)),
        };
        let trial = |end: f64| {
            let mut next = cell.clone();
            let middle = if step == 0 { end } else { 0.5 * (stretch + end) };
            next.advance_to(time, middle, (end - stretch) / over).unwrap();
            let input = Input { stretch: end, ..Input::REST };
            let tension = next.model().tension(next.state(), &input);
            (next, tension, tension + (felt - tension) * kept)
        };
        // The rate of a cell is below 4 lengths/s.
        let reach = if step == 0 { 0.2 } else { 4e-3 * interval_ms };
        let (mut low, mut high) = (stretch - reach, f64::min(stretch + reach, most));
        if rest(trial(high).2, young, &outside) >= high {
            low = high;
        }
        while high - low > 1e-9 {
            let middle = 0.5 * (low + high);
            let longer = rest(trial(middle).2, young, &outside) > middle;
            if longer { low = middle } else { high = middle }
        }
        let tension;
        (cell, tension, felt) = trial(low);
        stretch = low;
        lengths.push(stretch);
        tensions.push(tension);
    }
    let shortening = lengths.iter().map(|length| 100.0 * (1.0 - length / lengths[0])).collect();
    Twitch { interval_ms, shortening, tension: tensions }
}

/// Calcium of the first beat of ToR-ORd with these myofilaments, as a trace that is measured each 0.5 ms.
pub(crate) fn torord_calcium() -> CalciumTrace {
    let model = TomekModel::published(Layer::Endo, Variant::Land);
    let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let trace = solve(&model, protocol, model.usual_settings(), 700.0, 0.5).unwrap();
    CalciumTrace::new(&trace.time_ms, trace.variable("Ca_i").unwrap()).unwrap()
}

#[test]
fn against_loads_it_shortens_less_and_slower_and_does_most_work_near_half_of_the_isometric_stress()
{
    let model = Arc::new(Land2017::published().with_trace(torord_calcium()));
    let mut works = Vec::new();
    for (part, shortening, work, rate) in [
        (0.1, 8.95, 0.215, 1.16),
        (0.2, 7.88, 0.378, 1.10),
        (0.4, 5.74, 0.552, 0.89),
        (0.6, 3.68, 0.531, 0.65),
        (0.8, 1.71, 0.329, 0.39),
    ] {
        // The isometric peak is 24.03 kPa, tested beside.
        let stress = part * 24.03;
        let found = twitch(&model, &Load::Afterload(stress), 1.0, 0.0, YOUNG);
        let done = stress * found.peak() / 100.0;
        assert!((found.peak() - shortening).abs() < 0.05, "{part}: {} %", found.peak());
        assert!((done - work).abs() < 5e-3, "{part}: {done} kPa");
        let fastest = found.largest_rate();
        assert!((fastest - rate).abs() < 0.03, "{part}: {fastest} lengths/s");
        // Below the speed without load of these myofilaments.
        assert!(fastest < 3.495);
        let end = found.time_of_peak();
        // That program has 170 to 182 ms.
        assert!((167.0..=183.0).contains(&end), "{part}: {end} ms");
        works.push(done);
    }
    assert!(works[2] > works[1] && works[2] > works[3]);
}

#[test]
#[ignore = "slow"]
fn between_carbon_fibres_it_pulls_harder_and_shortens_less_the_stiffer_they_are() {
    let model = Arc::new(TomekModel::published(Layer::Endo, Variant::Land));
    for (stiffness, shortening, force) in [(100.0, 9.04, 633.0), (2000.0, 2.12, 2968.0)] {
        let found = twitch(&model, &Load::Fibres(stiffness), 1.0, 5.0, 100.0);
        let ratio = found.largest_rate() / found.peak() * 100.0;
        let pulled = stiffness * 140.0 * found.peak() / 100.0 / 2.0;
        // That program had ten beats, this is the first: some 0.1 %.
        assert!((found.peak() - shortening).abs() < 0.02, "{stiffness}: {} %", found.peak());
        assert!((pulled / force - 1.0).abs() < 3e-3, "{stiffness}: {pulled} nN");
        assert!((10.0..=10.8).contains(&ratio), "{stiffness}: {ratio} 1/s");
    }
}

#[test]
#[ignore = "slow"]
fn blocked_calcium_current_takes_shortening_and_force_in_order() {
    let published = TomekModel::published(Layer::Endo, Variant::Land);
    let block = |factor: f64| -> Twitch {
        let mut parameters = published.parameters().clone();
        parameters.set("P_Ca", factor * parameters.get("P_Ca").unwrap()).unwrap();
        let model = published.with_parameters(parameters).unwrap();
        let protocol = Protocol {
            start_ms: 0.0,
            beats: 60,
            cycle_length_ms: 1000.0,
            ..Protocol::once(model.default_stimulus())
        };
        let settings = model.usual_settings();
        let mut cell = CellIntegrator::new(model, protocol, settings).unwrap();
        // At its resting length until it is steady; what it feels in one beat changes its stores little.
        cell.advance_to(59_000.0, 1.0, 0.0).unwrap();
        follow(cell, &Load::None, 1.0, 5.0, 100.0)
    };
    let mut sample = Sample::one_in(3);
    // An independent program has 11.07, 6.87 and 2.68 %, ten beats after the block; at ten beats this one has 7.56 and 3.93,
    // and falls as its stores empty: 6.78 and 2.53 in the end.
    for (factor, expected) in [(0.5, 2.68), (0.75, 6.87), (1.0, 11.07)] {
        if sample.leaves_out() {
            continue;
        }
        let found = block(factor).peak();
        assert!((found - expected).abs() < 0.2, "{factor}: {found} {expected} %");
    }
}
