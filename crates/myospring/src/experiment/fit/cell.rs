//! One cell, ready to be fitted: the way of every fit, whether its curve comes from a table, a film or an array.

use super::calcium::DrivingCalcium;
use super::curves::{self, Named};
use super::models::{Driven, Models};
use super::simulation::simulation;
use super::words;
use crate::cell::CellModel as _;
use crate::cell::given_tension::GivenTension;
use crate::experiment::{BeatOptions, ExperimentError, Observer};
use crate::fit::{
    self, Fit, FitError, FitOptions, FitSettings, Fitter, Loaded, Observed, RecordedCourse, Scale,
};
use crate::interruption::Interruption;
use crate::measured::Curve;
use crate::settings::{MeshedRun, Run};
use crate::simulation::Simulation;
use crate::study::Threads;
use std::sync::atomic::{AtomicU64, Ordering};

/// Starts of each model while several are tried; the one that is taken has all that were asked for.
const STARTS: usize = 4;
/// Peak shortening, %, that is assumed for the tension itself of a curve that does not tell it: unloaded cells shorten by 7 to 12 %.
const USUAL_SHORTENING_PCT: f64 = 10.0;
/// What is added to the name of a model that recorded calcium drives.
const MEASURED: &str = ", measured calcium";
/// Steps of the progress of all fits.
const STEPS: f64 = 1000.0;

/// A cell on its mesh, and what is sought of it.
pub struct FittableCell {
    /// One for each cell model that is fitted; at least one.
    candidates: Vec<Candidate>,
    /// Models that do not suit the cell, by name, with the reason.
    refused: Vec<(String, ExperimentError)>,
    spacing_um: f64,
    beats: BeatOptions,
    /// Curves of the same cell between springs.
    loaded: Vec<Loaded>,
    /// Of curves in arbitrary units, %.
    peak_shortening_pct: Option<f64>,
    /// Calcium that was recorded together with the only curve.
    calcium: Option<DrivingCalcium>,
}

/// The cell with one cell model.
pub(super) struct Candidate {
    pub(super) run: Run,
    pub(super) fitter: Fitter,
    settings: FitSettings,
    /// Whether the recorded calcium drives it.
    driven: bool,
}

/// A cell and its fit, or why there is none.
pub struct FittedCell {
    /// Name of its curve.
    pub name: String,
    /// The fit.
    pub found: Result<Fit, ExperimentError>,
}

impl Candidate {
    fn new(
        run: Run,
        fitter: Fitter,
        sought: &FitOptions,
        loaded: bool,
    ) -> Result<Self, ExperimentError> {
        // Of the tension itself no number is chosen.
        let loaded = loaded && !fitter.seeks_tension();
        let settings = sought.settings(&*fitter.simulation().cell, loaded);
        let settings = settings.map_err(|error| not_sought(error, sought))?;
        Ok(Self { run, fitter, settings, driven: false })
    }

    /// The same cell, driven by calcium that was recorded; `None` if its model takes no calcium or has its own from a table.
    fn driven(&self, calcium: &DrivingCalcium) -> Option<Result<Self, ExperimentError>> {
        if self.run.calcium.is_some() || self.fitter.seeks_tension() {
            return None;
        }
        let simulation = self.fitter.simulation();
        let cell = simulation.cell.with_calcium(&calcium.trace)?;
        let fitter = self.fitter.beside(Simulation { cell, ..simulation.clone() });
        let (run, settings) = (self.run.clone(), self.settings.clone());
        let driven = |fitter| Self { run, fitter, settings, driven: true };
        Some(fitter.map(driven).map_err(ExperimentError::from))
    }

    /// Its cell model, and what drives it.
    fn model(&self) -> String {
        let name = self.fitter.simulation().cell.name();
        if self.driven { format!("{name}{MEASURED}") } else { name.to_owned() }
    }
}

impl FittableCell {
    /// A cell whose run is made. `own` is when it was stimulated, and curves of it between springs.
    ///
    /// # Errors
    /// A run that cannot be fitted, and names that are not sought.
    pub fn new(
        run: Run,
        made: MeshedRun,
        models: Models,
        sought: &FitOptions,
        (beats, loaded, calcium): (BeatOptions, Vec<Loaded>, Option<DrivingCalcium>),
    ) -> Result<Self, ExperimentError> {
        let MeshedRun { simulation, report, .. } = made;
        let with = |run, fitter: Result<Fitter, FitError>| {
            Candidate::new(run, fitter?, sought, !loaded.is_empty())
        };
        let mut refused = Vec::new();
        let of_run = matches!(models, Models::OfRun);
        let candidates = match models {
            Models::OfRun => vec![with(run, Fitter::new(simulation))?],
            Models::Tension => vec![with(run, Fitter::of_tension(simulation))?],
            Models::All(all) => {
                let first = Fitter::new(simulation)?;
                let mut candidates = Vec::new();
                for (name, driven) in all {
                    let candidate = driven.and_then(|Driven { run: own, cell }| {
                        let made = self::simulation(first.simulation(), &own)?;
                        let fitter = first.beside(Simulation { cell, ..made });
                        with(Run { shape: run.shape.clone(), fibre: run.fibre, ..own }, fitter)
                    });
                    match candidate {
                        Ok(candidate) => candidates.push(candidate),
                        Err(error) => refused.push((name, error)),
                    }
                }
                if candidates.is_empty() {
                    let (_, error) = refused.swap_remove(0);
                    return Err(error);
                }
                match with(run, Fitter::of_tension(first.simulation().clone())) {
                    Ok(own) => candidates.push(own),
                    Err(error) => refused.push((GivenTension::example().name().to_owned(), error)),
                }
                candidates
            }
        };
        let (candidates, calcium) = with_calcium(candidates, calcium, of_run)?;
        let (spacing_um, peak_shortening_pct) = (report.spacing_um, sought.peak_shortening_pct);
        Ok(Self { candidates, refused, spacing_um, beats, loaded, peak_shortening_pct, calcium })
    }

    /// The cell with the model of a fit.
    pub(super) fn of(&self, fit: &Fit) -> &Candidate {
        let found = self.candidates.iter().find(|candidate| candidate.model() == fit.model);
        found.unwrap_or(self.first())
    }

    /// The cell with the first model that suits it.
    pub(super) fn first(&self) -> &Candidate {
        &self.candidates[0]
    }

    pub(super) fn spacing_um(&self) -> f64 {
        self.spacing_um
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
        let slow = self.slow(curves, threads, observer);
        observer.stage("\u{2030} of the fits", STEPS as u64);
        let interruption = observer.interruption();
        let (done, count) = (AtomicU64::new(0), curves.len());
        let mut cells = Vec::new();
        for (number, (name, curve)) in curves.iter().enumerate() {
            let goes_on = |part: f64| {
                let now = (STEPS * (number as f64 + part) / count as f64) as u64;
                observer.reached(done.fetch_max(now, Ordering::Relaxed).max(now));
                !interruption.is_requested()
            };
            let fitted = |curve: &Curve| {
                let all = self.with_loaded(self.observed(curve)?);
                let assumed = self.assumed(curve, &all)?;
                let seen = [&all, assumed.as_ref().unwrap_or(&all)];
                let fit = threads.install(|| self.fit_one(seen, &slow, &interruption, &goes_on))?;
                let is_assumed = |fit: &Fit| assumed.is_some() && fit.own_tension.is_some();
                Ok(fit.map(|fit| {
                    let peak = is_assumed(&fit).then_some(USUAL_SHORTENING_PCT);
                    fit.with_peak(peak.or(self.peak_shortening_pct))
                }))
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

    /// The simplest fit that follows the curves, of models and of the tension itself; `None` if the work was interrupted.
    fn fit_one(
        &self,
        curves: [&Vec<Loaded>; 2],
        slow: &[Option<String>],
        interruption: &Interruption,
        goes_on: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<Option<Fit>, ExperimentError> {
        let count = self.candidates.len();
        let several = count + self.refused.len() > 1;
        // All models without intervals, then the one that is taken with them.
        let works = if several { count + 1 } else { 1 };
        let fit = |number: usize, candidate: &Candidate, settings: &FitSettings| {
            let part = |part: f64| goes_on((number as f64 + part) / works as f64);
            let fitter = candidate.fitter.interrupted_by(interruption.clone());
            let found = fitter.fit_loaded(&self.seen_by(candidate, curves), settings, &part)?;
            Ok::<_, FitError>(found.map(|fit| self.told_of(candidate, fit)))
        };
        if !several {
            return Ok(fit(0, self.first(), &self.first().settings)?);
        }
        let mut fits = Vec::new();
        for (number, (candidate, slow)) in self.candidates.iter().zip(slow).enumerate() {
            let starts = candidate.settings.starts.min(STARTS);
            let settings = FitSettings { intervals: false, starts, ..candidate.settings.clone() };
            let found = match slow {
                Some(why) => Err(ExperimentError::new(why)),
                None => match fit(number, candidate, &settings) {
                    Ok(None) => return Ok(None),
                    Ok(Some(fit)) => Ok(fit),
                    Err(error) => Err(error.into()),
                },
            };
            fits.push((candidate.model(), found));
        }
        fits.extend(self.refused.iter().map(|(name, error)| (name.clone(), Err(error.clone()))));
        let (taken, tried) = fit::simplest(&fits);
        let (_, first) = fits.swap_remove(taken);
        let first = first?;
        let whole = match first.own_tension {
            Some(_) => Some(first),
            None => fit(count, &self.candidates[taken], &self.candidates[taken].settings)?,
        };
        Ok(whole.map(|fit| fit.among(tried)))
    }

    /// The curves as a model is fitted to them: for one that recorded calcium drives, the first has the clock of calcium.
    fn seen_by(&self, candidate: &Candidate, curves: [&Vec<Loaded>; 2]) -> Vec<Loaded> {
        let mut curves = curves[usize::from(candidate.fitter.seeks_tension())].clone();
        if let (true, Some(calcium), Some(first)) =
            (candidate.driven, &self.calcium, curves.first_mut())
        {
            first.observed.stimuli = calcium.stimuli.clone();
        }
        curves
    }

    /// A fit with the name of its model and the calcium that was recorded.
    fn told_of(&self, candidate: &Candidate, fit: Fit) -> Fit {
        let calcium = self
            .calcium
            .as_ref()
            .map(|calcium| RecordedCourse { drives: candidate.driven, ..calcium.course.clone() });
        Fit { model: candidate.model(), calcium, ..fit }
    }

    /// The run that beats like a fitted cell, and the spacing of its mesh, um.
    ///
    /// # Errors
    /// Numbers that the model does not take.
    pub fn fitted_run(&self, fit: &Fit) -> Result<(Run, f64), ExperimentError> {
        let Candidate { run, fitter, .. } = self.of(fit);
        Ok((fitter.fitted(run.clone(), fit)?, self.spacing_um))
    }

    /// For each model, why it is too slow to be tried beside others. How long the fits with a single one take is noted, where that
    /// is long.
    fn slow(
        &self,
        curves: &[Named],
        threads: &Threads,
        observer: &dyn Observer,
    ) -> Vec<Option<String>> {
        // A curve without a beat says so later.
        let first = |curve: &Named| self.observed(curve.1.as_ref().ok()?).ok();
        let curve = || curves.iter().find_map(first).map(|observed| self.with_loaded(observed));
        let models = self.candidates.iter().filter(|it| !it.fitter.seeks_tension()).count();
        let of = |candidate: &Candidate| {
            let Candidate { fitter, settings, .. } = candidate;
            if !fitter.is_slow(settings).ok()? {
                return None;
            }
            if models > 1 {
                return Some(words::too_slow(&candidate.model()));
            }
            let one = fitter.will_take(&curve()?, settings).ok()?;
            observer.note(&words::will_take(one, curves.len(), threads.count()));
            None
        };
        self.candidates.iter().map(of).collect()
    }

    /// The curves for the tension itself, if the curve is in arbitrary units and nothing says how far the cell shortens.
    fn assumed(&self, curve: &Curve, all: &[Loaded]) -> Result<Option<Vec<Loaded>>, FitError> {
        let is_arbitrary = all[0].observed.scale == Scale::Arbitrary;
        let sought = self.candidates.iter().any(|candidate| candidate.fitter.seeks_tension());
        if !(is_arbitrary && sought) {
            return Ok(None);
        }
        let observed = curves::observed(curve, &self.beats, Some(USUAL_SHORTENING_PCT))?;
        Ok(Some(self.with_loaded(observed)))
    }

    fn observed(&self, curve: &Curve) -> Result<Observed, FitError> {
        curves::observed(curve, &self.beats, self.peak_shortening_pct)
    }

    fn with_loaded(&self, observed: Observed) -> Vec<Loaded> {
        let support = self.first().fitter.simulation().support;
        let own = Loaded::exact(support, observed);
        std::iter::once(own).chain(self.loaded.iter().cloned()).collect()
    }
}

/// The models that are fitted where calcium was recorded: that of the run is driven by it (`of_run`); of several, each that takes calcium
/// is added once more. Models of which none takes it leave it out, unless only one was asked for.
fn with_calcium(
    mut candidates: Vec<Candidate>,
    calcium: Option<DrivingCalcium>,
    of_run: bool,
) -> Result<(Vec<Candidate>, Option<DrivingCalcium>), ExperimentError> {
    let Some(calcium) = calcium else { return Ok((candidates, None)) };
    let driven = candidates.iter().filter_map(|candidate| candidate.driven(&calcium));
    let driven: Vec<Candidate> = driven.collect::<Result<_, _>>()?;
    if of_run && !driven.is_empty() {
        candidates = driven;
    } else {
        // Before the tension itself, which comes last.
        let place = candidates.iter().position(|it| it.fitter.seeks_tension());
        let place = place.unwrap_or(candidates.len());
        candidates.splice(place..place, driven);
    }
    Ok((candidates, Some(calcium)))
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

fn with_notes(error: ExperimentError, notes: &[String]) -> ExperimentError {
    notes.iter().fold(error, |failure, note| failure.also(note))
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
