//! Where the analysis of measured curves breaks: made-up recordings with beats, rates, noise and artefacts drawn at random,
//! none of which its tests use. Counts beats that are lost although no artefact touches them, beats that are not there,
//! artefacts that are not listed, and means that artefacts move; and how many of these recordings the program calls doubtful.
//!
//! ```text
//! cargo run --release -p myospring-verification --example curve_robustness [RECORDINGS [SEED [SHOW [ONE]]]]
//! ```
#![allow(clippy::print_stdout, reason = "it prints tables of curves of its own")]

use myospring::analysis::curve::{Analysis, CurveBeat, CurveOptions, State, analyse};
use myospring::analysis::kind::Kind;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A mean that artefacts move by more than this part is wrong.
const MOVED: f64 = 0.03;

/// Xorshift, by Marsaglia (2003).
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0xd134_2543_de82_ef95) | 1);
        (0..16).for_each(|_| {
            random.uniform();
        });
        random
    }

    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// As many between 1 and 2 as between 10 and 20.
    fn of_any_size(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.uniform())
    }

    fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[(self.uniform() * list.len() as f64) as usize]
    }

    fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform().max(1e-300), self.uniform());
        (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
    }
}

/// Height of a beat of duration 1 since its onset.
type Shape = fn(f64) -> f64;

fn skewed(t: f64) -> f64 {
    let width = if t < 0.35 { 0.12 } else { 0.22 };
    (-0.5 * ((t - 0.35) / width).powi(2)).exp()
}
fn exponential(t: f64) -> f64 {
    if t <= 0.0 { 0.0 } else { 1.5 * (1.0 - (-t / 0.06).exp()) * (-t / 0.25).exp() }
}
fn plateau(t: f64) -> f64 {
    0.5 * (((t - 0.15) / 0.06).tanh() - ((t - 0.75) / 0.1).tanh())
}
fn two_humps(t: f64) -> f64 {
    let hump = |at: f64| (-0.5 * ((t - at) / 0.11).powi(2)).exp();
    hump(0.3) + 0.6 * hump(0.62)
}
fn ventricular(t: f64) -> f64 {
    if t <= 0.0 {
        0.0
    } else {
        (1.0 - (-t / 0.004).exp()) * (0.8 + 0.2 * (-t / 0.02).exp())
            / (1.0 + ((t - 0.75) / 0.06).exp())
    }
}
fn of_stem_cells(t: f64) -> f64 {
    if t <= -1.0 {
        0.0
    } else {
        (1.0 / (1.0 + (-(t - 0.1) / 0.02).exp())) / (1.0 + ((t - 0.6) / 0.1).exp())
    }
}

const KINDS: [Kind; 8] = [
    Kind::SarcomereLength,
    Kind::Length,
    Kind::Shortening,
    Kind::CalciumRatio,
    Kind::Fluorescence,
    Kind::Potential,
    Kind::Tension,
    Kind::NormalisedLength,
];

fn shapes(kind: Kind) -> &'static [(&'static str, Shape)] {
    match kind {
        Kind::Potential => &[("ventricular", ventricular), ("stem cell", of_stem_cells)],
        Kind::CalciumRatio | Kind::Fluorescence => {
            &[("exponential", exponential), ("skewed", skewed)]
        }
        _ => &[
            ("skewed", skewed),
            ("exponential", exponential),
            ("plateau", plateau),
            ("two humps", two_humps),
        ],
    }
}

/// Level and height of a beat.
fn scale(kind: Kind) -> [f64; 2] {
    match kind {
        Kind::SarcomereLength => [1.85, -0.15],
        Kind::Length => [110.0, -8.0],
        Kind::NormalisedLength => [1.0, -0.08],
        Kind::Potential => [-75.0, 105.0],
        Kind::CalciumRatio => [0.9, 0.7],
        Kind::Fluorescence => [900.0, 400.0],
        Kind::Tension => [2.0, 25.0],
        _ => [0.2, 9.0],
    }
}

/// A made-up recording.
struct Recording {
    kind: Kind,
    shape: &'static str,
    words: String,
    times: Vec<f64>,
    /// Without artefacts.
    clean: Vec<f64>,
    values: Vec<f64>,
    /// Of each beat.
    onsets: Vec<f64>,
    duration: f64,
    /// The mean cycle, ms.
    cycle: f64,
    /// First and last time of each artefact.
    faults: Vec<[f64; 2]>,
    /// Artefacts for each beat.
    crowd: f64,
}

/// Artefacts of one form.
struct Artefacts {
    count: usize,
    /// Frames.
    length: usize,
    /// In beats.
    height: f64,
    form: &'static str,
}

impl Artefacts {
    fn of(random: &mut Random, longest: f64) -> Self {
        let length = random.of_any_size(1.0, longest + 0.999) as usize;
        let height = random.of_any_size(0.5, 20.0);
        let count = random.of_any_size(1.0, 20.999) as usize;
        let height = height * random.one_of(&[1.0, -1.0]);
        Self { count, length, height, form: random.one_of(&["box", "hump", "ramp", "decay"]) }
    }

    /// Lays them over a curve anywhere: first and last frame of each.
    fn lay(&self, random: &mut Random, values: &mut [f64]) -> Vec<[usize; 2]> {
        let length = self.length;
        let mut places = Vec::new();
        for _ in 0..self.count {
            let room = (values.len() - length) as f64;
            let at = (random.uniform() * room) as usize;
            for frame in 0..length {
                let part = (frame + 1) as f64 / (length + 1) as f64;
                let size = match self.form {
                    "hump" if length > 1 => (0.5 * TAU * part).sin(),
                    "ramp" if length > 1 => (2.0 * part).min(2.0 - 2.0 * part),
                    "decay" if length > 1 => (-2.0 * (part - 1.0 / (length + 1) as f64)).exp(),
                    _ => 1.0,
                };
                values[at + frame] += self.height * size;
            }
            places.push([at, at + length - 1]);
        }
        places
    }
}

fn record(seed: u64) -> Recording {
    let mut random = Random::new(seed);
    let kind = random.one_of(&KINDS);
    let (shape, pulse) = random.one_of(shapes(kind));
    let hz = random.of_any_size(0.5, 5.0);
    let cycle = 1e3 / hz;
    let duration = (cycle * random.between(0.3, 0.65)).min(random.between(250.0, 800.0));
    // A beat has ten frames at least.
    let rate = random.of_any_size((1e4 / duration).max(15.0), 1000.0);
    let most = (30_000.0 / rate * hz).min(60.0);
    let beats = random.of_any_size(2.0, most.max(3.0)) as usize;
    let jitter = random.one_of(&[0.0, 0.0, 0.2]);
    let unlike = random.one_of(&[0.0, 0.05]);
    let mut onset = random.between(0.2, 0.6) * cycle;
    let mut onsets = Vec::new();
    let mut heights = Vec::new();
    for _ in 0..beats {
        onsets.push(onset);
        heights.push(1.0 + unlike * random.normal());
        onset += (cycle * (1.0 + jitter * random.normal())).max(0.35 * cycle + 0.65 * duration);
    }
    let frames = ((onset + 0.2 * cycle) * rate * 1e-3) as usize;
    let times: Vec<f64> = (0..frames).map(|frame| frame as f64 * 1e3 / rate).collect();
    let noise = random.one_of(&[0.0, 0.01, 0.03, 0.06, 0.1]);
    let memory = random.one_of(&[0.0, 0.0, 0.5, 0.8]);
    let slope = random.one_of(&[0.0, 0.5, -0.5]);
    let wander = random.one_of(&[0.0, 0.2]);
    let slow = random.between(6.0, 20.0) * cycle;
    let end = times.last().copied().unwrap_or(1.0);
    let mut last = random.normal();
    let mut first_near = 0;
    let signal: Vec<f64> = times
        .iter()
        .map(|&t| {
            while onsets.get(first_near).is_some_and(|onset| onset + 3.0 * duration < t) {
                first_near += 1;
            }
            let near = onsets.iter().zip(&heights).skip(first_near);
            let near = near.take_while(|(onset, _)| **onset < t + duration);
            let beat = near
                .map(|(onset, height)| height * pulse((t - onset) / duration))
                .fold(0.0, f64::max);
            last = memory * last + (1.0_f64 - memory * memory).sqrt() * random.normal();
            beat + noise * last + slope * t / end + wander * (TAU * t / slow).sin()
        })
        .collect();
    let longest = (duration * rate * 1e-3 / 3.0).clamp(1.0, 30.0);
    let artefacts = Artefacts::of(&mut random, longest);
    let mut values = signal.clone();
    let faults = artefacts.lay(&mut random, &mut values);
    let faults: Vec<[f64; 2]> = faults.iter().map(|at| at.map(|frame| times[frame])).collect();
    let [level, size] = scale(kind);
    let of = |signal: &[f64]| signal.iter().map(|value| level + size * value).collect::<Vec<f64>>();
    let words = format!(
        "{hz:.2} Hz, {rate:.0} /s, {beats} beats of {duration:.0} ms, jitter {jitter}, noise {noise} ({memory}), drift {slope} {wander}; \
         {} {} of {} frames ({:.2} of a beat), height {:.2}",
        artefacts.count,
        artefacts.form,
        artefacts.length,
        artefacts.length as f64 * 1e3 / rate / duration,
        artefacts.height
    );
    Recording {
        kind,
        shape,
        words,
        clean: of(&signal),
        values: of(&values),
        times,
        onsets,
        duration,
        cycle,
        faults,
        crowd: artefacts.count as f64 / beats as f64,
    }
}

fn at(beat: &CurveBeat, name: &str) -> Option<[f64; 2]> {
    let mark = beat.marks.iter().find(|mark| mark.name == name)?;
    Some([mark.point.time, mark.point.value])
}

fn peak(beat: &CurveBeat) -> Option<f64> {
    at(beat, "peak").map(|[time, _]| time)
}

fn amplitude(beat: &CurveBeat) -> Option<f64> {
    let [time, value] = at(beat, "peak")?;
    let [from, to] = beat.baseline?;
    let part = (time - from.time) / (to.time - from.time);
    Some(value - from.value - part * (to.value - from.value))
}

fn rise(beat: &CurveBeat) -> Option<f64> {
    Some(at(beat, "peak")?[0] - at(beat, "10 % up")?[0])
}

fn interval(beat: &CurveBeat) -> Option<f64> {
    myospring::analysis::value(&beat.metrics, "interval")
}

/// What came out of one recording.
#[derive(Default)]
struct Outcome {
    untouched: usize,
    lost: usize,
    invented: usize,
    listed: usize,
    /// Names of the means that artefacts moved, by how much.
    moved: Vec<(&'static str, f64)>,
    /// Without artefacts: beats that were lost, those that are none, and artefacts that are listed nevertheless.
    clean: [usize; 3],
    doubtful: bool,
    refused: bool,
}

impl Outcome {
    fn is_bad(&self, of: &Recording) -> bool {
        self.lost + self.invented > 0 || self.listed < of.faults.len() || !self.moved.is_empty()
    }
}

impl Recording {
    /// The found beat of each true one, and how many are none.
    fn pair(&self, found: &[CurveBeat]) -> (Vec<Option<usize>>, usize) {
        let mut pairs = vec![None; self.onsets.len()];
        let mut invented = 0;
        for (number, beat) in found.iter().enumerate() {
            let Some(time) = peak(beat) else { continue };
            let own = |onset: f64| onset - 0.1 * self.duration..onset + 0.9 * self.duration;
            let place = self.onsets.iter().position(|&onset| own(onset).contains(&time));
            match place {
                Some(place) if pairs[place].is_none() => pairs[place] = Some(number),
                _ => invented += 1,
            }
        }
        (pairs, invented)
    }

    fn judge(&self) -> Outcome {
        let clean = analyse(&self.times, &self.clean, self.kind, "", &CurveOptions::default());
        let found = analyse(&self.times, &self.values, self.kind, "", &CurveOptions::default());
        let listed_clean = clean
            .as_ref()
            .map_or(0, |clean| clean.treatment.artefacts.len() + clean.treatment.bad_frames.len());
        let beats = |found: &Result<Analysis, _>| {
            found.as_ref().map_or(Vec::new(), |found: &Analysis| found.beats.clone())
        };
        let (clean, all) = (beats(&clean), beats(&found));
        let (true_pairs, invented_clean) = self.pair(&clean);
        let (pairs, invented) = self.pair(&all);
        let touched = |onset: f64| {
            let (from, to) = (onset - 0.1 * self.cycle, onset + 1.1 * self.duration);
            self.faults.iter().any(|[first, last]| *last >= from && *first <= to)
        };
        let untouched: Vec<usize> = (0..self.onsets.len())
            .filter(|&beat| !touched(self.onsets[beat]) && true_pairs[beat].is_some())
            .collect();
        let is_listed = |[from, to]: &&[f64; 2]| {
            found.as_ref().is_ok_and(|found| {
                let treatment = &found.treatment;
                treatment
                    .bad_frames
                    .iter()
                    .any(|frame| (*from..=*to).contains(&self.times[frame - 1]))
                    || treatment.artefacts.iter().any(|it| it.from_ms <= *to && it.to_ms >= *from)
            })
        };
        let counts = |beat: &CurveBeat| matches!(beat.state, State::Whole | State::CutAtEnd);
        let mut moved = Vec::new();
        for (name, of) in [
            ("amplitude", amplitude as fn(&CurveBeat) -> Option<f64>),
            ("interval", interval),
            ("time to peak", rise),
        ] {
            let now: Vec<f64> = all.iter().filter(|beat| counts(beat)).filter_map(of).collect();
            // The same beats without artefacts.
            let before: Vec<f64> = (pairs.iter().zip(&true_pairs))
                .filter_map(|(now, before)| Some((&all[(*now)?], &clean[(*before)?])))
                .filter(|(now, _)| counts(now) && of(now).is_some())
                .filter_map(|(_, before)| of(before))
                .collect();
            if now.is_empty() || before.is_empty() {
                continue;
            }
            let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
            let by = mean(&now) / mean(&before) - 1.0;
            if by.abs() > MOVED {
                moved.push((name, by));
            }
        }
        Outcome {
            untouched: untouched.len(),
            lost: untouched.iter().filter(|&&beat| pairs[beat].is_none()).count(),
            invented,
            listed: self.faults.iter().filter(is_listed).count(),
            moved,
            clean: [
                true_pairs.iter().filter(|pair| pair.is_none()).count(),
                invented_clean,
                listed_clean,
            ],
            doubtful: found
                .as_ref()
                .is_ok_and(|found| found.remarks.iter().any(|it| it.contains("cannot be told"))),
            refused: found.is_err(),
        }
    }
}

#[derive(Default)]
struct Sum {
    recordings: usize,
    bad: usize,
    silent: usize,
    doubtful: usize,
    refused: usize,
    untouched: usize,
    lost: usize,
    invented: usize,
    faults: usize,
    unlisted: usize,
    moved: usize,
    clean: [usize; 3],
}

impl Sum {
    fn add(&mut self, of: &Recording, outcome: &Outcome) {
        let bad = outcome.is_bad(of);
        self.recordings += 1;
        self.bad += usize::from(bad);
        self.silent += usize::from(bad && !outcome.doubtful && !outcome.refused);
        self.doubtful += usize::from(outcome.doubtful);
        self.refused += usize::from(outcome.refused);
        self.untouched += outcome.untouched;
        self.lost += outcome.lost;
        self.invented += outcome.invented;
        self.faults += of.faults.len();
        self.unlisted += of.faults.len() - outcome.listed;
        self.moved += usize::from(!outcome.moved.is_empty());
        self.clean.iter_mut().zip(outcome.clean).for_each(|(sum, one)| *sum += one);
    }

    fn print(&self, name: &str) {
        println!(
            "| {name} | {} | {} | {} | {} | {} | {} of {} | {} | {} of {} | {} | {} + {} + {} |",
            self.recordings,
            self.bad,
            self.silent,
            self.doubtful,
            self.refused,
            self.lost,
            self.untouched,
            self.invented,
            self.unlisted,
            self.faults,
            self.moved,
            self.clean[0],
            self.clean[1],
            self.clean[2],
        );
    }
}

fn main() {
    let number = |place: usize, default: u64| {
        std::env::args().nth(place).and_then(|word| word.parse().ok()).unwrap_or(default)
    };
    let (count, seed) = (number(1, 1000), number(2, 1));
    // 1 shows the recordings that went wrong without a word, 2 all that went wrong; then one of them alone.
    let (show, only) = (number(3, 0), number(4, u64::MAX));
    let mut sums: BTreeMap<String, Sum> = BTreeMap::new();
    let mut slowest = 0.0_f64;
    for turn in 0..count {
        if only != u64::MAX && turn != only {
            continue;
        }
        let recording = record(seed.wrapping_mul(1_000_003) + turn);
        let begin = std::time::Instant::now();
        let outcome = recording.judge();
        slowest = slowest.max(begin.elapsed().as_secs_f64());
        let crowd = match recording.crowd {
            crowd if crowd <= 0.25 => "artefacts on up to a quarter of the beats",
            crowd if crowd <= 1.0 => "on up to all beats",
            _ => "more than beats",
        };
        for name in [
            "all",
            &format!("kind: {}", recording.kind),
            &format!("shape: {}", recording.shape),
            crowd,
        ] {
            sums.entry(name.to_owned()).or_default().add(&recording, &outcome);
        }
        let bad = outcome.is_bad(&recording) || outcome.clean != [0, 0, 0];
        if show > 0 && bad && (show > 1 || !(outcome.doubtful || outcome.refused)) {
            println!(
                "{turn}: {}, {}, {}: {} lost, {} invented, {} of {} listed, moved {:?}, clean {:?}{}",
                recording.kind.word(),
                recording.shape,
                recording.words,
                outcome.lost,
                outcome.invented,
                outcome.listed,
                recording.faults.len(),
                outcome.moved,
                outcome.clean,
                if outcome.doubtful { ", said" } else { "" },
            );
        }
    }
    println!(
        "\n| recordings | all | bad | not said | doubtful | refused | beats lost | invented | artefacts not listed | means moved | \
         clean: lost + invented + listed |\n|---|---|---|---|---|---|---|---|---|---|---|"
    );
    for (name, sum) in &sums {
        sum.print(name);
    }
    println!("\nslowest: {slowest:.2} s");
}
