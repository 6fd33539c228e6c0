//! What the program must not take for a beat, and what it says where it cannot tell.

use super::{each_second, frames, half_sine};
use crate::noise::Noise;
use myospring::analysis::curve::{CurveOptions, analyse};
use myospring::analysis::kind::Kind;
use std::f64::consts::PI;

fn length(height: f64) -> f64 {
    120.0 - 12.0 * height
}

/// Contracted for three quarters of the time: by itself the curve seems to rise for a quarter of it.
#[test]
fn the_kind_fixes_the_direction_whatever_the_curve_looks_like() {
    let times = frames(250.0, 12.0);
    let values: Vec<f64> = times
        .iter()
        .map(|t| {
            let t = t.rem_euclid(1000.0);
            length((t / 60.0).min((750.0 - t) / 60.0).clamp(0.0, 1.0))
        })
        .collect();
    let of = |kind| analyse(&times, &values, kind, "um", &CurveOptions::default()).unwrap();
    assert!(of(Kind::Unknown).treatment.rises);
    let found = of(Kind::Length);
    assert!(!found.treatment.rises);
    assert_eq!(found.beats.len(), 12);
    let shortening = found.mean("peak_shortening").unwrap();
    // The rest is so short that its mean takes in the foot of the next beat.
    assert!((shortening - 10.0).abs() < 0.1, "{shortening}");
}

#[test]
fn one_beat_that_fills_its_recording_raises_no_doubt_about_its_kind() {
    let times = frames(1000.0, 0.6);
    let values: Vec<f64> = times
        .iter()
        .map(|t| 12.0 * ((t - 20.0) / 100.0).min((590.0 - t) / 60.0).clamp(0.0, 1.0))
        .collect();
    let found = analyse(&times, &values, Kind::Shortening, "%", &CurveOptions::default()).unwrap();
    assert_eq!(found.beats.len(), 1);
    let remarks = found.remarks.join("; ");
    assert!(!remarks.contains("is its kind right"), "{remarks}");
}

/// Noise that goes on for some frames has small differences from frame to frame, and its wiggles repeat more often than
/// beats do. Before, 20 beats with noise of a hundredth of their height were hundreds.
#[test]
fn noise_that_goes_on_for_some_frames_is_no_beats() {
    for rate in [200.0, 600.0] {
        for memory in [0.5, 0.8] {
            for size in [0.01, 0.03, 0.1] {
                let times = frames(rate, 20.0);
                let mut random = Noise::new((1e3 * size) as u64);
                let mut noise = random.normal();
                let mut signal = Vec::new();
                for height in each_second(&times, half_sine) {
                    noise = memory * noise + (1.0_f64 - memory * memory).sqrt() * random.normal();
                    signal.push(length(height + size * noise));
                }
                let found = analyse(&times, &signal, Kind::Length, "um", &CurveOptions::default());
                let found = found.unwrap();
                let case = format!("{rate} /s, memory {memory}, noise {size}");
                assert_eq!(found.beats.len(), 20, "{case}");
                let shortening = found.mean("peak_shortening").unwrap();
                // The highest point of a beat stands on the noise's top there, about its standard deviation high.
                assert!((shortening - 10.0).abs() < 0.1 + 10.0 * size, "{case}: {shortening}");
            }
        }
    }
}

/// As in a published recording of Fura at 1000 frames a second, where a ratio of two noisy numbers has spikes upwards too;
/// before, its six beats were 59.
#[test]
fn light_that_flickers_more_than_a_beat_is_high_is_no_beats() {
    for seed in 0..3 {
        let times = frames(1000.0, 12.0);
        let (mut random, mut phase) = (Noise::new(seed), 0.0);
        let values: Vec<f64> = times
            .iter()
            .map(|t| {
                phase += 0.2 * PI * (1.0 + 0.3 * random.normal());
                let height = half_sine((t - 250.0).rem_euclid(2000.0));
                let flicker = 0.03 * phase.sin() + 0.015 * random.normal();
                0.86 + 0.044 * height + flicker + 12.0 * flicker.max(0.0).powi(2)
            })
            .collect();
        let options = CurveOptions::default();
        let found = analyse(&times, &values, Kind::CalciumRatio, "", &options).unwrap();
        assert!((5..=6).contains(&found.beats.len()), "seed {seed}: {} beats", found.beats.len());
        let interval = found.mean("interval").unwrap();
        assert!((interval - 2000.0).abs() < 40.0, "seed {seed}: {interval} ms");
    }
}

#[test]
fn artefacts_as_many_as_beats_are_called_what_cannot_be_told() {
    let times = frames(100.0, 15.0);
    let beats = each_second(&times, half_sine);
    let of = |count: usize, frames: usize, height: f64| {
        let mut random = Noise::new(7);
        let mut signal: Vec<f64> = beats.iter().map(|b| b + 0.01 * random.normal()).collect();
        let share = signal.len() / count;
        for number in 0..count {
            let at = number * share + (number * 37) % share.saturating_sub(frames).max(1);
            signal[at..at + frames].iter_mut().for_each(|value| *value += height);
        }
        let values: Vec<f64> = signal.into_iter().map(length).collect();
        let found = analyse(&times, &values, Kind::Length, "um", &CurveOptions::default()).unwrap();
        found.remarks.join("; ").contains("look at the figure")
    };
    assert!(of(20, 8, 20.0));
    assert!(of(20, 3, -5.0));
    assert!(!of(1, 3, -5.0));
    assert!(!of(3, 5, 3.0));
}
