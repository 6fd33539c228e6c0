//! Chooses the lattice squares or cubes of the mesh: the most covered connected ones. Squares are one layer of cubes.

use std::ops::RangeInclusive;

/// A rule for the cut: which neighbours in the order count as equal, the range of coverage (in
/// millionths), and the accepted area error.
type Rule<'a> = (&'a dyn Fn(usize, usize) -> bool, RangeInclusive<i64>, f64);

/// Squares kept for the mesh.
pub(super) struct Choice {
    /// Whether each square is kept.
    pub(super) kept: Vec<bool>,
    /// Number of kept squares.
    pub(super) count: usize,
    /// Number of squares that were covered enough but not connected by a side.
    pub(super) dropped: usize,
}

/// Keeps the most covered squares, as many as bring the largest connected piece nearest to
/// `target` squares.
///
/// Squares of equal coverage are kept or dropped together, so that straight sides stay straight and
/// symmetric cells symmetric; the threshold is between 0.3 and 0.7. If the area is then off by more
/// than 0.5 %, as for a straight side between two lattice lines, equal squares are distinguished by
/// their distance from the centre: the outermost row of such a side (more than half covered, since
/// the lattice is centred on the cell) loses its ends. If the area is still off by almost 1 %, in a
/// mesh of about a hundred squares, each square is decided separately.
pub(super) fn choose(coverage: &[f64], shape: [usize; 3], target: f64) -> Choice {
    // Coverage in steps of 1e-6, so that rounding does not distinguish equal squares.
    let level = |square: u32| (coverage[square as usize] * 1e6).round() as i64;
    let distance = |square: u32| {
        let along = |at: usize, count: usize| (2 * at + 1).abs_diff(count).pow(2);
        let at = place(square as usize, shape);
        (0..3).map(|axis| along(at[axis], shape[axis])).sum::<usize>()
    };
    let mut order: Vec<u32> =
        (0..coverage.len() as u32).filter(|&square| level(square) >= 300_000).collect();
    order.sort_by_key(|&square| (-level(square), distance(square), square));
    let levels: Vec<i64> = order.iter().map(|&square| level(square)).collect();

    let same_distance = |a: usize, b: usize| distance(order[a]) == distance(order[b]);
    let rules: [Rule; 3] = [
        (&|_, _| true, 300_000..=700_000, 0.005),
        (&same_distance, 300_000..=999_999, 0.009),
        (&|_, _| false, 300_000..=999_999, 0.0),
    ];
    let off = |choice: &Choice| (choice.count as f64 - target).abs();
    let mut best: Option<Choice> = None;
    for (equal, range, content) in rules {
        let choice = best_cut(&order, shape, target, &cuts(&levels, &range, equal));
        let better = best.as_ref().is_none_or(|best| off(&choice) < off(best));
        best = if better { Some(choice) } else { best };
        if best.as_ref().is_some_and(|best| off(best) <= content * target) {
            break;
        }
    }
    best.unwrap_or_else(|| largest_piece(&order, shape))
}

/// Possible numbers of kept squares in the order: ends of classes of equal squares; all squares
/// above the range are kept, and none below it.
fn cuts(
    levels: &[i64],
    range: &RangeInclusive<i64>,
    equal: impl Fn(usize, usize) -> bool,
) -> Vec<usize> {
    let first = levels.partition_point(|level| level > range.end());
    let last = levels.partition_point(|level| level >= range.start());
    (first..=last)
        .filter(|&end| {
            end == 0
                || end == levels.len()
                || levels[end - 1] != levels[end]
                || !equal(end - 1, end)
        })
        .collect()
}

/// The cut whose largest piece is nearest to `target`; adding squares never makes the piece
/// smaller.
fn best_cut(order: &[u32], shape: [usize; 3], target: f64, cuts: &[usize]) -> Choice {
    let at = |cut: usize| largest_piece(&order[..cut], shape);
    let enough = cuts.partition_point(|&cut| (at(cut).count as f64) < target);
    let [above, below] = [cuts.get(enough), cuts[..enough].last()].map(|cut| cut.map(|&n| at(n)));
    match (below, above) {
        (Some(below), Some(above)) => {
            let off = |choice: &Choice| (choice.count as f64 - target).abs();
            if off(&below) < off(&above) { below } else { above }
        }
        (Some(only), None) | (None, Some(only)) => only,
        (None, None) => at(0),
    }
}

/// Column, row and layer.
fn place(square: usize, [columns, rows, _]: [usize; 3]) -> [usize; 3] {
    [square % columns, square / columns % rows, square / (columns * rows)]
}

/// The largest piece of squares joined by their sides, or of cubes joined by their faces; of equal ones the lowest.
fn largest_piece(squares: &[u32], shape: [usize; 3]) -> Choice {
    const OUT: u32 = 0;
    const NEW: u32 = 1;
    let [columns, rows, layers] = shape;
    let mut piece = vec![OUT; columns * rows * layers];
    for &square in squares {
        piece[square as usize] = NEW;
    }
    let (mut name, mut best, mut best_size) = (NEW, NEW, 0);
    let mut stack = Vec::new();
    for start in 0..piece.len() {
        if piece[start] != NEW {
            continue;
        }
        name += 1;
        let mut size = 0;
        piece[start] = name;
        stack.push(start);
        while let Some(square) = stack.pop() {
            size += 1;
            let [i, j, k] = place(square, shape);
            let mut visit = |other: usize| {
                if piece[other] == NEW {
                    piece[other] = name;
                    stack.push(other);
                }
            };
            if i > 0 {
                visit(square - 1);
            }
            if i + 1 < columns {
                visit(square + 1);
            }
            if j > 0 {
                visit(square - columns);
            }
            if j + 1 < rows {
                visit(square + columns);
            }
            if k > 0 {
                visit(square - columns * rows);
            }
            if k + 1 < layers {
                visit(square + columns * rows);
            }
        }
        if size > best_size {
            (best, best_size) = (name, size);
        }
    }
    let kept = piece.into_iter().map(|name| name == best && best_size > 0).collect();
    Choice { kept, count: best_size, dropped: squares.len() - best_size }
}
