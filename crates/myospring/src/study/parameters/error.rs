//! Errors of a study of parameters.

use super::super::StudyError;
use super::super::sampling::SamplingError;
use super::super::sensitivity::SensitivityError;
use crate::parameter::nearest;
use crate::run_file::RunFileError;
use crate::settings::{NumberError, ShapeError};
use crate::units::UnitError;

/// Why a study of parameters was not read or not begun.
#[derive(Debug, thiserror::Error)]
pub enum ParameterStudyError {
    /// Not TOML, or a key that is unknown or has a value of the wrong kind.
    #[error("{0}")]
    Toml(#[from] toml::de::Error),
    /// The run that all members have in common.
    #[error("[run]: {0}")]
    Run(#[from] RunFileError),
    /// A file that cannot be read.
    #[error("{what}: cannot read `{path}`: {cause}")]
    Read {
        /// The key that names it.
        what: &'static str,
        /// The file.
        path: String,
        /// Why.
        cause: std::io::Error,
    },
    /// A name that is not a number of the run.
    #[error("[parameters]: {0}")]
    Name(#[from] NumberError),
    /// A parameter given twice, by its name and by its key.
    #[error("[parameters]: `{key}` is given twice")]
    Twice {
        /// Its key.
        key: String,
    },
    /// A number of a distribution with a unit of another kind.
    #[error("[parameters.{name}] {what}: {cause}")]
    Unit {
        /// The parameter.
        name: String,
        /// The number.
        what: String,
        /// What is wrong with it.
        cause: UnitError,
    },
    /// An invalid distribution.
    #[error("[parameters.{name}]: {cause}")]
    Distribution {
        /// The parameter.
        name: String,
        /// What is wrong with it.
        cause: String,
    },
    /// Cells are compared with the run itself, which has no such number.
    #[error(
        "[parameters.{name}]: cells are compared with the run itself, which has none; give it one in [run]: {key}"
    )]
    NoUsual {
        /// The parameter.
        name: String,
        /// Its key.
        key: String,
    },
    /// Factors of a number that the run decides itself.
    #[error(
        "[parameters.{name}]: relative = true needs a value to multiply, and the run has none; give it one in [run]"
    )]
    NoValue {
        /// The parameter.
        name: String,
    },
    /// The table `[sampling]` is missing.
    #[error(
        "[sampling] is missing; it sets the number of members and their values, like sampler = \
         \"latin-hypercube\" with size = 100"
    )]
    NoSampling,
    /// Invalid sampling.
    #[error("[sampling]: {0}")]
    Sampling(#[from] SamplingError),
    /// A key of the sampling that cannot be read.
    #[error("[sampling]: {cause}")]
    Design {
        /// What is wrong.
        cause: String,
    },
    /// Keys that a table of rows does not use, or a missing file.
    #[error("[sampling] with sampler = \"table\": {cause}")]
    Table {
        /// What is wrong.
        cause: String,
    },
    /// A band in which nothing can lie.
    #[error("[keep] {metric} = [{}, {}]: write the least and the largest value", .band[0], .band[1])]
    Band {
        /// The metric.
        metric: String,
        /// As written.
        band: [f64; 2],
    },
    /// An invalid table of rows.
    #[error("[sampling] file `{path}`: {cause}")]
    Rows {
        /// The file.
        path: String,
        /// What is wrong with it.
        cause: String,
    },
    /// A table of members that is not that of the study.
    #[error("the table of members: {cause}")]
    Members {
        /// What is wrong with it.
        cause: String,
    },
    /// A row that does not have a value for each number.
    #[error("row {row} has {length} values, but {columns} numbers vary")]
    Length {
        /// Which row, from 1.
        row: usize,
        /// Its values.
        length: usize,
        /// Numbers that vary.
        columns: usize,
    },
    /// A metric that members do not have.
    #[error("{place}: there is no metric `{name}`{}", hint(name, known))]
    Metric {
        /// Where it is named.
        place: &'static str,
        /// As written.
        name: String,
        /// Those that there are.
        known: Vec<&'static str>,
    },
    /// A setting that cells without a mesh do not have.
    #[error(
        "kind = \"cell\" follows action potential, calcium and tension of cells without a mesh: {what}; take \
         kind = \"beat\""
    )]
    NoCell {
        /// The obstacle.
        what: String,
    },
    /// The shape that all members have in common.
    #[error("[run]: {0}")]
    Shape(#[from] ShapeError),
    /// The common run cannot be simulated.
    #[error("[run]: {0}")]
    Base(String),
    /// A part of a study that does not exist.
    #[error("`{text}` names no part of a study; write i/N with i from 1 to N, like 2/8")]
    Shard {
        /// As written.
        text: String,
    },
    /// Indices cannot be computed.
    #[error(transparent)]
    Sensitivity(#[from] SensitivityError),
    /// The study itself.
    #[error(transparent)]
    Study(#[from] StudyError),
}

/// A hint at the metric that may be meant.
fn hint(name: &str, known: &[&'static str]) -> String {
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("; did you mean `{near}`?"),
        None => format!("; there are {}", known.join(", ")),
    }
}
