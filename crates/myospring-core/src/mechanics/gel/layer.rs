//! A layer of gel that is bonded to glass.
//!
//! It differs from a half-space for long waves (`wave`): the difference goes as `exp(-2 k h)`, so in space it is smooth over the
//! thickness:
//!
//! ```text
//! dG_ij(r) = g_0(r/h) delta_ij + g_2(r/h) (2 r_i r_j / r^2 - delta_ij)
//! g_0 = 1/(4 pi G h) int (dL + dT) J_0(s r/h) s ds        g_2 = 1/(4 pi G h) int (dT - dL) J_2(s r/h) s ds
//! g_N = 1/(2 pi G h) int dN J_0(s r/h) s ds
//! ```
//!
//! where `dL`, `dT` and, normal to the surface, `dN` are the differences in units of `h/G`. Beyond some ten thicknesses the layer does not move at all.

use super::description::Gel;
use super::wave::compliance;
use libm::{j0, j1};
use std::f64::consts::PI;

/// Distance beyond which the layer does not move, in thicknesses: displacements go at least as `exp(-r/h)`.
const REACH: f64 = 25.0;
/// Distance between entries of the table, in thicknesses: cubics between them are good to 1e-7 of the largest.
const STEP: f64 = 0.05;
/// Where the integrals end, `exp(-2 s)` being 1e-17, and the width of a panel of Gauss's rule.
const LONGEST: f64 = 20.0;
const PANEL: f64 = 0.25;
/// Gauss's rule of five points between -1 and 1.
const GAUSS: [[f64; 2]; 5] = [
    [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [0.906_179_845_938_664, 0.236_926_885_056_189_1],
];

/// What a layer differs from a half-space by.
pub(super) struct Layer {
    thickness: f64,
    /// `g_0`, `g_2` and `g_N`, um/nN, at multiples of [`STEP`].
    table: Vec<[f64; 3]>,
}

impl Layer {
    pub(super) fn new(gel: Gel, thickness: f64) -> Self {
        let mut points = Vec::new();
        let mut start = 0.0;
        while start < LONGEST {
            points.extend(GAUSS.map(|[at, weight]| {
                let s = start + 0.5 * PANEL * (1.0 + at);
                let [along, across, normal] = compliance(gel.poisson, s);
                let [along, across, normal] =
                    [along - (1.0 - gel.poisson), across - 1.0, normal - (1.0 - gel.poisson)];
                let weight = 0.5 * PANEL * weight / (4.0 * PI * gel.shear_modulus() * thickness);
                [s, weight * (along + across), weight * (across - along), 2.0 * weight * normal]
            }));
            start += PANEL;
        }
        let entry = |place: usize| {
            let distance = place as f64 * STEP;
            points.iter().fold([0.0; 3], |[g0, g2, normal], &[s, both, apart, pressed]| {
                let [zeroth, second] = bessel(s * distance);
                [g0 + both * zeroth, g2 + apart * second, normal + pressed * zeroth]
            })
        };
        // One more on either side of each interval.
        let table = (0..=(REACH / STEP) as usize + 3).map(entry).collect();
        Self { thickness, table }
    }

    /// The distance beyond which the surface does not move, um.
    pub(super) fn reach(&self) -> f64 {
        REACH * self.thickness
    }

    /// What the layer adds to the displacements `[xx, xy, yy]` of a half-space at (x, y) from a force, um/nN.
    pub(super) fn more(&self, x: f64, y: f64) -> [f64; 3] {
        let r = x.hypot(y);
        let [g0, g2, _] = self.interpolate(r / self.thickness);
        if r == 0.0 {
            return [g0, 0.0, g0];
        }
        let (cosine, sine) = (x / r, y / r);
        let turn = cosine * cosine - sine * sine;
        [g0 + g2 * turn, 2.0 * g2 * cosine * sine, g0 - g2 * turn]
    }

    /// What the layer adds to the normal displacement of a half-space at (x, y) from a normal force, um/nN.
    pub(super) fn more_normal(&self, x: f64, y: f64) -> f64 {
        let [.., normal] = self.interpolate(x.hypot(y) / self.thickness);
        normal
    }

    /// The cubic through the four nearest entries.
    fn interpolate(&self, distance: f64) -> [f64; 3] {
        let at = (distance / STEP).min((self.table.len() - 3) as f64);
        let first = (at as usize).max(1) - 1;
        let t = at - first as f64;
        let weights = [
            -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
            t * (t - 2.0) * (t - 3.0) / 2.0,
            -t * (t - 1.0) * (t - 3.0) / 2.0,
            t * (t - 1.0) * (t - 2.0) / 6.0,
        ];
        let entries = &self.table[first..first + 4];
        [0, 1, 2].map(|of: usize| weights.iter().zip(entries).map(|(w, entry)| w * entry[of]).sum())
    }
}

/// Bessel functions `J_0` and `J_2`.
fn bessel(x: f64) -> [f64; 2] {
    let zeroth = j0(x);
    // J_2(x) = 2 J_1(x) / x - J_0(x), near 0 x^2 / 8.
    let second = if x < 1e-4 { x * x / 8.0 } else { 2.0 * j1(x) / x - zeroth };
    [zeroth, second]
}
