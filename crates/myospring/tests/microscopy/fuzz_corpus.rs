//! The files that fuzzing started from and found: each reader answers or refuses, without panic.
//!
//! `fuzz/` at the root of the repository has the targets that run on a nightly compiler.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::{film_bytes, picture_bytes};

use std::path::{Path, PathBuf};

/// Name and bytes of the files of a target, those that once failed among them.
fn files(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target);
    let entries = std::fs::read_dir(folder).unwrap();
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
        read += picture_bytes::exercise(&bytes);
    }
    assert!(read > 0, "a corpus without any picture that can be read tests little");
}

#[test]
fn no_file_of_the_corpus_makes_the_reader_of_films_panic() {
    let mut read = 0;
    for (path, bytes) in files("film") {
        println!("{}", path.display());
        let frames = film_bytes::exercise(&bytes);
        let whole = !path.to_string_lossy().contains("xvid");
        assert_eq!(frames > 0, whole, "{}: {frames} frames", path.display());
        read += frames;
        for end in 0..bytes.len() {
            film_bytes::exercise(&bytes[..end]);
        }
    }
    assert!(read > 40, "{read} frames");
}

#[test]
fn no_file_of_films_or_pictures_makes_the_reader_of_stacks_panic() {
    let mut slices = 0;
    for (path, bytes) in files("film").into_iter().chain(files("picture")) {
        println!("{}", path.display());
        slices += film_bytes::exercise_stack(&bytes);
        for part in 1..20 {
            film_bytes::exercise_stack(&bytes[..bytes.len() * part / 20]);
        }
    }
    assert!(slices > 20, "{slices} slices");
}
