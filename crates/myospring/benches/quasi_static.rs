//! The quasi-static solver: `cargo bench -p myospring --bench quasi_static`.
#![allow(missing_docs, reason = "the macros of criterion make public items")]
#![allow(clippy::expect_used, reason = "a benchmark may stop here")]

use criterion::{Criterion, criterion_group, criterion_main};
use myospring::cell;
use myospring::cell::pacing::Protocol;
use myospring::integrate::quasi_static::Tolerance;
use myospring::mechanics::material::myofilament_material;
use myospring::mesh::{built_in, lattice};
use myospring::simulation::Simulation;
use std::hint::black_box;

fn built_in_cell(masses: usize) -> Simulation {
    let outline = built_in::adult_ventricular();
    let spacing = lattice::default_spacing(outline.area(), masses);
    let (mesh, _) = lattice::from_outline(&outline, Some(spacing)).expect("a built-in cell meshes");
    Simulation::new(mesh)
}

fn quasi_static(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("quasi_static");
    group.sample_size(10);
    for masses in [1_900, 20_000] {
        let simulation = built_in_cell(masses);
        let solve = || simulation.equilibria(&[50.0], Tolerance::default());
        group.bench_function(format!("path to 50 kPa, {masses} masses"), |bench| {
            bench.iter(|| black_box(solve().is_ok()));
        });
        group.bench_function(format!("beat of coelho_2021, {masses} masses"), |bench| {
            bench.iter(|| {
                let outcome = simulation.run_quasi_static(Tolerance::default(), |_| true);
                black_box(outcome.is_ok())
            });
        });
        let equilibria = solve().expect("the built-in cell has a path");
        let series: Vec<[f64; 2]> = (0..10_000_u32)
            .map(|k| [f64::from(k), 25.0 - 25.0 * (0.006 * f64::from(k)).cos()])
            .collect();
        group.bench_function(format!("10 000 tensions, {masses} masses"), |bench| {
            bench.iter(|| black_box(equilibria.follow(&series).is_ok()));
        });
    }
    // Tension and length are found together in each of 2400 exchanges.
    for name in ["land_2017", "tor_ord_land"] {
        let simulation = feeling(name);
        group.bench_function(format!("beat of {name}, 1900 masses"), |bench| {
            bench.iter(|| {
                let outcome = simulation.run_quasi_static(Tolerance::default(), |_| true);
                black_box(outcome.is_ok())
            });
        });
    }
    group.finish();
}

/// The built-in cell with a model that feels its stretch, as a run takes it.
fn feeling(name: &str) -> Simulation {
    let model = cell::model(name).expect("a model of the list");
    let usual = built_in_cell(1_900);
    Simulation {
        protocol: Protocol::once(model.default_stimulus()),
        material: myofilament_material(),
        cell: model,
        ..usual
    }
}

criterion_group!(benches, quasi_static);
criterion_main!(benches);
