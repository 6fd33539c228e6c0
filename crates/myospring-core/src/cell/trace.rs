//! What a cell did over time.

use super::cell_model::CellModel;
use super::description::Input;
use super::settings::{SolveError, validate_time};
use crate::analysis::trace::{self, Point};

/// A cell's course, sampled; all columns that there are have the length of `time_ms`.
#[derive(Debug, Clone, PartialEq)]
pub struct CellTrace {
    /// Times, ms.
    pub time_ms: Vec<f64>,
    /// Names of the state variables.
    pub state_names: Vec<String>,
    /// One column per state variable.
    pub states: Vec<Vec<f64>>,
    /// The potential variable, in the unit of its state; empty where there is none.
    pub potential: Vec<f64>,
    /// Membrane potential, mV, where the model defines it.
    pub membrane_potential_mv: Option<Vec<f64>>,
    /// Active tension, relative or in kPa as the model says.
    pub tension: Vec<f64>,
    /// Names of what the model tells beside its state.
    pub output_names: Vec<String>,
    /// One column for each of them.
    pub outputs: Vec<Vec<f64>>,
}

/// A cell at one instant.
pub(super) struct Instant {
    pub(super) state: Vec<f64>,
    pub(super) outputs: Vec<f64>,
}

impl CellTrace {
    /// Samples a cell from 0 ms to `duration_ms`; `at` is asked for rising times.
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
        // A duration that is a multiple of the interval but for rounding keeps its last sample.
        let samples = (duration_ms / sample_interval_ms * (1.0 + 1e-12)).floor() as u64;
        for sample in 0..=samples {
            let time_ms = sample as f64 * sample_interval_ms;
            let Instant { state, outputs } = at(time_ms)?;
            trace.time_ms.push(time_ms);
            trace.potential.extend(model.potential(&state));
            trace.tension.push(model.tension(&state, &Input::REST));
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

    /// The highest point of the potential variable.
    pub fn peak_potential(&self) -> Option<Point> {
        trace::peak(&self.time_ms, &self.potential)
    }

    /// The highest point of the tension.
    pub fn peak_tension(&self) -> Option<Point> {
        trace::peak(&self.time_ms, &self.tension)
    }
}
