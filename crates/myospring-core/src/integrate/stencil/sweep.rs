//! What the sweeps over squares and cubes share: a pass over one row makes forces, kick and drift at once.
//!
//! The springs and the area or volume law of a square or cube are evaluated once. Their forces on the rows above are
//! carried to the passes over those; forces of a square or cube sum to zero, so its least corner takes minus the
//! sum of the others. A row's masses move as soon as their force is complete: what is to the right and above
//! still sees the old positions.

use super::lanes::{Lanes, prefetch};
use super::plan::{BLOCK, Class, Plan, Record};
use std::ops::Range;

/// Purpose of a pass over a row.
pub(super) mod purpose {
    /// Kicks and drifts the row's masses.
    pub(in super::super) const MOVE: u8 = 0;
    /// Writes the velocities at the full step, without moving the masses.
    pub(in super::super) const LOOK: u8 = 1;
}

/// Forces on the corner b and by the corner c of a square, x and y each: see [`Row::left`]. Rows of cubes are not divided.
pub(super) type Handover = [f64; 4];

/// A pass over some blocks of a row; all rows have the layout of [`Plan`].
pub(super) struct Row<'a> {
    /// Number of the row.
    pub(super) index: usize,
    /// Blocks to visit.
    pub(super) blocks: Range<usize>,
    /// State of the row: places, and velocities at the half step; those of the rows above follow.
    pub(super) lower: *mut f64,
    /// Carried forces on `lag` rows; those on row `r` are in row `r % lag`. On entry they are those on this row and the next
    /// ones, on return the furthest row above has taken the place of this one.
    pub(super) carry: *mut f64,
    /// Those of the square to the left of the first block.
    pub(super) left: Handover,
    /// The same of the last square visited, on return.
    pub(super) right: &'a mut Handover,
    /// Where `LOOK` writes velocities.
    pub(super) out: *mut f64,
    /// Whether to prefetch the next row's data.
    pub(super) fetch: bool,
}

/// Most springs of a place.
const MOST: usize = 9;

/// Coefficients of eight squares or cubes.
pub(super) trait Terms<L: Lanes> {
    /// `k + Ta w` of a spring direction, nN/um.
    unsafe fn stiffness(&self, direction: usize) -> L::V;
    /// `-k r`, nN.
    unsafe fn minus_rest_load(&self, direction: usize) -> L::V;
    /// Dashpot coefficient, nN ms/um.
    unsafe fn damping(&self, direction: usize) -> L::V;
    /// Of the area or volume law, see the sweeps.
    unsafe fn measure(&self) -> L::V;
    /// `dt / (m (1 + g))`, ms/ug.
    unsafe fn inverse_mass(&self) -> L::V;
}

/// The same everywhere.
pub(super) struct Uniform<L: Lanes> {
    stiffness: [L::V; MOST],
    load: [L::V; MOST],
    damping: [L::V; MOST],
    measure: L::V,
    inverse_mass: L::V,
}

impl<L: Lanes> Uniform<L> {
    /// The coefficients of a place inside a uniform cell under a tension.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
    pub(super) unsafe fn of<const D: usize, const LAWS: bool>(plan: &Plan, tension: f64) -> Self {
        let common = &plan.uniform[..Record::<D>::LEN];
        // SAFETY: the caller has the features of L.
        unsafe {
            let zero = L::splat(0.0);
            let mut uniform = Self {
                stiffness: [zero; MOST],
                load: [zero; MOST],
                damping: [zero; MOST],
                measure: L::splat(common[Record::<D>::MEASURE]),
                inverse_mass: L::splat(common[Record::<D>::INVERSE_MASS]),
            };
            for direction in 0..Record::<D>::SPRINGS {
                let passive = common[Record::<D>::STIFFNESS + direction];
                let fibre =
                    if LAWS { tension * common[Record::<D>::FIBRE + direction] } else { 0.0 };
                let rest_length = plan.rest_length[usize::from(direction >= D)];
                uniform.stiffness[direction] = L::splat(passive + fibre);
                uniform.load[direction] = L::splat(-passive * rest_length);
                uniform.damping[direction] = L::splat(common[Record::<D>::DAMPING + direction]);
            }
            uniform
        }
    }
}

#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl<L: Lanes> Terms<L> for Uniform<L> {
    #[inline(always)]
    unsafe fn stiffness(&self, direction: usize) -> L::V {
        self.stiffness[direction]
    }
    #[inline(always)]
    unsafe fn minus_rest_load(&self, direction: usize) -> L::V {
        self.load[direction]
    }
    #[inline(always)]
    unsafe fn damping(&self, direction: usize) -> L::V {
        self.damping[direction]
    }
    #[inline(always)]
    unsafe fn measure(&self) -> L::V {
        self.measure
    }
    #[inline(always)]
    unsafe fn inverse_mass(&self) -> L::V {
        self.inverse_mass
    }
}

/// One value per place, read from a record of the plan.
pub(super) struct Field<L: Lanes, const D: usize, const LAWS: bool> {
    pub(super) record: *const f64,
    pub(super) tension: L::V,
    pub(super) minus_rest_length: [L::V; 2],
}

#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl<L: Lanes, const D: usize, const LAWS: bool> Field<L, D, LAWS> {
    #[inline(always)]
    unsafe fn at(&self, term: usize) -> L::V {
        // SAFETY: a record has `Record::LEN` blocks; the caller has the features of L, here and below.
        unsafe { L::load(self.record.add(term * BLOCK)) }
    }
}

#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl<L: Lanes, const D: usize, const LAWS: bool> Terms<L> for Field<L, D, LAWS> {
    #[inline(always)]
    unsafe fn stiffness(&self, direction: usize) -> L::V {
        // SAFETY: see `at`.
        unsafe {
            let passive = self.at(Record::<D>::STIFFNESS + direction);
            if !LAWS {
                return passive;
            }
            L::mul_add(self.tension, self.at(Record::<D>::FIBRE + direction), passive)
        }
    }
    #[inline(always)]
    unsafe fn minus_rest_load(&self, direction: usize) -> L::V {
        // SAFETY: see `at`.
        unsafe {
            let passive = self.at(Record::<D>::STIFFNESS + direction);
            L::mul(passive, self.minus_rest_length[usize::from(direction >= D)])
        }
    }
    #[inline(always)]
    unsafe fn damping(&self, direction: usize) -> L::V {
        // SAFETY: see `at`.
        unsafe { self.at(Record::<D>::DAMPING + direction) }
    }
    #[inline(always)]
    unsafe fn measure(&self) -> L::V {
        // SAFETY: see `at`.
        unsafe { self.at(Record::<D>::MEASURE) }
    }
    #[inline(always)]
    unsafe fn inverse_mass(&self) -> L::V {
        // SAFETY: see `at`.
        unsafe { self.at(Record::<D>::INVERSE_MASS) }
    }
}

/// A step in time, with `g = gamma dt/2`.
pub(super) struct Step<L: Lanes> {
    /// `1/2`
    half: L::V,
    /// `1/(1 + g)`
    slowing: L::V,
    /// `(1 - g)/(1 + g)`
    keep: L::V,
    /// `dt`
    time: L::V,
}

#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
impl<L: Lanes> Step<L> {
    #[inline(always)]
    pub(super) unsafe fn of(plan: &Plan) -> Self {
        // SAFETY: the caller has the features of L, here and below.
        unsafe {
            let (half, slowing) = (L::splat(0.5), L::splat(plan.slowing));
            Self { half, slowing, keep: L::splat(plan.keep), time: L::splat(plan.time_step) }
        }
    }

    /// Positions `x_{n+1} = x_n + dt v_{n+1/2}` and velocities
    /// `v_{n+1/2} = [(1 - g) v_{n-1/2} + dt f_n/m] / (1 + g)`: `coelho_2021`, Eq. (16).
    #[inline(always)]
    pub(super) unsafe fn made<const D: usize>(
        &self,
        inverse_mass: L::V,
        force: [L::V; D],
        a: [L::V; D],
        va: [L::V; D],
    ) -> ([L::V; D], [L::V; D]) {
        // SAFETY: see above.
        unsafe {
            let (mut moved, mut v) = (a, va);
            for axis in 0..D {
                v[axis] = L::mul_add(inverse_mass, force[axis], L::mul(self.keep, va[axis]));
                moved[axis] = L::mul_add(self.time, v[axis], a[axis]);
            }
            (moved, v)
        }
    }

    /// Velocities at the full step, `v_n = (v_{n-1/2} + dt/2 f_n/m) / (1 + g)`.
    #[inline(always)]
    pub(super) unsafe fn halfway<const D: usize>(
        &self,
        inverse_mass: L::V,
        force: [L::V; D],
        va: [L::V; D],
    ) -> [L::V; D] {
        // SAFETY: see above.
        unsafe {
            let kick = L::mul(self.half, inverse_mass);
            let mut v = va;
            for axis in 0..D {
                v[axis] = L::mul_add(kick, force[axis], L::mul(self.slowing, va[axis]));
            }
            v
        }
    }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) unsafe fn dot<L: Lanes, const D: usize>(a: [L::V; D], b: [L::V; D]) -> L::V {
    // SAFETY: the caller has the features of L.
    unsafe {
        let mut sum = L::mul(a[0], b[0]);
        for axis in 1..D {
            sum = L::mul_add(a[axis], b[axis], sum);
        }
        sum
    }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) unsafe fn difference<L: Lanes, const D: usize>(
    to: [L::V; D],
    from: [L::V; D],
) -> [L::V; D] {
    // SAFETY: the caller has the features of L.
    unsafe {
        let mut difference = to;
        for axis in 0..D {
            difference[axis] = L::sub(to[axis], from[axis]);
        }
        difference
    }
}

/// `s` such that the force on the spring's first end is `s l`, with `l` and the relative velocity
/// `w` from the first end to the second:
/// `s = k (1 - r/|l|) + c (w.l)/|l|^2 + Ta w_fibre`, `coelho_2021`, Eqs (7) and (8).
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) unsafe fn pull<L: Lanes, T: Terms<L>, const D: usize>(
    terms: &T,
    direction: usize,
    l: [L::V; D],
    w: [L::V; D],
) -> L::V {
    // SAFETY: the caller has the features of L.
    unsafe {
        let square = dot::<L, D>(l, l);
        let approach = dot::<L, D>(l, w);
        let inverse = L::inverse_sqrt(square);
        // s = (k + Ta w) + (c w.l/|l| - k r)/|l|
        let damping = L::mul(terms.damping(direction), approach);
        let slope = L::mul_add(damping, inverse, terms.minus_rest_load(direction));
        L::mul_add(slope, inverse, terms.stiffness(direction))
    }
}

/// `N` values of each component from a place on.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) unsafe fn load<L: Lanes, const D: usize>(from: *const f64, stride: usize) -> [L::V; D] {
    // SAFETY: the caller's.
    unsafe {
        let mut values = [L::load(from); D];
        for axis in 1..D {
            values[axis] = L::load(from.add(axis * stride));
        }
        values
    }
}

/// The same written.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) unsafe fn store<L: Lanes, const D: usize>(
    to: *mut f64,
    stride: usize,
    values: [L::V; D],
) {
    // SAFETY: the caller's.
    unsafe {
        for axis in 0..D {
            L::store(to.add(axis * stride), values[axis]);
        }
    }
}

/// Adds the force of the springs to resting places.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) unsafe fn held_back<L: Lanes, const D: usize>(
    plan: &Plan,
    (row, at): (usize, usize),
    a: [L::V; D],
    mut force: [L::V; D],
) -> [L::V; D] {
    // SAFETY: there are `1 + D` strides of anchors for each row; the caller has the features of L.
    unsafe {
        let anchor = plan.anchors.as_ptr().cast::<f64>().add(row * (1 + D) * plan.stride + at);
        let (k, rest) = (L::load(anchor), load::<L, D>(anchor.add(plan.stride), plan.stride));
        for axis in 0..D {
            force[axis] = L::mul_sub_from(k, L::sub(a[axis], rest[axis]), force[axis]);
        }
        force
    }
}

/// Prefetches what the next row's pass is the first to read at a block: coefficients, and the state of the furthest row
/// above it.
#[inline(always)]
#[allow(clippy::inline_always, reason = "inlined where the vector units are enabled")]
pub(super) fn fetch_next(plan: &Plan, row: usize, block: usize, state: *const f64) {
    let furthest = state.wrapping_add((plan.lag + 1) * plan.row_len + block * BLOCK);
    for component in 0..2 * plan.axes {
        prefetch(furthest.wrapping_add(component * plan.stride));
    }
    if let Some(&class) = plan.classes.get((row + 1) * plan.blocks + block)
        && class.0 > Class::UNIFORM.0
    {
        let record = plan.record(class);
        for term in 0..plan.record_len {
            prefetch(record.wrapping_add(term * BLOCK));
        }
    }
}
