//! Positions, velocities and forces of all nodes.

/// One vector per node, by axis: `vectors[axis][node]`.
pub type Vectors<const D: usize = 2> = [Vec<f64>; D];

/// Zero vectors for `count` nodes.
pub fn zeros<const D: usize>(count: usize) -> Vectors<D> {
    std::array::from_fn(|_| vec![0.0; count])
}

/// Returns the sum of `count` terms. Eight partial sums are added up in parallel, because each addition waits for the one before.
#[inline]
pub(crate) fn sum(count: usize, term: impl Fn(usize) -> f64) -> f64 {
    const BESIDE: usize = 8;
    let mut sums = [0.0; BESIDE];
    let whole = count - count % BESIDE;
    for first in (0..whole).step_by(BESIDE) {
        for (beside, sum) in sums.iter_mut().enumerate() {
            *sum += term(first + beside);
        }
    }
    (whole..count).map(term).sum::<f64>() + sums.iter().sum::<f64>()
}

/// Scalar product of the vectors of all nodes.
pub(crate) fn product<const D: usize>(a: &Vectors<D>, b: &Vectors<D>) -> f64 {
    a.iter().zip(b).map(|(a, b)| sum_of_products(a, b)).sum()
}

/// Scalar product of two rows of numbers, in eight partial sums.
fn sum_of_products(a: &[f64], b: &[f64]) -> f64 {
    let (mut sums, (a, b)) = ([0.0; 8], (a.chunks_exact(8), b.chunks_exact(8)));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    rest + sums.iter().sum::<f64>()
}

/// Largest absolute value; NaN if one is NaN.
pub(crate) fn largest<const D: usize>(vectors: &Vectors<D>) -> f64 {
    let larger = |size: f64, value: &f64| {
        if size.is_nan() || value.is_nan() { f64::NAN } else { size.max(value.abs()) }
    };
    vectors.iter().flatten().fold(0.0, larger)
}

/// Adds a multiple of the vectors of all nodes to others.
pub(crate) fn add_scaled<const D: usize>(sum: &mut Vectors<D>, factor: f64, other: &Vectors<D>) {
    for (sum, other) in sum.iter_mut().zip(other) {
        for (sum, other) in sum.iter_mut().zip(other) {
            *sum += factor * other;
        }
    }
}

/// Scalar product.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised loops that use it")]
pub(super) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let mut sum = a[0] * b[0];
    for axis in 1..D {
        sum += a[axis] * b[axis];
    }
    sum
}
