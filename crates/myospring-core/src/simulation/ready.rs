//! A run prepared by the method of its settings.

use super::observer::{RunObserver, Samples};
use super::outcome::Outcome;
use super::setup::Setup;
use super::{Prepared, PreparedField, PreparedPath, Progress, SetupError, Simulation};
use crate::integrate::Method;
use crate::integrate::engine::EngineUsed;
use crate::integrate::quasi_static::Tolerance;

/// Strengths relative to the published parameters' without a warning.
const ORDINARY: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// A prepared run: everything is checked, and it owns its data.
pub enum Ready {
    /// In time: forces assembled, time step chosen.
    InTime(Prepared),
    /// Along the path of equilibria, which is solved.
    AlongPath(PreparedPath),
    /// From equilibrium to equilibrium.
    FromRestToRest(PreparedField),
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
        Ok(match self.numerics.method {
            Method::Verlet(_) => Ready::InTime(self.prepare()?),
            Method::QuasiStatic if self.has_sites_in_triangles() => {
                Ready::FromRestToRest(self.prepare_field(Tolerance::default())?)
            }
            Method::QuasiStatic => {
                Ready::AlongPath(self.prepare_quasi_static(Tolerance::default())?)
            }
        })
    }
}

impl Ready {
    pub(super) fn setup(&self) -> &Setup {
        match self {
            Self::InTime(prepared) => &prepared.setup,
            Self::AlongPath(prepared) => &prepared.setup,
            Self::FromRestToRest(prepared) => &prepared.setup,
        }
    }

    /// Warnings before a run.
    pub fn warnings(&self) -> Vec<String> {
        let setup = self.setup();
        let mut warnings = Vec::new();
        if let Self::InTime(prepared) = self
            && let EngineUsed::Plain { instead_of_fused: Some(hindrance) } = prepared.engine()
        {
            warnings.push(format!(
                "the plain loops move the masses, several times slower than the fused kernel, which does not \
                 serve {hindrance}"
            ));
        }
        if let Self::InTime(prepared) = self
            && let Some(cause) = &prepared.not_at_rest
        {
            warnings.push(format!(
                "the run begins in the shape without tension, though the cell has tension at rest: it jerks at the start, \
                 which can make the first beat's rates too large. Its shape at rest was not found: {cause}"
            ));
        }
        let (strength, simulation) = (setup.strength, &setup.simulation);
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
        match self {
            Self::InTime(prepared) => prepared.run_observed(observer),
            Self::AlongPath(prepared) => prepared.run_observed(observer),
            Self::FromRestToRest(prepared) => prepared.run_observed(observer),
        }
    }
}

impl Setup {
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
