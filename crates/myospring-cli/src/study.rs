//! `myospring study`: many runs that differ in numbers.

mod files;
mod words;

use crate::args::{
    SchemaOf, StudyArgs, StudyCommand, StudyFiguresArgs, StudyInitArgs, StudyMergeArgs,
    StudyRunArgs,
};
use crate::batch::damaged;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::{interrupt, lists, print, progress};
use files::TABLE;
pub use files::save;
use files::{FIGURES, draw, write};
use indicatif::ProgressBar;
use myospring::interruption::Interruption;
use myospring::output::files::Manifest;
use myospring::output::json;
use myospring::study::parameters::{
    Answer, Common, ParameterStudy, Shard, Variation, VariationRow, merge_traces, run,
    with_whole_curves,
};
use myospring::study::{Journal, Observer, Row as _, Status, Threads};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Missing members that are named.
const NAMED: usize = 5;

const TEMPLATE: &str = include_str!("study/template.toml");

pub(crate) fn study(args: &StudyArgs) -> Result<ExitCode, Failure> {
    match &args.command {
        StudyCommand::Run(args) => begin(args),
        StudyCommand::Merge(args) => merge(args),
        StudyCommand::Figures(args) => figures(args),
        StudyCommand::Init(args) => init(args),
    }
}

fn read_study(path: &Path) -> Result<(String, ParameterStudy), Failure> {
    let named =
        |cause: &dyn std::fmt::Display| Failure::new(format!("`{}`: {cause}", path.display()));
    let text = FILES.text(path)?;
    let study = ParameterStudy::from_toml(&text, beside(path)).map_err(|error| {
        named(&error).advise("`myospring study init` writes a description to start from")
    })?;
    Ok((text, study))
}

/// Reads files as a description names them: beside it.
fn beside(path: &Path) -> impl Fn(&str) -> io::Result<Vec<u8>> + Sync {
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    move |file: &str| FILES.bytes(folder.join(file))
}

fn target(output: Option<&PathBuf>, study: &Path) -> PathBuf {
    output.cloned().unwrap_or_else(|| {
        let name = study.file_stem().unwrap_or_default().to_string_lossy();
        Path::new("results").join(format!("{name}_study"))
    })
}

fn shard_folder(target: &Path, shard: Shard) -> PathBuf {
    target.join(format!("shard_{}_of_{}", shard.part, shard.of))
}

/// The part whose folder has this name.
fn part_of(folder: &str) -> Option<Shard> {
    let (part, of) = folder.strip_prefix("shard_")?.split_once("_of_")?;
    format!("{part}/{of}").parse().ok()
}

fn begin(args: &StudyRunArgs) -> Result<ExitCode, Failure> {
    let (start, output) = (Instant::now(), &args.output);
    let (text, study) = read_study(&args.study)?;
    let read = beside(&args.study);
    let target = target(output.output.as_ref(), &args.study);
    let shard: Shard =
        args.shard.as_deref().map_or(Ok(Shard::WHOLE), str::parse).map_err(Failure::new)?;
    let folder = if args.shard.is_some() { shard_folder(&target, shard) } else { target.clone() };
    // Before anything beats, and once more when all files are known.
    FILES.reads().check_folder(&folder)?;
    if output.force {
        Manifest::of(&folder).check_replaceable(&FILES.reads())?;
    }
    let common = Common::new(&study, read).map_err(Failure::new)?;
    let journal = if output.force {
        Journal::begin_anew(&folder, &study.settings(&common), &FILES.reads())?
    } else {
        Journal::open_beside(&folder, &study.settings(&common), &FILES.reads())?
    };
    let manifest = journal.manifest().unwrap_or_else(|| Manifest::of(&folder));
    let common = common.keeping_traces(&folder, shard)?;
    interrupt::heed_soon("the members under way are given up");
    let threads = Threads::new(args.jobs.map(usize::from))?;
    let members = shard.size(study.values.members());
    let bar = progress::of_members(output.quiet, members, "members");
    let seen = Seen { bar: &bar, quiet: output.quiet };
    let report = run(&study, &common, shard, &journal, &threads, &seen)?;
    interrupt::tidies();
    bar.finish_and_clear();
    if report.stopped {
        print::note(&format!(
            "interrupted: {} of {members} members are done and kept; the same command goes on with the others",
            report.rows.len()
        ));
        return Ok(ExitCode::from(1));
    }
    if args.shard.is_some() {
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
    let answer = Answer::new(&study, &common.units, report.rows);
    finish(&study, &common, &answer, &manifest, &text, output.json)?;
    let took = format!("results in {} ({:.1} s)", target.display(), start.elapsed().as_secs_f64());
    if !output.json {
        print::out(&took)?;
    }
    Ok(ExitCode::from(u8::from(answer.acceptance().failed > 0)))
}

fn merge(args: &StudyMergeArgs) -> Result<ExitCode, Failure> {
    let (text, study) = read_study(&args.study)?;
    let read = beside(&args.study);
    let common = Common::new(&study, read).map_err(Failure::new)?;
    let target = target(args.output.as_ref(), &args.study);
    let failed =
        |error: io::Error| Failure::new(format!("cannot read `{}`: {error}", target.display()));
    let all = study.values.members();
    let manifest = Manifest::of(&target);
    FILES.reads().check_folder(&target)?;
    manifest.check_reads(&FILES.reads())?;
    let mut rows = Vec::new();
    let mut parts: Vec<(Shard, PathBuf)> = Vec::new();
    for entry in std::fs::read_dir(&target).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        if let Some(part) = part_of(&entry.file_name().to_string_lossy())
            && entry.path().is_dir()
        {
            let journal: Journal<Variation> =
                Journal::open(&entry.path(), &study.settings(&common))?;
            let noted = study.noted(part, &journal)?;
            rows.extend(match &common.axes {
                Some(axes) => with_whole_curves(&entry.path(), axes, part, all, noted)?,
                None => noted,
            });
            parts.push((part, entry.path()));
        }
    }
    parts.sort_by_key(|(part, _)| (part.of, part.part));
    let answer = Answer::new(&study, &common.units, rows);
    let is_there = |member| answer.rows().binary_search_by_key(&member, |row| row.member).is_ok();
    let mut missing = (1..=all).filter(|member| !is_there(*member));
    let named: Vec<String> =
        missing.by_ref().take(NAMED).map(|member| member.to_string()).collect();
    if !named.is_empty() {
        let count = named.len() + missing.count();
        let dots = if count > named.len() { ", ..." } else { "" };
        let message = format!(
            "{count} of {all} members are not in the parts in `{}`: {}{dots}",
            target.display(),
            named.join(", ")
        );
        return Err(Failure::new(message)
            .advise("run the parts that are missing: myospring study run --shard i/N"));
    }
    if let Some(axes) = &common.axes {
        let parts: Vec<(Shard, &Path)> =
            parts.iter().map(|(part, folder)| (*part, folder.as_path())).collect();
        merge_traces(&target, axes, all, &parts)?;
    }
    finish(&study, &common, &answer, &manifest, &text, args.json)?;
    if !args.json {
        print::out(&format!("results in {}", target.display()))?;
    }
    Ok(ExitCode::from(u8::from(answer.acceptance().failed > 0)))
}

fn finish(
    study: &ParameterStudy,
    common: &Common,
    answer: &Answer<'_>,
    manifest: &Manifest,
    text: &str,
    as_json: bool,
) -> Result<(), Failure> {
    let (outcome, left_out) = write(study, common, answer, manifest, text)?;
    for warning in &left_out {
        print::warn(warning);
    }
    print::out(&if as_json {
        json::pretty(&outcome)?
    } else {
        words::for_people(study, &outcome)
    })?;
    Ok(())
}

fn figures(args: &StudyFiguresArgs) -> Result<ExitCode, Failure> {
    let (_, study) = read_study(&args.study)?;
    let read = beside(&args.study);
    let common = Common::new(&study, read).map_err(Failure::new)?;
    let target = target(args.output.as_ref(), &args.study);
    let table = target.join(TABLE);
    let named = |cause: &dyn std::fmt::Display| {
        Failure::new(format!("`{}`: {cause}", table.display()))
            .advise("`myospring study run` or `myospring study merge` writes it")
    };
    let rows = FILES.bytes(&table).map_err(|error| named(&error))?;
    let answer = Answer::from_csv(&study, &common.units, &rows).map_err(|error| named(&error))?;
    let sensitivity = answer.sensitivity().unwrap_or_default();
    let manifest = Manifest::of(&target);
    manifest.part(FIGURES).check_reads(&FILES.reads())?;
    let (count, left_out) = draw(&answer, &common, &sensitivity, &manifest)?;
    manifest.settle()?;
    for warning in &left_out {
        print::warn(warning);
    }
    print::out(&format!("{count} figures in {}", target.join(FIGURES).display()))?;
    Ok(ExitCode::SUCCESS)
}

/// What people see of a study while it goes on.
struct Seen<'a> {
    bar: &'a ProgressBar,
    quiet: bool,
}

impl Observer<Variation> for Seen<'_> {
    fn begins(&self, done: usize, members: usize) {
        if !self.quiet && done > 0 {
            print::note(&format!("going on: {done} of {members} members are done"));
        }
        self.bar.inc(done as u64);
    }

    fn damaged(&self, members: usize) {
        print::warn(&damaged(members, "members"));
    }

    fn finished(&self, member: &Variation, rows: &[VariationRow]) -> bool {
        let failed = rows.iter().filter(|row| row.status() == Status::Failed && !self.quiet);
        for row in failed {
            self.bar.suspend(|| print::warn(&format!("member {}: {}", member.name, row.reason)));
        }
        self.bar.inc(1);
        !interrupt::asked()
    }

    fn interruption(&self) -> Interruption {
        interrupt::interruption()
    }

    fn wants_tables(&self) -> bool {
        false
    }
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
