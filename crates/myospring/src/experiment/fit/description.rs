//! What is fitted, to what, and how.

use super::calcium::RecordedCalcium;
use super::curves::EndSprings;
use super::traction::TractionCurve;
use crate::experiment::BeatOptions;
use crate::experiment::input::ChosenSetting;
use crate::experiment::refused::Place;
use crate::fit::FitOptions;
use crate::measured::TableOptions;
use std::path::PathBuf;

/// What is fitted, to what, and how.
#[derive(Default)]
pub struct FitCell {
    /// A picture, an outline or a run file of the cell; `None`: the cell of the film, or the built-in one.
    pub cell: Option<PathBuf>,
    /// Tables of curves and folders of them, each curve a cell; or one film. Without any `cell` is the film or the table.
    pub to: Vec<PathBuf>,
    /// Settings, which override those of a run file.
    pub settings: Vec<ChosenSetting>,
    /// How tables are read; for a film its frame rate, its curve (`values`) and the part that
    /// counts.
    pub table: TableOptions,
    /// When the cell was stimulated.
    pub beats: BeatOptions,
    /// Curves of the same cell between springs.
    pub loaded: Vec<EndSprings>,
    /// Forces of the same cell on gels.
    pub traction: Vec<TractionCurve>,
    /// Relative standard deviation of the scale of these forces; `None`: [`SCALE_ERROR`](super::SCALE_ERROR).
    pub traction_error: Option<f64>,
    /// Calcium that was recorded together with the curve.
    pub calcium: RecordedCalcium,
    /// Which numbers are fitted.
    pub sought: FitOptions,
    /// Threads of the fits; `None` takes as many as there are cores.
    pub threads: Option<usize>,
    /// Where the overlay of a picture goes in which no cell is accepted.
    pub refused: Option<Place>,
}
