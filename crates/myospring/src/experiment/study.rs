//! A study of parameters: many runs that differ in numbers. A study stores finished members in its
//! folder at once, so that it can continue after an interruption; it writes its files there, too.

mod files;
mod found;
mod page;

pub use files::{FIGURES, TABLE, save};
pub use found::Found;

use super::error::ExperimentError;
use super::files::Files;
use super::observer::Observer;
use super::watched::Watched;
use crate::output::files::Manifest;
use crate::settings::Models;
use crate::study::parameters::{
    Answer, Common, ParameterStudy, Rows, Shard, Variation, VariationRow, merge_traces, run,
    with_whole_curves,
};
use crate::study::{Journal, Threads};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU64;

/// Missing members that are named.
const NAMED: usize = 5;
/// Members of a part that are merged at a time.
const MERGED_AT_ONCE: usize = 1 << 14;

/// A study that was read.
pub struct Study {
    /// Its description, TOML.
    pub text: String,
    /// The same, checked.
    pub parameters: ParameterStudy,
    /// The folder of the description; its files are relative to it.
    folder: PathBuf,
    files: Files,
}

/// Where and how a study is run.
pub struct StudyPlan {
    /// The folder for all parts.
    pub target: PathBuf,
    /// Which part; `None` is the whole.
    pub shard: Option<Shard>,
    /// Members at a time; `None` takes as many as there are cores.
    pub jobs: Option<usize>,
    /// Whether to start again in this folder.
    pub force: bool,
}

/// A study whose folder is open.
pub struct Open<'a> {
    study: &'a Study,
    common: Common,
    shard: Shard,
    jobs: Option<usize>,
    /// The folder of this part.
    pub folder: PathBuf,
    journal: Journal<Variation>,
    manifest: Manifest,
}

/// Members of a study that are done.
pub struct Studied<'a> {
    study: &'a Study,
    common: Common,
    manifest: Manifest,
    rows: Rows,
    /// How many members this part has.
    pub members: usize,
    /// Whether it was stopped before its last member.
    pub interrupted: bool,
}

impl Study {
    /// Reads the description of a study; files in it are named relative to it.
    ///
    /// # Errors
    /// A description that cannot be read or is not possible.
    pub fn read(path: &Path, files: &Files) -> Result<Self, ExperimentError> {
        let text = files.text(path)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let read = |file: &str| files.bytes(folder.join(file));
        let models = Models::default().holding(files.held()).beside(&folder);
        let parameters =
            ParameterStudy::from_toml_knowing(&text, models, read).map_err(|error| {
                ExperimentError::new(format!("`{}`: {error}", path.display()))
                    .advise("`myospring study init` writes a description to start from")
            })?;
        Ok(Self { text, parameters, folder, files: files.clone() })
    }

    fn common(&self) -> Result<Common, ExperimentError> {
        let read = |file: &str| -> io::Result<Vec<u8>> { self.files.bytes(self.folder.join(file)) };
        Common::new(&self.parameters, read).map_err(ExperimentError::new)
    }

    /// Opens the folder of a study, or of a part of it, and simulates the unchanged run.
    ///
    /// # Errors
    /// A folder with other results, and a run that is not possible.
    pub fn open(&self, plan: &StudyPlan) -> Result<Open<'_>, ExperimentError> {
        let shard = plan.shard.unwrap_or(Shard::WHOLE);
        let folder = match plan.shard {
            Some(shard) => shard_folder(&plan.target, shard),
            None => plan.target.clone(),
        };
        // Before any simulation, and again when all files are known.
        self.files.reads().check_folder(&folder)?;
        if plan.force {
            Manifest::of(&folder).check_replaceable(&self.files.reads())?;
        }
        let common = self.common()?;
        let (settings, reads) = (self.parameters.settings(&common), self.files.reads());
        let journal = if plan.force {
            Journal::begin_anew(&folder, &settings, &reads)?
        } else {
            Journal::open_protecting(&folder, &settings, &reads)?
        };
        let manifest = journal.manifest().unwrap_or_else(|| Manifest::of(&folder));
        let common = common.keeping_traces(&folder, shard)?;
        Ok(Open { study: self, common, shard, jobs: plan.jobs, folder, journal, manifest })
    }

    /// Merges the parts in a folder.
    ///
    /// # Errors
    /// Parts that are missing or of another study.
    pub fn merge(&self, target: &Path) -> Result<Studied<'_>, ExperimentError> {
        let (study, common) = (&self.parameters, self.common()?);
        let all = study.values.members();
        let manifest = Manifest::of(target);
        self.files.reads().check_folder(target)?;
        manifest.check_reads(&self.files.reads())?;
        let mut rows = Rows::default();
        let parts = parts(target)?;
        for (part, folder) in &parts {
            let journal: Journal<Variation> = Journal::open(folder, &study.settings(&common))?;
            for members in study.in_turn(*part, MERGED_AT_ONCE) {
                let noted = journal.rows(&members)?;
                rows.extend(match &common.axes {
                    Some(axes) => with_whole_curves(folder, axes, *part, all, noted)?,
                    None => noted,
                });
            }
        }
        let studied =
            Studied { study: self, common, manifest, rows, members: all, interrupted: false };
        studied.check_complete(target)?;
        if let Some(axes) = &studied.common.axes {
            let parts: Vec<(Shard, &Path)> =
                parts.iter().map(|(part, folder)| (*part, folder.as_path())).collect();
            merge_traces(target, axes, all, &parts)?;
        }
        Ok(studied)
    }

    /// Draws the figures of a study again, from its table; returns how many, and what was left out.
    ///
    /// # Errors
    /// No table, or one of another study.
    pub fn draw(&self, target: &Path) -> Result<(usize, Vec<String>), ExperimentError> {
        let common = self.common()?;
        let table = target.join(TABLE);
        let named = |cause: &dyn std::fmt::Display| {
            ExperimentError::new(format!("`{}`: {cause}", table.display()))
                .advise("`myospring study run` or `myospring study merge` writes it")
        };
        let rows = self.files.bytes(&table).map_err(|error| named(&error))?;
        let answer = Answer::from_csv(&self.parameters, &common.units, &rows)
            .map_err(|error| named(&error))?;
        let sensitivity = answer.sensitivity().unwrap_or_default();
        let manifest = Manifest::of(target);
        manifest.part(FIGURES).check_reads(&self.files.reads())?;
        let (figures, left_out) = files::draw(&answer, &common, &sensitivity, &manifest)?;
        manifest.settle()?;
        Ok((figures.len(), left_out))
    }
}

impl<'a> Open<'a> {
    /// How many members this part has.
    pub fn members(&self) -> usize {
        self.shard.size(self.study.parameters.values.members())
    }

    /// Processes every member that is not done.
    ///
    /// # Errors
    ///
    /// Errors of the disk; an error of a member is in its row.
    pub fn run(self, observer: &dyn Observer) -> Result<Studied<'a>, ExperimentError> {
        let (members, threads) = (self.members(), Threads::new(self.jobs)?);
        let Self { study, common, shard, journal, manifest, .. } = self;
        let watched = Watched {
            observer,
            interruption: observer.interruption(),
            words: |member: &Variation, row: &VariationRow| {
                (format!("member {}", member.name), row.reason.clone())
            },
            table: None,
            done: AtomicU64::new(0),
        };
        let report = run(&study.parameters, &common, shard, &journal, &threads, &watched)?;
        let (rows, interrupted) = (report.rows, report.stopped);
        Ok(Studied { study, common, manifest, rows, members, interrupted })
    }
}

impl Studied<'_> {
    /// How many members are done.
    pub fn done(&self) -> usize {
        self.rows.len()
    }

    /// Writes table, description, numbers and figures into the folder of the study; returns the
    /// results, and what was left out.
    ///
    /// # Errors
    ///
    /// A file that cannot be written.
    pub fn write(&mut self) -> Result<(Found<'_>, Vec<String>), ExperimentError> {
        let parameters = &self.study.parameters;
        let answer = Answer::new(parameters, &self.common.units, std::mem::take(&mut self.rows));
        files::write(parameters, &self.common, &answer, &self.manifest, &self.study.text)
    }

    /// Refuses a study with missing members.
    fn check_complete(&self, target: &Path) -> Result<(), ExperimentError> {
        let all = self.members;
        let mut there = vec![false; all];
        for row in self.rows.iter() {
            if let Some(there) = there.get_mut(row.member.wrapping_sub(1)) {
                *there = true;
            }
        }
        let mut missing = (1..=all).filter(|member| !there[member - 1]);
        let named: Vec<String> =
            missing.by_ref().take(NAMED).map(|member| member.to_string()).collect();
        if named.is_empty() {
            return Ok(());
        }
        let count = named.len() + missing.count();
        let dots = if count > named.len() { ", ..." } else { "" };
        let message = format!(
            "{count} of {all} members are not in the parts in `{}`: {}{dots}",
            target.display(),
            named.join(", ")
        );
        Err(ExperimentError::new(message)
            .advise("run the parts that are missing: myospring study run --shard i/N"))
    }
}

fn shard_folder(target: &Path, shard: Shard) -> PathBuf {
    target.join(format!("shard_{}_of_{}", shard.part, shard.of))
}

/// The parts of a study in its folder, in order.
fn parts(target: &Path) -> Result<Vec<(Shard, PathBuf)>, ExperimentError> {
    let failed = |error: io::Error| {
        ExperimentError::new(format!("cannot read `{}`: {error}", target.display()))
    };
    let mut parts = Vec::new();
    for entry in std::fs::read_dir(target).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        if let Some(part) = part_of(&entry.file_name().to_string_lossy())
            && entry.path().is_dir()
        {
            parts.push((part, entry.path()));
        }
    }
    parts.sort_by_key(|(part, _): &(Shard, PathBuf)| (part.of, part.part));
    Ok(parts)
}

/// The part whose folder has this name.
fn part_of(folder: &str) -> Option<Shard> {
    let (part, of) = folder.strip_prefix("shard_")?.split_once("_of_")?;
    format!("{part}/{of}").parse().ok()
}
