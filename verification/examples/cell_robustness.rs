//! Whether adaptive steps bring any cell to its end: 18 000 cells with every parameter changed at random.
//!
//! The six published sets; parameters times 1 + s r, r even between -1 and 1, s of 0.2, 0.5 and 0.9, thresholds
//! among them; jumps and pulses of a tenth to three times the usual size, cycles of 200 to 1200 ms; 3 s each.
//! Prints one JSON line per set and s: cells, those that no step took further, steps on average and the most.
//!
//! ```sh
//! cargo run --release -p myospring-verification --example cell_robustness
//! ```
#![allow(clippy::print_stdout, reason = "printing is what this program is for")]

use myospring::cell::batch::{BatchSettings, Paced, run};
use myospring::cell::bueno_orovio_2008::{self, Variant};
use myospring::cell::coelho_2021;
use myospring::cell::minimal::{Identity, MinimalModel};
use myospring::cell::pacing::{Protocol, Stimulus};
use myospring::cell::solve::{CellMethod, SolverSettings};
use myospring::parameter::ParameterSet;
use std::error::Error;
use std::sync::Arc;

const CELLS: usize = 1000;
const DURATION_MS: f64 = 3000.0;

fn main() -> Result<(), Box<dyn Error>> {
    let variants = [Variant::Epi, Variant::Endo, Variant::M, Variant::Pb, Variant::Tnnp];
    let mut sets = vec![(coelho_2021::IDENTITY, coelho_2021::parameters())];
    sets.extend(variants.map(|variant| {
        (bueno_orovio_2008::identity(variant), bueno_orovio_2008::parameters(variant))
    }));
    let method = SolverSettings::of(CellMethod::Adaptive);
    let settings = BatchSettings { method, sample_interval_ms: None };
    let mut random = Random(1);
    let mut failed = 0;
    for (identity, parameters) in &sets {
        for spread in [0.2, 0.5, 0.9] {
            let cells = (0..CELLS)
                .map(|_| cell(*identity, parameters, spread, &mut random))
                .collect::<Result<Vec<_>, _>>()?;
            let outcomes = run(&cells, &settings)?;
            let steps: Vec<u64> =
                outcomes.iter().filter_map(|outcome| Some(outcome.as_ref().ok()?.steps)).collect();
            failed += CELLS - steps.len();
            let line = serde_json::json!({
                "set": identity.name,
                "spread": spread,
                "cells": CELLS,
                "failed": CELLS - steps.len(),
                "steps_on_average": steps.iter().sum::<u64>() / steps.len().max(1) as u64,
                "steps_at_most": steps.iter().max(),
            });
            println!("{line}");
        }
    }
    if failed > 0 { Err(format!("{failed} cells came to no end").into()) } else { Ok(()) }
}

/// A cell like no other; a parameter whose new value is outside its range keeps the published one.
fn cell(
    identity: Identity,
    parameters: &ParameterSet,
    spread: f64,
    random: &mut Random,
) -> Result<Paced, Box<dyn Error>> {
    let mut own = parameters.clone();
    for parameter in parameters.rows() {
        let factor = random.between(1.0 - spread, 1.0 + spread);
        own.set(&parameter.name, factor * parameter.value).ok();
    }
    let model = MinimalModel::new(identity, own)
        .or_else(|_| MinimalModel::new(identity, parameters.clone()))?;
    let size = random.between(0.1, 3.0);
    let stimulus = if random.between(0.0, 1.0) < 0.5 {
        Stimulus::Jump { amplitude: 0.3 * size }
    } else {
        Stimulus::Pulse { amplitude: 0.5 * size, duration_ms: random.between(0.2, 5.0) }
    };
    let protocol = Protocol {
        start_ms: random.between(0.0, 50.0),
        cycle_length_ms: random.between(200.0, 1200.0),
        beats: 100,
        ..Protocol::once(stimulus)
    };
    Ok(Paced::new(Arc::new(model), protocol, DURATION_MS)?)
}

/// `SplitMix64` (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn between(&mut self, least: f64, most: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        least + (most - least) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
