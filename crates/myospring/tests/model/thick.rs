//! A thick cell: cubes above its outline, by the same runs as a flat one.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::analysis::value;
use myospring::integrate::Method;
use myospring::integrate::engine::{EngineUsed, Loops};
use myospring::integrate::quasi_static::Tolerance;
use myospring::integrate::verlet::Integrator;
use myospring::mechanics::gel::Gel;
use myospring::mechanics::material::{Material, Stiffness, default_material, of_thick_cell};
use myospring::mechanics::support::SupportKind;
use myospring::mesh::built_in;
use myospring::mesh::outline::Outline;
use myospring::mesh::profile::Profile;
use myospring::mesh::surface;
use myospring::mesh::thick::{self, Form};
use myospring::recording::{LENGTH_BOTTOM, LENGTH_TOP, THICKNESS, VOLUME};
use myospring::simulation::{Outcome, Simulation, projected_area};
use std::sync::Arc;

fn cell(outline: &Outline, form: Form, spacing: f64) -> Simulation {
    let (mesh, thick, _) = thick::from_outline(outline, form, Some(spacing)).unwrap();
    let mut simulation = Simulation::new(mesh);
    simulation.thick = Some(Arc::new(thick));
    simulation.material = of_thick_cell(&default_material());
    simulation.numerics.method = Method::QuasiStatic;
    simulation
}

fn rectangle(length: f64, width: f64) -> Outline {
    let geojson = format!(
        r#"{{"type":"Polygon","coordinates":[[[0,0],[{length},0],[{length},{width}],[0,{width}],[0,0]]]}}"#
    );
    Outline::from_geojson(&geojson).unwrap()
}

/// A block of 48 x 12 x 8 um in cubes of 2 um.
fn block() -> Simulation {
    cell(&rectangle(48.0, 12.0), Form { profile: Profile::Slab, thickness: 8.0 }, 2.0)
}

fn beaten(simulation: &Simulation) -> Outcome {
    let outcome = simulation.build().unwrap().run(|_| true);
    assert_eq!(outcome.stop, None);
    outcome
}

fn signal<'a>(outcome: &'a Outcome, name: &str) -> &'a [f64] {
    &outcome.recording.signals.iter().find(|signal| signal.name == name).unwrap().values
}

fn peak(simulation: &Simulation) -> f64 {
    let samples = beaten(simulation).recording.samples;
    samples.iter().map(|sample| sample.shortening_pct).fold(0.0, f64::max)
}

#[test]
#[ignore = "slow"]
fn a_cell_of_any_profile_shortens_and_widens_as_its_material_says() {
    // From the energy of a homogeneous cell alone (a separate program): 12.00, 9.96 and 7.75 % at 50, 40 and 30 kPa, widening
    // 6.43 %, area -6.34 %, volume -0.32 %.
    let outline = built_in::adult_ventricular();
    for profile in Profile::ALL {
        let mut simulation = cell(&outline, Form { profile, thickness: 10.0 }, 3.3);
        for (tension, shortening) in [(50.0, 12.0), (40.0, 9.96), (30.0, 7.75)] {
            simulation.peak_tension = tension;
            let found = peak(&simulation);
            // Half of the last digit of those numbers.
            assert!((found - shortening).abs() < 0.006, "{profile:?}, {tension} kPa: {found} %");
        }
        simulation.peak_tension = 50.0;
        let outcome = beaten(&simulation);
        let beat = &outcome.beats()[0];
        let of = |name: &str| beat.value(name).unwrap();
        assert!((of("peak_thickening") - 6.43).abs() < 0.006, "{}", of("peak_thickening"));
        assert!((of("volume_change") + 0.32).abs() < 0.006, "{}", of("volume_change"));
        // Interpolation between load steps: 1e-6 of the length.
        assert!((of("top_shortening") - of("bottom_shortening")).abs() < 1e-4);
        let [first, last] = [0, outcome.recording.frames.len() - 1]
            .map(|at| outcome.recording.in_space[at].positions.clone());
        assert_eq!(first, simulation.thick.as_ref().unwrap().mesh.points);
        assert_eq!(last[0].len(), first[0].len());
        let area = value(&beat.shape, "area_change");
        assert!(area.is_none_or(|area| (area + 6.34).abs() < 0.02), "{area:?}");
    }
}

#[test]
fn a_thick_cell_moves_in_time_as_along_its_equilibria() {
    let mut simulation = block();
    // The slowest vibration is a hundredth of the twitch, and volume is kept less strictly: larger steps.
    simulation.material.poisson_ratio = 0.4;
    simulation.material.slowest_period = Some(2.0);
    simulation.duration = 250.0;
    let still = beaten(&simulation);
    simulation.numerics.method = Method::Verlet(Integrator::StoermerVerlet);
    let moving = beaten(&simulation);
    let pairs = still.recording.samples.iter().zip(&moving.recording.samples);
    let lag = pairs.map(|(a, b)| (a.shortening_pct - b.shortening_pct).abs()).fold(0.0, f64::max);
    // The lag of the drag at the steepest rise, 2 lengths a second: some 0.1 ms.
    assert!(lag < 0.05, "{lag} % of the length");
    for sample in &moving.recording.samples {
        assert!(sample.momentum_nn_ms < 1e-9 && sample.angular_momentum_nn_um_ms < 1e-7);
    }
    let last = moving.recording.samples.last().unwrap();
    let missing = last.active_work_fj
        - (last.elastic_energy_fj + last.kinetic_energy_fj + last.dissipated_energy_fj);
    assert!(missing.abs() < 0.01 * last.active_work_fj, "{missing} of {} fJ", last.active_work_fj);
    assert!(matches!(moving.engine, Some(EngineUsed::Fused { .. })), "{:?}", moving.engine);
    // What the kernel does not make is refused, or left to the plain loops, which say what it was.
    simulation.material.fibre_modulus = 5.0;
    simulation.numerics.engine.loops = Loops::Fused;
    let refused = simulation.build().err().unwrap().to_string();
    assert!(refused.contains("stiffness of the fibres"), "{refused}");
}

#[test]
fn a_bed_under_a_thick_cell_holds_its_lower_face_more_than_its_upper_one() {
    if crate::common::left_to_full() {
        return;
    }
    // 100 x 20 x 10 um, 50 kPa: shortening of the lower and the upper face by a separate program.
    let mut simulation =
        cell(&rectangle(100.0, 20.0), Form { profile: Profile::Slab, thickness: 10.0 }, 2.0);
    for (bed, bottom, top) in [(0.1, 11.37, 12.25), (1.0, 9.16, 11.76), (10.0, 3.96, 7.81)] {
        simulation.support = SupportKind::ElasticBed { stiffness: bed };
        let outcome = beaten(&simulation);
        // That program took the distance between the ends of a face, in its middle.
        let thick = simulation.thick.as_ref().unwrap();
        let shortest =
            outcome.recording.in_space.iter().max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa));
        let ends = |at: usize| {
            let row: Vec<usize> = (0..thick.mesh.len())
                .filter(|&node| {
                    thick.mesh.points[1][node] == 10.0 && thick.mesh.points[2][node] == at as f64
                })
                .collect();
            let x = &shortest.unwrap().positions[0];
            100.0 - (x[*row.last().unwrap()] - x[row[0]])
        };
        let found = [ends(0), ends(10)];
        let beats = outcome.beats();
        let of = |name: &str| beats[0].value(name).unwrap();
        assert!(of("bottom_shortening") < of("top_shortening"));
        // Both programs have some ten cubes across: a percent of the shortening.
        let close = |found: f64, wanted: f64| (found - wanted).abs() < 0.06;
        assert!(close(found[0], bottom) && close(found[1], top), "{bed}: {found:?}");
    }
}

#[test]
fn fibres_that_turn_through_the_thickness_shorten_the_cell_less_and_keep_its_volume() {
    let mut simulation = block();
    let straight = peak(&simulation);
    let thick = simulation.thick.as_ref().unwrap();
    simulation.fibres_in_space = Some(thick.turned(&simulation.fibres, 50_f64.to_radians()));
    let outcome = beaten(&simulation);
    let turned = outcome.beats()[0].value("peak_shortening").unwrap();
    assert!(turned < straight - 0.5 && turned > 0.5 * straight, "{turned}, {straight}");
    let change = outcome.beats()[0].value("volume_change").unwrap();
    assert!(change.abs() < 1.0, "{change} %");
    for name in [THICKNESS, VOLUME, LENGTH_TOP, LENGTH_BOTTOM] {
        assert_eq!(signal(&outcome, name).len(), outcome.recording.samples.len());
    }
}

#[test]
fn stiffness_along_the_fibre_adds_to_that_along_it_and_not_across() {
    if crate::common::left_to_full() {
        return;
    }
    // Small tension along stiff fibres: strain Ta/(E + k_f).
    let mut simulation = block();
    let Material { stiffness: Stiffness::YoungModulus(modulus), .. } = simulation.material else {
        panic!("the default material has a modulus")
    };
    simulation.peak_tension = 0.01 * modulus;
    let soft = peak(&simulation);
    simulation.material.fibre_modulus = modulus;
    let stiff = peak(&simulation);
    assert!((soft / stiff - 2.0).abs() < 0.02, "{soft} %, {stiff} %");
    // Across the fibres nothing has changed.
    let axis = simulation.long_axis;
    simulation.fibres.fill([-axis[1], axis[0]]);
    let response = |simulation: &Simulation| {
        simulation.response_to(0.01, Tolerance::default()).map(|it| it.shortening(1.0)[0])
    };
    assert!(response(&simulation).is_err() || response(&simulation).unwrap() < 0.0);
}

#[test]
fn supports_that_hold_ends_and_contents_by_place_serve_a_thick_cell() {
    let mut simulation = block();
    let free = peak(&simulation);
    simulation.support = SupportKind::SpringHeldEnds { stiffness: 200.0 };
    let outcome = beaten(&simulation);
    let force = outcome.beats()[0].value("peak_end_force").unwrap();
    let held = outcome.beats()[0].value("peak_shortening").unwrap();
    // Each end moves by half of the shortening; the springs hold the outer two layers of points, whose middle is 4/3 um from the end.
    let expected = 200.0 * (24.0 - 4.0 / 3.0) * held / 100.0;
    assert!(held < free && (force / expected - 1.0).abs() < 0.01, "{force} nN, {expected} nN");
    simulation.support = SupportKind::ClampedEnds;
    let isometric = beaten(&simulation).beats()[0].value("peak_end_force").unwrap();
    // 50 kPa on 96 um^2.
    assert!((isometric / 4800.0 - 1.0).abs() < 0.02, "{isometric} nN");
    simulation.support = SupportKind::AfterloadedEnds { load: 0.5 * isometric };
    let loaded = beaten(&simulation).beats()[0].value("peak_shortening").unwrap();
    assert!(loaded > 0.0 && loaded < free, "{loaded} %");
    simulation.support = SupportKind::MassCentre;
    simulation.myofibril_content = Some(vec![1.0; simulation.mesh.simplices.len()]);
    assert!((peak(&simulation) - free).abs() < 1e-9);
    simulation.myofibril_content = Some(vec![0.5; simulation.mesh.simplices.len()]);
    let half = peak(&simulation);
    simulation.myofibril_content = None;
    simulation.peak_tension = 25.0;
    assert!((peak(&simulation) - half).abs() < 1e-3, "{half}");
}

#[test]
fn ends_that_are_held_or_loaded_serve_a_thick_cell_of_any_form() {
    let of = |profile: Profile, support: SupportKind, end_stretch: f64| {
        let form = Form { profile, thickness: 8.0 };
        let mut simulation = cell(&built_in::adult_ventricular(), form, 4.0);
        (simulation.support, simulation.end_stretch) = (support, end_stretch);
        let force = |name: &str| beaten(&simulation).beats()[0].value(name);
        force(if support == SupportKind::ClampedEnds {
            "peak_end_force"
        } else {
            "peak_shortening"
        })
        .unwrap()
    };
    let clamped = SupportKind::ClampedEnds;
    for profile in [Profile::Dome, Profile::Slab, Profile::Round] {
        let [unstretched, stretched] = [1.0, 1.08].map(|stretch| of(profile, clamped, stretch));
        assert!(unstretched > 0.0 && stretched > 0.0, "{unstretched} nN, {stretched} nN");
        // A load of half of what it can pull still lets it shorten.
        let load = 0.5 * unstretched;
        let [light, heavy] =
            [0.2 * load, load].map(|load| of(profile, SupportKind::AfterloadedEnds { load }, 1.0));
        assert!(light > heavy && heavy > 0.0, "{light} %, {heavy} %");
    }
}

#[test]
fn the_area_of_a_cell_that_deforms_evenly_is_that_of_its_columns() {
    let form = Form { profile: Profile::Round, thickness: 8.0 };
    let simulation = cell(&built_in::adult_ventricular(), form, 3.0);
    let outcome = beaten(&simulation);
    let samples = &outcome.recording.samples;
    for frame in &outcome.recording.frames {
        let sample = samples.iter().find(|sample| sample.t_ms == frame.t_ms).unwrap();
        let columns = projected_area(&simulation.mesh, &frame.positions);
        // Interpolation between load steps: 1e-6 of the length.
        assert!((sample.area_um2 / columns - 1.0).abs() < 1e-5, "{} ms: {columns}", frame.t_ms);
    }
}

#[test]
fn a_cell_that_twists_has_the_area_of_its_shadow_and_keeps_its_volume() {
    let mut simulation = block();
    let thick = simulation.thick.clone().unwrap();
    simulation.fibres_in_space = Some(thick.turned(&simulation.fibres, 60_f64.to_radians()));
    let outcome = beaten(&simulation);
    // Against a picture of the cell: the centres of pixels of 0.05 um that lie in any of the projected faces.
    let frame =
        outcome.recording.in_space.iter().max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa)).unwrap();
    let [x, y, _] = &frame.positions;
    let (low, pixel) = ([-40.0, -20.0], 0.05);
    let [columns, rows] = [1600, 800];
    let mut covered = vec![false; columns * rows];
    for face in surface::quads(&thick.mesh) {
        let [a, b, c, d] = face.map(|node| [x[node as usize], y[node as usize]]);
        for corners in [[a, b, c], [a, c, d]] {
            let turn = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
                (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
            };
            let bounds = [0, 1].map(|axis: usize| {
                let places = corners.map(|corner| (corner[axis] - low[axis]) / pixel);
                [
                    places.iter().fold(f64::INFINITY, |a, b| a.min(*b)) as usize,
                    places.iter().fold(0.0_f64, |a, b| a.max(*b)) as usize,
                ]
            });
            for row in bounds[1][0]..=bounds[1][1] {
                for column in bounds[0][0]..=bounds[0][1] {
                    let at = [
                        low[0] + (column as f64 + 0.5) * pixel,
                        low[1] + (row as f64 + 0.5) * pixel,
                    ];
                    let turns =
                        [0, 1, 2].map(|k: usize| turn(corners[k], corners[(k + 1) % 3], at));
                    let inside = turns.iter().all(|turn| *turn >= 0.0)
                        || turns.iter().all(|turn| *turn <= 0.0);
                    covered[row * columns + column] |= inside;
                }
            }
        }
    }
    let picture = covered.iter().filter(|inside| **inside).count() as f64 * pixel * pixel;
    let samples = &outcome.recording.samples;
    let at = samples.iter().position(|sample| sample.t_ms == frame.t_ms).unwrap();
    assert!(
        (samples[at].area_um2 / picture - 1.0).abs() < 1e-3,
        "{} um^2, {picture} um^2",
        samples[at].area_um2
    );
    let [thickness, volume] = [THICKNESS, VOLUME].map(|name| signal(&outcome, name)[at]);
    assert!((thickness * samples[at].area_um2 / volume - 1.0).abs() < 1e-6);
}

/// Largest force along the axis on a gel of this modulus, nN, and the last forces in space.
fn on_gel(simulation: &Simulation, gel: Gel) -> (f64, Outcome) {
    let simulation = Simulation { support: SupportKind::Gel(gel), ..simulation.clone() };
    let outcome = beaten(&simulation);
    (outcome.beats()[0].value("peak_axial_force").unwrap(), outcome)
}

#[test]
fn a_gel_under_a_thick_cell_feels_no_resultant_and_holds_it_between_free_and_fixed() {
    let mut simulation = block();
    simulation.peak_tension = 5.0;
    simulation.duration = 250.0;
    let free = peak(&simulation);
    let (_, soft) = on_gel(&simulation, Gel::half_space(1e-3));
    assert!((soft.beats()[0].value("peak_shortening").unwrap() / free - 1.0).abs() < 2e-3);
    let forces: Vec<f64> = [1.0, 10.0, 100.0, 1e4]
        .map(|modulus| {
            let (force, outcome) = on_gel(&simulation, Gel::half_space(modulus));
            let frames = &outcome.recording.in_space;
            let strongest = frames.iter().max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa)).unwrap();
            let pulls = strongest.on_gel_nn.as_ref().unwrap();
            for axis in pulls {
                let (sum, size) =
                    axis.iter().fold((0.0, 0.0), |(sum, size), f| (sum + f, size + f64::abs(*f)));
                assert!(sum.abs() < 1e-6 * size, "{modulus} kPa: {sum} of {size} nN");
            }
            // Seen from above the same forces act.
            let flat = outcome.recording.frames.iter().find(|frame| frame.t_ms == strongest.t_ms);
            let flat = flat.unwrap().on_gel_nn.as_ref().unwrap();
            assert!((flat[0].iter().sum::<f64>() - pulls[0].iter().sum::<f64>()).abs() < 1e-9);
            force
        })
        .into();
    assert!(forces.windows(2).all(|pair| pair[1] > pair[0]), "{forces:?}");
    // On a stiff gel the lower face cannot shorten, and half of the cell pulls with what its tension does not spend above.
    let (_, stiff) = on_gel(&simulation, Gel::half_space(1e5));
    let beats = stiff.beats();
    let of = |name: &str| beats[0].value(name).unwrap();
    assert!(of("bottom_shortening") < 0.02 * of("top_shortening"));
}

#[test]
fn a_thin_slab_pulls_on_its_gel_as_a_flat_cell_does() {
    // One layer of cubes on a gel: as stiff in its plane as the sheet, which has Poisson's ratio 1/3 and its own area law.
    let outline = rectangle(60.0, 16.0);
    let (mesh, _) = myospring::mesh::lattice::from_outline(&outline, Some(2.0)).unwrap();
    let mut flat = Simulation::new(mesh);
    flat.numerics.method = Method::QuasiStatic;
    flat.material.thickness = 2.0;
    flat.peak_tension = 20.0;
    flat.duration = 250.0;
    let mut thin = cell(&outline, Form { profile: Profile::Slab, thickness: 2.0 }, 2.0);
    thin.peak_tension = 20.0;
    thin.duration = 250.0;
    for modulus in [3.0, 30.0] {
        let gel = Gel::half_space(modulus);
        let (of_flat, of_thin) = (on_gel(&flat, gel).0, on_gel(&thin, gel).0);
        // Both shorten alike when free; on a gel the thin cell is sheared through its thickness, too.
        assert!((of_thin / of_flat - 1.0).abs() < 0.1, "{modulus} kPa: {of_thin}, {of_flat} nN");
    }
}
