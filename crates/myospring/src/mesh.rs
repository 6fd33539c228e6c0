//! The mesh: point masses, springs and simplices.
//!
//! A [`Mesh`] is geometry only: where the points rest, which pairs are springs, which sets of
//! `D + 1` points span area (or volume). Material and forces live in [`crate::mechanics`].

/// Direction class of a lattice spring; it decides its stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpringKind {
    /// Along a lattice axis (horizontal or vertical).
    Axial,
    /// Across a lattice square.
    Diagonal,
}

/// A spring between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// The two points.
    pub nodes: [u32; 2],
    /// Direction class.
    pub kind: SpringKind,
    /// Part of a full spring's stiffness that it carries: 1 inside, 1/2 on the rim, where only one
    /// lattice square stands behind it.
    pub share: f64,
}

/// A triangle (or tetrahedron) with its weight in sums over area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simplex<const N: usize> {
    /// Corners, counter-clockwise.
    pub nodes: [u32; N],
    /// Weight: 1/2 where the triangles of both diagonals of a square overlap.
    pub weight: f64,
}

/// How the points lie on a lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    /// Distance of neighbours along the axes, um.
    pub spacing: f64,
    /// Number of columns (points along x) and rows (points along y) of the bounding box.
    pub shape: [usize; 2],
    /// Position of the point in column 0, row 0, um.
    pub origin: [f64; 2],
    /// Column and row of each point.
    pub cells: Vec<[u32; 2]>,
}

/// Points, springs and triangles of a flat cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Rest positions, um: `points[axis][node]`.
    pub points: [Vec<f64>; 2],
    /// Area that each point stands for, um^2.
    pub areas: Vec<f64>,
    /// Springs.
    pub springs: Vec<Spring>,
    /// Triangles.
    pub simplices: Vec<Simplex<3>>,
    /// The lattice, when the mesh is one.
    pub lattice: Option<Lattice>,
}
