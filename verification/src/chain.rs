//! A hanging chain: elastic links between point masses under gravity, both ends held.
//!
//! Statics of the discrete chain is closed but for one number, the horizontal force `H`. Link i of N
//! carries `V_i = m g (i - (N + 1)/2)` vertically, so its tension is `T_i = sqrt(H^2 + V_i^2)`, its length
//! `r + T_i/k`, its direction `(H, V_i)/T_i`; `H` is the one for which the links span the gap. For many
//! links this is the elastic catenary (`irvine_1981`, section 1.3).

use crate::check::{Failure, Setting};
use crate::fit::slope;
use crate::row::Row;
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::drag::Drag;
use myospring::mechanics::spring::Springs;
use myospring::mechanics::support::Support;
use myospring::mechanics::{Body, Configuration, Force, System, Vectors, zeros};

/// Weight of point masses, a constant force downward.
struct Gravity {
    /// nN, per node.
    weights: Vec<f64>,
}

impl Force for Gravity {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn add_forces(&self, _: &Configuration<'_>, forces: &mut Vectors) {
        for (force, weight) in forces[1].iter_mut().zip(&self.weights) {
            *force -= weight;
        }
    }

    fn energy(&self, at: &Configuration<'_>) -> Option<f64> {
        Some(at.positions[1].iter().zip(&self.weights).map(|(y, weight)| y * weight).sum())
    }

    fn is_internal(&self) -> bool {
        false
    }
}

/// Unstretched length um, span um, stiffness of the whole chain nN/um, its weight nN.
const LENGTH: f64 = 20.0;
const SPAN: f64 = 18.0;
const STIFFNESS: f64 = 5.0;
const WEIGHT: f64 = 10.0;

/// Where the masses of a chain of `links` come to rest in time.
fn simulated(links: usize) -> Result<Vectors, Failure> {
    let count = links + 1;
    let mass = 10.0 / links as f64;
    let masses = vec![mass; count];
    let along = |i: usize| SPAN * i as f64 / links as f64;
    let body = Body {
        positions: [(0..count).map(along).collect(), vec![0.0; count]],
        velocities: zeros(count),
        masses: masses.clone(),
    };
    let stiffness = STIFFNESS * links as f64;
    let springs = Springs::new(
        (0..links as u32).map(|i| [i, i + 1]).collect(),
        vec![stiffness; links],
        vec![LENGTH / links as f64; links],
        vec![0.0; links],
    );
    let system = System {
        passive: vec![
            Box::new(springs),
            Box::new(Gravity { weights: vec![WEIGHT / links as f64; count] }),
        ],
        active: vec![],
        // About critical for the slowest vibration.
        drag: Drag { rate: 0.8, masses },
        support: Support::Clamped(vec![0, links]),
    };
    // Half of the stability limit 2/omega, omega = 2 sqrt(k/m).
    let step = 0.5 * (mass / stiffness).sqrt();
    let mut motion = Motion::new(&system, body, Integrator::StoermerVerlet, step);
    motion.advance((200.0 / step) as usize, [0.0, 0.0])?;
    Ok(motion.body.positions)
}

/// The closed form of the same chain.
fn closed_form(links: usize) -> Vectors {
    let (rest, stiffness) = (LENGTH / links as f64, STIFFNESS * links as f64);
    let vertical = |i: usize| WEIGHT / links as f64 * (i as f64 + 0.5 - 0.5 * links as f64);
    let link = |i: usize, horizontal: f64| {
        let tension = horizontal.hypot(vertical(i));
        let scale = rest / tension + 1.0 / stiffness;
        [horizontal * scale, vertical(i) * scale]
    };
    let span = |horizontal: f64| (0..links).map(|i| link(i, horizontal)[0]).sum::<f64>();
    let (mut low, mut high) = (1e-6, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if span(middle) < SPAN { low = middle } else { high = middle }
    }
    let mut at = [vec![0.0], vec![0.0]];
    for i in 0..links {
        let [dx, dy] = link(i, low);
        at[0].push(at[0][i] + dx);
        at[1].push(at[1][i] + dy);
    }
    at
}

/// Sag of the continuous elastic catenary at its middle, um (`irvine_1981`, section 1.3), with supports at
/// one height: `span = H L/EA + 2 (H L/W) asinh(W/2H)` gives H, then
/// `sag = W L/(8 EA) + (H L/W) (sqrt(1 + (W/2H)^2) - 1)`.
fn catenary_sag() -> f64 {
    let rigidity = STIFFNESS * LENGTH;
    let span =
        |h: f64| h * LENGTH / rigidity + 2.0 * h * LENGTH / WEIGHT * (0.5 * WEIGHT / h).asinh();
    let (mut low, mut high) = (1e-6, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if span(middle) < SPAN { low = middle } else { high = middle }
    }
    let steep = 0.5 * WEIGHT / low;
    WEIGHT * LENGTH / (8.0 * rigidity)
        + low * LENGTH / WEIGHT * ((1.0 + steep * steep).sqrt() - 1.0)
}

/// Rest shape against the closed form, and the approach to the continuous catenary.
///
/// # Errors
/// None.
pub fn rows(_: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let counts = [8, 16, 32];
    let mut largest = 0.0_f64;
    let mut sags = Vec::new();
    for links in counts {
        let (found, exact) = (simulated(links)?, closed_form(links));
        largest = largest.max(crate::fit::farthest(&found, &exact));
        sags.push((-found[1][links / 2] - catenary_sag()).abs().ln());
    }
    let steps: Vec<f64> = counts.map(|links| -(links as f64).ln()).to_vec();
    Ok(vec![
        Row::difference(
            "hanging chain of 8, 16, 32 elastic links at rest: positions",
            "closed form of the discrete elastic catenary",
            largest / SPAN,
            1e-10,
            "of the span",
            "motion not yet damped by drag after 200 ms, and rounding",
        ),
        Row::about(
            "hanging chain: order of convergence of its sag to that of a continuous cable",
            "elastic catenary (Irvine 1981, section 1.3)",
            slope(&steps, &sags),
            2.0,
            0.05,
            "",
            "a cable cut into equal links differs by the square of their length",
        ),
    ])
}
