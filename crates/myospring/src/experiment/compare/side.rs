//! A run that is compared.

use crate::analysis::beats::Beats;
use crate::compare::factor::Scaled;
use crate::compare::setting;
use crate::experiment::input;
use crate::experiment::{ExperimentError, Files};
use crate::interruption::Interruption;
use crate::mesh::Mesh;
use crate::mesh::carried::Carried;
use crate::mesh::outline::Outline;
use crate::mesh::quality::MeshReport;
use crate::output::figure::{ComparedRun, key_shapes};
use crate::output::files::{MANIFEST, Manifest};
use crate::output::{csv, frames};
use crate::recording::{Frame, Recording};
use crate::run_file::{RunFile, SHAPES};
use crate::settings::{MeshedRun, Run};
use crate::simulation::{InSpace, Outcome as Simulated, Simulation};
use crate::study::sha256;
use std::path::Path;

/// The file that a result folder must have.
const CURVES: &str = "traces.csv";
pub(super) const RUN_FILE: &str = "run.toml";
const RECORD: &str = "run.json";
/// The file that it may have in addition.
const FRAMES: &str = "frames.npz";

/// A run that is compared.
#[derive(Clone)]
pub struct Side {
    /// What it is called.
    pub label: String,
    /// Where it comes from.
    pub source: String,
    /// Every setting.
    pub file: RunFile,
    /// Rounded to the digits of `traces.csv`, whatever its source, so that equal runs are equal.
    pub recording: Recording,
    /// When stimuli fell, ms.
    pub stimuli: Vec<f64>,
    /// The last of them where that is an extra one, S2, ms.
    pub s2_ms: Option<f64>,
    /// The run on its mesh, for the report; `None` if it cannot be meshed as in its run.
    pub(super) shown: Option<Shown>,
    /// Rings of the outline at rest and at peak.
    pub(super) cell: Option<[Vec<Vec<[f64; 2]>>; 2]>,
    /// Of the picture or outline.
    pub(super) shape_sha256: Option<String>,
    /// Numbers of the run that factors have changed.
    pub scaled: Vec<Scaled>,
    /// Why it ended early.
    pub stop: Option<String>,
    pub(super) notes: Vec<String>,
}

/// A run on its mesh.
#[derive(Clone)]
pub(super) struct Shown {
    pub(super) run: Run,
    pub(super) simulation: Simulation,
    /// What the tetrahedra of a thick cell have.
    pub(super) in_space: Option<InSpace>,
    pub(super) report: MeshReport,
    pub(super) outline: Outline,
}

impl Side {
    /// A run that was simulated.
    ///
    /// # Errors
    /// Curves that cannot be written as `traces.csv`.
    pub fn of(
        label: String,
        source: String,
        run: &Run,
        made: &MeshedRun,
        outcome: &Simulated,
        shape_sha256: String,
    ) -> Result<Self, ExperimentError> {
        let stimuli = run.stimulus_times();
        let mut recording = csv::read_traces(&csv::traces(&outcome.recording)?)?;
        recording.frames.clone_from(&outcome.recording.frames);
        recording.in_space.clone_from(&outcome.recording.in_space);
        let stop = outcome.stop.as_ref().map(ToString::to_string);
        Ok(Self {
            source,
            file: run.settled(made.report.spacing_um, outcome.effort.time_step()),
            cell: shapes(&made.simulation.mesh, &made.outline, &recording, &stimuli),
            notes: stop.iter().map(|stop| format!("{label} stopped early: {stop}")).collect(),
            label,
            recording,
            stimuli,
            s2_ms: run.s2_ms(),
            shown: Some(Shown::of(run.clone(), made)),
            shape_sha256: Some(shape_sha256),
            scaled: Vec::new(),
            stop,
        })
    }

    /// Its beats.
    pub(super) fn beats(&self) -> Beats {
        Beats::of(&self.recording, &self.stimuli, self.s2_ms)
    }

    /// The value of a parameter of the cell model and its unit.
    pub(super) fn parameter(&self, name: &str) -> Option<String> {
        let parameters = self.shown.as_ref()?.run.cell.parameters();
        let row = parameters.rows().iter().find(|row| row.name == name)?;
        let text = format!("{} {}", row.value, row.unit);
        Some(setting::shown(Some(text.trim_end())))
    }

    pub(super) fn drawn(&self) -> ComparedRun<'_> {
        let cell = self.cell.as_ref().map(|shapes| shapes.each_ref().map(Vec::as_slice));
        ComparedRun { label: &self.label, recording: &self.recording, cell }
    }
}

/// Refuses a folder without results, and one whose results are not those that the run wrote.
///
/// # Errors
/// What is missing or was changed.
pub fn check_folder(folder: &Path, files: &Files) -> Result<(), ExperimentError> {
    files.note(folder);
    let missing = [RUN_FILE, CURVES].into_iter().find(|name| !folder.join(name).is_file());
    if let Some(name) = missing {
        let message =
            format!("`{}` holds no results of a run: {name} is missing", folder.display());
        return Err(ExperimentError::new(message)
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
            .map_err(|error| ExperimentError::new(error).advise(advice));
    }
    // Written before manifests existed, or copied without one: `run.json` has the hashes.
    let record = record(folder);
    match record["run_file_sha256"].as_str() {
        Some(hash) if hash != sha256(read(&file)?.as_bytes()) => {
            let message = format!(
                "`{}` is not the file that myospring wrote there: it was changed or damaged since, as {RECORD} shows",
                file.display()
            );
            Err(ExperimentError::new(message).advise(advice))
        }
        _ => Ok(()),
    }
}

/// What `run.json` has; nothing where it cannot be read.
fn record(folder: &Path) -> serde_json::Value {
    let text = read(&folder.join(RECORD)).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// The message for runs that name the same picture if its content differed between them.
pub(super) fn other_pictures(sides: &[Side], files: &[&RunFile]) -> Option<String> {
    let file = |at: usize| SHAPES.into_iter().find_map(|key| files[at].get(key).cloned());
    let first = sides.first()?;
    let (_, changed) = sides.iter().enumerate().find(|(at, side)| {
        file(*at).is_some()
            && file(*at) == file(0)
            && side.shape_sha256.is_some()
            && first.shape_sha256.is_some()
            && side.shape_sha256 != first.shape_sha256
    })?;
    Some(format!(
        "the runs {} and {} read their cell from the same file, but the file changed between them",
        first.label, changed.label
    ))
}

/// Reads the results of a folder; `beat` simulates them again where they have no frames.
pub(super) fn of_folder(
    label: &str,
    folder: &Path,
    files: &Files,
    beat: &dyn Fn() -> Result<Side, ExperimentError>,
) -> Result<Side, ExperimentError> {
    let text = read(&folder.join(CURVES))?;
    let mut recording = csv::read_traces(&text).map_err(|error| {
        ExperimentError::new(format!("`{}`: {error}", folder.join(CURVES).display()))
    })?;
    let run_file = folder.join(RUN_FILE);
    let settled = || input::settle(Some(&run_file), &[], files, &Interruption::default());
    let (_, run) = settled()?;
    let stimuli = run.stimulus_times();
    let mut notes = Vec::new();
    let mut shown = None;
    let cell = match frames_of(folder, files) {
        Some(kept) => {
            recording.frames = kept.frames;
            // Meshed again, if its input files still exist and give the same mesh.
            let (_, again) = settled()?;
            let same = |made: &MeshedRun| made.simulation.mesh.points == kept.mesh.points;
            shown = meshed(&again, files).filter(same).map(|made| Shown::of(again, &made));
            outline_of(kept.rings)
                .and_then(|outline| shapes(&kept.mesh, &outline, &recording, &stimuli))
        }
        // Simulated again for its shapes; they are valid if the curves are the same.
        None => match beat() {
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
    let record = record(folder);
    let stop = record["stop"]["message"].as_str().map(str::to_owned);
    notes.extend(doubts(folder, cell.is_some()));
    notes.extend(stop.iter().map(|stop| format!("{label} stopped early: {stop}")));
    Ok(Side {
        label: label.to_owned(),
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

/// What could not be checked in a folder of results.
fn doubts(folder: &Path, is_drawn: bool) -> Vec<String> {
    let mut doubts = Vec::new();
    if !is_drawn {
        doubts.push(format!(
            "the cell of `{}` is not drawn: there is no frames.npz, and its run.toml does not reproduce its curves; \
            --outputs frames writes frames.npz",
            folder.display()
        ));
    }
    if !Manifest::of(folder).is_there() {
        doubts.push(format!(
            "whether {CURVES} in `{}` is as its run wrote it is not known: there is no {MANIFEST}",
            folder.display()
        ));
    }
    doubts
}

fn read(path: &Path) -> Result<String, ExperimentError> {
    std::fs::read_to_string(path).map_err(|error| ExperimentError::unread(path, &error))
}

impl Shown {
    fn of(run: Run, made: &MeshedRun) -> Self {
        let MeshedRun { simulation, report, outline, .. } = made;
        Self {
            run,
            simulation: simulation.clone(),
            in_space: simulation.in_space(),
            report: report.clone(),
            outline: outline.clone(),
        }
    }
}

/// A run on its mesh, where what it is made of is there.
fn meshed(run: &Run, files: &Files) -> Option<MeshedRun> {
    let shaped = run.shape.mesh(&run.shape.bytes(|file| files.bytes(file)).ok()?).ok()?;
    run.make(shaped, |file| files.bytes(file)).ok()
}

/// The frames that a run has kept, where it has.
fn frames_of(folder: &Path, files: &Files) -> Option<frames::SavedFrames> {
    frames::read(&files.bytes(folder.join(FRAMES)).ok()?).ok()?
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
