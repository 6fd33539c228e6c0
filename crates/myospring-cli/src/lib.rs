//! The program `myospring`: arguments, progress, file names. What is computed is in the library `myospring`.
//!
//! It is a library of its own so that the Python package brings the same program: [`main`] with the arguments that
//! Python was given.

mod analyse;
mod args;
mod batch;
mod cite;
mod compare;
mod exit;
mod failure;
mod fibres;
mod film;
mod fit;
mod input;
mod interrupt;
mod lists;
mod look;
mod mesh;
mod options;
mod outputs;
mod overlay;
mod page;
mod paper;
mod print;
mod progress;
mod refused;
mod results;
mod run;
mod segment;
mod study;
mod summary;
mod table;
mod track;

use args::{Cli, Command};
use clap::Parser;
pub use exit::ExitCode;
use failure::Failure;
pub use run::Over;
use std::ffi::OsString;
use std::io::Write;
pub use study::{RESULTS as STUDY_RESULTS, save as save_study};

/// The whole program, with the arguments of a command line, its own name first; the code to end with.
///
/// It prints, heeds signals and may end the process with one.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    interrupt::large_files_are_errors();
    let code = read_and_do(arguments).unwrap_or_else(Failure::report);
    interrupt::end(code)
}

fn read_and_do(arguments: impl IntoIterator<Item = OsString>) -> Result<ExitCode, Failure> {
    match Cli::try_parse_from(arguments) {
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
    match &cli.command {
        None => Err(Failure::new("no command was given").advise("myospring --help lists them")),
        Some(Command::Run(args)) => run::run(args),
        Some(Command::Paper(args)) => paper::paper(args),
        Some(Command::Segment(args)) => segment::segment(args),
        Some(Command::Track(args)) => track::track(args),
        Some(Command::Batch(args)) => batch::batch(args),
        Some(Command::Analyse(args)) => analyse::analyse(args),
        Some(Command::Fit(args)) => fit::fit(args),
        Some(Command::Compare(args)) => compare::compare(args),
        Some(Command::Study(args)) => study::study(args),
        Some(Command::Mesh(args)) => mesh::mesh(args),
        Some(Command::Models(args)) => lists::models(args),
        Some(Command::Init(args)) => lists::init(args),
        Some(Command::Schema) => lists::schema(),
    }
}
