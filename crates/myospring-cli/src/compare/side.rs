//! A run that is compared: beaten now, or read from its results.

use super::Told;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input::{self, Input};
use crate::interrupt;
use crate::options::Given;
use indicatif::ProgressBar;
use myospring::compare::factor::{self, Factor, Scaled};
use myospring::compare::setting;
use myospring::mesh::Mesh;
use myospring::mesh::carried::Carried;
use myospring::mesh::outline::Outline;
use myospring::mesh::quality::MeshReport;
use myospring::output::figure::{Compared, key_shapes};
use myospring::output::files::{MANIFEST, Manifest};
use myospring::output::{csv, frames};
use myospring::recording::{Frame, Recording};
use myospring::run_file::RunFile;
use myospring::settings::{Made, Run};
use myospring::study::sha256;
use std::path::{Path, PathBuf};

/// What a whole run counts on the progress bar.
pub(super) const PROGRESS: u64 = 1000;

/// What a result folder has to hold.
const CURVES: &str = "traces.csv";
const RUN_FILE: &str = "run.toml";
const RECORD: &str = "run.json";
/// What it may hold beside them.
const FRAMES: &str = "frames.npz";

/// A run to be.
pub(super) struct Job {
    pub(super) label: String,
    /// Results to read instead of running.
    pub(super) folder: Option<PathBuf>,
    /// Run file, picture or outline; the built-in cell without one.
    pub(super) path: Option<PathBuf>,
    pub(super) overrides: Vec<Given>,
    pub(super) factors: Vec<Factor>,
}

/// A run that is there.
pub(super) struct Side {
    pub(super) label: String,
    pub(super) source: String,
    /// Every setting.
    pub(super) file: RunFile,
    /// To the digits of `traces.csv`, wherever it comes from, so that equal runs are equal.
    pub(super) recording: Recording,
    pub(super) stimuli: Vec<f64>,
    /// The last of them where that is an extra one, S2, ms.
    pub(super) s2_ms: Option<f64>,
    /// Its run on its mesh, for the report; `None` where it cannot be meshed as it was.
    pub(super) shown: Option<Shown>,
    /// Rings of the outline at rest and at peak.
    cell: Option<[Vec<Vec<[f64; 2]>>; 2]>,
    /// Of the picture or outline.
    shape_sha256: Option<String>,
    scaled: Vec<Scaled>,
    pub(super) stop: Option<String>,
    pub(super) notes: Vec<String>,
}

/// A run on its mesh.
pub(super) struct Shown {
    pub(super) run: Run,
    pub(super) mesh: Mesh,
    pub(super) report: MeshReport,
    pub(super) outline: Outline,
    pub(super) fibres: Vec<[f64; 2]>,
    pub(super) content: Option<Vec<f64>>,
}

impl Side {
    pub(super) fn told(&self) -> Told<'_> {
        Told {
            label: &self.label,
            source: &self.source,
            scaled: &self.scaled,
            stop: self.stop.as_deref(),
        }
    }

    /// The value of a parameter of the cell model and its unit.
    pub(super) fn parameter(&self, name: &str) -> Option<String> {
        let parameters = self.shown.as_ref()?.run.cell.parameters();
        let row = parameters.rows().iter().find(|row| row.name == name)?;
        let text = format!("{} {}", row.value, row.unit);
        Some(setting::shown(Some(text.trim_end())))
    }

    pub(super) fn compared(&self) -> Compared<'_> {
        let cell = self.cell.as_ref().map(|shapes| shapes.each_ref().map(Vec::as_slice));
        Compared { label: &self.label, recording: &self.recording, cell }
    }
}

/// Refuses a folder without results, and one whose results are not those that the run wrote.
pub(super) fn check_folder(folder: &Path) -> Result<(), Failure> {
    FILES.note(folder);
    let missing = [RUN_FILE, CURVES].into_iter().find(|name| !folder.join(name).is_file());
    if let Some(name) = missing {
        let message =
            format!("`{}` holds no results of a run: {name} is missing", folder.display());
        return Err(Failure::new(message)
            .advise("give a folder that myospring run has written, or a run file"));
    }
    let file = folder.join(RUN_FILE);
    let advice = format!("`myospring run {}` makes the results anew", file.display());
    let manifest = Manifest::of(folder);
    if manifest.is_there() {
        let check = |name| manifest.check_unchanged(name);
        return [CURVES, RUN_FILE, RECORD, FRAMES]
            .into_iter()
            .try_for_each(check)
            .map_err(|error| Failure::new(error).advise(advice));
    }
    // Written before there were manifests, or copied without it: what run.json knows.
    let record = record(folder);
    match record["run_file_sha256"].as_str() {
        Some(hash) if hash != sha256(read(&file)?.as_bytes()) => {
            let message = format!(
                "`{}` is not the file that myospring wrote there: it was changed or damaged since, as {RECORD} shows",
                file.display()
            );
            Err(Failure::new(message).advise(advice))
        }
        _ => Ok(()),
    }
}

/// What `run.json` has; nothing where it cannot be read.
fn record(folder: &Path) -> serde_json::Value {
    let text = read(&folder.join(RECORD)).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// What to say where runs name one picture, but it was another then.
pub(super) fn other_pictures(sides: &[Side]) -> Option<String> {
    let file = |side: &Side| {
        ["shape.picture", "shape.outline"].into_iter().find_map(|key| side.file.get(key).cloned())
    };
    let first = sides.first()?;
    let changed = sides.iter().find(|side| {
        file(side).is_some()
            && file(side) == file(first)
            && side.shape_sha256.is_some()
            && first.shape_sha256.is_some()
            && side.shape_sha256 != first.shape_sha256
    })?;
    Some(format!(
        "the runs {} and {} name one file as their cell, but it was another one then",
        first.label, changed.label
    ))
}

impl Job {
    /// Reads the results or beats the cell.
    pub(super) fn side(self, bar: &ProgressBar) -> Result<Side, Failure> {
        let Some(folder) = self.folder.clone() else { return self.beaten(bar) };
        let text = read(&folder.join(CURVES))?;
        let mut recording = csv::read_traces(&text).map_err(|error| {
            Failure::new(format!("`{}`: {error}", folder.join(CURVES).display()))
        })?;
        let (_, run) = input::settle(Some(&folder.join(RUN_FILE)), &[])?;
        let stimuli = run.stimulus_times();
        let mut notes = Vec::new();
        let mut shown = None;
        let cell = match frames_of(&folder) {
            Some(kept) => {
                recording.frames = kept.frames;
                // Meshed again, where what it was made of is still there and gives the same.
                let (_, again) = input::settle(Some(&folder.join(RUN_FILE)), &[])?;
                let same = |made: &Made| made.simulation.mesh.points == kept.mesh.points;
                shown = meshed(&again).filter(same).map(|made| Shown::of(again, made));
                outline_of(kept.rings)
                    .and_then(|outline| shapes(&kept.mesh, &outline, &recording, &stimuli))
            }
            // Beaten again for its shapes, which are its own where the curves are.
            None => match self.beaten(bar) {
                Ok(again) if csv::traces(&again.recording).is_ok_and(|traces| traces == text) => {
                    shown = again.shown;
                    recording.frames = again.recording.frames;
                    again.cell
                }
                Ok(_) => None,
                Err(failure) => {
                    notes.push(format!("{}: {failure}", folder.display()));
                    None
                }
            },
        };
        if cell.is_none() {
            notes.push(format!(
                "the cell of `{}` is not drawn: there is no frames.npz, and its run.toml does not give the same \
                 curves again; --outputs frames keeps the frames",
                folder.display()
            ));
        }
        bar.inc(PROGRESS);
        let record = record(&folder);
        if !Manifest::of(&folder).is_there() {
            notes.push(format!(
                "whether {CURVES} in `{}` is as its run wrote it is not known: there is no {MANIFEST}",
                folder.display()
            ));
        }
        let stop = record["stop"]["message"].as_str().map(str::to_owned);
        notes.extend(stop.iter().map(|stop| format!("{} stopped early: {stop}", self.label)));
        Ok(Side {
            label: self.label,
            source: folder.display().to_string(),
            file: run.to_run_file(),
            recording,
            stimuli,
            s2_ms: run.s2_ms(),
            shown,
            cell,
            shape_sha256: record["shape_sha256"].as_str().map(str::to_owned),
            scaled: Vec::new(),
            stop,
            notes,
        })
    }

    /// The run that is to be beaten, with its factors.
    pub(super) fn run(&self) -> Result<(String, Run, Vec<Scaled>), Failure> {
        let (name, mut run) = input::settle(self.path.as_deref(), &self.overrides)?;
        let scaled = factor::scale(&mut run, &self.factors)
            .map_err(|error| Failure::new(format!("{}: {error}", self.label)))?;
        Ok((name, run, scaled))
    }

    fn beaten(&self, bar: &ProgressBar) -> Result<Side, Failure> {
        let path = self.path.as_deref();
        let (name, run, scaled) = self.run()?;
        let Input { mut run, bytes, shaped, .. } = input::mesh(name, run, None)?;
        let mut made = run.make(shaped, |file| FILES.bytes(file))?;
        run.fibre = made.fibres.taken;
        // One thread each: the runs go side by side.
        made.simulation.numerics.engine.threads = 1;
        let prepared = made.simulation.build()?;
        let mut done = 0;
        let outcome = prepared.run(|progress| {
            let now = (PROGRESS as f64 * progress.time / progress.duration.max(1e-9)) as u64;
            bar.inc(now.saturating_sub(done));
            done = done.max(now);
            !interrupt::asked()
        });
        let stimuli = run.stimulus_times();
        let file = run.settled(made.report.spacing_um, outcome.effort.time_step());
        let mut recording = csv::read_traces(&csv::traces(&outcome.recording)?)?;
        recording.frames = outcome.recording.frames;
        let cell = shapes(&made.simulation.mesh, &made.outline, &recording, &stimuli);
        let stop = outcome.stop.as_ref().map(ToString::to_string);
        let notes = stop.iter().map(|stop| format!("{} stopped early: {stop}", self.label));
        let built_in = || run.shape.name().to_owned();
        Ok(Side {
            label: self.label.clone(),
            source: path.map_or_else(built_in, |path| path.display().to_string()),
            file,
            recording,
            stimuli,
            s2_ms: run.s2_ms(),
            shown: Some(Shown::of(run, made)),
            cell,
            shape_sha256: Some(sha256(&bytes.shape)),
            scaled,
            notes: notes.collect(),
            stop,
        })
    }
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| Failure::unread(path, &error))
}

impl Shown {
    fn of(run: Run, made: Made) -> Self {
        let Made { simulation, report, outline, .. } = made;
        let (mesh, fibres, content) =
            (simulation.mesh, simulation.fibres, simulation.myofibril_content);
        Self { run, mesh, report, outline, fibres, content }
    }
}

/// A run on its mesh, where what it is made of is there.
fn meshed(run: &Run) -> Option<Made> {
    let shaped = run.shape.mesh(&run.shape.bytes(|file| FILES.bytes(file)).ok()?).ok()?;
    run.make(shaped, |file| FILES.bytes(file)).ok()
}

/// The frames that a run has kept, where it has.
fn frames_of(folder: &Path) -> Option<frames::Kept> {
    frames::read(&FILES.bytes(folder.join(FRAMES)).ok()?).ok()?
}

/// An outline of its rings, the rim first.
fn outline_of(mut rings: Vec<Vec<[f64; 2]>>) -> Option<Outline> {
    let exterior = (!rings.is_empty()).then(|| rings.remove(0))?;
    Outline::new(exterior, rings).ok()
}

/// Rings of the outline at rest and at the peak of the first beat; `None` where the run did not get that far.
fn shapes(
    mesh: &Mesh,
    outline: &Outline,
    recording: &Recording,
    stimuli: &[f64],
) -> Option<[Vec<Vec<[f64; 2]>>; 2]> {
    let moments = key_shapes(recording, stimuli);
    let peak = moments.iter().find(|moment| moment.name == "peak")?;
    let rings = Carried::rings(mesh, outline);
    let at = |frame: &Frame| rings.iter().map(|ring| ring.at(&frame.positions)).collect();
    Some([at(moments.first()?.frame), at(peak.frame)])
}
