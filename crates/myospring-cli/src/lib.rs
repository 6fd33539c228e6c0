//! The program `myospring`: arguments, progress, file names. All computation is in the library
//! `myospring`.
//!
//! It is a separate library so that the Python package includes the same program: [`main`] with the
//! arguments that Python received.

mod analyse;
mod args;
mod batch;
mod cite;
mod compare;
mod exit;
mod failure;
mod files;
mod fit;
mod input;
mod interrupt;
mod kinds;
mod lists;
mod look;
mod manual;
mod mesh;
mod options;
mod outputs;
mod paper;
mod print;
mod progress;
mod run;
mod segment;
mod shell;
mod study;
mod table;
mod terminal;
#[cfg(test)]
mod tests;
mod track;
mod traction;

use args::{Cli, Command};
use clap::Parser;
pub use exit::ExitCode;
use failure::Failure;
use kinds::{Kind, refusal};
use myospring::experiment::optical::MapWaves;
use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

/// Runs the program with the arguments of a command line, its own name first; returns the exit
/// code.
///
/// It prints, handles signals, and may end the process by a signal.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    interrupt::large_files_are_errors();
    let code = read_and_do(arguments).unwrap_or_else(failure::report);
    interrupt::end(code)
}

fn read_and_do(arguments: impl IntoIterator<Item = OsString>) -> Result<ExitCode, Failure> {
    match Cli::try_parse_from(shell::arguments(arguments)?) {
        Ok(cli) => dispatch(&cli),
        // Help and version, too.
        Err(answer) => {
            let printed = answer.print().and_then(|()| std::io::stdout().flush());
            if !answer.use_stderr() {
                print::check(printed)?;
            }
            Ok(ExitCode::from(u8::try_from(answer.exit_code()).unwrap_or(failure::BAD_INPUT)))
        }
    }
}

fn dispatch(cli: &Cli) -> Result<ExitCode, Failure> {
    if cli.cite {
        return cite::print(cli);
    }
    let of_cells = [Kind::Picture, Kind::Outline, Kind::RunFile];
    match &cli.command {
        None => Err(Failure::new("no command was given").advise("myospring --help lists them")),
        Some(Command::Run(args)) => with("run", &args.input, &of_cells, run::run(args)),
        Some(Command::Paper(args)) => paper::paper(args),
        Some(Command::Segment(args)) => {
            with("segment", [&args.input], &[Kind::Picture], segment::segment(args))
        }
        Some(Command::Track(args)) => {
            let takes = [Kind::Film, Kind::Picture, Kind::Pictures];
            // Before a folder for the results is created.
            refusal("track", [&args.input], &takes).map_or_else(|| track::track(args), Err)
        }
        Some(Command::Batch(args)) => {
            // Before figures of results are read as pictures of cells.
            refusal("batch", &args.folder, &[Kind::Pictures])
                .map_or_else(|| batch::batch(args), Err)
        }
        Some(Command::Analyse(args)) => match &args.inputs[..] {
            // It takes films of light: their failures are their own.
            [film] if MapWaves::takes(film) => analyse::analyse(args),
            inputs => {
                let takes = [Kind::Curves, Kind::Tables, Kind::Results];
                with("analyse", inputs, &takes, analyse::analyse(args))
            }
        },
        Some(Command::Traction(args)) => traction::traction(args),
        Some(Command::Fit(args)) => {
            let takes = [Kind::Curves, Kind::Tables, Kind::Film, Kind::Picture, Kind::Pictures];
            with("fit", &args.to, &takes, fit::fit(args))
        }
        Some(Command::Compare(args)) => {
            let takes = [Kind::Picture, Kind::Outline, Kind::RunFile, Kind::Results];
            with("compare", &args.inputs, &takes, compare::compare(args))
        }
        Some(Command::Study(args)) => {
            with("study run", args.command.file(), &[Kind::Study], study::study(args))
        }
        Some(Command::Mesh(args)) => with("mesh", &args.input, &of_cells, mesh::mesh(args)),
        Some(Command::Models(args)) => lists::models(args),
        Some(Command::Init(args)) => lists::init(args),
        Some(Command::Schema(args)) => lists::schema(args),
        Some(Command::Completions(args)) => manual::completions(args),
        Some(Command::Manual(args)) => manual::manual(args),
    }
}

/// The result of a command; a failure names the command that takes the file if this one does not.
fn with<'a>(
    command: &str,
    paths: impl IntoIterator<Item = &'a PathBuf>,
    takes: &[Kind],
    done: Result<ExitCode, Failure>,
) -> Result<ExitCode, Failure> {
    done.map_err(|failure| refusal(command, paths, takes).unwrap_or(failure))
}
