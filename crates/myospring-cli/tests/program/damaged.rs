//! Damaged input, as a table: what was done to which file, the command that reads it, its exit code, and what its message
//! names. A new reader or command adds its rows here.

use super::{myospring, stderr};
use rayon::prelude::*;
use std::fs;
use std::path::Path;

/// What was done to a file.
enum Damage {
    /// All but the first bytes are gone.
    Cut(usize),
    /// The last bytes are gone.
    CutEnd(usize),
    /// One byte is another.
    Flip(usize),
    /// Bytes that stand in it are others.
    Bytes(&'static [u8], &'static [u8]),
    /// Text that stands in it is another.
    Text(&'static str, &'static str),
    /// All of it is other text.
    All(&'static str),
    /// All of it is made anew.
    Made(fn() -> Vec<u8>),
    /// It is gone.
    Gone,
    /// Nothing: the command itself is what is wrong.
    None,
}
use Damage::{All, Bytes, Cut, CutEnd, Flip, Gone, Made, Text};

/// File, damage, command, exit code, what the message names.
type Row = (&'static str, Damage, &'static str, i32, &'static [&'static str]);

const MESH: &str = "mesh mask.png --pixel-size 0.5um";
const MESH_TIFF: &str = "mesh cell.tif --pixel-size 0.5um";
const Y4M: &str = "track film.y4m --pixel-size 0.5um";
const AVI: &str = "track film.avi --pixel-size 0.5um";
const ANALYSE: &str = "analyse curve.csv";
const OUTLINE: &str = "mesh cell.geojson";
const RUN: &str = "run run.toml";
const CALCIUM: &str = "run --model land_2017 --calcium calcium.csv";
const STUDY: &str = "study run study.toml -o s";
const COMPARE: &str = "compare res run.toml";
const CHANGED: &str = "is not the file that myospring wrote there";

#[rustfmt::skip]
const ROWS: &[Row] = &[
    // Pictures.
    ("mask.png", Cut(0), MESH, 2, &["`mask.png`: this is not a picture (0 bytes"]),
    ("mask.png", Cut(20), MESH, 2, &["`mask.png`", "is the file complete?"]),
    ("mask.png", CutEnd(20), MESH, 2, &["`mask.png`", "is the file complete?"]),
    ("mask.png", Flip(60), MESH, 2, &["`mask.png`", "is the file complete?"]),
    ("mask.png", Flip(29), MESH, 2, &["`mask.png`", "CRC error"]),
    ("cell.tif", CutEnd(400), MESH_TIFF, 2, &["`cell.tif`", "beyond the end of the file"]),
    ("cell.tif", Made(|| tiff(80, f32::NAN)), MESH_TIFF, 2, &["2400 pixels are infinite or not a number, the first at column 10, row 20"]),
    ("cell.tif", Made(|| tiff(80, f32::INFINITY)), MESH_TIFF, 2, &["2400 pixels are infinite or not a number"]),
    ("cell.tif", Made(|| tiff(0, 200.0)), MESH_TIFF, 2, &["it declares 0 x 80 pixels"]),
    ("cell.tif", Made(|| tiff(u32::MAX, 200.0)), MESH_TIFF, 2, &["declares 4294967295 x 80 pixels", "cut out the cell"]),
    ("cell.tif", Bytes(&[0x11, 1, 4, 0, 1, 0, 0, 0, 8, 0, 0, 0], &[0x11, 1, 4, 0, 1, 0, 0, 0, 0, 0, 0, 0x70]), MESH_TIFF, 2, &["strip or tile 0 lies at bytes 1879048192"]),
    ("cell.tif", Bytes(&[2, 1, 3, 0, 1, 0, 0, 0, 32], &[2, 1, 3, 0, 1, 0, 0, 0, 7]), MESH_TIFF, 2, &["floating-point numbers of 7 bits"]),
    ("", Damage::None, "mesh mask.png --pixel-size 1e-300um", 2, &["--pixel-size", "1e-300 um is outside its bounds", "0.001 um to 50 um"]),
    ("", Damage::None, "mesh mask.png --pixel-size 0.5um --seed 1e300,5", 2, &["no cell was found at 1e300, 5"]),
    ("", Damage::None, "mesh cell.tif --pixel-size 0.5um --threshold=-1e300", 2, &["the threshold is -1e300"]),
    // Films.
    ("film.y4m", Cut(5), Y4M, 2, &["`film.y4m`"]),
    ("film.y4m", Cut(300), Y4M, 2, &["`film.y4m`: there is no frame; at least 3"]),
    ("film.y4m", Text("F30:1", "F30:0"), Y4M, 2, &["how many frames a second", "--frame-rate 30"]),
    ("film.y4m", Text("F30:1", "F99999999999999999999:1"), Y4M, 2, &["frames a second; that must be above 0, at most 1000000"]),
    ("film.y4m", Text("W64", "W0"), Y4M, 2, &["states no size"]),
    ("film.y4m", Text("W64", "W999999999"), Y4M, 2, &["999999999 x 48 pixels"]),
    ("film.y4m", Text("FRAME", "FRUMP"), Y4M, 2, &["frame 0 does not begin with `FRAME`"]),
    ("", Damage::None, "track film.y4m --pixel-size 0.5um --frame-rate 1e300", 2, &["--frame-rate is `1e300`", "at most 1000000"]),
    ("", Damage::None, "track film.y4m --pixel-size 0.5um --subset 1e300um", 2, &["--subset is 1e300 um", "100 um"]),
    ("film.avi", Cut(60), AVI, 2, &["`film.avi`", "describes no pictures"]),
    ("film.avi", Cut(1400), AVI, 2, &["declares 5 frames but contains none"]),
    ("film.avi", Bytes(&[64, 0, 0, 0, 48, 0, 0, 0, 1, 0, 8, 0], &[64, 0, 0, 0, 0, 0, 0, 0, 1, 0, 8, 0]), AVI, 2, &["describes no pictures"]),
    ("film.avi", Bytes(&[64, 0, 0, 0, 48, 0, 0, 0, 1, 0, 8, 0], &[64, 0, 0, 0, 0, 0, 0, 128, 1, 0, 8, 0]), AVI, 2, &["64 x 2147483648 pixels"]),
    // Tables.
    ("curve.csv", All(""), ANALYSE, 2, &["`curve.csv`"]),
    ("curve.csv", All("time_ms,length_um\n"), ANALYSE, 2, &["`curve.csv`"]),
    ("curve.csv", Made(|| vec![0; 4000]), ANALYSE, 2, &["`curve.csv`"]),
    ("curve.csv", Text("\n300,", "\nlate,"), ANALYSE, 2, &["line 17, column `time_ms`: \"late\" is not a finite number"]),
    ("curve.csv", Text("\n300,", "\n1e300,"), ANALYSE, 2, &["line 17, column `time_ms`: time 1e300 ms is later than any clock shows"]),
    ("curve.csv", Text("\n300,92", "\n300,1e300"), ANALYSE, 2, &["line 17, column `length_um`"]),
    ("curve.csv", Made(|| curve("e-300")), ANALYSE, 2, &["column `length_um`: ", "smaller than anything measured"]),
    ("curve.csv", Made(|| curve("e300")), "fit --to curve.csv", 2, &["column `length_um`: ", "larger than anything measured"]),
    ("curve.csv", Text("\n300,", "\n20,"), ANALYSE, 2, &["line 17", "time 20 ms does not come after 280 ms"]),
    ("c.xlsx", All("PK\u{3}\u{4}"), "analyse c.xlsx", 2, &["`c.xlsx`", "cannot be read as a workbook"]),
    ("c.xls", Made(|| [&[0xd0, 0xcf, 0x11, 0xe0, 0xa1, 0xb1, 0x1a, 0xe1][..], &[0; 600]].concat()), "analyse c.xls", 2, &["`c.xls`", "save it as .xlsx or CSV"]),
    ("", Damage::None, "analyse curve.csv --stimulus-period 1e300ms", 2, &["--stimulus-period is 1e300 ms"]),
    ("", Damage::None, "analyse curve.csv --stimulus-times 1e300", 2, &["none of 1 stimuli falls into the recording, from 0 to 2980 ms"]),
    ("", Damage::None, "analyse curve.csv --from 1e300ms", 2, &["no values from 1e300 to 2980 ms"]),
    ("", Damage::None, "analyse curve.csv --smooth 1e300ms", 2, &["--smooth is 1e300 ms"]),
    ("", Damage::None, "fit --to curve.csv --bounds c_0=1e-300:1e300", 2, &["the bounds of `c_0` are 1e-300 to 1e300"]),
    ("", Damage::None, "fit --to curve.csv --loaded 1e300nN/um=curve.csv", 2, &["--loaded: 1e300 nN/um"]),
    ("calcium.csv", Text("0.6", "1e300"), CALCIUM, 2, &["line 4", "1e300 is larger than anything measured"]),
    ("calcium.csv", Text("0.6", "600"), CALCIUM, 2, &["line 4", "calcium is 600 uM; it must be between 0 and 100 uM"]),
    ("calcium.csv", Text("500,", "5,"), CALCIUM, 2, &["line 5", "time 5 ms does not come after 100 ms"]),
    ("calcium.csv", Gone, CALCIUM, 2, &["calcium.csv"]),
    ("content.csv", All("x_um,y_um,content\n0,0,1e300\n"), "run --myofibril-content content.csv", 2, &["line 2: content is 1e300; it must be from 0 to 100"]),
    // Outlines.
    ("cell.geojson", Cut(60), OUTLINE, 2, &["`cell.geojson`", "not GeoJSON"]),
    ("cell.geojson", Text("[100,0]", "[1e300,0]"), OUTLINE, 2, &["the outline is 1e300 um long, more than 10000 um"]),
    ("cell.geojson", Text("[100,0],[100,20]", "[100,20],[100,0]"), OUTLINE, 2, &["crosses or touches itself"]),
    ("cell.geojson", Made(|| b"[".repeat(200_000)), OUTLINE, 2, &["not GeoJSON"]),
    ("rois.zip", Made(|| [&b"PK\x05\x06"[..], &[0; 10]].concat()), "mesh rois.zip --pixel-size 0.5um", 2, &["`rois.zip`"]),
    // Gels.
    ("u.npy", Made(|| b"\x93NUMPY\x01\0".to_vec()), "traction u.npy --pixel-size 0.5um --gel-modulus 5kPa", 2, &["`u.npy` is one array", "give two: displacements to the right, and downward"]),
    // Run files.
    ("run.toml", Made(|| "s = {= 1\n\n[p]\n".repeat(5000).into_bytes()), RUN, 2, &["run.toml", "more than 64 brackets are open here"]),
    ("run.toml", All("[shape\nspacing = \"5 um\""), RUN, 2, &["run.toml, line 1, column 7", "unclosed table"]),
    ("run.toml", All("[shape]\nspacing = \"5\0 um\"\n"), RUN, 2, &["`run.toml` is not a text file"]),
    ("run.toml", All("[stimulus]\namplitude = inf\n"), RUN, 2, &["`stimulus.amplitude` = inf is not a finite number"]),
    ("run.toml", All("[material]\nthickness = 2020-01-01\n"), RUN, 2, &["`material.thickness` is the date 2020-01-01"]),
    ("run.toml", Made(|| [&b"a = "[..], &b"[".repeat(100_000)].concat()), RUN, 2, &["line 1: more than 64 brackets are open here"]),
    ("", Damage::None, "run --young-modulus 1e300kPa", 2, &["`material.young_modulus` = 1e300 kPa is outside its bounds"]),
    // Studies.
    ("study.toml", Text("low = 1.5", "low = nan"), STUDY, 2, &["[parameters.tau_si]", "low is NaN"]),
    ("study.toml", Text("low = 1.5", "low = 9.5"), STUDY, 2, &["[parameters.tau_si]", "needs high above low"]),
    ("study.toml", Text("size = 2", "size = -2"), STUDY, 2, &["[sampling]", "a whole number from 0 on"]),
    ("study.toml", Text("size = 2", "size = 4000000000"), STUDY, 2, &["4000000000 rows are more than"]),
    ("study.toml", Text("size = 2", "size = 2\nseed = -1"), STUDY, 2, &["[sampling]", "a whole number from 0 on"]),
    ("study.toml", Text("size = 2", "sise = 2"), STUDY, 2, &["[sampling]", "unknown field `sise`"]),
    // Results to compare.
    ("res/traces.csv", CutEnd(100), COMPARE, 2, &["`res/traces.csv`", CHANGED]),
    ("res/traces.csv", Gone, COMPARE, 2, &["`res` holds no results of a run: traces.csv is missing"]),
    ("res/run.toml", All(""), COMPARE, 2, &["`res/run.toml`", CHANGED]),
    ("res/run.json", Cut(50), COMPARE, 2, &["`res/run.json`", CHANGED]),
    ("", Damage::None, "compare run.toml --scale tau_si=1e-300", 2, &["tau_si", "1e-300", "is outside its range 0.001 to 1000000 ms"]),
    // Batches.
    ("p.csv", All("file\ngone.png\n"), "batch --table p.csv -o b --pixel-size 0.5um", 2, &["`p.csv`: line 2, column `file`: there is no file `gone.png`"]),
    ("p.csv", All("file,pixel_size\nmask.png,1e300 um\n"), "batch --table p.csv -o b", 2, &["p.csv, line 2, column `pixel_size`", "1e300 um"]),
];

/// A 32-bit TIFF of 80 rows; `inside` is the grey value of its cell.
fn tiff(width: u32, inside: f32) -> Vec<u8> {
    let is_inside = |at: usize| (10..70).contains(&(at % 80)) && (20..60).contains(&(at / 80));
    let pixels = (0..6400).flat_map(|at| if is_inside(at) { inside } else { 20.0 }.to_le_bytes());
    let pixels: Vec<u8> = pixels.collect();
    let count = pixels.len() as u32;
    // Tag, type (3: 16 bits, 4: 32 bits), value.
    let tags: [(u16, u16, u32); 10] = [
        (256, 4, width),
        (257, 4, 80),
        (258, 3, 32),
        (259, 3, 1),
        (262, 3, 1),
        (273, 4, 8),
        (277, 3, 1),
        (278, 4, 80),
        (279, 4, count),
        (339, 3, 3),
    ];
    let mut file = [&b"II*\0"[..], &(8 + count).to_le_bytes(), &pixels].concat();
    file.extend((tags.len() as u16).to_le_bytes());
    for (tag, kind, value) in tags {
        file.extend(tag.to_le_bytes());
        file.extend(kind.to_le_bytes());
        file.extend(1_u32.to_le_bytes());
        file.extend(value.to_le_bytes());
    }
    file.extend([0; 4]);
    file
}

/// Three beats of a length in um, with these powers behind each.
fn curve(power: &str) -> Vec<u8> {
    let beat = |t: f64| 100.0 - 8.0 * (-((t % 1000.0 - 300.0) / 80.0).powi(2)).exp();
    let row = |row: i32| format!("{},{:.4}{power}\n", 20 * row, beat(20.0 * f64::from(row)));
    let rows: String = (0..150).map(row).collect();
    format!("time_ms,length_um\n{rows}").into_bytes()
}

/// One frame of 64 x 48 pixels, bright within.
fn frame() -> Vec<u8> {
    let inside = |at: usize| (8..56).contains(&(at % 64)) && (12..36).contains(&(at / 64));
    (0..64 * 48).map(|at| if inside(at) { 150 + (at * 7 % 40) as u8 } else { 20 }).collect()
}

fn y4m() -> Vec<u8> {
    let frames = [&b"FRAME\n"[..], &frame()].concat().repeat(4);
    [&b"YUV4MPEG2 W64 H48 F30:1 Cmono\n"[..], &frames].concat()
}

/// An uncompressed film of five frames in grey.
fn avi() -> Vec<u8> {
    let chunk =
        |name: &[u8], data: &[u8]| [name, &(data.len() as u32).to_le_bytes(), data].concat();
    let list = |name: &[u8], data: &[u8]| chunk(b"LIST", &[name, data].concat());
    let words =
        |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<_>>();
    let main = words(&[33_333, 0, 0, 16, 5, 0, 1, 3072, 64, 48, 0, 0, 0, 0]);
    let stream =
        [&b"vidsDIB "[..], &words(&[0, 0, 0, 1, 30, 0, 5, 3072, 0, 0, 0, 64 | 48 << 16])].concat();
    let grey: Vec<u8> = (0..=255).flat_map(|grey| [grey, grey, grey, 0]).collect();
    let format = [words(&[40, 64, 48, 1 | 8 << 16, 0, 3072, 0, 0, 256, 0]), grey].concat();
    let stream = [chunk(b"strh", &stream), chunk(b"strf", &format)].concat();
    let header = [chunk(b"avih", &main), list(b"strl", &stream)].concat();
    let movie = chunk(b"00db", &frame()).repeat(5);
    let body = [&b"AVI "[..], &list(b"hdrl", &header), &list(b"movi", &movie)].concat();
    chunk(b"RIFF", &body)
}

/// A mask of one cell, PNG.
pub(crate) fn mask() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 80, 80).write_header().unwrap();
    let inside = |at: usize| (10..70).contains(&(at % 80)) && (20..60).contains(&(at / 80));
    let pixels: Vec<u8> = (0..6400).map(|at| if inside(at) { 255 } else { 0 }).collect();
    encoder.write_image_data(&pixels).unwrap();
    drop(encoder);
    bytes
}

const GEOJSON: &str = r#"{"type":"Polygon","coordinates":[[[0,0],[100,0],[100,20],[0,20],[0,0]]]}"#;
const RUN_FILE: &str = "[shape]\nspacing = \"5 um\"\n[run]\nduration = \"100 ms\"\n";
const DESCRIPTION: &str = "kind = \"cell\"\n[parameters]\ntau_si = { distribution = \"uniform\", low = 1.5, high = 2.0 }\n\
     [sampling]\nsampler = \"latin-hypercube\"\nsize = 2\n";

/// One of everything that commands read, whole.
fn whole(at: &Path) {
    let files: [(&str, Vec<u8>); 9] = [
        ("mask.png", mask()),
        ("cell.tif", tiff(80, 200.0)),
        ("film.y4m", y4m()),
        ("film.avi", avi()),
        ("curve.csv", curve("")),
        ("calcium.csv", b"time (ms),calcium (uM)\n0,0.1\n50,0.1\n100,0.6\n500,0.1\n".to_vec()),
        ("cell.geojson", GEOJSON.into()),
        ("run.toml", RUN_FILE.into()),
        ("study.toml", DESCRIPTION.into()),
    ];
    for (name, bytes) in files {
        fs::write(at.join(name), bytes).unwrap();
    }
}

impl Damage {
    fn done_to(&self, file: &Path) {
        let bytes = || fs::read(file).unwrap();
        let replaced = |from: &[u8], to: &[u8]| {
            let bytes = bytes();
            let mut places = bytes.windows(from.len()).enumerate().filter(|(_, at)| *at == from);
            let (place, _) =
                places.next().unwrap_or_else(|| panic!("{} has no {from:?}", file.display()));
            [&bytes[..place], to, &bytes[place + from.len()..]].concat()
        };
        let now = match self {
            Cut(count) => bytes()[..*count].to_vec(),
            CutEnd(count) => bytes()[..bytes().len() - count].to_vec(),
            Flip(place) => {
                let mut bytes = bytes();
                bytes[*place] ^= 0xff;
                bytes
            }
            Bytes(from, to) => replaced(from, to),
            Text(from, to) => replaced(from.as_bytes(), to.as_bytes()),
            All(text) => text.as_bytes().to_vec(),
            Made(make) => make(),
            Gone => return fs::remove_file(file).unwrap(),
            Damage::None => return,
        };
        fs::write(file, now).unwrap();
    }
}

/// Copies files, and those of one folder in it.
fn copy(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() {
            fs::create_dir(&to).unwrap();
            copy(&from, &to);
        } else {
            fs::copy(from, to).unwrap();
        }
    }
}

#[test]
fn every_damaged_input_is_refused_with_what_is_wrong_in_it() {
    let template = tempfile::tempdir().unwrap();
    whole(template.path());
    let results = "run run.toml -o res --outputs none --quiet".split(' ').collect::<Vec<_>>();
    let output = myospring(template.path(), &results);
    assert!(output.status.success(), "{}", stderr(&output));
    let wrong: Vec<String> = ROWS
        .par_iter()
        .filter_map(|(file, damage, command, code, names)| {
            let folder = tempfile::tempdir().unwrap();
            copy(template.path(), folder.path());
            damage.done_to(&folder.path().join(file));
            let output = myospring(folder.path(), &command.split(' ').collect::<Vec<_>>());
            let said = stderr(&output).split_whitespace().collect::<Vec<_>>().join(" ");
            let missing: Vec<_> = names.iter().filter(|name| !said.contains(**name)).collect();
            let is_right = output.status.code() == Some(*code) && missing.is_empty();
            let code = output.status.code();
            (!is_right).then(|| format!("{command}: {code:?}, without {missing:?}: {said}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// The files of the table are read where nothing was done to them: rows would prove nothing otherwise.
#[test]
fn the_same_input_is_read_where_it_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    whole(folder.path());
    let commands = [
        "mesh mask.png --pixel-size 0.5um -o 1",
        "mesh cell.tif --pixel-size 0.5um -o 2",
        "track film.y4m --pixel-size 1um -o 3",
        "track film.avi --pixel-size 1um -o 4",
        "analyse curve.csv -o 5",
        "run --model land_2017 --calcium calcium.csv --spacing 5um --duration 60ms --outputs none -o 6",
        "mesh cell.geojson -o 7",
        "study run study.toml -o 8",
    ];
    commands.par_iter().for_each(|command| {
        let output = myospring(folder.path(), &command.split(' ').collect::<Vec<_>>());
        assert!(output.status.success(), "{command}: {}", stderr(&output));
    });
}
