//! Outlines drawn elsewhere: every format read and written.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::common::pixels_of;
use crate::outline_files;

use myospring::mesh::built_in;
use myospring::mesh::mask::Mask;
use myospring::microscopy::cells::{PictureCells, PictureOptions};
use myospring::microscopy::outlines::raster::{rasterise, write_labels_png, write_mask_png};
use myospring::microscopy::outlines::trace::{Edge, trace_mask};
use myospring::microscopy::outlines::{
    CoordinateUnit, NamedOutline, PixelFrame, Placement, ReadOptions, read_outlines,
    write_cellpose, write_geojson, write_roi, write_roi_set,
};
use myospring::microscopy::picture::Selection;
use myospring::microscopy::plane::Plane;
use myospring::microscopy::read::read_picture;
use outline_files::{
    PIXEL_UM, close, fixture, frame, names, options, outline, read, refused, zipped,
};

/// Area in pixels.
fn pixels(cell: &NamedOutline) -> f64 {
    cell.outline.area() / (PIXEL_UM * PIXEL_UM)
}

/// Bounding box in pixels, y downward: left, top, right, bottom.
fn bounds(cell: &NamedOutline) -> [f64; 4] {
    let [low, high] = cell.outline.bounds();
    let ([left, bottom], [right, top]) = (frame().to_pixels(low), frame().to_pixels(high));
    [left, top, right, bottom]
}

/// The label picture of `make.py` with its cells by label, along the edges of their pixels.
fn labels() -> (Plane, PixelFrame, Vec<NamedOutline>) {
    let options =
        PictureOptions { pixel_size: Some(pixels_of(PIXEL_UM)), ..PictureOptions::default() };
    let found = PictureCells::find(&fixture("labels.png"), &options).unwrap();
    let mut cells = found.outlines();
    cells.sort_by_key(|cell| cell.name.parse::<u32>().unwrap());
    assert_eq!(names(&cells), ["1", "2", "7"]);
    let frame = found.frame().unwrap();
    (found.plane, frame, cells)
}

fn label_mask(plane: &Plane, label: f32) -> Vec<bool> {
    plane.values().iter().map(|&value| value == label).collect()
}

// ImageJ.

#[test]
fn every_kind_of_closed_roi_lies_where_imagej_has_it() {
    use std::f64::consts::PI;
    // Area and box by hand from the numbers in make.py; pixel corners are whole numbers.
    for (file, name, area, sides) in [
        ("polygon", "Zelle α", 550.0, [10.0, 20.0, 50.0, 40.0]),
        ("freehand", "freehand", 550.0, [10.0, 20.0, 50.0, 40.0]),
        ("rectangle", "rectangle", 30.0 * 12.0, [10.0, 20.0, 40.0, 32.0]),
        ("fine_rectangle", "fine rectangle", 30.0 * 12.5, [10.5, 20.25, 40.5, 32.75]),
        ("oval", "oval", PI * 20.0 * 10.0, [10.0, 20.0, 50.0, 40.0]),
        ("traced", "wand", 9.0 + 16.0, [2.0, 2.0, 9.0, 9.0]),
    ] {
        let cells = read(&fixture(&format!("{file}.roi"))).unwrap().outlines;
        assert_eq!(names(&cells), [name], "{file}");
        // An ellipse of 360 sides is 0.005 % small.
        assert!((pixels(&cells[0]) / area - 1.0).abs() < 1e-4, "{file}: {}", pixels(&cells[0]));
        assert!(close(&bounds(&cells[0]), &sides, 1e-9), "{file}: {:?}", bounds(&cells[0]));
    }
}

#[test]
fn sub_pixel_points_come_before_whole_ones() {
    let cell = read(&fixture("fine.roi")).unwrap().outlines.remove(0);
    assert!(close(&bounds(&cell), &[10.25, 20.5, 50.75, 40.0], 1e-9));
    let expected = [[10.25, 20.5], [50.75, 20.5], [50.0, 30.125], [20.0, 40.0]];
    for point in expected.map(|point| frame().to_um(point)) {
        assert!(cell.outline.exterior().contains(&point), "{point:?}");
    }
}

#[test]
fn ellipses_and_rectangles_may_be_rotated() {
    use std::f64::consts::PI;
    // Both about the line of 50 pixels from (10, 10) to (50, 40).
    let ellipse = read(&fixture("ellipse.roi")).unwrap().outlines.remove(0);
    assert!((pixels(&ellipse) / (PI * 25.0 * 12.5) - 1.0).abs() < 1e-4);
    let rectangle = read(&fixture("rotated_rectangle.roi")).unwrap().outlines.remove(0);
    assert!((pixels(&rectangle) - 50.0 * 12.0).abs() < 1e-3);
    for cell in [&ellipse, &rectangle] {
        let centre = frame().to_pixels(cell.outline.centroid());
        assert!(close(&centre, &[30.0, 25.0], 1e-6), "{centre:?}");
        let angle = myospring::mesh::quality::outline_dimensions(&cell.outline).long_axis_deg;
        // y is turned upward.
        assert!((angle + 30.0_f64.atan2(40.0).to_degrees()).abs() < 1e-6, "{angle}");
    }
}

#[test]
fn a_composite_keeps_its_hole_and_gives_its_parts_apart() {
    let cells = read(&fixture("composite.roi")).unwrap().outlines;
    assert_eq!(names(&cells), ["composite-1", "composite-2"]);
    assert_eq!(cells[0].outline.holes().len(), 1);
    assert!((pixels(&cells[0]) - 800.0).abs() < 1e-9);
    assert!(cells[1].outline.holes().is_empty());
    // A curve bulges beyond the chord from (60, 10) to (60, 40), up to 0.75 of its control points.
    assert!((bounds(&cells[1])[2] - 67.5).abs() < 0.1, "{:?}", bounds(&cells[1]));
}

#[test]
fn rois_that_enclose_nothing_are_refused_by_name() {
    for kind in ["line", "point", "angle"] {
        assert_eq!(
            refused(&fixture(&format!("{kind}.roi"))),
            format!(
                "some/cell.file is an ImageJ {kind} ROI, which is not the outline of a cell; draw round the \
                 cell with a polygon, freehand or brush tool"
            )
        );
    }
    let mut spline = fixture("polygon.roi");
    spline[51] |= 1;
    let message = refused(&spline);
    assert!(message.contains("spline-fitted") && message.contains("Create Mask"), "{message}");
    let mut rounded = fixture("rectangle.roi");
    rounded[55] = 5;
    assert!(refused(&rounded).contains("rounded rectangle"));
    let mut unknown = fixture("polygon.roi");
    unknown[6] = 77;
    assert!(refused(&unknown).contains("77 is not a kind of ROI"));
}

#[test]
fn a_roi_set_keeps_names_and_says_what_it_leaves_out() {
    let given = read(&fixture("RoiSet.zip")).unwrap();
    assert_eq!(names(&given.outlines), ["Zelle α", "composite-1", "composite-2", "oval"]);
    assert_eq!(given.notes, ["0001-line.roi is an ImageJ line ROI and was left out"]);
}

#[test]
fn a_roi_without_a_name_takes_that_of_its_file() {
    let mut bytes = fixture("rectangle.roi");
    bytes[60..64].fill(0);
    assert_eq!(names(&read(&bytes).unwrap().outlines), ["cell"]);
}

#[test]
fn a_set_of_lines_alone_says_what_it_found() {
    let bytes = zipped(&[("a.roi", fixture("line.roi")), ("b.roi", fixture("point.roi"))]);
    assert_eq!(
        refused(&bytes),
        "the file holds no outline of a cell: a.roi is an ImageJ line ROI and was left out; b.roi is an \
         ImageJ point ROI and was left out"
    );
}

// Round trips.

/// Two cells, one with a hole, at odd places.
fn two_cells() -> Vec<NamedOutline> {
    let hole = vec![[5.1, 5.2], [7.3, 5.4], [6.2, 7.7]];
    let first = vec![[2.3, 3.1], [14.7, 4.2], [15.9, 12.6], [3.3, 11.8]];
    let second = vec![[20.11, 5.27], [36.4, 8.19], [30.33, 22.77]];
    vec![
        NamedOutline { name: "with hole".to_owned(), outline: outline(first, vec![hole]) },
        NamedOutline { name: "ü, 2".to_owned(), outline: outline(second, vec![]) },
    ]
}

fn assert_same(found: &[NamedOutline], expected: &[NamedOutline], tolerance: f64) {
    assert_eq!(names(found), names(expected));
    for (found, expected) in found.iter().zip(expected) {
        let rings =
            |cell: &NamedOutline| cell.outline.rings().map(<[_]>::to_vec).collect::<Vec<_>>();
        assert_eq!(rings(found).len(), rings(expected).len());
        for (a, b) in rings(found).iter().zip(&rings(expected)) {
            // A ring may start anywhere.
            let start = (0..b.len()).find(|&start| close(&a[0], &b[start], tolerance));
            let mut turned = b.clone();
            turned.rotate_left(start.expect("the first point is there"));
            assert!(close(a.as_flattened(), turned.as_flattened(), tolerance), "{a:?} {turned:?}");
        }
    }
}

#[test]
fn geojson_in_um_reads_back_to_the_same_numbers() {
    let text = write_geojson(&two_cells());
    assert_eq!(read(text.as_bytes()).unwrap().outlines, two_cells());
}

#[test]
fn rois_read_back_to_single_precision() {
    for cell in two_cells() {
        let bytes = write_roi(&cell, &frame());
        // 80 pixels times the rounding of single precision, 6e-8.
        assert_same(&read(&bytes).unwrap().outlines, &[cell], 5e-6);
    }
    let set = write_roi_set(&two_cells(), &frame()).unwrap();
    let expected: Vec<NamedOutline> = two_cells();
    assert_same(&read(&set).unwrap().outlines, &expected, 5e-6);
}

#[test]
fn names_that_repeat_or_lead_elsewhere_are_made_safe_in_a_set() {
    let mut cells = two_cells();
    cells[0].name = "../cell".to_owned();
    cells[1].name = "../cell".to_owned();
    let set = write_roi_set(&cells, &frame()).unwrap();
    assert_eq!(names(&read(&set).unwrap().outlines), [".._cell", ".._cell-2"]);
}

#[test]
fn traced_outlines_are_written_as_traced_rois_of_whole_numbers() {
    let (_, frame, mut cells) = labels();
    let cell = cells.remove(0);
    let bytes = write_roi(&cell, &frame);
    assert_eq!((bytes[6], &bytes[50..52]), (8, &[0, 0][..]));
    let options = ReadOptions { placement: Placement::Picture(frame), ..options() };
    let back = read_outlines(&bytes, "a.roi", &options).unwrap().outlines;
    assert_same(&back, &[cell], 1e-9);
}

#[test]
fn a_label_picture_reads_back_to_the_same_outlines() {
    let (plane, frame, cells) = labels();
    assert_eq!(cells[1].outline.holes().len(), 1);
    let png = write_labels_png(&cells, &frame).unwrap();
    for (index, label) in [1.0, 2.0, 7.0].into_iter().enumerate() {
        assert_eq!(with_value(&png, index as f32 + 1.0), label_mask(&plane, label));
        let mask = write_mask_png(&cells[index], &frame).unwrap();
        assert_eq!(with_value(&mask, 255.0), label_mask(&plane, label));
    }
}

/// Which pixels of a picture have this value.
fn with_value(png: &[u8], value: f32) -> Vec<bool> {
    let plane = read_picture(png, &Selection::default()).unwrap().plane;
    plane.values().iter().map(|&other| other == value).collect()
}

#[test]
fn many_labels_take_sixteen_bits() {
    let frame = PixelFrame::new(600, 2, pixels_of(2.0)).unwrap();
    let square = |x: f64| vec![[x, 0.0], [x + 2.0, 0.0], [x + 2.0, 2.0], [x, 2.0]];
    let cell = |index: usize| NamedOutline {
        name: index.to_string(),
        outline: outline(square(4.0 * index as f64), vec![]),
    };
    let cells: Vec<NamedOutline> = (0..300).map(cell).collect();
    let png = write_labels_png(&cells, &frame).unwrap();
    let last = with_value(&png, 300.0);
    assert!(last[600 + 598] && last.iter().filter(|&&is| is).count() == 1);
}

// Cellpose.

#[test]
fn cellposes_outlines_are_those_of_its_masks() {
    let (plane, frame, _) = labels();
    let options = ReadOptions { placement: Placement::Picture(frame), ..options() };
    let given = read_outlines(&fixture("cellpose_outlines.txt"), "x", &options).unwrap();
    assert_eq!(names(&given.outlines), ["1", "2", "3"]);
    for (cell, label) in given.outlines.iter().zip([1.0, 2.0, 7.0]) {
        let mask = Mask::new(64, 48, pixels_of(PIXEL_UM), label_mask(&plane, label)).unwrap();
        let traced = trace_mask(&mask, Edge::Exact).unwrap();
        let filled = outline(traced.exterior().to_vec(), vec![]);
        assert_eq!(
            rasterise(&cell.outline, &frame).unwrap(),
            rasterise(&filled, &frame).unwrap(),
            "label {label}"
        );
        assert!((cell.outline.area() - filled.area()).abs() < 1e-9);
    }
}

#[test]
fn outlines_are_written_with_the_pixels_that_opencv_finds() {
    let (_, frame, cells) = labels();
    let pixels = |text: &str| -> Vec<std::collections::BTreeSet<(u32, u32)>> {
        text.lines()
            .map(|line| {
                let numbers: Vec<u32> = line.split(',').map(|n| n.parse().unwrap()).collect();
                numbers.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect()
            })
            .collect()
    };
    let theirs = String::from_utf8(fixture("cellpose_outlines.txt")).unwrap();
    let ours = write_cellpose(&cells, &frame).unwrap();
    assert_eq!(pixels(&ours), pixels(&theirs));
}

#[test]
fn cellpose_points_that_were_thinned_out_are_middles_of_pixels() {
    let cells = read(b"10,10,30,10,30,20,10,20\n").unwrap().outlines;
    assert!(close(&bounds(&cells[0]), &[10.5, 10.5, 30.5, 20.5], 1e-9));
}

#[test]
fn a_line_of_points_that_cannot_be_read_is_named() {
    for (text, problem) in [
        ("1,1,2,1,2\n", "line 1 of the list of outlines has 5 numbers, an odd count"),
        ("\n1,1,x,1\n", "line 2 of the list of outlines has `x` where a number should be"),
        ("1,1,nan,1\n", "`nan` where a number should be"),
        ("1,1,,1\n", "`` where a number should be"),
    ] {
        let message = refused(text.as_bytes());
        // A blank first line is no reason to take the text for something else.
        assert!(message.contains(problem), "{message}");
    }
    assert!(refused(b"5,5\n").contains("1 um^2") || refused(b"5,5\n").contains("um^2"));
}

// GeoJSON.

fn feature(properties: &str, corners: &str) -> String {
    format!(
        r#"{{"type":"Feature","properties":{properties},"geometry":{{"type":"Polygon","coordinates":[{corners}]}}}}"#
    )
}

const CORNERS: &str = "[[4,8],[24,8],[24,18],[4,18],[4,8]]";
const PIXELS: [[f64; 2]; 2] = [[2.0, 21.0], [12.0, 26.0]];
const UM: [[f64; 2]; 2] = [[4.0, 8.0], [24.0, 18.0]];

#[test]
fn a_geojson_says_in_which_unit_it_is() {
    let collection = |unit: &str, properties: &str| {
        format!(
            r#"{{"type":"FeatureCollection",{unit}"features":[{}]}}"#,
            feature(properties, CORNERS)
        )
    };
    for (text, expected) in [
        (feature("{}", CORNERS), UM),
        (feature("null", CORNERS), UM),
        (feature(r#"{"unit":"um"}"#, CORNERS), UM),
        (feature(r#"{"unit":"pixel"}"#, CORNERS), PIXELS),
        (feature(r#"{"unit":"px"}"#, CORNERS), PIXELS),
        (feature(r#"{"objectType":"annotation"}"#, CORNERS), PIXELS),
        (feature(r#"{"objectType":"annotation","unit":"um"}"#, CORNERS), UM),
        (collection(r#""unit":"pixel","#, "{}"), PIXELS),
        (collection(r#""unit":"um","#, r#"{"objectType":"cell"}"#), UM),
        // As QuPath exports without "FeatureCollection": a bare list.
        (format!("[{}]", feature(r#"{"objectType":"detection"}"#, CORNERS)), PIXELS),
    ] {
        let cells = read(text.as_bytes()).unwrap().outlines;
        assert_eq!(cells[0].outline.bounds(), expected, "{text}");
    }
    let pixels = ReadOptions { silent_unit: CoordinateUnit::Pixel, ..options() };
    let given = read_outlines(feature("{}", CORNERS).as_bytes(), "a", &pixels).unwrap();
    assert_eq!(given.outlines[0].outline.bounds(), PIXELS);
    assert_eq!(
        refused(feature(r#"{"unit":"mm","name":"A"}"#, CORNERS).as_bytes()),
        "outline `A` has the property `unit` \"mm\"; give \"um\" (y upward from the lower left corner \
         of the picture) or \"pixel\" (y downward from the top left corner)"
    );
}

#[test]
fn every_polygon_is_a_cell_with_a_name() {
    let multi = r#"{"type":"Feature","id":"f7","properties":{"name":"pair"},"geometry":{"type":
        "MultiPolygon","coordinates":[[[[1,1],[5,1],[5,5]]],[[[10,1],[15,1],[15,5]]]]}}"#;
    let by_id = feature(r#"{"id":12}"#, CORNERS);
    let nameless = feature("{}", CORNERS);
    let point = r#"{"type":"Feature","properties":{"name":"bead"},"geometry":{"type":"Point","coordinates":[1,2]}}"#;
    let text = format!(
        r#"{{"type":"FeatureCollection","features":[{multi},{by_id},{point},{nameless}]}}"#
    );
    let given = read(text.as_bytes()).unwrap();
    assert_eq!(names(&given.outlines), ["pair-1", "pair-2", "12", "4"]);
    assert_eq!(given.notes, ["`bead` is a Point and was left out"]);
    let message = refused(point.as_bytes());
    assert!(message.contains("no outline of a cell: `bead` is a Point"), "{message}");
}

#[test]
fn an_outline_whose_name_is_empty_has_its_number() {
    // Found among damaged files: an entry of a zip without a name.
    let roi = write_roi(&NamedOutline { name: String::new(), ..two_cells().remove(0) }, &frame());
    let given = read(&zipped(&["a.roi", "", " .roi"].map(|name| (name, roi.clone())))).unwrap();
    assert_eq!(names(&given.outlines), ["a", "2", "3"]);
    let again = read(write_geojson(&given.outlines).as_bytes()).unwrap();
    assert_eq!(again.outlines, given.outlines);
}

#[test]
fn names_that_are_too_long_for_a_zip_are_cut() {
    // Found among damaged files: a name may take 64 kB of a zip at most.
    let long = "β".repeat(70_000);
    let text = feature(&format!(r#"{{"name":"{long}"}}"#), CORNERS);
    let given = read(text.as_bytes()).unwrap();
    let name = "β".repeat(200);
    assert_eq!(given.outlines[0].name, name);
    assert_eq!(
        given.notes[0],
        format!("names of more than 200 letters were cut, 1 in all, such as `{name}`")
    );
    let set = write_roi_set(&given.outlines, &frame()).unwrap();
    assert_eq!(names(&read(&set).unwrap().outlines)[0], name);
    // Parts of one feature and features that begin alike still differ.
    let multi = format!(
        r#"{{"type":"Feature","properties":{{"name":"{long}"}},"geometry":{{"type":
        "MultiPolygon","coordinates":[[[[1,1],[5,1],[5,5]]],[[[10,1],[15,1],[15,5]]]]}}}}"#
    );
    let text = format!(r#"{{"type":"FeatureCollection","features":[{multi},{text}]}}"#);
    let given = read(text.as_bytes()).unwrap();
    let begin = "β".repeat(192);
    assert_eq!(names(&given.outlines), [name, format!("{begin}-2"), format!("{begin}-3")]);
}

#[test]
fn the_reader_of_one_outline_agrees_with_that_of_many() {
    let cell = built_in::adult_ventricular();
    let given = read_outlines(
        cell.to_geojson().as_bytes(),
        "a.geojson",
        &ReadOptions { placement: Placement::Bounds { pixel_size: pixels_of(1.0) }, ..options() },
    );
    assert_eq!(given.unwrap().outlines[0].outline, cell);
}

// Places.

#[test]
fn without_the_picture_its_frame_ends_with_the_outlines() {
    let placement = Placement::Bounds { pixel_size: pixels_of(2.0) };
    let given =
        read_outlines(&fixture("rectangle.roi"), "a.roi", &ReadOptions { placement, ..options() });
    let given = given.unwrap();
    assert_eq!(given.outlines[0].outline.bounds(), [[20.0, 0.0], [80.0, 24.0]]);
    assert!(given.notes[0].contains("40 x 32 pixels"), "{:?}", given.notes);
}

#[test]
fn an_outline_of_another_picture_is_refused() {
    let small = PixelFrame::new(30, 30, pixels_of(PIXEL_UM)).unwrap();
    let options = ReadOptions { placement: Placement::Picture(small), ..options() };
    let error = read_outlines(&fixture("rectangle.roi"), "a.roi", &options).unwrap_err();
    assert_eq!(
        error.to_string(),
        "outline `rectangle` reaches (40, 20) pixels, outside the picture of 30 x 30 pixels: is it from \
         this picture, and are its coordinates in the unit that the file or option says?"
    );
}

#[test]
fn an_outline_that_crosses_itself_is_refused_with_its_name_and_place() {
    let text = feature(r#"{"name":"eight"}"#, "[[0,0],[20,10],[20,0],[0,10],[0,0]]");
    assert_eq!(
        refused(text.as_bytes()),
        "outline `eight`: the outline crosses or touches itself at (10, 5) um: its edges must go once \
         around the cell"
    );
}

#[test]
fn absurd_frames_are_refused() {
    assert!(
        PixelFrame::new(0, 5, pixels_of(1.0)).is_err()
            && PixelFrame::new(70_000, 1, pixels_of(1.0)).is_err()
    );
    assert!(PixelFrame::new(50_000, 50_000, pixels_of(1.0)).is_err());
}
