//! A stack of slices as the shape of a run.

use myospring::run_file::RunFile;
use std::io;
use tiff::encoder::{TiffEncoder, colortype::Gray8};

/// The mask of an ellipsoid of 60 x 20 x 8 um in voxels of 0.5 x 0.5 x 1 um.
fn ellipsoid() -> Vec<u8> {
    let [columns, rows, slices] = [140_u32, 60, 12];
    let mut bytes = io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    for slice in 0..slices {
        let z = (f64::from(slice) + 0.5 - 6.0) / 4.0;
        let inside = |at: u32| {
            let x = 0.5 * (f64::from(at % columns) + 0.5 - 70.0) / 30.0;
            let y = 0.5 * (f64::from(at / columns) + 0.5 - 30.0) / 10.0;
            if x * x + y * y + z * z < 1.0 { 255 } else { 0 }
        };
        let pixels: Vec<u8> = (0..columns * rows).map(inside).collect();
        encoder.write_image::<Gray8>(columns, rows, &pixels).unwrap();
    }
    bytes.into_inner()
}

fn read(path: &str) -> io::Result<Vec<u8>> {
    if path == "cell.tif" { Ok(ellipsoid()) } else { Err(io::ErrorKind::NotFound.into()) }
}

#[test]
fn a_stack_gives_a_thick_cell_of_its_volume_that_beats() {
    let text = "[shape]\nstack = \"cell.tif\"\npixel_size = \"0.5 um\"\nz_step = \"1 um\"\nspacing = \"1.6 um\"\n";
    let file = RunFile::from_text(text).unwrap();
    let run = file.resolve().unwrap();
    let shaped = run.shape.mesh(&run.shape.bytes(read).unwrap()).unwrap();
    let thick = shaped.report.thick.unwrap();
    let exact = 4.0 / 3.0 * std::f64::consts::PI * 30.0 * 10.0 * 4.0;
    assert!((thick.volume_um3 / exact - 1.0).abs() < 0.02, "{} um^3", thick.volume_um3);
    assert_eq!(thick.layers, 5);
    let told = shaped.report.warnings.join("\n");
    assert!(told.contains("--first-slice top"), "{told}");
    let made = run.make(shaped, read).unwrap();
    let outcome = made.simulation.build().unwrap().run(|_| true);
    let beats = outcome.beats();
    assert!((beats[0].value("peak_shortening").unwrap() - 12.0).abs() < 0.01);
    // What repeats the run is the same run.
    let again = run.to_run_file().to_toml();
    assert!(again.contains("stack = \"cell.tif\"") && !again.contains("profile"), "{again}");
    let again = RunFile::from_text(&again).unwrap().resolve().unwrap();
    assert_eq!((&again.shape, &again.material), (&run.shape, &run.material));
    assert_eq!(again.numerics.method, run.numerics.method);
}

#[test]
fn a_stack_without_a_scale_says_which_is_missing_and_how_to_give_it() {
    for (scale, option) in
        [("z_step = \"1 um\"", "--pixel-size"), ("pixel_size = \"0.5 um\"", "--z-step")]
    {
        let text = format!("[shape]\nstack = \"cell.tif\"\n{scale}\n");
        let run = RunFile::from_text(&text).unwrap().resolve().unwrap();
        let error = run.shape.mesh(&run.shape.bytes(read).unwrap()).unwrap_err().to_string();
        assert!(error.contains("`cell.tif`") && error.contains(option), "{error}");
    }
}

#[test]
fn of_two_cells_the_larger_is_taken_and_said_so_unless_one_is_chosen() {
    let mut bytes = io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    for slice in 0..12_u32 {
        let inside = |at: u32| {
            let (column, row) = (at % 140, at / 140);
            let of_both = (5..45).contains(&row) || (60..84).contains(&row);
            let within = (10..130).contains(&column) && of_both && (2..10).contains(&slice);
            if within { 255 } else { 0 }
        };
        let pixels: Vec<u8> = (0..140 * 90).map(inside).collect();
        encoder.write_image::<Gray8>(140, 90, &pixels).unwrap();
    }
    let bytes = bytes.into_inner();
    for (choice, width, is_told) in [("", 20.0, true), ("[segmentation]\ncell = 2", 12.0, false)] {
        let text = format!(
            "[shape]\nstack = \"cell.tif\"\npixel_size = \"0.5 um\"\nz_step = \"1 um\"\nspacing = \"2 um\"\n{choice}\n"
        );
        let run = RunFile::from_text(&text).unwrap().resolve().unwrap();
        let shaped = run.shape.mesh(&run.shape.bytes(|_| Ok(bytes.clone())).unwrap()).unwrap();
        let found = shaped.report.dimensions.width_um;
        assert!((found - width).abs() < 0.5, "{found}");
        let warnings = shaped.report.warnings.join("\n");
        assert_eq!(warnings.contains("2 cells were found"), is_told, "{warnings}");
    }
}

/// A slab of 60 x 20 x 8 um with z-discs 1.8 um apart, whose fibres turn by 4 degrees from slice to slice, in slices 1 um apart.
fn turning() -> Vec<u8> {
    let [columns, rows, slices] = [280_u32, 120, 12];
    let mut bytes = io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    for slice in 0..slices {
        let (sine, cosine) = (4.0 * (f64::from(slice) - 5.5)).to_radians().sin_cos();
        let grey = |at: u32| {
            let [x, y] = [f64::from(at % columns) - 140.0, 60.0 - f64::from(at / columns)];
            let [x, y] = [0.25 * x, 0.25 * y];
            let inside = (x / 30.0).powi(4) + (y / 10.0).powi(4) < 1.0 && (2..10).contains(&slice);
            let wave = (std::f64::consts::TAU * (cosine * x + sine * y) / 1.8).sin();
            let noise = f64::from((at * 7919 + slice * 104_729) % 1009) / 1009.0;
            (10.0 * noise + if inside { 140.0 + 60.0 * wave } else { 5.0 }) as u8
        };
        let pixels: Vec<u8> = (0..columns * rows).map(grey).collect();
        encoder.write_image::<Gray8>(columns, rows, &pixels).unwrap();
    }
    bytes.into_inner()
}

#[test]
fn fibres_are_those_of_each_slice_unless_the_angle_is_stated_by_which_they_turn() {
    let read = |path: &str| if path == "cell.tif" { Ok(turning()) } else { read(path) };
    let made = |mechanics: &str| {
        let text = format!(
            "[shape]\nstack = \"cell.tif\"\npixel_size = \"0.25 um\"\nz_step = \"1 um\"\nspacing = \"2 um\"\n[mechanics]\n{mechanics}"
        );
        let run = RunFile::from_text(&text).unwrap().resolve().unwrap();
        run.make(run.shape.mesh(&run.shape.bytes(read).unwrap()).unwrap(), read).unwrap()
    };
    for mechanics in ["", "fibre = \"picture\""] {
        let made = made(mechanics);
        let told = made.fibres_of_picture().unwrap().to_string();
        assert!(
            told.starts_with("read from 8 of 8 slices") && told.contains("turn by 28 deg"),
            "{told}"
        );
        let directions = made.simulation.fibres_in_space.unwrap();
        let mesh = &made.simulation.thick.as_ref().unwrap().mesh;
        for (tetrahedron, [x, y, _]) in mesh.simplices.iter().zip(directions) {
            // Slice 2 lies at a height of 2.5 um; below the lowest and above the highest nothing turns.
            let height = mesh.centre(tetrahedron)[2].clamp(2.5, 9.5);
            let off = y.atan2(x).to_degrees() - 4.0 * (height - 6.0);
            let off = off - 180.0 * (off / 180.0).round();
            assert!(off.abs() < 4.0, "{mechanics}: {off} degrees at {height} um");
        }
    }
    let along = made("fibre = \"long axis\"");
    assert!(along.simulation.fibres_in_space.is_none() && along.fibres_of_picture().is_none());
    let stated = made("helix_angle = \"10 deg\"");
    assert!(stated.simulation.fibres_in_space.is_some() && stated.fibres_of_picture().is_none());
}

#[test]
fn what_only_a_flat_picture_shows_is_not_asked_of_a_stack() {
    for (asked, key) in [
        ("myofibril_content = \"picture\"", "myofibril_content"),
        ("fibre = \"picture\"\nhelix_angle = \"10 deg\"", "helix_angle"),
    ] {
        let text = format!("[shape]\nstack = \"cell.tif\"\n[mechanics]\n{asked}\n");
        let error = RunFile::from_text(&text).unwrap().resolve().err().unwrap().to_string();
        assert!(error.contains(key), "{error}");
    }
}
