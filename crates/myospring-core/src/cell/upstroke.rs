//! The maximum upstroke velocity, from the model's own rates.

use super::cell_model::CellModel;

/// The largest rate of the potential since the last stimulus began, without the current of the stimulus.
#[derive(Debug, Clone)]
pub(super) struct Upstroke {
    /// Index of the potential, and its rate per unit of stimulus current; `None` without potential.
    potential: Option<(usize, f64)>,
    since_stimulus_ms: f64,
    steepest: f64,
}

impl Upstroke {
    /// Starts without any rate.
    pub(super) fn new(model: &dyn CellModel) -> Self {
        let potential = model.potential(&model.initial_state());
        let moved = potential.and(model.stimulation().moves.first().copied());
        Self {
            potential: moved.map(|moved| (moved.state, moved.weight)),
            since_stimulus_ms: f64::INFINITY,
            steepest: f64::NEG_INFINITY,
        }
    }

    /// Records the rates at a time after the last stimulus began, with a stimulus current.
    pub(super) fn see(&mut self, since_stimulus_ms: f64, rates: &[f64], stimulus: f64) {
        let Some((place, weight)) = self.potential else { return };
        if since_stimulus_ms < self.since_stimulus_ms {
            self.steepest = f64::NEG_INFINITY;
        }
        self.since_stimulus_ms = since_stimulus_ms;
        self.steepest = self.steepest.max(rates[place] - weight * stimulus);
    }

    /// The largest recorded rate, in the unit of the potential's state per ms.
    pub(super) fn steepest(&self) -> Option<f64> {
        Some(self.steepest).filter(|rate| rate.is_finite())
    }
}
