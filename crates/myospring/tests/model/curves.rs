//! Curves of closed form: what is known of them is measured.

mod crowded;
mod doubt;
mod grid;
mod unread;

use crate::noise::Noise;
use myospring::analysis::curve::{Analysis, CurveOptions, State, analyse};
use myospring::analysis::kind::Kind;
use std::f64::consts::PI;

/// Times at a frame rate.
fn frames(rate: f64, seconds: f64) -> Vec<f64> {
    (0..(rate * seconds) as usize).map(|i| i as f64 * 1e3 / rate).collect()
}

/// Triangle of height 1: up in 100 ms, down in 200.
fn triangle(t: f64) -> f64 {
    (t / 100.0).min((300.0 - t) / 200.0).max(0.0)
}

/// Half a sine of 300 ms.
fn half_sine(t: f64) -> f64 {
    if (0.0..300.0).contains(&t) { (PI * t / 300.0).sin() } else { 0.0 }
}

/// Up in a line of 50 ms, down with 80.
fn exponential(t: f64) -> f64 {
    match t {
        t if t < 0.0 => 0.0,
        t if t < 50.0 => t / 50.0,
        t => (-(t - 50.0) / 80.0).exp(),
    }
}

/// A beat each second from 250 ms on.
fn each_second(times: &[f64], pulse: fn(f64) -> f64) -> Vec<f64> {
    times.iter().map(|t| pulse((t - 250.0).rem_euclid(1000.0))).collect()
}

fn check(name: &str, analysis: &Analysis, metric: &str, expected: f64) {
    for beat in &analysis.beats {
        let value = myospring::analysis::value(&beat.metrics, metric)
            .unwrap_or_else(|| panic!("{name}: beat {} has no {metric}", beat.number));
        let error = (value - expected).abs() / expected.abs();
        assert!(error <= 1e-3, "{name}, {metric}: {value}, not {expected}");
    }
}

/// A shape of beats of which everything is known: times in ms, slopes per s.
struct Form {
    name: &'static str,
    pulse: fn(f64) -> f64,
    peak: f64,
    rise: f64,
    half: f64,
    ninety: f64,
    duration: f64,
    /// Where the line through 10 % and 50 % meets the rest.
    onset: f64,
    area: f64,
    steepest: f64,
}

fn forms() -> [Form; 3] {
    let sine = |part: f64| 300.0 / PI * part.asin();
    [
        Form {
            name: "triangle",
            pulse: triangle,
            peak: 100.0,
            rise: 80.0,
            half: 100.0,
            ninety: 180.0,
            duration: 150.0,
            onset: 0.0,
            area: 150.0,
            steepest: 10.0,
        },
        Form {
            name: "half sine",
            pulse: half_sine,
            peak: 150.0,
            rise: sine(0.9) - sine(0.1),
            half: 150.0 - sine(0.5),
            ninety: 150.0 - sine(0.1),
            duration: 300.0 - 2.0 * sine(0.5),
            onset: sine(0.1) - 0.25 * (sine(0.5) - sine(0.1)),
            area: 600.0 / PI,
            steepest: PI / 0.3,
        },
        Form {
            name: "exponential",
            pulse: exponential,
            peak: 50.0,
            rise: 40.0,
            half: 80.0 * 2.0_f64.ln(),
            ninety: 80.0 * 10.0_f64.ln(),
            duration: 25.0 + 80.0 * 2.0_f64.ln(),
            onset: 0.0,
            area: 105.0,
            steepest: 20.0,
        },
    ]
}

#[test]
fn closed_forms_have_their_known_answers_within_a_thousandth_in_every_kind() {
    let times = frames(1000.0, 5.0);
    for Form { name, pulse, peak, rise, half, ninety, duration, onset, area, steepest } in forms() {
        let shape = each_second(&times, pulse);
        let of = |kind, unit, level: f64, height: f64| {
            let values: Vec<f64> = shape.iter().map(|part| level + height * part).collect();
            analyse(&times, &values, kind, unit, &CurveOptions::default())
                .unwrap_or_else(|error| panic!("{name}: {error}"))
        };
        let length = of(Kind::Length, "um", 120.0, -12.0);
        assert_eq!(length.beats.len(), 5, "{name}");
        assert_eq!(length.treatment.smoothing, "none");
        for (metric, expected) in [
            ("resting_length", 120.0),
            ("minimum_length", 108.0),
            ("peak_shortening", 10.0),
            ("time_to_peak_from_onset", peak - onset),
            ("rise_time_10_90", rise),
            ("relaxation_time_50", half),
            ("relaxation_time_90", ninety),
            ("contraction_duration_50", duration),
            ("maximum_shortening_rate", 0.1 * steepest),
            ("maximum_shortening_velocity", 12.0 * steepest),
            ("area_under_curve", 10.0 * area),
        ] {
            check(name, &length, metric, expected);
        }
        let motion = of(Kind::Contraction, "a.u.", 50.0, 400.0);
        check(name, &motion, "peak_amplitude", 400.0);
        check(name, &motion, "maximum_contraction_rate", 400.0 * steepest);
        let tension = of(Kind::Tension, "kPa", 2.0, 20.0);
        check(name, &tension, "developed_tension", 20.0);
        check(name, &tension, "tension_relaxation_time_50", half);
        check(name, &tension, "twitch_duration_50", duration);
        check(name, &tension, "tension_time_integral", 20.0 * area);
        let calcium = of(Kind::CalciumRatio, "", 0.8, 0.6);
        check(name, &calcium, "diastolic_level", 0.8);
        check(name, &calcium, "amplitude_over_rest", 0.75);
        check(name, &calcium, "decay_time_90", ninety);
        let potential = of(Kind::Potential, "mV", -85.0, 120.0);
        check(name, &potential, "resting_potential", -85.0);
        check(name, &potential, "action_potential_amplitude", 120.0);
        let steep = potential.mean("time_of_upstroke").unwrap();
        assert!(steep.is_finite());
        let spread = length.spread();
        let interval = spread.iter().find(|spread| spread.name == "interval").unwrap();
        assert!((interval.mean - 1000.0).abs() < 0.1 && interval.standard_deviation < 0.1);
    }
    let values: Vec<f64> =
        each_second(&times, exponential).iter().map(|h| 120.0 - 12.0 * h).collect();
    let analysis = analyse(&times, &values, Kind::Length, "um", &CurveOptions::default()).unwrap();
    check("exponential", &analysis, "relaxation_time_constant", 80.0);
}

#[test]
fn a_line_of_drift_is_taken_off_and_a_bleaching_one_nearly() {
    let times = frames(1000.0, 8.0);
    let shape = each_second(&times, triangle);
    let line: Vec<f64> =
        times.iter().zip(&shape).map(|(t, h)| 100.0 + 0.002 * t + 10.0 * h).collect();
    let analysis =
        analyse(&times, &line, Kind::Contraction, "a.u.", &CurveOptions::default()).unwrap();
    for (metric, expected) in
        [("peak_amplitude", 10.0), ("relaxation_time_90", 180.0), ("area_under_curve", 1500.0)]
    {
        check("line", &analysis, metric, expected);
    }
    let kept = CurveOptions { keep_drift: true, ..CurveOptions::default() };
    let analysis = analyse(&times, &line, Kind::Contraction, "a.u.", &kept).unwrap();
    assert!(analysis.mean("area_under_curve").unwrap() > 2000.0);
    // Half of the light is gone in 5 s.
    let bleached: Vec<f64> =
        times.iter().zip(&shape).map(|(t, h)| (-t / 7200.0).exp() * (1.0 + 0.5 * h)).collect();
    let analysis =
        analyse(&times, &bleached, Kind::Fluorescence, "a.u.", &CurveOptions::default()).unwrap();
    for beat in &analysis.beats {
        let over = myospring::analysis::value(&beat.metrics, "amplitude_over_rest").unwrap();
        assert!((over - 0.5).abs() < 0.01, "{over}");
    }
}

#[test]
fn stimuli_give_the_beats_and_name_those_that_are_missed() {
    let times = frames(500.0, 6.0);
    let shape = each_second(&times, triangle);
    let values: Vec<f64> = times
        .iter()
        .zip(&shape)
        .map(|(t, h)| if (3000.0..4000.0).contains(t) { 100.0 } else { 100.0 - 8.0 * h })
        .collect();
    let stimuli_ms = (0..6).map(|i| 200.0 + 1000.0 * f64::from(i)).collect();
    let options = CurveOptions { stimuli_ms, ..CurveOptions::default() };
    let analysis = analyse(&times, &values, Kind::Length, "um", &options).unwrap();
    let states: Vec<State> = analysis.beats.iter().map(|beat| beat.state).collect();
    let words: Vec<&str> = states.into_iter().map(State::words).collect();
    assert_eq!(words, ["whole", "whole", "whole", "missed", "whole", "whole"]);
    assert!(analysis.remarks[0].contains("1 of 6 stimuli"), "{:?}", analysis.remarks);
    let counted: Vec<f64> = analysis
        .counted()
        .iter()
        .map(|beat| myospring::analysis::value(beat, "time_to_peak_from_stimulus").unwrap())
        .collect();
    assert!(counted.iter().all(|time| (time - 150.0).abs() < 0.3), "{counted:?}");
    // Without stimuli the gap is seen by its length.
    let analysis = analyse(&times, &values, Kind::Length, "um", &CurveOptions::default()).unwrap();
    assert_eq!(analysis.beats.len(), 5);
    assert!(analysis.remarks[0].contains("1 beat missing"), "{:?}", analysis.remarks);
    let late = CurveOptions { stimuli_ms: vec![9000.0], ..CurveOptions::default() };
    let error = analyse(&times, &values, Kind::Length, "um", &late).unwrap_err().to_string();
    assert!(
        error.contains("none of 1 stimuli falls into the recording, from 0 to 5998 ms"),
        "{error}"
    );
}

/// A spontaneous beat, a fifth higher, follows each paced one.
#[test]
fn the_first_beat_answers_a_stimulus_though_a_later_one_is_higher() {
    let times = frames(500.0, 6.0);
    let paced = each_second(&times, half_sine);
    let values: Vec<f64> = (times.iter().zip(paced))
        .map(|(t, h)| 100.0 - 8.0 * h - 9.6 * half_sine((t - 750.0).rem_euclid(1000.0)))
        .collect();
    let stimuli_ms = (0..6).map(|i| 200.0 + 1000.0 * f64::from(i)).collect();
    let options = CurveOptions { stimuli_ms, ..CurveOptions::default() };
    let analysis = analyse(&times, &values, Kind::Length, "um", &options).unwrap();
    assert_eq!(analysis.beats.len(), 6);
    for beat in &analysis.beats {
        let time = myospring::analysis::value(&beat.metrics, "time_to_peak_from_stimulus").unwrap();
        assert!((time - 200.0).abs() < 1.0, "{}: {time}", beat.number);
        let said = beat.remarks.join("; ");
        assert!(said.contains("2 beats follow"), "{}: {said}", beat.number);
    }
}

/// Drift makes rests as wide and as high as beats, and a dip hides which way beats go.
#[test]
fn the_way_that_takes_least_of_a_curve_for_artefacts_is_that_of_its_beats() {
    let times = frames(60.0, 10.0);
    for sign in [1.0, -1.0] {
        let mut random = Noise::new(4);
        let values: Vec<f64> = times
            .iter()
            .map(|t| {
                let dip = 0.5 * (-((t - 2550.0) / 40.0).powi(2)).exp();
                let beats = half_sine((t - 800.0).rem_euclid(1900.0) / 1.5);
                let drift = 0.7 * (t / 1e4).powi(2);
                sign * (beats + drift - dip + 0.015 * random.normal())
            })
            .collect();
        let found = analyse(&times, &values, Kind::Unknown, "", &CurveOptions::default()).unwrap();
        assert_eq!(found.treatment.rises, sign > 0.0, "{sign}");
        assert_eq!(found.beats.len(), 5, "{sign}: {:?}", found.remarks);
    }
}

/// The third of five beats lasts longer.
#[test]
fn a_beat_of_twice_the_area_of_few_others_is_named_and_counts_in_no_mean() {
    let times = frames(60.0, 10.0);
    for (area, odd) in [(1.0, 0), (1.4, 0), (2.2, 1)] {
        let values: Vec<f64> = times
            .iter()
            .map(|t| {
                let beat = (t / 2000.0).floor();
                let t = t - 2000.0 * beat;
                if beat == 2.0 { half_sine((t - 800.0) / area) } else { half_sine(t - 800.0) }
            })
            .collect();
        let found = analyse(&times, &values, Kind::Unknown, "", &CurveOptions::default()).unwrap();
        assert_eq!(found.beats.len(), 5);
        let unlike = found.beats.iter().filter(|beat| beat.state == State::Disturbed).count();
        assert_eq!(unlike, odd, "{area}: {:?}", found.remarks);
        let said = found.remarks.iter().any(|remark| remark.contains("whether it is a beat"));
        assert_eq!(said, odd == 1, "{area}: {:?}", found.remarks);
    }
}

#[test]
fn alternans_early_beats_and_irregular_ones_are_named() {
    let times = frames(250.0, 10.0);
    let noisy = |height: &dyn Fn(f64) -> f64| {
        let mut random = Noise::new(3);
        let values = times.iter().map(|t| height(*t) + 0.02 * random.normal());
        let values: Vec<f64> = values.collect();
        analyse(&times, &values, Kind::Contraction, "a.u.", &CurveOptions::default()).unwrap()
    };
    let place = |t: f64| ((t - 250.0) / 1000.0).floor();
    let alternans = noisy(&|t| {
        let high = place(t).rem_euclid(2.0) == 0.0;
        half_sine((t - 250.0).rem_euclid(1000.0)) * if high { 1.0 } else { 0.7 }
    });
    let said = alternans.remarks.join("; ");
    assert!(
        said.contains("alternans") && (said.contains(" 30.") || said.contains(" 29.")),
        "{said}"
    );
    let regular = noisy(&|t| half_sine((t - 250.0).rem_euclid(1000.0)));
    assert_eq!(regular.remarks, Vec::<String>::new());
    let early = noisy(&|t| {
        let t = if t > 5000.0 { t + 400.0 } else { t };
        half_sine((t - 250.0).rem_euclid(1000.0))
    });
    assert!(early.remarks.iter().any(|r| r.contains("1 early beat")), "{:?}", early.remarks);
}

#[test]
fn recordings_that_begin_or_end_within_a_beat_say_so_and_keep_the_rest() {
    let times = frames(500.0, 3.5);
    let shape = |t: f64| half_sine((t + 150.0).rem_euclid(1000.0));
    let values: Vec<f64> = times.iter().map(|t| 100.0 - 10.0 * shape(*t)).collect();
    // Begins at a peak, ends 50 ms before one is over.
    let last = times.partition_point(|time| *time < 3100.0);
    let analysis =
        analyse(&times[..last], &values[..last], Kind::Length, "um", &CurveOptions::default())
            .unwrap();
    let states: Vec<State> = analysis.beats.iter().map(|beat| beat.state).collect();
    assert_eq!(states, [State::Whole, State::Whole, State::CutAtEnd]);
    assert!((analysis.mean("peak_shortening").unwrap() - 10.0).abs() < 0.01);
    // Begins 50 ms before its peak.
    let first = times.partition_point(|time| *time < 900.0);
    let (times, values) = (&times[first..last], &values[first..last]);
    let analysis = analyse(times, values, Kind::Length, "um", &CurveOptions::default()).unwrap();
    assert_eq!(analysis.beats[0].state, State::CutAtStart);
    assert!((analysis.mean("peak_shortening").unwrap() - 10.0).abs() < 0.01);
}

#[test]
fn bad_frames_hum_and_curves_upside_down_are_seen() {
    let times = frames(500.0, 5.0);
    let mut random = Noise::new(5);
    let mut values: Vec<f64> = each_second(&times, half_sine)
        .iter()
        .zip(&times)
        .map(|(h, t)| 100.0 - 10.0 * h + 0.1 * random.normal() + 0.5 * (2.0 * PI * 0.05 * t).sin())
        .collect();
    values[700] = 140.0;
    values[1500] = 60.0;
    let analysis = analyse(&times, &values, Kind::Length, "um", &CurveOptions::default()).unwrap();
    assert_eq!(analysis.treatment.bad_frames, [701, 1501]);
    assert!((analysis.treatment.hum.unwrap()[1] - 0.5).abs() < 0.05);
    assert_eq!(analysis.beats.len(), 5);
    assert!((analysis.mean("peak_shortening").unwrap() - 10.0).abs() < 0.1);
    let unknown =
        analyse(&times, &values, Kind::Unknown, "a.u.", &CurveOptions::default()).unwrap();
    assert!(!unknown.treatment.rises);
    let wrong = analyse(&times, &values, Kind::Contraction, "a.u.", &CurveOptions::default());
    let said = match wrong {
        Ok(analysis) => analysis.remarks.join("; "),
        Err(error) => error.to_string(),
    };
    assert!(said.contains("is its kind right?"), "{said}");
}

#[test]
fn curves_without_a_beat_say_why() {
    let times = frames(50.0, 10.0);
    let of = |values: &[f64]| {
        analyse(&times[..values.len()], values, Kind::Length, "um", &CurveOptions::default())
            .map_or_else(
                |error| error.to_string(),
                |analysis| panic!("{} beats", analysis.beats.len()),
            )
    };
    assert!(of(&[100.0, 99.0]).contains("2 frames; a beat needs at least 8"));
    assert!(of(&[100.0; 50]).contains("all 50 values are 100"));
    let mut random = Noise::new(11);
    let noise: Vec<f64> = times.iter().map(|_| 100.0 + random.normal()).collect();
    assert!(of(&noise).contains("there is no beat: nothing rises above the noise"));
    // Noise has no way that could be wrong.
    for seed in 0..20 {
        let mut random = Noise::new(seed);
        let noise: Vec<f64> = times.iter().map(|_| 100.0 + random.normal()).collect();
        assert!(!of(&noise).contains("is its kind right"), "{seed}");
    }
    let mut nan = noise.clone();
    nan[7] = f64::NAN;
    assert!(of(&nan).contains("frame 8: time 140 ms, value NaN"));
    // 250 frames a second said to be 30000.
    let fast: Vec<f64> = frames(250.0, 10.0).iter().map(|t| t / 120.0).collect();
    let beats: Vec<f64> =
        frames(250.0, 10.0).iter().map(|t| half_sine((t - 250.0).rem_euclid(1000.0))).collect();
    let analysis =
        analyse(&fast, &beats, Kind::Contraction, "a.u.", &CurveOptions::default()).unwrap();
    assert!(analysis.remarks.iter().any(|remark| remark.contains("is the frame rate")));
}

/// Spontaneous action potentials each 800 ms: a slow foot from -70 to -50 mV, a logistic upstroke to 30 mV whose largest slope
/// is 5 mV/ms, a plateau and a fall to -70 mV.
fn spontaneous(t: f64) -> f64 {
    let t = t.rem_euclid(800.0);
    let foot = -70.0 + 20.0 * (t / 600.0).min(1.0);
    let rise = 80.0 / (1.0 + (-(t - 600.0) / 4.0).exp());
    let fall = 100.0 / (1.0 + (-(t - 740.0) / 8.0).exp());
    foot + rise - fall
}

#[test]
fn upstrokes_of_spontaneous_cells_have_their_slope_diastolic_potential_and_cycle_length() {
    for (rate, noise) in [(1000.0, 0.0), (10_000.0, 0.1), (10_000.0, 0.5), (25_000.0, 0.3)] {
        let times = frames(rate, 3.0);
        let mut random = Noise::new(rate as u64);
        let values: Vec<f64> =
            times.iter().map(|t| spontaneous(*t) + noise * random.normal()).collect();
        let found =
            analyse(&times, &values, Kind::Potential, "mV", &CurveOptions::default()).unwrap();
        let name = format!("{rate} /s, noise {noise} mV: {:?}", found.treatment.rates);
        assert!(found.beats.len() >= 3, "{name}");
        let mean = |metric: &str| found.mean(metric).unwrap_or_else(|| panic!("{name}: {metric}"));
        // 80 / (4 * 4 ms) and the foot's 1/30 mV/ms at most.
        let slope = mean("maximum_upstroke_velocity");
        assert!((slope / 5.0 - 1.0).abs() < 0.03, "{name}: {slope} mV/ms");
        assert!(mean("upstroke_window") < 12.0, "{name}");
        let cycle = mean("cycle_length");
        assert!((cycle - 800.0).abs() < 0.5, "{name}: {cycle} ms");
        let lowest = mean("maximum_diastolic_potential");
        assert!((lowest + 70.0).abs() < 1.0, "{name}: {lowest} mV");
    }
    // Stimuli make them unnecessary.
    let times = frames(1000.0, 3.0);
    let values: Vec<f64> = times.iter().map(|t| spontaneous(*t)).collect();
    let options = CurveOptions { stimuli_ms: vec![590.0, 1390.0], ..CurveOptions::default() };
    let paced = analyse(&times, &values, Kind::Potential, "mV", &options).unwrap();
    assert_eq!(paced.mean("cycle_length"), None);
}

#[test]
fn an_upstroke_that_the_sampling_is_too_slow_for_is_said() {
    let times = frames(200.0, 3.0);
    let values: Vec<f64> = times
        .iter()
        .map(|t| if t.rem_euclid(1000.0) < 300.0 { 30.0 } else { -80.0 } + 0.001 * (t % 7.0))
        .collect();
    let found = analyse(&times, &values, Kind::Potential, "mV", &CurveOptions::default()).unwrap();
    let said = found.remarks.join(" ");
    assert!(said.contains("at least the given value; record at 2 kHz"), "{said}");
}
