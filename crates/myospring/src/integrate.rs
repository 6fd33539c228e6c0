//! Integrators: how the masses move from one time to the next, or from one tension to the next.

pub mod quasi_static;
pub mod verlet;
