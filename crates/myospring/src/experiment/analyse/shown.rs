//! A figure that a page of curves shows first.

use crate::output::figure::Figure;
use crate::output::page::Tile;

/// A figure of what the curves were read from.
#[derive(Debug, Clone)]
pub(in crate::experiment) struct Shown {
    /// Name of the file.
    pub(in crate::experiment) of: String,
    pub(in crate::experiment) id: &'static str,
    pub(in crate::experiment) title: &'static str,
    /// What it shows, in a sentence.
    pub(in crate::experiment) words: String,
    pub(in crate::experiment) figure: Figure,
    /// Its key numbers.
    pub(in crate::experiment) tiles: Vec<Tile>,
}
