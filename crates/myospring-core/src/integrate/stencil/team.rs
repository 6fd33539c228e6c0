//! Threads that move one lattice together, and go on when one of them does not.
//!
//! The caller gives commands and does all of the work that nobody else does; the workers only help. Each
//! thread looks for free bands in a part of the lattice of its own, which stays in its cache, and takes
//! others' if it has waited. So a worker that does not run costs nothing, unless it has begun a piece
//! that the rest needs. The caller then notices that it waits for longer than such a piece can take, and
//! works alone for some time before it lets the workers help again: on a busy machine they take little
//! from it. Nobody waits by spinning for long.
//!
//! A panic breaks the bands (see `bands.rs`): all threads let go, and every command from then on fails.

use super::bands::{Board, Claim, Progress};
use super::lanes::Units;
use super::plan::Plan;
use super::tiles::{Command, Tiles, Tiling};
use crate::integrate::stepper::StepError;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How long a thread waits awake: a waiter that sleeps comes late, one that is awake takes a core.
const AWAKE: Duration = Duration::from_micros(100);

/// How long a waiter sleeps at a time.
const NAP: Duration = Duration::from_micros(50);

/// How long a thread waits before it takes bands from the part of another.
const PATIENCE: Duration = Duration::from_micros(5);

/// A wait for a worker beyond this and three times the caller's own pieces means that it does not run.
const GRACE: Duration = Duration::from_micros(200);

/// The caller works alone for as many times as long as it has waited for a worker that did not run, so
/// that such waits take a small part of its time.
const SOLITUDE: u32 = 16;

/// What the threads share.
struct Shared {
    tiles: Tiles,
    board: Board,
    threads: usize,
    /// Whether the workers may help.
    invited: AtomicBool,
    /// Whether the workers are to end.
    quit: AtomicBool,
    #[cfg(test)]
    hook: Option<tests::Hook>,
}

/// Threads that step one lattice.
pub(super) struct Team {
    shared: Arc<Shared>,
    workers: Vec<JoinHandle<()>>,
    /// When the workers may help again.
    alone_until: Option<Instant>,
}

impl Team {
    /// The state is that of [`Plan::vacant`] until it is written.
    pub(super) fn new(plan: Plan, units: Units, threads: usize) -> Self {
        let tiling = Tiling::new(&plan, threads.max(1));
        // With a single band each, threads could only take turns.
        let threads = threads.clamp(1, (tiling.starts.len() / 2).max(1));
        let tiles = Tiles::new(plan, units, tiling);
        Self::at_work(Shared {
            board: Board::new(tiles.bands()),
            tiles,
            threads,
            invited: AtomicBool::new(true),
            quit: AtomicBool::new(false),
            #[cfg(test)]
            hook: None,
        })
    }

    fn at_work(shared: Shared) -> Self {
        let shared = Arc::new(shared);
        let worker = |index| {
            let shared = Arc::clone(&shared);
            std::thread::Builder::new().spawn(move || shared.serve(index))
        };
        // A thread that the system does not give is one that does not run.
        let workers = (1..shared.threads).map_while(|index| worker(index).ok()).collect();
        Self { shared, workers, alone_until: None }
    }

    /// Number of threads at work, this one included.
    pub(super) fn threads(&self) -> usize {
        self.workers.len() + 1
    }

    /// The plan, the state in rows as [`Plan`] lays them out, and the velocities at the full step that
    /// the last [`Command::Look`] has seen: x and y by row.
    pub(super) fn parts(&mut self) -> (&Plan, &mut [f64], &[f64]) {
        let tiles = &self.shared.tiles;
        // SAFETY: `&mut self`, and no thread is at work between commands.
        let (state, seen) = unsafe { tiles.values() };
        (&tiles.plan, state, seen)
    }

    /// # Errors
    /// If a thread panics, or has panicked before.
    pub(super) fn obey(&mut self, command: Command) -> Result<(), StepError> {
        let shared = Arc::clone(&self.shared);
        let closing = Closing(&shared.board);
        let first = shared.board.asked();
        // SAFETY: `&mut self`, and no thread is at work between commands.
        let sweeps = unsafe { shared.tiles.begin(command, first) };
        shared.board.ask(sweeps);
        if self.alone_until.is_none() {
            self.wake();
        }
        self.lead()?;
        std::mem::forget(closing);
        Ok(())
    }

    fn wake(&self) {
        for worker in &self.workers {
            worker.thread().unpark();
        }
    }

    /// Works until the command is done.
    fn lead(&mut self) -> Result<(), StepError> {
        let shared = Arc::clone(&self.shared);
        let begun = (!self.workers.is_empty()).then(Instant::now);
        let (mut next, mut pieces) = (0, 0);
        let mut wait = Wait::default();
        loop {
            self.invite();
            let alone = self.alone_until.is_some() || wait.lasted > PATIENCE;
            let part = if alone { 0..shared.board.len() } else { shared.part(0) };
            if let Some(claim) = shared.board.claim_one(part, next) {
                self.judge(wait, begun, pieces);
                wait = Wait::default();
                next = claim.band + 1;
                pieces += 1;
                shared.perform(0, claim);
                continue;
            }
            match shared.board.progress() {
                Progress::Finished => {
                    self.judge(wait, begun, pieces);
                    return Ok(());
                }
                Progress::Broken => return Err(StepError::Poisoned),
                Progress::Open => wait.turn(),
            }
        }
    }

    /// Works alone from now on if this wait, after so many pieces of the command, was too long.
    fn judge(&mut self, Wait { lasted, .. }: Wait, begun: Option<Instant>, pieces: u32) {
        if let Some(begun) = begun
            && lasted > GRACE
        {
            let piece = begun.elapsed().saturating_sub(lasted) / pieces.max(1);
            if lasted > GRACE + 3 * piece {
                self.alone_until = Some(Instant::now() + SOLITUDE * lasted);
                self.shared.invited.store(false, Ordering::Relaxed);
            }
        }
    }

    /// Lets the workers help again when it is time.
    fn invite(&mut self) {
        if self.alone_until.is_some_and(|until| Instant::now() >= until) {
            self.alone_until = None;
            self.shared.invited.store(true, Ordering::Relaxed);
            self.wake();
        }
    }
}

impl Drop for Team {
    fn drop(&mut self) {
        self.shared.quit.store(true, Ordering::Release);
        self.wake();
        for worker in self.workers.drain(..) {
            // If it has panicked, the command that it was at has said so.
            let _ = worker.join();
        }
    }
}

impl Shared {
    /// The life of a worker.
    fn serve(&self, index: usize) {
        loop {
            self.help(index);
            // Looked at after any nap in there, which may have taken the call of who wants it to end.
            if self.quit.load(Ordering::Acquire) {
                return;
            }
            // Whoever has something new unparks after saying so: before or after this, it ends.
            std::thread::park();
        }
    }

    /// Takes part until there has been nothing to do for a while.
    fn help(&self, index: usize) {
        let everything = 0..self.board.len();
        let mut next = 0;
        let mut wait = Wait::default();
        while self.invited.load(Ordering::Relaxed) && !self.quit.load(Ordering::Relaxed) {
            let part = if wait.lasted > PATIENCE { everything.clone() } else { self.part(index) };
            if let Some(claim) = self.board.claim_one(part, next) {
                wait = Wait::default();
                next = claim.band + 1;
                self.perform(index, claim);
            } else if wait.lasted > AWAKE && self.board.progress() != Progress::Open {
                return;
            } else {
                wait.turn();
            }
        }
    }

    /// The bands that a thread does if it can.
    fn part(&self, index: usize) -> Range<usize> {
        let start = |index: usize| index * self.board.len() / self.threads;
        start(index)..start(index + 1)
    }

    #[cfg_attr(not(test), expect(unused_variables, reason = "for tests to see"))]
    fn perform(&self, thread: usize, claim: Claim<'_>) {
        #[cfg(test)]
        if let Some(hook) = &self.hook {
            hook(thread, &claim);
        }
        // SAFETY: the claim says that the piece is this thread's.
        unsafe { self.tiles.perform(claim.band, claim.sweeps.clone()) };
        claim.finish();
    }
}

/// Sees to it that nobody is at work when a command ends early.
struct Closing<'a>(&'a Board);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.close(|| std::thread::park_timeout(NAP));
    }
}

/// A wait, awake at first, then asleep a little at a time.
#[derive(Debug, Clone, Copy, Default)]
struct Wait {
    since: Option<Instant>,
    lasted: Duration,
}

impl Wait {
    /// Waits a little.
    fn turn(&mut self) {
        let since = *self.since.get_or_insert_with(Instant::now);
        if self.lasted > AWAKE {
            std::thread::park_timeout(NAP);
        } else {
            for _ in 0..8 {
                std::hint::spin_loop();
            }
        }
        self.lasted = since.elapsed();
    }
}

#[cfg(test)]
mod tests;
