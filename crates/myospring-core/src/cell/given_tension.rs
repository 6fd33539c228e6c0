//! A prescribed active tension: what a measured cell needs, or a tension from elsewhere.
//!
//! ```text
//! T(s) = tension_factor * monotone cubic through the rows, then the last value   (fritsch_1984)
//! ```
//! `s` is the time since the last stimulus, or since the start of the run ([`TensionClock`]). The
//! cubic stays between neighbouring rows, so that it has no peak that the rows do not have. Neither
//! stretch nor speed changes the tension: such a cell predicts nothing beyond its table.

mod course;

pub use course::{TensionClock, TensionCourse};

use super::cell_model::{CellModel, InFits};
use super::description::{Input, ModelError, StateVariable, Stimulation, TensionKind, required};
use super::pacing::Stimulus;
use super::settings::{CellMethod, SolverSettings};
use crate::analysis::monotone::MonotoneCubic;
use crate::parameter::{Parameter, ParameterSet};
use std::borrow::Cow;
use std::f64::consts::PI;
use std::sync::Arc;

const NAME: &str = "given_tension";
const FACTOR: &str = "tension_factor";

/// Peak (kPa) and times of the example: from rest to its peak, and back to rest (ms).
const EXAMPLE: [f64; 3] = [40.0, 150.0, 250.0];
/// Rows of each half of the example.
const ROWS: u32 = 25;

/// A cell whose active tension is prescribed.
///
/// It has no state, membrane or potential. Tension is in kPa.
///
/// # Example
/// ```
/// use myospring::cell::CellModel;
/// use myospring::cell::given_tension::{GivenTension, TensionClock, TensionCourse};
/// let course = TensionCourse::new(&[0.0, 100.0, 300.0], &[0.0, 30.0, 0.0])?;
/// let model = GivenTension::example().with_course(course, TensionClock::Stimulus);
/// assert_eq!((model.peak(), model.states().len()), (30.0, 0));
/// # Ok::<(), myospring::cell::calcium::TraceError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GivenTension {
    parameters: ParameterSet,
    factor: f64,
    course: TensionCourse,
    clock: TensionClock,
}

impl GivenTension {
    /// The model with an example of a beat: 40 kPa after 150 ms, and rest again 250 ms later.
    pub fn example() -> Self {
        let parameters = ParameterSet::new(vec![Parameter {
            name: FACTOR.into(),
            value: 1.0,
            unit: "".into(),
            minimum: 0.0,
            maximum: 100.0,
            meaning: "factor on the prescribed tension".into(),
            source: "the table as it is".into(),
        }]);
        Self { parameters, factor: 1.0, course: example(), clock: TensionClock::Stimulus }
    }

    /// The same with another course.
    #[must_use]
    pub fn with_course(&self, course: TensionCourse, clock: TensionClock) -> Self {
        Self { course, clock, ..self.clone() }
    }

    /// Its greatest tension, kPa.
    pub fn peak(&self) -> f64 {
        self.factor * self.course.peak()
    }
}

/// Half a cosine up, half a cosine down.
fn example() -> TensionCourse {
    let [peak, rise_ms, fall_ms] = EXAMPLE;
    let part = |row: u32| f64::from(row) / f64::from(ROWS);
    let up = (0..ROWS).map(|row| (rise_ms * part(row), 1.0 - (PI * part(row)).cos()));
    let down = (0..=ROWS).map(|row| (rise_ms + fall_ms * part(row), 1.0 + (PI * part(row)).cos()));
    let (times, heights): (Vec<f64>, Vec<f64>) = up.chain(down).unzip();
    let tensions_kpa: Vec<f64> = heights.iter().map(|height| 0.5 * peak * height).collect();
    TensionCourse(MonotoneCubic::new(times, tensions_kpa))
}

impl CellModel for GivenTension {
    fn name(&self) -> &'static str {
        NAME
    }

    fn description(&self) -> &'static str {
        "An active tension from a table (tension = \"FILE.csv\"), whatever made it: it predicts nothing beyond the table"
    }

    fn citations(&self) -> Vec<&str> {
        vec!["fritsch_1984"]
    }

    fn parameters(&self) -> &ParameterSet {
        &self.parameters
    }

    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        let factor = required(NAME, &parameters, FACTOR)?;
        Ok(Arc::new(Self { parameters, factor, ..self.clone() }))
    }

    fn states(&self) -> &[StateVariable] {
        &[]
    }

    fn derivatives(&self, _state: &[f64], _input: &Input, _rates: &mut [f64]) {}

    fn stimulation(&self) -> Stimulation {
        // The stimulus starts the course and changes no state.
        Stimulation {
            default: Stimulus::Jump { amplitude: 0.0 },
            current_unit: Cow::Borrowed("1/ms"),
            moves: Cow::Borrowed(&[]),
        }
    }

    fn potential(&self, _state: &[f64]) -> Option<f64> {
        None
    }

    fn membrane_potential_mv(&self, _state: &[f64]) -> Option<f64> {
        None
    }

    fn tension(&self, _state: &[f64], input: &Input) -> f64 {
        let time = match self.clock {
            TensionClock::Stimulus if input.since_stimulus_ms.is_infinite() => 0.0,
            TensionClock::Stimulus => input.since_stimulus_ms,
            TensionClock::Run => input.time_ms,
        };
        self.factor * self.course.at(time)
    }

    fn tension_kind(&self) -> TensionKind {
        TensionKind::Kilopascal
    }

    fn with_tension(
        &self,
        course: &TensionCourse,
        clock: TensionClock,
    ) -> Option<Arc<dyn CellModel>> {
        Some(Arc::new(self.with_course(course.clone(), clock)))
    }

    fn given_peak(&self) -> Option<f64> {
        Some(self.peak())
    }

    fn in_fits(&self) -> InFits<'_> {
        InFits { strength: Some(FACTOR), ..InFits::default() }
    }

    fn usual_settings(&self) -> SolverSettings {
        // There is nothing to integrate.
        SolverSettings { step_ms: 1.0, ..SolverSettings::of(CellMethod::RungeKutta4) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tension_that_is_none_is_refused_with_its_row_value_and_bound() {
        for (value, part) in [(-0.5, "tension is -0.5 kPa"), (5e4, "between 0 and 500 kPa")] {
            let error = TensionCourse::new(&[0.0, 1.0, 2.0], &[0.0, value, 0.0]).unwrap_err();
            assert_eq!(error.sample(), Some(1));
            assert!(error.to_string().contains(part), "{error}");
        }
    }

    #[test]
    fn one_beat_restarts_with_each_stimulus_and_a_recording_goes_on() {
        let course = TensionCourse::new(&[0.0, 100.0, 300.0], &[1.0, 30.0, 1.0]).unwrap();
        let model = |clock| GivenTension::example().with_course(course.clone(), clock);
        let at = |clock, since_stimulus_ms, time_ms| {
            model(clock).tension(&[], &Input { since_stimulus_ms, time_ms, ..Input::REST })
        };
        assert_eq!(at(TensionClock::Stimulus, f64::INFINITY, 40.0), 1.0);
        assert_eq!(at(TensionClock::Stimulus, 100.0, 1150.0), 30.0);
        assert_eq!(at(TensionClock::Run, f64::INFINITY, 100.0), 30.0);
        assert_eq!(at(TensionClock::Run, 100.0, 1150.0), 1.0);
    }
}
