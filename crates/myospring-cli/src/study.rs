//! `myospring study`: many runs that differ in numbers.

use crate::args::{StudyArgs, StudyCommand, StudyInitArgs, StudyMergeArgs, StudyRunArgs};
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::table::{aligned, number};
use crate::{interrupt, print, progress};
use indicatif::ProgressBar;
use myospring::output::figure::{self, Bar, Ranking};
use myospring::output::{files, json};
use myospring::study::parameters::{
    Acceptance, Answer, Common, ParameterStudy, Ranked, Sensitivity, Shard, Variation,
    VariationRow, run,
};
use myospring::study::sensitivity::Index;
use myospring::study::{Cause, Journal, Observer, Row as _, Status, Threads};
use serde::Serialize;
use std::fmt::Write as _;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What stays to be written anew.
const RESULTS: [&str; 6] = [
    "members.csv",
    "members.parquet",
    "study.toml",
    "study.json",
    "figures/sensitivity.svg",
    "figures/sensitivity.png",
];
/// Resolution of PNG, dots per inch.
const DPI: f64 = 300.0;
/// Bars of a figure, and rows of a table, for each metric.
const SHOWN: usize = 10;
/// Missing members that are named.
const NAMED: usize = 5;

const TEMPLATE: &str = include_str!("study/template.toml");

pub(crate) fn study(args: &StudyArgs) -> Result<ExitCode, Failure> {
    match &args.command {
        StudyCommand::Run(args) => begin(args),
        StudyCommand::Merge(args) => merge(args),
        StudyCommand::Init(args) => init(args),
    }
}

/// study.json.
#[derive(Serialize)]
struct Outcome<'a> {
    title: &'a str,
    members: usize,
    #[serde(flatten)]
    acceptance: Acceptance,
    /// Metrics of the run without any change.
    usual: Vec<Usual<'a>>,
    sensitivity: Vec<Sensitivity>,
}

#[derive(Serialize)]
struct Usual<'a> {
    metric: &'a str,
    value: Option<f64>,
    unit: &'a str,
}

fn read_study(path: &Path) -> Result<(String, ParameterStudy), Failure> {
    let named =
        |cause: &dyn std::fmt::Display| Failure::new(format!("`{}`: {cause}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| named(&error))?;
    let study = ParameterStudy::from_toml(&text, beside(path)).map_err(|error| {
        named(&error).advise("`myospring study init` writes a description to start from")
    })?;
    Ok((text, study))
}

/// Reads files as a description names them: beside it.
fn beside(path: &Path) -> impl Fn(&str) -> io::Result<Vec<u8>> + Sync {
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    move |file: &str| std::fs::read(folder.join(file))
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

fn begin(args: &StudyRunArgs) -> Result<ExitCode, Failure> {
    let (start, output) = (Instant::now(), &args.output);
    let (text, study) = read_study(&args.study)?;
    let read = beside(&args.study);
    let common = Common::new(&study, &read).map_err(Failure::new)?;
    let target = target(output.output.as_ref(), &args.study);
    let shard: Shard =
        args.shard.as_deref().map_or(Ok(Shard::WHOLE), str::parse).map_err(Failure::new)?;
    let folder = if args.shard.is_some() { shard_folder(&target, shard) } else { target.clone() };
    let journal = if output.force {
        Journal::begin_anew(&folder, &study.settings(), &RESULTS)?
    } else {
        Journal::open(&folder, &study.settings())?
    };
    interrupt::heed("the members under way are finished and kept");
    let threads = Threads::new(args.jobs.map(usize::from))?;
    let members = study.members(shard).len();
    let bar = progress::of_members(output.quiet, members, "members");
    let seen = Seen { bar: &bar, quiet: output.quiet };
    let report = run(&common, shard, &journal, &threads, &seen)?;
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
    finish(&study, &common, &answer, &target, &text, output.json)?;
    let took = format!("results in {} ({:.1} s)", target.display(), start.elapsed().as_secs_f64());
    if !output.json {
        print::out(&took)?;
    }
    Ok(ExitCode::from(u8::from(answer.acceptance().failed > 0)))
}

fn merge(args: &StudyMergeArgs) -> Result<ExitCode, Failure> {
    let (text, study) = read_study(&args.study)?;
    let read = beside(&args.study);
    let common = Common::new(&study, &read).map_err(Failure::new)?;
    let target = target(args.output.as_ref(), &args.study);
    let failed =
        |error: io::Error| Failure::new(format!("cannot read `{}`: {error}", target.display()));
    let all = study.members(Shard::WHOLE);
    let mut rows = Vec::new();
    for entry in std::fs::read_dir(&target).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        if entry.file_name().to_string_lossy().starts_with("shard_") && entry.path().is_dir() {
            let journal: Journal<Variation> = Journal::open(&entry.path(), &study.settings())?;
            rows.extend(journal.rows(&all));
        }
    }
    let answer = Answer::new(&study, &common.units, rows);
    let mut missing = all.iter().filter(|member| {
        answer.rows().binary_search_by_key(&member.number, |row| row.member).is_err()
    });
    let named: Vec<&str> =
        missing.by_ref().take(NAMED).map(|member| member.name.as_str()).collect();
    if !named.is_empty() {
        let count = named.len() + missing.count();
        let dots = if count > named.len() { ", ..." } else { "" };
        let message = format!(
            "{count} of {} members are not in the parts in `{}`: {}{dots}",
            all.len(),
            target.display(),
            named.join(", ")
        );
        return Err(Failure::new(message)
            .advise("run the parts that are missing: myospring study run --shard i/N"));
    }
    finish(&study, &common, &answer, &target, &text, args.json)?;
    if !args.json {
        print::out(&format!("results in {}", target.display()))?;
    }
    Ok(ExitCode::from(u8::from(answer.acceptance().failed > 0)))
}

fn finish(
    study: &ParameterStudy,
    common: &Common<'_>,
    answer: &Answer<'_>,
    target: &Path,
    text: &str,
    as_json: bool,
) -> Result<(), Failure> {
    let table = answer.table();
    files::write(&target.join(RESULTS[0]), table.to_csv()?)?;
    files::write(&target.join(RESULTS[1]), table.to_parquet().map_err(Failure::new)?)?;
    files::write(&target.join(RESULTS[2]), text)?;
    let sensitivity = match answer.sensitivity() {
        Ok(sensitivity) => sensitivity,
        Err(error) => {
            print::warn(&error.to_string());
            Vec::new()
        }
    };
    let usual = study.metrics.iter().zip(&common.usual).zip(&common.units);
    let outcome = Outcome {
        title: &study.title,
        members: study.values.len(),
        acceptance: answer.acceptance(),
        usual: usual.map(|((metric, &value), unit)| Usual { metric, value, unit }).collect(),
        sensitivity,
    };
    files::write(&target.join(RESULTS[3]), json::pretty(&outcome)?)?;
    if !outcome.sensitivity.is_empty() {
        let rankings: Vec<Ranking> = outcome.sensitivity.iter().map(ranking).collect();
        match figure::rankings(&rankings)
            .and_then(|figure| Ok((figure.to_svg(), figure.to_png(DPI)?)))
        {
            Ok((svg, png)) => {
                files::create_folder(&target.join("figures"))?;
                files::write(&target.join(RESULTS[4]), svg)?;
                files::write(&target.join(RESULTS[5]), png)?;
            }
            Err(error) => print::warn(&format!("figure sensitivity is left out: {error}")),
        }
    }
    print::out(&if as_json { json::pretty(&outcome)? } else { for_people(study, &outcome) })?;
    Ok(())
}

fn short(key: &str) -> &str {
    key.rsplit_once('.').map_or(key, |(_, name)| name)
}

fn words(metric: &str) -> String {
    metric.replace('_', " ")
}

fn ranking(one: &Sensitivity) -> Ranking {
    let bars = one.parameters.iter().take(SHOWN).map(|ranked| Bar {
        name: short(ranked.parameter()).to_owned(),
        value: ranked.rank().value.max(0.0),
        confidence: ranked.rank().confidence,
        alone: match ranked {
            Ranked::Sobol { first, .. } => Some(first.value.max(0.0)),
            Ranked::Morris { .. } => None,
        },
    });
    let axis = match one.parameters.first() {
        Some(Ranked::Morris { .. }) => format!("mean effect ({})", one.unit),
        _ => "part of the variance".to_owned(),
    };
    Ranking { title: words(&one.metric), axis, bars: bars.collect() }
}

fn for_people(study: &ParameterStudy, outcome: &Outcome<'_>) -> String {
    let Acceptance { beat, kept, failed } = outcome.acceptance;
    let mut text = format!("{} members: {beat} beat", outcome.members);
    if failed > 0 {
        let _ = write!(text, ", {failed} failed (the column reason says why)");
    }
    if !study.keep.is_empty() {
        let share = 100.0 * kept as f64 / outcome.members.max(1) as f64;
        let _ = write!(text, ", {kept} kept ({share:.1} % of all)");
    }
    text.push('\n');
    for one in &outcome.sensitivity {
        let _ = writeln!(text, "\n{}", words(&one.metric));
        let unit = |what: &str| format!("{what} ({})", one.unit);
        let mut rows = vec![match one.parameters.first() {
            Some(Ranked::Morris { .. }) => {
                let sizes = ["mean size of effect", "mean", "spread"].map(unit);
                ["parameter".to_owned()].into_iter().chain(sizes).collect()
            }
            _ => ["parameter", "alone", "with all interactions"].map(str::to_owned).to_vec(),
        }];
        let with = |index: Index| format!("{:.3} +- {:.3}", index.value, index.confidence);
        rows.extend(one.parameters.iter().take(SHOWN).map(|ranked| {
            let name = short(ranked.parameter()).to_owned();
            match ranked {
                Ranked::Sobol { first, total, .. } => vec![name, with(*first), with(*total)],
                Ranked::Morris { mean_size, mean, spread, .. } => {
                    vec![name, with(*mean_size), number(*mean), number(*spread)]
                }
            }
        }));
        text.push_str(&aligned(&rows, &[1, 2, 3]));
        if one.left_out > 0 {
            let all = one.used + one.left_out;
            let _ = writeln!(
                text,
                "{} of {all} groups of members are left out, since one failed or has no such metric",
                one.left_out
            );
        }
    }
    text
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

    fn finished(&self, member: &Variation, rows: &[VariationRow]) -> bool {
        let failed = rows.iter().filter(|row| row.status() == Status::Failed && !self.quiet);
        for row in failed {
            self.bar.suspend(|| print::warn(&format!("member {}: {}", member.name, row.reason)));
        }
        self.bar.inc(1);
        !interrupt::asked()
    }

    fn table(&self, _rows: &[VariationRow]) -> Result<(), Cause> {
        Ok(())
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
    files::write(path, TEMPLATE)?;
    print::note(&format!("wrote {0}; try: myospring study run {0}", path.display()));
    Ok(ExitCode::SUCCESS)
}
