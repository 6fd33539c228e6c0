//! The files that fuzzing started from and found: each reader answers or refuses, without panic.
//!
//! `fuzz/` at the root of the repository has the targets that run on a nightly compiler.
#![cfg(feature = "microscopy")]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};

use myospring::microscopy::mask::{MaskOptions, read_mask};
use myospring::microscopy::picture::{Depth, Selection};
use myospring::microscopy::read::read_picture;

/// Name and bytes of the files of a target, those that once failed among them.
fn files(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    let folders = ["corpus", "regressions"].map(|folder| root.join(folder).join(target));
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).into_iter().flatten());
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(paths.len() >= 10, "only {} files of the target `{target}`", paths.len());
    paths.into_iter().map(|path| (path.clone(), std::fs::read(path).unwrap())).collect()
}

#[test]
fn no_file_of_the_corpus_makes_the_reader_of_pictures_panic() {
    let mut read = 0;
    for (path, bytes) in files("picture") {
        // Shown where a panic follows.
        println!("{}", path.display());
        let maximum = Selection { depth: Some(Depth::Maximum), ..Selection::default() };
        let inner = Selection { channel: Some(1), frame: 1, depth: Some(Depth::Slice(1)) };
        for selection in [Selection::default(), maximum, inner] {
            read += usize::from(read_picture(&bytes, &selection).is_ok());
        }
        let _ = read_mask(&bytes, &MaskOptions { label: None, pixel_size_um: 0.27 });
    }
    assert!(read > 0, "a corpus without any picture that can be read tests little");
}
