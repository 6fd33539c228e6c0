//! The content of a page.

use super::cell::BeatingCells;
use super::chart::Chart;
use super::figure::{Drawing, Thumbnail};
use super::table::{Table, Tile};
use crate::figure::LikelihoodProfile;
use serde::Serialize;

/// What a page shows.
#[derive(Debug, Clone)]
pub struct Page<'a> {
    /// What the page is, above its title: `A beat by Myospring`.
    pub kind: &'a str,
    /// Its title: any text.
    pub title: &'a str,
    /// Facts about the experiment, a few words each.
    pub facts: Vec<String>,
    /// The answer.
    pub answer: Option<Answer>,
    /// Warnings, such as that a run stopped early.
    pub warnings: Vec<String>,
    /// Everything else, in the order of reading.
    pub sections: Vec<Section<'a>>,
}

/// The answer of an experiment in one line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Answer {
    /// A sentence.
    pub words: String,
    /// Its quality, shown as a colour.
    pub quality: Quality,
}

/// How good an answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Quality {
    /// It can be used.
    Good,
    /// It can be used with care.
    Fair,
    /// It must not be used.
    Poor,
}

/// A heading with what is below it.
#[derive(Debug, Clone)]
pub struct Section<'a> {
    /// Its unique name in the page.
    pub id: &'static str,
    /// Its heading.
    pub title: String,
    /// How to read it, small; empty where that is clear.
    pub hint: String,
    /// What it shows.
    pub parts: Vec<Part<'a>>,
}

impl<'a> Section<'a> {
    /// A section without a hint.
    pub fn new(id: &'static str, title: &str, parts: Vec<Part<'a>>) -> Self {
        Self { id, title: title.to_owned(), hint: String::new(), parts }
    }
}

/// One of the kinds of things that a page shows.
#[derive(Debug, Clone)]
pub enum Part<'a> {
    /// Beating cells with the curves that go with them; a page has one at most.
    Beat(BeatingCells<'a>),
    /// Charts over time.
    Charts(Vec<Chart>),
    /// How well numbers are determined.
    Profiles(Vec<LikelihoodProfile>),
    /// Key numbers.
    Tiles(Vec<Tile>),
    /// A table.
    Table(Table),
    /// Small pictures.
    Gallery(Vec<Thumbnail>),
    /// A figure.
    Figure(Drawing),
    /// Sentences; those of several are a list.
    Words(Vec<String>),
    /// Text to copy or to save as a file.
    Text {
        /// What it is: `run file`.
        what: String,
        /// Name of the file.
        file: &'static str,
        /// The text.
        text: String,
    },
    /// Parts behind a title that unfolds.
    Folded {
        /// What unfolds.
        title: String,
        /// Whether it is printed.
        on_paper: bool,
        /// The parts.
        parts: Vec<Part<'a>>,
    },
}
