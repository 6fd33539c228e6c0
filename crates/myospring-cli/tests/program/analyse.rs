//! `myospring analyse`: measured curves.

use super::{json, myospring, names, stderr, stdout};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Half sines of 300 ms each second from 250 ms on.
fn height(t: f64) -> f64 {
    let t = (t - 250.0).rem_euclid(1000.0);
    if t < 300.0 { (std::f64::consts::PI * t / 300.0).sin() } else { 0.0 }
}

/// 5 s at 250 frames a second.
fn times() -> impl Iterator<Item = f64> {
    (0..1250).map(|frame| 4.0 * f64::from(frame))
}

/// A cell of 120 um that shortens by 10 %, as a spreadsheet of a country with decimal commas has it.
fn semicolons(folder: &Path) {
    let mut text = "Zelle 3\r\nZeit (s);Länge (µm)\r\n".to_owned();
    for t in times() {
        let line = format!("{:.3};{:.5}\r\n", t / 1e3, 120.0 - 12.0 * height(t));
        text += &line.replace('.', ",");
    }
    fs::write(folder.join("zelle.csv"), text).unwrap();
}

#[test]
fn the_beats_of_a_table_are_measured_drawn_and_printed_with_units() {
    let folder = tempfile::tempdir().unwrap();
    semicolons(folder.path());
    let output = myospring(folder.path(), &["analyse", "zelle.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.contains("beats: 5 whole") && text.contains("1250 frames at 250.0 /s"), "{text}");
    assert!(text.contains("peak shortening") && text.contains("baseline: mean over"), "{text}");
    let results = folder.path().join("results/zelle_beats");
    assert_eq!(
        names(&results),
        ["figures", "metrics.csv", "report.html", "summary.csv", "summary.json"]
    );
    assert_eq!(names(&results.join("figures")).len(), 2, "one figure as SVG and PNG");
    let rows = fs::read_to_string(results.join("metrics.csv")).unwrap();
    assert_eq!(rows.lines().count(), 6);
    assert!(
        rows.starts_with("file,curve,kind,beat,state,time_of_stimulus_ms,interval_ms"),
        "{rows}"
    );
    assert!(rows.contains("peak_shortening_pct") && rows.contains("L0_per_s"), "{rows}");
    let summary = fs::read_to_string(results.join("summary.csv")).unwrap();
    let line = summary.lines().find(|line| line.contains("peak_shortening,")).unwrap();
    assert!(
        line.contains("resting length - length") && line.contains("drift: subtracted"),
        "{line}"
    );

    let again = myospring(folder.path(), &["analyse", "zelle.csv"]);
    assert_eq!(again.status.code(), Some(2));
    let output = myospring(folder.path(), &["analyse", "zelle.csv", "--force", "--json", "-q"]);
    let summary = json(&output);
    let metrics = summary["curves"][0]["metrics"].as_array().unwrap();
    let mean = |name: &str| metrics.iter().find(|m| m["name"] == name).unwrap()["mean"].as_f64();
    assert!((mean("peak_shortening").unwrap() - 10.0).abs() < 0.01);
    assert!((mean("interval").unwrap() - 1000.0).abs() < 0.5);
    assert_eq!(stderr(&output), "");
}

/// Calcium and length of a cell whose shortening begins 30 ms later, for the frames that are chosen.
fn calcium_and_length(folder: &Path, frames: impl Fn(usize) -> bool) {
    let mut both = "t_ms,Ca_uM,length_um\n".to_owned();
    let [mut calcium, mut length] = ["t_ms,ratio\n".to_owned(), "t_ms,length_um\n".to_owned()];
    for (frame, t) in times().enumerate() {
        let (ca, um) = (0.1 + 0.4 * height(t), 120.0 - 12.0 * height(t - 30.0));
        writeln!(both, "{t},{ca:.5},{um:.5}").unwrap();
        writeln!(length, "{t},{um:.5}").unwrap();
        if frames(frame) {
            writeln!(calcium, "{t},{ca:.5}").unwrap();
        }
    }
    for (name, text) in [("both.csv", both), ("ratio.csv", calcium), ("length.csv", length)] {
        fs::write(folder.join(name), text).unwrap();
    }
}

#[test]
fn calcium_and_length_recorded_together_are_paired_in_numbers_tables_and_pictures() {
    let folder = tempfile::tempdir().unwrap();
    calcium_and_length(folder.path(), |frame| frame % 4 == 0);
    let output = myospring(folder.path(), &["analyse", "both.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.contains("5 of 5 beats in both; loop counter-clockwise"), "{text}");
    assert!(text.contains("delay of half rise") && text.contains("relative loop area"), "{text}");
    let results = folder.path().join("results/both_beats");
    let figures = names(&results.join("figures"));
    assert!(figures.contains(&"loop_length_um.svg".to_owned()), "{figures:?}");
    let pairs = fs::read_to_string(results.join("pairs.csv")).unwrap();
    assert_eq!(pairs.lines().count(), 6);
    assert!(
        pairs.contains("calcium_at_half_rise_uM") && pairs.contains("loop_area_uM_pct"),
        "{pairs}"
    );
    let loops = fs::read_to_string(results.join("loops.csv")).unwrap();
    // The mean beat, and the four beats that the recording shows to their end.
    assert!(
        loops.lines().count() > 5 * 200 && loops.contains(",mean,"),
        "{}",
        loops.lines().count()
    );
    assert!(
        fs::read_to_string(results.join("report.html")).unwrap().contains("Calcium and motion")
    );

    // Two files with other frames: nothing is taken for a concentration.
    let arguments = ["analyse", "ratio.csv", "length.csv", "--json"];
    let output = myospring(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let warnings = stderr(&output);
    assert!(warnings.contains("are taken as recorded together, on one clock"), "{warnings}");
    assert!(warnings.contains("are not concentrations"), "{warnings}");
    let pair = &json(&output)["pairs"][0];
    let metrics = pair["metrics"].as_array().unwrap();
    let mean = |name: &str| metrics.iter().find(|it| it["name"] == name).unwrap()["mean"].as_f64();
    assert!((mean("delay_of_half_rise").unwrap() - 30.0).abs() < 1.0, "{pair}");
    assert_eq!(pair["direction"], "counter-clockwise");
}

#[test]
fn several_files_and_cells_stimuli_and_musclemotion_are_taken_in_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let results = folder.path().join("film-Contr-Results");
    fs::create_dir(&results).unwrap();
    let mut motion = String::new();
    for t in times() {
        writeln!(motion, "{t}\t{}", 30.0 + 500.0 * height(t)).unwrap();
    }
    fs::write(results.join("contraction.txt"), motion).unwrap();
    let mut cells = "t_s,cell 1,cell 2,cell 3\n".to_owned();
    for t in times() {
        writeln!(cells, "{},{},{},{}", t / 1e3, height(t), 2.0 * height(t), 0.5).unwrap();
    }
    fs::write(folder.path().join("cells.csv"), cells).unwrap();
    let output = myospring(
        folder.path(),
        &[
            "analyse",
            "film-Contr-Results/contraction.txt",
            "cells.csv",
            "--stimulus-period",
            "1 s",
            "--stimulus-start",
            "200 ms",
        ],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let (text, warnings) = (stdout(&output), stderr(&output));
    assert!(text.contains("contraction.txt: 2"), "{text}");
    assert!(warnings.contains("ignored") && warnings.contains("`cell 3`"), "{warnings}");
    let rows = fs::read_to_string(folder.path().join("results/beats/metrics.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 3 * 5);
    assert!(rows.contains("time_to_peak_from_stimulus_ms"), "{rows}");
}

#[test]
fn a_part_of_a_recording_and_a_sheet_of_a_workbook_are_measured() {
    let folder = tempfile::tempdir().unwrap();
    semicolons(folder.path());
    let part = ["analyse", "zelle.csv", "--from", "1 s", "--to", "3.1 s", "-o", "part"];
    let output = myospring(folder.path(), &part);
    assert!(
        stdout(&output).contains("526 frames at 250.0 /s"),
        "{}{}",
        stdout(&output),
        stderr(&output)
    );
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/workbook");
    fs::copy(corpus.join("two_sheets.xlsx"), folder.path().join("book.xlsx")).unwrap();
    let both = json(&myospring(folder.path(), &["analyse", "book.xlsx", "--json", "-q"]));
    assert_eq!(both["curves"].as_array().unwrap().len(), 2);
    let one = ["analyse", "book.xlsx", "--sheet", "second", "--json", "-q", "-o", "one"];
    let one = json(&myospring(folder.path(), &one));
    assert_eq!(one["curves"][0]["curve"], "force (mN)");
    assert_eq!(one["curves"].as_array().unwrap().len(), 1);
}

#[test]
fn what_is_no_measurement_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    semicolons(folder.path());
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("two.csv", "t_ms,length_um\n0,1\n4,2\n");
    write("words.csv", "t_ms,length_um\n0,1\n4,long\n8,2\n");
    write("back.csv", "t_ms,length_um\n0,1\n8,1\n4,2\n12,3\n");
    write("bare.csv", "length_um\n1\n2\n3\n");
    write("still.csv", &("length_um\n".to_owned() + &"5\n".repeat(50)));
    for (arguments, part) in [
        (&["analyse", "nowhere.csv"][..], "cannot read `nowhere.csv`"),
        (
            &["analyse", "two.csv"],
            "`two.csv`, column `length_um`: 2 frames; a beat needs at least 8",
        ),
        (&["analyse", "words.csv"], "line 3, column `length_um`: \"long\" is not a finite number"),
        (&["analyse", "back.csv"], "line 4, column `t_ms`: time 4 ms does not come after 8 ms"),
        (&["analyse", "bare.csv"], "no column of times"),
        (&["analyse", "bare.csv", "--frame-rate=-5"], "--frame-rate is `-5`"),
        (
            &["analyse", "still.csv", "--frame-rate", "50 /s"],
            "all 50 values are 5: there is no beat",
        ),
        (&["analyse", "zelle.csv", "--frame-rate", "30"], "the given frame rate is 30.0000"),
        (&["analyse", "zelle.csv", "--kind", "width"], "`width` is no kind of curve"),
        (&["analyse", "zelle.csv", "--columns", "Breite"], "no column `Breite`; its columns are"),
        (&["analyse", "zelle.csv", "--stimulus-times", "9 s"], "none of 1 stimuli falls"),
        (&["analyse", "zelle.csv", "--stimulus-period", "0 s"], "it must be at least 10 ms"),
        (&["analyse", "zelle.csv", "--stimulus-period", "1e-9 ms"], "must be at least 10 ms"),
        (&["analyse", "zelle.csv", "--pixel-size", "0.2"], "--pixel-size: `0.2` has no unit"),
        (&["analyse", "zelle.csv", "--unit", "mm"], "its unit is um, and --unit says mm"),
        (&["analyse", "zelle.csv", "--from", "1 min"], "the recording runs from 0 to 4996 ms"),
        (&["analyse", "zelle.csv", "--from", "2 s", "--to", "1 s"], "its end must come after"),
    ] {
        let output = myospring(folder.path(), arguments);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(part), "{arguments:?}: {said}");
    }
    assert!(!folder.path().join("results").exists());
}

/// A table of times and of columns of a cell of 120 um that shortens by 8 %.
fn table(header: &str, row: impl Fn(usize, f64, f64) -> String) -> String {
    let rows = times().enumerate().map(|(at, t)| row(at, t, 120.0 - 9.6 * height(t)));
    rows.fold(format!("{header}\n"), |text, row| text + &row + "\n")
}

#[test]
fn what_a_column_cannot_be_is_refused_with_its_line_and_what_it_seems_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("change.csv", &table("t_ms,length_um", |_, t, l| format!("{t},{}", l - 120.0)));
    write("sarc.csv", &table("t_ms,sarcomere_um", |_, t, l| format!("{t},{}", (l - 120.0) / 48.0)));
    let twelve = |l: f64| 11.6 * (120.0 - l);
    write("short.csv", &table("t_ms,shortening_pct", |_, t, l| format!("{t},{}", twelve(l))));
    write(
        "third.csv",
        &table("t_ms,length_um", |at, t, l| {
            format!("{t},{l}{}", if at == 300 { ",9" } else { "" })
        }),
    );
    write("shifted.csv", &table("t_ms,length_um", |at, t, l| format!("{at},{t},{l}")));
    for (file, part) in [
        ("change.csv", "a length is above 0; it seems to be a change of length"),
        ("sarc.csv", "a length is above 0; it seems to be a change of length"),
        ("short.csv", "no cell shortens by more than 100 %; its unit seems to be another one"),
        ("third.csv", "line 302, column `3`: \"9\" is one field too many: the line of names has 2"),
        (
            "shifted.csv",
            "line 2, column `3`: \"120\" is one field too many: the line of names has 2",
        ),
    ] {
        let output = myospring(folder.path(), &["analyse", file]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{file}: {said}");
        assert!(said.contains(part) && said.contains("line "), "{file}: {said}");
    }
    assert!(!folder.path().join("results").exists());
    let fit = myospring(folder.path(), &["fit", "--to", "change.csv", "--starts", "1"]);
    assert_eq!(fit.status.code(), Some(2));
    assert!(stderr(&fit).contains("a length is above 0"), "{}", stderr(&fit));
}

#[test]
fn columns_of_one_name_of_like_names_and_of_long_names_have_a_figure_each() {
    let folder = tempfile::tempdir().unwrap();
    let long = "x".repeat(300);
    let header = format!(
        "t_ms;length a,b (um);length a_b (um);length a b (um);length A b (um);twin (um);twin (um);length {long} (um)"
    );
    let text = table(&header, |_, t, l| {
        format!("{t};{l};{};{};{};{l};{};{l}", l + 1.0, l + 2.0, l + 3.0, l + 4.0)
    });
    fs::write(folder.path().join("names.csv"), text.replace("twin", "length twin")).unwrap();
    let output = myospring(folder.path(), &["analyse", "names.csv", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let summary = json(&output);
    let curves = summary["curves"].as_array().unwrap();
    assert_eq!(curves.len(), 7);
    assert_eq!(curves[5]["curve"], "length twin (um) (column 7)");
    assert!(stderr(&output).contains("several columns share a name"), "{}", stderr(&output));
    let figures = names(&folder.path().join("results/names_beats/figures"));
    assert_eq!(figures.len(), 2 * curves.len(), "{figures:?}");
    let lower: std::collections::BTreeSet<String> =
        figures.iter().map(|name| name.to_lowercase()).collect();
    assert_eq!(lower.len(), figures.len(), "{figures:?}");
}

#[test]
fn a_metric_that_cannot_be_read_is_empty_with_its_reason_in_every_file() {
    let folder = tempfile::tempdir().unwrap();
    // Frames are missing across the second peak, and the recording ends in the last beat.
    let text = table("t_ms,length_um", |_, t, l| format!("{t},{l}"));
    let kept =
        text.lines().enumerate().filter(|(line, _)| !(340..360).contains(line) && *line < 1120);
    let text = kept.fold(String::new(), |text, (_, line)| text + line + "\n");
    fs::write(folder.path().join("hole.csv"), text).unwrap();
    let output = myospring(folder.path(), &["analyse", "hole.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("1 with missing frames"), "{}", stdout(&output));
    let said = stderr(&output);
    assert!(said.contains("frames are missing from 1352 to 1436 ms"), "{said}");
    let rows = fs::read_to_string(folder.path().join("results/hole_beats/metrics.csv")).unwrap();
    assert!(rows.contains("peak_shortening: frames are missing there"), "{rows}");
    let summary =
        fs::read_to_string(folder.path().join("results/hole_beats/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let beats = summary["curves"][0]["beats"].as_array().unwrap();
    let of = |beat: usize, name: &str| {
        beats[beat]["metrics"]
            .as_array()
            .unwrap()
            .iter()
            .find(|row| row["name"] == name)
            .unwrap()
            .clone()
    };
    assert_eq!(of(1, "peak_shortening")["missing"], "frames are missing there");
    assert_eq!(of(1, "peak_shortening")["value"], serde_json::Value::Null);
    assert_eq!(of(0, "interval")["missing"], "no beat comes before");
    let last = beats.len() - 1;
    assert_eq!(of(last, "area_under_curve")["missing"], "the recording ends earlier");
    let mean = |name: &str| {
        summary["curves"][0]["metrics"]
            .as_array()
            .unwrap()
            .iter()
            .find(|row| row["name"] == name)
            .unwrap()
            .clone()
    };
    assert!((mean("peak_shortening")["mean"].as_f64().unwrap() - 8.0).abs() < 0.01);
    assert_eq!(mean("peak_shortening")["beats"], 4);
}
