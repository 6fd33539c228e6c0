//! Files of outlines for tests, and what they all ask of them.
#![allow(dead_code, reason = "no test uses all of it")]

use std::path::{Path, PathBuf};

use myospring::mesh::outline::Outline;
use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::outlines::{
    CoordinateUnit, GivenOutlines, NamedOutline, OutlineFileError, PixelFrame, Placement,
    ReadOptions, read_outlines,
};

pub(crate) const PIXEL_UM: f64 = 0.5;

pub(crate) fn frame() -> PixelFrame {
    PixelFrame::new(80, 60, PixelSize::new(PIXEL_UM).unwrap()).unwrap()
}

pub(crate) fn options() -> ReadOptions {
    ReadOptions { placement: Placement::Picture(frame()), silent_unit: CoordinateUnit::Micrometre }
}

pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/outlines")
}

/// A file that `make.py` has made with other programs.
pub(crate) fn fixture(name: &str) -> Vec<u8> {
    std::fs::read(folder().join(name)).unwrap()
}

pub(crate) fn read(bytes: &[u8]) -> Result<GivenOutlines, OutlineFileError> {
    read_outlines(bytes, "some/cell.file", &options())
}

pub(crate) fn refused(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

pub(crate) fn names(cells: &[NamedOutline]) -> Vec<&str> {
    cells.iter().map(|cell| cell.name.as_str()).collect()
}

pub(crate) fn close(found: &[f64], expected: &[f64], tolerance: f64) -> bool {
    found.len() == expected.len()
        && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance)
}

pub(crate) fn zipped(entries: &[(&str, Vec<u8>)]) -> Vec<u8> {
    use std::io::Write as _;
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        writer.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

pub(crate) fn outline(exterior: Vec<[f64; 2]>, holes: Vec<Vec<[f64; 2]>>) -> Outline {
    Outline::new(exterior, holes).unwrap()
}
