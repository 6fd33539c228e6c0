//! Stacks of made-up cells: how far volume and thickness are off, and what the report says.

mod files;
mod made_up;
mod turning;

use crate::common::Sample;
use files::{described, plain};
use made_up::{Body, Scene};
use myospring::mesh::pixel_size::PixelSize;
use myospring::mesh::voxels::Voxels;
use myospring::microscopy::segment::{Choice, Modality, SegmentError, SegmentationSettings};
use myospring::microscopy::stack::{
    FirstSlice, Stack, StackError, StackOptions, StackReport, StackSelection, Stain,
};

/// A clear stack: pixels of 0.5 um, slices 1 um apart.
const CLEAR: Scene = Scene {
    body: Body::Ellipsoid,
    pixel_um: 0.5,
    z_step_um: 1.0,
    blur_um: [0.2, 0.6],
    noise: 0.1,
    membrane: false,
    attenuation_um: f64::INFINITY,
};

fn options(pixel_um: f64, z_step_um: f64) -> StackOptions {
    StackOptions {
        pixel_size: Some(PixelSize::new(pixel_um).unwrap()),
        z_step_um: Some(z_step_um),
        ..StackOptions::default()
    }
}

fn found(scene: &Scene, options: &StackOptions) -> (Voxels, StackReport) {
    let (slices, size) = scene.slices();
    let stack = Stack::read(plain(&slices, size), &StackSelection::default()).unwrap();
    stack.cell(options).unwrap_or_else(|error| panic!("{scene:?}: {error}"))
}

/// Errors of volume, per cent, and of thickness, um.
fn errors(scene: &Scene) -> ([f64; 2], StackReport) {
    let (voxels, report) = found(scene, &options(scene.pixel_um, scene.z_step_um));
    let [volume, thickness] = scene.body.measures();
    let errors = [100.0 * (voxels.volume_um3() / volume - 1.0), report.thickness_um - thickness];
    (errors, report)
}

/// Checks a scene: the volume to `volume_pct`, the thickness to half a step and a quarter of a
/// micrometre.
fn check(scene: Scene, volume_pct: f64) {
    let ([volume, thickness], report) = errors(&scene);
    let bound = 0.25 + 0.5 * scene.z_step_um;
    assert!(volume.abs() <= volume_pct, "{scene:?}: volume {volume:+.1} %");
    assert!(thickness.abs() <= bound, "{scene:?}: thickness {thickness:+.2} um");
    let stain = if scene.membrane { Stain::Membrane } else { Stain::Filled };
    assert_eq!(report.stain, Some(stain), "{scene:?}");
}

const BODIES: [Body; 4] = [Body::Ellipsoid, Body::Dome, Body::Slab, Body::Tilted];

#[test]
#[ignore = "slow"]
fn volume_and_thickness_of_a_filled_cell_are_found_whatever_the_voxels() {
    let mut sample = Sample::one_in(5);
    for body in BODIES {
        for (pixel_um, z_step_um) in [(0.25, 0.25), (0.5, 1.0), (0.25, 2.0), (0.5, 2.0)] {
            if !sample.leaves_out() {
                check(Scene { body, pixel_um, z_step_um, ..CLEAR }, 8.0);
            }
        }
    }
}

#[test]
#[ignore = "slow"]
fn volume_and_thickness_of_a_cell_with_a_bright_membrane_are_found() {
    check(Scene { pixel_um: 0.25, z_step_um: 0.5, membrane: true, ..CLEAR }, 12.0);
    for body in BODIES {
        check(Scene { body, membrane: true, ..CLEAR }, 12.0);
    }
}

#[test]
#[ignore = "slow"]
fn noise_blur_and_attenuation_change_the_volume_little() {
    let scenes = [
        Scene { noise: 0.3, ..CLEAR },
        Scene { noise: 0.6, ..CLEAR },
        Scene { blur_um: [0.2, 1.2], ..CLEAR },
        Scene { attenuation_um: 20.0, ..CLEAR },
        Scene { attenuation_um: 8.0, ..CLEAR },
    ];
    let mut sample = Sample::one_in(4);
    for body in BODIES {
        for scene in &scenes {
            if sample.leaves_out() {
                continue;
            }
            // Three slices deep inside a slab do not show attenuation surely, so it loses 11 %.
            check(Scene { body, ..*scene }, 12.0);
        }
    }
}

#[test]
#[ignore = "slow"]
fn attenuation_is_measured_only_where_it_is() {
    for (true_um, z_step_um) in [(8.0, 0.5), (20.0, 1.0)] {
        let (_, report) = errors(&Scene { attenuation_um: true_um, z_step_um, ..CLEAR });
        let found = report.attenuation_um.unwrap();
        assert!((found / true_um - 1.0).abs() < 0.1, "{found} of {true_um}");
    }
    assert_eq!(errors(&CLEAR).1.attenuation_um, None);
}

#[test]
#[ignore = "slow"]
fn the_edges_tell_the_blur_along_z() {
    for sigma in [0.6, 1.2] {
        let scene = Scene { z_step_um: 0.5, blur_um: [0.2, sigma], ..CLEAR };
        let blur = errors(&scene).1.blur.unwrap();
        let [found, expected] = [blur.depth_um.unwrap(), 2.3548 * sigma];
        assert!((found / expected - 1.0).abs() < 0.25, "{found} of {expected}");
        assert!(blur.plane_um.unwrap() < found);
    }
    // A cell thinner than the blur: the report says that it seems thicker.
    let thin = Scene { body: Body::Slab, blur_um: [0.2, 2.5], z_step_um: 0.5, ..CLEAR };
    let (_, report) = errors(&thin);
    assert!(
        report.warnings.iter().any(|warning| warning.contains("thinner than it seems")),
        "{report:?}"
    );
}

#[test]
fn a_cell_that_the_stack_cuts_or_shows_coarsely_has_a_warning() {
    let (slices, size) = CLEAR.slices();
    let warnings = |slices: &[Vec<f32>], step: f64| {
        let stack = Stack::read(plain(slices, size), &StackSelection::default()).unwrap();
        stack.cell(&options(0.5, step)).unwrap().1.warnings
    };
    let says = |warnings: &[String], what: &str| warnings.iter().any(|text| text.contains(what));
    // The middle of the cell is 11 um above the first slice.
    let cut = warnings(&slices[10..], 1.0);
    assert!(says(&cut, "the cell reaches the lowest slice"), "{cut:?}");
    let cut = warnings(&slices[..12], 1.0);
    assert!(says(&cut, "the cell reaches the highest slice"), "{cut:?}");
    let whole = warnings(&slices, 1.0);
    assert!(!says(&whole, "reaches") && !says(&whole, "slice(s) show"), "{whole:?}");
    let every_third: Vec<Vec<f32>> = slices.iter().skip(1).step_by(3).cloned().collect();
    let coarse = warnings(&every_third, 3.0);
    assert!(says(&coarse, "slice(s) show the cell, fewer than 5"), "{coarse:?}");
    let fine = warnings(&slices, 0.05);
    assert!(says(&fine, "is the z step of 0.05 um right?"), "{fine:?}");
}

/// A mask of two boxes with different values; rows from the top of the picture.
fn boxes(shape: [usize; 3]) -> Vec<Vec<f32>> {
    let value = |[x, y, z]: [usize; 3]| match (x, y, z) {
        (2..9, 1..4, 1..5) => 7.0,
        (3..5, 6..8, 2..4) => 9.0,
        _ => 0.0,
    };
    let slice = |z: usize| {
        (0..shape[0] * shape[1]).map(|at| value([at % shape[0], at / shape[0], z])).collect()
    };
    (0..shape[2]).map(slice).collect()
}

#[test]
fn masks_and_labels_are_exact() {
    let shape = [24, 20, 7];
    let stack = Stack::read(plain(&boxes(shape), [24, 20]), &StackSelection::default()).unwrap();
    for anisotropy in [1.0, 2.5, 8.0] {
        let step = 0.4 * anisotropy;
        let (cell, report) = stack.cell(&options(0.4, step)).unwrap();
        let [low, high] = cell.bounds_um();
        // Rows 1 to 3 from the top are rows 16 to 18 from the bottom.
        let expected = [[0.8, 6.4, step], [3.6, 7.6, 5.0 * step]];
        for axis in 0..3 {
            assert!((low[axis] - expected[0][axis]).abs() < 1e-12, "{low:?}");
            assert!((high[axis] - expected[1][axis]).abs() < 1e-12, "{high:?}");
        }
        assert_eq!((cell.count(), report.cells, report.slices_in_cell), (7 * 3 * 4, 2, 4));
        assert!((report.thickness_um - 4.0 * step).abs() < 1e-12);
        assert!((cell.above().unwrap().area_um2() - 21.0 * 0.16).abs() < 1e-12);
        let labelled = StackOptions { choice: Choice::Label(9), ..options(0.4, step) };
        assert_eq!(stack.cell(&labelled).unwrap().0.count(), 2 * 2 * 2);
        let turned = StackOptions { first_slice: FirstSlice::Top, ..options(0.4, step) };
        let bounds = stack.cell(&turned).unwrap().0.bounds_um();
        assert!((bounds[0][2] - 2.0 * step).abs() < 1e-12, "{bounds:?}");
        let seeded = StackOptions { choice: Choice::At([4.5, 6.5]), ..options(0.4, step) };
        assert_eq!(stack.cell(&seeded).unwrap().0.count(), 8);
    }
    let unknown = StackOptions { choice: Choice::Label(3), ..options(0.4, 1.0) };
    let error = stack.cell(&unknown).unwrap_err();
    assert!(matches!(error, StackError::Segment(SegmentError::NoSuchLabel { label: 3, .. })));
}

#[test]
fn of_a_mask_of_one_value_connected_parts_are_the_cells() {
    let slices: Vec<Vec<f32>> =
        boxes([24, 20, 7]).iter().map(|slice| slice.iter().map(|v| v.min(1.0)).collect()).collect();
    let stack = Stack::read(plain(&slices, [24, 20]), &StackSelection::default()).unwrap();
    let (cell, report) = stack.cell(&options(0.4, 1.0)).unwrap();
    assert_eq!((cell.count(), report.cells), (84, 2));
    let second = StackOptions { choice: Choice::Number(2), ..options(0.4, 1.0) };
    assert_eq!(stack.cell(&second).unwrap().0.count(), 8);
}

#[test]
fn a_page_for_each_slice_needs_only_pixel_size_and_z_step() {
    let stack =
        Stack::read(plain(&boxes([24, 20, 7]), [24, 20]), &StackSelection::default()).unwrap();
    let message = |options: StackOptions| stack.cell(&options).unwrap_err().to_string();
    assert!(message(StackOptions::default()).contains("--pixel-size"));
    let pixel = StackOptions { z_step_um: None, ..options(0.4, 1.0) };
    assert!(message(pixel).contains("--z-step \"0.5 um\""));
    let nothing = message(options(0.4, 0.0));
    assert!(nothing.starts_with("the z step is 0 um, outside 0.001 to 50 um"), "{nothing}");
    let segmentation =
        SegmentationSettings { modality: Modality::Brightfield, ..SegmentationSettings::default() };
    let brightfield = message(StackOptions { segmentation, ..options(0.4, 1.0) });
    assert!(brightfield.contains("a thickness"), "{brightfield}");
}

#[test]
fn the_file_states_pixel_size_z_step_channels_and_time_points() {
    let slices = boxes([24, 20, 6]);
    let read = |description: &str, selection: StackSelection| {
        Stack::read(described(&slices, [24, 20], description), &selection)
    };
    let all = StackSelection::default();
    let imagej = read("ImageJ=1.53\nimages=6\nslices=6\nunit=micron\nspacing=-1.5\n", all).unwrap();
    assert_eq!((imagej.slices(), imagej.z_step_um), (6, Some(1.5)));
    let ome = |sizes: &str| {
        format!(
            "<?xml version=\"1.0\"?><OME><Image><Pixels DimensionOrder=\"XYCZT\" {sizes} PhysicalSizeX=\"0.3\" \
             PhysicalSizeZ=\"900\" PhysicalSizeZUnit=\"nm\"><TiffData/></Pixels></Image></OME>"
        )
    };
    let stack = read(&ome("SizeC=\"1\" SizeZ=\"6\" SizeT=\"1\""), all).unwrap();
    let scale = stack.scale(&StackOptions::default()).unwrap();
    assert!((scale.pixel_size.um() - 0.3).abs() < 1e-12 && (scale.z_step_um - 0.9).abs() < 1e-12);
    let channels = ome("SizeC=\"2\" SizeZ=\"3\" SizeT=\"1\"");
    assert_eq!(
        read(&channels, all).unwrap_err().to_string(),
        "the stack has 2 channels, 0 to 1; say which one shows the cell, like --channel 0"
    );
    let second = read(&channels, StackSelection { channel: Some(1), frame: None }).unwrap();
    assert_eq!(second.slices(), 3);
    assert_eq!(second.slice(1).unwrap().values(), slices[3]);
    let times = ome("SizeC=\"1\" SizeZ=\"2\" SizeT=\"3\"");
    assert!(read(&times, all).unwrap_err().to_string().contains("3 time points, 0 to 2"));
    let last = read(&times, StackSelection { channel: None, frame: Some(2) }).unwrap();
    assert_eq!(last.slice(0).unwrap().values(), slices[4]);
    // Slices that were saved as time points.
    let film = read(&ome("SizeC=\"1\" SizeZ=\"1\" SizeT=\"6\""), all).unwrap();
    assert_eq!(film.slices(), 6);
    assert!(film.notes[0].contains("time points were taken as slices"), "{:?}", film.notes);
}

#[test]
fn pictures_in_natural_order_are_slices() {
    let slices = boxes([24, 20, 7]);
    let mut files: Vec<(String, Vec<u8>)> = slices
        .iter()
        .enumerate()
        .map(|(z, slice)| (format!("z{}.tif", z + 5), plain(std::slice::from_ref(slice), [24, 20])))
        .collect();
    files.reverse();
    let stack = Stack::of_pictures(files, &StackSelection::default()).unwrap();
    assert_eq!(stack.cell(&options(0.4, 1.0)).unwrap().0.count(), 84);
    let odd = vec![
        ("a.tif".to_owned(), plain(&slices[..1], [24, 20])),
        ("b.tif".to_owned(), plain(&[vec![0.0; 6]], [3, 2])),
    ];
    let stack = Stack::of_pictures(odd, &StackSelection::default()).unwrap();
    let error = stack.cell(&options(0.4, 1.0)).unwrap_err().to_string();
    assert!(error.starts_with("slice 1 (`b.tif`) has 3 x 2 pixels"), "{error}");
}

#[test]
fn stacks_without_a_cell_are_refused_in_words() {
    let size = [40, 30];
    let blank = vec![vec![5.0; 1200]; 6];
    let stack = Stack::read(plain(&blank, size), &StackSelection::default()).unwrap();
    assert!(stack.cell(&options(0.5, 1.0)).is_err());
    let dark = vec![vec![0.0; 1200]; 6];
    let stack = Stack::read(plain(&dark, size), &StackSelection::default()).unwrap();
    assert!(stack.cell(&options(0.5, 1.0)).is_err());
    let one = Stack::read(plain(&blank[..1], size), &StackSelection::default());
    assert_eq!(one.unwrap_err(), StackError::TooFew { slices: 1 });
    let noise = Scene { noise: 0.3, ..CLEAR }.noise_alone();
    let stack = Stack::read(plain(&noise.0, noise.1), &StackSelection::default()).unwrap();
    assert!(stack.cell(&options(0.5, 1.0)).is_err());
}
