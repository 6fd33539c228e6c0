//! The checked description of one page of a TIFF file.

use super::directory::{Directory, File, Tag};
use crate::picture::Samples;
use crate::read::PictureError;
use crate::read::check::{check_memory, check_size};
use crate::read::error::damaged_tiff;

/// Largest number of samples per pixel.
const MOST_SAMPLES: u64 = 1024;

/// Number format of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Unsigned,
    Signed,
    Float,
}

/// One page.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Page {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) bits: u32,
    pub(super) format: Format,
    /// Samples of a pixel, opacity included.
    pub(super) samples: u32,
    /// Red, green and blue are the first samples.
    pub(super) colour: bool,
    pub(super) white_is_zero: bool,
    /// Which sample is the opacity.
    pub(super) alpha: Option<u32>,
    /// Each sample has chunks of its own.
    pub(super) planar: bool,
    pub(super) compression: u16,
    pub(super) predictor: u16,
    pub(super) grid: Grid,
}

/// How a page is divided into strips or tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Grid {
    pub(super) tiled: bool,
    pub(super) columns: u32,
    pub(super) rows: u32,
    pub(super) across: u32,
    pub(super) down: u32,
}

impl Grid {
    /// Number of chunks for all pixels of one sample, or of all samples if they share chunks.
    pub(super) fn chunks(&self) -> u64 {
        u64::from(self.across) * u64::from(self.down)
    }
}

/// Columns and rows stated in the directory.
pub(super) fn size(file: &File, directory: &Directory) -> Result<(u32, u32), PictureError> {
    let side = |tag, name| {
        let side = file.integer(directory, tag, 0);
        side.ok_or_else(|| damaged_tiff(format!("a page does not state its {name}")))
            .map(|side| u32::try_from(side).unwrap_or(u32::MAX))
    };
    Ok((side(Tag::Width, "width")?, side(Tag::Height, "height")?))
}

impl Page {
    /// Reads and checks the tags of a page.
    pub(super) fn read(file: &File, directory: &Directory) -> Result<Self, PictureError> {
        let (width, height) = size(file, directory)?;
        check_size(width, height)?;
        if width == 0 || height == 0 {
            return Err(damaged_tiff(format!("it declares {width} x {height} pixels")));
        }
        let value = |tag, otherwise| file.integer(directory, tag, 0).unwrap_or(otherwise);
        let compression = value(Tag::Compression, 1) as u16;
        check_compression(compression)?;
        let samples = value(Tag::SamplesPerPixel, 1);
        if !(1..=MOST_SAMPLES).contains(&samples) {
            return Err(unread(format!("{samples} samples per pixel")));
        }
        let samples = samples as u32;
        let photometric = value(Tag::Photometric, 1);
        if photometric > 4 {
            return Err(unread(format!("colour model {photometric}, {}", model(photometric))));
        }
        let bits = uniform(file, directory, Tag::BitsPerSample, 1, "bits per sample")?;
        let format = match uniform(file, directory, Tag::SampleFormat, 1, "sample formats")? {
            1 | 4 => Format::Unsigned,
            2 => Format::Signed,
            3 => Format::Float,
            other => return Err(unread(format!("sample format {other}, complex numbers"))),
        };
        let predictor = value(Tag::Predictor, 1) as u16;
        let packed = check_samples(bits, format, predictor)?;
        if packed && value(Tag::FillOrder, 1) == 2 {
            return Err(unread("bits packed from the low end".to_owned()));
        }
        let white_is_zero = photometric == 0;
        if white_is_zero && format != Format::Unsigned {
            return Err(unread("white as zero in signed numbers".to_owned()));
        }
        let colours = if photometric == 2 && samples >= 3 { 3 } else { 1 };
        let page = Self {
            width,
            height,
            bits: bits as u32,
            format,
            samples,
            colour: colours == 3,
            white_is_zero,
            alpha: opacity(file, directory, samples)
                .or((colours == 3 && samples == 4 && directory.count(Tag::ExtraSamples) == 0)
                    .then_some(3)),
            planar: value(Tag::PlanarConfiguration, 1) == 2 && samples > 1,
            compression,
            predictor,
            grid: grid(file, directory, width, height)?,
        };
        check_memory(page.row_bytes().saturating_mul(u64::from(page.grid.rows)))?;
        Ok(page)
    }

    /// Number of channels without opacity.
    pub(super) fn channels(&self) -> u32 {
        if self.colour { 3 } else { self.samples - u32::from(self.alpha.is_some()) }
    }

    /// Whether several samples share bytes.
    pub(super) fn packed(&self) -> bool {
        !matches!(self.bits, 8 | 16 | 32 | 64)
    }

    /// Number of samples of a pixel in one chunk.
    pub(super) fn samples_in_chunk(&self) -> u32 {
        if self.planar { 1 } else { self.samples }
    }

    /// Bytes of one decoded row of a chunk.
    pub(super) fn row_bytes(&self) -> u64 {
        let bits = u64::from(self.samples_in_chunk()) * u64::from(self.bits);
        (u64::from(self.grid.columns) * bits).div_ceil(8)
    }

    /// Type of the pixel values.
    pub(super) fn kind(&self) -> Samples {
        let bits = self.bits as u8;
        if self.format == Format::Float {
            Samples::Float { bits }
        } else {
            Samples::Integer { bits }
        }
    }

    /// Whether both pages can be slices of one stack.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let size = |page: &Self| (page.width, page.height);
        let kind = |page: &Self| (page.samples, page.bits, page.format, page.colour, page.alpha);
        size(self) == size(other) && kind(self) == kind(other)
    }

    /// Size and type in words.
    pub(super) fn words(&self) -> String {
        let Self { width, height, samples, bits, .. } = self;
        format!("{width} x {height} pixels of {samples} x {bits} bits")
    }
}

fn unread(reason: String) -> PictureError {
    PictureError::Pixels { format: "TIFF", reason }
}

fn check_compression(number: u16) -> Result<(), PictureError> {
    let method = match number {
        1 | 5 | 8 | 32773 | 32946 => return Ok(()),
        2..=4 => "fax encoding".to_owned(),
        6 | 7 => "JPEG (lossy)".to_owned(),
        33003 | 33005 | 34712 => "JPEG 2000".to_owned(),
        34887 => "LERC".to_owned(),
        34925 => "LZMA".to_owned(),
        50000 => "Zstandard".to_owned(),
        50001 => "WebP".to_owned(),
        50002 | 52546 => "JPEG XL".to_owned(),
        other => format!("method {other}"),
    };
    Err(PictureError::Compression { method })
}

fn model(photometric: u64) -> &'static str {
    match photometric {
        5 => "CMYK",
        6 => "YCbCr",
        8..=10 => "Lab",
        32803 => "a colour filter array",
        _ => "unknown",
    }
}

/// The value of a tag that is stated per sample and must be the same for all.
fn uniform(
    file: &File,
    directory: &Directory,
    tag: Tag,
    otherwise: u64,
    name: &str,
) -> Result<u64, PictureError> {
    let first = file.integer(directory, tag, 0).unwrap_or(otherwise);
    let count = directory.count(tag).min(MOST_SAMPLES);
    let differs = (1..count).any(|index| file.integer(directory, tag, index) != Some(first));
    if differs { Err(unread(format!("different {name} in one pixel"))) } else { Ok(first) }
}

/// Whether samples share bytes; an error if they cannot be read.
fn check_samples(bits: u64, format: Format, predictor: u16) -> Result<bool, PictureError> {
    let read = match format {
        Format::Unsigned => matches!(bits, 1..=16 | 32 | 64),
        Format::Signed => matches!(bits, 8 | 16 | 32 | 64),
        Format::Float => matches!(bits, 16 | 32 | 64),
    };
    if !read {
        let name = match format {
            Format::Unsigned => "whole numbers",
            Format::Signed => "signed whole numbers",
            Format::Float => "floating-point numbers",
        };
        return Err(unread(format!("{name} of {bits} bits")));
    }
    let packed = !matches!(bits, 8 | 16 | 32 | 64);
    match predictor {
        1 => {}
        2 if !packed => {}
        3 if format == Format::Float => {}
        other => return Err(unread(format!("predictor {other} with {bits} bits"))),
    }
    Ok(packed)
}

/// Index of the opacity: the first extra sample of that type.
fn opacity(file: &File, directory: &Directory, samples: u32) -> Option<u32> {
    let extra = u32::try_from(directory.count(Tag::ExtraSamples)).ok()?;
    let first = samples.checked_sub(extra).filter(|&first| first > 0)?;
    let is_opacity = |index: &u32| {
        let meaning = file.integer(directory, Tag::ExtraSamples, u64::from(*index));
        matches!(meaning, Some(1 | 2))
    };
    (0..extra).find(is_opacity).map(|index| first + index)
}

fn grid(file: &File, directory: &Directory, width: u32, height: u32) -> Result<Grid, PictureError> {
    let tiled = directory.count(Tag::TileOffsets) > 0;
    let [columns, rows] = if tiled {
        [Tag::TileWidth, Tag::TileHeight].map(|tag| file.integer(directory, tag, 0).unwrap_or(0))
    } else {
        let rows = file.integer(directory, Tag::RowsPerStrip, 0).unwrap_or(u64::from(height));
        [u64::from(width), rows.min(u64::from(height))]
    };
    match (u32::try_from(columns), u32::try_from(rows)) {
        (Ok(columns @ 1..), Ok(rows @ 1..)) => Ok(Grid {
            tiled,
            columns,
            rows,
            across: width.div_ceil(columns),
            down: height.div_ceil(rows),
        }),
        _ => Err(damaged_tiff(format!("its strips or tiles are {columns} x {rows} pixels"))),
    }
}
