//! Files that are no outlines, damaged, or meant to do harm.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::outline_bytes;
use crate::outline_files;

use std::path::Path;

use myospring::microscopy::outlines::read_outlines;
use outline_files::{fixture, folder, options, outline, read, refused, zipped};

#[test]
fn files_cut_off_anywhere_are_refused_or_read_and_never_panic() {
    let (mut cut, mut read_on) = (0, 0);
    for entry in std::fs::read_dir(folder()).unwrap() {
        let bytes = std::fs::read(entry.unwrap().path()).unwrap();
        for length in 0..bytes.len().min(1_400) {
            match read(&bytes[..length]) {
                Ok(given) => {
                    assert!(!given.outlines.is_empty());
                    read_on += 1;
                }
                Err(error) => {
                    assert!(!error.to_string().is_empty());
                    cut += 1;
                }
            }
        }
    }
    // Lists of points and names behind the coordinates may end early and still make sense.
    assert!(cut > 1_500 && read_on > 100, "{cut} {read_on}");
}

#[test]
fn a_cut_roi_says_how_much_is_missing() {
    assert_eq!(
        refused(&fixture("polygon.roi")[..70]),
        "some/cell.file is cut off: 80 bytes are needed, 70 are there; save it again in Fiji"
    );
    assert!(refused(b"Iout").contains("64 bytes are needed, 4 are there"));
}

#[test]
fn counts_that_cannot_be_are_refused_at_once() {
    let mut none = fixture("polygon.roi");
    none[16..18].fill(0);
    assert!(refused(&none).contains("it has no points"));
    let mut huge = none.clone();
    huge[18..22].copy_from_slice(&i32::MAX.to_be_bytes());
    assert!(refused(&huge).contains("2147483647 points in one outline; at most 100000"));
    let mut negative = none;
    negative[18..22].copy_from_slice(&(-4_i32).to_be_bytes());
    assert!(refused(&negative).contains("it has no points"));
    let mut path = fixture("composite.roi");
    path[36..40].copy_from_slice(&i32::MAX.to_be_bytes());
    assert!(refused(&path).contains("at most 100000"));
    path[36..40].copy_from_slice(&2_i32.to_be_bytes());
    assert!(refused(&path).contains("its path ends within a segment"));
    let mut wild = fixture("fine.roi");
    wild[80..84].copy_from_slice(&f32::NAN.to_be_bytes());
    assert!(refused(&wild).contains("the coordinate at byte 80 is NaN"));
}

#[test]
fn other_files_are_told_from_outlines() {
    assert_eq!(
        refused(b"\x89PNG\r\n\x1a\n"),
        "this is not a file of outlines (8 bytes that start with \"\u{fffd}PNG\\r\\n\\u{1a}\\n\"); give an \
         ImageJ .roi or RoiSet .zip, GeoJSON, or Cellpose's _outlines.txt"
    );
    assert!(refused(b"").contains("0 bytes"));
    // A file that says by its name whose it is has been damaged.
    for (name, kind) in [("a.roi", "ImageJ ROI"), ("a.ZIP", "RoiSet zip")] {
        for bytes in [&b"[Iout"[..], b"12,x", b"\0\0\0", b""] {
            let error = read_outlines(bytes, name, &options()).unwrap_err().to_string();
            assert!(
                error.starts_with(&format!("{name} is damaged, or not a valid {kind}")),
                "{error}"
            );
        }
    }
    assert!(refused(b"{}").contains("not GeoJSON"));
    assert!(refused(b"PK\x03\x04 and no more").contains("the RoiSet zip cannot be read"));
    assert!(
        refused(&zipped(&[("notes.txt", b"hello".to_vec())]))
            .contains("notes.txt is no ImageJ ROI")
    );
}

#[test]
fn an_outline_that_crosses_itself_does_not_cost_the_others() {
    let bow_tie = "30,2,40,12,30,12,40,2\n";
    let given = read(format!("2,2,22,2,22,12,2,12\n{bow_tie}").as_bytes()).unwrap();
    assert_eq!(given.outlines.len(), 1);
    assert!(given.notes[0].starts_with("left out: outline `2`: the outline crosses"), "{given:?}");
    assert!(refused(bow_tie.as_bytes()).starts_with("outline `1`: the outline crosses"));
}

#[test]
fn zip_bombs_do_not_go_off() {
    let mut large = fixture("rectangle.roi");
    large.resize(4_000_000, 0);
    let message = refused(&zipped(&[("big.roi", large.clone())]));
    assert!(message.contains("`big.roi` unpacks to more than"), "{message}");
    large.truncate(1_200_000);
    let many: Vec<(String, Vec<u8>)> =
        (0..60).map(|index| (format!("{index}.roi"), large.clone())).collect();
    let many: Vec<(&str, Vec<u8>)> =
        many.iter().map(|(name, bytes)| (name.as_str(), bytes.clone())).collect();
    let message = refused(&zipped(&many));
    assert!(message.contains("unpacks to more than"), "{message}");
    let names: Vec<String> = (0..10_001).map(|index| index.to_string()).collect();
    let empty: Vec<(&str, Vec<u8>)> = names.iter().map(|name| (name.as_str(), vec![])).collect();
    assert!(refused(&zipped(&empty)).contains("10001 entries in its zip; at most 10000"));
}

#[test]
fn an_outline_of_a_hundred_thousand_points_takes_no_minute() {
    // A cog wheel: each edge near few others.
    let point = |index: usize| {
        let angle = index as f64 / 100_000.0 * std::f64::consts::TAU;
        let radius = if index.is_multiple_of(2) { 14.0 } else { 14.01 };
        [20.0 + radius * angle.cos(), 15.0 + radius * angle.sin()]
    };
    let start = std::time::Instant::now();
    outline((0..100_000).map(point).collect(), vec![]);
    assert!(start.elapsed().as_secs() < 20);
}

#[test]
fn what_the_fuzzer_found_stays_found() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/outlines");
    let mut files = 0;
    for entry in std::fs::read_dir(corpus).unwrap() {
        outline_bytes::exercise(&std::fs::read(entry.unwrap().path()).unwrap());
        files += 1;
    }
    assert!(files > 0);
}
