//! Land's myofilaments in a cell: isometric and unloaded twitches, against numbers of independent programs.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::cell::calcium::CalciumTrace;
use myospring::cell::integrator::CellIntegrator;
use myospring::cell::land_2017::Land2017;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::solve;
use myospring::cell::tomek_2019::{Layer, TomekModel, Variant};
use myospring::cell::{CellModel as _, Input};
use myospring::integrate::Method;
use myospring::integrate::verlet::Integrator;
use myospring::mechanics::material::myofilament_material;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::{built_in, lattice};
use myospring::simulation::{Numerics, Simulation, StretchFelt};
use std::sync::Arc;

/// Young's modulus of the passive cell, kPa, and Poisson's ratio.
const YOUNG: f64 = 100.6;
const POISSON: f64 = 0.49;

/// Stretch of a block of the cubic lattice (springs along sides and diagonals of faces, a volume law) that
/// pulls itself together by a tension along its fibre, kPa: homogeneous, so two equations.
fn rest(tension: f64, young: f64) -> f64 {
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
            + tension * l;
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
        let [fm, gm] = slopes(l, m + d).map(|x| x);
        let [a, b, c, e] = [(fl - f) / d, (fm - f) / d, (gl - g) / d, (gm - g) / d];
        let det = a * e - b * c;
        l -= (f * e - g * b) / det;
        m -= (g * a - f * c) / det;
    }
    l
}

/// A twitch of one stimulus at 0 ms.
struct Twitch {
    interval_ms: f64,
    /// Per cent of the length at the start, which calcium at rest has shortened a little.
    shortening: Vec<f64>,
    tension: Vec<f64>,
}

impl Twitch {
    fn peak(&self) -> f64 {
        self.shortening.iter().copied().fold(0.0, f64::max)
    }

    fn time_of_peak(&self) -> f64 {
        let at = self.shortening.iter().position(|value| *value == self.peak()).unwrap();
        self.interval_ms * at as f64
    }

    /// Lengths per s.
    fn largest_rate(&self) -> f64 {
        let rate = |pair: &[f64]| (pair[1] - pair[0]) / self.interval_ms * 10.0;
        self.shortening.windows(2).map(rate).fold(0.0, f64::max)
    }

    /// From the peak, ms.
    fn half_relaxation(&self) -> f64 {
        let start = (self.time_of_peak() / self.interval_ms) as usize;
        let after = self.shortening[start..].iter();
        self.interval_ms * after.take_while(|value| **value > 0.5 * self.peak()).count() as f64
    }
}

/// Without load: at the end of each interval the stretch is that of the block under the tension, which has a
/// lag of 1 ms (a filter; 0 for none), found by bisection.
fn unloaded(model: Land2017, interval_ms: f64, lag_ms: f64, young: f64) -> Twitch {
    let model = Arc::new(model);
    let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let mut cell = CellIntegrator::new(model.clone(), protocol, model.usual_settings()).unwrap();
    let (mut lengths, mut tensions) = (Vec::new(), Vec::new());
    let (mut stretch, mut felt) = (1.0, 0.0);
    for step in 0..=(600.0 / interval_ms).round() as usize {
        let time = step as f64 * interval_ms;
        let (over, kept) = match step {
            0 => (f64::INFINITY, 0.0),
            _ if lag_ms == 0.0 => (interval_ms, 0.0),
            _ => (interval_ms, f64::exp(-interval_ms / lag_ms)),
        };
        let trial = |end: f64| {
            let mut next = cell.clone();
            let middle = if step == 0 { end } else { 0.5 * (stretch + end) };
            next.advance_to(time, middle, (end - stretch) / over).unwrap();
            let tension = model.tension(next.state(), &Input { stretch: end, ..Input::REST });
            (next, tension, tension + (felt - tension) * kept)
        };
        let (mut low, mut high) = (0.6, 1.2);
        for _ in 0..45 {
            let middle = 0.5 * (low + high);
            if rest(trial(middle).2, young) > middle { low = middle } else { high = middle }
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

#[test]
fn the_block_that_the_numbers_are_for_shortens_as_published() {
    for (tension, shortening) in [(50.0, 12.0), (40.0, 9.96), (30.0, 7.75)] {
        let found = 100.0 * (1.0 - rest(tension, 348.6));
        assert!((found - shortening).abs() < 5e-3, "{tension} kPa: {found} %");
    }
}

#[test]
fn an_unloaded_twitch_is_that_of_independent_programs() {
    // Two programs: 10.12 and 10.12 %, 1.134 and 1.132 lengths/s, 163 and 163.0 ms, 112.5 and 112.1 ms.
    let twitch = unloaded(Land2017::published(), 0.5, 1.0, YOUNG);
    assert!((twitch.peak() - 10.12).abs() < 5e-3, "{} %", twitch.peak());
    assert!((twitch.largest_rate() - 1.132).abs() < 2e-3, "{}/s", twitch.largest_rate());
    assert!((twitch.time_of_peak() - 163.0).abs() <= 0.5, "{} ms", twitch.time_of_peak());
    assert!((twitch.half_relaxation() - 112.3).abs() <= 0.7, "{} ms", twitch.half_relaxation());
    let strongest = twitch.tension.iter().copied().fold(0.0, f64::max);
    assert!((strongest - 11.83).abs() < 5e-3, "{strongest} kPa");
}

/// The built-in cell with the material for myofilaments, stimulated at 0 ms.
pub(crate) fn cell(method: Method, exchange_interval: f64, support: SupportKind) -> Simulation {
    let model = Land2017::published();
    let (mesh, _) = lattice::from_outline(&built_in::adult_ventricular(), Some(5.0)).unwrap();
    let usual = Simulation::new(mesh);
    Simulation {
        protocol: Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) },
        material: myofilament_material(),
        support,
        duration: 400.0,
        numerics: Numerics {
            method,
            exchange_interval,
            output_interval: 1.0,
            cell: model.usual_settings(),
            ..usual.numerics.clone()
        },
        cell: Arc::new(model),
        ..usual
    }
}

fn shortening(simulation: &Simulation) -> Vec<f64> {
    let outcome = simulation.build().unwrap().run(|_progress| true);
    assert_eq!(outcome.stop, None);
    outcome.recording.samples.iter().map(|sample| sample.shortening_pct).collect()
}

#[test]
fn tension_and_stretch_are_found_together_at_any_exchange_interval() {
    let free = |method, interval| shortening(&cell(method, interval, SupportKind::MassCentre));
    let fine = free(Method::QuasiStatic, 0.05);
    let peak = fine.iter().copied().fold(0.0, f64::max);
    // The flat cell widens a little otherwise than the block.
    assert!((peak - 10.12).abs() < 0.05, "{peak} %");
    for interval in [1.0, 0.25] {
        let off = largest_difference(&free(Method::QuasiStatic, interval), &fine);
        // Second order: 2.4e-5 and 1.5e-6 of the peak.
        assert!(off < 1e-4 * peak, "{interval} ms: {off} of {peak} %");
    }
    let moving = free(Method::Verlet(Integrator::StoermerVerlet), 0.25);
    // It begins without the little that calcium at rest pulls, and lags by some 0.02 ms: 2.1e-4.
    let off = largest_difference(&moving[20..], &fine[20..]);
    assert!(off < 1e-3 * peak, "in time: {off} of {peak} %");
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn a_cell_without_a_potential_records_none_but_its_calcium_and_its_crossbridges() {
    let outcome = cell(Method::QuasiStatic, 1.0, SupportKind::MassCentre).build().unwrap();
    let outcome = outcome.run(|_progress| true);
    let samples = &outcome.recording.samples;
    assert!(samples.iter().all(|sample| sample.u.is_none() && sample.vm_mv.is_none()));
    let beats = outcome.beats();
    assert!(beats[0].action_potential.is_empty());
    let signals = &outcome.recording.signals;
    let names: Vec<&str> = signals.iter().map(|signal| &*signal.name).collect();
    assert_eq!(names, ["Ca_i", "XS", "XW", "CaTRPN", "TmB", "zeta_s", "zeta_w"]);
    let calcium = &signals[0].values;
    // From the start of the stimulus on: 0.0632 uM at rest, 0.4391 above it after 51.6 ms.
    assert_eq!(calcium[0], 0.0632);
    let highest = calcium.iter().copied().fold(0.0, f64::max);
    assert!((highest - 0.5023).abs() < 1e-4 && calcium[52] == highest, "{highest} uM");
    assert!(signals[1].values[150] > 5.0 * signals[1].values[0]);
}

#[test]
fn calcium_begins_anew_with_each_stimulus() {
    let model = Land2017::published();
    let protocol = Protocol {
        start_ms: 10.0,
        cycle_length_ms: 400.0,
        beats: 3,
        ..Protocol::once(model.default_stimulus())
    };
    let trace = solve(&model, protocol, model.usual_settings(), 1400.0, 1.0).unwrap();
    let calcium = trace.variable("Ca_i").unwrap();
    assert_eq!(calcium[..10], [0.0632; 10]);
    for at in [0, 50, 399] {
        // At the stimulus itself the course is at its start.
        assert_eq!(calcium[10 + at], calcium[410 + at]);
        assert!((calcium[10 + at] - calcium[810 + at]).abs() < 1e-12);
    }
    assert!(trace.potential.is_empty() && trace.membrane_potential_mv.is_none());
}

/// A strip with half as many myofibrils in one half.
fn weak_half() -> Simulation {
    let mesh = lattice::rectangle(16, 3, 5.0).unwrap();
    let usual = cell(Method::QuasiStatic, 1.0, SupportKind::MassCentre);
    let half = |triangle| if mesh.centre(triangle)[0] < 40.0 { 0.5 } else { 1.0 };
    Simulation {
        myofibril_content: Some(mesh.simplices.iter().map(half).collect()),
        stretch_felt: StretchFelt::Triangle,
        duration: 300.0,
        numerics: Numerics { frame_interval: 150.0, ..usual.numerics.clone() },
        cell: usual.cell.clone(),
        protocol: usual.protocol,
        material: usual.material.clone(),
        ..Simulation::new(mesh)
    }
}

#[test]
fn triangles_that_feel_their_own_stretch_are_the_whole_cell_where_all_are_alike() {
    let whole =
        Simulation { myofibril_content: None, stretch_felt: StretchFelt::Cell, ..weak_half() };
    let each = Simulation { stretch_felt: StretchFelt::Triangle, ..whole.clone() };
    let (whole, each) = (shortening(&whole), shortening(&each));
    let peak = whole.iter().copied().fold(0.0, f64::max);
    // A uniform strip deforms homogeneously: what is left is the path's interpolation.
    let off = largest_difference(&whole, &each);
    assert!(off < 1e-5 * peak, "{off} of {peak} %");
}

#[test]
fn triangles_that_differ_are_found_at_any_exchange_interval_and_in_time() {
    let run = |method, exchange_interval: f64| {
        let simulation = weak_half();
        let numerics = Numerics { method, exchange_interval, ..simulation.numerics.clone() };
        shortening(&Simulation { numerics, ..simulation })
    };
    let fine = run(Method::QuasiStatic, 0.25);
    let peak = fine.iter().copied().fold(0.0, f64::max);
    let off = largest_difference(&run(Method::QuasiStatic, 1.0), &fine);
    assert!(off < 1e-3 * peak, "{off} of {peak} %");
    let moving = run(Method::Verlet(Integrator::StoermerVerlet), 0.25);
    let off = largest_difference(&moving[20..], &fine[20..]);
    // 1.7e-3: the halves swing a little where the motion is in time.
    assert!(off < 4e-3 * peak, "in time: {off} of {peak} %");
}

/// Calcium of the first beat of ToR-ORd with these myofilaments, as a trace that is measured each 0.5 ms.
fn torord_calcium() -> CalciumTrace {
    let model = TomekModel::published(Layer::Endo, Variant::Land);
    let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let trace = solve(&model, protocol, model.usual_settings(), 700.0, 0.5).unwrap();
    CalciumTrace::new(&trace.time_ms, trace.variable("Ca_i").unwrap()).unwrap()
}

#[test]
fn held_at_three_lengths_on_the_calcium_of_torord_it_twitches_as_in_an_independent_program() {
    let model = Arc::new(Land2017::published().with_trace(torord_calcium()));
    for (stretch, peak, at, steepest) in
        [(0.9, 9.73, 155.1, 11.9), (1.0, 24.03, 169.3, 10.8), (1.1, 56.12, 188.9, 9.7)]
    {
        let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
        let settings = model.usual_settings();
        let mut cell = CellIntegrator::new(model.clone(), protocol, settings).unwrap();
        let tensions: Vec<f64> = (0..=7000)
            .map(|step| {
                cell.advance_to(0.1 * f64::from(step), stretch, 0.0).unwrap();
                model.tension(cell.state(), &Input { stretch, ..Input::REST })
            })
            .collect();
        let highest = tensions.iter().copied().fold(0.0, f64::max);
        let time = 0.1 * tensions.iter().position(|value| *value == highest).unwrap() as f64;
        let rise = tensions.windows(2).map(|pair| (pair[1] - pair[0]) / 0.1).fold(0.0, f64::max);
        // That program took its own translation of ToR-ORd, whose first beat is 0.1 % off its hundredth.
        assert!((highest / peak - 1.0).abs() < 1e-3, "{stretch}: {highest} kPa");
        assert!((time - at).abs() < 0.2, "{stretch}: {time} ms");
        let found = 1e3 * rise / highest;
        assert!((found - steepest).abs() < 0.06, "{stretch}: {found} 1/s");
    }
}

#[test]
fn an_unloaded_twitch_on_the_calcium_of_torord_is_that_of_an_independent_program() {
    let with_trace = || Land2017::published().with_trace(torord_calcium());
    let twitch = unloaded(with_trace(), 0.5, 1.0, YOUNG);
    assert!((twitch.peak() - 9.93).abs() < 0.02, "{} %", twitch.peak());
    // Printed twice, 1.114 and 1.116 lengths/s, 166 and 167 ms, 120 and 119.5 ms.
    assert!((twitch.largest_rate() - 1.115).abs() < 4e-3, "{}/s", twitch.largest_rate());
    assert!((twitch.time_of_peak() - 166.5).abs() <= 1.0, "{} ms", twitch.time_of_peak());
    assert!((twitch.half_relaxation() - 119.8).abs() <= 1.0, "{} ms", twitch.half_relaxation());
    // Stiffer and softer cells.
    for (young, peak) in [(40.0, 14.6), (80.0, 11.1), (150.0, 8.0)] {
        let found = unloaded(with_trace(), 1.0, 1.0, young).peak();
        assert!((found - peak).abs() < 0.06, "{young} kPa: {found} %");
    }
}
