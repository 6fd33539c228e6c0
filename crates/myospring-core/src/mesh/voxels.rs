//! Voxels: the parts of space that belong to a thick cell.

use super::mask::{Mask, MaskError, Part};
use super::pixel_size::{PixelSize, PixelSizeError};

/// Names of the axes in messages.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Largest relative difference of the sides of a voxel along x and y.
const SQUARE: f64 = 0.01;

/// Why a list of voxels is not a valid cell.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VoxelsError {
    /// The list of voxels does not fill the stack.
    #[error(
        "a stack of {} x {} x {} voxels (columns, rows, slices) needs one value for each, but {found} were given",
        shape[0], shape[1], shape[2]
    )]
    Shape {
        /// Columns, rows and slices.
        shape: [usize; 3],
        /// Values given.
        found: usize,
    },
    /// A side of a voxel is not a plausible length.
    #[error("side of a voxel along {axis}: {cause}")]
    Pitch {
        /// `x`, `y` or `z`.
        axis: &'static str,
        /// The length and its bounds.
        cause: PixelSizeError,
    },
    /// Voxels that are not square seen from above.
    #[error(
        "the voxels are {x_um} um wide along x and {y_um} um along y, but they must be square seen from above: \
         resample the stack (Fiji: Image > Scale)"
    )]
    NotSquare {
        /// Side along x, um.
        x_um: f64,
        /// Side along y, um.
        y_um: f64,
    },
    /// No voxel belongs to the cell.
    #[error(
        "the stack is empty: none of its {} x {} x {} voxels belongs to the cell; paint the cell in a non-zero value \
         on a background of zero",
        shape[0], shape[1], shape[2]
    )]
    Empty {
        /// Columns, rows and slices.
        shape: [usize; 3],
    },
    /// Every voxel belongs to the cell.
    #[error(
        "the stack has no background: all of its {} x {} x {} voxels belong to the cell; the background must be zero \
         (is this the stack itself, not its mask?)",
        shape[0], shape[1], shape[2]
    )]
    Full {
        /// Columns, rows and slices.
        shape: [usize; 3],
    },
}

/// The voxels of a stack that belong to a cell: boxes of equal size, square seen from above.
///
/// Coordinates are um from the **lower left corner of the picture** and from the **lower face of
/// the lowest slice**: x to the right, y upward in the picture, z upward. A cell has the same
/// coordinates as in the [`Mask`] of a picture of the same size, whose rows run downward; here row 0
/// is the **bottom** of the picture. Voxels are listed with x fastest, then y, then z.
///
/// At least one voxel belongs to the cell and at least one does not. Only the bounding box of the
/// cell is stored.
#[derive(Debug, Clone, PartialEq)]
pub struct Voxels {
    shape: [usize; 3],
    pitch: [f64; 3],
    pixel_size: PixelSize,
    block: Block,
}

/// The bounding box of a cell with its voxels.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Its first column, row (from the bottom of the picture) and slice in the stack.
    pub first: [usize; 3],
    /// Number of columns, rows and slices.
    pub size: [usize; 3],
    /// For each voxel, x fastest, then y, then z: whether it belongs to the cell.
    pub inside: Vec<bool>,
}

/// The parts that [`Voxels::largest_part`] left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DroppedParts {
    /// Number of parts other than the cell.
    pub parts: usize,
    /// Their total number of voxels.
    pub voxels: usize,
}

/// Faces of the stack that a cell reaches: there it may be cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Touched {
    /// The first or last column or row of the picture.
    pub sides: bool,
    /// The lowest slice.
    pub lowest_slice: bool,
    /// The highest slice.
    pub highest_slice: bool,
}

impl Touched {
    /// Whether the cell reaches any face.
    pub fn any(self) -> bool {
        self.sides || self.lowest_slice || self.highest_slice
    }
}

impl Block {
    /// The box without empty layers at its faces; `None` if it is empty.
    fn cropped(self) -> Option<Self> {
        let [columns, rows, _] = self.size;
        let (mut low, mut high) = ([usize::MAX; 3], [0; 3]);
        for (line, values) in self.inside.chunks_exact(columns.max(1)).enumerate() {
            let Some(left) = values.iter().position(|&is| is) else { continue };
            let right = values.iter().rposition(|&is| is).unwrap_or(left);
            let from = [left, line % rows, line / rows];
            let to = [right, from[1], from[2]];
            for axis in 0..3 {
                low[axis] = low[axis].min(from[axis]);
                high[axis] = high[axis].max(to[axis] + 1);
            }
        }
        if high[0] == 0 {
            return None;
        }
        if (low, high) == ([0; 3], self.size) {
            return Some(self);
        }
        let lines = (low[2]..high[2]).flat_map(|z| (low[1]..high[1]).map(move |y| z * rows + y));
        let line = |at: usize| &self.inside[at * columns..][low[0]..high[0]];
        let inside = lines.flat_map(|at| line(at).iter().copied()).collect();
        let first = [0, 1, 2].map(|axis| self.first[axis] + low[axis]);
        let size = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        Some(Self { first, size, inside })
    }
}

impl Voxels {
    /// Makes a cell from all voxels of a stack of `shape` (columns, rows, slices), whose sides are
    /// `pitch` um; row 0 is the bottom of the picture, slice 0 the lowest.
    ///
    /// # Errors
    /// A wrong number of values, sides outside [`PixelSize::SMALLEST_UM`] to
    /// [`PixelSize::LARGEST_UM`] or not square seen from above, no voxel inside, or none outside.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::voxels::Voxels;
    /// let cell = Voxels::new([2, 1, 2], [0.5, 0.5, 2.0], vec![false, true, true, true])?;
    /// assert_eq!(cell.volume_um3(), 3.0 * 0.5 * 0.5 * 2.0);
    /// # Ok::<(), myospring::mesh::voxels::VoxelsError>(())
    /// ```
    pub fn new(shape: [usize; 3], pitch: [f64; 3], inside: Vec<bool>) -> Result<Self, VoxelsError> {
        Self::of_block(shape, pitch, Block { first: [0; 3], size: shape, inside })
    }

    /// As [`Voxels::new`], of a cell that lies entirely in `block`.
    ///
    /// # Errors
    /// As of [`Voxels::new`]; a block that is not within the stack.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::voxels::{Block, Voxels};
    /// let block = Block { first: [3, 0, 1], size: [2, 1, 1], inside: vec![true, true] };
    /// let cell = Voxels::of_block([9, 4, 3], [1.0, 1.0, 2.0], block)?;
    /// assert_eq!(cell.bounds_um(), [[3.0, 0.0, 2.0], [5.0, 1.0, 4.0]]);
    /// # Ok::<(), myospring::mesh::voxels::VoxelsError>(())
    /// ```
    pub fn of_block(shape: [usize; 3], pitch: [f64; 3], block: Block) -> Result<Self, VoxelsError> {
        let volume =
            |size: [usize; 3]| size[0].checked_mul(size[1]).and_then(|n| n.checked_mul(size[2]));
        let found = block.inside.len();
        let within =
            |axis: usize| block.first[axis].saturating_add(block.size[axis]) <= shape[axis];
        let all = volume(shape).ok_or(VoxelsError::Shape { shape, found })?;
        if volume(block.size) != Some(found) || !(0..3).all(within) {
            return Err(VoxelsError::Shape { shape, found });
        }
        for (axis, um) in AXES.into_iter().zip(pitch) {
            PixelSize::new(um).map_err(|cause| VoxelsError::Pitch { axis, cause })?;
        }
        let pixel_size =
            PixelSize::new(pitch[0]).map_err(|cause| VoxelsError::Pitch { axis: "x", cause })?;
        let [x_um, y_um, _] = pitch;
        if (x_um - y_um).abs() > SQUARE * x_um.min(y_um) {
            return Err(VoxelsError::NotSquare { x_um, y_um });
        }
        let block = block.cropped().ok_or(VoxelsError::Empty { shape })?;
        if block.inside.len() == all && block.inside.iter().all(|&inside| inside) {
            return Err(VoxelsError::Full { shape });
        }
        Ok(Self { shape, pitch: [x_um, x_um, pitch[2]], pixel_size, block })
    }

    /// Columns, rows and slices of the stack.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// Sides of a voxel, um; those along x and y are equal.
    pub fn pitch(&self) -> [f64; 3] {
        self.pitch
    }

    /// The bounding box of the cell.
    pub fn block(&self) -> &Block {
        &self.block
    }

    /// Number of voxels of the cell.
    pub fn count(&self) -> usize {
        self.block.inside.iter().filter(|&&inside| inside).count()
    }

    /// Volume of the cell, um^3.
    pub fn volume_um3(&self) -> f64 {
        self.count() as f64 * self.pitch.iter().product::<f64>()
    }

    /// Lower and upper corner of the bounding box of the cell, um.
    pub fn bounds_um(&self) -> [[f64; 3]; 2] {
        let Block { first, size, .. } = &self.block;
        let um = |axis: usize, at: usize| at as f64 * self.pitch[axis];
        [
            [0, 1, 2].map(|axis| um(axis, first[axis])),
            [0, 1, 2].map(|axis| um(axis, first[axis] + size[axis])),
        ]
    }

    /// Faces of the stack that the cell reaches.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::voxels::Voxels;
    /// let lower = (0..27).map(|at| at == 4 || at == 13).collect();
    /// let touched = Voxels::new([3, 3, 3], [1.0; 3], lower)?.touches_frame();
    /// assert!(touched.lowest_slice && !touched.highest_slice && !touched.sides);
    /// # Ok::<(), myospring::mesh::voxels::VoxelsError>(())
    /// ```
    pub fn touches_frame(&self) -> Touched {
        let Block { first, size, .. } = &self.block;
        let low = |axis: usize| first[axis] == 0;
        let high = |axis: usize| first[axis] + size[axis] == self.shape[axis];
        Touched {
            sides: low(0) || high(0) || low(1) || high(1),
            lowest_slice: low(2),
            highest_slice: high(2),
        }
    }

    /// The largest part of voxels connected by faces, and the parts left out.
    ///
    /// Of two parts of equal size, the first in the order of voxels is kept.
    #[must_use]
    pub fn largest_part(&self) -> (Self, DroppedParts) {
        let Block { size, inside, .. } = &self.block;
        let (names, sizes) = parts(*size, inside);
        let largest = sizes.iter().copied().max().unwrap_or(0);
        let kept = sizes.iter().position(|&size| size == largest).unwrap_or(0) as u32 + 1;
        let dropped = DroppedParts {
            parts: sizes.len().saturating_sub(1),
            voxels: sizes.iter().sum::<usize>() - largest,
        };
        if sizes.len() == 1 {
            return (self.clone(), dropped);
        }
        let inside = names.into_iter().map(|name| name == kept).collect();
        let block = Block { inside, ..self.block };
        // The largest part has a voxel.
        let block = block.cropped().unwrap_or_else(|| self.block.clone());
        (Self { block, ..*self }, dropped)
    }

    /// The cell seen from above: the pixels over which it has a voxel.
    ///
    /// # Errors
    /// [`MaskError::Full`] if the cell covers the whole picture.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::voxels::Voxels;
    /// // Row 0 of voxels is the bottom of the picture, row 0 of a mask its top.
    /// let inside = vec![true, false, false, false, true, false, false, false];
    /// let above = Voxels::new([2, 2, 2], [1.0; 3], inside)?.above()?;
    /// assert_eq!(above.inside(), [false, false, true, false]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn above(&self) -> Result<Mask, MaskError> {
        let Block { first, size, inside } = &self.block;
        let slice = size[0] * size[1];
        let mut seen = vec![false; slice];
        for (line, values) in inside.chunks_exact(size[0]).enumerate() {
            let row = size[1] - 1 - line % size[1];
            for (seen, &inside) in seen[row * size[0]..][..size[0]].iter_mut().zip(values) {
                *seen |= inside;
            }
        }
        let top = self.shape[1] - first[1] - size[1];
        let part = Part { left: first[0], top, width: size[0], inside: seen };
        Mask::of_part(self.shape[0], self.shape[1], self.pixel_size, part)
    }

    /// The exact fraction of each cube of a lattice that lies inside the cell, 0 to 1.
    ///
    /// The lattice has `cubes` along x, y and z, of side `spacing` um, from the corner `origin` um
    /// upward; cubes are listed with x fastest, then y, then z. Boxes overlap boxes axis by axis, so
    /// the sums are exact but for rounding. The cost is linear in voxels and cubes. All fractions
    /// are 0 unless the spacing is positive and finite.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::voxels::Voxels;
    /// let cell = Voxels::new([2, 1, 1], [1.0, 1.0, 4.0], vec![false, true])?;
    /// // Cubes of 2 um from the corner: the voxel covers a quarter of the lower two.
    /// assert_eq!(cell.coverage([0.0; 3], 2.0, [1, 1, 3]), [0.25, 0.25, 0.0]);
    /// # Ok::<(), myospring::mesh::voxels::VoxelsError>(())
    /// ```
    pub fn coverage(&self, origin: [f64; 3], spacing: f64, cubes: [usize; 3]) -> Vec<f64> {
        let mut fractions = vec![0.0; cubes.iter().product()];
        if !(spacing.is_finite() && spacing > 0.0) || fractions.is_empty() {
            return fractions;
        }
        let Block { first, size, inside } = &self.block;
        let [along, up, over] = [0, 1, 2].map(|axis| {
            let voxels = first[axis]..first[axis] + size[axis];
            overlaps(voxels, self.pitch[axis], origin[axis], spacing, cubes[axis])
        });
        let layer = cubes[0] * cubes[1];
        let mut line = vec![0.0; cubes[0]];
        let mut sheet = vec![0.0; layer];
        for (z, slice) in inside.chunks_exact(size[0] * size[1]).enumerate() {
            if over[z].is_empty() {
                continue;
            }
            sheet.fill(0.0);
            for (y, row) in slice.chunks_exact(size[0]).enumerate() {
                if up[y].is_empty() || !row.contains(&true) {
                    continue;
                }
                line.fill(0.0);
                for (covered, _) in along.iter().zip(row).filter(|(_, inside)| **inside) {
                    for &(cube, share) in covered {
                        line[cube] += share;
                    }
                }
                for &(cube, share) in &up[y] {
                    add(&mut sheet[cube * cubes[0]..][..cubes[0]], share, &line);
                }
            }
            for &(cube, share) in &over[z] {
                add(&mut fractions[cube * layer..][..layer], share, &sheet);
            }
        }
        for fraction in &mut fractions {
            *fraction = fraction.min(1.0);
        }
        fractions
    }
}

/// For each voxel along one axis: the cubes that it overlaps, each with the part of the cube's side
/// that it covers.
fn overlaps(
    voxels: std::ops::Range<usize>,
    pitch: f64,
    origin: f64,
    spacing: f64,
    cubes: usize,
) -> Vec<Vec<(usize, f64)>> {
    let place = |at: usize| (at as f64 * pitch - origin) / spacing;
    let of_voxel = |at: usize| {
        let (low, high) = (place(at).max(0.0), place(at + 1).min(cubes as f64));
        let cubes = low as usize..(high.max(0.0).ceil() as usize).min(cubes);
        let share = |cube: usize| high.min(cube as f64 + 1.0) - low.max(cube as f64);
        cubes.map(|cube| (cube, share(cube))).filter(|&(_, share)| share > 0.0).collect()
    };
    voxels.map(of_voxel).collect()
}

fn add(sums: &mut [f64], share: f64, values: &[f64]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += share * value;
    }
}

/// Numbers the parts of a box of `size` (x fastest) that are connected by faces.
///
/// Returns the number of the part of each voxel, from 1 in the order of their first voxels and 0
/// outside, and the number of voxels of each part.
///
/// # Example
/// ```
/// use myospring::mesh::voxels::parts;
/// let (names, sizes) = parts([2, 1, 2], &[true, false, true, true]);
/// assert_eq!((names, sizes), (vec![1, 0, 1, 1], vec![3]));
/// ```
pub fn parts(size: [usize; 3], inside: &[bool]) -> (Vec<u32>, Vec<usize>) {
    let steps = [1, size[0], size[0] * size[1]];
    let mut names = vec![0; inside.len()];
    let mut sizes: Vec<usize> = Vec::new();
    let mut stack = Vec::new();
    for start in 0..inside.len() {
        if !inside[start] || names[start] != 0 {
            continue;
        }
        let name = sizes.len() as u32 + 1;
        let mut count = 0;
        names[start] = name;
        stack.push(start);
        while let Some(voxel) = stack.pop() {
            count += 1;
            for axis in 0..3 {
                let at = voxel / steps[axis] % size[axis];
                let before = (at > 0).then(|| voxel - steps[axis]);
                let after = (at + 1 < size[axis]).then(|| voxel + steps[axis]);
                for other in before.into_iter().chain(after) {
                    if inside[other] && names[other] == 0 {
                        names[other] = name;
                        stack.push(other);
                    }
                }
            }
        }
        sizes.push(count);
    }
    (names, sizes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A made-up cell: voxels inside or not, without pattern.
    fn scattered(shape: [usize; 3], pitch: [f64; 3]) -> Voxels {
        let mut state = 7_u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            state >> 62 != 0
        };
        Voxels::new(shape, pitch, (0..shape.iter().product()).map(|_| next()).collect()).unwrap()
    }

    #[test]
    fn coverage_is_the_overlap_of_boxes() {
        for (pitch, spacing, origin) in [
            ([0.5, 0.5, 2.0], 0.7, [-0.3, 0.2, -0.9]),
            ([1.0, 1.0, 1.0], 1.0, [0.0; 3]),
            ([0.3, 0.3, 2.4], 5.0, [-1.0, -2.0, -3.0]),
            ([2.0, 2.0, 0.25], 0.6, [1.1, -0.7, 0.4]),
        ] {
            let shape = [5, 4, 3];
            let cell = scattered(shape, pitch);
            let cubes = [6, 5, 7];
            let found = cell.coverage(origin, spacing, cubes);
            let block = cell.block();
            for (at, &fraction) in found.iter().enumerate() {
                let cube = [at % cubes[0], at / cubes[0] % cubes[1], at / (cubes[0] * cubes[1])];
                let mut volume = 0.0;
                for (voxel, _) in block.inside.iter().enumerate().filter(|(_, inside)| **inside) {
                    let [a, b, _] = block.size;
                    let place = [voxel % a, voxel / a % b, voxel / (a * b)];
                    let overlap = |axis: usize| {
                        let low = (block.first[axis] + place[axis]) as f64 * pitch[axis];
                        let corner = origin[axis] + spacing * cube[axis] as f64;
                        ((low + pitch[axis]).min(corner + spacing) - low.max(corner)).max(0.0)
                    };
                    volume += overlap(0) * overlap(1) * overlap(2);
                }
                let expected = volume / spacing.powi(3);
                assert!((fraction - expected).abs() < 1e-12, "{fraction} {expected}");
            }
        }
    }

    #[test]
    fn cubes_that_hold_the_cell_hold_its_volume() {
        for anisotropy in [1.0, 2.0, 8.0] {
            let cell = scattered([9, 7, 4], [0.4, 0.4, 0.4 * anisotropy]);
            for spacing in [0.1, 0.37, 1.0, 3.0] {
                let cubes = cell.bounds_um()[1].map(|um| (um / spacing).ceil() as usize + 2);
                let sum: f64 = cell.coverage([-spacing; 3], spacing, cubes).iter().sum();
                let error = sum * spacing.powi(3) / cell.volume_um3() - 1.0;
                assert!(error.abs() < 1e-12, "{error}");
            }
        }
    }

    #[test]
    fn voxels_that_touch_by_an_edge_are_parts_of_their_own() {
        // Two voxels that share a face, one that shares an edge with them.
        let inside = (0..27).map(|at| [0, 1, 5].contains(&at)).collect();
        let cell = Voxels::new([3, 3, 3], [1.0; 3], inside).unwrap();
        let (part, dropped) = cell.largest_part();
        assert_eq!(dropped, DroppedParts { parts: 1, voxels: 1 });
        assert_eq!((part.count(), part.bounds_um()), (2, [[0.0; 3], [2.0, 1.0, 1.0]]));
    }

    #[test]
    fn the_mask_from_above_lies_where_the_voxels_do() {
        let block = Block { first: [2, 1, 0], size: [3, 1, 2], inside: vec![true; 6] };
        let cell = Voxels::of_block([8, 6, 4], [0.5, 0.5, 1.5], block).unwrap();
        let mask = cell.above().unwrap();
        assert_eq!((mask.part().left, mask.part().top, mask.part().width), (2, 4, 3));
        assert_eq!(mask.area_um2(), 0.75);
        let touched = cell.touches_frame();
        assert!(touched.lowest_slice && !touched.highest_slice && !touched.sides && touched.any());
    }

    #[test]
    fn unusable_voxels_say_what_to_mend() {
        let message =
            |pitch, inside| Voxels::new([2, 1, 1], pitch, inside).unwrap_err().to_string();
        let unit = [1.0; 3];
        assert!(message(unit, vec![false; 2]).contains("none of its 2 x 1 x 1 voxels"));
        assert!(message(unit, vec![true; 2]).contains("has no background"));
        assert!(message(unit, vec![true]).ends_with("but 1 were given"));
        let step = message([1.0, 1.0, 0.0], vec![true, false]);
        assert!(step.starts_with("side of a voxel along z: pixel size 0 um is outside"), "{step}");
        assert!(message([1.0, 1.5, 1.0], vec![true, false]).contains("must be square"));
    }
}
