//! Many cells of one model in fixed steps of forward Euler, variable by variable.

use super::cell_model::{CellModel, Together};
use super::pacer::Pacer;
use super::pacing::Protocol;
use super::settings::SolveError;
use std::sync::Arc;

/// Times closer than this fraction of a step are the same time, as for a cell alone.
const SAME_INSTANT: f64 = 1e-6;

/// Fewer cells than this are not worth a second thread, which takes longer to begin than they do.
const WORTH_A_THREAD: usize = 8000;

/// A step of all cells, which as many threads share as are worth it.
fn shared(together: &dyn Together, mut states: Vec<&mut [f64]>, stimuli: &[f64], step_ms: f64) {
    let half = stimuli.len() / 2;
    if half < WORTH_A_THREAD || rayon::current_num_threads() < 2 {
        return together.euler(&mut states, stimuli, step_ms);
    }
    let (first, second) = states.into_iter().map(|values| values.split_at_mut(half)).unzip();
    let (one, other) = stimuli.split_at(half);
    rayon::join(
        || shared(together, first, one, step_ms),
        || shared(together, second, other, step_ms),
    );
}

/// Cells that make their steps together. Steps end where those of [`CellIntegrator`](super::integrator::CellIntegrator) do, on the grid of
/// fixed steps and at events; an event of one cell ends the step of all.
#[derive(Clone)]
pub(crate) struct CellsTogether {
    model: Arc<dyn CellModel>,
    states: Vec<Vec<f64>>,
    /// The current of each cell.
    stimuli: Vec<f64>,
    /// The cells of each protocol.
    paced: Vec<(Pacer, Vec<usize>)>,
    step_ms: f64,
    time_ms: f64,
    next_grid: u64,
    on_grid: bool,
}

impl CellsTogether {
    /// Cells with these protocols in one state at 0 ms, after the events at 0 ms; `None` if the model makes no steps together.
    pub(crate) fn new(
        model: &Arc<dyn CellModel>,
        state: &[f64],
        protocols: &[Protocol],
        step_ms: f64,
    ) -> Result<Option<Self>, SolveError> {
        if model.together().is_none() {
            return Ok(None);
        }
        let mut paced: Vec<(Protocol, Vec<usize>)> = Vec::new();
        for (cell, protocol) in protocols.iter().enumerate() {
            match paced.iter_mut().find(|(known, _)| known == protocol) {
                Some((_, cells)) => cells.push(cell),
                None => paced.push((*protocol, vec![cell])),
            }
        }
        let stimulation = model.stimulation();
        let paced = paced.into_iter().map(|(protocol, cells)| {
            Ok::<_, SolveError>((Pacer::new(&stimulation, protocol)?, cells))
        });
        let mut cells = Self {
            model: Arc::clone(model),
            states: state.iter().map(|value| vec![*value; protocols.len()]).collect(),
            stimuli: vec![0.0; protocols.len()],
            paced: paced.collect::<Result<_, _>>()?,
            step_ms,
            time_ms: 0.0,
            next_grid: 1,
            on_grid: true,
        };
        cells.act();
        Ok(Some(cells))
    }

    /// Values of one state variable, cell by cell.
    pub(crate) fn values(&self, variable: usize) -> &[f64] {
        &self.states[variable]
    }

    /// The same, to be changed.
    pub(crate) fn values_mut(&mut self, variable: usize) -> &mut [f64] {
        &mut self.states[variable]
    }

    /// The state of one cell.
    pub(crate) fn write_state(&self, cell: usize, state: &mut Vec<f64>) {
        state.clear();
        state.extend(self.states.iter().map(|values| values[cell]));
    }

    /// Integrates to a time, ms.
    pub(crate) fn advance_to(&mut self, t_ms: f64) {
        let same = SAME_INSTANT * self.step_ms;
        while t_ms - self.time_ms > same {
            let grid_ms = self.next_grid as f64 * self.step_ms;
            let mut stop_ms = if t_ms <= grid_ms + same { t_ms } else { grid_ms };
            for (pacer, _) in &self.paced {
                if let Some(event_ms) = pacer.next_ms()
                    && event_ms <= stop_ms + same
                {
                    stop_ms = stop_ms.min(event_ms);
                }
            }
            let to_grid = (stop_ms - grid_ms).abs() <= same;
            let step_ms =
                if self.on_grid && to_grid { self.step_ms } else { stop_ms - self.time_ms };
            if let Some(together) = self.model.together() {
                let states = self.states.iter_mut().map(Vec::as_mut_slice).collect();
                shared(together, states, &self.stimuli, step_ms);
            }
            self.time_ms = stop_ms;
            self.on_grid = to_grid;
            self.next_grid += u64::from(to_grid);
            self.act();
        }
    }

    /// Applies the events that are due.
    fn act(&mut self) {
        let mut added = vec![0.0; self.states.len()];
        for (pacer, cells) in &mut self.paced {
            if !pacer.act(self.time_ms, &mut added) {
                continue;
            }
            for &cell in &*cells {
                self.stimuli[cell] = pacer.current();
                for (values, added) in self.states.iter_mut().zip(&added) {
                    values[cell] += added;
                }
            }
            added.fill(0.0);
        }
    }

    /// An error if a value is not finite.
    pub(crate) fn check_finite(&self) -> Result<(), SolveError> {
        let bad = |values: &Vec<f64>| values.iter().position(|value| !value.is_finite());
        let found =
            self.states.iter().enumerate().find_map(|(at, values)| Some((at, bad(values)?)));
        let Some((variable, cell)) = found else { return Ok(()) };
        Err(SolveError::NotFinite {
            model: self.model.name().to_owned(),
            variable: self.model.states()[variable].name.to_string(),
            value: self.states[variable][cell],
            time_ms: self.time_ms,
            step_ms: self.step_ms,
        })
    }
}
