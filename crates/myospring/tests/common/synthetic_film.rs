//! Films of a beating cell whose motion is known at every point.
#![allow(dead_code, reason = "no user of this file needs all of it")]

use std::f64::consts::TAU;

use super::synthetic_cell::Random;
use myospring::mesh::mask::Mask;
use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::film::Film;
use myospring::microscopy::motion::CellMotion;
use myospring::microscopy::picture::Selection;

/// Length of a sarcomere at rest, um.
pub(crate) const SARCOMERE_UM: f64 = 1.8;

/// What the film is like.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FilmScene {
    /// Side of a pixel, um.
    pub(crate) pixel_um: f64,
    /// Length and width of the cell at rest, um.
    pub(crate) cell_um: [f64; 2],
    /// Number of frames, and of those that a beat takes.
    pub(crate) frames: usize,
    pub(crate) beat: usize,
    /// Largest shortening, part of the length.
    pub(crate) shortening: f64,
    /// Standard deviation of the noise, part of that of the cell's grey values.
    pub(crate) noise: f64,
    /// By how much the light falls from the middle to the corners, and how much the stain bleaches over the film.
    pub(crate) vignette: f64,
    pub(crate) bleach: f64,
    /// 8 or 16.
    pub(crate) bits: u8,
    /// How far the stage goes to and fro, um.
    pub(crate) stage_um: f64,
    /// Whether the background has beads.
    pub(crate) beads: bool,
    /// Number that decides everything random.
    pub(crate) seed: u64,
}

impl Default for FilmScene {
    /// A striped cell of 80 x 16 um, 0.2 um a pixel, that shortens by 10 % within ten frames.
    fn default() -> Self {
        Self {
            pixel_um: 0.2,
            cell_um: [80.0, 16.0],
            frames: 16,
            beat: 12,
            shortening: 0.10,
            noise: 0.0,
            vignette: 0.0,
            bleach: 0.0,
            bits: 16,
            stage_um: 0.0,
            beads: false,
            seed: 1,
        }
    }
}

impl FilmScene {
    /// Columns and rows.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.cell_um.map(|length| ((length + 16.0) / self.pixel_um).round() as usize)
    }

    pub(crate) fn middle(&self) -> [f64; 2] {
        self.size().map(|side| 0.5 * side as f64 * self.pixel_um)
    }

    /// How strong the beat is in a frame, 0 to 1: at rest for the first three frames.
    pub(crate) fn strength(&self, frame: usize) -> f64 {
        let part = (frame as f64 - 2.0) / self.beat as f64;
        if (0.0..1.0).contains(&part) { (0.5 * TAU * part.sqrt()).sin().powi(2) } else { 0.0 }
    }

    /// How strong the beat is in the frame in which it is strongest.
    pub(crate) fn strength_most(&self) -> f64 {
        (0..self.frames).map(|frame| self.strength(frame)).fold(0.0, f64::max)
    }

    /// Motion of the stage in a frame, um.
    pub(crate) fn stage(&self, frame: usize) -> [f64; 2] {
        let turn = TAU * frame as f64 / self.frames as f64;
        [self.stage_um * turn.sin(), 0.5 * self.stage_um * turn.sin()]
    }

    /// Displacement without the stage of what rests at a point, um, y upward: the middle pulls more than the ends.
    pub(crate) fn displacement(&self, [x, y]: [f64; 2], frame: usize) -> [f64; 2] {
        let s = self.strength(frame) * self.shortening;
        let [cx, cy] = self.middle();
        let half = 0.5 * self.cell_um[0];
        let along = (x - cx) / half;
        // Twice as much strain in the middle as at the ends, and none sideways of the ends.
        let shift = -s * half * (1.2 * along - 0.2 * along.powi(3));
        [shift, 0.4 * s * (y - cy) * (1.0 - 0.3 * along * along)]
    }

    /// Distance from the outline at rest, um, positive inside: a rectangle with round corners and uneven sides.
    pub(crate) fn depth(&self, [x, y]: [f64; 2]) -> f64 {
        let [cx, cy] = self.middle();
        let [half_x, half_y] = self.cell_um.map(|length| 0.5 * length);
        let side = half_y + 0.6 * (0.35 * x).sin() - 1.0;
        let [dx, dy] = [(x - cx).abs() - half_x + 3.0, (y - cy).abs() - side + 3.0];
        3.0 - dx.max(0.0).hypot(dy.max(0.0)) - dx.max(dy).min(0.0)
    }

    /// Grey value, 0 to 1, of what rests at a point: rows of myofibrils with stripes, each with a phase and brightness of
    /// its own that wander along it; beads beside the cell.
    pub(crate) fn texture(&self, point: [f64; 2]) -> f64 {
        let [x, y] = point;
        let depth = self.depth(point);
        let edge = 1.0 / (1.0 + (-depth / 0.25).exp());
        let row = y / 1.6;
        let stripes = |row: f64| {
            let phase = self.wander(row, x / 14.0) * 2.5;
            let bright = 0.35 + 0.65 * (0.5 + 0.5 * self.wander(row + 1000.0, x / 5.0));
            let wave = (TAU * x / SARCOMERE_UM + phase).cos();
            bright * (0.5 + 0.5 * wave).powi(2)
        };
        let (low, part) = (row.floor(), row - row.floor());
        let mix = 0.5 - 0.5 * (0.5 * TAU * part).cos();
        let inside = 0.15 + 0.85 * ((1.0 - mix) * stripes(low) + mix * stripes(low + 1.0));
        let bead = |row: f64| (0.5 + 0.5 * self.wander(row + 5000.0, x / 1.3)).powi(4);
        let (low, part) = ((y / 1.3).floor(), (y / 1.3).fract());
        let mix = 0.5 - 0.5 * (0.5 * TAU * part).cos();
        let beads =
            if self.beads { 0.5 * ((1.0 - mix) * bead(low) + mix * bead(low + 1.0)) } else { 0.0 };
        edge * inside + (1.0 - edge) * (0.05 + beads)
    }

    /// A smooth random function along a row, -1 to 1.
    fn wander(&self, row: f64, at: f64) -> f64 {
        let knot = |k: f64| {
            let seed = self.seed
                ^ (row as i64 as u64).wrapping_mul(0x9e37_79b9)
                ^ ((k as i64 as u64) << 32);
            2.0 * Random(seed).next() - 1.0
        };
        let (low, part) = (at.floor(), at - at.floor());
        let mix = 0.5 - 0.5 * (0.5 * TAU * part).cos();
        (1.0 - mix) * knot(low) + mix * knot(low + 1.0)
    }

    /// What rests at the place that is seen at a point.
    pub(crate) fn origin(&self, seen: [f64; 2], frame: usize) -> [f64; 2] {
        let stage = self.stage(frame);
        let seen = [seen[0] - stage[0], seen[1] - stage[1]];
        let mut rest = seen;
        // A contraction: the strain is below a fifth.
        for _ in 0..12 {
            let moved =
                if self.depth(rest) > -4.0 { self.displacement(rest, frame) } else { [0.0; 2] };
            let before = std::mem::replace(&mut rest, [seen[0] - moved[0], seen[1] - moved[1]]);
            if before.iter().zip(&rest).all(|(before, now)| (before - now).abs() < 1e-9) {
                break;
            }
        }
        // What is beside the cell stays where it is.
        if self.depth(rest) > -1.0 { rest } else { seen }
    }

    fn counts(&self, frame: usize) -> Vec<u16> {
        let [width, height] = self.size();
        let most = if self.bits == 8 { 255.0 } else { 4095.0 };
        let mut random = Random(self.seed * 7919 + frame as u64);
        let bright = 1.0 - self.bleach * frame as f64 / self.frames as f64;
        let mut counts = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let point = self.point(column as f64, row as f64);
                let place = [column as f64 / width as f64 - 0.5, row as f64 / height as f64 - 0.5];
                let light = 1.0 - self.vignette * 2.0 * (place[0].powi(2) + place[1].powi(2));
                let value = 0.8 * bright * light * self.texture(self.origin(point, frame));
                // The grey values of the cell have a standard deviation of about a fifth of the range.
                let noisy = value + 0.2 * self.noise * random.normal();
                counts.push(((0.1 + noisy) * most).round().clamp(0.0, most) as u16);
            }
        }
        counts
    }

    /// A pixel's centre in um, y upward.
    pub(crate) fn point(&self, column: f64, row: f64) -> [f64; 2] {
        let height = self.size()[1] as f64;
        [(column + 0.5) * self.pixel_um, (height - row - 0.5) * self.pixel_um]
    }

    /// The bytes of the film, `YUV4MPEG2`.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let [width, height] = self.size();
        let kind = if self.bits == 8 { "mono" } else { "mono16" };
        let mut bytes = format!("YUV4MPEG2 W{width} H{height} F50:1 C{kind}\n").into_bytes();
        for frame in 0..self.frames {
            bytes.extend(b"FRAME\n");
            for count in self.counts(frame) {
                if self.bits == 8 {
                    bytes.push(count as u8);
                } else {
                    bytes.extend(count.to_le_bytes());
                }
            }
        }
        bytes
    }

    pub(crate) fn film(&self) -> Film {
        Film::read(self.bytes(), &Selection::default()).unwrap()
    }

    /// The cell at rest.
    pub(crate) fn mask(&self) -> Mask {
        let [width, height] = self.size();
        let inside = (0..width * height)
            .map(|at| self.depth(self.point((at % width) as f64, (at / width) as f64)) > 0.0)
            .collect();
        Mask::new(width, height, PixelSize::new(self.pixel_um).unwrap(), inside).unwrap()
    }
}

/// How well a motion was found.
impl FilmScene {
    /// Errors of all points in all frames, pixels, the least first.
    pub(crate) fn errors(&self, motion: &CellMotion) -> Vec<f64> {
        let mut errors = Vec::new();
        for frame in 0..motion.len() {
            let stage = self.stage(frame);
            for node in 0..motion.mesh.len() {
                let wanted = self.displacement(motion.mesh.point(node), frame);
                let off = [0, 1].map(|axis: usize| {
                    let found =
                        motion.displacements_um[frame][axis][node] + motion.stage_um[frame][axis];
                    found - wanted[axis] - stage[axis]
                });
                errors.push(off[0].hypot(off[1]) / self.pixel_um);
            }
        }
        errors.sort_by(f64::total_cmp);
        errors
    }

    /// Largest difference of measured and true shortening over all frames, percentage points.
    pub(crate) fn shortening_error(&self, motion: &CellMotion) -> f64 {
        let lengths = motion.lengths_um();
        let moved = |frame: &usize| {
            let ways = (0..motion.mesh.len())
                .map(|node| self.displacement(motion.mesh.point(node), *frame));
            let ways: Vec<[f64; 2]> = ways.collect();
            [0, 1].map(|axis: usize| ways.iter().map(|way| way[axis]).collect::<Vec<f64>>())
        };
        let displacements_um = motion.frames.iter().map(moved).collect();
        let truth = CellMotion { displacements_um, ..motion.clone() }.lengths_um();
        let off =
            |frame: usize| 100.0 * (lengths[frame] / lengths[0] - truth[frame] / truth[0]).abs();
        (0..motion.len()).map(off).fold(0.0, f64::max)
    }
}

/// The value below which a part of sorted values lies.
pub(crate) fn quantile(sorted: &[f64], part: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * part) as usize]
}
