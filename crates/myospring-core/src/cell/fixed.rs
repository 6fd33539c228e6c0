//! Methods with fixed steps, one function each.

use super::cell_model::CellModel;
use super::description::{Gate, Input};
use super::pacer::Pacer;
use super::settings::SolveError;
use super::upstroke::Upstroke;

/// Times closer than this fraction of a step are the same time.
const SAME_INSTANT: f64 = 1e-6;

/// A method with fixed steps.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scheme {
    RungeKutta4,
    /// Forward Euler, block by block; a cut is the index of the first variable of a block.
    Euler {
        cuts: &'static [usize],
    },
    RushLarsen,
}

/// The integration of a cell in fixed steps.
///
/// Steps lie on the grid `n step` from 0 ms, computed as a product (not a running sum), and are cut
/// exactly at the events of the protocol and at requested times. Times within a millionth of a step
/// are the same time, so rounding neither misses nor doubles an event, and no tiny step is taken.
#[derive(Debug, Clone)]
pub(super) struct FixedSteps {
    scheme: Scheme,
    step_ms: f64,
    pacer: Pacer,
    work: Work,
    state: Vec<f64>,
    time_ms: f64,
    /// The next grid point is `next_grid * step`.
    next_grid: u64,
    on_grid: bool,
    upstroke: Upstroke,
}

impl FixedSteps {
    /// Starts in this state at 0 ms, after the protocol's events at 0 ms.
    pub(super) fn new(
        model: &dyn CellModel,
        mut state: Vec<f64>,
        scheme: Scheme,
        mut pacer: Pacer,
        step_ms: f64,
    ) -> Self {
        pacer.act(0.0, &mut state);
        let (work, upstroke) = (Work::new(model), Upstroke::new(model));
        let (time_ms, next_grid, on_grid) = (0.0, 1, true);
        Self { scheme, step_ms, pacer, work, state, time_ms, next_grid, on_grid, upstroke }
    }

    /// Time reached, ms.
    pub(super) fn time(&self) -> f64 {
        self.time_ms
    }

    /// The state at that time.
    pub(super) fn state(&self) -> &[f64] {
        &self.state
    }

    /// Sets a state variable at that time.
    pub(super) fn set_state(&mut self, place: usize, value: f64) {
        self.state[place] = value;
    }

    /// The largest rate of the potential since the last stimulus.
    pub(super) fn steepest_rise(&self) -> Option<f64> {
        self.upstroke.steepest()
    }

    /// Integrates to time `t_ms`; the stimulus in `input` is ignored.
    pub(super) fn advance_to(
        &mut self,
        model: &dyn CellModel,
        t_ms: f64,
        input: &Input,
    ) -> Result<(), SolveError> {
        let same = SAME_INSTANT * self.step_ms;
        if !t_ms.is_finite() || t_ms < self.time_ms - same {
            return Err(SolveError::BackInTime { target_ms: t_ms, time_ms: self.time_ms });
        }
        while t_ms - self.time_ms > same {
            self.step_towards(model, t_ms, input, same)?;
        }
        Ok(())
    }

    /// Makes one step to the first of these: the next grid point, the next event, or `target_ms`.
    fn step_towards(
        &mut self,
        model: &dyn CellModel,
        target_ms: f64,
        input: &Input,
        same: f64,
    ) -> Result<(), SolveError> {
        let grid_ms = self.next_grid as f64 * self.step_ms;
        let mut stop_ms = grid_ms;
        if target_ms <= stop_ms + same {
            stop_ms = target_ms;
        }
        if let Some(event_ms) = self.pacer.next_ms()
            && event_ms <= stop_ms + same
        {
            stop_ms = event_ms;
        }
        let to_grid = (stop_ms - grid_ms).abs() <= same;
        // Between grid points the exact step is used, not a difference of rounded times.
        let step_ms = if self.on_grid && to_grid { self.step_ms } else { stop_ms - self.time_ms };

        let input = Input {
            stimulus: self.pacer.current(),
            since_stimulus_ms: self.pacer.since_stimulus(self.time_ms),
            time_ms: self.time_ms,
            ..*input
        };
        self.work.step(self.scheme, model, &mut self.state, &input, step_ms);
        self.upstroke.see(input.since_stimulus_ms, &self.work.rates[0], input.stimulus);
        self.time_ms = stop_ms;
        self.on_grid = to_grid;
        self.next_grid += u64::from(to_grid);
        self.check_finite(model)?;
        self.pacer.act(self.time_ms, &mut self.state);
        Ok(())
    }

    fn check_finite(&self, model: &dyn CellModel) -> Result<(), SolveError> {
        let Some(index) = self.state.iter().position(|value| !value.is_finite()) else {
            return Ok(());
        };
        Err(SolveError::NotFinite {
            model: model.name().to_owned(),
            variable: model.states()[index].name.to_string(),
            value: self.state[index],
            time_ms: self.time_ms,
            step_ms: self.step_ms,
        })
    }
}

/// Room for the rates of one step.
#[derive(Debug, Clone)]
struct Work {
    rates: [Vec<f64>; 4],
    trial: Vec<f64>,
    gates: Vec<Gate>,
}

impl Work {
    fn new(model: &dyn CellModel) -> Self {
        let variables = model.states().len();
        Self {
            rates: std::array::from_fn(|_| vec![0.0; variables]),
            trial: vec![0.0; variables],
            gates: vec![Gate::default(); model.gates().len()],
        }
    }

    fn step(
        &mut self,
        scheme: Scheme,
        model: &dyn CellModel,
        state: &mut [f64],
        input: &Input,
        step_ms: f64,
    ) {
        match scheme {
            Scheme::RungeKutta4 => self.runge_kutta_4(model, state, input, step_ms),
            Scheme::Euler { cuts } => self.euler(model, cuts, state, input, step_ms),
            Scheme::RushLarsen => self.rush_larsen(model, state, input, step_ms),
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

    /// Gates by the exact solution of their equation at the old values of all other states, the
    /// rest by forward Euler: `rush_larsen_1978`.
    fn rush_larsen(&mut self, model: &dyn CellModel, state: &mut [f64], input: &Input, h: f64) {
        let Self { rates: [rates, ..], trial: old, gates } = self;
        model.derivatives(state, input, rates);
        model.write_gates(state, input, gates);
        old.copy_from_slice(state);
        for (value, rate) in state.iter_mut().zip(rates) {
            *value += h * *rate;
        }
        for (&place, gate) in model.gates().iter().zip(gates) {
            // x(t + h) = x_inf + (x - x_inf) exp(-h / tau)
            let x = old[place];
            state[place] = x + (x - gate.steady_state) * (-h / gate.time_constant_ms).exp_m1();
        }
    }

    /// The classical method of order 4; the stimulus is constant within a step, but the time since
    /// the stimulus advances.
    fn runge_kutta_4(&mut self, model: &dyn CellModel, state: &mut [f64], input: &Input, h: f64) {
        let Self { rates: [k1, k2, k3, k4], trial, .. } = self;
        let shift = |trial: &mut [f64], state: &[f64], k: &[f64], h: f64| {
            for ((trial, state), k) in trial.iter_mut().zip(state).zip(k) {
                *trial = state + h * k;
            }
        };
        let Input { since_stimulus_ms, time_ms, .. } = *input;
        let later = |by: f64| Input {
            since_stimulus_ms: since_stimulus_ms + by,
            time_ms: time_ms + by,
            ..*input
        };
        model.derivatives(state, input, k1);
        shift(trial, state, k1, h / 2.0);
        model.derivatives(trial, &later(h / 2.0), k2);
        shift(trial, state, k2, h / 2.0);
        model.derivatives(trial, &later(h / 2.0), k3);
        shift(trial, state, k3, h);
        model.derivatives(trial, &later(h), k4);
        for i in 0..state.len() {
            state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
}
