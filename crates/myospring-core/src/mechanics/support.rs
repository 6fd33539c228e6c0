//! Supports of the cell.
//!
//! - [`Support::MassCentre`]: the mass centre stays in place (`coelho_2021`, section 2.1) and the
//!   cell does not rotate: net force and net torque are subtracted from the forces, in proportion
//!   to mass. Internal forces have none, so for them this only removes rounding errors; it holds a
//!   cell that an external load would push or rotate.
//! - [`SupportKind::ClampedEnd`], [`SupportKind::ClampedEnds`]: the nodes at one end or both cannot move
//!   (isometric when both).
//! - [`SupportKind::AfterloadedEnds`]: clamped ends, one of which leaves its stop under a constant
//!   load ([`super::loaded_end`]).
//! - [`SupportKind::SpringHeldEnds`], [`SupportKind::Posts`], [`SupportKind::ElasticBed`]: springs hold the cell, which are
//!   forces with an energy ([`super::anchor`]); no node is constrained.
//! - [`SupportKind::Gel`]: an elastic gel, likewise ([`super::gel`]).

use super::anchor::Anchors;
use super::gel::Gel;
use super::post::Post;
use super::vectors::Vectors;
use crate::mesh::Mesh;
use crate::mesh::ends::end_nodes;
use serde::Serialize;

/// The kind of support.
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
        /// Stiffness of each of the two springs, nN/um.
        stiffness: f64,
    },
    /// A flexible post at either end, as of a strip of tissue: an auxotonic contraction.
    Posts(Post),
    /// Both ends are gripped: an afterloaded contraction, as with a force clamp. Once the cell
    /// pulls harder than a constant load, it shortens against the load (isotonic), until it has
    /// relengthened to the stop of the grips. Only along equilibria.
    AfterloadedEnds {
        /// The load, nN.
        load: f64,
    },
    /// The cell adheres to an elastic gel.
    Gel(Gel),
    /// Every point is tied to its resting position: a cell on pillars, or on a thin gel.
    ElasticBed {
        /// Traction per displacement, kPa/um.
        stiffness: f64,
    },
}

/// A support, and where the cell adheres to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attachment<'a> {
    /// The support.
    pub support: SupportKind,
    /// For each node, how strongly it adheres to a gel, as in
    /// [`GelBed::adhering`](super::gel::GelBed::adhering); `None` is 1 everywhere.
    pub adhesion: Option<&'a [f64]>,
}

impl From<SupportKind> for Attachment<'_> {
    fn from(support: SupportKind) -> Self {
        Self { support, adhesion: None }
    }
}

impl SupportKind {
    /// Whether both ends are held, so that the cell exerts a force on their supports.
    pub fn holds_both_ends(self) -> bool {
        matches!(
            self,
            Self::ClampedEnds
                | Self::AfterloadedEnds { .. }
                | Self::SpringHeldEnds { .. }
                | Self::Posts(_)
        )
    }

    /// Whether what holds the cell gives way.
    pub fn gives_way(self) -> bool {
        matches!(
            self,
            Self::SpringHeldEnds { .. } | Self::Posts(_) | Self::ElasticBed { .. } | Self::Gel(_)
        )
    }

    /// Whether one end or both are clamped; clamped parts do not change length.
    pub fn clamps(self) -> bool {
        matches!(self, Self::ClampedEnd | Self::ClampedEnds | Self::AfterloadedEnds { .. })
    }

    /// The springs of an elastic support, on a mesh whose long axis is the unit vector `axis`.
    pub fn anchors<const D: usize, const N: usize>(
        self,
        mesh: &Mesh<D, N>,
        axis: [f64; D],
    ) -> Option<Anchors<D>> {
        match self {
            Self::MassCentre
            | Self::ClampedEnd
            | Self::ClampedEnds
            | Self::AfterloadedEnds { .. }
            | Self::Gel(_) => None,
            Self::SpringHeldEnds { stiffness } => {
                Some(Anchors::spring_held_ends(mesh, axis, stiffness))
            }
            Self::Posts(post) => Some(Anchors::spring_held_ends(mesh, axis, post.stiffness())),
            Self::ElasticBed { stiffness } => Some(Anchors::elastic_bed(mesh, stiffness)),
        }
    }
}

/// A support prepared for one mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum Support {
    /// Nothing: the body is free, or forces hold it.
    Free,
    /// Net force and torque are subtracted.
    MassCentre,
    /// These nodes cannot move.
    Clamped(Vec<usize>),
}

impl Support {
    /// The support of a kind on a mesh whose long axis is the unit vector `axis`; clamps hold the
    /// [`end_nodes`].
    pub fn new<const D: usize, const N: usize>(
        kind: SupportKind,
        mesh: &Mesh<D, N>,
        axis: [f64; D],
    ) -> Self {
        let [mut lower, upper] = end_nodes(mesh, axis);
        match kind {
            SupportKind::MassCentre => Self::MassCentre,
            SupportKind::SpringHeldEnds { .. }
            | SupportKind::Posts(_)
            | SupportKind::ElasticBed { .. }
            | SupportKind::Gel(_) => Self::Free,
            SupportKind::ClampedEnd => Self::Clamped(lower),
            // At their stops; a loaded grip that has left its stop is a force ([`super::loaded_end`]).
            SupportKind::ClampedEnds | SupportKind::AfterloadedEnds { .. } => {
                lower.extend(upper);
                lower.sort_unstable();
                Self::Clamped(lower)
            }
        }
    }

    /// Removes from the forces the part that the support carries.
    pub fn constrain<const D: usize>(
        &self,
        positions: &Vectors<D>,
        masses: &[f64],
        forces: &mut Vectors<D>,
    ) {
        match self {
            Self::Free => {}
            Self::MassCentre => match (&positions[..], &mut forces[..]) {
                ([x, y], [fx, fy]) => remove_resultant([x, y], masses, [fx, fy]),
                (positions, forces) => remove_resultant_of_solid(positions, masses, forces),
            },
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

/// Removes net force and torque of a flat body by a rigid acceleration.
fn remove_resultant([x, y]: [&Vec<f64>; 2], masses: &[f64], [fx, fy]: [&mut Vec<f64>; 2]) {
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

/// Removes net force and torque with three axes: torque and angular acceleration are vectors,
/// `torque = inertia angular`.
fn remove_resultant_of_solid(positions: &[Vec<f64>], masses: &[f64], forces: &mut [Vec<f64>]) {
    let mass: f64 = masses.iter().sum();
    let axes = [0, 1, 2];
    let centre =
        axes.map(|axis| positions[axis].iter().zip(masses).map(|(x, m)| x * m).sum::<f64>() / mass);
    let net = axes.map(|axis| forces[axis].iter().sum::<f64>() / mass);
    let (mut torque, mut inertia) = ([0.0; 3], [[0.0; 3]; 3]);
    for (node, mass) in masses.iter().enumerate() {
        let arm = axes.map(|axis| positions[axis][node] - centre[axis]);
        let part = cross(arm, axes.map(|axis| forces[axis][node]));
        let square: f64 = arm.iter().map(|x| x * x).sum();
        for i in axes {
            torque[i] += part[i];
            inertia[i][i] += mass * square;
            for j in axes {
                inertia[i][j] -= mass * arm[i] * arm[j];
            }
        }
    }
    // Cramer's rule; the inertia of masses that are not collinear is positive definite.
    let [a, b, c] = inertia;
    let along = |u: [f64; 3], v: [f64; 3]| u.iter().zip(v).map(|(u, v)| u * v).sum::<f64>();
    let determinant = along(a, cross(b, c));
    let columns = [cross(b, c), cross(c, a), cross(a, b)];
    let angular =
        axes.map(|axis| (0..3).map(|k| columns[k][axis] * torque[k]).sum::<f64>() / determinant);
    for (node, mass) in masses.iter().enumerate() {
        let turn = cross(angular, axes.map(|axis| positions[axis][node] - centre[axis]));
        for axis in axes {
            forces[axis][node] -= mass * (net[axis] + turn[axis]);
        }
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
