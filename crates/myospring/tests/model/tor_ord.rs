//! ToR-ORd against Myokit's reading of the published `CellML`, and with myofilaments against an independent program.
//!
//! `reference/tor_ord_rates.csv` and `tor_ord_beats.csv` were made by `verification/python/tor_ord_reference.py`.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings, solve};
use myospring::cell::tomek_2019::{Layer, TomekModel, Variant};
use myospring::cell::{self, CellModel, Input};
use myospring::integrate::Method as Way;
use myospring::mechanics::material::myofilament_material;
use myospring::mesh::lattice;
use myospring::recording::Recording;
use myospring::simulation::Simulation;
use std::collections::BTreeMap;
use std::sync::Arc;

/// States and rates of one model at one instant, by name.
type Sample = BTreeMap<String, [f64; 2]>;

fn samples() -> BTreeMap<String, Vec<Sample>> {
    let mut all = BTreeMap::<String, BTreeMap<u64, Sample>>::new();
    for line in include_str!("../reference/tor_ord_rates.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |at: usize| fields[at].parse::<f64>().unwrap();
        let sample = all.entry(fields[0].to_owned()).or_default();
        let sample = sample.entry((10.0 * number(1)) as u64).or_default();
        sample.insert(fields[2].to_owned(), [number(3), number(4)]);
    }
    all.into_iter().map(|(name, samples)| (name, samples.into_values().collect())).collect()
}

fn model(name: &str) -> Arc<dyn CellModel> {
    cell::model(name).unwrap()
}

fn rates(model: &dyn CellModel, state: &[f64], input: &Input) -> Vec<f64> {
    let mut rates = vec![f64::NAN; state.len()];
    model.derivatives(state, input, &mut rates);
    rates
}

#[test]
fn rates_of_all_states_are_those_that_myokit_finds_in_the_published_cellml() {
    let all = samples();
    assert_eq!(all.len(), 6);
    for (name, samples) in all {
        let model = model(&name);
        assert_eq!(samples.len(), 7, "{name}");
        for (index, state) in model.state_names().iter().enumerate() {
            let largest = samples.iter().map(|s| s[*state][1].abs()).fold(0.0, f64::max);
            for sample in &samples {
                let values: Vec<f64> =
                    model.state_names().iter().map(|name| sample[*name][0]).collect();
                let found = rates(&*model, &values, &Input::REST)[index];
                let expected = sample[*state][1];
                // Fluxes some thousand times as large cancel; 13 digits are written.
                let bound = 1e-11 * largest;
                assert!((found - expected).abs() <= bound, "{name}, {state}: {found} {expected}");
            }
        }
    }
}

#[test]
fn with_myofilaments_rates_at_the_published_start_are_those_of_an_independent_program() {
    let model = model("tor_ord_land");
    let stimulated = Input { stimulus: 53.0, ..Input::REST };
    let found = rates(&*model, &model.initial_state(), &stimulated);
    let rate = |name: &str| found[model.state_names().iter().position(|n| *n == name).unwrap()];
    // Half of the last digit printed.
    assert!((rate("v") - 53.0000408).abs() < 5e-8, "{}", rate("v"));
    assert!((rate("Ca_cyt") - 3.119567977e-9).abs() < 5e-19, "{:e}", rate("Ca_cyt"));
    assert!((rate("Ca_nsr") - -2.547044888e-5).abs() < 5e-15, "{:e}", rate("Ca_nsr"));
}

/// What one beat of many amounts to; durations from the stimulus.
struct Beat {
    apd90_ms: f64,
    /// Least and most, nM.
    calcium: [f64; 2],
    calcium_peak_ms: f64,
    /// kPa, and when, ms.
    tension: f64,
    tension_peak_ms: f64,
    /// From the peak of tension to 50 and 90 % of relaxation, ms.
    relaxation_ms: [f64; 2],
}

/// Samples, ms.
const EACH_MS: f64 = 0.25;

/// When a course falls through a level, ms; linear between samples.
fn falls(course: &[f64], from: usize, level: f64) -> f64 {
    let last = (from..course.len() - 1).find(|&k| course[k + 1] < level).unwrap();
    EACH_MS * (last as f64 + (course[last] - level) / (course[last] - course[last + 1]))
}

fn beat(model: &(dyn CellModel + 'static), beats: u32, cycle_length_ms: f64) -> Beat {
    let stimulus = model.default_stimulus();
    let protocol = Protocol { start_ms: 0.0, cycle_length_ms, beats, ..Protocol::once(stimulus) };
    let settings = SolverSettings { tolerance: 1e-4, ..SolverSettings::of(CellMethod::Stiff) };
    let duration_ms = f64::from(beats) * cycle_length_ms;
    let trace = solve(model, protocol, settings, duration_ms, EACH_MS).unwrap();
    let from = trace.time_ms.len() - 1 - (cycle_length_ms / EACH_MS) as usize;
    let v = &trace.variable("v").unwrap()[from..];
    let calcium = &trace.variable("Ca_cyt").unwrap()[from..];
    let tension = &trace.tension[from..];
    let highest = |course: &[f64]| {
        (0..course.len()).fold(0, |best, k| if course[k] > course[best] { k } else { best })
    };
    let (peak, top) = (highest(v), highest(tension));
    let relaxed = |part: f64| {
        let level = tension[top] - part * (tension[top] - tension[0]);
        let time = if tension[top] > 0.0 { falls(tension, top, level) } else { f64::NAN };
        time - EACH_MS * top as f64
    };
    Beat {
        apd90_ms: falls(v, peak, v[peak] - 0.9 * (v[peak] - v[0])),
        calcium: [
            1e6 * calcium.iter().copied().fold(f64::MAX, f64::min),
            1e6 * calcium.iter().copied().fold(0.0, f64::max),
        ],
        calcium_peak_ms: EACH_MS * highest(calcium) as f64,
        tension: tension[top],
        tension_peak_ms: EACH_MS * top as f64,
        relaxation_ms: [relaxed(0.5), relaxed(0.9)],
    }
}

#[test]
#[ignore = "slow"]
fn after_a_hundred_beats_the_cell_without_myofilaments_is_that_of_cvode() {
    if crate::common::left_to_full() {
        return;
    }
    for line in include_str!("../reference/tor_ord_beats.csv").lines().skip(1) {
        let (name, numbers) = line.split_once(',').unwrap();
        let numbers: Vec<f64> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
        let [apd90, _, _, least, most, peak] = numbers[..] else { panic!("{line}") };
        let found = beat(&*model(name), 100, 1000.0);
        // Lines between samples, and our tolerance of 1e-4 over 100 beats.
        assert!((found.apd90_ms - apd90).abs() < 0.1, "{name}: {} ms", found.apd90_ms);
        for (found, expected) in found.calcium.iter().zip([least, most]) {
            assert!((found / expected - 1.0).abs() < 1e-3, "{name}: {found} nM");
        }
        assert!((found.calcium_peak_ms - peak).abs() < 2.0 * EACH_MS, "{name}");
    }
}

#[test]
fn with_myofilaments_a_beat_of_each_layer_is_that_of_an_independent_program() {
    // APD90, calcium, tension, its time, relaxation to 50 and 90 %: to the digits that program printed. Its
    // duration begins where the potential rises most steeply, which it does as the stimulus ends, at 0.9 ms.
    for (name, apd90, calcium, tension, peak, relaxation) in [
        ("tor_ord_land", 271.7, [72.0, 475.0], 24.0, 169.5, [114.5, 224.5]),
        ("tor_ord_land_epi", 239.9, [65.0, 707.0], 42.5, 167.0, [112.0, 216.5]),
        ("tor_ord_land_mid", 343.4, [75.0, 937.0], 61.9, 192.0, [141.0, 252.5]),
    ] {
        // Mid is not quite at rest at its published start.
        let found = beat(&*model(name), if name.ends_with("mid") { 20 } else { 1 }, 1000.0);
        assert!((found.apd90_ms - 0.9 - apd90).abs() < 0.15, "{name}: {} ms", found.apd90_ms);
        for (found, expected) in found.calcium.iter().zip(calcium) {
            // Half of the last digit printed; the peak is sharp, and samples are 0.5 ms apart there.
            let bound = 0.5 + 3e-3 * expected;
            assert!((found - expected).abs() < bound, "{name}: {found} nM");
        }
        assert!((found.tension - tension).abs() < 0.05, "{name}: {} kPa", found.tension);
        assert!((found.tension_peak_ms - peak).abs() <= 0.5, "{name}: {}", found.tension_peak_ms);
        for (found, expected) in found.relaxation_ms.iter().zip(relaxation) {
            // Read off samples of 0.5 ms there.
            assert!((found - expected).abs() < 1.0, "{name}: {found} ms");
        }
    }
}

#[test]
#[ignore = "slow"]
fn blocked_channels_and_other_rates_change_it_as_in_an_independent_program() {
    let published = model("tor_ord_land");
    // Factor on a conductance, APD90, largest calcium, tension; that program looked at the 60th beat.
    let mut sample = crate::common::Sample::one_in(2);
    for (name, factor, apd90, calcium, tension) in
        [("P_Ca", 0.5, 240.3, 229.0, 3.20), ("G_Kr", 0.5, 363.3, 514.0, 28.0)]
    {
        if sample.leaves_out() {
            continue;
        }
        let mut parameters = published.parameters().clone();
        parameters.set(name, factor * parameters.get(name).unwrap()).unwrap();
        let found = beat(&*published.with_parameters(parameters).unwrap(), 60, 1000.0);
        assert!((found.apd90_ms - 0.9 - apd90).abs() < 0.3, "{name}: {} ms", found.apd90_ms);
        assert!((found.calcium[1] / calcium - 1.0).abs() < 5e-3, "{name}: {:?}", found.calcium);
        assert!((found.tension - tension).abs() < 0.06, "{name}: {} kPa", found.tension);
    }
    // Cycle length, APD90, tension, at rest in its rhythm.
    for (cycle_ms, apd90, tension) in [(400.0, 220.4, 32.6), (2000.0, 296.5, 14.6)] {
        if sample.leaves_out() {
            continue;
        }
        let found = beat(&*published, 100, cycle_ms);
        assert!((found.apd90_ms - 0.9 - apd90).abs() < 0.2, "{cycle_ms}: {} ms", found.apd90_ms);
        assert!((found.tension - tension).abs() < 0.06, "{cycle_ms}: {} kPa", found.tension);
    }
}

#[test]
fn the_jacobian_is_that_of_differences_in_every_form() {
    for variant in [Variant::Published, Variant::MovingChloride, Variant::Land] {
        let model = TomekModel::published(Layer::Epi, variant);
        let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
        let trace =
            solve(&model, protocol, SolverSettings::of(CellMethod::Stiff), 400.0, 40.0).unwrap();
        let size = model.states().len();
        for sample in 0..trace.time_ms.len() {
            let mut state: Vec<f64> = trace.states.iter().map(|column| column[sample]).collect();
            if variant == Variant::Land {
                // Off the kinks of their terms.
                state[size - 2..].copy_from_slice(&[0.1, -0.2]);
            }
            let mut jacobian = vec![f64::NAN; size * size];
            let input = Input { stretch: 0.95, stretch_rate: -1e-3, ..Input::REST };
            assert!(model.jacobian(&state, &input, &mut jacobian));
            for column in 0..size {
                let by = 1e-5 * (1e-4 + state[column].abs());
                let moved = |by: f64| {
                    let mut state = state.clone();
                    state[column] += by;
                    rates(&model, &state, &input)
                };
                let (above, below) = (moved(by), moved(-by));
                for row in 0..size {
                    let difference = (above[row] - below[row]) / (2.0 * by);
                    let entry = jacobian[row * size + column];
                    // Rounding of fluxes that cancel over the step, and the third derivative.
                    let bound = 1e-4 * difference.abs() + 1e-13 * (1.0 + above[row].abs()) / by;
                    let names = [row, column].map(|place| model.state_names()[place].to_owned());
                    assert!((entry - difference).abs() < bound, "{names:?} {entry} {difference}");
                }
            }
        }
    }
}

#[test]
fn long_rests_are_outside_of_what_it_is_known_to_get_right() {
    assert_eq!(model("tor_ord_land").longest_rest_ms(), 5000.0);
    assert_eq!(model("coelho_2021").longest_rest_ms(), f64::INFINITY);
}

#[test]
fn in_a_cell_it_feels_its_stretch_and_a_drug_shows_in_calcium_and_shortening() {
    let run = |changes: &[(&str, f64)]| {
        let published = model("tor_ord_land");
        let mut parameters = published.parameters().clone();
        for (name, factor) in changes {
            parameters.set(name, factor * parameters.get(name).unwrap()).unwrap();
        }
        let cell = published.with_parameters(parameters).unwrap();
        let mut simulation = Simulation {
            protocol: Protocol { start_ms: 10.0, ..Protocol::once(cell.default_stimulus()) },
            material: myofilament_material(),
            duration: 500.0,
            ..Simulation::new(lattice::rectangle(20, 4, 5.0).unwrap())
        };
        simulation.numerics.method = Way::QuasiStatic;
        simulation.cell = cell;
        let outcome = simulation.build().unwrap().run(|_| true);
        assert_eq!(outcome.stop, None);
        outcome.recording
    };
    let recording = run(&[]);
    let shortest = |recording: &Recording| {
        recording.samples.iter().map(|sample| sample.shortening_pct).fold(0.0, f64::max)
    };
    // Unloaded human cells by this model: 9 to 11 %, at most 1.2 lengths per s.
    assert!((9.0..11.5).contains(&shortest(&recording)), "{} %", shortest(&recording));
    let lengths = recording.samples.windows(2).map(|pair| {
        (pair[1].shortening_pct - pair[0].shortening_pct) / (pair[1].t_ms - pair[0].t_ms) * 10.0
    });
    let rate = lengths.fold(0.0, f64::max);
    assert!((0.9..1.25).contains(&rate), "{rate} lengths/s");
    let calcium = |recording: &Recording| {
        let signal = recording.signals.iter().find(|signal| signal.name == "Ca_i").unwrap();
        assert_eq!(signal.unit, "uM");
        signal.values.iter().copied().fold(0.0, f64::max)
    };
    // What it feels changes troponin, and with it calcium: 475 nM where it is held.
    assert!((0.47..0.51).contains(&calcium(&recording)), "{} uM", calcium(&recording));
    assert!(recording.signals.iter().any(|signal| signal.name == "x_s1"));
    let blocked = run(&[("P_Ca", 0.5)]);
    assert!(calcium(&blocked) < 0.9 * calcium(&recording));
    assert!(shortest(&blocked) < 0.8 * shortest(&recording));
}
