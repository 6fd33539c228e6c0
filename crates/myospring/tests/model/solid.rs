//! Three axes: a bar of tetrahedra, its laws and its equilibria.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::mechanics::noise;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::active::{FibreTension, Myofibrils};
use myospring::mechanics::anchor::Anchors;
use myospring::mechanics::area::{AreaLaw, AreaPreservation};
use myospring::mechanics::drag::Drag;
use myospring::mechanics::spring::Springs;
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::Support;
use myospring::mechanics::volume::VolumePreservation;
use myospring::mechanics::{
    Body, Configuration, Following, Force, System, Tension, Vectors, zeros,
};
use myospring::mesh::{Mesh, cubes, lattice};
use myospring::testing::force;
use std::array::from_fn;

/// Tetrahedra of a cube.
const CUBE: usize = 10;
const YOUNG: f64 = 300.0;

/// Stiffness of all springs over the spacing, and kappa, of a solid with this Poisson's ratio: mu and
/// lambda - mu with Lame's constants.
fn constants(poisson: f64) -> [f64; 2] {
    let shear = YOUNG / (2.0 * (1.0 + poisson));
    let lame = YOUNG * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    [shear, lame - shear]
}

fn springs(mesh: &Mesh<3, 4>, stiffness: f64, damping: f64) -> Springs {
    let nodes: Vec<[u32; 2]> = mesh.springs.iter().map(|spring| spring.nodes).collect();
    let rest = |pair: &[u32; 2]| {
        let [a, b] = pair.map(|node| mesh.point(node as usize));
        (0..3).map(|axis| (b[axis] - a[axis]).powi(2)).sum::<f64>().sqrt()
    };
    let rest_length: Vec<f64> = nodes.iter().map(rest).collect();
    let stiffness: Vec<f64> = mesh.springs.iter().map(|spring| spring.share * stiffness).collect();
    let damping = vec![damping; nodes.len()];
    Springs::new(nodes, stiffness, rest_length, damping)
}

/// A bar of 6 x 3 x 2 cubes of 2 um whose slowest vibration takes 1 ms.
fn made(poisson: f64, fibre: [f64; 3]) -> (Mesh<3, 4>, Body<3>, System<3>) {
    let mesh = cubes::block([6, 3, 2], 2.0).unwrap();
    let density = YOUNG * (1.0_f64 / (2.0 * 12.0)).powi(2);
    let body = Body::at_rest(&mesh, density, 1.0);
    let [shear, kappa] = constants(poisson);
    let system = System {
        passive: vec![
            Box::new(springs(&mesh, shear * 2.0, 0.5)),
            Box::new(VolumePreservation::new(&mesh, CUBE, kappa)),
        ],
        active: vec![Box::new(FibreTension::uniform(&mesh, fibre, 1.0))],
        drag: Drag::of_slowest_mode(1.0, 0.5, &body.masses),
        support: Support::MassCentre,
    };
    (mesh, body, system)
}

/// Stretches along and across a fibre along x of the homogeneous bar, from its energy per volume alone:
/// with mu = k/h, `L^2 = (a^2 + b^2)/2`,
/// `W = mu/2 [(a-1)^2 + 2 (b-1)^2] + mu [4 (L-1)^2 + 2 (b-1)^2] + kappa/2 (a b^2 - 1)^2 + Ta/2 a^2`.
fn closed_form(poisson: f64, tension: f64) -> [f64; 2] {
    let [mu, kappa] = constants(poisson);
    let slope = |[a, b]: [f64; 2]| {
        let l = (0.5 * (a * a + b * b)).sqrt();
        let across = 4.0 * mu * (l - 1.0) / l;
        let pressure = kappa * (a * b * b - 1.0);
        [
            mu * (a - 1.0) + across * a + pressure * b * b + tension * a,
            6.0 * mu * (b - 1.0) + across * b + 2.0 * pressure * a * b,
        ]
    };
    let mut at = [1.0, 1.0];
    for _ in 0..50 {
        let base = slope(at);
        let step = 1e-6;
        let [da, db] = [slope([at[0] + step, at[1]]), slope([at[0], at[1] + step])];
        let k = [0, 1].map(|i| [(da[i] - base[i]) / step, (db[i] - base[i]) / step]);
        let determinant = k[0][0] * k[1][1] - k[0][1] * k[1][0];
        at[0] -= (base[0] * k[1][1] - base[1] * k[0][1]) / determinant;
        at[1] -= (base[1] * k[0][0] - base[0] * k[1][0]) / determinant;
    }
    at
}

/// `x = F X` from four corners of the bar, and how far the others are from it, um.
fn affine(mesh: &Mesh<3, 4>, positions: &Vectors<3>) -> ([[f64; 3]; 3], f64) {
    let at = |of: &Vectors<3>, node: usize| -> [f64; 3] { from_fn(|axis| of[axis][node]) };
    // Nodes 0, 6, 21, 56 - 0: the corner at the origin and the ends of the three edges from it.
    let ends = [6, 7 * 3, 7 * 4 * 2];
    let lengths = [12.0, 6.0, 4.0];
    let origin = at(positions, 0);
    let gradient: [[f64; 3]; 3] =
        from_fn(|i| from_fn(|j| (at(positions, ends[j])[i] - origin[i]) / lengths[j]));
    let mut worst = 0.0_f64;
    for node in 0..mesh.len() {
        let (rest, now) = (at(&mesh.points, node), at(positions, node));
        for i in 0..3 {
            let expected: f64 = origin[i] + (0..3).map(|j| gradient[i][j] * rest[j]).sum::<f64>();
            worst = worst.max((now[i] - expected).abs());
        }
    }
    (gradient, worst)
}

#[test]
fn every_law_keeps_its_promises_with_three_axes() {
    let mesh = cubes::block([3, 2, 2], 1.0).unwrap();
    let scattered = |size: f64, seed: usize| -> Vectors<3> {
        from_fn(|axis| noise(mesh.len(), seed + axis).iter().map(|x| size * x).collect())
    };
    let shift = scattered(0.2, 1);
    let positions: Vectors<3> =
        from_fn(|axis| mesh.points[axis].iter().zip(&shift[axis]).map(|(x, d)| x + d).collect());
    let velocities = scattered(2.0, 5);
    let count = mesh.simplices.len();
    let list = |size: f64, seed: usize| -> Vec<f64> {
        noise(count, seed).iter().map(|x| size * (x + 0.6)).collect()
    };
    let fibres: Vec<[f64; 3]> =
        list(6.0, 11).iter().map(|a| [a.cos() * 0.8, a.sin() * 0.8, 0.6]).collect();
    let content = list(1.0, 12);
    let myofibrils = Myofibrils { directions: &fibres, content: Some(&content) };
    let laws: [Box<dyn Force<3>>; 6] = [
        Box::new(springs(&mesh, 200.0, 0.7)),
        Box::new(VolumePreservation::new(&mesh, CUBE, 500.0)),
        Box::new(VolumePreservation::new(&mesh, 1, 500.0)),
        Box::new(FibreTension::new(&mesh, myofibrils, 1.0)),
        Box::new(Anchors::elastic_bed(&mesh, 3.0)),
        Box::new(Drag { rate: 0.4, masses: mesh.areas.clone() }),
    ];
    let [tension, per_stretch, per_rate, stretch, rate] =
        [(40.0, 20), (90.0, 21), (5.0, 22), (1.0, 23), (0.1, 24)]
            .map(|(size, seed)| list(size, seed));
    let following = Following {
        tension: &tension,
        per_stretch: &per_stretch,
        per_rate: &per_rate,
        stretch: &stretch,
        rate: &rate,
    };
    for tension in
        [Tension::Uniform(35.0), Tension::PerElement(&tension), Tension::Following(following)]
    {
        let at = Configuration { positions: &positions, velocities: &velocities, tension };
        for law in &laws {
            force::check(&**law, &at);
        }
    }
}

#[test]
fn the_volume_law_on_triangles_is_the_area_law() {
    let mesh = lattice::rectangle(5, 3, 1.0).unwrap();
    let positions: Vectors = from_fn(|axis| {
        let shift = noise(mesh.len(), axis);
        mesh.points[axis].iter().zip(shift).map(|(x, d)| x + 0.2 * d).collect()
    });
    let still = zeros(mesh.len());
    let at = Configuration { positions: &positions, velocities: &still, tension: 0.0.into() };
    let area = AreaPreservation::new(&mesh, AreaLaw::Gradient, 700.0);
    // A triangle counts with its weight 1/2: (w k/2)(A - A0)^2/A0 is (k/2)(wA - wA0)^2/(wA0).
    let volume = VolumePreservation::new(&mesh, 1, 700.0);
    let [mut a, mut b] = [zeros(mesh.len()), zeros(mesh.len())];
    area.add_forces(&at, &mut a);
    volume.add_forces(&at, &mut b);
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        // Rounding of forces of some 100 nN.
        assert!((a - b).abs() < 1e-10, "{a} nN, {b} nN");
    }
    let (a, b) = (area.energy(&at).unwrap(), volume.energy(&at).unwrap());
    assert!((a / b - 1.0).abs() < 1e-12);
}

#[test]
fn a_bar_under_uniform_tension_deforms_homogeneously_as_its_energy_says_by_both_methods() {
    let x = [1.0, 0.0, 0.0];
    for poisson in [0.3, 0.45] {
        let (mesh, body, system) = made(poisson, x);
        let path = Path::solve(&system, &body, 50.0, Tolerance::default()).unwrap();
        let last = path.range()[1];
        for tension in [20.0, last] {
            let [along, across] = closed_form(poisson, tension);
            assert!(along < 0.97 && across > 1.0, "{along}, {across}");
            let (gradient, off) = affine(&mesh, &path.positions(tension).unwrap());
            // Interpolation between load steps: 1e-6 of 12 um; at a load step rounding.
            let allowed = if tension == last { 1e-9 } else { 1.2e-5 };
            assert!(off < allowed, "nu = {poisson}, {tension} kPa: {off} um from affine");
            for (axis, stretch) in [along, across, across].into_iter().enumerate() {
                let error = (gradient[axis][axis] - stretch).abs();
                assert!(error < allowed, "nu = {poisson}, {tension} kPa, axis {axis}: {error}");
            }
        }
        let step = 0.8 * StabilityLimit::of(&system, &body, 50.0).time_step;
        for form in Integrator::ALL {
            let mut motion = Motion::new(&system, body.clone(), form, step);
            motion.advance((10.0 / step) as usize, [0.0, 50.0]).unwrap();
            motion.advance((15.0 / step) as usize, [50.0; 2]).unwrap();
            let [along, across] = closed_form(poisson, 50.0);
            let (gradient, off) = affine(&mesh, &motion.body.positions);
            // What drag leaves of the motion after 15 periods: e^(-0.5 2 pi 15) is nothing.
            assert!(off < 1e-8, "{form:?}: {off} um from affine");
            for (axis, stretch) in [along, across, across].into_iter().enumerate() {
                assert!((gradient[axis][axis] - stretch).abs() < 1e-8, "{form:?}, axis {axis}");
            }
        }
    }
}

#[test]
fn a_bar_with_fibres_in_any_direction_stays_homogeneous_and_is_isotropic() {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for fibre in [[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.36, 0.48, 0.8], [0.0, 0.8, -0.6]] {
        let (mesh, body, system) = made(0.4, fibre);
        // Small enough for Hooke's law to hold to a part in a thousand.
        let small = 1e-4 * YOUNG;
        let path = Path::solve(&system, &body, 40.0, Tolerance::default()).unwrap();
        let (_, off) = affine(&mesh, &path.positions(40.0).unwrap());
        assert!(off < 1e-9, "{fibre:?}: {off} um from affine");
        let path = Path::solve(&system, &body, small, Tolerance::default()).unwrap();
        let (gradient, _) = affine(&mesh, &path.positions(small).unwrap());
        let strain = |u: [f64; 3], v: [f64; 3]| -> f64 {
            let part = |i: usize, j: usize| gradient[i][j] - f64::from(u8::from(i == j));
            (0..9).map(|k| u[k / 3] * part(k / 3, k % 3) * v[k % 3]).sum()
        };
        let along = -strain(fibre, fibre) * YOUNG / small;
        (least, most) = (least.min(along), most.max(along));
        let trace = (0..3).map(|i| gradient[i][i] - 1.0).sum::<f64>();
        let poisson = -(trace / strain(fibre, fibre) - 1.0) / 2.0;
        assert!((poisson - 0.4).abs() < 1e-3, "{fibre:?}: nu = {poisson}");
    }
    assert!((least - 1.0).abs() < 1e-3 && (most - 1.0).abs() < 1e-3, "E/E0: {least} to {most}");
}

#[test]
fn a_solid_whose_mass_centre_is_held_feels_no_force_and_no_torque() {
    let mesh = cubes::block([2, 2, 3], 1.0).unwrap();
    let mut forces: Vectors<3> = from_fn(|axis| noise(mesh.len(), 3 + axis));
    Support::MassCentre.constrain(&mesh.points, &mesh.areas, &mut forces);
    for axis in 0..3 {
        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
        let net: f64 = forces[axis].iter().sum();
        let torque: f64 = (0..mesh.len())
            .map(|i| mesh.points[p][i] * forces[q][i] - mesh.points[q][i] * forces[p][i])
            .sum();
        // Rounding of some tens of terms of order 1.
        assert!(net.abs() < 1e-13 && torque.abs() < 1e-12, "{net} nN, {torque} nN um");
    }
}
