//! Chooses the loops of the integrator; an impossible choice is an error, never silently replaced.

use super::fused::FusedMotion;
use super::stencil::Units;
use super::stepper::Stepper;
use super::verlet::{Integrator, Motion};
use crate::mechanics::{Body, System};
use crate::mesh::Lattice;
use serde::{Deserialize, Serialize};

/// Implementation of the loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loops {
    /// The fused kernel if it supports the simulation, else the plain loops.
    Auto,
    /// Plain loops over all laws: any mesh, force, tension and form of Verlet's method.
    Plain,
    /// The fused kernel of a lattice, or an error.
    Fused,
}

/// The requested engine of the integrator; [`Default`] is the fastest possible one on one thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Engine {
    /// Implementation of the loops.
    pub loops: Loops,
    /// Vector units of the fused kernel; `None` uses the best of the processor.
    pub units: Option<Units>,
    /// Largest number of threads of the fused kernel; the result does not depend on it, bitwise.
    pub threads: usize,
}

impl Default for Engine {
    fn default() -> Self {
        Self { loops: Loops::Auto, units: None, threads: 1 }
    }
}

/// The engine that was used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "loops", rename_all = "kebab-case")]
pub enum EngineUsed {
    /// The fused kernel.
    Fused {
        /// Vector units.
        vector_units: Units,
        /// Threads.
        threads: usize,
    },
    /// The plain loops.
    Plain {
        /// What the fused kernel does not support, in words; absent if it was not requested.
        #[serde(skip_serializing_if = "Option::is_none")]
        instead_of_fused: Option<String>,
    },
    /// A custom stepper.
    Own,
}

/// Why an engine cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EngineError {
    /// The fused kernel does not support something.
    #[error(
        "engine = \"fused\": the fused kernel does not support {what}; use engine = \"plain\", or \"auto\", \
         which chooses"
    )]
    Unsupported {
        /// What it does not support.
        what: String,
    },
    /// The processor lacks vector units.
    #[error("this processor has no vector units {wanted}; it has: {available}")]
    NoUnits {
        /// The requested ones.
        wanted: &'static str,
        /// The available ones.
        available: String,
    },
}

/// A motion for which an engine is chosen.
#[derive(Clone, Copy)]
pub struct Task<'a, const D: usize = 2> {
    /// All forces on the body.
    pub system: &'a System<D>,
    /// The body at its start.
    pub body: &'a Body<D>,
    /// Its lattice, if it has one.
    pub lattice: Option<&'a Lattice<D>>,
    /// Form of Verlet's method.
    pub form: Integrator,
    /// Time step, ms.
    pub time_step: f64,
    /// Whether the tension is the same everywhere.
    pub uniform_tension: bool,
}

impl Engine {
    /// Makes a stepper, and returns which engine it uses.
    ///
    /// # Errors
    /// The fused kernel was requested but does not support the motion, or the processor lacks its
    /// vector units.
    pub fn stepper<'a, const D: usize>(
        &self,
        task: &Task<'a, D>,
    ) -> Result<(Box<dyn Stepper<D> + 'a>, EngineUsed), EngineError> {
        let units = self.units.unwrap_or_else(Units::best);
        if !units.available() {
            let available = Units::ALL.into_iter().filter(|units| units.available());
            let available = available.map(Units::name).collect::<Vec<_>>().join(", ");
            return Err(EngineError::NoUnits { wanted: units.name(), available });
        }
        let plain = |instead_of_fused| {
            let Task { system, body, form, time_step, .. } = *task;
            let motion = Motion::new(system, body.clone(), form, time_step);
            (Box::new(motion) as Box<dyn Stepper<D> + 'a>, EngineUsed::Plain { instead_of_fused })
        };
        if self.loops == Loops::Plain {
            return Ok(plain(None));
        }
        match fused(task, self.threads, units) {
            Ok(motion) => {
                let used = EngineUsed::Fused { vector_units: units, threads: motion.threads() };
                Ok((Box::new(motion), used))
            }
            Err(what) if self.loops == Loops::Auto => Ok(plain(Some(what))),
            Err(what) => Err(EngineError::Unsupported { what }),
        }
    }
}

fn fused<'a, const D: usize>(
    task: &Task<'a, D>,
    threads: usize,
    units: Units,
) -> Result<FusedMotion<'a, D>, String> {
    let Task { system, body, lattice, form, time_step, uniform_tension } = *task;
    let lattice = lattice.ok_or("a mesh that is not a lattice of squares or cubes")?;
    if form != Integrator::StoermerVerlet {
        return Err(format!("{} (it only makes Stoermer-Verlet steps)", form.name()));
    }
    if !uniform_tension {
        return Err("a tension that is not uniform".to_owned());
    }
    FusedMotion::new(system, body.clone(), lattice, time_step, threads, units)
        .map_err(|unsupported| unsupported.to_string())
}
