//! What a sweep reads but does not write, in the order in which it reads it.
//!
//! Rows run along x. In space they are numbered through, layer by layer, so that the places above those of row `r`
//! in y, in z and in both are in the rows `r + 1`, `r + J` and `r + J + 1`, with `J` rows in a layer. Springs that
//! would go from the last row of a layer to the first of the next have no stiffness.

use crate::mechanics::runs::Run;

/// Squares or cubes that share a record; the widest vector.
pub(super) const BLOCK: usize = 8;

/// A place has a spring for each direction: `D` along the axes, then two across each plane of two axes.
/// Its record has a block for each of these coefficients.
pub(super) struct Record<const D: usize>;

impl<const D: usize> Record<D> {
    /// Springs of a place: 4 of a square, 9 of a cube.
    pub(super) const SPRINGS: usize = D * D;
    /// The springs' stiffness, ...
    pub(super) const STIFFNESS: usize = 0;
    /// ... their dashpot coefficients, ...
    pub(super) const DAMPING: usize = Self::SPRINGS;
    /// ... their fibre weights, ...
    pub(super) const FIBRE: usize = 2 * Self::SPRINGS;
    /// ... the coefficient of the area or volume law, ...
    pub(super) const MEASURE: usize = 3 * Self::SPRINGS;
    /// ... and `dt / (m (1 + g))` of the mass at the place.
    pub(super) const INVERSE_MASS: usize = Self::MEASURE + 1;
    /// Blocks in a record.
    pub(super) const LEN: usize = Self::MEASURE + 2;
}

/// Eight aligned values.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Block(pub(super) [f64; BLOCK]);

impl Block {
    pub(super) const ZERO: Self = Self([0.0; BLOCK]);
}

/// Location of the coefficients of a block of squares or cubes: none, the uniform terms, or record n - 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Class(pub(super) u32);

impl Class {
    pub(super) const EMPTY: Self = Self(0);
    pub(super) const UNIFORM: Self = Self(1);
}

/// Everything that a sweep reads but does not write.
///
/// A row of the state has the coordinates and then the components of the half-step velocity, each `stride` values
/// long; there are `lag` rows of padding on top.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub(super) axes: usize,
    /// Rows of all layers.
    pub(super) rows: usize,
    /// The squares or cubes of a row reach this many rows further up: 1, or one more than a layer has. A step trails the
    /// previous one by as much.
    pub(super) lag: usize,
    /// Blocks in a row.
    pub(super) blocks: usize,
    /// Values of a component in a row, with a block of padding on the right.
    pub(super) stride: usize,
    /// Values in one row of the state: coordinates and velocities.
    pub(super) row_len: usize,
    /// Blocks in a record, [`Record::LEN`].
    pub(super) record_len: usize,
    /// First block of each row's pass, and the one after the last.
    pub(super) spans: Vec<[usize; 2]>,
    /// By row and block.
    pub(super) classes: Vec<Class>,
    pub(super) records: Vec<Block>,
    /// The coefficients of a place inside a uniform cell, in the order of [`Record`].
    pub(super) uniform: Vec<f64>,
    /// Rest length along the axes and across, um.
    pub(super) rest_length: [f64; 2],
    /// Four times the rest area of a triangle, um^2; 64 times the rest volume of a cube, um^3.
    pub(super) rest_measure: f64,
    /// Time step, ms.
    pub(super) time_step: f64,
    /// `(1 - g)/(1 + g)`
    pub(super) keep: f64,
    /// `1/(1 + g)`
    pub(super) slowing: f64,
    /// Springs from places to their resting positions, if any: stiffness (nN/um) and the
    /// resting coordinates (um), one more stride than there are axes for each row.
    pub(super) anchors: Vec<Block>,
    /// Whether anything but springs and dashpots acts: an area or volume law, tension of fibres or springs to resting places.
    pub(super) laws: bool,
    /// Runs of nodes in a row: `first` is the first node, `nodes[0]` the offset of its x in the state.
    pub(super) places: Vec<Run<1>>,
    /// State of the lattice before any mass is put on it.
    pub(super) vacant: Vec<Block>,
}

impl Plan {
    /// The offset of each node's x in the state.
    #[cfg(test)]
    pub(super) fn nodes(&self) -> impl Iterator<Item = usize> {
        self.places.iter().flat_map(|run| run.nodes[0]..run.nodes[0] + run.len)
    }

    /// The coefficients of a block that has its own.
    pub(super) fn record(&self, class: Class) -> *const f64 {
        self.records[(class.0 as usize - 2) * self.record_len..].as_ptr().cast()
    }
}
