//! Displacement of the gel's surface by a force on a square of it.
//!
//! A force `P` along x at a point of an elastic half-space moves the surface at (x, y) by (Cerruti; `landau_lifshitz_1986`,
//! section 8, without the normal displacement)
//!
//! ```text
//! u_x = P (1 + nu) / (pi E r) [(1 - nu) + nu x^2 / r^2]        u_y = P (1 + nu) nu x y / (pi E r^3)
//! ```
//!
//! Spread evenly over a square, it is the integral of that, which has a closed form: sums over the corners of
//!
//! ```text
//! 1/r:      x ln(y + r) + y ln(x + r)        x^2/r^3:  y ln(x + r)        x y/r^3:  -r
//! ```
//!
//! A layer that is bonded to glass adds a smooth part ([`Layer`]).

use super::description::Gel;
use super::layer::Layer;

/// Points of Gauss's rule over an edge, with their weights, of an edge from -1/2 to 1/2.
const GAUSS: [[f64; 2]; 3] = [
    [-0.387_298_334_620_741_7, 5.0 / 18.0],
    [0.0, 8.0 / 18.0],
    [0.387_298_334_620_741_7, 5.0 / 18.0],
];

/// The displacements by forces on squares of one side.
pub(super) struct Green {
    gel: Gel,
    side: f64,
    layer: Option<Layer>,
}

impl Green {
    /// For squares of this side, um, on a layer that is not thinner.
    pub(super) fn new(gel: Gel, side: f64) -> Self {
        Self { gel, side, layer: gel.thickness.map(|thickness| Layer::new(gel, thickness)) }
    }

    /// Normal displacement at (x, y) from the centre of a square, um per nN normal to the square (Boussinesq):
    /// `P (1 - nu^2) / (pi E r)` spread over it.
    ///
    /// Both coordinates are whole multiples of its side.
    pub(super) fn normal_at(&self, x: f64, y: f64) -> f64 {
        let Gel { modulus, poisson, .. } = self.gel;
        if self.layer.as_ref().is_some_and(|layer| x.hypot(y) > layer.reach()) {
            return 0.0;
        }
        let half = 0.5 * self.side;
        let mut inverse = 0.0;
        for (p, q, sign) in
            [(1.0, 1.0, 1.0), (-1.0, 1.0, -1.0), (1.0, -1.0, -1.0), (-1.0, -1.0, 1.0)]
        {
            let (x, y) = (x + p * half, y + q * half);
            let r = x.hypot(y);
            inverse += sign * (y * log_sum(x, y, r) + x * log_sum(y, x, r));
        }
        let scale = (1.0 - poisson * poisson) / (std::f64::consts::PI * modulus);
        let mut moved = scale / self.side.powi(2) * inverse;
        let Some(layer) = &self.layer else { return moved };
        for [p, across] in GAUSS {
            for [q, along] in GAUSS {
                moved += across * along * layer.more_normal(x + p * self.side, y + q * self.side);
            }
        }
        moved
    }

    /// Displacements `[xx, xy, yy]` at (x, y) from the centre of a square, um per nN on the square.
    ///
    /// Both coordinates are whole multiples of its side.
    pub(super) fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let Gel { modulus, poisson, .. } = self.gel;
        if self.layer.as_ref().is_some_and(|layer| x.hypot(y) > layer.reach()) {
            return [0.0; 3];
        }
        let half = 0.5 * self.side;
        let (mut inverse, mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0, 0.0);
        for (p, q, sign) in
            [(1.0, 1.0, 1.0), (-1.0, 1.0, -1.0), (1.0, -1.0, -1.0), (-1.0, -1.0, 1.0)]
        {
            let (x, y) = (x + p * half, y + q * half);
            let r = x.hypot(y);
            let (along_x, along_y) = (sign * y * log_sum(x, y, r), sign * x * log_sum(y, x, r));
            inverse += along_x + along_y;
            xx += along_x;
            yy += along_y;
            xy -= sign * r;
        }
        // u = (1 + nu) / (pi E) [(1 - nu) int 1/r + nu int x x / r^3] / side^2
        let scale = (1.0 + poisson) / (std::f64::consts::PI * modulus * self.side.powi(2));
        let mut moved = [
            scale * ((1.0 - poisson) * inverse + poisson * xx),
            scale * poisson * xy,
            scale * ((1.0 - poisson) * inverse + poisson * yy),
        ];
        let Some(layer) = &self.layer else { return moved };
        for [p, across] in GAUSS {
            for [q, along] in GAUSS {
                let more = layer.more(x + p * self.side, y + q * self.side);
                for (moved, more) in moved.iter_mut().zip(more) {
                    *moved += across * along * more;
                }
            }
        }
        moved
    }
}

/// `ln(x + r)` with `r^2 = x^2 + y^2`, also where `x` is near `-r`.
fn log_sum(x: f64, y: f64, r: f64) -> f64 {
    if x >= 0.0 { (x + r).ln() } else { (y * y / (r - x)).ln() }
}
