//! Paths whose load steps share a factor, beside paths whose steps each have their own.

use super::{Equilibrium, Path, PathError, Tolerance};
use crate::interruption::Interruption;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::material::{Material, assemble, assemble_thick, default_material};
use crate::mechanics::support::SupportKind;
use crate::mechanics::{Body, System, Vectors};
use crate::mesh::{cubes, lattice};

/// A path from rest; `shares`: as if factors were costly.
fn start<'a, const D: usize>(
    system: &'a System<D>,
    body: &'a Body<D>,
    shares: bool,
) -> Path<'a, D> {
    let mut path =
        Path::start(system, body, Tolerance::default(), &Interruption::default()).unwrap();
    path.solver.share_factors(shares);
    path
}

/// A block whose fibres turn by 60 degrees through its thickness, so that it twists.
fn twisting(support: SupportKind) -> (Body<3>, System<3>) {
    let mesh = cubes::block([16, 4, 4], 2.0).unwrap();
    let height =
        |nodes: [u32; 4]| nodes.map(|node| mesh.points[2][node as usize]).iter().sum::<f64>() / 4.0;
    let fibre = |nodes| {
        let (sine, cosine) = (height(nodes) / 8.0 - 0.5).sin_cos();
        [cosine, sine, 0.0]
    };
    let fibres: Vec<_> = mesh.simplices.iter().map(|simplex| fibre(simplex.nodes)).collect();
    assemble_thick(&mesh, &default_material(), &fibres, support, [1.0, 0.0, 0.0], 32.0)
}

fn strip(support: SupportKind) -> (Body, System) {
    let mesh = lattice::rectangle(100, 4, 1.0).unwrap();
    let material = Material { area_modulus: 0.0, ..default_material() };
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    assemble(&mesh, &material, ActiveLaw::Fibre, &fibres, support, [1.0, 0.0], 100.0)
}

#[test]
fn a_path_whose_steps_have_their_own_factors_goes_one_step_beyond_the_tension() {
    let (body, system) = strip(SupportKind::MassCentre);
    let mut path = start(&system, &body, false);
    path.extend(20.0).unwrap();
    let tensions = path.tensions();
    assert!(tensions[tensions.len() - 2] < 20.0 && tensions[tensions.len() - 1] >= 20.0);
}

fn farthest<const D: usize>(a: &Vectors<D>, b: &Vectors<D>) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn agree<const D: usize>(system: &System<D>, body: &Body<D>, extent: f64) {
    let [mut shared, mut own] = [true, false].map(|shares| start(system, body, shares));
    for path in [&mut shared, &mut own] {
        path.extend(40.0).unwrap();
    }
    assert!(shared.factorisations() < own.factorisations());
    for tension in [0.0, 0.4, 3.0, 11.0, 25.0, 40.0] {
        let [a, b] = [&shared, &own].map(|path| path.positions(tension).unwrap());
        // Each is interpolated to a millionth of the extent.
        let off = farthest(&a, &b);
        assert!(off < 2e-6 * extent, "{off:e} um at {tension} kPa");
    }
}

#[test]
fn load_steps_that_share_a_factor_lead_to_the_same_shapes() {
    for support in [SupportKind::MassCentre, SupportKind::ClampedEnd] {
        let (body, system) = strip(support);
        agree(&system, &body, 100.0);
        let (body, system) = twisting(support);
        agree(&system, &body, 32.0);
    }
}

#[test]
fn a_path_that_shares_factors_is_the_beginning_of_a_longer_one_to_the_last_bit() {
    let (body, system) = twisting(SupportKind::MassCentre);
    let mut whole = start(&system, &body, true);
    whole.extend(60.0).unwrap();
    for (first, forgets) in [(0.2, false), (9.0, true), (20.0, false), (20.0, true)] {
        let mut path = start(&system, &body, true);
        path.extend(first).unwrap();
        let (shapes, mut workspace) = path.into_parts();
        if forgets {
            workspace = workspace.clone();
        }
        let mut path = Path::resume(&system, &body, (shapes, workspace), &Interruption::default());
        path.solver.share_factors(true);
        path.extend(60.0).unwrap();
        assert_eq!(path.branches, whole.branches, "by way of {first} kPa");
    }
}

#[test]
fn a_strip_that_buckles_is_found_out_where_several_load_steps_share_a_factor() {
    // It is pushed exactly along its axis, so that it stays straight when that is no longer stable.
    let (body, system) = strip(SupportKind::ClampedEnds);
    let ends = [true, false].map(|shares| {
        let mut path = start(&system, &body, shares);
        let error = path.extend(-20.0).unwrap_err();
        let PathError::Unstable { tension, beyond, place: Some(place) } = error else {
            panic!("{error}")
        };
        assert_eq!(path.range()[0], tension);
        (tension, beyond, place)
    });
    let [(a, ..), (b, beyond, _)] = ends;
    // Each is found to a ten-thousandth.
    assert!((a / b - 1.0).abs() < 3e-4 && a > beyond, "{ends:?}");
    assert_eq!(ends[0].2, ends[1].2);
}

#[test]
fn a_push_that_no_shape_withstands_is_an_error_where_factors_are_shared_and_the_next_shape_is_found()
 {
    let (body, system) = twisting(SupportKind::MassCentre);
    let [mut shared, mut own] = [true, false].map(|shares| {
        let mut equilibrium = Equilibrium::new(&system, &body, Tolerance::default()).unwrap();
        equilibrium.solver.share_factors(shares);
        equilibrium
    });
    // At first, and when there has been a factor.
    for _ in 0..2 {
        let pushed = shared.find(&body.positions, (-5000.0).into());
        assert!(matches!(pushed, Err(PathError::Unstable { .. } | PathError::Lost { .. })));
        let [a, b] =
            [&mut shared, &mut own].map(|of| of.find(&body.positions, 5.0.into()).unwrap());
        let off = farthest(&a, &b);
        assert!(off < 1e-6, "{off:e} um");
    }
}
