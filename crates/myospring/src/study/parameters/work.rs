//! The work on members: whole beats, or cells side by side.

use super::super::Cause;
use super::super::{Interrupted, StudyError};
use super::description::{Kind, OF_CELLS, ParameterStudy, Which, is_minimal};
use super::error::ParameterStudyError;
use super::member::{Variation, VariationRow};
use super::shard::Shard;
use super::traces::{TraceAxes, Traces};
use crate::analysis::beat::Beats;
use crate::cell::adaptive;
use crate::cell::minimal::MinimalModel;
use crate::cell::population::{self, Cell};
use crate::cell::{CellModel as _, TensionKind};
use crate::integrate::Method;
use crate::integrate::quasi_static::Shapes;
use crate::mesh::Mesh;
use crate::output::files::FileError;
use crate::recording::Sample;
use crate::run_file::RunFile;
use crate::settings::{Run, Shaped};
use crate::simulation::{Outcome, Ready, Simulation, TensionScale};
use std::any::Any;
use std::path::Path;
use std::{io, iter};

/// Reads a file by its name as written.
type Read<'a> = dyn Fn(&str) -> io::Result<Vec<u8>> + Sync + 'a;

/// What all members have in common, made once.
pub struct Common<'a> {
    study: &'a ParameterStudy,
    read: &'a Read<'a>,
    /// Units of the metrics, in their order.
    pub units: Vec<&'static str>,
    /// The metrics of the run without any change, in their order.
    pub usual: Vec<Option<f64>>,
    /// What the curves that are kept of each member have in common; `None` where none are.
    pub axes: Option<TraceAxes>,
    /// The curves of the run without any change, quantity by quantity.
    pub usual_curves: Vec<f32>,
    traces: Option<Traces>,
    body: Option<Body>,
}

/// A member's cell without a mesh.
struct Alone {
    cell: Cell,
    /// Slope and offset of its membrane potential, mV, where its model has one.
    millivolts: Option<(f64, f64)>,
    /// kPa per unit of its tension.
    scale: f64,
}

/// A member that is done, and its curves where they are wanted.
type Done = (VariationRow, Vec<f32>);

/// The mesh that members share, where what they differ in leaves it as it is.
struct Body {
    mesh: Mesh,
    fibres: Vec<[f64; 2]>,
    content: Option<Vec<f64>>,
    /// The equilibria that they share, where they differ in the cell model and its pacing alone.
    shapes: Option<Shapes>,
}

/// Keys under which a number changes nothing but the course of tension.
const TENSION_ONLY: [&str; 3] = ["cell.", "stimulus.", "run."];
/// Keys of numbers that decide mesh or fibres.
const SHAPING: [&str; 4] =
    ["shape.", "segmentation.", "mechanics.fibre", "mechanics.myofibril_content"];

impl<'a> Common<'a> {
    /// The study.
    pub fn study(&self) -> &'a ParameterStudy {
        self.study
    }

    /// Makes what members share, and beats the run without any change.
    ///
    /// # Errors
    /// A shape that cannot be made, a run that cannot beat, or a metric that it does not have.
    pub fn new(study: &'a ParameterStudy, read: &'a Read<'a>) -> Result<Self, ParameterStudyError> {
        let run = study.run.resolve()?;
        let at_rest = run.cell.initial_state();
        let mut quantities = Vec::new();
        if run.cell.membrane_potential_mv(&at_rest).is_some() {
            quantities.push("Potential (mV)");
        } else if run.cell.potential(&at_rest).is_some() {
            quantities.push("Potential u (\u{2013})");
        }
        quantities.push("Active tension (kPa)");
        if study.kind == Kind::Beat {
            quantities.push("Shortening (%)");
        }
        let common = Self {
            study,
            read,
            units: Vec::new(),
            usual: Vec::new(),
            axes: study.traces.then(|| TraceAxes::new(run.duration, quantities)),
            usual_curves: Vec::new(),
            traces: None,
            body: None,
        };
        match study.kind {
            Kind::Cell => common.of_cells(&run),
            Kind::Beat => common.of_beats(&run),
        }
    }

    /// Keeps the curves of the members of a part in a folder, where the study wants them: [`TRACES`](super::TRACES).
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn keeping_traces(self, folder: &Path, part: Shard) -> Result<Self, StudyError> {
        let Some(axes) = &self.axes else { return Ok(self) };
        let members = (self.study.values.len() + part.of - part.part) / part.of;
        let traces = Some(Traces::open(folder, axes, part, members)?);
        Ok(Self { traces, ..self })
    }

    /// Why curves were not kept.
    pub(super) fn failure(&self) -> Option<FileError> {
        self.traces.as_ref()?.failure()
    }

    /// The rows of members, once their curves are kept.
    fn kept(
        &self,
        members: &[&Variation],
        done: Vec<Result<Done, Cause>>,
    ) -> Vec<Result<VariationRow, Cause>> {
        if let Some(traces) = &self.traces {
            let curves = |done: &Result<Done, Cause>| {
                done.as_ref().map_or_else(|_| Vec::new(), |(_, curves)| curves.clone())
            };
            let curves: Vec<Vec<f32>> = done.iter().map(curves).collect();
            if traces.keep(members, &curves).is_err() {
                return members.iter().map(|_| Err(Interrupted.into())).collect();
            }
        }
        done.into_iter().map(|done| done.map(|(row, _)| row)).collect()
    }

    fn of_cells(self, run: &Run) -> Result<Self, ParameterStudyError> {
        let no = |what: &str| Err(ParameterStudyError::NoCell { what: what.to_owned() });
        if !is_minimal(run) {
            return no(&format!("the model is {}", run.cell.name()));
        }
        if run.tension_scale == TensionScale::OwnPeak {
            return no("tension_scale = \"own-peak\" needs a reference beat of each");
        }
        let other = self.study.varied.iter().map(|varied| &varied.number.key);
        if let Some(key) =
            other.into_iter().find(|key| !TENSION_ONLY.iter().any(|of| key.starts_with(of)))
        {
            return no(&format!("`{key}` is of the mesh"));
        }
        let units = ["kPa", "ms", "ms", "", ""];
        let place = |name: &String| OF_CELLS.iter().position(|known| known == name);
        let units = self.in_order(|name| place(name).map(|at| units[at]), &OF_CELLS)?;
        let usual = self.cells_done(&[&Variation::new(0, self.usual_values(run))]).remove(0);
        let (usual, usual_curves) =
            usual.map_err(|error| ParameterStudyError::Base(error.to_string()))?;
        Ok(Self { units, usual: usual.metrics, usual_curves, ..self })
    }

    fn of_beats(self, run: &Run) -> Result<Self, ParameterStudyError> {
        let base = |error: Cause| ParameterStudyError::Base(error.to_string());
        let keys = || self.study.varied.iter().map(|varied| varied.number.key.as_str());
        let starts = |key: &str, list: &[&str]| list.iter().any(|start| key.starts_with(start));
        let (mut body, ready) = self.made(&self.study.run, run).map_err(base)?;
        if let Ready::AlongPath(path) = &ready
            && keys().all(|key| starts(key, &TENSION_ONLY))
        {
            body.shapes = Some(path.shapes.clone());
        }
        let outcome = ready.run(|_progress| true);
        let beats = ended(&outcome).map_err(base)?;
        let Some(first) = beats.first() else {
            return Err(ParameterStudyError::Base(
                "no stimulus falls within its duration".to_owned(),
            ));
        };
        let known: Vec<&'static str> = first.metrics().map(|metric| metric.name).collect();
        let unit = |name: &String| Some(first.metrics().find(|metric| metric.name == *name)?.unit);
        let units = self.in_order(unit, &known)?;
        let usual = self.metrics(&beats);
        let usual_curves = self.curves(&outcome);
        let shared = !keys().any(|key| starts(key, &SHAPING));
        let body = Some(body).filter(|_| shared);
        Ok(Self { units, usual, usual_curves, body, ..self })
    }

    /// What is known of each metric, or the one that does not exist.
    fn in_order(
        &self,
        of: impl Fn(&String) -> Option<&'static str>,
        known: &[&'static str],
    ) -> Result<Vec<&'static str>, ParameterStudyError> {
        let unknown = |name: &String| {
            let place = if self.study.keep.contains_key(name) { "[keep]" } else { "metrics" };
            ParameterStudyError::Metric { place, name: name.clone(), known: known.to_vec() }
        };
        self.study.metrics.iter().map(|name| of(name).ok_or_else(|| unknown(name))).collect()
    }

    fn usual_values(&self, run: &Run) -> Vec<f64> {
        let value =
            |varied: &super::description::Varied| varied.number.get(run).unwrap_or(f64::NAN);
        self.study.varied.iter().map(value).collect()
    }

    /// The rows of some members, each a beat of its own.
    pub fn beats(&self, members: &[&Variation]) -> Vec<Result<VariationRow, Cause>> {
        self.kept(members, members.iter().map(|member| self.beat(member)).collect())
    }

    fn beat(&self, member: &Variation) -> Result<Done, Cause> {
        let file = self.study.run_of(&member.values)?;
        let run = file.resolve()?;
        let (_, ready) = self.made(&file, &run)?;
        let outcome = ready.run(|_progress| true);
        let beats = ended(&outcome)?;
        Ok((VariationRow::done(member.number, self.metrics(&beats)), self.curves(&outcome)))
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
        axes.resampled(&outcome.recording.samples, &quantities[first..])
    }

    /// The simulation of a run, on the mesh that members share or on its own.
    fn made(&self, file: &RunFile, run: &Run) -> Result<(Body, Ready), Cause> {
        let mut simulation = if let Some(body) = &self.body {
            let (cell, _) = run.driven(self.read)?;
            let content = body.content.clone();
            Simulation { cell, ..run.simulation(body.mesh.clone(), body.fibres.clone(), content) }
        } else {
            let bytes = run.shape.bytes(self.read)?;
            let shaped: Shaped = run.shape.mesh(&bytes)?;
            run.make(shaped, self.read)?.simulation
        };
        if !file.has("numerics.frame_interval") {
            // Nobody looks at the shapes in between.
            let output = simulation.numerics.output_interval;
            simulation.numerics.frame_interval =
                output * (simulation.duration / output).ceil().max(1.0);
        }
        let shapes = self.body.as_ref().and_then(|body| body.shapes.clone());
        let ready = match (simulation.numerics.method, shapes) {
            (Method::QuasiStatic, Some(shapes)) => {
                Ready::AlongPath(simulation.prepare_quasi_static_from(shapes)?)
            }
            _ => simulation.build()?,
        };
        let content = simulation.myofibril_content;
        let body = Body { mesh: simulation.mesh, fibres: simulation.fibres, content, shapes: None };
        Ok((body, ready))
    }

    /// The metrics that are wanted, in their order.
    fn metrics(&self, beats: &Beats) -> Vec<Option<f64>> {
        let of = |name: &String| match self.study.beat {
            Which::First => beats.first()?.value(name),
            Which::Last => beats.last()?.value(name),
            Which::Mean => {
                let values: Vec<f64> = beats.iter().filter_map(|beat| beat.value(name)).collect();
                (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
            }
        };
        self.study.metrics.iter().map(of).collect()
    }

    /// The rows of some members, whose cells go side by side.
    pub fn cells(&self, members: &[&Variation]) -> Vec<Result<VariationRow, Cause>> {
        self.kept(members, self.cells_done(members))
    }

    fn cells_done(&self, members: &[&Variation]) -> Vec<Result<Done, Cause>> {
        let tasks: Vec<Result<Alone, Cause>> =
            members.iter().map(|member| self.cell(member)).collect();
        let cells: Vec<Cell> =
            tasks.iter().filter_map(|task| Some(task.as_ref().ok()?.cell.clone())).collect();
        let settings = population::Settings {
            method: adaptive::Settings::default(),
            sample_interval_ms: self.axes.as_ref().map(|axes| axes.interval_ms),
        };
        let outcomes = match population::run(&cells, &settings) {
            Ok(outcomes) => outcomes,
            Err(error) => return members.iter().map(|_| Err(error.clone().into())).collect(),
        };
        let mut outcomes = outcomes.into_iter();
        let row = |(member, task): (&&Variation, Result<Alone, Cause>)| {
            let Alone { millivolts, scale, .. } = task?;
            let outcome = outcomes.next().ok_or("a cell without an outcome")??;
            let value = |beat: &adaptive::Beat, name: &String| match name.as_str() {
                "peak_tension" => Some(scale * beat.peak_tension),
                "time_to_peak_tension" => Some(beat.peak_tension_ms - beat.stimulus_ms),
                "action_potential_duration_90" => beat.apd90_ms,
                "peak_potential" => Some(beat.peak_potential),
                _ => Some(beat.resting_potential),
            };
            let beats = &outcome.beats;
            let (first, last) = (beats.first(), beats.last());
            let of = |name: &String| match self.study.beat {
                Which::First => value(first?, name),
                Which::Last => value(last?, name),
                Which::Mean => {
                    let values: Vec<f64> =
                        beats.iter().filter_map(|beat| value(beat, name)).collect();
                    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
                }
            };
            let curves = self.axes.as_ref().map_or_else(Vec::new, |axes| {
                let potential = |state: &[f64; 6]| {
                    millivolts.map_or(state[0], |(slope, rest)| slope * state[0] + rest) as f32
                };
                let one = |value: &dyn Fn(&[f64; 6]) -> f32| {
                    let values = outcome.samples.iter().map(value);
                    values.chain(iter::repeat(f32::NAN)).take(axes.times).collect::<Vec<f32>>()
                };
                [one(&potential), one(&|state| (scale * state[5]) as f32)].concat()
            });
            let metrics = self.study.metrics.iter().map(of).collect();
            Ok((VariationRow::done(member.number, metrics), curves))
        };
        members.iter().zip(tasks).map(row).collect()
    }

    /// A member's cell.
    fn cell(&self, member: &Variation) -> Result<Alone, Cause> {
        let run = self.study.run_of(&member.values)?.resolve()?;
        let model = (&*run.cell as &dyn Any).downcast_ref::<MinimalModel>();
        let model = model.ok_or("the model is not the minimal one")?;
        let scale = match model.tension_kind() {
            TensionKind::Relative { published_peak } => run.peak_tension / published_peak,
            TensionKind::Kilopascal | TensionKind::None => 1.0,
        };
        let cell = Cell::new(model, run.protocol, run.duration)?;
        Ok(Alone { cell, millivolts: model.identity().millivolts, scale })
    }
}

/// The beats of a run that came to its end.
fn ended(outcome: &Outcome) -> Result<Beats, Cause> {
    match &outcome.stop {
        Some(reason) => Err(reason.to_string().into()),
        None => Ok(outcome.beats()),
    }
}
