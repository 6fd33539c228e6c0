//! Natural order of file names.

use std::cmp::Ordering;

/// Compares names with their numbers by value: `frame2` comes before `frame10`.
///
/// # Example
/// ```
/// use myospring::microscopy::film::in_natural_order;
/// let mut names = ["t10.png", "t9.png", "t09b.png", "s11.png"];
/// names.sort_by(|a, b| in_natural_order(a, b));
/// assert_eq!(names, ["s11.png", "t9.png", "t09b.png", "t10.png"]);
/// ```
pub fn in_natural_order(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a, b);
    loop {
        let digits = [left, right].map(|text| text.bytes().take_while(u8::is_ascii_digit).count());
        let ordering = if digits[0] > 0 && digits[1] > 0 {
            let numbers = [&left[..digits[0]], &right[..digits[1]]]
                .map(|number| number.trim_start_matches('0'));
            left = &left[digits[0]..];
            right = &right[digits[1]..];
            let [a, b] = numbers;
            a.len().cmp(&b.len()).then_with(|| a.cmp(b))
        } else {
            let [first, other] = [left, right].map(|text| text.chars().next());
            let (Some(first_is), Some(other_is)) = (first, other) else {
                // Names that differ only in leading zeros, such as `t1` and `t01`.
                return first.cmp(&other).then_with(|| a.cmp(b));
            };
            left = &left[first_is.len_utf8()..];
            right = &right[other_is.len_utf8()..];
            first_is.cmp(&other_is)
        };
        if ordering.is_ne() {
            return ordering;
        }
    }
}
