//! Many steps in one sweep, on one thread or several, with the same bits.
//!
//! The lattice is cut into **tiles** of some blocks' width over all rows. A tile makes several steps in
//! one sweep: each step trails the one before it by a row and stands one block further to the left, so
//! that what it needs of the step before is there and what the step before needs is still old:
//!
//! ```text
//! rows         tile k     tile k+1
//!  ^       . . . . . . . . . . . .
//!  |    step 0 |0 0 0 0|0 0 0 0|         front: step 0 in row j,
//!  |  step 1 |1 1 1 1|1 1 1 1|                  step 1 in row j - 1,
//!  |step 2 |2 2 2 2|2 2 2 2|                    step 2 in row j - 2
//! ```
//!
//! A tile's window of rows stays in the second-level cache, so a large mesh comes from memory once for
//! several steps. Tile k + 1 may do a front as soon as tile k has done it, and the next sweep may start
//! on tile k when tile k + 1 is some rows ahead: threads take the tiles in turns, each counts its fronts
//! in a number that the others read, and they follow each other without ever stopping together. Every
//! force is computed once, from the same values in the same order whatever the tiles: hence the same
//! bits.

#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, Avx512};
use super::lanes::{Lanes, Portable, Units};
use super::plan::{BLOCK, Block, Plan};
use super::sweep::{Handover, Row, laws, pass, purpose};
use std::cell::UnsafeCell;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread::JoinHandle;

/// Turns of a waiting loop before the thread gives its core to others.
const SPINS: u32 = 20000;

/// Bytes that a tile's window of rows may take: three quarters of a second-level cache of 1 MiB.
const CACHE: usize = 3 << 18;

/// Steps that share a sweep of a large mesh.
const DEEP: usize = 8;

/// What all threads are asked to do.
#[derive(Debug, Clone, Copy)]
enum Command {
    /// Steps under a tension that goes linearly from the first to the second value, kPa; the forces
    /// of the last step are not at the second value but one step before.
    Advance {
        steps: usize,
        tensions: [f64; 2],
    },
    /// Velocities at the full step under this tension, kPa.
    Look {
        tension: f64,
    },
    Quit,
}

/// Memory that threads write through its pointer, each its own part.
struct Buffer {
    start: *mut f64,
    len: usize,
    _owner: Vec<Block>,
}

impl Buffer {
    fn new(mut blocks: Vec<Block>) -> Self {
        let (start, len) = (blocks.as_mut_ptr().cast(), blocks.len() * BLOCK);
        Self { start, len, _owner: blocks }
    }

    fn zeros(values: usize) -> Self {
        Self::new(vec![Block::ZERO; values / BLOCK])
    }

    /// All of it.
    ///
    /// # Safety
    /// Nobody else reads or writes it meanwhile.
    #[allow(
        clippy::mut_from_ref,
        reason = "the owner of the team vouches that no thread is at work"
    )]
    unsafe fn values(&self) -> &mut [f64] {
        // SAFETY: the owner lives as long as this, and a Block is BLOCK values without padding.
        unsafe { std::slice::from_raw_parts_mut(self.start, self.len) }
    }
}

/// How the lattice is cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tiling {
    /// Blocks in a tile.
    pub(super) width: usize,
    /// Steps in a sweep.
    pub(super) depth: usize,
    /// Number of tiles.
    pub(super) count: usize,
}

impl Tiling {
    /// A mesh that fits the cache is one tile a thread; a larger one has tiles that fit.
    fn new(plan: &Plan, threads: usize) -> Self {
        let blocks = plan.blocks;
        let state = 4 * size_of::<Block>();
        let records = size_of_val(&plan.records[..]) / (plan.rows * blocks);
        let fits = plan.rows * blocks * (state + records) <= CACHE;
        let depth = if fits { 2 } else { DEEP };
        let in_cache = CACHE / ((depth + 2) * (state + records));
        let widest = (blocks + depth - 1).div_ceil(threads);
        let width = if fits { widest } else { widest.min(in_cache) }.max(depth);
        Self { width, depth, count: (blocks + depth - 1).div_ceil(width) }
    }
}

/// What the threads share.
struct Shared {
    plan: Plan,
    units: Units,
    tiling: Tiling,
    state: Buffer,
    /// Velocities at the full step, x and y by row.
    seen: Buffer,
    /// Carried forces, by thread and step of a sweep: x and y.
    carries: Vec<Buffer>,
    /// By tile, step of a sweep and row.
    handovers: Vec<UnsafeCell<Handover>>,
    command: UnsafeCell<Command>,
    /// Number of the present command.
    epoch: AtomicU64,
    /// Workers that have not yet finished it.
    busy: AtomicUsize,
    /// Fronts that each tile has done in the present command, over all sweeps.
    fronts: Vec<Progress>,
}

/// A counter with a cache line of its own.
#[repr(align(128))]
struct Progress(AtomicUsize);

// SAFETY: `command` is written by the owner while no worker is busy. A thread writes its own carries.
// A tile is swept by one thread at a time; it writes its blocks of `state` and `seen` and its
// `handovers` only when `fronts` (release, acquire) says that the tiles on both sides have read what
// they need of the old values, and reads theirs only when they are there; see `Worker::sweep`.
unsafe impl Sync for Shared {}
// SAFETY: plain data and atomics.
unsafe impl Send for Shared {}

/// Threads that step one lattice.
pub(super) struct Team {
    shared: Arc<Shared>,
    workers: Vec<JoinHandle<()>>,
}

impl Team {
    /// The state is that of [`Plan::vacant`] until it is written.
    pub(super) fn new(plan: Plan, units: Units, threads: usize) -> Self {
        assert!(units.available(), "{units:?} is not available on this processor");
        // A tile narrower than two blocks is more handing over than work.
        let threads = threads.clamp(1, (plan.blocks / 2).max(1));
        Self::tiled(plan, units, threads, None)
    }

    /// As [`Team::new`], cut as asked.
    pub(super) fn tiled(plan: Plan, units: Units, threads: usize, tiling: Option<Tiling>) -> Self {
        let tiling = tiling.unwrap_or_else(|| Tiling::new(&plan, threads));
        let count = threads.min(tiling.count);
        let handovers = tiling.count * tiling.depth * plan.rows;
        let shared = Arc::new(Shared {
            units,
            tiling,
            state: Buffer::new(plan.vacant.clone()),
            seen: Buffer::zeros(plan.vacant.len() * BLOCK / 2),
            carries: (0..count).map(|_| Buffer::zeros(tiling.depth * 2 * plan.stride)).collect(),
            handovers: (0..handovers).map(|_| UnsafeCell::new([0.0; 4])).collect(),
            command: UnsafeCell::new(Command::Quit),
            epoch: AtomicU64::new(0),
            busy: AtomicUsize::new(0),
            fronts: (0..tiling.count).map(|_| Progress(AtomicUsize::new(0))).collect(),
            plan,
        });
        let workers = (1..count)
            .map(|index| {
                let shared = Arc::clone(&shared);
                std::thread::spawn(move || shared.serve(index))
            })
            .collect();
        Self { shared, workers }
    }

    /// Number of threads at work, this one included.
    pub(super) fn threads(&self) -> usize {
        self.workers.len() + 1
    }

    /// The plan, the state in rows as [`Plan`] lays them out, and the velocities at the full step that
    /// the last [`Team::look`] has seen: x and y by row.
    pub(super) fn parts(&mut self) -> (&Plan, &mut [f64], &[f64]) {
        let shared = &*self.shared;
        // SAFETY: `&mut self`, and no worker is busy between commands.
        unsafe { (&shared.plan, shared.state.values(), shared.seen.values()) }
    }

    pub(super) fn advance(&mut self, steps: usize, tensions: [f64; 2]) {
        self.command(Command::Advance { steps, tensions });
    }

    pub(super) fn look(&mut self, tension: f64) {
        self.command(Command::Look { tension });
    }

    fn command(&mut self, command: Command) {
        let shared = &*self.shared;
        // SAFETY: `&mut self` and no worker is busy between commands.
        unsafe { *shared.command.get() = command };
        shared.busy.store(self.workers.len(), Ordering::Relaxed);
        for fronts in &shared.fronts {
            fronts.0.store(0, Ordering::Relaxed);
        }
        shared.epoch.fetch_add(1, Ordering::Release);
        for worker in &self.workers {
            worker.thread().unpark();
        }
        shared.obey(0, command);
        wait_until(|| shared.busy.load(Ordering::Acquire) == 0);
    }
}

impl Drop for Team {
    fn drop(&mut self) {
        self.command(Command::Quit);
        for worker in self.workers.drain(..) {
            // A worker has nothing to say and cannot fail.
            let _ = worker.join();
        }
    }
}

fn wait_until(condition: impl Fn() -> bool) {
    let mut turns = 0;
    while !condition() {
        turns += 1;
        if turns > SPINS {
            std::thread::yield_now();
        }
    }
}

impl Shared {
    /// The life of a worker.
    fn serve(&self, index: usize) {
        let mut epoch = 0;
        loop {
            let mut turns = 0;
            while self.epoch.load(Ordering::Acquire) == epoch {
                turns += 1;
                if turns < SPINS {
                    std::hint::spin_loop();
                } else {
                    std::thread::park();
                }
            }
            epoch += 1;
            // SAFETY: written before the epoch was, and not again before this worker is done.
            let command = unsafe { *self.command.get() };
            self.obey(index, command);
            self.busy.fetch_sub(1, Ordering::Release);
            if let Command::Quit = command {
                return;
            }
        }
    }

    fn obey(&self, index: usize, command: Command) {
        // SAFETY: `units` are available, see `Team::new`; each index is obeyed by one thread.
        match self.units {
            #[cfg(target_arch = "x86_64")]
            Units::Avx512 => unsafe { obey_avx512(self, index, command) },
            #[cfg(target_arch = "x86_64")]
            Units::Avx2 => unsafe { obey_avx2(self, index, command) },
            _ => unsafe { obey_with_laws::<Portable>(self, index, command) },
        }
    }
}

/// # Safety
/// The processor has AVX-512F; one thread for each index.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
unsafe fn obey_avx512(shared: &Shared, index: usize, command: Command) {
    // SAFETY: as above.
    unsafe { obey_with_laws::<Avx512>(shared, index, command) }
}

/// # Safety
/// The processor has AVX2 and FMA; one thread for each index.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn obey_avx2(shared: &Shared, index: usize, command: Command) {
    // SAFETY: as above.
    unsafe { obey_with_laws::<Avx2>(shared, index, command) }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn obey_with_laws<L: Lanes>(shared: &Shared, index: usize, command: Command) {
    const A: u8 = laws::AREA;
    const F: u8 = laws::FIBRE;
    const N: u8 = laws::ANCHORS;
    // SAFETY: the caller's.
    unsafe {
        match shared.plan.laws {
            0 => obey::<L, 0>(shared, index, command),
            A => obey::<L, A>(shared, index, command),
            F => obey::<L, F>(shared, index, command),
            3 => obey::<L, { A | F }>(shared, index, command),
            // With anchors the rare combinations share a kernel; absent laws have no coefficients.
            _ => obey::<L, { A | F | N }>(shared, index, command),
        }
    }
}

/// One thread's part of a command.
///
/// # Safety
/// The processor has the features of `L`; one thread for each index.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn obey<L: Lanes, const LAWS: u8>(shared: &Shared, index: usize, command: Command) {
    let worker = Worker { shared, index };
    // SAFETY: the caller's.
    unsafe {
        match command {
            Command::Quit => {}
            Command::Advance { steps, tensions } => {
                let slope = (tensions[1] - tensions[0]) / steps as f64;
                let tension = |step: usize| tensions[0] + slope * step as f64;
                worker.work::<L, LAWS, { purpose::MOVE }>(steps, tension);
            }
            Command::Look { tension } => {
                worker.work::<L, LAWS, { purpose::LOOK }>(1, |_| tension);
            }
        }
    }
}

/// One of the threads.
struct Worker<'a> {
    shared: &'a Shared,
    index: usize,
}

#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl Worker<'_> {
    /// This thread's tiles of all sweeps.
    #[inline(always)]
    unsafe fn work<L: Lanes, const LAWS: u8, const PURPOSE: u8>(
        &self,
        steps: usize,
        tension: impl Fn(usize) -> f64,
    ) {
        let Tiling { depth, count, .. } = self.shared.tiling;
        let total = steps.div_ceil(depth) * count;
        for turn in (self.index..total).step_by(self.shared.carries.len()) {
            let (sweep, tile) = (turn / count, turn % count);
            let first = sweep * depth;
            let steps = depth.min(steps - first);
            // SAFETY: turns are taken in order, each by one thread.
            unsafe {
                self.sweep::<L, LAWS, PURPOSE>(sweep, tile, steps, |step| tension(first + step));
            }
        }
    }

    /// One tile of one sweep.
    #[inline(always)]
    unsafe fn sweep<L: Lanes, const LAWS: u8, const PURPOSE: u8>(
        &self,
        sweep: usize,
        tile: usize,
        steps: usize,
        tension: impl Fn(usize) -> f64,
    ) {
        let Shared { plan, tiling, fronts, .. } = self.shared;
        let Tiling { width, depth, count } = *tiling;
        // All sweeps but the last have `depth` steps.
        let per_sweep = plan.rows + depth - 1;
        let before = sweep * per_sweep;
        let await_front = |tile: usize, done: usize| {
            wait_until(|| fronts[tile].0.load(Ordering::Acquire) >= done);
        };
        // The tile's last sweep is done, so its counter is this sweep's alone.
        await_front(tile, before);
        for front in 0..plan.rows + steps - 1 {
            if tile > 0 {
                await_front(tile - 1, before + front + 1);
            }
            if sweep > 0 && tile + 1 < count {
                // The last step of the sweep before has passed the row above this front.
                await_front(tile + 1, before - per_sweep + (front + depth + 1).min(per_sweep));
            }
            for step in front.saturating_sub(plan.rows - 1)..steps.min(front + 1) {
                let start = (tile * width).saturating_sub(step);
                let end = ((tile + 1) * width).saturating_sub(step);
                // SAFETY: see `Shared`.
                unsafe {
                    self.row::<L, LAWS, PURPOSE>(
                        tile,
                        step,
                        front - step,
                        start..end,
                        tension(step),
                    );
                }
            }
            fronts[tile].0.store(before + front + 1, Ordering::Release);
        }
    }

    /// One row of a tile in one step.
    #[inline(always)]
    unsafe fn row<L: Lanes, const LAWS: u8, const PURPOSE: u8>(
        &self,
        tile: usize,
        step: usize,
        index: usize,
        blocks: Range<usize>,
        tension: f64,
    ) {
        let Shared { plan, tiling, handovers, .. } = self.shared;
        let [first, last] = plan.spans[index];
        let blocks = blocks.start.max(first)..blocks.end.min(last);
        let handover =
            |tile: usize| handovers[(tile * tiling.depth + step) * plan.rows + index].get();
        // SAFETY: offsets stay within the buffers; for the rest see `Shared`.
        unsafe {
            let left = if tile > 0 { *handover(tile - 1) } else { [0.0; 4] };
            let right = &mut *handover(tile);
            if blocks.is_empty() {
                *right = left;
                return;
            }
            let carry = self.shared.carries[self.index].start.add(step * 2 * plan.stride);
            if index == 0 {
                for axis in 0..2 {
                    let start = carry.add(axis * plan.stride + blocks.start * BLOCK);
                    std::ptr::write_bytes(start, 0, blocks.len() * BLOCK);
                }
            }
            let lower = self.shared.state.start.add(index * plan.row_len());
            let upper = lower.add(plan.row_len());
            let out = self.shared.seen.start.add(index * plan.row_len() / 2);
            let fetch = step == 0 && tiling.depth == DEEP;
            let row = Row { index, blocks, lower, upper, carry, left, right, out, fetch };
            pass::<L, LAWS, PURPOSE>(plan, tension, row);
        }
    }
}
