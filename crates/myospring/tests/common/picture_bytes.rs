//! Any bytes as a picture, and as one that holds cells: an answer or an error, in little time and memory.

use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::cells::{PictureCells, PictureOptions};
use myospring::microscopy::picture::{Depth, Selection};
use myospring::microscopy::read::read_picture;
use myospring::microscopy::segment::{Choice, Modality, SegmentationSettings};

/// Most pixels that are also segmented, so that many pictures can be tried.
const FEW: usize = 1 << 14;

/// Reads the bytes in several ways and says in how many there was a picture.
pub(crate) fn exercise(bytes: &[u8]) -> usize {
    let maximum = Selection { depth: Some(Depth::Maximum), ..Selection::default() };
    let inner = Selection { channel: Some(1), frame: 1, depth: Some(Depth::Slice(1)) };
    let mut read = 0;
    for selection in [Selection::default(), maximum, inner] {
        let Ok(picture) = read_picture(bytes, &selection) else { continue };
        read += 1;
        if picture.plane.values().len() > FEW {
            continue;
        }
        for modality in [Modality::Mask, Modality::Fluorescence, Modality::Brightfield] {
            let segmentation = SegmentationSettings { modality, ..SegmentationSettings::default() };
            let options = PictureOptions {
                selection,
                pixel_size: Some(PixelSize::MICROMETRE),
                segmentation,
                ..PictureOptions::default()
            };
            if let Ok(cells) = PictureCells::find(bytes, &options) {
                let _ = cells.cell(Choice::Largest, true);
            }
        }
    }
    read
}
