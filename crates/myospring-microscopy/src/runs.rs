//! Runs of pixels of one kind along rows, and the islands that they form.
//!
//! Numbering islands costs as much per run as it would cost per pixel, and there are few runs: some
//! ten thousand for the background of a picture of 10 000 x 10 000 pixels with a cell.

/// Adjacent pixels of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) row: usize,
    /// First column, and the one after the last.
    pub(super) from: usize,
    pub(super) to: usize,
    /// Number of its island, from 0 on in the order of their first pixels.
    pub(super) island: usize,
}

/// The runs of the pixels that have a kind, in the order of the pixels. Only pixels of the same
/// kind are connected; with `corners` also those that share only a corner.
pub(super) fn runs<Kind: PartialEq>(
    width: usize,
    height: usize,
    kind: impl Fn(usize) -> Option<Kind>,
    corners: bool,
) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let reach = usize::from(corners);
    // The first run of the row above.
    let mut above = 0;
    for row in 0..height {
        let first = runs.len();
        let start = row * width;
        let mut column = 0;
        while let Some(from) = (column..width).find(|column| kind(start + column).is_some()) {
            let own_kind = kind(start + from);
            let to = (from + 1..width).find(|column| kind(start + column) != own_kind);
            let to = to.unwrap_or(width);
            let own = runs.len();
            runs.push(Run { row, from, to, island: own });
            // Runs above that end before this one do not touch the following ones either.
            while above < first && runs[above].to + reach <= from {
                above += 1;
            }
            let mut other = above;
            while other < first && runs[other].from < to + reach {
                if kind(start - width + runs[other].from) == own_kind {
                    join(&mut runs, other, own);
                }
                other += 1;
            }
            column = to;
        }
        above = first;
    }
    // Until here, `island` was the index of another run of the same island, for the root its own.
    let mut islands = 0;
    for own in 0..runs.len() {
        let of = runs[own].island;
        runs[own].island = if of == own {
            islands += 1;
            islands - 1
        } else {
            runs[of].island
        };
    }
    runs
}

/// Joins the islands of two runs; the root is the first run.
fn join(runs: &mut [Run], a: usize, b: usize) {
    let (a, b) = (root(runs, a), root(runs, b));
    runs[a.max(b)].island = a.min(b);
}

/// The first run of an island, with path halving (Tarjan and van Leeuwen 1984).
fn root(runs: &mut [Run], mut run: usize) -> usize {
    while runs[run].island != run {
        runs[run].island = runs[runs[run].island].island;
        run = runs[run].island;
    }
    run
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Numbers pixel by pixel.
    fn by_looking(kinds: &[Option<u8>], width: usize, corners: bool) -> Vec<usize> {
        let height = kinds.len() / width;
        let mut numbers = vec![usize::MAX; kinds.len()];
        let mut next = 0;
        for first in 0..kinds.len() {
            if kinds[first].is_none() || numbers[first] != usize::MAX {
                continue;
            }
            let mut open = vec![first];
            numbers[first] = next;
            while let Some(at) = open.pop() {
                let (row, column) = (at / width, at % width);
                for y in row.saturating_sub(1)..(row + 2).min(height) {
                    for x in column.saturating_sub(1)..(column + 2).min(width) {
                        let (other, side) = (y * width + x, y == row || x == column);
                        let free = numbers[other] == usize::MAX && kinds[other] == kinds[first];
                        if (side || corners) && free {
                            numbers[other] = next;
                            open.push(other);
                        }
                    }
                }
            }
            next += 1;
        }
        numbers
    }

    proptest! {
        #[test]
        fn islands_of_runs_are_those_of_their_pixels(
            width in 1_usize..12,
            share in 0.0_f64..1.0,
            kinds in 1_u8..4,
            seeds in proptest::collection::vec((0.0_f64..1.0, 0_u8..12), 12..160),
        ) {
            let kind = |&(seed, kind): &(f64, u8)| (seed < share).then_some(kind % kinds);
            let height = seeds.len() / width;
            let pixels: Vec<Option<u8>> = seeds[..height * width].iter().map(kind).collect();
            for corners in [false, true] {
                let mut numbers = vec![usize::MAX; pixels.len()];
                for run in runs(width, height, |at| pixels[at], corners) {
                    numbers[run.row * width..][run.from..run.to].fill(run.island);
                }
                prop_assert_eq!(numbers, by_looking(&pixels, width, corners));
            }
        }
    }
}
