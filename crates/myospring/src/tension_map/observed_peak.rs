//! The cell of a film at its peak.

use super::blur::Blur;
use crate::mesh::Mesh;
use crate::microscopy::motion::CellMotion;

/// Frames within this part of the largest contraction count as peak.
pub(super) const NEAR: f64 = 0.1;
/// Largest deviation of a frame at rest from their median, in median absolute deviations: two standard deviations.
const AROUND: f64 = 3.0;

/// The cell at the peak of its contraction.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedPeak {
    /// Displacement of each point of the mesh from rest, um: `[axis][point]`.
    pub displacements_um: [Vec<f64>; 2],
    /// Which points were found, not interpolated from their neighbours.
    pub found: Vec<bool>,
    /// Which points lie where the frame cuts the cell, so that the part beyond it pulls at them.
    pub cut: Vec<bool>,
    /// Side of a square whose points have one error between them, um.
    pub alike_um: f64,
    /// What the motion of a point is a mean of.
    pub blur: Blur,
    /// Frames of the film whose mean this is.
    pub frames: Vec<usize>,
}

impl ObservedPeak {
    /// The peak of a film: the mean of the frames within a tenth of the greatest contraction along
    /// the smaller principal stretch, minus that of the frames as close to rest. So noise is
    /// averaged, also that of the frame at rest. A point counts if it was found in half of the
    /// frames of the peak.
    pub fn at_peak(motion: &CellMotion) -> Self {
        let peak = near(motion, |part, most| part >= (1.0 - NEAR) * most);
        let rest = displacement(motion, &rest_frames(motion));
        let at_peak = displacement(motion, &peak);
        let count = motion.mesh.len();
        let interpolated =
            |point: usize| peak.iter().filter(|frame| motion.interpolated[**frame][point]).count();
        Self {
            displacements_um: [0, 1].map(|axis: usize| {
                at_peak[axis].iter().zip(&rest[axis]).map(|(peak, rest)| peak - rest).collect()
            }),
            found: (0..count).map(|point| 2 * interpolated(point) <= peak.len()).collect(),
            cut: motion.cut(),
            alike_um: motion.alike_um(),
            blur: Blur { subset_um: motion.subset_um, smoothing_um: motion.smoothing_um() },
            frames: peak.iter().map(|frame| motion.frames[*frame]).collect(),
        }
    }
    /// Area of each point that was found, um^2, 0 of the others: its weight in means over the cell.
    ///
    /// # Panics
    /// If they are points of another mesh.
    pub fn weights(&self, mesh: &Mesh) -> Vec<f64> {
        let of = |(area, found): (&f64, &bool)| if *found { *area } else { 0.0 };
        mesh.areas.iter().zip(&self.found).map(of).collect()
    }
}

/// Frames without contraction as far as noise shows, by their places in the lists of a motion: of those within a tenth of
/// the largest contraction the ones around their median, so that the start and the end of a beat are no rest.
pub(super) fn rest_frames(motion: &CellMotion) -> Vec<usize> {
    let contraction: Vec<f64> =
        motion.stretches().iter().map(|stretches| 1.0 - stretches.smaller).collect();
    let mut rest = near(motion, |part, most| part.abs() <= NEAR * most);
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let middle = median(rest.iter().map(|&frame| contraction[frame]).collect());
    let away = |frame: usize| (contraction[frame] - middle).abs();
    let spread = AROUND * median(rest.iter().map(|&frame| away(frame)).collect());
    rest.retain(|&frame| away(frame) <= spread);
    rest
}

/// Frames whose contraction, and the largest of all, are so.
fn near(motion: &CellMotion, is: impl Fn(f64, f64) -> bool) -> Vec<usize> {
    let contraction: Vec<f64> =
        motion.stretches().iter().map(|stretches| 1.0 - stretches.smaller).collect();
    let mut seen = motion.frames_with_cell();
    let most = seen.iter().map(|&frame| contraction[frame]).fold(f64::MIN, f64::max);
    seen.retain(|&frame| is(contraction[frame], most));
    seen
}

/// Mean displacement of each point over some frames, um: over those in which it was found, if there are any.
pub(super) fn displacement(motion: &CellMotion, frames: &[usize]) -> [Vec<f64>; 2] {
    let mean = |axis: usize, point: usize| {
        let found: Vec<f64> = frames
            .iter()
            .filter(|frame| !motion.interpolated[**frame][point])
            .map(|frame| motion.displacements_um[*frame][axis][point])
            .collect();
        let all = || frames.iter().map(|frame| motion.displacements_um[*frame][axis][point]);
        match (found.len(), frames.len()) {
            (_, 0) => 0.0,
            (0, of) => all().sum::<f64>() / of as f64,
            (of, _) => found.iter().sum::<f64>() / of as f64,
        }
    };
    [0, 1].map(|axis: usize| (0..motion.mesh.len()).map(|point| mean(axis, point)).collect())
}
