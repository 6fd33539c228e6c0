//! One cell in the frame at rest, and the search for its points in other frames.

use super::cell::{CellAtRest, Texture, TrackingSettings, spacing};
use super::error::MotionError;
use super::level::{Detail, Field, Level, SMOOTHING, mask};
use super::neighbours::{REACH, median};
use super::register::Registration;
use super::rest::Rest;
use super::spline::Spline;
use super::stripes::Stripes;
use super::subset::Warp;
use crate::filter;
use crate::outlines::PixelFrame;
use crate::plane::Plane;

/// Half of the smallest and of the largest side of a subset, pixels; beads may be many pixels apart.
const HALVES: [usize; 2] = [8, 30];
const MOST_HALF_OF_BEADS: usize = 80;
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
/// Of beads: blur and coarse pixels that merge neighbouring beads, and the distance of coarse points, in mean distances of
/// beads; half of a coarse subset's side, pixels of its level.
const BEADS_BLUR: f64 = 0.5;
const BEADS_APART: f64 = 2.0;
const BEADS_HALF: usize = 6;
/// If the coarse level differs from the frame before by at least this, it is used as a second
/// start, pixels.
const ANOTHER_START: f32 = 0.3;
/// Largest deviation of a point from its neighbours, um: well below half a sarcomere; of beads, in their mean distances.
const OFF_UM: f64 = 0.4;
const BEADS_OFF: f64 = 0.5;
/// A whole picture that is at least this far from its place in the last frame has jumped, pixels.
const JUMP: f32 = 3.0;
/// Distance of adjacent points, in spacings of the lattice.
const NEXT: f32 = 1.5;
/// Least part of the points that must be found in the median frame.
const LEAST_FOUND: f64 = 0.3;

/// A cell in the frame at rest, prepared for the comparison with others.
pub(super) struct Follower<'a> {
    pub(super) cell: &'a CellAtRest<'a>,
    pub(super) fine: Level,
    coarse: Level,
    /// Which points the coarse level uses, and for each point the coarse points that represent it,
    /// with weights.
    chosen: Vec<usize>,
    standing: Vec<Vec<(usize, f32)>>,
    points: Vec<[f32; 2]>,
    pub(super) stripes: Stripes,
    /// The whole picture at rest, if it may jump between frames.
    registration: Option<Registration>,
}

/// Result of one frame.
pub(super) struct Frame {
    pub(super) field: Field,
    pub(super) periods: Vec<Option<f32>>,
}

/// A frame, prepared for both levels. It serves all cells of a film.
pub(super) struct Seen {
    pub(super) fine: Spline,
    coarse: Spline,
    /// Shift of the whole picture from rest, pixels.
    shift: Option<[f32; 2]>,
}

/// Lengths that depend on what is followed, um unless stated.
struct Scales {
    /// Largest deviation of a point from its neighbours.
    off: f64,
    /// Blur and pixels of the coarse level.
    blur: f64,
    coarse: f64,
    /// Half of a coarse subset's side, pixels of that level.
    coarse_half: usize,
    /// Distance of coarse points.
    apart: f64,
}

impl Scales {
    fn of(texture: Texture) -> Self {
        match texture {
            Texture::Cell => Self {
                off: OFF_UM,
                blur: BLUR_UM,
                coarse: COARSE_UM,
                coarse_half: COARSE_HALF,
                apart: COARSE_APART_UM,
            },
            Texture::Beads { distance_um } => Self {
                off: BEADS_OFF * distance_um,
                blur: BEADS_BLUR * distance_um,
                coarse: BEADS_BLUR * distance_um,
                coarse_half: BEADS_HALF,
                apart: BEADS_APART * distance_um,
            },
        }
    }
}

/// Half of a subset's side, pixels.
pub(super) fn half(subset_um: f64, pixel_um: f64, texture: Texture) -> usize {
    let [least, most] = HALVES;
    let most = if texture == Texture::Cell { most } else { MOST_HALF_OF_BEADS };
    let half = ((subset_um / pixel_um - 1.0) / 2.0).round().max(0.0) as usize;
    half.clamp(least, most)
}

impl<'a> Follower<'a> {
    /// # Errors
    /// A mask of another size, and a cell without texture.
    pub(super) fn new(
        plane: &Plane,
        rest: Rest,
        cell: &'a CellAtRest<'a>,
        settings: TrackingSettings,
    ) -> Result<Self, MotionError> {
        let pixel_um = cell.pixel_size.um();
        let frame = PixelFrame::new(plane.width(), plane.height(), cell.pixel_size)
            .map_err(|_| MotionError::Mask { width: plane.width(), height: plane.height() })?;
        let points: Vec<[f32; 2]> = (0..cell.mesh.len())
            .map(|node| frame.to_pixels(cell.mesh.point(node)).map(|at| (at - 0.5) as f32))
            .collect();
        let spacing = spacing(cell.mesh) / pixel_um;
        let (texture, scales) = (settings.texture, Scales::of(settings.texture));
        let smooths = texture == Texture::Cell;
        let detail = Detail {
            factor: 1,
            blur: SMOOTHING,
            half: half(settings.subset_um, pixel_um, texture),
            reach: [REACH, NEXT].map(|part| part * spacing as f32),
            off_by: [0.25, (scales.off / pixel_um).max(1.0) as f32],
            smooths,
        };
        let allowed = mask(plane, |at| cell.inside[at]);
        let allowed =
            filter::largest_nearby(&allowed, (RIM_UM / pixel_um).round().max(1.0) as usize);
        let fine = Level::new(plane, &points, &allowed, rest.noise, detail);
        if fine.textured_share() < LEAST_FOUND {
            return Err(MotionError::Flat {
                textured_pct: 100.0 * fine.textured_share(),
                noise: rest.noise,
                contrast: rest.contrast,
            });
        }

        let factor = ((scales.coarse / pixel_um).round() as usize).max(2);
        let blur = (scales.blur / pixel_um).max(LEAST_BLUR);
        let apart = (scales.apart / pixel_um).max(spacing);
        let chosen = scattered(&points, apart as f32);
        let apart = (apart / factor as f64) as f32;
        let coarse_detail = Detail {
            factor,
            blur,
            half: scales.coarse_half,
            reach: [3.5 * apart, 2.0 * apart],
            off_by: [0.3, 1.0],
            smooths: true,
        };
        let coarse_points: Vec<[f32; 2]> = chosen.iter().map(|&point| points[point]).collect();
        let coarse = Level::new(plane, &coarse_points, &allowed, rest.noise, coarse_detail);
        let standing = standing(&points, &coarse_points, apart * factor as f32);
        let stripes = cell.fibres.map(|field| Stripes::new(field, &points, &frame));
        let stripes = stripes.unwrap_or_default();
        let registration = (texture != Texture::Cell).then(|| Registration::of(plane));
        Ok(Self { cell, fine, coarse, chosen, standing, points, stripes, registration })
    }

    /// The points at rest.
    pub(super) fn still(&self) -> Vec<Warp> {
        vec![Warp::default(); self.points.len()]
    }

    /// Prepares a frame for all cells of the film: only what depends on the pixel size is used.
    pub(super) fn see(&self, plane: &Plane) -> Seen {
        let (fine, coarse) = rayon::join(|| self.fine.look(plane), || self.coarse.look(plane));
        let shift = self.registration.as_ref().and_then(|rest| rest.shift(plane));
        Seen { fine, coarse, shift }
    }

    /// Follows all points into a frame.
    pub(super) fn frame(&self, seen: &Seen, last: &[Warp]) -> Frame {
        let jumped = seen.shift.and_then(|shift| jumped(last, shift));
        let last = jumped.as_deref().unwrap_or(last);
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
        let periods = self.stripes.read(&seen.fine, &field.warps);
        Frame { field, periods }
    }

    /// Whether enough points were found again; else why the cell counts as lost. `numbers` are those of the frames in the
    /// film.
    pub(super) fn check(done: &[&Frame], numbers: &[usize]) -> Result<(), MotionError> {
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
        Ok(())
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
}

/// The warps of the last frame, moved to where the whole picture is now; `None` if it is near there.
fn jumped(last: &[Warp], to: [f32; 2]) -> Option<Vec<Warp>> {
    let from = [0, 1].map(|a: usize| median(last.iter().map(|warp| warp.shift[a]).collect()));
    let by = [0, 1].map(|a: usize| to[a] - from[a]);
    let moved = |warp: &Warp| Warp {
        shift: [warp.shift[0] + by[0], warp.shift[1] + by[1]],
        gradient: warp.gradient,
    };
    (by[0].hypot(by[1]) > JUMP).then(|| last.iter().map(moved).collect())
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
