//! From a film to the motion of its cell.

use super::open;
use crate::analyse::table::{HIGHEST_FRAME_RATE, frame_rate};
use crate::args::{OutputArgs, TrackArgs};
use crate::failure::Failure;
use crate::files::FILES;
use crate::input;
use crate::interrupt;
use crate::options::Given;
use crate::progress;
use myospring::microscopy::film::Film;
use myospring::microscopy::motion::{self, Cell, Motion, Rest, Settings};
use myospring::microscopy::picture::{PixelSizeSource, StatedPixelSize};
use myospring::run_file::{Origin, Shaped, Source};
use myospring::settings::{Fibres, PictureSource, Run, ShapeBytes, Value};
use myospring::units::{self, Dimension};
use std::num::NonZeroUsize;
use std::path::Path;

/// Sizes of subsets that make sense, um.
const SUBSETS_UM: [f64; 2] = [0.5, 100.0];

/// What was asked for.
pub(crate) struct Asked {
    /// Settings of shape, segmentation and fibres.
    pub(crate) overrides: Vec<Given>,
    /// Frames a second.
    pub(crate) frame_rate: Option<f64>,
    /// Side of a subset, um.
    pub(crate) subset_um: f64,
    /// The frame at rest.
    pub(crate) rest: Option<usize>,
    /// Threads.
    pub(crate) threads: Option<usize>,
}

impl Asked {
    /// Usual subsets, the frame at rest as it is found.
    pub(crate) fn new(overrides: Vec<Given>, frame_rate: Option<f64>) -> Self {
        Self { overrides, frame_rate, subset_um: Settings::SUBSET_UM, rest: None, threads: None }
    }

    pub(crate) fn of(args: &TrackArgs) -> Result<Self, Failure> {
        let frame_rate = args.frame_rate.as_deref().map(frame_rate).transpose()?;
        let subset_um = match &args.subset {
            None => Settings::SUBSET_UM,
            Some(text) => subset(text)?,
        };
        let key = "segmentation.frame";
        let rest = match args.settings.get(key) {
            Some(Value::Whole(frame)) => usize::try_from(*frame).ok(),
            _ => None,
        };
        let overrides = args.settings.overrides();
        Ok(Self {
            overrides,
            frame_rate,
            subset_um,
            rest,
            threads: args.threads.map(NonZeroUsize::get),
        })
    }
}

impl Asked {
    /// The run that the settings make of the cell of a film.
    pub(crate) fn settled(&self) -> Result<Run, Failure> {
        // A film has endings that pictures do not have; the picture at rest is a TIFF.
        let own = [(Origin::Unknown, "shape.picture", Value::Text("rest.tif".to_owned()))];
        Ok(input::settle_with(None, &self.overrides, own)?.1)
    }
}

fn subset(text: &str) -> Result<f64, Failure> {
    let [least, most] = SUBSETS_UM;
    let um = units::parse(text, Dimension::Length)
        .map_err(|error| Failure::new(format!("--subset: {error}")))?;
    if (least..=most).contains(&um) {
        return Ok(um);
    }
    Err(Failure::new(format!("--subset is {um} um; it must be between {least} and {most} um"))
        .advise("two sarcomeres are a good size: --subset \"4 um\""))
}

/// A film with its cell at rest.
pub(crate) struct Found {
    pub(crate) film: Film,
    pub(crate) rest: Rest,
    pub(crate) run: Run,
    /// The frame at rest, a TIFF.
    pub(crate) rest_picture: Vec<u8>,
    pub(crate) shaped: Shaped,
    pub(crate) fibres: Fibres,
    pub(crate) frames_per_second: f64,
    /// Whether the rate was given, not the film's own.
    pub(crate) rate_given: bool,
}

/// A film with its cell, followed.
pub(crate) struct Followed {
    pub(crate) film: Film,
    pub(crate) run: Run,
    pub(crate) rest_picture: Vec<u8>,
    pub(crate) shaped: Shaped,
    pub(crate) fibres: Fibres,
    pub(crate) motion: Motion,
    pub(crate) frames_per_second: f64,
    pub(crate) rate_given: bool,
}

/// Opens a film and finds the cell at rest.
pub(crate) fn cell(path: &Path, asked: &Asked, output: &OutputArgs) -> Result<Found, Failure> {
    let Some(text) = path.to_str() else {
        return Err(Failure::new(format!("`{}` is not UTF-8", path.display())));
    };
    let name = open::name(path)?;
    let mut run = asked.settled()?;
    let failed = |error: &dyn std::fmt::Display| Failure::new(format!("`{text}`: {error}"));
    let Source::Picture(source) = &mut run.shape.source else {
        return Err(failed(&"it is not a film"));
    };
    text.clone_into(&mut source.path);
    let mut film = open::open(path, &source.options.selection)?;
    if film.pixel_size.is_none()
        && let Some(size) = source.options.pixel_size
    {
        // So that the picture at rest, which is written, knows it.
        film.pixel_size = Some(StatedPixelSize { size, source: PixelSizeSource::TiffResolution });
    }
    let Some(frames_per_second) = asked.frame_rate.or(film.frames_per_second) else {
        return Err(failed(&"the film does not say how many frames a second it has")
            .advise("give it like --frame-rate 30, as the camera was set"));
    };
    if !(f64::MIN_POSITIVE..=HIGHEST_FRAME_RATE).contains(&frames_per_second) {
        let most = HIGHEST_FRAME_RATE;
        let message = format!(
            "the film says that it has {frames_per_second} frames a second; that must be above 0, at most {most}"
        );
        return Err(failed(&message).advise("give it like --frame-rate 30, as the camera was set"));
    }
    let bar = progress::of_members(output.quiet, 1, "frame at rest");
    let rest = match asked.rest {
        Some(frame) => Rest::at(&film, frame),
        None => Rest::find(&film),
    };
    bar.finish_and_clear();
    let rest = rest.map_err(|error| failed(&error))?;
    let rest_picture = film.picture(rest.frame).map_err(|error| failed(&error))?;
    let selection = &mut source.options.selection;
    (selection.frame, selection.channel, selection.depth) = (0, None, None);
    let bytes = ShapeBytes { shape: rest_picture.clone(), outline: outline(source)? };
    let shaped = input::mesh_picture(&run, &bytes, input::refusals(output, &name))?;
    let Some((cells, cell)) = &shaped.picture else {
        return Err(failed(&"it shows no cell"));
    };
    let fibres = run.fibre.on(&shaped.mesh, Some((cells, cell)))?;
    let rate_given = asked.frame_rate.is_some();
    Ok(Found { film, rest, run, rest_picture, shaped, fibres, frames_per_second, rate_given })
}

fn outline(source: &PictureSource) -> Result<Option<Vec<u8>>, Failure> {
    let read =
        |path: &String| FILES.bytes(path).map_err(|error| Failure::unread(Path::new(path), &error));
    source.outline.as_ref().map(read).transpose()
}

/// Follows the cell; Ctrl-C ends it with the frames that are done.
pub(crate) fn film(found: Found, asked: &Asked, quiet: bool) -> Result<Followed, Failure> {
    let Found { film, rest, run, rest_picture, shaped, fibres, frames_per_second, rate_given } =
        found;
    let Some((cells, cell)) = &shaped.picture else {
        return Err(Failure::new("the film shows no cell"));
    };
    let inside = cell.mask.inside();
    let any_cell = match cells.segmentation() {
        Some(found) => found.numbers.iter().map(|&number| number > 0).collect(),
        None => inside.clone(),
    };
    let settings =
        Settings { frames_per_second, subset_um: asked.subset_um, threads: asked.threads };
    let seen = Cell {
        mesh: &shaped.mesh,
        inside: &inside,
        any_cell: &any_cell,
        pixel_size: cells.pixel_size,
        fibres: fibres.seen.as_ref().map(|seen| &seen.field),
    };
    let bar = progress::of_members(quiet, film.len(), "frames");
    let motion = motion::follow(&film, rest, &seen, settings, |(done, all)| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
        !interrupt::asked()
    });
    bar.finish_and_clear();
    let path = run.shape.file().unwrap_or_default();
    let motion = motion.map_err(|error| Failure::new(format!("`{path}`: {error}")))?;
    Ok(Followed { film, run, rest_picture, shaped, fibres, motion, frames_per_second, rate_given })
}
