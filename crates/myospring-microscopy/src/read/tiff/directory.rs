//! The directories of a TIFF file: positions of the values of its tags; nothing in the file is
//! trusted.
//!
//! TIFF 6.0 (Adobe 1992), section 2; `BigTIFF` (Aware Systems 2014).

use std::collections::HashSet;

use crate::read::PictureError;
use crate::read::error::damaged_tiff;

/// Largest number of pages of a file.
const MOST_PAGES: usize = 100_000;

/// Largest number of entries of all directories together, so that overlapping directories cannot
/// make reading slow.
const MOST_ENTRIES: u64 = 4_000_000;

/// The tags that are used; all others are ignored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u16)]
pub(super) enum Tag {
    Width = 256,
    Height = 257,
    BitsPerSample = 258,
    Compression = 259,
    Photometric = 262,
    FillOrder = 266,
    Description = 270,
    StripOffsets = 273,
    SamplesPerPixel = 277,
    RowsPerStrip = 278,
    StripByteCounts = 279,
    XResolution = 282,
    YResolution = 283,
    PlanarConfiguration = 284,
    ResolutionUnit = 296,
    Predictor = 317,
    TileWidth = 322,
    TileHeight = 323,
    TileOffsets = 324,
    TileByteCounts = 325,
    ExtraSamples = 338,
    SampleFormat = 339,
    /// MetaMorph's list of planes.
    MetaMorphPlanes = 33629,
    /// Zeiss LSM's description.
    ZeissLsm = 34412,
}

const TAGS: [Tag; 24] = [
    Tag::Width,
    Tag::Height,
    Tag::BitsPerSample,
    Tag::Compression,
    Tag::Photometric,
    Tag::FillOrder,
    Tag::Description,
    Tag::StripOffsets,
    Tag::SamplesPerPixel,
    Tag::RowsPerStrip,
    Tag::StripByteCounts,
    Tag::XResolution,
    Tag::YResolution,
    Tag::PlanarConfiguration,
    Tag::ResolutionUnit,
    Tag::Predictor,
    Tag::TileWidth,
    Tag::TileHeight,
    Tag::TileOffsets,
    Tag::TileByteCounts,
    Tag::ExtraSamples,
    Tag::SampleFormat,
    Tag::MetaMorphPlanes,
    Tag::ZeissLsm,
];

/// The values of one tag: their position in the file.
#[derive(Debug, Clone, Copy)]
struct Entry {
    tag: Tag,
    /// Type number in TIFF.
    kind: u16,
    count: u64,
    at: u64,
}

/// One page's tags.
#[derive(Debug, Clone, Default)]
pub(super) struct Directory {
    entries: Vec<Entry>,
}

/// The bytes of a TIFF file and its number format.
#[derive(Debug, Clone, Copy)]
pub(super) struct File<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) big_endian: bool,
    /// `BigTIFF`: offsets of 8 bytes.
    wide: bool,
}

impl<'a> File<'a> {
    /// A file whose first bytes are those of a TIFF.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let big_endian = bytes.starts_with(b"MM");
        Self { bytes, big_endian, wide: bytes.get(2..4).is_some_and(|mark| mark.contains(&b'+')) }
    }

    /// An unsigned number of 1, 2, 4 or 8 bytes; `None` beyond the end.
    fn number(&self, at: u64, size: u64) -> Option<u64> {
        let start = usize::try_from(at).ok()?;
        let bytes = self.bytes.get(start..start.checked_add(size as usize)?)?;
        let join = |number: u64, &byte: &u8| number << 8 | u64::from(byte);
        Some(if self.big_endian {
            bytes.iter().fold(0, join)
        } else {
            bytes.iter().rev().fold(0, join)
        })
    }

    /// All pages in the order of the file.
    pub(super) fn directories(&self) -> Result<Vec<Directory>, PictureError> {
        let (at, size) = if self.wide { (8, 8) } else { (4, 4) };
        let mut next =
            self.number(at, size).ok_or_else(|| damaged_tiff("it ends in its header"))?;
        let (mut directories, mut seen, mut entries) = (Vec::new(), HashSet::new(), 0);
        while next != 0 {
            if !seen.insert(next) {
                return Err(damaged_tiff("its list of pages is circular"));
            }
            let page = directories.len();
            if page == MOST_PAGES || entries > MOST_ENTRIES {
                return Err(PictureError::TooMuch {
                    what: format!("more than {page} pages"),
                    most: format!("{MOST_PAGES} pages with {MOST_ENTRIES} tags are allowed"),
                    mend: "split the recording",
                });
            }
            let (directory, count, following) = self.directory(next).ok_or_else(|| {
                damaged_tiff(format!("the tags of page {page} lie beyond the end of the file"))
            })?;
            directories.push(directory);
            entries += count;
            next = following;
        }
        if directories.is_empty() { Err(damaged_tiff("it has no pages")) } else { Ok(directories) }
    }

    /// One directory, the number of its entries, and the offset of the next one (0: there is none);
    /// `None` if a part of it, or of the values of its tags, lies beyond the end of the file.
    fn directory(&self, at: u64) -> Option<(Directory, u64, u64)> {
        let (count_size, offset_size) = if self.wide { (8, 8) } else { (2, 4) };
        let count = self.number(at, count_size)?;
        let entry_size = 4 + 2 * offset_size;
        let first = at.checked_add(count_size)?;
        let end = first.checked_add(count.checked_mul(entry_size)?)?;
        let next = self.number(end, offset_size)?;
        let mut directory = Directory::default();
        for entry in 0..count {
            let at = first + entry * entry_size;
            let number = self.number(at, 2)?;
            let Some(&tag) = TAGS.iter().find(|&&tag| tag as u64 == number) else { continue };
            let kind = self.number(at + 2, 2)? as u16;
            let Some(size) = kind_size(kind) else { continue };
            let count = self.number(at + 4, offset_size)?;
            let field = at + 4 + offset_size;
            let length = count.checked_mul(size)?;
            let at = if length <= offset_size { field } else { self.number(field, offset_size)? };
            if at.checked_add(length)? > self.bytes.len() as u64 {
                return None;
            }
            if directory.entry(tag).is_none() {
                directory.entries.push(Entry { tag, kind, count, at });
            }
        }
        Some((directory, count, next))
    }

    /// One unsigned whole number of a tag; `None` without it.
    pub(super) fn integer(&self, directory: &Directory, tag: Tag, index: u64) -> Option<u64> {
        let entry = directory.entry(tag).filter(|entry| index < entry.count)?;
        if !matches!(entry.kind, BYTE | SHORT | LONG | IFD | LONG8 | IFD8) {
            return None;
        }
        let size = kind_size(entry.kind)?;
        self.number(entry.at.checked_add(index.checked_mul(size)?)?, size)
    }

    /// One fraction or floating-point number of a tag; `None` without it, or if it is not finite.
    pub(super) fn fraction(&self, directory: &Directory, tag: Tag) -> Option<f64> {
        let entry = directory.entry(tag).filter(|entry| entry.count > 0)?;
        let value = match entry.kind {
            RATIONAL => {
                let over = self.number(entry.at, 4)? as f64;
                over / self.number(entry.at.checked_add(4)?, 4)? as f64
            }
            FLOAT => f64::from(f32::from_bits(self.number(entry.at, 4)? as u32)),
            DOUBLE => f64::from_bits(self.number(entry.at, 8)?),
            _ => self.integer(directory, tag, 0)? as f64,
        };
        value.is_finite().then_some(value)
    }

    /// The text of a tag, up to its zero byte; text that is not UTF-8 is read as Latin-1.
    pub(super) fn text(&self, directory: &Directory, tag: Tag) -> Option<String> {
        let entry = directory.entry(tag).filter(|entry| matches!(entry.kind, BYTE | ASCII))?;
        let start = usize::try_from(entry.at).ok()?;
        let end = start.checked_add(usize::try_from(entry.count).ok()?)?;
        let bytes = self.bytes.get(start..end)?.split(|&byte| byte == 0).next()?;
        Some(match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
        })
    }
}

impl Directory {
    fn entry(&self, tag: Tag) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.tag == tag)
    }

    /// Number of values of a tag; 0 without it.
    pub(super) fn count(&self, tag: Tag) -> u64 {
        self.entry(tag).map_or(0, |entry| entry.count)
    }
}

const BYTE: u16 = 1;
const ASCII: u16 = 2;
const SHORT: u16 = 3;
const LONG: u16 = 4;
const RATIONAL: u16 = 5;
const FLOAT: u16 = 11;
const DOUBLE: u16 = 12;
const IFD: u16 = 13;
const LONG8: u16 = 16;
const IFD8: u16 = 18;

/// Bytes of one value of a type; `None` for unknown types.
fn kind_size(kind: u16) -> Option<u64> {
    match kind {
        BYTE | ASCII | 6 | 7 => Some(1),
        SHORT | 8 => Some(2),
        LONG | 9 | FLOAT | IFD => Some(4),
        RATIONAL | 10 | DOUBLE | LONG8 | 17 | IFD8 => Some(8),
        _ => None,
    }
}
