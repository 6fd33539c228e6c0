//! PNG files.

use std::fmt::Display;
use std::io::Cursor;

use ::png::{ColorType, DecodingError, Info, Limits, Reader, Transformations, Unit};

use super::super::picture::{Depth, Picture, PixelSizeSource, Samples, Selection};
use super::PictureError;
use super::canvas::{Canvas, Colours, Row, Strand, unpack};
use super::check::{check_memory, check_range, check_size};
use super::pixel_size::{self, Stated};

/// Largest memory of the decoder in addition to the pixels (colour profiles, rows), bytes.
const MOST_EXTRA_MEMORY: usize = 1 << 26;

fn unreadable(reason: &dyn Display) -> PictureError {
    PictureError::Unreadable { format: "PNG", reason: reason.to_string() }
}

/// Reads a PNG: one frame, one slice.
pub(super) fn read(bytes: &[u8], selection: &Selection) -> Result<Picture, PictureError> {
    if let Some((width, height)) = declared_size(bytes) {
        check_size(width, height)?;
    }
    let limits = Limits { bytes: MOST_EXTRA_MEMORY };
    let mut decoder = ::png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::IDENTITY);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let mut reader = decoder.read_info().map_err(|error| unreadable(&error))?;
    let colours = Colouring::of(reader.info());
    let stated = stated_size(reader.info());
    check_range("frame", selection.frame, 1)?;
    if let Some(Depth::Slice(slice)) = selection.depth {
        check_range("slice", slice, 1)?;
    }
    if let Some(channel) = selection.channel {
        check_range("channel", channel, colours.channels())?;
    }
    let canvas = decode(&mut reader, &colours, selection.channel)?;
    let mut notes = Vec::new();
    let coloured = canvas.coloured;
    Ok(Picture {
        plane: canvas.finish()?,
        pixel_size: pixel_size::choose(stated, &mut notes)?,
        samples: Samples::Integer { bits: colours.sample_bits() },
        coloured,
        channels: colours.channels(),
        choices: 1,
        frames: 1,
        slices: 1,
        z_step_um: None,
        frame_interval_s: None,
        notes,
    })
}

/// The size in the header, which always comes first: 8 bytes of signature, 8 of chunk name, then width
/// and height (PNG specification, 11.2.1).
fn declared_size(bytes: &[u8]) -> Option<(u32, u32)> {
    let number = |at: usize| Some(u32::from_be_bytes(*bytes.get(at..)?.first_chunk()?));
    Some((number(16)?, number(20)?))
}

fn stated_size(info: &Info) -> Option<Stated> {
    let size = info.pixel_dims.filter(|size| size.unit == Unit::Meter)?;
    let um = |per_metre: u32| (per_metre > 0).then(|| 1e6 / f64::from(per_metre));
    let source = PixelSizeSource::PngResolution;
    Some(Stated { x_um: um(size.xppu)?, y_um: um(size.yppu)?, source })
}

/// Meaning of the samples of a pixel.
struct Colouring {
    kind: ColorType,
    bits: u32,
    /// Red, green and blue of each index, one byte each.
    palette: Vec<u8>,
    /// Opacity of the first indices, or the samples of the transparent colour.
    transparent: Option<Vec<u8>>,
}

impl Colouring {
    fn of(info: &Info) -> Self {
        Self {
            kind: info.color_type,
            bits: info.bit_depth as u32,
            palette: info.palette.as_deref().unwrap_or_default().to_vec(),
            transparent: info.trns.as_deref().map(<[u8]>::to_vec),
        }
    }

    fn sample_bits(&self) -> u8 {
        if self.kind == ColorType::Indexed { 8 } else { self.bits as u8 }
    }

    /// Number of channels without opacity.
    fn channels(&self) -> usize {
        match self.kind {
            ColorType::Grayscale | ColorType::GrayscaleAlpha => 1,
            ColorType::Rgb | ColorType::Rgba | ColorType::Indexed => 3,
        }
    }

    /// Whether the stored samples are the pixels, without palette or transparent colour.
    fn is_plain(&self) -> bool {
        self.kind != ColorType::Indexed && self.transparent.is_none()
    }

    /// Whether an opacity follows the channels, in the file or after [`Self::expand`].
    fn has_opacity(&self) -> bool {
        !self.is_plain() || matches!(self.kind, ColorType::GrayscaleAlpha | ColorType::Rgba)
    }

    /// Expands the stored samples of one row into pixels of `channels()` samples and an opacity.
    fn expand(&self, stored: &[f32], pixels: &mut Vec<f32>) {
        let stride = self.kind.samples();
        // The library gives one byte instead of two for samples of at most 8 bits.
        let size = if self.bits == 16 { 2 } else { 1 };
        let number =
            |bytes: &[u8]| bytes.iter().fold(0.0, |sum, &byte| 256.0 * sum + f32::from(byte));
        let key = self.transparent.iter().flat_map(|key| key.chunks_exact(size).map(number));
        let key: Vec<f32> = key.take(stride).collect();
        for pixel in stored.chunks_exact(stride) {
            match self.kind {
                ColorType::Indexed => {
                    let index = pixel[0] as usize;
                    let part = |at: usize| f32::from(self.palette.get(at).copied().unwrap_or(0));
                    pixels.extend([0, 1, 2].map(|channel| part(3 * index + channel)));
                    let opacity = self.transparent.as_ref().and_then(|all| all.get(index));
                    pixels.push(opacity.map_or(1.0, |&opacity| f32::from(opacity)));
                }
                ColorType::GrayscaleAlpha | ColorType::Rgba => pixels.extend(pixel),
                ColorType::Grayscale | ColorType::Rgb => {
                    pixels.extend(pixel);
                    pixels.push(if key == pixel { 0.0 } else { 1.0 });
                }
            }
        }
    }
}

/// Decodes all rows.
fn decode(
    reader: &mut Reader<Cursor<&[u8]>>,
    colours: &Colouring,
    channel: Option<usize>,
) -> Result<Canvas, PictureError> {
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let size = reader.output_buffer_size().ok_or_else(|| unreadable(&"its size overflows"))?;
    check_memory(size as u64)?;
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer).map_err(|error| match error {
        DecodingError::IoError(_) => unreadable(&"it ends too early"),
        other => unreadable(&other),
    })?;
    let mut canvas = Canvas::new(width, height, Depth::Maximum);
    canvas.next_slice();
    let (mut stored, mut pixels) = (Vec::new(), Vec::new());
    let stride = colours.channels() + usize::from(colours.has_opacity());
    for (row, bytes) in buffer.chunks_exact(frame.line_size.max(1)).enumerate() {
        stored.clear();
        pixels.clear();
        match colours.bits {
            8 => stored.extend(bytes.iter().map(|&byte| f32::from(byte))),
            16 => stored.extend(
                bytes.chunks_exact(2).map(|pair| f32::from(u16::from_be_bytes([pair[0], pair[1]]))),
            ),
            bits => unpack(bytes, bits, &mut stored),
        }
        stored.truncate(width * colours.kind.samples());
        if colours.is_plain() {
            std::mem::swap(&mut stored, &mut pixels);
        } else {
            colours.expand(&stored, &mut pixels);
        }
        let strand = |offset| Strand { values: &pixels, stride, offset };
        let wanted = match channel {
            Some(channel) => Colours::Grey(strand(channel)),
            None if colours.channels() == 3 => Colours::Rgb([strand(0), strand(1), strand(2)]),
            None => Colours::Grey(strand(0)),
        };
        let alpha = colours.has_opacity().then(|| strand(stride - 1));
        let samples = Row { colours: wanted, alpha };
        canvas.lay(0, row, width, &samples);
    }
    Ok(canvas)
}
