//! A fit, from a run and its curves to its answer.

use super::answer::{Estimate, Fit, FitVerdict};
use super::contraction::Contraction;
use super::error::FitError;
use super::least_squares::Least;
use super::likelihood::Profile;
use super::observed::{Observed, Scale};
use super::problem::{Layout, Role, Source, shortening};
use super::settings::FitSettings;
use super::sure::{SEARCH, Sure};
use super::table::Shelf;
use super::unknown::{Physics, Unknown};
use super::words::verdicts;
use super::work::Work;
use crate::cell::TensionKind;
use crate::cell::given_tension::GivenTension;
use crate::interruption::Interruption;
use crate::mechanics::material::Stiffness;
use crate::mechanics::support::SupportKind;
use crate::settings::Run;
use crate::simulation::{Simulation, Train};
use crate::study::sampling::Sampler;
use rayon::prelude::*;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Starts lie within this factor of the run's parameters, either way.
const START: f64 = 1.8;
/// Largest correlation without a verdict.
const TOLD_APART: f64 = 0.95;
/// Equilibria are solved up to this multiple of the measured shortening.
const MARGIN: f64 = 2.0;
/// Shortening of a cell whose curves do not show it.
pub(super) const UNKNOWN: f64 = 0.25;
/// Beats before the recorded ones in a train that began earlier: enough for it to be steady.
const BEFORE: usize = 10;
/// A profile that is this far below the answer has found a better one; this many better ones are
/// followed.
const BETTER: f64 = -0.05;
const ANSWERS: usize = 3;

/// A curve of the same cell under another support.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The support.
    pub support: SupportKind,
    /// The measured curve.
    pub observed: Observed,
    /// Relative standard deviation of the scale of a force, moment or energy, such as that of traction microscopy; 0 if it is exact, and for
    /// all other curves.
    pub scale_error: f64,
}

impl Loaded {
    /// A curve whose scale is exact.
    pub fn exact(support: SupportKind, observed: Observed) -> Self {
        Self { support, observed, scale_error: 0.0 }
    }
}

/// The result of a search.
struct Found {
    layout: Layout,
    /// Where each start ended, the best first.
    ends: Vec<Least>,
    before: usize,
}

/// One cell, ready to be fitted to curves.
pub struct Fitter {
    simulation: Simulation,
    shelf: Arc<Shelf>,
    /// Whether the tension itself is sought, whatever the cell model.
    seeks_tension: bool,
}

impl Fitter {
    /// A fitter for the cell of a run: its cell model, shape, material and support, except for the
    /// numbers that are fitted.
    ///
    /// # Errors
    /// A shape that cannot be made; a run that cannot be fitted.
    pub fn of(run: &Run, read: impl Fn(&str) -> io::Result<Vec<u8>>) -> Result<Self, FitError> {
        let bytes = run.shape.bytes(&read)?;
        let shaped = run.shape.mesh(&bytes)?;
        Self::new(run.make(shaped, read)?.simulation)
    }

    /// A fitter for the cell of a simulation; its duration and stimuli do not matter.
    ///
    /// # Errors
    /// A simulation that cannot be fitted.
    pub fn new(simulation: Simulation) -> Result<Self, FitError> {
        match simulation.cell.tension_kind() {
            TensionKind::None => {
                return Err(FitError::Setting {
                    what: "this cell model",
                    why: "it has no tension",
                });
            }
            TensionKind::Kilopascal if simulation.cell.in_fits().strength.is_none() => {
                return Err(FitError::Setting {
                    what: "this cell model",
                    why: "its tension is in kPa, and it has no parameter that scales it",
                });
            }
            _ => {}
        }
        Ok(Self { simulation, shelf: Arc::default(), seeks_tension: false })
    }

    /// For the same cell with another cell model; it shares tables of equilibria where the material is the same.
    ///
    /// # Errors
    /// Those of [`Fitter::new`].
    pub fn beside(&self, simulation: Simulation) -> Result<Self, FitError> {
        let same = simulation.material == self.simulation.material;
        let other = Self::new(simulation)?;
        Ok(if same { Self { shelf: Arc::clone(&self.shelf), ..other } } else { other })
    }

    /// Of a simulation of which the tension itself is sought.
    pub(super) fn seeking_tension(simulation: Simulation) -> Self {
        let simulation = Simulation { cell: Arc::new(GivenTension::example()), ..simulation };
        Self { simulation, shelf: Arc::default(), seeks_tension: true }
    }

    /// Whether the tension itself is sought.
    pub fn seeks_tension(&self) -> bool {
        self.seeks_tension
    }

    /// The tables of its equilibria.
    pub(super) fn shelf(&self) -> &Shelf {
        &self.shelf
    }

    /// The run's peak tension over its Young's modulus; for a tension in kPa the model's greatest
    /// tension over it.
    pub fn tension_over_stiffness(&self) -> f64 {
        self.tension() / self.modulus()
    }

    /// The peak tension of the setting, or the model's greatest tension, kPa.
    pub(super) fn tension(&self) -> f64 {
        let cell = &self.simulation.cell;
        match cell.tension_kind() {
            TensionKind::Relative { .. } => self.simulation.peak_tension,
            _ => cell
                .in_fits()
                .strength
                .and_then(|name| cell.parameters().get(name))
                .unwrap_or(f64::NAN),
        }
    }

    /// Young's modulus, kPa; for given springs that of the sheet that they form.
    pub(super) fn modulus(&self) -> f64 {
        match self.simulation.material.stiffness {
            Stiffness::YoungModulus(modulus) => modulus,
            Stiffness::Spring(stiffness) => stiffness / (0.75 * self.simulation.material.thickness),
        }
    }

    /// The same fitter, which ends early on this interruption.
    #[must_use]
    pub fn interrupted_by(&self, interruption: Interruption) -> Self {
        let simulation = Simulation { interruption, ..self.simulation.clone() };
        Self { simulation, shelf: Arc::clone(&self.shelf), ..*self }
    }

    /// The cell.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The length of a cell of this resting length at times in ms, stimulated at 50 ms, with some numbers other than the
    /// run's, by factors.
    ///
    /// # Errors
    /// An unknown name, or numbers with which the cell does not beat.
    pub fn curve(
        &self,
        factors: &[(&str, f64)],
        resting_length: f64,
        times_ms: &[f64],
    ) -> Result<Vec<f64>, FitError> {
        let free: Vec<Unknown> = factors.iter().map(|(name, _)| Unknown::named(name)).collect();
        let settings = FitSettings { free: Some(free.clone()), ..FitSettings::default() };
        let sought =
            settings.sought(&*self.simulation.cell, |unknown| self.usual(unknown), false)?;
        let last = times_ms.last().copied().unwrap_or_default();
        let cycle = (last - FIRST_STIMULUS).max(100.0);
        let train = Train { before: 0, beats: 1, cycle_ms: cycle };
        let contraction = Contraction::new(&self.simulation, &free, &train, 0.5, &self.shelf)?;
        let of = |wanted: &Unknown| {
            let found = free.iter().zip(factors).find(|(unknown, _)| *unknown == wanted);
            found.map_or(1.0, |(_, (_, factor))| *factor)
        };
        let parameters: Vec<f64> = sought
            .iter()
            .filter(|(unknown, ..)| matches!(unknown, Unknown::Parameter(_)))
            .map(|(unknown, _, usual)| usual * of(unknown))
            .collect();
        let physics = Physics {
            tension: of(&Unknown::TensionOverStiffness),
            stiffness: of(&Unknown::YoungModulus),
            parameters: &parameters,
        };
        let curve = contraction.shortening(&physics, &[FIRST_STIMULUS], times_ms);
        let curve = curve.ok_or(FitError::Setting {
            what: "these factors",
            why: "the cell does not beat with them",
        })?;
        Ok(curve.into_iter().map(|shortening| resting_length * (1.0 - shortening)).collect())
    }

    pub(super) fn usual(&self, unknown: &Unknown) -> f64 {
        match unknown {
            Unknown::TensionOverStiffness => self.tension_over_stiffness(),
            Unknown::YoungModulus => self.modulus(),
            Unknown::PeakTension => self.tension(),
            Unknown::Parameter(name) => {
                self.simulation.cell.parameters().get(name).unwrap_or(f64::NAN)
            }
        }
    }

    /// Fits the cell to curves, all with the support of the run. `goes_on` is called with the part
    /// of the work that is done, from 0 to 1, and ends the fit by returning `false`. Then the
    /// result is `None`, as when the simulation's own interruption ends it.
    ///
    /// # Errors
    ///
    /// Curves without a beat, invalid unknowns, or a cell that beats from no start.
    pub fn fit(
        &self,
        curves: &[Observed],
        settings: &FitSettings,
        goes_on: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<Option<Fit>, FitError> {
        let support = self.simulation.support;
        let curves: Vec<Loaded> =
            curves.iter().map(|observed| Loaded::exact(support, observed.clone())).collect();
        self.fit_loaded(&curves, settings, goes_on)
    }

    /// As [`Fitter::fit`], for curves of one cell under different supports.
    ///
    /// # Errors
    /// Those of [`Fitter::fit`].
    pub fn fit_loaded(
        &self,
        curves: &[Loaded],
        settings: &FitSettings,
        goes_on: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<Option<Fit>, FitError> {
        let found = self.fit_unless_interrupted(curves, settings, goes_on);
        // Any other error is a consequence of the interruption.
        if self.simulation.interruption.is_requested() { Ok(None) } else { found }
    }

    fn fit_unless_interrupted(
        &self,
        curves: &[Loaded],
        settings: &FitSettings,
        goes_on: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<Option<Fit>, FitError> {
        if self.seeks_tension {
            settings.refuse_parameters()?;
            return if goes_on(0.0) { self.own_tension(curves).map(Some) } else { Ok(None) };
        }
        let arbitrary = curves.iter().all(|curve| curve.observed.scale == Scale::Arbitrary);
        let sought =
            settings.sought(&*self.simulation.cell, |unknown| self.usual(unknown), arbitrary)?;
        let unknowns: Vec<Unknown> = sought.iter().map(|(unknown, ..)| unknown.clone()).collect();
        // A train may begin from rest or have begun earlier; only the curve shows which.
        let trains = curves.iter().any(|curve| curve.observed.stimuli.times().len() > 1);
        let paced = if trains { &[BEFORE, 0][..] } else { &[0] };
        let work = Work::new(goes_on, &self.simulation.interruption);
        let mut best: Option<Found> = None;
        for (number, &before) in paced.iter().enumerate() {
            let sources = self.sources(curves, &unknowns, before)?;
            // For a slow cell model only a start from rest is computed.
            if before > 0 && sources.iter().all(|source| source.contraction.is_slow()) {
                continue;
            }
            let layout = Layout::new(sources, &sought);
            let part = |part: f64| SEARCH * (number as f64 + part) / paced.len() as f64;
            let Some(ends) = Self::search(&layout, settings, &work, &part)? else {
                return Ok(None);
            };
            if best.as_ref().is_none_or(|best| ends[0].sum < best.ends[0].sum) {
                best = Some(Found { layout, ends, before });
            }
        }
        let Some(Found { mut layout, mut ends, before }) = best else { return Ok(None) };
        if layout.leave_out_bad_frames(&ends[0]) {
            ends = minimise_again(&layout, &ends, &work);
        }
        if ends.is_empty() {
            return Ok(None);
        }
        if layout.scale_errors().next().is_some() {
            // The errors of scales are known, whatever the misfit of the curves.
            let Some(deviation) = Sure::deviation(&layout, &ends[0]) else { return Ok(None) };
            layout.unit = deviation;
            ends = minimise_again(&layout, &ends, &work);
        }
        if ends.is_empty() {
            return Ok(None);
        }
        let fit = self.answer(layout, ends, settings, &work);
        Ok(fit.map(|fit| Fit { beats_before: before, ..fit }))
    }

    /// Each curve with the cell that makes it.
    pub(super) fn sources(
        &self,
        curves: &[Loaded],
        unknowns: &[Unknown],
        before: usize,
    ) -> Result<Vec<Source>, FitError> {
        let (mut sources, mut shape): (Vec<Source>, Option<f64>) = (Vec::new(), None);
        for curve in curves {
            let source = self.source(curve, unknowns, before, shape)?;
            shape = source.shortening().into_iter().chain(shape).reduce(f64::max);
            sources.push(source);
        }
        Ok(sources)
    }

    /// A curve with the cell that makes it; `shape` is the largest shortening of the curves before it.
    pub(super) fn source(
        &self,
        curve: &Loaded,
        unknowns: &[Unknown],
        before: usize,
        shape: Option<f64>,
    ) -> Result<Source, FitError> {
        let observed = curve.observed.clone();
        let frames = observed.frames()?;
        let stimuli = observed.stimuli.times();
        let (first, last) = (stimuli[0], stimuli[stimuli.len() - 1]);
        let end = frames.times.last().copied().unwrap_or(last);
        let cycle = if stimuli.len() > 1 {
            (last - first) / (stimuli.len() - 1) as f64
        } else {
            (end - first).max(ONE_BEAT)
        };
        let up_to = match observed.scale {
            // The cell pulls at a gel while it shortens no more than its shape shows.
            Scale::Load(_) => shape,
            scale => shortening(scale, frames.rest, frames.reach),
        };
        let up_to = up_to.unwrap_or(UNKNOWN);
        let simulation = Simulation { support: curve.support, ..self.simulation.clone() };
        let train = Train { before, beats: stimuli.len(), cycle_ms: cycle };
        let up_to = (MARGIN * up_to).clamp(0.02, 0.8);
        let contraction = Contraction::new(&simulation, unknowns, &train, up_to, &self.shelf)?;
        if let Scale::Load(load) = observed.scale
            && contraction.load(load, 1.0, 0.0).is_none()
        {
            return Err(FitError::NoLoad { name: observed.name, load });
        }
        let (used, scale_error) = (vec![true; frames.values.len()], curve.scale_error);
        Ok(Source { observed, frames, contraction, used, cycle, scale_error })
    }

    /// The end of each start, the best first, at least one; `part` is the part of all work that is
    /// then done.
    fn search(
        layout: &Layout,
        settings: &FitSettings,
        work: &Work<'_>,
        part: &(dyn Fn(f64) -> f64 + Sync),
    ) -> Result<Option<Vec<Least>>, FitError> {
        let count = settings.starts.max(1);
        let varied = layout.roles.iter().filter(|role| {
            matches!(role, Role::Physics(unknown) if *unknown != Unknown::TensionOverStiffness)
        });
        let dimensions = varied.count().max(1);
        let design = Sampler::LatinHypercube { size: count }.unit_cube(dimensions, settings.seed);
        let design =
            design.map_err(|_| FitError::Nowhere { starts: count, why: "no design".to_owned() })?;
        let done = AtomicUsize::new(0);
        let mut found: Vec<Least> = (0..count)
            .into_par_iter()
            .filter_map(|number| {
                if !work.is_wanted() {
                    return None;
                }
                // The first is the run's own cell.
                let point = design.point(number)?;
                let factor =
                    |place: f64| if number == 0 { 1.0 } else { START.powf(2.0 * place - 1.0) };
                let factors: Vec<f64> = point.into_iter().map(factor).collect();
                let start = layout.start(&factors)?;
                let least = minimise(layout, &start, work);
                let begun = done.fetch_add(1, Ordering::Relaxed) + 1;
                work.done(part(begun as f64 / count as f64));
                least
            })
            .collect();
        if !work.is_wanted() {
            return Ok(None);
        }
        if found.is_empty() {
            let why = "the cell does not beat with such parameters, or the curve shows no rise";
            return Err(FitError::Nowhere { starts: count, why: why.to_owned() });
        }
        found.sort_by(|a, b| a.sum.total_cmp(&b.sum));
        Ok(Some(found))
    }

    fn answer(
        &self,
        mut layout: Layout,
        mut ends: Vec<Least>,
        settings: &FitSettings,
        work: &Work<'_>,
    ) -> Option<Fit> {
        let shown = |&place: &usize| settings.intervals && layout.is_shown(place);
        let shown: Vec<usize> = (0..layout.roles.len()).filter(shown).collect();
        let mut sure = Sure::of(&layout, &ends, &shown, work)?;
        let starts = ends.clone();
        for _ in 1..ANSWERS {
            let lowest = sure.profiles.iter().map(|profile| &profile.lowest);
            let lowest = lowest.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|low| low.0 < BETTER);
            let better = lowest.and_then(|(_, at)| minimise(&layout, at, work));
            let Some(better) = better.filter(|better| better.sum < ends[0].sum) else { break };
            ends.insert(0, better);
            sure = Sure::of(&layout, &ends, &shown, work)?;
        }
        let least = &ends[0];
        let Sure { covariance, unit, at_ends, reduced, factor, .. } = &sure;
        let (unit, at_ends, reduced, factor) = (*unit, *at_ends, *reduced, *factor);
        let mut estimates = self.estimates(&layout, least, &shown, &sure);
        let mut sums: Vec<Vec<usize>> = shown.iter().map(|place| vec![*place]).collect();
        let both = layout.ratio_and_stiffness().filter(|_| settings.intervals);
        let after = both.and_then(|[_, stiffness]| shown.iter().position(|it| *it == stiffness));
        if let (Some(both), Some(after)) = (both, after) {
            // The logarithm of the tension is the sum of the two.
            sums.insert(after + 1, both.to_vec());
        }
        let correlations = covariance.as_ref().map(|all| {
            let product = |a: &Vec<usize>, b: &Vec<usize>| -> f64 {
                a.iter().map(|j| b.iter().map(|k| all[*j][*k]).sum::<f64>()).sum()
            };
            let of = |a, b| product(a, b) / (product(a, a) * product(b, b)).sqrt();
            let row = |a| sums.iter().map(|b| of(a, b)).collect();
            sums.iter().map(row).collect::<Vec<Vec<f64>>>()
        });
        let name = |at: usize| layout.name(sums[at][0]);
        let mut correlated = Vec::new();
        for (j, row) in correlations.iter().flatten().enumerate() {
            for (k, correlation) in row.iter().enumerate().skip(j + 1) {
                if correlation.abs() > TOLD_APART && sums[j].len() == sums[k].len() {
                    correlated.push((name(j), name(k), *correlation));
                }
            }
        }
        let curves = (0..layout.sources.len()).map(|number| layout.fitted(least, number));
        let curves = curves.collect::<Option<_>>()?;
        let numbers = layout.roles.len();
        let agreeing = starts.iter().filter(|end| (end.sum - least.sum) / unit < at_ends).count();
        let count = least.residuals.len() as f64;
        if let (Some(both), Some(after)) = (both, after) {
            layout.seek_tension(both, &mut ends);
            let sure = Sure::of(&layout, &ends, &both[..1], work)?;
            let own = self.estimates(&layout, &ends[0], &both[..1], &sure);
            for own in own {
                estimates.insert(after + 1, own);
            }
        }
        let mut fit = Fit {
            model: self.simulation.cell.name().to_owned(),
            estimates,
            correlations,
            correlated,
            variance_factor: factor,
            rise_at_ends: at_ends,
            verdict: FitVerdict::Fits,
            curves,
            verdicts: Vec::new(),
            beats_before: 0,
            agreeing_starts: [agreeing, settings.starts.max(1)],
            starts: starts.iter().map(|end| (end.sum / count).sqrt()).collect(),
            reduced_chi_squared: reduced,
            numbers,
            evaluations: work.evaluations(),
            own_tension: None,
            tried: Vec::new(),
            calcium: None,
        };
        fit.judge();
        fit.verdicts = verdicts(&fit, &self.simulation, self.modulus());
        Some(fit)
    }

    /// The estimates of unknowns from their profiles.
    fn estimates(
        &self,
        layout: &Layout,
        least: &Least,
        shown: &[usize],
        sure: &Sure,
    ) -> Vec<Estimate> {
        let Sure { profiles, covariance, unit, .. } = sure;
        let deviation = |place: usize| Some((covariance.as_ref()?[place][place] * unit).sqrt());
        let estimate = |(&place, profile): (&usize, &Profile)| {
            let [low, high] = layout.bounds[place];
            let value = |x: f64| self.value(layout, place, x);
            Estimate {
                name: layout.name(place),
                unknown: layout.unknown(place).cloned(),
                unit: self.unit(layout, place),
                value: value(least.at[place]),
                interval: profile.ends.map(|end| end.map(value)),
                standard_deviation: deviation(place).map(|deviation| {
                    let is_log = matches!(layout.roles[place], Role::Physics(_));
                    if is_log { deviation * value(least.at[place]) } else { deviation }
                }),
                bounds: [value(low), value(high)],
                profile: profile.points.iter().map(|[x, rise]| [value(*x), *rise]).collect(),
                verdict: profile.verdict,
            }
        };
        shown.iter().zip(profiles).map(estimate).collect()
    }

    /// A number as people read it.
    fn value(&self, layout: &Layout, place: usize, x: f64) -> f64 {
        match &layout.roles[place] {
            Role::Physics(unknown) => self.usual(unknown) * x.exp(),
            _ => x,
        }
    }

    fn unit(&self, layout: &Layout, place: usize) -> String {
        match &layout.roles[place] {
            Role::Physics(Unknown::TensionOverStiffness) | Role::ScaleError { .. } => String::new(),
            Role::Physics(Unknown::YoungModulus | Unknown::PeakTension) => "kPa".to_owned(),
            Role::Physics(Unknown::Parameter(name)) => {
                let rows = self.simulation.cell.parameters().rows();
                let row = rows.iter().find(|row| row.name == *name);
                row.map(|row| row.unit.to_string()).unwrap_or_default()
            }
            Role::Delay { .. } => "ms".to_owned(),
            Role::Level { source } | Role::Gain { source } | Role::Drift { source } => {
                layout.sources[*source].observed.unit.clone()
            }
        }
    }
}

/// Time of the stimulus of [`Fitter::curve`], ms.
const FIRST_STIMULUS: f64 = 50.0;
/// A beat lasts at least so long, ms.
pub(super) const ONE_BEAT: f64 = 600.0;

/// The answers again, after the problem has changed, the best first.
fn minimise_again(layout: &Layout, ends: &[Least], work: &Work<'_>) -> Vec<Least> {
    let mut ends: Vec<Least> =
        ends.iter().filter_map(|end| minimise(layout, &end.at, work)).collect();
    ends.sort_by(|a, b| a.sum.total_cmp(&b.sum));
    ends
}

fn minimise(layout: &Layout, start: &[f64], work: &Work<'_>) -> Option<Least> {
    let residuals = layout.counted(work);
    let slopes = |at: &[f64], held: &[bool]| layout.slopes(at, held, work);
    let problem = layout.problem(&residuals, &slopes);
    problem.minimise(start, &vec![false; start.len()])
}
