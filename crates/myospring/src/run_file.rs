//! Run files: reads TOML into validated types, and writes them back.
//!
//! ```text
//! text + options  ->  RunFile (what was written)  ->  Run (checked, internal units)  ->  Simulation
//!                          ^                             |
//!                          +----------- to_run_file -----+
//! ```
//!
//! The keys are those of the table of [`settings`](crate::settings), from which [`schema()`] makes
//! a JSON Schema and [`template()`] a commented run file; rules between keys are in
//! `run_file/rules.rs`. No file is opened here: pictures are read through a closure
//! ([`Shape::bytes`]).
//!
//! # Example
//! ```
//! use myospring::run_file::RunFile;
//! let run = RunFile::from_text("[cell]\npeak_tension = \"40 kPa\"")?.resolve()?;
//! assert_eq!((run.peak_tension, run.duration), (40.0, 600.0));
//!
//! let error = RunFile::from_text("[material]\nthicknes = \"8 um\"").unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "line 2, column 1: unknown key `thicknes` in [material]; did you mean `thickness`?"
//! );
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod file;
mod presets;
mod reading;
mod resolve;
mod rules;
mod schema;
mod template;

pub use crate::settings::{
    FibreDirection, PictureSource, Problem, Run, Shape, ShapeBytes, ShapeError, Shaped, Source,
};
pub use error::{Origin, RunFileError};
pub use file::RunFile;
pub use presets::{PRESETS, Preset};
pub use reading::Reader;
pub(crate) use rules::SHAPES;
pub use schema::{schema, schema_id};
pub use template::template;
