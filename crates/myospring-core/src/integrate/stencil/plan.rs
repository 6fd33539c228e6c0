//! Turns forces on a mesh into coefficients by lattice place, in the order in which the sweep reads
//! them.

use crate::mechanics::lattice_law::LatticeLaw;
use crate::mechanics::support::Support;
use crate::mesh::Lattice;
use std::f64::consts::SQRT_2;

/// Squares that share a record; the widest vector.
pub(super) const BLOCK: usize = 8;

/// Blocks of a record: four spring stiffnesses, ...
pub(super) const STIFFNESS: usize = 0;
/// ... four dashpot coefficients, ...
pub(super) const DAMPING: usize = 4;
/// ... four fibre weights, ...
pub(super) const FIBRE: usize = 8;
/// ... the area law's `-kappa/4`, ...
pub(super) const AREA: usize = 12;
/// ... and `dt / (m (1 + g))` of the mass at the square's lower left.
pub(super) const INVERSE_MASS: usize = 13;
/// Blocks in a record.
pub(super) const RECORD: usize = 14;

/// Whether forces other than springs and dashpots act.
pub(super) mod laws {
    /// The area law.
    pub(in super::super) const AREA: u8 = 1;
    /// The fibre tension.
    pub(in super::super) const FIBRE: u8 = 2;
    /// Springs to resting places.
    pub(in super::super) const ANCHORS: u8 = 4;
}

/// Relative difference below which coefficients count as equal: far above the rounding of a mesh's
/// coordinates, far below anything a user states.
const SAME: f64 = 1e-12;

/// Part of the spacing by which a spring's rest length may differ from the lattice's.
const ON_LATTICE: f64 = 1e-9;

/// Distance from the cell of places without a mass, in spacings: no mass ever comes there, so the
/// lengths of their springs without stiffness are never zero.
const FAR: f64 = 1e6;

/// Eight aligned values.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Block(pub(super) [f64; BLOCK]);

impl Block {
    pub(super) const ZERO: Self = Self([0.0; BLOCK]);
}

/// Location of the coefficients of a block of squares: none, the uniform terms, or record n - 2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Class(pub(super) u32);

impl Class {
    pub(super) const EMPTY: Self = Self(0);
    pub(super) const UNIFORM: Self = Self(1);
}

/// Coefficients of a square, such as one inside a uniform cell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Uniform {
    pub(super) stiffness: [f64; 4],
    pub(super) damping: [f64; 4],
    pub(super) fibre: [f64; 4],
    pub(super) area: f64,
    pub(super) inverse_mass: f64,
}

impl Uniform {
    /// As records have them.
    fn record(&self) -> [f64; RECORD] {
        let mut all = [0.0; RECORD];
        all[STIFFNESS..DAMPING].copy_from_slice(&self.stiffness);
        all[DAMPING..FIBRE].copy_from_slice(&self.damping);
        all[FIBRE..AREA].copy_from_slice(&self.fibre);
        all[AREA] = self.area;
        all[INVERSE_MASS] = self.inverse_mass;
        all
    }
}

/// Everything that a sweep reads but does not write.
///
/// A row of the state is x, y, and the two components of the half-step velocity, each `stride` values
/// long; there is one row of padding on top.
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pub(super) rows: usize,
    /// Blocks in a row.
    pub(super) blocks: usize,
    /// Values in a row, with a block of padding on the right.
    pub(super) stride: usize,
    /// First block of each row's pass, and the one after the last.
    pub(super) spans: Vec<[usize; 2]>,
    /// By row and block.
    pub(super) classes: Vec<Class>,
    pub(super) records: Vec<Block>,
    pub(super) uniform: Uniform,
    /// Rest length along the axes and across, um.
    pub(super) rest_length: [f64; 2],
    /// Four times the rest area of a triangle, um^2.
    pub(super) rest_area: f64,
    /// Time step, ms.
    pub(super) time_step: f64,
    /// `(1 - g)/(1 + g)`
    pub(super) keep: f64,
    /// `1/(1 + g)`
    pub(super) slowing: f64,
    /// Springs from places to their resting positions, if any: stiffness (nN/um) and the two
    /// resting coordinates (um), three strides for each row.
    pub(super) anchors: Vec<Block>,
    /// Which of [`laws`] act.
    pub(super) laws: u8,
    /// Offset of each node's x in the state.
    pub(super) places: Vec<usize>,
    /// State of the lattice before any mass is put on it.
    pub(super) vacant: Vec<Block>,
}

impl Plan {
    /// The coefficients of a block that has its own.
    pub(super) fn record(&self, class: Class) -> *const f64 {
        self.records[(class.0 as usize - 2) * RECORD..].as_ptr().cast()
    }

    /// Values in one row of the state.
    pub(super) fn row_len(&self) -> usize {
        4 * self.stride
    }
}

/// Coefficients of forces on a lattice: of its springs, squares and places.
///
/// Filled with the data of the forces ([`LatticeLaw`]) for a [`super::Stencil`].
#[derive(Debug, Clone)]
pub(super) struct LatticeTerms {
    columns: usize,
    rows: usize,
    spacing: f64,
    origin: [f64; 2],
    /// Place of each node.
    places: Vec<usize>,
    /// By direction and by the place of the square that a spring belongs to.
    stiffness: [Vec<f64>; 4],
    damping: [Vec<f64>; 4],
    fibre: [Vec<f64>; 4],
    /// Stiffness of the four triangles of a square, by the corner that they leave out.
    area: Vec<[f64; 4]>,
    /// Stiffness of the springs that tie the places to the lattice.
    anchors: Vec<f64>,
}

impl LatticeTerms {
    /// A lattice without forces.
    pub(super) fn new(lattice: &Lattice) -> Self {
        let [columns, rows] = lattice.shape;
        let count = columns * rows;
        let none = || [0; 4].map(|_| vec![0.0; count]);
        let places =
            lattice.cells.iter().map(|&[i, j]| j as usize * columns + i as usize).collect();
        Self {
            columns,
            rows,
            spacing: lattice.spacing,
            origin: lattice.origin,
            places,
            stiffness: none(),
            damping: none(),
            fibre: none(),
            area: vec![[0.0; 4]; count],
            anchors: vec![0.0; count],
        }
    }

    /// Direction and square of the spring between two nodes, if they are neighbours.
    fn edge(&self, nodes: [u32; 2]) -> Option<(usize, usize)> {
        let [a, b] = nodes.map(|node| self.places[node as usize]);
        let (a, b) = (a.min(b), a.max(b));
        let (column, other) = (a % self.columns, b % self.columns);
        match b / self.columns - a / self.columns {
            0 if other == column + 1 => Some((0, a)),
            1 if other == column => Some((1, a)),
            1 if other == column + 1 => Some((2, a)),
            1 if other + 1 == column => Some((3, a - 1)),
            _ => None,
        }
    }

    /// Adds a law; returns whether all of it fits the lattice.
    pub(super) fn add(&mut self, law: LatticeLaw<'_>) -> bool {
        match law {
            LatticeLaw::Springs { nodes, stiffness, rest_length, damping } => {
                nodes.iter().enumerate().all(|(spring, &nodes)| {
                    let (stiffness, rest) = (stiffness[spring], rest_length[spring]);
                    self.add_spring(nodes, stiffness, rest, damping[spring])
                })
            }
            LatticeLaw::Areas { nodes, stiffness, rest_area } => nodes
                .iter()
                .zip(stiffness.iter().zip(rest_area))
                .all(|(&nodes, (&stiffness, &rest))| self.add_area(nodes, stiffness, rest)),
            LatticeLaw::Tension { nodes, weights } => {
                nodes.iter().zip(weights).all(|(&nodes, &weight)| self.add_tension(nodes, weight))
            }
            LatticeLaw::Anchors(springs) => springs
                .iter()
                .all(|anchor| self.add_anchor(anchor.node, anchor.stiffness, anchor.place)),
        }
    }

    /// Adds a spring with stiffness (nN/um), rest length (um) and dashpot coefficient (nN ms/um);
    /// returns whether it fits the lattice.
    pub(super) fn add_spring(
        &mut self,
        nodes: [u32; 2],
        stiffness: f64,
        rest_length: f64,
        damping: f64,
    ) -> bool {
        let Some((direction, square)) = self.edge(nodes) else { return false };
        let length = self.spacing * if direction < 2 { 1.0 } else { SQRT_2 };
        self.stiffness[direction][square] += stiffness;
        self.damping[direction][square] += damping;
        (rest_length - length).abs() <= ON_LATTICE * self.spacing
    }

    /// Adds a spring without rest length whose stiffness (nN/um) is the tension (kPa) times a
    /// weight (um); returns whether it fits the lattice.
    fn add_tension(&mut self, nodes: [u32; 2], weight: f64) -> bool {
        let Some((direction, square)) = self.edge(nodes) else { return false };
        self.fibre[direction][square] += weight;
        true
    }

    /// Adds the energy `(kappa/2)(A - A0)^2` of a triangle, kappa in nN/um^3, A0 in um^2; returns
    /// whether it fits the lattice.
    fn add_area(&mut self, nodes: [u32; 3], stiffness: f64, rest_area: f64) -> bool {
        let places = nodes.map(|node| self.places[node as usize]);
        let column = places.map(|place| place % self.columns);
        let row = places.map(|place| place / self.columns);
        let smallest = |values: [usize; 3]| values.into_iter().fold(usize::MAX, usize::min);
        let (left, bottom) = (smallest(column), smallest(row));
        let corner = |k: usize| match (column[k] - left, row[k] - bottom) {
            (0, 0) => Some(0),
            (1, 0) => Some(1),
            (1, 1) => Some(2),
            (0, 1) => Some(3),
            _ => None,
        };
        let (Some(first), Some(second), Some(third)) = (corner(0), corner(1), corner(2)) else {
            return false;
        };
        if first == second || second == third || third == first {
            return false;
        }
        self.area[bottom * self.columns + left][6 - first - second - third] += stiffness;
        let expected = 0.5 * self.spacing * self.spacing;
        (rest_area - expected).abs() <= ON_LATTICE * expected
    }

    /// Adds a spring without rest length from a node to a resting position (um), stiffness in
    /// nN/um; returns whether that is the node's place on the lattice.
    fn add_anchor(&mut self, node: usize, stiffness: f64, rest: [f64; 2]) -> bool {
        let place = self.places[node];
        self.anchors[place] += stiffness;
        let on_lattice = self.point(place % self.columns, place / self.columns);
        (0..2).all(|axis| (rest[axis] - on_lattice[axis]).abs() <= ON_LATTICE * self.spacing)
    }

    /// Position of a place, um.
    fn point(&self, column: usize, row: usize) -> [f64; 2] {
        [0, 1].map(|axis| self.origin[axis] + self.spacing * [column, row][axis] as f64)
    }

    /// Arranges the coefficients for a sweep; `None` if the four triangles of a square differ, or
    /// if a support needs more than fixed nodes.
    pub(super) fn plan(
        &self,
        masses: &[f64],
        drag_rate: f64,
        support: &Support,
        time_step: f64,
    ) -> Option<Plan> {
        let (columns, rows) = (self.columns, self.rows);
        let g = 0.5 * drag_rate * time_step;
        let slowing = 1.0 / (1.0 + g);
        let inverse_mass = self.inverse_masses(masses, time_step * slowing, support);
        let alike = |parts: &[f64; 4]| parts.iter().all(|part| same(*part, parts[0]));
        if !self.area.iter().all(alike) {
            return None;
        }
        // -kappa/4, see the sweep
        let area: Vec<f64> = self.area.iter().map(|parts| -0.25 * parts[0]).collect();
        let uniform = Uniform {
            stiffness: [0, 1, 2, 3].map(|direction| commonest(&self.stiffness[direction])),
            damping: [0, 1, 2, 3].map(|direction| commonest(&self.damping[direction])),
            fibre: [0, 1, 2, 3].map(|direction| commonest(&self.fibre[direction])),
            area: commonest(&area),
            inverse_mass: commonest(&inverse_mass),
        };
        let blocks = columns.div_ceil(BLOCK);
        let stride = (blocks + 1) * BLOCK;
        let record = |place: usize| self.record(place, area[place], inverse_mass[place]);
        let (classes, records) = self.classes(record, uniform.record());
        let row_len = 4 * stride;
        let places: Vec<usize> =
            self.places.iter().map(|place| place / columns * row_len + place % columns).collect();
        let any = |values: &[Vec<f64>; 4]| values.iter().flatten().any(|value| *value != 0.0);
        let anchored = self.anchors.iter().any(|stiffness| *stiffness != 0.0);
        let laws = if area.iter().any(|value| *value != 0.0) { laws::AREA } else { 0 }
            | if any(&self.fibre) { laws::FIBRE } else { 0 }
            | if anchored { laws::ANCHORS } else { 0 };
        Some(Plan {
            rows,
            blocks,
            stride,
            spans: spans(&classes, rows, blocks),
            classes,
            records,
            uniform,
            rest_length: [self.spacing, SQRT_2 * self.spacing],
            rest_area: 2.0 * self.spacing * self.spacing,
            time_step,
            keep: (1.0 - g) * slowing,
            slowing,
            anchors: if anchored { self.anchor_rows(stride) } else { Vec::new() },
            laws,
            places,
            vacant: self.vacant(stride),
        })
    }

    /// `scale / m` at every place, 0 where there is no mass or a fixed one.
    fn inverse_masses(&self, masses: &[f64], scale: f64, support: &Support) -> Vec<f64> {
        let mut inverse_mass = vec![0.0; self.columns * self.rows];
        for (place, mass) in self.places.iter().zip(masses) {
            inverse_mass[*place] = scale / mass;
        }
        if let Support::Clamped(nodes) = support {
            for &node in nodes {
                inverse_mass[self.places[node]] = 0.0;
            }
        }
        inverse_mass
    }

    /// The record of a square.
    fn record(&self, place: usize, area: f64, inverse_mass: f64) -> [f64; RECORD] {
        let at = |of: &[Vec<f64>; 4]| [0, 1, 2, 3].map(|direction| of[direction][place]);
        let (stiffness, damping, fibre) = (at(&self.stiffness), at(&self.damping), at(&self.fibre));
        Uniform { stiffness, damping, fibre, area, inverse_mass }.record()
    }

    /// The class of every block, from the records of its squares, and the records of those that are neither
    /// empty nor `uniform`.
    fn classes(
        &self,
        record: impl Fn(usize) -> [f64; RECORD],
        uniform: [f64; RECORD],
    ) -> (Vec<Class>, Vec<Block>) {
        let (columns, blocks) = (self.columns, self.columns.div_ceil(BLOCK));
        let mut occupied = vec![false; columns * self.rows];
        for place in &self.places {
            occupied[*place] = true;
        }
        let mut classes = Vec::with_capacity(self.rows * blocks);
        let mut records: Vec<Block> = Vec::new();
        for row in 0..self.rows {
            for block in 0..blocks {
                let lanes: Vec<Option<usize>> = (block * BLOCK..(block + 1) * BLOCK)
                    .map(|column| (column < columns).then_some(row * columns + column))
                    .collect();
                let values: Vec<[f64; RECORD]> =
                    lanes.iter().map(|lane| lane.map_or([0.0; RECORD], &record)).collect();
                let vacant = lanes.iter().all(|lane| lane.is_none_or(|place| !occupied[place]));
                let is_uniform =
                    |all: &[f64; RECORD]| all.iter().zip(&uniform).all(|(a, b)| same(*a, *b));
                let class = if vacant && values.iter().all(|all| all.iter().all(|c| *c == 0.0)) {
                    Class::EMPTY
                } else if values.iter().all(is_uniform) {
                    Class::UNIFORM
                } else {
                    let class = Class((records.len() / RECORD) as u32 + 2);
                    records.extend(
                        (0..RECORD)
                            .map(|term| Block(std::array::from_fn(|lane| values[lane][term]))),
                    );
                    class
                };
                classes.push(class);
            }
        }
        (classes, records)
    }

    /// Stiffness and resting position of all anchors, in rows.
    fn anchor_rows(&self, stride: usize) -> Vec<Block> {
        let mut rows = vec![Block::ZERO; self.rows * 3 * stride / BLOCK];
        for (place, stiffness) in self.anchors.iter().enumerate() {
            let (column, row) = (place % self.columns, place / self.columns);
            let [x, y] = self.point(column, row);
            for (component, value) in [*stiffness, x, y].into_iter().enumerate() {
                let at = (3 * row + component) * stride + column;
                rows[at / BLOCK].0[at % BLOCK] = value;
            }
        }
        rows
    }

    /// Rows of a state without masses: every place at rest, far away.
    fn vacant(&self, stride: usize) -> Vec<Block> {
        let (h, row_len) = (self.spacing, 4 * stride);
        let mut state = vec![Block::ZERO; (self.rows + 1) * row_len / BLOCK];
        for row in 0..=self.rows {
            for column in 0..stride {
                let position = [column, row].map(|place| (place as f64 + FAR) * h);
                for axis in 0..2 {
                    let at = row * row_len + axis * stride + column;
                    state[at / BLOCK].0[at % BLOCK] = self.origin[axis] + position[axis];
                }
            }
        }
        state
    }
}

/// First block, and the one after the last, of each row that is not empty in this row or in the row
/// above, which receives the forces carried from this row.
fn spans(classes: &[Class], rows: usize, blocks: usize) -> Vec<[usize; 2]> {
    let own = |row: usize| {
        let filled = |block: &usize| classes[row * blocks + block] != Class::EMPTY;
        let first = (0..blocks).find(filled).unwrap_or(blocks);
        [first, (0..blocks).rev().find(filled).map_or(first, |last| last + 1)]
    };
    (0..rows)
        .map(|row| {
            let ([first, last], [first_above, last_above]) =
                (own(row), if row + 1 < rows { own(row + 1) } else { own(row) });
            [first.min(first_above), last.max(last_above)]
        })
        .collect()
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * b.abs()
}

/// The median of the nonzero values, which nearly all places inside a uniform cell have.
fn commonest(values: &[f64]) -> f64 {
    let mut some: Vec<f64> = values.iter().copied().filter(|value| *value != 0.0).collect();
    if some.is_empty() {
        return 0.0;
    }
    let middle = some.len() / 2;
    *some.select_nth_unstable_by(middle, f64::total_cmp).1
}
