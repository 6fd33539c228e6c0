//! The rows as lines on the terminal and as a page.

use serde::Deserialize;
use std::fmt::Write as _;

/// The finite-element twitch beside ours, in `docs`.
pub(crate) const FIGURE: &str = "pictures/verification_twitch.svg";

/// Rows of one check.
pub(crate) struct Section {
    pub(crate) title: &'static str,
    pub(crate) rows: Vec<Row>,
    pub(crate) seconds: f64,
}

/// One comparison, as both sides write it (`verification/src/row.rs`).
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Row {
    what: String,
    against: String,
    /// None for what is not a number.
    measured: Option<f64>,
    expected: Option<f64>,
    tolerance: Option<f64>,
    unit: String,
    reason: String,
    verdict: String,
}

impl Row {
    fn without_numbers(what: &str, against: &str, reason: &str, verdict: &str) -> Self {
        Self {
            what: what.to_owned(),
            against: against.to_owned(),
            measured: None,
            expected: None,
            tolerance: None,
            unit: String::new(),
            reason: reason.to_owned(),
            verdict: verdict.to_owned(),
        }
    }

    /// A check that broke.
    pub(crate) fn failed(what: &str, error: &str) -> Self {
        Self::without_numbers(what, "", error, "fail")
    }

    /// A check whose program is missing.
    pub(crate) fn skipped(what: &str, against: &str, missing: &str) -> Self {
        Self::without_numbers(what, against, missing, "skipped")
    }

    fn numbers(&self) -> [String; 2] {
        let Some(measured) = self.measured else { return [String::new(), String::new()] };
        let expected = self.expected.unwrap_or_default();
        // What should vanish is a size, what should be a number is shown beside it.
        let trimmed = |text: String| {
            let whole = |part: &str| part.trim_end_matches('0').trim_end_matches('.').to_owned();
            if text.contains('.') { whole(&text) } else { text }
        };
        let size = |value: f64| {
            let small = value != 0.0 && value.abs() < 0.01;
            if small {
                format!("{value:.1e}").replace(".0e", "e")
            } else {
                trimmed(format!("{value:.3}"))
            }
        };
        let shown = |value: f64| if expected == 0.0 { size(value) } else { format!("{value:.4}") };
        let allowed = match self.tolerance {
            Some(tolerance) if expected == 0.0 => size(tolerance),
            Some(tolerance) => {
                format!("{} ± {}", trimmed(format!("{expected:.4}")), size(tolerance))
            }
            None if expected == 0.0 => String::new(),
            None => format!("{expected:.4}"),
        };
        [shown(measured), allowed]
    }
}

/// Rows with a verdict.
pub(crate) fn count(sections: &[Section], verdict: &str) -> usize {
    let rows = sections.iter().flat_map(|section| &section.rows);
    rows.filter(|row| row.verdict == verdict).count()
}

/// A row on the terminal.
pub(crate) fn line(row: &Row) -> String {
    let [measured, allowed] = row.numbers();
    let verdict = row.verdict.to_uppercase();
    let unit = if row.unit.is_empty() { String::new() } else { format!(" ({})", row.unit) };
    let mut line = format!("{verdict:8}{measured:>9}  {allowed:>12}  {}{unit}\n", row.what);
    if row.verdict != "pass" {
        _ = writeln!(line, "{:33}{}", "", row.reason);
    }
    line
}

/// The last words on the terminal.
pub(crate) fn summary(sections: &[Section]) -> String {
    let mut text = String::from("\n");
    for section in sections {
        _ = writeln!(
            text,
            "{:40}{:>3} rows {:>6.1} s",
            section.title,
            section.rows.len(),
            section.seconds
        );
    }
    let [pass, fail, noted, skipped] =
        ["pass", "fail", "noted", "skipped"].map(|verdict| count(sections, verdict));
    _ = writeln!(
        text,
        "\n{pass} passed, {fail} FAILED, {skipped} SKIPPED, {noted} noted without a verdict"
    );
    text
}

/// The page.
pub(crate) fn page(sections: &[Section], machine: &str, figure: bool) -> String {
    let mut text = String::from(
        "# Verification\n\n\
         Made by `cargo xtask verify`; do not edit. Each row compares Myospring with a closed form or with a \
         program we did not write. *Measured* is the difference, or the number compared with what it should be. \
         *Notes* are listed below each table: a letter says what it was compared with, a number the reason of the \
         tolerance. PASS: within the tolerance. NOTED: no tolerance, because the two are not the same model; the \
         note explains the difference. SKIPPED: a program was missing. Of four or more rows with the same tolerance \
         only the worst is listed.\n\n\
         The sources of the checks are in `verification/`; quick forms of them run in `cargo xtask test`.\n\n",
    );
    let [pass, fail, noted, skipped] =
        ["pass", "fail", "noted", "skipped"].map(|verdict| count(sections, verdict));
    _ = writeln!(
        text,
        "{pass} passed, {fail} failed, {skipped} skipped, {noted} noted. Measured on {machine}."
    );
    for Section { title, rows, .. } in sections {
        _ = writeln!(text, "\n## {title}\n");
        text.push_str("| what | measured | should be, or at most | | verdict | notes |\n");
        text.push_str("|---|---|---|---|---|---|\n");
        let (mut against, mut reasons) = (Notes::default(), Notes::default());
        for (row, like_it) in listed(rows) {
            let [measured, allowed] = row.numbers();
            let verdict = row.verdict.to_uppercase();
            let [mut what, unit] = [&row.what, &row.unit].map(|text| cell(text));
            if like_it > 1 {
                _ = write!(what, " (worst of {like_it} rows)");
            }
            let place = against.place(&row.against);
            let letter = char::from(b'a' + u8::try_from(place % 26).unwrap_or_default());
            let number = reasons.place(&row.reason) + 1;
            _ = writeln!(
                text,
                "| {what} | {measured} | {allowed} | {unit} | {verdict} | {letter}{number} |"
            );
        }
        text.push('\n');
        for (letter, note) in ('a'..='z').zip(&against.texts) {
            _ = writeln!(text, "- {letter}: {note}");
        }
        for (place, note) in reasons.texts.iter().enumerate() {
            _ = writeln!(text, "- {}: {note}", place + 1);
        }
    }
    if figure {
        _ = write!(
            text,
            "\n![Shortening over time of the finite elements and of Myospring, equal at the peak](../{FIGURE})\n\n\
             *One cell of finite elements in a matrix and our strip in an elastic bed under the same tension. One \
             incompressible exponential fibre lies on the curve of the finite elements: the law of the \
             material makes the difference.*\n"
        );
    }
    text
}

/// From this number on, rows that pass with the same tolerance are listed as one.
const FOLDED: usize = 4;

/// The rows that the page lists, each with the number of rows that it represents.
fn listed(rows: &[Row]) -> Vec<(&Row, usize)> {
    let key = |row: &Row| {
        let vanishes = row.expected == Some(0.0) && row.verdict == "pass";
        vanishes.then(|| (row.against.clone(), row.tolerance.map(f64::to_bits), row.unit.clone()))
    };
    let mut listed: Vec<(&Row, usize)> = Vec::new();
    for row in rows {
        let like_it: Vec<&Row> =
            rows.iter().filter(|other| key(row).is_some() && key(other) == key(row)).collect();
        let size = |row: &&Row| row.measured.unwrap_or_default().abs();
        let worst = like_it.iter().copied().max_by(|a, b| size(a).total_cmp(&size(b)));
        match worst.filter(|_| like_it.len() >= FOLDED) {
            None => listed.push((row, 1)),
            Some(worst) if std::ptr::eq(row, worst) => listed.push((row, like_it.len())),
            Some(_) => {}
        }
    }
    listed
}

/// Texts below a table, each once.
#[derive(Default)]
struct Notes<'a> {
    texts: Vec<&'a str>,
    last: usize,
}

impl<'a> Notes<'a> {
    /// The place of a text, which is added where it is new. "as above" is the text before it.
    fn place(&mut self, text: &'a str) -> usize {
        if text == "as above" && !self.texts.is_empty() {
            return self.last;
        }
        self.last = self.texts.iter().position(|note| *note == text).unwrap_or_else(|| {
            self.texts.push(text);
            self.texts.len() - 1
        });
        self.last
    }
}

/// Text that does not break a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_rows_with_one_tolerance_the_worst_is_listed() {
        let row = |measured: f64, tolerance: f64, verdict: &str| Row {
            measured: Some(measured),
            expected: Some(0.0),
            tolerance: Some(tolerance),
            ..Row::without_numbers("positions", "LAMMPS", "rounding", verdict)
        };
        let mut rows: Vec<Row> = [1e-12, 3e-12, 2e-12].map(|by| row(by, 1e-9, "pass")).into();
        let shown = |rows: &[Row]| -> Vec<(Option<f64>, usize)> {
            listed(rows).into_iter().map(|(row, like_it)| (row.measured, like_it)).collect()
        };
        assert_eq!(shown(&rows).len(), 3);
        rows.extend([row(1e-12, 1e-9, "pass"), row(1e-3, 1e-2, "pass"), row(1.0, 1e-9, "fail")]);
        assert_eq!(shown(&rows), [(Some(3e-12), 4), (Some(1e-3), 1), (Some(1.0), 1)]);
    }
}
