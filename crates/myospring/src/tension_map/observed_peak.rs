//! The cell of a film at its peak.

use crate::mesh::Mesh;
use crate::microscopy::motion::CellMotion;

/// Frames within this part of the largest contraction count as peak, and as close to no contraction
/// as rest.
pub(super) const NEAR: f64 = 0.1;

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
    /// Frames of the film whose mean this is.
    pub frames: Vec<usize>,
}

impl ObservedPeak {
    /// The peak of a film: the mean of the frames within a tenth of the greatest contraction along
    /// the smaller principal stretch, minus that of the frames as close to rest. So noise is
    /// averaged, also that of the frame at rest. A point counts if it was found in half of the
    /// frames of the peak.
    pub fn at_peak(motion: &CellMotion) -> Self {
        let contraction: Vec<f64> =
            motion.stretches().iter().map(|stretches| 1.0 - stretches.smaller).collect();
        let seen = motion.frames_with_cell();
        let most = seen.iter().map(|&frame| contraction[frame]).fold(f64::MIN, f64::max);
        let frames = |is: &dyn Fn(f64) -> bool| -> Vec<usize> {
            seen.iter().copied().filter(|&frame| is(contraction[frame])).collect()
        };
        let peak = frames(&|part| part >= (1.0 - NEAR) * most);
        let rest = frames(&|part| part.abs() <= NEAR * most);
        let count = motion.mesh.len();
        let mean = |frames: &[usize], axis: usize, point: usize| {
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
        let interpolated =
            |point: usize| peak.iter().filter(|frame| motion.interpolated[**frame][point]).count();
        Self {
            displacements_um: [0, 1].map(|axis: usize| {
                (0..count)
                    .map(|point| mean(&peak, axis, point) - mean(&rest, axis, point))
                    .collect()
            }),
            found: (0..count).map(|point| 2 * interpolated(point) <= peak.len()).collect(),
            cut: motion.cut(),
            alike_um: motion.alike_um(),
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
