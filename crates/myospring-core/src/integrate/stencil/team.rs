//! Threads that move one lattice together, and continue when one of them is suspended.
//!
//! The calling thread gives commands and does all work that the workers do not do; workers only
//! help. Each thread searches available bands in its own part of the lattice, which stays in its
//! cache, and takes bands of others after waiting. So a suspended worker costs nothing, unless it
//! has begun a piece that others need. If the caller waits longer than such a piece can take, it
//! works alone for some time before it lets the workers help again. No thread spins for long.
//!
//! A panic breaks the bands (see `bands.rs`): all threads stop, and every later command fails.

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

/// Time for which a thread waits without sleeping: a sleeping thread reacts late, a spinning one
/// occupies a core.
const AWAKE: Duration = Duration::from_micros(100);

/// Duration of one sleep while waiting.
const NAP: Duration = Duration::from_micros(50);

/// Time for which a thread waits before it takes bands from another thread's part.
const PATIENCE: Duration = Duration::from_micros(5);

/// If the caller waits for a worker longer than this and three times its own pieces, the worker
/// counts as suspended.
const GRACE: Duration = Duration::from_micros(200);

/// After waiting for a suspended worker, the caller works alone for this many times as long, so
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
    /// Starts threads for a lattice in the state [`Plan::vacant`].
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
        // Works with fewer threads if the system does not start all of them.
        let workers = (1..shared.threads).map_while(|index| worker(index).ok()).collect();
        Self { shared, workers, alone_until: None }
    }

    /// Number of threads, including the calling one.
    pub(super) fn threads(&self) -> usize {
        self.workers.len() + 1
    }

    /// The plan, the state in rows as [`Plan`] lays them out, and the velocities at the full step
    /// from the last [`Command::Look`], by row.
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

    /// Lets the caller work alone from now on if this wait, after `pieces` pieces of the command,
    /// was too long.
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
            // If it has panicked, its command has reported that.
            let _ = worker.join();
        }
    }
}

impl Shared {
    /// The main loop of a worker.
    fn serve(&self, index: usize) {
        loop {
            self.help(index);
            // Checked after any nap in there, which may have consumed the wake-up call for
            // quitting.
            if self.quit.load(Ordering::Acquire) {
                return;
            }
            // A thread with news unparks this one after publishing it, so parking always ends.
            std::thread::park();
        }
    }

    /// Works until there has been nothing to do for some time.
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

    /// The bands of a thread's own part.
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

/// Ensures that no thread is working when a command ends early.
struct Closing<'a>(&'a Board);

impl Drop for Closing<'_> {
    fn drop(&mut self) {
        self.0.close(|| std::thread::park_timeout(NAP));
    }
}

/// A wait, spinning at first, then sleeping in short intervals.
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
