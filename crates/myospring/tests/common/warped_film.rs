//! A picture of a resting cell, warped by the program's own beat of that cell: a film of known motion that looks as the
//! picture does.

use super::synthetic_cell::Random;
use myospring::integrate::quasi_static::Tolerance;
use myospring::mesh::carried::Carried;
use myospring::mesh::lattice;
use myospring::mesh::mask::Mask;
use myospring::microscopy::film::Film;
use myospring::microscopy::picture::Selection;
use myospring::microscopy::plane::Plane;
use myospring::simulation::{Numerics, Simulation};

/// Time between frames of the film, ms.
const FRAME_MS: f64 = 40.0;
/// Rate of the film, frames per second.
pub(crate) const FRAME_RATE: f64 = 1000.0 / FRAME_MS;
/// How far what surrounds the cell is drawn along, in largest displacements: a picture has no crack around the cell.
const SURROUNDINGS: f64 = 3.0;

/// What the camera adds.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Camera {
    /// Standard deviation of the noise, part of that of the cell's grey values.
    pub(crate) noise: f64,
    /// By how much the light falls from the middle to the corners, and how much the stain bleaches over the film.
    pub(crate) vignette: f64,
    pub(crate) bleach: f64,
}

/// A picture at rest and where each of its points goes.
pub(crate) struct WarpedFilm {
    plane: Plane,
    mask: Mask,
    /// Displacement of what rests at each pixel, pixels to the right and down, frame by frame.
    displacements: Vec<[Vec<f32>; 2]>,
}

impl WarpedFilm {
    /// The beat of the cell of a mask, with lattice sides of `spacing_um` and a peak tension in kPa, on its picture.
    pub(crate) fn new(plane: Plane, mask: Mask, spacing_um: f64, peak_tension: f64) -> Self {
        let (mesh, _) = lattice::from_mask(&mask, Some(spacing_um)).unwrap();
        let numerics = Numerics { frame_interval: FRAME_MS, ..Numerics::default() };
        let simulation =
            Simulation { numerics, peak_tension, duration: 500.0, ..Simulation::new(mesh.clone()) };
        let outcome = simulation.run_quasi_static(Tolerance::default(), |_| true).unwrap();
        assert_eq!(outcome.stop, None);
        let (width, height, pixel) = (mask.width(), mask.height(), mask.pixel_size().um());
        let centres = (0..width * height).map(|at| {
            let [column, row] = [(at % width) as f64, (at / width) as f64];
            [(column + 0.5) * pixel, (height as f64 - row - 0.5) * pixel]
        });
        let rest: Vec<[f64; 2]> = centres.collect();
        let carried = Carried::new(&mesh, rest.iter().copied());
        let moved: Vec<Vec<[f64; 2]>> =
            outcome.recording.frames.iter().map(|frame| carried.at(&frame.positions)).collect();
        let inside = mask.inside();
        let within = (0..rest.len()).filter(|&at| inside[at]);
        let farthest = moved.iter().flat_map(|to| {
            let of = |at: usize| (to[at][0] - rest[at][0]).hypot(to[at][1] - rest[at][1]);
            within.clone().map(of)
        });
        let reach = SURROUNDINGS * farthest.fold(0.0, f64::max) / pixel;
        let share = shares(&inside, width, reach);
        let displacements = moved.iter().map(|to| {
            let along = |axis: usize, sign: f64| {
                let of =
                    |at: usize| (share[at] * sign * (to[at][axis] - rest[at][axis]) / pixel) as f32;
                (0..rest.len()).map(of).collect()
            };
            [along(0, 1.0), along(1, -1.0)]
        });
        let displacements = displacements.collect();
        Self { plane, mask, displacements }
    }

    /// Number of frames.
    pub(crate) fn len(&self) -> usize {
        self.displacements.len()
    }

    /// Whether the cell rests in a frame: no point is further from its place than a hundredth of a pixel.
    pub(crate) fn rests(&self, frame: usize) -> bool {
        self.displacements[frame].iter().flatten().all(|shift| shift.abs() < 0.01)
    }

    /// Displacement of what rests at a point, um, y upward.
    pub(crate) fn displacement(&self, [x, y]: [f64; 2], frame: usize) -> [f64; 2] {
        let pixel = self.mask.pixel_size().um();
        let place = [x / pixel - 0.5, self.mask.height() as f64 - y / pixel - 0.5];
        let [right, down] = self.shift(frame, place);
        [right * pixel, -down * pixel]
    }

    /// Displacement of what rests at a place in pixels, by straight lines between the centres of pixels.
    fn shift(&self, frame: usize, [column, row]: [f64; 2]) -> [f64; 2] {
        let (width, height) = (self.plane.width(), self.plane.height());
        let column = column.clamp(0.0, width as f64 - 1.001);
        let row = row.clamp(0.0, height as f64 - 1.001);
        let (left, top) = (column as usize, row as usize);
        let (s, t) = (column - left as f64, row - top as f64);
        [0, 1].map(|axis: usize| {
            let at = |right: usize, down: usize| {
                f64::from(self.displacements[frame][axis][(top + down) * width + left + right])
            };
            (1.0 - t) * ((1.0 - s) * at(0, 0) + s * at(1, 0))
                + t * ((1.0 - s) * at(0, 1) + s * at(1, 1))
        })
    }

    /// The grey value at a place of the picture at rest, by the cubic of Catmull and Rom in both directions.
    fn grey(&self, [column, row]: [f64; 2]) -> f64 {
        let (width, height) = (self.plane.width(), self.plane.height());
        let weights = |part: f64| {
            let t = part;
            [
                0.5 * t * (t * (2.0 - t) - 1.0),
                0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
                0.5 * t * (t * (4.0 - 3.0 * t) + 1.0),
                0.5 * t * t * (t - 1.0),
            ]
        };
        let (across, down) = (weights(column - column.floor()), weights(row - row.floor()));
        let pixel = |from: f64, step: usize, sides: usize| {
            (from.floor() + step as f64 - 1.0).clamp(0.0, sides as f64 - 1.0) as usize
        };
        let mut sum = 0.0;
        for (j, down) in down.into_iter().enumerate() {
            for (i, across) in across.into_iter().enumerate() {
                let value = self.plane.at(pixel(column, i, width), pixel(row, j, height));
                sum += down * across * f64::from(value);
            }
        }
        sum
    }

    /// The place at rest of what is seen at a pixel.
    fn origin(&self, frame: usize, seen: [f64; 2]) -> [f64; 2] {
        let mut rest = seen;
        for _ in 0..60 {
            let shift = self.shift(frame, rest);
            let next = [seen[0] - shift[0], seen[1] - shift[1]];
            let step = (next[0] - rest[0]).hypot(next[1] - rest[1]);
            rest = next;
            if step < 1e-6 {
                break;
            }
        }
        rest
    }

    /// What a camera of 16 bits makes of it.
    pub(crate) fn film(&self, camera: Camera, seed: u64) -> Film {
        let (width, height) = (self.plane.width(), self.plane.height());
        let [low, high] = self.plane.range().map(f64::from);
        let inside = self.mask.inside();
        let cell: Vec<f64> = (0..inside.len())
            .filter(|&at| inside[at])
            .map(|at| f64::from(self.plane.values()[at]))
            .collect();
        let mean = cell.iter().sum::<f64>() / cell.len() as f64;
        let variance = cell.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / cell.len() as f64;
        let noise = camera.noise * variance.sqrt();
        let mut random = Random(seed);
        let mut bytes = format!("YUV4MPEG2 W{width} H{height} F25:1 Cmono16\n").into_bytes();
        for frame in 0..self.len() {
            bytes.extend(b"FRAME\n");
            let bright = 1.0 - camera.bleach * frame as f64 / self.len() as f64;
            for at in 0..width * height {
                let seen = [(at % width) as f64, (at / width) as f64];
                let [x, y] = [seen[0] / width as f64 - 0.5, seen[1] / height as f64 - 0.5];
                let light = bright * (1.0 - 2.0 * camera.vignette * (x * x + y * y));
                let value =
                    light * (self.grey(self.origin(frame, seen)) - low) + noise * random.normal();
                // Space for noise below and above.
                let part = 0.2 + 0.6 * value / (high - low);
                bytes.extend(((65535.0 * part).round().clamp(0.0, 65535.0) as u16).to_le_bytes());
            }
        }
        Film::read(bytes, &Selection::default()).unwrap()
    }

    /// The cell at rest.
    pub(crate) fn mask(&self) -> &Mask {
        &self.mask
    }
}

/// By how much each pixel goes with the cell: 1 within it, 0 from a distance of `reach` pixels on.
fn shares(inside: &[bool], width: usize, reach: f64) -> Vec<f64> {
    let height = inside.len() / width;
    // The distance by steps to neighbours, straight and slant (Borgefors 1986): within 6 %.
    let mut distance: Vec<f64> =
        inside.iter().map(|&inside| if inside { 0.0 } else { f64::INFINITY }).collect();
    let near: [(isize, isize, f64); 4] =
        [(-1, 0, 1.0), (0, -1, 1.0), (-1, -1, 1.414), (1, -1, 1.414)];
    for sign in [1, -1] {
        for step in 0..inside.len() {
            let at = if sign == 1 { step } else { inside.len() - 1 - step };
            for (right, down, length) in near {
                let column = (at % width).checked_add_signed(sign * right).filter(|&x| x < width);
                let row = (at / width).checked_add_signed(sign * down).filter(|&y| y < height);
                if let (Some(x), Some(y)) = (column, row) {
                    distance[at] = distance[at].min(distance[y * width + x] + length);
                }
            }
        }
    }
    let share = |distance: f64| {
        if distance < reach {
            0.5 + 0.5 * (std::f64::consts::PI * distance / reach).cos()
        } else {
            0.0
        }
    };
    distance.into_iter().map(share).collect()
}
