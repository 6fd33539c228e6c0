//! Artefacts: departures that are unlike the beats of their curve.
//!
//! Beats repeat: all beats of a recording have about the same height, width and direction, and they
//! relax smoothly. The curve is filtered by morphological openings and closings with flat windows
//! (Serra 1982) of increasing width; each removes pulses narrower than its window, in both
//! directions and of any height. The window behind which the most pulses of one height and width
//! remain shows the beats ([`Beats`]). An artefact is what narrower windows remove, beyond what
//! they remove from the tops of beats; a jump away and back that beats do not make; a part far
//! below the rest; or a pulse far above the usual beat.

mod lost;
mod runs;
mod usual;
mod windows;

use super::detect::persistent;
use super::noise::{Noise, median};
use runs::runs;
pub(super) use usual::Beats;

/// Widest window, as a part of a beat's width at half height (about a third of the beat).
const WINDOW: f64 = 0.66;

/// Least height of an artefact, in beats.
const LEAST: f64 = 0.25;

/// Least depth below the surrounding rest at which a departure is against the direction of the
/// beats, in beats.
const BELOW: f64 = 0.4;

/// A pulse higher than this many usual beats is an artefact.
const TALL: f64 = 2.5;

/// A departure that is not a beat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Artefact {
    /// First and last frame.
    pub(super) from: usize,
    pub(super) to: usize,
    /// Its distance from the line between its neighbours, positive in the direction of beats.
    pub(super) height: f64,
    /// Whether it is longer than the interval between beats.
    pub(super) long: bool,
}

/// A curve with its artefacts replaced by lines, the artefacts, and the usual beat, if there are
/// beats.
pub(super) type Bridged = (Vec<f64>, Vec<Artefact>, Option<Beats>);

/// Replaces the artefacts of a curve whose beats rise by lines; `lasts` are the shortest and
/// longest usual width of a beat at half its height, frames.
pub(super) fn bridge(measured: &[f64], plateau: bool, lasts: [f64; 2]) -> Bridged {
    let mut bad = vec![false; measured.len()];
    lost::mark(measured, &mut bad);
    let mut signal = measured.to_vec();
    bridge_over(&mut signal, &bad);
    let values = &signal[..];
    let undisturbed = without(values, &bad);
    let windows = windows::widths(values.len());
    let filtered = windows::behind(values, &windows);
    let (noise, beats) = usual_in_noise(values, &windows, &filtered, &undisturbed, lasts);
    let Some(beats) = beats else {
        return (measured.to_vec(), Vec::new(), None);
    };
    let sigma = noise.sd;
    narrow(values, &windows, &filtered, &beats, sigma, plateau, &mut bad);
    let mut clean = values.to_vec();
    bridge_over(&mut clean, &bad);
    jumps(&clean, &beats, sigma, plateau, &mut bad);
    bridge_over(&mut clean, &bad);
    below(&clean, &beats, sigma, &mut bad);
    bridge_over(&mut clean, &bad);
    tall(&clean, &beats, &mut bad);
    let cycle = cycle(&beats);
    close_up(cycle, &mut bad);
    let mut clean = measured.to_vec();
    bridge_over(&mut clean, &bad);
    let artefacts = runs(&bad).into_iter().map(|[from, to]| {
        let height = (from..=to)
            .map(|at| measured[at] - clean[at])
            .reduce(|most, other| if other.abs() > most.abs() { other } else { most });
        Artefact { from, to, height: height.unwrap_or(0.0), long: (to - from) as f64 > 1.5 * cycle }
    });
    let artefacts = artefacts.collect();
    (clean, artefacts, Some(beats))
}

/// The noise of a curve and its beats. The correlation time (memory) of the noise is determined
/// from the beats: the longest memory is used unless a shorter one gives more of the same beats.
fn usual_in_noise(
    values: &[f64],
    windows: &[usize],
    filtered: &[Vec<f64>],
    undisturbed: &[f64],
    lasts: [f64; 2],
) -> (Noise, Option<Beats>) {
    let mut noise = Noise::of(undisturbed);
    let mut best: Option<(Noise, Beats)> = None;
    loop {
        let beats = usual::usual(values, windows, filtered, noise, lasts);
        // Noise with a memory of a quarter of a beat consists of beats.
        let fits = |beats: &Beats| 4.0 * noise.memory <= beats.width;
        best = match (beats, best) {
            (Some(beats), None) if noise.memory <= 1.0 || fits(&beats) => Some((noise, beats)),
            (Some(beats), Some((_, longer)))
                if fits(&beats) && beats.replace(&longer, lasts[1]) =>
            {
                Some((noise, beats))
            }
            (_, best) => best,
        };
        if noise.memory <= 1.0 {
            break;
        }
        noise = Noise::up_to(noise.memory as usize / 2, undisturbed);
    }
    best.map_or((noise, None), |(noise, beats)| (noise, Some(beats)))
}

/// A bound, in standard deviations, that noise does not reach in this number of frames. It is wider
/// for few frames, from which noise is estimated less precisely.
fn noise_reach(frames: usize) -> f64 {
    let frames = frames as f64;
    ((2.0 * frames.ln()).sqrt() + 2.5) * (1.0 + 3.0 / frames.sqrt())
}

/// Marks what windows narrower than a beat remove, beyond what they remove from beats.
fn narrow(
    values: &[f64],
    windows: &[usize],
    filtered: &[Vec<f64>],
    beats: &Beats,
    sigma: f64,
    plateau: bool,
    bad: &mut [bool],
) {
    let count = values.len();
    let noisy = noise_reach(count) * sigma;
    let steps = Steps::of(values, beats);
    // The widest window that keeps the beats shows their rest.
    let fits = |window: usize| window as f64 <= (WINDOW * beats.width).max(1.0);
    let widest = windows.iter().rposition(|window| fits(*window)).unwrap_or(0);
    let ground = &filtered[widest];
    for (&window, behind) in windows.iter().zip(filtered) {
        if window == 0 || !fits(window) {
            continue;
        }
        for sign in [1.0, -1.0] {
            let lost: Vec<f64> = (0..count)
                .map(|at| if bad[at] { 0.0 } else { sign * (values[at] - behind[at]) })
                .collect();
            let least = (LEAST * beats.height).max(noisy);
            let top = top_of_beats(&lost, beats, window, plateau);
            let above = |at: usize| {
                let beat = beats.nearest(at);
                let near = beats.tops[beat].abs_diff(at) as f64 <= beats.width;
                let at_beat = top * beats.heights[beat] + 0.7 * noisy;
                lost[at] > if near { at_beat.max(least) } else { least }
            };
            let mut at = 0;
            while at < count {
                if !above(at) {
                    at += 1;
                    continue;
                }
                let mut end = at;
                while end + 1 < count && lost[end + 1] > 0.5 * least {
                    end += 1;
                }
                let most = lost[at..=end].iter().copied().fold(0.0, f64::max);
                let edge = (0.15 * most).max(0.5 * noisy);
                let mut from = at;
                while from > 0 && lost[from - 1] > edge {
                    from -= 1;
                }
                let mut to = at;
                while to < count - 1 && (lost[to + 1] > edge) {
                    to += 1;
                }
                let excursion = Excursion { from, to, sign, most };
                let between = sign < 0.0 && between_beats(values, ground, &excursion, beats);
                if !between && is_artefact(values, &excursion, window, beats, &steps) {
                    bad[from..=to].fill(true);
                }
                at = end.max(to) + 1;
            }
        }
    }
}

/// Largest height that a window removes from the tops (or bottoms) of beats, in their own heights.
fn top_of_beats(lost: &[f64], beats: &Beats, window: usize, plateau: bool) -> f64 {
    let mut largest = vec![0.0_f64; beats.tops.len()];
    for (at, &here) in lost.iter().enumerate() {
        let beat = beats.nearest(at);
        if beats.tops[beat].abs_diff(at) as f64 <= beats.width {
            largest[beat] = largest[beat].max(here / beats.heights[beat]);
        }
    }
    // An artefact among the beats has another width and is left out.
    let mut largest: Vec<f64> = largest
        .iter()
        .zip(&beats.usual)
        .filter(|(_, usual)| **usual)
        .map(|(most, _)| *most)
        .collect();
    largest.sort_by(f64::total_cmp);
    let part = |part: f64| largest[((largest.len() - 1) as f64 * part) as usize];
    // A triangle loses half of the ratio of window to width; other pulses with a single top lose
    // less, or little more.
    let smooth = 1.1 * (window + 1) as f64 / beats.width;
    let (few, usual) = (part(0.1), part(0.4));
    if !plateau && (largest.len() < 4 || few <= smooth) {
        return smooth;
    }
    smooth.max(1.5 * usual + 4.0 * (usual - few))
}

/// A departure that a window removed.
struct Excursion {
    from: usize,
    to: usize,
    /// Direction: 1 up, -1 down.
    sign: f64,
    /// Its largest size.
    most: f64,
}

/// Whether a dip is the rest between two beats, each as wide as a beat.
fn between_beats(values: &[f64], ground: &[f64], dip: &Excursion, beats: &Beats) -> bool {
    let bottom = (dip.from..=dip.to).map(|at| values[at]).fold(f64::INFINITY, f64::min);
    let reach = (3.0 * beats.width) as usize;
    let around = dip.from.saturating_sub(reach)..(dip.to + reach).min(values.len());
    let rest = around.map(|at| ground[at]).fold(f64::INFINITY, f64::min);
    if bottom < rest - 0.3 * beats.height {
        return false;
    }
    let level = bottom + 0.5 * dip.most;
    let left = (0..dip.from).rev().take_while(|&at| values[at] > level).count();
    let right = (dip.to + 1..values.len()).take_while(|&at| values[at] > level).count();
    let of_a_beat = |width: usize| (0.6..2.2).contains(&(width as f64 / beats.width));
    of_a_beat(left) && of_a_beat(right)
}

/// Whether a removed departure is complete, and not the top of something wider.
fn is_artefact(
    values: &[f64],
    excursion: &Excursion,
    window: usize,
    beats: &Beats,
    steps: &Steps,
) -> bool {
    let Excursion { from, to, sign, most } = *excursion;
    let last = values.len() - 1;
    let (up, down) = if sign > 0.0 { (steps.up, steps.down) } else { (steps.down, steps.up) };
    if from == 0 || to == last {
        // A recording may begin or end within a beat, but not with a jump.
        let step = if from == 0 && to < last {
            sign * (values[to] - values[to + 1]) - 1.5 * down
        } else if to == last && from > 0 {
            sign * (values[from] - values[from - 1]) - 1.5 * up
        } else {
            return false;
        };
        return step > 0.5 * most.min(beats.height);
    }
    // A wider pulse continues to fall on both sides of its top.
    let way = (window / 3).max(1);
    let left = from.saturating_sub(1);
    let right = (to + 1).min(last);
    let further = |side: usize, beyond: usize| sign * (values[side] - values[beyond]);
    let falls =
        further(left, left.saturating_sub(way)).min(further(right, (right + way).min(last)));
    falls < 0.5 * most * (way as f64 / (to + 1 - from) as f64).min(1.0)
}

/// The largest steps from one frame to the next that beats usually make.
struct Steps {
    up: f64,
    down: f64,
}

impl Steps {
    fn of(values: &[f64], beats: &Beats) -> Self {
        let mut largest = vec![[0.0_f64; 2]; beats.tops.len()];
        for (at, pair) in values.windows(2).enumerate() {
            let beat = beats.nearest(at);
            if beats.tops[beat].abs_diff(at) as f64 <= 1.5 * beats.width {
                let step = pair[1] - pair[0];
                largest[beat][0] = largest[beat][0].max(step);
                largest[beat][1] = largest[beat][1].max(-step);
            }
        }
        let of = |way: usize| median(largest.iter().map(|both| both[way]).collect());
        Self { up: of(0).min(beats.height), down: of(1).min(beats.height) }
    }
}

/// Marks the frames between a jump that beats do not make and the jump back.
fn jumps(values: &[f64], beats: &Beats, sigma: f64, plateau: bool, bad: &mut [bool]) {
    let mut steps = Steps::of(values, beats);
    if plateau {
        // An action potential may rise from one frame to the next.
        steps.up = steps.up.max(beats.height);
    }
    let noisy = 1.5 * noise_reach(values.len()) * sigma;
    let least = LEAST * beats.height + noisy;
    let step = |at: usize| values[at + 1] - values[at];
    let unusual = |at: usize| {
        let here = step(at);
        let usual = if here > 0.0 { steps.up } else { steps.down };
        here.abs() > least.max(1.7 * usual)
    };
    // Longest artefact: as long as a beat may be, or longer if no beat lies on it. Two beats are
    // not enough to know the usual steps.
    let few = beats.alike < 3.0;
    let near = (if few { 1.0 } else { 3.0 } * beats.width) as usize;
    let last = values.len().saturating_sub(1);
    let far = if few { near } else { last / 3 };
    let edge = beats.width as usize;
    // The highest point of a displaced part is not a beat on it.
    let no_beat = |from: usize, to: usize| {
        let within = from + edge..to.saturating_sub(edge);
        let mut tops = beats.tops.iter().filter(|top| within.contains(top)).peekable();
        if tops.peek().is_none() {
            return true;
        }
        let level = median(values[from + 1..=to].to_vec());
        !tops.any(|&top| values[top] > level + 0.3 * beats.height)
    };
    for at in (0..last).filter(|&at| unusual(at)) {
        if bad[at] && bad[at + 1] {
            continue;
        }
        let jump = step(at);
        let reach = if jump.abs() > 1.2 * beats.height { far } else { near };
        let back = (at.saturating_sub(near)..(at + reach).min(last))
            .filter(|&other| other != at && !(bad[other] && bad[other + 1]))
            // Down after one spike and up with the next: that is the rest between two action
            // potentials.
            .filter(|&other| !plateau || (other > at) == (jump > 0.0))
            .filter(|&other| step(other) * jump < 0.0 && step(other).abs() > 0.5 * jump.abs())
            .filter(|&other| {
                // Away and back: outside, the curve continues as before.
                let (from, to) = (at.min(other), at.max(other));
                (values[to + 1] - values[from]).abs() < 0.5 * jump.abs()
            })
            .min_by_key(|other| other.abs_diff(at))
            .filter(|other| other.abs_diff(at) <= near || no_beat(at, *other));
        if let Some(other) = back {
            bad[at.min(other) + 1..=at.max(other)].fill(true);
        }
    }
}

/// Marks parts far below the rest on both sides.
fn below(values: &[f64], beats: &Beats, sigma: f64, bad: &mut [bool]) {
    let count = beats.tops.len();
    let last = values.len() - 1;
    let middle = |left: usize, right: usize| usize::midpoint(left, right);
    let bounds: Vec<usize> = std::iter::once(0)
        .chain(beats.tops.windows(2).map(|pair| middle(pair[0], pair[1])))
        .chain(std::iter::once(last + 1))
        .collect();
    // The rest of each beat: the 10 % quantile of its frames.
    let rests: Vec<f64> = bounds
        .windows(2)
        .map(|ends| {
            let mut part: Vec<f64> =
                (ends[0]..ends[1]).filter(|at| !bad[*at]).map(|at| values[at]).collect();
            part.sort_by(f64::total_cmp);
            part.get(part.len() / 10).copied().unwrap_or(f64::NAN)
        })
        .collect();
    for beat in 0..count {
        let around = rests[beat.saturating_sub(2)..(beat + 3).min(count)].iter().copied();
        let mut around: Vec<f64> = around.filter(|rest| rest.is_finite()).collect();
        around.sort_by(f64::total_cmp);
        // Drift is not an artefact, so the lower neighbours are used.
        let Some(&rest) = around.get(around.len().saturating_sub(1) / 3) else { continue };
        let noisy = noise_reach(values.len()) * sigma;
        let floor = rest - (BELOW * beats.height + noisy);
        let mut at = bounds[beat];
        while at < bounds[beat + 1] {
            if values[at] < floor && !bad[at] {
                let (mut from, mut to) = (at, at);
                let edge = rest - 0.15 * beats.height - 2.0 * sigma;
                while from > 0 && values[from - 1] < edge {
                    from -= 1;
                }
                while to < last && values[to + 1] < edge {
                    to += 1;
                }
                bad[from..=to].fill(true);
                at = to;
            }
            at += 1;
        }
    }
}

/// Marks pulses far higher than the usual beat, from foot to foot.
fn tall(values: &[f64], beats: &Beats, bad: &mut [bool]) {
    if beats.alike < 3.0 {
        return;
    }
    for peak in persistent(values) {
        if peak.prominence <= TALL * beats.height {
            break;
        }
        if peak.at == 0 || peak.at + 1 == values.len() {
            continue;
        }
        let level = values[peak.at] - 0.95 * peak.prominence;
        let from = (0..peak.at).rev().find(|&at| values[at] < level).map_or(0, |at| at + 1);
        let to = (peak.at..values.len()).find(|&at| values[at] < level);
        let to = to.unwrap_or(values.len()) - 1;
        // The highest beat may lie on a drift of that height.
        if ((to - from) as f64) < 3.0 * beats.width {
            bad[from..=to].fill(true);
        }
    }
}

/// Interval between beats, frames.
fn cycle(beats: &Beats) -> f64 {
    let distances = beats.tops.windows(2).map(|pair| (pair[1] - pair[0]) as f64);
    let usual = median(distances.collect());
    usual.max(if usual > 0.0 { 1.5 } else { 4.0 } * beats.width)
}

/// The values that are not marked.
pub(super) fn without(values: &[f64], bad: &[bool]) -> Vec<f64> {
    values.iter().zip(bad).filter(|(_, bad)| !**bad).map(|(value, _)| *value).collect()
}

/// Marks everything between artefacts that follow each other more closely than beats, over longer
/// than the interval between beats.
fn close_up(cycle: f64, bad: &mut [bool]) {
    let runs = runs(bad);
    let mut first = 0;
    while first < runs.len() {
        let mut last = first;
        let mut marked = runs[first][1] + 1 - runs[first][0];
        while let Some(next) = runs.get(last + 1)
            && ((next[0] - runs[last][1]) as f64) < 0.5 * cycle
        {
            marked += next[1] + 1 - next[0];
            last += 1;
        }
        let (from, to) = (runs[first][0], runs[last][1]);
        let whole = to + 1 - from;
        if last > first && whole as f64 > 2.0 * cycle && 3 * marked > whole {
            bad[from..=to].fill(true);
        }
        first = last + 1;
    }
}

/// Replaces marked frames by lines between the medians of three frames on either side.
fn bridge_over(values: &mut [f64], bad: &[bool]) {
    let good = |side: &mut dyn Iterator<Item = usize>| -> Vec<usize> {
        side.filter(|at| !bad[*at]).take(3).collect()
    };
    for [from, to] in runs(bad) {
        let left = good(&mut (from.saturating_sub(6)..from).rev());
        let right = good(&mut (to + 1..(to + 7).min(values.len())));
        let of = |side: &[usize]| {
            if to == from {
                side.first().map(|at| values[*at])
            } else {
                (!side.is_empty()).then(|| median(side.iter().map(|at| values[*at]).collect()))
            }
        };
        let (before, after) = (of(&left), of(&right));
        let width = (to + 2 - from) as f64;
        for at in from..=to {
            let part = (at + 1 - from) as f64 / width;
            values[at] = match (before, after) {
                (Some(before), Some(after)) => before + part * (after - before),
                (Some(one), None) | (None, Some(one)) => one,
                (None, None) => values[at],
            };
        }
    }
}
