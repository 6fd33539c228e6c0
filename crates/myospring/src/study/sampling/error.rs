//! Errors of sampling.

/// More rows than this are refused: their matrix would not fit into memory.
pub(super) const MOST_ROWS: usize = 100_000_000;

/// Dimensions that the Sobol sequence has here.
pub const MOST_DIMENSIONS: usize = 512;

/// Why there is no sample.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SamplingError {
    /// An invalid distribution.
    #[error("a {kind} distribution needs {must}, but {what} is {value}")]
    Distribution {
        /// Its word.
        kind: &'static str,
        /// Which of its numbers.
        what: &'static str,
        /// That number.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// A number of rows, levels or trajectories that is not possible.
    #[error("{what} is {value}; give {must}")]
    Size {
        /// What.
        what: &'static str,
        /// As given.
        value: usize,
        /// What it must be.
        must: &'static str,
    },
    /// Nothing to sample.
    #[error("no parameter varies; give at least one a distribution other than fixed")]
    NoParameters,
    /// More parameters than the Sobol sequence has dimensions.
    #[error(
        "{dimensions} dimensions are more than the {MOST_DIMENSIONS} of the Sobol sequence; vary fewer parameters (Saltelli's design needs two for each), or use latin-hypercube or morris"
    )]
    Dimensions {
        /// Asked for.
        dimensions: usize,
    },
    /// More rows than can be held.
    #[error(
        "{rows} rows are more than {MOST_ROWS}; take fewer levels, a smaller size or fewer parameters"
    )]
    Rows {
        /// How many, as a float where they do not fit a whole number.
        rows: f64,
    },
}
