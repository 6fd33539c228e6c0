use myospring::cell::{adaptive::*, *, pacing::*};
use std::time::Instant;
fn main() {
    let mut models = vec![coelho_2021::model()];
    use bueno_orovio_2008::{Variant::*, model};
    for v in [Epi, Endo, M, Pb, Tnnp] { models.push(model(v)); }
    for m in &models {
        let p = Protocol { stimulus: m.default_stimulus(), start_ms: 50.0, cycle_length_ms: 1000.0, beats: 5 };
        let cell = Cell::new(m, p, 5000.0);
        let fine = run::<1>(&[cell.clone()], 1e-9).remove(0);
        println!("{} fine {:?} steps {} {} {}", m.name(), fine.beats[4], fine.taken, fine.refused, fine.steps);
        for tol in [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6] {
            let o = run::<1>(&[cell.clone()], tol).remove(0);
            let (mut et, mut ea, mut ett) = (0f64, 0f64, 0f64);
            for (a, b) in o.beats.iter().zip(&fine.beats) {
                et = et.max((a.peak_tension / b.peak_tension - 1.).abs() * 100.);
                ea = ea.max((a.apd90_ms.unwrap_or(0.) - b.apd90_ms.unwrap_or(0.)).abs());
                ett = ett.max((a.peak_tension_ms - b.peak_tension_ms).abs());
            }
            println!("  tol {tol:e} Ta err {et:.5}% t {ett:.4} apd err {ea:.5} ms; per beat taken {} refused {} attended {}", o.taken / 5, o.refused / 5, o.steps / 5);
        }
    }
    for m in &models[..2] {
        for tol in [1e-3, 1e-4] {
        let p = Protocol { stimulus: m.default_stimulus(), start_ms: 10.0, cycle_length_ms: 1000.0, beats: 100 };
        let cells: Vec<Cell> = (0..64).map(|_| Cell::new(m, p, 100000.0)).collect();
        let time = |name: &str, f: &dyn Fn() -> usize| {
            let mut best = 0f64;
            for _ in 0..5 { let t = Instant::now(); let n = f(); best = best.max(n as f64 / t.elapsed().as_secs_f64()); }
            println!("{} tol {tol:e} {name}: {best:.0} cell-beats/s", m.name());
        };
        time("N=1", &|| run::<1>(&cells[..8], tol).len() * 100);
        time("N=4", &|| run::<4>(&cells, tol).len() * 100);
        time("N=8", &|| run::<8>(&cells, tol).len() * 100);
        time("N=16", &|| run::<16>(&cells, tol).len() * 100);
        time("N=32", &|| run::<32>(&cells, tol).len() * 100);
        }
    }
}
