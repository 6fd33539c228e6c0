//! Reading pictures: every kind of PNG and TIFF, its metadata, and what is refused.
//!
//! The files in `pictures/` were written by tifffile with `pictures/make.py`; each pixel follows from its
//! place, so that the values here do not come from our own reader.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::common::{self, pixels_of};

use std::path::Path;

use myospring::microscopy::picture::{
    Depth, Picture, PixelSizeSource, Samples, Selection, StatedPixelSize,
};
use myospring::microscopy::read::{PictureError, read_picture};
use tiff::encoder::colortype::RGB8;

const FIRST: Selection = Selection { channel: None, frame: 0, depth: None };

fn file(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures").join(name)).unwrap()
}

fn read(name: &str, selection: &Selection) -> Picture {
    read_picture(&file(name), selection).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn error(bytes: &[u8], selection: &Selection) -> String {
    read_picture(bytes, selection).unwrap_err().to_string()
}

/// The pixel that `make.py` writes.
fn pixel(column: usize, row: usize) -> f32 {
    (16 * row + column) as f32
}

/// Every pixel is `value(column, row)` with columns and rows enlarged by `scale`.
fn check(name: &str, picture: &Picture, scale: usize, value: impl Fn(usize, usize) -> f32) {
    let plane = &picture.plane;
    assert_eq!((plane.width(), plane.height()), (9 * scale, 6 * scale), "{name}");
    for row in 0..plane.height() {
        for column in 0..plane.width() {
            let expected = value(column / scale, row / scale);
            assert_eq!(plane.at(column, row), expected, "{name}, column {column}, row {row}");
        }
    }
}

const STACKS: [(&str, PixelSizeSource); 4] = [
    ("ome_tzcyx.ome.tif", PixelSizeSource::OmeXml),
    ("ome_ctzyx.ome.tif", PixelSizeSource::OmeXml),
    ("ome_big.ome.tif", PixelSizeSource::OmeXml),
    ("imagej_tzcyx.tif", PixelSizeSource::ImageJ),
];

#[test]
fn every_plane_of_a_stack_is_found_in_every_order_of_its_axes() {
    for (name, source) in STACKS {
        for (frame, slice, channel) in
            (0..12).map(|number| (number / 6, number / 2 % 3, number % 2))
        {
            let depth = Some(Depth::Slice(slice));
            let picture = read(name, &Selection { channel: Some(channel), frame, depth });
            let shift = (1000 * channel + 100 * slice + 10 * frame) as f32;
            check(name, &picture, 1, |column, row| pixel(column, row) + shift);
            assert_eq!((picture.channels, picture.frames, picture.slices), (2, 2, 3), "{name}");
            let size = picture.pixel_size.unwrap();
            assert_eq!(size.source, source, "{name}");
            // ImageJ's resolution is a fraction of 32-bit numbers.
            assert!((size.size.um() - 0.27).abs() < 1e-8, "{name}: {size:?}");
            assert_eq!(picture.samples, Samples::Integer { bits: 16 });
            assert_eq!(picture.notes, Vec::<String>::new());
        }
    }
}

#[test]
fn slices_are_projected_to_their_maximum_or_mean() {
    for (name, _) in STACKS {
        let select = |depth| Selection { depth, frame: 1, ..FIRST };
        for depth in [None, Some(Depth::Maximum)] {
            let picture = read(name, &select(depth));
            check(name, &picture, 1, |column, row| pixel(column, row) + 210.0);
            assert_eq!(picture.notes, ["the first of 2 channels was taken"]);
        }
        let picture = read(name, &select(Some(Depth::Mean)));
        check(name, &picture, 1, |column, row| pixel(column, row) + 110.0);
    }
}

#[test]
fn a_plane_that_is_not_there_is_refused_with_the_number_of_those_that_are() {
    let bytes = file("imagej_tzcyx.tif");
    assert_eq!(
        error(&bytes, &Selection { frame: 7, ..FIRST }),
        "frame 7 was asked for, but the picture has 2 frames, 0 to 1"
    );
    assert_eq!(
        error(&bytes, &Selection { channel: Some(2), ..FIRST }),
        "channel 2 was asked for, but the picture has 2 channels, 0 to 1"
    );
    assert_eq!(
        error(&bytes, &Selection { depth: Some(Depth::Slice(3)), ..FIRST }),
        "slice 3 was asked for, but the picture has 3 slices, 0 to 2"
    );
    let png = common::png([3, 3], 1, &[0; 9]);
    for (selection, words) in [
        (
            Selection { frame: 1, ..FIRST },
            "frame 1 was asked for, but the picture has only frame 0",
        ),
        (
            Selection { channel: Some(1), ..FIRST },
            "channel 1 was asked for, but the picture has only channel 0",
        ),
        (
            Selection { depth: Some(Depth::Slice(1)), ..FIRST },
            "slice 1 was asked for, but the picture has only slice 0",
        ),
    ] {
        assert_eq!(error(&png, &selection), words);
        assert_eq!(error(&file("int8.tif"), &selection), words);
    }
}

#[test]
fn pages_without_meaning_are_frames_unless_a_depth_is_asked_for() {
    let note =
        |words| format!("the file does not say what its 3 pages are; they were taken as {words}");
    let name = "imagej_series.tif";
    let picture = read(name, &Selection { frame: 2, ..FIRST });
    check(name, &picture, 1, |column, row| pixel(column, row) + 20.0);
    assert_eq!((picture.frames, picture.slices), (3, 1));
    assert_eq!(picture.notes, [note("frames")]);
    let size = StatedPixelSize { size: pixels_of(0.25), source: PixelSizeSource::ImageJ };
    assert_eq!(picture.pixel_size, Some(size));

    let picture = read(name, &Selection { depth: Some(Depth::Mean), ..FIRST });
    check(name, &picture, 1, |column, row| pixel(column, row) + 10.0);
    assert_eq!((picture.frames, picture.slices), (1, 3));
    assert_eq!(picture.notes, [note("slices")]);
}

#[test]
fn every_kind_of_number_keeps_its_value() {
    let integer = |bits| Samples::Integer { bits };
    let float = |bits| Samples::Float { bits };
    for (name, samples, shift) in [
        ("int8.tif", integer(8), -60.0),
        ("int16.tif", integer(16), -60.0),
        ("int32.tif", integer(32), -60.0),
        ("int64.tif", integer(64), -60.0),
        ("uint32.tif", integer(32), 0.0),
        ("uint64.tif", integer(64), 0.0),
        ("float16.tif", float(16), -60.0),
        ("float64.tif", float(64), -60.0),
    ] {
        let picture = read(name, &FIRST);
        check(name, &picture, 1, |column, row| pixel(column, row) + shift);
        assert_eq!(picture.samples, samples, "{name}");
        assert_eq!(picture.notes, Vec::<String>::new(), "{name}");
    }
    let picture = read("white_is_zero.tif", &FIRST);
    check("white_is_zero.tif", &picture, 1, |column, row| 255.0 - pixel(column, row));
    assert_eq!(picture.notes, ["the file says that 0 is white; the values were inverted"]);
    let picture = read("one_bit.tif", &FIRST);
    let third = |column, row| if pixel(column, row) % 3.0 == 0.0 { 1.0 } else { 0.0 };
    check("one_bit.tif", &picture, 1, third);
    assert_eq!(picture.samples, integer(1));
    let picture = read("palette.tif", &FIRST);
    check("palette.tif", &picture, 1, |column, row| pixel(column, row) % 4.0);
}

#[test]
fn twelve_bits_in_one_and_a_half_bytes_are_taken_apart() {
    // Rows of 3 samples fill 5 bytes, the last half of them empty.
    let data = [0x12, 0x3a, 0xbc, 0xff, 0xf0, 0x00, 0x10, 0x02, 0x00, 0x30];
    let bytes = tiff(&[(256, 3), (257, 2), (258, 12), (262, 1), (277, 1)], &data);
    let picture = read_picture(&bytes, &FIRST).unwrap();
    let expected = [0x123, 0xabc, 0xfff, 0x001, 0x002, 0x003].map(|value: u16| f32::from(value));
    assert_eq!(picture.plane.values(), expected);
    assert_eq!(picture.samples, Samples::Integer { bits: 12 });
}

#[test]
fn tiles_strips_and_compression_change_nothing() {
    for name in ["tiles_lzw.tif", "tiles_deflate.tif", "tiles_packbits.tif"] {
        check(name, &read(name, &FIRST), 4, pixel);
    }
    let picture = read("float_predictor.tif", &FIRST);
    check("float_predictor.tif", &picture, 1, |column, row| pixel(column, row) / 8.0);
}

#[test]
fn samples_of_a_page_are_channels() {
    for channel in 0..3 {
        let select = Selection { channel: Some(channel), ..FIRST };
        let picture = read("planar_tiles.tif", &select);
        let shift = 1000.0 * channel as f32;
        check("planar_tiles.tif", &picture, 4, |column, row| pixel(column, row) + shift);
        assert_eq!(picture.channels, 3);
        if channel < 2 {
            let picture = read("chunky_channels.tif", &select);
            check("chunky_channels.tif", &picture, 1, |column, row| pixel(column, row) + shift);
        }
    }
    assert_eq!(read("planar_tiles.tif", &FIRST).notes, ["the first of 3 channels was taken"]);
}

#[test]
fn colour_becomes_luminance_and_its_channels_can_be_had() {
    for name in ["planar_rgb.tif", "ome_rgb.ome.tif", "rgba.tif"] {
        let picture = read(name, &FIRST);
        assert!(picture.coloured && picture.channels == 3, "{name}: {picture:?}");
        assert_eq!(picture.notes, Vec::<String>::new(), "{name}");
        let see_through = |column: usize| name == "rgba.tif" && column.is_multiple_of(2);
        for (column, row) in [(0, 0), (3, 2), (8, 5)] {
            // 0.2126 * 0 + 0.7152 * 50 + 0.0722 * 100 above red.
            let expected = if see_through(column) { 0.0 } else { pixel(column, row) + 42.98 };
            let found = picture.plane.at(column, row);
            // Products in f32 of numbers below 256.
            assert!((found - expected).abs() < 1e-4, "{name}: {found} for {expected}");
        }
        for channel in 0..3 {
            let picture = read(name, &Selection { channel: Some(channel), ..FIRST });
            let shift = 50.0 * channel as f32;
            check(name, &picture, 1, |column, row| {
                if see_through(column) { 0.0 } else { pixel(column, row) + shift }
            });
        }
    }
    // Grey as colour stays what it is, to the last digit.
    let grey: Vec<u8> = (0..54).flat_map(|at| [16 * (at / 9) + at % 9; 3]).collect();
    for bytes in [common::png([9, 6], 3, &grey), common::tiff::<RGB8>([9, 6], &grey)] {
        let picture = read_picture(&bytes, &FIRST).unwrap();
        check("grey as colour", &picture, 1, pixel);
        assert!(!picture.coloured && picture.channels == 3);
    }
}

#[test]
fn a_png_keeps_its_values() {
    let wide: Vec<u16> = (0..54).map(|at| 1000 * (at / 9) + at % 9).collect();
    let picture = read_picture(&common::wide_png([9, 6], &wide), &FIRST).unwrap();
    check("16 bits", &picture, 1, |column, row| (1000 * row + column) as f32);
    assert_eq!(picture.samples, Samples::Integer { bits: 16 });
    assert_eq!((picture.channels, picture.frames, picture.slices), (1, 1, 1));
}

#[test]
fn a_png_with_a_palette_is_its_colours_and_transparent_pixels_are_zero() {
    let picture = read("palette.png", &FIRST);
    assert!(picture.coloured && picture.channels == 3);
    let colours = [[0.0; 3], [255.0, 0.0, 0.0], [0.0, 255.0, 0.0], [7.0; 3]];
    for channel in 0..3 {
        let picture = read("palette.png", &Selection { channel: Some(channel), ..FIRST });
        check("palette.png", &picture, 1, |column, row| {
            colours[pixel(column, row) as usize % 4][channel]
        });
    }
    let picture = read("opacity.png", &FIRST);
    let odd = |column: usize| column % 2 == 1;
    check(
        "opacity.png",
        &picture,
        1,
        |column, row| if odd(column) { pixel(column, row) } else { 0.0 },
    );
    let picture = read("transparent_grey.png", &FIRST);
    let visible = |value| if value == 35.0 { 0.0 } else { value };
    check("transparent_grey.png", &picture, 1, |column, row| visible(pixel(column, row)));
}

#[test]
fn the_pixel_size_of_the_resolution_tags_is_believed_unless_it_is_a_print_setting() {
    let size = read("centimetre.tif", &FIRST).pixel_size.unwrap();
    assert_eq!(size.source, PixelSizeSource::TiffResolution);
    // The tag is a fraction of 32-bit numbers.
    assert!((size.size.um() - 0.27).abs() < 1e-8, "{size:?}");
    let picture = read("print.tif", &FIRST);
    assert_eq!(picture.pixel_size, None);
    assert_eq!(
        picture.notes,
        ["the TIFF resolution says 84.6667 um per pixel: outside 0.001 to 50 um, ignored"]
    );
}

#[test]
fn the_pixel_size_of_a_png_is_believed_unless_it_is_a_print_setting() {
    let with_size = |per_metre: [u32; 2]| {
        let png = common::png([3, 3], 1, &[0; 9]);
        let mut body = b"pHYs".to_vec();
        body.extend(per_metre.map(u32::to_be_bytes).concat());
        body.push(1);
        // Signature and header chunk are 33 bytes.
        let chunk =
            [&9_u32.to_be_bytes(), body.as_slice(), &common::png_checksum(&body).to_be_bytes()]
                .concat();
        [&png[..33], &chunk, &png[33..]].concat()
    };
    let picture = read_picture(&with_size([4_000_000; 2]), &FIRST).unwrap();
    let size = StatedPixelSize { size: pixels_of(0.25), source: PixelSizeSource::PngResolution };
    assert_eq!(picture.pixel_size, Some(size));
    for (per_metre, words) in
        [(2835, "outside 0.001 to 50 um"), (94488, "print setting of 2400 dpi")]
    {
        let picture = read_picture(&with_size([per_metre; 2]), &FIRST).unwrap();
        assert_eq!(picture.pixel_size, None);
        assert!(picture.notes[0].contains(words), "{:?}", picture.notes);
    }
    let text = error(&with_size([4_000_000, 2_000_000]), &FIRST);
    assert!(text.starts_with("the pixels are 0.25 um wide and 0.5 um high"), "{text}");
}

#[test]
fn pixels_that_are_not_square_are_refused() {
    assert_eq!(
        error(&file("ome_rectangular.ome.tif"), &FIRST),
        "the pixels are 0.27 um wide and 0.5 um high, but the mesh needs square ones: resample the \
         picture (Fiji: Image > Scale)"
    );
}

#[test]
fn thumbnails_and_pyramids_are_left_out() {
    let picture = read("thumbnail.tif", &Selection { frame: 1, ..FIRST });
    check("thumbnail.tif", &picture, 1, |column, row| pixel(column, row) + 10.0);
    assert_eq!(picture.frames, 2);
    assert_eq!(picture.notes[0], "1 pages of another size than the first were left out");
    let picture = read("pyramid.tif", &FIRST);
    check("pyramid.tif", &picture, 1, pixel);
    assert_eq!(picture.frames, 1);
}

#[test]
fn pixels_that_are_no_number_are_refused_with_their_place() {
    assert_eq!(
        error(&file("not_a_number.tif"), &FIRST),
        "1 pixels are infinite or not a number, the first at column 3, row 2; give them a value (Fiji: \
         Process > Filters > Remove NaNs)"
    );
}

#[test]
fn values_that_are_rounded_are_noted() {
    let note = &read("big_labels.tif", &FIRST).notes[0];
    assert!(note.starts_with("values above 16777216 are rounded to 24 bits"), "{note}");
}

#[test]
fn compressions_that_are_not_read_are_named() {
    assert_eq!(
        error(&file("zstd.tif"), &FIRST),
        "the TIFF picture is compressed with Zstandard, which cannot be read; save it without \
         compression, or with LZW or deflate"
    );
    assert!(error(&file("jpeg.tif"), &FIRST).contains("compressed with JPEG (lossy)"));
}

#[test]
fn other_files_are_named_with_what_to_do() {
    let lif = b"\x70\0\0\0\x10\0\0\0\x2a\0\0\0".to_vec();
    let dicom = [vec![0; 128], b"DICM".to_vec()].concat();
    for (bytes, name) in [
        (b"ZISRAWFILE\0\0\0".to_vec(), "Zeiss CZI"),
        (b"\xda\xce\xbe\x0a\0\0\0\0".to_vec(), "Nikon ND2"),
        (lif, "Leica LIF"),
        (dicom, "DICOM"),
    ] {
        let text = error(&bytes, &FIRST);
        let start = format!("this is a {name} file, which cannot be read; export it as OME-TIFF");
        assert!(text.starts_with(&start), "{text}");
    }
    for (bytes, name) in [
        (b"\xff\xd8\xff\xe0\0\x10JFIF\0".as_slice(), "JPEG"),
        (b"GIF89a\0\0", "GIF"),
        (b"BM\0\0\0\0\0\0", "BMP"),
        (b"RIFF\0\0\0\0WEBPVP8 ", "WEBP"),
    ] {
        let start = format!("this is a {name} picture, which cannot be read");
        assert!(error(bytes, &FIRST).starts_with(&start));
    }
    assert!(error(b"time_ms,length_um\n0,100\n", &FIRST).starts_with("this is not a picture (24"));
}

#[test]
fn a_truncated_file_is_refused_at_every_length() {
    for name in ["imagej_tzcyx.tif", "ome_big.ome.tif", "tiles_lzw.tif", "planar_tiles.tif"] {
        let whole = file(name);
        let needed = read_picture(&whole, &FIRST).unwrap();
        for length in (4..whole.len()).step_by(7) {
            match read_picture(&whole[..length], &FIRST) {
                // What is cut off may be a part that this plane does not need.
                Ok(picture) => assert_eq!(picture, needed, "{name} cut to {length} bytes"),
                Err(PictureError::Unreadable { format: "TIFF", .. }) => {}
                Err(error) => panic!("{name} cut to {length} bytes: {error}"),
            }
        }
        let text = error(&whole[..whole.len() / 3], &FIRST);
        assert!(text.ends_with("is the file complete?"), "{name}: {text}");
    }
}

#[test]
fn hostile_headers_are_refused_before_they_take_memory_or_time() {
    let plain = [(256, 4), (257, 4), (258, 8), (262, 1), (277, 1)];
    let with = |tag: u16, value: u32| {
        let mut tags: Vec<_> = plain.into_iter().filter(|&(known, _)| known != tag).collect();
        tags.push((tag, value));
        tags.sort_unstable();
        tiff(&tags, &[1; 16])
    };
    assert_eq!(read_picture(&tiff(&plain, &[1; 16]), &FIRST).unwrap().plane.values(), [1.0; 16]);
    for (tag, value, words) in [
        (256, 0, "it declares 0 x 4 pixels"),
        (256, u32::MAX, "the picture declares 4294967295 x 4 pixels"),
        (257, 30_000, "but the file has"),
        (258, 7000, "whole numbers of 7000 bits"),
        (262, 6, "colour model 6, YCbCr"),
        (277, 0, "0 samples per pixel"),
        (277, 60_000, "60000 samples per pixel"),
        (278, 0, "its strips or tiles are 4 x 0 pixels"),
        (278, 1, "strip or tile 1 is not in its list"),
        (317, 9, "predictor 9 with 8 bits"),
        (339, 6, "sample format 6"),
    ] {
        let text = error(&with(tag, value), &FIRST);
        assert!(text.contains(words), "tag {tag} = {value}: {text}");
    }
    // A tile of 30000 x 30000 in 16 bytes; a page list that runs in a circle.
    let tile = [(322, 30_000), (323, 30_000), (324, 8), (325, 16), (259, 8)];
    let tags = [plain.as_slice(), &tile].concat();
    assert!(error(&tiff(&tags, &[1; 16]), &FIRST).contains("858 MiB of memory at once"));
    let mut circle = tiff(&plain, &[1; 16]);
    let end = circle.len();
    circle[end - 4..].copy_from_slice(&24_u32.to_le_bytes());
    assert!(error(&circle, &FIRST).contains("its list of pages is circular"));
}

#[test]
fn an_entity_bomb_and_damaged_xml_do_no_harm() {
    let describe = |xml: &str| {
        let mut bytes = tiff(
            &[(256, 4), (257, 4), (258, 8), (262, 1), (270, xml.len() as u32), (277, 1)],
            &[1; 16],
        );
        let at = bytes.len() as u32;
        let entry = bytes.windows(2).position(|pair| pair == 270_u16.to_le_bytes()).unwrap();
        bytes[entry + 2..entry + 4].copy_from_slice(&2_u16.to_le_bytes());
        bytes[entry + 4..entry + 8].copy_from_slice(&(xml.len() as u32).to_le_bytes());
        bytes[entry + 8..entry + 12].copy_from_slice(&at.to_le_bytes());
        bytes.extend(xml.as_bytes());
        bytes
    };
    let bomb = r#"<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>
        <OME><Image><Pixels SizeC="&b;" SizeZ="1" SizeT="1"/></Image></OME>"#;
    let text = error(&describe(bomb), &FIRST);
    assert!(text.starts_with("the TIFF picture cannot be read: its OME-XML is damaged"), "{text}");
    let endless = r#"<OME><Image><Pixels SizeC="1" SizeZ="999999999" SizeT="1"/></Image></OME>"#;
    assert!(error(&describe(endless), &FIRST).contains("SizeZ is 999999999, outside 1 to 1000000"));
    let short = r#"<OME><Image><Pixels SizeC="1" SizeZ="3" SizeT="1"/></Image></OME>"#;
    assert!(error(&describe(short), &FIRST).starts_with(
        "the file declares channel 0, frame 0, slice 1, but none of its 1 pages contains them"
    ));
    let set = r#"<OME UUID="urn:uuid:1"><Image><Pixels SizeC="1" SizeZ="1" SizeT="2">
        <TiffData IFD="0" FirstT="0"><UUID FileName="a.ome.tif">urn:uuid:1</UUID></TiffData>
        <TiffData IFD="0" FirstT="1"><UUID FileName="b.ome.tif">urn:uuid:2</UUID></TiffData>
        </Pixels></Image></OME>"#;
    assert!(read_picture(&describe(set), &FIRST).is_ok());
    let text = error(&describe(set), &Selection { frame: 1, ..FIRST });
    assert!(text.contains("is in another file of the set, `b.ome.tif`"), "{text}");
}

#[test]
fn a_real_film_has_five_frames_and_no_pixel_size() {
    let Some(path) = common::shared_data("images/contrax_brightfield.tif") else { return };
    let bytes = std::fs::read(path).unwrap();
    let first = read_picture(&bytes, &FIRST).unwrap();
    assert_eq!((first.plane.width(), first.plane.height(), first.frames), (519, 184, 5));
    assert_eq!((first.pixel_size, first.slices, first.channels), (None, 1, 1));
    let last = read_picture(&bytes, &Selection { frame: 4, ..FIRST }).unwrap();
    // Corners and the middle as tifffile reads them.
    let corners = |picture: &Picture| {
        [(0, 0), (518, 0), (0, 183), (518, 183), (259, 92)]
            .map(|(column, row)| picture.plane.at(column, row))
    };
    assert_eq!(corners(&first), CORNERS[0]);
    assert_eq!(corners(&last), CORNERS[1]);
    assert_eq!(
        error(&bytes, &Selection { frame: 7, ..FIRST }),
        "frame 7 was asked for, but the picture has 5 frames, 0 to 4"
    );
}

const CORNERS: [[f32; 5]; 2] =
    [[192.0, 184.0, 186.0, 193.0, 168.0], [185.0, 184.0, 186.0, 196.0, 204.0]];

/// A little-endian TIFF with one strip: the data from byte 8, then the directory. Tags of strips that are
/// not given fit the data.
fn tiff(tags: &[(u16, u32)], data: &[u8]) -> Vec<u8> {
    let mut tags = tags.to_vec();
    for (tag, value) in [(273, 8), (279, data.len() as u32)] {
        if !tags.iter().any(|&(known, _)| known == tag || known == 324) {
            tags.push((tag, value));
        }
    }
    tags.sort_unstable();
    let mut bytes = b"II*\0".to_vec();
    bytes.extend((8 + data.len() as u32).to_le_bytes());
    bytes.extend(data);
    bytes.extend((tags.len() as u16).to_le_bytes());
    for (tag, value) in tags {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(4_u16.to_le_bytes());
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend(0_u32.to_le_bytes());
    bytes
}
