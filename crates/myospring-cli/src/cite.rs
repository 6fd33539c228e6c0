//! `--cite`.

use crate::args::{Cli, Command, ModelsArgs};
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::{input, print};
use myospring::cell::{self, CellModel};
use myospring::references;
use std::path::Path;

/// Prints what to cite: this program, the paper behind it, and the papers of the cell model.
pub(crate) fn print(cli: &Cli) -> Result<ExitCode, Failure> {
    let model = match &cli.command {
        Some(Command::Run(args)) => {
            let is_run_file =
                |path: &&Path| path.extension().is_some_and(|ending| ending == "toml");
            let run_file = args.input.as_deref().filter(is_run_file);
            input::settle(run_file, args.settings.model())?.1.cell
        }
        Some(Command::Batch(args)) => input::settle(None, args.settings.model())?.1.cell,
        Some(Command::Models(ModelsArgs { name: Some(name), .. })) => {
            cell::model(name).map_err(Failure::new)?
        }
        _ => input::settle(None, Vec::new())?.1.cell,
    };
    print::out(&bibtex(&*model))?;
    Ok(ExitCode::SUCCESS)
}

/// Entries of this program, the paper behind it, and the papers of a cell model.
pub(crate) fn bibtex(model: &dyn CellModel) -> String {
    let mut keys = vec!["coelho_2021"];
    for key in model.citations() {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    let version = env!("CARGO_PKG_VERSION");
    let program = format!(
        "@software{{myospring,\n  author  = {{{{The Myospring developers}}}},\n  title   = \
         {{Myospring: from a microscope picture of a heart cell to its beat}},\n  version = \
         {{{version}}},\n  year    = {{2026}}\n}}"
    );
    let papers = keys.into_iter().filter_map(references::entry).map(str::to_owned);
    std::iter::once(program).chain(papers).collect::<Vec<_>>().join("\n\n")
}
