//! How fast a cell model read from a file is, and many cells of it side by side, compared with the
//! same model written in Rust.
//!
//! Reads the files named (the public ToR-ORd files with dynamic chloride first, which the built-in
//! `tor_ord_dyn_cl_endo` is), or `ToRORd_dynCl_endo.cellml` of the shared data. Prints one JSON line
//! per file and population: cells per second of processor time, and for ToR-ORd the ratio to the
//! built-in model in the same run.
//!
//! ```sh
//! cargo run --release -p myospring-verification --example cell_file_throughput -- FILE.cellml
//! ```
#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use myospring::cell::batch::{self, BatchSettings, Paced};
use myospring::cell::equation_model::EquationModel;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings};
use myospring::cell::{self, CellModel};
use myospring::cell_files::{Choices, open};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

const CELLS: u32 = 1000;
const DURATION_MS: f64 = 1000.0;
/// Between samples, ms.
const SAMPLED_MS: f64 = 1.0;
/// Repetitions, alternating; the fastest counts.
const ROUNDS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut files: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    if files.is_empty() {
        let root = std::env::var("MYOSPRING_SHARED_DATA").unwrap_or("../shared/data".to_owned());
        files.push(Path::new(&root).join("cell-models/ToRORd_dynCl_endo.cellml"));
    }
    for file in files {
        let start = now();
        let equations = open(&file, &Choices::default())?;
        let read_ms = 1e3 * (now() - start);
        let start = now();
        let model: Arc<dyn CellModel> = Arc::new(EquationModel::new(equations)?);
        let compiled_ms = 1e3 * (now() - start);
        let mut members = vec![population(&model)?];
        let by_hand = model.name() == "torord_dyncl_endo";
        if by_hand {
            members.push(population(&cell::model("tor_ord_dyn_cl_endo")?)?);
        }
        for tolerance in [1e-3, 1e-5] {
            let rates = fastest(&members, tolerance)?;
            let ratio = rates.get(1).map_or(f64::NAN, |by_hand| rates[0] / by_hand);
            println!(
                "{{\"model\": \"{}\", \"read_ms\": {read_ms:.1}, \"compiled_ms\": {compiled_ms:.1}, \
                 \"tolerance\": {tolerance:e}, \"cells_per_s\": {:.1}, \"ratio_to_built_in\": {ratio:.2}}}",
                model.name(),
                rates[0]
            );
        }
    }
    Ok(())
}

/// Cells per second of each population, in turn.
fn fastest(members: &[Vec<Paced>], tolerance: f64) -> Result<Vec<f64>, Box<dyn Error>> {
    let method = SolverSettings { tolerance, ..SolverSettings::of(CellMethod::Stiff) };
    let settings = BatchSettings { method, sample_interval_ms: Some(SAMPLED_MS) };
    let mut rates = vec![0.0; members.len()];
    for _ in 0..ROUNDS {
        for (cells, rate) in members.iter().zip(&mut rates) {
            let start = now();
            for outcome in batch::run(cells, &settings)? {
                outcome?;
            }
            *rate = f64::max(*rate, f64::from(CELLS) / (now() - start));
        }
    }
    Ok(rates)
}

/// Cells of a model whose first conductance differs by up to 30 % (the same ones in every model).
fn population(model: &Arc<dyn CellModel>) -> Result<Vec<Paced>, Box<dyn Error>> {
    let conductance = |name: &str| {
        let name = name.to_lowercase().replace('_', "");
        name == "gkr" || name.ends_with("gkr") || name.ends_with("gkrb") || name.ends_with("pca")
    };
    let names: Vec<String> = model
        .parameters()
        .rows()
        .iter()
        .filter(|row| conductance(&row.name))
        .map(|row| row.name.to_string())
        .collect();
    let protocol = Protocol::once(model.default_stimulus());
    let cell = |number: u32| {
        let mut parameters = model.parameters().clone();
        for (place, name) in names.iter().enumerate() {
            let part = (f64::from(number + 1) * [0.618_034, 0.754_878][place % 2]).fract();
            let published = parameters.get(name).unwrap_or(1.0);
            parameters.set(name, published * (0.7 + 0.6 * part))?;
        }
        Ok(Paced::new(model.with_parameters(parameters)?, protocol, DURATION_MS)?)
    };
    (0..CELLS).map(cell).collect()
}

/// Seconds on a clock.
fn now() -> f64 {
    use std::sync::OnceLock;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}
