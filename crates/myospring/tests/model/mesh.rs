//! Meshes from outlines, masks and generators: counts in closed form, area, real cells, refusals.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stderr)]

use crate::common::pixels_of;
use myospring::mesh::mask::Mask;
use myospring::mesh::outline::Outline;
use myospring::mesh::{Mesh, MeshError, SpringKind, built_in, lattice, quality};
use proptest::prelude::*;

/// An ellipse of 200 points with half axes `a`, `b`, um, turned by `angle` degrees.
fn ellipse(a: f64, b: f64, angle: f64, centre: [f64; 2]) -> Outline {
    let points = (0..200)
        .map(|k| f64::from(k) * std::f64::consts::TAU / 200.0)
        .map(|t| [centre[0] + a * t.cos(), centre[1] + b * t.sin()])
        .collect();
    Outline::new(points, vec![]).unwrap().rotated(angle)
}

/// Pixels of side `pixel` um whose centre lies in an ellipse in the middle of a picture.
fn ellipse_mask(a: f64, b: f64, angle: f64, pixel: f64) -> Mask {
    let side = (2.4 * a.max(b) / pixel).ceil() as usize;
    let (sin, cos) = angle.to_radians().sin_cos();
    let inside = (0..side * side)
        .map(|index| {
            let x = ((index % side) as f64 + 0.5 - side as f64 / 2.0) * pixel;
            // Row 0 is on top.
            let y = (side as f64 / 2.0 - 0.5 - (index / side) as f64) * pixel;
            let (along, across) = (cos * x + sin * y, cos * y - sin * x);
            (along / a).powi(2) + (across / b).powi(2) < 1.0
        })
        .collect();
    Mask::new(side, side, pixels_of(pixel), inside).unwrap()
}

fn rectangle_outline(width: f64, height: f64) -> Outline {
    Outline::new(vec![[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]], vec![]).unwrap()
}

/// What the force kernels rely on, beyond the invariants that `Mesh::new` checks.
fn assert_lattice_guarantees(mesh: &Mesh) {
    let lattice = mesh.lattice.as_ref().unwrap();
    let place = |node: u32| lattice.cells[node as usize].map(i64::from);
    assert!(
        lattice.cells.windows(2).all(|two| (two[0][1], two[0][0]) < (two[1][1], two[1][0])),
        "nodes are not row by row"
    );
    let mut degree = vec![0; mesh.len()];
    let mut keys = Vec::new();
    for spring in &mesh.springs {
        let [a, b] = spring.nodes.map(place);
        let step = [b[0] - a[0], b[1] - a[1]];
        let direction = [[1, 0], [0, 1], [1, 1], [-1, 1]].iter().position(|d| *d == step);
        let direction = direction.expect("a spring joins lattice neighbours");
        assert_eq!(spring.kind == SpringKind::Diagonal, direction > 1);
        assert!(spring.share == 1.0 || (spring.share == 0.5 && direction < 2));
        // The order within north-west is that of the squares, whose lower left corner is a - 1.
        let column = if direction == 3 { a[0] - 1 } else { a[0] };
        keys.push((direction, a[1], column));
        for node in spring.nodes {
            degree[node as usize] += 1;
        }
    }
    assert!(keys.windows(2).all(|two| two[0] < two[1]), "springs are not in order");
    assert!(degree.iter().all(|&springs| springs >= 3));
    let (h, squares) = (lattice.spacing, mesh.simplices.len() / 4);
    let area = squares as f64 * h * h;
    let weighted: f64 = mesh.simplices.iter().map(|s| s.weight * h * h / 2.0).sum();
    assert!((mesh.area() - area).abs() < 1e-9 * area && (weighted - area).abs() < 1e-9 * area);
    // Every square has four sides; a side is whole between two squares and half on the rim.
    let sides: f64 =
        mesh.springs.iter().filter(|s| s.kind == SpringKind::Axial).map(|s| s.share).sum();
    assert_eq!(sides, 2.0 * squares as f64);
    let columns = lattice.cells.iter().map(|cell| cell[0] as usize + 1).max().unwrap();
    assert!(columns <= lattice.shape[0]);
    Mesh::new(
        mesh.points.clone(),
        mesh.areas.clone(),
        mesh.springs.clone(),
        mesh.simplices.clone(),
        mesh.lattice.clone(),
    )
    .unwrap();
}

#[test]
fn a_rectangle_has_the_counts_of_its_closed_form() {
    for (n, m) in [(1, 1), (1, 7), (5, 3), (70, 10)] {
        let mesh = lattice::rectangle(n, m, 1.5).unwrap();
        assert_eq!(mesh.len(), (n + 1) * (m + 1));
        assert_eq!(mesh.springs.len(), n * (m + 1) + m * (n + 1) + 2 * n * m);
        assert_eq!(mesh.simplices.len(), 4 * n * m);
        assert_eq!(mesh.area(), (n * m) as f64 * 2.25);
        assert_lattice_guarantees(&mesh);
    }
}

#[test]
fn a_rectangle_of_whole_squares_is_filled_exactly_from_outline_and_mask() {
    let (drawn, report) = lattice::from_outline(&rectangle_outline(30.0, 12.0), Some(1.5)).unwrap();
    let mesh = lattice::rectangle(20, 8, 1.5).unwrap();
    assert_eq!(drawn, mesh);
    assert_eq!((report.area_error_pct, report.warnings.len()), (0.0, 0));

    // The same rectangle in pixels of 0.5 um, 3 pixels from the left and 2 from the bottom.
    let inside = |i: usize| (3..63).contains(&(i % 70)) && (4..28).contains(&(i / 70));
    let mask = Mask::new(70, 30, pixels_of(0.5), (0..2100).map(inside).collect()).unwrap();
    let (painted, _) = lattice::from_mask(&mask, Some(1.5)).unwrap();
    assert_eq!(painted.springs, mesh.springs);
    assert_eq!(painted.point(0), [1.5, 1.0]);
}

#[test]
fn a_straight_side_between_lattice_lines_costs_no_area() {
    for width in [16.0, 16.25, 16.5, 16.67, 16.9, 17.3] {
        for spacing in [1.0, 1.2] {
            let outline = rectangle_outline(140.3, width);
            let (mesh, report) = lattice::from_outline(&outline, Some(spacing)).unwrap();
            assert!(report.area_error_pct.abs() < 0.6, "{width} {spacing}: {report}");
            assert_lattice_guarantees(&mesh);
            // And the mesh is as symmetric as the cell.
            let centre = mesh.centroid();
            assert!((centre[0] - 70.15).abs() < 1e-9 && (centre[1] - width / 2.0).abs() < 1e-9);
        }
    }
}

#[test]
fn a_quarter_turn_changes_no_count() {
    let cell = built_in::adult_ventricular();
    let (upright, before) = lattice::from_outline(&cell, Some(1.3)).unwrap();
    for angle in [90.0, 180.0, 270.0] {
        let (turned, after) = lattice::from_outline(&cell.rotated(angle), Some(1.3)).unwrap();
        assert_eq!(turned.len(), upright.len(), "{angle}");
        assert_eq!(turned.springs.len(), upright.springs.len());
        assert_eq!(after.squares, before.squares);
        assert!((after.dimensions.length_um - before.dimensions.length_um).abs() < 1e-3);
    }
}

#[test]
fn pictures_do_not_come_out_mirrored() {
    // An L: a long stroke down the left, a short one along the bottom.
    let rows = ["##....", "##....", "##....", "######", "######"];
    let enlarge = |i: usize| rows[i / 60 / 10].as_bytes()[i % 60 / 10] == b'#';
    let mask = Mask::new(60, 50, pixels_of(0.5), (0..3000).map(enlarge).collect()).unwrap();
    let (mesh, _) = lattice::from_mask(&mask, Some(1.0)).unwrap();
    let has = |x: f64, y: f64| (0..mesh.len()).any(|node| mesh.point(node) == [x, y]);
    assert!(has(0.0, 25.0) && has(30.0, 0.0) && has(0.0, 0.0) && !has(30.0, 25.0));
}

#[test]
fn a_mesh_lies_where_its_cell_lies() {
    let outline = ellipse(50.0, 12.0, 25.0, [310.0, -70.0]);
    let (mesh, report) = lattice::from_outline(&outline, None).unwrap();
    let centre = mesh.centroid();
    assert!((centre[0] - 310.0).abs() < 0.1 && (centre[1] + 70.0).abs() < 0.1, "{centre:?}");
    assert!((report.dimensions.long_axis_deg - 25.0).abs() < 0.2, "{report}");
}

#[test]
fn islands_are_dropped_and_reported() {
    let cell = |x: usize, y: usize| (10..90).contains(&x) && (10..30).contains(&y);
    let islands = |x: usize, y: usize| (x, y) == (5, 5) || ((50..60).contains(&x) && y == 35);
    let inside = (0..100 * 40).map(|i| (i % 100, i / 100));
    let mask =
        |keep: &dyn Fn(usize, usize) -> bool| inside.clone().map(|(x, y)| keep(x, y)).collect();
    let alone = Mask::new(100, 40, pixels_of(1.0), mask(&cell)).unwrap();
    let both =
        Mask::new(100, 40, pixels_of(1.0), mask(&|x, y| cell(x, y) || islands(x, y))).unwrap();
    let (expected, clean) = lattice::from_mask(&alone, Some(2.0)).unwrap();
    let (mesh, report) = lattice::from_mask(&both, Some(2.0)).unwrap();
    assert_eq!(mesh, expected);
    assert_eq!((clean.dropped_components, clean.dropped_pixels), (0, 0));
    assert_eq!((report.dropped_components, report.dropped_pixels), (2, 11));
    assert_eq!(report.source_area_um2, clean.source_area_um2);
}

#[test]
fn a_neck_thinner_than_the_squares_drops_the_smaller_side_and_says_so() {
    // Two blocks of 40 x 20 and 6 x 20 um, joined by a thread.
    let outline = Outline::new(
        vec![
            [0.0, 0.0],
            [60.0, 0.0],
            [60.0, 9.9],
            [70.0, 9.9],
            [70.0, 8.0],
            [73.0, 8.0],
            [73.0, 12.0],
            [70.0, 12.0],
            [70.0, 10.1],
            [60.0, 10.1],
            [60.0, 20.0],
            [0.0, 20.0],
        ],
        vec![],
    )
    .unwrap();
    let (mesh, report) = lattice::from_outline(&outline, Some(1.0)).unwrap();
    assert_eq!(report.dropped_squares, 12);
    assert_eq!(quality::extent(&mesh, [1.0, 0.0]), 60.0);
    assert!(report.warnings[0].contains("too coarse for this shape"), "{report}");
}

#[test]
fn a_cell_that_touches_the_frame_gets_a_warning() {
    let mask =
        Mask::new(100, 40, pixels_of(1.0), (0..4000).map(|i| i % 100 < 60).collect()).unwrap();
    let (_, report) = lattice::from_mask(&mask, None).unwrap();
    assert!(report.touches_frame);
    assert!(report.warnings[0].contains("touches the frame"), "{report}");
}

#[test]
fn a_hole_stays_open() {
    let square = |low: f64, high: f64| vec![[low, low], [high, low], [high, high], [low, high]];
    let outline = Outline::new(square(0.0, 30.0), vec![square(12.0, 18.0)]).unwrap();
    let (mesh, report) = lattice::from_outline(&outline, Some(1.0)).unwrap();
    assert_eq!((report.squares, mesh.len()), (900 - 36, 31 * 31 - 25));
    assert_lattice_guarantees(&mesh);
}

#[test]
fn the_built_in_cell_has_the_size_of_an_adult_ventricular_myocyte() {
    let outline = built_in::adult_ventricular();
    let (mesh, report) = lattice::from_outline(&outline, None).unwrap();
    eprintln!("{report}");
    assert_lattice_guarantees(&mesh);
    let size = report.dimensions;
    assert!((size.length_um - 140.0).abs() < 2.0, "{report}");
    assert!((size.width_um - 21.0).abs() < 1.5, "{report}");
    // Gerdes et al. 1992: length over width 7.5.
    assert!((size.aspect_ratio - 7.5).abs() < 0.5, "{report}");
    assert!(size.long_axis_deg.abs() < 3.0, "{report}");
    assert!((1_800..2_400).contains(&report.masses), "{report}");
    assert!(report.area_error_pct.abs() < 0.5 && report.warnings.is_empty(), "{report}");
}

#[test]
fn the_built_in_cell_turned_keeps_its_size() {
    let cell = built_in::adult_ventricular();
    let straight = lattice::from_outline(&cell, None).unwrap().1;
    let turned = lattice::from_outline(&cell.rotated(30.0), None).unwrap().1;
    let (a, b) = (straight.dimensions, turned.dimensions);
    assert!((b.long_axis_deg - a.long_axis_deg - 30.0).abs() < 0.2, "{turned}");
    // One spacing: the ends fall between lattice lines.
    assert!((a.length_um - b.length_um).abs() < straight.spacing_um, "{straight}\n{turned}");
    assert!((a.mean_width_um - b.mean_width_um).abs() < 0.2);
}

#[test]
fn every_built_in_cell_is_a_sound_outline_with_a_name_of_its_own() {
    for (index, cell) in built_in::CELLS.iter().enumerate() {
        let outline = cell.outline().unwrap();
        lattice::from_outline(&outline, None).unwrap();
        assert_eq!(built_in::find(cell.name), Some(&built_in::CELLS[index]));
    }
}

#[test]
fn the_report_prints_as_a_table_with_units_and_goes_to_json() {
    let (_, report) = lattice::from_outline(&rectangle_outline(30.0, 12.0), Some(1.5)).unwrap();
    let table = report.to_string();
    assert!(table.contains("masses                 189\n"), "{table}");
    assert!(table.contains("length                30.0 um\n"), "{table}");
    assert!(table.contains("area                 360.0 um^2\n"), "{table}");
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!((&json["length_um"], &json["masses"]), (&30.0.into(), &189.into()));
}

#[test]
fn an_absurd_spacing_is_refused_with_the_bound_and_a_better_one() {
    let cell = rectangle_outline(140.0, 21.0);
    let message = |spacing| lattice::from_outline(&cell, Some(spacing)).unwrap_err().to_string();
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            message(spacing),
            format!("spacing {spacing} um is not a positive length; leave it out for 1.3 um")
        );
    }
    assert_eq!(
        message(10.0),
        "spacing 10 um exceeds 7.000 um, a third of the cell's width of 21.000 um; give less, or \
         leave it out for 1.3 um"
    );
    lattice::from_outline(&cell, Some(7.0)).unwrap();
    assert_eq!(
        message(0.001),
        "spacing 0.001 um would give about 2.9e9 masses, more than 2500000; give more than 0.03 um, \
         or leave it out for 1.3 um"
    );
    assert!(message(1e-300).contains("masses, more than 2500000"), "{}", message(1e-300));
    let error = lattice::rectangle(1_000_000, 1_000_000, 1.0).unwrap_err().to_string();
    assert!(error.contains("about 1.0e12 masses, more than 2500000"), "{error}");
}

#[test]
fn a_cell_of_three_pixels_is_refused() {
    let mask =
        Mask::new(10, 10, pixels_of(0.27), (0..100).map(|i| (44..47).contains(&i)).collect())
            .unwrap();
    assert_eq!(
        lattice::from_mask(&mask, None).unwrap_err().to_string(),
        "the cell has only 3 pixels (0.219 um^2); at least 25 are needed: is this the right mask and \
         label?"
    );
}

/// Breaks one invariant.
type Change<'a> = &'a dyn Fn(&mut Mesh);

#[test]
fn a_broken_mesh_names_what_is_broken() {
    let good = lattice::rectangle(3, 2, 1.0).unwrap();
    let rebuilt = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = good.clone();
        change(&mut mesh);
        Mesh::new(mesh.points, mesh.areas, mesh.springs, mesh.simplices, mesh.lattice)
            .map(|_| ())
            .map_err(|error| error.to_string())
    };
    let cases: [(Change, &str); 11] = [
        (&|m| m.points[1][4] = f64::NAN, "y of node 4 is NaN; it must be finite"),
        (&|m| m.areas.truncate(11), "the list of areas has 11 entries, but the mesh has 12 points"),
        (&|m| m.areas[3] = 0.0, "area of node 3 is 0; it must be finite and positive"),
        (&|m| m.springs[1].nodes[1] = 12, "spring 1 refers to node 12, but the mesh has 12 points"),
        (&|m| m.springs[0].nodes = [5, 5], "spring 0 between nodes 5 and 5 has no length"),
        (&|m| m.springs.push(m.springs[2]), "nodes 2 and 3 are joined by two springs"),
        (&|m| m.springs[7].share = -1.0, "share of spring 7 is -1; it must be finite and positive"),
        (&|m| m.simplices[6].nodes.reverse(), "triangle 6 has the area -0.5 um^2"),
        (
            &|m| m.springs.retain(|s| !s.nodes.contains(&0) || s.nodes.contains(&1)),
            "node 0 has only 1 spring(s); at least 2 are needed",
        ),
        (
            &|m| {
                let right = |node: u32| node % 4 > 1;
                m.springs.retain(|s| right(s.nodes[0]) == right(s.nodes[1]));
            },
            "the mesh is not connected: only 6 of 12 nodes are connected with node 0",
        ),
        (&|m| m.points[0][3] += 0.2, "node 3 does not lie on column 3, row 0 of the lattice"),
    ];
    for (change, message) in cases {
        let error = rebuilt(change).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
    assert_eq!(
        <Mesh>::new([vec![], vec![]], vec![], vec![], vec![], None).unwrap_err(),
        MeshError::NoPoints
    );
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 48,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_mesh_of_an_outline_has_its_area_within_one_per_cent_and_holds_every_invariant(
        a in 20.0_f64..90.0, ratio in 0.12_f64..1.0, angle in -180.0_f64..180.0,
        across in 8.0_f64..30.0, x in -50.0_f64..50.0,
    ) {
        let outline = ellipse(a, a * ratio, angle, [x, 3.0]);
        let spacing = 2.0 * a * ratio / across;
        let (mesh, report) = lattice::from_outline(&outline, Some(spacing)).unwrap();
        prop_assert!(report.area_error_pct.abs() < 1.0, "{report}");
        prop_assert!((mesh.area() - report.area_um2).abs() < 1e-6 * report.area_um2);
        assert_lattice_guarantees(&mesh);
    }

    #[test]
    fn a_mesh_of_a_mask_has_its_area_within_one_per_cent_and_holds_every_invariant(
        a in 20.0_f64..60.0, ratio in 0.15_f64..1.0, angle in -180.0_f64..180.0,
        spacing in 0.7_f64..1.5, pixel in 0.2_f64..0.9,
    ) {
        let mask = ellipse_mask(a, a * ratio, angle, pixel);
        let (mesh, report) = lattice::from_mask(&mask, Some(spacing)).unwrap();
        prop_assert!(report.area_error_pct.abs() < 1.0, "{report}");
        prop_assert_eq!(report.dropped_pixels, 0);
        assert_lattice_guarantees(&mesh);
        // The rounder the cell, the more the pixels turn its axis.
        if ratio < 0.6 {
            let off = (report.dimensions.long_axis_deg - angle).rem_euclid(180.0);
            prop_assert!(off.min(180.0 - off) < 2.0, "{} for {}", report.dimensions.long_axis_deg, angle);
        }
    }

    #[test]
    fn a_mask_and_the_outline_that_it_was_painted_from_give_one_mesh_to_a_pixel(
        angle in -90.0_f64..90.0,
    ) {
        let outline = ellipse(40.0, 10.0, angle, [48.0, 48.0]);
        let drawn = lattice::from_outline(&outline, Some(1.0)).unwrap().1;
        let painted = lattice::from_mask(&ellipse_mask(40.0, 10.0, angle, 0.2), Some(1.0)).unwrap().1;
        prop_assert!((drawn.area_um2 / painted.area_um2 - 1.0).abs() < 0.01);
        // One spacing at either end: the lattices are centred on boxes that a pixel may shift.
        prop_assert!((drawn.dimensions.length_um - painted.dimensions.length_um).abs() < 2.0);
    }

    #[test]
    fn an_outline_survives_geojson_and_keeps_its_measures_when_turned(
        a in 5.0_f64..90.0, b in 5.0_f64..90.0, angle in -360.0_f64..360.0,
    ) {
        let outline = ellipse(a, b, 0.0, [7.0, -3.0]);
        let turned = outline.rotated(angle);
        prop_assert!((turned.area() / outline.area() - 1.0).abs() < 1e-10);
        prop_assert!((turned.perimeter() / outline.perimeter() - 1.0).abs() < 1e-10);
        // The JSON reader may be off by one unit in the last place.
        let again = Outline::from_geojson(&turned.to_geojson()).unwrap();
        for (p, q) in again.exterior().iter().zip(turned.exterior()) {
            prop_assert!((p[0] - q[0]).abs() < 1e-10 && (p[1] - q[1]).abs() < 1e-10);
        }
        prop_assert_eq!(again.exterior().len(), turned.exterior().len());
    }
}
