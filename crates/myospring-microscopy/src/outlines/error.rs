//! What can be wrong with a file of outlines.

use super::FrameError;
use myospring_core::mesh::outline::OutlineError;
use myospring_core::mesh::pixel_size::PixelSize;

/// Why bytes are not usable outlines.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OutlineFileError {
    /// Bytes of no known format.
    #[error(
        "this is not a file of outlines ({bytes} bytes that start with {start}); give an ImageJ .roi or \
         RoiSet .zip, GeoJSON, or Cellpose's _outlines.txt"
    )]
    Unknown {
        /// Size of the file, bytes.
        bytes: usize,
        /// Its first bytes.
        start: String,
    },
    /// The picture of the outlines is impossible.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// Bytes that are not a ROI.
    #[error("{name} is no ImageJ ROI: it does not start with `Iout`")]
    NotARoi {
        /// The file, or the entry of the zip.
        name: String,
    },
    /// A file whose name ends like one of ImageJ's, but whose content is different.
    #[error(
        "{name} is damaged, or not a valid {kind}: its first bytes differ; save it again in Fiji"
    )]
    NotOfImageJ {
        /// The file.
        name: String,
        /// What its name says.
        kind: &'static str,
    },
    /// A ROI whose bytes end too early.
    #[error(
        "{name} is cut off: {needed} bytes are needed, {found} are there; save it again in Fiji"
    )]
    Truncated {
        /// The file, or the entry of the zip.
        name: String,
        /// Bytes needed.
        needed: usize,
        /// Bytes there.
        found: usize,
    },
    /// A ROI that is not a closed outline.
    #[error("{name} is an ImageJ {kind} ROI, which is not the outline of a cell; {mend}")]
    RoiKind {
        /// The file, or the entry of the zip.
        name: String,
        /// ImageJ's name of the kind.
        kind: String,
        /// What to do.
        mend: &'static str,
    },
    /// A ROI whose numbers make no sense.
    #[error("{name} is damaged: {reason}; save it again in Fiji")]
    DamagedRoi {
        /// The file, or the entry of the zip.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// A zip that cannot be read.
    #[error("the RoiSet zip cannot be read: {reason}; is the file complete?")]
    Zip {
        /// What is wrong.
        reason: String,
    },
    /// Too many outlines, points or holes.
    #[error(
        "the file has {found} {what}; at most {bound} are read: simplify it, or split the file"
    )]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many.
        found: usize,
        /// How many are allowed.
        bound: usize,
    },
    /// A zip entry that unpacks to too many bytes.
    #[error("{name} unpacks to more than {bound} bytes, which no ROI needs; is this a RoiSet?")]
    TooLarge {
        /// The entry of the zip, or the zip.
        name: String,
        /// How many bytes are allowed.
        bound: u64,
    },
    /// Text that is not GeoJSON.
    #[error("the outlines are not GeoJSON: {reason}")]
    NotGeoJson {
        /// What the parser says.
        reason: String,
    },
    /// An unknown unit.
    #[error(
        "outline `{name}` has the property `unit` \"{unit}\"; give \"um\" (y upward from the lower \
         left corner of the picture) or \"pixel\" (y downward from the top left corner)"
    )]
    Unit {
        /// Name of the outline.
        name: String,
        /// What it says.
        unit: String,
    },
    /// A line of the list of points cannot be read.
    #[error(
        "line {line} of the list of outlines has {problem}; each line must be x1,y1,x2,y2,... in \
         pixels"
    )]
    PointList {
        /// Line number, 1 is the first.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// No outline at all.
    #[error("the file holds no outline of a cell{}", listed(notes))]
    Empty {
        /// What was left out.
        notes: Vec<String>,
    },
    /// An outline off the picture.
    #[error(
        "outline `{name}` reaches ({x}, {y}) pixels, outside the picture of {width} x {height} pixels: \
         is it from this picture, and are its coordinates in the unit that the file or option says?"
    )]
    Outside {
        /// Name of the outline.
        name: String,
        /// x of the first point outside, pixels.
        x: f64,
        /// y of the first point outside, pixels.
        y: f64,
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
    },
    /// A polygon that is not a valid outline.
    #[error("outline `{name}`: {error}")]
    Outline {
        /// Name of the outline.
        name: String,
        /// What is wrong.
        error: OutlineError,
    },
}

fn listed(notes: &[String]) -> String {
    const SHOWN: usize = 4;
    match notes {
        [] => String::new(),
        notes if notes.len() <= SHOWN => format!(": {}", notes.join("; ")),
        notes => format!(": {}; and {} more", notes[..SHOWN].join("; "), notes.len() - SHOWN),
    }
}

impl OutlineFileError {
    pub(super) fn unknown(bytes: &[u8]) -> Self {
        let start = format!("{:?}", String::from_utf8_lossy(&bytes[..bytes.len().min(8)]));
        Self::Unknown { bytes: bytes.len(), start }
    }
}

/// Why outlines cannot be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OutlineWriteError {
    /// More than the format can distinguish.
    #[error("{found} outlines are more than the {bound} that this format can distinguish")]
    TooMany {
        /// How many.
        found: usize,
        /// How many are allowed.
        bound: usize,
    },
    /// An outline that contains no pixel's centre.
    #[error(
        "outline `{name}` covers no pixel of the picture of {width} x {height} pixels of \
         {pixel_size}: is it from this picture?"
    )]
    NoPixel {
        /// Name of the outline.
        name: String,
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// Side of a pixel.
        pixel_size: PixelSize,
    },
    /// The encoder fails.
    #[error("the outlines cannot be written: {reason}")]
    Encode {
        /// What it says.
        reason: String,
    },
}
