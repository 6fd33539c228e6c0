//! Threads that stall and threads that panic.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::super::terms::LatticeTerms;
use super::*;
use crate::mechanics::support::Support;
use crate::mesh::lattice;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::AtomicUsize;

/// Sees every piece before it is done, and by which thread.
pub(super) type Hook = Box<dyn Fn(usize, &Claim<'_>) + Send + Sync>;

const STEP: f64 = 0.05;

/// Springs and dashpots on a rectangle of so many places.
fn plan(columns: usize, rows: usize) -> Plan {
    let mesh = lattice::rectangle(columns - 1, rows - 1, 1.0).unwrap();
    let mut terms = LatticeTerms::new(mesh.lattice.as_ref().unwrap());
    for spring in &mesh.springs {
        let [a, b] = spring.nodes.map(|node| mesh.point(node as usize));
        assert!(terms.add_spring(spring.nodes, 1.0, (b[0] - a[0]).hypot(b[1] - a[1]), 0.1));
    }
    terms.plan(&vec![1.0; mesh.len()], 0.01, &Support::Free, STEP).unwrap()
}

/// A team on a disturbed rectangle, watched by a hook.
fn team(threads: usize, hook: impl Fn(usize, &Claim<'_>) + Send + Sync + 'static) -> Team {
    let plan = plan(60, 48);
    let tiling = Tiling::new(&plan, threads);
    let tiles = Tiles::new(plan, Units::best(), tiling);
    let mut team = Team::at_work(Shared {
        board: Board::new(tiles.bands()),
        tiles,
        threads,
        invited: AtomicBool::new(true),
        quit: AtomicBool::new(false),
        hook: Some(Box::new(hook)),
    });
    let (plan, state, _) = team.parts();
    for (node, place) in plan.nodes().enumerate() {
        let (i, j) = ((node % 60) as f64, (node / 60) as f64);
        state[place] = i + 0.05 * (0.37 * i + 0.61 * j).sin();
        state[place + plan.stride] = j + 0.05 * (0.53 * i - 0.29 * j + 1.0).sin();
        state[place + 2 * plan.stride] = 0.0;
        state[place + 3 * plan.stride] = 0.0;
    }
    team
}

fn advance(team: &mut Team) -> Result<(), StepError> {
    team.obey(Command::Advance { steps: 25, tensions: [0.0; 2] })
}

/// Runs a test on a thread of its own and fails if it takes longer than any machine needs.
fn in_bounded_time(test: impl FnOnce() + Send + 'static) {
    let (done, end) = std::sync::mpsc::channel();
    let thread = std::thread::spawn(move || {
        test();
        done.send(()).unwrap();
    });
    let timeout = std::sync::mpsc::RecvTimeoutError::Timeout;
    assert_ne!(end.recv_timeout(Duration::from_secs(60)), Err(timeout), "somebody waits for ever");
    thread.join().unwrap();
}

#[test]
fn the_caller_goes_on_alone_when_a_worker_stalls_and_the_bits_stay() {
    in_bounded_time(|| {
        let helped = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&helped);
        let mut stalling = team(2, move |thread, _| {
            if thread == 0 {
                // Long pieces, so that the worker finds something to do on a busy machine, too.
                std::thread::sleep(Duration::from_micros(20));
            } else if count.fetch_add(1, Ordering::Relaxed).is_multiple_of(40) {
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        // Alone and in company again, three times over.
        let (mut commands, mut changes, mut alone, mut before) = (0, 0, false, 0);
        while changes < 6 {
            advance(&mut stalling).unwrap();
            commands += 1;
            let company = helped.load(Ordering::Relaxed);
            let now = stalling.alone_until.is_some();
            // It counts as company only if the worker has done something since.
            if now != alone && (now || company > before) {
                (alone, before) = (now, company);
                changes += 1;
            }
        }
        let mut one = team(1, |thread, _| assert_eq!(thread, 0));
        for _ in 0..commands {
            advance(&mut one).unwrap();
        }
        assert!(stalling.parts().1 == one.parts().1, "other bits after {commands} commands");
        assert!(one.parts().1.iter().all(|value| value.is_finite()));
    });
}

#[test]
fn when_a_worker_panics_every_command_from_then_on_is_an_error() {
    in_bounded_time(|| {
        for threads in [2, 3, 4] {
            let mut team = team(threads, |thread, _| {
                std::thread::sleep(Duration::from_micros(50));
                assert_ne!(thread, 1, "a worker panics for the sake of a test");
            });
            let mut commands = 0;
            while advance(&mut team).is_ok() {
                commands += 1;
                assert!(commands < 100_000, "the worker never came to work");
            }
            assert_eq!(advance(&mut team), Err(StepError::Poisoned));
            assert_eq!(team.obey(Command::Look { tension: 0.0 }), Err(StepError::Poisoned));
        }
    });
}

#[test]
fn when_the_caller_panics_nobody_is_at_work_any_more() {
    in_bounded_time(|| {
        for threads in 1..=4 {
            let pieces = AtomicUsize::new(0);
            let mut team = team(threads, move |thread, _| {
                if thread == 0 {
                    assert!(
                        pieces.fetch_add(1, Ordering::Relaxed) < 30,
                        "the caller panics for the sake of a test"
                    );
                } else {
                    std::thread::sleep(Duration::from_micros(200));
                }
            });
            let panicked = catch_unwind(AssertUnwindSafe(|| while advance(&mut team).is_ok() {}));
            assert!(panicked.is_err());
            let state = team.parts().1.to_vec();
            std::thread::sleep(Duration::from_millis(2));
            assert!(team.parts().1 == state, "{threads} threads: somebody is at work");
            assert_eq!(advance(&mut team), Err(StepError::Poisoned));
        }
    });
}

#[test]
fn a_team_is_dropped_in_bounded_time_whatever_its_workers_do() {
    in_bounded_time(|| {
        for commands in [0, 1, 50] {
            let mut team = team(4, |_, _| {});
            for _ in 0..commands {
                advance(&mut team).unwrap();
            }
        }
    });
}

/// Repeatable numbers below a bound.
fn draw(seed: &mut u64, below: usize) -> usize {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) as usize % below
}

#[test]
fn the_bits_are_the_same_in_whatever_order_the_pieces_are_done() {
    let run = |tiling: Tiling, mut seed: u64| {
        let plan = plan(60, 48);
        let mut state: Vec<f64> = Vec::new();
        for units in Units::ALL.into_iter().filter(|units| units.available()) {
            let tiles = Tiles::new(plan.clone(), units, tiling.clone());
            let board = Board::new(tiles.bands());
            // SAFETY: there is one thread.
            let values = unsafe { tiles.values().0 };
            for (i, place) in plan.nodes().enumerate() {
                let (column, row) = ((i % 60) as f64, (i / 60) as f64);
                values[place] = column + 0.05 * (0.7 * i as f64).sin();
                values[place + plan.stride] = row + 0.05 * (0.9 * i as f64).cos();
            }
            for steps in [1, 29, 8] {
                let command = Command::Advance { steps, tensions: [0.0; 2] };
                // SAFETY: there is one thread.
                board.ask(unsafe { tiles.begin(command, board.asked()) });
                while board.progress() == Progress::Open {
                    let band = draw(&mut seed, board.len());
                    if let Some(claim) = board.claim_one(band..band + 1, band) {
                        // SAFETY: there is one thread.
                        unsafe { tiles.perform(claim.band, claim.sweeps.clone()) };
                        claim.finish();
                    }
                }
            }
            // SAFETY: there is one thread.
            state.extend(unsafe { &*tiles.values().0 });
        }
        state
    };
    let tiling = |width: usize, depth: usize, starts: &[usize]| Tiling {
        large: depth > 2,
        width,
        depth,
        count: (8 + depth - 1_usize).div_ceil(width),
        starts: starts.to_vec(),
    };
    let whole = run(tiling(9, 2, &[0]), 0);
    assert!(whole.iter().all(|value| value.is_finite()));
    for seed in 0..20 {
        assert!(run(tiling(9, 2, &[0, 7, 9, 30, 33, 40]), seed) == whole, "seed {seed}");
        assert!(run(tiling(3, 3, &[0, 3, 6, 9, 12, 44]), seed) == whole, "seed {seed}, tiles");
        assert!(run(tiling(8, 8, &[0, 8, 16, 24, 32, 40]), seed) == whole, "seed {seed}, deep");
    }
}

#[test]
fn pieces_that_are_under_way_together_do_not_meet() {
    let depth = 3;
    let board = Board::new(7);
    let (mut seed, mut held) = (1, Vec::<Claim<'_>>::new());
    board.ask(200);
    let mut most = 0;
    while board.progress() == Progress::Open {
        if draw(&mut seed, 16) == 0 && !held.is_empty() {
            let index = draw(&mut seed, held.len());
            held.swap_remove(index).finish();
        }
        let band = draw(&mut seed, board.len());
        held.extend(board.claim_one(band..band + 1, band));
        most = most.max(held.len());
        for (a, b) in held.iter().flat_map(|a| held.iter().map(move |b| (a, b))) {
            if a.band < b.band {
                // A band is `depth` fronts: a touches the rows up to the first front of the band
                // above, b those from `depth - 1` below its own first front.
                assert!((a.band + 1) * depth < b.band * depth - (depth - 1));
                assert!(a.sweeps.start > b.sweeps.start, "the upper band is never ahead");
                assert_ne!(a.sweeps.start as usize % 7, b.sweeps.start as usize % 7, "one carry");
            }
        }
    }
    assert_eq!(most, 4, "as many as fit at a time have been at work together");
}

#[test]
fn bands_are_of_like_work_and_at_least_a_sweep_deep() {
    for (columns, rows) in [(100, 20), (320, 64), (1000, 200), (2000, 9), (9, 1000)] {
        let plan = plan(columns, rows);
        for threads in 1..=5 {
            let Tiling { depth, starts, .. } = Tiling::new(&plan, threads);
            let heights: Vec<usize> = starts
                .iter()
                .zip(starts.iter().skip(1).chain([&rows]))
                .map(|(start, end)| end - start)
                .collect();
            assert!(starts.len() == 1 || *heights.iter().min().unwrap() >= depth, "{heights:?}");
            let spread = heights.iter().max().unwrap() - heights.iter().min().unwrap();
            assert!(spread <= depth.max(2), "{columns} x {rows}, {threads}: {heights:?}");
            assert!(threads > 1 || starts == [0]);
        }
    }
}
