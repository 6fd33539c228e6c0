//! Rounding of numbers in JSON and CSV that are read by people.
//!
//! Curves, shapes and everything that a program reads back (`traces.csv`, `frames.npz`, Parquet,
//! `members.csv`, `fit.json`, `run.toml`) are not rounded here.

/// Significant digits of numbers for people: at least one more than the precision of any result; a
/// time up to twenty minutes still has a resolution of 0.1 ms.
pub const DIGITS: usize = 7;

/// A number with [`DIGITS`] significant digits.
///
/// # Example
/// ```
/// use myospring::output::digits::rounded;
/// assert_eq!(rounded(12.007834512345), 12.00783);
/// assert_eq!(rounded(1_234_567.0), 1_234_567.0);
/// ```
pub fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// A number as exact text; very small and very large ones have an exponent.
///
/// # Example
/// ```
/// use myospring::output::digits::written;
/// assert_eq!(written(1e-97), "1e-97");
/// assert_eq!(written(0.00025), "0.00025");
/// ```
pub fn written(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-5..1e15).contains(&size) {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// A point or a direction in words: `(0, 1.5)`.
pub(crate) fn point(coordinates: &[f64]) -> String {
    let numbers: Vec<String> = coordinates.iter().map(f64::to_string).collect();
    format!("({})", numbers.join(", "))
}
