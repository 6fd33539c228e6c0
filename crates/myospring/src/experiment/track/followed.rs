//! From a film to the motion of its cell.

use super::description::Track;
use super::open;
use crate::experiment::input::{mesh_picture, settle_with};
use crate::experiment::refused::Refused;
use crate::experiment::segment::{self, LeftOut};
use crate::experiment::{ExperimentError, Files, Observer};
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::film::{FEWEST_FRAMES, Film};
use crate::microscopy::motion::{
    self, CellAtRest, CellMotion, MotionError, Rest, TrackingSettings,
};
use crate::microscopy::picture::{PixelSizeSource, StatedPixelSize};
use crate::microscopy::segment::Choice;
use crate::run_file::{Origin, Shaped, Source};
use crate::settings::{Fibres, PictureSource, Run, ShapeBytes, Value};
use std::path::Path;
use std::sync::Arc;

/// A film with its frame at rest.
pub(super) struct AtRest {
    film: Film,
    rest: Rest,
    run: Run,
    pub(super) rest_picture: Vec<u8>,
    bytes: ShapeBytes,
    frames_per_second: f64,
    rate_given: bool,
}

/// A cell in the frame at rest.
pub(super) struct CellShape {
    run: Run,
    shaped: Shaped,
    fibres: Fibres,
}

/// A film with the motion of its cell.
pub struct Followed {
    /// The film; cells that were followed together share it.
    pub film: Arc<Film>,
    /// The settings of the cell; its shape is that of `rest_picture`.
    pub run: Run,
    /// The frame at rest, a TIFF.
    pub rest_picture: Arc<Vec<u8>>,
    /// The cell at rest on its mesh.
    pub shaped: Shaped,
    /// Its fibres.
    pub fibres: Fibres,
    /// Its motion.
    pub motion: CellMotion,
    /// Frames a second.
    pub frames_per_second: f64,
    /// Whether the rate was given, not the film's own.
    pub rate_given: bool,
}

/// The run of a film's cell with these settings.
pub(super) fn settled(
    track: &Track,
    files: &Files,
    observer: &dyn Observer,
) -> Result<Run, ExperimentError> {
    // A film has endings that pictures do not have; the picture at rest is a TIFF.
    let own = [(Origin::Unknown, "shape.picture", Value::Text("rest.tif".to_owned()))];
    Ok(settle_with(None, &track.settings, own, files, &observer.interruption())?.1)
}

/// A film, and what its settings say of it.
pub(in crate::experiment) struct OpenedFilm {
    pub(in crate::experiment) film: Film,
    run: Run,
    pub(in crate::experiment) frames_per_second: f64,
}

impl OpenedFilm {
    /// Opens the film that is to be tracked.
    ///
    /// # Errors
    /// A film that cannot be read, or whose frame rate is not known.
    pub(in crate::experiment) fn of(
        track: &Track,
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<Self, ExperimentError> {
        let Some(text) = track.film.to_str() else {
            return Err(ExperimentError::new(format!("`{}` is not UTF-8", track.film.display())));
        };
        let failed =
            |error: &dyn std::fmt::Display| ExperimentError::new(format!("`{text}`: {error}"));
        open::name(&track.film, files)?;
        let mut run = settled(track, files, observer)?;
        let Source::Picture(source) = &mut run.shape.source else {
            return Err(failed(&"it is not a film"));
        };
        text.clone_into(&mut source.path);
        let mut film = open::open(&track.film, &source.options.selection, FEWEST_FRAMES, files)?;
        if film.pixel_size.is_none()
            && let Some(size) = source.options.pixel_size
        {
            // So that the written picture of the cell at rest knows its pixel size.
            let source = PixelSizeSource::TiffResolution;
            film.pixel_size = Some(StatedPixelSize { size, source });
        }
        let frames_per_second = rate(track.frame_rate, &film).map_err(|message| {
            failed(&message).advise("give it like --frame-rate 30, as the camera was set")
        })?;
        Ok(Self { film, run, frames_per_second })
    }
}

impl AtRest {
    /// Opens a film and finds its frame at rest.
    pub(super) fn find(
        track: &Track,
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<Self, ExperimentError> {
        let OpenedFilm { film, mut run, frames_per_second } =
            OpenedFilm::of(track, files, observer)?;
        let failed = |error: &dyn std::fmt::Display| {
            ExperimentError::new(format!("`{}`: {error}", track.film.display()))
        };
        let Source::Picture(source) = &mut run.shape.source else {
            return Err(failed(&"it is not a film"));
        };
        observer.stage("frame at rest", 1);
        let rest = match track.stated_frame() {
            Some(frame) => Rest::at(&film, frame),
            None => Rest::find(&film),
        };
        observer.reached(1);
        let rest = rest.map_err(|error| failed(&error))?;
        let rest_picture = film.picture(rest.frame).map_err(|error| failed(&error))?;
        let selection = &mut source.options.selection;
        (selection.frame, selection.channel, selection.depth) = (0, None, None);
        let bytes = ShapeBytes { shape: rest_picture.clone(), outline: outline(source, files)? };
        let rate_given = track.frame_rate.is_some();
        Ok(Self { film, rest, run, rest_picture, bytes, frames_per_second, rate_given })
    }

    /// The cell that the settings choose.
    pub(super) fn cell(&self, track: &Track, files: &Files) -> Result<CellShape, ExperimentError> {
        let mut shaped = mesh_picture(&self.run, &self.bytes, track.refused.clone(), files)?;
        let cells = shaped.picture.as_ref().map_or(1, |(cells, _)| cells.len());
        let all = (cells > 1)
            .then(|| format!("`myospring track --cell all` follows each of the {cells} cells"));
        shaped.report.warnings.extend(all);
        CellShape::of(self.run.clone(), shaped)
    }

    /// All cells of the frame, and those that are left out, each with the reason.
    pub(super) fn cells(
        &self,
        track: &Track,
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<FrameCells, ExperimentError> {
        let shape = &self.run.shape;
        let Source::Picture(source) = &shape.source else {
            return Err(ExperimentError::new("the film shows no cell"));
        };
        let (picture, place) = (source.path.as_str(), track.refused.clone());
        let refused = Refused { picture, shape, place, files };
        observer.stage("outlines", 1);
        let cells =
            source.cells(&self.bytes).map_err(|cause| refused.without_cells(cause, &self.bytes))?;
        let (chosen, mut left_out) = segment::chosen(&cells, source, true, source.allow_cut)
            .map_err(|cause| refused.with_cells(source.failed(cause), &cells, true))?;
        let (chosen, impossible) = segment::of_possible_size(shape, &cells, chosen);
        let first = impossible.into_iter().map(|(number, cause)| {
            left_out.push(LeftOut { number, reason: cause.to_string(), cut: false });
            cause
        });
        if let (Some(cause), true) = (first.last(), chosen.is_empty()) {
            return Err(refused.with_cells(cause, &cells, true));
        }
        observer.reached(1);
        let mut shapes = Vec::new();
        observer.stage("fibres of cells", chosen.len() as u64);
        for (done, cell) in (1..).zip(chosen) {
            let mut run = self.run.clone();
            if let Some(choice) = run.shape.source.choice_mut() {
                *choice = Choice::Number(cell.number);
            }
            let shape = shape.mesh_each(cells.clone(), cell.clone());
            let shape = shape.map_err(ExperimentError::new);
            let shape = shape.and_then(|shaped| CellShape::of(run, shaped));
            shapes.push((cell, shape.map_err(|error| error.to_string())));
            observer.reached(done);
            observer.interruption().check().map_err(ExperimentError::new)?;
        }
        Ok(FrameCells { cells, shapes, left_out })
    }

    /// Follows cells together; for each its motion, or why it cannot be followed.
    pub(super) fn follow(
        self,
        shapes: Vec<CellShape>,
        track: &Track,
        observer: &dyn Observer,
    ) -> Result<Vec<Result<Followed, MotionError>>, ExperimentError> {
        let Self { film, rest, rest_picture, frames_per_second, rate_given, .. } = self;
        let insides: Vec<Vec<bool>> = shapes.iter().map(CellShape::inside).collect();
        let found = shapes.first().and_then(|shape| shape.shaped.picture.as_ref());
        let found = found.and_then(|(cells, _)| cells.segmentation());
        let [width, height] = film.size();
        let any_cell: Vec<bool> = match found {
            Some(found) => found.numbers.iter().map(|&number| number > 0).collect(),
            None => (0..width * height).map(|at| insides.iter().any(|it| it[at])).collect(),
        };
        let settings = TrackingSettings {
            subset_um: track.subset_um,
            threads: track.threads,
            ..TrackingSettings::at(frames_per_second)
        };
        let seen = shapes.iter().zip(&insides).filter_map(|(shape, inside)| {
            Some(CellAtRest {
                mesh: &shape.shaped.mesh,
                inside,
                any_cell: &any_cell,
                pixel_size: shape.shaped.picture.as_ref()?.0.pixel_size,
                fibres: shape.fibres.seen.as_ref().map(|seen| &seen.field),
            })
        });
        let seen: Vec<CellAtRest<'_>> = seen.collect();
        let interruption = observer.interruption();
        let mut begun = false;
        let motions = motion::follow_all(&film, rest, &seen, settings, |(done, all)| {
            if !begun {
                observer.stage("frames", all as u64);
                begun = true;
            }
            observer.reached(done as u64);
            !interruption.is_requested()
        });
        let motions = motions.map_err(|error| unfollowed(track, &error))?;
        let (film, rest_picture) = (Arc::new(film), Arc::new(rest_picture));
        let followed = shapes.into_iter().zip(motions).map(|(shape, motion)| {
            let CellShape { run, shaped, fibres } = shape;
            motion.map(|motion| Followed {
                film: Arc::clone(&film),
                run,
                rest_picture: Arc::clone(&rest_picture),
                shaped,
                fibres,
                motion,
                frames_per_second,
                rate_given,
            })
        });
        Ok(followed.collect())
    }
}

/// The cells of the frame at rest.
pub(super) struct FrameCells {
    /// The picture with all cells.
    pub(super) cells: PictureCells,
    /// Each cell that was chosen, on its mesh, or why it has none.
    pub(super) shapes: Vec<(PictureCell, Result<CellShape, String>)>,
    /// The others.
    pub(super) left_out: Vec<LeftOut>,
}

impl CellShape {
    fn of(run: Run, shaped: Shaped) -> Result<Self, ExperimentError> {
        if shaped.picture.is_none() {
            return Err(ExperimentError::new("the film shows no cell"));
        }
        let fibres = run.fibres(&shaped)?;
        Ok(Self { run, shaped, fibres })
    }

    fn inside(&self) -> Vec<bool> {
        self.shaped.picture.as_ref().map(|(_, cell)| cell.mask.inside()).unwrap_or_default()
    }
}

/// A film that cannot be followed.
pub(super) fn unfollowed(track: &Track, cause: &MotionError) -> ExperimentError {
    ExperimentError::new(format!("`{}`: {cause}", track.film.display()))
}

/// Frames a second, those that are stated or those of the film; or why they are not known.
pub(in crate::experiment) fn rate(stated: Option<f64>, film: &Film) -> Result<f64, String> {
    let Some(rate) = stated.or(film.frames_per_second) else {
        return Err("the film does not say how many frames a second it has".to_owned());
    };
    let most = TrackingSettings::HIGHEST_FRAME_RATE;
    if (f64::MIN_POSITIVE..=most).contains(&rate) {
        return Ok(rate);
    }
    Err(format!(
        "the film says that it has {rate} frames a second; that must be above 0, at most {most}"
    ))
}

fn outline(source: &PictureSource, files: &Files) -> Result<Option<Vec<u8>>, ExperimentError> {
    let read = |path: &String| {
        files.bytes(path).map_err(|error| ExperimentError::unread(Path::new(path), &error))
    };
    source.outline.as_ref().map(read).transpose()
}
