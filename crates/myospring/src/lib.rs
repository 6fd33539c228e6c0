//! Myospring: from a microscope picture of a heart cell to its beat.

pub mod analysis;
pub mod cell;
pub mod integrate;
pub mod mechanics;
pub mod mesh;
#[cfg(feature = "microscopy")]
pub mod microscopy;
#[cfg(feature = "output")]
pub mod output;
pub mod parameter;
pub mod recording;
#[cfg(feature = "run-file")]
pub mod run_file;
pub mod simulation;
#[cfg(any(test, feature = "testing"))]
pub mod testing;
pub mod units;
