//! The numbers of mapped waves.

use crate::analysis::wave::ACTIVATION_TIME;
use crate::analysis::{Metric, Spread, beat_to_beat, value};
use crate::microscopy::film::Film;
use crate::microscopy::optical::{OpticalMap, OpticalSettings};
use serde::Serialize;
use std::path::Path;

/// Frames that a wave must take to cross the tissue, so that nothing is said.
const FEW_FRAMES: f64 = 5.0;
/// Noise of a point over the height of its beats from which on 90 % repolarisation is not read well.
const NOISY: f64 = 0.05;

/// Part of the changes of light that may go against those of a beat.
const AGAINST: f64 = 0.15;

/// A wave.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WaveReport {
    /// When it begins, ms from the first frame: its stimulus, or when the first hundredth of the points is activated.
    pub begins_ms: f64,
    /// Its numbers.
    pub metrics: Vec<Metric>,
}

/// Every number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OpticalReport {
    /// The film.
    pub film: String,
    /// Its frames, and how many were read.
    pub frames: usize,
    /// See above.
    pub frames_read: usize,
    /// Frames a second.
    pub frames_per_second: f64,
    /// Side of a pixel, um.
    pub pixel_size_um: f64,
    /// Side of a point of the map, pixels.
    pub pixels_of_a_point: usize,
    /// Points of the map.
    pub points: usize,
    /// Part of them that beat, %.
    pub beating_pct: f64,
    /// Whether the light falls in a beat.
    pub falls: bool,
    /// Whether activation is counted from stimuli; otherwise from the first points that are activated.
    pub stimulated: bool,
    /// Noise of a point, % of the height of its beats; the median.
    pub noise_pct: f64,
    /// The waves.
    pub waves: Vec<WaveReport>,
    /// Mean and standard deviation over them.
    pub spread: Vec<Spread>,
    /// Warnings.
    pub warnings: Vec<String>,
}

impl OpticalReport {
    pub(super) fn of(
        path: &Path,
        film: &Film,
        settings: &OpticalSettings,
        map: &OpticalMap,
    ) -> Self {
        let points = map.mesh.len();
        let beating = map.wave.beats.iter().filter(|beats| !beats.is_empty()).count();
        let waves: Vec<WaveReport> = map
            .beats
            .iter()
            .map(|beat| WaveReport { begins_ms: beat.begins_ms, metrics: beat.metrics.clone() })
            .collect();
        let all: Vec<Vec<Metric>> = waves.iter().map(|wave| wave.metrics.clone()).collect();
        let mut warnings = film.notes.clone();
        let step_ms = 1000.0 / settings.frames_per_second;
        let crossed = |wave: &WaveReport| {
            let last = value(&wave.metrics, ACTIVATION_TIME)?;
            let own = map.beats.iter().find(|beat| beat.begins_ms == wave.begins_ms)?;
            let first = own.map.activation_ms.iter().flatten().copied().reduce(f64::min)?;
            Some((last - first) / step_ms)
        };
        let fewest = waves.iter().filter_map(crossed).reduce(f64::min);
        if let Some(frames) = fewest.filter(|frames| *frames < FEW_FRAMES) {
            warnings.push(format!(
                "a wave crosses the tissue within {frames:.1} frames: its conduction velocity is hardly resolved; record more frames a second, or a \
                 larger part of the tissue"
            ));
        }
        if map.against > AGAINST {
            warnings.push(format!(
                "{:.0} % of the changes of light go against those of a beat: the tissue moves, or this is no film of a dye; do not trust the map",
                100.0 * map.against
            ));
        }
        if map.noise > NOISY {
            warnings.push(format!(
                "the noise of a point is {:.0} % of the height of its beats (median): durations to 90 % repolarisation are not read well",
                100.0 * map.noise
            ));
        }
        if map.interrupted {
            warnings.push(format!(
                "interrupted: {} of {} frames were read",
                map.times_ms.len(),
                film.len()
            ));
        }
        Self {
            film: path.display().to_string(),
            frames: film.len(),
            frames_read: map.times_ms.len(),
            frames_per_second: settings.frames_per_second,
            pixel_size_um: settings.pixel_um,
            pixels_of_a_point: map.block,
            points,
            beating_pct: 100.0 * beating as f64 / points as f64,
            falls: map.falls,
            stimulated: !settings.stimuli_ms.is_empty(),
            noise_pct: 100.0 * map.noise,
            spread: beat_to_beat(&all),
            waves,
            warnings,
        }
    }
}
