//! Which cells are not simulated, why, and the notes on them.

use crate::microscopy::cells::{PictureCell, PictureCells};
use std::fmt;

/// How many notes on single cells are shown with a picture.
const MOST_NOTES: usize = 12;

/// The notes shown with a picture: cells that are left out, grouped by reason.
pub(super) fn notes(
    cells: &PictureCells,
    chosen: &[PictureCell],
    left_out: impl Fn(&PictureCell) -> Option<LeftOut>,
) -> Vec<String> {
    let (mut notes, mut cut, mut unusual, mut others) =
        (cells.notes.clone(), Vec::new(), Vec::new(), Vec::new());
    for cell in chosen {
        let who = if chosen.len() > 1 { format!("cell {}: ", cell.name) } else { String::new() };
        match left_out(cell) {
            Some(LeftOut::Cut { .. }) => cut.push(cell.name.clone()),
            Some(LeftOut::Area(_)) => {
                unusual.push(format!("{} ({:.0} um^2)", cell.name, cell.shape.area_um2));
            }
            Some(doubtful @ LeftOut::Doubtful(_)) => {
                others.push(format!("{who}left out: {doubtful}"));
            }
            None => others.extend(cell.warnings().map(|warning| format!("{who}{warning}"))),
        }
    }
    if !cut.is_empty() {
        notes.push(format!(
            "left out because the frame cuts them (--allow-cut includes them): {}",
            cut.join(", ")
        ));
    }
    if !unusual.is_empty() {
        let unusual = unusual.join(", ");
        notes.push(format!("left out because of their size (--min-area, --max-area): {unusual}"));
    }
    let more = others.len().saturating_sub(MOST_NOTES);
    notes.extend(others.into_iter().take(MOST_NOTES));
    if more > 0 {
        notes.push(format!("and {more} more such notes, listed in the table"));
    }
    notes
}

/// Why a cell is not simulated.
pub(super) enum LeftOut {
    /// The frame cuts it, with so many of its pixels on it.
    Cut { pixels: usize },
    /// Its area is not as expected.
    Area(String),
    /// Its outline is doubtful.
    Doubtful(String),
}

impl LeftOut {
    /// Why a cell is left out; `None` if it is simulated.
    pub(super) fn of(cells: &PictureCells, cell: &PictureCell, allow_cut: bool) -> Option<Self> {
        let pixels = cell.shape.pixels_on_frame;
        if pixels > 0 && !allow_cut {
            return Some(Self::Cut { pixels });
        }
        if let Some(unusual) = cells.unusual_area(cell) {
            return Some(Self::Area(unusual));
        }
        let (score, reasons) = (cell.confidence.score, &cell.confidence.reasons);
        let doubtful = || format!("confidence {score:.2} of 1: {}", reasons.join("; "));
        cell.confidence.is_doubtful().then(|| Self::Doubtful(doubtful()))
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cut { pixels } => {
                write!(out, "the frame cuts it ({pixels} pixels); --allow-cut includes it")
            }
            Self::Area(reason) => out.write_str(reason),
            Self::Doubtful(reason) => write!(out, "doubtful, {reason}"),
        }
    }
}
