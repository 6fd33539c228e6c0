//! Turns forces on a mesh into coefficients by lattice place.

use super::plan::{BLOCK, Block, Class, Plan, Record};
use crate::mechanics::lattice_law::LatticeLaw;
use crate::mechanics::runs;
use crate::mechanics::support::Support;
use crate::mesh::Lattice;
use crate::mesh::cubes::{TETRAHEDRA, TETRAHEDRA_OF_A_CUBE};
use std::array::from_fn;
use std::f64::consts::SQRT_2;

/// Relative difference below which coefficients count as equal: far above the rounding of a mesh's
/// coordinates, far below anything a user states.
const SAME: f64 = 1e-12;

/// Part of the spacing by which a spring's rest length may differ from the lattice's.
const ON_LATTICE: f64 = 1e-9;

/// Distance from the cell of places without a mass, in spacings: no mass ever comes there, so the
/// lengths of their springs without stiffness are never zero.
const FAR: f64 = 1e6;

/// Coefficients of forces on a lattice: of its springs, squares or cubes, and places.
///
/// Filled with the data of the forces ([`LatticeLaw`]) for a [`super::Stencil`].
#[derive(Debug, Clone)]
pub(super) struct LatticeTerms<const D: usize> {
    /// Places along each axis.
    shape: [usize; D],
    spacing: f64,
    origin: [f64; D],
    /// Column, row and layer of each node.
    cells: Vec<[usize; D]>,
    /// By direction and by the least corner of the square or cube that a spring belongs to.
    stiffness: Vec<Vec<f64>>,
    damping: Vec<Vec<f64>>,
    fibre: Vec<Vec<f64>>,
    /// Stiffness of the four triangles of a square, by the corner that they leave out.
    area: Vec<[f64; 4]>,
    /// `kappa/V0` of the cubes.
    volume: Vec<f64>,
    /// Stiffness of the springs that tie the places to the lattice.
    anchors: Vec<f64>,
}

impl<const D: usize> LatticeTerms<D> {
    /// A lattice without forces.
    pub(super) fn new(lattice: &Lattice<D>) -> Self {
        let count = lattice.shape.iter().product();
        let none = || vec![vec![0.0; count]; Record::<D>::SPRINGS];
        let flat = if D == 2 { count } else { 0 };
        Self {
            shape: lattice.shape,
            spacing: lattice.spacing,
            origin: lattice.origin,
            cells: lattice.cells.iter().map(|cell| cell.map(|place| place as usize)).collect(),
            stiffness: none(),
            damping: none(),
            fibre: none(),
            area: vec![[0.0; 4]; flat],
            volume: vec![0.0; count - flat],
            anchors: vec![0.0; count],
        }
    }

    /// Number of a place, x fastest.
    fn place(&self, cell: [usize; D]) -> usize {
        (0..D).rev().fold(0, |place, axis| place * self.shape[axis] + cell[axis])
    }

    /// Column, row and layer of a place.
    fn cell(&self, place: usize) -> [usize; D] {
        let mut rest = place;
        self.shape.map(|count| {
            let along = rest % count;
            rest /= count;
            along
        })
    }

    /// The least column, row and layer of some nodes, and how far each is from there: bit `axis` is set if it is one
    /// further along that axis. `None` if one is further than that.
    fn corners<const N: usize>(&self, nodes: [usize; N]) -> Option<([usize; D], [usize; N])> {
        let cells = nodes.map(|node| self.cells[node]);
        let least = from_fn(|axis| cells.iter().map(|cell| cell[axis]).min().unwrap_or(0));
        let corner = |cell: [usize; D]| {
            (0..D).try_fold(0, |bits, axis| match cell[axis] - least[axis] {
                0 => Some(bits),
                1 => Some(bits | 1 << axis),
                _ => None,
            })
        };
        let corners = cells.map(corner);
        corners.iter().all(Option::is_some).then(|| (least, corners.map(Option::unwrap_or_default)))
    }

    /// Direction and place of the spring between two nodes, if they are neighbours.
    fn edge(&self, nodes: [u32; 2]) -> Option<(usize, usize)> {
        let (least, [a, b]) = self.corners(nodes.map(|node| node as usize))?;
        let across: usize = a ^ b;
        let mut axes = (0..D).filter(|axis| across & (1 << axis) != 0);
        let direction = match (axes.next(), axes.next(), axes.next()) {
            (Some(axis), None, None) => axis,
            // A rising diagonal has one end at the least corner, a falling one none.
            (Some(first), Some(second), None) => {
                D + 2 * (first + second - 1) + usize::from(a != 0 && b != 0)
            }
            _ => return None,
        };
        Some((direction, self.place(least)))
    }

    /// Adds a law; returns whether all of it fits the lattice.
    pub(super) fn add(&mut self, law: LatticeLaw<'_, D>) -> bool {
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
            LatticeLaw::Volumes { corners, weights, stiffness, rest } => {
                let (simplices, odd) = corners.as_chunks::<4>();
                let cut = TETRAHEDRA_OF_A_CUBE * rest.len() == simplices.len() && odd.is_empty();
                let halves = weights.iter().all(|weight| *weight == 0.5);
                let (cubes, _) = simplices.as_chunks::<TETRAHEDRA_OF_A_CUBE>();
                let mut cubes = cubes.iter().zip(rest);
                cut && halves && cubes.all(|(cube, &rest)| self.add_volume(cube, stiffness, rest))
            }
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
        let Some((direction, place)) = self.edge(nodes) else { return false };
        let length = self.spacing * if direction < D { 1.0 } else { SQRT_2 };
        self.stiffness[direction][place] += stiffness;
        self.damping[direction][place] += damping;
        (rest_length - length).abs() <= ON_LATTICE * self.spacing
    }

    /// Adds a spring without rest length whose stiffness (nN/um) is the tension (kPa) times a
    /// weight (um); returns whether it fits the lattice.
    fn add_tension(&mut self, nodes: [u32; 2], weight: f64) -> bool {
        let Some((direction, place)) = self.edge(nodes) else { return false };
        self.fibre[direction][place] += weight;
        true
    }

    /// Adds the energy `(kappa/2)(A - A0)^2` of a triangle, kappa in nN/um^3, A0 in um^2; returns
    /// whether it fits the lattice.
    fn add_area(&mut self, nodes: [u32; 3], stiffness: f64, rest_area: f64) -> bool {
        let Some((least, [a, b, c])) = self.corners(nodes.map(|node| node as usize)) else {
            return false;
        };
        if self.area.is_empty() || a == b || b == c || c == a {
            return false;
        }
        let place = self.place(least);
        self.area[place][6 - a - b - c] += stiffness;
        let expected = 0.5 * self.spacing * self.spacing;
        (rest_area - expected).abs() <= ON_LATTICE * expected
    }

    /// Adds the energy `(kappa/2)(V - V0)^2/V0` of a cube, kappa in kPa, V0 in um^3, whose volume is that of the mean of both
    /// divisions into five tetrahedra; returns whether it fits the lattice.
    fn add_volume(
        &mut self,
        cube: &[[u32; 4]; TETRAHEDRA_OF_A_CUBE],
        stiffness: f64,
        rest_volume: f64,
    ) -> bool {
        let nodes: [u32; 4 * TETRAHEDRA_OF_A_CUBE] = from_fn(|k| cube[k / 4][k % 4]);
        let Some((least, corners)) = self.corners(nodes.map(|node| node as usize)) else {
            return false;
        };
        let sorted = |mut of: [usize; 4]| {
            of.sort_unstable();
            of
        };
        let (of_each, _) = corners.as_chunks::<4>();
        let alike = of_each.iter().zip(&TETRAHEDRA).all(|(a, b)| sorted(*a) == sorted(*b));
        let place = self.place(least);
        if self.volume.is_empty() || !alike {
            return false;
        }
        self.volume[place] += stiffness / rest_volume;
        let expected = self.spacing.powi(3);
        (rest_volume - expected).abs() <= ON_LATTICE * expected
    }

    /// Adds a spring without rest length from a node to a resting position (um), stiffness in
    /// nN/um; returns whether that is the node's place on the lattice.
    fn add_anchor(&mut self, node: usize, stiffness: f64, rest: [f64; D]) -> bool {
        let cell = self.cells[node];
        let place = self.place(cell);
        self.anchors[place] += stiffness;
        let on_lattice = self.point(cell);
        (0..D).all(|axis| (rest[axis] - on_lattice[axis]).abs() <= ON_LATTICE * self.spacing)
    }

    /// Position of a place, um.
    fn point(&self, cell: [usize; D]) -> [f64; D] {
        from_fn(|axis| self.origin[axis] + self.spacing * cell[axis] as f64)
    }

    /// Arranges the coefficients for a sweep; `None` if the four triangles of a square differ.
    pub(super) fn plan(
        &self,
        masses: &[f64],
        drag_rate: f64,
        support: &Support,
        time_step: f64,
    ) -> Option<Plan> {
        let [columns, ref others @ ..] = self.shape[..] else { return None };
        let rows: usize = others.iter().product();
        let g = 0.5 * drag_rate * time_step;
        let slowing = 1.0 / (1.0 + g);
        let inverse_mass = self.inverse_masses(masses, time_step * slowing, support);
        let alike = |parts: &[f64; 4]| parts.iter().all(|part| same(*part, parts[0]));
        if !self.area.iter().all(alike) {
            return None;
        }
        // -kappa/4 of a triangle, -kappa/V0/64^2 of a cube: see the sweeps.
        let area = self.area.iter().map(|parts| -0.25 * parts[0]);
        let measure: Vec<f64> = area.chain(self.volume.iter().map(|k| -k / 4096.0)).collect();
        let springs = self.stiffness.iter().chain(&self.damping).chain(&self.fibre);
        let terms: Vec<&[f64]> =
            springs.map(Vec::as_slice).chain([&measure[..], &inverse_mass]).collect();
        let uniform: Vec<f64> = terms.iter().map(|values| commonest(values)).collect();
        let blocks = columns.div_ceil(BLOCK);
        let stride = (blocks + 1) * BLOCK;
        let (classes, records) = self.classes(&terms, &uniform);
        let row_len = 2 * D * stride;
        let places = self.cells.iter().map(|cell| {
            let place = self.place(*cell);
            [(place / columns * row_len + place % columns) as u32]
        });
        let places: Vec<[u32; 1]> = places.collect();
        let any = |values: &[f64]| values.iter().any(|value| *value != 0.0);
        let anchored = any(&self.anchors);
        let laws = anchored || any(&measure) || self.fibre.iter().any(|of| any(of));
        // The rows above: in y, and in space in z and in both.
        let above = match others {
            [] => return None,
            [_] => vec![1],
            [layer, ..] => vec![1, *layer, layer + 1],
        };
        let lag = above[above.len() - 1];
        Some(Plan {
            axes: D,
            rows,
            lag,
            blocks,
            stride,
            row_len,
            record_len: Record::<D>::LEN,
            spans: spans(&classes, rows, blocks, &above),
            classes,
            records,
            uniform,
            rest_length: [self.spacing, SQRT_2 * self.spacing],
            rest_measure: match D {
                2 => 2.0 * self.spacing * self.spacing,
                _ => 64.0 * self.spacing.powi(3),
            },
            time_step,
            keep: (1.0 - g) * slowing,
            slowing,
            anchors: if anchored { self.anchor_rows(stride) } else { Vec::new() },
            laws,
            places: runs::find(&places),
            vacant: self.vacant(rows + lag, stride),
        })
    }

    /// `scale / m` at every place, 0 where there is no mass or a fixed one.
    fn inverse_masses(&self, masses: &[f64], scale: f64, support: &Support) -> Vec<f64> {
        let mut inverse_mass = vec![0.0; self.anchors.len()];
        for (cell, mass) in self.cells.iter().zip(masses) {
            inverse_mass[self.place(*cell)] = scale / mass;
        }
        if let Support::Clamped(nodes) = support {
            for &node in nodes {
                inverse_mass[self.place(self.cells[node])] = 0.0;
            }
        }
        inverse_mass
    }

    /// The class of every block, from the coefficients of its places, and the records of those that are neither
    /// empty nor `uniform`.
    fn classes(&self, terms: &[&[f64]], uniform: &[f64]) -> (Vec<Class>, Vec<Block>) {
        let (columns, count) = (self.shape[0], self.anchors.len());
        let mut occupied = vec![false; count];
        for cell in &self.cells {
            occupied[self.place(*cell)] = true;
        }
        let mut classes = Vec::new();
        let mut records: Vec<Block> = Vec::new();
        for row in 0..count / columns {
            for block in 0..columns.div_ceil(BLOCK) {
                let lanes: [Option<usize>; BLOCK] = from_fn(|lane| {
                    let column = block * BLOCK + lane;
                    (column < columns).then_some(row * columns + column)
                });
                let value = |term: &[f64], lane: Option<usize>| lane.map_or(0.0, |at| term[at]);
                let all = |holds: &dyn Fn(usize, f64) -> bool| {
                    terms.iter().enumerate().all(|(term, values)| {
                        lanes.iter().all(|lane| holds(term, value(values, *lane)))
                    })
                };
                let vacant = lanes.iter().all(|lane| lane.is_none_or(|place| !occupied[place]));
                let class = if vacant && all(&|_, value| value == 0.0) {
                    Class::EMPTY
                } else if all(&|term, value| same(value, uniform[term])) {
                    Class::UNIFORM
                } else {
                    let class = Class((records.len() / Record::<D>::LEN) as u32 + 2);
                    let block = |term: &&[f64]| Block(lanes.map(|lane| value(term, lane)));
                    records.extend(terms.iter().map(block));
                    class
                };
                classes.push(class);
            }
        }
        (classes, records)
    }

    /// Stiffness and resting position of all anchors, in rows.
    fn anchor_rows(&self, stride: usize) -> Vec<Block> {
        let rows = self.anchors.len() / self.shape[0];
        let mut blocks = vec![Block::ZERO; rows * (1 + D) * stride / BLOCK];
        for (place, stiffness) in self.anchors.iter().enumerate() {
            let (column, row) = (place % self.shape[0], place / self.shape[0]);
            let rest = self.point(self.cell(place));
            for (component, value) in std::iter::once(*stiffness).chain(rest).enumerate() {
                let at = ((1 + D) * row + component) * stride + column;
                blocks[at / BLOCK].0[at % BLOCK] = value;
            }
        }
        blocks
    }

    /// Rows of a state without masses: every place at rest, far away.
    fn vacant(&self, rows: usize, stride: usize) -> Vec<Block> {
        let (h, row_len) = (self.spacing, 2 * D * stride);
        let mut state = vec![Block::ZERO; rows * row_len / BLOCK];
        for row in 0..rows {
            let mut cell = self.cell(row * self.shape[0]);
            // Rows of padding lie above the last layer.
            cell[D - 1] = row / self.shape[1..D - 1].iter().product::<usize>();
            for column in 0..stride {
                cell[0] = column;
                for axis in 0..D {
                    let at = row * row_len + axis * stride + column;
                    state[at / BLOCK].0[at % BLOCK] =
                        self.origin[axis] + (cell[axis] as f64 + FAR) * h;
                }
            }
        }
        state
    }
}

/// First block, and the one after the last, of each row that is not empty in this row or in the rows
/// above, which receive the forces carried from this row.
fn spans(classes: &[Class], rows: usize, blocks: usize, above: &[usize]) -> Vec<[usize; 2]> {
    let own = |row: usize| {
        let filled = |block: &usize| classes[row * blocks + block] != Class::EMPTY;
        let first = (0..blocks).find(filled).unwrap_or(blocks);
        [first, (0..blocks).rev().find(filled).map_or(first, |last| last + 1)]
    };
    let own: Vec<[usize; 2]> = (0..rows).map(own).collect();
    let all = |row: usize| {
        let above = above.iter().filter_map(|step| own.get(row + step));
        above.fold(own[row], |[first, last], [a, b]| [first.min(*a), last.max(*b)])
    };
    (0..rows).map(all).collect()
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
