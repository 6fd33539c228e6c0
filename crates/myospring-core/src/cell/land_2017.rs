//! Human myofilaments that feel length and speed: `land_2017`, driven by calcium.
//!
//! Calcium binds to troponin, troponin frees the thin filament, and crossbridges bind weakly, then strongly; two
//! distortions follow the rate of stretch. Tension is in kPa. What stands here takes calcium from whoever has
//! it: [`Myofilaments`] are the equations alone, and a cell model with calcium of its own adds their six states
//! to its own; [`Land2017`] is a cell model whose calcium is given.

mod model;
mod myofilaments;
mod parameters;

pub(in crate::cell) use model::IN_FITS;
pub use model::Land2017;
pub(in crate::cell) use myofilaments::NUMBERS;
pub use myofilaments::{Myofilaments, STATES, states};
pub use parameters::{parameters, rows};
