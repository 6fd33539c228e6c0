//! Detects alternans: every other beat is higher, by more than chance.

/// Least relative difference between even and odd beats for alternans.
const LEAST: f64 = 0.05;
/// Number of standard errors that chance explains.
const CHANCE: f64 = 4.0;

/// Alternans of a series of beats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alternans {
    /// Whether the higher beats have even (0) or odd (1) indices.
    pub higher: usize,
    /// How much lower the others are, % of the higher ones.
    pub percent: f64,
}

/// Alternans of the heights of beats, each with its index in the series; `None` without alternans,
/// or with fewer than four beats.
///
/// # Example
/// ```
/// use myospring::analysis::alternans::alternans;
/// let heights = [(0, 10.0), (1, 8.0), (2, 10.1), (3, 7.9), (4, 9.9), (5, 8.1)];
/// let found = alternans(&heights).unwrap();
/// assert!(found.higher == 0 && (found.percent - 20.0).abs() < 0.1);
/// assert_eq!(alternans(&[(0, 10.0), (1, 9.0), (2, 8.5), (3, 8.3)]), None);
/// ```
pub fn alternans(heights: &[(usize, f64)]) -> Option<Alternans> {
    let of = |odd: usize| -> Vec<f64> {
        heights.iter().filter(|(at, _)| at % 2 == odd).map(|(_, height)| *height).collect()
    };
    let (even, odd) = (of(0), of(1));
    if even.len() < 2 || odd.len() < 2 {
        return None;
    }
    let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
    let squares = |list: &[f64]| list.iter().map(|x| (x - mean(list)).powi(2)).sum::<f64>();
    let (a, b) = (mean(&even), mean(&odd));
    let difference = (a - b).abs();
    let free = (heights.len() - 2) as f64;
    let pooled = ((squares(&even) + squares(&odd)) / free).sqrt();
    let error = pooled * (1.0 / even.len() as f64 + 1.0 / odd.len() as f64).sqrt();
    let larger = a.max(b);
    (difference > LEAST * larger && difference > CHANCE * error)
        .then(|| Alternans { higher: usize::from(b > a), percent: 100.0 * difference / larger })
}
