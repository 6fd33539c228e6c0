//! A cell on a gel: balance of forces and energy, limits, convergence, both methods, cell models that feel length.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use super::quasi_static::{cell, largest_difference, tear_drop};
use crate::common::Sample;
use myospring::cell::land_2017::Land2017;
use myospring::cell::{CellModel, pacing::Protocol};
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::interruption::Interruption;
use myospring::mechanics::gel::{Adhesion, Gel};
use myospring::mechanics::material::{default_material, myofilament_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::{built_in, lattice};
use myospring::prelude::*;
use myospring::recording::{
    AXIAL_FORCE, CONTRACTILE_MOMENT, END_FORCE, GEL_ENERGY, Recording, TRACTION_FORCE,
};
use myospring::simulation::{SettingError, SetupError, StretchFelt};
use std::sync::Arc;

/// The built-in cell on this gel, along equilibria.
fn on(gel: Gel, spacing: f64) -> Simulation {
    let outline = built_in::adult_ventricular();
    let (mesh, _) = lattice::from_outline(&outline, Some(spacing)).unwrap();
    let mut simulation =
        Simulation { support: SupportKind::Gel(gel), duration: 200.0, ..Simulation::new(mesh) };
    simulation.numerics.method = Method::QuasiStatic;
    simulation
}

fn run(simulation: &Simulation) -> Recording {
    let outcome = simulation.build().unwrap().run(|_| true);
    assert!(outcome.stop.is_none(), "{:?}", outcome.stop);
    outcome.recording
}

fn most(recording: &Recording, name: &str) -> f64 {
    let signal = recording.signals.iter().find(|signal| signal.name == name).unwrap();
    signal.values.iter().copied().fold(0.0, f64::max)
}

fn shortening(recording: &Recording) -> f64 {
    recording.samples.iter().map(|sample| sample.shortening_pct).fold(0.0, f64::max)
}

#[test]
fn nothing_shifts_or_turns_the_gel_and_the_work_of_tension_is_the_energy_of_cell_and_gel() {
    for gel in [
        Gel::half_space(5.0),
        Gel { thickness: Some(20.0), poisson: 0.3, ..Gel::half_space(20.0) },
        Gel { adhesion: Adhesion::Ends, ..Gel::half_space(20.0) },
        Gel { adhesion: Adhesion::Rim, adhesion_stiffness: Some(1.0), ..Gel::half_space(20.0) },
    ] {
        let simulation = Simulation { mesh: tear_drop(4.0), ..on(gel, 3.0) };
        let simulation = Simulation {
            long_axis: [1.0, 0.0],
            fibres: vec![[0.8, 0.6]; simulation.mesh.simplices.len()],
            ..simulation
        };
        let recording = run(&simulation);
        let peak = recording.frames.iter().max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa)).unwrap();
        let (body, system) = simulation.mechanics();
        let bed = system.compliance().unwrap();
        let forces = bed.forces(&bed.displacements(&peak.positions));
        let size: f64 = forces.iter().flatten().map(|force| force.abs()).sum();
        let net = forces.each_ref().map(|axis| axis.iter().sum::<f64>());
        let turn = |place: usize| {
            let [x, y] = [0, 1].map(|axis: usize| peak.positions[axis][bed.nodes()[place]]);
            x * forces[1][place] - y * forces[0][place]
        };
        let torque: f64 = (0..bed.nodes().len()).map(turn).sum();
        // What Newton's method and interpolation leave.
        assert!(net.iter().all(|net| net.abs() < 1e-5 * size), "{gel:?}: {net:?} of {size}");
        assert!(torque.abs() < 1e-5 * size * body.positions[0].len() as f64, "{gel:?}: {torque}");
        let last = recording.samples.iter().max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa)).unwrap();
        // The work is a sum over eight parts of a load step.
        let balance = last.active_work_fj / last.elastic_energy_fj - 1.0;
        assert!(balance.abs() < 1e-3, "{gel:?}: {balance}");
        assert!(most(&recording, GEL_ENERGY) < last.elastic_energy_fj);
    }
}

#[test]
fn a_soft_gel_lets_the_cell_shorten_freely_and_a_stiff_one_holds_it() {
    let free = shortening(&run(&Simulation {
        support: SupportKind::MassCentre,
        ..on(Gel::half_space(1.0), 2.4)
    }));
    let soft =
        [1e-2, 1e-1].map(|modulus| free - shortening(&run(&on(Gel::half_space(modulus), 2.4))));
    // What a soft gel takes away is in proportion to its modulus.
    assert!((soft[1] / soft[0] - 10.0).abs() < 0.3, "{soft:?} of {free}");
    // A cell held everywhere pulls on the gel at its rim with tension times section; half of it along the axis is the force
    // at an end of a clamped cell.
    let held = run(&on(Gel::half_space(1e6), 2.4));
    assert!(shortening(&held) < 0.01);
    let clamped = Simulation { support: SupportKind::ClampedEnds, ..on(Gel::half_space(1.0), 2.4) };
    let (held, clamped) = (most(&held, AXIAL_FORCE), most(&run(&clamped), END_FORCE));
    // At clamped ends tension acts on the section of the clamps, here on the whole width.
    assert!(held > clamped && held < 5.0 * clamped, "{held} {clamped}");
    let outline = built_in::adult_ventricular();
    let width = outline.area() / 110.0;
    assert!((held / (50.0 * 10.0 * width) - 1.0).abs() < 0.35, "{held}, width {width}");
}

#[test]
fn forces_converge_with_the_spacing() {
    for modulus in [2.0, 50.0] {
        let forces = [4.0, 2.0, 1.0].map(|spacing| {
            let recording = run(&on(Gel::half_space(modulus), spacing));
            [TRACTION_FORCE, CONTRACTILE_MOMENT].map(|name| most(&recording, name))
        });
        let [coarse, middle, fine] = forces;
        for of in 0..2 {
            let error = |found: [f64; 2]| (found[of] / fine[of] - 1.0).abs();
            assert!(error(coarse) < 0.05 && error(middle) < 0.025, "{modulus}: {forces:?}");
        }
    }
}

#[test]
fn a_thin_gel_is_an_elastic_bed_but_for_its_rim() {
    // Displacements decay over sqrt(E w h/G), here 35 um, far more than the thickness of the gel.
    let gel = Gel { thickness: Some(2.0), ..Gel::half_space(15.0) };
    let bed = SupportKind::ElasticBed { stiffness: gel.shear_modulus() / 2.0 };
    let mut sample = Sample::one_in(2);
    // Beside the cell and beyond its ends a strip of gel as wide as a part of its thickness is drawn along.
    for width in [12, 48, 24] {
        if sample.leaves_out() {
            continue;
        }
        let mesh = lattice::rectangle(120, width, 1.0).unwrap();
        let [on_gel, on_bed] = [SupportKind::Gel(gel), bed].map(|support| {
            let (body, system) = cell(&mesh, &default_material(), support);
            let path = Path::solve(&system, &body, 1.0, Tolerance::default()).unwrap();
            path.positions(1.0).unwrap()[0][121 * (width / 2)]
        });
        let stiffer = 1.0 - on_gel / on_bed;
        let most = 2.0 / width as f64 + 2.0 / 35.0;
        assert!((0.0..most).contains(&stiffer), "{width} um wide: {stiffer}");
    }
}

#[test]
fn the_cell_comes_to_rest_on_its_path_in_time_too() {
    if crate::common::left_to_full() {
        return;
    }
    let mesh = tear_drop(4.0);
    let support = SupportKind::Gel(Gel::half_space(20.0));
    let (body, system) = cell(&mesh, &default_material(), support);
    let tension = 30.0;
    let path = Path::solve(&system, &body, tension, Tolerance::default()).unwrap();
    let step = 0.8 * StabilityLimit::of(&system, &body, tension).time_step;
    let mut motion = Motion::new(&system, body.clone(), Integrator::StoermerVerlet, step);
    motion.advance((5.0 / step) as usize, [0.0, tension]).unwrap();
    motion.advance((40.0 / step) as usize, [tension; 2]).unwrap();
    let apart = largest_difference(&path.positions(tension).unwrap(), &motion.body.positions);
    assert!(apart < 1e-4, "{apart} um");
    let moved = largest_difference(&body.positions, &motion.body.positions);
    assert!(moved > 0.5, "{moved} um");
}

#[test]
fn myofilaments_that_feel_length_pull_stronger_on_a_stiffer_gel() {
    if crate::common::left_to_full() {
        return;
    }
    let model = Land2017::published();
    let beat = |modulus| {
        let mut simulation = Simulation {
            protocol: Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) },
            cell: Arc::new(model.clone()),
            material: myofilament_material(),
            duration: 160.0,
            ..on(Gel::half_space(modulus), 7.0)
        };
        simulation.numerics.exchange_interval = 1.0;
        simulation.numerics.output_interval = 1.0;
        simulation
    };
    let strength = |simulation: &Simulation| {
        let recording = run(simulation);
        let tension = recording.samples.iter().map(|sample| sample.ta_kpa).fold(0.0, f64::max);
        [most(&recording, AXIAL_FORCE), tension]
    };
    let [soft, stiff] = [1.0, 10.0].map(|modulus| strength(&beat(modulus)));
    // A cell that shortens less pulls more strongly, at the same calcium.
    assert!(stiff[0] > soft[0] && stiff[1] > soft[1], "{soft:?} {stiff:?}");
    // Each place feels its own length, which differs along the cell.
    let mut each = Simulation { stretch_felt: StretchFelt::Triangle, ..beat(10.0) };
    each.numerics.exchange_interval = 5.0;
    each.numerics.output_interval = 5.0;
    let by_triangle = strength(&each);
    assert!((stiff[0] / by_triangle[0] - 1.0).abs() < 0.2, "{stiff:?} {by_triangle:?}");
}

#[test]
fn a_gel_that_does_not_fit_is_refused_before_the_run() {
    let refused = |simulation: &Simulation| match simulation.build() {
        Err(SetupError::Setting(error)) => error,
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("it was built"),
    };
    let thin = refused(&on(Gel { thickness: Some(1.0), ..Gel::half_space(5.0) }, 2.0));
    assert!(matches!(thin, SettingError::Gel(_)));
    assert!(
        thin.to_string().contains("thickness is 1 um") && thin.to_string().contains("2 um"),
        "{thin}"
    );
    let solid = refused(&on(Gel { poisson: 0.5, ..Gel::half_space(5.0) }, 2.0));
    assert!(solid.to_string().contains("Poisson"), "{solid}");
    let nothing = refused(&on(Gel::half_space(0.0), 2.0));
    assert!(nothing.to_string().contains("modulus of the gel"), "{nothing}");
    let mut anywhere = on(Gel::half_space(5.0), 2.0);
    anywhere.mesh.lattice = None;
    assert!(refused(&anywhere).to_string().contains("lattice"));
}

#[test]
fn a_search_on_a_gel_ends_when_it_is_interrupted() {
    let interruption = Interruption::when(|| true);
    let simulation = Simulation { interruption, ..on(Gel::half_space(5.0), 2.4) };
    assert!(matches!(simulation.build(), Err(SetupError::Interrupted)));
}

#[test]
fn an_adhesion_that_holds_no_cell_is_refused_with_its_value_and_its_bound() {
    let gel = Gel::half_space(10.0);
    let error = |support: SupportKind, adhesion: Vec<f64>| {
        let adhesion = Some(adhesion);
        let simulation = Simulation { support, adhesion, ..on(gel, 4.0) };
        simulation.build().err().map(|error| error.to_string()).unwrap_or_default()
    };
    let nodes = on(gel, 4.0).mesh.len();
    let with = |node: usize, value: f64, others: f64| {
        let mut list = vec![others; nodes];
        list[node] = value;
        list
    };
    for (support, adhesion, message) in [
        (SupportKind::MassCentre, vec![1.0; nodes], "only a cell on a gel adheres"),
        (SupportKind::Gel(gel), vec![1.0; 3], "the adhesion has 3 entries, but the mesh has"),
        (SupportKind::Gel(gel), with(3, -0.5, 1.0), "the adhesion of node 3 is -0.5; it must be"),
        (SupportKind::Gel(gel), with(3, f64::NAN, 1.0), "the adhesion of node 3 is NaN"),
        (SupportKind::Gel(gel), with(3, 1.0, 0.0), "that adhere to the gel is 1; it must be 2"),
    ] {
        let said = error(support, adhesion);
        assert!(said.contains(message), "{message}: {said}");
    }
    assert_eq!(error(SupportKind::Gel(gel), with(3, 0.0, 1.0)), "");
}
