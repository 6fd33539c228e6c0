//! Slices to volumes in memory, and back to voxels that run upward.

use super::error::{MOST_VOXELS, StackError};
use super::options::FirstSlice;
use super::reading::{Scale, Stack};
use super::volume::Volume;
use crate::segment::{SegmentationSettings, is_taken_for_mask};
use crate::{filter, hot_pixels};
use myospring_core::interruption::Interruption;
use myospring_core::mesh::voxels::Block;

/// Whether the slices are those of a mask: each is one, or empty.
pub(super) fn is_mask(stack: &Stack) -> Result<bool, StackError> {
    let settings = SegmentationSettings::default();
    let mut any = false;
    // The middle first: most stacks are known by one slice.
    let middle = stack.slices() / 2;
    for index in std::iter::once(middle).chain(0..stack.slices()) {
        let plane = stack.slice(index)?;
        let empty = plane.range() == [0.0; 2];
        if !empty && !is_taken_for_mask(&plane, &settings) {
            return Ok(false);
        }
        any |= !empty;
    }
    Ok(any)
}

/// The stack as means over blocks of `factor` x `factor` pixels of each slice, hot pixels removed,
/// and notes on them.
pub(super) fn volume(
    stack: &Stack,
    scale: Scale,
    factor: usize,
    interruption: &Interruption,
) -> Result<(Volume<f32>, Vec<String>), StackError> {
    let [width, height] = stack.size().map(|side| side.div_ceil(factor));
    let size = [width, height, stack.slices()];
    let voxels = size.iter().map(|&count| count as f64).product();
    if voxels > MOST_VOXELS as f64 {
        return Err(StackError::TooLarge { voxels });
    }
    let mut values = Vec::with_capacity(size.iter().product());
    let mut hot = 0;
    for index in 0..stack.slices() {
        interruption.check()?;
        let plane = stack.slice(index)?;
        let cooled = hot_pixels::cooled(&plane);
        hot += usize::from(cooled.is_some());
        let plane = cooled.map_or(plane, |(plane, _)| plane);
        values.extend_from_slice(filter::coarse(&plane, factor).values());
    }
    let notes = (hot > 0)
        .then(|| format!("{hot} slice(s) had hot pixels, which were replaced by their neighbours"));
    let side = scale.pixel_size.um() * factor as f64;
    let pitch = [side, side, scale.z_step_um];
    Ok((Volume { size, pitch, values }, notes.into_iter().collect()))
}

/// A block of rows from the top of a picture of `height` rows and slices in the order of the file,
/// turned so that y and z run upward.
pub(super) fn upward(block: Block, slices: usize, height: usize, first_slice: FirstSlice) -> Block {
    let Block { first: [left, top, low], size, inside } = block;
    let [columns, rows, layers] = size;
    let turned = first_slice == FirstSlice::Top;
    let order = |z: usize| if turned { layers - 1 - z } else { z };
    let lines = (0..layers).flat_map(|z| (0..rows).map(move |y| order(z) * rows + rows - 1 - y));
    let line = |at: usize| inside[at * columns..][..columns].iter().copied();
    let upward = lines.flat_map(line).collect();
    let bottom = height - top - rows;
    let low = if turned { slices - low - layers } else { low };
    Block { first: [left, bottom, low], size, inside: upward }
}
