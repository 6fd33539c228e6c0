//! A run prepared by the method of its settings.

use super::observer::{RunObserver, Samples};
use super::outcome::Outcome;
use super::setup::Setup;
use super::space::Space;
use super::{Prepared, PreparedField, PreparedPath, Progress, SetupError, Simulation};
use crate::integrate::Method;
use crate::integrate::engine::EngineUsed;
use crate::integrate::quasi_static::{PathError, Tolerance};

/// Strengths relative to the published parameters' without a warning.
const ORDINARY: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// A prepared run: everything is checked, and it owns its data. In time, along the path of equilibria, or from equilibrium to
/// equilibrium; of a flat or a thick cell.
pub struct Ready(Box<dyn Runs>);

/// What can be asked of a prepared run, whatever its method and axes.
pub(super) trait Runs: Send + Sync {
    /// The simulation, and the tension of a default beat relative to that of the parameters that are scaled to the peak tension.
    fn cell(&self) -> (&Simulation, f64);
    /// Runs to the end or to the first fault.
    fn run_observed(&self, observer: &mut dyn RunObserver) -> Outcome;
    /// Why a path ends before the peak of tension, if it does.
    fn end(&self) -> Option<&PathError> {
        None
    }
    /// Whether what takes time is done, so that the run takes none.
    fn is_solved(&self) -> bool {
        false
    }
    /// The motion of a run in time.
    fn motion(&self) -> Option<Motion<'_>> {
        None
    }
}

/// How a run in time moves the masses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion<'a> {
    /// Mechanical steps in each exchange interval.
    pub steps_per_exchange: usize,
    /// The engine.
    pub engine: &'a EngineUsed,
    /// Why the masses are not at rest under the tension before the first beat, and start from the shape without tension.
    pub not_at_rest: Option<&'a str>,
}

impl<const D: usize, const N: usize> Runs for Prepared<D, N>
where
    Simulation: Space<D, N>,
{
    fn cell(&self) -> (&Simulation, f64) {
        self.setup.cell()
    }

    fn run_observed(&self, observer: &mut dyn RunObserver) -> Outcome {
        self.run_observed(observer)
    }

    fn motion(&self) -> Option<Motion<'_>> {
        Some(Motion {
            steps_per_exchange: self.steps_per_exchange,
            engine: self.engine(),
            not_at_rest: self.not_at_rest.as_deref(),
        })
    }
}

impl<const D: usize, const N: usize> Runs for PreparedPath<D, N>
where
    Simulation: Space<D, N>,
{
    fn cell(&self) -> (&Simulation, f64) {
        self.setup.cell()
    }

    fn run_observed(&self, observer: &mut dyn RunObserver) -> Outcome {
        self.run_observed(observer)
    }

    fn end(&self) -> Option<&PathError> {
        self.end()
    }

    fn is_solved(&self) -> bool {
        true
    }
}

impl<const D: usize, const N: usize> Runs for PreparedField<D, N>
where
    Simulation: Space<D, N>,
{
    fn cell(&self) -> (&Simulation, f64) {
        self.setup.cell()
    }

    fn run_observed(&self, observer: &mut dyn RunObserver) -> Outcome {
        self.run_observed(observer)
    }
}

impl Simulation {
    /// Checks everything and prepares the run by the method of its numerical settings: chooses the
    /// time step, or solves the path of equilibria.
    ///
    /// # Errors
    /// Those of [`Simulation::prepare`], [`Simulation::prepare_quasi_static`] or
    /// [`Simulation::prepare_field`].
    ///
    /// # Example
    /// ```
    /// use myospring::prelude::*;
    /// let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
    /// simulation.numerics.method = Method::QuasiStatic;
    /// let ready = simulation.build()?;
    /// // It owns all that it needs.
    /// let outcome = std::thread::spawn(move || ready.run(|_progress| true)).join().unwrap();
    /// assert!(matches!(outcome.effort, Effort::QuasiStatic { load_steps: 2..10, .. }));
    ///
    /// simulation.numerics.time_step = Some(-1.0);
    /// let error = simulation.build().err().unwrap();
    /// assert_eq!(error.to_string(), "the time step is -1 ms; it must be a finite number above 0");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn build(&self) -> Result<Ready, SetupError> {
        match &self.thick {
            None => self.built::<2, 3>(),
            Some(_) => self.built::<3, 4>(),
        }
    }

    fn built<const D: usize, const N: usize>(&self) -> Result<Ready, SetupError>
    where
        Self: Space<D, N>,
    {
        Ok(match self.numerics.method {
            Method::Verlet(_) => Ready::of(self.in_time::<D, N>()?),
            Method::QuasiStatic if self.has_sites_in_triangles() => {
                Ready::of(self.field::<D, N>(Tolerance::default())?)
            }
            Method::QuasiStatic => self.prepare_quasi_static(Tolerance::default())?,
        })
    }
}

impl Ready {
    pub(super) fn of(run: impl Runs + 'static) -> Self {
        Self(Box::new(run))
    }

    pub(super) fn simulation(&self) -> &Simulation {
        self.0.cell().0
    }

    /// Why the path of equilibria ends before the peak of tension, if it does.
    pub fn end(&self) -> Option<&PathError> {
        self.0.end()
    }

    /// Whether the path of equilibria is solved, so that the run itself takes hardly any time.
    pub fn is_solved(&self) -> bool {
        self.0.is_solved()
    }

    /// How the masses move, if the run is in time.
    pub fn motion(&self) -> Option<Motion<'_>> {
        self.0.motion()
    }

    /// Warnings before a run.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(Motion {
            engine: EngineUsed::Plain { instead_of_fused: Some(hindrance) },
            ..
        }) = self.motion()
        {
            warnings.push(format!(
                "the plain loops move the masses, several times slower than the fused kernel, which does not \
                 serve {hindrance}"
            ));
        }
        if let Some(Motion { not_at_rest: Some(cause), .. }) = self.motion() {
            warnings.push(format!(
                "the run begins in the shape without tension, though the cell has tension at rest: it jerks at the start, \
                 which can make the first beat's rates too large. Its shape at rest was not found: {cause}"
            ));
        }
        let (simulation, strength) = self.0.cell();
        if !ORDINARY.contains(&strength) {
            warnings.push(format!(
                "the cell model's parameters make a default beat {strength:.3} times as strong as the \
                 published ones do: about {:.4} kPa; peak_tension = \"{:.4} kPa\" makes it {} kPa strong",
                strength * simulation.peak_tension,
                simulation.peak_tension / strength,
                simulation.peak_tension
            ));
        }
        warnings
    }

    /// Runs to the end or to the first fault; `observe` is called at each recorded sample and stops
    /// the run by returning `false`.
    pub fn run(&self, observe: impl FnMut(Progress) -> bool) -> Outcome {
        self.run_observed(&mut Samples(observe))
    }

    /// As [`Ready::run`], for an observer that is also called when a part of the work begins.
    pub fn run_observed(&self, observer: &mut dyn RunObserver) -> Outcome {
        self.0.run_observed(observer)
    }
}

impl<const D: usize, const N: usize> Setup<D, N> {
    /// The simulation, and how strong its cell is.
    fn cell(&self) -> (&Simulation, f64) {
        (&self.simulation, self.strength)
    }

    /// Times of the stimuli that fall within the run, ms.
    pub(super) fn stimulus_times(&self) -> Vec<f64> {
        let Simulation { duration, .. } = &self.simulation;
        let times = self.activation.stimulus_times_ms();
        times.into_iter().take_while(|time| time < duration).collect()
    }

    /// When an extra stimulus comes within the run, ms, if one does.
    pub(super) fn s2_ms(&self) -> Option<f64> {
        self.activation.s2_ms().filter(|time| *time < self.simulation.duration)
    }
}
