//! The fused kernel of a lattice: equal to the sum of the laws to rounding, and to itself to the bit.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "helpers of tests")]

#[path = "common/skipped.rs"]
mod skipped;

#[path = "common/sample.rs"]
mod sample;

use myospring::integrate::engine::{Engine, EngineError, EngineUsed, Loops, Task};
use myospring::integrate::fused::FusedMotion;
use myospring::integrate::stencil::{Stencil, Units, worthwhile_threads};
use myospring::integrate::stepper::{StepError, Stepper};
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::active::{ActiveLaw, FibreTension};
use myospring::mechanics::anchor::Anchors;
use myospring::mechanics::area::{AreaLaw, AreaPreservation};
use myospring::mechanics::drag::Drag;
use myospring::mechanics::lattice_law::LatticeLaw;
use myospring::mechanics::material::{Material, assemble, default_material};
use myospring::mechanics::spring::Springs;
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::{Support, SupportKind};
use myospring::mechanics::volume::VolumePreservation;
use myospring::mechanics::{Body, Configuration, Force, System, Vectors, zeros};
use myospring::mesh::{Mesh, SpringKind, built_in, cubes, lattice, quality};
use proptest::prelude::*;
use sample::Sample;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Repeatable numbers in 1/2..3/2.
fn field(count: usize, seed: usize) -> Vec<f64> {
    let one = |i: usize| ((i * 7919 + seed * 104_729 + 1) as f64 * 0.618_033_988_75).fract() + 0.5;
    (0..count).map(one).collect()
}

/// A mesh whose every mass, spring, dashpot and fibre differs from the next, under this law of area or volume; disturbed and
/// moving.
fn varied_under<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    law: Box<dyn Force<D>>,
    fibre: impl Fn(f64) -> [f64; D],
    support: Support,
    seed: usize,
) -> (Body<D>, System<D>) {
    let count = mesh.springs.len();
    let masses: Vec<f64> =
        mesh.areas.iter().zip(field(mesh.len(), seed)).map(|(area, f)| 0.02 * area * f).collect();
    let nodes: Vec<[u32; 2]> = mesh.springs.iter().map(|spring| spring.nodes).collect();
    let stiffness = mesh.springs.iter().zip(field(count, seed + 1));
    let rest_length = |pair: &[u32; 2]| {
        let [a, b] = pair.map(|node| mesh.point(node as usize));
        a.iter().zip(b).map(|(a, b)| b - a).fold(0.0, f64::hypot)
    };
    let springs = Springs::new(
        nodes.clone(),
        stiffness.map(|(spring, f)| 400.0 * spring.share * f).collect(),
        nodes.iter().map(rest_length).collect(),
        field(count, seed + 2).iter().map(|f| 0.5 * f).collect(),
    );
    let fibres: Vec<[f64; D]> =
        field(mesh.simplices.len(), seed + 3).into_iter().map(fibre).collect();
    let system = System {
        passive: vec![Box::new(springs), law],
        active: vec![Box::new(FibreTension::new(mesh, &fibres, 10.0))],
        drag: Drag { rate: 1.3, masses: masses.clone() },
        support,
    };
    let spacing = mesh.lattice.as_ref().unwrap().spacing;
    let positions = std::array::from_fn(|axis| {
        let shift = field(mesh.len(), seed + 4 + axis);
        mesh.points[axis].iter().zip(shift).map(|(x, f)| x + 0.1 * spacing * (f - 1.0)).collect()
    });
    let velocities = std::array::from_fn(|axis| {
        field(mesh.len(), seed + 7 + axis).iter().map(|f| f - 1.0).collect()
    });
    (Body { positions, velocities, masses }, system)
}

/// As [`varied_under`], of a flat cell.
fn varied(mesh: &Mesh, support: Support, seed: usize) -> (Body, System) {
    let law = Box::new(AreaPreservation::new(mesh, AreaLaw::Gradient, 1500.0));
    varied_under(mesh, law, |a| [(6.0 * a).cos(), (6.0 * a).sin()], support, seed)
}

/// As [`varied_under`], of a thick cell.
fn varied_in_space(mesh: &Mesh<3, 4>, support: Support, seed: usize) -> (Body<3>, System<3>) {
    let law = Box::new(VolumePreservation::new(mesh, cubes::TETRAHEDRA_OF_A_CUBE, 150.0));
    let fibre = |a: f64| [0.8 * (6.0 * a).cos(), 0.8 * (6.0 * a).sin(), 0.6];
    varied_under(mesh, law, fibre, support, seed)
}

/// An ellipsoid of cubes, with this many along each axis.
fn ellipsoid(shape: [usize; 3], spacing: f64) -> Mesh<3, 4> {
    let grid = cubes::Grid { spacing, origin: [-3.0, 70.0, 0.5], shape };
    let within = |cube: usize| {
        let place = grid.place(cube);
        let part = |axis: usize| {
            let half = 0.5 * shape[axis] as f64;
            ((place[axis] as f64 + 0.5 - half) / half).powi(2)
        };
        (0..3).map(part).sum::<f64>() <= 1.1
    };
    cubes::filled(&grid, &(0..grid.len()).map(within).collect::<Vec<_>>()).unwrap()
}

fn largest_difference<const D: usize>(a: &Vectors<D>, b: &Vectors<D>) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}

/// Each kind of vector units that this processor has, not only its best; a test says which it lacks.
fn available() -> impl Iterator<Item = Units> {
    Units::ALL.into_iter().filter(|units| {
        if !units.available() {
            skipped::skipped(&format!("a processor with {units:?}"));
        }
        units.available()
    })
}

fn fused<'a, const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    system: &'a System<D>,
    body: &Body<D>,
    step: f64,
    threads: usize,
    units: Units,
) -> FusedMotion<'a, D> {
    let lattice = mesh.lattice.as_ref().unwrap();
    FusedMotion::new(system, body.clone(), lattice, step, threads, units).unwrap()
}

/// Half of the largest stable step, ms.
fn stable_step<const D: usize>((body, system): &(Body<D>, System<D>)) -> f64 {
    0.5 * StabilityLimit::of(system, body, 50.0).time_step
}

/// The same motion by the plain loops of one form of Verlet's method and by the kernel, which has the other.
fn both_ways<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    (body, system): &(Body<D>, System<D>),
    (step, steps): (f64, [usize; 2]),
    threads: usize,
    units: Units,
) -> [Body<D>; 2] {
    let plain = Motion::new(system, body.clone(), Integrator::VelocityVerlet, step);
    let fused = fused(mesh, system, body, step, threads, units);
    let both: [Box<dyn Stepper<D>>; 2] = [Box::new(plain), Box::new(fused)];
    both.map(|mut motion| {
        motion.advance(steps[0], [0.0, 40.0].map(Into::into)).unwrap();
        motion.advance(steps[1], [40.0, 50.0].map(Into::into)).unwrap();
        motion.body().clone()
    })
}

/// Rounding of positions of some 100 um and of velocities that forces of 1e3 nN change, over some
/// tens of steps of a motion that is regular.
fn assert_same_to_rounding<const D: usize>([plain, fused]: &[Body<D>; 2], what: &str) {
    let positions = largest_difference(&plain.positions, &fused.positions);
    assert!(positions < 1e-11, "{what}: positions differ by {positions} um");
    let velocities = largest_difference(&plain.velocities, &fused.velocities);
    assert!(velocities < 1e-9, "{what}: velocities differ by {velocities} um/ms");
}

/// The same motion both ways: free, or held by the mass centre, clamped ends, a bed or springs at the ends.
fn assert_same_however_held<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    axis: [f64; D],
    held: usize,
    problem: impl Fn(Support) -> (Body<D>, System<D>),
    threads: usize,
) {
    let support = match held {
        1 => Support::MassCentre,
        2 => Support::new(SupportKind::ClampedEnds, mesh, axis),
        _ => Support::Free,
    };
    let mut problem = problem(support);
    match held {
        3 => problem.1.passive.push(Box::new(Anchors::elastic_bed(mesh, 40.0))),
        4 => problem.1.passive.push(Box::new(Anchors::spring_held_ends(mesh, axis, 900.0))),
        _ => {}
    }
    let step = stable_step(&problem);
    for units in available() {
        let bodies = both_ways(mesh, &problem, (step, [7, 23]), threads, units);
        assert_same_to_rounding(&bodies, &format!("{units:?} on {threads} threads"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn the_kernel_equals_the_plain_loops_on_any_outline_with_any_fields(
        angle in 0.0..180.0_f64, spacing in 1.5..4.0_f64, seed in 0..1000_usize,
        threads in 1..4_usize, held in 0..5_usize,
    ) {
        let outline = built_in::adult_ventricular().rotated(angle);
        let mesh = lattice::from_outline(&outline, Some(spacing)).unwrap().0;
        let axis = quality::long_axis(&mesh);
        assert_same_however_held(&mesh, axis, held, |support| varied(&mesh, support, seed), threads);
    }

    #[test]
    fn the_kernel_equals_the_plain_loops_in_space_on_any_form_with_any_fields(
        long in 3..40_usize, wide in 1..12_usize, high in 1..12_usize, spacing in 0.7..3.0_f64,
        seed in 0..1000_usize, threads in 1..4_usize, held in 0..5_usize,
    ) {
        let mesh = ellipsoid([long, wide, high], spacing);
        let axis = [1.0, 0.0, 0.0];
        assert_same_however_held(&mesh, axis, held, |support| varied_in_space(&mesh, support, seed), threads);
    }
}

#[test]
#[ignore = "slow"]
fn the_kernel_equals_the_plain_loops_on_a_mesh_larger_than_the_cache() {
    let mut sample = Sample::one_in(4);
    // 24 321 masses with a record each: 3 MB
    let mesh = lattice::rectangle(300, 80, 1.0).unwrap();
    let problem = varied(&mesh, Support::Free, 5);
    let step = stable_step(&problem);
    for (threads, steps) in [(1, [9, 20]), (2, [1, 16]), (3, [30, 3])] {
        for units in available() {
            if sample.leaves_out() {
                continue;
            }
            let bodies = both_ways(&mesh, &problem, (step, steps), threads, units);
            assert_same_to_rounding(&bodies, &format!("{units:?} on {threads} threads"));
        }
    }
}

#[test]
fn the_bits_are_the_same_whatever_the_number_of_threads() {
    let cell = |angle, spacing| {
        let outline = built_in::adult_ventricular().rotated(angle);
        lattice::from_outline(&outline, Some(spacing)).unwrap().0
    };
    for mesh in [cell(0.0, 1.2), cell(33.0, 0.7), lattice::rectangle(700, 40, 1.0).unwrap()] {
        let (body, system) = varied(&mesh, Support::MassCentre, 11);
        for units in available() {
            let run = |threads| {
                let mut motion = fused(&mesh, &system, &body, 1e-4, threads, units);
                motion.advance(5, [0.0, 40.0]).unwrap();
                motion.advance(17, [40.0, 50.0]).unwrap();
                motion.body().clone()
            };
            let one = run(1);
            assert!(one.positions.iter().flatten().all(|x| x.abs() < 1e4), "the motion is regular");
            for threads in 2..=4 {
                let many = run(threads);
                let differ = largest_difference(&one.positions, &many.positions);
                assert!(one == many, "{units:?}, {threads} threads: {differ} um");
            }
        }
    }
}

#[test]
fn the_bits_of_a_thick_cell_are_the_same_whatever_the_number_of_threads() {
    // Within the cache and, with 18 000 masses and a record for most blocks, beyond it.
    for mesh in [ellipsoid([30, 9, 9], 1.5), ellipsoid([70, 25, 18], 1.0)] {
        let (body, system) = varied_in_space(&mesh, Support::MassCentre, 11);
        for units in available() {
            let run = |threads| {
                let mut motion = fused(&mesh, &system, &body, 1e-4, threads, units);
                motion.advance(5, [0.0, 40.0]).unwrap();
                motion.advance(17, [40.0, 50.0]).unwrap();
                (motion.body().clone(), motion.threads())
            };
            let (one, _) = run(1);
            assert!(one.positions.iter().flatten().all(|x| x.abs() < 1e4), "the motion is regular");
            for threads in 2..=4 {
                let (many, made) = run(threads);
                assert!(made >= 2, "{made} threads");
                let differ = largest_difference(&one.positions, &many.positions);
                assert!(one == many, "{units:?}, {threads} threads: {differ} um");
            }
        }
    }
}

#[test]
fn the_kernel_equals_the_plain_loops_inside_a_uniform_block_under_any_laws() {
    // 50 cubes along x: blocks inside share their coefficients.
    let mesh = cubes::block([50, 4, 3], 1.5).unwrap();
    for laws in 0..4 {
        let (body, varied) = varied_in_space(&mesh, Support::Free, 7);
        let (nodes, rest) = mesh
            .springs
            .iter()
            .map(|spring| {
                let length =
                    if spring.kind == SpringKind::Axial { 1.5 } else { 1.5 * 2.0_f64.sqrt() };
                (spring.nodes, length)
            })
            .unzip::<_, _, Vec<_>, Vec<_>>();
        let stiffness = mesh.springs.iter().map(|spring| 400.0 * spring.share).collect();
        let springs = Springs::new(nodes, stiffness, rest, vec![0.3; mesh.springs.len()]);
        let mut system = System { passive: vec![Box::new(springs)], active: vec![], ..varied };
        if laws & 1 != 0 {
            let volume = VolumePreservation::new(&mesh, cubes::TETRAHEDRA_OF_A_CUBE, 150.0);
            system.passive.push(Box::new(volume));
        }
        if laws & 2 != 0 {
            system.active.push(Box::new(FibreTension::uniform(&mesh, [0.6, 0.0, 0.8], 1.0)));
        }
        let body = Body { masses: vec![0.1; mesh.len()], ..body };
        system.drag.masses.clone_from(&body.masses);
        let problem = (body, system);
        let step = stable_step(&problem);
        for units in available() {
            let bodies = both_ways(&mesh, &problem, (step, [7, 23]), 2, units);
            assert_same_to_rounding(&bodies, &format!("{units:?} under {laws}"));
        }
    }
}

#[test]
fn a_cube_whose_tetrahedra_are_others_has_no_place_in_the_kernel() {
    let mesh = cubes::block([3, 2, 2], 1.0).unwrap();
    let known = |mesh: &Mesh<3, 4>, group| {
        let body = Body::at_rest(mesh, 1.0, 1.0);
        let system = System {
            passive: vec![Box::new(VolumePreservation::new(mesh, group, 10.0))],
            active: vec![],
            drag: Drag { rate: 0.0, masses: body.masses.clone() },
            support: Support::Free,
        };
        let lattice = mesh.lattice.as_ref().unwrap();
        Stencil::new(&system, &body, lattice, 0.1, 1, Units::best()).is_ok()
    };
    assert!(known(&mesh, cubes::TETRAHEDRA_OF_A_CUBE));
    assert!(!known(&mesh, 5), "each division by itself");
    assert!(!known(&mesh, 1), "each tetrahedron by itself");
    let mut uneven = mesh.clone();
    uneven.simplices[0].weight = 0.4;
    assert!(!known(&uneven, cubes::TETRAHEDRA_OF_A_CUBE), "one division more than the other");
    let mut mixed = mesh.clone();
    mixed.simplices.swap(0, 10);
    assert!(!known(&mixed, cubes::TETRAHEDRA_OF_A_CUBE), "tetrahedra of two cubes");
}

#[test]
fn two_hundred_steps_of_the_peers_lattice_give_the_peers_sums() {
    // Spacing 1, k = 1 for every spring, dashpots 0.1, masses 1, dt 0.05: sums of squared displacements
    // and of squared half-step velocities by NumPy, Numba and C++ programs that are not ours.
    let mesh = lattice::rectangle(99, 19, 1.0).unwrap();
    let nodes: Vec<[u32; 2]> = mesh.springs.iter().map(|spring| spring.nodes).collect();
    let rest_length = nodes
        .iter()
        .map(|pair| {
            let [a, b] = pair.map(|node| mesh.point(node as usize));
            (b[0] - a[0]).hypot(b[1] - a[1])
        })
        .collect();
    let count = nodes.len();
    let springs = Springs::new(nodes, vec![1.0; count], rest_length, vec![0.1; count]);
    let masses = vec![1.0; mesh.len()];
    let mut body = Body {
        positions: mesh.points.clone(),
        velocities: zeros(mesh.len()),
        masses: masses.clone(),
    };
    for node in 0..mesh.len() {
        let [i, j] = mesh.point(node);
        body.positions[0][node] += 0.05 * (0.37 * i + 0.61 * j).sin();
        body.positions[1][node] += 0.05 * (0.53 * i - 0.29 * j + 1.0).sin();
    }
    let system = System {
        passive: vec![Box::new(springs)],
        active: vec![],
        drag: Drag { rate: 0.0, masses },
        support: Support::Free,
    };
    for units in available() {
        let mut motion = fused(&mesh, &system, &body, 0.05, 2, units);
        motion.advance(200, [0.0; 2]).unwrap();
        let displacement: f64 = (0..2)
            .flat_map(|axis| motion.body().positions[axis].iter().zip(&mesh.points[axis]))
            .map(|(x, rest)| (x - rest).powi(2))
            .sum();
        // As many digits as the peers print.
        assert!((displacement - 1.222_314_112_97).abs() < 1e-11, "{units:?}: {displacement}");
        let half: f64 = motion.half_velocities().iter().flatten().map(|v| v * v).sum();
        assert!((half - 0.657_978_435).abs() < 1e-9, "{units:?}: {half}");
    }
}

#[test]
fn what_the_kernel_does_not_know_stays_with_the_plain_loops() {
    let mesh = lattice::rectangle(20, 5, 1.0).unwrap();
    let axis = [1.0, 0.0];
    let fibres = vec![axis; mesh.simplices.len()];
    let used = |loops, form, uniform_tension, material: &Material, active, support| {
        let (body, system) = assemble(&mesh, material, active, &fibres, support, axis, 20.0);
        let lattice = mesh.lattice.as_ref();
        let (system, body) = (&system, &body);
        let task = Task { system, body, lattice, form, time_step: 1e-3, uniform_tension };
        Engine { loops, ..Engine::default() }.stepper(&task).map(|(_, used)| used)
    };
    let form = Integrator::StoermerVerlet;
    let fused = |material: &Material, active, support| {
        let auto = used(Loops::Auto, form, true, material, active, support).unwrap();
        let wanted = used(Loops::Fused, form, true, material, active, support);
        match (&auto, wanted) {
            (EngineUsed::Fused { .. }, Ok(fused)) => assert_eq!(fused, auto),
            // What auto says and what a refusal says are one.
            (
                EngineUsed::Plain { instead_of_fused: Some(why) },
                Err(EngineError::Unsupported { what }),
            ) => assert_eq!(&what, why),
            (auto, wanted) => panic!("{auto:?} but {wanted:?}"),
        }
        matches!(auto, EngineUsed::Fused { .. })
    };
    let usual = default_material();
    let barycentric = Material { area_law: AreaLaw::Barycentric, ..default_material() };
    assert!(fused(&usual, ActiveLaw::Fibre, SupportKind::MassCentre));
    assert!(fused(&usual, ActiveLaw::Fibre, SupportKind::ClampedEnd));
    assert!(!fused(&usual, ActiveLaw::Ends, SupportKind::MassCentre));
    assert!(!fused(&barycentric, ActiveLaw::Fibre, SupportKind::MassCentre));

    // The kernel is one method: another is not made by it, nor is a tension for each triangle.
    for (form, uniform, word) in
        [(Integrator::VelocityVerlet, true, "velocity Verlet"), (form, false, "not uniform")]
    {
        let (active, support) = (ActiveLaw::Fibre, SupportKind::MassCentre);
        let auto = used(Loops::Auto, form, uniform, &usual, active, support).unwrap();
        let EngineUsed::Plain { instead_of_fused: Some(why) } = auto else { panic!("{auto:?}") };
        assert!(why.contains(word), "{why}");
        let refused = used(Loops::Fused, form, uniform, &usual, active, support).unwrap_err();
        assert!(refused.to_string().contains(word), "{refused}");
    }
}

#[test]
fn springs_off_the_lattice_or_of_another_length_have_no_place_in_the_kernel() {
    let mesh = lattice::rectangle(3, 3, 1.0).unwrap();
    let place = |nodes, rest_length| {
        let masses = vec![1.0; mesh.len()];
        let body = Body {
            positions: mesh.points.clone(),
            velocities: zeros(mesh.len()),
            masses: masses.clone(),
        };
        let springs = Springs::new(vec![nodes], vec![1.0], vec![rest_length], vec![0.0]);
        let system = System {
            passive: vec![Box::new(springs)],
            active: vec![],
            drag: Drag { rate: 0.0, masses },
            support: Support::Free,
        };
        let lattice = mesh.lattice.as_ref().unwrap();
        Stencil::new(&system, &body, lattice, 0.1, 1, Units::best()).is_ok()
    };
    // Nodes 0 to 3 stand in the first row, 4 to 7 in the second.
    assert!(place([0, 1], 1.0) && place([5, 0], 2.0_f64.sqrt()) && place([4, 1], 2.0_f64.sqrt()));
    assert!(!place([0, 1], 1.01), "a spring that is not at rest on the lattice");
    assert!(!place([0, 2], 2.0), "a spring to the neighbour after next");
    assert!(!place([3, 4], 10.0_f64.sqrt()), "the ends of two rows, next to each other in number");

    // Four points along x, three along y, two along z.
    let block = cubes::block([3, 2, 1], 1.0).unwrap();
    let place = |nodes: [u32; 2]| {
        let [a, b] = nodes.map(|node| block.point(node as usize));
        let length = a.iter().zip(b).map(|(a, b)| b - a).fold(0.0, f64::hypot);
        let body = Body::at_rest(&block, 1.0, 1.0);
        let system = System {
            passive: vec![Box::new(Springs::new(vec![nodes], vec![1.0], vec![length], vec![0.0]))],
            active: vec![],
            drag: Drag { rate: 0.0, masses: body.masses.clone() },
            support: Support::Free,
        };
        let lattice = block.lattice.as_ref().unwrap();
        Stencil::new(&system, &body, lattice, 0.1, 1, Units::best()).is_ok()
    };
    assert!(place([0, 12]) && place([13, 0]) && place([1, 12]) && place([4, 12]) && place([16, 0]));
    assert!(!place([0, 17]), "across a cube");
    assert!(!place([3, 4]) && !place([11, 12]), "the ends of two rows, and of two layers");
}

/// A force that has its place in the kernel, but panics in the plain first step.
struct Mistaken;

impl Force for Mistaken {
    fn name(&self) -> &'static str {
        "a mistake"
    }

    fn add_forces(&self, _: &Configuration<'_>, _: &mut Vectors) {
        panic!("a force panics for the sake of a test");
    }

    fn energy(&self, _: &Configuration<'_>) -> Option<f64> {
        None
    }

    fn on_lattice(&self) -> Option<LatticeLaw<'_>> {
        Some(LatticeLaw::Anchors(&[]))
    }

    fn is_internal(&self) -> bool {
        true
    }
}

#[test]
fn a_motion_that_a_panic_has_interrupted_says_so_and_its_threads_end() {
    let mesh = lattice::rectangle(60, 40, 1.0).unwrap();
    let (body, mut system) = varied(&mesh, Support::Free, 3);
    system.passive.push(Box::new(Mistaken));
    let plain = Motion::new(&system, body.clone(), Integrator::StoermerVerlet, 1e-4);
    let fused = fused(&mesh, &system, &body, 1e-4, 3, Units::best());
    let both: [Box<dyn Stepper>; 2] = [Box::new(plain), Box::new(fused)];
    for mut motion in both {
        let panicked = catch_unwind(AssertUnwindSafe(|| motion.advance(5, [0.0.into(); 2])));
        assert!(panicked.is_err());
        assert_eq!(motion.advance(5, [0.0.into(); 2]), Err(StepError::Poisoned));
    }
}

#[test]
fn a_motion_that_goes_back_makes_the_same_steps_again_to_the_bit() {
    let mesh = lattice::rectangle(60, 40, 1.0).unwrap();
    let (body, system) = varied(&mesh, Support::Free, 9);
    for begun in [0, 7] {
        let steppers: [Box<dyn Stepper>; 4] = [
            Box::new(Motion::new(&system, body.clone(), Integrator::StoermerVerlet, 1e-4)),
            Box::new(Motion::new(&system, body.clone(), Integrator::VelocityVerlet, 1e-4)),
            Box::new(fused(&mesh, &system, &body, 1e-4, 1, Units::best())),
            Box::new(fused(&mesh, &system, &body, 1e-4, 3, Units::best())),
        ];
        for mut motion in steppers {
            let go = |motion: &mut dyn Stepper, steps, tensions: [f64; 2]| {
                motion.advance(steps, tensions.map(Into::into)).unwrap();
                (motion.body().clone(), motion.steps())
            };
            go(&mut *motion, begun, [0.0, 10.0]);
            motion.mark();
            let first = go(&mut *motion, 11, [10.0, 40.0]);
            motion.back();
            go(&mut *motion, 5, [10.0, 90.0]);
            motion.back();
            assert_eq!(go(&mut *motion, 11, [10.0, 40.0]), first);
        }
    }
}

/// A motion goes back after it blew up, and on as if it had not.
fn recovers<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    (body, system): &(Body<D>, System<D>),
) {
    let mut motion = fused(mesh, system, body, 1e-4, 2, Units::best());
    motion.advance(7, [0.0, 10.0]).unwrap();
    motion.mark();
    motion.advance(11, [10.0, 40.0]).unwrap();
    let expected = motion.body().clone();
    motion.back();
    motion.advance(60, [f64::NAN; 2]).unwrap();
    assert!(motion.body().positions[0].iter().any(|x| x.is_nan()));
    motion.back();
    motion.advance(11, [10.0, 40.0]).unwrap();
    assert!(*motion.body() == expected);
}

#[test]
fn a_motion_goes_back_from_numbers_that_are_none_and_on_as_before() {
    let outline = built_in::adult_ventricular().rotated(20.0);
    let cell = lattice::from_outline(&outline, Some(2.5)).unwrap().0;
    recovers(&cell, &varied(&cell, Support::Free, 4));
    let cell = ellipsoid([30, 9, 7], 1.5);
    recovers(&cell, &varied_in_space(&cell, Support::Free, 4));
}

#[test]
fn small_meshes_are_worth_one_thread_and_none_more_than_there_are_cores() {
    let cores = std::thread::available_parallelism().unwrap().get();
    assert_eq!(worthwhile_threads(0), 1);
    assert_eq!(worthwhile_threads(7300), 1, "the built-in cell");
    assert_eq!(worthwhile_threads(80_000), 2.min(cores));
    assert_eq!(worthwhile_threads(usize::MAX), cores);
}
