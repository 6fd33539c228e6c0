//! What holds the cell.
//!
//! - [`Support::MassCentre`]: the mass centre stays where it is (`coelho_2021`, section 2.1) and the
//!   cell does not turn: net force and net torque are taken out of the forces, in proportion to
//!   mass. Internal forces have none, so this changes nothing but rounding for them; it holds a cell
//!   that an external load would push or turn.
//! - [`SupportKind::ClampedEnd`], [`SupportKind::ClampedEnds`]: the nodes at one end or both cannot move
//!   (isometric when both).
//! - [`SupportKind::SpringHeldEnds`], [`SupportKind::ElasticBed`]: springs hold the cell, which are forces
//!   with an energy ([`super::anchor`]); no node is constrained besides.

use super::Vectors;
use super::anchor::Anchors;
use crate::mesh::Mesh;
use serde::Serialize;

/// Which support holds the cell.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SupportKind {
    /// Mass centre and orientation fixed; otherwise free.
    MassCentre,
    /// The end where the long axis starts is clamped.
    ClampedEnd,
    /// Both ends are clamped: an isometric contraction.
    ClampedEnds,
    /// A spring at either end, such as a carbon fibre: an auxotonic contraction.
    SpringHeldEnds {
        /// Of each of the two springs, nN/um.
        stiffness: f64,
    },
    /// Every point is tied to its resting place: a cell that adheres to a gel.
    ElasticBed {
        /// Traction per displacement, kPa/um.
        stiffness: f64,
    },
}

impl SupportKind {
    /// The springs of a support that gives way, on a mesh whose long axis is the unit vector `axis`.
    pub fn anchors(self, mesh: &Mesh, axis: [f64; 2]) -> Option<Anchors> {
        match self {
            Self::MassCentre | Self::ClampedEnd | Self::ClampedEnds => None,
            Self::SpringHeldEnds { stiffness } => {
                Some(Anchors::spring_held_ends(mesh, axis, stiffness))
            }
            Self::ElasticBed { stiffness } => Some(Anchors::elastic_bed(mesh, stiffness)),
        }
    }
}

/// What a support takes from the forces, made for one mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum Support {
    /// Nothing: the body is free, or forces hold it.
    Free,
    /// Net force and torque are taken out.
    MassCentre,
    /// These nodes cannot move.
    Clamped(Vec<usize>),
}

/// Part of the length at an end that a clamp or spring holds.
pub const END_PART: f64 = 0.05;

/// The nodes in the outer [`END_PART`] of the length at the lower and at the upper end of a mesh whose
/// long axis is the unit vector `axis`.
pub fn end_nodes(mesh: &Mesh, axis: [f64; 2]) -> [Vec<usize>; 2] {
    let along: Vec<f64> = mesh.points[0]
        .iter()
        .zip(&mesh.points[1])
        .map(|(x, y)| x * axis[0] + y * axis[1])
        .collect();
    let lowest = along.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let zone = END_PART * (highest - lowest);
    let nodes = |held: &dyn Fn(f64) -> bool| -> Vec<usize> {
        (0..along.len()).filter(|&node| held(along[node])).collect()
    };
    [nodes(&|s| s <= lowest + zone), nodes(&|s| s >= highest - zone)]
}

impl Support {
    /// The support of a kind on a mesh whose long axis is the unit vector `axis`; clamps hold the
    /// [`end_nodes`].
    pub fn new(kind: SupportKind, mesh: &Mesh, axis: [f64; 2]) -> Self {
        let [mut lower, upper] = end_nodes(mesh, axis);
        match kind {
            SupportKind::MassCentre => Self::MassCentre,
            SupportKind::SpringHeldEnds { .. } | SupportKind::ElasticBed { .. } => Self::Free,
            SupportKind::ClampedEnd => Self::Clamped(lower),
            SupportKind::ClampedEnds => {
                lower.extend(upper);
                lower.sort_unstable();
                Self::Clamped(lower)
            }
        }
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
