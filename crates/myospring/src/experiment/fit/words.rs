//! The numbers of fits as people read them.

use crate::fit::{Estimate, Fit, FitVerdict, FittedCurve};
use std::time::Duration;

/// Name, value, 95 % interval and verdict of every estimate.
pub fn estimates(fit: &Fit) -> Vec<[String; 4]> {
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

/// Whether the model fits the curves; comes before any number.
pub fn headline(fit: &Fit) -> String {
    if fit.own_tension.is_some() {
        return "The tension that this curve needs, frame by frame. It predicts nothing beyond this recording.".to_owned();
    }
    format!("The model {}.", fit.verdict.words())
}

/// How large the residuals of a curve are, and its noise.
pub fn residual(curve: &FittedCurve) -> String {
    format!(
        "{}: residual {} (root mean square of {} frames), noise at rest {}",
        curve.name,
        with_unit(three_digits(curve.residual), &curve.unit),
        curve.used.iter().filter(|used| **used).count(),
        with_unit(three_digits(curve.noise), &curve.unit),
    )
}

/// Three significant digits: residuals of a stretch are small.
fn three_digits(value: f64) -> String {
    let digits = if value > 0.0 { 2.0 - value.log10().floor() } else { 0.0 };
    format!("{value:.*}", digits.clamp(0.0, 9.0) as usize)
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

/// A number with one digit more than its interval justifies.
pub fn precise(value: f64, estimate: &Estimate) -> String {
    let width = match estimate.interval {
        [Some(low), Some(high)] if high > low => high - low,
        _ => value.abs(),
    };
    let digits = (1.0 - width.max(f64::MIN_POSITIVE).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

fn with_unit(text: String, unit: &str) -> String {
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
        "this cell model computes a whole beat for each curve that is tried: {fits} about {time} on this machine"
    )
}
