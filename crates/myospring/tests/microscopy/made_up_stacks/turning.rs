//! Stripes that turn from slice to slice.

use super::files::plain;
use super::options;
use myospring::mesh::voxels::Voxels;
use myospring::microscopy::fibres::{FibreSettings, Stain};
use myospring::microscopy::segment::{Modality, SegmentationSettings};
use myospring::microscopy::stack::{Stack, StackOptions, StackSelection};

const SIZE: [usize; 2] = [160, 90];
const PIXEL_UM: f64 = 0.25;
const SLICES: usize = 9;

/// Slices with z-discs 1.8 um apart across fibres that turn by `per_slice` degrees, and no stripes in
/// the uppermost `blank` slices.
fn stripes(per_slice: f64, blank: usize) -> (Stack, Voxels) {
    let [width, height] = SIZE;
    let slice = |z: usize| {
        let (sine, cosine) = (20.0 + per_slice * z as f64).to_radians().sin_cos();
        let value = |at: usize| {
            let (x, y) = ((at % width) as f64 * PIXEL_UM, -((at / width) as f64) * PIXEL_UM);
            let wave = (std::f64::consts::TAU * (cosine * x + sine * y) / 1.8).sin();
            let noise = ((at * 7919 + z * 104_729) % 1009) as f64 / 1009.0;
            let strength = if z + blank >= SLICES { 0.0 } else { 300.0 };
            (500.0 + strength * wave + 100.0 * noise).round() as f32
        };
        (0..width * height).map(value).collect::<Vec<f32>>()
    };
    let slices: Vec<Vec<f32>> = (0..SLICES).map(slice).collect();
    let stack = Stack::read(plain(&slices, SIZE), &StackSelection::default()).unwrap();
    let mut inside = vec![true; width * height * SLICES];
    inside[0] = false;
    let voxels = Voxels::new([width, height, SLICES], [PIXEL_UM, PIXEL_UM, 1.0], inside).unwrap();
    (stack, voxels)
}

fn settings() -> StackOptions {
    let segmentation = SegmentationSettings {
        modality: Modality::Fluorescence,
        ..SegmentationSettings::default()
    };
    StackOptions { segmentation, ..options(PIXEL_UM, 1.0) }
}

#[test]
fn the_turn_of_the_fibres_is_measured_with_its_error() {
    let zdisc = FibreSettings::of(Stain::ZDisc);
    for per_slice in [-6.0, 0.0, 4.0] {
        let (stack, voxels) = stripes(per_slice, 0);
        let fibres = stack.fibres(&voxels, [1.0, 0.0], &zdisc, &settings()).unwrap();
        for slice in &fibres.slices {
            let off = slice.angle_deg.unwrap() - 20.0 - per_slice * slice.slice as f64;
            assert!(off.abs() < 1.5, "{slice:?}");
        }
        let helix = fibres.helix.unwrap();
        let off = helix.turn_deg - per_slice * (SLICES - 1) as f64;
        assert!(off.abs() < 1.5 && helix.error_deg < 1.0, "{helix:?}");
        assert_eq!((helix.slices, helix.heights_um), (SLICES, [0.5, 8.5]));
        // Between slices it turns evenly; beyond the outermost it does not.
        for (height, level) in [(0.0, 0.0), (3.5, 3.0), (4.2, 3.7), (9.0, 8.0)] {
            let [x, y] = fibres.at([20.0, 11.0, height]).unwrap();
            let off = y.atan2(x).to_degrees() - 20.0 - per_slice * level;
            assert!((off - 180.0 * (off / 180.0).round()).abs() < 2.0, "{height}: {off}");
        }
        let widest = stack.fibres_of_widest(&voxels, [1.0, 0.0], &zdisc, &settings()).unwrap();
        assert!((widest.summary().median_sarcomere_um.unwrap() - 1.8).abs() < 0.02);
    }
}

#[test]
fn slices_without_stripes_have_no_direction() {
    let zdisc = FibreSettings::of(Stain::ZDisc);
    let (stack, voxels) = stripes(4.0, 7);
    let fibres = stack.fibres(&voxels, [1.0, 0.0], &zdisc, &settings()).unwrap();
    assert_eq!(fibres.slices.iter().filter(|slice| slice.angle_deg.is_some()).count(), 2);
    assert_eq!(fibres.helix, None);
    // Where no slice shows a direction, it is that of the nearest that does.
    let angle = |height| fibres.at([20.0, 11.0, height]).map(|[x, y]| y.atan2(x));
    assert_eq!(angle(8.0), angle(1.5));
    assert!(
        fibres.warnings[0].starts_with("7 of 9 slices show no fibres"),
        "{:?}",
        fibres.warnings
    );
}
