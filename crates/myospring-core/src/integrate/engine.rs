//! Which loops move the masses: chosen, refused when impossible, never silently replaced.

use super::fused::FusedMotion;
use super::stencil::Units;
use super::stepper::Stepper;
use super::verlet::{Integrator, Motion};
use crate::mechanics::{Body, System};
use crate::mesh::Lattice;
use serde::{Deserialize, Serialize};

/// Which loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loops {
    /// The fused kernel where it can, else the plain loops.
    Auto,
    /// Plain loops over all laws: any mesh, force, tension and form of Verlet's method.
    Plain,
    /// The fused kernel of a lattice, or nothing.
    Fused,
}

/// What moves the masses, as it is asked for; [`Default`] is the fastest that can, on one thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Engine {
    /// Which loops.
    pub loops: Loops,
    /// Vector units of the fused kernel; `None` takes the best that the processor has.
    pub units: Option<Units>,
    /// Most threads of the fused kernel; the result is the same to the last bit.
    pub threads: usize,
}

impl Default for Engine {
    fn default() -> Self {
        Self { loops: Loops::Auto, units: None, threads: 1 }
    }
}

/// What did move the masses, for the record.
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
        /// What the fused kernel does not serve, in words for people; absent if nobody wanted it.
        #[serde(skip_serializing_if = "Option::is_none")]
        instead_of_fused: Option<String>,
    },
    /// A stepper from outside.
    Own,
}

/// Why an engine cannot move the masses.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EngineError {
    /// The fused kernel does not serve something.
    #[error(
        "engine = \"fused\": the fused kernel does not serve {hindrance}; take engine = \"plain\", or \"auto\", \
         which chooses"
    )]
    NotServed {
        /// What.
        hindrance: String,
    },
    /// The processor lacks vector units.
    #[error("this processor has no vector units {wanted}; it has: {available}")]
    NoUnits {
        /// Those that were asked for.
        wanted: &'static str,
        /// Those that it has.
        available: String,
    },
}

/// A motion to be made: what the engine is chosen for.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// All that acts on the body.
    pub system: &'a System,
    /// The body at its start.
    pub body: &'a Body,
    /// Its lattice, if it has one.
    pub lattice: Option<&'a Lattice>,
    /// Form of Verlet's method.
    pub form: Integrator,
    /// Time step, ms.
    pub time_step: f64,
    /// Whether the tension is the same everywhere.
    pub uniform_tension: bool,
}

impl Engine {
    /// Makes a stepper, and says what it is.
    ///
    /// # Errors
    /// The fused kernel was asked for and cannot, or the processor lacks its vector units.
    pub fn stepper<'a>(
        &self,
        task: &Task<'a>,
    ) -> Result<(Box<dyn Stepper + 'a>, EngineUsed), EngineError> {
        let units = self.units.unwrap_or_else(Units::best);
        if !units.available() {
            let available = Units::ALL.into_iter().filter(|units| units.available());
            let available = available.map(Units::name).collect::<Vec<_>>().join(", ");
            return Err(EngineError::NoUnits { wanted: units.name(), available });
        }
        let plain = |instead_of_fused| {
            let Task { system, body, form, time_step, .. } = *task;
            let motion = Motion::new(system, body.clone(), form, time_step);
            (Box::new(motion) as Box<dyn Stepper + 'a>, EngineUsed::Plain { instead_of_fused })
        };
        if self.loops == Loops::Plain {
            return Ok(plain(None));
        }
        match fused(task, self.threads, units) {
            Ok(motion) => {
                let used = EngineUsed::Fused { vector_units: units, threads: motion.threads() };
                Ok((Box::new(motion), used))
            }
            Err(hindrance) if self.loops == Loops::Auto => Ok(plain(Some(hindrance))),
            Err(hindrance) => Err(EngineError::NotServed { hindrance }),
        }
    }
}

fn fused<'a>(task: &Task<'a>, threads: usize, units: Units) -> Result<FusedMotion<'a>, String> {
    let Task { system, body, lattice, form, time_step, uniform_tension } = *task;
    let lattice = lattice.ok_or("a mesh that is no square lattice")?;
    if form != Integrator::StoermerVerlet {
        return Err(format!("{} (it makes Stoermer-Verlet's steps)", form.name()));
    }
    if !uniform_tension {
        return Err("a tension that differs from place to place".to_owned());
    }
    FusedMotion::new(system, body.clone(), lattice, time_step, threads, units)
        .map_err(|hindrance| hindrance.to_string())
}
