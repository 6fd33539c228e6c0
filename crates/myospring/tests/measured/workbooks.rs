//! Workbooks: what spreadsheets and instruments write, and what nobody should.

use crate::common;
use crate::workbook_bytes;
use myospring::analysis::curve as curves;
use myospring::measured::{Column, Kind, Table, TableOptions, read, read_bytes};
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

fn corpus(name: &str) -> (PathBuf, Vec<u8>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/workbook");
    let path = folder.join(name);
    let bytes = std::fs::read(&path).unwrap();
    (path, bytes)
}

fn table(name: &str) -> Table {
    let (path, bytes) = corpus(name);
    read_bytes(&path.to_string_lossy(), &bytes, &TableOptions::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn sheets_are_read_as_text_is() {
    for name in ["columns.xlsx", "texts.xlsx", "durations.xlsx"] {
        let curve = &table(name).curves[0];
        assert_eq!(
            (curve.kind, curve.unit, &*curve.name),
            (Kind::Length, "um", "length (um)"),
            "{name}"
        );
        // Durations are days in the file.
        assert!((curve.times_ms[1] - 20.0).abs() < 1e-9, "{name}: {}", curve.times_ms[1]);
        assert_eq!(curve.values[15], 108.0, "{name}");
    }
    let two = table("two_sheets.xlsx");
    let names: Vec<&str> = two.curves.iter().map(|curve| &*curve.name).collect();
    assert_eq!(names, ["first: force (mN)", "second: force (mN)"]);
    assert_eq!((two.curves[0].kind, two.curves[0].unit), (Kind::Force, "nN"));
    let (path, bytes) = corpus("two_sheets.xlsx");
    let path = path.to_string_lossy();
    let options = TableOptions { sheets: vec![Column::of("2")], ..TableOptions::default() };
    let second = read_bytes(&path, &bytes, &options).unwrap();
    assert_eq!((second.curves.len(), &*second.curves[0].name), (1, "force (mN)"));
    let options = TableOptions { sheets: vec![Column::of("third")], ..TableOptions::default() };
    let said = read_bytes(&path, &bytes, &options).unwrap_err().to_string();
    assert!(said.contains("no sheet `third`; its sheets are `first`, `second`"), "{said}");
}

/// Every damaged file is refused, and none makes the reader panic or ask for room that it does not need.
#[test]
fn no_workbook_of_the_corpus_makes_the_reader_panic() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/workbook");
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let (mut read, mut refused) = (0, 0);
    for path in paths {
        println!("{}", path.display());
        let bytes = std::fs::read(&path).unwrap();
        if workbook_bytes::exercise(&bytes) > 0 {
            read += 1;
        } else {
            refused += 1;
        }
        for end in (0..bytes.len()).step_by(401) {
            workbook_bytes::exercise(&bytes[..end]);
        }
    }
    assert!(read >= 8 && refused >= 6, "{read} read, {refused} refused");
}

#[test]
fn workbooks_beyond_the_bounds_are_refused() {
    for (name, part) in
        [("wide_rows.xlsx", "fields"), ("many_texts.xlsx", "list of texts is damaged")]
    {
        let (path, bytes) = corpus(name);
        let found = read_bytes(&path.to_string_lossy(), &bytes, &TableOptions::default());
        let said = found.unwrap_err().to_string();
        assert!(said.contains(part), "{name}: {said}");
    }
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    let zeros = vec![0; 1 << 20];
    archive.start_file("xl/worksheets/sheet1.xml", options).unwrap();
    for _ in 0..520 {
        archive.write_all(&zeros).unwrap();
    }
    let bytes = archive.finish().unwrap().into_inner();
    assert!(bytes.len() < 1 << 21, "{}", bytes.len());
    let said = read_bytes("bomb.xlsx", &bytes, &TableOptions::default()).unwrap_err().to_string();
    assert!(said.contains("inflates to more than 512 MiB"), "{said}");
}

#[test]
fn workbooks_of_instruments_are_read_as_they_are() {
    let file = |name: &str| common::shared_data(&format!("curves/{name}"));
    if let Some(path) = file("bp_exportcatissue_raw_trace.xlsx") {
        let table = read(&path, &TableOptions::default()).unwrap();
        let curve = &table.curves[0];
        assert_eq!((curve.kind, curve.values.len()), (Kind::Fluorescence, 265));
        assert!((curve.times_ms[1] - 50.189).abs() < 1e-3, "{}", curve.times_ms[1]);
    }
    if let Some(path) = file("bp_exporttissue_force.xlsx") {
        let table = read(&path, &TableOptions::default()).unwrap();
        let counts: Vec<usize> = table.curves.iter().map(|curve| curve.values.len()).collect();
        assert_eq!(counts, [400, 197], "{:?}", table.notes);
    }
    if let Some(path) = file("bp_exportcatissue_peak_summary.xlsx") {
        let said = read(&path, &TableOptions::default()).unwrap_err().to_string();
        assert!(said.contains("no column of times") && said.len() < 400, "{said}");
    }
    if let Some(path) = file("ca2_2021-10-29_d35_ENT-001-S1_run4_001_A1.xlsx") {
        let table = read(&path, &TableOptions::default()).unwrap();
        let curve = &table.curves[0];
        assert_eq!(
            (table.curves.len(), curve.kind, curve.values.len()),
            (1, Kind::Fluorescence, 1001)
        );
        assert!((curve.times_ms[0] + 30.0).abs() < 1e-9);
    }
    if let Some(path) = file("caltrack_Fura_first12s.csv") {
        let table = read(&path, &TableOptions::default()).unwrap();
        let names: Vec<&str> = table.curves.iter().map(|curve| &*curve.name).collect();
        assert_eq!(names, ["Cell1 Ratio", "Cell 2 Ratio", "Cell6 Ratio", "Cell7 Ratio"]);
        assert_eq!(table.curves[0].frame_rate_per_s().map(f64::round), Some(1000.0));
        for curve in &table.curves {
            let options = curves::CurveOptions::default();
            let found =
                curves::analyse(&curve.times_ms, &curve.values, curve.kind, curve.unit, &options);
            let found = found.unwrap();
            // The cells were paced every two seconds.
            let interval = found.mean("interval").unwrap();
            let beats = found.beats.len();
            assert!((5..=7).contains(&beats), "{}: {beats} beats", curve.name);
            assert!((interval / 2000.0 - 1.0).abs() < 0.03, "{}: {interval} ms", curve.name);
        }
    }
    if let Some(path) = file("ionoptix_Z5_first60s_all_columns.TXT") {
        let table = read(&path, &TableOptions::default()).unwrap();
        let curve = &table.curves[0];
        assert_eq!((curve.kind, curve.values.len()), (Kind::SarcomereLength, 15000));
        // Every 1.917 s, by the file's own list.
        assert!((curve.stimuli_ms[0] - 2097.8).abs() < 1e-6, "{:?}", curve.stimuli_ms);
        let period = curve.stimuli_ms[1] - curve.stimuli_ms[0];
        assert!((period - 1917.9).abs() < 0.2, "{period}");
    }
    if let Some(path) = file("curi_new_A1_tsv.tsv") {
        let table = read(&path, &TableOptions::default()).unwrap();
        assert_eq!(
            table.curves[0].frame_rate_per_s().map(f64::round),
            Some(100.0),
            "{:?}",
            table.notes
        );
    }
}
