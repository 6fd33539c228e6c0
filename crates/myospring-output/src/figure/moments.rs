//! Chooses the characteristic frames of a beat.

use myospring_core::recording::{Frame, Recording};

/// A cell that shortens by less than this, per cent, is held.
pub(super) const LEAST_SHORTENING: f64 = 0.1;

/// A frame with its labels; `D` = 3 of a thick cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape<'a, const D: usize = 2> {
    /// Short name: `at rest`, `peak`.
    pub name: String,
    /// The shape.
    pub frame: &'a Frame<D>,
    /// Shortening, per cent of the resting length, if known.
    pub shortening_pct: Option<f64>,
}

/// The characteristic frames of the first beat: at rest, contracting (nearest half of the peak),
/// peak, relaxing (nearest half again).
///
/// Rest is the last frame up to the first stimulus, else the first of all. The beat ends at the
/// second stimulus. A run that ended early gives only the moments that it reached; if its last
/// frame is the most shortened one, it is named `end of record`, because the peak is not known.
/// Frames with positions that are not finite are skipped.
///
/// # Example
/// ```
/// use myospring::output::figure::key_shapes;
/// use myospring::recording::Recording;
/// assert!(key_shapes(&Recording::default(), &[50.0]).is_empty());
/// ```
pub fn key_shapes<'a>(recording: &'a Recording, stimulus_times_ms: &[f64]) -> Vec<Shape<'a>> {
    let mut stimuli: Vec<f64> =
        stimulus_times_ms.iter().copied().filter(|t| t.is_finite()).collect();
    stimuli.sort_by(f64::total_cmp);
    let frames: Vec<&Frame> = recording
        .frames
        .iter()
        .filter(|frame| frame.positions.iter().flatten().all(|x| x.is_finite()))
        .collect();
    let before = frames.iter().rposition(|frame| stimuli.first().is_some_and(|&t| frame.t_ms <= t));
    let rest = before.unwrap_or(0);
    let end = frames
        .iter()
        .position(|frame| stimuli.get(1).is_some_and(|&t| frame.t_ms > t))
        .unwrap_or(frames.len());
    let Some(beat) = frames.get(rest..end).filter(|beat| !beat.is_empty()) else {
        return Vec::new();
    };
    let shortening: Vec<Option<f64>> =
        beat.iter().map(|frame| shortening_at(recording, frame.t_ms)).collect();
    // Progress of the beat at each frame: shortening, or tension if there is no shortening.
    let most = shortening.iter().flatten().copied().fold(0.0, f64::max);
    let told = if most > LEAST_SHORTENING { shortening.as_slice() } else { &[] };
    let told = told.iter().copied().chain(std::iter::repeat(None));
    let progress: Vec<f64> =
        beat.iter().zip(told).map(|(frame, s)| s.unwrap_or(frame.ta_kpa)).collect();
    moments(&progress)
        .into_iter()
        .map(|(i, name)| Shape {
            name: name.to_owned(),
            frame: beat[i],
            shortening_pct: shortening[i],
        })
        .collect()
}

/// A thick cell in space at rest and at its peak, of the shapes of [`key_shapes`]; empty of a flat cell.
///
/// # Example
/// ```
/// use myospring::output::figure::key_shapes_in_space;
/// use myospring::recording::Recording;
/// assert!(key_shapes_in_space(&Recording::default(), &[50.0]).is_empty());
/// ```
pub fn key_shapes_in_space<'a>(
    recording: &'a Recording,
    stimulus_times_ms: &[f64],
) -> Vec<Shape<'a, 3>> {
    let shapes = key_shapes(recording, stimulus_times_ms).into_iter();
    let two = shapes.filter(|shape| !["contracting", "relaxing"].contains(&&*shape.name));
    two.filter_map(|Shape { name, frame, shortening_pct }| {
        let frame = recording.in_space.iter().find(|other| other.t_ms == frame.t_ms)?;
        Some(Shape { name, frame, shortening_pct })
    })
    .collect()
}

/// The characteristic places of a beat, in order, by its progress from rest: `at rest` (the first), `contracting` and
/// `relaxing` (nearest half of the peak before and after it) and `peak`, or `end of record` if that is the last.
///
/// # Example
/// ```
/// use myospring::output::figure::moments;
/// let beat = [0.0, 0.1, 0.6, 1.0, 0.9, 0.4, 0.1];
/// assert_eq!(moments(&beat), [(0, "at rest"), (2, "contracting"), (3, "peak"), (5, "relaxing")]);
/// ```
pub fn moments(progress: &[f64]) -> Vec<(usize, &'static str)> {
    let count = progress.len();
    let Some(top) =
        (0..count).reduce(|best, i| if progress[i] > progress[best] { i } else { best })
    else {
        return Vec::new();
    };
    let half = f64::midpoint(progress[0], progress[top]);
    let nearest_half = |range: std::ops::Range<usize>| {
        range.min_by(|&a, &b| (progress[a] - half).abs().total_cmp(&(progress[b] - half).abs()))
    };
    let top_name = if top + 1 == count { "end of record" } else { "peak" };
    let mut moments = vec![(0, "at rest")];
    if top > 0 {
        moments.extend(nearest_half(1..top).map(|i| (i, "contracting")));
        moments.push((top, top_name));
        moments.extend(nearest_half(top + 1..count).map(|i| (i, "relaxing")));
    }
    moments
}

/// Shortening at a time, interpolated linearly between samples; `None` outside the samples.
fn shortening_at(recording: &Recording, t_ms: f64) -> Option<f64> {
    let samples = &recording.samples;
    // Times of frames and samples may differ by rounding errors of summed steps.
    let after = samples.partition_point(|sample| sample.t_ms < t_ms - 1e-6);
    let next = samples.get(after)?;
    let value = match after.checked_sub(1).and_then(|before| samples.get(before)) {
        Some(last) if next.t_ms > t_ms => {
            let part = (t_ms - last.t_ms) / (next.t_ms - last.t_ms);
            last.shortening_pct + part * (next.shortening_pct - last.shortening_pct)
        }
        _ if (next.t_ms - t_ms).abs() <= 1e-6 => next.shortening_pct,
        _ => return None,
    };
    value.is_finite().then_some(value)
}
