//! A cell model as the activation of a whole cell.

use super::cell_course::CellCourse;
use super::crossbridges::Crossbridges;
use super::{
    Activation, ActivationBounds, ActivationError, ActivationTangent, Sites, StretchState,
};
use crate::cell::integrator::CellIntegrator;
use crate::cell::pacing::Protocol;
use crate::cell::solve::{SolveError, SolverSettings};
use crate::cell::{CellModel, Input, Output, StateVariable};
use crate::mechanics::Tension;
use crate::recording::{CALCIUM, STEEPEST_RISE};
use std::borrow::Cow;
use std::sync::Arc;

/// One cell model for the whole cell.
#[derive(Clone)]
pub struct WholeCell {
    kept: Arc<CellIntegrator>,
    moved: Arc<CellIntegrator>,
    /// Number of intervals that were kept.
    intervals: usize,
    /// The course that it shares with the cells of other runs.
    course: Option<CellCourse>,
    /// Stretch and rate at the current time.
    input: Input,
    /// Crossbridges that are followed apart from the rest of the cell, which then goes on but once an interval.
    crossbridges: Option<Crossbridges>,
    /// When the rest of that cell was moved to last, ms, since it was kept.
    reached: Option<f64>,
    /// kPa per unit of the model's tension.
    scale: f64,
    strongest: ActivationBounds,
    feels_stretch: bool,
    /// Stretch of the model in the cell at rest.
    resting_stretch: f64,
    stimulus_times_ms: Vec<f64>,
    s2_ms: Option<f64>,
}

impl WholeCell {
    /// Creates a cell in this state at 0 ms, by default the initial one, with its bounds; `scale` is in kPa per unit
    /// of the model's tension.
    ///
    /// # Errors
    /// A protocol or settings that the model cannot follow, and a state that does not fit it.
    pub fn new(
        model: Arc<dyn CellModel>,
        state: Option<&[f64]>,
        protocol: Protocol,
        settings: SolverSettings,
        scale: f64,
        strongest: ActivationBounds,
    ) -> Result<Self, SolveError> {
        let feels_stretch = model.feels_stretch();
        let stimulus_times_ms = protocol.stimulus_times().collect();
        let s2_ms = protocol.s2_ms();
        let state = state.map_or_else(|| model.initial_state(), <[f64]>::to_vec);
        let kept = Arc::new(CellIntegrator::starting_from(model, &state, protocol, settings)?);
        Ok(Self {
            moved: Arc::clone(&kept),
            kept,
            intervals: 0,
            course: None,
            input: Input::REST,
            crossbridges: None,
            reached: None,
            scale,
            strongest,
            feels_stretch,
            resting_stretch: 1.0,
            stimulus_times_ms,
            s2_ms,
        })
    }

    /// Returns the same with this stretch of the model in the cell at rest; all other stretches are
    /// multiplied by it.
    #[must_use]
    pub fn at_resting_stretch(self, resting_stretch: f64) -> Self {
        Self { resting_stretch, ..self }
    }

    /// Returns the same on a course that it shares with the cells of other runs, unless it feels stretch. Their equations,
    /// parameters, protocols, methods and starts must be the same.
    #[must_use]
    pub(crate) fn along(self, course: &CellCourse) -> Self {
        let course = (!self.feels_stretch).then(|| course.clone());
        Self { course, ..self }
    }

    /// The state that it was moved to.
    fn state(&self) -> Cow<'_, [f64]> {
        match &self.crossbridges {
            Some(crossbridges) => {
                let mut state = self.moved.state().to_vec();
                crossbridges.put(&mut state);
                state.into()
            }
            None => self.moved.state().into(),
        }
    }
}

/// Returns the further outputs of a cell model: its outputs, recorded states, and calcium if it is
/// not one of these.
pub(super) fn told_by(model: &dyn CellModel) -> Vec<Output> {
    let states = model.recorded_states().iter().map(|&place| {
        let StateVariable { name, unit, meaning, .. } = model.states()[place].clone();
        Output { name, unit, meaning }
    });
    let mut told: Vec<Output> = model.outputs().iter().cloned().chain(states).collect();
    if tells_calcium_besides(model) {
        let meaning = "free calcium in the cytosol".into();
        told.push(Output { name: CALCIUM.into(), unit: "uM".into(), meaning });
    }
    told
}

/// Returns the values of these outputs.
pub(super) fn told(cell: &CellIntegrator, state: &[f64]) -> Vec<f64> {
    let mut values = cell.outputs();
    values.extend(cell.model().recorded_states().iter().map(|&place| state[place]));
    values.extend(cell.calcium_um().filter(|_| tells_calcium_besides(&**cell.model())));
    values
}

/// Whether a model has calcium that is neither an output nor a recorded state.
fn tells_calcium_besides(model: &dyn CellModel) -> bool {
    let is_output = || model.outputs().iter().any(|output| output.name == CALCIUM);
    let is_state = || model.recorded_states().iter().any(|&at| model.states()[at].name == CALCIUM);
    let state = model.initial_state();
    model.calcium_um(&state, &Input::REST).is_some() && !is_output() && !is_state()
}

impl Activation for WholeCell {
    fn sites(&self) -> Sites {
        Sites::Whole
    }

    fn advance(&mut self, to_ms: f64, now: StretchState<'_>) -> Result<(), ActivationError> {
        let failed = |error: SolveError| ActivationError(error.to_string());
        let [stretch, rate] = [now.stretch[0], now.rate[0]].map(|of| self.resting_stretch * of);
        self.input = Input { stretch, stretch_rate: rate, ..Input::REST };
        if let Some(crossbridges) = &mut self.crossbridges {
            let over = to_ms - self.kept.time();
            if self.reached != Some(to_ms) {
                let [middle, rate] = crossbridges.foretell(over, stretch);
                let mut cell = CellIntegrator::clone(&self.kept);
                cell.advance_to(to_ms, middle, rate).map_err(failed)?;
                self.moved = Arc::new(cell);
                self.reached = Some(to_ms);
            }
            crossbridges.follow(over, stretch);
            return Ok(());
        }
        if let Some(known) =
            self.course.as_ref().and_then(|course| course.at(self.intervals, to_ms))
        {
            self.moved = known;
            return Ok(());
        }
        let mut cell = CellIntegrator::clone(&self.kept);
        // Stretch in the middle of the interval; a linear course is accurate to second order.
        let middle = stretch - 0.5 * rate * (to_ms - self.kept.time());
        cell.advance_to(to_ms, middle, rate).map_err(failed)?;
        self.moved = Arc::new(cell);
        self.course =
            self.course.take().filter(|course| course.keep(self.intervals, to_ms, &self.moved));
        Ok(())
    }

    fn keep(&mut self) {
        self.kept = Arc::clone(&self.moved);
        self.intervals += 1;
        if let Some(crossbridges) = &mut self.crossbridges {
            crossbridges.keep(self.input.stretch);
            self.reached = None;
        }
    }

    fn tension(&self) -> Tension<'_> {
        let Input { stretch, stretch_rate, .. } = self.input;
        let input = Input { stretch, stretch_rate, ..self.moved.input() };
        let tension = self.moved.model().tension(&self.state(), &input);
        Tension::Uniform(self.scale * tension)
    }

    fn tangent(&self) -> Option<ActivationTangent<'_>> {
        self.feels_stretch.then_some(ActivationTangent { per_stretch: &[], per_rate: &[] })
    }

    fn strongest(&self) -> ActivationBounds {
        self.strongest
    }

    fn at_equilibria(&mut self) {
        self.crossbridges = Crossbridges::of(&**self.kept.model(), self.kept.state());
    }

    fn potential(&self) -> Option<f64> {
        self.moved.model().potential(self.moved.state())
    }

    fn membrane_potential_mv(&self) -> Option<f64> {
        self.moved.model().membrane_potential_mv(self.moved.state())
    }

    fn stimulus_times_ms(&self) -> Vec<f64> {
        self.stimulus_times_ms.clone()
    }

    fn s2_ms(&self) -> Option<f64> {
        self.s2_ms
    }

    fn outputs(&self) -> Vec<Output> {
        let model = &**self.moved.model();
        let state = model.initial_state();
        let mut told = told_by(model);
        if model.potential(&state).is_some() {
            let in_mv = model.membrane_potential_mv(&state).is_some();
            let unit = if in_mv { "mV/ms" } else { "1/ms" };
            let meaning = "largest rate of the potential since the last stimulus".into();
            told.push(Output { name: STEEPEST_RISE.into(), unit: unit.into(), meaning });
        }
        told
    }

    fn output_values(&self) -> Vec<f64> {
        let mut values = told(&self.moved, &self.state());
        let model = self.moved.model();
        if model.potential(self.moved.state()).is_some() {
            values.push(self.moved.steepest_rise().unwrap_or(0.0));
        }
        values
    }

    fn boxed(&self) -> Box<dyn Activation> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell;

    /// A cell of this model on a course, after some intervals of 0.25 ms under a stretch.
    fn after(model: &str, course: &CellCourse, intervals: u32, stretch: f64) -> WholeCell {
        let model = cell::model(model).unwrap();
        let protocol = Protocol { start_ms: 1.0, ..Protocol::once(model.default_stimulus()) };
        let bounds = ActivationBounds::default();
        let cell =
            WholeCell::new(model, None, protocol, SolverSettings::default(), 1.0, bounds).unwrap();
        let mut cell = cell.along(course);
        for interval in 1..=intervals {
            let now = StretchState { stretch: &[stretch], rate: &[0.0] };
            cell.advance(0.25 * f64::from(interval), now).unwrap();
            cell.keep();
        }
        cell
    }

    #[test]
    fn cells_on_one_course_are_the_same_cell_and_a_longer_run_goes_on() {
        let course = CellCourse::default();
        let first = after("coelho_2021", &course, 20, 1.0);
        assert!(Arc::ptr_eq(&first.moved, &after("coelho_2021", &course, 20, 0.9).moved));
        let longer = after("coelho_2021", &course, 40, 0.9);
        let alone = after("coelho_2021", &CellCourse::default(), 40, 1.0);
        assert_eq!((longer.moved.time(), longer.state()), (10.0, alone.state()));
        assert!(longer.state()[0] > 0.5);
    }

    #[test]
    fn intervals_of_another_length_leave_the_course() {
        let course = CellCourse::default();
        let _ = after("coelho_2021", &course, 20, 1.0);
        let mut cell = after("coelho_2021", &course, 4, 1.0);
        cell.advance(3.0, StretchState { stretch: &[1.0], rate: &[0.0] }).unwrap();
        cell.keep();
        assert!(cell.course.is_none());
        let alone = after("coelho_2021", &CellCourse::default(), 12, 1.0);
        assert_eq!((cell.moved.time(), cell.state()), (3.0, alone.state()));
    }

    #[test]
    fn a_cell_that_feels_stretch_has_its_own_course() {
        let course = CellCourse::default();
        let first = after("land_2017", &course, 20, 1.0);
        assert!(first.course.is_none());
        assert_ne!(first.state(), after("land_2017", &course, 20, 0.9).state());
    }
}
