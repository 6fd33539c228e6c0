//! Beats among artefacts: a grid over their direction, length, height and number, over kinds of curves and recordings.

use super::{half_sine, triangle};
use crate::noise::Noise;
use myospring::analysis::curve::{Analysis, Artefact, CurveOptions, State, analyse};
use myospring::analysis::kind::Kind;
use std::f64::consts::PI;

/// Pulses of height 1, of a time in ms since the onset.
fn contraction(t: f64) -> f64 {
    match t {
        t if t <= 0.0 => 0.0,
        t if t < 120.0 => 0.5 - 0.5 * (PI * t / 120.0).cos(),
        t => (-((t - 120.0) / 110.0).powi(2)).exp().max((-(t - 120.0) / 90.0).exp() * 0.8),
    }
}
fn transient(t: f64) -> f64 {
    match t {
        t if t <= 0.0 => 0.0,
        t if t < 40.0 => t / 40.0,
        t => (-(t - 40.0) / 150.0).exp(),
    }
}
/// With a spike of two to three ms and a notch.
fn potential(t: f64) -> f64 {
    match t {
        t if t <= 0.0 => 0.0,
        t if t < 1.5 => t / 1.5,
        t if t < 6.0 => 1.0 - 0.3 * (t - 1.5) / 4.5,
        t if t < 40.0 => 0.7 + 0.12 * (1.0 - (-(t - 6.0) / 10.0).exp()),
        t if t < 280.0 => 0.816 - 0.25 * ((t - 40.0) / 240.0).powi(2),
        t => 0.566 * (-(t - 280.0) / 25.0).exp(),
    }
}

pub(super) struct Recording {
    pub(super) times: Vec<f64>,
    pub(super) clean: Vec<f64>,
    pub(super) onsets: Vec<f64>,
}

pub(super) fn recording(rate: f64, beats: usize, cycle: f64, pulse: fn(f64) -> f64) -> Recording {
    let seconds = (beats as f64 * cycle + 0.3 * cycle) / 1e3;
    let times: Vec<f64> = (0..(rate * seconds) as usize).map(|i| i as f64 * 1e3 / rate).collect();
    let onsets: Vec<f64> = (0..beats).map(|beat| 0.25 * cycle + cycle * beat as f64).collect();
    let clean = times.iter().map(|t| onsets.iter().map(|o| pulse(t - o)).fold(0.0, f64::max));
    let clean = clean.collect();
    Recording { times, clean, onsets }
}

/// Artefacts that are laid over a recording.
pub(super) struct Faults {
    /// Up or down in the direction of a beat.
    pub(super) direction: f64,
    pub(super) frames: usize,
    /// In beats.
    pub(super) height: f64,
    pub(super) count: usize,
    /// Half sines instead of boxes.
    pub(super) smooth: bool,
}

impl Faults {
    /// Lays them over a curve, each in its share of it, and returns their first and last times.
    pub(super) fn lay(
        &self,
        times: &[f64],
        signal: &mut [f64],
        random: &mut Noise,
    ) -> Vec<[f64; 2]> {
        let share = times.len() as f64 / self.count as f64;
        let mut places = Vec::new();
        for number in 0..self.count {
            let part = (random.normal() * 7.77).rem_euclid(1.0);
            let last = times.len() - self.frames - 4;
            let at = (((number as f64 + part) * share) as usize).clamp(3, last);
            for frame in 0..self.frames {
                let place = (frame + 1) as f64 / (self.frames + 1) as f64;
                let shape = if self.smooth { (PI * place).sin() } else { 1.0 };
                signal[at + frame] += self.direction * self.height * shape;
            }
            places.push([times[at], times[at + self.frames - 1]]);
        }
        places
    }
}

/// Level and height of a beat, in the direction that the kind has.
pub(super) fn scale(kind: Kind) -> [f64; 2] {
    match kind {
        Kind::Length | Kind::SarcomereLength => [120.0, -12.0],
        Kind::Potential => [-80.0, 110.0],
        Kind::CalciumRatio => [0.8, 0.6],
        Kind::Unknown => [3.0, -1.0],
        _ => [5.0, 20.0],
    }
}

pub(super) fn tops(analysis: &Analysis) -> Vec<f64> {
    analysis
        .beats
        .iter()
        .filter_map(|beat| beat.marks.iter().find(|mark| mark.name == "peak"))
        .map(|mark| mark.point.time)
        .collect()
}

/// Height over the time since its onset, ms.
pub(super) type Shape = fn(f64) -> f64;

pub(super) const SHAPES: [(Kind, Shape); 7] = [
    (Kind::Length, contraction),
    (Kind::SarcomereLength, half_sine),
    (Kind::Contraction, half_sine),
    (Kind::Tension, triangle),
    (Kind::CalciumRatio, transient),
    (Kind::Potential, potential),
    (Kind::Unknown, contraction),
];

#[test]
#[ignore = "slow"]
fn artefacts_cost_at_most_the_beats_that_they_touch() {
    let (mut cells, mut lost, mut untouched, mut invented, mut listed, mut all) =
        (0, 0, 0, 0, 0, 0);
    let mut worst: Vec<String> = Vec::new();
    let mut turn = 0;
    for (kind, pulse) in SHAPES {
        for (rate, beats) in [(60.0, 1), (60.0, 25), (250.0, 4), (250.0, 40)] {
            let recording = recording(rate, beats, 1000.0, pulse);
            for frames in [1, 2, 3, 5, 10, 20, 30] {
                for height in [0.5, 1.0, 3.0, 20.0] {
                    for count in [1, 3, 20] {
                        turn += 1;
                        // A third of a beat of 300 ms; of a grid of thousands every eleventh, all kinds of cells among them.
                        if frames as f64 > 0.1 * rate || count > beats || turn % 11 != 0 {
                            continue;
                        }
                        let faults = Faults {
                            direction: if turn % 2 == 0 { 1.0 } else { -1.0 },
                            frames,
                            height,
                            count,
                            smooth: turn % 3 == 0,
                        };
                        let mut random = Noise::new(turn);
                        let noise = if turn % 4 < 2 { 0.0 } else { 0.02 };
                        let drift = if turn % 5 == 0 { 0.05 } else { 0.0 };
                        let times = &recording.times;
                        let mut signal: Vec<f64> = (recording.clean.iter().zip(times))
                            .map(|(v, t)| v + noise * random.normal() + drift * t / 1e3)
                            .collect();
                        let places = faults.lay(times, &mut signal, &mut random);
                        let [level, size] = scale(kind);
                        let values: Vec<f64> = signal.iter().map(|v| level + size * v).collect();
                        let found = analyse(times, &values, kind, "", &CurveOptions::default());
                        let tops = found.as_ref().map(tops).unwrap_or_default();
                        let is_listed = |[from, to]: &&[f64; 2]| {
                            found.as_ref().is_ok_and(|found| {
                                let treatment = &found.treatment;
                                let single =
                                    |frame: &usize| (*from..=*to).contains(&times[frame - 1]);
                                treatment.bad_frames.iter().any(single)
                                    || treatment
                                        .artefacts
                                        .iter()
                                        .any(|it| it.from_ms <= *to && it.to_ms >= *from)
                            })
                        };
                        cells += 1;
                        listed += places.iter().filter(is_listed).count();
                        all += places.len();
                        let mut matched = 0;
                        let mut gone = 0;
                        for onset in &recording.onsets {
                            let own = onset - 60.0..onset + 500.0;
                            let hit = tops.iter().any(|top| own.contains(top));
                            matched += usize::from(hit);
                            let touched = places
                                .iter()
                                .any(|[from, to]| *to > onset - 150.0 && *from < onset + 500.0);
                            untouched += usize::from(!touched);
                            gone += usize::from(!hit && !touched);
                        }
                        lost += gone;
                        let extra = tops.len() - matched.min(tops.len());
                        invented += extra;
                        if gone + extra > 1 {
                            worst.push(format!("{kind:?}, {rate} /s, {beats} beats, {frames} frames, {height} x{count}: {gone} lost, {extra} more"));
                        }
                    }
                }
            }
        }
    }
    println!(
        "{cells} cells: {lost} of {untouched} beats lost, {invented} invented, {listed} of {all} artefacts listed"
    );
    assert!(cells > 100, "{cells}");
    // Before: half of the cells lost nearly all beats.
    assert!(lost * 500 <= untouched, "{lost} of {untouched} lost: {worst:#?}");
    // An artefact of the height and nearly the length of a beat, in its direction, cannot be told from one.
    assert!(invented * 10 <= all, "{invented} invented of {all} artefacts: {worst:#?}");
    assert!(listed * 10 >= all * 9, "{listed} of {all} listed: {worst:#?}");
}

#[test]
fn clean_curves_have_no_artefacts() {
    for (kind, pulse) in SHAPES {
        for rate in [30.0, 60.0, 250.0] {
            for beats in [1, 5, 30] {
                for rhythm in ["regular", "alternans", "arrhythmic"] {
                    let mut random = Noise::new(beats * 31 + rate as u64);
                    let noise = if beats == 5 { 0.03 } else { 0.0 };
                    let (mut onset, mut series) = (300.0, Vec::new());
                    for beat in 0..beats {
                        let height = match rhythm {
                            "alternans" if beat % 2 == 1 => 0.55,
                            "arrhythmic" => 1.0 + 0.15 * random.normal().clamp(-2.0, 2.0),
                            _ => 1.0,
                        };
                        series.push((onset, height));
                        onset += match rhythm {
                            "arrhythmic" => (1000.0 + 300.0 * random.normal()).clamp(600.0, 3000.0),
                            _ => 1000.0,
                        };
                    }
                    let count = ((onset + 200.0) * rate / 1e3) as usize;
                    let times: Vec<f64> = (0..count).map(|i| i as f64 * 1e3 / rate).collect();
                    let [level, size] = scale(kind);
                    let beat = |t: f64| {
                        series
                            .iter()
                            .map(|(onset, height)| height * pulse(t - onset))
                            .fold(0.0, f64::max)
                    };
                    let values: Vec<f64> = times
                        .iter()
                        .map(|t| {
                            level
                                + size
                                    * (beat(*t) + noise * random.normal() + 0.1 * (t / 3e3).sin())
                        })
                        .collect();
                    let found = analyse(&times, &values, kind, "", &CurveOptions::default());
                    let case = format!("{kind:?}, {rate} /s, {beats} beats, {rhythm}");
                    let found = found.unwrap_or_else(|error| panic!("{case}: {error}"));
                    assert_eq!(found.treatment.artefacts, [], "{case}");
                }
            }
        }
    }
}

/// Twelve seconds of what a lost instrument writes, in a minute of beats.
#[test]
fn a_stretch_in_which_the_cell_was_lost_is_cut_out_and_the_other_beats_stay() {
    let recording = recording(250.0, 60, 1000.0, contraction);
    for (what, garbage) in [
        ("noise", (|_, noise| 2.0 * noise) as fn(f64, f64) -> f64),
        ("zero", |_, _| 10.0),
        ("far off", |_, _| -5.0),
        ("held", |_, _| 0.3),
        ("a random walk of small steps", |walk, _| 0.05 * walk),
        ("a random walk", |walk, _| 0.15 * walk),
        ("a random walk of large steps", |walk, _| 0.5 * walk),
    ] {
        let mut random = Noise::new(9);
        let mut walk = 0.0;
        let values = recording.times.iter().zip(&recording.clean).map(|(t, beat)| {
            let noise = random.normal();
            let lost = (20_000.0..32_000.0).contains(t);
            walk += if lost { noise } else { 0.0 };
            120.0 - 12.0 * if lost { garbage(walk, noise) } else { beat + 0.01 * noise }
        });
        let values: Vec<f64> = values.collect();
        let found =
            analyse(&recording.times, &values, Kind::Length, "um", &CurveOptions::default());
        let found = found.unwrap();
        assert_eq!(found.beats.len(), 48, "{what}");
        let long: Vec<&Artefact> =
            found.treatment.artefacts.iter().filter(|artefact| artefact.long).collect();
        assert_eq!(long.len(), 1, "{what}: {long:?}");
        assert!((long[0].from_ms - 20_000.0).abs() < 150.0, "{what}: {long:?}");
        assert!((long[0].to_ms - 32_000.0).abs() < 150.0, "{what}: {long:?}");
        assert!(
            found.remarks[0].contains("the signal there is not that of beats"),
            "{what}: {:?}",
            found.remarks
        );
        let shortening = found.mean("peak_shortening").unwrap();
        assert!((shortening - 10.0).abs() < 0.1, "{what}: {shortening}");
    }
}

/// The beats of alternate heights at a fast rate, of which twelve stand out by themselves.
#[test]
fn stimuli_own_the_beats_that_begin_after_them_and_find_low_ones() {
    let low = [3, 5, 8, 11, 14];
    let recording = recording(250.0, 17, 300.0, contraction);
    let mut random = Noise::new(9);
    let values = recording.times.iter().map(|t| {
        let beats = recording.onsets.iter().enumerate();
        let beats = beats.map(|(beat, onset)| {
            contraction(t - onset) * if low.contains(&beat) { 0.15 } else { 1.0 }
        });
        120.0 - 12.0 * (beats.fold(0.0, f64::max) + 0.02 * random.normal())
    });
    let values: Vec<f64> = values.collect();
    let of = |stimuli_ms: Vec<f64>| {
        let options = CurveOptions { stimuli_ms, ..CurveOptions::default() };
        analyse(&recording.times, &values, Kind::Length, "um", &options).unwrap()
    };
    assert_eq!(of(Vec::new()).beats.len(), 12);
    let paced = of(recording.onsets.iter().map(|onset| onset - 5.0).collect());
    assert_eq!(paced.beats.len(), 17);
    let missed = |found: &Analysis| {
        found
            .beats
            .iter()
            .filter(|beat| beat.state == State::Missed)
            .map(|beat| beat.number)
            .collect::<Vec<_>>()
    };
    let none = missed(&paced);
    assert!(none.len() <= 1 && none.iter().all(|number| low.contains(&(number - 1))), "{none:?}");
    // A beat whose peak comes after the next stimulus belongs to its own: it begins 190 ms after it.
    let late = of(recording.onsets.iter().map(|onset| onset - 190.0).collect());
    for beat in &late.beats {
        let onset = recording.onsets[beat.number + recording.onsets.len() - late.beats.len() - 1];
        let Some(top) = beat.marks.iter().find(|mark| mark.name == "peak") else { continue };
        let own = onset - 10.0..onset + 290.0;
        assert!(own.contains(&top.point.time), "beat {}: {}, {onset}", beat.number, top.point.time);
    }
}
