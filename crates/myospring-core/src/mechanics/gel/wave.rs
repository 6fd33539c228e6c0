//! Waves of traction on a layer of gel that is bonded to glass.
//!
//! Tractions with the wave vector **k** move its surface along **k** and across it by (the problem of `merkel_2007`), with
//! `s = k h`,
//!
//! ```text
//! u_L / t_L = (1 - nu) / (G k) [(3 - 4 nu) sinh s cosh s + s] / [(3 - 4 nu) cosh^2 s + s^2 + (1 - 2 nu)^2]
//! u_T / t_T = tanh s / (G k)
//! ```
//!
//! For long waves both are `h/G`, for short ones those of a half-space, `(1 - nu)/(G k)` and `1/(G k)`.

/// Displacement of the surface under tractions with a wave number, in units of `1/(G k)`, along and across the wave vector.
pub(super) fn compliance(poisson: f64, s: f64) -> [f64; 2] {
    let stiff = 3.0 - 4.0 * poisson;
    // Divided by cosh^2 s, so that nothing overflows.
    let (tanh, narrow) = (s.tanh(), s.cosh().powi(-2));
    let along =
        (stiff * tanh + s * narrow) / (stiff + (s * s + (1.0 - 2.0 * poisson).powi(2)) * narrow);
    [(1.0 - poisson) * along, tanh]
}
