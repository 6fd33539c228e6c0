use super::*;
use crate::mesh::built_in;
use crate::mesh::pixel_size::PixelSize;

fn ellipse(a: f64, b: f64, pixel: f64) -> Mask {
    let (width, height) = ((2.2 * a / pixel) as usize, (2.2 * b / pixel) as usize);
    let inside = |at: usize| {
        let x = ((at % width) as f64 + 0.5 - 0.5 * width as f64) * pixel / a;
        let y = ((at / width) as f64 + 0.5 - 0.5 * height as f64) * pixel / b;
        x * x + y * y < 1.0
    };
    let pixels = (0..width * height).map(inside).collect();
    Mask::new(width, height, PixelSize::new(pixel).unwrap(), pixels).unwrap()
}

#[test]
fn an_ellipse_becomes_an_ellipsoid_and_a_dome_of_its_volume() {
    let mask = ellipse(30.0, 8.0, 0.25);
    let exact = 4.0 / 3.0 * std::f64::consts::PI * 30.0 * 8.0 * 4.0;
    for profile in [Profile::Round, Profile::Dome] {
        for spacing in [1.0, 0.8] {
            let form = Form { profile, thickness: 8.0 };
            let (above, thick, report) = from_mask(&mask, form, Some(spacing)).unwrap();
            let of = report.thick.unwrap();
            assert!((of.source_volume_um3 / exact - 1.0).abs() < 0.015, "{}", of.source_volume_um3);
            assert!(of.volume_error_pct.abs() < 1.0, "{}", of.volume_error_pct);
            assert!((thick.mesh.area() - of.volume_um3).abs() < 1e-6);
            assert_eq!(thick.squares.len(), of.cubes);
            assert_eq!(thick.columns.iter().map(Vec::len).sum::<usize>(), thick.mesh.len());
            // Seen from above, each point is where the flat mesh has it.
            let seen = thick.seen_from_above(&thick.mesh.points);
            for axis in 0..2 {
                for (a, b) in seen[axis].iter().zip(&above.points[axis]) {
                    assert!((a - b).abs() < 1e-9);
                }
            }
        }
    }
}

#[test]
fn a_slab_has_its_outline_times_its_thickness() {
    let form = Form { profile: Profile::Slab, thickness: 8.0 };
    let (above, thick, report) =
        from_outline(&built_in::adult_ventricular(), form, Some(2.0)).unwrap();
    let (flat, _) = lattice::from_outline(&built_in::adult_ventricular(), Some(2.0)).unwrap();
    assert_eq!(above, flat);
    assert!((thick.mesh.area() - 8.0 * flat.area()).abs() < 1e-6);
    assert_eq!(report.thick.unwrap().layers, 4);
}

#[test]
fn values_of_triangles_go_to_the_cubes_above() {
    let form = Form { profile: Profile::Dome, thickness: 8.0 };
    let (above, thick, _) = from_outline(&built_in::adult_ventricular(), form, Some(2.0)).unwrap();
    let x: Vec<f64> = above.simplices.iter().map(|triangle| above.centre(triangle)[0]).collect();
    for (tetrahedra, value) in
        thick.mesh.simplices.chunks(10).zip(thick.of_triangles(&x).chunks(10))
    {
        let centre: f64 = tetrahedra.iter().map(|it| thick.mesh.centre(it)[0]).sum::<f64>() / 10.0;
        assert!(value.iter().all(|value| (value - centre).abs() < 1e-9));
    }
}

#[test]
fn few_cubes_across_the_thickness_are_warned_of_and_impossible_ones_refused() {
    let outline = built_in::adult_ventricular();
    let form = |thickness| Form { profile: Profile::Slab, thickness };
    let (.., report) = from_outline(&outline, form(4.0), Some(2.0)).unwrap();
    assert!(report.warnings[0].contains("take a spacing of 1.00 um"), "{:?}", report.warnings);
    for (thickness, spacing, says) in [
        (-1.0, None, "thickness"),
        (f64::NAN, None, "thickness"),
        (4.0, Some(5.0), "thickness of 4 um"),
        (4.0, Some(0.05), "more than 400000"),
        (4.0, Some(0.0), "not a positive length"),
        (30.0, Some(9.0), "a third of the cell's width"),
    ] {
        let error = from_outline(&outline, form(thickness), spacing).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
    for (profile, thickness) in
        [(Profile::Slab, 10.0), (Profile::Dome, 8.0), (Profile::Round, 12.0), (Profile::Round, 5.0)]
    {
        let (.., report) = from_outline(&outline, Form { profile, thickness }, None).unwrap();
        // A thin cell takes more, as it needs four cubes.
        assert!((3_000..8_000).contains(&report.masses), "{profile:?}: {}", report.masses);
        assert!(report.warnings.is_empty(), "{:?}", report.warnings);
        let meshed = report.thick.unwrap().thickness_um;
        assert!((meshed / thickness - 1.0).abs() < 1e-3, "{profile:?}: {meshed}");
    }
    let (.., report) = from_outline(&outline, form(10.0), Some(1.8)).unwrap();
    assert!(report.warnings[0].contains("1.6667 um"), "{:?}", report.warnings);
    let (.., report) = from_outline(&outline, form(200.0), Some(4.0)).unwrap();
    assert!(report.warnings.iter().any(|text| text.contains("unit")), "{:?}", report.warnings);
}
