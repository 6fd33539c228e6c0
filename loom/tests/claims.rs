//! What must hold of the claims, whatever the threads do when.

use loom::cell::UnsafeCell;
// In place of that of the standard library.
use loom::sync::atomic;
use loom::thread;
use std::sync::Arc;

#[allow(dead_code)]
#[path = "../../crates/myospring-core/src/integrate/stencil/bands.rs"]
mod bands;

use bands::{Board, Claim, Progress};

/// A board, and for each band how often it was swept.
struct Lattice {
    board: Board,
    rows: Vec<UnsafeCell<u64>>,
}

// SAFETY: loom reports two threads at one row.
unsafe impl Sync for Lattice {}
// SAFETY: as above.
unsafe impl Send for Lattice {}

impl Lattice {
    fn of(bands: usize) -> Arc<Self> {
        let rows = (0..bands).map(|_| UnsafeCell::new(0)).collect();
        Arc::new(Self { board: Board::new(bands), rows })
    }

    fn row(&self, band: usize) -> u64 {
        // SAFETY: loom reports a thread that writes it.
        self.rows[band].with(|row| unsafe { *row })
    }

    /// Sweeps the band of a claim, which reads both neighbours, as a piece of the lattice does.
    fn perform(&self, claim: Claim<'_>) {
        let (band, sweep) = (claim.band, claim.sweeps.start);
        if band > 0 {
            assert!(self.row(band - 1) > sweep, "the band below is behind");
        }
        if band + 1 < self.rows.len() {
            assert!(self.row(band + 1) >= sweep, "the band above is behind");
        }
        self.rows[band].with_mut(|row| {
            // SAFETY: loom reports any other thread at it.
            let row = unsafe { &mut *row };
            assert_eq!(*row, sweep, "a sweep was made twice or left out");
            *row = claim.sweeps.end;
        });
        claim.finish();
    }

    /// Helps until a number of looks found nothing.
    fn help(&self, looks: usize) {
        for _ in 0..looks {
            while let Some(claim) = self.board.claim_one(0..self.board.len(), 0) {
                self.perform(claim);
            }
            thread::yield_now();
        }
    }

    /// Works until all is done or broken.
    fn lead(&self) -> Progress {
        loop {
            if let Some(claim) = self.board.claim_one(0..self.board.len(), 0) {
                self.perform(claim);
                continue;
            }
            match self.board.progress() {
                Progress::Open => thread::yield_now(),
                end => return end,
            }
        }
    }

    /// All rows, which nobody else may have.
    fn all(&self) -> Vec<u64> {
        // SAFETY: loom reports any other thread at them.
        self.rows.iter().map(|row| row.with_mut(|row| unsafe { *row })).collect()
    }
}

/// Runs the threads in every order of their steps. A running thread is interrupted at most so many times.
fn in_every_order(interruptions: usize, of: impl Fn() + Sync + Send + 'static) {
    let mut builder = loom::model::Builder::new();
    builder.preemption_bound = Some(interruptions);
    builder.check(of);
}

fn all_is_swept(bands: usize, sweeps: u64, workers: usize) {
    let lattice = Lattice::of(bands);
    lattice.board.ask(sweeps);
    let helpers: Vec<_> = (0..workers)
        .map(|_| {
            let lattice = Arc::clone(&lattice);
            thread::spawn(move || lattice.help(1))
        })
        .collect();
    assert_eq!(lattice.lead(), Progress::Finished);
    // What the next command does before it asks: nobody else is at the rows, though workers still look.
    assert_eq!(lattice.all(), vec![sweeps; bands]);
    helpers.into_iter().for_each(|helper| helper.join().unwrap());
}

#[test]
fn two_threads_sweep_all_bands_once_each_time() {
    in_every_order(3, || all_is_swept(3, 2, 1));
}

#[test]
fn three_threads_sweep_all_bands_once_each_time() {
    in_every_order(2, || all_is_swept(2, 1, 2));
}

#[test]
fn a_second_command_finds_what_the_first_has_left() {
    in_every_order(3, || {
        let lattice = Lattice::of(2);
        lattice.board.ask(1);
        let helper = Arc::clone(&lattice);
        let helper = thread::spawn(move || helper.help(2));
        for sweeps in 1..=2 {
            assert_eq!(lattice.lead(), Progress::Finished);
            assert_eq!(lattice.all(), vec![sweeps; 2]);
            if sweeps == 1 {
                lattice.board.ask(1);
            }
        }
        helper.join().unwrap();
    });
}

#[test]
fn a_panic_stops_all_and_nobody_is_at_work_after_it() {
    in_every_order(3, || {
        let lattice = Lattice::of(3);
        lattice.board.ask(2);
        let helper = Arc::clone(&lattice);
        let helper = thread::spawn(move || {
            // A piece that panics drops its claim; this thread then ends.
            if let Some(claim) = helper.board.claim_one(0..3, 0) {
                drop(claim);
            }
        });
        let end = lattice.lead();
        lattice.board.close(thread::yield_now);
        let rows = lattice.all();
        assert!(end == Progress::Broken || rows == [2; 3], "{end:?}, {rows:?}");
        assert!(lattice.board.claim_one(0..3, 0).is_none());
        helper.join().unwrap();
    });
}

#[test]
fn a_command_that_ends_early_leaves_nobody_at_work() {
    in_every_order(3, || {
        let lattice = Lattice::of(3);
        lattice.board.ask(2);
        let helper = Arc::clone(&lattice);
        let helper = thread::spawn(move || helper.help(2));
        lattice.board.close(thread::yield_now);
        // Whatever was swept, nobody is at it now or later.
        lattice.all();
        assert_eq!(lattice.board.progress(), Progress::Broken);
        helper.join().unwrap();
    });
}
