//! Converts a run file to a run, and a run to a run file.

use super::error::RunFileError;
use super::file::RunFile;
use super::rules;
use crate::cell::solve::{CellMethod, SolverSettings};
use crate::integrate::Method;
use crate::settings::{Failure, Run, Source, Value, table};
use crate::units::{self, Dimension};

/// Interval at which a tissue takes the shape of its tension, ms: with waves, each shape is an equilibrium of its own.
const EXCHANGE_OF_TISSUE_MS: f64 = 1.0;

impl RunFile {
    /// Checks every value and fills in every default.
    ///
    /// # Errors
    /// A value with a wrong unit or outside its bounds, keys that exclude each other, a model or
    /// parameter that does not exist.
    pub fn resolve(&self) -> Result<Run, RunFileError> {
        self.run().map_err(RunFileError::bare)
    }

    /// Does what [`RunFile::resolve`] does; a failure contains the key that caused it.
    pub(super) fn run(&self) -> Result<Run, Failure> {
        let mut run = Run { models: self.models.clone(), ..Run::default_run() };
        for setting in table() {
            if let Some(value) = self.get(setting.key) {
                setting.set(&mut run, value)?;
            }
        }
        // Only fixed steps have a length: who states one means a method with them.
        if self.has("cell.step") && !self.has("cell.integrator") {
            let own = run.cell_settings_mut();
            if own.method == CellMethod::Adaptive {
                own.method = CellMethod::RungeKutta4;
            }
        }
        if matches!(run.shape.source, Source::BuiltIn(shape) if shape.is_tissue) {
            run.tissue.get_or_insert_default().assume_velocity();
        }
        if run.tissue.is_some() {
            self.suit_tissue(&mut run);
        }
        if !self.has("run.duration") {
            run.duration = run.usual_duration();
        }
        rules::check(self, &run)?;
        run.assumed = rules::assumed(self, &run);
        Ok(run)
    }

    /// Numerical settings that suit coupled cells, where the file states none.
    fn suit_tissue(&self, run: &mut Run) {
        // Its size is not that of a cell.
        run.shape.any_size |= !self.has("shape.any_size");
        let stated = |key: &str| self.has(key) || self.has("cell.authors_step");
        if let Some(own) = &mut run.numerics.cell {
            let suited = SolverSettings::coupled(&*run.cell);
            if !stated("cell.integrator") {
                own.method = suited.method;
            }
            if !stated("cell.step") {
                own.step_ms = suited.step_ms;
            }
        }
        if !self.has("numerics.integrator") {
            run.numerics.method = Method::QuasiStatic;
        }
        if !self.has("numerics.exchange_interval") && !self.has("numerics.output_interval") {
            run.numerics.exchange_interval = EXCHANGE_OF_TISSUE_MS;
            run.numerics.output_interval = EXCHANGE_OF_TISSUE_MS;
        }
    }
}

impl Run {
    /// Returns the run file of this run, with every default written out.
    ///
    /// Spacing and time step are absent where the shape and the stability limit determine them.
    pub fn to_run_file(&self) -> RunFile {
        let values = table().filter_map(|setting| Some((setting.key, setting.get(self)?)));
        RunFile { values: values.collect(), models: self.models.clone() }
    }

    /// Returns the run file that repeats this run, with the spacing (um) and time step (ms) that it
    /// used; a quasi-static run has no time step.
    pub fn settled(&self, spacing: f64, time_step: Option<f64>) -> RunFile {
        let mut file = self.to_run_file();
        let took = |value, dimension| Value::Text(units::format(value, dimension));
        file.values.insert("shape.spacing", took(spacing, Dimension::Length));
        file.values.remove("numerics.time_step");
        file.values
            .extend(time_step.map(|step| ("numerics.time_step", took(step, Dimension::Time))));
        file
    }
}
