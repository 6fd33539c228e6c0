//! `--cite`.

use crate::args::{Cli, Command, ModelsArgs};
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::{input, print};
use myospring::experiment::citations::bibtex;
use myospring::settings::{FromFile, Models};
use std::path::Path;

/// Prints what to cite: this program, the paper behind it, and the papers of the cell model.
pub(crate) fn print(cli: &Cli) -> Result<ExitCode, Failure> {
    let model = match &cli.command {
        Some(Command::Run(args)) => {
            let is_run_file =
                |path: &&Path| path.extension().is_some_and(|ending| ending == "toml");
            let run_file = args.input.as_deref().filter(is_run_file);
            input::settle(run_file, &args.settings.model())?.1.cell
        }
        Some(Command::Batch(args)) => input::settle(None, &args.settings.model())?.1.cell,
        Some(Command::Models(ModelsArgs { name: Some(name), variables, .. })) => {
            let variables = variables.clone().unwrap_or_default();
            let how = FromFile { variables, myofilaments: None };
            Models::default().model(name, &how).map_err(Failure::new)?
        }
        _ => input::settle(None, &[])?.1.cell,
    };
    print::out(&bibtex(&*model))?;
    Ok(ExitCode::SUCCESS)
}
