//! Thickness, volume, and the lengths of the upper and the lower face of a thick cell.

use crate::analysis::shape::ShapeMeter;
use crate::mechanics::Vectors;
use crate::mesh::Mesh;
use crate::mesh::shadow::Shadow;
use crate::mesh::simplex::measure_at;
use crate::mesh::thick::Thick;
use crate::recording::{LENGTH_BOTTOM, LENGTH_TOP, THICKNESS, VOLUME};
use std::sync::Arc;

/// Measures what a thick cell has and a flat one has not.
#[derive(Debug)]
pub(super) struct ThicknessMeter {
    thick: Arc<Thick>,
    shadow: Shadow,
    /// The lowest and the highest point of each column, and the meter of each face.
    faces: [(Vec<u32>, ShapeMeter); 2],
}

impl ThicknessMeter {
    /// Names, units and meanings of what it tells.
    pub(super) const TOLD: [[&'static str; 3]; 4] = [
        [THICKNESS, "um", "mean thickness: volume over the area seen from above"],
        [VOLUME, "um^3", "volume of the cell"],
        [LENGTH_TOP, "um", "length of the upper face along the long axis"],
        [LENGTH_BOTTOM, "um", "length of the lower face along the long axis"],
    ];

    /// A meter for a cell seen from above, with its long axis.
    pub(super) fn new(thick: &Arc<Thick>, above: &Mesh, axis: [f64; 2]) -> Self {
        let ends = |column: &Vec<u32>| column.first().copied().zip(column.last().copied());
        let (lowest, highest) = thick.columns.iter().filter_map(ends).unzip();
        let face = |nodes: Vec<u32>| {
            let points = chosen(&thick.mesh.points, &nodes);
            (nodes, ShapeMeter::new(points, axis, &above.areas))
        };
        let shadow = Shadow::of(&thick.mesh);
        Self { thick: Arc::clone(thick), shadow, faces: [face(lowest), face(highest)] }
    }

    /// The area seen from above, um^2.
    pub(super) fn area<const D: usize>(&self, positions: &Vectors<D>) -> f64 {
        self.shadow.area(&[&positions[0], &positions[1]])
    }

    /// The values in the order of [`ThicknessMeter::TOLD`], given the area seen from above, um^2. A flat body has none.
    pub(super) fn read<const D: usize>(&self, positions: &Vectors<D>, area: f64) -> Vec<f64> {
        let [x, y, _] = &positions[..] else { return Vec::new() };
        let Self { thick, faces: [(lowest, below), (highest, above)], .. } = self;
        let length = |nodes: &[u32], meter: &ShapeMeter| {
            let plane = [x, y].map(|of| nodes.iter().map(|&node| of[node as usize]).collect());
            meter.measure(&plane).length
        };
        let volume = volume(&thick.mesh, positions);
        vec![volume / area, volume, length(highest, above), length(lowest, below)]
    }
}

fn chosen(points: &[Vec<f64>; 3], nodes: &[u32]) -> [Vec<f64>; 2] {
    [0, 1].map(|axis: usize| nodes.iter().map(|&node| points[axis][node as usize]).collect())
}

/// Volume of a mesh in given positions, um^3.
fn volume<const D: usize>(mesh: &Mesh<3, 4>, positions: &Vectors<D>) -> f64 {
    let Ok(positions) = <&Vectors<3>>::try_from(&positions[..]) else { return f64::NAN };
    let one =
        |simplex: &crate::mesh::Simplex<4>| simplex.weight * measure_at(positions, simplex.nodes);
    mesh.simplices.iter().map(one).sum()
}
