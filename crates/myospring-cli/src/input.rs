//! From the command line to a run, with the program's files and its signals.

use crate::args::OutputArgs;
use crate::failure::Failure;
use crate::files::FILES;
use crate::interrupt;
use crate::options::ChosenSetting;
use myospring::experiment::input;
pub(crate) use myospring::experiment::input::ending;
use myospring::experiment::refused::Place;
use myospring::run_file::Run;
use std::path::{Path, PathBuf};

/// Where the overlay of a refused picture goes: next to the folder that the results would have had.
pub(crate) fn refusals(args: &OutputArgs, name: &str) -> Place {
    let folder = args.output.as_ref().and_then(|output| {
        let beside = output.file_name()?.to_string_lossy();
        Some(output.with_file_name(format!("{beside}_outline")))
    });
    Place::Folder(folder.unwrap_or_else(|| outlines(name)))
}

/// The default folder for the outlines of a picture of this name.
pub(crate) fn outlines(name: &str) -> PathBuf {
    Path::new("results").join(format!("{name}_outline"))
}

/// Reads and checks every setting; returns the name of the results, and the run.
pub(crate) fn settle(
    path: Option<&Path>,
    overrides: &[ChosenSetting],
) -> Result<(String, Run), Failure> {
    input::settle(path, overrides, &FILES, &interrupt::interruption())
}

/// Refuses `--cell all` where one cell is needed.
pub(crate) fn one_cell(all: bool) -> Result<(), Failure> {
    if !all {
        return Ok(());
    }
    let advice =
        "give --cell largest or a number, or simulate every cell of a folder with myospring batch";
    Err(Failure::new("--cell all chooses several cells, but this command takes one".to_owned())
        .advise(advice))
}
