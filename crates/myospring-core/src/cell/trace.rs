//! The sampled course of a cell.

use super::cell_model::CellModel;
use super::description::Input;
use super::settings::{SolveError, validate_time};
use crate::analysis::trace::{self, Point};

/// The sampled course of a cell; all columns have the length of `time_ms`.
#[derive(Debug, Clone, PartialEq)]
pub struct CellTrace {
    /// Times, ms.
    pub time_ms: Vec<f64>,
    /// Names of the state variables.
    pub state_names: Vec<String>,
    /// One column per state variable.
    pub states: Vec<Vec<f64>>,
    /// The potential variable, in the unit of its state; empty without potential.
    pub potential: Vec<f64>,
    /// Membrane potential, mV, if the model defines it.
    pub membrane_potential_mv: Option<Vec<f64>>,
    /// Active tension, relative or in kPa as the model says.
    pub tension: Vec<f64>,
    /// Names of the model's outputs.
    pub output_names: Vec<String>,
    /// One column for each of them.
    pub outputs: Vec<Vec<f64>>,
}

/// A cell at one time.
pub(super) struct Instant {
    pub(super) state: Vec<f64>,
    pub(super) input: Input,
    pub(super) outputs: Vec<f64>,
}

impl CellTrace {
    /// Samples a cell from 0 ms to `duration_ms`; `at` is called with ascending times.
    pub(super) fn sample(
        model: &dyn CellModel,
        duration_ms: f64,
        sample_interval_ms: f64,
        mut at: impl FnMut(f64) -> Result<Instant, SolveError>,
    ) -> Result<Self, SolveError> {
        validate_time("duration", duration_ms)?;
        validate_time("sample interval", sample_interval_ms)?;
        let has_millivolts = model.membrane_potential_mv(&model.initial_state()).is_some();
        let mut trace = Self {
            time_ms: Vec::new(),
            state_names: model.states().iter().map(|state| state.name.to_string()).collect(),
            states: vec![Vec::new(); model.states().len()],
            potential: Vec::new(),
            membrane_potential_mv: has_millivolts.then(Vec::new),
            tension: Vec::new(),
            output_names: model.outputs().iter().map(|output| output.name.to_string()).collect(),
            outputs: vec![Vec::new(); model.outputs().len()],
        };
        // If the duration is a multiple of the interval except for rounding, the last sample is
        // kept.
        let samples = (duration_ms / sample_interval_ms * (1.0 + 1e-12)).floor() as u64;
        for sample in 0..=samples {
            let time_ms = sample as f64 * sample_interval_ms;
            let Instant { state, input, outputs } = at(time_ms)?;
            trace.time_ms.push(time_ms);
            trace.potential.extend(model.potential(&state));
            trace.tension.push(model.tension(&state, &input));
            if let Some(column) = &mut trace.membrane_potential_mv {
                column.extend(model.membrane_potential_mv(&state));
            }
            let columns = trace.states.iter_mut().chain(&mut trace.outputs);
            for (column, value) in columns.zip(state.into_iter().chain(outputs)) {
                column.push(value);
            }
        }
        Ok(trace)
    }

    /// The column of a state variable or an output.
    pub fn variable(&self, name: &str) -> Option<&[f64]> {
        let mut names = self.state_names.iter().chain(&self.output_names);
        let index = names.position(|known| known == name)?;
        self.states.iter().chain(&self.outputs).nth(index).map(Vec::as_slice)
    }

    /// The peak of the potential variable.
    pub fn peak_potential(&self) -> Option<Point> {
        trace::peak(&self.time_ms, &self.potential)
    }

    /// The peak of the tension.
    pub fn peak_tension(&self) -> Option<Point> {
        trace::peak(&self.time_ms, &self.tension)
    }
}
