//! Made-up curves whose delay and loop are known.

use crate::noise::Noise;
use myospring::analysis::curve::Analysis;
use myospring::analysis::curve::{CurveOptions, analyse};
use myospring::analysis::kind::Kind;
use myospring::analysis::paired::{Direction, PairError, Paired, Recorded, pair};
use myospring::analysis::{reading, value};

/// A curve of beats: onsets, ms; and frames a second, first and last time, ms, and noise as a part of a beat.
#[derive(Clone, Copy)]
struct Made<'a> {
    onsets: &'a [f64],
    rate: f64,
    span: [f64; 2],
    noise: f64,
}

const ONSETS: [f64; 6] = [300.0, 1300.0, 2300.0, 3300.0, 4300.0, 5300.0];
const USUAL: Made = Made { onsets: &ONSETS, rate: 250.0, span: [0.0, 6500.0], noise: 0.0 };

/// Sine squared of 300 ms; no two pulses overlap.
fn height(onsets: &[f64], t: f64) -> f64 {
    let pulse = |t: f64| {
        if (0.0..300.0).contains(&t) {
            (std::f64::consts::PI * t / 300.0).sin().powi(2)
        } else {
            0.0
        }
    };
    onsets.iter().map(|onset| pulse(t - onset)).sum()
}

/// A curve of a kind and its beats.
struct Read {
    times: Vec<f64>,
    kind: Kind,
    unit: &'static str,
    analysis: Analysis,
}

impl Read {
    fn of(made: Made, kind: Kind, lag: f64, seed: u64) -> Self {
        let step = 1e3 / made.rate;
        let count = ((made.span[1] - made.span[0]) / step) as usize;
        let times: Vec<f64> = (0..count).map(|at| made.span[0] + step * at as f64).collect();
        let mut random = Noise::new(seed);
        let height = |t: f64| height(made.onsets, t - lag) + made.noise * random.normal();
        let (unit, rest, by) = match kind {
            Kind::Calcium => ("uM", 0.1, 0.5),
            Kind::CalciumRatio => ("", 1.0, 0.5),
            Kind::Tension => ("kPa", 1.0, 20.0),
            _ => ("um", 100.0, -10.0),
        };
        let values: Vec<f64> =
            times.iter().copied().map(height).map(|height| rest + by * height).collect();
        let analysis = analyse(&times, &values, kind, unit, &CurveOptions::default())
            .unwrap_or_else(|error| panic!("{error}"));
        Self { times, kind, unit, analysis }
    }

    fn recorded(&self) -> Recorded<'_> {
        let Self { times, kind, unit, analysis } = self;
        Recorded { times_ms: times, kind: *kind, unit, analysis }
    }

    fn with(&self, other: &Self) -> Result<Paired, PairError> {
        pair(&self.recorded(), &other.recorded())
    }
}

#[test]
fn a_known_delay_and_loop_come_out_over_a_grid_of_rates_and_noise() {
    for rate in [30.0, 100.0, 250.0, 1000.0] {
        for noise in [0.0, 0.01, 0.1] {
            for lag in [-20.0, 15.0, 60.0] {
                let made = Made { rate, noise, ..USUAL };
                let calcium = Read::of(made, Kind::Calcium, 0.0, 5);
                let length = Read::of(made, Kind::Length, lag, 9);
                let paired = calcium.with(&length).unwrap();
                let place = format!("{rate} /s, noise {noise}, lag {lag} ms");
                assert_eq!(paired.beats.len(), 6, "{place}");
                // Both pulses have one shape, so that onset, half and peak come with the same delay. A hundredth of a frame, and
                // of noise at half of the rise (whose slope is 1 in 95 ms) three standard deviations of a mean of six beats
                // without smoothing.
                let error = (paired.mean("delay_of_half_rise").unwrap() - lag).abs();
                let frame = 1e3 / rate;
                let least = 0.12 * frame + 3.0 * 95.0 * noise * (2.0_f64 / 6.0).sqrt();
                assert!(error < least, "{place}: {error}");
                let onset = (paired.mean("delay_of_onset").unwrap() - lag).abs();
                assert!(onset < 0.3 * frame + 3.0 * 150.0 * noise, "{place}: {onset}");
                // Of two equal pulses u(t), u(t - lag): the area is that of sine squared against itself.
                let expected = relative_area(lag);
                let area = paired.mean("relative_loop_area").unwrap();
                assert!(
                    (area - expected).abs() < 1.0 + 0.02 * frame + 100.0 * noise,
                    "{place}: {area} of {expected}"
                );
                let turns = match paired.direction {
                    Direction::CounterClockwise => 1.0,
                    Direction::Clockwise => -1.0,
                    Direction::Unknown => 0.0,
                };
                assert!(turns * lag > 0.0 || noise > 0.05 && turns == 0.0, "{place}: {turns}");
            }
        }
    }
}

/// Area of the loop of two pulses of one shape, % of their amplitudes.
fn relative_area(lag: f64) -> f64 {
    let at = |i: i32| [height(&[300.0], f64::from(i)), height(&[300.0], f64::from(i) - lag)];
    let turn = |i: i32| {
        let ([x, y], [next_x, next_y]) = (at(i), at(i + 1));
        50.0 * (x * next_y - next_x * y)
    };
    (0..1000).map(turn).sum()
}

#[test]
fn calcium_at_half_of_the_shortening_is_read_on_both_sides() {
    let calcium = Read::of(USUAL, Kind::Calcium, 0.0, 1);
    let tension = Read::of(USUAL, Kind::Tension, 30.0, 1);
    let paired = calcium.with(&tension).unwrap();
    // Half of the pulse is passed 75 and 225 ms after its onset, here 105 and 255 ms after that of calcium.
    for (name, at) in [("calcium_at_half_rise", 105.0), ("calcium_at_half_fall", 255.0)] {
        let expected = 0.1 + 0.5 * height(&[0.0], at);
        let mean = paired.mean(name).unwrap();
        assert!((mean - expected).abs() < 1e-3, "{name}: {mean} of {expected}");
        let relative = paired.mean(&format!("relative_{name}")).unwrap();
        assert!((relative - 200.0 * (expected - 0.1)).abs() < 0.2, "{name}: {relative} %");
    }
    let metrics = &paired.beats[1].metrics;
    let unit = metrics.iter().find(|metric| metric.name == "loop_area").unwrap().unit;
    assert_eq!(unit, "uM kPa");
    let mean = paired.mean_loop.as_ref().unwrap();
    let area = 0.5 * 20.0 * 0.01 * relative_area(30.0);
    assert!((mean.area() - area).abs() < 0.01 * area, "{} of {area}", mean.area());
}

#[test]
fn other_rates_a_late_start_and_beats_of_one_curve_only_are_paired_right() {
    let calcium = Read::of(USUAL, Kind::Calcium, 0.0, 1);
    let slow = Made { rate: 60.0, ..USUAL };
    let late = Made { span: [1800.0, 6100.0], ..USUAL };
    let fewer = Made { onsets: &[300.0, 1300.0, 3300.0, 4300.0, 5300.0], ..USUAL };
    for (made, both, alone) in [(slow, 6, 0), (late, 4, 0), (fewer, 5, 1)] {
        let paired = calcium.with(&Read::of(made, Kind::Length, 20.0, 2)).unwrap();
        let counted = paired.beats.iter().filter(|beat| beat.counts).count();
        assert_eq!((counted, paired.beats.len() - counted), (both, alone), "{:?}", paired.beats);
        let delay = paired.mean("delay_of_half_rise").unwrap();
        assert!((delay - 20.0).abs() < 1.0, "{delay}");
        let said = paired
            .remarks
            .iter()
            .any(|remark| remark.contains("1 of 6 beats: found in calcium only"));
        assert_eq!(said, alone == 1, "{:?}", paired.remarks);
    }
}

#[test]
fn a_beat_with_missing_frames_has_a_reason_instead_of_numbers() {
    let calcium = Read::of(USUAL, Kind::Calcium, 0.0, 1);
    let mut times = calcium.times.clone();
    times.retain(|t| !(2350.0..2450.0).contains(t));
    let values: Vec<f64> = times.iter().map(|t| 100.0 - 10.0 * height(&ONSETS, t - 20.0)).collect();
    let options = CurveOptions::default();
    let analysis = analyse(&times, &values, Kind::Length, "um", &options).unwrap();
    let torn = Read { times, kind: Kind::Length, unit: "um", analysis };
    let paired = calcium.with(&torn).unwrap();
    let counts: Vec<bool> = paired.beats.iter().map(|beat| beat.counts).collect();
    assert_eq!(counts, [true, true, false, true, true, true]);
    let third = &paired.beats[2];
    assert_eq!(reading(&third.metrics, "delay_of_onset"), Err(myospring::analysis::Missing::Hole));
    assert!(third.remark.contains("with missing frames"), "{}", third.remark);
    assert!(value(&paired.beats[1].metrics, "delay_of_onset").is_some());
}

#[test]
fn curves_that_were_not_recorded_together_are_refused_or_doubted() {
    let calcium = Read::of(USUAL, Kind::Calcium, 0.0, 1);
    let apart = Made { onsets: &[9300.0, 10300.0], span: [9000.0, 11_500.0], ..USUAL };
    let error = calcium.with(&Read::of(apart, Kind::Length, 0.0, 1)).unwrap_err().to_string();
    assert!(error.contains("do not overlap: calcium was recorded from 0 to 6496 ms"), "{error}");
    let faster: Vec<f64> = (0..15).map(|beat| 200.0 + 410.0 * f64::from(beat)).collect();
    let other = Made { onsets: &faster, ..USUAL };
    let error = calcium.with(&Read::of(other, Kind::Length, 0.0, 1)).unwrap_err().to_string();
    assert!(error.contains("calcium has 6 beats and the other curve 15"), "{error}");
    let length = Read::of(USUAL, Kind::Length, 20.0, 1);
    assert!(matches!(length.with(&calcium), Err(PairError::Kind(Kind::Length))));
    // Nearly the same rhythm: delays drift from beat to beat.
    let drifting: Vec<f64> = (0..6).map(|beat| 100.0 + 1120.0 * f64::from(beat)).collect();
    let other = Made { onsets: &drifting, ..USUAL };
    let paired = calcium.with(&Read::of(other, Kind::Length, 0.0, 1)).unwrap();
    let doubt = |remark: &String| remark.contains("check that both curves were recorded together");
    assert!(paired.remarks.iter().any(doubt), "{:?}", paired.remarks);
    let early = calcium.with(&Read::of(USUAL, Kind::Length, -40.0, 1)).unwrap();
    let clock = |remark: &String| remark.contains("have one clock");
    assert!(early.remarks.iter().any(clock), "{:?}", early.remarks);
}

#[test]
fn a_dye_without_calibration_is_not_called_a_concentration() {
    let ratio = Read::of(USUAL, Kind::CalciumRatio, 0.0, 1);
    let paired = ratio.with(&Read::of(USUAL, Kind::Length, 20.0, 1)).unwrap();
    assert!(
        paired.remarks[0].contains("calcium ratio without calibration"),
        "{:?}",
        paired.remarks
    );
    let level = paired.beats[0].metrics.iter().find(|metric| metric.name == "calcium_at_half_rise");
    assert_eq!(level.unwrap().unit, "");
}
