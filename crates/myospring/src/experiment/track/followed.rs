//! From a film to the motion of its cell.

use super::description::Track;
use super::open;
use crate::experiment::input::{mesh_picture, settle_with};
use crate::experiment::{ExperimentError, Files, Observer};
use crate::microscopy::film::Film;
use crate::microscopy::motion::{self, CellAtRest, CellMotion, Rest, TrackingSettings};
use crate::microscopy::picture::{PixelSizeSource, StatedPixelSize};
use crate::run_file::{Origin, Shaped, Source};
use crate::settings::{Fibres, PictureSource, Run, ShapeBytes, Value};
use std::path::Path;

/// A film with its cell at rest.
pub(super) struct AtRest {
    film: Film,
    rest: Rest,
    run: Run,
    rest_picture: Vec<u8>,
    shaped: Shaped,
    fibres: Fibres,
    frames_per_second: f64,
    rate_given: bool,
}

/// A film with the motion of its cell.
pub struct Followed {
    /// The film.
    pub film: Film,
    /// The settings of the cell; its shape is that of `rest_picture`.
    pub run: Run,
    /// The frame at rest, a TIFF.
    pub rest_picture: Vec<u8>,
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

impl AtRest {
    /// Opens a film and finds the cell at rest.
    pub(super) fn find(
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
        let mut film = open::open(&track.film, &source.options.selection, files)?;
        if film.pixel_size.is_none()
            && let Some(size) = source.options.pixel_size
        {
            // So that the written picture of the cell at rest knows its pixel size.
            let source = PixelSizeSource::TiffResolution;
            film.pixel_size = Some(StatedPixelSize { size, source });
        }
        let frames_per_second = rate(track, &film).map_err(|message| {
            failed(&message).advise("give it like --frame-rate 30, as the camera was set")
        })?;
        observer.stage("frame at rest", 1);
        let frame = track.settings.iter().find_map(|(setting, value)| match value {
            Value::Whole(frame) if setting.key == "segmentation.frame" => {
                usize::try_from(*frame).ok()
            }
            _ => None,
        });
        let rest = match frame {
            Some(frame) => Rest::at(&film, frame),
            None => Rest::find(&film),
        };
        observer.reached(1);
        let rest = rest.map_err(|error| failed(&error))?;
        let rest_picture = film.picture(rest.frame).map_err(|error| failed(&error))?;
        let selection = &mut source.options.selection;
        (selection.frame, selection.channel, selection.depth) = (0, None, None);
        let bytes = ShapeBytes { shape: rest_picture.clone(), outline: outline(source, files)? };
        let shaped = mesh_picture(&run, &bytes, track.refused.clone(), files)?;
        let Some((cells, cell)) = &shaped.picture else {
            return Err(failed(&"it shows no cell"));
        };
        let fibres = run.fibre.on(&shaped.mesh, Some((cells, cell)))?;
        let rate_given = track.frame_rate.is_some();
        Ok(Self { film, rest, run, rest_picture, shaped, fibres, frames_per_second, rate_given })
    }

    /// Follows the cell.
    pub(super) fn follow(
        self,
        track: &Track,
        observer: &dyn Observer,
    ) -> Result<Followed, ExperimentError> {
        let Self { film, rest, run, rest_picture, shaped, fibres, frames_per_second, rate_given } =
            self;
        let Some((cells, cell)) = &shaped.picture else {
            return Err(ExperimentError::new("the film shows no cell"));
        };
        let inside = cell.mask.inside();
        let any_cell = match cells.segmentation() {
            Some(found) => found.numbers.iter().map(|&number| number > 0).collect(),
            None => inside.clone(),
        };
        let settings = TrackingSettings {
            frames_per_second,
            subset_um: track.subset_um,
            threads: track.threads,
        };
        let seen = CellAtRest {
            mesh: &shaped.mesh,
            inside: &inside,
            any_cell: &any_cell,
            pixel_size: cells.pixel_size,
            fibres: fibres.seen.as_ref().map(|seen| &seen.field),
        };
        let interruption = observer.interruption();
        let mut begun = false;
        let motion = motion::follow(&film, rest, &seen, settings, |(done, all)| {
            if !begun {
                observer.stage("frames", all as u64);
                begun = true;
            }
            observer.reached(done as u64);
            !interruption.is_requested()
        });
        let motion = motion.map_err(|error| {
            ExperimentError::new(format!("`{}`: {error}", track.film.display()))
        })?;
        Ok(Followed {
            film,
            run,
            rest_picture,
            shaped,
            fibres,
            motion,
            frames_per_second,
            rate_given,
        })
    }
}

/// Frames a second, or why they are not known.
fn rate(track: &Track, film: &Film) -> Result<f64, String> {
    let Some(rate) = track.frame_rate.or(film.frames_per_second) else {
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
