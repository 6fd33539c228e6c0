//! Who does what: the fronts of a sweep are cut into bands, and threads claim them.
//!
//! A band of a sweep may be done as soon as the band below has done the same sweep and the band above
//! the sweep before. So several bands are free at a time, each in a sweep of its own:
//!
//! ```text
//! bands
//!   ^     3 | . . . .          sweeps done or under way: band 0 is two sweeps ahead of band 3
//!   |     2 | # . . .          # under way, each by one thread; none waits for the other
//!   |     1 | # # . .
//!   |     0 | # # # .   > sweeps
//! ```
//!
//! Nothing belongs to a thread for good: whoever finds a band free may take it, so a thread that the
//! system does not let run holds up the others by the one piece that it has begun, if any.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Twice the number of sweeps that a band has done, and one more while a thread is at the next; or
/// [`BROKEN`]. It has a cache line of its own.
#[repr(align(128))]
struct Band(AtomicU64);

/// Nobody gets this band any more. Odd, as if somebody had it for ever.
const BROKEN: u64 = u64::MAX;

/// The bands of a lattice and how far each is.
pub(super) struct Board {
    bands: Vec<Band>,
    /// Sweeps asked for so far.
    asked: AtomicU64,
}

/// How far the sweeps asked for are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Progress {
    Finished,
    Open,
    Broken,
}

/// A piece of work that its holder alone does; broken if it is dropped before [`Claim::finish`].
pub(super) struct Claim<'a> {
    state: &'a AtomicU64,
    pub(super) band: usize,
    pub(super) sweeps: Range<u64>,
}

impl Claim<'_> {
    pub(super) fn finish(self) {
        self.state.store(2 * self.sweeps.end, Ordering::Release);
        std::mem::forget(self);
    }
}

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        self.state.store(BROKEN, Ordering::Release);
    }
}

impl Board {
    pub(super) fn new(bands: usize) -> Self {
        let bands = (0..bands).map(|_| Band(AtomicU64::new(0))).collect();
        Self { bands, asked: AtomicU64::new(0) }
    }

    pub(super) fn len(&self) -> usize {
        self.bands.len()
    }

    /// Sweeps asked for so far: the number of the next.
    pub(super) fn asked(&self) -> u64 {
        self.asked.load(Ordering::Acquire)
    }

    /// Lets bands be claimed for so many sweeps more.
    pub(super) fn ask(&self, sweeps: u64) {
        self.asked.fetch_add(sweeps, Ordering::Release);
    }

    /// Sweeps that a band has done; none if it is broken, so that nobody builds on it.
    fn done(&self, band: usize) -> u64 {
        match self.bands[band].0.load(Ordering::Acquire) {
            BROKEN => 0,
            state => state / 2,
        }
    }

    /// A band, if its next sweep is asked for, its neighbours are far enough and nobody has it. One that
    /// has no neighbours is free for all sweeps that are asked for.
    fn claim(&self, band: usize) -> Option<Claim<'_>> {
        let state = &self.bands[band].0;
        let seen = state.load(Ordering::Acquire);
        let (sweep, asked) = (seen / 2, self.asked());
        let free = seen.is_multiple_of(2)
            && sweep < asked
            && (band == 0 || self.done(band - 1) > sweep)
            && (band + 1 == self.len() || self.done(band + 1) >= sweep);
        let taken = free
            && state.compare_exchange(seen, seen + 1, Ordering::AcqRel, Ordering::Relaxed).is_ok();
        // Made only if taken: a claim that is dropped breaks the band.
        let end = if self.len() == 1 { asked } else { sweep + 1 };
        taken.then(|| Claim { state, band, sweeps: sweep..end })
    }

    /// Any band of a range, looked for from `first` on and around.
    pub(super) fn claim_one(&self, range: Range<usize>, first: usize) -> Option<Claim<'_>> {
        let first = first.clamp(range.start, range.end);
        (first..range.end).chain(range.start..first).find_map(|band| self.claim(band))
    }

    pub(super) fn progress(&self) -> Progress {
        let end = 2 * self.asked();
        let states = self.bands.iter().map(|band| band.0.load(Ordering::Acquire));
        states.fold(Progress::Finished, |progress, state| match (progress, state) {
            (Progress::Broken, _) | (_, BROKEN) => Progress::Broken,
            (Progress::Finished, state) if state == end => Progress::Finished,
            _ => Progress::Open,
        })
    }

    /// Breaks every band, for good. One that a thread has is waited for by `wait`, so that nobody is at
    /// work on return.
    pub(super) fn close(&self, wait: impl Fn()) {
        for Band(state) in &self.bands {
            let mut seen = state.load(Ordering::Acquire);
            while seen != BROKEN {
                if seen % 2 == 1 {
                    wait();
                    seen = state.load(Ordering::Acquire);
                    continue;
                }
                seen = state
                    .compare_exchange(seen, BROKEN, Ordering::AcqRel, Ordering::Acquire)
                    .map_or_else(|other| other, |_| BROKEN);
            }
        }
    }
}
