//! Outlines that a laboratory has drawn or mended elsewhere: read, written, and joined with masks.
//!
//! | format | made by | coordinates |
//! |---|---|---|
//! | `.roi`, RoiSet `.zip` | Fiji, ImageJ | pixels, y downward, whole numbers are pixel corners |
//! | GeoJSON | this program, QuPath, GIS programs | um, y upward; or pixels, y downward |
//! | `_outlines.txt` | Cellpose | whole numbers are pixels, those that the edge of the cell passes |
//! | label picture | Cellpose, StarDist, ilastik, Fiji | none: a picture like any other, see [`super::cells`] |
//!
//! [`read_outlines`] tells the format by the first bytes. Pixels become um by a [`PixelFrame`], which
//! puts the origin at the lower left corner of the picture and y upward, as masks have it: a mask and
//! its traced outline lie in the same place and give the same mesh.
//!
//! # Which coordinates a GeoJSON has
//! GeoJSON itself does not say. In this order:
//! 1. a property `unit` of the feature, or a member `unit` of the collection: `um`, or `pixel` (also
//!    `px`), the latter with y downward from the top left corner of the picture;
//! 2. a property `objectType`, which only QuPath writes: pixels;
//! 3. [`ReadOptions::silent_unit`], um unless the caller says otherwise.

mod cellpose;
mod error;
mod frame;
mod geojson;
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
    /// What a person should know: lines and points that were left out, a frame that was guessed.
    pub notes: Vec<String>,
}

impl GivenOutlines {
    /// Puts the largest first, as the cells of a picture are numbered.
    pub fn sort_by_area(&mut self) {
        self.outlines.sort_by(|a, b| b.outline.area().total_cmp(&a.outline.area()));
    }

    /// Place of the outline with this number, 1 being the first; `None` beyond the last.
    pub fn numbered(&self, number: u32) -> Option<usize> {
        (number as usize).checked_sub(1).filter(|&at| at < self.outlines.len())
    }

    /// Place of the outline whose name is this label; `None` when none has it.
    pub fn labelled(&self, label: u32) -> Option<usize> {
        self.outlines.iter().position(|cell| cell.name == label.to_string())
    }

    /// The first names in words, for messages.
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

/// Where coordinates in pixels lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Placement {
    /// In a picture of known size: the outlines must lie within it.
    Picture(PixelFrame),
    /// In a picture that is not at hand: the picture is taken to end where the outlines do, on the
    /// right and below, so that the lowest point has y = 0.
    Bounds {
        /// Side of a pixel.
        pixel_size: PixelSize,
    },
}

/// How to read outlines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadOptions {
    /// Where coordinates in pixels lie.
    pub placement: Placement,
    /// Unit of a GeoJSON that does not state one.
    pub silent_unit: CoordinateUnit,
}

/// A polygon as a file has it: the exterior, then the holes.
struct Raw {
    name: String,
    unit: CoordinateUnit,
    rings: Vec<Vec<[f64; 2]>>,
}

/// Reads a file of outlines in any of the formats above; `file_name` names what has no name of its
/// own and stands in errors.
///
/// Lines and points in a RoiSet or GeoJSON that also holds cells are left out with a note.
///
/// # Errors
/// Bytes of no known format, damaged or too large ones; kinds of ROI that enclose no area; an outline
/// that lies outside the picture, or that [`Outline::new`] refuses, with its name.
///
/// # Example
/// ```
/// use myospring::mesh::pixel_size::PixelSize;
/// use myospring::microscopy::outlines::{PixelFrame, Placement, ReadOptions, read_outlines};
/// let frame = PixelFrame::new(64, 48, PixelSize::new(0.5)?)?;
/// let options = ReadOptions { placement: Placement::Picture(frame), silent_unit: Default::default() };
/// let corners = br#"{"type": "Feature", "properties": {"unit": "pixel", "name": "left cell"},
///     "geometry": {"type": "Polygon", "coordinates": [[[2,8], [22,8], [22,18], [2,18], [2,8]]]}}"#;
/// let given = read_outlines(corners, "cells.geojson", &options)?;
/// assert_eq!(given.outlines[0].name, "left cell");
/// // Row 8 to 18 of 48 rows of half a micrometre is 15 to 20 um above the lower side.
/// assert_eq!(given.outlines[0].outline.bounds(), [[1.0, 15.0], [11.0, 20.0]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_outlines(
    bytes: &[u8],
    file_name: &str,
    options: &ReadOptions,
) -> Result<GivenOutlines, OutlineFileError> {
    let format = OutlineFormat::of(bytes).ok_or_else(|| OutlineFileError::unknown(bytes))?;
    read_outlines_as(format, bytes, file_name, options)
}

/// As [`read_outlines`], for bytes whose format is known.
///
/// # Errors
/// As [`read_outlines`].
///
/// # Example
/// ```
/// use myospring::mesh::pixel_size::PixelSize;
/// use myospring::microscopy::outlines::{
///     OutlineFormat, Placement, ReadOptions, read_outlines_as,
/// };
/// let placement = Placement::Bounds { pixel_size: PixelSize::new(1.0)? };
/// let options = ReadOptions { placement, silent_unit: Default::default() };
/// let error = read_outlines_as(OutlineFormat::ImageJRoi, b"12,30", "a.roi", &options).unwrap_err();
/// assert_eq!(error.to_string(), "a.roi is no ImageJ ROI: it does not start with `Iout`");
/// # Ok::<(), myospring::mesh::pixel_size::PixelSizeError>(())
/// ```
pub fn read_outlines_as(
    format: OutlineFormat,
    bytes: &[u8],
    file_name: &str,
    options: &ReadOptions,
) -> Result<GivenOutlines, OutlineFileError> {
    let mut notes = Vec::new();
    let raw = match format {
        OutlineFormat::ImageJRoi => roi::read(bytes, file_name)?,
        OutlineFormat::ImageJRoiSet => roi_set::read(bytes, &mut notes)?,
        OutlineFormat::GeoJson => geojson::read(bytes, options.silent_unit, &mut notes)?,
        OutlineFormat::CellposeText => cellpose::read(bytes)?,
    };
    if raw.is_empty() {
        return Err(OutlineFileError::Empty { notes });
    }
    check_counts(&raw)?;
    let frame = frame_of(&raw, options.placement, &mut notes)?;
    let outlines =
        raw.into_iter().map(|raw| place(raw, &frame, options)).collect::<Result<_, _>>()?;
    Ok(GivenOutlines { outlines, notes })
}

fn check_counts(raw: &[Raw]) -> Result<(), OutlineFileError> {
    let too_many = |what, found, bound| Err(OutlineFileError::TooMany { what, found, bound });
    if raw.len() > MOST_OUTLINES {
        return too_many("outlines", raw.len(), MOST_OUTLINES);
    }
    let mut all = 0;
    for Raw { rings, .. } in raw {
        let points: usize = rings.iter().map(Vec::len).sum();
        if points > MOST_POINTS {
            return too_many("points in one outline", points, MOST_POINTS);
        }
        if rings.len() > MOST_HOLES + 1 {
            return too_many("holes in one outline", rings.len() - 1, MOST_HOLES);
        }
        all += points;
    }
    if all > MOST_POINTS_IN_FILE {
        return too_many("points in all outlines", all, MOST_POINTS_IN_FILE);
    }
    Ok(())
}

/// The frame of the picture, or one that ends where the outlines do.
fn frame_of(
    raw: &[Raw],
    placement: Placement,
    notes: &mut Vec<String>,
) -> Result<PixelFrame, OutlineFileError> {
    let pixel_size = match placement {
        Placement::Picture(frame) => return Ok(frame),
        Placement::Bounds { pixel_size } => pixel_size,
    };
    let in_pixels = || raw.iter().filter(|raw| raw.unit == CoordinateUnit::Pixel);
    let side = |axis: usize| {
        let points = in_pixels().flat_map(|raw| raw.rings.iter().flatten());
        let largest = points.map(|point| point[axis]).filter(|x| x.is_finite()).fold(1.0, f64::max);
        largest.ceil() as usize
    };
    let frame = PixelFrame::new(side(0), side(1), pixel_size)?;
    if in_pixels().next().is_some() {
        notes.push(format!(
            "the size of the picture is not known: it was taken to end with the outlines, at {} x {} \
             pixels",
            frame.width(),
            frame.height()
        ));
    }
    Ok(frame)
}

/// A file's polygon in um.
fn place(
    mut raw: Raw,
    frame: &PixelFrame,
    options: &ReadOptions,
) -> Result<NamedOutline, OutlineFileError> {
    if matches!(options.placement, Placement::Picture(_)) {
        check_within(&raw, frame)?;
    }
    if raw.unit == CoordinateUnit::Pixel {
        ring::part_touching(&mut raw.rings, ring::CUT);
        for point in raw.rings.iter_mut().flatten() {
            *point = frame.to_um(*point);
        }
    } else {
        ring::part_touching(&mut raw.rings, ring::CUT * frame.pixel_size().um());
    }
    let mut rings = raw.rings.into_iter();
    let exterior = rings.next().unwrap_or_default();
    match Outline::new(exterior, rings.collect()) {
        Ok(outline) => Ok(NamedOutline { name: raw.name, outline }),
        Err(error) => Err(OutlineFileError::Outline { name: raw.name, error }),
    }
}

/// Coordinates may leave the picture by a pixel, which is drawing and rounding; more than that is
/// another picture or another unit.
fn check_within(raw: &Raw, frame: &PixelFrame) -> Result<(), OutlineFileError> {
    const SLACK: f64 = 1.0;
    let within = |[x, y]: [f64; 2]| {
        (-SLACK..=frame.width() as f64 + SLACK).contains(&x)
            && (-SLACK..=frame.height() as f64 + SLACK).contains(&y)
    };
    let in_pixels = |&point: &[f64; 2]| match raw.unit {
        CoordinateUnit::Pixel => point,
        CoordinateUnit::Micrometre => frame.to_pixels(point),
    };
    let outside = raw
        .rings
        .iter()
        .flatten()
        .map(in_pixels)
        .find(|&point| point.iter().all(|value| value.is_finite()) && !within(point));
    match outside {
        None => Ok(()),
        Some([x, y]) => Err(OutlineFileError::Outside {
            name: raw.name.clone(),
            x: (x * 100.0).round() / 100.0,
            y: (y * 100.0).round() / 100.0,
            width: frame.width(),
            height: frame.height(),
        }),
    }
}
