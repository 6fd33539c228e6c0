//! The motion of a cell through a film: digital image correlation on the points of its lattice.
//!
//! 1. [`Rest::find`] chooses the frame at rest.
//! 2. Around each point of the lattice a **subset** (the cell's pixels of the frame at rest) is
//!    matched in every frame, with free translation and gradients, by the zero-normalised sum of
//!    squared differences (independent of brightness and contrast), inverse-compositional
//!    Gauss-Newton steps, and cubic B-splines between pixels.
//! 3. Every frame is compared with the one at rest, so nothing drifts; the search starts from the
//!    result of the frame before, and from a coarse level, where stripes are blurred away: stripes
//!    repeat, so a start that is half a sarcomere off would end on the wrong stripe.
//! 4. Points that correlate badly, disagree with their neighbours, or belong to a group that
//!    disagrees with a larger adjacent group are searched again from the position that their
//!    neighbours predict. Points that still disagree are **interpolated** from their neighbours,
//!    marked and counted.
//! 5. The motion of the stage is subtracted: that of the background if it has a texture, otherwise
//!    the mean of the cell.
//!
//! Displacements are um, y upward, as in meshes.

mod doubts;
mod error;
mod headline;
mod level;
mod measure;
mod neighbours;
mod rest;
mod sarcomeres;
mod spline;
mod stage;
mod stripes;
mod subset;

pub use error::MotionError;
pub use headline::{Headline, Measure, Reason};
pub use measure::Stretches;
pub use rest::Rest;
pub use sarcomeres::Estimate;
pub use stage::Stage;
pub use stripes::FEWEST_PARTS;

use crate::fibres::FibreField;
use crate::film::Film;
use crate::filter;
use crate::outlines::PixelFrame;
use crate::plane::Plane;
use error::RATES;
use level::{Detail, Field, Level, SMOOTHING, mask};
use myospring_core::mesh::Mesh;
use myospring_core::mesh::pixel_size::PixelSize;
use rayon::ThreadPoolBuilder;
use spline::Spline;
use stage::Background;
use stripes::Stripes;
use subset::Warp;

/// Half of the smallest and of the largest side of a subset, pixels.
const HALVES: [usize; 2] = [8, 30];
/// Width of the band outside the cell that is also used, um, because it contains the blurred rim.
const RIM_UM: f64 = 0.6;
/// Blur that removes stripes, um, and its least value in pixels; pixels of the film per pixel of
/// the coarse level.
const BLUR_UM: f64 = 0.9;
const LEAST_BLUR: f64 = 1.5;
const COARSE_UM: f64 = 0.8;
/// Half of a coarse subset's side, pixels of its level, and the distance of its points, um.
const COARSE_HALF: usize = 9;
const COARSE_APART_UM: f64 = 4.0;
/// If the coarse level differs from the frame before by at least this, it is used as a second
/// start, pixels.
const ANOTHER_START: f32 = 0.3;
/// Largest deviation of a point from its neighbours, um: well below half a sarcomere.
const OFF_UM: f64 = 0.4;
/// Distance of neighbours, and of adjacent points, in spacings of the lattice.
const REACH: f32 = 2.6;
const NEXT: f32 = 1.5;
/// Least part of the points that must be found in the median frame.
const LEAST_FOUND: f64 = 0.3;

/// Options for following a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackingSettings {
    /// Frames a second.
    pub frames_per_second: f64,
    /// Side of a subset, um; limited to 17 to 61 pixels.
    pub subset_um: f64,
    /// Number of threads; `None` uses one per core. Results do not depend on it.
    pub threads: Option<usize>,
}

impl TrackingSettings {
    /// Default side of a subset, um: two sarcomeres.
    pub const SUBSET_UM: f64 = 4.0;
    /// Sides of a subset that make sense, um.
    pub const SUBSETS_UM: [f64; 2] = [0.5, 100.0];
    /// No camera takes more frames a second.
    pub const HIGHEST_FRAME_RATE: f64 = 1e6;

    /// The defaults for a frame rate.
    pub const fn at(frames_per_second: f64) -> Self {
        Self { frames_per_second, subset_um: Self::SUBSET_UM, threads: None }
    }
}

/// The cell in the frame at rest.
#[derive(Debug, Clone, Copy)]
pub struct CellAtRest<'a> {
    /// Its lattice, um from the lower left corner of the picture.
    pub mesh: &'a Mesh,
    /// For each pixel, row by row from the top left: whether it belongs to this cell.
    pub inside: &'a [bool],
    /// For each pixel, row by row from the top left: whether it belongs to any cell, this one or
    /// another.
    pub any_cell: &'a [bool],
    /// Side of a pixel.
    pub pixel_size: PixelSize,
    /// Its fibres; used to measure sarcomeres.
    pub fibres: Option<&'a FibreField>,
}

/// The motion of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellMotion {
    /// The lattice at rest.
    pub mesh: Mesh,
    /// Numbers in the film of the frames that were followed, ascending. All lists by frame below
    /// are in this order.
    pub frames: Vec<usize>,
    /// Numbers of the frames that repeat the one before ([`Film::repeats`]); they were not
    /// followed.
    pub repeated: Vec<usize>,
    /// Whether `goes_on` stopped it before all frames were done.
    pub interrupted: bool,
    /// Number in the film of the frame at rest; it is one of [`CellMotion::frames`].
    pub rest: usize,
    /// Time of each frame from the first of the film, ms.
    pub times_ms: Vec<f64>,
    /// Displacement of each point from its position at rest, without the motion of the stage, um, y
    /// upward: `displacements_um[frame][axis][point]`.
    pub displacements_um: Vec<[Vec<f64>; 2]>,
    /// Which points were interpolated from their neighbours: `interpolated[frame][point]`.
    pub interpolated: Vec<Vec<bool>>,
    /// Median zero-normalised correlation of the points that were found, by frame; 1 for a perfect
    /// match.
    pub correlation: Vec<Option<f64>>,
    /// How the motion of the stage was determined.
    pub stage: Stage,
    /// Motion of the stage that was subtracted in each frame, um, y upward.
    pub stage_um: Vec<[f64; 2]>,
    /// Mean length of the sarcomeres in each frame by the period of the stripes, um; `None` where the picture shows
    /// none.
    pub sarcomeres_um: Vec<Option<f64>>,
    /// Number of places at which sarcomeres were read.
    pub sarcomere_places: usize,
    /// Number of independent parts of the cell in which these places lie: the parts are so far
    /// apart that they share no stripes.
    pub sarcomere_parts: usize,
    /// Mean length in each frame, in each of these parts, um; empty if there are too few parts for
    /// a mean.
    pub sarcomeres_by_part_um: Vec<Vec<Option<f64>>>,
    /// Median standard error of a point's displacement due to noise, um.
    pub error_um: Option<f64>,
    /// Standard deviation of the noise, grey levels.
    pub noise: f64,
    /// Side of a subset, um.
    pub subset_um: f64,
    /// Side of a pixel, um.
    pub pixel_um: f64,
    /// Width and height of the frame, um; its lower left corner is the origin.
    pub frame_um: [f64; 2],
}

/// Progress: number of frames done, and of all frames to follow (without repeats).
pub type Progress = (usize, usize);

/// Follows a cell through a film from the frame at rest. `goes_on` is called after each frame; if
/// it returns false, the motion has the frames done so far.
///
/// # Errors
/// A frame that cannot be read, a frame rate out of range, a mask of another size, a cell without
/// texture, or a film in which too few points are found again.
pub fn follow(
    film: &Film,
    rest: Rest,
    cell: &CellAtRest<'_>,
    settings: TrackingSettings,
    goes_on: impl FnMut(Progress) -> bool + Send,
) -> Result<CellMotion, MotionError> {
    let rate = settings.frames_per_second;
    if !(rate.is_finite() && (RATES[0]..=RATES[1]).contains(&rate)) {
        return Err(MotionError::Rate { rate });
    }
    let [width, height] = film.size();
    if [cell.inside, cell.any_cell].iter().any(|mask| mask.len() != width * height) {
        return Err(MotionError::Mask { width, height });
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads =
        settings.threads.filter(|count| *count > 0).map_or(cores, |count| count.min(cores));
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|cause| MotionError::Threads { cause: cause.to_string() })?;
    pool.install(|| Follower::new(film, rest, cell, settings)?.film(goes_on))
}

/// The frame at rest, prepared for the comparison with others.
struct Follower<'a> {
    film: &'a Film,
    repeats: Vec<Option<usize>>,
    rest: Rest,
    cell: &'a CellAtRest<'a>,
    settings: TrackingSettings,
    fine: Level,
    coarse: Level,
    /// Which points the coarse level uses, and for each point the coarse points that represent it,
    /// with weights.
    chosen: Vec<usize>,
    standing: Vec<Vec<(usize, f32)>>,
    points: Vec<[f32; 2]>,
    stripes: Stripes,
    background: Option<Background>,
}

/// Result of one frame.
struct Frame {
    field: Field,
    stage: Option<[f32; 2]>,
    periods: Vec<Option<f32>>,
}

/// A frame, prepared for both levels.
struct Seen {
    fine: Spline,
    coarse: Spline,
}

impl<'a> Follower<'a> {
    fn new(
        film: &'a Film,
        rest: Rest,
        cell: &'a CellAtRest<'a>,
        settings: TrackingSettings,
    ) -> Result<Self, MotionError> {
        let repeats = film.repeats()?;
        // If the frame at rest is a repeat, the frame that it repeats is used.
        let rest = Rest { frame: repeats[rest.frame].unwrap_or(rest.frame), ..rest };
        let plane = film.frame(rest.frame)?;
        let pixel_um = cell.pixel_size.um();
        let frame = PixelFrame::new(plane.width(), plane.height(), cell.pixel_size)
            .map_err(|_| MotionError::Mask { width: plane.width(), height: plane.height() })?;
        let points: Vec<[f32; 2]> = (0..cell.mesh.len())
            .map(|node| frame.to_pixels(cell.mesh.point(node)).map(|at| (at - 0.5) as f32))
            .collect();
        let spacing = spacing(cell.mesh) / pixel_um;
        let half = ((settings.subset_um / pixel_um - 1.0) / 2.0).round().max(0.0) as usize;
        let [least, most] = HALVES;
        let detail = Detail {
            factor: 1,
            blur: SMOOTHING,
            half: half.clamp(least, most),
            reach: [REACH, NEXT].map(|part| part * spacing as f32),
            off_by: [0.25, (OFF_UM / pixel_um).max(1.0) as f32],
        };
        let allowed = mask(&plane, |at| cell.inside[at]);
        let allowed =
            filter::largest_nearby(&allowed, (RIM_UM / pixel_um).round().max(1.0) as usize);
        let fine = Level::new(&plane, &points, &allowed, rest.noise, detail);
        if fine.textured_share() < LEAST_FOUND {
            return Err(MotionError::Flat {
                textured_pct: 100.0 * fine.textured_share(),
                noise: rest.noise,
                contrast: rest.contrast,
            });
        }

        let factor = ((COARSE_UM / pixel_um).round() as usize).max(2);
        let blur = (BLUR_UM / pixel_um).max(LEAST_BLUR);
        let chosen = scattered(&points, (COARSE_APART_UM / pixel_um).max(spacing) as f32);
        let apart = ((COARSE_APART_UM / pixel_um).max(spacing) / factor as f64) as f32;
        let coarse_detail = Detail {
            factor,
            blur,
            half: COARSE_HALF,
            reach: [3.5 * apart, 2.0 * apart],
            off_by: [0.3, 1.0],
        };
        let coarse_points: Vec<[f32; 2]> = chosen.iter().map(|&point| points[point]).collect();
        let coarse = Level::new(&plane, &coarse_points, &allowed, rest.noise, coarse_detail);
        let standing = standing(&points, &coarse_points, apart * factor as f32);
        let stripes = cell.fibres.map(|field| Stripes::new(field, &points, &frame));
        let background =
            Background::new(&plane, cell.any_cell, pixel_um, rest.noise, half.clamp(least, most));
        Ok(Self {
            film,
            repeats,
            rest,
            cell,
            settings,
            fine,
            coarse,
            chosen,
            standing,
            points,
            stripes: stripes.unwrap_or_default(),
            background,
        })
    }

    fn see(&self, plane: &Plane) -> Seen {
        let (fine, coarse) = rayon::join(|| self.fine.look(plane), || self.coarse.look(plane));
        Seen { fine, coarse }
    }

    /// Follows all frames, forward from the one at rest and then backward.
    fn film(
        &self,
        mut goes_on: impl FnMut(Progress) -> bool + Send,
    ) -> Result<CellMotion, MotionError> {
        let (rest, count) = (self.rest.frame, self.film.len());
        let mut frames: Vec<Option<Frame>> = (0..count).map(|_| None).collect();
        let taken = |index: &usize| self.repeats[*index].is_none();
        let ways = [
            (rest..count).filter(taken).collect::<Vec<_>>(),
            (0..rest).rev().filter(taken).collect(),
        ];
        let all = ways.iter().map(Vec::len).sum();
        let mut done = 0;
        'ways: for way in ways {
            let still = vec![Warp::default(); self.points.len()];
            let mut last = match &frames[rest] {
                Some(frame) => frame.field.warps.clone(),
                None => still,
            };
            let mut stage = [0.0; 2];
            let mut next = way.first().map(|&first| self.film.frame(first)).transpose()?;
            for (at, &index) in way.iter().enumerate() {
                let Some(plane) = next.take() else { break };
                // The next frame is decoded meanwhile.
                let following = way.get(at + 1).copied();
                let decode = || following.map(|index| self.film.frame(index)).transpose();
                let (frame, decoded) = rayon::join(|| self.frame(&plane, &last, stage), decode);
                next = decoded?;
                last.clone_from(&frame.field.warps);
                stage = frame.stage.unwrap_or(stage);
                frames[index] = Some(frame);
                done += 1;
                if !goes_on((done, all)) {
                    break 'ways;
                }
            }
        }
        self.motion(frames)
    }

    /// Follows all points into a frame.
    fn frame(&self, plane: &Plane, last: &[Warp], stage: [f32; 2]) -> Frame {
        let seen = self.see(plane);
        let start: Vec<Warp> = self.chosen.iter().map(|&point| last[point]).collect();
        let coarse = self.coarse.follow(&seen.coarse, &[&start]);
        // Change since the last frame according to the coarse level, interpolated to all points.
        let beyond: Vec<Option<Warp>> = (coarse.warps.iter().zip(&coarse.found).zip(&start))
            .map(|((now, found), start)| found.map(|_| difference(now, start)))
            .collect();
        let mut differs = false;
        let moved: Vec<Warp> = (last.iter().zip(&self.standing).enumerate())
            .map(|(point, (warp, standing))| {
                let more = self.spread(point, standing, &beyond);
                let more = more.filter(|more| more.shift[0].hypot(more.shift[1]) > ANOTHER_START);
                differs |= more.is_some();
                more.map_or(*warp, |more| sum(warp, &more))
            })
            .collect();
        let field = if differs {
            self.fine.follow(&seen.fine, &[last, &moved])
        } else {
            self.fine.follow(&seen.fine, &[last])
        };
        let background = self.background.as_ref();
        let stage = background.and_then(|background| background.shift(&seen.fine, stage));
        let periods = self.stripes.read(&seen.fine, &field.warps);
        Frame { field, stage, periods }
    }

    fn spread(
        &self,
        point: usize,
        standing: &[(usize, f32)],
        beyond: &[Option<Warp>],
    ) -> Option<Warp> {
        let (mut total, mut all) = (0.0, Warp::default());
        for &(coarse, weight) in standing {
            let Some(more) = &beyond[coarse] else { continue };
            let from = self.points[self.chosen[coarse]];
            let shift = more.at([0, 1].map(|a: usize| self.points[point][a] - from[a]));
            total += weight;
            for a in 0..2 {
                all.shift[a] += weight * shift[a];
            }
        }
        (total > 0.0).then(|| Warp { shift: all.shift.map(|shift| shift / total), ..all })
    }

    /// Displacements of the points in each frame without that of the stage, and that of the stage, um.
    fn displacements(&self, done: &[Frame], stage: Stage) -> (Vec<[Vec<f64>; 2]>, Vec<[f64; 2]>) {
        let pixel_um = self.cell.pixel_size.um();
        let (mut displacements_um, mut stage_um) = (Vec::new(), Vec::new());
        let mut last = [0.0; 2];
        let areas = &self.cell.mesh.areas;
        let total: f64 = areas.iter().sum();
        for frame in done {
            let along = |axis: usize| -> Vec<f64> {
                let sign = if axis == 0 { pixel_um } else { -pixel_um };
                frame.field.warps.iter().map(|warp| sign * f64::from(warp.shift[axis])).collect()
            };
            let mut moved = [along(0), along(1)];
            let stage = match stage {
                Stage::Background { .. } => {
                    let shift = frame.stage.map(|[x, y]| [f64::from(x), -f64::from(y)]);
                    shift.map_or(last, |shift| shift.map(|shift| shift * pixel_um))
                }
                Stage::CellMean => [0, 1].map(|axis: usize| {
                    moved[axis].iter().zip(areas).map(|(u, area)| u * area).sum::<f64>() / total
                }),
            };
            last = stage;
            for (moved, stage) in moved.iter_mut().zip(stage) {
                for u in moved {
                    *u -= stage;
                }
            }
            displacements_um.push(moved);
            stage_um.push(stage);
        }
        (displacements_um, stage_um)
    }

    /// Combines the frames that were done.
    fn motion(&self, frames: Vec<Option<Frame>>) -> Result<CellMotion, MotionError> {
        let numbers: Vec<usize> = (0..frames.len()).filter(|&at| frames[at].is_some()).collect();
        let between = numbers.first().zip(numbers.last()).map_or(0..0, |(a, b)| *a..*b);
        let repeated = between.filter(|&at| self.repeats[at].is_some()).collect();
        let interrupted =
            (0..frames.len()).any(|at| frames[at].is_none() && self.repeats[at].is_none());
        let done: Vec<Frame> = frames.into_iter().flatten().collect();
        let mut shares: Vec<f64> = done.iter().map(|frame| frame.field.found_share()).collect();
        let worst = (0..shares.len()).min_by(|&a, &b| shares[a].total_cmp(&shares[b])).unwrap_or(0);
        let least_share = shares.get(worst).copied().unwrap_or(0.0);
        shares.sort_by(f64::total_cmp);
        let middle = shares.get((shares.len().max(1) - 1) / 2).copied().unwrap_or(0.0);
        if middle < LEAST_FOUND {
            return Err(MotionError::Lost {
                found_pct: 100.0 * middle,
                frame: numbers[worst],
                least_pct: 100.0 * least_share,
            });
        }
        let pixel_um = self.cell.pixel_size.um();
        let from_background = done.iter().filter(|frame| frame.stage.is_some()).count();
        // Frames without a visible background are interpolated if it was visible in nearly all
        // others.
        let stage = match &self.background {
            Some(background) if 10 * from_background >= 9 * done.len() => {
                Stage::Background { points: background.len() }
            }
            _ => Stage::CellMean,
        };
        let (displacements_um, stage_um) = self.displacements(&done, stage);
        let periods: Vec<Vec<Option<f32>>> =
            done.iter().map(|frame| frame.periods.clone()).collect();
        let sarcomeres = self.stripes.lengths(&periods, pixel_um);
        let time = |number: &usize| 1000.0 * *number as f64 / self.settings.frames_per_second;
        let side = (2 * self.fine.half() + 1) as f64 * pixel_um;
        Ok(CellMotion {
            mesh: self.cell.mesh.clone(),
            times_ms: numbers.iter().map(time).collect(),
            frames: numbers,
            repeated,
            interrupted,
            rest: self.rest.frame,
            displacements_um,
            interpolated: done
                .iter()
                .map(|frame| frame.field.found.iter().map(Option::is_none).collect())
                .collect(),
            correlation: done
                .iter()
                .map(|frame| frame.field.correlation().map(f64::from))
                .collect(),
            stage,
            stage_um,
            sarcomeres_um: sarcomeres.mean_um,
            sarcomere_places: sarcomeres.places,
            sarcomere_parts: sarcomeres.parts,
            sarcomeres_by_part_um: sarcomeres.by_part_um,
            error_um: self.fine.error(self.rest.noise).map(|error| error * pixel_um),
            noise: self.rest.noise,
            subset_um: side,
            pixel_um,
            frame_um: self.film.size().map(|pixels| pixels as f64 * pixel_um),
        })
    }
}

impl CellMotion {
    /// Which points lie within one spacing of the frame's edge, where the frame may cut the cell.
    pub fn cut(&self) -> Vec<bool> {
        let reach = spacing(&self.mesh);
        let at_edge = |point: usize| {
            let place = self.mesh.point(point);
            (0..2).any(|axis| place[axis] < reach || self.frame_um[axis] - place[axis] < reach)
        };
        (0..self.mesh.len()).map(at_edge).collect()
    }

    /// Side of a square within which the errors of points are correlated, um, because subsets
    /// overlap and neighbours are averaged. The cell has about as many independent errors as it has
    /// such squares.
    pub fn alike_um(&self) -> f64 {
        let smoothing = f64::from(REACH / neighbours::SMOOTHING) * spacing(&self.mesh);
        // Areas of correlation add: a side a has a^2, a Gaussian of standard deviation s has 4 pi
        // s^2.
        (self.subset_um.powi(2) + 4.0 * std::f64::consts::PI * smoothing.powi(2)).sqrt()
    }
}

/// Distance of neighbouring points, um.
fn spacing(mesh: &Mesh) -> f64 {
    let mean = || (mesh.area() / mesh.len() as f64).sqrt();
    mesh.lattice.as_ref().map_or_else(mean, |lattice| lattice.spacing)
}

/// Indices of some points: at most one in each square of a grid.
fn scattered(points: &[[f32; 2]], apart: f32) -> Vec<usize> {
    let mut nearest = std::collections::BTreeMap::<[i32; 2], (f32, usize)>::new();
    for (index, point) in points.iter().enumerate() {
        let square = point.map(|at| (at / apart).floor());
        let middle = square.map(|at| (at + 0.5) * apart);
        let away = (point[0] - middle[0]).hypot(point[1] - middle[1]);
        let entry = nearest.entry(square.map(|at| at as i32)).or_insert((away, index));
        if away < entry.0 {
            *entry = (away, index);
        }
    }
    nearest.into_values().map(|(_, index)| index).collect()
}

/// For each point, the coarse points around it with weights that decrease with distance.
fn standing(points: &[[f32; 2]], coarse: &[[f32; 2]], apart: f32) -> Vec<Vec<(usize, f32)>> {
    let of = |point: &[f32; 2]| {
        let weigh = |(index, other): (usize, &[f32; 2])| {
            let away = (point[0] - other[0]).hypot(point[1] - other[1]) / apart;
            (away < 2.5).then(|| (index, (-away * away).exp()))
        };
        coarse.iter().enumerate().filter_map(weigh).collect()
    };
    points.iter().map(of).collect()
}

fn difference(a: &Warp, b: &Warp) -> Warp {
    let minus = |a: [f32; 2], b: [f32; 2]| [a[0] - b[0], a[1] - b[1]];
    let [ga, gb] = [a.gradient, b.gradient];
    Warp { shift: minus(a.shift, b.shift), gradient: [minus(ga[0], gb[0]), minus(ga[1], gb[1])] }
}

fn sum(a: &Warp, b: &Warp) -> Warp {
    let plus = |a: [f32; 2], b: [f32; 2]| [a[0] + b[0], a[1] + b[1]];
    let [ga, gb] = [a.gradient, b.gradient];
    Warp { shift: plus(a.shift, b.shift), gradient: [plus(ga[0], gb[0]), plus(ga[1], gb[1])] }
}
