//! Reads numbers with a decimal comma or point and with or without separators of thousands.

/// Decimal mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Decimal {
    /// `1,234.5`
    Point,
    /// `1.234,5`
    Comma,
}

/// Content of a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cell {
    Number(f64),
    /// No value: an empty field or a word such as `NaN` or `n/a`.
    Missing,
    Text,
}

/// Words that stand for a missing value, in lower case.
const MISSING: [&str; 9] = ["", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--"];

/// Reads a field with this decimal mark.
pub(super) fn cell(field: &str, decimal: Decimal) -> Cell {
    let field = field.trim();
    if MISSING.iter().any(|word| word.eq_ignore_ascii_case(field)) {
        return Cell::Missing;
    }
    number(field, decimal).map_or(Cell::Text, Cell::Number)
}

fn number(field: &str, decimal: Decimal) -> Option<f64> {
    // Words that parse as numbers (`inf`) are not measured values.
    if !field.bytes().any(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let (mark, thousands) = match decimal {
        Decimal::Point => ('.', ','),
        Decimal::Comma => (',', '.'),
    };
    let separators = [thousands, '\''];
    // Most fields can be read as they are.
    if !field.contains([mark, thousands, '\'']) || (mark == '.' && !field.contains(separators)) {
        return finite(field);
    }
    let whole = field.find([mark, 'e', 'E']).map_or(field, |at| &field[..at]);
    let mut groups = whole.trim_start_matches(['+', '-']).split(separators);
    let first = groups.next().unwrap_or_default();
    let mut others = groups.peekable();
    let grouped = others.peek().is_none()
        || ((1..=3).contains(&first.len()) && others.all(|group| group.len() == 3));
    let kept = field.chars().filter(|letter| !separators.contains(letter));
    let plain: String = kept.map(|letter| if letter == mark { '.' } else { letter }).collect();
    if grouped { finite(&plain) } else { None }
}

fn finite(plain: &str) -> Option<f64> {
    plain.parse::<f64>().ok().filter(|number| number.is_finite())
}

/// Largest magnitude that is accepted as measured, in any unit; calculations with larger numbers
/// would overflow.
const LARGEST: f64 = 1e30;
const SMALLEST: f64 = 1e-30;

/// Returns a message if a number is too large to have been measured.
pub(super) fn is_too_large(number: f64) -> Option<String> {
    (number.abs() > LARGEST)
        .then(|| format!("{number:e} is larger than anything measured; correct or delete the row"))
}

/// Returns a message if the largest magnitude is too small to have been measured, but not 0.
pub(super) fn are_too_small(numbers: &[f64]) -> Option<String> {
    let largest = numbers.iter().fold(0.0, |most: f64, number| most.max(number.abs()));
    (largest > 0.0 && largest < SMALLEST).then(|| {
        format!(
            "{largest:e} is the largest value, smaller than anything measured; correct the column"
        )
    })
}

/// Returns the decimal mark of these fields: a comma if some field is a number only with it, or if
/// commas are the only marks. If commas also separate the fields, the comma of a quoted `1,234`
/// separates thousands.
pub(super) fn decimal<'a>(fields: impl Iterator<Item = &'a str>, delimiter: char) -> Decimal {
    let (mut point, mut comma) = (0_usize, 0_usize);
    for field in fields.filter(|field| field.contains([',', '.'])) {
        let marks = [Decimal::Point, Decimal::Comma].map(|mark| number(field, mark).is_some());
        match marks {
            [false, true] => comma += 1,
            // `1,234` and `1.234` are ambiguous; most measured numbers have decimals, so the mark
            // counts as decimal.
            [true, true] if field.contains(',') => comma += usize::from(delimiter != ','),
            [true, _] => point += 1,
            [false, false] => {}
        }
    }
    if comma > point { Decimal::Comma } else { Decimal::Point }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_with_either_mark_and_with_thousands() {
        for (field, mark, value) in [
            ("1.82", Decimal::Point, 1.82),
            ("-1,234.5", Decimal::Point, -1234.5),
            ("1,82", Decimal::Comma, 1.82),
            ("1.234,5", Decimal::Comma, 1234.5),
            ("1'234.5", Decimal::Point, 1234.5),
            ("2.5e-3", Decimal::Point, 2.5e-3),
            ("2,5E-3", Decimal::Comma, 2.5e-3),
            (" +7 ", Decimal::Point, 7.0),
            (".5", Decimal::Point, 0.5),
        ] {
            assert_eq!(cell(field, mark), Cell::Number(value), "{field}");
        }
        for field in ["1.8.2", "12:30:01", "3 um", "inf", "1e999", "1,82"] {
            assert_eq!(cell(field, Decimal::Point), Cell::Text, "{field}");
        }
        assert_eq!(cell("NaN", Decimal::Point), Cell::Missing);
    }

    #[test]
    fn the_mark_is_what_makes_numbers_of_most_fields() {
        let of = |fields: &[&str]| decimal(fields.iter().copied(), ';');
        assert_eq!(of(&["0,05", "1,9999"]), Decimal::Comma);
        assert_eq!(of(&["1,234.5", "0.2"]), Decimal::Point);
        assert_eq!(of(&["1.234,5", "0,2"]), Decimal::Comma);
        assert_eq!(of(&["1", "2"]), Decimal::Point);
    }
}
