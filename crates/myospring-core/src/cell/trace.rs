//! What a cell did over time.

use crate::analysis::trace::{self, Point};

/// A cell's course, sampled; all columns have the length of `time_ms`.
#[derive(Debug, Clone, PartialEq)]
pub struct CellTrace {
    /// Times, ms.
    pub time_ms: Vec<f64>,
    /// Names of the state variables.
    pub state_names: &'static [&'static str],
    /// One column per state variable.
    pub states: Vec<Vec<f64>>,
    /// The potential variable, dimensionless.
    pub potential: Vec<f64>,
    /// Membrane potential, mV, where the model defines it.
    pub membrane_potential_mv: Option<Vec<f64>>,
    /// Active tension, dimensionless.
    pub tension: Vec<f64>,
}

impl CellTrace {
    /// The column of a state variable.
    pub fn variable(&self, name: &str) -> Option<&[f64]> {
        let index = self.state_names.iter().position(|known| *known == name)?;
        Some(&self.states[index])
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
