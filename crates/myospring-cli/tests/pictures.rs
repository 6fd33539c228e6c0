//! Pictures on the command line: outline, beat, a whole folder.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::path::Path;
use std::process::{Command, Output};

/// A bright ellipse of 80 x 24 um with stripes on a dark ground, 240 x 120 pixels of 0.5 um.
fn cell(file: &Path) {
    let value = |x: u32, y: u32| {
        let (u, v) = ((f64::from(x) - 120.0) / 80.0, (f64::from(y) - 60.0) / 24.0);
        let stripes = 0.6 + 0.4 * (f64::from(x) * 0.5 * std::f64::consts::TAU / 1.9).cos();
        let light = if u * u + v * v < 1.0 { 200.0 * stripes } else { 0.0 };
        // Noise enough for a scatter to be seen.
        (20.0 + light) as u8 + ((x * 7 + y * 13) % 5) as u8
    };
    let pixels: Vec<u8> = (0..240 * 120).map(|at| value(at % 240, at / 240)).collect();
    let file = std::fs::File::create(file).unwrap();
    // Grey with 8 bits unless something else is set.
    png::Encoder::new(file, 240, 120).write_header().unwrap().write_image_data(&pixels).unwrap();
}

fn myospring(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_myospring"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn an_outline_goes_out_as_a_roi_and_comes_back_over_its_picture() {
    let folder = tempfile::tempdir().unwrap();
    cell(&folder.path().join("cell.png"));
    let pixels = ["--pixel-size", "0.5 um"];
    let segmented = myospring(
        folder.path(),
        &[&["segment", "cell.png", "-o", "cell.roi"], &pixels[..]].concat(),
    );
    assert!(segmented.status.success(), "{}", text(&segmented.stderr));
    let report = text(&segmented.stdout);
    assert!(report.contains("fluorescence picture") && report.contains("um^2"), "{report}");
    assert!(report.contains(" masses, ") && report.contains("confidence "), "{report}");
    assert!(folder.path().join("cell_overlay.png").exists());

    let mesh = |arguments: &[&str]| {
        let meshed = myospring(folder.path(), arguments);
        assert!(meshed.status.success(), "{}", text(&meshed.stderr));
        let report: serde_json::Value = serde_json::from_slice(&meshed.stdout).unwrap();
        report["area_um2"].as_f64().unwrap()
    };
    let found = mesh(&["mesh", "cell.png", "--pixel-size", "0.5 um", "--json", "-o", "found"]);
    let drawn = mesh(&[
        "mesh",
        "cell.png",
        "--pixel-size",
        "0.5 um",
        "--outline",
        "cell.roi",
        "--json",
        "-o",
        "drawn",
    ]);
    let alone = mesh(&["mesh", "cell.roi", "--pixel-size", "0.5 um", "--json", "-o", "alone"]);
    // The smooth outline keeps the area of the pixels to half a per cent; a mesh to 1 %.
    assert!((drawn / found - 1.0).abs() < 0.015, "{drawn} {found}");
    assert!((alone / drawn - 1.0).abs() < 0.015, "{alone} {drawn}");
    // An ellipse with half axes of 40 and 12 um.
    assert!((found / 1508.0 - 1.0).abs() < 0.06, "{found}");

    // Nothing is overwritten unasked.
    let again = myospring(
        folder.path(),
        &[&["segment", "cell.png", "-o", "cell.roi"], &pixels[..]].concat(),
    );
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("already exists"));
}

/// A mask of 32 bits, 120 x 80 pixels, with a cell in value 3 and a smaller one in value 70000.
fn labels_of_32_bits(file: &Path) {
    use tiff::encoder::{TiffEncoder, colortype::Gray32};
    let label = |at: u32| match (at % 120, at / 120) {
        (10..110, 10..40) => 3,
        (20..100, 50..70) => 70_000,
        _ => 0,
    };
    let labels: Vec<u32> = (0..120 * 80).map(label).collect();
    let mut encoder = TiffEncoder::new(std::fs::File::create(file).unwrap()).unwrap();
    encoder.write_image::<Gray32>(120, 80, &labels).unwrap();
}

#[test]
fn a_label_beyond_16_bits_is_segmented_meshed_and_written_so_that_it_runs_again() {
    let folder = tempfile::tempdir().unwrap();
    labels_of_32_bits(&folder.path().join("labels.tif"));
    let picture = ["labels.tif", "--pixel-size", "0.5 um", "--label", "70000"];
    let run = |arguments: &[&str]| {
        let done = myospring(folder.path(), arguments);
        assert!(done.status.success(), "{}", text(&done.stderr));
        text(&done.stdout)
    };
    run(&[&["segment", "-o", "cell.geojson"], &picture[..]].concat());
    let outline = std::fs::read_to_string(folder.path().join("cell.geojson")).unwrap();
    assert!(outline.contains(r#""name":"70000""#), "{outline}");
    run(&[&["run", "-o", "run", "--integrator", "quasi-static"], &picture[..]].concat());
    let written = std::fs::read_to_string(folder.path().join("run/run.toml")).unwrap();
    assert!(written.contains("label = 70000"), "{written}");
    let report = run(&["mesh", "run/run.toml", "--json", "-o", "mesh"]);
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    // 80 x 20 pixels of a quarter of a square micrometre.
    let area = report["area_um2"].as_f64().unwrap();
    assert!((area / 400.0 - 1.0).abs() < 0.05, "{area}");
}

#[test]
#[ignore = "slow"]
fn files_of_options_are_relative_to_the_user_and_a_written_run_file_runs_from_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let study = folder.path().join("study");
    std::fs::create_dir(&study).unwrap();
    cell(&study.join("cell.png"));
    let run_file = "[shape]\npicture = \"cell.png\"\npixel_size = \"0.5 um\"\n\
                    [numerics]\nintegrator = \"quasi-static\"\n";
    std::fs::write(study.join("run.toml"), run_file).unwrap();
    let drawn = ["segment", "study/cell.png", "--pixel-size", "0.5 um", "-o", "cell.roi"];
    assert!(myospring(folder.path(), &drawn).status.success());

    // The picture stands beside the run file, the outline where the user stands.
    let first = ["run", "study/run.toml", "--outline", "cell.roi", "-o", "first"];
    let first = myospring(folder.path(), &first);
    assert!(first.status.success(), "{}", text(&first.stderr));
    let elsewhere = tempfile::tempdir().unwrap();
    let written = folder.path().join("first/run.toml");
    let again = ["run", written.to_str().unwrap(), "-o", "again"];
    let again = myospring(elsewhere.path(), &again);
    assert!(again.status.success(), "{}", text(&again.stderr));
    let traces = |path: std::path::PathBuf| std::fs::read_to_string(path).unwrap();
    assert_eq!(
        traces(folder.path().join("first/traces.csv")),
        traces(elsewhere.path().join("again/traces.csv"))
    );
}

#[test]
fn results_that_were_moved_repeat_their_run_without_the_files_that_it_was_made_from() {
    let folder = tempfile::tempdir().unwrap();
    let at = |path: &str| folder.path().join(path);
    std::fs::create_dir_all(at("data")).unwrap();
    cell(&at("data/cell.png"));
    std::fs::write(at("data/calcium.csv"), calcium()).unwrap();
    // Named in full, as a shell's completion or a file manager does.
    let [picture, calcium] =
        ["data/cell.png", "data/calcium.csv"].map(|path| at(path).display().to_string());
    let run =
        ["run", &picture, "--pixel-size", "0.5 um", "--integrator", "quasi-static", "--model"];
    let first = ["land_2017", "--calcium", &calcium, "-o", "results/first"];
    let first = myospring(folder.path(), &[&run[..], &first].concat());
    assert!(first.status.success(), "{}", text(&first.stderr));
    let root = folder.path().display().to_string();
    for file in ["run.toml", "run.json", "report.html", "summary.json"] {
        let text = std::fs::read_to_string(at("results/first").join(file)).unwrap();
        assert!(!text.contains(&root), "{file} names a folder of this machine");
    }
    let written = std::fs::read_to_string(at("results/first/run.toml")).unwrap();
    assert!(written.contains("\"inputs/cell.png\"") && written.contains("\"inputs/calcium.csv\""));

    let elsewhere = tempfile::tempdir().unwrap();
    std::fs::rename(at("results/first"), elsewhere.path().join("moved")).unwrap();
    std::fs::remove_dir_all(at("data")).unwrap();
    let again = myospring(elsewhere.path(), &["run", "moved/run.toml", "-o", "again"]);
    assert!(again.status.success(), "{}", text(&again.stderr));
    for file in ["traces.csv", "summary.json", "run.toml", "inputs/cell.png", "inputs/calcium.csv"]
    {
        let [again, moved] = ["again", "moved"]
            .map(|folder| std::fs::read(elsewhere.path().join(folder).join(file)).unwrap());
        assert!(again == moved, "{file}");
    }
    assert_eq!(std::fs::read_to_string(elsewhere.path().join("again/run.toml")).unwrap(), written);
}

/// A calcium transient as `land_2017` takes it.
fn calcium() -> String {
    let rows = (0..200).map(|row| {
        let t = 5.0 * f64::from(row);
        let bell =
            if t < 50.0 { 0.0 } else { ((t - 50.0) / 60.0) * (1.0 - (t - 50.0) / 60.0).exp() };
        format!("{t},{}\n", 0.1 + 0.9 * bell)
    });
    std::iter::once("time (ms),calcium (uM)\n".to_owned()).chain(rows).collect()
}

#[test]
fn pictures_of_one_name_in_several_folders_are_resumed_each_as_itself() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = folder.path().join("pictures");
    std::fs::create_dir_all(pictures.join("dish")).unwrap();
    cell(&pictures.join("a.png"));
    // The same name with other bytes, and sorted before.
    std::fs::write(pictures.join("dish/a.png"), "no picture").unwrap();
    let batch = ["batch", "pictures", "--pixel-size", "0.5 um", "--integrator", "quasi-static"];
    let batch = [&batch[..], &["-o", "out", "--json"]].concat();
    for resumed in [0, 2, 2] {
        let output = myospring(folder.path(), &batch);
        let outcome: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&outcome["resumed"], &outcome["cells"]), (&resumed.into(), &1.into()));
    }
    // Begun anew, nothing of the earlier batch stays.
    std::fs::remove_file(pictures.join("a.png")).unwrap();
    cell(&pictures.join("dish/a.png"));
    assert!(myospring(folder.path(), &[&batch[..], &["--force"]].concat()).status.success());
    let overlays = folder.path().join("out/overlays");
    assert!(overlays.join("dish/a_png.png").exists() && !overlays.join("a_png.png").exists());
}

#[test]
fn what_speaks_against_outline_and_fibres_is_said() {
    let folder = tempfile::tempdir().unwrap();
    cell(&folder.path().join("cell.png"));
    let warned = |arguments: &[&str]| {
        let common = ["run", "cell.png", "--pixel-size", "0.5 um", "--dry-run"];
        let plan = myospring(folder.path(), &[&common[..], arguments].concat());
        assert!(plan.status.success(), "{}", text(&plan.stderr));
        text(&plan.stderr)
    };
    // The stripes stand across the long axis: z-discs of fibres along it, or filaments across it.
    assert_eq!(warned(&["--fibre", "picture", "--stain", "z-disc"]), "");
    let across = warned(&["--fibre", "picture", "--stain", "filament"]);
    assert!(across.contains("the fibres lie across the cell"), "{across}");
    // A mesh has the same fibres, and says the same.
    let mesh =
        ["mesh", "cell.png", "--pixel-size", "0.5 um", "--fibre", "picture", "--stain", "filament"];
    let meshed = myospring(folder.path(), &mesh);
    assert!(meshed.status.success() && text(&meshed.stderr).contains("the fibres lie across"));
    let unsure = warned(&["--fibre", "picture", "--modality", "brightfield"]);
    assert!(unsure.contains("were read from a brightfield picture"), "{unsure}");
}

#[test]
#[ignore = "slow"]
fn fibres_that_a_picture_shows_go_into_a_table_into_reports_and_into_the_run_that_repeats_it() {
    let folder = tempfile::tempdir().unwrap();
    cell(&folder.path().join("cell.png"));
    let done = |arguments: &[&str], stain: &[&str]| {
        let stained = ["cell.png", "--pixel-size", "0.5 um"];
        let output = myospring(folder.path(), &[arguments, &stained, stain].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let read = |path: &str| std::fs::read_to_string(folder.path().join(path)).unwrap();
    let json = |path: &str| serde_json::from_str::<serde_json::Value>(&read(path)).unwrap();
    let z_disc = ["--stain", "z-disc"];

    let printed = done(&["segment"], &z_disc);
    assert!(printed.contains("% of the cell read from the picture"), "{printed}");
    let report = &json("results/cell_outline/report.json")["cells"][0];
    assert_eq!(report["fibres"]["direction"], "picture");
    assert!(report["fibres"]["read_pct"].as_f64().unwrap() > 50.0, "{report}");
    let table = read("results/cell_outline/fibres.csv");
    let mut lines = table.lines();
    assert_eq!(
        lines.next(),
        Some("x_um,y_um,direction_deg,sarcomere_um,order,coverage,sarcomere_doubtful")
    );
    let rows: Vec<Vec<Option<f64>>> =
        lines.map(|line| line.split(',').map(|value| value.parse().ok()).collect()).collect();
    assert_eq!(rows.len() as u64, report["lattice"]["triangles"].as_u64().unwrap());
    for row in &rows {
        // Within the ellipse, a lattice spacing allowed, and along it: the stripes stand upright.
        let [x, y] = [row[0].unwrap() - 60.0, row[1].unwrap() - 30.0];
        assert!(x.hypot(y * 40.0 / 12.0) < 44.0, "{row:?}");
        assert!(row[2].is_none_or(|angle| angle.abs() < 5.0), "{row:?}");
        let parts = row[4].into_iter().chain(row[5]);
        assert!(parts.into_iter().all(|part| (0.0..=1.0).contains(&part)), "{row:?}");
        assert_eq!(row[2].is_some(), row[5].is_some(), "{row:?}");
    }
    assert!(rows.iter().filter(|row| row[2].is_some()).count() > rows.len() / 2);

    done(&["mesh", "-o", "mesh"], &z_disc);
    assert_eq!(read("mesh/fibres.csv"), table);
    assert_eq!(json("mesh/mesh.json")["fibres"], report["fibres"]);
    let run = ["run", "--integrator", "quasi-static", "-o"];
    let printed = done(&[&run[..], &["first"]].concat(), &z_disc);
    assert!(printed.contains("\nfibres: "), "{printed}");
    assert_eq!(read("first/fibres.csv"), table);
    assert_eq!(json("first/summary.json")["fibres"], report["fibres"]);
    let settled = read("first/run.toml");
    let taken = "fibre = \"picture\"\nstain = \"z-disc\"\nfibre_smoothing = \"3 um\"\n";
    assert!(settled.contains(taken), "{settled}");
    let again = ["run", "first/run.toml", "-o", "again"];
    assert!(myospring(folder.path(), &again).status.success());
    for file in ["traces.csv", "summary.json", "fibres.csv", "run.toml"] {
        assert_eq!(read(&format!("first/{file}")), read(&format!("again/{file}")), "{file}");
    }

    // Without a word about the stain: its stripes are as far apart as sarcomeres.
    let run = ["run", "--integrator", "quasi-static", "--outputs", "none", "-o"];
    done(&[&run[..], &["unsaid"]].concat(), &[]);
    assert_eq!(read("unsaid/traces.csv"), read("first/traces.csv"));
    let length = json("unsaid/summary.json")["fibres"]["sarcomere_um"].as_f64().unwrap();
    assert!((length - 1.9).abs() < 0.03, "{length}");
    assert!(rows.iter().filter_map(|row| row[3]).all(|length| (length - 1.9).abs() < 0.2));

    // The tension may go by the order of the fibres; the word comes back in the run file.
    done(&[&run[..], &["content", "--content", "picture"]].concat(), &[]);
    assert!(read("content/run.toml").contains("myofibril_content = \"picture\"\n"));
    assert_ne!(read("content/traces.csv"), read("first/traces.csv"));
    assert!(myospring(folder.path(), &["run", "content/run.toml", "-o", "twice"]).status.success());
    assert_eq!(read("content/traces.csv"), read("twice/traces.csv"));
    let brightfield = ["--modality", "brightfield", "--content", "picture", "--dry-run"];
    let run = ["run", "cell.png", "--pixel-size", "0.5 um"];
    let refused = myospring(folder.path(), &[&run[..], &brightfield].concat());
    assert_eq!(refused.status.code(), Some(2));
    let message = text(&refused.stderr);
    assert!(message.contains("no fibres were read from it: a brightfield picture"), "{message}");

    // What cannot be read is no error: the long axis, and why.
    let axis = |more: &[&str], why: &str| {
        let printed = done(&[&["mesh", "--force", "-o", "mesh"], more].concat(), &[]);
        assert!(printed.contains("along the cell's long axis"), "{printed}");
        assert!(printed.contains(why), "{printed}");
        assert!(!folder.path().join("mesh/fibres.csv").exists(), "{more:?}");
    };
    axis(&["--fibre", "long axis"], "");
    axis(&["--modality", "brightfield"], "a brightfield picture has no stain");
    let coarse =
        ["mesh", "cell.png", "--pixel-size", "0.8 um", "--stain", "z-disc", "-o", "coarse"];
    let coarse = myospring(folder.path(), &coarse);
    assert!(coarse.status.success(), "{}", text(&coarse.stderr));
    assert!(text(&coarse.stdout).contains("pixels of 0.8 um are too coarse"));
}

#[test]
fn a_folder_of_good_and_broken_pictures_gives_a_row_each_and_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = folder.path().join("pictures");
    std::fs::create_dir_all(pictures.join("second dish")).unwrap();
    cell(&pictures.join("a.png"));
    cell(&pictures.join("second dish/b.png"));
    std::fs::write(pictures.join("broken.tif"), "II*\0 and nothing more").unwrap();
    std::fs::write(pictures.join("notes.txt"), "no picture, not looked at").unwrap();
    let batch = [
        "batch",
        "pictures",
        "--pixel-size",
        "0.5 um",
        "--integrator",
        "quasi-static",
        "-o",
        "out",
        "--json",
    ];
    let first = myospring(folder.path(), &batch);
    assert_eq!(first.status.code(), Some(1), "{}", text(&first.stderr));
    let outcome: serde_json::Value = serde_json::from_slice(&first.stdout).unwrap();
    assert_eq!((&outcome["cells"], &outcome["failed"]), (&2.into(), &1.into()), "{outcome}");
    let table = std::fs::read_to_string(folder.path().join("out/cells.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 4);
    assert!(
        rows[0].starts_with("picture,cell,status,reason,modality,pixel_size_um"),
        "{}",
        rows[0]
    );
    assert!(rows[1].starts_with("a.png,1,ok,,fluorescence,0.5"), "{}", rows[1]);
    assert!(rows[2].starts_with("broken.tif,,failed,") && rows[2].contains("TIFF"), "{}", rows[2]);
    assert!(rows[3].starts_with("second dish/b.png,1,ok"), "{}", rows[3]);
    let parquet = std::fs::read(folder.path().join("out/cells.parquet")).unwrap();
    assert!(parquet.starts_with(b"PAR1") && parquet.ends_with(b"PAR1"));
    for overlay in ["a_png.png", "second dish/b_png.png"] {
        assert!(folder.path().join("out/overlays").join(overlay).exists(), "{overlay}");
    }
    let report = || std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(report().contains("2 cells of 3 pictures beat, 1 failed."));
    assert_eq!(report().matches("data:image/png").count(), 2, "a small picture of each cell");

    // Interrupted after the first picture, with a line cut off; and a picture mended meanwhile.
    let journal = folder.path().join("out/progress.jsonl");
    let lines = std::fs::read_to_string(&journal).unwrap();
    let kept: Vec<&str> = lines.lines().filter(|line| !line.contains("second dish")).collect();
    std::fs::write(&journal, format!("{}\n{{\"picture\":\"second", kept.join("\n"))).unwrap();
    cell(&pictures.join("c.png"));
    std::fs::remove_file(pictures.join("broken.tif")).unwrap();
    let second = myospring(folder.path(), &batch);
    assert_eq!(second.status.code(), Some(0), "{}", text(&second.stderr));
    let outcome: serde_json::Value = serde_json::from_slice(&second.stdout).unwrap();
    assert_eq!((&outcome["resumed"], &outcome["cells"]), (&1.into(), &3.into()), "{outcome}");
    assert!(report().contains("3 cells of 3 pictures beat."));
    assert_eq!(report().matches("data:image/png").count(), 3, "also of those done before");

    let other = myospring(folder.path(), &[&batch[..], &["--beats", "2"]].concat());
    assert_eq!(other.status.code(), Some(2));
    assert!(text(&other.stderr).contains("results of other settings"), "{}", text(&other.stderr));
}

#[test]
fn a_table_beats_each_cell_with_its_own_settings_and_hands_its_group_on() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = folder.path().join("pictures");
    std::fs::create_dir_all(&pictures).unwrap();
    cell(&pictures.join("a.png"));
    labels_of_32_bits(&pictures.join("labels.tif"));
    cell(&pictures.join("not in it.png"));
    let table = "file,pixel_size,label,group\na.png,0.5,,control\nlabels.tif,0.5 um,3,drug\n\
                 labels.tif,0.5 um,70000,drug\n";
    std::fs::write(folder.path().join("pictures.csv"), table).unwrap();
    let batch = ["batch", "pictures", "--table", "pictures.csv", "--integrator", "quasi-static"];
    let batch = [&batch[..], &["-o", "out", "--json"]].concat();
    let first = myospring(folder.path(), &batch);
    let message = text(&first.stderr);
    assert_eq!(first.status.code(), Some(0), "{message}");
    assert!(message.contains("1 pictures in `pictures` are not in `pictures.csv`"), "{message}");
    let cells = std::fs::read_to_string(folder.path().join("out/cells.csv")).unwrap();
    let rows: Vec<&str> = cells.lines().collect();
    assert!(rows[0].starts_with("picture,cell,group,status,"), "{cells}");
    assert!(rows[1].starts_with("a.png,1,control,ok,,fluorescence,0.5"), "{cells}");
    assert!(rows[2].starts_with("labels.tif,3,drug,ok,,mask,0.5"), "{cells}");
    assert!(rows[3].starts_with("labels.tif,70000,drug,ok,,mask,0.5"), "{cells}");
    for overlay in ["a_png.png", "labels_tif.png", "labels_tif-2.png"] {
        assert!(folder.path().join("out/overlays").join(overlay).exists(), "{overlay}");
    }

    // A line that has changed is done again, the others are not; a wrong value is refused before all that.
    let changed = table.replace("a.png,0.5", "a.png,0.4");
    std::fs::write(folder.path().join("pictures.csv"), &changed).unwrap();
    let outcome: serde_json::Value =
        serde_json::from_slice(&myospring(folder.path(), &batch).stdout).unwrap();
    assert_eq!((&outcome["resumed"], &outcome["cells"]), (&2.into(), &3.into()), "{outcome}");
    for (from, to, expected) in [
        (
            "0.4",
            "0.4 kg",
            "pictures.csv, line 2, column `pixel_size`: `shape.pixel_size`: `0.4 kg`",
        ),
        ("70000", "0", "pictures.csv, line 4, column `label`: `shape.label` is 0"),
        ("a.png", "b.png", "line 2, column `file`: there is no file `pictures/b.png`"),
        ("group", "grop", "there is no setting `grop`; did you mean `group`?"),
    ] {
        std::fs::write(folder.path().join("pictures.csv"), changed.replacen(from, to, 1)).unwrap();
        let refused = myospring(folder.path(), &batch);
        assert_eq!(refused.status.code(), Some(2));
        assert!(text(&refused.stderr).contains(expected), "{}", text(&refused.stderr));
    }
}

#[test]
fn of_a_picture_that_gives_no_cell_there_is_an_overlay_to_look_at_and_nothing_else_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let grey = |name: &str, value: &dyn Fn(u32, u32) -> u8| {
        let file = std::fs::File::create(folder.path().join(name)).unwrap();
        let pixels: Vec<u8> = (0..240 * 120).map(|at| value(at % 240, at / 240)).collect();
        let mut writer = png::Encoder::new(file, 240, 120).write_header().unwrap();
        writer.write_image_data(&pixels).unwrap();
    };
    let noise = |x: u32, y: u32| ((x * 240 + y).wrapping_mul(2_654_435_761) >> 27) as u8;
    grey("cut.png", &|x, y| noise(x, y) + if x < 150 && (40..90).contains(&y) { 180 } else { 20 });
    grey("noise.png", &|x, y| noise(x, y) + noise(y + 7, x));
    grey("speck.png", &|x, y| if (50..53).contains(&x) && y == 30 { 255 } else { 0 });
    cell(&folder.path().join("cell.png"));
    let exists = |path: &str| folder.path().join(path).exists();
    let refused = |arguments: &[&str], expected: &[&str]| {
        let output = myospring(folder.path(), &[arguments, &["--pixel-size", "0.5 um"]].concat());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for part in expected {
            assert!(message.contains(part), "{arguments:?} lacks `{part}`: {message}");
        }
    };
    let found = " um^2 (fluorescence picture, pixels of 0.5 um (given), threshold";
    let cut = ["is cut by the frame", found, "results/cut_outline/overlay.png"];
    refused(&["segment", "cut.png"], &cut);
    let report = std::fs::read_to_string(folder.path().join("results/cut_outline/report.json"));
    let report: serde_json::Value = serde_json::from_str(&report.unwrap()).unwrap();
    assert_eq!(report["cells"][0]["pixels_on_frame"], 50);
    assert!(report["refused"].as_str().unwrap().contains("50 of its pixels"), "{report}");
    // Whoever asks, it is written over, for it is no result.
    refused(&["segment", "cut.png", "--cell", "all"], &cut);
    refused(&["run", "cut.png"], &cut);
    refused(
        &["mesh", "cut.png", "-o", "mine"],
        &["found one cell of 187", "mine_outline/overlay.png"],
    );
    refused(
        &["segment", "cut.png", "-o", "cut.roi"],
        &["look at cut_overlay.png", "the part within the frame was written: cut.roi"],
    );
    assert!(!exists("results/cut") && !exists("mine") && exists("cut.roi"));
    let allowed = ["segment", "cut.png", "--allow-cut", "--pixel-size", "0.5 um"];
    assert!(myospring(folder.path(), &allowed).status.success());
    assert!(exists("results/cut_outline/cell.roi"));

    // What was found before stays.
    refused(&["run", "cut.png"], &["results/cut_outline_refused/overlay.png"]);
    assert!(exists("results/cut_outline/cell.roi"));

    let none = ["no cell was found", "pixel size of 0.5 um", "results/noise_outline/overlay.png"];
    refused(&["mesh", "noise.png", "--modality", "fluorescence"], &none);
    refused(&["run", "speck.png"], &["only 3 pixels", "at least 25", "speck_outline/overlay.png"]);
    let beside =
        ["no cell was found at 5, 5", "--threshold below", "results/cell_outline/overlay.png"];
    refused(&["run", "cell.png", "--seed", "5,5"], &beside);
    refused(
        &["run", "noise.png", "--modality", "fluorescence", "--dry-run", "-o", "dry"],
        &none[..1],
    );
    assert!(!exists("dry_outline"));

    let names = ["cut", "noise", "speck", "cell"];
    std::fs::create_dir(folder.path().join("dish")).unwrap();
    for name in names.map(|name| format!("{name}.png")) {
        std::fs::rename(folder.path().join(&name), folder.path().join("dish").join(&name)).unwrap();
    }
    let batch = ["batch", "dish", "--pixel-size", "0.5 um", "--integrator", "quasi-static"];
    let batch = [&batch[..], &["--modality", "fluorescence", "-o", "out"]].concat();
    assert_eq!(myospring(folder.path(), &batch).status.code(), Some(1));
    for name in names {
        assert!(exists(&format!("out/overlays/{name}_png.png")), "{name}");
    }
}

#[test]
fn of_a_sheet_the_fibres_of_the_whole_frame_are_read_and_no_outline_is_made_up() {
    let folder = tempfile::tempdir().unwrap();
    let stripes = |x: u32, y: u32| {
        let light = 0.6 + 0.4 * (f64::from(x) * 0.25 * std::f64::consts::TAU / 1.9).cos();
        (20.0 + 200.0 * light) as u8 + ((x * 7 + y * 13) % 5) as u8
    };
    let pixels: Vec<u8> = (0..200 * 160).map(|at| stripes(at % 200, at / 200)).collect();
    let file = std::fs::File::create(folder.path().join("sheet.png")).unwrap();
    png::Encoder::new(file, 200, 160).write_header().unwrap().write_image_data(&pixels).unwrap();
    let asked = ["segment", "sheet.png", "--pixel-size", "0.25 um", "--whole-frame"];
    let read = myospring(folder.path(), &[&asked[..], &["--json"]].concat());
    assert!(read.status.success(), "{}", text(&read.stderr));
    let report: serde_json::Value = serde_json::from_slice(&read.stdout).unwrap();
    let number = |key: &str| report["fibres"][key].as_f64().unwrap();
    assert!(number("read_pct") > 90.0, "{report}");
    assert!(number("direction_deg").abs() < 2.0, "{report}");
    // The period of the stripes; a quarter of a pixel.
    assert!((number("sarcomere_um") - 1.9).abs() < 0.06, "{report}");
    assert_eq!((&report["width_um"], &report["height_um"]), (&50.0.into(), &40.0.into()));
    let results = folder.path().join("results/sheet_whole_frame");
    let table = std::fs::read_to_string(results.join("fibres.csv")).unwrap();
    assert!(table.starts_with("x_um,y_um,direction_deg,sarcomere_um"), "{table}");
    // A header, and a place every 2 um.
    assert_eq!(table.lines().count(), 1 + 25 * 20);
    assert!(results.join("overlay.png").exists() && !results.join("outline.geojson").exists());

    let refused = myospring(folder.path(), &[&asked[..], &["-o", "sheet.roi"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("--whole-frame gives no outline"));
}
