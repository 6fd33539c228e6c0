//! AVI: chunks of a RIFF file (Microsoft, AVI RIFF File Reference; `OpenDML` 1.02 for files above 1
//! GB).
//!
//! Frames are uncompressed (grey, palette, 24 and 32 bits of colour, planar and packed YUV), JPEG
//! or PNG. Frames are found by walking through the file, so a missing or wrong index does no harm.

use std::ops::Range;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::check::{check_memory, check_size};
use super::{PictureError, read_picture};
use crate::film::error::FilmError;
use crate::picture::Selection;
use crate::plane::Plane;

/// Weights of red, green and blue in the luminance, as for pictures (ITU-R BT.709-6, item 3.2).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Largest nesting of lists of pictures; cameras write one or two levels.
const DEEPEST: usize = 8;

/// A film.
#[derive(Debug, Clone)]
pub(crate) struct Avi {
    bytes: Vec<u8>,
    size: [usize; 2],
    rate: Option<f64>,
    coding: Coding,
    /// Position of each frame; a frame that the camera dropped has the position of the one before
    /// it.
    frames: Vec<Range<usize>>,
}

/// How frames are encoded.
#[derive(Debug, Clone)]
enum Coding {
    Jpeg,
    Png,
    /// One byte per pixel, with the grey value of each palette entry; rows from bottom to top
    /// unless `down`.
    Palette {
        grey: Vec<f32>,
        down: bool,
    },
    /// Blue, green, red and possibly a fourth byte; rows from bottom to top unless `down`.
    Colour {
        bytes: usize,
        down: bool,
    },
    /// Luminance first, one byte per pixel.
    Planar,
    /// Luminance, two bytes per pixel.
    Wide,
    /// Luminance in each second byte, from this one on.
    Packed {
        first: usize,
    },
}

/// A chunk: its name and the position of its content.
struct Chunk {
    name: [u8; 4],
    content: Range<usize>,
    /// Whether the file ends within it.
    cut: bool,
}

/// The chunks of a part of a file; the last may be cut off.
fn chunks(bytes: &[u8], part: Range<usize>) -> impl Iterator<Item = Chunk> + '_ {
    let mut at = part.start;
    std::iter::from_fn(move || {
        let head = bytes.get(at..at + 8).filter(|_| at + 8 <= part.end)?;
        let name = [head[0], head[1], head[2], head[3]];
        let size = u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
        let start = at + 8;
        let end = start.saturating_add(size);
        // Chunks begin at even offsets.
        at = end.saturating_add(size & 1);
        Some(Chunk { name, content: start..end.min(part.end), cut: end > part.end })
    })
}

/// A little-endian number of 2 or 4 bytes.
fn number(bytes: &[u8], at: usize, count: usize) -> Option<u32> {
    let part = bytes.get(at..at + count)?;
    Some(part.iter().rev().fold(0, |sum, &byte| sum << 8 | u32::from(byte)))
}

fn damaged(reason: impl Into<String>) -> FilmError {
    FilmError::Damaged { format: "AVI", reason: reason.into() }
}

/// The header of the stream of pictures.
#[derive(Default)]
struct Header {
    /// Its number among the streams.
    stream: Option<usize>,
    streams: usize,
    rate: Option<f64>,
    declared: usize,
    format: Vec<u8>,
}

impl Header {
    fn read(&mut self, bytes: &[u8], list: Range<usize>) {
        for chunk in chunks(bytes, list) {
            let content = &bytes[chunk.content.clone()];
            match &chunk.name {
                b"avih" => {
                    let microseconds = number(content, 0, 4).filter(|time| *time > 0);
                    self.rate = microseconds.map(|time| 1e6 / f64::from(time));
                    self.declared = number(content, 16, 4).unwrap_or(0) as usize;
                }
                b"LIST" if content.starts_with(b"strl") => {
                    self.stream(bytes, chunk.content.start + 4..chunk.content.end);
                    self.streams += 1;
                }
                _ => {}
            }
        }
    }

    fn stream(&mut self, bytes: &[u8], list: Range<usize>) {
        if self.stream.is_some() {
            return;
        }
        let mut is_video = false;
        for chunk in chunks(bytes, list) {
            let content = &bytes[chunk.content];
            match &chunk.name {
                b"strh" if content.starts_with(b"vids") => {
                    is_video = true;
                    let scale = number(content, 20, 4).filter(|scale| *scale > 0);
                    let rate = number(content, 24, 4).filter(|rate| *rate > 0);
                    if let (Some(scale), Some(rate)) = (scale, rate) {
                        self.rate = Some(f64::from(rate) / f64::from(scale));
                    }
                }
                b"strf" if is_video => {
                    content.clone_into(&mut self.format);
                    self.stream = Some(self.streams);
                }
                _ => {}
            }
        }
    }
}

impl Avi {
    pub(crate) fn is_one(bytes: &[u8]) -> bool {
        bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"AVI ")
    }

    /// Reads the film; also returns warnings.
    pub(crate) fn read(bytes: Vec<u8>) -> Result<(Self, Vec<String>), FilmError> {
        let mut header = Header::default();
        let mut frames = Vec::new();
        let mut cut = false;
        for riff in chunks(&bytes, 0..bytes.len()).filter(|chunk| &chunk.name == b"RIFF") {
            cut |= riff.cut;
            for chunk in chunks(&bytes, riff.content.start + 4..riff.content.end) {
                let inside = chunk.content.start + 4..chunk.content.end;
                let kind = bytes.get(chunk.content.start..chunk.content.start + 4);
                match (&chunk.name, kind) {
                    (b"LIST", Some(b"hdrl")) => header.read(&bytes, inside),
                    (b"LIST", Some(b"movi")) => {
                        cut |= chunk.cut;
                        let stream = header.stream.unwrap_or(0);
                        cut |= pictures(&bytes, inside, stream, &mut frames, 0)?;
                    }
                    _ => {}
                }
            }
        }
        let format = &header.format;
        let [width, height] = [4, 8].map(|at| number(format, at, 4).unwrap_or(0).cast_signed());
        if header.stream.is_none() || width <= 0 || height == 0 {
            return Err(damaged("its header describes no pictures"));
        }
        let sides = [width.unsigned_abs(), height.unsigned_abs()];
        check_size(sides[0], sides[1])?;
        let coding = Coding::of(format, height < 0)?;
        let size = sides.map(|side| side as usize);
        if let Some(least) = coding.bytes(size) {
            check_memory(least as u64)?;
            // The last frame may be cut off; a damaged one in the middle gives an error when it is
            // read.
            while frames
                .last()
                .is_some_and(|frame: &Range<usize>| (1..least).contains(&frame.len()))
            {
                frames.pop();
                cut = true;
            }
        }
        let first = frames.iter().position(|frame| !frame.is_empty()).unwrap_or(frames.len());
        frames.drain(..first);
        let mut notes = Vec::new();
        if cut || header.declared > frames.len() {
            let declared = header.declared.max(frames.len());
            if frames.is_empty() {
                return Err(damaged(format!("it declares {declared} frames but contains none")));
            }
            notes.push(format!(
                "the film is cut off: {} complete frames of the {declared} declared ones were read",
                frames.len()
            ));
        }
        let repeated = frames.iter().filter(|frame| frame.is_empty()).count();
        if repeated > 0 {
            notes.push(format!(
                "{repeated} frames were dropped by the camera; each repeats the one before it"
            ));
            let mut last = 0..0;
            for frame in &mut frames {
                if Range::is_empty(frame) {
                    frame.clone_from(&last);
                }
                last.clone_from(frame);
            }
        }
        Ok((Self { bytes, size, rate: header.rate, coding, frames }, notes))
    }

    pub(crate) fn len(&self) -> usize {
        self.frames.len()
    }

    pub(crate) fn size(&self) -> [usize; 2] {
        self.size
    }

    pub(crate) fn frames_per_second(&self) -> Option<f64> {
        self.rate
    }

    pub(crate) fn frame(&self, index: usize) -> Result<Plane, PictureError> {
        let bytes = &self.bytes[self.frames[index].clone()];
        let [width, height] = self.size;
        let unreadable = |reason: String| PictureError::Unreadable { format: "AVI", reason };
        let values: Vec<f32> = match &self.coding {
            Coding::Jpeg => return jpeg(bytes),
            Coding::Png => return Ok(read_picture(bytes, &Selection::default())?.plane),
            Coding::Palette { grey, down } => {
                let line = width.next_multiple_of(4);
                let rows = rows(bytes, line, height, *down);
                rows.flat_map(|row| &row[..width.min(row.len())])
                    .map(|&index| grey.get(usize::from(index)).copied().unwrap_or(0.0))
                    .collect()
            }
            Coding::Colour { bytes: each, down } => {
                let line = (width * each).next_multiple_of(4);
                let rows = rows(bytes, line, height, *down);
                rows.flat_map(|row| row.chunks_exact(*each).take(width)).map(luminance).collect()
            }
            Coding::Planar => {
                bytes.iter().take(width * height).map(|&byte| f32::from(byte)).collect()
            }
            Coding::Wide => {
                let pairs = bytes.chunks_exact(2).take(width * height);
                pairs.map(|pair| f32::from(u16::from_le_bytes([pair[0], pair[1]]))).collect()
            }
            Coding::Packed { first } => {
                let pairs = bytes.chunks_exact(2).take(width * height);
                pairs.map(|pair| f32::from(pair[*first])).collect()
            }
        };
        let found = values.len();
        Plane::new(width, height, values)
            .ok_or_else(|| unreadable(format!("it has {found} of {} pixels", width * height)))
    }
}

/// Rows of a picture from the top.
fn rows(bytes: &[u8], line: usize, height: usize, down: bool) -> impl Iterator<Item = &[u8]> {
    let row = move |row: usize| {
        let row = if down { row } else { height - 1 - row };
        bytes.get(row * line..(row + 1) * line).unwrap_or_default()
    };
    (0..height).map(row)
}

fn luminance(pixel: &[u8]) -> f32 {
    let [blue, green, red] = [0, 1, 2].map(|at: usize| f32::from(pixel[at]));
    if red == green && green == blue {
        return red;
    }
    red * LUMINANCE[0] + green * LUMINANCE[1] + blue * LUMINANCE[2]
}

/// Collects the positions of the pictures of a stream in a list; returns whether the last one is
/// cut off and therefore left out.
fn pictures(
    bytes: &[u8],
    list: Range<usize>,
    stream: usize,
    frames: &mut Vec<Range<usize>>,
    depth: usize,
) -> Result<bool, FilmError> {
    if depth > DEEPEST {
        return Err(damaged(format!("its lists of pictures are nested more than {DEEPEST} deep")));
    }
    let mut cut = false;
    for chunk in chunks(bytes, list) {
        if &chunk.name == b"LIST" && bytes[chunk.content.clone()].starts_with(b"rec ") {
            let inside = chunk.content.start + 4..chunk.content.end;
            cut |= pictures(bytes, inside, stream, frames, depth + 1)?;
            continue;
        }
        let [tens, ones, kind @ ..] = chunk.name;
        let digits = tens.is_ascii_digit() && ones.is_ascii_digit();
        let of_stream =
            digits && usize::from(tens - b'0') * 10 + usize::from(ones - b'0') == stream;
        if of_stream && [*b"dc", *b"db"].contains(&kind) {
            if chunk.cut {
                cut = true;
            } else {
                frames.push(chunk.content);
            }
        }
    }
    Ok(cut)
}

impl Coding {
    /// Reads the encoding from the `BITMAPINFOHEADER` of a stream.
    fn of(format: &[u8], down: bool) -> Result<Self, FilmError> {
        let bits = number(format, 14, 2).unwrap_or(0);
        let code = number(format, 16, 4).unwrap_or(0);
        let letters = code.to_le_bytes();
        Ok(match (&letters.to_ascii_uppercase()[..], bits) {
            (b"MJPG" | b"JPEG" | b"AVRN" | b"DMB1" | b"MJPA", _) => Self::Jpeg,
            (b"PNG " | b"MPNG" | b"PNG1", _) => Self::Png,
            (b"Y800" | b"Y8  " | b"GREY" | b"I420" | b"IYUV" | b"YV12" | b"NV12" | b"YV16", _) => {
                Self::Planar
            }
            (b"Y16 " | b"Y1\0\x10", _) => Self::Wide,
            (b"YUY2" | b"YUYV" | b"YVYU", _) => Self::Packed { first: 0 },
            (b"UYVY" | b"HDYC", _) => Self::Packed { first: 1 },
            (b"\0\0\0\0" | b"DIB " | b"RAW ", 8) => {
                let start = number(format, 0, 4).unwrap_or(40) as usize;
                let colours = format.get(start..).unwrap_or_default().chunks_exact(4);
                let mut grey: Vec<f32> = colours.take(256).map(luminance).collect();
                if grey.is_empty() {
                    grey = (0..=255_u8).map(f32::from).collect();
                }
                Self::Palette { grey, down }
            }
            (b"\0\0\0\0" | b"DIB " | b"RAW ", 24 | 32) => {
                Self::Colour { bytes: bits as usize / 8, down }
            }
            _ => {
                let named = letters.iter().all(u8::is_ascii_graphic);
                let codec = if named {
                    String::from_utf8_lossy(&letters).into_owned()
                } else {
                    format!("method {code} and {bits} bits per pixel")
                };
                return Err(FilmError::Codec { codec });
            }
        })
    }

    /// Bytes of a frame, if they follow from its size.
    fn bytes(&self, [width, height]: [usize; 2]) -> Option<usize> {
        Some(match self {
            Self::Jpeg | Self::Png => return None,
            Self::Palette { .. } => width.next_multiple_of(4) * height,
            Self::Colour { bytes, .. } => (bytes * width).next_multiple_of(4) * height,
            Self::Planar => width * height,
            Self::Wide | Self::Packed { .. } => 2 * width * height,
        })
    }
}

/// The luminance of a JPEG picture.
fn jpeg(bytes: &[u8]) -> Result<Plane, PictureError> {
    let unreadable = |reason: String| PictureError::Unreadable { format: "JPEG", reason };
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::Luma);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| unreadable(error.to_string()))?;
    let (width, height) =
        decoder.dimensions().ok_or_else(|| unreadable("it has no size".into()))?;
    check_size(width as u32, height as u32)?;
    let pixels = decoder.decode().map_err(|error| unreadable(error.to_string()))?;
    let values = pixels.iter().map(|&byte| f32::from(byte)).collect();
    Plane::new(width, height, values).ok_or_else(|| unreadable("it holds no pixels".into()))
}
