//! Tolerances of a path of equilibria.

/// Tolerances of a path; the [`Default`] is far more precise than measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Largest error of the interpolated positions, as a part of the body's largest extent; 1e-6.
    pub interpolation: f64,
    /// Largest last correction of Newton's method, as a part of the body's largest extent; 1e-9.
    pub equilibrium: f64,
    /// Smallest load step, as a part of the tension reached; 1e-4. The tension at which a path ends
    /// is found with this precision.
    pub smallest_step: f64,
    /// Largest accepted delay of the shape by damping, ms; 1. Up to this, a contraction counts as
    /// quasi-static.
    pub longest_delay: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { interpolation: 1e-6, equilibrium: 1e-9, smallest_step: 1e-4, longest_delay: 1.0 }
    }
}
