//! What must hold for any bytes that are given as outlines; tests and the fuzz target run it.

use myospring::mesh::mask::Mask;
use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::outlines::raster::{rasterise, write_labels_png};
use myospring::microscopy::outlines::trace::{Edge, trace_mask};
use myospring::microscopy::outlines::{
    CoordinateUnit, OutlineFormat, PixelFrame, Placement, ReadOptions, read_outlines_as,
    write_cellpose, write_geojson, write_roi_set,
};
use myospring::microscopy::report::shape_report;

/// Reads bytes whose first one picks the reader, and writes what was read in all formats.
///
/// # Panics
/// When something does not hold.
pub(crate) fn exercise(bytes: &[u8]) {
    let Some((pick, rest)) = bytes.split_first() else { return };
    let format = match pick % 5 {
        0 => OutlineFormat::ImageJRoi,
        1 => OutlineFormat::ImageJRoiSet,
        2 => OutlineFormat::GeoJson,
        3 => OutlineFormat::CellposeText,
        _ => return mask(rest),
    };
    let frame =
        PixelFrame::new(128, 96, PixelSize::new(0.5).expect("a pixel size")).expect("a frame");
    let pixel_size = frame.pixel_size();
    for (placement, silent_unit) in [
        (Placement::Picture(frame), CoordinateUnit::Micrometre),
        (Placement::Bounds { pixel_size }, CoordinateUnit::Pixel),
    ] {
        let options = ReadOptions { placement, silent_unit };
        let given = match read_outlines_as(format, rest, "fuzz.bin", &options) {
            Ok(given) => given,
            Err(error) => {
                assert!(!error.to_string().is_empty());
                continue;
            }
        };
        assert!(!given.outlines.is_empty());
        let same = ReadOptions { placement: Placement::Bounds { pixel_size }, silent_unit };
        let text = write_geojson(&given.outlines);
        let again = read_outlines_as(OutlineFormat::GeoJson, text.as_bytes(), "a", &same);
        assert_eq!(again.expect("our own GeoJSON").outlines, given.outlines);
        write_roi_set(&given.outlines, &frame).expect("a RoiSet");
        write_cellpose(&given.outlines, &frame).ok();
        write_labels_png(&given.outlines, &frame).ok();
        for cell in &given.outlines {
            assert!(cell.outline.area() >= 1.0);
            let report = shape_report(&cell.outline, Some(&frame));
            assert!(report.solidity > 0.0 && report.solidity < 1.0 + 1e-9, "{report}");
        }
    }
}

/// A small mask, whose width is the first byte: its largest part traced is the pixels again.
fn mask(bytes: &[u8]) {
    let Some((&width, rest)) = bytes.split_first() else { return };
    let width = usize::from(width % 32) + 1;
    let height = rest.len().min(1024) / width;
    let inside = rest[..width * height].iter().map(|&value| value % 4 == 1).collect();
    let pixel = PixelSize::new(2.0).expect("a pixel size");
    let Ok(mask) = Mask::new(width, height, pixel, inside) else { return };
    let frame = PixelFrame::of(&mask);
    trace_mask(&mask, Edge::Smooth).expect("a part of 4 um^2 or more");
    let exact = trace_mask(&mask, Edge::Exact).expect("a part of 4 um^2 or more");
    assert_eq!(rasterise(&exact, &frame).expect("neither empty nor full"), mask.largest_part().0);
}
