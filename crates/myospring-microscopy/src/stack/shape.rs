//! Sets of voxels in physical units: closing gaps, filling holes, connected parts.

use super::distance;
use crate::region::Region;
use myospring_core::mesh::voxels::parts;

/// A set of voxels in a box, in the order of a [`Volume`](super::volume::Volume).
#[derive(Debug, Clone)]
pub(super) struct Shape {
    pub(super) size: [usize; 3],
    pub(super) pitch: [f64; 3],
    pub(super) inside: Vec<bool>,
}

impl Shape {
    pub(super) fn count(&self) -> usize {
        self.inside.iter().filter(|&&inside| inside).count()
    }

    /// Volume of one voxel, um^3.
    pub(super) fn voxel_um3(&self) -> f64 {
        self.pitch.iter().product()
    }

    /// Distance of each voxel of the set from the nearest voxel outside, um, with sides `pitch`.
    pub(super) fn depths(&self, pitch: [f64; 3]) -> Vec<f32> {
        let outside: Vec<bool> = self.inside.iter().map(|inside| !inside).collect();
        let squares = distance::squared(&outside, self.size, pitch);
        squares.into_iter().map(f32::sqrt).collect()
    }

    /// The voxels deeper than `um`.
    pub(super) fn shrunk(&self, um: f64) -> Self {
        let inside = self.depths(self.pitch).into_iter().map(|depth| f64::from(depth) > um);
        Self { inside: inside.collect(), ..*self }
    }

    /// The voxels within `um` of the set.
    pub(super) fn grown(&self, um: f64) -> Self {
        let squares = distance::squared(&self.inside, self.size, self.pitch);
        let near = |square: f32| f64::from(square) <= um * um;
        Self { inside: squares.into_iter().map(near).collect(), ..*self }
    }

    /// Morphological opening with a ball: removes necks and tips thinner than `2 um`.
    pub(super) fn opened(&self, um: f64) -> Self {
        self.shrunk(um).grown(um)
    }

    /// Morphological closing with a ball: fills gaps and bays narrower than `2 um`.
    pub(super) fn closed(&self, um: f64) -> Self {
        // A margin, so that the set does not grow against the faces of the box.
        let margin = self.pitch.map(|pitch| (um / pitch).ceil() as usize + 1);
        let size = [0, 1, 2].map(|axis| self.size[axis] + 2 * margin[axis]);
        let mut wide = Self { size, pitch: self.pitch, inside: vec![false; size.iter().product()] };
        let start = |line: usize, wide: &Self| {
            let (y, z) = (line % self.size[1] + margin[1], line / self.size[1] + margin[2]);
            (z * wide.size[1] + y) * wide.size[0] + margin[0]
        };
        for (line, values) in self.inside.chunks_exact(self.size[0]).enumerate() {
            let at = start(line, &wide);
            wide.inside[at..][..self.size[0]].copy_from_slice(values);
        }
        let wide = wide.grown(um).shrunk(um);
        let lines = 0..self.size[1] * self.size[2];
        let inside = lines.flat_map(|line| &wide.inside[start(line, &wide)..][..self.size[0]]);
        Self { inside: inside.copied().collect(), ..*self }
    }

    /// The set with the holes in each slice filled, then those in space: outside parts that do not
    /// reach a face of the box.
    pub(super) fn filled(mut self) -> Self {
        let [width, height, _] = self.size;
        for slice in self.inside.chunks_exact_mut(width * height) {
            if slice.contains(&true) {
                let filled = Region::new(width, height, slice.iter().copied()).filled(usize::MAX);
                for (inside, filled) in slice.iter_mut().zip(filled.inside()) {
                    *inside = filled;
                }
            }
        }
        let outside: Vec<bool> = self.inside.iter().map(|inside| !inside).collect();
        let (names, sizes) = parts(self.size, &outside);
        let mut open = vec![false; sizes.len() + 1];
        for (at, &name) in names.iter().enumerate() {
            open[name as usize] |= self.on_face(at);
        }
        for (inside, name) in self.inside.iter_mut().zip(names) {
            *inside |= name > 0 && !open[name as usize];
        }
        self
    }

    fn on_face(&self, at: usize) -> bool {
        let [width, height, depth] = self.size;
        let place = [at % width, at / width % height, at / (width * height)];
        (0..3).any(|axis| place[axis] == 0 || place[axis] + 1 == [width, height, depth][axis])
    }

    /// The connected parts of at least `um3`.
    pub(super) fn without_specks(mut self, um3: f64) -> Self {
        let (names, sizes) = parts(self.size, &self.inside);
        let least = um3 / self.voxel_um3();
        for (inside, name) in self.inside.iter_mut().zip(names) {
            *inside &= name > 0 && sizes[name as usize - 1] as f64 >= least;
        }
        self
    }

    /// The largest connected part, the number of others, and their number of voxels.
    pub(super) fn largest(mut self) -> (Self, usize, usize) {
        let (names, sizes) = parts(self.size, &self.inside);
        let most = sizes.iter().copied().max().unwrap_or(0);
        let kept = sizes.iter().position(|&size| size == most).map_or(0, |at| at as u32 + 1);
        for (inside, name) in self.inside.iter_mut().zip(names) {
            *inside &= name == kept;
        }
        (self, sizes.len().saturating_sub(1), sizes.iter().sum::<usize>() - most)
    }

    /// Number of voxels in each slice.
    pub(super) fn by_slice(&self) -> Vec<usize> {
        let layer = self.size[0] * self.size[1];
        let count = |slice: &[bool]| slice.iter().filter(|&&inside| inside).count();
        self.inside.chunks_exact(layer).map(count).collect()
    }
}
