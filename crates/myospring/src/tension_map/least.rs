//! Least squares of numbers that are not negative.

use nalgebra::{DMatrix, DVector};

/// Rounds in which all numbers that violate a condition change sides at once; after them one
/// changes per round, which is guaranteed to end.
const AT_ONCE: usize = 20;
const ROUNDS: usize = 500;

/// The x >= 0 with the least `x.(H x)/2 - b.x`, for a positive definite H, by an active set (`lawson_hanson_1974`).
pub(super) fn not_negative(h: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let count = b.len();
    let mut free = vec![true; count];
    let mut x = DVector::zeros(count);
    let scale = b.amax().max(f64::MIN_POSITIVE);
    for round in 0..ROUNDS {
        let places: Vec<usize> = (0..count).filter(|&at| free[at]).collect();
        let part = h.select_rows(&places).select_columns(&places);
        let found = part.cholesky()?.solve(&b.select_rows(&places));
        x.fill(0.0);
        for (&place, value) in places.iter().zip(found.iter()) {
            x[place] = *value;
        }
        let worst = places.iter().copied().min_by(|&a, &b| x[a].total_cmp(&x[b]))?;
        if x[worst] < 0.0 {
            if round < AT_ONCE {
                places.iter().filter(|&&at| x[at] < 0.0).for_each(|&at| free[at] = false);
            } else {
                free[worst] = false;
            }
            continue;
        }
        let slope = h * &x - b;
        let wrong = (0..count).filter(|&at| !free[at]);
        let most = wrong.min_by(|&a, &b| slope[a].total_cmp(&slope[b]));
        match most.filter(|&at| slope[at] < -1e-9 * scale) {
            Some(at) => free[at] = true,
            None => return Some(x),
        }
    }
    Some(x.map(|value| value.max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_be_negative_is_0_and_the_others_know_it() {
        // Without the bound x is (-1, 3); with it the second number alone is sought: 4/2.
        let h = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let b = DVector::from_vec(vec![1.0, 5.0]);
        let x = not_negative(&h, &b).unwrap();
        assert!(x[0].abs() < 1e-15 && (x[1] - 2.5).abs() < 1e-12, "{x}");
        // What is inside is the plain answer.
        let inside = not_negative(&h, &DVector::from_vec(vec![4.0, 5.0])).unwrap();
        assert!((inside[0] - 1.0).abs() < 1e-12 && (inside[1] - 2.0).abs() < 1e-12);
    }
}
