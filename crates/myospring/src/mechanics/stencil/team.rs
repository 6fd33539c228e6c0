//! Steps on one thread or several, with the same bits.
//!
//! Each thread owns consecutive rows. What it needs of its neighbours, the old state of the row
//! above its last and of the row below its first, they publish in a buffer of two slots after every
//! step. A thread looks at them only at the end of its next step, so neighbours may drift apart by
//! most of a step without waiting. The forces that the row below sends up are computed a second
//! time by the thread above, from the same values in the same order: hence the same bits.

use super::lanes::{Lanes, Portable, Units};
#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, Avx512};
use super::plan::{BLOCK, Block, Plan};
use super::sweep::{Row, finish, laws, pass, purpose};
use std::cell::UnsafeCell;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread::JoinHandle;

/// Turns of a waiting loop before the thread gives its core to others.
const SPINS: u32 = 4000;

/// Bytes of state and coefficients above which several steps share a sweep: the second-level cache.
const CACHE: usize = 1 << 20;

/// Steps that share a sweep.
const SKEW: usize = 4;

/// What all threads are asked to do.
#[derive(Debug, Clone, Copy)]
enum Command {
    /// Steps under a tension that goes linearly from the first to the second value, kPa; the forces
    /// of the last step are not at the second value but one step before.
    Advance { steps: usize, tensions: [f64; 2] },
    /// Velocities at the full step under this tension, kPa.
    Look { tension: f64 },
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
    #[allow(clippy::mut_from_ref, reason = "the owner of the team vouches that no thread is at work")]
    unsafe fn values(&self) -> &mut [f64] {
        // SAFETY: the owner lives as long as this, and a Block is BLOCK values without padding.
        unsafe { std::slice::from_raw_parts_mut(self.start, self.len) }
    }
}

/// Buffers and rows of one thread.
struct Share {
    rows: Range<usize>,
    /// One for each step of a sweep, x and y.
    carries: Buffer,
    /// Carried up from the row below the first.
    from_below: Buffer,
    /// Force from above on the first row.
    first_above: Buffer,
    /// Old states of the first and the last row, two slots each.
    published: [[Buffer; 2]; 2],
}

/// What the threads share.
struct Shared {
    plan: Plan,
    units: Units,
    state: Buffer,
    /// Velocities at the full step, x and y by row.
    seen: Buffer,
    command: UnsafeCell<Command>,
    shares: Vec<Share>,
    /// Number of the present command.
    epoch: AtomicU64,
    /// Workers that have not yet finished it.
    busy: AtomicUsize,
    /// States that each thread has published.
    versions: Vec<AtomicU64>,
}

// SAFETY: a thread writes only its own rows of `state` and `seen` and the buffers of its own `Share`.
// `command` is written by the owner while no worker is busy. Neighbours read the slots of `published` that
// `versions` (release, acquire) says are complete, and a slot is written again only after the
// neighbour has published the state that it made from it.
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
        let ranges = share_out(&plan, threads);
        let row = || Buffer::zeros(plan.row_len());
        let shares: Vec<Share> = ranges
            .into_iter()
            .map(|rows| Share {
                rows,
                carries: Buffer::zeros(SKEW * plan.row_len() / 2),
                from_below: Buffer::zeros(plan.row_len() / 2),
                first_above: Buffer::zeros(plan.row_len() / 2),
                published: [[row(), row()], [row(), row()]],
            })
            .collect();
        let count = shares.len();
        let shared = Arc::new(Shared {
            units,
            state: Buffer::new(plan.vacant.clone()),
            seen: Buffer::zeros(plan.vacant.len() * BLOCK / 2),
            command: UnsafeCell::new(Command::Quit),
            shares,
            epoch: AtomicU64::new(0),
            busy: AtomicUsize::new(0),
            versions: (0..count).map(|_| AtomicU64::new(0)).collect(),
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

/// Rows for each of at most `threads` threads, of about equal numbers of blocks, two rows or more.
fn share_out(plan: &Plan, threads: usize) -> Vec<Range<usize>> {
    let threads = threads.clamp(1, (plan.rows / 2).max(1));
    let work = |row: usize| plan.spans[row][1].saturating_sub(plan.spans[row][0]) + 1;
    let total: usize = (0..plan.rows).map(work).sum();
    let mut ranges = Vec::with_capacity(threads);
    let (mut start, mut done) = (0, 0);
    for thread in 0..threads {
        let mut end = start;
        let last_end = plan.rows - 2 * (threads - 1 - thread);
        while end < last_end && (end < start + 2 || done * threads < total * (thread + 1)) {
            done += work(end);
            end += 1;
        }
        if thread + 1 == threads {
            end = plan.rows;
        }
        ranges.push(start..end);
        start = end;
    }
    ranges
}

fn wait_until(condition: impl Fn() -> bool) {
    let mut turns = 0;
    while !condition() {
        turns += 1;
        if turns < SPINS {
            std::hint::spin_loop();
        } else {
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
    const BOTH: u8 = laws::AREA | laws::FIBRE;
    // SAFETY: the caller's.
    unsafe {
        match shared.plan.laws {
            0 => obey::<L, 0>(shared, index, command),
            laws::AREA => obey::<L, { laws::AREA }>(shared, index, command),
            laws::FIBRE => obey::<L, { laws::FIBRE }>(shared, index, command),
            _ => obey::<L, BOTH>(shared, index, command),
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
    // SAFETY: this thread's rows and share are its own, see `Shared`.
    unsafe {
        match command {
            Command::Quit => {}
            Command::Advance { steps, tensions } => {
                let slope = (tensions[1] - tensions[0]) / steps as f64;
                let tension = |step: usize| tensions[0] + slope * step as f64;
                let mut lane = Lane::new(shared, index);
                if shared.shares.len() > 1 {
                    lane.publish();
                    for step in 0..steps {
                        lane.step::<L, LAWS>(tension(step));
                        lane.publish();
                    }
                } else if lane.is_large() {
                    let mut step = 0;
                    while step < steps {
                        let count = SKEW.min(steps - step);
                        lane.skewed::<L, LAWS>(count, |level| tension(step + level));
                        step += count;
                    }
                } else {
                    for step in 0..steps {
                        lane.skewed::<L, LAWS>(1, |_| tension(step));
                    }
                }
            }
            Command::Look { tension } => Lane::new(shared, index).look::<L, LAWS>(tension),
        }
    }
}

/// A thread's rows and what it needs to step them.
struct Lane<'a> {
    shared: &'a Shared,
    share: &'a Share,
    index: usize,
    version: u64,
}

#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl<'a> Lane<'a> {
    fn new(shared: &'a Shared, index: usize) -> Self {
        let version = shared.versions[index].load(Ordering::Relaxed);
        Self { shared, share: &shared.shares[index], index, version }
    }

    fn is_large(&self) -> bool {
        let plan = &self.shared.plan;
        size_of_val(&plan.vacant[..]) + size_of_val(&plan.records[..]) > CACHE
    }

    fn rows(&self) -> Range<usize> {
        self.share.rows.clone()
    }

    unsafe fn row(&self, index: usize) -> *mut f64 {
        // SAFETY: the state has `rows + 1` rows.
        unsafe { self.shared.state.start.add(index * self.shared.plan.row_len()) }
    }

    /// Lets the neighbours see the first and the last row.
    unsafe fn publish(&mut self) {
        // SAFETY: the neighbours read this slot only after the version is stored, and are done with
        // what it held: they have published what they made from it.
        unsafe {
            let (rows, len) = (self.rows(), self.shared.plan.row_len());
            let slot = (self.version & 1) as usize;
            for (side, row) in [rows.start, rows.end - 1].into_iter().enumerate() {
                let to = self.share.published[side][slot].start;
                std::ptr::copy_nonoverlapping(self.row(row), to, len);
            }
        }
        self.version += 1;
        self.shared.versions[self.index].store(self.version, Ordering::Release);
    }

    /// A row that a neighbour has published: side 0 its first, 1 its last. It is complete, and is not
    /// written again before this thread publishes.
    fn neighbour(&self, index: usize, side: usize) -> *mut f64 {
        let versions = &self.shared.versions;
        wait_until(|| versions[index].load(Ordering::Acquire) >= self.version);
        let slot = ((self.version - 1) & 1) as usize;
        self.shared.shares[index].published[side][slot].start
    }

    /// The row above one of this thread's rows, as it was before the step.
    unsafe fn above(&self, row: usize) -> *const f64 {
        // SAFETY: the row on top of all is padding and never moves.
        unsafe {
            if row + 1 == self.rows().end && row + 1 < self.shared.plan.rows {
                self.neighbour(self.index + 1, 0)
            } else {
                self.row(row + 1)
            }
        }
    }

    /// One step of rows with neighbours on other threads.
    #[inline(always)]
    unsafe fn step<L: Lanes, const LAWS: u8>(&mut self, tension: f64) {
        // SAFETY: see `Shared`.
        unsafe {
            let plan = &self.shared.plan;
            let carry = self.share.carries.start;
            let out = self.share.first_above.start;
            std::ptr::write_bytes(carry, 0, 2 * plan.stride);
            let rows = self.rows();
            for index in rows.clone() {
                let (lower, upper) = (self.row(index), self.above(index));
                let row = Row { index, lower, upper, carry, out };
                if index == rows.start && index > 0 {
                    pass::<L, LAWS, { purpose::DEFER }>(plan, tension, row);
                } else {
                    pass::<L, LAWS, { purpose::MOVE }>(plan, tension, row);
                }
            }
            if rows.start > 0 {
                // The first row has not moved yet.
                let carry = self.from_below::<L, LAWS>(tension);
                let lower = self.row(rows.start);
                finish::<L>(plan, Row { index: rows.start, lower, upper: lower, carry, out });
            }
        }
    }

    /// What the row below the first carries up.
    #[inline(always)]
    unsafe fn from_below<L: Lanes, const LAWS: u8>(&mut self, tension: f64) -> *mut f64 {
        // SAFETY: see `Shared`.
        unsafe {
            let start = self.rows().start;
            let carry = self.share.from_below.start;
            let (lower, upper) = (self.neighbour(self.index - 1, 1), self.row(start));
            let row = Row { index: start - 1, lower, upper, carry, out: carry };
            pass::<L, LAWS, { purpose::CARRY }>(&self.shared.plan, tension, row);
            carry
        }
    }

    /// Several steps in one sweep over all rows: each step trails the one before it by a row.
    #[inline(always)]
    unsafe fn skewed<L: Lanes, const LAWS: u8>(
        &mut self,
        steps: usize,
        tension: impl Fn(usize) -> f64,
    ) {
        // SAFETY: this thread owns all rows.
        unsafe {
            let plan = &self.shared.plan;
            let carries = self.share.carries.start;
            std::ptr::write_bytes(carries, 0, 2 * plan.stride * steps);
            for front in 0..plan.rows + steps - 1 {
                for step in front.saturating_sub(plan.rows - 1)..steps.min(front + 1) {
                    let index = front - step;
                    let carry = carries.add(2 * plan.stride * step);
                    let (lower, upper) = (self.row(index), self.row(index + 1));
                    let row = Row { index, lower, upper, carry, out: carry };
                    pass::<L, LAWS, { purpose::MOVE }>(plan, tension(step), row);
                }
            }
        }
    }

    /// Velocities at the full step.
    #[inline(always)]
    unsafe fn look<L: Lanes, const LAWS: u8>(&mut self, tension: f64) {
        // SAFETY: see `Shared`; `seen` has half a row for each row.
        unsafe {
            let plan = &self.shared.plan;
            let rows = self.rows();
            let carry = if rows.start > 0 {
                self.from_below::<L, LAWS>(tension)
            } else {
                let carry = self.share.carries.start;
                std::ptr::write_bytes(carry, 0, 2 * plan.stride);
                carry
            };
            let seen = self.shared.seen.start;
            for index in rows {
                let (lower, upper) = (self.row(index), self.above(index));
                let out = seen.add(index * plan.row_len() / 2);
                let row = Row { index, lower, upper, carry, out };
                pass::<L, LAWS, { purpose::LOOK }>(plan, tension, row);
            }
        }
    }
}
