//! The model of Myospring with few dependencies: a heart cell's mesh, its forces and its beat.
//!
//! It opens no files and builds for the web. The crate `myospring` re-exports it together with
//! pictures, figures and run files, and its documentation has the tour; depend on that crate unless
//! you need only this part.

pub mod analysis;
pub mod cell;
pub mod exchange;
pub mod integrate;
pub mod interruption;
pub mod mechanics;
pub mod mesh;
pub mod parameter;
pub mod recording;
pub mod references;
pub mod simulation;
#[cfg(any(test, feature = "testing"))]
pub mod testing;
pub mod units;
