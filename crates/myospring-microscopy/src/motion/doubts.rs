//! What a reader of a motion must know before the numbers are used.

use super::{CellMotion, FEWEST_PARTS};

/// Share of interpolated points from which on the user is told, per cent.
const MANY_INTERPOLATED_PCT: f64 = 30.0;
/// Share of interpolated points above which a frame shows too little of the cell: with more than half of them missing,
/// neighbours that were found no longer surround those that were not.
const UNSEEN: f64 = 0.5;
/// Part of its excursion by which a cell may be longer than at rest.
const LONGER: f64 = 0.5;

impl CellMotion {
    /// Indices of the frames in which at least half of the points were found, or of all frames if there is none. Only
    /// these count for the largest contraction: a black or blurred frame shows no motion of the cell.
    pub fn frames_with_cell(&self) -> Vec<usize> {
        let seen: Vec<usize> =
            (0..self.len()).filter(|&at| self.interpolated_share(at) <= UNSEEN).collect();
        if seen.is_empty() { (0..self.len()).collect() } else { seen }
    }

    /// What limits the numbers of this motion, in sentences: sarcomeres that are too few for a mean, many interpolated points,
    /// a cell that hardly moves, a frame at rest that is none.
    pub fn doubts(&self) -> Vec<String> {
        let all = [self.without_sarcomeres(), self.much_interpolated(), self.without_rest()];
        all.into_iter().flatten().collect()
    }

    /// Whether the cell neither shortens, lengthens nor strains by more than its noise.
    pub fn hardly_moves(&self) -> bool {
        let (lengths, stretches) = (self.lengths_um(), self.stretches());
        let rest = lengths[self.rest_index()];
        let moves = |at: usize| {
            let changed = 100.0 * (1.0 - lengths[at] / rest).abs();
            changed.max(100.0 * (1.0 - stretches[at].smaller))
        };
        let most = self.frames_with_cell().into_iter().map(moves).fold(0.0, f64::max);
        most < self.least_contraction_pct()
    }

    fn without_sarcomeres(&self) -> Option<String> {
        let none = self.sarcomere_places > 0 && self.sarcomeres_by_part_um.is_empty();
        none.then(|| {
            format!(
                "there is no sarcomere_um: stripes can be read in nearly all frames at {} places in {} parts of the \
                 cell only, and sarcomeres differ from part to part, so fewer than {FEWEST_PARTS} parts say little of \
                 the cell",
                self.sarcomere_places, self.sarcomere_parts
            )
        })
    }

    fn much_interpolated(&self) -> Option<String> {
        let shares = (0..self.len()).map(|at| (at, 100.0 * self.interpolated_share(at)));
        let many: Vec<(usize, f64)> =
            shares.filter(|(_, pct)| *pct > MANY_INTERPOLATED_PCT).collect();
        let (at, pct) = many.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let unseen = match self.len() - self.frames_with_cell().len() {
            0 => String::new(),
            unseen => format!(
                "; {unseen} of them, with more than {:.0} %, do not count for the largest contraction",
                100.0 * UNSEEN
            ),
        };
        Some(format!(
            "in {} frames more than {MANY_INTERPOLATED_PCT} % of the points were not found again but interpolated from \
             their neighbours (frame {}: {pct:.0} %){unseen}",
            many.len(),
            self.frames[*at]
        ))
    }

    fn without_rest(&self) -> Option<String> {
        let lengths = self.lengths_um();
        let rest = lengths[self.rest_index()];
        let seen = self.frames_with_cell();
        let shortening = || seen.iter().map(|&at| 100.0 * (1.0 - lengths[at] / rest));
        let shortest = shortening().fold(0.0, f64::max);
        let longest = shortening().map(|pct| -pct).fold(0.0, f64::max);
        let error_pct = 100.0 * self.error_um.unwrap_or(0.0) / rest;
        let least = self.least_contraction_pct();
        if self.hardly_moves() {
            return Some(format!(
                "the cell hardly moves: it shortens by {shortest:.3} % at most, while the noise makes an error of \
                 {error_pct:.3} %"
            ));
        }
        (longest > least.max(LONGER * (shortest + longest))).then(|| {
            format!(
                "the cell is up to {longest:.1} % longer than in frame {}, which was taken for rest; choose it with \
                 --frame",
                self.rest
            )
        })
    }
}
