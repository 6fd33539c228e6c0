//! The walk through a film: each frame is decoded and prepared once, and all cells are followed in it.

use super::cell::{CellAtRest, CellMotion, Progress, TrackingSettings};
use super::error::MotionError;
use super::follower::{self, Follower, Frame};
use super::rest::Rest;
use super::stage::{Background, Stage};
use super::subset::Warp;
use crate::film::Film;
use crate::plane::Plane;
use rayon::prelude::*;

/// A film with its frame at rest, and the cells in it that have enough texture.
pub(super) struct Walk<'a> {
    film: &'a Film,
    repeats: Vec<Option<usize>>,
    rest: Rest,
    settings: TrackingSettings,
    pixel_um: f64,
    background: Option<Background>,
    /// In the order of the cells; why a cell cannot be followed.
    cells: Vec<Result<Follower<'a>, MotionError>>,
}

/// What one frame shows.
struct Walked {
    /// Motion of the background, pixels.
    stage: Option<[f32; 2]>,
    /// Of each cell that is followed.
    cells: Vec<Frame>,
}

/// The frames that were done, with their numbers in the film.
struct Done {
    numbers: Vec<usize>,
    frames: Vec<Walked>,
    repeated: Vec<usize>,
    interrupted: bool,
}

impl<'a> Walk<'a> {
    /// # Errors
    /// A frame that cannot be read.
    pub(super) fn new(
        film: &'a Film,
        rest: Rest,
        cells: &'a [CellAtRest<'a>],
        settings: TrackingSettings,
    ) -> Result<Self, MotionError> {
        let repeats = film.repeats()?;
        // If the frame at rest is a repeat, the frame that it repeats is used.
        let rest = Rest { frame: repeats[rest.frame].unwrap_or(rest.frame), ..rest };
        let plane = film.frame(rest.frame)?;
        let first = cells.first();
        let pixel_um = first.map_or(1.0, |cell| cell.pixel_size.um());
        let half = follower::half(settings.subset_um, pixel_um, settings.texture);
        let background = first
            .and_then(|cell| Background::new(&plane, cell.any_cell, pixel_um, rest.noise, half));
        let cells =
            cells.par_iter().map(|cell| Follower::new(&plane, rest, cell, settings)).collect();
        Ok(Self { film, repeats, rest, settings, pixel_um, background, cells })
    }

    fn followers(&self) -> Vec<&Follower<'a>> {
        self.cells.iter().filter_map(|cell| cell.as_ref().ok()).collect()
    }

    /// Follows all cells, forward from the frame at rest and then backward. A cell that cannot be followed does not stop the
    /// others.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub(super) fn motions(
        self,
        goes_on: impl FnMut(Progress) -> bool + Send,
    ) -> Result<Vec<Result<CellMotion, MotionError>>, MotionError> {
        let done = self.film(goes_on)?;
        let followers = self.followers();
        let of = |cell: usize| -> Vec<&Frame> {
            done.frames.iter().map(|frame| &frame.cells[cell]).collect()
        };
        let mut found: Vec<Result<(&Follower<'a>, Vec<&Frame>), MotionError>> = Vec::new();
        for (at, follower) in followers.iter().enumerate() {
            let frames = of(at);
            found.push(Follower::check(&frames, &done.numbers).map(|()| (*follower, frames)));
        }
        let seen: Vec<&(&Follower<'a>, Vec<&Frame>)> = found.iter().flatten().collect();
        let (stage, stage_um) = self.stage(&done, &seen);
        let motions: Vec<Result<CellMotion, MotionError>> = found
            .iter()
            .map(|found| match found {
                Ok((follower, frames)) => {
                    Ok(self.motion(&done, follower, frames, (stage, &stage_um)))
                }
                Err(cause) => Err(cause.clone()),
            })
            .collect();
        let mut motions = motions.into_iter();
        let every = self.cells.iter().map(|cell| match cell {
            Ok(_) => motions.next(),
            Err(cause) => Some(Err(cause.clone())),
        });
        Ok(every.flatten().collect())
    }

    fn film(&self, mut goes_on: impl FnMut(Progress) -> bool + Send) -> Result<Done, MotionError> {
        let (rest, count) = (self.rest.frame, self.film.len());
        let followers = self.followers();
        let mut frames: Vec<Option<Walked>> = (0..count).map(|_| None).collect();
        let taken = |index: &usize| self.repeats[*index].is_none();
        let ways = [
            (rest..count).filter(taken).collect::<Vec<_>>(),
            (0..rest).rev().filter(taken).collect(),
        ];
        let all = ways.iter().map(Vec::len).sum();
        let mut done = 0;
        'ways: for way in ways.iter().filter(|_| !followers.is_empty()) {
            let mut last: Vec<Vec<Warp>> = match &frames[rest] {
                Some(frame) => frame.cells.iter().map(|cell| cell.field.warps.clone()).collect(),
                None => followers.iter().map(|follower| follower.still()).collect(),
            };
            let mut stage = [0.0; 2];
            let mut next = way.first().map(|&first| self.film.frame(first)).transpose()?;
            for (at, &index) in way.iter().enumerate() {
                let Some(plane) = next.take() else { break };
                // The next frame is decoded meanwhile.
                let following = way.get(at + 1).copied();
                let decode = || following.map(|index| self.film.frame(index)).transpose();
                let step = || self.step(&followers, &plane, &last, stage);
                let (frame, decoded) = rayon::join(step, decode);
                next = decoded?;
                for (last, cell) in last.iter_mut().zip(&frame.cells) {
                    last.clone_from(&cell.field.warps);
                }
                stage = frame.stage.unwrap_or(stage);
                frames[index] = Some(frame);
                done += 1;
                if !goes_on((done, all)) {
                    break 'ways;
                }
            }
        }
        let numbers: Vec<usize> = (0..count).filter(|&at| frames[at].is_some()).collect();
        let between = numbers.first().zip(numbers.last()).map_or(0..0, |(a, b)| *a..*b);
        let repeated = between.filter(|&at| self.repeats[at].is_some()).collect();
        let interrupted = (0..count).any(|at| frames[at].is_none() && self.repeats[at].is_none());
        Ok(Done { numbers, frames: frames.into_iter().flatten().collect(), repeated, interrupted })
    }

    /// Follows all cells and the background into a frame.
    fn step(
        &self,
        followers: &[&Follower<'a>],
        plane: &Plane,
        last: &[Vec<Warp>],
        stage: [f32; 2],
    ) -> Walked {
        let Some(first) = followers.first() else {
            return Walked { stage: None, cells: Vec::new() };
        };
        let seen = first.see(plane);
        let pairs: Vec<_> = followers.iter().zip(last).collect();
        let cells = pairs.into_par_iter().map(|(follower, last)| follower.frame(&seen, last));
        let cells = cells.collect();
        let background = self.background.as_ref();
        let stage = background.and_then(|background| background.shift(&seen.fine, stage));
        Walked { stage, cells }
    }

    /// How the motion of the stage is determined, and the motion in each frame, um, y upward.
    fn stage(
        &self,
        done: &Done,
        cells: &[&(&Follower<'a>, Vec<&Frame>)],
    ) -> (Stage, Vec<[f64; 2]>) {
        let seen = done.frames.iter().filter(|frame| frame.stage.is_some()).count();
        // Frames without a visible background take the motion of the last one, if it was visible in nearly all
        // others.
        let stage = match &self.background {
            Some(background) if 10 * seen >= 9 * done.frames.len() => {
                Stage::Background { points: background.len() }
            }
            _ => Stage::CellMean { cells: cells.len() },
        };
        let area: f64 =
            cells.iter().map(|(follower, _)| follower.cell.mesh.areas.iter().sum::<f64>()).sum();
        let mut last = [0.0; 2];
        let mut moved = |(at, frame): (usize, &Walked)| {
            let now = match stage {
                Stage::Background { .. } => frame.stage.map_or(last, |shift| self.um(shift)),
                Stage::CellMean { .. } => {
                    let mut sum = [0.0; 2];
                    for (follower, frames) in cells {
                        let warps = &frames[at].field.warps;
                        for (warp, area) in warps.iter().zip(&follower.cell.mesh.areas) {
                            let shift = self.um(warp.shift);
                            sum = [0, 1].map(|axis: usize| sum[axis] + area * shift[axis]);
                        }
                    }
                    sum.map(|sum| sum / area)
                }
            };
            last = now;
            now
        };
        (stage, done.frames.iter().enumerate().map(&mut moved).collect())
    }

    /// A shift in pixels, y downward, in um, y upward.
    fn um(&self, [x, y]: [f32; 2]) -> [f64; 2] {
        [self.pixel_um * f64::from(x), -self.pixel_um * f64::from(y)]
    }

    /// Combines the frames of a cell.
    fn motion(
        &self,
        done: &Done,
        follower: &Follower<'a>,
        frames: &[&Frame],
        (stage, stage_um): (Stage, &[[f64; 2]]),
    ) -> CellMotion {
        let pixel_um = self.pixel_um;
        let displacements_um = frames.iter().zip(stage_um).map(|(frame, stage)| {
            [0, 1].map(|axis: usize| {
                let warps = frame.field.warps.iter();
                warps.map(|warp| self.um(warp.shift)[axis] - stage[axis]).collect()
            })
        });
        let periods: Vec<Vec<Option<f32>>> =
            frames.iter().map(|frame| frame.periods.clone()).collect();
        let sarcomeres = follower.stripes.lengths(&periods, pixel_um);
        let time = |number: &usize| 1000.0 * *number as f64 / self.settings.frames_per_second;
        let missing = |frame: &&Frame| frame.field.found.iter().map(Option::is_none).collect();
        CellMotion {
            mesh: follower.cell.mesh.clone(),
            times_ms: done.numbers.iter().map(time).collect(),
            frames: done.numbers.clone(),
            repeated: done.repeated.clone(),
            interrupted: done.interrupted,
            rest: self.rest.frame,
            displacements_um: displacements_um.collect(),
            interpolated: frames.iter().map(missing).collect(),
            correlation: frames
                .iter()
                .map(|frame| frame.field.correlation().map(f64::from))
                .collect(),
            stage,
            stage_um: stage_um.to_vec(),
            sarcomeres_um: sarcomeres.mean_um,
            sarcomere_places: sarcomeres.places,
            sarcomere_parts: sarcomeres.parts,
            sarcomeres_by_part_um: sarcomeres.by_part_um,
            error_um: follower.fine.error(self.rest.noise).map(|error| error * pixel_um),
            noise: self.rest.noise,
            subset_um: (2 * follower.fine.half() + 1) as f64 * pixel_um,
            pixel_um,
            frame_um: self.film.size().map(|pixels| pixels as f64 * pixel_um),
        }
    }
}
