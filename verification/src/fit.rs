//! Small helpers of the checks: orders, largest differences, best affine maps.

use myospring::mechanics::Vectors;

/// Order of convergence from a quantity at step h, h/2 and h/4: `log2((q_1 - q_2)/(q_2 - q_4))`.
pub fn order(values: [f64; 3]) -> f64 {
    ((values[0] - values[1]) / (values[1] - values[2])).abs().log2()
}

/// Slope of the straight line through points by least squares.
pub fn slope(x: &[f64], y: &[f64]) -> f64 {
    let count = x.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
    let (mx, my) = (mean(x), mean(y));
    let above: f64 = x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum();
    above / x.iter().map(|x| (x - mx) * (x - mx)).sum::<f64>()
}

/// The largest distance between the nodes of two shapes, um.
pub fn farthest<const D: usize>(a: &Vectors<D>, b: &Vectors<D>) -> f64 {
    let apart = |node: usize| a.iter().zip(b).map(|(a, b)| a[node] - b[node]).fold(0.0, f64::hypot);
    (0..a[0].len()).map(apart).fold(0.0, f64::max)
}

/// Of two numbers the one that is further from 0.
pub fn furthest(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

/// The affine map that brings resting points nearest to their positions by least squares, and the
/// largest distance that remains, um.
///
/// Returns `G` of `x = G X + t` as `[[xx, xy], [yx, yy]]`.
pub fn affine(rest: &Vectors, now: &Vectors) -> ([[f64; 2]; 2], f64) {
    let count = rest[0].len() as f64;
    let centred = |values: &[f64]| -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / count;
        values.iter().map(|value| value - mean).collect()
    };
    let (before, after) = ([0, 1].map(|k| centred(&rest[k])), [0, 1].map(|k| centred(&now[k])));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // G = (sum x X^T) (sum X X^T)^-1
    let [xx, xy, yy] = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| dot(&before[i], &before[j]));
    let determinant = xx * yy - xy * xy;
    let map = [0, 1].map(|row| {
        let (bx, by) = (dot(&after[row], &before[0]), dot(&after[row], &before[1]));
        [(bx * yy - by * xy) / determinant, (by * xx - bx * xy) / determinant]
    });
    let mut residual = 0.0_f64;
    for node in 0..rest[0].len() {
        let off = [0, 1].map(|row| {
            after[row][node] - map[row][0] * before[0][node] - map[row][1] * before[1][node]
        });
        residual = residual.max(off[0].hypot(off[1]));
    }
    (map, residual)
}

/// The right stretch `U = sqrt(G^T G)` as `[xx, xy, yy]`: what is left of a map without rotation.
pub fn right_stretch(map: [[f64; 2]; 2]) -> [f64; 3] {
    let [[a, b], [c, d]] = map;
    let square = [a * a + c * c, a * b + c * d, b * b + d * d];
    // The root of a symmetric 2 x 2 matrix C: (C + sqrt(det C) I) / sqrt(tr C + 2 sqrt(det C)).
    let root = (square[0] * square[2] - square[1] * square[1]).sqrt();
    let scale = (square[0] + square[2] + 2.0 * root).sqrt();
    [(square[0] + root) / scale, square[1] / scale, (square[2] + root) / scale]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_affine_map_is_found_whatever_the_rotation() {
        let rest = [vec![0.0, 1.0, 0.0, 2.0], vec![0.0, 0.0, 1.0, 3.0]];
        let stretch = [[0.9, 0.1], [0.1, 1.2]];
        let (sine, cosine) = 0.7_f64.sin_cos();
        let map = [0, 1].map(|k| {
            [
                cosine * stretch[0][k] - sine * stretch[1][k],
                sine * stretch[0][k] + cosine * stretch[1][k],
            ]
        });
        let at = |row: usize| -> Vec<f64> {
            (0..4).map(|i| map[0][row] * rest[0][i] + map[1][row] * rest[1][i] + 5.0).collect()
        };
        let (found, residual) = affine(&rest, &[at(0), at(1)]);
        assert!(residual < 1e-14);
        let [xx, xy, yy] = right_stretch(found);
        for (value, exact) in [(xx, 0.9), (xy, 0.1), (yy, 1.2)] {
            assert!((value - exact).abs() < 1e-14, "{value} not {exact}");
        }
    }

    #[test]
    fn the_order_of_a_square_is_two() {
        assert!((order([1.0 + 16.0, 1.0 + 4.0, 1.0 + 1.0]) - 2.0).abs() < 1e-14);
    }
}
