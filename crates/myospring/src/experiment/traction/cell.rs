//! Where the cell is: outlines, a mask, or a picture or film of it.

use super::measured::Grid;
use crate::experiment::input::ending;
use crate::experiment::track::{Followed, Track};
use crate::experiment::{ExperimentError, Files, Observer};
use crate::mesh::pixel_size::PixelSize;
use crate::microscopy::cells::{PictureCells, PictureOptions};
use crate::microscopy::outlines::{
    CoordinateUnit, PixelFrame, Placement, ReadOptions, raster, read_outlines,
};
use crate::microscopy::picture::Selection;
use crate::microscopy::read::read_picture;
use crate::microscopy::segment::{Choice, Modality};
use crate::settings::{self, OUTLINE_ENDINGS, PICTURE_ENDINGS, Value};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How far around a cell tractions are sought, um, where it was found in a picture or film: what lies on the outline counts in full.
pub const MARGIN_UM: f64 = 2.0;

/// Where the cell is.
#[derive(Clone)]
pub enum CellPlace {
    /// A file of the cell, in the frame of the pictures of beads; of arrays, with a pixel for each displacement.
    File {
        /// Outlines or a mask, a little larger than the cell; or a picture or a film of the cell, in which it is found, with a margin
        /// of [`MARGIN_UM`]. Of a film it is where the cell is in any frame.
        path: PathBuf,
        /// Channel of a picture or film, from 0; `None` takes the first.
        channel: Option<usize>,
    },
    /// The cell of a film that was followed.
    Followed(Arc<Followed>),
}

impl fmt::Debug for CellPlace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { path, .. } => formatter.debug_tuple("File").field(path).finish(),
            Self::Followed(_) => formatter.debug_tuple("Followed").finish(),
        }
    }
}

/// How a film of the cell is followed.
pub(super) struct Following<'a> {
    /// Frames a second, where they are known.
    pub(super) frame_rate_per_s: Option<f64>,
    pub(super) threads: Option<usize>,
    pub(super) observer: &'a dyn Observer,
}

impl CellPlace {
    /// A file whose first channel shows the cell.
    pub fn of(path: impl Into<PathBuf>) -> Self {
        Self::File { path: path.into(), channel: None }
    }

    /// The file that is read.
    pub(super) fn path(&self) -> Option<&PathBuf> {
        match self {
            Self::File { path, .. } => Some(path),
            Self::Followed(_) => None,
        }
    }

    /// The places of the cell, rows from the lowest.
    pub(super) fn places(
        &self,
        grid: &Grid,
        files: &Files,
        following: &Following<'_>,
    ) -> Result<Vec<bool>, ExperimentError> {
        let (inside, name) = match self {
            Self::File { path, channel } => {
                let shown = Shown { path, channel: *channel, grid, files, following };
                (shown.inside()?, path.display().to_string())
            }
            Self::Followed(followed) => {
                let name = followed.run.shape.file().unwrap_or_default();
                (covered(followed, grid, name)?, name.to_owned())
            }
        };
        let places = grid.places(&inside);
        if !places.contains(&true) {
            return Err(ExperimentError::new(format!(
                "no displacement is known where the cell of `{name}` is"
            ))
            .advise("it must be where the gel was measured, away from the edges of the pictures"));
        }
        Ok(places)
    }
}

/// Where the cell of a film is in any frame.
fn covered(followed: &Followed, grid: &Grid, name: &str) -> Result<Vec<bool>, ExperimentError> {
    let [width, height] = followed.film.size();
    grid.check_size([width, height], name)?;
    let pixel_size = PixelSize::new(followed.motion.pixel_um).map_err(ExperimentError::new)?;
    let frame = PixelFrame::new(width, height, pixel_size).map_err(ExperimentError::new)?;
    Ok(followed.motion.covered(&frame, MARGIN_UM))
}

/// A file that shows where the cell is.
struct Shown<'a> {
    path: &'a Path,
    channel: Option<usize>,
    grid: &'a Grid,
    files: &'a Files,
    following: &'a Following<'a>,
}

impl Shown<'_> {
    fn failed(&self, error: &dyn fmt::Display) -> ExperimentError {
        ExperimentError::new(format!("`{}`: {error}", self.path.display()))
    }

    /// The pixels of the cell, row by row from the top.
    fn inside(&self) -> Result<Vec<bool>, ExperimentError> {
        let unread = |error| ExperimentError::unread(self.path, &error);
        let kind = ending(self.path);
        let is_folder = self.files.is_folder(self.path).map_err(unread)?;
        let is_outline = OUTLINE_ENDINGS.contains(&kind.as_str());
        if is_folder || !(is_outline || PICTURE_ENDINGS.contains(&kind.as_str())) {
            return self.in_film();
        }
        let bytes = self.files.bytes(self.path).map_err(unread)?;
        if is_outline {
            return outlined(self.path, &bytes, self.grid);
        }
        let selection = Selection { channel: self.channel, ..Selection::default() };
        let picture = read_picture(&bytes, &selection).map_err(|error| self.failed(&error))?;
        let plane = &picture.plane;
        let size = [plane.width(), plane.height()];
        self.grid.check_size(size, &self.path.display().to_string())?;
        if picture.frames > 1 || picture.slices > 1 {
            return self.in_film();
        }
        let options = PictureOptions {
            selection,
            pixel_size: Some(self.pixel_size()?),
            ..PictureOptions::default()
        };
        let found = PictureCells::find(&bytes, &options);
        let modality = |cells: &PictureCells| cells.segmentation().map(|found| found.modality);
        match found {
            Ok(cells) if modality(&cells) != Some(Modality::Mask) => {
                let cell =
                    cells.cell(Choice::Largest, true).map_err(|error| self.failed(&error))?;
                if cells.len() > 1 {
                    self.following.observer.note(&format!(
                        "`{}` shows {} cells; the largest is taken",
                        self.path.display(),
                        cells.len()
                    ));
                }
                Ok(raster::grown(&cell.mask.inside(), size[0], MARGIN_UM / self.grid.pixel_um))
            }
            found => {
                let inside: Vec<bool> = plane.values().iter().map(|value| *value > 0.0).collect();
                match (inside.contains(&true), inside.contains(&false), found) {
                    (false, ..) => {
                        Err(self.failed(&"it is black everywhere, so there is no cell in it"))
                    }
                    (true, false, Err(cause)) => Err(self.failed(&cause)),
                    _ => Ok(inside),
                }
            }
        }
    }

    fn pixel_size(&self) -> Result<PixelSize, ExperimentError> {
        PixelSize::new(self.grid.pixel_um).map_err(|error| self.failed(&error))
    }

    fn in_film(&self) -> Result<Vec<bool>, ExperimentError> {
        let Following { frame_rate_per_s, threads, observer } = self.following;
        let value = |key: &str, value: Value| settings::find(key).map(|setting| (setting, value));
        let size = value("shape.pixel_size", Value::Text(format!("{} um", self.grid.pixel_um)));
        let channel = self.channel.and_then(|channel| i64::try_from(channel).ok());
        let channel =
            channel.and_then(|channel| value("segmentation.channel", Value::Whole(channel)));
        let track = Track {
            settings: size.into_iter().chain(channel).collect(),
            // Only its order counts.
            frame_rate: frame_rate_per_s.or(Some(1.0)),
            threads: *threads,
            ..Track::of(self.path)
        };
        track.check(self.files)?;
        let followed = track.follow(self.files, *observer)?;
        observer.interruption().check().map_err(ExperimentError::new)?;
        covered(&followed, self.grid, &self.path.display().to_string())
    }
}

/// The pixels within any outline of a file.
fn outlined(path: &Path, bytes: &[u8], grid: &Grid) -> Result<Vec<bool>, ExperimentError> {
    let name = path.display();
    let failed = |error: &dyn std::fmt::Display| ExperimentError::new(format!("`{name}`: {error}"));
    let [width, height] = grid.picture;
    let pixel_size = PixelSize::new(grid.pixel_um).map_err(|error| failed(&error))?;
    let frame = PixelFrame::new(width, height, pixel_size).map_err(|error| failed(&error))?;
    let options = ReadOptions {
        placement: Placement::Picture(frame),
        silent_unit: CoordinateUnit::default(),
    };
    let given = read_outlines(bytes, &name.to_string(), &options);
    let given = given.map_err(|error| failed(&error))?;
    let mut inside = vec![false; width * height];
    for cell in &given.outlines {
        let mask = raster::rasterise(&cell.outline, &frame).map_err(|error| failed(&error))?;
        inside.iter_mut().zip(mask.inside()).for_each(|(into, is)| *into |= is);
    }
    Ok(inside)
}
