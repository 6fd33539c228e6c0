//! Supports that give way: closed forms of a bar, their limits, and the same answer in time and along
//! the path of equilibria.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use super::quasi_static::{cell, largest_difference, tear_drop};
use crate::common::Sample;
use myospring::analysis::shape::ShapeMeter;
use myospring::integrate::quasi_static::{Path, PathError, Tolerance};
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::interruption::Interruption;
use myospring::mechanics::Vectors;
use myospring::mechanics::material::{Material, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::{Support, SupportKind};
use myospring::mesh::{Mesh, lattice, quality};

/// A bar without area law: Young's modulus 308 kPa in uniaxial stress, thickness 10 um.
const YOUNG: f64 = 308.0;
const THICKNESS: f64 = 10.0;
/// So little tension, kPa, that the bar is linear to a part in ten thousand.
const LITTLE: f64 = 0.01;

/// Shapes under a tension, by both methods.
fn shapes(mesh: &Mesh, material: &Material, support: SupportKind, tension: f64) -> [Vectors; 2] {
    let (body, system) = cell(mesh, material, support);
    let path = Path::solve(&system, &body, tension, Tolerance::default()).unwrap();
    let step = 0.8 * StabilityLimit::of(&system, &body, tension).time_step;
    let mut motion = Motion::new(&system, body.clone(), Integrator::StoermerVerlet, step);
    motion.advance((5.0 / step) as usize, [0.0, tension]).unwrap();
    motion.advance((60.0 / step) as usize, [tension; 2]).unwrap();
    [path.positions(tension).unwrap(), motion.body.positions]
}

fn soft() -> Material {
    Material { area_modulus: 0.0, ..default_material() }
}

#[test]
fn a_bar_on_an_elastic_bed_follows_the_shear_lag_solution() {
    // Equilibrium of a slice of the bar, N' = W b u with N = W w (E u' + Ta), ends free of load:
    //   u'' = u/lambda^2,  lambda^2 = E w/b,  u'(+-L/2) = -Ta/E
    //   u = -(Ta/E) lambda sinh(x/lambda) / cosh(L/(2 lambda))
    let mesh = lattice::rectangle(100, 2, 1.0).unwrap();
    for bed in [0.5, 2.0, 5.0] {
        let lambda = (YOUNG * THICKNESS / bed).sqrt();
        let support = SupportKind::ElasticBed { stiffness: bed };
        let exact =
            |x: f64| -LITTLE / YOUNG * lambda * (x / lambda).sinh() / (50.0 / lambda).cosh();
        let middle = 0.5 * (mesh.points[0][0] + mesh.points[0][mesh.len() - 1]);
        for shape in shapes(&mesh, &soft(), support, LITTLE) {
            for node in 0..mesh.len() {
                let x = mesh.points[0][node];
                let error = shape[0][node] - x - exact(x - middle);
                // The bed resists the widening of the bar (W^2/12 lambda^2) and the lattice is no
                // continuum (h^2/12 lambda^2): some parts in a thousand.
                assert!(
                    error.abs() < 2e-3 * exact(-50.0),
                    "{bed} kPa/um, x = {x}: off by {error} um of {}",
                    exact(-50.0)
                );
            }
        }
    }
}

/// Shortening of the middle of a bar between two springs, in um per um.
///
/// Half of the bar, `u(0) = 0`, strain `-s` in the middle; in the zone of length `z` at the end the
/// spring acts as a bed, `u'' = u/mu^2` with `mu^2 = E A z/K` and `u' = -Ta/E` at the end. Displacement and
/// strain go on smoothly where the zone begins, at `a`:
///   s a = d cosh(z/mu) - e mu sinh(z/mu),  s = e cosh(z/mu) - (d/mu) sinh(z/mu),  e = Ta/E
/// where `d` is how far the end itself comes in. As `z` goes to 0 this is `s = Ta A/(E A + K L/2)`: the
/// cell's stiffness beside that of two springs in series.
fn strain_between_springs(length: f64, width: f64, zone: f64, spring: f64, tension: f64) -> f64 {
    let section = width * THICKNESS;
    let mu = (YOUNG * section * zone / spring).sqrt();
    let (sinh, cosh) = ((zone / mu).sinh(), (zone / mu).cosh());
    let (e, a) = (tension / YOUNG, 0.5 * length - zone);
    let end = e * (a * cosh + mu * sinh) / (cosh + a * sinh / mu);
    e * cosh - end / mu * sinh
}

#[test]
fn a_bar_between_springs_shortens_as_far_as_cell_and_springs_together_allow() {
    let mesh = lattice::rectangle(100, 4, 1.0).unwrap();
    // Six columns of nodes are held, half a square around each.
    let zone = 5.5;
    let mut sample = Sample::one_in(3);
    for spring in [100.0, 10.0, 1000.0] {
        if sample.leaves_out() {
            continue;
        }
        let support = SupportKind::SpringHeldEnds { stiffness: spring };
        let exact = strain_between_springs(100.0, 4.0, zone, spring, LITTLE);
        // The point attachment that a physiologist writes down is near.
        let section = 4.0 * THICKNESS;
        let lumped = LITTLE * section / (YOUNG * section + 0.5 * spring * 100.0);
        assert!((exact / lumped - 1.0).abs() < 0.08, "{exact} {lumped}");
        for shape in shapes(&mesh, &soft(), support, LITTLE) {
            // Nodes 20 and 80 of the lowest row.
            let measured = 1.0 - (shape[0][80] - shape[0][20]) / 60.0;
            let error = measured / exact - 1.0;
            // The transverse springs and the lattice: some parts in a thousand.
            assert!(error.abs() < 3e-3, "{spring} nN/um: {measured}, closed form {exact}");
        }
    }
}

#[test]
fn any_cell_comes_to_rest_on_its_path_on_a_bed_and_between_springs() {
    let mesh = tear_drop(4.0);
    for support in [
        SupportKind::ElasticBed { stiffness: 0.5 },
        SupportKind::SpringHeldEnds { stiffness: 300.0 },
    ] {
        let (_, system) = cell(&mesh, &default_material(), support);
        assert_eq!(system.support, Support::Free, "nothing is constrained besides");
        let [path, motion] = shapes(&mesh, &default_material(), support, 50.0);
        let error = largest_difference(&path, &motion);
        assert!(error < 1e-3, "{support:?}: {error} um");
    }
}

#[test]
fn a_stiff_spring_clamps_and_a_soft_one_lets_go() {
    let mesh = tear_drop(4.0);
    let axis = quality::long_axis(&mesh);
    let meter = ShapeMeter::new(mesh.points.clone(), axis, &mesh.areas);
    let shape = |support| {
        let (body, system) = cell(&mesh, &default_material(), support);
        let path = Path::solve(&system, &body, 50.0, Tolerance::default()).unwrap();
        path.positions(50.0).unwrap()
    };
    let clamped = shape(SupportKind::ClampedEnds);
    let springs = |stiffness| shape(SupportKind::SpringHeldEnds { stiffness });
    // The clamp's force, some 2e4 nN, moves springs of 1e8 nN/um by 2e-4 um.
    assert!(largest_difference(&clamped, &springs(1e8)) < 1e-3);
    let length = |positions: &Vectors| meter.measure(positions).length;
    let free = length(&shape(SupportKind::MassCentre));
    for soft in [springs(1e-4), shape(SupportKind::ElasticBed { stiffness: 1e-6 })] {
        assert!((length(&soft) - free).abs() < 1e-3, "{} um, free {free} um", length(&soft));
    }
    let stiff = shape(SupportKind::ElasticBed { stiffness: 1e6 });
    assert!(largest_difference(&stiff, &mesh.points) < 1e-3);
}

#[test]
fn the_stability_limit_counts_the_bed() {
    let mesh = lattice::rectangle(20, 4, 1.0).unwrap();
    // Stiff enough to set the limit alone: all masses on b A, so omega^2 = b/(rho w).
    let bed = 1e6;
    let (body, system) = cell(&mesh, &soft(), SupportKind::ElasticBed { stiffness: bed });
    let limit = StabilityLimit::of(&system, &body, 0.0);
    let bare = bed / (soft().density(20.0) * THICKNESS);
    let (free_body, free) = cell(&mesh, &soft(), SupportKind::MassCentre);
    let lattice = StabilityLimit::of(&free, &free_body, 0.0).angular_frequency.powi(2);
    let square = limit.angular_frequency.powi(2);
    // The bed adds the same to the square of every vibration.
    assert!((square / (bare + lattice) - 1.0).abs() < 1e-3, "{square} of {bare} + {lattice}");
    for (part, stable) in [(0.97, true), (1.03, false)] {
        let mut body = body.clone();
        for (node, x) in body.velocities[0].iter_mut().enumerate() {
            *x = 1e-6 * ((node * 7919 % 97) as f64 - 48.0);
        }
        let before = body.kinetic_energy();
        let mut motion =
            Motion::new(&system, body, Integrator::VelocityVerlet, part * limit.time_step);
        motion.advance(3000, [0.0; 2]).unwrap();
        let after = motion.body.kinetic_energy();
        assert_eq!(after < before, stable, "{part} of the limit: {before} fJ becomes {after} fJ");
    }
}

#[test]
fn a_fixed_mass_centre_on_a_bed_is_refused_along_the_path() {
    let mesh = lattice::rectangle(10, 4, 1.0).unwrap();
    let (body, mut system) =
        cell(&mesh, &default_material(), SupportKind::ElasticBed { stiffness: 1.0 });
    system.support = Support::MassCentre;
    let error =
        Path::start(&system, &body, Tolerance::default(), &Interruption::default()).err().unwrap();
    assert!(matches!(error, PathError::External { force: "elastic bed" }), "{error}");
}
