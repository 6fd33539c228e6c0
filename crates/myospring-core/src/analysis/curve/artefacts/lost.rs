//! Parts of a curve in which the instrument had lost the cell.

use super::runs::runs;
use crate::analysis::curve::noise::{self, median};

/// Frames in a block whose noise is estimated, and number of consecutive blocks that is longer than
/// any beat.
const BLOCK: usize = 24;
const BLOCKS: usize = 6;

/// Largest part of a recording that is held at a constant value, and largest number of such parts;
/// rests in whole pixels are more frequent.
const HELD: f64 = 1.0 / 3.0;
const HELD_STRETCHES: usize = 3;

/// Marks long parts in which the instrument had lost the cell: pure noise far larger than
/// elsewhere, a random walk, or a constant value among noise.
pub(super) fn mark(values: &[f64], bad: &mut [bool]) {
    let blocks: Vec<&[f64]> = values.chunks(BLOCK).collect();
    let levels: Vec<f64> = blocks.iter().map(|block| noise::level(block)).collect();
    let usual = median(levels.clone());
    let is_noise: Vec<bool> = blocks
        .iter()
        .zip(&levels)
        .map(|(block, level)| {
            let mean = block.iter().sum::<f64>() / block.len() as f64;
            let variance = block.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
            // Beats are correlated from frame to frame, noise is not.
            *level > 6.0 * usual && level * level > 0.05 * variance / block.len() as f64
        })
        .collect();
    let is_held: Vec<bool> =
        blocks.iter().map(|block| block.iter().all(|value| *value == block[0])).collect();
    let long = |of: &[bool]| -> Vec<[usize; 2]> {
        runs(of).into_iter().filter(|[from, to]| to + 1 - from >= BLOCKS).collect()
    };
    let mut held = long(&is_held);
    let frozen: usize = held.iter().map(|[from, to]| to + 1 - from).sum();
    // Noise is the same in all other blocks; the curvature of a smooth curve is not.
    let mut other: Vec<f64> =
        levels.iter().zip(&is_held).filter(|(_, held)| !**held).map(|(level, _)| *level).collect();
    other.sort_by(f64::total_cmp);
    let part = |part: usize| other.get(other.len() / part).copied().unwrap_or(0.0);
    let noisy = part(20) > 0.4 * part(2) && part(2) > 1e-9 * noise::range(values, 0.0);
    if !noisy || frozen as f64 > HELD * blocks.len() as f64 || held.len() > HELD_STRETCHES {
        held.clear();
    }
    for [from, to] in held {
        let (mut from, mut to) = (from * BLOCK, ((to + 1) * BLOCK).min(values.len()));
        while from > 0 && values[from - 1] == values[from] {
            from -= 1;
        }
        while to < values.len() && values[to] == values[to - 1] {
            to += 1;
        }
        bad[from..to].fill(true);
    }
    for [from, to] in long(&is_noise) {
        let (from, to) = (from.saturating_sub(1) * BLOCK, (to + 2) * BLOCK);
        bad[from..to.min(values.len())].fill(true);
    }
    for [from, to] in walks(values) {
        // A block counts as a walk if at least half of it is.
        let half = BLOCK / 2;
        let (from, to) = ((from * BLOCK).saturating_sub(half), (to + 1) * BLOCK + half);
        bad[from..to.min(values.len())].fill(true);
    }
}

/// Growth of fourth differences when their lag doubles, for a random walk: the root of 2, with a
/// tolerance of about a fifth. For white noise they do not grow, for a smooth curve they grow
/// 16-fold.
const WALK: [f64; 2] = [1.2, 1.7];

/// Smallest lag of the differences by which a walk is recognised, frames: beats are smooth over
/// this lag, and white noise has the same differences at any lag.
const STRIDE: usize = 4;

/// First and last blocks of random walks.
fn walks(values: &[f64]) -> Vec<[usize; 2]> {
    let middle = |block: &[f64], lag: usize| median(noise::differences(block, lag));
    let rough: Vec<f64> = values.chunks(BLOCK).map(|block| middle(block, STRIDE)).collect();
    let usual = median(rough.clone());
    // A block has few differences, so three blocks are used together.
    let wide: Vec<bool> = (0..rough.len())
        .map(|at| {
            median(rough[at.saturating_sub(1)..(at + 2).min(rough.len())].to_vec()) > 2.0 * usual
        })
        .collect();
    let is_walk = |[from, to]: &[usize; 2]| {
        let part = &values[from * BLOCK..((to + 1) * BLOCK).min(values.len())];
        [1, 2, 4].iter().all(|&lag| {
            let growth = middle(part, 2 * lag) / middle(part, lag);
            (WALK[0]..WALK[1]).contains(&growth)
        })
    };
    let runs = runs(&wide).into_iter().filter(|[from, to]| to + 1 - from >= BLOCKS);
    runs.filter(is_walk).collect()
}
