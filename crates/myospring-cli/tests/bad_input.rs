//! Bad input: a message that says how to mend it, exit code 2, and nothing half-written.

#![allow(clippy::unwrap_used, reason = "a test may stop here")]

use std::fs;
use std::path::Path;
use std::process::Command;

/// A folder with pictures good and bad.
fn workplace() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let save = |name: &str, size: u32, inside: &dyn Fn(u32, u32) -> bool| {
        let pick = |at: u32| if inside(at % size, at / size) { 255 } else { 0 };
        let pixels: Vec<u8> = (0..size * size).map(pick).collect();
        let file = fs::File::create(folder.path().join(name)).unwrap();
        // Grey with 8 bits unless something else is set.
        let mut encoder = png::Encoder::new(file, size, size).write_header().unwrap();
        encoder.write_image_data(&pixels).unwrap();
    };
    save("good.png", 80, &|x, y| (10..70).contains(&x) && (20..60).contains(&y));
    save("dark.png", 80, &|x, y| x < 3 && y < 3);
    save("black.png", 40, &|_, _| false);
    save("white.png", 40, &|_, _| true);
    save("speck.png", 40, &|x, y| y == 20 && (20..23).contains(&x));
    let good = fs::read(folder.path().join("good.png")).unwrap();
    fs::write(folder.path().join("truncated.png"), &good[..good.len() / 2]).unwrap();
    fs::write(folder.path().join("text.png"), "this is no picture").unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    fs::write(folder.path().join("cell.czi"), "ZISRAWFILE").unwrap();
    fs::write(folder.path().join("cell.JPG"), "no JPEG even").unwrap();
    fs::write(folder.path().join("cell.vtk"), "# vtk DataFile Version 3.0\n").unwrap();
    fs::create_dir(folder.path().join("dish")).unwrap();
    fs::write(folder.path().join("dish/a.lif"), "").unwrap();
    fs::write(folder.path().join("czi.toml"), "[shape]\npicture = \"cell.czi\"\n").unwrap();
    fs::write(folder.path().join("damaged.roi"), "[Iou").unwrap();
    fs::write(folder.path().join("beat.csv"), "t_ms,length_um\n0,120\n1,118\n2,119\n").unwrap();
    fs::write(folder.path().join("pictures.csv"), "file\ncell.tif\n").unwrap();
    fs::write(folder.path().join("content.csv"), "content\n1\n-1\n").unwrap();
    fs::write(folder.path().join("beside.csv"), "x_um,y_um,content\n900,900,1\n990,900,2\n")
        .unwrap();
    fs::write(folder.path().join("mm.csv"), "x_mm,y_mm,content\n0,0,1\n").unwrap();
    fs::write(folder.path().join("tabs.csv"), "x_um\ty_um\tcontent\n0\t0\t1\n").unwrap();
    fs::write(folder.path().join("rows.csv"), "content\n1\n1\n").unwrap();
    fs::write(folder.path().join("film.avi"), "RIFF....AVI LIST").unwrap();
    fs::write(folder.path().join("drawn.geojson"), "{}").unwrap();
    fs::write(folder.path().join("study.toml"), "[sampling]\nsampler = \"morris\"\n").unwrap();
    fs::write(folder.path().join("drug.toml"), "[[drug]]\nname = \"a\"\n").unwrap();
    fs::write(folder.path().join("my cell.png"), "").unwrap();
    fs::create_dir(folder.path().join("frames")).unwrap();
    fs::write(folder.path().join("frames/1.png"), "").unwrap();
    fs::create_dir(folder.path().join("beaten")).unwrap();
    fs::write(folder.path().join("beaten/run.toml"), "").unwrap();
    fs::write(folder.path().join("beaten/traces.csv"), "").unwrap();
    // A header that declares 100 000 x 100 000 pixels, with its right checksum.
    let mut huge = good.clone();
    huge[16..20].copy_from_slice(&100_000_u32.to_be_bytes());
    huge[20..24].copy_from_slice(&100_000_u32.to_be_bytes());
    let check = crc32(&huge[12..29]).to_be_bytes();
    huge[29..33].copy_from_slice(&check);
    fs::write(folder.path().join("huge.png"), huge).unwrap();
    fs::write(folder.path().join("unknown_key.toml"), "[material]\nthicknes = \"8 um\"\n").unwrap();
    let slow = "[material]\ndrag_ratio = 20\n[numerics]\nintegrator = \"quasi-static\"\n";
    fs::write(folder.path().join("slow.toml"), slow).unwrap();
    fs::write(folder.path().join("nan.toml"), "[cell]\npeak_tension = nan\n").unwrap();
    fs::write(folder.path().join("wrong_unit.toml"), "[cell]\npeak_tension = \"50 mV\"\n").unwrap();
    folder
}

/// CRC-32 as PNG has it.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 }
        })
    })
}

fn listing(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut paths: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

const PIXELS: [&str; 2] = ["--pixel-size", "0.5 um"];

/// Arguments, and parts of the message that they get.
const CASES: &[(&[&str], &[&str])] = &[
    (
        &["run", "missing.png", PIXELS[0], PIXELS[1]],
        &["cannot read `missing.png`", "check the path"],
    ),
    (
        &["run", "text.png", PIXELS[0], PIXELS[1]],
        &["`text.png`: this is not a picture", "PNG or TIFF"],
    ),
    (
        &["run", "truncated.png", PIXELS[0], PIXELS[1]],
        &["`truncated.png`", "cannot be read", "complete?"],
    ),
    (
        &["run", "huge.png", PIXELS[0], PIXELS[1]],
        &["declares 100000 x 100000 pixels", "cut out the cell"],
    ),
    (
        &["run", "black.png", PIXELS[0], PIXELS[1]],
        &["all 40 x 40 pixels have the same value, 0", "no cell is visible"],
    ),
    (
        &["run", "white.png", PIXELS[0], PIXELS[1]],
        &["pixels have the same value, 255", "no cell is visible"],
    ),
    (&["run", "good.png"], &["does not say how large its pixels are", "--pixel-size"]),
    (
        &["run", "good.png", "--pixel-size", "0.27 mm"],
        &["--pixel-size", "270 um", "0.001 um to 50 um"],
    ),
    (
        &["run", "good.png", "--pixel-size", "0.5 um", "--label", "7"],
        &["label 7 is not in the picture", "255"],
    ),
    (&["run", "--spacing", "50 um"], &["spacing 50 um exceeds", "give less"]),
    (&["run", "--spacing", "0.001 um"], &["spacing 0.001 um would give about", "masses"]),
    (&["run", "--spacing", "-1 um"], &["--spacing", "-1 um is outside its bounds"]),
    (&["run", "--thickness", "0 um"], &["0 um is outside", "like --thickness \"10 um\""]),
    (&["run", "--thickness", "-3 um"], &["-3 um is outside its bounds, above 0 um"]),
    (
        &["run", "--time-step", "0.1 ms"],
        &["time step 0.1 ms exceeds the stability limit 0.0", "smaller step"],
    ),
    (
        &["run", "--peak-tension", "50 mV"],
        &["`50 mV` is a potential, but a pressure is needed", "kPa"],
    ),
    (&["run", "--model", "coelho"], &["no cell model is named `coelho`", "models"]),
    (
        &["run", "--integrator", "quasi-static", "--area-law", "printed"],
        &["--area-law", "no energy", "area_law = \"gradient\"", "integrator = \"verlet\""],
    ),
    (
        &["run", "--integrator", "quasi-static", "--area-law", "barycentric"],
        &["--area-law", "no energy", "area_law = \"gradient\""],
    ),
    (
        &["run", "--integrator", "quasi-static", "--active", "ends"],
        &["--active", "active = \"fibre\"", "integrator = \"verlet\""],
    ),
    (
        &["run", "--integrator", "quasi-static", "--time-step", "0.001 ms"],
        &["--time-step", "no time step", "leave it out"],
    ),
    (&["run", "slow.toml"], &["delay the shape by", "drag_ratio", "Verlet", "more than 1 ms"]),
    (
        &["run", "--engine", "fused", "--active", "ends"],
        &["engine = \"fused\"", "`end tension`", "engine = \"plain\""],
    ),
    (
        &["run", "--engine", "fused", "--integrator", "velocity-verlet"],
        &["engine = \"fused\"", "velocity Verlet"],
    ),
    (
        &["run", "--myofibril-content", "content.csv"],
        &["content.csv", "line 3", "content is -1", "from 0 to 100"],
    ),
    (
        &["run", "--myofibril-content", "beside.csv"],
        &["beside.csv", "[900.0, 900.0] to [990.0, 900.0] um", "same origin"],
    ),
    (
        &["run", "--myofibril-content", "mm.csv"],
        &["mm.csv", "its columns are `x_mm`, `y_mm`, `content`", "`x_um,y_um,content`"],
    ),
    (
        &["run", "--myofibril-content", "tabs.csv"],
        &["tabs.csv", "its one column, as separated by commas", "`x_um,y_um,content`"],
    ),
    (
        &["run", "--myofibril-content", "rows.csv"],
        &["rows.csv", "2 rows", "triangles: give one for each"],
    ),
    (
        &["run", "--myofibril-content", "good.png"],
        &["`good.png` is a picture", "give a table (.csv)"],
    ),
    (
        &["run", "good.png", PIXELS[0], PIXELS[1], "--myofibril-content", "dark.png"],
        &["`dark.png` is black everywhere in the cell"],
    ),
    (
        &["run", "good.png", PIXELS[0], PIXELS[1], "--myofibril-content", "speck.png"],
        &["`speck.png` has [40, 40] pixels", "[80, 80]", "same frame"],
    ),
    (&["run", "--integrator", "quasistatic"], &["did you mean `quasi-static`?"]),
    (&["run", "--support", "spring-held-ends"], &["end_stiffness` is missing", "nN/um"]),
    (&["run", "--bed-stiffness", "1 kPa/um"], &["--bed-stiffness", "support = \"elastic-bed\""]),
    (&["run", "--area-law", "gradeint"], &["did you mean `gradient`?"]),
    (
        &["run", "unknown_key.toml"],
        &["unknown_key.toml:2:1", "did you mean `thickness`?", "keys in [material]"],
    ),
    (&["run", "nan.toml"], &["nan.toml:2:16", "is not a finite number"]),
    (
        &["run", "wrong_unit.toml"],
        &["wrong_unit.toml:2:16", "is a potential", "peak_tension = \"50 kPa\""],
    ),
    (&["run", "nothing.toml"], &["cannot read `nothing.toml`"]),
    (&["run", "file"], &["has an ending that is not known", ".png"]),
    (&["run", "cell.czi"], &["`cell.czi`: this is a Zeiss CZI file", "export it as OME-TIFF"]),
    (&["run", "cell.vtk"], &["`cell.vtk`: this is a VTK mesh", "mask stack", "mesh_to_stack.py"]),
    (&["run", "--stack", "cell.vtk"], &["cell.vtk", "this is a VTK mesh", "mesh_to_stack.py"]),
    (&["segment", "cell.JPG"], &["`cell.JPG`: this is a JPEG picture", "save the original"]),
    (&["run", "missing.nd2"], &["cannot read `missing.nd2`"]),
    (&["segment", "dish"], &["`dish` is a folder", "myospring batch dish"]),
    (&["run", "dish"], &["`dish` is a folder", "myospring batch dish"]),
    (&["batch", "dish"], &["holds no file like *.png", "1 .lif", "Leica LIF", "OME-TIFF"]),
    (&["run", "czi.toml"], &["shape.picture", "this is a Zeiss CZI file", "export it as OME-TIFF"]),
    (
        &["run", "damaged.roi", PIXELS[0], PIXELS[1]],
        &["damaged.roi is damaged, or not a valid ImageJ ROI", "save it again in Fiji"],
    ),
    (
        &["run", "good.png", PIXELS[0], PIXELS[1], "--outline", "damaged.roi"],
        &["damaged.roi is damaged, or not a valid ImageJ ROI"],
    ),
    (&["run", "beat.csv"], &["a table of measured curves", "`myospring analyse beat.csv`"]),
    (&["segment", "beat.csv"], &["a table of measured curves", "fit --to beat.csv"]),
    (&["track", "beat.csv"], &["a table of measured curves", "analyse beat.csv"]),
    (&["batch", "beat.csv"], &["a table of measured curves", "analyse beat.csv"]),
    (&["run", "film.avi"], &["`film.avi` is a film", "`myospring track film.avi`"]),
    (&["analyse", "film.avi"], &["`film.avi`: the AVI film cannot be read", "complete?"]),
    (&["analyse", "film.avi", "--pixel-size", "0 um"], &["--pixel-size is 0 um", "above 0"]),
    (&["segment", "film.avi"], &["is a film", "`myospring track film.avi`"]),
    (&["mesh", "film.avi"], &["is a film", "`myospring track film.avi`"]),
    (&["compare", "film.avi", "a"], &["is a film", "`myospring track film.avi`"]),
    (&["study", "run", "film.avi"], &["is a film", "`myospring track film.avi`"]),
    (&["analyse", "good.png"], &["is a picture", "`myospring run good.png`"]),
    (&["batch", "good.png"], &["is a picture", "`myospring run good.png`"]),
    (&["track", "drawn.geojson"], &["is an outline", "`myospring run drawn.geojson`"]),
    (&["run", "study.toml"], &["the description of a study", "study run study.toml"]),
    (&["study", "run", "nan.toml"], &["is a run file", "`myospring run nan.toml`"]),
    (&["run", "drug.toml"], &["a file of doses", "--doses drug.toml"]),
    (&["run", "frames"], &["a folder of pictures", "batch frames", "track frames"]),
    (&["analyse", "frames"], &["`1.png`", "not a picture", "PNG or TIFF"]),
    (&["run", "beaten"], &["the results of a run", "`myospring run beaten/run.toml`"]),
    (&["run", "my", "cell.png"], &["needs quotes", "write \"my cell.png\""]),
    (
        &["run", "--pixel-size", "0.27", "um"],
        &["a value with a space needs quotes", "write --pixel-size \"0.27 um\""],
    ),
    (
        &["run", "good.png", "--pixel-size", "0,27 um"],
        &["has a comma in its number", "write \"0.27 um\""],
    ),
    (
        &["run", "good.png", "--pixel-size", "0.27 UM"],
        &["unknown unit `UM`", "did you mean \"0.27 um\"?"],
    ),
    (
        &["analyse", "beat.csv", "--stimulus-times", "0,1 s"],
        &["`0` has no unit", "decimals with a point"],
    ),
    (
        &["batch", "--table", "pictures.csv"],
        &["`pictures.csv`", "line 2, column `file`", "cell.tif"],
    ),
    (&["batch"], &["<FOLDER>"]),
    (
        &[
            "run",
            "good.png",
            PIXELS[0],
            PIXELS[1],
            "--min-area",
            "9000 um^2",
            "--max-area",
            "900 um^2",
        ],
        &["segmentation.min_area", "the least area must be below the largest"],
    ),
    (&["run", "--output", "file/results"], &["cannot write results to `file/results`"]),
    (&["run", "--output", "file"], &["cannot write results to `file`"]),
    (&["mesh", "--output", "file/results"], &["cannot write results"]),
    (&["paper", "--output", "file/results"], &["cannot write results"]),
    (&["models", "cohelo_2021"], &["did you mean `coelho_2021`?"]),
    (&["init", "file/beat.toml"], &["cannot write", "beat.toml"]),
    (&["film.avi"], &["a film, not a command", "`myospring track film.avi`"]),
    (&["study"], &["Usage: myospring study [OPTIONS] <COMMAND>", "init"]),
    (&["rum"], &["there is no command `rum`; did you mean `run`?"]),
    (&["--model", "land_2017"], &["write myospring run --model"]),
    (&["run", "--thicknes", "1 um"], &["unexpected argument", "--thickness"]),
    (&[], &["Usage: myospring"]),
];

#[test]
fn every_bad_input_is_refused_with_exit_code_2_and_leaves_nothing() {
    let folder = workplace();
    let before = listing(folder.path());
    for (arguments, expected) in CASES {
        let output = Command::new(env!("CARGO_BIN_EXE_myospring"))
            .args(*arguments)
            .current_dir(folder.path())
            .env("NO_COLOR", "1")
            .output()
            .unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty(), "{arguments:?}: messages go to stderr");
        for part in *expected {
            assert!(message.contains(part), "{arguments:?} lacks `{part}`:\n{message}");
        }
        assert!(!message.contains('\u{1b}'), "{arguments:?}: NO_COLOR");
        assert!(!message.contains("panicked"), "{arguments:?}: {message}");
        assert_eq!(listing(folder.path()), before, "{arguments:?} left something");
    }
}

/// The micro sign, the Greek letter, words; what an old editor or terminal writes.
#[test]
#[ignore = "slow"]
fn a_unit_is_read_however_it_is_written() {
    let folder = workplace();
    let mesh = |arguments: &[&std::ffi::OsStr]| {
        let output = Command::new(env!("CARGO_BIN_EXE_myospring"))
            .args(["mesh", "--json"])
            .args(arguments)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{arguments:?}: {message}");
        fs::remove_dir_all(folder.path().join("results")).ok();
        output.stdout
    };
    let by_option =
        |size: &std::ffi::OsStr| mesh(&["good.png".as_ref(), "--pixel-size".as_ref(), size]);
    let usual = by_option("0.5 um".as_ref());
    for size in ["0.5 \u{b5}m", "0.5 \u{3bc}m", "0.5 microns", "0.5 micrometers", "500 nanometers"]
    {
        assert_eq!(by_option(size.as_ref()), usual, "{size}");
    }
    let latin = |text: &str| text.chars().map(|letter| letter as u8).collect::<Vec<u8>>();
    let file = "[shape]\npicture = \"good.png\"\npixel_size = \"0.5 \u{b5}m\"\n";
    for bytes in
        [latin(file), file.as_bytes().to_vec(), [b"\xef\xbb\xbf", file.as_bytes()].concat()]
    {
        fs::write(folder.path().join("good.toml"), bytes).unwrap();
        mesh(&["good.toml".as_ref()]);
    }
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        let size = std::ffi::OsStr::from_bytes(b"0.5 \xb5m");
        assert_eq!(by_option(size), usual, "Latin-1");
    }
}

#[test]
fn outlines_go_to_a_folder_as_all_results_do() {
    let folder = workplace();
    let segment = |output: &str| {
        Command::new(env!("CARGO_BIN_EXE_myospring"))
            .args(["segment", "good.png", "--pixel-size", "0.5 um", "--output", output])
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    fs::create_dir(folder.path().join("there.v2")).unwrap();
    for output in ["mine", "there.v2", "new/"] {
        let done = segment(output);
        assert!(done.status.success(), "{output}: {}", String::from_utf8_lossy(&done.stderr));
        for file in ["outline.geojson", "mask.png", "cell.roi", "overlay.png", "report.json"] {
            assert!(folder.path().join(output).join(file).is_file(), "{output}/{file}");
        }
    }
    // What is there stays.
    assert_eq!(segment("mine").status.code(), Some(2));
    let refused = segment("mine.jpg");
    assert!(String::from_utf8_lossy(&refused.stderr).contains("or one folder"));
}

#[test]
fn a_good_picture_meshes() {
    let folder = workplace();
    let output = Command::new(env!("CARGO_BIN_EXE_myospring"))
        .args(["mesh", "good.png", "--pixel-size", "0.5 um", "--json"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!((report["area_um2"].as_f64().unwrap() - 600.0).abs() < 6.0, "{report}");
}

#[test]
fn sizes_that_no_heart_cell_has_are_refused_unless_any_size_is_allowed() {
    let folder = workplace();
    let huge = "x_um,y_um\n0,0\n900,0\n900,20\n0,20\n";
    fs::write(folder.path().join("huge.csv"), huge).unwrap();
    let done = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_myospring"))
            .args(arguments)
            .current_dir(folder.path())
            .env("NO_COLOR", "1")
            .output()
            .unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let long = ["is 1620 um long", "longer than 400 um", "Its pixels are 27 um wide (given)"];
    let cases: [(&str, &[&str]); 4] = [
        ("27 um", &long),
        ("0.1 um", &["is 6.0 um long", "shorter than 15 um"]),
        ("0.4 um", &["area of 384 um^2", "500 um^2 (--min-area)"]),
        ("5 um", &["area of 60000 um^2", "20000 um^2 (--max-area)"]),
    ];
    for (pixel, parts) in cases {
        for command in ["run", "mesh", "segment"] {
            let picture = [command, "good.png", "--pixel-size", pixel];
            let (code, message) = done(&picture);
            assert_eq!(code, Some(2), "{command} {pixel}: {message}");
            for part in parts.iter().chain(&["`good.png`", "--pixel-size", "--any-size"]) {
                assert!(message.contains(part), "{command} {pixel} lacks `{part}`:\n{message}");
            }
        }
    }
    let (code, message) = done(&["mesh", "huge.csv"]);
    assert_eq!(code, Some(2));
    for part in ["`huge.csv`", "is 900 um long", "coordinates were read as um", "--any-size"] {
        assert!(message.contains(part), "lacks `{part}`:\n{message}");
    }
    for taken in [
        ["mesh", "huge.csv", "--any-size", "--force"].as_slice(),
        &["mesh", "good.png", "--pixel-size", "27 um", "--any-size", "--force"],
        &["mesh", "good.png", "--pixel-size", "0.4 um", "--min-area", "300 um^2", "--force"],
    ] {
        let (code, message) = done(taken);
        assert_eq!(code, Some(0), "{taken:?}: {message}");
    }
}
