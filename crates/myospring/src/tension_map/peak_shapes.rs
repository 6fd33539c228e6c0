//! The cell of a film compared with a simulated one, both at the peak of their contraction.

use super::observed_peak::{NEAR, ObservedPeak};
use crate::analysis::shape::laid_upon;
use crate::mesh::Mesh;
use crate::recording::Frame;

/// Both shapes, and the distances between their points.
#[derive(Debug, Clone)]
pub struct PeakShapes {
    /// Measured positions, um.
    pub measured: Frame,
    /// Positions of the simulated cell, um, shifted and rotated as a whole to fit the measured ones
    /// best.
    pub simulated: Frame,
    /// Distance of each pair of points, um.
    pub distances_um: Vec<f64>,
    /// Area of each point that was found, um^2, 0 of the others.
    weights: Vec<f64>,
}

impl PeakShapes {
    /// The peak of a film, and the mean of the simulated frames as close to their own peak; `None`
    /// if there are no frames.
    ///
    /// # Panics
    ///
    /// If the frames or the peak are of another mesh.
    pub fn of(mesh: &Mesh, seen: &ObservedPeak, frames: &[Frame]) -> Option<Self> {
        let moved = |frame: &Frame| {
            let square = |node: usize, axis: usize| {
                (frame.positions[axis][node] - mesh.points[axis][node]).powi(2)
            };
            (0..mesh.len()).map(|node| square(node, 0) + square(node, 1)).sum::<f64>().sqrt()
        };
        let most = frames.iter().map(moved).fold(0.0, f64::max);
        let near: Vec<&Frame> =
            frames.iter().filter(|frame| moved(frame) >= (1.0 - NEAR) * most).collect();
        let peak = near.iter().max_by(|a, b| moved(a).total_cmp(&moved(b)))?;
        let at = |positions| Frame { positions, ..(*peak).clone() };
        let nodes = 0..mesh.len();
        let mean = [0, 1].map(|axis: usize| {
            let of =
                |node: usize| near.iter().map(|frame| frame.positions[axis][node]).sum::<f64>();
            nodes.clone().map(|node| of(node) / near.len() as f64).collect()
        });
        let measured = [0, 1].map(|axis: usize| {
            let points = mesh.points[axis].iter().zip(&seen.displacements_um[axis]);
            points.map(|(rest, way)| rest + way).collect::<Vec<f64>>()
        });
        let weights = seen.weights(mesh);
        let simulated = laid_upon(&mean, &measured, &weights);
        let apart = |axis: usize, node: usize| measured[axis][node] - simulated[axis][node];
        let distances_um = nodes.map(|node| apart(0, node).hypot(apart(1, node))).collect();
        Some(Self { measured: at(measured), simulated: at(simulated), distances_um, weights })
    }

    /// Mean over the points that were found, each by its area.
    pub fn mean(&self, of: impl Fn(usize) -> f64) -> f64 {
        let sum: f64 =
            self.weights.iter().enumerate().map(|(node, weight)| weight * of(node)).sum();
        sum / self.weights.iter().sum::<f64>()
    }

    /// Root mean square of the distances, um.
    pub fn root_mean_square_um(&self) -> f64 {
        self.mean(|node| self.distances_um[node].powi(2)).sqrt()
    }

    /// Largest distance of a point that was found, um.
    pub fn largest_um(&self) -> f64 {
        let found =
            self.distances_um.iter().zip(&self.weights).filter(|(_, weight)| **weight > 0.0);
        found.map(|(distance, _)| *distance).fold(0.0, f64::max)
    }
}
