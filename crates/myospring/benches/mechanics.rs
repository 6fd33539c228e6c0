//! Steps of a lattice, by the fused kernel and by the plain loops: `cargo bench -p myospring --bench
//! mechanics`. Elements are spring updates.
#![allow(missing_docs, reason = "the macros of criterion make public items")]
#![allow(clippy::expect_used, reason = "a benchmark may stop here")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use myospring::integrate::fused::FusedMotion;
use myospring::integrate::stencil::Units;
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{assemble, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::{built_in, lattice, quality};
use std::hint::black_box;

/// Steps in one measurement: about one interval between two exchanges with the cell model.
const STEPS: usize = 50;

fn mechanics(criterion: &mut Criterion) {
    for masses in [1_900, 20_000] {
        let outline = built_in::adult_ventricular();
        let spacing = lattice::default_spacing(outline.area(), masses);
        let (mesh, _) = lattice::from_outline(&outline, Some(spacing)).expect("it meshes");
        let axis = quality::long_axis(&mesh);
        let fibres = vec![axis; mesh.simplices.len()];
        let (body, system) = assemble(
            &mesh,
            &default_material(),
            ActiveLaw::Fibre,
            &fibres,
            SupportKind::MassCentre,
            axis,
            quality::extent(&mesh, axis),
        );
        let step = 0.9 * StabilityLimit::of(&system, &body, 50.0).time_step;
        let lattice = mesh.lattice.as_ref().expect("it is a lattice");
        let fused = |threads, units| {
            FusedMotion::new(&system, body.clone(), lattice, step, threads, units)
                .expect("the kernel serves it")
        };

        let mut group = criterion.benchmark_group(format!("steps of {} masses", mesh.len()));
        group.throughput(Throughput::Elements((mesh.springs.len() * STEPS) as u64));
        let mut plain = Motion::new(&system, body.clone(), Integrator::StoermerVerlet, step);
        group.bench_function("plain loops", |bench| {
            bench.iter(|| {
                black_box(&mut plain).advance(STEPS, [30.0; 2]).expect("no thread panics");
            });
        });
        for units in Units::ALL.into_iter().filter(|units| units.available()) {
            let mut fused = fused(1, units);
            group.bench_function(format!("fused, {units:?}"), |bench| {
                bench.iter(|| {
                    black_box(&mut fused).advance(STEPS, [30.0; 2]).expect("no thread panics");
                });
            });
        }
        let mut fused = fused(2, Units::best());
        group.bench_function("fused, 2 threads", |bench| {
            bench.iter(|| {
                black_box(&mut fused).advance(STEPS, [30.0; 2]).expect("no thread panics");
            });
        });
    }
}

criterion_group!(benches, mechanics);
criterion_main!(benches);
