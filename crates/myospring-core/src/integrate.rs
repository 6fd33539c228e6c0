//! Integrators: they move the masses from one time to the next, or from one tension to the next.

pub mod engine;
pub mod fused;
pub mod quasi_static;
pub mod stencil;
pub mod stepper;
pub mod verlet;

use serde::Serialize;
use verlet::Integrator;

/// How the shape follows the tension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// In time, by a form of Verlet's method, as in `coelho_2021`.
    Verlet(Integrator),
    /// Along its path of equilibria, independent of time ([`quasi_static`]).
    QuasiStatic,
}

impl Method {
    /// Whether the masses move in time, step by step; otherwise time steps, engines and inertia
    /// have no effect.
    pub fn is_in_time(self) -> bool {
        matches!(self, Self::Verlet(_))
    }

    /// The form of Verlet's method for a motion in time; for the path of equilibria, that of the
    /// paper.
    pub fn in_time(self) -> Integrator {
        match self {
            Self::Verlet(form) => form,
            Self::QuasiStatic => Integrator::StoermerVerlet,
        }
    }
}
