//! Pictures of a cell whose outline is known: striations, uneven light, blur, noise, beads.
#![allow(dead_code, reason = "no user of this file needs all of it")]

use std::f64::consts::TAU;

use myospring::microscopy::plane::Plane;

/// What the picture is like. Lengths are um, brightness is relative to the plateau of the cell (fluorescence)
/// or to the background (brightfield).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scene {
    /// Side of one pixel.
    pub(crate) pixel_um: f64,
    /// Side of the square field of view.
    pub(crate) field_um: f64,
    /// Fluorescence: brightness of the cell above the background of 100 counts, counts. Brightfield: depth of
    /// the dark rim, part of the background of 1000 counts.
    pub(crate) contrast: f64,
    /// Standard deviation of the noise, counts.
    pub(crate) noise: f64,
    /// By how much the light falls from the middle to the corners, part of it.
    pub(crate) vignette: f64,
    /// Background that rises over the field, counts (fluorescence only).
    pub(crate) haze: f64,
    /// Standard deviation of the blur.
    pub(crate) blur_um: f64,
    /// Beads per 1000 um^2.
    pub(crate) beads: f64,
    /// Half of the cell's greatest width, um.
    pub(crate) half_width_um: f64,
    /// How blunt its ends are: 0.6 is a spindle, 0.1 nearly a rectangle.
    pub(crate) taper: f64,
    /// Turn of the cell, degrees.
    pub(crate) turn_deg: f64,
    /// Whether there are two nuclei of 18 x 11 um, dim and without stripes (fluorescence only).
    pub(crate) nuclei: bool,
    /// Brightness of one half of the cell over that of the other (fluorescence only).
    pub(crate) dim_half: f64,
    /// Number that decides everything random.
    pub(crate) seed: u64,
}

impl Default for Scene {
    /// A clear picture of 160 um with pixels of 0.25 um.
    fn default() -> Self {
        Self {
            pixel_um: 0.25,
            field_um: 160.0,
            contrast: 1.0,
            noise: 10.0,
            vignette: 0.0,
            haze: 0.0,
            blur_um: 0.3,
            beads: 0.0,
            half_width_um: 12.0,
            taper: 0.6,
            turn_deg: 20.0,
            nuclei: false,
            dim_half: 1.0,
            seed: 1,
        }
    }
}

/// A picture with its true mask.
pub(crate) struct Truth {
    pub(crate) plane: Plane,
    pub(crate) inside: Vec<bool>,
}

impl Truth {
    /// Dice's coefficient of a mask with the true one: 2 |A and B| / (|A| + |B|).
    pub(crate) fn dice(&self, found: impl Iterator<Item = bool>) -> f64 {
        let (mut both, mut all) = (0, 0);
        for (found, &truth) in found.zip(&self.inside) {
            both += usize::from(found && truth);
            all += usize::from(found) + usize::from(truth);
        }
        2.0 * both as f64 / all.max(1) as f64
    }
}

/// `SplitMix64`: Steele, Lea and Flood 2014.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.next()).ln()).sqrt() * (TAU * self.next()).cos()
    }
}

impl Scene {
    fn pixels(&self) -> usize {
        (self.field_um / self.pixel_um).round() as usize
    }

    /// Place of a pixel's centre about the middle of the cell, along its axis and across, um.
    fn place(&self, column: usize, row: usize) -> [f64; 2] {
        let middle = self.field_um / 2.0;
        let x = (column as f64 + 0.5) * self.pixel_um - middle;
        let y = middle - (row as f64 + 0.5) * self.pixel_um;
        let (sine, cosine) = self.turn_deg.to_radians().sin_cos();
        [x * cosine + y * sine, y * cosine - x * sine]
    }

    /// Distance from the outline, um, positive inside: a spindle of about 100 x 24 um, unless it is wider, with uneven sides.
    fn depth(&self, [x, y]: [f64; 2]) -> f64 {
        let u = x / 50.0;
        let half = self.half_width_um * (1.0 - u * u).max(0.0).powf(self.taper)
            + 0.8 * (x / 9.0).sin()
            + 0.5 * (x / 4.1).cos();
        let side = if y > 0.0 { half } else { half - 1.5 * (x / 16.0).cos() };
        // Across the side, corrected for its slope; exact enough for a rim of a um or two.
        (side - y.abs()).min((50.0 - x.abs()) * 1.2)
    }

    pub(crate) fn light(&self, column: usize, row: usize) -> f64 {
        let half = self.pixels() as f64 / 2.0;
        let (x, y) = (column as f64 / half - 1.0, row as f64 / half - 1.0);
        1.0 - self.vignette * (x * x + y * y) / 2.0
    }

    fn picture(&self, value: impl Fn([f64; 2], f64) -> f64, background: f64, scale: f64) -> Truth {
        let side = self.pixels();
        let mut random = Random(self.seed);
        let beads = self.bead_places(&mut random);
        let mut values = Vec::with_capacity(side * side);
        let mut inside = Vec::with_capacity(side * side);
        for row in 0..side {
            for column in 0..side {
                let place = self.place(column, row);
                let depth = self.depth(place);
                inside.push(depth > 0.0);
                values.push(value(place, depth) as f32);
            }
        }
        for [x, y] in beads {
            stamp(
                &mut values,
                side,
                [x / self.pixel_um, y / self.pixel_um],
                0.6 / self.pixel_um,
                |value| value - (0.5 * self.contrast * scale) as f32,
            );
        }
        let plane = Plane::new(side, side, values).unwrap();
        let blurred = myospring::microscopy::filter::gaussian(&plane, self.blur_um / self.pixel_um);
        let noisy = blurred.values().iter().enumerate().map(|(at, &value)| {
            let (column, row) = (at % side, at / side);
            let haze = self.haze * column as f64 / side as f64;
            let lit = background + haze + f64::from(value) * self.light(column, row);
            (lit + self.noise * random.normal()).clamp(0.0, 65535.0).round() as f32
        });
        let plane = Plane::new(side, side, noisy.collect()).unwrap();
        Truth { plane, inside }
    }

    fn bead_places(&self, random: &mut Random) -> Vec<[f64; 2]> {
        let count = (self.beads * self.field_um * self.field_um / 1000.0).round() as usize;
        (0..count).map(|_| [random.next() * self.field_um, random.next() * self.field_um]).collect()
    }

    /// A bright cell with z-discs 1.9 um apart on a dark ground.
    pub(crate) fn fluorescence(&self) -> Truth {
        let bright = 1000.0 * self.contrast;
        let value = |[x, y]: [f64; 2], depth: f64| {
            if depth <= 0.0 {
                return 0.0;
            }
            let stripes = 0.5 + 0.5 * (TAU * (x + 0.4 * (y / 3.0).sin()) / 1.9).cos();
            let rows = 0.6 + 0.4 * (TAU * y / 2.6).cos();
            if self.nuclei && ((x.abs() - 18.0) / 9.0).hypot(y / 5.5) < 1.0 {
                return 0.3 * bright;
            }
            let half = self.dim_half + (1.0 - self.dim_half) / (1.0 + (-x / 1.5).exp());
            bright * half * (0.25 + 0.75 * stripes * rows)
        };
        self.picture(value, 100.0, 0.0)
    }

    /// A cell as grey as its background with a dark rim, a bright halo and grains.
    pub(crate) fn brightfield(&self) -> Truth {
        let value = |[x, y]: [f64; 2], depth: f64| {
            let rim = -(-((depth - 0.8) / 0.7).powi(2)).exp();
            let halo = 0.6 * (-((depth + 1.0) / 0.8).powi(2)).exp();
            let grains = if depth > 1.5 {
                0.35 * (x / 0.9).sin() * (y / 0.7 + (x / 2.3).sin()).cos()
            } else {
                0.0
            };
            1000.0 * (1.0 + self.contrast * (rim + halo + grains))
        };
        self.picture(value, 0.0, 1000.0)
    }
}

fn stamp(
    values: &mut [f32],
    side: usize,
    [x, y]: [f64; 2],
    radius: f64,
    change: impl Fn(f32) -> f32,
) {
    let reach = |at: f64| ((at - radius).max(0.0) as usize, ((at + radius) as usize + 1).min(side));
    let ((left, right), (top, bottom)) = (reach(x), reach(y));
    for row in top..bottom {
        for column in left..right {
            if (column as f64 + 0.5 - x).hypot(row as f64 + 0.5 - y) <= radius {
                let value = &mut values[row * side + column];
                *value = change(*value);
            }
        }
    }
}
