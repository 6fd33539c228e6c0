//! Integrators: how the masses move from one time to the next.

pub mod verlet;
