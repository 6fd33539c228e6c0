//! Converts a run file to a run, and a run to a run file.

use super::error::RunFileError;
use super::file::RunFile;
use super::rules;
use crate::settings::{Failure, Run, Value, table};
use crate::units::{self, Dimension};

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
        if !self.has("run.duration") {
            run.duration = run.usual_duration();
        }
        rules::check(self, &run)?;
        run.assumed = rules::assumed(self, &run);
        Ok(run)
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
