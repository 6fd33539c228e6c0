//! Outlines from GeoJSON and lists of points: what is read, and what is refused with which words.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stderr)]

use myospring::integrate::Method;
use myospring::mesh::carried::Carried;
use myospring::mesh::lattice;
use myospring::mesh::outline::Outline;
use myospring::simulation::Simulation;

const SQUARE: &str = "[[[0,0],[10,0],[10,10],[0,10],[0,0]]]";

fn refused(text: &str) -> String {
    Outline::from_geojson(text).unwrap_err().to_string()
}

fn refused_points(points: &[[f64; 2]]) -> String {
    Outline::new(points.to_vec(), vec![]).unwrap_err().to_string()
}

#[test]
fn one_polygon_is_found_wherever_geojson_may_hold_it() {
    let polygon = format!(r#"{{"type":"Polygon","coordinates":{SQUARE}}}"#);
    let multi = format!(r#"{{"type":"MultiPolygon","coordinates":[{SQUARE}]}}"#);
    let feature = |geometry: &str| {
        format!(r#"{{"type":"Feature","properties":{{"unit":"um"}},"geometry":{geometry}}}"#)
    };
    let collection =
        |feature: &str| format!(r#"{{"type":"FeatureCollection","features":[{feature}]}}"#);
    let group = format!(r#"{{"type":"GeometryCollection","geometries":[{polygon}]}}"#);
    for text in [
        polygon.clone(),
        multi.clone(),
        group,
        feature(&polygon),
        feature(&multi),
        collection(&feature(&polygon)),
    ] {
        assert_eq!(Outline::from_geojson(&text).unwrap().area(), 100.0, "{text}");
    }
}

#[test]
fn the_direction_and_closing_of_a_ring_do_not_matter() {
    let corners = vec![[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [0.0, 5.0]];
    let outline = Outline::new(corners.clone(), vec![]).unwrap();
    let clockwise: Vec<_> = corners.iter().rev().copied().collect();
    let closed: Vec<_> = corners.iter().chain(&corners[..1]).copied().collect();
    let doubled: Vec<_> = corners.iter().flat_map(|&point| [point, point]).collect();
    assert_eq!(Outline::new(closed, vec![]).unwrap(), outline);
    assert_eq!(Outline::new(doubled, vec![]).unwrap(), outline);
    let turned = Outline::new(clockwise, vec![]).unwrap();
    assert_eq!((turned.area(), turned.perimeter()), (50.0, 30.0));
    assert_eq!((turned.centroid(), turned.bounds()), ([5.0, 2.5], [[0.0, 0.0], [10.0, 5.0]]));
}

#[test]
fn moments_of_a_rectangle_have_their_closed_form_also_far_from_the_origin() {
    let (a, b) = (12.0, 4.0);
    let corners = vec![[0.0, 0.0], [a, 0.0], [a, b], [0.0, b]];
    let outline = Outline::new(corners, vec![]).unwrap().moved([5_000.0, -3_000.0]);
    let [xx, yy, xy] = outline.second_moments();
    assert!((xx - a.powi(3) * b / 12.0).abs() < 1e-9 && (yy - a * b.powi(3) / 12.0).abs() < 1e-9);
    assert!(xy.abs() < 1e-9);
    let [xx, yy, _] = outline.rotated(90.0).second_moments();
    assert!(xx < yy);
}

#[test]
fn holes_count_against_area() {
    let text = r#"{"type":"Polygon","coordinates":[[[0,0],[10,0],[10,10],[0,10],[0,0]],
                   [[2,2],[5,2],[5,5],[2,5],[2,2]]]}"#;
    let outline = Outline::from_geojson(text).unwrap();
    assert_eq!((outline.area(), outline.holes().len()), (91.0, 1));
    assert_eq!(Outline::from_geojson(&outline.to_geojson()).unwrap(), outline);
}

#[test]
fn a_list_of_points_is_read_with_the_usual_separators_and_headers() {
    for text in [
        "0,0\n10,0\n10,10\n0,10\n",
        "x_um,y_um\r\n0,0\r\n10,0\r\n10,10\r\n0,10\r\n0,0\r\n",
        "\u{feff}\"X\";\"Y\"\n0;0\n10;0\n10;10\n0;10\n",
        "# drawn by hand\n\n0 0\n10\t0\n10  10\n0, 10",
        "X (µm),Y (µm)\n0,0\n10,0\n10,10\n0,10\n",
        "x_coord y_coord\n0 0\n10 0\n10 10\n0 10\n",
    ] {
        assert_eq!(Outline::from_csv(text).unwrap().area(), 100.0, "{text:?}");
    }
}

#[test]
fn a_curve_in_time_is_no_outline_and_its_header_says_so() {
    let rows: Vec<String> = (0..40).map(|k| format!("{k},{}\n", 120 - k % 7)).collect();
    for (header, expected) in [
        (
            "t_ms,length_um\n",
            "its columns are `t_ms`, `length_um`: this seems to be a curve in time",
        ),
        ("Time (s);Length (um)\n", "its columns are `Time (s)`, `Length (um)`: this seems"),
        ("frame,length,width\n", "its columns are `frame`, `length`, `width`: this seems"),
        ("x_px,y_px\n", "its columns are `x_px`, `y_px`; a list of points of an outline has"),
        ("y,x\n", "its columns are `y`, `x`; a list of points"),
        ("", "x only grows or only falls along its 40 points: this seems to be a curve"),
        ("x,y\n", "x only grows or only falls along its 40 points"),
    ] {
        let error =
            Outline::from_csv(&format!("{header}{}", rows.concat())).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn a_line_that_is_not_a_point_is_named() {
    for (text, message) in [
        (
            "x,y\n0,0\n10,zero\n",
            "line 3 of the list of points is `10,zero`; two numbers, x and y in um, are needed",
        ),
        ("1,2,3\n", "line 1 of the list of points is `1,2,3`; two numbers"),
        ("x,y\nx,y\n", "line 2 of the list of points is `x,y`"),
        ("", "the outline's exterior has 0 different points; at least 3 are needed"),
        ("0,0\n1,nan\n2,2\n", "point 1 of the outline's exterior is (1, NaN) um; coordinates"),
    ] {
        let error = Outline::from_csv(text).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

#[test]
fn what_is_not_one_polygon_is_refused() {
    assert!(refused("x_um,y_um").starts_with("the outline is not GeoJSON: "));
    assert!(refused(r#"{"type":"Polygon"}"#).starts_with("the outline is not GeoJSON: "));
    assert_eq!(
        refused(r#"{"type":"FeatureCollection","features":[]}"#),
        "the GeoJSON has 0 polygons (no geometry); exactly one, the cell, is needed"
    );
    assert_eq!(
        refused(r#"{"type":"LineString","coordinates":[[0,0],[1,1]]}"#),
        "the GeoJSON has 0 polygons (LineString); exactly one, the cell, is needed"
    );
    assert_eq!(
        refused(&format!(r#"{{"type":"MultiPolygon","coordinates":[{SQUARE},{SQUARE}]}}"#)),
        "the GeoJSON has 2 polygons (MultiPolygon); exactly one, the cell, is needed"
    );
    assert!(
        refused(r#"{"type":"Polygon","coordinates":[]}"#).contains("has 0 different points"),
        "{}",
        refused(r#"{"type":"Polygon","coordinates":[]}"#)
    );
}

#[test]
fn another_unit_is_refused() {
    let text = format!(
        r#"{{"type":"Feature","properties":{{"unit":"px"}},
             "geometry":{{"type":"Polygon","coordinates":{SQUARE}}}}}"#
    );
    assert_eq!(
        refused(&text),
        "the outline's property `unit` is \"px\", but coordinates must be in \"um\""
    );
}

#[test]
fn a_polygon_of_no_size_is_refused() {
    let message = "the outline has an area of 0 um^2, less than 1 um^2: coordinates must be in \
                   micrometres and go around the cell";
    assert_eq!(refused_points(&[[0.0, 0.0], [50.0, 0.0], [100.0, 0.0]]), message);
    assert_eq!(refused_points(&[[0.0, 0.0], [3.0, 1.0], [9.0, 3.0], [6.0, 2.0]]), message);
    let error = refused_points(&[[0.0, 0.0], [0.1, 0.0], [0.1, 0.1]]);
    assert!(error.contains("less than 1 um^2"), "{error}");
    assert_eq!(
        refused_points(&[[2.0, 2.0], [2.0, 2.0], [2.0, 2.0], [2.0, 2.0]]),
        "the outline's exterior has 1 different points; at least 3 are needed"
    );
}

#[test]
fn a_polygon_of_absurd_size_is_refused() {
    assert_eq!(
        refused_points(&[[0.0, 0.0], [20_000.0, 0.0], [0.0, 9.0]]),
        "the outline is 20000 um long, more than 10000 um: coordinates must be in micrometres"
    );
}

#[test]
fn a_polygon_that_crosses_or_touches_itself_is_refused_with_the_place() {
    assert_eq!(
        refused_points(&[[0.0, 0.0], [10.0, 10.0], [10.0, 0.0], [0.0, 10.0]]),
        "the outline crosses or touches itself at (5, 5) um: its edges must go once around the cell"
    );
    // A corner on another edge.
    let error = refused_points(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [5.0, 0.0], [0.0, 10.0]]);
    assert!(error.contains("touches itself at (5, 0) um"), "{error}");
    // A spike: out and back along one line.
    let error = refused_points(&[[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [10.0, 0.0], [5.0, 10.0]]);
    assert!(error.contains("crosses or touches itself"), "{error}");
}

#[test]
fn a_hole_outside_is_refused() {
    let square = |x: f64| vec![[x, x], [x + 9.0, x], [x + 9.0, x + 9.0], [x, x + 9.0]];
    let error = Outline::new(square(0.0), vec![square(20.0)]).unwrap_err().to_string();
    assert!(error.starts_with("the outline's holes must lie inside it"), "{error}");
}

#[test]
fn the_outline_of_a_block_at_its_peak_is_the_stretched_block() {
    // The lattice is a little larger than the outline, which begins beside it.
    let corners = vec![[0.0, 0.0], [60.0, 0.0], [60.0, 60.0], [0.0, 60.0]];
    let outline = Outline::new(corners, vec![]).unwrap();
    let (mesh, report) = lattice::from_outline(&outline, Some(3.7)).unwrap();
    assert!((report.dimensions.length_um - 60.0).abs() > 1.0);
    let mut simulation = Simulation::new(mesh);
    simulation.numerics.method = Method::QuasiStatic;
    let recording = simulation.build().unwrap().run(|_| true).recording;
    let peak = recording.frames.iter().max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa)).unwrap();
    // Uniform tension shortens a free block by one factor and widens it by another, wherever one looks.
    let stretch = [0, 1].map(|axis: usize| {
        let ends = |of: &[f64]| {
            let low = of.iter().copied().fold(f64::INFINITY, f64::min);
            of.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
        };
        ends(&peak.positions[axis]) / ends(&simulation.mesh.points[axis])
    });
    assert!(stretch[0] < 0.9 && stretch[1] > 1.03, "{stretch:?}");
    let rings = Carried::rings(&simulation.mesh, &outline);
    let now = Outline::new(rings[0].at(&peak.positions), vec![]).unwrap();
    let [low, high] = now.bounds();
    for axis in 0..2 {
        // The path of equilibria is known to 1e-4 um.
        assert!((high[axis] - low[axis] - 60.0 * stretch[axis]).abs() < 1e-3, "{low:?} {high:?}");
    }
    let area = outline.area() * stretch[0] * stretch[1];
    assert!((now.area() / area - 1.0).abs() < 1e-5, "{} {area}", now.area());
}
