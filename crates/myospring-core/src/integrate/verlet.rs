//! Verlet's method in its two forms.
//!
//! Stoermer-Verlet, `coelho_2021`, Eq. (16), with the velocity of Eq. (17) in the drag:
//!
//! ```text
//! x_{n+1} = [2 x_n - (1 - g) x_{n-1} + dt^2 f_n/m] / (1 + g)              g = gamma dt/2
//! ```
//!
//! Velocity Verlet with the drag explicit in the first half-kick and implicit in the last:
//!
//! ```text
//! v_{n+1/2} = v_n + dt/2 (f_n/m - gamma v_n)
//! x_{n+1}   = x_n + dt v_{n+1/2}
//! v_{n+1}   = (v_{n+1/2} + dt/2 f_{n+1}/m) / (1 + g)
//! ```
//!
//! They are the same method: positions are equal except for rounding, of order 2 with and without
//! drag. Dashpots use the half-step velocity `(x_{n+1} - x_n)/dt`, the last one known when
//! `f_{n+1}` is computed. There is one force evaluation per step; the first half-kick uses the
//! force at the start.

use super::stepper::{StepError, Stepper};
use crate::mechanics::{Body, Configuration, System, Tension, Vectors, zeros};
use serde::Serialize;

/// The form of Verlet's method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Stoermer-Verlet, the paper's Eq. (16): positions of two times, no velocities.
    StoermerVerlet,
    /// Velocity Verlet with implicit drag in the last half-kick: the same positions except for
    /// rounding.
    VelocityVerlet,
}

impl Integrator {
    /// All integrators.
    pub const ALL: [Self; 2] = [Self::StoermerVerlet, Self::VelocityVerlet];

    /// Its name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::StoermerVerlet => "Stoermer-Verlet",
            Self::VelocityVerlet => "velocity Verlet",
        }
    }

    /// Whether a step ends without the velocities at its end.
    const fn leaves_half_kick(self) -> bool {
        match self {
            Self::StoermerVerlet => true,
            Self::VelocityVerlet => false,
        }
    }
}

/// A body in motion under a system of forces, by plain loops over all laws.
///
/// # Example
/// ```
/// use myospring::integrate::verlet::{Integrator, Motion};
/// use myospring::mechanics::{Body, System, drag::Drag, spring::Springs, support::Support, zeros};
/// // Two masses of 1 ug on a spring of 2 nN/um, 1 um apart and pulled apart by 0.1 um: period pi ms.
/// let springs = Springs::new(vec![[0, 1]], vec![2.0], vec![1.0], vec![0.0]);
/// let masses = vec![1.0; 2];
/// let body = Body { positions: [vec![0.0, 1.1], vec![0.0; 2]], velocities: zeros(2), masses: masses.clone() };
/// let system = System {
///     passive: vec![Box::new(springs)],
///     active: vec![],
///     drag: Drag { rate: 0.0, masses },
///     support: Support::Free,
/// };
/// let step = std::f64::consts::PI / 1000.0;
/// let mut motion = Motion::new(&system, body, Integrator::StoermerVerlet, step);
/// motion.advance(500, [0.0; 2])?;
/// let [x, _] = &motion.body.positions;
/// assert!((x[1] - x[0] - 0.9).abs() < 1e-5);
/// # Ok::<(), myospring::integrate::stepper::StepError>(())
/// ```
pub struct Motion<'a, const D: usize = 2> {
    system: &'a System<D>,
    integrator: Integrator,
    /// The body; its velocities belong to the same time as its positions.
    pub body: Body<D>,
    time_step: f64,
    /// 1/m of each mass, because a division in the inner loop would dominate its cost.
    inverse_masses: Vec<f64>,
    state: State<D>,
    mark: Option<(Body<D>, State<D>)>,
    /// Tensions of the triangles during a step.
    tensions: Vec<f64>,
    /// Whether [`Motion::advance`] has begun but not ended.
    under_way: bool,
}

/// State of the method in addition to the body.
#[derive(Clone)]
struct State<const D: usize> {
    forces: Vectors<D>,
    /// Velocities at the last half step; at the start those of the body.
    half_velocities: Vectors<D>,
    /// Positions one step before, for Stoermer-Verlet.
    previous: Vectors<D>,
    /// Steps made so far.
    steps: u64,
}

impl<'a, const D: usize> Motion<'a, D> {
    /// A body to be moved with a fixed time step in ms, at most the stability limit
    /// ([`crate::mechanics::stability::StabilityLimit`]).
    pub fn new(
        system: &'a System<D>,
        body: Body<D>,
        integrator: Integrator,
        time_step: f64,
    ) -> Self {
        Self {
            system,
            integrator,
            time_step,
            inverse_masses: body.masses.iter().map(|mass| 1.0 / mass).collect(),
            state: State {
                forces: zeros(body.len()),
                half_velocities: body.velocities.clone(),
                previous: body.positions.clone(),
                steps: 0,
            },
            body,
            mark: None,
            tensions: Vec::new(),
            under_way: false,
        }
    }

    /// Like [`Stepper::advance`]; numbers are uniform tensions in kPa.
    ///
    /// # Errors
    /// If a panic has interrupted this or an earlier call.
    pub fn advance<'t>(
        &mut self,
        steps: usize,
        tensions: [impl Into<Tension<'t>>; 2],
    ) -> Result<(), StepError> {
        Stepper::advance(self, steps, tensions.map(Into::into))
    }

    /// Velocities at the last half step, um/ms: those used by the dashpots.
    pub fn half_velocities(&self) -> &Vectors<D> {
        &self.state.half_velocities
    }

    /// Gives the fused kernel access to the body and its half-step velocities, after it has made
    /// `steps` steps.
    pub(super) fn moved_by(&mut self, steps: u64) -> (&mut Body<D>, &mut Vectors<D>) {
        self.state.steps += steps;
        (&mut self.body, &mut self.state.half_velocities)
    }

    fn step_on(&mut self, steps: usize, tensions: [Tension<'_>; 2]) {
        if self.state.steps == 0 {
            self.evaluate(tensions[0]);
        }
        let mut buffer = std::mem::take(&mut self.tensions);
        for step in 1..=steps {
            let part = step as f64 / steps as f64;
            let tension = Tension::between(tensions, part, &mut buffer);
            match self.integrator {
                Integrator::VelocityVerlet => self.velocity_verlet_step(tension),
                Integrator::StoermerVerlet => self.stoermer_verlet_step(tension),
            }
            self.state.steps += 1;
        }
        self.tensions = buffer;
        if self.integrator.leaves_half_kick() {
            // Eq. (17) without waiting for the next step: put Eq. (16) for x_{n+1} into it.
            self.last_half_kick();
        }
    }

    /// Forces at the present positions, dashpots at the half-step velocities.
    fn evaluate(&mut self, tension: Tension<'_>) {
        let at = Configuration {
            positions: &self.body.positions,
            velocities: &self.state.half_velocities,
            tension,
        };
        self.system.sum_forces(&at, &mut self.state.forces);
        self.system.constrain(&self.body.positions, &self.body.masses, &mut self.state.forces);
    }

    fn velocity_verlet_step(&mut self, tension: Tension<'_>) {
        let (dt, half_drag) = (self.time_step, 0.5 * self.time_step * self.system.drag.rate);
        let inverse_masses = &self.inverse_masses;
        for axis in 0..D {
            let force = &self.state.forces[axis];
            let half = &mut self.state.half_velocities[axis];
            let velocity = &self.body.velocities[axis];
            let position = &mut self.body.positions[axis];
            for i in 0..inverse_masses.len() {
                half[i] =
                    velocity[i] + 0.5 * dt * force[i] * inverse_masses[i] - half_drag * velocity[i];
                position[i] += dt * half[i];
            }
        }
        self.evaluate(tension);
        self.last_half_kick();
    }

    /// v_{n+1} = (v_{n+1/2} + dt/2 f_{n+1}/m) / (1 + g)
    fn last_half_kick(&mut self) {
        let (dt, half_drag) = (self.time_step, 0.5 * self.time_step * self.system.drag.rate);
        let slowing = 1.0 / (1.0 + half_drag);
        let inverse_masses = &self.inverse_masses;
        for axis in 0..D {
            let (force, half) = (&self.state.forces[axis], &self.state.half_velocities[axis]);
            let velocity = &mut self.body.velocities[axis];
            for i in 0..inverse_masses.len() {
                velocity[i] = (half[i] + 0.5 * dt * force[i] * inverse_masses[i]) * slowing;
            }
        }
    }

    fn stoermer_verlet_step(&mut self, tension: Tension<'_>) {
        let (dt, half_drag) = (self.time_step, 0.5 * self.time_step * self.system.drag.rate);
        let inverse_masses = &self.inverse_masses;
        let (slowing, per_step) = (1.0 / (1.0 + half_drag), 1.0 / dt);
        let State { forces, half_velocities, previous, steps } = &mut self.state;
        let first = *steps == 0;
        for axis in 0..D {
            let force = &forces[axis];
            let half = &mut half_velocities[axis];
            let (position, previous) = (&mut self.body.positions[axis], &mut previous[axis]);
            let velocity = &self.body.velocities[axis];
            for i in 0..inverse_masses.len() {
                let now = position[i];
                let kick = dt * dt * force[i] * inverse_masses[i];
                let next = if first {
                    // Taylor's series, Eq. (14), since there is no step before the first.
                    now + dt * (1.0 - half_drag) * velocity[i] + 0.5 * kick
                } else {
                    // Eq. (16), ordered so that a mass without force keeps its position exactly
                    now + ((1.0 - half_drag) * (now - previous[i]) + kick) * slowing
                };
                half[i] = (next - now) * per_step;
                previous[i] = now;
                position[i] = next;
            }
        }
        self.evaluate(tension);
    }
}

impl<const D: usize> Stepper<D> for Motion<'_, D> {
    fn advance(&mut self, steps: usize, tensions: [Tension<'_>; 2]) -> Result<(), StepError> {
        if std::mem::replace(&mut self.under_way, true) {
            return Err(StepError::Poisoned);
        }
        self.step_on(steps, tensions);
        self.under_way = false;
        Ok(())
    }

    fn body(&self) -> &Body<D> {
        &self.body
    }

    fn time_step(&self) -> f64 {
        self.time_step
    }

    fn steps(&self) -> u64 {
        self.state.steps
    }

    fn mark(&mut self) {
        self.mark = Some((self.body.clone(), self.state.clone()));
    }

    fn back(&mut self) {
        if let Some((body, state)) = &self.mark {
            self.body.clone_from(body);
            self.state.clone_from(state);
        }
    }
}
