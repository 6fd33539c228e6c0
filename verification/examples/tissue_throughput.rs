//! Steps of a node of coupled cells per second, in the form of the peers' benchmark.
//!
//! ```text
//! cargo run --release -p myospring-verification --example tissue_throughput -- COLUMNS THREADS
//! ```
//!
//! COLUMNS x COLUMNS nodes 0.25 mm apart, the minimal model of epicardial cells, diffusion 1.171 cm^2/s, forward Euler with steps of
//! 0.02 ms, 100 ms of a wave from the left edge. Prints one JSON line, with the velocity of the wave between a half and three quarters of
//! the middle row.
#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "a program of its own")]

use myospring::cell::CellModel;
use myospring::cell::bueno_orovio_2008::{Variant, model};
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings};
use myospring::exchange::{Activation, Conduction, Tissue, TissueCells};
use myospring::mesh::lattice;
use std::sync::Arc;
use std::time::Instant;

const SPACING_UM: f64 = 250.0;
const STEP_MS: f64 = 0.02;
const UNTIL_MS: f64 = 100.0;
const DIFFUSION: f64 = 1.171e5;
const RUNS: usize = 3;

fn main() {
    let number = |at: usize| std::env::args().nth(at).unwrap().parse::<usize>().unwrap();
    let (columns, threads) = (number(1), number(2));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let (wave, mut rates) = pool
        .install(|| (velocity(columns), (0..RUNS).map(|_| rate(columns)).collect::<Vec<f64>>()));
    rates.sort_by(f64::total_cmp);
    println!(
        "{{\"peer\": \"myospring\", \"threads\": {threads}, \"node_steps\": {:.6e}, \"least\": {:.6e}, \"most\": {:.6e}, \
         \"velocity_cm_per_s\": {wave:.3}}}",
        rates[RUNS / 2],
        rates[0],
        rates[RUNS - 1]
    );
}

/// A sheet whose three left columns are stimulated at once.
fn sheet(columns: usize) -> Tissue {
    let mesh = lattice::rectangle(columns - 1, columns - 1, SPACING_UM).unwrap();
    let model = model(Variant::Epi);
    let beat = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let is_left = |node: usize| mesh.point(node)[0] < 2.5 * SPACING_UM;
    let protocols: Vec<Protocol> =
        (0..mesh.len()).map(|node| if is_left(node) { beat } else { Protocol::rest() }).collect();
    let settings = SolverSettings {
        method: CellMethod::ForwardEuler,
        step_ms: STEP_MS,
        ..SolverSettings::default()
    };
    let cells = TissueCells {
        model: Arc::new(model),
        state: None,
        protocols: &protocols,
        settings,
        scale: 1.0,
    };
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    Tissue::new(&mesh, &fibres, &Conduction::even(DIFFUSION), cells).unwrap()
}

/// Steps of a node per second; setting the sheet up counts, too.
fn rate(columns: usize) -> f64 {
    let start = Instant::now();
    let mut sheet = sheet(columns);
    sheet.reach(UNTIL_MS).unwrap();
    (columns * columns) as f64 * UNTIL_MS / STEP_MS / start.elapsed().as_secs_f64()
}

/// Between a half and three quarters of the middle row, cm/s.
fn velocity(columns: usize) -> f64 {
    let mut sheet = sheet(columns);
    let length = SPACING_UM * (columns - 1) as f64;
    sheet.reach(length / 500.0).unwrap();
    let mesh = lattice::rectangle(columns - 1, columns - 1, SPACING_UM).unwrap();
    let at = |column: usize| {
        let place = [column, columns / 2].map(|at| SPACING_UM * at as f64);
        let near = |node: &usize| {
            let [x, y] = mesh.point(*node);
            (x - place[0]).hypot(y - place[1]) < 1.0
        };
        sheet.local_beats().unwrap()[(0..mesh.len()).find(near).unwrap()][0].activated_ms
    };
    let [from, to] = [columns / 2, 3 * columns / 4];
    0.1 * SPACING_UM * (to - from) as f64 / (at(to) - at(from))
}
