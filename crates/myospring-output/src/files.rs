//! Writes files completely or not at all: the only part of the library that writes to the disk,
//! except the journal of a study.

mod bounded;
mod draft;
mod error;
mod hold;
mod manifest;
mod names;
mod reads;
mod scratch;
mod write;

pub use bounded::read;
pub use draft::Draft;
pub use error::FileError;
pub use hold::{Hold, hold};
pub use manifest::{Manifest, sha256};
pub use names::MANIFEST;
pub use reads::Reads;
pub use scratch::Scratch;
pub use write::{check_writable, clear_parts, create_folder, write, write_with};
