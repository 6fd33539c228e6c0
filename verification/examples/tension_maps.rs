//! How well a known map of tension is found in a film, over noise, shape and support.
//!
//! `cargo run --release -p myospring-verification --example tension_maps` prints the table of the peak of
//! `docs/reference/accuracy.md`, with `-- coverage` that of the whole beat; with `-- docs/pictures/tension-map.png` it draws
//! its picture instead, and with `-- film FILE.y4m`
//! writes 504 frames of 510 x 480 pixels of a cell with a weak half, to time `myospring fit FILE.y4m --pixel-size "0.2 um"`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "an example that measures")]

#[path = "../../crates/myospring/tests/common/pulled_film.rs"]
mod pulled_film;
#[path = "../../crates/myospring/tests/common/synthetic_cell.rs"]
mod synthetic_cell;
#[path = "../../crates/myospring/tests/common/synthetic_film.rs"]
mod synthetic_film;

use myospring::mechanics::support::SupportKind;
use myospring::microscopy::outlines::trace::{Edge, trace_mask};
use myospring::output::field::Fields;
use myospring::output::figure::{self, DrawnCell, Map};
use myospring::output::files;
use myospring::tension_map::{ObservedPeak, TensionFilm, TensionMap};
use pulled_film::{BEAT, FRAMES, Pulled, even, late_half, passive_nucleus, together, weak_half};
use rayon::prelude::*;
use synthetic_film::FilmScene;

/// Correlation of two lists.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (p, q) = (mean(a), mean(b));
    let sum =
        |of: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| of(a - p, b - q)).sum::<f64>();
    sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt()
}

/// What one film tells.
struct Told {
    correlation: f64,
    mean_kpa: f64,
    /// Mean of the weak half over that of the strong one, or of the middle of the nucleus over the cell far from it.
    ratio: f64,
    uneven: bool,
    numbers: f64,
    resolution_um: f64,
    deviation_kpa: f64,
    within: f64,
}

fn told(tension: fn([f64; 2]) -> f64, support: SupportKind, noise: f64, seed: u64) -> Told {
    let scene = FilmScene { cell_um: [100.0, 22.0], noise, bits: 8, seed, ..FilmScene::default() };
    let pulled = Pulled { scene, tension, support, frames: &FRAMES, lag: together };
    let mesh = pulled.mesh(1.1);
    let simulation = pulled.simulation(mesh.clone());
    let map = TensionMap::of(&simulation, &ObservedPeak::at_peak(&pulled.followed(&mesh))).unwrap();
    let truth = pulled.truth(&mesh);
    let [cx, cy] = pulled.scene.middle();
    let mean = |is: &dyn Fn(f64, f64) -> bool| {
        let there = (0..truth.len()).filter(|&at| {
            let [x, y] = mesh.centre(&mesh.simplices[at]);
            is(x - cx, y - cy)
        });
        let (sum, count) = there.fold((0.0, 0), |(sum, n), at| (sum + map.tensions_kpa[at], n + 1));
        sum / f64::from(count)
    };
    let from_nucleus = |x: f64, y: f64| (x / 9.0).powi(2) + (y / 3.6).powi(2);
    let ratio = if tension([0.0, 0.0]) == 0.0 {
        mean(&|x, y| from_nucleus(x, y) < 0.5) / mean(&|x, y| from_nucleus(x, y) > 3.0)
    } else {
        mean(&|x, _| x > 5.0) / mean(&|x, _| x < -5.0)
    };
    let found = map.tensions_kpa.iter().zip(&truth).zip(&map.deviations_kpa);
    let within = found.filter(|((found, truth), sd)| (*found - *truth).abs() < 1.96 * **sd).count();
    let mut deviations = map.deviations_kpa.clone();
    deviations.sort_by(f64::total_cmp);
    Told {
        correlation: correlation(&map.tensions_kpa, &truth),
        mean_kpa: map.mean_kpa,
        ratio,
        uneven: map.is_uneven(),
        numbers: map.numbers,
        resolution_um: map.resolution_um(),
        deviation_kpa: deviations[deviations.len() / 2],
        within: within as f64 / truth.len() as f64,
    }
}

/// A row: means over films.
fn row(name: &str, tension: fn([f64; 2]) -> f64, support: SupportKind, noise: f64) {
    const FILMS: u64 = 5;
    let all: Vec<Told> = (1..=FILMS).map(|seed| told(tension, support, noise, seed)).collect();
    let mean = |of: &dyn Fn(&Told) -> f64| all.iter().map(of).sum::<f64>() / FILMS as f64;
    let uneven = all.iter().filter(|told| told.uneven).count();
    let correlation = mean(&|told| told.correlation);
    let correlation =
        if correlation.is_finite() { format!("{correlation:.2}") } else { "-".to_owned() };
    println!(
        "| {name} | {noise} | {uneven} of {FILMS} | {:.1} | {:.2} | {correlation} | {:.0} | {:.1} | {:.1} | {:.0} |",
        mean(&|told| told.mean_kpa),
        mean(&|told| told.ratio),
        mean(&|told| told.numbers),
        mean(&|told| told.resolution_um),
        mean(&|told| told.deviation_kpa),
        100.0 * mean(&|told| told.within),
    );
}

/// A weak half beside what a film with noise tells of it.
fn draw(path: &std::path::Path) {
    let scene = FilmScene { cell_um: [100.0, 22.0], noise: 0.155, bits: 8, ..FilmScene::default() };
    let support = SupportKind::MassCentre;
    let pulled = Pulled { scene, tension: weak_half, support, frames: &FRAMES, lag: together };
    let mesh = pulled.mesh(1.1);
    let simulation = pulled.simulation(mesh.clone());
    let map = TensionMap::of(&simulation, &ObservedPeak::at_peak(&pulled.followed(&mesh))).unwrap();
    let fields = Fields::new(&mesh, &simulation.fibres, None).unwrap();
    let one = |name: &str, values: &[f64], quantity: &str, limits| Map {
        name: name.to_owned(),
        positions: &map.positions_um,
        values: fields.from_triangles(values),
        quantity: quantity.to_owned(),
        limits,
        doubts: None,
        hatched: figure::NOT_KNOWN,
        dots: None,
    };
    let tension = Some([0.0, 45.0]);
    let maps = [
        one("Where the cell pulls", &pulled.truth(&mesh), "Active tension (kPa)", tension),
        one("What its film shows", &map.tensions_kpa, "Active tension (kPa)", tension),
        one("How sure that is", &map.deviations_kpa, "Standard deviation (kPa)", None),
    ];
    let outline = trace_mask(&pulled.scene.mask(), Edge::Smooth).unwrap();
    let cell = DrawnCell::new(fields.clone(), Some(&outline)).unwrap();
    let figure = figure::maps(&cell, &maps, Some(map.resolution_um())).unwrap();
    files::write(path, figure.to_png(200.0).unwrap()).unwrap();
}

/// How much of the truth the bands of a film's frames have, %: of all frames, of those of the rise, of the peak, and of the
/// fall; modes; part of the places that are known, %.
fn over_the_beat(pulled: &Pulled) -> [f64; 6] {
    let mesh = pulled.mesh(1.1);
    let simulation = pulled.simulation(mesh.clone());
    let (_, film) = TensionFilm::of(&simulation, &pulled.followed(&mesh)).unwrap();
    let covered = |frames: std::ops::Range<usize>| {
        let there = (0..film.frames.len()).filter(|at| frames.contains(&film.frames[*at]));
        let parts: Vec<f64> = there
            .map(|at| {
                let truth = pulled.truth_in(&mesh, film.frames[at]);
                let found =
                    film.tensions_kpa(at).into_iter().zip(film.deviations_kpa(at)).zip(truth);
                let within =
                    found.filter(|((found, sd), truth)| (found - truth).abs() <= 1.96 * sd);
                100.0 * within.count() as f64 / mesh.simplices.len() as f64
            })
            .collect();
        parts.iter().sum::<f64>() / parts.len() as f64
    };
    let known = film.known(9).into_iter().filter(|known| *known).count() as f64;
    [
        covered(0..pulled.frames.len()),
        covered(4..8),
        covered(8..12),
        covered(12..21),
        film.modes as f64,
        100.0 * known / mesh.simplices.len() as f64,
    ]
}

/// The table of coverage over the beat.
fn coverage() {
    type Kind = (&'static str, fn([f64; 2]) -> f64, fn([f64; 2]) -> usize);
    const FILMS: u64 = 4;
    let kinds: [Kind; 4] = [
        ("even", even, together),
        ("weak half", weak_half, together),
        ("passive nucleus", passive_nucleus, together),
        ("half of the cell late", even, late_half),
    ];
    let supports =
        [("", SupportKind::MassCentre), (", on a bed", SupportKind::ElasticBed { stiffness: 0.5 })];
    println!(
        "| cell | noise | all frames, % | rise, % | peak, % | fall, % | modes | known at the peak, % |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, tension, lag) in kinds {
        for (on, support) in supports {
            for noise in [0.05, 0.155, 0.4] {
                let films: Vec<[f64; 6]> = (1..=FILMS)
                    .into_par_iter()
                    .map(|seed| {
                        // No two films have a cell of one size.
                        let length = 84.0 + 8.0 * seed as f64;
                        let cell_um = [length, 17.0 + 2.0 * seed as f64];
                        let scene =
                            FilmScene { cell_um, noise, bits: 8, seed, ..FilmScene::default() };
                        over_the_beat(&Pulled { scene, tension, support, frames: &BEAT, lag })
                    })
                    .collect();
                let mean =
                    |at: usize| films.iter().map(|film| film[at]).sum::<f64>() / FILMS as f64;
                println!(
                    "| {name}{on} | {noise} | {:.0} | {:.0} | {:.0} | {:.0} | {:.1} | {:.0} |",
                    mean(0),
                    mean(1),
                    mean(2),
                    mean(3),
                    mean(4),
                    mean(5)
                );
            }
        }
    }
}

/// Writes a film of a cell of 86 x 80 um with a weak half: 21 beats of 24 frames.
fn long_film(file: &std::ffi::OsStr) {
    let scene = FilmScene { cell_um: [86.0, 80.0], noise: 0.1, bits: 8, ..FilmScene::default() };
    let support = SupportKind::MassCentre;
    let film = Pulled { scene, tension: weak_half, support, frames: &BEAT, lag: together };
    std::fs::write(file, film.bytes(21)).unwrap();
}

fn main() {
    match std::env::args_os().nth(1) {
        Some(word) if word == "coverage" => return coverage(),
        Some(word) if word == "film" => {
            return long_film(&std::env::args_os().nth(2).unwrap_or_default());
        }
        Some(path) => return draw(path.as_ref()),
        None => {}
    }
    println!(
        "| cell | noise | said to be uneven | mean tension, kPa | weak over strong part | correlation | numbers of the map | \
         resolution, um | standard deviation, kPa | true tension within 1.96 of them, % |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let free = SupportKind::MassCentre;
    let bed = SupportKind::ElasticBed { stiffness: 0.5 };
    for noise in [0.0, 0.155, 0.4] {
        row("weak half", weak_half, free, noise);
    }
    row("weak half, on a bed", weak_half, bed, 0.155);
    for noise in [0.0, 0.155, 0.4] {
        row("passive nucleus", passive_nucleus, free, noise);
    }
    row("passive nucleus, on a bed", passive_nucleus, bed, 0.155);
    for noise in [0.0, 0.155, 0.4] {
        row("even", even, free, noise);
    }
    row("even, on a bed", even, bed, 0.155);
}
