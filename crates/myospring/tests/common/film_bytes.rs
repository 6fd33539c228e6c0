//! What is done with the bytes of a film that may be anything.

use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::film::Film;
use myospring::microscopy::picture::Selection;
use myospring::microscopy::segment::{Modality, SegmentationSettings};
use myospring::microscopy::stack::{Stack, StackOptions, StackSelection};

/// Most voxels of a stack in which a cell is also sought.
const FEW: usize = 1 << 14;

/// Reads the bytes as a film and the first frames of it; how many there were. Nothing may panic.
pub(crate) fn exercise(bytes: &[u8]) -> usize {
    let Ok(film) = Film::read(bytes.to_vec(), &Selection::default()) else { return 0 };
    (0..film.len().min(4)).filter(|&index| film.frame(index).is_ok()).count()
}

/// Reads the bytes as a stack in depth, and a small one's cell; how many slices there were. Nothing may panic.
pub(crate) fn exercise_stack(bytes: &[u8]) -> usize {
    let Ok(stack) = Stack::read(bytes.to_vec(), &StackSelection::default()) else { return 0 };
    let [columns, rows] = stack.size();
    if columns * rows * stack.slices() <= FEW {
        for modality in [Modality::Auto, Modality::Mask, Modality::Fluorescence] {
            let options = StackOptions {
                pixel_size: Some(PixelSize::MICROMETRE),
                z_step_um: Some(1.0),
                segmentation: SegmentationSettings { modality, ..SegmentationSettings::default() },
                allow_cut: true,
                ..StackOptions::default()
            };
            let _ = stack.cell(&options);
        }
    }
    stack.slices()
}
