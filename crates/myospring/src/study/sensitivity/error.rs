//! Errors of a sensitivity analysis.

/// Errors of a sensitivity analysis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SensitivityError {
    /// The number of answers is not the number of rows of the design.
    #[error(
        "{answers} answers are not a multiple of {rows}, the rows of one of the {of} for {parameters} parameters; \
        analyse all rows of the design, in its order"
    )]
    Rows {
        /// Answers given.
        answers: usize,
        /// What a group of rows is.
        of: &'static str,
        /// Rows of one.
        rows: usize,
        /// Parameters.
        parameters: usize,
    },
    /// Too few complete groups.
    #[error(
        "only {whole} of {all} {of} have an answer in every row; 2 are needed: see why members failed"
    )]
    TooFew {
        /// Groups without a failure.
        whole: usize,
        /// All groups.
        all: usize,
        /// What a group of rows is.
        of: &'static str,
    },
    /// The answer does not vary.
    #[error("all answers are {value}: nothing varies, so nothing can be explained")]
    Constant {
        /// The answer.
        value: f64,
    },
}
