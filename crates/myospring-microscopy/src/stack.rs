//! Stacks in depth: many planes of one cell, to the voxels that belong to it.
//!
//! A stack is a TIFF of many pages (OME-TIFF, ImageJ's, plain) or a list of pictures, one for each
//! slice. Slices run along z, the first at the bottom unless stated otherwise. [`Stack::cell`] gives
//! the [`Voxels`](myospring_core::mesh::voxels::Voxels) of one cell and a [`StackReport`]; [`Stack::fibres`] reads the direction of the
//! myofibrils in each slice.
//!
//! - **Masks and labels** are used voxel by voxel as they are.
//! - **Fluorescence**, in this order:
//!   1. The stack is smoothed with a Gaussian, 0.5 um wide in all three directions.
//!   2. The cell's outline from above is found in the largest brightness over all slices, as in a
//!      picture ([`segment()`](super::segment::segment)). This also chooses among several cells.
//!   3. Each slice has its own background, the median around the cell. If the brightness of a filled
//!      cell falls (or rises) steadily with depth, an exponential is divided out.
//!   4. A voxel is inside if it has more than half of the largest brightness within 3 um above and
//!      below it, averaged over 4 um in the plane. Between two slices brightness is interpolated
//!      linearly, so the surface is not bound to slices.
//!   5. Gaps narrower than 3 um are closed; holes are filled in each slice and in space; parts that
//!      are not connected by faces are dropped.
//!   6. The half of a thin bright layer's brightness lies outside of it: if only the membrane is
//!      bright, the surface is moved inward to the brightest layer.
//!
//! Accuracy, on made-up cells 6 to 12 um thick (ellipsoid, dome, slab, tilted ellipsoid) with slices
//! 0.25 to 2 um apart, noise up to 0.6 of the cell's brightness, blur of standard deviation up to
//! 1.2 um along z, and brightness that falls to 1/e over 8 um: the volume of a filled cell, and of a
//! cell with a bright membrane and slices up to 1 um apart in little noise, is within 12 %; thickness
//! is within half a step plus 0.25 um. Real cells have softer edges.
//!
//! What the microscope blurs in z is not undone: half of the brightness is the right place for the
//! surface of a cell that is thicker than the blur, not for a thinner one. The report says how wide
//! the edges are.

mod above;
mod bright;
mod cell;
mod depth;
mod distance;
mod error;
mod fibres;
mod labels;
mod load;
mod options;
mod reading;
mod report;
mod shape;
mod surface;
mod volume;

pub use error::{FEWEST_SLICES, MOST_VOXELS, StackError};
pub use fibres::{HelixAngle, SliceFibre, StackFibres};
pub use options::{FirstSlice, StackOptions, StackSelection, Stain};
pub use reading::{Scale, Stack};
pub use report::{Blur, StackReport};
