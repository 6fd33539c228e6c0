//! Pictures to masks: bytes in, pixels out; no file is opened here.
//!
//! [`read::read_mask`] takes the bytes of a PNG or TIFF in which a person or a program has marked
//! the cell, and gives a [`crate::mesh::mask::Mask`].

pub mod read;
