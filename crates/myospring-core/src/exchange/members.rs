//! The cells of a tissue, which make their steps together where the model can, and else each its own.

use crate::cell::integrator::CellIntegrator;
use crate::cell::pacing::Protocol;
use crate::cell::solve::{CellMethod, SolveError, SolverSettings};
use crate::cell::{CellModel, CellsTogether};
use rayon::prelude::*;
use std::sync::Arc;

/// Cells of one piece of work.
const PIECE: usize = 64;

#[derive(Clone)]
pub(super) enum Members {
    Together(CellsTogether),
    Alone(Vec<CellIntegrator>),
}

impl Members {
    /// Cells of these protocols in a state at 0 ms; `None` if the method chooses its steps.
    pub(super) fn new(
        model: &Arc<dyn CellModel>,
        state: &[f64],
        protocols: &[Protocol],
        settings: SolverSettings,
    ) -> Result<Option<Self>, SolveError> {
        let cell = |protocol: &Protocol| {
            CellIntegrator::starting_from(Arc::clone(model), state, *protocol, settings)
        };
        let Some(first) = protocols.first().map(cell).transpose()? else {
            return Ok(Some(Self::Alone(Vec::new())));
        };
        if !first.has_fixed_steps() {
            return Ok(None);
        }
        if settings.method == CellMethod::ForwardEuler
            && let Some(cells) = CellsTogether::new(model, state, protocols, settings.step_ms)?
        {
            return Ok(Some(Self::Together(cells)));
        }
        let cells = protocols.iter().map(cell).collect::<Result<_, _>>()?;
        Ok(Some(Self::Alone(cells)))
    }

    /// Integrates all to a time, ms, each with its stretch and rate of stretch (1/ms); without any, at rest.
    pub(super) fn advance_to(&mut self, t_ms: f64, strain: &[[f64; 2]]) -> Result<(), SolveError> {
        match self {
            Self::Together(cells) => {
                cells.advance_to(t_ms);
                Ok(())
            }
            Self::Alone(cells) => {
                cells.par_chunks_mut(PIECE).enumerate().try_for_each(|(piece, cells)| {
                    cells.iter_mut().enumerate().try_for_each(|(at, cell)| {
                        let known = strain.get(PIECE * piece + at);
                        let [stretch, rate] = known.copied().unwrap_or([1.0, 0.0]);
                        cell.advance_to(t_ms, stretch, rate)
                    })
                })
            }
        }
    }

    /// An error if a value is not finite.
    pub(super) fn check_finite(&self) -> Result<(), SolveError> {
        match self {
            Self::Together(cells) => cells.check_finite(),
            // They check each step.
            Self::Alone(_) => Ok(()),
        }
    }

    /// A state variable of all.
    pub(super) fn read(&self, variable: usize) -> Vec<f64> {
        match self {
            Self::Together(cells) => cells.values(variable).to_vec(),
            Self::Alone(cells) => cells.iter().map(|cell| cell.state()[variable]).collect(),
        }
    }

    /// Changes a state variable of all.
    pub(super) fn change(&mut self, variable: usize, how: impl FnOnce(&mut [f64])) {
        match self {
            Self::Together(cells) => how(cells.values_mut(variable)),
            Self::Alone(cells) => {
                let mut values: Vec<f64> =
                    cells.iter().map(|cell| cell.state()[variable]).collect();
                how(&mut values);
                for (cell, value) in cells.iter_mut().zip(values) {
                    cell.set_state(variable, value);
                }
            }
        }
    }

    /// A number of each cell and its state.
    pub(super) fn each(&self, mut number: impl FnMut(usize, &[f64]) -> f64) -> Vec<f64> {
        match self {
            Self::Together(cells) => {
                let mut state = Vec::new();
                let one = |cell| {
                    cells.write_state(cell, &mut state);
                    number(cell, &state)
                };
                (0..cells.values(0).len()).map(one).collect()
            }
            Self::Alone(cells) => {
                cells.iter().enumerate().map(|(at, cell)| number(at, cell.state())).collect()
            }
        }
    }

    /// The state of one cell.
    pub(super) fn state(&self, cell: usize) -> Vec<f64> {
        match self {
            Self::Together(cells) => {
                let mut state = Vec::new();
                cells.write_state(cell, &mut state);
                state
            }
            Self::Alone(cells) => cells[cell].state().to_vec(),
        }
    }
}
