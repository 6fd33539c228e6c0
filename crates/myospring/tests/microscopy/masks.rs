//! Masks from pictures: every format and refusal, and two real cells.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::common::{self, pixels_of};

use myospring::mesh::lattice;
use myospring::microscopy::cells::{CellError, PictureCells, PictureOptions};
use myospring::microscopy::read::PictureError;
use myospring::microscopy::segment::{
    Choice, LARGEST_LABEL, Modality, Segmentation, SegmentationSettings,
};
use tiff::encoder::colortype::{Gray8, Gray16, Gray32, RGB8, RGB32Float, RGBA8};

fn options(pixel_size_um: f64) -> PictureOptions {
    let segmentation =
        SegmentationSettings { modality: Modality::Mask, ..SegmentationSettings::default() };
    PictureOptions {
        pixel_size: Some(pixels_of(pixel_size_um)),
        segmentation,
        ..PictureOptions::default()
    }
}

fn cells(bytes: &[u8]) -> Segmentation {
    let found = PictureCells::find(bytes, &options(0.5)).unwrap();
    found.segmentation().unwrap().clone()
}

fn labels(found: &Segmentation) -> Vec<Option<u32>> {
    found.cells.iter().map(|cell| cell.label).collect()
}

const SIZE: [u32; 2] = [20, 10];

/// A picture of 20 x 10 pixels with a cell in value 3 and a smaller one in value 7.
fn two_cells() -> Vec<u8> {
    drawn(SIZE, |x, y| match (x, y) {
        (2..12, 2..8) => 3,
        (15..18, 4..6) => 7,
        _ => 0,
    })
}

fn drawn([width, height]: [u32; 2], at: impl Fn(u32, u32) -> u8) -> Vec<u8> {
    (0..width * height).map(|pixel| at(pixel % width, pixel / width)).collect()
}

/// Grey as dark blue.
fn blue(grey: &[u8]) -> Vec<u8> {
    grey.iter().flat_map(|&value| [0, 0, value]).collect()
}

fn opaque(grey: &[u8]) -> Vec<u8> {
    grey.iter().flat_map(|&value| [value, value, value, 255]).collect()
}

/// The two cells as PNG.
fn two_cells_png() -> Vec<u8> {
    common::png(SIZE, 1, &two_cells())
}

/// The two cells as TIFF.
fn two_cells_tiff() -> Vec<u8> {
    common::tiff::<Gray8>(SIZE, &two_cells())
}

fn error(bytes: &[u8]) -> String {
    PictureCells::find(bytes, &options(0.5)).unwrap_err().to_string()
}

fn no_such(found: &Segmentation, label: u32) -> String {
    found.choose(Choice::Label(label), true).unwrap_err().to_string()
}

#[test]
fn non_zero_pixels_are_the_cell_in_every_kind_of_picture() {
    let grey = two_cells();
    let wide: Vec<u16> = grey.iter().map(|&value| u16::from(value) * 300).collect();
    let long: Vec<u32> = grey.iter().map(|&value| u32::from(value) * 70_000).collect();
    let expected: Vec<bool> = grey.iter().map(|&value| value != 0).collect();
    for (bytes, expected_labels) in [
        (common::png(SIZE, 1, &grey), [Some(3), Some(7)]),
        (common::tiff::<Gray8>(SIZE, &grey), [Some(3), Some(7)]),
        (common::wide_png(SIZE, &wide), [Some(900), Some(2100)]),
        (common::tiff::<Gray16>(SIZE, &wide), [Some(900), Some(2100)]),
        (common::tiff::<Gray32>(SIZE, &long), [Some(210_000), Some(490_000)]),
        // The luminance of dark blue is below one, and no label.
        (common::png(SIZE, 3, &blue(&grey)), [None, None]),
        (common::tiff::<RGB8>(SIZE, &blue(&grey)), [None, None]),
        (common::png(SIZE, 4, &opaque(&grey)), [Some(3), Some(7)]),
        (common::tiff::<RGBA8>(SIZE, &opaque(&grey)), [Some(3), Some(7)]),
    ] {
        let found = cells(&bytes);
        let inside: Vec<bool> = found.numbers.iter().map(|&number| number != 0).collect();
        assert_eq!((inside, labels(&found)), (expected.clone(), expected_labels.to_vec()));
    }
}

#[test]
fn a_mask_in_dark_colours_is_known_for_one() {
    let grey = two_cells();
    let painted = blue(&drawn([120, 60], |x, y| grey[(y / 6 * SIZE[0] + x / 6) as usize]));
    let unasked = PictureOptions { pixel_size: Some(pixels_of(0.5)), ..PictureOptions::default() };
    let found = PictureCells::find(&common::png([120, 60], 3, &painted), &unasked).unwrap();
    assert_eq!((found.modality(), found.len()), ("mask", 2));
}

#[test]
fn the_soft_edge_of_a_mask_is_no_label() {
    // A square whose rim of two pixels fades.
    let depth = |at: u32| at.min(59 - at);
    let soft = drawn([60, 60], |x, y| match depth(x).min(depth(y)) {
        0..10 => 0,
        10 => 85,
        11 => 170,
        _ => 255,
    });
    let found = cells(&common::png([60, 60], 1, &soft));
    assert_eq!((found.cells[0].pixels, labels(&found)), (1600, vec![None]));
}

#[test]
fn transparent_pixels_are_background() {
    let mut picture = opaque(&two_cells());
    for pixel in picture.chunks_exact_mut(4).filter(|pixel| pixel[0] == 7) {
        pixel[3] = 0;
    }
    let found = cells(&common::png(SIZE, 4, &picture));
    assert_eq!((found.cells[0].pixels, labels(&found)), (60, vec![Some(3)]));
}

#[test]
fn one_label_of_a_label_picture_is_one_cell() {
    let found = cells(&two_cells_tiff());
    let pixels = |label| found.choose(Choice::Label(label), false).unwrap().pixels;
    assert_eq!([pixels(7), pixels(3)], [6, 60]);
}

#[test]
fn labels_in_fewer_than_eight_bits_keep_their_value() {
    // PNG of 2 x 1 pixels in 4-bit grey with the values 0 and 5, written byte by byte.
    assert_eq!(labels(&cells(&png(2, 1, 4, 0, &[0x05]))), [Some(5)]);
    let found = cells(&png(2, 1, 1, 0, &[0b0100_0000]));
    assert_eq!((labels(&found), found.numbers), (vec![Some(1)], vec![0, 1]));
}

#[test]
fn a_label_that_is_not_there_lists_those_that_are() {
    let found = cells(&two_cells_png());
    let there = "is not in the picture, which holds 3, 7; 0 is the background";
    assert_eq!(no_such(&found, 4), format!("label 4 {there}"));
    assert_eq!(no_such(&found, 0), format!("label 0 {there}"));
    let many = drawn([20, 84], |_, y| y as u8 / 3);
    assert_eq!(
        no_such(&cells(&common::png([20, 84], 1, &many)), 200),
        "label 200 is not in the picture, which holds 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, ...; \
         0 is the background"
    );
    let colour: Vec<u8> = (0..600).flat_map(|pixel| [(pixel / 100) as u8, 0, 9]).collect();
    assert_eq!(
        no_such(&cells(&common::png([20, 30], 3, &colour)), 1),
        "label 1 is not in the picture, which holds no label; 0 is the background"
    );
}

#[test]
fn values_that_mark_no_cell_are_refused() {
    let refused = |value: f32| {
        let mut picture = [0.0; 600];
        picture[3 * (2 * 20 + 3)..][..3].fill(value);
        error(&common::tiff::<RGB32Float>(SIZE, &picture))
    };
    for value in [-1.0, LARGEST_LABEL as f32 + 1.0] {
        let start = format!("the pixel in column 3, row 2 is {value}, but a mask contains values");
        assert!(refused(value).starts_with(&start), "{}", refused(value));
    }
}

#[test]
fn an_empty_and_a_full_mask_are_refused() {
    let plain = |value| common::png([8, 4], 1, &[value; 32]);
    assert!(
        error(&plain(0)).starts_with("all 8 x 4 pixels have the same value, 0: no cell is visible")
    );
    assert!(error(&plain(255)).starts_with("all 8 x 4 pixels have the same value, 255"));
}

#[test]
fn what_is_not_a_picture_is_refused() {
    assert_eq!(
        error(b"hello, world"),
        "this is not a picture (12 bytes that start with \"hello, w\"); give a PNG or TIFF file"
    );
    assert_eq!(
        error(b""),
        "this is not a picture (0 bytes that start with \"\"); give a PNG or TIFF file"
    );
    assert_eq!(
        error(b"\xff\xd8\xff\xe0\0\x10JFIF\0"),
        "this is a JPEG picture, which cannot be read; save the original as PNG or TIFF without lossy compression \
         (lossy compression creates false edges, which remain when the picture is saved again)"
    );
}

#[test]
fn a_truncated_picture_is_refused_at_every_length() {
    for whole in [two_cells_png(), two_cells_tiff()] {
        // The last bytes of a PNG are its end mark, of a TIFF its directory.
        for length in 16..whole.len() - 16 {
            let error = PictureCells::find(&whole[..length], &options(0.5)).unwrap_err();
            let known = matches!(
                error,
                CellError::Picture(
                    PictureError::Unreadable { .. }
                        | PictureError::Pixels { .. }
                        | PictureError::TooLarge { .. }
                )
            );
            assert!(known, "{:?} cut to {length} bytes: {error}", &whole[..4]);
        }
    }
    let text = error(&two_cells_png()[..45]);
    assert!(text.starts_with("the PNG picture cannot be read: "), "{text}");
    assert!(text.ends_with("; is the file complete?"), "{text}");
}

#[test]
fn a_header_that_declares_too_many_pixels_is_refused_before_they_take_memory() {
    assert_eq!(
        error(&png(100_000, 100_000, 8, 0, &[0])),
        "the picture declares 100000 x 100000 pixels; at most 32768 per side and 100000000 in all \
         are read: cut out the cell"
    );
    let text = error(&png(20_000, 20_000, 8, 0, &[0]));
    assert!(text.starts_with("the picture declares 20000 x 20000 pixels"), "{text}");

    // A TIFF of 20 x 10 whose directory is changed to claim 100000 columns, rows and rows per strip.
    let mut bytes = two_cells_tiff();
    let directory = u32::from_le_bytes(bytes[4..8].try_into().unwrap()) as usize;
    for entry in bytes[directory + 2..].chunks_exact_mut(12) {
        if [256_u16, 257, 278].contains(&u16::from_le_bytes([entry[0], entry[1]])) {
            entry[2..12].copy_from_slice(&[4, 0, 1, 0, 0, 0, 0xa0, 0x86, 1, 0]);
        }
    }
    let text = error(&bytes);
    assert!(text.starts_with("the picture declares 100000 x 100000 pixels"), "{text}");
}

#[test]
fn the_long_axis_of_a_real_tear_drop_cell_is_found() {
    let Some(file) = common::shared_data("images/sarcgraph_e5_mask.png") else { return };
    let (_, report) = lattice::from_mask(&common::mask(file), None).unwrap();
    eprintln!("{report}");
    let size = report.dimensions;
    // From lower left to upper right in the picture; 110 x 77 um by hand.
    assert!((40.0..75.0).contains(&size.long_axis_deg), "{report}");
    assert!((size.length_um - 110.0).abs() < 4.0, "{report}");
    assert!((size.width_um - 77.0).abs() < 4.0, "{report}");
    assert!((report.source_area_um2 - 86_530.0 * 0.27 * 0.27).abs() < 20.0, "{report}");
    assert!(report.area_error_pct.abs() < 0.5, "{report}");
}

#[test]
fn a_real_rod_shaped_cell_has_its_measured_size() {
    let Some(file) = common::shared_data("images/contrax_brightfield_mask.png") else { return };
    let (_, report) = lattice::from_mask(&common::mask(file), None).unwrap();
    eprintln!("{report}");
    let size = report.dimensions;
    assert!((size.length_um - 94.0).abs() < 2.0, "{report}");
    assert!((size.width_um - 14.0).abs() < 1.5, "{report}");
    assert!(size.long_axis_deg.abs() < 5.0, "{report}");
    assert!(report.area_error_pct.abs() < 0.5 && !report.touches_frame, "{report}");
}

/// A grey PNG with one row of data, for headers that no encoder would write.
fn png(width: u32, height: u32, depth: u8, colour: u8, row: &[u8]) -> Vec<u8> {
    let mut header = Vec::new();
    header.extend(width.to_be_bytes());
    header.extend(height.to_be_bytes());
    header.extend([depth, colour, 0, 0, 0]);
    // zlib: header, one stored block with the filter byte in front, checksum (RFC 1950, 1951).
    let data: Vec<u8> = std::iter::once(0).chain(row.iter().copied()).collect();
    let length = data.len() as u16;
    let mut packed = vec![0x78, 0x01, 0x01];
    packed.extend(length.to_le_bytes());
    packed.extend((!length).to_le_bytes());
    packed.extend(&data);
    let (mut a, mut b) = (1_u32, 0_u32);
    for &byte in &data {
        a = (a + u32::from(byte)) % 65_521;
        b = (b + a) % 65_521;
    }
    packed.extend(((b << 16) | a).to_be_bytes());
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    for (name, content) in [(b"IHDR", &header), (b"IDAT", &packed), (b"IEND", &Vec::new())] {
        let body: Vec<u8> = name.iter().chain(content).copied().collect();
        bytes.extend((content.len() as u32).to_be_bytes());
        bytes.extend(&body);
        bytes.extend(common::png_checksum(&body).to_be_bytes());
    }
    bytes
}
