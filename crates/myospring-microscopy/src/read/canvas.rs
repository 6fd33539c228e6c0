//! Turns rows of samples into one plane: colour to grey, several slices to one.

use super::super::picture::Depth;
use super::super::plane::Plane;
use super::PictureError;

/// The samples of one row that belong to one channel: each `stride`-th value from `offset`.
#[derive(Clone, Copy)]
pub(super) struct Strand<'a> {
    pub(super) values: &'a [f32],
    pub(super) stride: usize,
    pub(super) offset: usize,
}

impl Strand<'_> {
    fn at(&self, pixel: usize) -> f32 {
        self.values[pixel * self.stride + self.offset]
    }
}

/// The selected samples of one row.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    /// One channel, or red, green and blue.
    pub(super) colours: Colours<'a>,
    /// Opacity; where it is 0, the pixel is 0 whatever its colour.
    pub(super) alpha: Option<Strand<'a>>,
}

#[derive(Clone, Copy)]
pub(super) enum Colours<'a> {
    Grey(Strand<'a>),
    Rgb([Strand<'a>; 3]),
}

/// Weights of red, green and blue in the luminance (ITU-R BT.709-6, item 3.2), on the stored values.
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

impl Row<'_> {
    /// The grey value of one pixel, and whether it is coloured.
    fn grey(&self, pixel: usize) -> (f32, bool) {
        if self.alpha.is_some_and(|alpha| alpha.at(pixel) == 0.0) {
            return (0.0, false);
        }
        match self.colours {
            Colours::Grey(channel) => (channel.at(pixel), false),
            Colours::Rgb(channels) => {
                let [red, green, blue] = channels.map(|channel| channel.at(pixel));
                if red == green && green == blue {
                    return (red, false);
                }
                (red * LUMINANCE[0] + green * LUMINANCE[1] + blue * LUMINANCE[2], true)
            }
        }
    }
}

/// A plane that is being filled, slice after slice.
pub(super) struct Canvas {
    width: usize,
    height: usize,
    /// Allocated with the first row, so that a damaged file takes no memory.
    values: Vec<f32>,
    depth: Depth,
    slices: usize,
    pub(super) coloured: bool,
    not_finite: u64,
    first_not_finite: Option<usize>,
}

impl Canvas {
    pub(super) fn new(width: usize, height: usize, depth: Depth) -> Self {
        Self {
            width,
            height,
            values: Vec::new(),
            depth,
            slices: 0,
            coloured: false,
            not_finite: 0,
            first_not_finite: None,
        }
    }

    /// Starts the next slice.
    pub(super) fn next_slice(&mut self) {
        self.slices += 1;
    }

    /// Adds `count` pixels of a row from `column` on.
    pub(super) fn lay(&mut self, column: usize, row: usize, count: usize, samples: &Row) {
        if self.values.is_empty() {
            self.values.resize(self.width * self.height, 0.0);
        }
        let start = row * self.width + column;
        match (samples.colours, samples.alpha) {
            // Nearly all pictures; twice as fast without the general case in the loop.
            (Colours::Grey(channel), None) => {
                self.blend(start, count, |at| (channel.at(at), false));
            }
            _ => self.blend(start, count, |pixel| samples.grey(pixel)),
        }
    }

    fn blend(&mut self, start: usize, count: usize, grey: impl Fn(usize) -> (f32, bool)) {
        let first = self.slices <= 1;
        for (pixel, value) in self.values[start..start + count].iter_mut().enumerate() {
            let (grey, coloured) = grey(pixel);
            self.coloured |= coloured;
            if !grey.is_finite() {
                self.not_finite += 1;
                let first = self.first_not_finite.get_or_insert(start + pixel);
                *first = (*first).min(start + pixel);
            }
            *value = match self.depth {
                _ if first => grey,
                Depth::Maximum => value.max(grey),
                // The sum of 256 slices of 16 bits is still exact in 24 bits of mantissa.
                Depth::Mean => *value + grey,
                Depth::Slice(_) => grey,
            };
        }
    }

    /// The plane; several slices become their maximum or mean.
    pub(super) fn finish(self) -> Result<Plane, PictureError> {
        if let Some(at) = self.first_not_finite {
            let (column, row) = (at % self.width, at / self.width);
            return Err(PictureError::NotFinite { count: self.not_finite, column, row });
        }
        let slices = self.slices as f32;
        let mean = self.depth == Depth::Mean && self.slices > 1;
        let plane = Plane::new(self.width, self.height, self.values);
        let plane = plane.ok_or(PictureError::Unreadable {
            format: "PNG or TIFF",
            reason: "it holds no pixels".to_owned(),
        })?;
        Ok(if mean { plane.map(|sum| sum / slices) } else { plane })
    }
}

/// Unpacks whole numbers of 1 to 16 bits, packed from the high end of each byte.
pub(super) fn unpack(bytes: &[u8], bits: u32, into: &mut Vec<f32>) {
    let (mut held, mut count) = (0_u32, 0);
    for &byte in bytes {
        held = held << 8 | u32::from(byte);
        count += 8;
        while count >= bits {
            count -= bits;
            into.push((held >> count) as f32);
            held &= (1 << count) - 1;
        }
    }
}
