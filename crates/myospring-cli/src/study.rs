//! `myospring study`: many runs that differ in numbers.

mod words;

use crate::args::{
    SchemaOf, StudyArgs, StudyCommand, StudyFiguresArgs, StudyInitArgs, StudyMergeArgs,
    StudyRunArgs,
};
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::terminal::Terminal;
use crate::{interrupt, lists, print};
use myospring::experiment::study::{FIGURES, Studied, Study, StudyPlan};
use myospring::output::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

const TEMPLATE: &str = include_str!("study/template.toml");

pub(crate) fn study(args: &StudyArgs) -> Result<ExitCode, Failure> {
    match &args.command {
        StudyCommand::Run(args) => begin(args),
        StudyCommand::Merge(args) => merge(args),
        StudyCommand::Figures(args) => figures(args),
        StudyCommand::Init(args) => init(args),
    }
}

fn target(output: Option<&PathBuf>, study: &Path) -> PathBuf {
    output.cloned().unwrap_or_else(|| {
        let name = study.file_stem().unwrap_or_default().to_string_lossy();
        Path::new("results").join(format!("{name}_study"))
    })
}

fn begin(args: &StudyRunArgs) -> Result<ExitCode, Failure> {
    let (start, output) = (Instant::now(), &args.output);
    let study = Study::read(&args.study, &FILES)?;
    let target = target(output.output.as_ref(), &args.study);
    let shard = args.shard.as_deref().map(str::parse).transpose().map_err(Failure::new)?;
    let jobs = args.jobs.map(usize::from);
    let plan = StudyPlan { target: target.clone(), shard, jobs, force: output.force };
    let open = study.open(&plan)?;
    let folder = open.folder.clone();
    interrupt::heed_soon("unfinished members are discarded");
    let observer = Terminal::new(output.quiet);
    let studied = open.run(&observer)?;
    interrupt::tidies();
    observer.clear();
    let members = studied.members;
    if studied.interrupted {
        print::note(&format!(
            "interrupted: {} of {members} members are done and kept; the same command continues with the others",
            studied.done()
        ));
        return Ok(ExitCode::from(1));
    }
    if let Some(shard) = shard {
        print::out(&format!(
            "{members} members of part {shard} are done, in {} ({:.1} s)\n\
             when all parts are: myospring study merge {} --output {}",
            folder.display(),
            start.elapsed().as_secs_f64(),
            args.study.display(),
            target.display()
        ))?;
        return Ok(ExitCode::SUCCESS);
    }
    let took =
        || format!("results in {} ({:.1} s)", target.display(), start.elapsed().as_secs_f64());
    finish(&study, studied, output.json, took)
}

fn merge(args: &StudyMergeArgs) -> Result<ExitCode, Failure> {
    let study = Study::read(&args.study, &FILES)?;
    let target = target(args.output.as_ref(), &args.study);
    let studied = study.merge(&target)?;
    finish(&study, studied, args.json, || format!("results in {}", target.display()))
}

/// Writes the files of a study and prints what it found; `took` says where the results are.
fn finish(
    study: &Study,
    mut studied: Studied<'_>,
    as_json: bool,
    took: impl Fn() -> String,
) -> Result<ExitCode, Failure> {
    let (found, left_out) = studied.write()?;
    for warning in &left_out {
        print::warn(warning);
    }
    if as_json {
        print::out(&json::pretty(&found)?)?;
    } else {
        print::out(&words::for_people(&study.parameters, &found))?;
        print::out(&took())?;
    }
    Ok(ExitCode::from(u8::from(found.acceptance.failed > 0)))
}

fn figures(args: &StudyFiguresArgs) -> Result<ExitCode, Failure> {
    let study = Study::read(&args.study, &FILES)?;
    let target = target(args.output.as_ref(), &args.study);
    let (count, left_out) = study.draw(&target)?;
    for warning in &left_out {
        print::warn(warning);
    }
    print::out(&format!("{count} figures in {}", target.join(FIGURES).display()))?;
    Ok(ExitCode::SUCCESS)
}

fn init(args: &StudyInitArgs) -> Result<ExitCode, Failure> {
    let Some(path) = &args.file else {
        print::out(TEMPLATE)?;
        return Ok(ExitCode::SUCCESS);
    };
    if path.exists() && !args.force {
        let message = format!("`{}` exists already", path.display());
        return Err(Failure::new(message).advise("give another name, or replace it with --force"));
    }
    lists::write_with_schema(path, TEMPLATE, SchemaOf::Study)?;
    print::note(&format!("wrote {0}; try: myospring study run {0}", path.display()));
    Ok(ExitCode::SUCCESS)
}
