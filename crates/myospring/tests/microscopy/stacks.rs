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
    assert_eq!(again.numerics, run.numerics);
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
