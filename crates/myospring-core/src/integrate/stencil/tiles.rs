//! Several steps in one sweep, divided into pieces; the result is bitwise the same for any
//! division.
//!
//! The lattice is cut into **tiles** of some blocks' width over all rows. A tile makes several
//! steps in one sweep: each step trails the previous one by a row (in space by a layer and a row) and is one block further to the
//! left, so that the values it needs from the previous step are complete, and those which the
//! previous step needs are still unchanged:
//!
//! ```text
//! rows         tile k     tile k+1
//!  ^       . . . . . . . . . . . .
//!  |    step 0 |0 0 0 0|0 0 0 0|         front: step 0 in row j,
//!  |  step 1 |1 1 1 1|1 1 1 1|                  step 1 in row j - 1,
//!  |step 2 |2 2 2 2|2 2 2 2|                    step 2 in row j - 2
//! ```
//!
//! A tile's window of rows stays in the second-level cache, so a large mesh is read from memory
//! once for several steps. In space there is one tile. Consecutive fronts form a **band** (see `bands.rs`): one thread sweeps a
//! band, tile by tile, and leaves the forces carried upwards by its last front to the thread of the
//! band above. Every force is computed once, from the same values in the same order for any tiles
//! and bands, so results are bitwise the same.

#[cfg(target_arch = "x86_64")]
use super::lanes::{Avx2, Avx512};
use super::lanes::{Lanes, Portable, Units};
use super::plan::{BLOCK, Block, Plan};
use super::sweep::{Handover, Row, purpose};
use super::{cubes, squares};
use std::cell::UnsafeCell;
use std::ops::Range;

/// Bytes that a tile's window of rows may take: three quarters of a second-level cache of 1 MiB.
const CACHE: usize = 3 << 18;

/// Steps that share a sweep of a large flat mesh.
const DEEP: usize = 8;

/// Bands per thread: with more than two, a thread may be ahead or behind without waiting.
const BANDS: usize = 4;

/// The work of a command.
#[derive(Debug, Clone, Copy)]
pub(super) enum Command {
    /// Steps under a tension that goes linearly from the first to the second value, kPa; the forces
    /// of the last step are not at the second value but one step before.
    Advance { steps: usize, tensions: [f64; 2] },
    /// Velocities at the full step under this tension, kPa.
    Look { tension: f64 },
}

impl Command {
    fn steps(self) -> usize {
        match self {
            Self::Advance { steps, .. } => steps,
            Self::Look { .. } => 1,
        }
    }

    /// Tension in one of its steps, kPa.
    #[inline]
    fn tension(self, step: usize) -> f64 {
        match self {
            Self::Advance { steps, tensions: [from, to] } => {
                from + (to - from) / steps as f64 * step as f64
            }
            Self::Look { tension } => tension,
        }
    }
}

/// Division of the lattice into tiles and bands.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tiling {
    /// Whether the mesh is larger than the threads' caches.
    pub(super) large: bool,
    /// Blocks in a tile.
    pub(super) width: usize,
    /// Steps in a sweep.
    pub(super) depth: usize,
    /// Number of tiles.
    pub(super) count: usize,
    /// First front of each band. Every band except the last has at least `depth` times the plan's `lag` fronts, so that
    /// work on it in one sweep does not overlap with work on the band after next in the previous
    /// sweep.
    pub(super) starts: Vec<usize>,
}

impl Tiling {
    /// Divides a lattice: a mesh that fits into the threads' caches is one tile, a larger flat one has
    /// tiles that fit.
    pub(super) fn new(plan: &Plan, threads: usize) -> Self {
        let blocks = plan.blocks;
        let (flat, state) = (plan.axes == 2, 2 * plan.axes * size_of::<Block>());
        let records = size_of_val(&plan.records[..]) / (plan.rows * blocks);
        let fits = plan.rows * blocks * (state + records) <= CACHE * threads;
        // A layer is many rows, so that a deep sweep would take as much memory as the mesh, and leave few bands.
        let depth = match (flat, fits) {
            (false, true) if threads > 1 => 1,
            (false, _) | (_, true) => 2,
            (true, false) => DEEP,
        };
        let in_cache = CACHE / ((depth + 2) * (state + records));
        let widest = blocks + depth - 1;
        let width = if fits || !flat { widest } else { widest.min(in_cache) }.max(depth);
        let bands = if threads > 1 { BANDS * threads } else { 1 };
        let least = depth * plan.lag;
        let starts = starts(plan, bands.clamp(1, (plan.rows / least).max(1)), least);
        Self { large: !fits, width, depth, count: widest.div_ceil(width), starts }
    }
}

/// Bands with about equal work, each of at least `fewest` rows.
fn starts(plan: &Plan, bands: usize, fewest: usize) -> Vec<usize> {
    let work = |row: usize| plan.spans[row][1] - plan.spans[row][0] + 1;
    let total: usize = (0..plan.rows).map(work).sum();
    let mut starts = vec![0];
    let (mut row, mut below) = (0, 0);
    for band in 1..bands {
        let least = starts[band - 1] + fewest;
        let most = plan.rows - (bands - band) * fewest;
        while row < least || (row < most && below * bands < band * total) {
            below += work(row);
            row += 1;
        }
        starts.push(row);
    }
    starts
}

/// Memory to which threads write through a pointer, each to its own part.
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
    /// No other thread reads or writes it meanwhile.
    #[allow(clippy::mut_from_ref, reason = "the caller vouches that no thread is at work")]
    unsafe fn values(&self) -> &mut [f64] {
        // SAFETY: the owner lives as long as this, and a Block is BLOCK values without padding.
        unsafe { std::slice::from_raw_parts_mut(self.start, self.len) }
    }
}

/// The masses, their plan and buffers.
pub(super) struct Tiles {
    pub(super) plan: Plan,
    units: Units,
    tiling: Tiling,
    state: Buffer,
    /// Velocities at the full step by row.
    seen: Buffer,
    /// Carried forces by step of a sweep, on `lag` rows in turn. Each sweep has its own while it moves from band
    /// to band.
    carries: Vec<Buffer>,
    /// By tile, step of a sweep and row.
    handovers: Vec<UnsafeCell<Handover>>,
    /// The command, and the number of its first sweep.
    command: UnsafeCell<(Command, u64)>,
}

// SAFETY: `command` is written while no thread is at work. For the rest a thread touches only what
// belongs to the band and the sweep that it is at, and the order of bands in `bands.rs` keeps others
// away from it:
// - Step s of a band writes the rows `s lag` below its fronts, in `state`, `seen` and `handovers`, and reads
//   these rows and up to `lag` above. Bands below have done this sweep and do not come back before this band
//   has done it; the band above has done the sweep before; and the bands above that one stay `depth lag`
//   rows away, see `Tiling::starts`.
// - A sweep is in one band at a time, so its `carries` have one reader and writer. There are as many as
//   bands, and a sweep starts when the sweep as many before it has left the last band.
unsafe impl Sync for Tiles {}
// SAFETY: plain data.
unsafe impl Send for Tiles {}

impl Tiles {
    /// Starts in the state [`Plan::vacant`].
    pub(super) fn new(plan: Plan, units: Units, tiling: Tiling) -> Self {
        assert!(units.available(), "{units:?} is not available on this processor");
        let handovers = tiling.count * tiling.depth * plan.rows;
        let carry = || Buffer::zeros(tiling.depth * plan.lag * plan.axes * plan.stride);
        Self {
            units,
            state: Buffer::new(plan.vacant.clone()),
            seen: Buffer::zeros(plan.vacant.len() * BLOCK / 2),
            carries: tiling.starts.iter().map(|_| carry()).collect(),
            handovers: (0..handovers).map(|_| UnsafeCell::new([0.0; 4])).collect(),
            command: UnsafeCell::new((Command::Look { tension: 0.0 }, 0)),
            tiling,
            plan,
        }
    }

    pub(super) fn bands(&self) -> usize {
        self.tiling.starts.len()
    }

    /// Sets a command, which begins with this sweep, and returns how many sweeps it needs.
    ///
    /// # Safety
    /// No thread is at work.
    pub(super) unsafe fn begin(&self, command: Command, first: u64) -> u64 {
        // SAFETY: the caller's.
        unsafe { *self.command.get() = (command, first) };
        command.steps().div_ceil(self.tiling.depth) as u64
    }

    /// The state in rows as [`Plan`] lays them out, and the velocities at the full step from the
    /// last [`Command::Look`]: x and y by row.
    ///
    /// # Safety
    /// No thread is at work, nor will be while these are in use.
    #[allow(clippy::mut_from_ref, reason = "the caller vouches that no thread is at work")]
    pub(super) unsafe fn values(&self) -> (&mut [f64], &[f64]) {
        // SAFETY: the caller's.
        unsafe { (self.state.values(), self.seen.values()) }
    }

    /// Performs some sweeps of the command on one band.
    ///
    /// # Safety
    /// The band of these sweeps is the caller's alone, by the rules of `bands.rs`.
    pub(super) unsafe fn perform(&self, band: usize, sweeps: Range<u64>) {
        // SAFETY: `units` are available, see `Tiles::new`; for the rest the caller's.
        match self.units {
            #[cfg(target_arch = "x86_64")]
            Units::Avx512 => unsafe { perform_avx512(self, band, sweeps) },
            #[cfg(target_arch = "x86_64")]
            Units::Avx2 => unsafe { perform_avx2(self, band, sweeps) },
            _ => unsafe { perform::<Portable>(self, band, sweeps) },
        }
    }
}

/// # Safety
/// As for [`Tiles::perform`], and the processor has AVX-512F.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx2,fma")]
unsafe fn perform_avx512(tiles: &Tiles, band: usize, sweeps: Range<u64>) {
    // SAFETY: as above.
    unsafe { perform::<Avx512>(tiles, band, sweeps) }
}

/// # Safety
/// As for [`Tiles::perform`], and the processor has AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn perform_avx2(tiles: &Tiles, band: usize, sweeps: Range<u64>) {
    // SAFETY: as above.
    unsafe { perform::<Avx2>(tiles, band, sweeps) }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
unsafe fn perform<L: Lanes>(tiles: &Tiles, band: usize, sweeps: Range<u64>) {
    // SAFETY: the command was written before the band could be claimed, and is not again before all are
    // done; for the rest the caller's.
    unsafe {
        let (command, first) = *tiles.command.get();
        for sweep in sweeps {
            let sweep = (sweep - first) as usize;
            let carries = &tiles.carries[sweep % tiles.carries.len()];
            let piece = Piece { tiles, band, sweep, carries };
            match command {
                Command::Advance { .. } if tiles.plan.laws => {
                    piece.fronts::<L, true, { purpose::MOVE }>(command);
                }
                Command::Advance { .. } => piece.fronts::<L, false, { purpose::MOVE }>(command),
                // It is rare, so that all share a kernel; absent laws have no coefficients.
                Command::Look { .. } => piece.fronts::<L, true, { purpose::LOOK }>(command),
            }
        }
    }
}

/// One band of one sweep.
struct Piece<'a> {
    tiles: &'a Tiles,
    band: usize,
    /// Index within the command.
    sweep: usize,
    carries: &'a Buffer,
}

/// All functions need the processor features of `L`, and that the piece is the caller's alone.
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl Piece<'_> {
    /// The band's fronts, tile by tile.
    #[inline(always)]
    unsafe fn fronts<L: Lanes, const LAWS: bool, const PURPOSE: u8>(&self, command: Command) {
        let Tiles { plan, tiling, .. } = self.tiles;
        let Tiling { width, depth, count, ref starts, .. } = *tiling;
        let first = self.sweep * depth;
        let steps = depth.min(command.steps() - first);
        let lag = plan.lag;
        let end = plan.rows + (steps - 1) * lag;
        let end = starts.get(self.band + 1).map_or(end, |start| *start);
        for tile in 0..count {
            for front in starts[self.band]..end {
                let oldest = (front + 1).saturating_sub(plan.rows).div_ceil(lag);
                for step in oldest..steps.min(front / lag + 1) {
                    let start = (tile * width).saturating_sub(step);
                    let end = ((tile + 1) * width).saturating_sub(step);
                    // SAFETY: the caller's.
                    unsafe {
                        self.row::<L, LAWS, PURPOSE>(
                            tile,
                            step,
                            front - step * lag,
                            start..end,
                            command,
                        );
                    }
                }
            }
        }
    }

    /// One row of a tile in one step.
    #[inline(always)]
    unsafe fn row<L: Lanes, const LAWS: bool, const PURPOSE: u8>(
        &self,
        tile: usize,
        step: usize,
        index: usize,
        blocks: Range<usize>,
        command: Command,
    ) {
        let Tiles { plan, tiling, handovers, .. } = self.tiles;
        let [first, last] = plan.spans[index];
        let whole = blocks.start..blocks.end.min(plan.blocks);
        let blocks = blocks.start.max(first)..blocks.end.min(last);
        let handover =
            |tile: usize| handovers[(tile * tiling.depth + step) * plan.rows + index].get();
        // SAFETY: offsets stay within the buffers; for the rest see `Tiles`.
        unsafe {
            let left = if tile > 0 { *handover(tile - 1) } else { [0.0; 4] };
            let right = &mut *handover(tile);
            let carry = self.carries.start.add(step * plan.lag * plan.axes * plan.stride);
            if index == 0 {
                for part in 0..plan.lag * plan.axes {
                    let start = carry.add(part * plan.stride + whole.start * BLOCK);
                    std::ptr::write_bytes(start, 0, whole.len() * BLOCK);
                }
            }
            if blocks.is_empty() {
                *right = left;
                return;
            }
            let lower = self.tiles.state.start.add(index * plan.row_len);
            let out = self.tiles.seen.start.add(index * plan.row_len / 2);
            let fetch = step == 0 && tiling.large;
            let tension = command.tension(self.sweep * tiling.depth + step);
            let row = Row { index, blocks, lower, carry, left, right, out, fetch };
            match plan.axes {
                2 => squares::pass::<L, LAWS, PURPOSE>(plan, tension, row),
                3 => cubes::pass::<L, LAWS, PURPOSE>(plan, tension, row),
                _ => unreachable!("lattices have two or three axes"),
            }
        }
    }
}
