//! Moves one cell in time, alone or inside a coupled simulation.

use super::pacing::{Event, Protocol};
use super::solve::{Method, Settings, SolveError};
use super::{CellModel, Input};

/// Instants closer than this fraction of a step are one instant.
const SAME_INSTANT: f64 = 1e-6;

/// A cell on its way through time.
///
/// Steps lie on the grid `n step` from 0 ms, counted and not summed up, and are cut exactly at the
/// events of the protocol and at the times asked for; instants within a millionth of a step of each
/// other are one instant, so no event is missed or doubled by rounding and no sliver of a step is
/// taken. Going to a multiple of the step in many calls or in one gives the same bits.
///
/// The state at a time includes every event up to and at that time.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, coelho_2021, integrator::CellIntegrator, solve::Settings};
/// use myospring::cell::pacing::Protocol;
///
/// let model = coelho_2021::model();
/// let protocol = Protocol::once(model.default_stimulus());
/// let mut cell = CellIntegrator::new(&model, protocol, Settings::default())?;
/// for step in 1..=60 {
///     cell.advance_to(f64::from(step), 1.0)?; // 1.0: at resting length
/// }
/// assert!(model.potential(cell.state()) > 0.9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct CellIntegrator<'a> {
    model: &'a dyn CellModel,
    protocol: Protocol,
    settings: Settings,
    stepper: Stepper,
    state: Vec<f64>,
    time_ms: f64,
    /// The next grid point is `next_grid * step`.
    next_grid: u64,
    on_grid: bool,
    next_event: u64,
    stimulus: f64,
}

impl<'a> CellIntegrator<'a> {
    /// A cell in its initial state at 0 ms, after whatever the protocol does at 0 ms.
    ///
    /// # Errors
    /// A protocol that cannot be followed, or a step that is not a positive finite time.
    pub fn new(
        model: &'a dyn CellModel,
        protocol: Protocol,
        settings: Settings,
    ) -> Result<Self, SolveError> {
        protocol.validate()?;
        settings.validate()?;
        let state = model.initial_state();
        let mut cell = Self {
            model,
            protocol,
            settings,
            stepper: Stepper::new(state.len()),
            state,
            time_ms: 0.0,
            next_grid: 1,
            on_grid: true,
            next_event: 0,
            stimulus: 0.0,
        };
        cell.apply_events();
        Ok(cell)
    }

    /// Time reached, ms.
    pub fn time(&self) -> f64 {
        self.time_ms
    }

    /// The state at that time, in the order of the model's `state_names`.
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// The model that is integrated.
    pub fn model(&self) -> &'a dyn CellModel {
        self.model
    }

    /// Moves on to time `t_ms` at constant `stretch` (length over resting length).
    ///
    /// The time need not be a multiple of the step. A time within a millionth of a step of the time
    /// reached changes nothing.
    ///
    /// # Errors
    /// A time before the one reached or not finite, a stretch that is not a positive number, or a
    /// state variable that becomes NaN or infinite; the cell is then no longer of use.
    pub fn advance_to(&mut self, t_ms: f64, stretch: f64) -> Result<(), SolveError> {
        let same = SAME_INSTANT * self.settings.step_ms;
        if !t_ms.is_finite() || t_ms < self.time_ms - same {
            return Err(SolveError::BackInTime { target_ms: t_ms, time_ms: self.time_ms });
        }
        if !(stretch.is_finite() && stretch > 0.0) {
            return Err(SolveError::Stretch { value: stretch, time_ms: self.time_ms });
        }
        while t_ms - self.time_ms > same {
            self.step_towards(t_ms, stretch, same)?;
        }
        Ok(())
    }

    /// One step, to whatever comes first: the next grid point, the next event, or `target_ms`.
    fn step_towards(&mut self, target_ms: f64, stretch: f64, same: f64) -> Result<(), SolveError> {
        let grid_ms = self.next_grid as f64 * self.settings.step_ms;
        let mut stop_ms = grid_ms;
        if target_ms <= stop_ms + same {
            stop_ms = target_ms;
        }
        if let Some((event_ms, _)) = self.protocol.nth_event(self.next_event)
            && event_ms <= stop_ms + same
        {
            stop_ms = event_ms;
        }
        let to_grid = (stop_ms - grid_ms).abs() <= same;
        // Between grid points the step is the step, not a difference of rounded times.
        let step_ms =
            if self.on_grid && to_grid { self.settings.step_ms } else { stop_ms - self.time_ms };

        let input = Input { stimulus: self.stimulus, stretch };
        self.stepper.step(self.model, self.settings.method, &mut self.state, &input, step_ms);
        self.time_ms = stop_ms;
        self.on_grid = to_grid;
        self.next_grid += u64::from(to_grid);
        self.check_finite()?;
        self.apply_events();
        Ok(())
    }

    fn apply_events(&mut self) {
        while let Some((event_ms, event)) = self.protocol.nth_event(self.next_event)
            && event_ms <= self.time_ms
        {
            match event {
                Event::Jump(amplitude) => self.model.jump(&mut self.state, amplitude),
                Event::CurrentOn(rate) => self.stimulus = rate,
                Event::CurrentOff => self.stimulus = 0.0,
            }
            self.next_event += 1;
        }
    }

    fn check_finite(&self) -> Result<(), SolveError> {
        let Some(index) = self.state.iter().position(|value| !value.is_finite()) else {
            return Ok(());
        };
        Err(SolveError::NotFinite {
            model: self.model.name(),
            variable: self.model.state_names()[index],
            value: self.state[index],
            time_ms: self.time_ms,
            step_ms: self.settings.step_ms,
        })
    }
}

/// Work space of the fixed-step methods.
#[derive(Clone)]
struct Stepper {
    rates: [Vec<f64>; 4],
    trial: Vec<f64>,
}

impl Stepper {
    fn new(variables: usize) -> Self {
        Self { rates: std::array::from_fn(|_| vec![0.0; variables]), trial: vec![0.0; variables] }
    }

    fn step(
        &mut self,
        model: &dyn CellModel,
        method: Method,
        state: &mut [f64],
        input: &Input,
        step_ms: f64,
    ) {
        match method {
            Method::RungeKutta4 => self.runge_kutta_4(model, state, input, step_ms),
            Method::ForwardEuler => self.euler(model, &[], state, input, step_ms),
            Method::StaggeredEuler => {
                self.euler(model, model.staggered_blocks(), state, input, step_ms);
            }
        }
    }

    /// Forward Euler, block by block: a block sees the new values of the blocks before it.
    fn euler(
        &mut self,
        model: &dyn CellModel,
        cuts: &[usize],
        state: &mut [f64],
        input: &Input,
        h: f64,
    ) {
        let rates = &mut self.rates[0];
        let mut begin = 0;
        for &end in cuts.iter().chain([&state.len()]) {
            model.derivatives(state, input, rates);
            for i in begin..end {
                state[i] += h * rates[i];
            }
            begin = end;
        }
    }

    /// The classical method of order 4; the stimulus is constant within a step.
    fn runge_kutta_4(&mut self, model: &dyn CellModel, state: &mut [f64], input: &Input, h: f64) {
        let Self { rates: [k1, k2, k3, k4], trial } = self;
        let shift = |trial: &mut [f64], state: &[f64], k: &[f64], h: f64| {
            for ((trial, state), k) in trial.iter_mut().zip(state).zip(k) {
                *trial = state + h * k;
            }
        };
        model.derivatives(state, input, k1);
        shift(trial, state, k1, h / 2.0);
        model.derivatives(trial, input, k2);
        shift(trial, state, k2, h / 2.0);
        model.derivatives(trial, input, k3);
        shift(trial, state, k3, h);
        model.derivatives(trial, input, k4);
        for i in 0..state.len() {
            state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
}
