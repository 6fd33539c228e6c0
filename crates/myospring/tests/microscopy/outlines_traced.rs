//! Masks to outlines and back.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::common::{self, pixels_of};
use crate::outline_files;

use myospring::mesh::lattice;
use myospring::mesh::mask::Mask;
use myospring::microscopy::outlines::PixelFrame;
use myospring::microscopy::outlines::raster::rasterise;
use myospring::microscopy::outlines::trace::{Edge, trace_mask};
use outline_files::close;
use proptest::prelude::*;

/// A rod with a notch and ragged ends, turned by an angle.
fn rod(width: usize, height: usize, angle_deg: f64) -> Mask {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let inside = (0..width * height)
        .map(|index| {
            let x = (index % width) as f64 - 0.5 * width as f64;
            let y = (index / width) as f64 - 0.5 * height as f64;
            let (u, v) = ((x * cos + y * sin) / 60.0, (y * cos - x * sin) / 14.0);
            u.abs() < 1.0 + 0.1 * (8.0 * v).sin() && v.abs() < 1.0 && (u - 0.3).hypot(v - 1.0) > 0.2
        })
        .collect();
    Mask::new(width, height, pixels_of(0.4), inside).unwrap()
}

#[test]
fn a_mask_and_its_exact_outline_give_the_same_mesh() {
    let mut masks = vec![rod(180, 160, 0.0), rod(180, 160, 33.0)];
    for file in ["images/contrax_brightfield_mask.png", "images/sarcgraph_e5_mask.png"] {
        if let Some(path) = common::shared_data(file) {
            masks.push(common::mask(path));
        }
    }
    for mask in masks {
        let outline = trace_mask(&mask, Edge::Exact).unwrap();
        let (expected, report) = lattice::from_mask(&mask, None).unwrap();
        let (mesh, _) = lattice::from_outline(&outline, Some(report.spacing_um)).unwrap();
        assert_eq!((mesh.len(), mesh.springs.len()), (expected.len(), expected.springs.len()));
        for node in 0..mesh.len() {
            // Rounding of coordinates of some 100 um.
            assert!(close(&mesh.point(node), &expected.point(node), 1e-9));
        }
        let smooth = trace_mask(&mask, Edge::Smooth).unwrap();
        let (smooth, _) = lattice::from_outline(&smooth, Some(report.spacing_um)).unwrap();
        let off = (smooth.area() / expected.area() - 1.0).abs();
        assert!(off < 0.01, "{off}");
    }
}

#[test]
fn a_smooth_outline_keeps_the_area_and_has_the_right_length() {
    for (radius, tolerance) in [(15.0, 0.025), (40.0, 0.005), (100.5, 0.005)] {
        let side = 2 * radius as usize + 9;
        let centre = 0.5 * side as f64 + 0.2;
        let disc = |index: usize| {
            let (x, y) = ((index % side) as f64 + 0.5, (index / side) as f64 + 0.5);
            (x - centre).hypot(y - centre) < radius
        };
        let mask =
            Mask::new(side, side, pixels_of(1.0), (0..side * side).map(disc).collect()).unwrap();
        let smooth = trace_mask(&mask, Edge::Smooth).unwrap();
        assert!((smooth.area() / mask.area_um2() - 1.0).abs() < 0.005);
        let length = smooth.perimeter() / (std::f64::consts::TAU * radius);
        // The staircase is 27 % too long, the middles of its steps 3 %, averaged 0.3 %.
        assert!((length - 1.0).abs() < tolerance, "radius {radius}: {length}");
        let again = rasterise(&smooth, &PixelFrame::of(&mask)).unwrap();
        let differ = again.inside().iter().zip(&mask.inside()).filter(|(a, b)| a != b).count();
        // Pixels on the rim only: a quarter of those that the circle passes.
        assert!((differ as f64) < 0.25 * std::f64::consts::TAU * radius, "{differ}");
    }
}

#[test]
fn a_mask_of_noise_is_refused_before_it_fills_the_memory() {
    // A chequerboard: one island with a hole for each white square.
    let side = 400;
    let chequer = (0..side * side).map(|index| (index / side + index) % 2 == 1).collect();
    let mask = Mask::new(side, side, pixels_of(2.0), chequer).unwrap();
    for edge in [Edge::Exact, Edge::Smooth] {
        let error = trace_mask(&mask, edge).unwrap_err().to_string();
        assert!(error.contains("is this the picture itself, not its mask?"), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn tracing_and_filling_again_changes_no_pixel(
        width in 2_usize..24,
        share in 0.1_f64..0.9,
        seeds in proptest::collection::vec(0.0_f64..1.0, 48..400),
    ) {
        let height = seeds.len() / width;
        let inside: Vec<bool> = seeds[..width * height].iter().map(|&seed| seed < share).collect();
        prop_assume!(inside.contains(&true) && inside.contains(&false));
        // Each pixel is larger than the smallest outline.
        let mask = Mask::new(width, height, pixels_of(2.0), inside.clone()).unwrap();
        let frame = PixelFrame::of(&mask);
        let mut area = 0.0;
        // Part by part, until none is left.
        let mut rest = mask.clone();
        loop {
            let part = rest.largest_part().0;
            let traced = trace_mask(&rest, Edge::Exact).unwrap();
            area += traced.area();
            prop_assert_eq!(rasterise(&traced, &frame).unwrap(), part.clone());
            let left: Vec<bool> =
                rest.inside().iter().zip(&part.inside()).map(|(&all, &part)| all && !part).collect();
            if !left.contains(&true) {
                break;
            }
            rest = Mask::new(width, height, pixels_of(2.0), left).unwrap();
        }
        // Bridges at corners, at most one for each pixel, of a millionth of a pixel.
        prop_assert!((area - mask.area_um2()).abs() <= 1e-6 * 4.0 * (width * height) as f64);
        let traced = trace_mask(&mask, Edge::Exact).unwrap();
        let smooth = trace_mask(&mask, Edge::Smooth).unwrap();
        prop_assert!((smooth.area() / traced.area() - 1.0).abs() < 0.0051);
    }
}
