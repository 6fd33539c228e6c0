//! Texts that are safe to print and short enough to read.

/// Letters of a message that are printed, and of a word in it: a field of a damaged file may be as long as the file.
const LONGEST: usize = 6000;
const LONGEST_WORD: usize = 300;
/// Digits of a number that is printed as it is.
const MOST_DIGITS: usize = 30;

/// A text whose control characters are escaped, so that a file name cannot control the terminal.
#[must_use]
pub fn visible(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        if letter.is_control() && !['\n', '\t'].contains(&letter) {
            plain.extend(letter.escape_default());
        } else {
            plain.push(letter);
        }
    }
    plain
}

/// A message that is safe to print and short enough to read.
#[must_use]
pub fn message(text: &str) -> String {
    let text = with_powers(text);
    let words = text.split_inclusive(char::is_whitespace).map(|word| shortened(word, LONGEST_WORD));
    visible(&shortened(&words.collect::<String>(), LONGEST))
}

/// A text in which numbers with very many digits are written with a power of ten: `1e300`.
#[must_use]
pub fn with_powers(text: &str) -> String {
    let mut short = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(|letter: char| letter.is_ascii_digit()) {
        let (before, from) = rest.split_at(at);
        let end = from.find(|letter: char| !letter.is_ascii_digit() && letter != '.');
        // A full stop ends the sentence.
        let number = from[..end.unwrap_or(from.len())].trim_end_matches('.');
        let value = number.parse::<f64>().ok().filter(|value| value.is_finite());
        short.push_str(before);
        match value {
            Some(value) if number.len() > MOST_DIGITS => short.extend([format!("{value:e}")]),
            _ => short.push_str(number),
        }
        rest = &from[number.len()..];
    }
    short + rest
}

/// A number for people: four significant digits, no trailing noise.
#[must_use]
pub fn number(value: f64) -> String {
    let size = value.abs();
    let decimals = match size {
        _ if size >= 1000.0 => 0,
        _ if size >= 100.0 => 1,
        _ if size >= 1.0 => 2,
        _ => 3,
    };
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { text.trim_start_matches('-').to_owned() } else { text }
}

/// The start and the end of a text that is longer.
fn shortened(text: &str, longest: usize) -> String {
    let length = text.chars().count();
    if length <= longest {
        return text.to_owned();
    }
    let start: String = text.chars().take(longest * 2 / 3).collect();
    let end: String = text.chars().skip(length - longest / 4).collect();
    format!("{start} ... ({length} characters) ... {end}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_from_files_neither_moves_the_cursor_nor_fills_the_terminal() {
        assert_eq!(message("a\u{1b}[2Jb.csv\nc"), "a\\u{1b}[2Jb.csv\nc");
        let zeros = "0".repeat(300);
        let numbers = message(&format!("v1.2 is 1{zeros} um, -0.{zeros}5, 12.50 kPa and 20 nm."));
        assert_eq!(numbers, "v1.2 is 1e300 um, -5e-301, 12.50 kPa and 20 nm.");
        let long = message(&format!("`{}` is no number", "9".repeat(100_000)));
        assert!(long.len() < 400 && long.contains(" characters) "), "{long}");
        assert!(long.ends_with("9` is no number"), "{long}");
        assert!(message(&"9 ".repeat(100_000)).len() < 7000);
    }
}
