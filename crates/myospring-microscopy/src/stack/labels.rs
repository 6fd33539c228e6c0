//! One cell of a mask or a label stack, voxel by voxel.

use super::error::{MOST_VOXELS, StackError};
use super::load::upward;
use super::options::StackOptions;
use super::reading::{Scale, Stack};
use super::report::StackReport;
use crate::plane::Plane;
use crate::segment::{
    Confidence, LARGEST_LABEL, Modality, SegmentError, Segmentation, SegmentedCell, has_flat_labels,
};
use myospring_core::mesh::voxels::{Block, Voxels, parts};
use std::collections::BTreeMap;
use std::ops::Range;

/// A part smaller than the largest by this factor is a speck, not a cell.
const SPECKS_IN_A_CELL: usize = 50;

/// What the slices hold.
struct Contents {
    /// Columns, rows and slices that hold a value other than 0.
    bounds: [Range<usize>; 3],
    /// Number of voxels of each value.
    sizes: BTreeMap<u32, usize>,
    /// Whether the values are labels.
    labels: bool,
}

/// The cell that was chosen, and what is known of it.
pub(super) fn cell(
    stack: &Stack,
    scale: Scale,
    options: &StackOptions,
) -> Result<(Voxels, StackReport), StackError> {
    let interruption = &options.segmentation.interruption;
    let contents = Contents::of(stack, options)?;
    let size = [0, 1, 2].map(|axis| contents.bounds[axis].len());
    let voxels: f64 = size.iter().map(|&count| count as f64).product();
    if voxels > MOST_VOXELS as f64 {
        return Err(StackError::TooLarge { voxels });
    }
    let mut marks = Vec::with_capacity(size.iter().product());
    for index in contents.bounds[2].clone() {
        interruption.check()?;
        let plane = stack.slice(index)?;
        for row in contents.bounds[1].clone() {
            let row = &plane.values()[row * plane.width()..][contents.bounds[0].clone()];
            marks.extend(row.iter().map(|&value| mark(value)));
        }
    }
    let (names, found) = contents.cells(marks, size);
    let seen = Seen { names: &names, size, bounds: &contents.bounds };
    let above = seen.projected(stack.size(), scale, &found);
    let number = above.choose(options.choice, options.allow_cut)?.number;
    let name = found[number as usize - 1].name;
    let inside: Vec<bool> = names.iter().map(|&other| other == name).collect();
    let first = contents.bounds.clone().map(|range| range.start);
    let [width, height] = stack.size();
    let block = Block { first, size, inside };
    let block = upward(block, stack.slices(), height, options.first_slice);
    let pixel = scale.pixel_size.um();
    let pitch = [pixel, pixel, scale.z_step_um];
    let all = Voxels::of_block([width, height, stack.slices()], pitch, block)?;
    let (voxels, dropped) = all.largest_part();
    let mut report = StackReport::new(scale, Modality::Mask);
    report.dropped = dropped;
    report.cells = found.len();
    Ok((voxels, report))
}

/// A value as a mark; 0 is the background.
fn mark(value: f32) -> u32 {
    // Adding zero turns -0 into 0.
    if value.fract() == 0.0 { value as u32 } else { (value + 0.0).to_bits() }
}

/// One cell.
struct Found {
    name: u32,
    label: Option<u32>,
    voxels: usize,
}

impl Contents {
    fn of(stack: &Stack, options: &StackOptions) -> Result<Self, StackError> {
        let mut sizes: BTreeMap<u32, usize> = BTreeMap::new();
        let [columns, rows] = stack.size();
        // Empty, until a place widens them.
        let mut bounds = [columns, rows, stack.slices()].map(|count| count..0);
        let mut fullest: Option<(usize, Plane)> = None;
        let mut whole = true;
        for slice in 0..stack.slices() {
            options.segmentation.interruption.check()?;
            let plane = stack.slice(slice)?;
            let width = plane.width();
            let mut count = 0;
            for (at, &value) in plane.values().iter().enumerate().filter(|(_, v)| **v != 0.0) {
                let place = [at % width, at / width, slice];
                if !(0.0..=LARGEST_LABEL as f32).contains(&value) {
                    let [column, row, _] = place;
                    let cause = SegmentError::NoLabel { column, row, value };
                    return Err(StackError::NoLabel { slice, cause });
                }
                whole &= value.fract() == 0.0;
                *sizes.entry(mark(value)).or_default() += 1;
                count += 1;
                for (bounds, place) in bounds.iter_mut().zip(place) {
                    *bounds = bounds.start.min(place)..bounds.end.max(place + 1);
                }
            }
            if count > fullest.as_ref().map_or(0, |(most, _)| *most) {
                fullest = Some((count, plane));
            }
        }
        let Some((_, plane)) = fullest else {
            return Err(SegmentError::NoCell {
                modality: "mask",
                threshold: "0".to_owned(),
                why: "every voxel is 0, the background".to_owned(),
                pixel_size: stack.scale(options)?.pixel_size,
            }
            .into());
        };
        let labels = whole && sizes.len() > 1 && has_flat_labels(&plane);
        Ok(Self { bounds, sizes, labels })
    }

    /// The name of the cell of each voxel, and the cells, largest first: labels, or connected parts
    /// of everything that is not 0.
    fn cells(&self, marks: Vec<u32>, size: [usize; 3]) -> (Vec<u32>, Vec<Found>) {
        let (names, mut found) = if self.labels {
            let of_label = |(&label, &voxels): (&u32, &usize)| Found {
                name: label,
                label: Some(label),
                voxels,
            };
            (marks, self.sizes.iter().map(of_label).collect::<Vec<_>>())
        } else {
            let inside: Vec<bool> = marks.into_iter().map(|mark| mark != 0).collect();
            let (names, sizes) = parts(size, &inside);
            let largest = sizes.iter().copied().max().unwrap_or(0);
            let label =
                if self.sizes.len() == 1 { self.sizes.keys().next().copied() } else { None };
            let of_part = |(name, voxels)| Found { name, label, voxels };
            let found = (1..).zip(sizes).map(of_part);
            (names, found.filter(|part| part.voxels * SPECKS_IN_A_CELL >= largest).collect())
        };
        found.sort_by_key(|found| (std::cmp::Reverse(found.voxels), found.name));
        (names, found)
    }
}

/// The cells in their box.
struct Seen<'a> {
    names: &'a [u32],
    size: [usize; 3],
    bounds: &'a [Range<usize>; 3],
}

impl Seen<'_> {
    /// The cells as seen from above: in each column the one with the most voxels.
    fn projected(
        &self,
        [width, height]: [usize; 2],
        scale: Scale,
        found: &[Found],
    ) -> Segmentation {
        let numbered: BTreeMap<u32, u32> = found.iter().map(|found| found.name).zip(1..).collect();
        let mut numbers = vec![0; width * height];
        let mut on_sides = vec![0; found.len() + 1];
        let layer = self.size[0] * self.size[1];
        let mut counts: Vec<(u32, usize)> = Vec::new();
        for at in 0..layer {
            counts.clear();
            for name in self.names[at..].iter().step_by(layer) {
                let Some(&number) = numbered.get(name) else { continue };
                match counts.iter_mut().find(|(other, _)| *other == number) {
                    Some((_, count)) => *count += 1,
                    None => counts.push((number, 1)),
                }
            }
            let column = self.bounds[0].start + at % self.size[0];
            let row = self.bounds[1].start + at / self.size[0];
            let on_side = column == 0 || row == 0 || column + 1 == width || row + 1 == height;
            for &(number, count) in counts.iter().filter(|_| on_side) {
                on_sides[number as usize] += count;
            }
            let most =
                counts.iter().max_by_key(|(number, count)| (*count, std::cmp::Reverse(*number)));
            numbers[row * width + column] = most.map_or(0, |(number, _)| *number);
        }
        let mut pixels = vec![0; found.len() + 1];
        for &number in &numbers {
            pixels[number as usize] += 1;
        }
        let area = scale.pixel_size.um().powi(2);
        let cells = (1..).zip(found).map(|(number, found)| SegmentedCell {
            number,
            label: found.label,
            pixels: found.voxels,
            area_um2: f64::from(pixels[number as usize]) * area,
            pixels_on_the_frame: on_sides[number as usize],
            confidence: Confidence::full(),
        });
        let cells = cells.collect();
        Segmentation {
            width,
            height,
            pixel_size: scale.pixel_size,
            numbers,
            cells,
            modality: Modality::Mask,
            modality_reason: None,
            threshold: 0.0,
            notes: Vec::new(),
        }
    }
}
