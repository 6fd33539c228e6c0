//! The shape report: closed forms, warnings, and real cells.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::common::{self, pixels_of};

use std::f64::consts::{PI, TAU};

use myospring::mesh::outline::Outline;
use myospring::mesh::{lattice, quality};
use myospring::microscopy::outlines::PixelFrame;
use myospring::microscopy::outlines::trace::{Edge, trace_mask};
use myospring::microscopy::report::{ShapeReport, shape_report};

fn report(points: &[[f64; 2]]) -> ShapeReport {
    shape_report(&Outline::new(points.to_vec(), vec![]).unwrap(), None)
}

fn rectangle(length: f64, width: f64) -> [[f64; 2]; 4] {
    [[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]]
}

#[test]
fn a_rectangle_and_a_circle_have_their_closed_forms() {
    let found = report(&rectangle(100.0, 20.0));
    assert_eq!((found.area_um2, found.perimeter_um, found.solidity), (2000.0, 240.0, 1.0));
    assert_eq!(found.circularity, 4.0 * PI * 2000.0 / 240.0_f64.powi(2));
    let size = found.dimensions;
    assert_eq!((size.length_um, size.width_um, size.aspect_ratio), (100.0, 20.0, 5.0));
    assert_eq!(found.warnings, Vec::<String>::new());
    let circle: Vec<[f64; 2]> = (0..720)
        .map(|step| (f64::from(step) * TAU / 720.0).sin_cos())
        .map(|(sin, cos)| [30.0 * cos, 30.0 * sin])
        .collect();
    // A polygon of 720 sides differs from the circle by 1e-5.
    assert!((report(&circle).circularity - 1.0).abs() < 1e-4);
}

#[test]
fn an_outline_is_measured_as_its_mesh_is() {
    let outline = myospring::mesh::built_in::adult_ventricular().rotated(25.0);
    let found = shape_report(&outline, None).dimensions;
    let (mesh, _) = lattice::from_outline(&outline, Some(0.5)).unwrap();
    let mesh = quality::dimensions(&mesh);
    // The mesh is made of squares of 0.5 um: its ends are good to a square's diagonal.
    assert!((found.length_um - mesh.length_um).abs() < 0.71);
    assert!((found.width_um - mesh.width_um).abs() < 0.71);
    assert!((found.long_axis_deg - mesh.long_axis_deg).abs() < 0.2);
}

#[test]
fn warnings_name_what_is_odd() {
    let warned = |points: &[[f64; 2]]| report(points).warnings.join("; ");
    let l_shape =
        [[0.0, 0.0], [100.0, 0.0], [100.0, 20.0], [20.0, 20.0], [20.0, 100.0], [0.0, 100.0]];
    assert!(warned(&l_shape).contains("solidity 0.53 is below 0.8: the outline is ragged, or two"));
    assert!(warned(&rectangle(20.0, 5.0)).contains("area of 100 um^2 is below 500 um^2"));
    assert!(warned(&rectangle(300.0, 90.0)).contains("its area of 27000 um^2 is above 20000 um^2"));
    assert!(warned(&rectangle(300.0, 30.0)).contains("300 um long, more than the usual 250 um"));
    assert!(warned(&rectangle(160.0, 8.0)).contains("20 times as long as wide"));
    let hole = vec![[40.0, 5.0], [60.0, 5.0], [60.0, 15.0], [40.0, 15.0]];
    let holed = Outline::new(rectangle(100.0, 20.0).to_vec(), vec![hole]).unwrap();
    let found = shape_report(&holed, None);
    assert_eq!((found.holes, found.area_um2, found.solidity), (1, 1800.0, 0.9));
    assert!(found.warnings[0].contains("holes take 10.0 % of the cell"), "{:?}", found.warnings);
}

#[test]
fn pixels_on_the_frame_are_counted() {
    let frame = PixelFrame::new(240, 60, pixels_of(0.5)).unwrap();
    let outline = Outline::new(rectangle(100.0, 20.0).to_vec(), vec![]).unwrap();
    // 200 pixels on the lower side, 40 on the left one, one on both.
    let touching = shape_report(&outline, Some(&frame));
    assert_eq!(touching.pixels_on_frame, 239);
    assert!(touching.warnings[0].contains("touches the frame of the picture with 239 pixels"));
    assert_eq!(shape_report(&outline.moved([5.0, 5.0]), Some(&frame)).pixels_on_frame, 0);
}

#[test]
fn it_prints_as_a_table_with_units() {
    let text = report(&rectangle(20.0, 5.0)).to_string();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "area                 100.0 um^2");
    assert_eq!(lines[2], "length                20.0 um");
    assert!(lines.last().unwrap().starts_with("warning: its area of 100 um^2"));
    let json = serde_json::to_value(report(&rectangle(20.0, 5.0))).unwrap();
    assert_eq!((&json["area_um2"], &json["length_um"]), (&100.0.into(), &20.0.into()));
}

#[test]
fn two_real_cells_give_no_warning() {
    for file in ["images/contrax_brightfield_mask.png", "images/sarcgraph_e5_mask.png"] {
        let Some(path) = common::shared_data(file) else { continue };
        let mask = common::mask(path);
        let outline = trace_mask(&mask, Edge::Smooth).unwrap();
        let found = shape_report(&outline, Some(&PixelFrame::of(&mask)));
        assert_eq!(found.warnings, Vec::<String>::new(), "{file}\n{found}");
        assert!(found.solidity > 0.85 && found.circularity < 1.0, "{found}");
    }
}
