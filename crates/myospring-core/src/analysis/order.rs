//! Values by their order.

/// The value below which lies a part of some values, 0 to 1: one of them, of two that are as near the larger; `None` of
/// no values.
///
/// # Example
/// ```
/// use myospring::analysis::order::quantile;
/// assert_eq!(quantile([3.0, 1.0, 2.0, 5.0], 0.9), Some(5.0));
/// assert_eq!(quantile([0.0_f32; 0], 0.9), None);
/// ```
pub fn quantile<T: Copy + Into<f64>>(values: impl IntoIterator<Item = T>, part: f64) -> Option<T> {
    let mut values: Vec<T> = values.into_iter().collect();
    let at = (values.len().checked_sub(1)? as f64 * part.clamp(0.0, 1.0)).round() as usize;
    let by_value = |a: &T, b: &T| (*a).into().total_cmp(&(*b).into());
    Some(*values.select_nth_unstable_by(at, by_value).1)
}

/// The value in the middle; of an even number the upper of two.
///
/// # Example
/// ```
/// use myospring::analysis::order::median;
/// assert_eq!(median([3.0, 1.0, 2.0, 5.0]), Some(3.0));
/// ```
pub fn median<T: Copy + Into<f64>>(values: impl IntoIterator<Item = T>) -> Option<T> {
    quantile(values, 0.5)
}
