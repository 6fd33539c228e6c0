//! The reference beat: one default beat of a model.

use super::cell_model::CellModel;
use super::settings::SolveError;

/// Length of the reference beat, ms, stimulus at 50 ms.
pub const REFERENCE_BEAT_MS: f64 = 600.0;

/// Peak of tension of one default beat of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceBeat {
    /// Highest tension, relative or in kPa as the model says.
    pub peak_tension: f64,
    /// Its time, ms; the stimulus is at [`Protocol::DEFAULT_START_MS`](super::pacing::Protocol).
    pub peak_time_ms: f64,
}

impl ReferenceBeat {
    /// Makes the reference beat from a peak of tension (value, time in ms), if it is positive and
    /// before `last_ms`.
    pub(super) fn of(
        model: &dyn CellModel,
        peak: Option<(f64, f64)>,
        last_ms: f64,
    ) -> Result<Self, SolveError> {
        match peak {
            Some((peak_tension, peak_time_ms)) if peak_tension > 0.0 && peak_time_ms < last_ms => {
                Ok(Self { peak_tension, peak_time_ms })
            }
            other => Err(SolveError::NoPeak {
                model: model.name().to_owned(),
                duration_ms: REFERENCE_BEAT_MS,
                value: other.map_or(f64::NAN, |(value, _)| value),
                time_ms: other.map_or(f64::NAN, |(_, time_ms)| time_ms),
            }),
        }
    }
}
