//! The model of Myospring, on a handful of dependencies: a heart cell's mesh, its forces and its beat.
//!
//! It opens no file and builds for the web. `myospring` passes all of it on, beside pictures, figures and
//! run files, and its documentation has the tour; depend on that crate unless you want this part alone.

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
