//! What to take from a stack, and how.

use crate::segment::{Choice, SegmentationSettings};
use myospring_core::mesh::pixel_size::PixelSize;
use serde::Serialize;

/// Which planes of a file are the slices of a stack. Channels and time points count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StackSelection {
    /// Channel; `None` needs a file that has only one.
    pub channel: Option<usize>,
    /// Time point; `None` needs a file that has only one.
    pub frame: Option<usize>,
}

/// What of the cell is bright.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stain {
    /// Determined from the brightness at the surface and inside.
    #[default]
    Auto,
    /// The inside: cytosol, calcium dye, myofibrils.
    Filled,
    /// The membrane alone.
    Membrane,
}

/// Where the first slice of the file lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FirstSlice {
    /// At the bottom, where the cell stands on its support.
    #[default]
    Bottom,
    /// At the top.
    Top,
}

/// How to find a cell in a stack.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StackOptions {
    /// Side of one pixel; `None` uses the file's own.
    pub pixel_size: Option<PixelSize>,
    /// Distance of two slices, um; `None` uses the file's own.
    ///
    /// Files state the steps of the stage. If the lens is in air and the cell in water, the focus
    /// moves about 1.35 times as far; the true distance must then be given.
    pub z_step_um: Option<f64>,
    /// Modality, threshold (grey value, background included), smoothing and smallest area. The area is
    /// that seen from above.
    pub segmentation: SegmentationSettings,
    /// Which cell; [`Choice::At`] is a place in the picture.
    pub choice: Choice,
    /// Whether a cell that the sides of the picture cut is accepted. One that is cut at the first or
    /// last slice is accepted with a warning.
    pub allow_cut: bool,
    /// What of the cell is bright.
    pub stain: Stain,
    /// Where the first slice of the file lies.
    pub first_slice: FirstSlice,
}
