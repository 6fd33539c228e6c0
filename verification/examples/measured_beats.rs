//! How well the metrics of measured beats are known: bias and spread over noise, frame rate, drift and rate of beating.
//!
//! Made-up contractions of a known course (up as half a cosine in 100 ms, back with a time constant) with noise whose
//! standard deviation is a part of their height; 40 recordings of 10 s for each row.
//!
//! ```sh
//! cargo run --release -p myospring-verification --example measured_beats
//! ```

#![allow(clippy::print_stdout, reason = "it prints tables")]

use myospring::analysis::curve::{CurveOptions, analyse};
use myospring::analysis::kind::Kind;
use myospring::analysis::value;
use myospring_verification::random::Random;
use std::f64::consts::{PI, TAU};

/// Recordings for each row.
const RECORDINGS: u64 = 40;
/// Length of each, s.
const SECONDS: f64 = 10.0;
/// Time from start to peak, ms.
const RISE: f64 = 100.0;
/// Height of a beat, a.u.
const HEIGHT: f64 = 100.0;

/// A course of beats.
#[derive(Debug, Clone, Copy)]
struct Scene {
    /// Standard deviation of the noise, % of a beat's height.
    noise_pct: f64,
    /// Frames a second.
    frame_rate: f64,
    /// Beats a second.
    beats_per_s: f64,
    /// Drift of the baseline, % of a beat's height a second.
    drift_pct: f64,
    /// Mains hum of 50 Hz, % of a beat's height.
    hum_pct: f64,
}

const USUAL: Scene =
    Scene { noise_pct: 1.0, frame_rate: 250.0, beats_per_s: 1.0, drift_pct: 0.0, hum_pct: 0.0 };

impl Scene {
    /// Time constant of the way back, ms: shorter where beats follow each other quickly.
    fn constant(self) -> f64 {
        80.0_f64.min(80.0 / self.beats_per_s)
    }

    /// Height of a beat, 0 to 1, a time after its start.
    fn height(self, t: f64) -> f64 {
        if t < RISE {
            0.5 - 0.5 * (PI * t / RISE).cos()
        } else {
            // Meets the top without a corner.
            let past = (t - RISE) / self.constant();
            (1.0 + past) * (-past).exp()
        }
    }

    /// Contraction, a.u., over times, ms.
    fn recording(self, seed: u64) -> (Vec<f64>, Vec<f64>) {
        let mut random = Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        let period = 1e3 / self.beats_per_s;
        // Frames fall anywhere between a beat's start and the next.
        let start = (0.3 + 0.5 * random.uniform()) * period;
        let frames = (SECONDS * self.frame_rate) as usize;
        let times: Vec<f64> = (0..frames).map(|i| i as f64 * 1e3 / self.frame_rate).collect();
        let phase = TAU * random.uniform();
        let values = times.iter().map(|t| {
            let beat = self.height((t - start).rem_euclid(period));
            let drift = 0.01 * self.drift_pct * t / 1e3;
            let hum = 0.01 * self.hum_pct * (TAU * 0.05 * t + phase).sin();
            let noise = 0.01 * self.noise_pct * random.normal();
            50.0 + HEIGHT * (beat + drift + hum + noise)
        });
        let values = values.collect();
        (times, values)
    }

    /// What is known of a beat: peak, time to peak from 10 %, time to half back, time constant of the second
    /// half of the way back, steepest slope.
    fn truth(self) -> [f64; 5] {
        let step = 0.01;
        let times: Vec<f64> =
            (0..(1e3 / self.beats_per_s / step) as usize).map(|i| i as f64 * step).collect();
        let heights: Vec<f64> = times.iter().map(|t| self.height(*t)).collect();
        let first = |from: f64, is: &dyn Fn(f64) -> bool| {
            let at = times.iter().zip(&heights).position(|(t, height)| *t >= from && is(*height));
            at.map_or(f64::NAN, |at| times[at])
        };
        let tenth = first(0.0, &|height| height >= 0.1);
        let half = first(RISE, &|height| height <= 0.5);
        let ninety = first(RISE, &|height| height <= 0.1);
        // The slope of the logarithm by least squares, as it is defined.
        let fall: Vec<(f64, f64)> = times
            .iter()
            .zip(&heights)
            .filter(|(t, _)| (half..ninety).contains(*t))
            .map(|(t, height)| (*t, height.ln()))
            .collect();
        let count = fall.len() as f64;
        let mean_t = fall.iter().map(|(t, _)| t).sum::<f64>() / count;
        let mean_l = fall.iter().map(|(_, l)| l).sum::<f64>() / count;
        let covariance: f64 = fall.iter().map(|(t, l)| (t - mean_t) * (l - mean_l)).sum();
        let variance: f64 = fall.iter().map(|(t, _)| (t - mean_t).powi(2)).sum();
        [HEIGHT, RISE - tenth, half - RISE, -variance / covariance, HEIGHT * PI / 2.0 / RISE * 1e3]
    }
}

const METRICS: [&str; 5] = [
    "peak_amplitude",
    "time_to_peak_from_10_percent",
    "relaxation_time_50",
    "relaxation_time_constant",
    "maximum_contraction_rate",
];

/// A row: beats found of those there are, and for each metric its bias and its spread from beat to beat, %.
fn row(name: &str, scene: Scene) {
    let truth = scene.truth();
    let (mut found, mut there) = (0, 0);
    let mut values: [Vec<f64>; 5] = Default::default();
    for seed in 1..=RECORDINGS {
        let (times, values_over_time) = scene.recording(seed);
        // Those that begin 100 ms after the recording and reach their peak before its end.
        let period = 1e3 / scene.beats_per_s;
        let mut random = Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        let start = (0.3 + 0.5 * random.uniform()) * period;
        there += ((SECONDS * 1e3 - start - RISE) / period).floor() as usize + 1;
        let options = CurveOptions::default();
        let Ok(analysis) = analyse(&times, &values_over_time, Kind::Contraction, "a.u.", &options)
        else {
            continue;
        };
        found += analysis.beats.len();
        for beat in analysis.counted() {
            for (list, name) in values.iter_mut().zip(METRICS) {
                list.extend(value(&beat, name));
            }
        }
    }
    print!("| {name} | {:.0} % |", 100.0 * f64::from(found as u32) / f64::from(there as u32));
    for (list, truth) in values.iter().zip(truth) {
        let count = list.len() as f64;
        if list.len() < 2 {
            print!(" - |");
            continue;
        }
        let mean = list.iter().sum::<f64>() / count;
        let spread = (list.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
        print!(" {:+.1} ({:.1}) |", 100.0 * (mean / truth - 1.0), 100.0 * spread / truth);
    }
    println!();
}

fn main() {
    println!(
        "| recording | beats found | peak | time to peak from 10 % | half back | time constant | largest rate |"
    );
    println!("|---|---|---|---|---|---|---|");
    for noise_pct in [0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 20.0] {
        row(&format!("noise {noise_pct} %"), Scene { noise_pct, ..USUAL });
    }
    for frame_rate in [30.0, 60.0, 100.0, 500.0, 1000.0] {
        row(&format!("{frame_rate} frames/s"), Scene { frame_rate, ..USUAL });
    }
    for frame_rate in [30.0, 60.0, 1000.0] {
        row(
            &format!("{frame_rate} frames/s, noise 10 %"),
            Scene { frame_rate, noise_pct: 10.0, ..USUAL },
        );
    }
    for beats_per_s in [0.3, 0.5, 2.0, 4.0] {
        row(&format!("{beats_per_s} beats/s"), Scene { beats_per_s, ..USUAL });
    }
    for drift_pct in [5.0, 20.0, 50.0] {
        row(&format!("drift {drift_pct} %/s"), Scene { drift_pct, ..USUAL });
    }
    for hum_pct in [2.0, 5.0] {
        row(&format!("hum {hum_pct} %"), Scene { hum_pct, ..USUAL });
    }
}
