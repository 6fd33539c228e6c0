//! Maps of tension of cells whose map is known: exact displacements, and films of them.

use super::pulled_film::{FRAMES, Pulled, even, late_half, passive_nucleus, together, weak_half};
use super::synthetic_cell::Random;
use super::synthetic_film::FilmScene;
use crate::common::Sample;
use myospring::integrate::quasi_static::{Equilibrium, Tolerance};
use myospring::mechanics::Tension;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::{Mesh, lattice};
use myospring::simulation::Simulation;
use myospring::tension_map::{Blur, ObservedPeak, TensionFilm, TensionMap, TensionMapError};

const FREE: SupportKind = SupportKind::MassCentre;

fn pulled(tension: fn([f64; 2]) -> f64, support: SupportKind, noise: f64) -> Pulled {
    let scene = FilmScene { cell_um: [70.0, 20.0], noise, bits: 8, ..FilmScene::default() };
    Pulled { scene, tension, support, frames: &FRAMES, lag: together }
}

/// What would be seen without noise.
fn exact(pulled: &Pulled, spacing: f64) -> (Simulation, ObservedPeak) {
    let mesh = pulled.mesh(spacing);
    let displacements_um = pulled.displacements(&mesh, 1.0);
    let found = vec![true; mesh.len()];
    let cut = vec![false; mesh.len()];
    let seen = ObservedPeak {
        displacements_um,
        found,
        cut,
        alike_um: 3.0,
        blur: Blur::default(),
        frames: Vec::new(),
    };
    (pulled.simulation(mesh), seen)
}

/// Mean of values of triangles whose centre, relative to the middle of the cell, is so.
fn mean(pulled: &Pulled, simulation: &Simulation, values: &[f64], is: fn([f64; 2]) -> bool) -> f64 {
    let [cx, cy] = pulled.scene.middle();
    let mesh = &simulation.mesh;
    let there = mesh.simplices.iter().zip(values).filter(|(triangle, _)| {
        let [x, y] = mesh.centre(triangle);
        is([x - cx, y - cy])
    });
    let (sum, count) = there.fold((0.0, 0), |(sum, count), (_, value)| (sum + value, count + 1));
    sum / f64::from(count)
}

fn is_right([x, _]: [f64; 2]) -> bool {
    x > 5.0
}

fn is_left([x, _]: [f64; 2]) -> bool {
    x < -5.0
}

fn is_nucleus([x, y]: [f64; 2]) -> bool {
    (x / 9.0).powi(2) + (y / 3.6).powi(2) < 0.7
}

fn is_far([x, y]: [f64; 2]) -> bool {
    (x / 9.0).powi(2) + (y / 3.6).powi(2) > 3.0
}

/// A map that a bilinear one is nearly: 30 kPa and a wave of 10 along the cell.
fn wave([x, _]: [f64; 2]) -> f64 {
    30.0 + 10.0 * (x / 12.0).sin()
}

#[test]
fn a_smooth_map_is_found_to_a_hundredth_where_there_is_no_noise() {
    let mut sample = Sample::one_in(3);
    for support in [FREE, SupportKind::ElasticBed { stiffness: 0.5 }, SupportKind::ClampedEnd] {
        if sample.leaves_out() {
            continue;
        }
        let pulled = pulled(wave, support, 0.0);
        let (simulation, seen) = exact(&pulled, 2.0);
        let map = TensionMap::of(&simulation, &seen).unwrap();
        let truth = pulled.truth(&simulation.mesh);
        let mut off: Vec<f64> = map
            .tensions_kpa
            .iter()
            .zip(&truth)
            .map(|(found, truth)| (found / truth - 1.0).abs())
            .collect();
        off.sort_by(f64::total_cmp);
        // A grid of 3 um gives a wave of 75 um to a quarter of a per cent; at the rim of the cell the map has no
        // neighbours on one side.
        assert!(off[off.len() / 2] < 0.003, "{support:?}: median {}", off[off.len() / 2]);
        assert!(
            off[off.len() * 95 / 100] < 0.02,
            "{support:?}: 95 % {}",
            off[off.len() * 95 / 100]
        );
        assert!(map.is_uneven() && map.misfit_um < 0.02 * map.even_misfit_um, "{}", map.misfit_um);
    }
}

#[test]
fn twice_the_stiffness_is_twice_the_tension_and_the_same_map() {
    if crate::common::left_to_full() {
        return;
    }
    let pulled = pulled(weak_half, FREE, 0.0);
    let (simulation, seen) = exact(&pulled, 2.5);
    let once = TensionMap::of(&simulation, &seen).unwrap();
    let mut stiff = simulation.clone();
    stiff.material.stiffness = myospring::mechanics::material::Stiffness::YoungModulus(
        2.0 * simulation.material.young_modulus(),
    );
    stiff.material.area_modulus *= 2.0;
    let twice = TensionMap::of(&stiff, &seen).unwrap();
    for (once, twice) in once.tensions_kpa.iter().zip(&twice.tensions_kpa) {
        // What the rounds leave.
        assert!((twice / once - 2.0).abs() < 1e-3, "{once} kPa, {twice} kPa");
    }
}

#[test]
fn shift_and_rotation_of_the_whole_cell_are_no_tension() {
    if crate::common::left_to_full() {
        return;
    }
    let pulled = pulled(weak_half, FREE, 0.0);
    let (simulation, seen) = exact(&pulled, 2.5);
    let still = TensionMap::of(&simulation, &seen).unwrap();
    let (sin, cos) = 0.05_f64.sin_cos();
    let points = &simulation.mesh.points;
    let mut turned = seen.clone();
    for point in 0..simulation.mesh.len() {
        let [x, y] =
            [0, 1].map(|axis: usize| points[axis][point] + seen.displacements_um[axis][point]);
        turned.displacements_um[0][point] = cos * x - sin * y + 3.0 - points[0][point];
        turned.displacements_um[1][point] = sin * x + cos * y - 1.0 - points[1][point];
    }
    let moved = TensionMap::of(&simulation, &turned).unwrap();
    // What the rounds leave.
    for (still, moved) in still.tensions_kpa.iter().zip(&moved.tensions_kpa) {
        assert!((moved - still).abs() < 0.05, "{still} kPa, {moved} kPa");
    }
    assert!((moved.misfit_um - still.misfit_um).abs() < 1e-4, "{}", moved.misfit_um);
}

#[test]
fn a_film_shows_a_weak_half_and_how_weak_it_is() {
    if crate::common::left_to_full() {
        return;
    }
    for support in [FREE, SupportKind::ElasticBed { stiffness: 0.5 }] {
        let pulled = pulled(weak_half, support, 0.155);
        let mesh = pulled.mesh(1.2);
        let seen = ObservedPeak::at_peak(&pulled.followed(&mesh));
        assert_eq!(seen.frames, (0..9).filter(|&frame| FRAMES[frame] == 1.0).collect::<Vec<_>>());
        let simulation = pulled.simulation(mesh);
        let map = TensionMap::of(&simulation, &seen).unwrap();
        let (right, left) = (
            mean(&pulled, &simulation, &map.tensions_kpa, is_right),
            mean(&pulled, &simulation, &map.tensions_kpa, is_left),
        );
        // Half as strong; the noise of the film leaves two hundredths.
        assert!((right / left - 0.5).abs() < 0.02, "{support:?}: {right} and {left} kPa");
        assert!((map.mean_kpa - 30.0).abs() < 0.5, "{} kPa", map.mean_kpa);
        assert!(map.is_uneven() && map.misfit_um < 0.1 * map.even_misfit_um);
        let truth = pulled.truth(&simulation.mesh);
        let within = (map.tensions_kpa.iter().zip(&truth).zip(&map.deviations_kpa))
            .filter(|((found, truth), deviation)| (*found - *truth).abs() < 1.96 * **deviation)
            .count() as f64
            / truth.len() as f64;
        // 95 % of a smooth map; a step is none.
        assert!(within > 0.8, "{support:?}: {within}");
    }
}

#[test]
fn a_film_shows_a_passive_nucleus_as_far_as_its_noise_allows() {
    if crate::common::left_to_full() {
        return;
    }
    let pulled = pulled(passive_nucleus, FREE, 0.155);
    let mesh = pulled.mesh(1.0);
    let seen = ObservedPeak::at_peak(&pulled.followed(&mesh));
    let simulation = pulled.simulation(mesh);
    let map = TensionMap::of(&simulation, &seen).unwrap();
    let nucleus = mean(&pulled, &simulation, &map.tensions_kpa, is_nucleus);
    let far = mean(&pulled, &simulation, &map.tensions_kpa, is_far);
    // It is as wide as what can be told, so it looks weaker than its surroundings, not without tension.
    assert!(map.resolution_um() > 4.0 && map.resolution_um() < 9.0, "{}", map.resolution_um());
    assert!(nucleus < 0.5 * far && (far / 40.0 - 1.0).abs() < 0.03, "{nucleus} and {far} kPa");
    assert!(map.tensions_kpa.iter().all(|tension| *tension >= 0.0));
    assert!(map.is_uneven());
}

#[test]
fn an_even_cell_is_said_to_be_even() {
    if crate::common::left_to_full() {
        return;
    }
    let (mut uneven, mut tried) = (0, 0);
    for seed in 1..=3 {
        tried += 1;
        let mut pulled = pulled(even, FREE, 0.4);
        pulled.scene.seed = seed;
        let mesh = pulled.mesh(1.2);
        let seen = ObservedPeak::at_peak(&pulled.followed(&mesh));
        let simulation = pulled.simulation(mesh);
        let map = TensionMap::of(&simulation, &seen).unwrap();
        let words = &map.verdicts(&simulation)[0];
        let says_even = words.contains("this film shows no difference between places");
        assert_eq!(says_even, !map.is_uneven(), "{words}");
        uneven += usize::from(map.is_uneven());
        assert!((map.mean_kpa - 35.0).abs() < 0.5, "{}", map.mean_kpa);
    }
    // The test errs in 5 % of films: in two of three by chance in 0.7 %.
    assert!(uneven < 2, "{uneven} of {tried}");
}

#[test]
fn what_gives_no_map_says_why() {
    let pulled = pulled(even, FREE, 0.0);
    let (simulation, seen) = exact(&pulled, 3.0);
    let longer = ObservedPeak {
        displacements_um: seen
            .displacements_um
            .clone()
            .map(|axis| axis.iter().map(|u| -u).collect()),
        ..seen.clone()
    };
    let error = TensionMap::of(&simulation, &longer).unwrap_err();
    assert!(
        matches!(error, TensionMapError::NoContraction { tension_kpa } if tension_kpa < 0.0),
        "{error}"
    );
    let lost = ObservedPeak { found: vec![false; seen.found.len()], ..seen.clone() };
    let error = TensionMap::of(&simulation, &lost).unwrap_err();
    assert!(matches!(error, TensionMapError::TooLittle { squares: 0, .. }), "{error}");
    let other = ObservedPeak { found: vec![true; 3], ..seen.clone() };
    assert!(matches!(
        TensionMap::of(&simulation, &other),
        Err(TensionMapError::Mesh { found: 3, .. })
    ));
    let ends = Simulation { active: ActiveLaw::Ends, ..simulation };
    assert!(matches!(TensionMap::of(&ends, &seen), Err(TensionMapError::Ends)));
}

/// Three fifths of a strip of 100 um, which the frame cuts at 60 um; what is seen there is that of the whole strip.
fn cut_strip(
    tension: fn([f64; 2]) -> f64,
    support: SupportKind,
) -> (Simulation, ObservedPeak, Vec<f64>) {
    let mut whole = Simulation::new(lattice::rectangle(50, 10, 2.0).unwrap());
    whole.support = support;
    let mesh = &whole.mesh;
    let truth = |mesh: &Mesh| -> Vec<f64> {
        mesh.simplices.iter().map(|triangle| tension(mesh.centre(triangle))).collect()
    };
    let (body, system) = whole.mechanics();
    let mut equilibrium = Equilibrium::new(&system, &body, Tolerance::default()).unwrap();
    let moved = equilibrium.find(&body.positions, Tension::PerElement(&truth(mesh))).unwrap();
    let mut seen = Simulation::new(lattice::rectangle(30, 10, 2.0).unwrap());
    seen.support = support;
    let there = |point: usize| {
        let place = seen.mesh.point(point);
        let away = |other: usize| {
            let at = mesh.point(other);
            (at[0] - place[0]).hypot(at[1] - place[1])
        };
        (0..mesh.len()).min_by(|a, b| away(*a).total_cmp(&away(*b))).unwrap()
    };
    let displacements_um = [0, 1].map(|axis: usize| {
        let ways = (0..seen.mesh.len()).map(there);
        ways.map(|point| moved[axis][point] - mesh.points[axis][point]).collect()
    });
    let cut = (0..seen.mesh.len()).map(|point| seen.mesh.point(point)[0] > 59.0).collect();
    let found = vec![true; seen.mesh.len()];
    let told = ObservedPeak {
        displacements_um,
        found,
        cut,
        alike_um: 3.0,
        blur: Blur::default(),
        frames: Vec::new(),
    };
    let truth = truth(&seen.mesh);
    (seen, told, truth)
}

#[test]
fn what_pulls_beyond_the_frame_is_not_taken_for_tension() {
    if crate::common::left_to_full() {
        return;
    }
    // The part that is not seen pulls three times as hard, so it draws the other out.
    let tension = |[x, _]: [f64; 2]| if x < 60.0 { 20.0 + 5.0 * (x / 10.0).sin() } else { 60.0 };
    for support in [FREE, SupportKind::ElasticBed { stiffness: 0.5 }] {
        let (simulation, seen, truth) = cut_strip(tension, support);
        let map = TensionMap::of(&simulation, &seen).unwrap();
        let off = |map: &TensionMap| {
            let mut off: Vec<f64> = (map.tensions_kpa.iter().zip(&truth))
                .map(|(found, truth)| (found / truth - 1.0).abs())
                .collect();
            off.sort_by(f64::total_cmp);
            off[off.len() / 2]
        };
        let whole = ObservedPeak { cut: vec![false; seen.cut.len()], ..seen.clone() };
        let taken = TensionMap::of(&simulation, &whole).unwrap();
        assert_eq!((map.held_at_cut, taken.held_at_cut), (11, 0));
        // As of a whole cell; what pulls beyond the frame makes an error of 4 and 8 % where it is not counted with.
        assert!(off(&map) < 0.003, "{support:?}: {}", off(&map));
        assert!(off(&taken) > 0.03, "{support:?}: {}", off(&taken));
        let words = map.verdicts(&simulation).join("; ");
        assert!(words.contains("the frame cuts the cell"), "{words}");
    }
}

#[test]
fn noise_at_the_cut_is_no_unevenness() {
    if crate::common::left_to_full() {
        return;
    }
    let (simulation, exact, _) = cut_strip(|_| 30.0, FREE);
    for seed in 0..5 {
        let mut random = Random(seed);
        let mut seen = exact.clone();
        for way in seen.displacements_um.iter_mut().flatten() {
            *way += 0.02 * random.normal();
        }
        // Points have one error each.
        seen.alike_um = 2.0;
        let map = TensionMap::of(&simulation, &seen).unwrap();
        assert!(!map.is_uneven(), "{seed}: {}", map.chance_even);
        assert!((map.mean_kpa - 30.0).abs() < 0.5, "{seed}: {} kPa", map.mean_kpa);
    }
}

#[test]
fn places_whose_standard_deviation_exceeds_half_of_their_tension_are_doubtful_and_most_of_them_are_no_map()
 {
    let (simulation, seen) = exact(&pulled(wave, FREE, 0.0), 4.0);
    let sure = TensionMap::of(&simulation, &seen).unwrap();
    assert!(sure.is_known() && sure.doubtful_part() < 0.01, "{}", sure.doubtful_part());
    let with_doubts = |part: f64| {
        let mut map = sure.clone();
        let count = (part * map.tensions_kpa.len() as f64) as usize;
        for (deviation, tension) in map.deviations_kpa.iter_mut().zip(&map.tensions_kpa).take(count)
        {
            *deviation = 0.6 * tension;
        }
        map
    };
    let some = with_doubts(0.3);
    assert!(some.is_known() && (some.doubtful_part() - 0.3).abs() < 0.02);
    assert!(
        some.verdicts(&simulation)
            .iter()
            .any(|verdict| verdict.contains("30 % of the cell, hatched"))
    );
    let most = with_doubts(0.7);
    let words = most.verdicts(&simulation);
    assert!(
        !most.is_known() && words[0].contains("does not show where the cell pulls"),
        "{words:?}"
    );
    assert!(
        !words.iter().any(|verdict| verdict.contains("differs from place to place")),
        "{words:?}"
    );
    // A place without tension is known if its deviation is small against the mean, and not otherwise.
    let mut none = sure.clone();
    none.tensions_kpa.fill(0.0);
    none.deviations_kpa.fill(0.1 * sure.mean_kpa);
    assert!(none.doubts().iter().all(|doubt| *doubt < 0.5));
    none.deviations_kpa.fill(sure.mean_kpa);
    assert!(none.doubts().iter().all(|doubt| *doubt == 1.0));
}

/// A tension by place, the support, and when each place begins.
type Kind = (fn([f64; 2]) -> f64, SupportKind, fn([f64; 2]) -> usize);

#[test]
#[ignore = "slow"]
fn bands_of_all_frames_have_the_true_tension() {
    if crate::common::left_to_full() {
        return;
    }
    let bed = SupportKind::ElasticBed { stiffness: 0.5 };
    let kinds: [Kind; 4] = [
        (passive_nucleus, bed, together),
        (even, bed, together),
        (weak_half, FREE, together),
        (even, FREE, late_half),
    ];
    let mut sample = Sample::one_in(4);
    for (number, (tension, support, lag)) in kinds.into_iter().enumerate() {
        if sample.leaves_out() {
            continue;
        }
        let pulled = Pulled { lag, ..pulled(tension, support, 0.155) };
        let mesh = pulled.mesh(1.2);
        let motion = pulled.followed(&mesh);
        let (map, film) = TensionFilm::of(&pulled.simulation(mesh.clone()), &motion).unwrap();
        let (mut within, mut all) = (0, 0);
        for (at, &frame) in film.frames.iter().enumerate() {
            let truth = pulled.truth_in(&mesh, frame);
            let found = film.tensions_kpa(at).into_iter().zip(film.deviations_kpa(at)).zip(truth);
            within +=
                found.filter(|((found, sd), truth)| (found - truth).abs() <= 1.96 * sd).count();
            all += mesh.simplices.len();
        }
        let covered = within as f64 / all as f64;
        // A nominal 95 %; one film of nine frames, half of them at rest.
        assert!(covered > 0.9, "{number}: {covered}");
        // A half that is late is a pattern of its own.
        assert_eq!(film.modes > 1, number == 3, "{number}: {} modes", film.modes);
        let most = film.means_kpa.iter().copied().fold(0.0, f64::max);
        assert!((most / map.mean_kpa - 1.0).abs() < 0.03 || number == 3, "{most} {}", map.mean_kpa);
    }
}
