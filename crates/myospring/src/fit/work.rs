//! The work of a fit: how much it will be, how much was done, and whether it goes on.

use super::error::FitError;
use super::fitter::{Fitter, Loaded};
use super::problem::{Layout, Role, Source};
use super::settings::Settings;
use super::unknown::Unknown;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// It is asked so often whether to go on, however long a start or a profile takes.
const ASKED_EVERY: Duration = Duration::from_millis(100);

/// Steps that a search takes, curves that a start needs besides, and steps to all points of a profile: measured.
const STEPS: usize = 5;
const BESIDES: usize = 10;
const OF_PROFILE: usize = 55;

/// What was done.
pub(super) struct Work<'a> {
    evaluations: AtomicUsize,
    stopped: AtomicBool,
    /// How much of all, and when somebody heard of it.
    heard: Mutex<(f64, Instant)>,
    goes_on: &'a (dyn Fn(f64) -> bool + Sync),
}

impl<'a> Work<'a> {
    pub(super) fn new(goes_on: &'a (dyn Fn(f64) -> bool + Sync)) -> Self {
        let (evaluations, stopped) = (AtomicUsize::new(0), AtomicBool::new(false));
        Self { evaluations, stopped, heard: Mutex::new((0.0, Instant::now())), goes_on }
    }

    /// So much of all is done; whether to go on.
    pub(super) fn done(&self, part: f64) -> bool {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        *heard = (heard.0.max(part), Instant::now());
        let part = heard.0;
        drop(heard);
        if !(self.goes_on)(part) {
            self.stopped.store(true, Ordering::Relaxed);
        }
        self.is_wanted()
    }

    /// One more curve is asked for; whether to go on.
    pub(super) fn counts(&self) -> bool {
        self.evaluations.fetch_add(1, Ordering::Relaxed);
        let heard = *self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        if heard.1.elapsed() > ASKED_EVERY { self.done(heard.0) } else { self.is_wanted() }
    }

    pub(super) fn is_wanted(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed)
    }

    pub(super) fn evaluations(&self) -> usize {
        self.evaluations.load(Ordering::Relaxed)
    }
}

impl Fitter {
    /// About how long a fit will take on one thread, of a cell whose curves take longer than all else: one is made and
    /// timed. `None` of other cells, whose fits take seconds.
    ///
    /// # Errors
    /// As [`Fitter::fit_loaded`].
    pub fn will_take(
        &self,
        curves: &[Loaded],
        settings: &Settings,
    ) -> Result<Option<Duration>, FitError> {
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
        let begun = Instant::now();
        for (number, source) in layout.sources.iter().enumerate() {
            layout.shortening(&at, number, &source.frames.times);
        }
        // Of those that are held, delays and levels, no curve is made anew.
        let of_cell = layout.roles.iter().filter(|role| matches!(role, Role::Physics(_))).count();
        let shown = (0..layout.roles.len()).filter(|&place| layout.is_shown(place)).count();
        let a_step = of_cell + 1;
        let curves =
            settings.starts.max(1) * (BESIDES + STEPS * a_step) + shown * OF_PROFILE * a_step;
        Ok(Some(begun.elapsed() * u32::try_from(curves).unwrap_or(u32::MAX)))
    }
}
