//! The patch test: a rectangle under uniform tension deforms homogeneously, whichever way the lattice
//! and the fibres lie.
//!
//! Under `x = F X` the energy per area and thickness of the lattice is, with the lattice's axes `e_1`,
//! `e_2` and diagonals `d_1`, `d_2` (unit vectors), fibre `f`, area modulus K and tension Ta,
//!
//! ```text
//! W(F) = 3/8 E sum_i (|F e_i| - 1)^2 + 3/8 E sum_i (|F d_i| - 1)^2 + K/2 (det F - 1)^2 + Ta/2 |F f|^2
//! ```
//!
//! (`k_1 = 3/4 E w` on two axes, `k_2 = 3/8 E w` on two diagonals, each `2 h^2` long squared). Its minimum over
//! the three components of the right stretch U is the closed form; it is found here from W alone, by
//! Newton's method. For small strains it is Hooke's law with E and nu = 1/3.

use crate::check::{Failure, Setting};
use crate::fit::{affine, right_stretch};
use crate::row::Row;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{Material, assemble, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::SupportKind;
use myospring::mechanics::{Body, System, Vectors};
use myospring::mesh::{Mesh, lattice};
use std::f64::consts::FRAC_1_SQRT_2;

/// Angles of the lattice in the plane and of the fibres against the lattice, degrees.
const LATTICE_ANGLES: [f64; 3] = [0.0, 17.0, 45.0];
const FIBRE_ANGLES: [f64; 5] = [0.0, 20.0, 45.0, 70.0, 90.0];
const TENSION: f64 = 50.0;

fn unit(degrees: f64) -> [f64; 2] {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    [cosine, sine]
}

/// A block of 12 x 8 squares whose lattice lies at an angle.
fn block(degrees: f64) -> Result<Mesh, Failure> {
    let Mesh { points, areas, springs, simplices, .. } = lattice::rectangle(12, 8, 1.0)?;
    let [cosine, sine] = unit(degrees);
    let turned = |a: f64, b: f64| -> Vec<f64> {
        points[0].iter().zip(&points[1]).map(|(x, y)| a * x + b * y).collect()
    };
    Ok(Mesh::new([turned(cosine, -sine), turned(sine, cosine)], areas, springs, simplices, None)?)
}

fn made(mesh: &Mesh, material: &Material, fibre: [f64; 2]) -> (Body, System) {
    let fibres = vec![fibre; mesh.simplices.len()];
    assemble(mesh, material, ActiveLaw::Fibre, &fibres, SupportKind::MassCentre, fibre, 12.0)
}

/// Energy per area and thickness of the homogeneous lattice, kPa, under the stretch `[xx, xy, yy]`;
/// lattice along the axes.
fn energy(young: f64, area: f64, tension: f64, fibre: [f64; 2], [xx, xy, yy]: [f64; 3]) -> f64 {
    let length = |[x, y]: [f64; 2]| (xx * x + xy * y).hypot(xy * x + yy * y);
    let axes = [[1.0, 0.0], [0.0, 1.0]];
    let diagonals = [[FRAC_1_SQRT_2; 2], [FRAC_1_SQRT_2, -FRAC_1_SQRT_2]];
    let springs = axes.into_iter().chain(diagonals).map(|d| (length(d) - 1.0).powi(2)).sum::<f64>();
    let change = xx * yy - xy * xy - 1.0;
    0.375 * young * springs + 0.5 * area * change * change + 0.5 * tension * length(fibre).powi(2)
}

/// Its stretch of least energy, by Newton's method with differences of W.
fn closed_form(young: f64, area: f64, tension: f64, fibre: [f64; 2]) -> [f64; 3] {
    let w = |at: [f64; 3]| energy(young, area, tension, fibre, at);
    let shifted = |at: [f64; 3], i: usize, by: f64| {
        let mut to = at;
        to[i] += by;
        to
    };
    // Central differences of order 4: exact to some 1e-11 with this step.
    let e = 2e-3;
    let gradient = |at: [f64; 3]| {
        [0, 1, 2].map(|i| {
            let d = |by: f64| w(shifted(at, i, by)) - w(shifted(at, i, -by));
            (45.0 * d(e) - 9.0 * d(2.0 * e) + d(3.0 * e)) / (60.0 * e)
        })
    };
    let mut at = [1.0, 0.0, 1.0];
    for _ in 0..60 {
        let g = gradient(at);
        let columns = [0, 1, 2].map(|j| {
            let (plus, minus) = (gradient(shifted(at, j, 1e-4)), gradient(shifted(at, j, -1e-4)));
            [0, 1, 2].map(|i| (plus[i] - minus[i]) / 2e-4)
        });
        let step = solve(columns, g);
        for i in 0..3 {
            at[i] -= step[i];
        }
    }
    at
}

/// Solves a system of three equations given by its columns, by Cramer's rule.
fn solve(columns: [[f64; 3]; 3], right: [f64; 3]) -> [f64; 3] {
    let det = |[a, b, c]: [[f64; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let whole = det(columns);
    [0, 1, 2].map(|i| {
        let mut replaced = columns;
        replaced[i] = right;
        det(replaced) / whole
    })
}

const EXACT: Tolerance = Tolerance {
    interpolation: 1e-10,
    equilibrium: 1e-13,
    smallest_step: 1e-4,
    longest_delay: f64::INFINITY,
};

fn at_rest(
    mesh: &Mesh,
    material: &Material,
    fibre: [f64; 2],
    tension: f64,
) -> Result<Vectors, Failure> {
    let (body, system) = made(mesh, material, fibre);
    let path = Path::solve(&system, &body, tension, EXACT)?;
    Ok(path.positions(tension).ok_or("the path has no shape at its last tension")?)
}

fn settled(mesh: &Mesh, material: &Material, fibre: [f64; 2]) -> Result<Vectors, Failure> {
    let material = Material { drag_ratio: 1.0, ..material.clone() };
    let (body, system) = made(mesh, &material, fibre);
    let step = 0.8 * StabilityLimit::of(&system, &body, TENSION).time_step;
    let mut motion = Motion::new(&system, body, Integrator::StoermerVerlet, step);
    motion.advance((10.0 / step) as usize, [0.0, TENSION])?;
    motion.advance((60.0 / step) as usize, [TENSION; 2])?;
    Ok(motion.body.positions)
}

/// Departure from a homogeneous shape (of the length), and from the closed form's stretch.
fn misses(mesh: &Mesh, lattice_angle: f64, now: &Vectors, exact: [f64; 3]) -> [f64; 2] {
    let (map, residual) = affine(&mesh.points, now);
    // Seen from the lattice's axes: G R with R the rotation of the lattice.
    let [c, s] = unit(lattice_angle);
    let turned = map.map(|[x, y]| [c * x + s * y, c * y - s * x]);
    let stretch = right_stretch(turned);
    let off = (0..3).map(|i| (stretch[i] - exact[i]).abs()).fold(0.0, f64::max);
    [residual / 12.0, off]
}

/// The largest of [`misses`] over lattice and fibre angles: of equilibria, and of what has moved there.
fn largest_misses(setting: &Setting<'_>) -> Result<[[f64; 2]; 2], Failure> {
    let (mut by_path, mut by_motion) = ([0.0_f64; 2], [0.0_f64; 2]);
    for area_modulus in [0.0, 175.0] {
        let material = Material { area_modulus, ..default_material() };
        let young = material.young_modulus();
        for lattice_angle in LATTICE_ANGLES {
            let mesh = block(lattice_angle)?;
            for angle in FIBRE_ANGLES {
                let fibre = unit(lattice_angle + angle);
                let exact = closed_form(young, area_modulus, TENSION, unit(angle));
                let shape = at_rest(&mesh, &material, fibre, TENSION)?;
                let miss = misses(&mesh, lattice_angle, &shape, exact);
                by_path = [0, 1].map(|k| by_path[k].max(miss[k]));
                if !setting.quick || angle == 20.0 {
                    let shape = settled(&mesh, &material, fibre)?;
                    let miss = misses(&mesh, lattice_angle, &shape, exact);
                    by_motion = [0, 1].map(|k| by_motion[k].max(miss[k]));
                }
            }
        }
    }
    Ok([by_path, by_motion])
}

/// Homogeneous shapes at 50 kPa, and Hooke's law at small tension.
///
/// # Errors
/// A mesh or an equilibrium that cannot be found.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let [by_path, by_motion] = largest_misses(setting)?;
    let [young, poisson, shear] = small_strain()?;
    let against = "minimum of the homogeneous lattice's energy";
    Ok(vec![
        Row::difference(
            "patch test at 50 kPa, any lattice and fibre angle, equilibria: departure from a \
             homogeneous shape",
            "an affine map",
            by_path[0],
            1e-10,
            "of the length",
            "tolerance of the equilibrium",
        ),
        Row::difference(
            "the same: stretches along, across and shear",
            against,
            by_path[1],
            1e-9,
            "",
            "tolerance of the equilibrium and differences of the energy",
        ),
        Row::difference(
            "patch test by Verlet's method, 70 ms: departure from a homogeneous shape",
            "an affine map",
            by_motion[0],
            1e-9,
            "of the length",
            "motion not yet damped by drag",
        ),
        Row::difference(
            "the same: stretches along, across and shear",
            against,
            by_motion[1],
            1e-9,
            "",
            "motion not yet damped by drag",
        ),
        Row::difference(
            "Young's modulus from small strains, any fibre angle, relative error",
            "Hooke's law with the given modulus",
            young,
            1e-6,
            "",
            "extrapolated from 1e-4 and half of it: the error is the square of the strain",
        ),
        Row::difference(
            "Poisson's ratio from small strains, any fibre angle, minus 1/3",
            "isotropic lattice of central springs: 1/3",
            poisson,
            1e-6,
            "",
            "as above",
        ),
        Row::difference(
            "shear from small strains, of the strain, any fibre angle",
            "isotropy: none",
            shear,
            1e-6,
            "",
            "as above",
        ),
    ])
}

/// Largest errors of Young's modulus, Poisson's ratio and shear over all fibre angles.
fn small_strain() -> Result<[f64; 3], Failure> {
    let material = Material { area_modulus: 0.0, ..default_material() };
    let young = material.young_modulus();
    let mesh = block(0.0)?;
    let mut worst = [0.0_f64; 3];
    for angle in FIBRE_ANGLES {
        let fibre = unit(angle);
        // E, nu and shear over strain at a tension.
        let measure = |tension: f64| -> Result<[f64; 3], Failure> {
            let shape = at_rest(&mesh, &material, fibre, tension)?;
            let [xx, xy, yy] = right_stretch(affine(&mesh.points, &shape).0);
            let [c, s] = fibre;
            let along = xx * c * c + 2.0 * xy * c * s + yy * s * s - 1.0;
            let across = xx * s * s - 2.0 * xy * c * s + yy * c * c - 1.0;
            let shear = (yy - xx) * c * s + xy * (c * c - s * s);
            Ok([-tension / along, -across / along, shear / along])
        };
        let (whole, half) = (measure(1e-4 * young)?, measure(5e-5 * young)?);
        let limit = [0, 1, 2].map(|k| 2.0 * half[k] - whole[k]);
        let errors = [limit[0] / young - 1.0, limit[1] - 1.0 / 3.0, limit[2]];
        worst = [0, 1, 2].map(|k| worst[k].max(errors[k].abs()));
    }
    Ok(worst)
}
