//! Why bytes are not a picture, or do not contain the requested plane.

use super::limits::{LONGEST_SIDE, MOST_PIXELS};

/// Why bytes are not a picture, or do not contain the requested plane.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PictureError {
    /// The bytes are not a picture.
    #[error(
        "this is not a picture ({bytes} bytes that start with {start}); give a PNG or TIFF file"
    )]
    NotAPicture {
        /// Size of the file, bytes.
        bytes: usize,
        /// Its first bytes.
        start: String,
    },
    /// A picture in an unsupported format.
    #[error(
        "this is a {format} picture, which cannot be read; save the original as PNG or TIFF without lossy \
         compression (lossy compression creates false edges, which remain when the picture is saved again)"
    )]
    Format {
        /// What it is.
        format: &'static str,
    },
    /// A microscope's own file format.
    #[error(
        "this is a {format} file, which cannot be read; export it as OME-TIFF (from the \
         microscope's program, or Fiji: Plugins > Bio-Formats > Bio-Formats Exporter)"
    )]
    Container {
        /// What it is.
        format: &'static str,
    },
    /// A surface in space.
    #[error(
        "this is a surface ({format}), which is not taken as it is; write which voxels are inside of it as a mask stack, for \
         --stack (in Python: trimesh.load(file).voxelized(0.25).fill())"
    )]
    Surface {
        /// What it is.
        format: &'static str,
    },
    /// A mesh of tetrahedra.
    #[error(
        "this is a {format} mesh, which is not taken as it is: a cell that keeps its volume bends too stiffly as \
         tetrahedra; write which voxels are inside of it as a mask stack, for --stack (examples/mesh_to_stack.py does)"
    )]
    Mesh {
        /// What it is.
        format: &'static str,
    },
    /// A PNG or TIFF that is damaged.
    #[error("the {format} picture cannot be read: {reason}; is the file complete?")]
    Unreadable {
        /// PNG or TIFF.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// Pixels of an unsupported type.
    #[error(
        "the {format} picture has pixels of a type that cannot be read ({reason}); save it with 8 or 16 \
         bits per pixel"
    )]
    Pixels {
        /// PNG or TIFF.
        format: &'static str,
        /// Which type.
        reason: String,
    },
    /// An unsupported compression.
    #[error(
        "the TIFF picture is compressed with {method}, which cannot be read; save it without \
         compression, or with LZW or deflate"
    )]
    Compression {
        /// Its name, or its number in the file.
        method: String,
    },
    /// The header declares more pixels than a picture may have.
    #[error(
        "the picture declares {width} x {height} pixels; at most {LONGEST_SIDE} per side and \
         {MOST_PIXELS} in all are read: cut out the cell"
    )]
    TooLarge {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Decoding would take too much memory or time.
    #[error("reading this picture would take {what}, and at most {most}; {mend}")]
    TooMuch {
        /// How much of what.
        what: String,
        /// The bound.
        most: String,
        /// What to do.
        mend: &'static str,
    },
    /// The picture has fewer channels, frames or slices.
    #[error("{what} {asked} was asked for, but the picture has {}", numbered(what, *count))]
    OutOfRange {
        /// `channel`, `frame` or `slice`.
        what: &'static str,
        /// What was asked for.
        asked: usize,
        /// How many there are.
        count: usize,
    },
    /// The file declares a plane but contains no page for it.
    #[error(
        "the file declares channel {channel}, frame {frame}, slice {slice}, but none of its {pages} \
         pages contains them; was the recording cut off? save it again from Fiji"
    )]
    MissingPlane {
        /// Channel.
        channel: usize,
        /// Frame.
        frame: usize,
        /// Slice.
        slice: usize,
        /// Pages in the file.
        pages: usize,
    },
    /// The plane is in another file of a set.
    #[error(
        "the plane that was asked for is in another file of the set, `{file}`; give that file, or \
         export all as one OME-TIFF"
    )]
    Elsewhere {
        /// Its name in the set.
        file: String,
    },
    /// The slices of a stack differ.
    #[error("the pages of one stack differ: {expected} and {found}; choose one slice")]
    PagesDiffer {
        /// The first page.
        expected: String,
        /// Another.
        found: String,
    },
    /// Infinite or NaN pixels.
    #[error(
        "{count} pixels are infinite or not a number, the first at column {column}, row {row}; give \
         them a value (Fiji: Process > Filters > Remove NaNs)"
    )]
    NotFinite {
        /// How many, over all slices.
        count: u64,
        /// Column of the first, from 0.
        column: usize,
        /// Row of the first, from 0 at the top.
        row: usize,
    },
    /// Pixels that are not square.
    #[error(
        "the pixels are {x_um} um wide and {y_um} um high, but the mesh needs square ones: resample the \
         picture (Fiji: Image > Scale)"
    )]
    NotSquare {
        /// Width of a pixel, um.
        x_um: f64,
        /// Height of a pixel, um.
        y_um: f64,
    },
}

fn numbered(what: &str, count: usize) -> String {
    match count {
        1 => format!("only {what} 0"),
        count => format!("{count} {what}s, 0 to {}", count.saturating_sub(1)),
    }
}

/// The error for a damaged TIFF.
pub(super) fn damaged_tiff(reason: impl Into<String>) -> PictureError {
    PictureError::Unreadable { format: "TIFF", reason: reason.into() }
}
