//! The numbers of fits as people read them.

use crate::fit::{Estimate, Fit, FitVerdict, FittedCurve, TriedModel};
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
    let models = tried_models(fit).count();
    match (&fit.own_tension, fit.verdict) {
        (Some(_), _) if models == 0 => {
            "The tension that this curve needs, frame by frame. It predicts nothing beyond this recording.".to_owned()
        }
        (Some(_), _) => "No cell model here follows this curve. This is the tension that it needs, frame by frame; it \
                         predicts nothing beyond this recording."
            .to_owned(),
        (None, verdict) if models == 0 => format!("The model {}.", verdict.words()),
        (None, FitVerdict::DoesNotFit) => {
            format!("No cell model here follows this curve; {} comes closest.", fit.model)
        }
        (None, verdict) => {
            format!("{} {}. Of the {models} models that were tried it comes closest.", fit.model, verdict.words())
        }
    }
}

/// The models that were fitted before one was taken, without the curve's own tension.
fn tried_models(fit: &Fit) -> impl Iterator<Item = &TriedModel> {
    fit.tried.iter().filter(|row| row.left.as_ref().is_some_and(|left| left.numbers < left.frames))
}

/// The heads of [`tried`].
pub const TRIED: [&str; 6] = ["model", "fitted numbers", "off by", "chi squared", "BIC", "verdict"];

/// What each model that was tried leaves of the curve; empty where only one was asked for.
pub fn tried(fit: &Fit) -> Vec<[String; 6]> {
    let row = |TriedModel { model, left, reason, .. }: &TriedModel| {
        let Some(left) = left else {
            let [numbers, off, chi_squared, bic] = [const { String::new() }; 4];
            let reason = reason.clone().unwrap_or_default();
            return [model.clone(), numbers, off, chi_squared, bic, reason];
        };
        let verdict = if left.as_good { "fits as well" } else { left.verdict.word() };
        [
            model.clone(),
            left.numbers.to_string(),
            format!("{:.1} %", left.misfit_pct),
            format!("{:.1}", left.chi_squared),
            format!("{:.1}", left.bic),
            verdict.replace('-', " "),
        ]
    };
    fit.tried.iter().map(row).collect()
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

/// Why a cell model is not tried beside others.
pub(super) fn too_slow(model: &str) -> String {
    format!("not tried: each of its curves is a whole beat (--model {model})")
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
