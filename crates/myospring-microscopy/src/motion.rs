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
//!    the mean of the cells.
//!
//! Several cells of a film are followed together: frames are decoded once, and the cells share the
//! frame at rest and the motion of the stage.
//!
//! Displacements are um, y upward, as in meshes.
//!
//! The beads of a gel are followed alike ([`follow_beads`]), on a lattice over the whole frame, without smoothing.

mod beads;
mod cell;
mod covered;
mod doubts;
mod error;
mod follower;
mod headline;
mod level;
mod measure;
mod neighbours;
mod register;
mod rest;
mod sarcomeres;
pub(crate) mod spline;
mod stage;
mod stripes;
pub(crate) mod subset;
mod walk;

pub use beads::{BeadError, BeadSettings, GelMotion, follow_beads};
pub use cell::{CellAtRest, CellMotion, Progress, Texture, TrackingSettings};
pub use error::MotionError;
pub use headline::{Headline, Measure, Reason};
pub use measure::Stretches;
pub use rest::Rest;
pub use sarcomeres::Estimate;
pub use stage::Stage;
pub use stripes::FEWEST_PARTS;

use crate::film::Film;
use error::RATES;
use rayon::ThreadPoolBuilder;
use walk::Walk;

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
    let one = follow_all(film, rest, std::slice::from_ref(cell), settings, goes_on)?;
    one.into_iter().collect::<Result<Vec<_>, _>>().map(|mut one| one.swap_remove(0))
}

/// Follows several cells of one film, as [`follow`] does: each frame is decoded once, and all share the frame at rest and
/// the motion of the stage. `any_cell` and the pixel size are those of the first cell. Returns for each cell its motion,
/// or why it cannot be followed.
///
/// # Errors
/// A frame that cannot be read, a frame rate out of range, or a mask of another size.
pub fn follow_all(
    film: &Film,
    rest: Rest,
    cells: &[CellAtRest<'_>],
    settings: TrackingSettings,
    goes_on: impl FnMut(Progress) -> bool + Send,
) -> Result<Vec<Result<CellMotion, MotionError>>, MotionError> {
    let rate = settings.frames_per_second;
    if !(rate.is_finite() && (RATES[0]..=RATES[1]).contains(&rate)) {
        return Err(MotionError::Rate { rate });
    }
    let [width, height] = film.size();
    let is_whole = |mask: &[bool]| mask.len() == width * height;
    if !cells.iter().all(|cell| is_whole(cell.inside) && is_whole(cell.any_cell)) {
        return Err(MotionError::Mask { width, height });
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads =
        settings.threads.filter(|count| *count > 0).map_or(cores, |count| count.min(cores));
    let walk = || Walk::new(film, rest, cells, settings)?.motions(goes_on);
    // A page has one thread.
    if cfg!(target_family = "wasm") {
        return walk();
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|cause| MotionError::Threads { cause: cause.to_string() })?.install(walk)
}
