//! The fitted cell laid over the frames of its film: a figure of one beat, and a GIF of it.

use crate::experiment::film_beat::FilmBeat;
use crate::experiment::track::Followed;
use crate::experiment::{ExperimentError, Folder};
use crate::microscopy::plane::Plane;
use crate::output::field::Fields;
use crate::output::figure::{ComparedFrame, DrawnCell, Figure, FigureError, FilmFrames};
use crate::tension_map::FrameShape;
use rayon::prelude::*;

/// Most frames of the GIF: of longer beats every second, third, ... is shown.
const MOST_SHOWN: usize = 24;
/// Hundredths of a second that a frame of it is shown, at least and at most.
const SHORTEST: f64 = 4.0;
const LONGEST: f64 = 100.0;

/// A fitted cell, and the beat of its film over which it is drawn.
pub(super) struct OverFilm<'a> {
    followed: &'a Followed,
    cell: DrawnCell<'a>,
    title: String,
    /// One for each frame of the film that the fitted cell reaches.
    shapes: &'a [FrameShape],
    beat: FilmBeat,
    /// The characteristic frames.
    planes: Vec<Plane>,
}

impl<'a> OverFilm<'a> {
    /// The fitted cell in the frames of the film that it reaches; `None` if there is none.
    pub(super) fn of(
        followed: &'a Followed,
        shapes: &'a [FrameShape],
    ) -> Result<Option<Self>, ExperimentError> {
        let Followed { motion, shaped, fibres, run, .. } = followed;
        let reached: Vec<usize> = shapes.iter().map(|shape| shape.at).collect();
        let Some(beat) = FilmBeat::of(motion, &reached) else { return Ok(None) };
        let fields = Fields::new(&motion.mesh, &fibres.directions, None);
        let fields = fields.map_err(ExperimentError::new)?;
        let cell = DrawnCell::new(fields, Some(&shaped.outline))?;
        let file = run.shape.file().unwrap_or_default();
        let name = file.rsplit(['/', '\\']).next().unwrap_or_default();
        let title = format!("{name}: {}", beat.words());
        let planes = beat.moments.iter().map(|(at, _)| plane(followed, *at));
        let planes = planes.collect::<Result<_, _>>()?;
        Ok(Some(Self { followed, cell, title, shapes, beat, planes }))
    }

    /// In a sentence.
    pub(super) fn words(&self) -> String {
        let (beat, times) = (self.beat.words(), &self.followed.motion.times_ms);
        let [first, last] = [self.beat.frames.first(), self.beat.frames.last()]
            .map(|at| at.map_or(0.0, |at| times[*at]));
        format!("The frames are those of {beat}, from {first:.0} to {last:.0} ms")
    }

    fn frames(&self) -> Option<FilmFrames<'_>> {
        let Followed { film, shaped, .. } = self.followed;
        let [width, height] = film.size();
        let pixel_size = shaped.picture.as_ref()?.0.pixel_size;
        Some(FilmFrames { title: &self.title, width, height, pixel_size, cell: &self.cell })
    }

    /// Both cells in a frame of the film.
    fn compared<'f>(
        &self,
        at: usize,
        name: &'f str,
        plane: &'f Plane,
    ) -> Option<ComparedFrame<'f>> {
        let motion = &self.followed.motion;
        let shape = self.shapes.iter().find(|shape| shape.at == at)?;
        let in_picture = |mut positions: [Vec<f64>; 2]| {
            for (positions, stage) in positions.iter_mut().zip(motion.stage_um[at]) {
                for position in positions {
                    *position += stage;
                }
            }
            positions
        };
        Some(ComparedFrame {
            name,
            frame: shape.frame,
            t_ms: shape.t_ms,
            values: plane.values(),
            measured: in_picture(motion.positions(at)),
            simulated: in_picture(shape.positions_um.clone()),
            distance_um: shape.distance_um,
            movement_um: shape.movement_um,
        })
    }

    /// The characteristic frames of the beat; `sharp` is the largest number of pixels of the film per px of the figure.
    pub(super) fn figure(&self, sharp: f64) -> Result<Figure, FigureError> {
        let nothing = FigureError::Nothing { what: "frames" };
        let drawn = self.frames().ok_or_else(|| nothing.clone())?;
        let moments = self.beat.moments.iter().zip(&self.planes);
        let frames: Option<Vec<ComparedFrame<'_>>> =
            moments.map(|((at, name), plane)| self.compared(*at, name, plane)).collect();
        let frames = frames.ok_or(nothing)?;
        let peak = self.beat.moments.iter().position(|(at, _)| *at == self.beat.peak());
        drawn.figure(&frames, peak.unwrap_or(0), sharp)
    }

    /// Writes the GIF of the beat, in real time as far as players can show it.
    pub(super) fn write_gif(&self, folder: &Folder, name: &str) -> Result<(), ExperimentError> {
        let (Some(drawn), true) = (self.frames(), self.beat.frames.len() > 1) else {
            return Ok(());
        };
        let every = self.beat.frames.len().div_ceil(MOST_SHOWN);
        let shown: Vec<usize> = self.beat.frames.iter().copied().step_by(every).collect();
        let planes: Result<Vec<Plane>, _> =
            shown.par_iter().map(|at| plane(self.followed, *at)).collect();
        let planes = planes?;
        let frames = shown.iter().zip(&planes);
        let frames: Vec<ComparedFrame<'_>> =
            frames.filter_map(|(at, plane)| self.compared(*at, "", plane)).collect();
        let common = drawn.common(&frames)?;
        let stills: Result<Vec<_>, FigureError> =
            frames.par_iter().map(|frame| drawn.still(frame, &common)).collect();
        let hundredths = 100.0 * every as f64 / self.followed.frames_per_second;
        let hundredths = hundredths.round().clamp(SHORTEST, LONGEST) as u16;
        folder.write(name, drawn.gif(&stills?, hundredths)?)
    }
}

fn plane(followed: &Followed, at: usize) -> Result<Plane, ExperimentError> {
    followed.film.frame(followed.motion.frames[at]).map_err(ExperimentError::new)
}
