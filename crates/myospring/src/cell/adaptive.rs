//! Adaptive integration.
#![allow(missing_docs)]
mod branch;
mod course;
mod exponential;
mod lanes;
mod piece;

use super::minimal::MinimalModel;
use super::pacing::Protocol;
use super::CellModel as _;
pub(super) use branch::Pieces;
use branch::State;
use course::Course;
use lanes::Lanes;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beat {
    pub stimulus_ms: f64,
    pub resting_potential: f64,
    pub peak_potential: f64,
    pub peak_tension: f64,
    pub peak_tension_ms: f64,
    pub apd90_ms: Option<f64>,
}

#[derive(Debug, Clone)]
pub struct Cell {
    pieces: Pieces,
    initial_state: State,
    protocol: Protocol,
    duration_ms: f64,
}

impl Cell {
    pub fn new(model: &MinimalModel, protocol: Protocol, duration_ms: f64) -> Self {
        let s = model.initial_state();
        Self { pieces: model.pieces(), initial_state: std::array::from_fn(|k| s[k]), protocol, duration_ms }
    }
}

#[derive(Debug, Clone)]
pub struct Outcome { pub beats: Vec<Beat>, pub taken: u64, pub refused: u64, pub steps: u64 }

pub fn run<const N: usize>(cells: &[Cell], tolerance: f64) -> Vec<Outcome> {
    let arch = pulp::Arch::new();
    let mut lanes = Lanes::<N>::new(tolerance);
    let mut out: Vec<Option<Outcome>> = vec![None; cells.len()];
    let mut queue = 0..cells.len();
    let mut courses: [Option<(usize, Course)>; N] = std::array::from_fn(|_| None);
    for i in 0..N {
        courses[i] = queue.next().map(|c| (c, Course::start(&cells[c], None, &mut lanes, i)));
    }
    let mut active = courses.iter().flatten().count();
    while active > 0 {
        if N == 1 { lanes.try_step(); } else { arch.dispatch(|| lanes.try_step()); }
        for i in 0..N {
            if lanes.attention[i] == 0 { continue; }
            let Some((index, course)) = &mut courses[i] else { continue };
            if course.attend(&mut lanes, i).unwrap() {
                out[*index] = Some(Outcome { beats: std::mem::take(&mut course.beats), taken: lanes.taken[i], refused: lanes.refused[i], steps: course.steps });
                courses[i] = queue.next().map(|c| (c, Course::start(&cells[c], None, &mut lanes, i)));
                if courses[i].is_none() {
                    active -= 1;
                    lanes.step[i] = 0.0; lanes.stop[i] = f64::INFINITY; lanes.sample[i] = f64::INFINITY;
                }
            }
        }
    }
    out.into_iter().flatten().collect()
}
