//! How long a fit will take.

use super::error::FitError;
use super::fitter::{Fitter, Loaded};
use super::problem::{Layout, Role, Source};
use super::settings::FitSettings;
use super::unknown::Unknown;
use crate::clock::Stopwatch;
use std::time::Duration;

/// Steps that a search takes, curves that a start needs besides, and steps to all points of a profile: measured.
const STEPS: usize = 5;
const BESIDES: usize = 10;
const OF_PROFILE: usize = 55;

impl Fitter {
    /// The approximate time of a fit on one thread, for a cell model whose curves take most of the
    /// time: one curve is computed and timed. `None` for other cell models, whose fits take
    /// seconds.
    ///
    /// # Errors
    ///
    /// As [`Fitter::fit_loaded`].
    pub fn will_take(
        &self,
        curves: &[Loaded],
        settings: &FitSettings,
    ) -> Result<Option<Duration>, FitError> {
        if self.seeks_tension() {
            return Ok(None);
        }
        let sought =
            settings.sought(&*self.simulation().cell, |unknown| self.usual(unknown), false)?;
        let unknowns: Vec<Unknown> = sought.iter().map(|(unknown, ..)| unknown.clone()).collect();
        let sources = curves
            .iter()
            .map(|curve| self.source(curve, &unknowns, 0))
            .collect::<Result<Vec<Source>, _>>()?;
        if !sources.iter().any(|source| source.contraction.is_slow()) {
            return Ok(None);
        }
        let layout = Layout::new(sources, &sought);
        let at = vec![0.0; layout.roles.len()];
        let begun = Stopwatch::start();
        for (number, source) in layout.sources.iter().enumerate() {
            layout.shortening(&at, number, &source.frames.times);
        }
        // Delays and levels need no new curve.
        let of_cell = layout.roles.iter().filter(|role| matches!(role, Role::Physics(_))).count();
        let shown = (0..layout.roles.len()).filter(|&place| layout.is_shown(place)).count();
        let a_step = of_cell + 1;
        let curves =
            settings.starts.max(1) * (BESIDES + STEPS * a_step) + shown * OF_PROFILE * a_step;
        Ok(Some(begun.elapsed() * u32::try_from(curves).unwrap_or(u32::MAX)))
    }
}
