//! What is written in addition to the curve.

use super::description::Output;
use super::followed::Followed;
use super::page;
use super::report::TrackReport;
use crate::experiment::{Draw, ExperimentError, Folder, Observer};
use crate::microscopy::plane::Plane;
use crate::output::figure::{FigureError, Theme, Tracked, TrackedFrame};
use crate::output::npz::Array;
use crate::output::{frames, vtu};
use crate::recording::Frame;
use rayon::prelude::*;

/// Most frames of the GIF: of longer films every second, third, ... is shown.
const MOST_SHOWN: usize = 100;
/// Hundredths of a second that a frame is shown, at least.
const SHORTEST: f64 = 3.0;

/// Writes the requested outputs.
pub(super) fn write(
    folder: &Folder,
    outputs: &[Output],
    followed: &Followed,
    report: &TrackReport,
    observer: &dyn Observer,
) -> Result<(), ExperimentError> {
    let drawn = Drawn { followed, report };
    if outputs.contains(&Output::Figures) {
        drawn.figures(folder, observer)?;
    }
    if outputs.contains(&Output::Gif) && !observer.is_late() {
        drawn.gif(folder)?;
    }
    if outputs.is_empty() {
        return Ok(());
    }
    let [frames, vtu] = [Output::Frames, Output::Vtu].map(|output| outputs.contains(&output));
    let shapes = shapes(followed);
    folder.write("report.html", page::html(followed, report, &shapes)?)?;
    if frames {
        npz(folder, followed, &shapes)?;
    }
    if vtu {
        grids(folder, followed, &shapes)?;
    }
    Ok(())
}

/// The frames in the form of those of a run, without tension.
fn shapes(followed: &Followed) -> Vec<Frame> {
    let motion = &followed.motion;
    let frame = |at: usize| Frame::new(motion.times_ms[at], f64::NAN, motion.positions(at));
    (0..motion.len()).map(frame).collect()
}

fn npz(folder: &Folder, followed: &Followed, shapes: &[Frame]) -> Result<(), ExperimentError> {
    let Followed { motion, shaped, fibres, .. } = followed;
    let (count, points) = (motion.len(), motion.mesh.len());
    let interpolated =
        motion.interpolated.iter().flatten().map(|&interpolated| i32::from(interpolated));
    let stage = motion.stage_um.iter().flatten().copied();
    let more = vec![
        ("interpolated", Array::whole([count, points], interpolated)),
        ("stage_um", Array::floats([count, 2], stage)),
    ];
    let directions = &fibres.directions;
    let bytes = frames::to_npz_with(&motion.mesh, shapes, directions, None, &shaped.outline, more)?;
    folder.write("frames.npz", bytes)
}

fn grids(folder: &Folder, followed: &Followed, shapes: &[Frame]) -> Result<(), ExperimentError> {
    let frames =
        vtu::Frames::new(&followed.motion.mesh, shapes, &followed.fibres.directions, None)?;
    (0..frames.len()).into_par_iter().try_for_each(|index| {
        folder.write(&format!("vtu/{}", frames.name(index)), frames.frame(index))
    })?;
    folder.write("cell.pvd", frames.collection("vtu"))
}

/// What figures and films are drawn from.
struct Drawn<'a> {
    followed: &'a Followed,
    report: &'a TrackReport,
}

impl Drawn<'_> {
    fn tracked(&self) -> Option<Tracked<'_>> {
        let Followed { film, motion, shaped, run, .. } = self.followed;
        let (cells, _) = shaped.picture.as_ref()?;
        let [width, height] = film.size();
        Some(Tracked {
            title: run
                .shape
                .file()
                .map_or("", |file| file.rsplit(['/', '\\']).next().unwrap_or(file)),
            width,
            height,
            pixel_size: cells.pixel_size,
            mesh: &motion.mesh,
            rows: &self.report.rows,
            contraction: &self.report.headline.contraction_pct,
            by: self.report.headline.column,
        })
    }

    /// A frame of the film, and the positions of the points in it.
    fn seen(&self, at: usize) -> Result<(Plane, [Vec<f64>; 2]), ExperimentError> {
        let Followed { film, motion, .. } = self.followed;
        let plane = film.frame(motion.frames[at]).map_err(ExperimentError::new)?;
        let mut positions = motion.positions(at);
        for (positions, stage) in positions.iter_mut().zip(motion.stage_um[at]) {
            for position in positions {
                *position += stage;
            }
        }
        Ok((plane, positions))
    }

    fn figures(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        let Some(tracked) = self.tracked() else { return Ok(()) };
        let motion = &self.followed.motion;
        let rest = motion.rest_index();
        let shortest = self.report.headline.at;
        let [(rest_plane, rest_at), (plane, at)] = [self.seen(rest)?, self.seen(shortest)?];
        // A point that was never found is as uncertain in the picture at rest as later.
        let often: Vec<bool> = (0..motion.mesh.len())
            .map(|point| {
                let interpolated =
                    motion.interpolated.iter().filter(|interpolated| interpolated[point]).count();
                2 * interpolated > motion.len()
            })
            .collect();
        let frame = |plane: &'_ Plane| plane.values().to_vec();
        let (rest_values, values) = (frame(&rest_plane), frame(&plane));
        let draw = || -> Result<_, FigureError> {
            let rest = TrackedFrame {
                values: &rest_values,
                positions: &rest_at,
                interpolated: &often,
                row: rest,
            };
            let interpolated = &motion.interpolated[shortest];
            let shortest =
                TrackedFrame { values: &values, positions: &at, interpolated, row: shortest };
            tracked.summary(&rest, &shortest)
        };
        let figures: [(&str, Draw<'_>); 1] = [("track", &draw)];
        folder.figures(Theme::default(), &figures, observer)
    }

    fn gif(&self, folder: &Folder) -> Result<(), ExperimentError> {
        let Some(tracked) = self.tracked() else { return Ok(()) };
        let motion = &self.followed.motion;
        if motion.len() < 2 {
            return Ok(());
        }
        // Real time, as far as players can show it.
        let hundredths = 100.0 / self.followed.frames_per_second;
        let every =
            motion.len().div_ceil(MOST_SHOWN).max((SHORTEST / hundredths).floor() as usize).max(1);
        let shown: Vec<usize> = (0..motion.len()).step_by(every).collect();
        let stills: Result<Vec<_>, ExperimentError> = shown
            .into_par_iter()
            .map(|at| {
                let (plane, positions) = self.seen(at)?;
                let frame = TrackedFrame {
                    values: plane.values(),
                    positions: &positions,
                    interpolated: &motion.interpolated[at],
                    row: at,
                };
                Ok(tracked.still(&frame)?)
            })
            .collect();
        let delay = (hundredths * every as f64).round().clamp(SHORTEST, 6000.0);
        folder.write("track.gif", tracked.gif(&stills?, delay as u16)?)
    }
}
