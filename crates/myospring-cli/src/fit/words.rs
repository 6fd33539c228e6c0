//! Fits in words.

use super::Cell;
use crate::table::aligned;
use myospring::fit::{Estimate, Fit, FitVerdict, FittedCurve};
use std::fmt::Write as _;
use std::time::Duration;

/// What is printed.
pub(super) fn for_people(cells: &[Cell]) -> String {
    match cells {
        [Cell { found: Ok(fit), .. }] => one(fit),
        cells => several(cells),
    }
}

/// Every estimate, its interval, what its profile says.
pub(super) fn table(fit: &Fit) -> Vec<[String; 4]> {
    let row = |estimate: &Estimate| {
        [
            estimate.name.clone(),
            with_unit(precise(estimate.value, estimate), &estimate.unit),
            interval(estimate, fit.verdict),
            estimate.verdict.words().to_owned(),
        ]
    };
    fit.estimates.iter().map(row).collect()
}

fn one(fit: &Fit) -> String {
    let mut rows = vec![["", "value", "95 % interval", ""].map(str::to_owned).to_vec()];
    rows.extend(table(fit).into_iter().map(|row| row.to_vec()));
    let mut text = format!("{}\n\n{}", headline(fit), aligned(&rows, &[]));
    for curve in &fit.curves {
        let _ = write!(text, "\n{}", left(curve));
    }
    text
}

/// Whether the cell follows its curves, before any number.
pub(super) fn headline(fit: &Fit) -> String {
    format!("The model {}.", fit.verdict.words())
}

/// How much of a curve is left.
pub(super) fn left(curve: &FittedCurve) -> String {
    format!(
        "{}: residual {} (root mean square of {} frames), noise at rest {}",
        curve.name,
        with_unit(three_digits(curve.residual), &curve.unit),
        curve.used.iter().filter(|used| **used).count(),
        with_unit(three_digits(curve.noise), &curve.unit),
    )
}

/// Three significant digits: what is left of a stretch is small.
fn three_digits(value: f64) -> String {
    let digits = if value > 0.0 { 2.0 - value.log10().floor() } else { 0.0 };
    format!("{value:.*}", digits.clamp(0.0, 9.0) as usize)
}

fn several(cells: &[Cell]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for (_, fit) in super::fits(cells) {
        for estimate in &fit.estimates {
            if !names.contains(&estimate.name.as_str()) {
                names.push(&estimate.name);
            }
        }
    }
    let mut head = vec!["cell".to_owned(), "verdict".to_owned()];
    head.extend(names.iter().map(|name| (*name).to_owned()));
    let mut rows = vec![head];
    for cell in cells {
        let mut row = vec![cell.name.clone()];
        match &cell.found {
            Ok(fit) => {
                row.push(fit.verdict.word().replace('-', " "));
                row.extend(names.iter().map(|name| {
                    fit.estimate(name)
                        .map_or_else(String::new, |estimate| precise(estimate.value, estimate))
                }));
            }
            Err(why) => row.push(format!("not fitted: {why}")),
        }
        rows.push(row);
    }
    aligned(&rows, &[])
}

fn interval(estimate: &Estimate, of: FitVerdict) -> String {
    if of == FitVerdict::DoesNotFit {
        return "none".to_owned();
    }
    let end = |end: f64| precise(end, estimate);
    match estimate.interval {
        [Some(low), Some(high)] => format!("{} to {}", end(low), end(high)),
        [Some(low), None] => format!("from {}", end(low)),
        [None, Some(high)] => format!("up to {}", end(high)),
        [None, None] => "any".to_owned(),
    }
}

/// As many digits as the interval is worth, and one more.
fn precise(value: f64, estimate: &Estimate) -> String {
    let width = match estimate.interval {
        [Some(low), Some(high)] if high > low => high - low,
        _ => value.abs(),
    };
    let digits = (1.0 - width.max(f64::MIN_POSITIVE).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

pub(super) fn with_unit(text: String, unit: &str) -> String {
    if unit.is_empty() { text } else { format!("{text} {unit}") }
}

/// How long a fit of a cell whose curves are slow takes.
pub(super) fn will_take(one: Duration, curves: usize, threads: usize) -> String {
    let seconds = one.as_secs_f64() * curves as f64 / threads as f64;
    let time = match seconds {
        ..=90.0 => format!("{seconds:.0} s"),
        ..=5400.0 => format!("{:.0} minutes", seconds / 60.0),
        _ => format!("{:.1} hours", seconds / 3600.0),
    };
    let fits = if curves == 1 { "the fit takes" } else { "the fits take" };
    format!(
        "each curve of this cell model is a beat of all its equations: {fits} about {time} on this machine"
    )
}
