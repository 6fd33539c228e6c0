//! Human myofilaments that depend on length and speed: `land_2017`, driven by calcium.
//!
//! Calcium binds to troponin, troponin frees the thin filament, and crossbridges bind weakly, then
//! strongly; two distortions follow the rate of stretch. Tension is in kPa. [`Myofilaments`] are
//! the equations alone: a cell model with its own calcium adds their six states to its own.
//! [`Land2017`] is a cell model with prescribed calcium.

mod model;
mod myofilaments;
mod parameters;

pub(in crate::cell) use model::IN_FITS;
pub use model::Land2017;
pub(in crate::cell) use myofilaments::NUMBERS;
pub use myofilaments::{Myofilaments, STATES, states};
pub use parameters::{parameters, rows};
