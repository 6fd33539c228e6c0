//! The overlay of a picture in which no cell is accepted.

use super::error::ExperimentError;
use super::files::Files;
use super::folder::Folder;
use super::overlay;
use super::segment::report::{Chosen, SegmentReport};
use crate::microscopy::cells::{CellError, PictureCell, PictureCells};
use crate::microscopy::segment::{Choice, SegmentError};
use crate::output::files::{MANIFEST, Manifest};
use crate::output::json;
use crate::run_file::{Shape, ShapeBytes, ShapeError, Source};
use std::path::{Path, PathBuf};

/// Resolution of the overlay, dots per inch.
const DPI: f64 = 200.0;

/// All that is written to a folder.
const OVERLAY: &str = "overlay.png";
const REPORT: &str = "report.json";

/// Where it is written; earlier results there stay.
#[derive(Debug, Clone)]
pub enum Place {
    /// A file for the overlay.
    File(PathBuf),
    /// A folder for overlay and report.
    Folder(PathBuf),
}

/// A picture that is refused.
pub(super) struct Refused<'a> {
    pub(super) picture: &'a str,
    pub(super) shape: &'a Shape,
    /// Without one nothing is written.
    pub(super) place: Option<Place>,
    pub(super) files: &'a Files,
}

impl Refused<'_> {
    /// The refusal of a picture in which no cell was found.
    pub(super) fn without_cells(&self, cause: ShapeError, bytes: &ShapeBytes) -> ExperimentError {
        let seen = match &self.shape.source {
            Source::Picture(source) if is_worth_seeing(&cause) => source.unsegmented(bytes).ok(),
            _ => None,
        };
        match seen {
            Some(seen) => self.shown(cause, &seen, Vec::new(), None),
            None => cause.into(),
        }
    }

    /// The refusal of a picture with cells, none of which is the requested one, or is whole.
    pub(super) fn with_cells(
        &self,
        cause: ShapeError,
        cells: &PictureCells,
        all: bool,
    ) -> ExperimentError {
        if !is_worth_seeing(&cause) {
            return cause.into();
        }
        let choice = match &self.shape.source {
            Source::Picture(source) => source.choice,
            _ => Choice::Largest,
        };
        let wanted: Vec<PictureCell> = if all {
            (1..=cells.len() as u32)
                .filter_map(|n| cells.cell(Choice::Number(n), true).ok())
                .collect()
        } else {
            cells.cell(choice, true).into_iter().collect()
        };
        let found = match (cells.len(), wanted.as_slice()) {
            (1, [one]) => format!("one cell of {:.0} um^2", one.shape.area_um2),
            (count, [one]) => {
                format!(
                    "{count} cells, of which cell {} has {:.0} um^2",
                    one.name, one.shape.area_um2
                )
            }
            (1, _) => "one cell".to_owned(),
            (count, _) => format!("{count} cells"),
        };
        let found = format!("{found} ({})", cells.method());
        self.shown(cause, cells, wanted, Some(found))
    }

    fn shown(
        &self,
        cause: ShapeError,
        seen: &PictureCells,
        wanted: Vec<PictureCell>,
        found: Option<String>,
    ) -> ExperimentError {
        let Some(place) = &self.place else { return cause.into() };
        // The title names the file.
        let mut notes = vec![match &cause {
            ShapeError::Picture { cause, .. } => cause.to_string(),
            other => other.to_string(),
        }];
        notes.extend(found.iter().map(|found| format!("found {found}")));
        notes.extend(seen.notes.iter().cloned());
        let chosen = Chosen::of(self.shape, seen, wanted);
        let where_to_look = match self.write(place, &notes, seen, &chosen, found.is_some()) {
            Ok(place) => format!("look at {}", place.display()),
            Err(failure) => format!("no overlay was written: {failure}"),
        };
        let found = found.map(|found| format!("found {found}; ")).unwrap_or_default();
        let notes: Vec<String> = seen.notes.iter().map(|note| format!("\n{note}")).collect();
        ExperimentError::new(cause).advise(format!("{found}{where_to_look}{}", notes.concat()))
    }

    fn write(
        &self,
        place: &Place,
        notes: &[String],
        seen: &PictureCells,
        chosen: &[Chosen],
        has_cells: bool,
    ) -> Result<PathBuf, ExperimentError> {
        let cells: Vec<&PictureCell> = chosen.iter().map(|chosen| &chosen.cell).collect();
        let figure = overlay::draw(self.picture, seen, &cells, None, notes)?;
        match place {
            Place::File(file) => {
                let file = if file.exists() { &refused_beside(file) } else { file };
                self.files.write_in_folder(file, figure.to_png(DPI)?)?;
                Ok(file.clone())
            }
            Place::Folder(target) => {
                let free = !target.exists() || is_all_there_is(target, self.files);
                let target = if free { target } else { &refused_beside(target) };
                let force = is_all_there_is(target, self.files);
                let folder = Folder::claim(target, force, self.files)?;
                folder.write(OVERLAY, figure.to_png(DPI)?)?;
                if has_cells {
                    let mut report = SegmentReport::of(self.picture, seen, chosen, &[]);
                    report.refused = notes.first().map(String::as_str);
                    folder.write(REPORT, json::for_people(&report)?)?;
                }
                Ok(folder.finish(&())?.join(OVERLAY))
            }
        }
    }
}

/// `cell_outline` gives `cell_outline_refused`, so that earlier results stay.
fn refused_beside(place: &Path) -> PathBuf {
    let stem = place.file_stem().unwrap_or_default().to_string_lossy();
    let ending = place.extension().map(|ending| format!(".{}", ending.to_string_lossy()));
    place.with_file_name(format!("{stem}_refused{}", ending.unwrap_or_default()))
}

/// Whether a folder holds only the files of an earlier refusal, so that it may be replaced.
pub fn is_all_there_is(folder: &Path, files: &Files) -> bool {
    let Ok(entries) = std::fs::read_dir(folder) else { return false };
    let names: Vec<String> =
        entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    let ours = |name: &String| {
        [OVERLAY, REPORT, MANIFEST].contains(&name.as_str()) || name.starts_with('.')
    };
    names.iter().any(|name| name == OVERLAY)
        && names.iter().all(ours)
        && Manifest::of(folder).check_replaceable(&files.reads()).is_ok()
}

/// Whether the overlay shows the reason of the refusal.
fn is_worth_seeing(cause: &ShapeError) -> bool {
    let ShapeError::Picture { cause, .. } = cause else {
        return matches!(cause, ShapeError::Size { .. });
    };
    matches!(
        **cause,
        CellError::TooSmall { .. }
            | CellError::Trace(_)
            | CellError::Rasterise { .. }
            | CellError::Segment(
                SegmentError::NoCell { .. }
                    | SegmentError::NothingStandsOut { .. }
                    | SegmentError::NoSuchCell { .. }
                    | SegmentError::NotThere { .. }
                    | SegmentError::Cut { .. }
                    | SegmentError::Mask(_)
            )
    )
}
