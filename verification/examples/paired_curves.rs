//! How well the delay of a contraction behind its calcium, and their loop, are known: bias and spread over frame rates and noise.
//!
//! Made-up beats, one a second: calcium rises in 50 ms and decays in 200 ms, the cell shortens after a delay of 25 ms, more
//! slowly. Noise is a part of a beat's height; 40 recordings of 10 s for each row. What is right was read from curves without noise at
//! 4000 frames/s.
//!
//! ```sh
//! cargo run --release -p myospring-verification --example paired_curves
//! ```

#![allow(clippy::print_stdout, reason = "it prints a table")]

use myospring::analysis::curve::{Analysis, CurveOptions, analyse};
use myospring::analysis::kind::Kind;
use myospring::analysis::paired::{Direction, Paired, Recorded, pair};
use myospring::analysis::value;
use myospring_verification::random::Random;

/// Recordings for each row.
const RECORDINGS: u64 = 40;
/// Length of each, ms.
const LENGTH_MS: f64 = 10_000.0;
/// Interval between beats, ms.
const PERIOD_MS: f64 = 1000.0;
/// The contraction begins this long after calcium.
const DELAY_MS: f64 = 25.0;

const METRICS: [&str; 5] = [
    "delay_of_onset",
    "delay_of_half_rise",
    "delay_of_peak",
    "relative_calcium_at_half_rise",
    "relative_loop_area",
];

/// How both curves were recorded.
#[derive(Debug, Clone, Copy)]
struct Scene {
    /// Frames a second of calcium and of length.
    rates: [f64; 2],
    /// Standard deviation of the noise, % of a beat's height.
    noise_pct: f64,
    /// Part of the frames that are missing, each on its own.
    missing: f64,
    /// When the recording of length starts, ms.
    late_ms: f64,
}

const USUAL: Scene = Scene { rates: [250.0; 2], noise_pct: 1.0, missing: 0.0, late_ms: 0.0 };

/// Height of a pulse, at most about 1, a time after its start, with time constants of its rise and fall, ms.
fn pulse(t: f64, rise: f64, fall: f64) -> f64 {
    if t <= 0.0 {
        return 0.0;
    }
    let of = |t: f64| (1.0 - (-t / rise).exp()).powi(2) * (-t / fall).exp();
    of(t) / of(rise * (1.0 + 2.0 * fall / rise).ln())
}

/// Times and values of both curves.
type Curves = [(Vec<f64>, Vec<f64>); 2];

impl Scene {
    fn curves(self, seed: u64) -> Curves {
        let mut random = Random::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        let start = (0.25 + 0.5 * random.uniform()) * PERIOD_MS;
        let phases = [random.uniform(), random.uniform()];
        let mut curve = |side: usize| {
            let step = 1e3 / self.rates[side];
            let first = if side == 1 { self.late_ms } else { 0.0 };
            let frames = ((LENGTH_MS - first) / step) as usize;
            let mut times: Vec<f64> =
                (0..frames).map(|i| first + (i as f64 + phases[side]) * step).collect();
            times.retain(|_| random.uniform() >= self.missing);
            let height = |t: f64| {
                let since = (t - start).rem_euclid(PERIOD_MS);
                match side {
                    0 => pulse(since, 20.0, 120.0),
                    _ => pulse(since - DELAY_MS, 60.0, 100.0),
                }
            };
            let noisy = times.iter().map(|t| height(*t) + 0.01 * self.noise_pct * random.normal());
            let values: Vec<f64> = match side {
                0 => noisy.map(|height| 0.1 + 0.5 * height).collect(),
                _ => noisy.map(|height| 110.0 - 11.0 * height).collect(),
            };
            (times, values)
        };
        [curve(0), curve(1)]
    }

    fn paired(self, seed: u64) -> Option<Paired> {
        let curves = self.curves(seed);
        let read = |side: usize, kind, unit| -> Option<Analysis> {
            let (times, values) = &curves[side];
            analyse(times, values, kind, unit, &CurveOptions::default()).ok()
        };
        let [calcium, length] = [read(0, Kind::Calcium, "uM")?, read(1, Kind::Length, "um")?];
        let recorded = |side: usize, kind, unit, analysis| Recorded {
            times_ms: &curves[side].0,
            kind,
            unit,
            analysis,
        };
        pair(&recorded(0, Kind::Calcium, "uM", &calcium), &recorded(1, Kind::Length, "um", &length))
            .ok()
    }
}

/// A row: beats that were paired of those there are, loops whose direction is right, and for each metric its bias and its
/// spread from beat to beat.
fn row(name: &str, scene: Scene, truth: [f64; 5]) {
    let (mut paired_beats, mut there, mut right, mut wrong) = (0, 0.0, 0, 0);
    let mut values: [Vec<f64>; 5] = Default::default();
    for seed in 1..=RECORDINGS {
        // Those that begin while both curves are recorded, but for one that the end cuts off.
        there += ((LENGTH_MS - scene.late_ms) / PERIOD_MS).floor();
        let Some(paired) = scene.paired(seed) else { continue };
        match paired.direction {
            Direction::CounterClockwise => right += 1,
            Direction::Clockwise => wrong += 1,
            Direction::Unknown => {}
        }
        for beat in paired.beats.iter().filter(|beat| beat.counts) {
            paired_beats += 1;
            for (list, metric) in values.iter_mut().zip(METRICS) {
                list.extend(value(&beat.metrics, metric));
            }
        }
    }
    let cells = values.iter().zip(truth).map(|(list, truth)| {
        let count = list.len() as f64;
        let mean = list.iter().sum::<f64>() / count;
        let squares: f64 = list.iter().map(|value| (value - mean).powi(2)).sum();
        format!("{:+.1} ({:.1})", mean - truth, (squares / (count - 1.0)).sqrt())
    });
    let cells: Vec<String> = cells.collect();
    let found = 100.0 * f64::from(paired_beats) / there;
    println!("| {name} | {found:.0} % | {} | {right}, {wrong} |", cells.join(" | "));
}

fn main() {
    let fine = Scene { rates: [4000.0; 2], noise_pct: 0.0, ..USUAL };
    let fine = fine.paired(1);
    let truth =
        METRICS.map(|metric| fine.as_ref().and_then(|it| it.mean(metric)).unwrap_or(f64::NAN));
    println!("true: {truth:.2?}");
    println!(
        "| recording | beats paired | delay of onset, ms | of half rise, ms | of peak, ms | calcium at half rise, % | loop area, % | \
         direction right, wrong of {RECORDINGS} |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for rate in [30.0, 60.0, 100.0, 250.0, 1000.0] {
        for noise_pct in [0.0, 1.0, 3.0, 10.0] {
            let name = format!("{rate} frames/s, noise {noise_pct} %");
            row(&name, Scene { rates: [rate; 2], noise_pct, ..USUAL }, truth);
        }
    }
    row("calcium 30, length 250 frames/s", Scene { rates: [30.0, 250.0], ..USUAL }, truth);
    row("calcium 1000, length 60 frames/s", Scene { rates: [1000.0, 60.0], ..USUAL }, truth);
    row("5 % of frames missing", Scene { missing: 0.05, ..USUAL }, truth);
    row("length starts 3 s later", Scene { late_ms: 3000.0, ..USUAL }, truth);
}
