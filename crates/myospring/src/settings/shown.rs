//! What shows a cell, and may show its fibres.

use crate::mesh::voxels::Voxels;
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::stack::{Stack, StackOptions, StackReport};

/// What shows the fibres of a cell.
#[derive(Debug, Clone, Copy)]
pub enum Shown<'a> {
    /// A picture with its cells, and the cell.
    Picture(&'a PictureCells, &'a PictureCell),
    /// A stack of slices.
    Stack(&'a StackCell),
}

/// A cell in a stack of slices.
#[derive(Debug, Clone)]
pub struct StackCell {
    /// The slices.
    pub stack: Stack,
    /// The cell.
    pub voxels: Voxels,
    /// How it was found.
    pub options: StackOptions,
    /// What is known of it.
    pub report: StackReport,
    /// The brightest of each place over all slices, and the cell in it; `None` if the outline lies beside them.
    pub seen: Option<(PictureCells, PictureCell)>,
}
