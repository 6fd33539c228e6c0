//! The cell of a film compared with a simulated one, frame by frame.

use super::observed_peak::{displacement, rest_frames};
use crate::analysis::shape::laid_upon;
use crate::microscopy::motion::CellMotion;
use crate::recording::Frame;

/// A simulated cell laid over that of the film in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameShape {
    /// Number of the frame in the film.
    pub frame: usize,
    /// Its place in the lists of the film's motion.
    pub at: usize,
    /// Its time from the first frame of the film, ms.
    pub t_ms: f64,
    /// Distance of the points, root mean square over the cell's area, um, after the best shift and rotation of the whole
    /// cell.
    pub distance_um: f64,
    /// The same between the measured points and the cell at rest: how far it has moved.
    pub movement_um: f64,
    /// Positions of the simulated points, um, shifted and rotated as a whole to those of the film in this frame.
    pub positions_um: [Vec<f64>; 2],
}

impl FrameShape {
    /// Of each frame with found points from `from_ms` on that the simulated frames reach; these are interpolated linearly, and
    /// their time 0 is at `start_ms` of the film. Before it the simulated cell is as in its first frame. The film's frames count from the mean of its frames at rest, or from the frame that its
    /// cell was found in where it has none.
    pub fn all(motion: &CellMotion, simulated: &[Frame], start_ms: f64, from_ms: f64) -> Vec<Self> {
        let mesh = &motion.mesh;
        let at_rest = displacement(motion, &rest_frames(motion));
        let shown = motion.frames_with_cell().into_iter();
        let one = |at: usize| {
            let t_ms = Some(motion.times_ms[at]).filter(|t_ms| *t_ms >= from_ms)?;
            let now = between(simulated, t_ms - start_ms)?;
            let moved = &motion.displacements_um[at];
            let measured = [0, 1].map(|axis: usize| {
                let ways = moved[axis].iter().zip(&at_rest[axis]).map(|(now, rest)| now - rest);
                mesh.points[axis].iter().zip(ways).map(|(rest, way)| rest + way).collect()
            });
            let found = motion.interpolated[at].iter().zip(&mesh.areas);
            let weights: Vec<f64> =
                found.map(|(lost, area)| if *lost { 0.0 } else { *area }).collect();
            let [placed, rest] =
                [&now, &mesh.points].map(|shape| laid_upon(shape, &measured, &weights));
            let apart = |shape: &[Vec<f64>; 2]| distance(shape, &measured, &weights);
            let (distance_um, movement_um) = (apart(&placed), apart(&rest));
            let positions_um = laid_upon(&now, &motion.positions(at), &weights);
            let frame =
                Self { frame: motion.frames[at], at, t_ms, distance_um, movement_um, positions_um };
            // A frame without a found point has no distance.
            frame.distance_um.is_finite().then_some(frame)
        };
        shown.filter_map(one).collect()
    }
}

/// Root mean square distance of points from others.
fn distance(points: &[Vec<f64>; 2], others: &[Vec<f64>; 2], weights: &[f64]) -> f64 {
    let square = |at: usize| (0..2).map(|a| (points[a][at] - others[a][at]).powi(2)).sum::<f64>();
    let sum: f64 = weights.iter().enumerate().map(|(at, weight)| weight * square(at)).sum();
    (sum / weights.iter().sum::<f64>()).sqrt()
}

/// Positions at a time, um: before the frames those of the first, `None` after the last.
fn between(frames: &[Frame], t_ms: f64) -> Option<[Vec<f64>; 2]> {
    let next = frames.partition_point(|frame| frame.t_ms < t_ms);
    let after = frames.get(next)?;
    let Some(before) = next.checked_sub(1).map(|at| &frames[at]) else {
        return Some(after.positions.clone());
    };
    let part = (t_ms - before.t_ms) / (after.t_ms - before.t_ms);
    let mix = |(from, to): (&f64, &f64)| from + part * (to - from);
    Some([0, 1].map(|axis: usize| {
        before.positions[axis].iter().zip(&after.positions[axis]).map(mix).collect()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(t_ms: f64, x: f64) -> Frame {
        Frame::new(t_ms, 0.0, [vec![x], vec![0.0]])
    }

    #[test]
    fn positions_between_frames_are_on_the_line_and_after_them_there_are_none() {
        let frames = [frame(0.0, 1.0), frame(10.0, 3.0)];
        assert_eq!(between(&frames, 2.5).unwrap()[0], [1.5]);
        assert_eq!(between(&frames, 0.0).unwrap()[0], [1.0]);
        assert_eq!(between(&frames, -0.1).unwrap()[0], [1.0]);
        assert!(between(&frames, 10.1).is_none());
    }

    #[test]
    fn a_shift_of_the_whole_cell_is_no_distance() {
        let points = [vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]];
        let shifted = points.clone().map(|axis| axis.iter().map(|x| x + 2.0).collect());
        let apart =
            |others: &_| distance(&laid_upon(&points, others, &[1.0; 3]), others, &[1.0; 3]);
        assert!(apart(&shifted) < 1e-12);
        let wider = points.clone().map(|axis| axis.iter().map(|x| 1.3 * x).collect());
        assert!(apart(&wider) > 0.1);
    }
}
