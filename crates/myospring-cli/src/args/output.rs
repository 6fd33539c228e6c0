//! What commands with results have in common.

use clap::Args;
use std::path::PathBuf;

/// Heading of the options of results.
pub(crate) const OUTPUT: &str = "Output";

/// Where results are written and what is printed.
#[derive(Debug, Args)]
pub(crate) struct OutputArgs {
    /// Folder for the results [default: results/NAME]
    #[arg(short, long, value_name = "DIR", help_heading = OUTPUT)]
    pub(crate) output: Option<PathBuf>,
    /// Replace existing results
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) force: bool,
    /// Print results as JSON
    #[arg(long, help_heading = OUTPUT)]
    pub(crate) json: bool,
    /// No progress bar and no notes
    #[arg(short, long, help_heading = OUTPUT)]
    pub(crate) quiet: bool,
}
