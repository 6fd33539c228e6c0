//! Why there is no map.

use crate::integrate::quasi_static::PathError;

/// Why there is no map of tension.
#[derive(Debug, thiserror::Error)]
pub enum TensionMapError {
    /// Displacements of another mesh.
    #[error("there are displacements of {found} points, and the cell's mesh has {points}")]
    Mesh {
        /// Of how many points.
        found: usize,
        /// Points of the mesh.
        points: usize,
    },
    /// Too few points were found.
    #[error(
        "points were found in {squares} squares of {alike_um:.1} um of the cell; a map needs {least} or more"
    )]
    TooLittle {
        /// Squares with points.
        squares: usize,
        /// Their side.
        alike_um: f64,
        /// Least number of them.
        least: usize,
    },
    /// The cell does not contract.
    #[error(
        "the cell does not contract along its fibres (uniform tension {tension_kpa:.3} kPa), so there is nothing to \
        map"
    )]
    NoContraction {
        /// The uniform tension that fits best, kPa.
        tension_kpa: f64,
    },
    /// Tension at the ends.
    #[error(
        "the tension of this cell acts at its ends, not in each place; a map needs `active_law = \"fibre\"`"
    )]
    Ends,
    /// No equilibrium.
    #[error("there is no equilibrium to compare the film with: {0}")]
    Path(#[from] PathError),
}
