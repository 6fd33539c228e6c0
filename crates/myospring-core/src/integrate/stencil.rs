//! The fused kernel of a lattice of squares or cubes: all forces, kick and drift in one sweep, vectorised.
//!
//! It makes the same Stoermer-Verlet steps as [`super::verlet`], several times faster, and agrees
//! with it except for rounding. It supports springs with axial dashpots, the `gradient` area law, the volume law of
//! cubes, uniform fibre tension in any directions, drag, clamped nodes, elastic beds and spring-held ends, on any
//! outline or form, with any mass, stiffness, dashpot, area or volume stiffness and fibre weight per place.
//! Everything else uses the plain loops.
//!
//! # How
//! - Masses are stored in rows of the bounding box. A place without a mass has springs without
//!   stiffness and cannot move; groups of eight such places are skipped.
//! - A group of eight squares or cubes shares its coefficients with the rest of the cell, or has its own
//!   record (on the rim, or everywhere if a field is not uniform).
//! - Each spring is evaluated once; see `sweep.rs`, `squares.rs` and `cubes.rs`. On AVX-512 the inverse length is computed by an
//!   estimate and a series, at a third of the cost of a root and a division.
//! - A mesh larger than the cache is swept once for several steps, each a row (in space a layer and a row) behind the last.
//! - Several threads share the mesh in bands of rows; see `bands.rs` and `team.rs`. Results are
//!   bitwise the same for any number of threads, but not for other vector units (FMA rounds once,
//!   others round twice).
//!
//! # Unsafe
//! Vector intrinsics and the in-place sweep over pointers need it. It is confined to this folder.
#![allow(unsafe_code, reason = "vector intrinsics and an in-place sweep shared by threads")]

mod bands;
mod cubes;
mod lanes;
mod plan;
mod squares;
mod sweep;
mod team;
mod terms;
mod tiles;

pub use lanes::Units;
use plan::{BLOCK, Plan};

use super::stepper::StepError;
use crate::mechanics::runs::Run;
use crate::mechanics::support::Support;
use crate::mechanics::{Body, System, Vectors};
use crate::mesh::Lattice;
// Taken from here by `bands`, in whose place `loom` puts its own.
use std::sync::atomic;
use team::Team;
use terms::LatticeTerms;
use tiles::Command;

/// Number of springs from which on a further thread is worthwhile; see docs/reference/performance.md.
const SPRINGS_A_THREAD: usize = 30_000;

/// Number of threads that is worthwhile for a number of springs: one for every 30 000 (8000 masses of a flat cell, 4000 of
/// a thick one), at least one, at most one per core. With fewer springs per thread, synchronisation takes much of the gain.
pub fn worthwhile_threads(springs: usize) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    (springs / SPRINGS_A_THREAD).clamp(1, cores)
}

/// What the kernel does not support, in words.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unsupported(pub String);

/// All coefficients of a system of forces, if the kernel supports each force.
fn plan<const D: usize>(
    system: &System<D>,
    body: &Body<D>,
    lattice: &Lattice<D>,
    time_step: f64,
) -> Result<Plan, Unsupported> {
    if D > 2 && lattice.shape[1] < 2 {
        return Err(Unsupported("a lattice in space with a single row".to_owned()));
    }
    let mut terms = LatticeTerms::new(lattice);
    for force in system.forces() {
        let law = force.on_lattice();
        let law = law.ok_or_else(|| Unsupported(format!("the force `{}`", force.name())))?;
        if !terms.add(law) {
            let what = format!("the force `{}` in this form on this lattice", force.name());
            return Err(Unsupported(what));
        }
    }
    if system.support == Support::MassCentre && !system.is_internal() {
        return Err(Unsupported("a mass centre that is held against outer forces".to_owned()));
    }
    terms
        .plan(&body.masses, system.drag.rate, &system.support, time_step)
        .ok_or_else(|| Unsupported("area laws that differ within a square".to_owned()))
}

/// A lattice of masses in motion.
pub struct Stencil<const D: usize = 2> {
    team: Team,
}

impl<const D: usize> Stencil<D> {
    /// The kernel for a body under a system of forces on a lattice, moved with a fixed time step in
    /// ms by at most `threads` threads.
    ///
    /// The body's velocities are those of the last half step.
    ///
    /// # Errors
    /// A force or support that it does not support.
    ///
    /// # Panics
    /// If the processor lacks the vector units, see [`Units::available`].
    pub fn new(
        system: &System<D>,
        body: &Body<D>,
        lattice: &Lattice<D>,
        time_step: f64,
        threads: usize,
        units: Units,
    ) -> Result<Self, Unsupported> {
        let plan = plan(system, body, lattice, time_step)?;
        let mut stencil = Self { team: Team::new(plan, units, threads) };
        stencil.put(&body.positions, &body.velocities);
        Ok(stencil)
    }

    /// Number of threads in use.
    pub fn threads(&self) -> usize {
        self.team.threads()
    }

    /// Sets the state: positions (um) and velocities at the last half step (um/ms).
    pub fn put(&mut self, positions: &Vectors<D>, half_velocities: &Vectors<D>) {
        let (plan, state, _) = self.team.parts();
        // Places without a mass, too: a motion that blew up has reached them.
        for (values, vacant) in state.chunks_exact_mut(BLOCK).zip(&plan.vacant) {
            values.copy_from_slice(&vacant.0);
        }
        let rows = positions.iter().chain(half_velocities).enumerate();
        for (component, values) in rows {
            for &Run { nodes: [place], first, len } in &plan.places {
                state[place + component * plan.stride..][..len]
                    .copy_from_slice(&values[first..][..len]);
            }
        }
    }

    /// Makes `steps` steps; the tension (kPa) changes linearly from `tensions[0]` at the first to
    /// `tensions[1]` at the end of the last.
    ///
    /// # Errors
    /// If a thread has panicked, now or before; the state is then invalid.
    pub fn advance(&mut self, steps: usize, tensions: [f64; 2]) -> Result<(), StepError> {
        self.team.obey(Command::Advance { steps, tensions })
    }

    /// Writes the velocities at the time of the positions under this tension (kPa), um/ms.
    ///
    /// # Errors
    /// Those of [`Stencil::advance`].
    pub fn read_velocities(
        &mut self,
        tension: f64,
        velocities: &mut Vectors<D>,
    ) -> Result<(), StepError> {
        self.team.obey(Command::Look { tension })?;
        let (plan, _, seen) = self.team.parts();
        // A row of `seen` is half as long as one of the state.
        let half = plan.row_len / 2;
        for (axis, values) in velocities.iter_mut().enumerate() {
            for &Run { nodes: [place], first, len } in &plan.places {
                let from = place - place / plan.row_len * half + axis * plan.stride;
                values[first..][..len].copy_from_slice(&seen[from..][..len]);
            }
        }
        Ok(())
    }

    /// Writes the positions (um) and the velocities at the last half step, um/ms.
    pub fn read_half_step(&mut self, positions: &mut Vectors<D>, half_velocities: &mut Vectors<D>) {
        let (plan, state, _) = self.team.parts();
        let rows = positions.iter_mut().chain(half_velocities).enumerate();
        for (component, values) in rows {
            for &Run { nodes: [place], first, len } in &plan.places {
                let from = place + component * plan.stride;
                values[first..][..len].copy_from_slice(&state[from..][..len]);
            }
        }
    }
}
