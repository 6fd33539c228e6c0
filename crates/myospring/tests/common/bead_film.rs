//! Pictures of beads in a gel that a cell of known force pulls on.
#![allow(dead_code, reason = "no user of this file needs all of it")]

use super::synthetic_cell::Random;
use myospring::experiment::Files;
use myospring::experiment::traction::{Beads, CellPlace, Traction};
use myospring::mechanics::compliance::Compliance;
use myospring::mechanics::gel::{Gel, GelBed, Surface};
use myospring::mesh::lattice;

/// Standard deviation of a bead's light, um: a diameter of 0.5 um at half of its height.
const BEAD_UM: f64 = 0.21;
/// Length and width of the cell, and the gel that is seen on each side of it, um.
pub(crate) const CELL_UM: [f64; 2] = [48.0, 14.0];
const AROUND_UM: [f64; 2] = [16.0, 24.0];
/// Light of the mean bead at its brightest, and of the ground, grey levels of 8 bits.
const BRIGHT: f64 = 100.0;
const GROUND: f64 = 12.0;

/// What the pictures are like.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BeadScene {
    /// Width and height of a picture, um.
    pub(crate) frame_um: [f64; 2],
    /// Side of a pixel, um.
    pub(crate) pixel_um: f64,
    /// Beads per um^2.
    pub(crate) density: f64,
    /// Photons that the brightest pixel of the mean bead counts: fewer make more noise.
    pub(crate) photons: f64,
    /// The gel.
    pub(crate) gel: Gel,
    /// Part by which the cell shortens where it pulls most; it widens by half of that.
    pub(crate) shortening: f64,
    /// How far the stage is off in the last frame, um to the right and upward.
    pub(crate) drift_um: [f64; 2],
    /// Number that decides everything random.
    pub(crate) seed: u64,
}

impl Default for BeadScene {
    /// A bead for every two um^2, moderate noise, and a cell that moves a gel of 5 kPa by up to half a um.
    fn default() -> Self {
        Self {
            frame_um: [0, 1].map(|axis: usize| CELL_UM[axis] + 2.0 * AROUND_UM[axis]),
            pixel_um: 0.2,
            density: 0.5,
            photons: 100.0,
            gel: Gel::half_space(5.0),
            shortening: 0.02,
            drift_um: [0.0; 2],
            seed: 1,
        }
    }
}

/// What the cell does where it pulls most.
pub(crate) struct Truth {
    pub(crate) axial_force_nn: f64,
    pub(crate) force_nn: f64,
    pub(crate) moment_fj: f64,
    /// The displacements, um; the origin is the lower left corner of the picture.
    surface: Surface,
}

impl Truth {
    /// The displacement at a place, um, when the cell pulls with this part of its force.
    pub(crate) fn displacement(&self, part: f64, at: [f64; 2]) -> [f64; 2] {
        displacement(&self.surface, at).map(|moved| part * moved)
    }
}

/// The displacement of a surface at a place, um, interpolated between nodes.
pub(crate) fn displacement(surface: &Surface, at: [f64; 2]) -> [f64; 2] {
    let Surface { spacing, origin, shape, displacements } = surface;
    let place = [0, 1].map(|axis: usize| {
        ((at[axis] - origin[axis]) / spacing).clamp(0.0, shape[axis] as f64 - 1.001)
    });
    let [column, row] = place.map(|at| at as usize);
    let [x, y] = place.map(f64::fract);
    displacements.each_ref().map(|axis| {
        let value = |right: usize, up: usize| axis[(row + up) * shape[0] + column + right];
        let low = (1.0 - x) * value(0, 0) + x * value(1, 0);
        let high = (1.0 - x) * value(0, 1) + x * value(1, 1);
        (1.0 - y) * low + y * high
    })
}

impl BeadScene {
    /// Columns and rows.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.frame_um.map(|side| (side / self.pixel_um).round() as usize)
    }

    /// What the cell does where it pulls most.
    pub(crate) fn truth(&self) -> Truth {
        let mesh = lattice::rectangle(CELL_UM[0] as usize, CELL_UM[1] as usize, 1.0).unwrap();
        let bed = GelBed::new(self.gel, &mesh, [1.0, 0.0]).unwrap();
        let middle = CELL_UM.map(|side| side / 2.0);
        let stretched = |axis: usize, by: f64| {
            mesh.points[axis].iter().map(|x| middle[axis] + by * (x - middle[axis])).collect()
        };
        let positions =
            [stretched(0, 1.0 - self.shortening), stretched(1, 1.0 + 0.5 * self.shortening)];
        let forces = bed.forces(&bed.displacements(&positions));
        let mut surface = bed.surface(&forces, 0.7);
        for (origin, around) in surface.origin.iter_mut().zip(AROUND_UM) {
            *origin += around;
        }
        let (mut axial, mut force, mut moment) = (0.0, 0.0, 0.0);
        for (node, (x, y)) in forces[0].iter().zip(&forces[1]).enumerate() {
            let place = mesh.point(node);
            let ahead = place[0] - middle[0];
            axial -= if ahead == 0.0 { 0.0 } else { 0.5 * x * ahead.signum() };
            force += x.hypot(*y);
            moment -= x * place[0] + y * place[1];
        }
        Truth { axial_force_nn: axial, force_nn: force, moment_fj: moment, surface }
    }

    /// Places of the beads at rest, um from the lower left corner, and their light.
    fn beads(&self) -> Vec<([f64; 2], f64)> {
        let mut random = Random(self.seed);
        let beyond = 3.0;
        let [width, height] = self.frame_um.map(|side| side + 2.0 * beyond);
        let count = (self.density * width * height).round() as usize;
        let bead = |_| {
            let place = [width * random.next() - beyond, height * random.next() - beyond];
            (place, 0.5 + random.next())
        };
        (0..count).map(bead).collect()
    }

    /// The picture when the surface is displaced so and the stage is off by this many um: 8 bits, rows from the top. `number`
    /// decides the noise.
    pub(crate) fn picture(
        &self,
        displaced: &dyn Fn([f64; 2]) -> [f64; 2],
        off: [f64; 2],
        number: u64,
    ) -> Vec<u8> {
        let [columns, rows] = self.size();
        let top = rows as f64 * self.pixel_um;
        let mut light = vec![0.0; columns * rows];
        for (place, brightness) in self.beads() {
            let moved = displaced(place);
            let now = [0, 1].map(|axis: usize| place[axis] + moved[axis] + off[axis]);
            // Pixels within four standard deviations.
            let range = |at: f64, count: usize| {
                let reach = 4.0 * BEAD_UM;
                let bound = |at: f64| (at / self.pixel_um).clamp(0.0, count as f64) as usize;
                bound(at - reach)..bound(at + reach + self.pixel_um)
            };
            for row in range(top - now[1], rows) {
                for column in range(now[0], columns) {
                    let x = (column as f64 + 0.5) * self.pixel_um - now[0];
                    let y = top - (row as f64 + 0.5) * self.pixel_um - now[1];
                    let height = (-(x * x + y * y) / (2.0 * BEAD_UM * BEAD_UM)).exp();
                    light[row * columns + column] += brightness * height;
                }
            }
        }
        let mut random = Random(self.seed ^ (number + 1).wrapping_mul(0x5851_f42d_4c95_7f2d));
        let seen = |light: &f64| {
            let ground = GROUND / BRIGHT;
            // Photons of the bead and the ground, and two of the camera.
            let counted = self.photons * (light + ground);
            let noise = (counted + 4.0).sqrt() * random.normal();
            (BRIGHT * (counted + noise) / self.photons).round().clamp(0.0, 255.0) as u8
        };
        light.iter().map(seen).collect()
    }

    /// A film in which the cell pulls with these parts of its force, and the stage drifts evenly; `rate` is whole frames a
    /// second. One frame is a picture.
    pub(crate) fn film(&self, parts: &[f64], rate: u32) -> Vec<u8> {
        let truth = self.truth();
        let [columns, rows] = self.size();
        let mut bytes = format!("YUV4MPEG2 W{columns} H{rows} F{rate}:1 Cmono\n").into_bytes();
        for (at, part) in parts.iter().enumerate() {
            let along = (at + 1) as f64 / parts.len() as f64;
            let off = self.drift_um.map(|drift| along * drift);
            bytes.extend(b"FRAME\n");
            bytes.extend(self.picture(&|at| truth.displacement(*part, at), off, at as u64));
        }
        bytes
    }

    /// A picture of other beads.
    pub(crate) fn film_of_others(&self) -> Vec<u8> {
        Self { seed: self.seed + 1000, ..*self }.reference()
    }

    /// A picture of the relaxed gel.
    pub(crate) fn reference(&self) -> Vec<u8> {
        let [columns, rows] = self.size();
        let mut bytes = format!("YUV4MPEG2 W{columns} H{rows} F1:1 Cmono\n").into_bytes();
        bytes.extend(b"FRAME\n");
        bytes.extend(self.picture(&|_| [0.0; 2], [0.0; 2], 1 << 40));
        bytes
    }

    /// A region around the cell, 2 um more than it, as GeoJSON.
    pub(crate) fn region() -> Vec<u8> {
        let [[left, right], [low, high]] = [0, 1]
            .map(|axis: usize| [AROUND_UM[axis] - 2.0, AROUND_UM[axis] + CELL_UM[axis] + 2.0]);
        format!(
            "{{\"type\":\"Polygon\",\"coordinates\":[[[{left},{low}],[{right},{low}],[{right},{high}],[{left},{high}],\
             [{left},{low}]]]}}"
        )
        .into_bytes()
    }

    /// Files of a film, `beads.y4m`, a reference, `relaxed.y4m`, and a region, `cell.geojson`.
    pub(crate) fn files(&self, parts: &[f64], rate: u32) -> Files {
        let held = [
            ("beads.y4m", self.film(parts, rate)),
            ("relaxed.y4m", self.reference()),
            ("cell.geojson", Self::region()),
        ];
        Files::holding(held.map(|(name, bytes)| (name.to_owned(), bytes)).into())
    }

    /// The experiment on these files, without its reference.
    pub(crate) fn traction(&self) -> Traction {
        let beads = Beads { pixel_size_um: Some(self.pixel_um), ..Beads::of("beads.y4m") };
        Traction {
            cell: Some(CellPlace::of("cell.geojson")),
            ..Traction::of_beads(beads, self.gel)
        }
    }

    /// The same with the picture of the relaxed gel as its reference.
    pub(crate) fn with_reference(&self) -> Traction {
        let beads = Beads {
            pixel_size_um: Some(self.pixel_um),
            reference: Some("relaxed.y4m".into()),
            ..Beads::of("beads.y4m")
        };
        Traction {
            cell: Some(CellPlace::of("cell.geojson")),
            ..Traction::of_beads(beads, self.gel)
        }
    }
}
