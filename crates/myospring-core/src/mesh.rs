//! The mesh: point masses, springs and simplices.
//!
//! A [`Mesh`] is geometry only: resting positions of points, pairs joined by springs, and sets of
//! `D + 1` points that span area (or volume). Material and forces live in [`crate::mechanics`]. A
//! cell is flat (`D` = 2, triangles) unless stated; [`cubes`] are the lattice of a thick one.
//!
//! In reading order: an [`outline::Outline`] (polygon) or a [`mask::Mask`] (pixels) says where the
//! cell is; [`lattice`] fills it with squares and turns them into masses, springs and triangles;
//! [`quality`] measures and reports; [`built_in`] has ready-made cells; [`simplex`] has the
//! geometry of one triangle or tetrahedron; [`carried`] points move with the mesh, such as the
//! outline in figures. Of thick cells, [`voxels`] or a [`profile`] say where the cell is, [`thick`]
//! fills it with [`cubes`], and [`surface`] has its faces.
//!
//! Lengths are micrometres, x to the right and **y upward**. Pictures have row 0 on top; their rows
//! are flipped when they are read, so that a cell has the same orientation as in the picture.

pub mod built_in;
pub mod carried;
mod coverage;
pub mod cubes;
pub mod ends;
pub mod lattice;
pub mod mask;
pub mod outline;
pub mod pixel_size;
mod place;
pub mod profile;
pub mod quality;
mod selection;
pub mod shadow;
pub mod simplex;
pub mod surface;
pub mod thick;
pub mod voxels;

pub use place::Place;

/// Direction class of a lattice spring; it determines its stiffness.
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
    /// Part of a full spring's stiffness that it carries: 1 inside, 1/2 on the rim, where it
    /// borders on only one lattice square.
    pub share: f64,
}

/// A triangle (or tetrahedron) with its weight in sums over area (or volume).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simplex<const N: usize> {
    /// Corners: of a triangle counter-clockwise; of a tetrahedron by the right-hand rule: fingers
    /// along the first three corners, thumb towards the last.
    pub nodes: [u32; N],
    /// Weight: 1/2 if the triangles of both diagonals of a square overlap.
    pub weight: f64,
}

/// The lattice on which the points lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice<const D: usize = 2> {
    /// Distance between neighbours along the axes, um.
    pub spacing: f64,
    /// Number of columns (points along x), rows (points along y) and layers of the bounding box.
    pub shape: [usize; D],
    /// Position of the point in column 0, row 0, um.
    pub origin: [f64; D],
    /// Column, row and layer of each point.
    pub cells: Vec<[u32; D]>,
}

/// Points, springs and simplices of a cell with `D` axes: triangles of a flat one, tetrahedra (`N` = 4
/// corners) of a thick one.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh<const D: usize = 2, const N: usize = 3> {
    /// Rest positions, um: `points[axis][node]`.
    pub points: [Vec<f64>; D],
    /// Area represented by each point, um^2; with three axes its volume, um^3.
    pub areas: Vec<f64>,
    /// Springs.
    pub springs: Vec<Spring>,
    /// Triangles or tetrahedra.
    pub simplices: Vec<Simplex<N>>,
    /// The lattice, if the mesh is one.
    pub lattice: Option<Lattice<D>>,
}

/// Why points, springs and triangles are not a valid mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// No points.
    #[error("the mesh has no points")]
    NoPoints,
    /// More points than a 32-bit index can count.
    #[error("the mesh has {points} points; at most {bound} can be numbered")]
    TooManyPoints {
        /// Number of points.
        points: usize,
        /// Largest number of points.
        bound: usize,
    },
    /// Arrays that run over the points have different lengths.
    #[error("{what} has {found} entries, but the mesh has {expected} points")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Number of points.
        expected: usize,
    },
    /// A coordinate, area, share or weight that is not finite, or not positive although it must be.
    #[error("{what} of {of} {index} is {value}; it must be {must}")]
    Value {
        /// Which quantity.
        what: &'static str,
        /// The kind of item: node, spring, triangle, lattice.
        of: &'static str,
        /// Its index.
        index: usize,
        /// The value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// A spring or triangle refers to a point that does not exist.
    #[error(
        "{of} {index} refers to node {node}, but the mesh has {points} points (0 is the first)"
    )]
    Index {
        /// Spring or triangle.
        of: &'static str,
        /// Its index.
        index: usize,
        /// The node to which it refers.
        node: u32,
        /// Number of points.
        points: usize,
    },
    /// A spring without length: its ends are the same node or have the same position.
    #[error("spring {spring} between nodes {a} and {b} has no length")]
    ZeroLength {
        /// Index of the spring.
        spring: usize,
        /// First end.
        a: u32,
        /// Second end.
        b: u32,
    },
    /// Two springs join one pair of nodes.
    #[error("nodes {a} and {b} are joined by two springs")]
    DuplicateSpring {
        /// First end.
        a: u32,
        /// Second end.
        b: u32,
    },
    /// A triangle without area, or with clockwise corners; a tetrahedron likewise.
    #[error("{of} {index} has the {measure} {value} um^{axes}; its corners must run {must}")]
    Orientation {
        /// Triangle or tetrahedron.
        of: &'static str,
        /// Its index.
        index: usize,
        /// Area or volume.
        measure: &'static str,
        /// Signed area, um^2, or volume, um^3.
        value: f64,
        /// Number of axes.
        axes: usize,
        /// How the corners must run.
        must: &'static str,
    },
    /// A node on fewer than two springs would swing freely.
    #[error("node {node} has only {springs} spring(s); at least 2 are needed")]
    Dangling {
        /// Index of the node.
        node: usize,
        /// Number of its springs.
        springs: usize,
    },
    /// The springs do not connect all nodes.
    #[error(
        "the mesh is not connected: only {reached} of {points} nodes are connected with node 0"
    )]
    Disconnected {
        /// Number of nodes connected with node 0.
        reached: usize,
        /// All nodes.
        points: usize,
    },
    /// A point does not lie on its stated lattice place.
    #[error("node {node} does not lie on {place} of the lattice")]
    OffLattice {
        /// Index of the node.
        node: usize,
        /// Its stated column, row and layer, in words.
        place: String,
    },
}

impl<const D: usize, const N: usize> Mesh<D, N> {
    /// Makes a mesh and checks all invariants.
    ///
    /// Guaranteed afterwards: coordinates are finite; areas, shares and weights are finite and
    /// positive; indices are in range; no spring has zero length and no pair of nodes has two
    /// springs; triangles run counter-clockwise; every node has at least two springs and all nodes
    /// are connected; the points lie on the lattice, if there is one.
    ///
    /// # Errors
    /// The first violated invariant, with the node, spring or triangle.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::{Mesh, MeshError, Simplex, Spring, SpringKind};
    /// let spring = |a, b| Spring { nodes: [a, b], kind: SpringKind::Axial, share: 1.0 };
    /// let triangle = |nodes| Simplex { nodes, weight: 1.0 };
    /// let points = [vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]];
    /// let springs = vec![spring(0, 1), spring(1, 2), spring(0, 2)];
    /// let areas = vec![1.0 / 6.0; 3];
    /// let mesh = |corners| {
    ///     Mesh::new(points.clone(), areas.clone(), springs.clone(), vec![triangle(corners)], None)
    /// };
    /// assert_eq!(mesh([0, 1, 2]).unwrap().area(), 0.5);
    /// let error = mesh([0, 2, 1]).unwrap_err();
    /// assert!(matches!(error, MeshError::Orientation { of: "triangle", index: 0, .. }));
    /// ```
    pub fn new(
        points: [Vec<f64>; D],
        areas: Vec<f64>,
        springs: Vec<Spring>,
        simplices: Vec<Simplex<N>>,
        lattice: Option<Lattice<D>>,
    ) -> Result<Self, MeshError> {
        let mesh = Self { points, areas, springs, simplices, lattice };
        mesh.check_points()?;
        mesh.check_springs()?;
        mesh.check_simplices()?;
        mesh.check_lattice()?;
        Ok(mesh)
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points[0].len()
    }

    /// Whether there are no points; always false for a mesh from [`Mesh::new`].
    pub fn is_empty(&self) -> bool {
        self.points[0].is_empty()
    }

    /// Rest position of one node, um.
    pub fn point(&self, node: usize) -> [f64; D] {
        std::array::from_fn(|axis| self.points[axis][node])
    }

    /// Area of the cell, um^2 (with three axes its volume, um^3): the sum of the nodes' areas.
    pub fn area(&self) -> f64 {
        self.areas.iter().sum()
    }

    /// Centre of the cell's area, um: `sum(A_n X_n) / sum(A_n)`.
    pub fn centroid(&self) -> [f64; D] {
        let area = self.area();
        std::array::from_fn(|axis| {
            self.points[axis].iter().zip(&self.areas).map(|(x, a)| x * a).sum::<f64>() / area
        })
    }

    /// The nodes by which the cell lies on what is below it, in ascending order, and the area of each, um^2: all of a flat one; of a
    /// thick one those of the lowest layer of its lattice.
    pub fn underside(&self) -> Vec<(usize, f64)> {
        let Some(lattice) = self.lattice.as_ref().filter(|_| D > 2) else {
            return self.areas.iter().copied().enumerate().collect();
        };
        let layer = |node: usize| lattice.cells[node].last();
        let least = (0..self.len()).map(layer).min().flatten();
        let lowest = |node: &usize| layer(*node) == least;
        // The part of a node's volume that is above its lowest face is half a spacing high.
        let area = |node: usize| (node, self.areas[node] / (0.5 * lattice.spacing));
        (0..self.len()).filter(lowest).map(area).collect()
    }

    /// Centre of one triangle (with three axes a tetrahedron) at rest, um: the mean of its corners.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::lattice;
    /// let mesh = lattice::rectangle(1, 1, 3.0).unwrap();
    /// // The halves of the square, parted along either diagonal, are centred a third and two thirds across it.
    /// let mut across: Vec<f64> = mesh.simplices.iter().map(|half| mesh.centre(half)[0]).collect();
    /// across.sort_by(f64::total_cmp);
    /// assert!((across[0] - 1.0).abs() < 1e-12 && (across[3] - 2.0).abs() < 1e-12);
    /// ```
    pub fn centre(&self, simplex: &Simplex<N>) -> [f64; D] {
        std::array::from_fn(|axis| {
            let corners = simplex.nodes.iter().map(|&node| self.points[axis][node as usize]);
            corners.sum::<f64>() / N as f64
        })
    }

    fn check_points(&self) -> Result<(), MeshError> {
        let count = self.len();
        if count == 0 {
            return Err(MeshError::NoPoints);
        }
        if count > u32::MAX as usize {
            return Err(MeshError::TooManyPoints { points: count, bound: u32::MAX as usize });
        }
        let lists =
            ["the list of x coordinates", "the list of y coordinates", "the list of z coordinates"];
        let lengths = lists.into_iter().zip(self.points.iter().map(Vec::len));
        for (what, found) in lengths.chain([("the list of areas", self.areas.len())]) {
            if found != count {
                return Err(MeshError::Length { what, found, expected: count });
            }
        }
        for (what, values) in ["x", "y", "z"].into_iter().zip(&self.points) {
            if let Some(index) = values.iter().position(|value| !value.is_finite()) {
                let value = values[index];
                return Err(MeshError::Value { what, of: "node", index, value, must: "finite" });
            }
        }
        positive("area", "node", self.areas.iter().copied())
    }

    fn check_springs(&self) -> Result<(), MeshError> {
        let count = self.len();
        positive("share", "spring", self.springs.iter().map(|spring| spring.share))?;
        let mut degree = vec![0_usize; count];
        let mut pairs = Vec::with_capacity(self.springs.len());
        for (index, spring) in self.springs.iter().enumerate() {
            in_range("spring", index, &spring.nodes, count)?;
            let [a, b] = spring.nodes;
            if self.point(a as usize) == self.point(b as usize) {
                return Err(MeshError::ZeroLength { spring: index, a, b });
            }
            degree[a as usize] += 1;
            degree[b as usize] += 1;
            pairs.push([a.min(b), a.max(b)]);
        }
        pairs.sort_unstable();
        if let Some(twice) = pairs.windows(2).find(|two| two[0] == two[1]) {
            return Err(MeshError::DuplicateSpring { a: twice[0][0], b: twice[0][1] });
        }
        if let Some(node) = degree.iter().position(|&springs| springs < 2) {
            return Err(MeshError::Dangling { node, springs: degree[node] });
        }
        let reached = self.reached_from_first();
        if reached < count {
            return Err(MeshError::Disconnected { reached, points: count });
        }
        Ok(())
    }

    /// Number of nodes connected with node 0 by springs, including itself (union-find with path
    /// halving).
    fn reached_from_first(&self) -> usize {
        fn root(parent: &mut [u32], mut node: u32) -> u32 {
            while parent[node as usize] != node {
                parent[node as usize] = parent[parent[node as usize] as usize];
                node = parent[node as usize];
            }
            node
        }
        let mut parent: Vec<u32> = (0..self.len() as u32).collect();
        for spring in &self.springs {
            let [a, b] = spring.nodes.map(|node| root(&mut parent, node));
            parent[a.max(b) as usize] = a.min(b);
        }
        (0..self.len() as u32).filter(|&node| root(&mut parent, node) == 0).count()
    }

    fn check_simplices(&self) -> Result<(), MeshError> {
        let (of, measure, must) = match D {
            2 => ("triangle", "area", "counter-clockwise"),
            _ => ("tetrahedron", "volume", "by the rule of the right hand"),
        };
        positive("weight", of, self.simplices.iter().map(|simplex| simplex.weight))?;
        for (index, simplex) in self.simplices.iter().enumerate() {
            in_range(of, index, &simplex.nodes, self.len())?;
            let value = simplex::measure(&simplex.nodes.map(|node| self.point(node as usize)));
            if value.is_nan() || value <= 0.0 {
                return Err(MeshError::Orientation { of, index, measure, value, axes: D, must });
            }
        }
        Ok(())
    }

    fn check_lattice(&self) -> Result<(), MeshError> {
        let Some(lattice) = &self.lattice else { return Ok(()) };
        positive("spacing", "lattice", std::iter::once(lattice.spacing))?;
        if lattice.cells.len() != self.len() {
            let (found, expected) = (lattice.cells.len(), self.len());
            return Err(MeshError::Length { what: "the list of lattice places", found, expected });
        }
        for (node, cell) in lattice.cells.iter().enumerate() {
            let point = self.point(node);
            // 1e-6 of the spacing: far above rounding, far below a wrong place.
            let there = cell.iter().enumerate().all(|(axis, &place)| {
                let expected = lattice.origin[axis] + lattice.spacing * f64::from(place);
                (place as usize) < lattice.shape[axis]
                    && (point[axis] - expected).abs() <= 1e-6 * lattice.spacing
            });
            if !there {
                let words = ["column", "row", "layer"].iter().zip(cell);
                let words: Vec<String> = words.map(|(word, at)| format!("{word} {at}")).collect();
                return Err(MeshError::OffLattice { node, place: words.join(", ") });
            }
        }
        Ok(())
    }
}

fn positive(
    what: &'static str,
    of: &'static str,
    values: impl Iterator<Item = f64>,
) -> Result<(), MeshError> {
    for (index, value) in values.enumerate() {
        if !(value.is_finite() && value > 0.0) {
            return Err(MeshError::Value { what, of, index, value, must: "finite and positive" });
        }
    }
    Ok(())
}

fn in_range(of: &'static str, index: usize, nodes: &[u32], points: usize) -> Result<(), MeshError> {
    match nodes.iter().find(|&&node| node as usize >= points) {
        Some(&node) => Err(MeshError::Index { of, index, node, points }),
        None => Ok(()),
    }
}
