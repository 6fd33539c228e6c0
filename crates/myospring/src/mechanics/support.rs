//! What holds the cell.
//!
//! - [`Support::MassCentre`]: the mass centre stays where it is (`coelho_2021`, section 2.1) and the
//!   cell does not turn: net force and net torque are taken out of the forces, in proportion to
//!   mass. Internal forces have none, so this changes nothing but rounding for them; it holds a cell
//!   that an external load would push or turn.
//! - [`SupportKind::ClampedEnd`], [`SupportKind::ClampedEnds`]: the nodes at one end or both cannot move
//!   (isometric when both).

use super::Vectors;
use crate::mesh::Mesh;
use serde::{Deserialize, Serialize};

/// Which support holds the cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "run-file", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum SupportKind {
    /// Mass centre and orientation fixed; otherwise free.
    MassCentre,
    /// The end where the long axis starts is clamped.
    ClampedEnd,
    /// Both ends are clamped: an isometric contraction.
    ClampedEnds,
}

/// A support made for one mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum Support {
    /// Nothing holds the body.
    Free,
    /// Net force and torque are taken out.
    MassCentre,
    /// These nodes cannot move.
    Clamped(Vec<usize>),
}

/// Part of the length at an end that a clamp holds.
pub const CLAMPED_PART: f64 = 0.05;

impl Support {
    /// The support of a kind on a mesh whose long axis is the unit vector `axis`; clamps hold the
    /// outer twentieth of the length.
    pub fn new(kind: SupportKind, mesh: &Mesh, axis: [f64; 2]) -> Self {
        if kind == SupportKind::MassCentre {
            return Self::MassCentre;
        }
        let along: Vec<f64> = mesh.points[0]
            .iter()
            .zip(&mesh.points[1])
            .map(|(x, y)| x * axis[0] + y * axis[1])
            .collect();
        let lowest = along.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let zone = CLAMPED_PART * (highest - lowest);
        let held = |s: f64| {
            s <= lowest + zone || (kind == SupportKind::ClampedEnds && s >= highest - zone)
        };
        Self::Clamped((0..along.len()).filter(|&node| held(along[node])).collect())
    }

    /// Takes from the forces what the support bears.
    pub fn constrain(&self, positions: &Vectors, masses: &[f64], forces: &mut Vectors) {
        match self {
            Self::Free => {}
            Self::MassCentre => remove_resultant(positions, masses, forces),
            Self::Clamped(nodes) => {
                for axis in forces {
                    for &node in nodes {
                        axis[node] = 0.0;
                    }
                }
            }
        }
    }
}

/// Removes net force and torque by a rigid acceleration of the whole body.
fn remove_resultant(positions: &Vectors, masses: &[f64], forces: &mut Vectors) {
    let [x, y] = positions;
    let [fx, fy] = forces;
    let (mut mass, mut mx, mut my, mut net_x, mut net_y) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for i in 0..masses.len() {
        mass += masses[i];
        mx += masses[i] * x[i];
        my += masses[i] * y[i];
        net_x += fx[i];
        net_y += fy[i];
    }
    let (cx, cy) = (mx / mass, my / mass);
    let (mut torque, mut inertia) = (0.0, 0.0);
    for i in 0..masses.len() {
        let (dx, dy) = (x[i] - cx, y[i] - cy);
        torque += dx * fy[i] - dy * fx[i];
        inertia += masses[i] * (dx * dx + dy * dy);
    }
    let (ax, ay, angular) = (net_x / mass, net_y / mass, torque / inertia);
    for i in 0..masses.len() {
        let (dx, dy) = (x[i] - cx, y[i] - cy);
        fx[i] -= masses[i] * (ax - angular * dy);
        fy[i] -= masses[i] * (ay + angular * dx);
    }
}
