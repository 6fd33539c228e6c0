//! `myospring completions` and `manual`.

use crate::args::{Cli, CompletionsArgs, ManualArgs};
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::print;
use clap::CommandFactory;
use myospring::output::files;

pub(crate) fn completions(args: &CompletionsArgs) -> Result<ExitCode, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "myospring", &mut script);
    print::out(String::from_utf8_lossy(&script).trim_end())?;
    Ok(ExitCode::SUCCESS)
}

pub(crate) fn manual(args: &ManualArgs) -> Result<ExitCode, Failure> {
    files::create_folder(&args.folder)?;
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    let count = pages(&command, args)?;
    print::note(&format!("wrote {count} pages to {}", args.folder.display()));
    Ok(ExitCode::SUCCESS)
}

/// Writes the page of a command and those of its subcommands; returns their number.
fn pages(command: &clap::Command, args: &ManualArgs) -> Result<usize, Failure> {
    let page = clap_mangen::Man::new(command.clone());
    let mut text = Vec::new();
    page.render(&mut text).map_err(Failure::new)?;
    FILES.write(&args.folder.join(page.get_filename()), text)?;
    command.get_subcommands().try_fold(1, |count, command| Ok(count + pages(command, args)?))
}
