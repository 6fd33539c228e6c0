//! The largest stable time step of a system.
//!
//! With stiffness `K` and damping `C` of the linearised system and masses `M`, the explicit Verlet
//! step with dashpots on the half-step velocity stays bounded while `4 M - dt^2 K - 2 dt C` is
//! positive definite. With the largest eigenvalues `lambda` of `M^-1 K` and `mu` of `M^-1 C` this
//! holds for
//!
//! ```text
//! dt < (sqrt(mu^2 + 4 lambda) - mu) / lambda        = 2/omega (sqrt(1 + zeta^2) - zeta) for one mode
//! ```
//!
//! Both come from a Lanczos iteration on differences of the forces themselves, so it works for any
//! [`super::Force`]. The drag is treated implicitly and has no influence.

use super::support::Support;
use super::{Body, Configuration, System, Tension, Vectors, add_scaled, product, zeros};
use crate::interruption::{Interrupted, Interruption};
use std::array::from_fn;

/// The limit and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StabilityLimit {
    /// Largest stable time step, ms.
    pub time_step: f64,
    /// Largest angular frequency, 1/ms.
    pub angular_frequency: f64,
    /// Largest eigenvalue of `M^-1 C`, 1/ms.
    pub damping_rate: f64,
    /// The node that moves most in the fastest vibration.
    pub stiffest_node: usize,
}

/// Largest number of steps of the Lanczos iteration; the largest eigenvalue of a lattice is found
/// to 0.1 %.
const ITERATIONS: usize = 120;

/// Steps between checks of the largest eigenvalue, which converges from below, and the relative
/// increase between two checks at which it counts as converged.
const LOOK: (usize, f64) = (15, 1e-5);

impl StabilityLimit {
    /// The limit of a system about the body's positions, under an active tension (a number is a
    /// uniform one in kPa).
    pub fn of<'a, const D: usize>(
        system: &System<D>,
        body: &Body<D>,
        tension: impl Into<Tension<'a>>,
    ) -> Self {
        let never = Interruption::default();
        Self::of_interruptible(system, body, tension, &never).unwrap_or_else(|_| unreachable!())
    }

    /// Like [`StabilityLimit::of`], but can be interrupted.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn of_interruptible<'a, const D: usize>(
        system: &System<D>,
        body: &Body<D>,
        tension: impl Into<Tension<'a>>,
        interruption: &Interruption,
    ) -> Result<Self, Interrupted> {
        let (count, tension) = (body.len(), tension.into());
        // Small against the shortest spring, large against rounding.
        let step = 1e-6 * shortest_scale(body);
        let difference = |displace: &dyn Fn(f64) -> Vectors<D>| {
            let (mut plus, mut minus) = (displace(step), displace(-step));
            for axis in 0..D {
                for node in 0..count {
                    plus[axis][node] = -(plus[axis][node] - minus[axis][node]) / (2.0 * step);
                }
            }
            minus.clone_from(&plus);
            plus
        };
        let stiffness = |direction: &Vectors<D>| {
            difference(&|h| {
                let positions = shifted(&body.positions, direction, h);
                let velocities = zeros(count);
                evaluate(system, body, &positions, &velocities, tension)
            })
        };
        let damping = |direction: &Vectors<D>| {
            difference(&|h| {
                let velocities = shifted(&zeros(count), direction, h);
                evaluate(system, body, &body.positions, &velocities, tension)
            })
        };
        let (lambda, mode) = largest_eigenvalue(&stiffness, &body.masses, interruption)?;
        let (mu, _) = largest_eigenvalue(&damping, &body.masses, interruption)?;
        let mu = mu.max(0.0);
        let square = |node: usize| mode.iter().map(|axis| axis[node].powi(2)).sum::<f64>();
        let stiffest_node =
            (0..count).max_by(|&a, &b| square(a).total_cmp(&square(b))).unwrap_or_default();
        Ok(Self {
            time_step: ((mu * mu + 4.0 * lambda).sqrt() - mu) / lambda,
            angular_frequency: lambda.sqrt(),
            damping_rate: mu,
            stiffest_node,
        })
    }
}

fn evaluate<const D: usize>(
    system: &System<D>,
    body: &Body<D>,
    positions: &Vectors<D>,
    velocities: &Vectors<D>,
    tension: Tension<'_>,
) -> Vectors<D> {
    let mut forces = zeros(body.len());
    system.sum_forces(&Configuration { positions, velocities, tension }, &mut forces);
    if let Support::Clamped(_) = system.support {
        system.support.constrain(positions, &body.masses, &mut forces);
    }
    forces
}

fn shifted<const D: usize>(base: &Vectors<D>, direction: &Vectors<D>, by: f64) -> Vectors<D> {
    from_fn(|axis| base[axis].iter().zip(&direction[axis]).map(|(x, d)| x + by * d).collect())
}

/// A length of the order of the node spacing, um.
fn shortest_scale<const D: usize>(body: &Body<D>) -> f64 {
    let extent = body
        .positions
        .iter()
        .map(|axis| {
            axis.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                - axis.iter().copied().fold(f64::INFINITY, f64::min)
        })
        .fold(0.0, f64::max);
    extent / if D == 2 { (body.len() as f64).sqrt() } else { (body.len() as f64).cbrt() }
}

/// Largest eigenvalue of `M^-1 A` and its vector (largest component scaled arbitrarily), by Lanczos for
/// the symmetric `M^-1/2 A M^-1/2`, with full reorthogonalisation.
fn largest_eigenvalue<const D: usize>(
    apply: &dyn Fn(&Vectors<D>) -> Vectors<D>,
    masses: &[f64],
    interruption: &Interruption,
) -> Result<(f64, Vectors<D>), Interrupted> {
    let count = masses.len();
    let roots: Vec<f64> = masses.iter().map(|mass| mass.sqrt()).collect();
    let over_roots = |v: &Vectors<D>| -> Vectors<D> {
        from_fn(|axis| v[axis].iter().zip(&roots).map(|(x, root)| x / root).collect())
    };
    let scale = |v: &mut Vectors<D>, by: f64| v.iter_mut().flatten().for_each(|x| *x *= by);
    // A fixed, irregular start: fractional parts of multiples of the golden ratio.
    let mut start = zeros(count);
    for axis in 0..D {
        for node in 0..count {
            let n = (D * node + axis + 1) as f64;
            start[axis][node] = roots[node] * ((n * 0.618_033_988_749_894_9).fract() - 0.5);
        }
    }
    let norm = product(&start, &start).sqrt();
    scale(&mut start, 1.0 / norm);
    let mut basis = vec![start];
    let (mut diagonal, mut off) = (Vec::new(), Vec::new());
    let mut seen = 0.0;
    for step in 1..=ITERATIONS.min(D * count) {
        interruption.check()?;
        let Some(current) = basis.last() else { break };
        let mut next = over_roots(&apply(&over_roots(current)));
        diagonal.push(product(&next, current));
        // The latest vector first: its component is the largest, and its errors along the others
        // are removed with them. In the opposite order these errors would grow from step to step if
        // all eigenvalues are close, as for a stiff elastic bed.
        for vector in basis.iter().rev() {
            let part = product(&next, vector);
            add_scaled(&mut next, -part, vector);
        }
        let norm = product(&next, &next).sqrt();
        let size = diagonal.iter().fold(f64::MIN_POSITIVE, |a: f64, b: &f64| a.max(b.abs()));
        if norm.is_nan() || norm <= 1e-7 * size {
            break;
        }
        if step % LOOK.0 == 0 {
            let now = largest_of_tridiagonal(&diagonal, &off);
            if now - seen < LOOK.1 * now {
                break;
            }
            seen = now;
        }
        off.push(norm);
        scale(&mut next, 1.0 / norm);
        basis.push(next);
    }
    off.truncate(diagonal.len().saturating_sub(1));
    let lambda = largest_of_tridiagonal(&diagonal, &off);
    // The eigenvector of the small matrix by its three-term recurrence, then back to the nodes.
    let mut weights = vec![1.0];
    for k in 0..off.len() {
        let below = if k == 0 { 0.0 } else { off[k - 1] * weights[k - 1] };
        weights.push(((lambda - diagonal[k]) * weights[k] - below) / off[k]);
    }
    let mut mode = zeros(count);
    for (weight, vector) in weights.iter().zip(&basis) {
        add_scaled(&mut mode, *weight, vector);
    }
    Ok((lambda, over_roots(&mode)))
}

/// Largest eigenvalue of a symmetric tridiagonal matrix by bisection on its Sturm sequence.
fn largest_of_tridiagonal(diagonal: &[f64], off: &[f64]) -> f64 {
    let radius = |k: usize| {
        let before = if k == 0 { 0.0 } else { off[k - 1].abs() };
        before + off.get(k).map_or(0.0, |value| value.abs())
    };
    let upper = (0..diagonal.len()).map(|k| diagonal[k] + radius(k)).fold(0.0, f64::max);
    let lower = diagonal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let all_below = |x: f64| {
        let mut pivot = 1.0;
        diagonal.iter().enumerate().all(|(k, d)| {
            let coupling = if k == 0 { 0.0 } else { off[k - 1] * off[k - 1] / pivot };
            pivot = x - d - coupling;
            pivot > 0.0
        })
    };
    let (mut low, mut high) = (lower, upper.max(lower));
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if all_below(middle) { high = middle } else { low = middle }
    }
    high
}
