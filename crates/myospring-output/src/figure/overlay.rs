//! A picture overlaid with outline, lattice, fibres and sarcomeres.

mod histogram;
mod layout;
mod panel;

pub(super) use layout::draw_lines_legend;
pub use layout::overlay;
pub(super) use panel::{Panel, View};

use super::theme::Colour;
use myospring_core::mesh::Mesh;
use myospring_core::mesh::pixel_size::PixelSize;

/// Line of the chosen cell (Okabe-Ito yellow), readable on black and on grey.
pub(super) const CHOSEN: Colour = Colour(0xf0e442);
/// Lines of other cells (Okabe-Ito reddish purple).
const OTHER: Colour = Colour(0xcc79a7);
/// Fibres that the picture shows (Okabe-Ito sky blue).
const FIBRE: Colour = Colour(0x56b4e9);
/// Fibres that the picture does not show.
const STAND_IN: Colour = Colour(0xe6e6e6);

/// A cell of the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Contour<'a> {
    /// Its number or name.
    pub name: &'a str,
    /// Outline and holes, um from the lower left corner of the picture, y upward; rings are closed
    /// implicitly.
    pub rings: Vec<&'a [[f64; 2]]>,
    /// Whether it is the chosen cell; others are drawn muted, with their names.
    pub chosen: bool,
}

/// The fibre at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tick {
    /// The point, um from the lower left corner of the picture, y upward.
    pub point_um: [f64; 2],
    /// Unit vector along the fibre, y upward.
    pub direction: [f64; 2],
    /// How certain the picture is of it, 0 to 1.
    pub coherency: f64,
    /// Whether it comes from the picture; otherwise it is assumed, along the long axis or as set.
    pub from_picture: bool,
}

/// Lengths of sarcomeres that were read from a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sarcomeres<'a> {
    /// One length for each triangle of the lattice in which it was read, um.
    pub lengths_um: &'a [f64],
    /// Their median over the cell, um.
    pub median_um: f64,
    /// Part of the cell whose fibres were read, per cent.
    pub read_pct: f64,
}

/// What chosen outlines of cells are called.
pub const CELL: [&str; 2] = ["chosen cell", "chosen cells"];

/// A picture and its overlays.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay<'a> {
    /// Line above the figure, such as the name of the file; may be empty.
    pub title: &'a str,
    /// Columns of the picture.
    pub width: usize,
    /// Rows of the picture.
    pub height: usize,
    /// Grey values row by row from the top left.
    pub values: &'a [f32],
    /// Side of one pixel.
    pub pixel_size: PixelSize,
    /// The cells; may be empty.
    pub cells: &'a [Contour<'a>],
    /// What one chosen outline is called, and what several are: [`CELL`] for cells.
    pub chosen: [&'a str; 2],
    /// The lattice of the chosen cell, if there is one.
    pub mesh: Option<&'a Mesh>,
    /// Fibres at many points of the chosen cell, about 1 um apart; as many are drawn as can be
    /// distinguished. May be empty.
    pub fibres: &'a [Tick],
    /// Lengths of sarcomeres, drawn as a histogram below the picture.
    pub sarcomeres: Option<Sarcomeres<'a>>,
    /// Warnings, one sentence each.
    pub warnings: &'a [String],
}
