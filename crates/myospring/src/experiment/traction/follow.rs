//! Displacements from pictures of the beads in a gel.

use super::followed::Followed;
use super::measured::{Displacements, Grid};
use crate::experiment::input::ending;
use crate::experiment::track::{film_name, open_film};
use crate::experiment::{ExperimentError, Files, Observer};
use crate::mechanics::gel::Surface;
use crate::mechanics::gel::cytometry::Errors;
use crate::mesh::pixel_size::PixelSize;
use crate::microscopy::film::{FEWEST_FRAMES, Film};
use crate::microscopy::motion::{
    BeadError, BeadSettings, GelMotion, Rest, TrackingSettings, follow_beads,
};
use crate::microscopy::picture::Selection;
use std::path::{Path, PathBuf};

/// Displacements below this are those of equal pictures, pixels: a tenth of the smallest step of a search.
const LEAST_MOTION_PX: f64 = 5e-4;

/// Pictures of the beads in a gel.
#[derive(Debug, Clone)]
pub struct Beads {
    /// A film, the folder of its pictures, or one picture of the pulled gel.
    pub film: PathBuf,
    /// A picture of the relaxed gel: without the cell, or with the cell relaxed. Without it, the gel is at rest in a frame of
    /// the film.
    pub reference: Option<PathBuf>,
    /// The frame at rest; `None` finds it.
    pub rest: Option<usize>,
    /// Side of a pixel, um; `None` takes that of the file.
    pub pixel_size_um: Option<f64>,
    /// Side of the squares that are matched, um; `None` takes the smallest with enough beads.
    pub subset_um: Option<f64>,
    /// Channel of the pictures, from 0; `None` takes the first.
    pub channel: Option<usize>,
}

impl Beads {
    /// Pictures whose files say all that is needed.
    pub fn of(film: impl Into<PathBuf>) -> Self {
        Self {
            film: film.into(),
            reference: None,
            rest: None,
            pixel_size_um: None,
            subset_um: None,
            channel: None,
        }
    }
}

/// Follows beads. `region` makes of the places in the pictures those of the cell.
pub(super) fn follow(
    (beads, threads): (&Beads, Option<usize>),
    frame_rate: Option<f64>,
    region: impl FnOnce(&Grid, Option<f64>) -> Result<Option<Vec<bool>>, ExperimentError>,
    files: &Files,
    observer: &dyn Observer,
) -> Result<(Displacements, Option<Vec<bool>>), ExperimentError> {
    let name = beads.film.display().to_string();
    let failed = |error: &dyn std::fmt::Display| ExperimentError::new(format!("`{name}`: {error}"));
    if ending(&beads.film) == "npy" {
        return Err(ExperimentError::new(format!("`{name}` is one array"))
            .advise("give two: displacements to the right, and downward, like u.npy v.npy"));
    }
    film_name(&beads.film, files)?;
    let selection = Selection { channel: beads.channel, ..Selection::default() };
    let fewest = if beads.reference.is_some() { 1 } else { FEWEST_FRAMES };
    let film = match open_film(&beads.film, &selection, 1, files)? {
        film if film.len() >= fewest => film,
        film => return Err(without_reference(&name, film.len())),
    };
    film.notes.iter().for_each(|note| observer.note(&format!("{name}: {note}")));
    let pixel_size = pixel_size(beads, &film)?;
    let frame_rate_per_s = rate(&film, frame_rate).map_err(|message| {
        failed(&message).advise("give it like --frame-rate 30, as the camera was set")
    })?;
    let (film, rest) = if let Some(path) = &beads.reference {
        let film = led_by(path, film, &selection, files)?;
        let rest = Rest::alone(&film, 0);
        (film, rest)
    } else {
        observer.stage("frame at rest", 1);
        let rest = match beads.rest {
            Some(frame) => Rest::at(&film, frame),
            None => Rest::find(&film),
        };
        (film, rest)
    };
    let rest = rest.map_err(|error| failed(&error))?;
    let settings = BeadSettings { pixel_size, subset_um: beads.subset_um, threads };
    let interruption = observer.interruption();
    observer.keeps("the frames that are done are written");
    let mut begun = false;
    let motion = follow_beads(&film, rest, settings, |(done, all)| {
        if !begun {
            observer.stage("frames", all as u64);
            begun = true;
        }
        observer.reached(done as u64);
        !interruption.is_requested()
    });
    let mut motion = motion.map_err(|error| unfollowed(beads, &name, &error))?;
    if motion.frames.len() < 2 {
        interruption.check().map_err(ExperimentError::new)?;
    }
    let grid = Grid {
        picture: film.size(),
        pixel_um: motion.pixel_um,
        shape: motion.shape,
        first: motion.first,
        step: motion.step,
    };
    let region = region(&grid, frame_rate_per_s)?;
    let far = region.as_ref().map(|region| region.iter().map(|within| !within).collect::<Vec<_>>());
    let stage_um = motion.take_drift(far.as_deref());
    let displacements = displacements(beads, motion, &stage_um, grid, region.is_some());
    if displacements.surfaces.is_empty() {
        return Err(failed(&"no frame but the one at rest is left"));
    }
    let least = LEAST_MOTION_PX * grid.pixel_um;
    let moves = |axis: &Vec<f64>| axis.iter().any(|moved| (moved - axis[0]).abs() > least);
    if !displacements.surfaces.iter().flat_map(|surface| &surface.displacements).any(moves) {
        return Err(failed(&"nothing moves: all frames are alike")
            .advise("is the reference the same picture as the film?"));
    }
    Ok((Displacements { frame_rate_per_s, ..displacements }, region))
}

/// The displacements of a motion, without the reference where that is no frame of the film.
fn displacements(
    beads: &Beads,
    motion: GelMotion,
    stage_um: &[[f64; 2]],
    grid: Grid,
    has_region: bool,
) -> Displacements {
    let led = usize::from(beads.reference.is_some());
    let shares: Vec<f64> =
        (0..motion.frames.len()).map(|at| 100.0 * motion.interpolated_share(at)).collect();
    let kept = motion.frames.iter().map(|frame| *frame >= led);
    let kept: Vec<bool> = kept.collect();
    let of = |at: &usize| kept[*at];
    let all = || (0..kept.len()).filter(of);
    let count = all().count().max(1) as f64;
    let correlation: Vec<f64> = all().filter_map(|at| motion.correlation[at]).collect();
    let reference = match &beads.reference {
        Some(path) => format!("`{}`", path.display()),
        None => format!("frame {} of the film, at rest", motion.rest),
    };
    let spacing = motion.step as f64 * motion.pixel_um;
    let interpolated_pct: Vec<f64> = all().map(|at| shares[at]).collect();
    let stage_um: Vec<[f64; 2]> = all().map(|at| stage_um[at]).collect();
    let followed = Followed {
        film: beads.film.display().to_string(),
        reference,
        relative_to_rest: beads.reference.is_none(),
        film_pixel_size_um: motion.pixel_um,
        places: motion.shape,
        first_place_px: motion.first,
        spacing_px: motion.step,
        subset_um: motion.subset_um,
        bead_distance_um: motion.bead_distance_um,
        displacement_error_um: motion.error_um,
        correlation: crate::analysis::order::median(correlation),
        interpolated_pct_mean: interpolated_pct.iter().sum::<f64>() / count,
        interpolated_pct_most: interpolated_pct.iter().copied().fold(0.0, f64::max),
        stage: if has_region {
            "the median displacement outside of the region was subtracted"
        } else {
            "the median displacement along the edges of the window was subtracted"
        },
        stage_largest_um: stage_um.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max),
        stage_um,
        interpolated_pct,
        repeated_frames: motion.repeated,
        interrupted: motion.interrupted,
    };
    let frames: Vec<usize> = all().map(|at| motion.frames[at] - led).collect();
    let surfaces = motion.displacements_um.into_iter().enumerate().filter(|(at, _)| kept[*at]);
    let surface = |(_, displacements): (usize, [Vec<f64>; 2])| Surface {
        spacing,
        origin: [0.0; 2],
        shape: grid.shape,
        displacements,
    };
    Displacements {
        surfaces: surfaces.map(surface).collect(),
        frames,
        frame_rate_per_s: None,
        grid,
        errors: Errors { overlap: GelMotion::OVERLAP, least_um: motion.error_um.unwrap_or(0.0) },
        followed: Some(followed),
    }
}

/// A film that begins with the picture of the relaxed gel.
fn led_by(
    path: &Path,
    film: Film,
    selection: &Selection,
    files: &Files,
) -> Result<Film, ExperimentError> {
    let failed = |error: &dyn std::fmt::Display| {
        ExperimentError::new(format!("the reference `{}`: {error}", path.display()))
    };
    let pictures = open_film(path, selection, 1, files)?;
    if pictures.len() > 1 {
        let message = format!("it has {} frames; one picture is needed", pictures.len());
        return Err(failed(&message).advise("save one frame of it as a picture"));
    }
    let picture = pictures.frame(0).map_err(|error| failed(&error))?;
    let [found, wanted] = [[picture.width(), picture.height()], film.size()];
    film.after(picture).map_err(|_| {
        let message = format!(
            "it has {} x {} pixels, the pictures of the pulled gel have {} x {}",
            found[0], found[1], wanted[0], wanted[1]
        );
        failed(&message).advise("both must show the same window of the gel at the same scale")
    })
}

fn without_reference(name: &str, frames: usize) -> ExperimentError {
    let what = match frames {
        1 => "is one picture".to_owned(),
        count => format!("has only {count} frames"),
    };
    ExperimentError::new(format!(
        "`{name}` {what}, which shows no gel at rest; at least {FEWEST_FRAMES} frames do without a reference"
    ))
    .advise("give a picture of the gel without the cell, or with the cell relaxed: --reference relaxed.tif")
}

/// That of the options, or of the film.
fn pixel_size(beads: &Beads, film: &Film) -> Result<PixelSize, ExperimentError> {
    let given = beads.pixel_size_um.map(PixelSize::new).transpose();
    let given = given.map_err(ExperimentError::new)?;
    given.or(film.pixel_size.map(|stated| stated.size)).ok_or_else(|| {
        let message = format!("`{}` does not say how large its pixels are", beads.film.display());
        ExperimentError::new(message).advise(
            "give it like --pixel-size \"0.16 um\" (the microscope's software shows it; it is the camera's pixel over the \
             magnification)",
        )
    })
}

/// Frames a second, or why they are not known. A single picture has none.
fn rate(film: &Film, given: Option<f64>) -> Result<Option<f64>, String> {
    if film.len() == 1 {
        return Ok(given);
    }
    let Some(rate) = given.or(film.frames_per_second) else {
        return Err("the film does not say how many frames a second it has".to_owned());
    };
    let most = TrackingSettings::HIGHEST_FRAME_RATE;
    if (f64::MIN_POSITIVE..=most).contains(&rate) {
        return Ok(Some(rate));
    }
    Err(format!(
        "the film says that it has {rate} frames a second; that must be above 0, at most {most}"
    ))
}

/// Beads that cannot be followed.
fn unfollowed(beads: &Beads, name: &str, cause: &BeadError) -> ExperimentError {
    let film = match (cause, &beads.reference) {
        // The frame at rest.
        (BeadError::NoBeads { .. } | BeadError::Flat { .. }, Some(path)) => {
            path.display().to_string()
        }
        _ => name.to_owned(),
    };
    let failure = ExperimentError::new(format!("`{film}`: {cause}"));
    match cause {
        BeadError::NoBeads { .. } => failure.advise(
            "is it the channel of the beads, in focus? it must not be empty or black (--channel chooses another)",
        ),
        BeadError::Flat { .. } => failure.advise(
            "give larger squares (--subset), or pictures with more light, in focus, or with more beads",
        ),
        BeadError::TooSmall { .. } => failure.advise(
            "give smaller squares (--subset), a larger frame, or check the size of a pixel (--pixel-size)",
        ),
        BeadError::Lost { .. } => failure.advise(
            "do all pictures show the same beads, in focus? give larger squares (--subset), or another frame at rest \
             (--frame) or reference (--reference)",
        ),
        BeadError::Motion(_) => failure,
    }
}
