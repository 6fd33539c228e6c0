//! Why bytes are not a stack, or a stack gives no cell.

use crate::fibres::FibreError;
use crate::film::FilmError;
use crate::read::PictureError;
use crate::segment::SegmentError;
use myospring_core::interruption::Interrupted;
use myospring_core::mesh::mask::MaskError;
use myospring_core::mesh::pixel_size::PixelSize;
use myospring_core::mesh::voxels::VoxelsError;

/// Least number of slices of a stack.
pub const FEWEST_SLICES: usize = 2;

/// Largest number of voxels that are kept in memory at a time.
pub const MOST_VOXELS: usize = 400_000_000;

/// Why bytes are not a stack, or a stack gives no cell.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StackError {
    /// The work was ended early.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// Not a picture, or a damaged one.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A film that cannot be read as a stack.
    #[error(transparent)]
    Film(FilmError),
    /// One slice cannot be read.
    #[error("slice {slice}{}: {cause}", named(name.as_ref()))]
    Slice {
        /// Its number, from 0.
        slice: usize,
        /// Its file, if each slice has one.
        name: Option<String>,
        /// What is wrong.
        cause: PictureError,
    },
    /// Slices of different sizes.
    #[error(
        "slice {slice}{} has {} x {} pixels, but the first has {} x {}; give slices of one size",
        named(name.as_ref()), found[0], found[1], expected[0], expected[1]
    )]
    Sizes {
        /// Its number, from 0.
        slice: usize,
        /// Its file, if each slice has one.
        name: Option<String>,
        /// Columns and rows of the first slice.
        expected: [usize; 2],
        /// Those of this slice.
        found: [usize; 2],
    },
    /// Several channels or time points.
    #[error(
        "the stack has {count} {what}, 0 to {}; say which one shows the cell, like {option} 0",
        count.saturating_sub(1)
    )]
    Several {
        /// `channels` or `time points`.
        what: &'static str,
        /// The option that chooses one.
        option: &'static str,
        /// How many there are.
        count: usize,
    },
    /// Too few slices.
    #[error(
        "the stack has {slices} slice(s); at least {FEWEST_SLICES} are needed: is this a single picture? A picture with \
         a thickness needs no stack"
    )]
    TooFew {
        /// How many there are.
        slices: usize,
    },
    /// Neither the file nor the caller states a pixel size.
    #[error(
        "the stack does not say how large its pixels are; give the side of one, like --pixel-size \"0.27 um\" \
         (the microscope's software shows it)"
    )]
    NoPixelSize,
    /// Neither the file nor the caller states the distance of slices.
    #[error(
        "the stack does not say how far apart its slices are; give the distance, like --z-step \"0.5 um\" (the \
         microscope's software shows it)"
    )]
    NoZStep,
    /// A distance of slices out of range.
    #[error(
        "the z step is {um} um, outside {} to {} um: give the distance of two slices in micrometres, like --z-step \
         \"0.5 um\"",
        PixelSize::SMALLEST_UM,
        PixelSize::LARGEST_UM
    )]
    ZStep {
        /// The given length, um.
        um: f64,
    },
    /// Too many voxels.
    #[error(
        "the stack has {voxels:.1e} voxels to keep in memory, more than {MOST_VOXELS:.1e}: cut out the cell (Fiji: \
         Image > Crop, Image > Stacks > Tools > Slice Remover)"
    )]
    TooLarge {
        /// How many.
        voxels: f64,
    },
    /// The cell cannot be found from above, or not the one that was asked for.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// The cell seen from above is not a valid mask.
    #[error(transparent)]
    Mask(#[from] MaskError),
    /// The voxels are not a valid cell.
    #[error(transparent)]
    Voxels(#[from] VoxelsError),
    /// The cell is visible from above but not in depth.
    #[error(
        "a cell is visible from above, but no voxel in it is brighter than the threshold of {threshold:.4}: is this the \
         right channel? Otherwise give a lower --threshold"
    )]
    NothingInDepth {
        /// The threshold, grey value.
        threshold: f64,
    },
    /// No directions can be read.
    #[error(transparent)]
    Fibres(#[from] FibreError),
    /// Voxels of another stack.
    #[error(
        "the cell has {} x {} x {} voxels, but the slices have {} x {} pixels: it is from another stack",
        voxels[0], voxels[1], voxels[2], stack[0], stack[1]
    )]
    OtherStack {
        /// Columns, rows and layers of the voxels.
        voxels: [usize; 3],
        /// Columns and rows of the slices.
        stack: [usize; 2],
    },
    /// Brightfield has no depth.
    #[error(
        "a stack in brightfield does not show where a cell begins and ends in depth; give a fluorescence stack or a \
         mask, or one slice of it as a picture, with a profile and a thickness"
    )]
    Brightfield,
    /// A voxel that is not a label.
    #[error("slice {slice}: {cause}")]
    NoLabel {
        /// The slice, from 0.
        slice: usize,
        /// The pixel and its value.
        cause: SegmentError,
    },
}

impl StackError {
    pub(super) fn several(what: &'static str, option: &'static str, count: usize) -> Self {
        Self::Several { what, option, count }
    }
}

fn named(name: Option<&String>) -> String {
    name.map(|name| format!(" (`{name}`)")).unwrap_or_default()
}
