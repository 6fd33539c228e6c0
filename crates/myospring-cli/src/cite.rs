//! `--cite`.

use crate::args::{Cli, Command};
use crate::failure::Failure;
use crate::print;
use myospring::cell;
use std::process::ExitCode;

const REFERENCES: &str = include_str!("../../../references.bib");

/// Prints what to cite: this program, the paper behind it, and the papers of the cell model.
pub(crate) fn print(cli: &Cli) -> Result<ExitCode, Failure> {
    let chosen = match &cli.command {
        Some(Command::Run(args)) => args.beat.simulation.model.as_deref(),
        Some(Command::Batch(args)) => args.beat.simulation.model.as_deref(),
        Some(Command::Models(args)) => args.name.as_deref(),
        _ => None,
    };
    let model = cell::model(chosen.unwrap_or("coelho_2021")).map_err(Failure::new)?;
    let mut keys = vec!["coelho_2021"];
    for key in model.citations() {
        if !keys.contains(key) {
            keys.push(key);
        }
    }
    let version = env!("CARGO_PKG_VERSION");
    print::out(&format!(
        "@software{{myospring,\n  author  = {{{{The Myospring developers}}}},\n  title   = \
         {{Myospring: from a microscope picture of a heart cell to its beat}},\n  version = \
         {{{version}}},\n  year    = {{2026}}\n}}"
    ));
    for key in keys {
        if let Some(entry) = entry(key) {
            print::out(&format!("\n{entry}"));
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// One entry of `references.bib`, from its `@` to its last brace.
fn entry(key: &str) -> Option<&'static str> {
    let head = format!("{{{key},");
    let at = REFERENCES.find(&head)?;
    let start = REFERENCES[..at].rfind('@')?;
    let end = REFERENCES[start..].find("\n}")?;
    Some(&REFERENCES[start..start + end + 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_paper_that_a_model_cites_is_in_the_references() {
        for model in cell::models() {
            for key in model.citations() {
                let entry = entry(key).unwrap_or_else(|| panic!("{key} is missing"));
                assert!(entry.starts_with('@') && entry.ends_with('}'), "{entry}");
            }
        }
    }
}
