//! Waves in a film of tissue whose light shows its potential or its calcium (optical mapping).
//!
//! ```text
//! film -> points of a grid, each a curve -> its beats -> when each point was activated, beat by beat -> WaveMap
//! ```
//!
//! 1. *Points* are pixels, or blocks of pixels of a large frame, smoothed by a Gaussian of one point.
//! 2. *Direction.* Some dyes darken with the potential. An upstroke is steeper than what follows, so the sum of the cubes of the
//!    changes from frame to frame has its sign.
//! 3. *Beats* of a point are those of its curve ([`curve::analyse`], as of any measured potential). A point is activated when it has risen
//!    by half of its height, and has repolarised when a tenth is left. Points with less than a fifth of the usual height
//!    show light scattered from elsewhere and have no beat.
//! 4. *Single points* that differ from all around them are errors: each has the median of its neighbours and its own time.
//! 5. *Velocity* is 1 over the gradient of a parabola fitted to the activation times within three points (`bayly_1998`).

mod fitted;

use crate::film::{Film, FilmError};
use crate::filter::{coarse, gaussian};
use fitted::{fitted_slopes, middling};
use myospring_core::analysis::Metric;
use myospring_core::analysis::curve::{self, Analysis, CurveError, CurveOptions, State};
use myospring_core::analysis::kind::Kind;
use myospring_core::analysis::order::{median, quantile};
use myospring_core::analysis::wave::WaveMap;
use myospring_core::mesh::Mesh;
use myospring_core::mesh::lattice::{self, LatticeError};
use myospring_core::recording::{LocalBeat, Wave};
use rayon::prelude::*;

/// Points of the grid, at most; and along each side, at least.
const MOST_POINTS: usize = 10_000;
const FEWEST: usize = 4;
/// Standard deviation of the Gaussian, points.
const SMOOTHED: f64 = 1.0;
/// Points with less than this part of the usual height show light from elsewhere.
const SCATTERED: f64 = 0.2;
/// Part of the points that beat, and number of points, that must be in a wave for it to count.
const FEW: f64 = 0.05;
const FEW_POINTS: f64 = 12.0;
/// A wave begins when this part of its points is activated, and ends when this part is left: single points err.
const ERRING: f64 = 0.01;

/// What a film does not say.
#[derive(Debug, Clone, PartialEq)]
pub struct OpticalSettings {
    /// Frames a second.
    pub frames_per_second: f64,
    /// Side of a pixel, um.
    pub pixel_um: f64,
    /// Times of stimuli, ms from the first frame; without any, activation is counted from where each wave begins.
    pub stimuli_ms: Vec<f64>,
    /// Whether the light falls in a beat; `None` finds out.
    pub falls: Option<bool>,
}

/// Why a film gives no map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OpticalError {
    /// A frame cannot be read.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A frame that is too small.
    #[error("frames have {columns} x {rows} pixels; a map needs at least {FEWEST} each way")]
    Small {
        /// Columns.
        columns: usize,
        /// Rows.
        rows: usize,
    },
    /// No grid of that pixel size.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// No point beats.
    #[error(
        "no beat is seen in the light of any of {points} points; of the frame as a whole: {cause}"
    )]
    NoBeat {
        /// How many points were looked at.
        points: usize,
        /// What is said of the mean of all.
        cause: CurveError,
    },
    /// Points that beat alone.
    #[error(
        "{beating} of {points} points seem to beat, but not with their neighbours: this is noise"
    )]
    NoWave {
        /// How many points were looked at.
        points: usize,
        /// How many of them seem to beat.
        beating: usize,
    },
}

/// One wave.
#[derive(Debug, Clone, PartialEq)]
pub struct MappedBeat {
    /// When it begins, ms: its stimulus, or when the first points are activated.
    pub begins_ms: f64,
    /// When each point was activated, and for how long.
    pub map: WaveMap,
    /// Its numbers, as of a simulated tissue.
    pub metrics: Vec<Metric>,
}

/// What a film shows of waves.
#[derive(Debug, Clone, PartialEq)]
pub struct OpticalMap {
    /// The grid of points: the frame, y upward, from 0.
    pub mesh: Mesh,
    /// Pixels of a point along each side.
    pub block: usize,
    /// Whether the light falls in a beat.
    pub falls: bool,
    /// Times of the frames, ms.
    pub times_ms: Vec<f64>,
    /// Mean light of the points that beat, frame by frame; rises in a beat.
    pub mean: Vec<f64>,
    /// The beats of each point.
    pub wave: Wave,
    /// The waves, in order of time.
    pub beats: Vec<MappedBeat>,
    /// The median of all waves, point by point.
    pub typical: WaveMap,
    /// Median noise of a point, as a part of the height of its beats.
    pub noise: f64,
    /// Part of the light's changes from rest to peak that go against the beat: near 0 for a dye in a still tissue, near a half where things
    /// move.
    pub against: f64,
    /// Whether it was interrupted before all frames were read.
    pub interrupted: bool,
}

/// What the curve of a point shows.
struct Point {
    beats: Vec<LocalBeat>,
    height: f64,
    noise: f64,
}

impl OpticalMap {
    /// The waves of a film. `goes_on` is told how many frames of how many were read, and may end that.
    ///
    /// # Errors
    /// Frames that cannot be read or are too small, and light that shows no beat.
    ///
    /// # Example
    /// A wave from left to right at 20 cm/s, 500 frames a second, in pixels of 0.1 mm:
    /// ```
    /// use myospring::analysis::value;
    /// use myospring::microscopy::film::Film;
    /// use myospring::microscopy::optical::{OpticalMap, OpticalSettings};
    /// use myospring::microscopy::picture::Selection;
    /// let mut bytes = b"YUV4MPEG2 W24 H12 F500:1 Cmono\n".to_vec();
    /// for frame in 0..300 {
    ///     bytes.extend(b"FRAME\n");
    ///     for pixel in 0..24 * 12 {
    ///         let since = 2.0 * f64::from(frame) - 100.0 - f64::from(pixel % 24) * 0.5;
    ///         let up = 1.0 / (1.0 + (-since / 3.0).exp()) / (1.0 + ((since - 200.0) / 20.0).exp());
    ///         bytes.push((100.0 + 100.0 * up) as u8);
    ///     }
    /// }
    /// let film = Film::read(bytes, &Selection::default())?;
    /// let settings = OpticalSettings { frames_per_second: 500.0, pixel_um: 100.0, stimuli_ms: Vec::new(), falls: None };
    /// let map = OpticalMap::of(&film, &settings, |_| true)?;
    /// assert!(!map.falls && map.beats.len() == 1);
    /// let velocity = value(&map.beats[0].metrics, "conduction_velocity").unwrap();
    /// assert!((velocity - 20.0).abs() < 1.0, "{velocity} cm/s");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(
        film: &Film,
        settings: &OpticalSettings,
        goes_on: impl FnMut((usize, usize)) -> bool,
    ) -> Result<Self, OpticalError> {
        let [columns, rows] = film.size();
        let block = ((columns * rows) as f64 / MOST_POINTS as f64).sqrt().ceil().max(1.0) as usize;
        let size = [columns, rows].map(|side| side.div_ceil(block));
        if size.into_iter().any(|side| side < FEWEST) {
            return Err(OpticalError::Small { columns, rows });
        }
        let (frames, interrupted) = points(film, block, goes_on)?;
        let step_ms = 1000.0 / settings.frames_per_second;
        let times_ms: Vec<f64> = (0..frames.len()).map(|frame| step_ms * frame as f64).collect();
        let falls = settings.falls.unwrap_or_else(|| changes_downward(&frames));
        let sign = if falls { -1.0 } else { 1.0 };
        let stimuli_ms = settings.stimuli_ms.clone();
        let options = CurveOptions { stimuli_ms, ..CurveOptions::default() };
        let look = |at: usize| {
            let values: Vec<f64> = frames.iter().map(|frame| sign * f64::from(frame[at])).collect();
            Point::of(&times_ms, &values, &options)
        };
        let count = size[0] * size[1];
        let mut found: Vec<Option<Point>> = (0..count).into_par_iter().map(look).collect();
        let usual = quantile(found.iter().flatten().map(|point| point.height), 0.9);
        for point in &mut found {
            if point.as_ref().is_some_and(|it| it.height < SCATTERED * usual.unwrap_or(0.0)) {
                *point = None;
            }
        }
        let beating: Vec<usize> = (0..count).filter(|at| found[*at].is_some()).collect();
        let all: Vec<usize> = (0..count).collect();
        let mean = mean(&frames, if beating.is_empty() { &all } else { &beating }, sign);
        let whole = curve::analyse(&times_ms, &mean, Kind::Potential, "", &options);
        let noise = median(found.iter().flatten().map(|it| it.noise / it.height));
        let (Ok(whole), Some(noise)) = (&whole, noise) else {
            let cause = whole.err().unwrap_or(CurveError::Few { frames: frames.len() });
            return Err(OpticalError::NoBeat { points: count, cause });
        };
        let spacing = settings.pixel_um * block as f64;
        let mesh = lattice::rectangle(size[0] - 1, size[1] - 1, spacing)?;
        let beats_of = |[column, row]: [usize; 2]| {
            let point = found[column + size[0] * row].as_ref();
            point.map_or_else(Vec::new, |point| point.beats.clone())
        };
        let wave = Wave {
            points: mesh.points.clone(),
            triangles: mesh.simplices.iter().map(|triangle| triangle.nodes).collect(),
            beats: pixels(&mesh).map(beats_of).collect(),
            tips: Vec::new(),
        };
        let middles: Vec<f64> =
            whole.beats.iter().filter_map(|beat| Some(halfway_up(beat)?[0])).collect();
        let beats = waves(&mesh, &wave, spacing, &middles, &settings.stimuli_ms, beating.len());
        if beats.is_empty() {
            return Err(OpticalError::NoWave { points: count, beating: beating.len() });
        }
        let typical = typical(&beats, &wave);
        let against = against(&frames, &times_ms, whole, sign);
        Ok(Self {
            mesh,
            block,
            falls,
            times_ms,
            mean,
            wave,
            beats,
            typical,
            noise,
            against,
            interrupted,
        })
    }
}

impl OpticalMap {
    /// Values of points as they lie in the frame, row by row from the top; NaN where there is none.
    pub fn in_frame(&self, values: &[Option<f64>]) -> Vec<Vec<f64>> {
        let [columns, rows] =
            [0, 1].map(|axis: usize| 1 + pixels(&self.mesh).map(|at| at[axis]).max().unwrap_or(0));
        let mut frame = vec![vec![f64::NAN; columns]; rows];
        for ([column, row], value) in pixels(&self.mesh).zip(values) {
            frame[row][column] = value.unwrap_or(f64::NAN);
        }
        frame
    }
}

/// Column and row of each point of a grid, from the upper left.
fn pixels(mesh: &Mesh) -> impl Iterator<Item = [usize; 2]> + '_ {
    let cells = || mesh.lattice.iter().flat_map(|lattice| &lattice.cells);
    let top = cells().map(|cell| cell[1]).max().unwrap_or(0);
    cells().map(move |&[column, up]| [column as usize, (top - up) as usize])
}

/// The light of each point, frame by frame, and whether reading was ended before the last.
fn points(
    film: &Film,
    block: usize,
    mut goes_on: impl FnMut((usize, usize)) -> bool,
) -> Result<(Vec<Vec<f32>>, bool), FilmError> {
    let mut frames = Vec::with_capacity(film.len());
    for frame in 0..film.len() {
        if !goes_on((frame, film.len())) {
            return Ok((frames, true));
        }
        let plane = gaussian(&coarse(&film.frame(frame)?, block), SMOOTHED);
        frames.push(plane.values().to_vec());
    }
    Ok((frames, false))
}

/// Whether the steepest changes are downward: the sign of the sum of their cubes, over two frames so that noise counts less.
fn changes_downward(frames: &[Vec<f32>]) -> bool {
    let cubes = |pair: (&Vec<f32>, &Vec<f32>)| -> f64 {
        pair.0.iter().zip(pair.1).map(|(a, b)| f64::from(b - a).powi(3)).sum()
    };
    frames.iter().zip(frames.iter().skip(2)).map(cubes).sum::<f64>() < 0.0
}

/// The part of the light's changes from rest to peak that go against the beat.
fn against(frames: &[Vec<f32>], times_ms: &[f64], whole: &Analysis, sign: f64) -> f64 {
    let (mut against, mut all) = (0.0, 0.0);
    for beat in &whole.beats {
        let peak = beat.marks.iter().find(|mark| mark.name == "peak");
        let (Some(onset), Some(peak)) = (beat.onset_ms, peak) else { continue };
        let at = |time: f64| {
            times_ms.partition_point(|other| *other < time).min(frames.len().saturating_sub(1))
        };
        for (rest, top) in frames[at(onset)].iter().zip(&frames[at(peak.point.time)]) {
            let change = sign * f64::from(top - rest);
            against += (-change).max(0.0);
            all += change.abs();
        }
    }
    if all > 0.0 { against / all } else { 0.0 }
}

/// The mean of some points, frame by frame.
fn mean(frames: &[Vec<f32>], points: &[usize], sign: f64) -> Vec<f64> {
    let of = |frame: &Vec<f32>| {
        sign * points.iter().map(|&at| f64::from(frame[at])).sum::<f64>() / points.len() as f64
    };
    frames.iter().map(of).collect()
}

/// When a beat has risen by half of its height, ms, and its light then; `None` if the film begins within it.
fn halfway_up(beat: &curve::CurveBeat) -> Option<[f64; 2]> {
    if beat.state == State::CutAtStart {
        return None;
    }
    let mark = beat.marks.iter().find(|mark| mark.name == "50 % up")?;
    Some([mark.point.time, mark.point.value])
}

/// When values first rise through a level between two times, ms.
fn risen(times_ms: &[f64], values: &[f64], [from, to]: [f64; 2], level: f64) -> Option<f64> {
    let pairs = times_ms.windows(2).zip(values.windows(2));
    let mut within = pairs.filter(|(times, _)| times[1] > from && times[0] < to);
    within.find_map(|(times, values)| {
        let part = (level - values[0]) / (values[1] - values[0]);
        (values[0] <= level && values[1] > level).then(|| times[0] + part * (times[1] - times[0]))
    })
}

impl Point {
    fn of(times_ms: &[f64], values: &[f64], options: &CurveOptions) -> Option<Self> {
        let found = curve::analyse(times_ms, values, Kind::Potential, "", options).ok()?;
        let beat = |beat: &curve::CurveBeat| {
            let down = beat.marks.iter().find(|mark| mark.name == "90 % down");
            let repolarised_ms = down.map(|mark| mark.point.time);
            let [mut activated_ms, light] = halfway_up(beat)?;
            if let (State::Disturbed, Some(onset)) = (beat.state, beat.onset_ms) {
                // A spike at the top of the upstroke may have been left out as an artefact.
                let early = risen(times_ms, values, [onset, activated_ms], light);
                activated_ms = early.unwrap_or(activated_ms);
            }
            Some(LocalBeat { activated_ms, repolarised_ms })
        };
        let beats: Vec<LocalBeat> = found.beats.iter().filter_map(beat).collect();
        let ends = [0.02, 0.98].map(|part| quantile(found.read.iter().copied(), part));
        let [Some(low), Some(high)] = ends else { return None };
        let height = high - low;
        (!beats.is_empty() && height > 0.0).then_some(Self {
            beats,
            height,
            noise: found.treatment.noise,
        })
    }
}

/// The waves. An activation belongs to the wave whose middle is nearest in time.
fn waves(
    mesh: &Mesh,
    wave: &Wave,
    spacing: f64,
    middles: &[f64],
    stimuli_ms: &[f64],
    beating: usize,
) -> Vec<MappedBeat> {
    let between = |a: f64, b: f64| f64::midpoint(a, b);
    let mut all = Vec::new();
    for (number, &middle) in middles.iter().enumerate() {
        let from = match number.checked_sub(1) {
            Some(before) => between(middles[before], middle),
            None => f64::NEG_INFINITY,
        };
        let to = middles.get(number + 1).map_or(f64::INFINITY, |after| between(middle, *after));
        let own = |beats: &Vec<LocalBeat>| {
            beats.iter().copied().find(|beat| (from..to).contains(&beat.activated_ms))
        };
        let own: Vec<Option<LocalBeat>> = wave.beats.iter().map(own).collect();
        let times: Vec<Option<f64>> =
            own.iter().map(|beat| Some(beat.as_ref()?.activated_ms)).collect();
        let duration = |beat: &Option<LocalBeat>| {
            let beat = beat.as_ref()?;
            Some(beat.repolarised_ms? - beat.activated_ms)
        };
        let durations: Vec<Option<f64>> = own.iter().map(duration).collect();
        let times = middling(mesh, &times);
        let known = || times.iter().flatten().copied();
        if (known().count() as f64) < (FEW * beating as f64).max(FEW_POINTS) {
            continue;
        }
        let Some(first) = quantile(known(), ERRING) else { continue };
        let Some(last) = quantile(known(), 1.0 - ERRING) else { continue };
        let stimulus = stimuli_ms.iter().copied().filter(|time| (from..=first).contains(time));
        let begins_ms = stimulus.reduce(f64::max).unwrap_or(first);
        // What is beyond errs.
        let since = |time: &Option<f64>| time.map(|time| time.clamp(first, last) - begins_ms);
        let activation_ms: Vec<Option<f64>> = times.iter().map(since).collect();
        let map = with_velocities(mesh, wave, spacing, activation_ms, middling(mesh, &durations));
        let metrics = map.metrics(wave);
        all.push(MappedBeat { begins_ms, map, metrics });
    }
    all
}

/// The map of these times and durations.
fn with_velocities(
    mesh: &Mesh,
    wave: &Wave,
    spacing: f64,
    activation_ms: Vec<Option<f64>>,
    duration_ms: Vec<Option<f64>>,
) -> WaveMap {
    let slopes = fitted_slopes(mesh, spacing, &activation_ms);
    let velocity = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|node| slopes[node as usize]);
        let ([ax, ay], [bx, by], [cx, cy]) = (a?, b?, c?);
        // 1 um/ms is 0.1 cm/s.
        Some(0.3 / (ax + bx + cx).hypot(ay + by + cy)).filter(|velocity| velocity.is_finite())
    };
    let velocity_cm_per_s = wave.triangles.iter().map(velocity).collect();
    WaveMap { activation_ms, duration_ms, velocity_cm_per_s }
}

/// The median of waves, place by place; where fewer than half of them went, none.
fn typical(beats: &[MappedBeat], wave: &Wave) -> WaveMap {
    let median_of = |count: usize, of: &dyn Fn(&WaveMap, usize) -> Option<f64>| {
        let one = |at: usize| {
            let known: Vec<f64> = beats.iter().filter_map(|beat| of(&beat.map, at)).collect();
            if 2 * known.len() < beats.len() { None } else { median(known) }
        };
        (0..count).map(one).collect::<Vec<Option<f64>>>()
    };
    WaveMap {
        activation_ms: median_of(wave.beats.len(), &|map, at| map.activation_ms[at]),
        duration_ms: median_of(wave.beats.len(), &|map, at| map.duration_ms[at]),
        velocity_cm_per_s: median_of(wave.triangles.len(), &|map, at| map.velocity_cm_per_s[at]),
    }
}
