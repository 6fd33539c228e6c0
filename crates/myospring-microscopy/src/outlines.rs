//! Outlines drawn or corrected in other programs: reading, writing, conversion to and from masks.
//!
//! | format | made by | coordinates |
//! |---|---|---|
//! | `.roi`, RoiSet `.zip` | Fiji, ImageJ | pixels, y downward, whole numbers are pixel corners |
//! | GeoJSON | this program, QuPath, GIS programs | um, y upward; or pixels, y downward |
//! | `_outlines.txt` | Cellpose | whole numbers are pixels, those on the edge of the cell |
//! | label picture | Cellpose, StarDist, ilastik, Fiji | none: a picture like any other, see [`super::cells`] |
//!
//! [`read_outlines`] recognises the format by the first bytes. A [`PixelFrame`] converts pixels to
//! um, with the origin at the lower left corner of the picture and y upward, as in masks: a mask
//! and its traced outline lie in the same place and give the same mesh.
//!
//! # Which coordinates a GeoJSON has
//! GeoJSON itself does not say. In this order:
//! 1. a property `unit` of the feature, or a member `unit` of the collection: `um`, or `pixel` (also
//!    `px`), the latter with y downward from the top left corner of the picture;
//! 2. a property `objectType`, which only QuPath writes: pixels;
//! 3. [`ReadOptions::silent_unit`], um by default.

mod cellpose;
mod error;
mod frame;
mod geojson;
mod reading;
mod ring;
mod roi;
mod roi_set;
mod roi_write;
mod smooth;

pub mod raster;
pub mod trace;

use myospring_core::mesh::outline::Outline;
use myospring_core::mesh::pixel_size::PixelSize;

pub use cellpose::write_cellpose;
pub use error::{OutlineFileError, OutlineWriteError};
pub use frame::{FrameError, PixelFrame};
pub use geojson::write_geojson;
pub use reading::{read_outlines, read_outlines_as};
pub use roi_set::write_roi_set;
pub use roi_write::write_roi;

/// Most points that one outline may have.
pub const MOST_POINTS: usize = 100_000;

/// Most holes that one outline may have.
pub const MOST_HOLES: usize = 2_000;

/// Most outlines that one file may hold.
pub const MOST_OUTLINES: usize = 10_000;

/// Most points that all outlines of a file may have together.
pub const MOST_POINTS_IN_FILE: usize = 2_000_000;

/// An outline with the name that it has in its file.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedOutline {
    /// Name: that of the ROI, of the GeoJSON feature, the label, or a number counted from 1.
    pub name: String,
    /// The outline, um, y upward.
    pub outline: Outline,
}

/// What a file of outlines holds.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenOutlines {
    /// The outlines in the order of the file; at least one.
    pub outlines: Vec<NamedOutline>,
    /// Warnings: lines and points that were left out, a frame that was guessed.
    pub notes: Vec<String>,
}

impl GivenOutlines {
    /// Sorts the outlines by area, largest first, in the order of a picture's cell numbers.
    pub fn sort_by_area(&mut self) {
        self.outlines.sort_by(|a, b| b.outline.area().total_cmp(&a.outline.area()));
    }

    /// Index of the outline with this number, counted from 1; `None` beyond the last.
    pub fn numbered(&self, number: u32) -> Option<usize> {
        (number as usize).checked_sub(1).filter(|&at| at < self.outlines.len())
    }

    /// Index of the outline whose name is this label; `None` if there is none.
    pub fn labelled(&self, label: u32) -> Option<usize> {
        self.outlines.iter().position(|cell| cell.name == label.to_string())
    }

    /// The first names as a list for messages.
    pub fn names(&self) -> String {
        const SHOWN: usize = 12;
        let names = self.outlines.iter().take(SHOWN).map(|cell| format!("`{}`", cell.name));
        let more = if self.outlines.len() > SHOWN { ", ..." } else { "" };
        format!("{}{more}", names.collect::<Vec<_>>().join(", "))
    }
}

/// Formats of outline files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutlineFormat {
    /// One ImageJ ROI.
    ImageJRoi,
    /// A zip of ImageJ ROIs.
    ImageJRoiSet,
    /// GeoJSON in um or pixels.
    GeoJson,
    /// Cellpose's list of points, one cell a line.
    CellposeText,
}

impl OutlineFormat {
    /// The format, by the first bytes: `Iout` is a ROI, `PK` a zip, `{` or `[` GeoJSON, digits are
    /// Cellpose's; `None` for anything else.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::outlines::OutlineFormat;
    /// assert_eq!(OutlineFormat::of(b"Iout\0\xe4"), Some(OutlineFormat::ImageJRoi));
    /// assert_eq!(OutlineFormat::of(b"12,30,13,30"), Some(OutlineFormat::CellposeText));
    /// assert_eq!(OutlineFormat::of(b"\x89PNG"), None);
    /// ```
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        match text {
            _ if bytes.starts_with(b"Iout") => Some(Self::ImageJRoi),
            _ if bytes.starts_with(b"PK") => Some(Self::ImageJRoiSet),
            [b'{' | b'[', ..] => Some(Self::GeoJson),
            [b'0'..=b'9', ..] => Some(Self::CellposeText),
            _ => None,
        }
    }
}

/// Unit and direction of a file's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CoordinateUnit {
    /// Micrometres, y upward.
    #[default]
    Micrometre,
    /// Pixels, y downward from the top left corner of the picture.
    Pixel,
}

/// How coordinates in pixels are placed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Placement {
    /// In a picture of known size: the outlines must lie within it.
    Picture(PixelFrame),
    /// In an unknown picture: it is assumed to end with the outlines on the right and below, so
    /// that the lowest point has y = 0.
    Bounds {
        /// Side of a pixel.
        pixel_size: PixelSize,
    },
}

/// How to read outlines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadOptions {
    /// How coordinates in pixels are placed.
    pub placement: Placement,
    /// Unit of a GeoJSON that does not state one.
    pub silent_unit: CoordinateUnit,
}

/// A polygon in the file's coordinates: the exterior, then the holes.
struct Raw {
    name: String,
    unit: CoordinateUnit,
    rings: Vec<Vec<[f64; 2]>>,
}
