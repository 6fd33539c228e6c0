//! Cells from masks and label images.

use myospring_core::mesh::pixel_size::PixelSize;
use std::collections::BTreeMap;

use super::{
    Confidence, LARGEST_LABEL, Modality, SegmentError, Segmentation, SegmentedCell, modality,
};
use crate::plane::Plane;
use crate::region::{Connectivity, Region};

/// An island smaller than the largest by this factor is a speck, not a cell.
const SPECKS_IN_A_CELL: usize = 50;

/// Reads the cells of a picture in which every value other than zero marks a cell. If there is only
/// one such value, or too many for labels (soft edges), the connected islands are the cells. Values
/// that are not whole, such as the luminance of colours, distinguish cells but are not labels.
pub(super) fn segment(plane: &Plane, pixel_size: PixelSize) -> Result<Segmentation, SegmentError> {
    let mut notes = Vec::new();
    let (width, height) = (plane.width(), plane.height());
    let no_label = |value: &f32| !(0.0..=LARGEST_LABEL as f32).contains(value);
    if let Some(at) = plane.values().iter().position(no_label) {
        let (column, row, value) = (at % width, at / width, plane.values()[at]);
        return Err(SegmentError::NoLabel { column, row, value });
    }
    let whole = plane.values().iter().all(|value| value.fract() == 0.0);
    // Adding zero turns -0 into 0.
    let mark = |value: &f32| if whole { *value as u32 } else { (value + 0.0).to_bits() };
    let values: Vec<u32> = plane.values().iter().map(mark).collect();
    let mut sizes: BTreeMap<u32, usize> = BTreeMap::new();
    for &value in values.iter().filter(|&&value| value != 0) {
        *sizes.entry(value).or_default() += 1;
    }
    let by_value = sizes.len() > 1 && modality::has_flat_labels(plane);
    if sizes.len() > 1 && !by_value {
        notes.push(format!(
            "the mask holds {} different values that are not 0, too many for labels: all count as cell",
            sizes.len()
        ));
    }
    let only = if sizes.len() == 1 { sizes.keys().next().copied() } else { None };
    let (marks, sizes) = if by_value {
        (values, sizes)
    } else {
        let islands = Region::new(width, height, values.iter().map(|&value| value != 0))
            .islands(Connectivity::Four);
        let largest = islands.list.iter().map(|island| island.pixels).max().unwrap_or(0);
        let sizes = (1..).zip(islands.list.iter().map(|island| island.pixels));
        let cells: BTreeMap<u32, usize> =
            sizes.filter(|&(_, pixels)| pixels * SPECKS_IN_A_CELL >= largest).collect();
        let specks = islands.list.len() - cells.len();
        if specks > 0 {
            notes.push(format!(
                "{specks} island(s) of less than 1/{SPECKS_IN_A_CELL} of the largest are too small for cells and were left out"
            ));
        }
        (islands.numbers, cells)
    };
    if sizes.is_empty() {
        return Err(SegmentError::NoCell {
            modality: "mask",
            threshold: "0".to_owned(),
            why: "every pixel is 0, the background".to_owned(),
            pixel_size,
        });
    }
    let mut order: Vec<(u32, usize)> = sizes.into_iter().collect();
    order.sort_by_key(|&(mark, pixels)| (std::cmp::Reverse(pixels), mark));
    let number: BTreeMap<u32, u32> = order.iter().map(|&(mark, _)| mark).zip(1..).collect();
    let numbers: Vec<u32> =
        marks.iter().map(|mark| number.get(mark).copied().unwrap_or(0)).collect();
    let on_frame = on_frame(&numbers, width, order.len());
    let cell = |(number, &(mark, pixels)): (u32, &(u32, usize))| SegmentedCell {
        number,
        label: if by_value { Some(mark) } else { only }.filter(|_| whole),
        pixels,
        area_um2: pixels as f64 * pixel_size.um().powi(2),
        pixels_on_the_frame: on_frame[number as usize],
        confidence: Confidence::full(),
    };
    let cells = (1..).zip(&order).map(cell).collect();
    let (modality, threshold) = (Modality::Mask, 0.0);
    let modality_reason = None;
    Ok(Segmentation {
        width,
        height,
        pixel_size,
        numbers,
        cells,
        modality,
        modality_reason,
        threshold,
        notes,
    })
}

/// Number of pixels of each cell on the frame of a picture, by the cell's number; 0 is the background.
fn on_frame(numbers: &[u32], width: usize, cells: usize) -> Vec<usize> {
    let mut on_frame = vec![0; cells + 1];
    for (at, &number) in numbers.iter().enumerate() {
        let (column, row) = (at % width, at / width);
        if column == 0 || row == 0 || column + 1 == width || row + 1 == numbers.len() / width {
            on_frame[number as usize] += 1;
        }
    }
    on_frame
}
