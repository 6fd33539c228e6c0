//! What a page is given.

use crate::field::{Field, FieldError};
use crate::figure::{Figure, FigureError, FittedCurve, LikelihoodProfile};
use crate::json::JsonError;
use crate::report::Summary;
use myospring_core::mesh::Mesh;
use myospring_core::mesh::outline::Outline;
use myospring_core::mesh::pixel_size::PixelSize;
use myospring_core::recording::Recording;

/// What a page shows.
#[derive(Debug, Clone)]
pub struct Page<'a> {
    /// Its title: any text.
    pub title: &'a str,
    /// Version of the program.
    pub version: &'a str,
    /// What the cell is coloured by until somebody chooses.
    pub colour: Field,
    /// What a person should know first, such as that a run stopped early, or that runs were paced otherwise.
    pub warnings: &'a [String],
    /// Settings in which the runs differ.
    pub differences: &'a [Difference],
    /// One run for a report; of several, the first is what the others are compared with.
    pub runs: &'a [PageRun<'a>],
    /// The fit that the only run is the beat of.
    pub fit: Option<PageFit<'a>>,
}

/// A fit on a page.
#[derive(Debug, Clone)]
pub struct PageFit<'a> {
    /// Whether the model follows the curves: `fits`, `fits-nearly`, `does-not-fit`.
    pub verdict: &'a str,
    /// The same in a sentence.
    pub headline: &'a str,
    /// What was found.
    pub estimates: &'a [FittedNumber],
    /// Measured and fitted curves, in the time of the run.
    pub curves: &'a [FittedCurve],
    /// How sure each number is.
    pub profiles: &'a [LikelihoodProfile],
    /// What is to be known of the fit, a sentence each.
    pub notes: &'a [String],
    /// Figures of its own.
    pub figures: Vec<PageFigure<'a>>,
}

/// A number that was fitted, as a person reads it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct FittedNumber {
    /// Its name.
    pub name: String,
    /// What it is.
    pub meaning: String,
    /// Its value with the unit.
    pub value: String,
    /// Its 95 % interval; empty where there is none.
    pub interval: String,
    /// What the curve says of it: `determined`.
    pub verdict: String,
}

/// A figure on a page.
#[derive(Debug, Clone)]
pub struct PageFigure<'a> {
    /// What it shows.
    pub title: &'a str,
    /// The drawing.
    pub figure: Figure,
    /// What it comes to, in a sentence.
    pub words: String,
    /// What is to be known of it, a sentence each.
    pub notes: &'a [String],
}

/// A setting in which runs differ, as a person reads it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Difference {
    /// Its key in a run file.
    pub name: String,
    /// Its value in each run.
    pub values: Vec<String>,
}

/// A run on a page.
#[derive(Debug, Clone)]
pub struct PageRun<'a> {
    /// Short, to tell runs apart: `50 kPa`.
    pub label: &'a str,
    /// What was run, a few words each: the cell, its model, its tension.
    pub facts: Vec<String>,
    /// Its numbers, and what a person should look at.
    pub summary: &'a Summary,
    /// Its curves and frames.
    pub recording: &'a Recording,
    /// Its mesh at rest.
    pub mesh: &'a Mesh,
    /// Unit vector along the fibre in each triangle.
    pub fibres: &'a [[f64; 2]],
    /// Content of myofibrils of each triangle; `None` is 1 everywhere.
    pub myofibril_content: Option<&'a [f64]>,
    /// The outline that was meshed, um.
    pub outline: &'a Outline,
    /// Times of the stimuli, ms.
    pub stimulus_times_ms: &'a [f64],
    /// Parameters and settings, group by group.
    pub parameters: Vec<ParameterGroup>,
    /// The run file that repeats it, TOML.
    pub run_file: &'a str,
    /// What to cite, BibTeX.
    pub citations: &'a str,
    /// The picture that the cell was found in.
    pub picture: Option<Photograph<'a>>,
}

/// Parameters that belong together.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct ParameterGroup {
    /// Name of the group.
    pub name: String,
    /// In the order in which they are shown.
    pub rows: Vec<ParameterRow>,
}

/// A parameter as a person reads it.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize)]
pub struct ParameterRow {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: String,
    /// Unit of the value; empty where the value has it, or has none.
    pub unit: String,
    /// What it does.
    pub meaning: String,
    /// Where the value comes from.
    pub source: String,
    /// Whether it is neither the default nor the published one; on paper only such parameters are listed.
    pub changed: bool,
}

/// The picture of a cell: grey values row by row from the top left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Photograph<'a> {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Values, any scale.
    pub values: &'a [f32],
    /// Side of one pixel; the lower left corner of the picture is at 0, 0 of the mesh.
    pub pixel_size: PixelSize,
}

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// No run to show.
    #[error("a page needs at least 1 run, it was given 0")]
    NoRuns,
    /// A mesh, frame or picture that cannot be drawn.
    #[error(transparent)]
    Drawing(#[from] FigureError),
    /// Fibres or contents of another mesh.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Data that JSON does not hold.
    #[error(transparent)]
    Json(#[from] JsonError),
}
