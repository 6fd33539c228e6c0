//! Conformance suites for cell models and forces written by others.
//!
//! Each suite is one function that panics with a sentence on the first thing that is wrong; call it
//! from a test.

pub mod cell_model;
pub mod force;
