//! The cell model in time: fixed steps, adaptive steps, a population side by side, and stiff steps of a model
//! of 40 states.
#![allow(missing_docs, reason = "criterion's macros make public items")]

#[path = "../tests/common/own_cell.rs"]
mod own_cell;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use myospring::cell::batch::{self, BatchSettings, Paced};
use myospring::cell::bueno_orovio_2008::{self, Variant};
use myospring::cell::minimal::MinimalModel;
use myospring::cell::pacing::Protocol;
use myospring::cell::{CellModel, adaptive, coelho_2021, solve};
use std::hint::black_box;

fn models() -> [MinimalModel; 2] {
    [bueno_orovio_2008::model(Variant::Epi), coelho_2021::model()]
}

fn beats_at_1_hz(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("cell_beats");
    group.sample_size(20);
    for model in models() {
        let train = |beats| Protocol { beats, ..Protocol::once(model.default_stimulus()) };
        group.throughput(Throughput::Elements(1));
        group.bench_function(BenchmarkId::new("fixed_steps", model.name()), |bencher| {
            bencher.iter(|| {
                solve::solve(
                    &model,
                    train(1),
                    solve::SolverSettings::default(),
                    1000.0,
                    black_box(10.0),
                )
            });
        });
        group.throughput(Throughput::Elements(20));
        group.bench_function(BenchmarkId::new("adaptive", model.name()), |bencher| {
            let settings = adaptive::AdaptiveSettings::default();
            bencher.iter(|| adaptive::beats(&model, train(20), settings, black_box(20_050.0)));
        });
        let cells: Vec<Paced> = (0..64)
            .filter_map(|k| {
                let mut parameters = model.parameters().clone();
                let tau_si = parameters.get("tau_si")?;
                parameters.set("tau_si", tau_si * (0.8 + 0.4 * f64::from(k) / 63.0)).ok()?;
                let cell = model.with_parameters(parameters).ok()?;
                Paced::new(cell, train(20), 20_050.0).ok()
            })
            .collect();
        group.throughput(Throughput::Elements(20 * cells.len() as u64));
        group.bench_function(BenchmarkId::new("population", model.name()), |bencher| {
            let method = solve::SolverSettings::of(solve::CellMethod::Adaptive);
            let settings = BatchSettings { method, sample_interval_ms: None };
            bencher.iter(|| batch::run(black_box(&cells), &settings));
        });
    }
    group.finish();
}

fn stiff_beat(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("stiff_beat_of_40_states");
    let model = own_cell::stiff();
    let protocol = Protocol::once(model.default_stimulus());
    let settings = solve::SolverSettings::of(solve::CellMethod::Stiff);
    for (name, model) in
        [("own_jacobian", model.clone()), ("differences", model.clone().without_jacobian())]
    {
        group.bench_function(name, |bencher| {
            bencher.iter(|| solve::solve(&model, protocol, settings, 600.0, black_box(1.0)));
        });
    }
    group.finish();
}

criterion_group!(benches, beats_at_1_hz, stiff_beat);
criterion_main!(benches);
