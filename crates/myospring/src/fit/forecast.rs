//! How long a fit will take.

use super::contraction::Contraction;
use super::error::FitError;
use super::fitter::{Fitter, Loaded};
use super::problem::{Layout, Role};
use super::settings::FitSettings;
use super::unknown::Unknown;
use crate::clock::Stopwatch;
use std::time::Duration;

/// Steps that a search takes, curves that a start needs besides, and steps to all points of a profile: measured.
const STEPS: usize = 5;
const BESIDES: usize = 10;
const OF_PROFILE: usize = 55;

/// Beats of a curve that are timed.
const TIMED: usize = 2;

impl Fitter {
    /// Whether a fit takes long, since each curve that it tries is a whole beat of the cell model.
    ///
    /// # Errors
    ///
    /// Settings that the model does not take.
    pub fn is_slow(&self, settings: &FitSettings) -> Result<bool, FitError> {
        if self.seeks_tension() {
            return Ok(false);
        }
        let unknowns: Vec<Unknown> =
            self.unknowns(settings)?.into_iter().map(|(unknown, ..)| unknown).collect();
        Ok(Contraction::will_be_slow(self.simulation(), &unknowns))
    }

    fn unknowns(&self, settings: &FitSettings) -> Result<Vec<(Unknown, [f64; 2], f64)>, FitError> {
        settings.sought(&*self.simulation().cell, |unknown| self.usual(unknown), false)
    }

    /// The approximate time of a slow fit on one thread: the first beats of each curve are computed and timed.
    ///
    /// # Errors
    ///
    /// As [`Fitter::fit_loaded`].
    pub fn will_take(
        &self,
        curves: &[Loaded],
        settings: &FitSettings,
    ) -> Result<Duration, FitError> {
        let sought = self.unknowns(settings)?;
        let unknowns: Vec<Unknown> = sought.iter().map(|(unknown, ..)| unknown.clone()).collect();
        let beats = |curve: &Loaded| curve.observed.stimuli.times().len();
        let (all, timed) = curves.iter().fold((0, 0), |(all, timed), curve| {
            (all + beats(curve), timed + beats(curve).min(TIMED))
        });
        let first = |curve: &Loaded| {
            let observed = curve.observed.first_beats(TIMED);
            Loaded { observed, ..curve.clone() }
        };
        let starts: Vec<Loaded> = curves.iter().map(first).collect();
        let sources = self.sources(&starts, &unknowns, 0)?;
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
        let one = begun.elapsed().mul_f64(all as f64 / timed.max(1) as f64);
        Ok(one * u32::try_from(curves).unwrap_or(u32::MAX))
    }
}
