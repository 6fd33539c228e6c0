//! Films of cells whose map of tension is known: the equilibrium under it warps the picture of a striped cell.
#![allow(dead_code, reason = "no user of this file needs all of it")]

use super::synthetic_cell::Random;
use super::synthetic_film::FilmScene;
use myospring::integrate::quasi_static::{Equilibrium, Tolerance};
use myospring::mechanics::Tension;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::{Mesh, lattice};
use myospring::microscopy::film::Film;
use myospring::microscopy::motion::{self, CellAtRest, CellMotion, Rest, TrackingSettings};
use myospring::microscopy::picture::Selection;
use myospring::simulation::Simulation;

/// Frames at rest, at half of the tension, and at its peak.
pub(crate) const FRAMES: [f64; 9] = [0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 0.5, 0.0];
/// A beat that rises and falls smoothly.
pub(crate) const BEAT: [f64; 24] = [
    0.0, 0.0, 0.0, 0.0, 0.08, 0.3, 0.58, 0.82, 0.96, 1.0, 0.98, 0.9, 0.78, 0.65, 0.5, 0.37, 0.26,
    0.17, 0.1, 0.05, 0.02, 0.0, 0.0, 0.0,
];
/// Spacing of the lattice that makes the truth, um: finer than any that a map is made on.
const TRUE_SPACING: f64 = 0.7;

/// A cell and where it pulls.
pub(crate) struct Pulled {
    pub(crate) scene: FilmScene,
    /// Peak tension at a place relative to the middle of the cell, um, kPa.
    pub(crate) tension: fn([f64; 2]) -> f64,
    pub(crate) support: SupportKind,
    /// Part of the peak tension in each frame.
    pub(crate) frames: &'static [f64],
    /// By how many frames a place is late.
    pub(crate) lag: fn([f64; 2]) -> usize,
}

/// No tension in an ellipse of 18 x 7.2 um.
pub(crate) fn passive_nucleus([x, y]: [f64; 2]) -> f64 {
    if (x / 9.0).powi(2) + (y / 3.6).powi(2) < 1.0 { 0.0 } else { 40.0 }
}

/// Half as much at x > 0.
pub(crate) fn weak_half([x, _]: [f64; 2]) -> f64 {
    if x > 0.0 { 20.0 } else { 40.0 }
}

/// All places at once.
pub(crate) fn together(_: [f64; 2]) -> usize {
    0
}

/// The part at x > 0 two frames late.
pub(crate) fn late_half([x, _]: [f64; 2]) -> usize {
    if x > 0.0 { 2 } else { 0 }
}

/// The same everywhere.
pub(crate) fn even(_: [f64; 2]) -> f64 {
    35.0
}

impl Pulled {
    /// A mesh of the cell with this spacing, um.
    pub(crate) fn mesh(&self, spacing: f64) -> Mesh {
        lattice::from_mask(&self.scene.mask(), Some(spacing)).unwrap().0
    }

    /// The simulation of a mesh of it.
    pub(crate) fn simulation(&self, mesh: Mesh) -> Simulation {
        Simulation { support: self.support, ..Simulation::new(mesh) }
    }

    /// True tension at the place of a triangle of a mesh, kPa.
    pub(crate) fn truth(&self, mesh: &Mesh) -> Vec<f64> {
        let [cx, cy] = self.scene.middle();
        let at = |[x, y]: [f64; 2]| (self.tension)([x - cx, y - cy]);
        mesh.simplices.iter().map(|triangle| at(mesh.centre(triangle))).collect()
    }

    /// True tension at the place of each triangle of a mesh in a frame, kPa.
    pub(crate) fn truth_in(&self, mesh: &Mesh, frame: usize) -> Vec<f64> {
        let [cx, cy] = self.scene.middle();
        let late = |[x, y]: [f64; 2]| (self.lag)([x - cx, y - cy]);
        let part = |place: [f64; 2]| self.frames[frame.saturating_sub(late(place))];
        let places = mesh.simplices.iter().map(|triangle| mesh.centre(triangle));
        places.zip(self.truth(mesh)).map(|(place, tension)| part(place) * tension).collect()
    }

    /// Displacements of the points of a mesh under a part of the tension, um.
    pub(crate) fn displacements(&self, mesh: &Mesh, part: f64) -> [Vec<f64>; 2] {
        let tensions: Vec<f64> = self.truth(mesh).iter().map(|tension| part * tension).collect();
        self.moved(mesh, &tensions)
    }

    fn moved(&self, mesh: &Mesh, tensions: &[f64]) -> [Vec<f64>; 2] {
        let simulation = self.simulation(mesh.clone());
        let (body, system) = simulation.mechanics();
        let mut equilibrium = Equilibrium::new(&system, &body, Tolerance::default()).unwrap();
        let moved = equilibrium.find(&body.positions, Tension::PerElement(tensions)).unwrap();
        [0, 1].map(|axis: usize| {
            moved[axis].iter().zip(&mesh.points[axis]).map(|(now, rest)| now - rest).collect()
        })
    }

    /// The film: 8 bits, grey values as those of the scene's own film.
    pub(crate) fn film(&self) -> Film {
        Film::read(self.bytes(1), &Selection::default()).unwrap()
    }

    /// The bytes of the film; its beat is repeated this often.
    pub(crate) fn bytes(&self, beats: usize) -> Vec<u8> {
        let mesh = self.mesh(TRUE_SPACING);
        let [width, height] = self.scene.size();
        let mut bytes = format!("YUV4MPEG2 W{width} H{height} F50:1 Cmono\n").into_bytes();
        let head = bytes.len();
        // Frames of one tension differ in their noise.
        let mut pictures: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        for frame in 0..self.frames.len() {
            let tensions = self.truth_in(&mesh, frame);
            let known = pictures.iter().position(|(of, _)| *of == tensions);
            let known = known.unwrap_or_else(|| {
                let field = Field::new(&mesh, &self.moved(&mesh, &tensions));
                let places =
                    (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
                let seen = places.map(|(column, row)| self.scene.point(column as f64, row as f64));
                let picture = seen.map(|seen| self.scene.texture(field.origin(seen))).collect();
                pictures.push((tensions, picture));
                pictures.len() - 1
            });
            let mut random = Random(self.scene.seed * 7919 + frame as u64);
            bytes.extend(b"FRAME\n");
            for value in &pictures[known].1 {
                let noisy = 0.8 * value + 0.2 * self.scene.noise * random.normal();
                bytes.push(((0.1 + noisy) * 255.0).round().clamp(0.0, 255.0) as u8);
            }
        }
        let beat = bytes.split_off(head);
        bytes.extend(beat.repeat(beats));
        bytes
    }

    /// The motion of a mesh of the cell through its film.
    pub(crate) fn followed(&self, mesh: &Mesh) -> CellMotion {
        let (film, mask) = (self.film(), self.scene.mask());
        let inside = mask.inside();
        let pixel_size = mask.pixel_size();
        let cell =
            CellAtRest { mesh, inside: &inside, any_cell: &inside, pixel_size, fibres: None };
        let rest = Rest::at(&film, 0).unwrap();
        motion::follow(&film, rest, &cell, TrackingSettings::at(50.0), |_| true).unwrap()
    }
}

/// A displacement between the points of a lattice, continued beyond them.
struct Field {
    spacing: f64,
    /// Where the first point of the table is, um.
    start: [f64; 2],
    size: [usize; 2],
    /// Row by row.
    table: Vec<[f64; 2]>,
}

impl Field {
    /// Squares of the table beside the lattice.
    const BESIDE: usize = 8;

    fn new(mesh: &Mesh, displacements: &[Vec<f64>; 2]) -> Self {
        let lattice = mesh.lattice.as_ref().unwrap();
        let cells: Vec<[usize; 2]> =
            lattice.cells.iter().map(|cell| cell.map(|at| at as usize + Self::BESIDE)).collect();
        let size = [0, 1].map(|axis: usize| {
            cells.iter().map(|cell| cell[axis]).max().unwrap() + 1 + Self::BESIDE
        });
        let start = [0, 1]
            .map(|axis: usize| mesh.points[axis][0] - cells[0][axis] as f64 * lattice.spacing);
        let mut table: Vec<Option<[f64; 2]>> = vec![None; size[0] * size[1]];
        for (node, [i, j]) in cells.into_iter().enumerate() {
            table[j * size[0] + i] = Some([0, 1].map(|axis: usize| displacements[axis][node]));
        }
        // Outward, each the mean of what is known around it.
        while table.iter().any(Option::is_none) {
            let before = table.clone();
            for at in (0..table.len()).filter(|&at| before[at].is_none()) {
                let (i, j) = (at % size[0], at / size[0]);
                let around = [
                    (i > 0).then(|| at - 1),
                    (i + 1 < size[0]).then_some(at + 1),
                    (j > 0).then(|| at - size[0]),
                    (j + 1 < size[1]).then_some(at + size[0]),
                ];
                let known: Vec<[f64; 2]> =
                    around.into_iter().flatten().filter_map(|other| before[other]).collect();
                if !known.is_empty() {
                    table[at] = Some([0, 1].map(|axis: usize| {
                        known.iter().map(|u| u[axis]).sum::<f64>() / known.len() as f64
                    }));
                }
            }
        }
        Self { spacing: lattice.spacing, start, size, table: table.into_iter().flatten().collect() }
    }

    fn at(&self, place: [f64; 2]) -> [f64; 2] {
        let at = [0, 1].map(|axis: usize| {
            ((place[axis] - self.start[axis]) / self.spacing)
                .clamp(0.0, self.size[axis] as f64 - 1.001)
        });
        let [i, j] = at.map(|at| at as usize);
        let [p, q] = at.map(f64::fract);
        let value = |di: usize, dj: usize| self.table[(j + dj) * self.size[0] + i + di];
        [0, 1].map(|axis: usize| {
            let below = (1.0 - p) * value(0, 0)[axis] + p * value(1, 0)[axis];
            let above = (1.0 - p) * value(0, 1)[axis] + p * value(1, 1)[axis];
            (1.0 - q) * below + q * above
        })
    }

    /// What rests at the place that is seen at a point.
    fn origin(&self, seen: [f64; 2]) -> [f64; 2] {
        let mut rest = seen;
        for _ in 0..12 {
            let moved = self.at(rest);
            rest = [seen[0] - moved[0], seen[1] - moved[1]];
        }
        rest
    }
}
