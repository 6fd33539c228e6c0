//! Why bytes are not a film, or a frame is not one.

use crate::read::PictureError;

/// Least number of frames of a film.
pub const FEWEST_FRAMES: usize = 3;

/// Why bytes are not a film, or a frame is not one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FilmError {
    /// Not a TIFF, AVI or `YUV4MPEG2`, or a damaged one.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// One frame cannot be read.
    #[error("frame {frame}{}: {cause}", named(name.as_ref()))]
    Frame {
        /// Its number, from 0.
        frame: usize,
        /// Its file, if each frame has one.
        name: Option<String>,
        /// What is wrong.
        cause: PictureError,
    },
    /// Frames of different sizes.
    #[error(
        "frame {frame}{} has {} x {} pixels, but the first has {} x {}; give frames of one size",
        named(name.as_ref()), found[0], found[1], expected[0], expected[1]
    )]
    Sizes {
        /// Its number, from 0.
        frame: usize,
        /// Its file, where each has one.
        name: Option<String>,
        /// Columns and rows of the first frame.
        expected: [usize; 2],
        /// Those of this frame.
        found: [usize; 2],
    },
    /// Too few frames.
    #[error(
        "there {}; at least {FEWEST_FRAMES} are needed to follow a cell: is this a picture, or was the \
         recording cut off?",
        match frames { 0 => "is no frame".to_owned(), 1 => "is only one frame".to_owned(), count => format!("are only {count} frames") }
    )]
    TooFew {
        /// How many there are.
        frames: usize,
    },
    /// A frame that does not exist.
    #[error(
        "frame {frame} was asked for, but the film has {frames}, 0 to {}",
        frames.saturating_sub(1)
    )]
    NoSuchFrame {
        /// The one that was asked for.
        frame: usize,
        /// How many there are.
        frames: usize,
    },
    /// An AVI or `YUV4MPEG2` that is damaged.
    #[error("the {format} film cannot be read: {reason}; is the file complete?")]
    Damaged {
        /// AVI or `YUV4MPEG2`.
        format: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// Unsupported compression.
    #[error(
        "the frames are compressed with {codec}, which cannot be read; save the film uncompressed (Fiji: \
         File > Save As > AVI, compression none), or as TIFF"
    )]
    Codec {
        /// Its four-letter code, or a number.
        codec: String,
    },
}

fn named(name: Option<&String>) -> String {
    name.map(|name| format!(" (`{name}`)")).unwrap_or_default()
}
