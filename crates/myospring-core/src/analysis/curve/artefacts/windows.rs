//! Openings and closings by flat windows of increasing width: each removes pulses narrower than it,
//! in both directions.

use std::collections::VecDeque;

/// Widths of windows minus one, frames: each a third wider than the previous one, up to a sixth of
/// the curve.
pub(super) fn widths(count: usize) -> Vec<usize> {
    let mut widths = vec![0];
    let mut next = 1;
    while (next + 1) * 6 <= count {
        widths.push(next);
        next = (next + 1).max(next * 4 / 3);
    }
    widths
}

/// The curve after each of a series of growing windows; each filter is applied to the result of the
/// previous one.
pub(super) fn behind(values: &[f64], windows: &[usize]) -> Vec<Vec<f64>> {
    let mut all: Vec<Vec<f64>> = Vec::new();
    for &window in windows {
        let last = all.last().map_or(values, Vec::as_slice);
        all.push(if window == 0 { values.to_vec() } else { open_and_close(last, window) });
    }
    all
}

/// The mean of closing after opening and of opening after closing by a flat window of `window + 1`
/// frames that lies within the curve.
fn open_and_close(values: &[f64], window: usize) -> Vec<f64> {
    let first = close(&open(values, window), window);
    let second = open(&close(values, window), window);
    first.iter().zip(second).map(|(first, second)| 0.5 * (first + second)).collect()
}

fn open(values: &[f64], window: usize) -> Vec<f64> {
    let lowest = extremes(values, window, |new, old| new <= old);
    spread(&lowest, window, values.len(), |new, old| new >= old)
}

fn close(values: &[f64], window: usize) -> Vec<f64> {
    let highest = extremes(values, window, |new, old| new >= old);
    spread(&highest, window, values.len(), |new, old| new <= old)
}

/// The extreme of each window that lies within the values: of `at..=at + window`.
fn extremes(values: &[f64], window: usize, wins: fn(f64, f64) -> bool) -> Vec<f64> {
    let mut queue: VecDeque<usize> = VecDeque::new();
    let mut found = Vec::with_capacity(values.len().saturating_sub(window));
    for (at, &value) in values.iter().enumerate() {
        while queue.back().is_some_and(|&last| wins(value, values[last])) {
            queue.pop_back();
        }
        queue.push_back(at);
        if queue.front().is_some_and(|&first| first + window < at) {
            queue.pop_front();
        }
        if let Some(&first) = queue.front()
            && at >= window
        {
            found.push(values[first]);
        }
    }
    found
}

/// For each of `count` frames the extreme over the windows that contain it.
fn spread(of_windows: &[f64], window: usize, count: usize, wins: fn(f64, f64) -> bool) -> Vec<f64> {
    let mut queue: VecDeque<usize> = VecDeque::new();
    let mut found = Vec::with_capacity(count);
    for at in 0..count {
        if let Some(&value) = of_windows.get(at) {
            while queue.back().is_some_and(|&last| wins(value, of_windows[last])) {
                queue.pop_back();
            }
            queue.push_back(at);
        }
        if queue.front().is_some_and(|&first| first + window < at) {
            queue.pop_front();
        }
        found.push(queue.front().map_or(0.0, |&first| of_windows[first]));
    }
    found
}

/// The moving mean over the window, with fewer frames at the ends.
pub(super) fn mean_over(values: &[f64], window: usize) -> Vec<f64> {
    if window == 0 {
        return values.to_vec();
    }
    let mut sums = Vec::with_capacity(values.len() + 1);
    let (ground, mut sum) = (values[0], 0.0);
    sums.push(0.0);
    for value in values {
        sum += value - ground;
        sums.push(sum);
    }
    let half = window / 2;
    (0..values.len())
        .map(|at| {
            let (from, to) = (at.saturating_sub(half), (at + half + 1).min(values.len()));
            ground + (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}
