//! Distribution of work: a sweep is divided into bands, which threads claim.
//!
//! A band may be swept as soon as the band below has completed the same sweep and the band above
//! the previous one. So several bands are available at a time, each in a different sweep:
//!
//! ```text
//! bands
//!   ^     3 | . . . .          sweeps done or under way: band 0 is two sweeps ahead of band 3
//!   |     2 | # . . .          # under way, each by one thread; none waits for the other
//!   |     1 | # # . .
//!   |     0 | # # # .   > sweeps
//! ```
//!
//! Bands are not assigned to threads: any thread may take an available band, so a thread that the
//! system suspends delays the others by at most the one piece that it has begun.

use super::atomic::{AtomicU64, Ordering};
use std::ops::Range;

/// Twice the number of completed sweeps of a band, plus one while a thread works on the next; or
/// [`BROKEN`]. It has its own cache line.
#[repr(align(128))]
struct Band(AtomicU64);

/// The band can no longer be claimed. The value is odd, as for a band in work.
const BROKEN: u64 = u64::MAX;

/// The bands of a lattice and their progress.
pub(super) struct Board {
    bands: Vec<Band>,
    /// Number of requested sweeps.
    asked: AtomicU64,
}

/// Progress of the requested sweeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Progress {
    Finished,
    Open,
    Broken,
}

/// A claimed piece of work; the band is broken if it is dropped before [`Claim::finish`].
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

    /// Number of requested sweeps.
    pub(super) fn asked(&self) -> u64 {
        self.asked.load(Ordering::Acquire)
    }

    /// Requests `sweeps` further sweeps.
    pub(super) fn ask(&self, sweeps: u64) {
        self.asked.fetch_add(sweeps, Ordering::Release);
    }

    /// Number of completed sweeps of a band; 0 if it is broken, so that its neighbours wait.
    fn done(&self, band: usize) -> u64 {
        match self.bands[band].0.load(Ordering::Acquire) {
            BROKEN => 0,
            state => state / 2,
        }
    }

    /// Claims a band, if its next sweep is requested, its neighbours are far enough and no thread
    /// works on it. A band without neighbours can be claimed for all requested sweeps.
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
        // Made only if the band was taken, since dropping a claim breaks the band.
        let end = if self.len() == 1 { asked } else { sweep + 1 };
        taken.then(|| Claim { state, band, sweeps: sweep..end })
    }

    /// Claims any available band of a range, searched from `first` on, cyclically.
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

    /// Breaks every band permanently. Waits for bands in work by calling `wait`, so that no thread
    /// is working on return.
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
