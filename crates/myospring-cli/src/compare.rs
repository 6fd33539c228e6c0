//! `myospring compare`.

mod words;

use crate::args::CompareArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::terminal::Terminal;
use crate::{input, interrupt, print};
use myospring::experiment::compare::{Compare, PAGE_OR_FIGURE, Source};
use myospring::experiment::{Experiment, Folder, Outcome};
use myospring::output::json;
use std::path::Path;

pub(crate) fn compare(args: &CompareArgs) -> Result<ExitCode, Failure> {
    input::one_cell(args.settings.all_cells())?;
    let target =
        args.output.output.clone().unwrap_or_else(|| Path::new("results").join("comparison"));
    let scale = args.scale.iter().map(|text| Compare::read_scale(text));
    let doses = args.doses.iter().map(|path| Compare::read_doses(path, &FILES));
    let experiment = Compare {
        inputs: args.inputs.iter().cloned().map(Source::Path).collect(),
        labels: Vec::new(),
        settings: args.settings.overrides(),
        scale: scale.collect::<Result<_, _>>()?,
        doses: doses.collect::<Result<Vec<_>, _>>()?.concat(),
        threads: args.jobs.map(usize::from),
        results: Some(target.clone()),
    };
    experiment.check(&FILES)?;
    interrupt::heed_soon("nothing is written");
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    let terminal = Terminal::new(args.output.quiet);
    let done = experiment.run(&FILES, &terminal);
    terminal.clear();
    if interrupt::asked() {
        return Ok(ExitCode::from(1));
    }
    let outcome = done?;
    if !args.output.quiet {
        outcome.warnings().iter().for_each(|warning| print::warn(warning));
    }
    outcome.save(&folder, &terminal)?;
    let look = PAGE_OR_FIGURE.into_iter().find(|name| folder.has(name)).unwrap_or_default();
    let target = folder.finish(&terminal)?;
    if args.output.json {
        print::out(&json::for_people(&outcome.numbers())?)?;
    } else {
        print::out(&words::for_people(&outcome))?;
        print::out(&format!(
            "\nresults in {} ({:.1} s)\nopen {}",
            target.display(),
            outcome.total_s(),
            target.join(look).display()
        ))?;
    }
    let stopped = outcome.sides.iter().any(|side| side.stop.is_some());
    Ok(if stopped { ExitCode::from(1) } else { ExitCode::SUCCESS })
}
