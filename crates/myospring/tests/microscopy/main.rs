//! Pictures, masks and drawn outlines to cells.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests may fail")]

#[path = "../common/bead_film.rs"]
mod bead_film;
#[path = "../common/cells_film.rs"]
mod cells_film;
#[path = "../common/mod.rs"]
mod common;
#[path = "../common/film_bytes.rs"]
mod film_bytes;
#[path = "../common/no_cell.rs"]
mod no_cell;
#[path = "../common/outline_bytes.rs"]
mod outline_bytes;
#[path = "../common/outline_files.rs"]
mod outline_files;
#[path = "../common/picture_bytes.rs"]
mod picture_bytes;
#[path = "../common/synthetic_cell.rs"]
mod synthetic_cell;
#[path = "../common/synthetic_film.rs"]
mod synthetic_film;
#[path = "../common/touching_cells.rs"]
mod touching_cells;
#[path = "../common/warped_film.rs"]
mod warped_film;

mod adhesion;
mod beads;
mod fibres;
mod film_cells;
mod films;
mod fuzz_corpus;
mod headline;
mod heart_cells;
mod hot_pixels;
mod interruption;
mod made_up_stacks;
mod marks;
mod masks;
mod motion;
#[cfg(feature = "run-file")]
mod optical;
mod optical_maps;
mod outlines_damaged;
mod outlines_given;
mod outlines_traced;
mod pictures;
mod posts;
mod repeats;
mod sarcomeres;
mod segmentation;
mod shape_report;
mod skipped;
mod stacks;
mod touching;
mod warped;
