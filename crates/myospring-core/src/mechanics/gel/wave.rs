//! Waves of traction on a layer of gel that is bonded to glass.
//!
//! Tractions with the wave vector **k** move its surface along **k** and across it by (the problem of `merkel_2007`), with
//! `s = k h`,
//!
//! ```text
//! u_L / t_L = (1 - nu) / (G k) [(3 - 4 nu) sinh s cosh s + s] / [(3 - 4 nu) cosh^2 s + s^2 + (1 - 2 nu)^2]
//! u_T / t_T = tanh s / (G k)
//! u_N / t_N = (1 - nu) / (G k) [(3 - 4 nu) sinh s cosh s - s] / [(3 - 4 nu) cosh^2 s + s^2 + (1 - 2 nu)^2]
//! ```
//!
//! The last is that of pressure, normal to the surface. For long waves the first two are `h/G` and the last `h (1 - 2 nu)/(2 G (1 - nu))`,
//! a layer that cannot bulge; for short ones those of a half-space, `(1 - nu)/(G k)`, `1/(G k)` and `(1 - nu)/(G k)`. Pressure also
//! moves the surface along, and traction along it up and down, by a part `(1 - 2 nu)` of these, which is left out: nothing of
//! an incompressible gel.

/// Displacement of the surface under tractions with a wave number, in units of `1/(G k)`: along and across the wave vector, and
/// normal to the surface.
pub(super) fn compliance(poisson: f64, s: f64) -> [f64; 3] {
    let stiff = 3.0 - 4.0 * poisson;
    // Divided by cosh^2 s, so that nothing overflows.
    let (tanh, narrow) = (s.tanh(), s.cosh().powi(-2));
    let whole = stiff + (s * s + (1.0 - 2.0 * poisson).powi(2)) * narrow;
    let along = (stiff * tanh + s * narrow) / whole;
    let normal = (stiff * tanh - s * narrow) / whole;
    [(1.0 - poisson) * along, tanh, (1.0 - poisson) * normal]
}
