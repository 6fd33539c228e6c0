//! The program `myospring`: arguments, progress, file names. What is computed is in the library.

mod args;
mod batch;
mod cite;
mod failure;
mod input;
mod lists;
mod mesh;
mod options;
mod overlay;
mod paper;
mod print;
mod results;
mod run;
mod segment;
mod table;

use args::{Cli, Command};
use clap::Parser;
use failure::Failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = Cli::parse();
    match dispatch(&cli) {
        Ok(code) => code,
        Err(failure) => failure.report(),
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
        Some(Command::Batch(args)) => batch::batch(args),
        Some(Command::Mesh(args)) => mesh::mesh(args),
        Some(Command::Models(args)) => lists::models(args),
        Some(Command::Init(args)) => lists::init(args),
        Some(Command::Schema) => lists::schema(),
    }
}
