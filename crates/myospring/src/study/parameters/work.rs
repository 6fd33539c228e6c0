//! The work on members: whole beats, or cells side by side.

use super::super::{Cause, Interrupted, Journal, StudyError};
use super::alone::{self, Wanted};
use super::cell_metrics;
use super::description::{CountedBeat, MemberKind, ParameterStudy, Varied, run_of};
use super::error::ParameterStudyError;
use super::member::{Variation, VariationRow};
use super::shard::Shard;
use super::traces::{TraceAxes, Traces};
use crate::analysis::beats::{Beats, known};
use crate::cell::batch;
use crate::integrate::Method;
use crate::integrate::quasi_static::Tolerance;
use crate::interruption::Interruption;
use crate::mesh::Mesh;
use crate::mesh::thick::Thick;
use crate::output::files::FileError;
use crate::recording::Sample;
use crate::run_file::RunFile;
use crate::settings::{Places, Run, ShapeBytes, Shaped};
use crate::simulation::{Outcome, Ready, SharedPath, Simulation, StopReason};
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// What all members of a study have in common, made once.
pub struct Common {
    kind: MemberKind,
    run: RunFile,
    varied: Vec<Varied>,
    metrics: Vec<String>,
    beat: CountedBeat,
    files: BTreeMap<String, Vec<u8>>,
    /// Units of the metrics, in their order.
    pub units: Vec<&'static str>,
    /// The metrics of the unchanged run, in their order; empty until it was simulated.
    pub usual: Vec<Option<f64>>,
    /// The axes of the members' stored curves; `None` if none are stored.
    pub axes: Option<TraceAxes>,
    /// The curves of the run without any change, quantity by quantity.
    pub usual_curves: Vec<f32>,
    /// How many members the study has.
    members: usize,
    traces: Option<Traces>,
    /// Curves by member for the caller to store.
    handed: Option<Mutex<BTreeMap<usize, Vec<f32>>>>,
    /// Whether cells return metrics of beats without samples, so that many take little time.
    pub(super) tells_beats: bool,
    body: Option<Body>,
}

/// A finished member, and its curves if requested.
type Done = (VariationRow, Vec<f32>);

/// What the beats have in common.
struct Body {
    bytes: ShapeBytes,
    /// The shape that was meshed, if all members share it.
    shaped: Option<Shaped>,
    /// The mesh with its fibres, if all members share them, too.
    meshed: Option<Meshed>,
    /// Whether members differ only in the course of tension, so that they share their equilibria.
    shares_path: bool,
    path: Mutex<Option<Result<Arc<SharedPath>, String>>>,
}

struct Meshed {
    mesh: Mesh,
    thick: Option<Arc<Thick>>,
    places: Places,
}

/// Keys of numbers that change only the course of tension.
const TENSION_ONLY: [&str; 3] = ["cell.", "stimulus.", "run."];
/// Keys of numbers that decide the mesh.
const SHAPING: [&str; 2] = ["shape.", "segmentation."];
/// Keys of numbers that decide the fibres on it, and how its cells are coupled.
const FIBRES: [&str; 5] = [
    "mechanics.fibre",
    "mechanics.helix_angle",
    "mechanics.myofibril_content",
    "mechanics.sarcomere_",
    "tissue.",
];

impl Common {
    /// Prepares what members share, and simulates the unchanged run. `read` reads a file by its
    /// name as written.
    ///
    /// # Errors
    /// A shape that cannot be made, a run that cannot be simulated, or a metric that it does not
    /// have.
    pub fn new(
        study: &ParameterStudy,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Self, ParameterStudyError> {
        let mut common = Self::still(study, read, None)?;
        let run = common.run.resolve()?;
        let usual = common.varied.iter().map(|varied| varied.number.get(&run).unwrap_or(f64::NAN));
        let usual = Variation::new(0, usual.collect());
        let row = match common.kind {
            MemberKind::Cell => common.cells(&[&usual], &study.interruption).remove(0),
            MemberKind::Beat => common.beat(None, &study.interruption),
        };
        let (row, curves) = row.map_err(|error| ParameterStudyError::Base(error.to_string()))?;
        (common.usual, common.usual_curves) = (row.metrics, curves);
        Ok(common)
    }

    /// As [`Common::new`], without a simulation: [`Common::usual`] stays empty. `shaped` is the
    /// shape of the run, if it is already meshed.
    ///
    /// # Errors
    /// A shape that cannot be made, or a metric that beats do not have.
    pub fn still(
        study: &ParameterStudy,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
        shaped: Option<&Shaped>,
    ) -> Result<Self, ParameterStudyError> {
        let run = study.run.resolve()?.interrupted_by(&study.interruption);
        let at_rest = run.cell.initial_state();
        let in_mv = run.cell.membrane_potential_mv(&at_rest).is_some();
        let quantities = match study.kind {
            MemberKind::Cell => cell_metrics::quantities(&*run.cell),
            MemberKind::Beat => of_runs(&run),
        };
        let mut common = Self {
            kind: study.kind,
            run: study.run.clone(),
            varied: study.varied.clone(),
            metrics: study.metrics.clone(),
            beat: study.beat,
            files: BTreeMap::new(),
            units: Vec::new(),
            usual: Vec::new(),
            axes: study.traces.then(|| TraceAxes::new(run.duration, quantities)),
            usual_curves: Vec::new(),
            members: study.values.members(),
            traces: None,
            handed: None,
            tells_beats: batch::tells_beats(&*run.cell, run.cell_settings()),
            body: None,
        };
        let units: Vec<(&str, &str)> = match study.kind {
            MemberKind::Cell => {
                common.check_cells(&run)?;
                let files = Mutex::new(BTreeMap::new());
                let driven = run.driven(|path| {
                    let bytes = read(path)?;
                    let mut files = files.lock().unwrap_or_else(PoisonError::into_inner);
                    files.insert(path.to_owned(), bytes.clone());
                    Ok(bytes)
                });
                driven.map_err(|error| ParameterStudyError::Base(error.to_string()))?;
                common.files = files.into_inner().unwrap_or_else(PoisonError::into_inner);
                cell_metrics::metrics(&run)
            }
            MemberKind::Beat => {
                // A metric that this cell does not have is missing in all its beats.
                known(in_mv).iter().map(|metric| (metric.name, metric.unit)).collect()
            }
        };
        let unit = |name: &String| {
            let unit = units.iter().find(|(known, _)| known == name).map(|(_, unit)| *unit);
            unit.ok_or_else(|| ParameterStudyError::Metric {
                place: if study.keep.contains_key(name) { "[keep]" } else { "metrics" },
                name: name.clone(),
                known: units.iter().map(|(name, _)| *name).collect(),
            })
        };
        common.units = study.metrics.iter().map(unit).collect::<Result<_, _>>()?;
        if study.kind == MemberKind::Beat {
            common.share(&run, read, shaped)?;
        }
        Ok(common)
    }

    /// Stores the curves of the members of a part in a folder, if the study requests them:
    /// [`TRACES`](super::TRACES).
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn keeping_traces(self, folder: &Path, part: Shard) -> Result<Self, StudyError> {
        let Some(axes) = &self.axes else { return Ok(self) };
        let members = (self.members + part.of - part.part) / part.of;
        let traces = Some(Traces::open(folder, axes, part, members)?);
        Ok(Self { traces, ..self })
    }

    /// Returns the curves of members, if the study requests them, for the caller to store:
    /// [`Common::handed`].
    #[must_use]
    pub fn handing_on(self) -> Self {
        Self { handed: Some(Mutex::default()), ..self }
    }

    /// The curves of a finished member, returned once; empty if there are none.
    pub fn handed(&self, member: usize) -> Vec<f32> {
        let Some(handed) = &self.handed else { return Vec::new() };
        let mut handed = handed.lock().unwrap_or_else(PoisonError::into_inner);
        handed.remove(&member).unwrap_or_default()
    }

    /// Stores curves that were computed elsewhere, empty ones for members without curves; returns
    /// the values for [`VariationRow::curves`].
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn keep(
        &self,
        members: &[&Variation],
        curves: &[Vec<f32>],
    ) -> Result<Vec<String>, StudyError> {
        let none = vec![String::new(); members.len()];
        let Some(traces) = &self.traces else { return Ok(none) };
        match (traces.keep(members, curves), traces.failure()) {
            (_, Some(error)) => Err(error.into()),
            (hashes, None) => Ok(hashes.unwrap_or(none)),
        }
    }

    /// Marks members of a journal as not done if their curves on the disk are not those that were
    /// recorded.
    ///
    /// # Errors
    /// Curves or a journal that cannot be read.
    pub fn check_curves(
        &self,
        members: &[Variation],
        journal: &Journal<Variation>,
    ) -> Result<(), StudyError> {
        let Some(traces) = &self.traces else { return Ok(()) };
        let by_number: BTreeMap<usize, &Variation> =
            members.iter().map(|member| (member.number, member)).collect();
        let mut damaged = Vec::new();
        for row in journal.rows(members)? {
            if let Some(member) = by_number.get(&row.member)
                && !traces.has(&row)?
            {
                damaged.push(*member);
            }
        }
        journal.forget(damaged)
    }

    /// Why curves were not stored.
    pub(super) fn failure(&self) -> Option<FileError> {
        self.traces.as_ref()?.failure()
    }

    /// The rows of members, after their curves are stored.
    fn kept(
        &self,
        members: &[&Variation],
        mut done: Vec<Result<Done, Cause>>,
    ) -> Vec<Result<VariationRow, Cause>> {
        if let Some(traces) = &self.traces {
            let curves = |done: &Result<Done, Cause>| {
                done.as_ref().map_or_else(|_| Vec::new(), |(_, curves)| curves.clone())
            };
            let curves: Vec<Vec<f32>> = done.iter().map(curves).collect();
            let Ok(hashes) = traces.keep(members, &curves) else {
                return members.iter().map(|_| Err(Interrupted.into())).collect();
            };
            for (done, hash) in done.iter_mut().zip(hashes) {
                if let Ok((row, _)) = done {
                    row.curves = hash;
                }
            }
        }
        if let Some(handed) = self.handed.as_ref().filter(|_| self.axes.is_some()) {
            let mut handed = handed.lock().unwrap_or_else(PoisonError::into_inner);
            let curves = done.iter().flatten().map(|(row, curves)| (row.member, curves.clone()));
            handed.extend(curves);
        }
        done.into_iter().map(|done| done.map(|(row, _)| row)).collect()
    }

    /// The kind of members.
    pub fn kind(&self) -> MemberKind {
        self.kind
    }

    /// The bytes of every file that the members need, by its name as written.
    pub fn files(&self) -> &BTreeMap<String, Vec<u8>> {
        &self.files
    }

    fn check_cells(&self, run: &Run) -> Result<(), ParameterStudyError> {
        let no = |what: &str| Err(ParameterStudyError::NoCell { what: what.to_owned() });
        if run.steady_state.is_some() {
            return no("it starts from the model's initial state, not from steady_state");
        }
        match self.keys().find(|key| !starts(key, &TENSION_ONLY)) {
            Some(key) => no(&format!("`{key}` belongs to the mesh")),
            None => Ok(()),
        }
    }

    fn keys(&self) -> impl Iterator<Item = &str> {
        self.varied.iter().map(|varied| varied.number.key.as_str())
    }

    /// Prepares the shape and the mesh, as far as all members share them.
    fn share(
        &mut self,
        run: &Run,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
        shaped: Option<&Shaped>,
    ) -> Result<(), ParameterStudyError> {
        let files = Mutex::new(BTreeMap::new());
        let read = |path: &str| {
            let bytes = read(path)?;
            let mut files = files.lock().unwrap_or_else(PoisonError::into_inner);
            files.insert(path.to_owned(), bytes.clone());
            Ok(bytes)
        };
        let bytes = run.shape.bytes(read)?;
        let shaped = shaped.map_or_else(|| run.shape.mesh(&bytes), |shaped| Ok(shaped.clone()))?;
        let made = run.make(shaped.clone(), read);
        let made = made.map_err(|error| ParameterStudyError::Base(error.to_string()))?.simulation;
        let shares_path = self.keys().all(|key| starts(key, &TENSION_ONLY));
        let shapes = |key: &str| {
            starts(key, &SHAPING) || (run.shape.form.is_some() && key == "material.thickness")
        };
        let same_shape = !self.keys().any(shapes);
        let same_mesh = same_shape && !self.keys().any(|key| starts(key, &FIBRES));
        let Simulation { mesh, thick, fibres, fibres_in_space, .. } = made;
        let Simulation { myofibril_content, resting_stretch, adhesion, tissue, .. } = made;
        let places = Places {
            fibres,
            fibres_in_space,
            myofibril_content,
            resting_stretch,
            adhesion,
            tissue,
        };
        self.body = Some(Body {
            bytes,
            shaped: Some(shaped).filter(|_| same_shape && !same_mesh),
            meshed: Some(Meshed { mesh, thick, places }).filter(|_| same_mesh),
            shares_path,
            path: Mutex::default(),
        });
        self.files = files.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(())
    }

    /// The rows of some members; after an interruption, those not done yet are [`Interrupted`].
    pub fn rows(
        &self,
        members: &[&Variation],
        interruption: &Interruption,
    ) -> Vec<Result<VariationRow, Cause>> {
        let done = match self.kind {
            MemberKind::Cell => self.cells(members, interruption),
            MemberKind::Beat => {
                members.iter().map(|member| self.beat(Some(member), interruption)).collect()
            }
        };
        self.kept(members, done)
    }

    /// The row of a member, or of the run without any change.
    fn beat(&self, member: Option<&Variation>, interruption: &Interruption) -> Result<Done, Cause> {
        interruption.check()?;
        let values = member.map_or(&[][..], |member| &member.values);
        let file = run_of(&self.run, &self.varied, values)?;
        let ready = self.ready(&file, interruption);
        // Any other error is a consequence of the interruption.
        interruption.check()?;
        let outcome = ready?.run(|_progress| !interruption.is_requested());
        match &outcome.stop {
            Some(StopReason::Interrupted { .. }) => return Err(Interrupted.into()),
            Some(reason) => return Err(reason.to_string().into()),
            None => {}
        }
        let beats = outcome.beats();
        match member {
            None if beats.is_empty() => Err("no stimulus falls within its duration".into()),
            _ => {
                let number = member.map_or(0, |it| it.number);
                let s2 = beats.s2().and_then(|beat| beat.captured);
                let row = VariationRow::done(number, self.of_beats(&beats));
                let row = row.noting(beats.rhythm.no_capture(s2));
                Ok((row, self.curves(&outcome)))
            }
        }
    }

    /// The curves of a beat, where they are wanted.
    fn curves(&self, outcome: &Outcome) -> Vec<f32> {
        let Some(axes) = &self.axes else { return Vec::new() };
        let quantities: [fn(&Sample) -> f64; 3] = [
            |sample| sample.vm_mv.or(sample.u).unwrap_or(f64::NAN),
            |sample| sample.ta_kpa,
            |sample| sample.shortening_pct,
        ];
        // Some cells have no potential.
        let first = quantities.len() - axes.quantities.len();
        axes.resampled(&outcome.recording.samples, |sample| sample.t_ms, &quantities[first..])
    }

    /// The simulation of a run, on the mesh that members share or on its own.
    fn ready(&self, file: &RunFile, interruption: &Interruption) -> Result<Ready, Cause> {
        let body = self.body.as_ref().ok_or("cells have no mesh")?;
        let run = file.resolve()?.interrupted_by(interruption);
        let mut simulation = self.simulation(body, &run)?;
        if !file.has("numerics.frame_interval") {
            // Shapes between outputs are not needed.
            let output = simulation.numerics.output_interval;
            simulation.numerics.frame_interval =
                output * (simulation.duration / output).ceil().max(1.0);
        }
        let has_path = simulation.numerics.method == Method::QuasiStatic
            && !simulation.has_sites_in_triangles();
        if !has_path || !body.shares_path {
            return Ok(simulation.build()?);
        }
        let path = || body.path.lock().unwrap_or_else(PoisonError::into_inner);
        let known = path().clone();
        let path = if let Some(known) = known {
            known
        } else {
            // Not under the lock: a thread that waits within the solution may take up another member, which asks for the lock, too.
            let solved = simulation.shared_path(Tolerance::default());
            // After an interruption, an error of the path is not valid.
            interruption.check()?;
            let solved = solved.map(Arc::new).map_err(|error| error.to_string());
            path().get_or_insert(solved).clone()
        };
        Ok(path?.prepare(&simulation)?)
    }

    fn simulation(&self, body: &Body, run: &Run) -> Result<Simulation, Cause> {
        let read = |path: &str| {
            self.files.get(path).cloned().ok_or_else(|| io::ErrorKind::NotFound.into())
        };
        if let Some(Meshed { mesh, thick, places }) = &body.meshed {
            let (cell, _) = run.driven(read)?;
            let (start_state, _) = run.start_state(&cell)?;
            let simulation = run.simulation(mesh.clone(), thick.clone(), places.clone());
            return Ok(Simulation { cell, start_state, ..simulation });
        }
        let shaped = body.shaped.clone().map_or_else(|| run.shape.mesh(&body.bytes), Ok)?;
        Ok(run.make(shaped, read)?.simulation)
    }

    /// The requested metrics, in their order.
    fn of_beats(&self, beats: &Beats) -> Vec<Option<f64>> {
        let whole = |name: &str| beats.energy.iter().find(|metric| metric.name == name);
        let of = |name: &String| match (self.beat, whole(name)) {
            (CountedBeat::Mean, _) => beats.mean(name),
            (_, Some(metric)) => metric.value,
            (CountedBeat::First, None) => beats.first()?.value(name),
            (CountedBeat::Last, None) => beats.last()?.value(name),
        };
        self.metrics.iter().map(of).collect()
    }

    /// Some members, whose cells have no mesh.
    fn cells(
        &self,
        members: &[&Variation],
        interruption: &Interruption,
    ) -> Vec<Result<Done, Cause>> {
        let Self { run, varied, metrics, beat, axes, files, .. } = self;
        let axes = axes.as_ref();
        let wanted = Wanted { run, varied, metrics, beat: *beat, axes, files };
        alone::cells(&wanted, members, &|| !interruption.is_requested())
    }
}

/// The quantities of curves of runs.
fn of_runs(run: &Run) -> Vec<&'static str> {
    let at_rest = run.cell.initial_state();
    let mut quantities = Vec::new();
    if run.cell.membrane_potential_mv(&at_rest).is_some() {
        quantities.push("Potential (mV)");
    } else if run.cell.potential(&at_rest).is_some() {
        quantities.push("Potential u (\u{2013})");
    }
    quantities.extend(["Active tension (kPa)", "Shortening (%)"]);
    quantities
}

fn starts(key: &str, list: &[&str]) -> bool {
    list.iter().any(|start| key.starts_with(start))
}
