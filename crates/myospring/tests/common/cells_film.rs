//! Films of several cells whose motions are known, on a stage that moves.
#![allow(dead_code, reason = "no user of this file needs all of it")]

use super::synthetic_cell::Random;
use super::synthetic_film::FilmScene;

/// A cell with the place of its scene in the film, um from the lower left corner.
pub(crate) type Placed = (FilmScene, [f64; 2]);

/// What the film is like.
#[derive(Debug, Clone)]
pub(crate) struct CellsFilm {
    /// Width and height, um.
    pub(crate) size_um: [f64; 2],
    /// The cells; their own stage, noise and beads are not used.
    pub(crate) cells: Vec<Placed>,
    /// How far the stage goes to and fro, um.
    pub(crate) stage_um: f64,
    /// Standard deviation of the noise, part of that of the cells' grey values.
    pub(crate) noise: f64,
    /// Number of a cell that is evenly bright.
    pub(crate) flat: Option<usize>,
}

/// Side of a pixel, um.
pub(crate) const PIXEL_UM: f64 = 0.25;
/// Distance from a scene's rectangle that its cell does not reach, um.
const ROOM_UM: f64 = 6.0;

/// A cell of 60 x 14 um that shortens by a part of its length.
pub(crate) fn cell(shortening: f64, seed: u64) -> FilmScene {
    let scene = FilmScene { pixel_um: PIXEL_UM, cell_um: [60.0, 14.0], ..FilmScene::default() };
    FilmScene { shortening, seed, frames: 10, beat: 8, ..scene }
}

impl CellsFilm {
    /// The bytes of the film, `YUV4MPEG2`.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let [width, height] = self.size_um.map(|side| (side / PIXEL_UM).round() as usize);
        let mut bytes = format!("YUV4MPEG2 W{width} H{height} F50:1 Cmono\n").into_bytes();
        let frames = self.cells.iter().map(|(cell, _)| cell.frames).min().unwrap_or(0);
        for frame in 0..frames {
            bytes.extend(b"FRAME\n");
            let mut random = Random(977 * frame as u64 + 5);
            let turn = std::f64::consts::TAU * frame as f64 / frames as f64;
            let stage = [self.stage_um * turn.sin(), -0.6 * self.stage_um * turn.sin()];
            for row in 0..height {
                for column in 0..width {
                    let place = [
                        (column as f64 + 0.5) * PIXEL_UM - stage[0],
                        (height as f64 - row as f64 - 0.5) * PIXEL_UM - stage[1],
                    ];
                    let noisy = 0.8 * self.value(place, frame) + 0.2 * self.noise * random.normal();
                    bytes.push((255.0 * (0.08 + noisy)).round().clamp(0.0, 255.0) as u8);
                }
            }
        }
        bytes
    }

    /// Grey value, 0 to 1, of what is seen at a place of the dish.
    fn value(&self, [x, y]: [f64; 2], frame: usize) -> f64 {
        // Faint waves of the ground, which the stage carries along.
        let ground = 0.05 + 0.012 * ((1.9 * x).sin() * (2.3 * y).cos() + (0.7 * x + 1.1 * y).sin());
        let seen = self.cells.iter().enumerate().filter_map(|(number, (cell, [left, low]))| {
            let at = [x - left, y - low];
            let size = cell.size().map(|side| side as f64 * cell.pixel_um);
            let near =
                |axis: usize| at[axis] > ROOM_UM - 4.0 && at[axis] < size[axis] - ROOM_UM + 4.0;
            let even = |depth: f64| 0.5 / (1.0 + (-depth / 0.25).exp());
            (near(0) && near(1)).then(|| match self.flat {
                Some(flat) if flat == number => even(cell.depth(at)),
                _ => cell.texture(cell.origin(at, frame)),
            })
        });
        seen.fold(ground, f64::max)
    }
}
