//! One cell, ready to be fitted: the way of every fit, whether its curve comes from a table, a film or an array.

use super::curves::{self, Named};
use super::words;
use crate::experiment::{BeatOptions, ExperimentError, Observer};
use crate::fit::{Fit, FitError, FitOptions, FitSettings, Fitter, Loaded, Observed};
use crate::measured::Curve;
use crate::settings::{MeshedRun, Run};
use crate::study::Threads;
use std::sync::atomic::{AtomicU64, Ordering};

/// Steps of the progress of all fits.
const STEPS: f64 = 1000.0;

/// A cell on its mesh, and what is sought of it.
pub struct FittableCell {
    pub(super) run: Run,
    pub(super) fitter: Fitter,
    pub(super) spacing_um: f64,
    settings: FitSettings,
    beats: BeatOptions,
    /// Curves of the same cell between springs.
    loaded: Vec<Loaded>,
}

/// A cell and its fit, or why there is none.
pub struct FittedCell {
    /// Name of its curve.
    pub name: String,
    /// The fit.
    pub found: Result<Fit, ExperimentError>,
}

impl FittableCell {
    /// A cell whose run is made; `seeks_tension` fits no parameter, but the tension itself. `own`
    /// is when it was stimulated, and curves of it between springs.
    ///
    /// # Errors
    /// A run that cannot be fitted, and names that are not sought.
    pub fn new(
        run: Run,
        made: MeshedRun,
        seeks_tension: bool,
        sought: &FitOptions,
        (beats, loaded): (BeatOptions, Vec<Loaded>),
    ) -> Result<Self, ExperimentError> {
        let spacing_um = made.report.spacing_um;
        let fitter = if seeks_tension {
            Fitter::of_tension(made.simulation)?
        } else {
            Fitter::new(made.simulation)?
        };
        let settings = sought.settings(&*fitter.simulation().cell, !loaded.is_empty());
        let settings = settings.map_err(|error| not_sought(error, sought))?;
        Ok(Self { run, fitter, spacing_um, settings, beats, loaded })
    }

    /// Fits the cell to each curve, until the work is interrupted; `notes` are added to the error of a single one.
    ///
    /// # Errors
    /// For a single curve, why it cannot be fitted; for several, the reason is in the cell's row.
    pub fn fit(
        &self,
        curves: &[Named],
        notes: &[String],
        threads: &Threads,
        observer: &dyn Observer,
    ) -> Result<Vec<FittedCell>, ExperimentError> {
        self.forecast(curves, threads, observer);
        observer.stage("\u{2030} of the fits", STEPS as u64);
        let interruption = observer.interruption();
        let fitter = self.fitter.interrupted_by(interruption.clone());
        let (done, count) = (AtomicU64::new(0), curves.len());
        let mut cells = Vec::new();
        for (number, (name, curve)) in curves.iter().enumerate() {
            let goes_on = |part: f64| {
                let now = (STEPS * (number as f64 + part) / count as f64) as u64;
                observer.reached(done.fetch_max(now, Ordering::Relaxed).max(now));
                !interruption.is_requested()
            };
            let fitted = |curve: &Curve| {
                let all = self.with_loaded(curves::observed(curve, &self.beats)?);
                threads.install(|| fitter.fit_loaded(&all, &self.settings, &goes_on))
            };
            let found = match curve {
                Ok(curve) => fitted(curve).map_err(|error| with_notes(error, notes)),
                Err(error) => Err(error.clone()),
            };
            let found = match found {
                Ok(Some(fit)) => Ok(fit),
                Ok(None) => break,
                Err(error) if count == 1 => return Err(error),
                Err(error) => Err(error),
            };
            cells.push(FittedCell { name: name.clone(), found });
        }
        Ok(cells)
    }

    /// The run that beats like a fitted cell, and the spacing of its mesh, um.
    ///
    /// # Errors
    /// Numbers that the model does not take.
    pub fn fitted_run(&self, fit: &Fit) -> Result<(Run, f64), ExperimentError> {
        Ok((self.fitter.fitted(self.run.clone(), fit)?, self.spacing_um))
    }

    /// Notes how long the fits take, where that is long.
    fn forecast(&self, curves: &[Named], threads: &Threads, observer: &dyn Observer) {
        // A curve without a beat says so later.
        let first = |curve: &Named| curves::observed(curve.1.as_ref().ok()?, &self.beats).ok();
        let takes = curves.iter().find_map(first).and_then(|observed| {
            self.fitter.will_take(&self.with_loaded(observed), &self.settings).ok().flatten()
        });
        if let Some(one) = takes {
            observer.note(&words::will_take(one, curves.len(), threads.count()));
        }
    }

    fn with_loaded(&self, observed: Observed) -> Vec<Loaded> {
        let support = self.fitter.simulation().support;
        [Loaded { support, observed }].into_iter().chain(self.loaded.iter().cloned()).collect()
    }
}

fn not_sought(error: FitError, asked: &FitOptions) -> ExperimentError {
    match error {
        FitError::NotFitted { name, sought } if asked.fix.iter().any(|it| it.trim() == name) => {
            ExperimentError::new(format!("--fix: `{name}` is not fitted anyway"))
                .advise(format!("fitted are {sought}"))
        }
        FitError::NotFitted { name, sought } => {
            ExperimentError::new(format!("--bounds: `{name}` is not fitted"))
                .advise(format!("fitted are {sought}; --free adds others"))
        }
        error => error.into(),
    }
}

fn with_notes(error: FitError, notes: &[String]) -> ExperimentError {
    notes.iter().fold(error.into(), |failure: ExperimentError, note| failure.also(note))
}

impl From<FitError> for ExperimentError {
    fn from(error: FitError) -> Self {
        let advice = match &error {
            FitError::Curve { .. } | FitError::NoBeat { .. } => {
                "`myospring analyse` shows the curve and the beats found in it"
            }
            FitError::TooMany { .. } => {
                "`--fix Ca50_ref` fixes one; without --free the other two are fitted"
            }
            FitError::Kind { .. } => "--columns chooses another column, --kind says what it is",
            FitError::Unknown { .. } => return Self::of_name(error),
            _ => return Self::new(error),
        };
        Self::new(error).advise(advice)
    }
}
