//! How fast the potential rises in an upstroke, by the model's own rates.

use super::cell_model::CellModel;

/// The largest rate of the potential since the last stimulus began, without the current of the stimulus.
#[derive(Debug, Clone)]
pub(super) struct Upstroke {
    /// The place of the potential, and the part of a stimulus current that is its rate; `None` where there is no potential.
    potential: Option<(usize, f64)>,
    since_stimulus_ms: f64,
    steepest: f64,
}

impl Upstroke {
    /// Nothing seen yet.
    pub(super) fn new(model: &dyn CellModel) -> Self {
        let potential = model.potential(&model.initial_state());
        let moved = potential.and(model.stimulation().moves.first().copied());
        Self {
            potential: moved.map(|moved| (moved.state, moved.weight)),
            since_stimulus_ms: f64::INFINITY,
            steepest: f64::NEG_INFINITY,
        }
    }

    /// Sees the rates at a time after the last stimulus began, under a stimulus current.
    pub(super) fn see(&mut self, since_stimulus_ms: f64, rates: &[f64], stimulus: f64) {
        let Some((place, weight)) = self.potential else { return };
        if since_stimulus_ms < self.since_stimulus_ms {
            self.steepest = f64::NEG_INFINITY;
        }
        self.since_stimulus_ms = since_stimulus_ms;
        self.steepest = self.steepest.max(rates[place] - weight * stimulus);
    }

    /// What was seen, in the unit of the potential's state per ms.
    pub(super) fn steepest(&self) -> Option<f64> {
        Some(self.steepest).filter(|rate| rate.is_finite())
    }
}
