//! TIFF files: plain, `BigTIFF`, OME-TIFF, and ImageJ's.

use super::super::picture::{Depth, Picture, Samples, Selection};
use super::canvas::{Canvas, Colours, Row, Strand};
use super::check::check_range;
use super::{PictureError, pixel_size};
use chunk::Chunk;
use directory::{Directory, File};
use page::Page;
use planes::Axis;
use stack::Stack;

mod chunk;
mod directory;
mod imagej;
mod ome;
mod page;
mod planes;
mod stack;

/// Largest work of reading one plane, in decoded bytes: a thousand slices of 2048 x 2048 pixels of
/// 16 bits.
const MOST_WORK: u64 = 1 << 33;

/// Overhead of a strip or tile, in decoded bytes.
const WORK_OF_A_CHUNK: u64 = 2000;

/// Largest number up to which `f32` represents all whole numbers.
const LARGEST_EXACT: f32 = 16_777_216.0;

/// Reads the selected plane.
pub(super) fn read(bytes: &[u8], selection: &Selection) -> Result<Picture, PictureError> {
    let file = File::new(bytes);
    let directories = file.directories()?;
    let mut notes = Vec::new();
    let first = Page::read(&file, &directories[0])?;
    let stack = Stack::new(&file, &directories, &first, selection, &mut notes)?;

    let inner = first.channels() as usize;
    let channels = stack.planes.size(Axis::Channel) * inner;
    let asked = selection.channel.unwrap_or(0);
    check_range("channel", asked, channels)?;
    let wanted = match selection.channel {
        None if first.colour => Wanted::Luminance,
        _ => Wanted::Channel(asked % inner),
    };
    if first.white_is_zero {
        notes.push("the file says that 0 is white; the values were inverted".to_owned());
    }
    let alternatives = channels / if first.colour { inner } else { 1 };
    if selection.channel.is_none() && alternatives > 1 {
        notes.push(format!("the first of {alternatives} channels was taken"));
    }
    let slices = stack.planes.size(Axis::Slice);
    check_range("frame", selection.frame, stack.planes.size(Axis::Frame))?;
    let depth = selection.depth.unwrap_or_default();
    let taken = match depth {
        Depth::Slice(slice) => {
            check_range("slice", slice, slices)?;
            slice..slice + 1
        }
        Depth::Maximum | Depth::Mean => 0..slices,
    };
    let mut canvas = Canvas::new(first.width as usize, first.height as usize, depth);
    let count = taken.len();
    for slice in taken {
        let page = stack.page(asked / inner, slice, selection.frame)?;
        let directory = &directories[page];
        let page = Page::read(&file, directory)?;
        if !page.is_like(&first) {
            return Err(PictureError::PagesDiffer { expected: first.words(), found: page.words() });
        }
        check_work(&page, count, wanted)?;
        canvas.next_slice();
        lay_page(&file, directory, &page, wanted, &mut canvas)?;
    }
    let coloured = canvas.coloured;
    let plane = canvas.finish()?;
    let samples = first.kind();
    let most = plane.values().iter().fold(0_f32, |most, value| most.max(value.abs()));
    if matches!(samples, Samples::Integer { .. }) && most > LARGEST_EXACT {
        notes.push(format!(
            "values above {LARGEST_EXACT} are rounded to 24 bits; the largest is {most}"
        ));
    }
    let pixel_size = pixel_size::choose(stack.sizes, &mut notes)?;
    let frames = stack.planes.size(Axis::Frame);
    let z_step_um =
        stack.z_step.and_then(|stated| pixel_size::plausible_z_step(stated, &mut notes));
    let frame_interval_s = stack.frame_interval_s.filter(|s| s.is_finite() && *s > 0.0);
    Ok(Picture {
        plane,
        pixel_size,
        samples,
        coloured,
        channels,
        choices: alternatives,
        frames,
        slices,
        frame_interval_s,
        z_step_um,
        notes,
    })
}

/// Which samples of a pixel are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wanted {
    Luminance,
    Channel(usize),
}

impl Wanted {
    /// Indices of the needed samples, opacity last.
    fn samples(self, page: &Page) -> Vec<u32> {
        let mut samples = match self {
            Wanted::Luminance => vec![0, 1, 2],
            Wanted::Channel(channel) => {
                let channel = channel as u32;
                let behind = page.alpha.is_some_and(|alpha| alpha <= channel);
                vec![channel + u32::from(behind)]
            }
        };
        samples.extend(page.alpha);
        samples
    }
}

/// Rejects reading `slices` pages like this one if it would take minutes.
fn check_work(page: &Page, slices: usize, wanted: Wanted) -> Result<(), PictureError> {
    let planes = if page.planar { wanted.samples(page).len() as u64 } else { 1 };
    let chunk = page.row_bytes().saturating_mul(u64::from(page.grid.rows));
    let chunks = planes.saturating_mul(page.grid.chunks()).saturating_mul(slices as u64);
    let work = chunk.saturating_add(WORK_OF_A_CHUNK).saturating_mul(chunks);
    if work <= MOST_WORK {
        return Ok(());
    }
    Err(PictureError::TooMuch {
        what: format!("decoding {chunks} strips or tiles of {chunk} bytes"),
        most: format!("{MOST_WORK} bytes (and {WORK_OF_A_CHUNK} for each) are allowed"),
        mend: "choose one slice, or cut out the cell",
    })
}

/// Decodes the needed chunks of a page.
fn lay_page(
    file: &File,
    directory: &Directory,
    page: &Page,
    wanted: Wanted,
    canvas: &mut Canvas,
) -> Result<(), PictureError> {
    let grid = page.grid;
    let samples = wanted.samples(page);
    let mut rows = vec![Vec::new(); if page.planar { samples.len() } else { 1 }];
    for index in 0..grid.chunks() {
        let left = (index % u64::from(grid.across)) as u32 * grid.columns;
        let top = (index / u64::from(grid.across)) as u32 * grid.rows;
        let visible = grid.rows.min(page.height - top);
        // The last strip ends with the page; a tile is always complete.
        let stored = if grid.tiled { grid.rows } else { visible };
        let decode = |plane: u64| {
            Chunk::decode(file, directory, page, plane * grid.chunks() + index, stored)
        };
        let chunks = if page.planar {
            samples
                .iter()
                .map(|&sample| decode(u64::from(sample)))
                .collect::<Result<Vec<_>, _>>()?
        } else {
            vec![decode(0)?]
        };
        for row in 0..visible {
            for (chunk, values) in chunks.iter().zip(&mut rows) {
                chunk.row(row as usize, values);
                if page.white_is_zero {
                    let white = ((1_u128 << page.bits) - 1) as f32;
                    for value in values.iter_mut() {
                        *value = white - *value;
                    }
                }
            }
            let strand = |number: usize| {
                if page.planar {
                    Strand { values: &rows[number], stride: 1, offset: 0 }
                } else {
                    let (stride, offset) = (page.samples as usize, samples[number] as usize);
                    Strand { values: &rows[0], stride, offset }
                }
            };
            let colours = match wanted {
                Wanted::Luminance => Colours::Rgb([strand(0), strand(1), strand(2)]),
                Wanted::Channel(_) => Colours::Grey(strand(0)),
            };
            let alpha = page.alpha.map(|_| strand(samples.len() - 1));
            let count = grid.columns.min(page.width - left) as usize;
            canvas.lay(left as usize, (top + row) as usize, count, &Row { colours, alpha });
        }
    }
    Ok(())
}
