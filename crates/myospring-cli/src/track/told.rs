//! What a track leaves and says.

use crate::args::TrackArgs;
use crate::failure::Failure;
use crate::print;
use crate::terminal::Terminal;
use myospring::experiment::{Folder, Outcome};
use myospring::output::json;

/// Saves an outcome and prints it.
pub(super) fn told(
    args: &TrackArgs,
    outcome: &impl Outcome,
    folder: Folder,
    terminal: &Terminal,
    words: impl FnOnce() -> String,
) -> Result<(), Failure> {
    terminal.clear();
    if !args.output.quiet {
        outcome.warnings().iter().for_each(|warning| print::warn(warning));
    }
    outcome.save(&folder, terminal)?;
    let target = folder.finish(terminal)?;
    if args.output.json {
        return print::out(&json::for_people(&outcome.numbers())?);
    }
    print::out(&words())?;
    print::out(&format!("\nwritten: {}", target.display()))
}
