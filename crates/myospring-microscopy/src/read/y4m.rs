//! `YUV4MPEG2`: a header line that describes the frames, then each frame after a line `FRAME`.
//!
//! Only the luminance is read; it comes first in every frame.

use super::PictureError;
use super::check::{check_memory, check_size};
use crate::film::error::FilmError;
use crate::plane::Plane;

const START: &[u8] = b"YUV4MPEG2";
/// Longest accepted line, bytes.
const LONGEST_LINE: usize = 1000;

/// A film.
#[derive(Debug, Clone)]
pub(crate) struct Y4m {
    bytes: Vec<u8>,
    size: [usize; 2],
    rate: Option<f64>,
    bits: u8,
    /// Start of each frame's luminance.
    starts: Vec<usize>,
}

impl Y4m {
    pub(crate) fn is_one(bytes: &[u8]) -> bool {
        bytes.starts_with(START)
    }

    /// Reads the film; also returns warnings.
    pub(crate) fn read(bytes: Vec<u8>) -> Result<(Self, Vec<String>), FilmError> {
        let damaged =
            |reason: &str| FilmError::Damaged { format: "YUV4MPEG2", reason: reason.to_owned() };
        let line = |from: usize| {
            let rest = bytes.get(from..)?;
            let end = rest.iter().take(LONGEST_LINE).position(|&byte| byte == b'\n')?;
            Some((String::from_utf8_lossy(&rest[..end]).into_owned(), from + end + 1))
        };
        let (header, mut at) = line(0).ok_or_else(|| damaged("its first line has no end"))?;
        let (mut sides, mut rate, mut colour) = ([0_u32; 2], None, "420".to_owned());
        for word in header.split(' ').skip(1) {
            let value = word.get(1..).unwrap_or_default();
            match word.as_bytes().first() {
                Some(b'W') => sides[0] = value.parse().unwrap_or(0),
                Some(b'H') => sides[1] = value.parse().unwrap_or(0),
                Some(b'C') => value.clone_into(&mut colour),
                Some(b'F') => {
                    rate = value.split_once(':').and_then(|(count, per)| {
                        Some(count.parse::<f64>().ok()? / per.parse::<f64>().ok()?)
                    });
                }
                _ => {}
            }
        }
        if sides.contains(&0) {
            return Err(damaged("its first line states no size"));
        }
        check_size(sides[0], sides[1])?;
        let [width, height] = sides.map(|side| side as usize);
        let bits: u8 = match colour.as_str() {
            "mono16" => 16,
            "mono12" => 12,
            "mono10" => 10,
            other if other.contains('p') && other.ends_with(['0', '2', '4', '6']) => {
                other.rsplit('p').next().and_then(|bits| bits.parse().ok()).unwrap_or(8)
            }
            _ => 8,
        };
        let luminance = width * height;
        let half = width.div_ceil(2);
        let samples = match colour.as_str() {
            mono if mono.starts_with("mono") => luminance,
            full if full.starts_with("444") => 3 * luminance,
            wide if wide.starts_with("422") => luminance + 2 * half * height,
            _ => luminance + 2 * half * height.div_ceil(2),
        };
        let bytes_each = if bits > 8 { 2 } else { 1 };
        check_memory((samples * bytes_each) as u64)?;
        let mut starts = Vec::new();
        let mut notes = Vec::new();
        while let Some((mark, start)) = line(at) {
            if !mark.starts_with("FRAME") {
                return Err(damaged(&format!(
                    "frame {} does not begin with `FRAME`",
                    starts.len()
                )));
            }
            at = start + samples * bytes_each;
            if at > bytes.len() {
                notes.push(format!(
                    "the film ends within frame {}, which is left out",
                    starts.len()
                ));
                break;
            }
            starts.push(start);
        }
        Ok((Self { bytes, size: [width, height], rate, bits, starts }, notes))
    }

    pub(crate) fn len(&self) -> usize {
        self.starts.len()
    }

    pub(crate) fn size(&self) -> [usize; 2] {
        self.size
    }

    pub(crate) fn frames_per_second(&self) -> Option<f64> {
        self.rate
    }

    pub(crate) fn bits(&self) -> u8 {
        self.bits
    }

    pub(crate) fn frame(&self, index: usize) -> Result<Plane, PictureError> {
        let [width, height] = self.size;
        let from = &self.bytes[self.starts[index]..];
        let values = if self.bits > 8 {
            let pairs = from.chunks_exact(2).take(width * height);
            pairs.map(|pair| f32::from(u16::from_le_bytes([pair[0], pair[1]]))).collect()
        } else {
            from.iter().take(width * height).map(|&byte| f32::from(byte)).collect()
        };
        let unreadable = || PictureError::Unreadable {
            format: "YUV4MPEG2",
            reason: "it ends too early".to_owned(),
        };
        Plane::new(width, height, values).ok_or_else(unreadable)
    }
}
