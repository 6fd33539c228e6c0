//! A fit in words.

use super::answer::{Estimate, Fit, FitVerdict, FittedCurve, Verdict};
use super::observed::Scale;
use super::unknown::Unknown;
use crate::analysis::curve::clipped;
use crate::cell::CellModel;
use crate::mechanics::support::SupportKind;
use crate::simulation::Simulation;

/// The largest number of left-out stretches that are listed.
const LISTED: usize = 5;

/// Verdicts for the reader, the most important first.
pub(super) fn verdicts(fit: &Fit, simulation: &Simulation, modulus: f64) -> Vec<String> {
    let cell = &*simulation.cell;
    let model = cell.name();
    let mut words = Vec::new();
    let off = fit.curves.iter().filter(|curve| curve.verdict() != FitVerdict::Fits);
    words.extend(off.map(|curve| misfit(curve, model)));
    if fit.verdict == FitVerdict::DoesNotFit {
        words.push(what_to_do(fit, cell));
    }
    let unknowns = fit.estimates.iter().filter(|estimate| estimate.unknown.is_some());
    words.extend(unknowns.filter_map(doubt));
    for (one, other, correlation) in &fit.correlated {
        words.push(format!(
            "the curve can hardly distinguish {one} from {other} (correlation {correlation:.3}): fix one of them"
        ));
    }
    // Too small to reject the fit, but included in its intervals.
    let small = |curve: &&FittedCurve| curve.verdict() == FitVerdict::Fits && curve.misfit > 0.0;
    words.extend(fit.curves.iter().filter(small).map(|curve| misfit(curve, model)));
    let [agreeing, starts] = fit.agreeing_starts;
    if 4 * agreeing < starts {
        words.push(format!(
            "only {agreeing} of {starts} starts reached this answer, so there may be a better one: try more starts"
        ));
    }
    words.extend(of_frames(fit));
    let free = |unknown: &Unknown| {
        fit.estimates.iter().any(|estimate| estimate.unknown.as_ref() == Some(unknown))
    };
    if fit.curves.iter().any(|curve| curve.scale == Scale::Arbitrary) {
        words.push(
            "a height in arbitrary units does not show how far the cell shortens: only timing was \
            fitted"
                .to_owned(),
        );
    } else if !free(&Unknown::YoungModulus) && free(&Unknown::TensionOverStiffness) {
        words.push(of_ratio(modulus, simulation.support));
    }
    if fit.curves.iter().any(|curve| matches!(curve.scale, Scale::Load(_))) {
        words.extend(of_forces(fit));
    }
    words
}

/// What a fit to forces on gels determines.
fn of_forces(fit: &Fit) -> Vec<String> {
    let modulus = fit.estimate(Unknown::YoungModulus.name());
    let is_open = |estimate: &Estimate| {
        !matches!(estimate.verdict, Verdict::Determined | Verdict::DoesNotFit)
    };
    let open = modulus.filter(|modulus| is_open(modulus)).map(|_| {
        "the shape and the force on one gel hardly show how stiff the cell itself is. A shape of the free cell, or a force on a gel of \
         another stiffness, does"
            .to_owned()
    });
    let scale = "forces on a gel are proportional to its Young's modulus: if that is 10 % off, so are tension and stiffness in kPa";
    open.into_iter().chain([scale.to_owned()]).collect()
}

/// Which other models follow the curve as well as the one that was taken.
pub(super) fn not_told_apart(fit: &Fit) -> Option<String> {
    let as_good = fit.tried.iter().filter(|row| row.left.as_ref().is_some_and(|left| left.as_good));
    let names: Vec<&str> = as_good.map(|row| row.model.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "the curve does not tell {} from {}, which {} it as well: it does not show which model the cell is like",
            fit.model,
            names.join(", "),
            if names.len() == 1 { "follows" } else { "follow" }
        )
    })
}

/// Which number a length determines.
fn of_ratio(modulus: f64, support: SupportKind) -> String {
    let modulus = (1e4 * modulus).round() / 1e4;
    if support.gives_way() {
        return format!(
            "the curve shows how far the cell shortens against its load, not how stiff the cell itself is; values in kPa assume a \
             Young's modulus of {modulus} kPa for the cell"
        );
    }
    format!(
        "the curve determines the ratio of tension to stiffness, not either one; values in kPa assume a Young's modulus of {modulus} kPa"
    )
}

/// Where the height of a curve is from.
pub(super) fn of_peak(shortening_pct: f64) -> String {
    format!(
        "the curve is in arbitrary units; its mean beat counts as a shortening of {shortening_pct} %, 10 % unless stated \
         (--peak-shortening). Every tension depends on that number, times hardly do"
    )
}

/// What a reader of a cell's own tension must know.
pub(super) fn of_own_tension(fit: &Fit, modulus: f64, support: SupportKind) -> Vec<String> {
    let Some(own) = &fit.own_tension else { return Vec::new() };
    let mut words = vec![OF_OWN_TENSION.to_owned()];
    if own.rest_raised > 0.0 {
        words.push(format!(
            "in {} of {} frames the cell is longer than before its beat, by up to {}, more often than noise explains: \
             either it had tension before its beat, or its length at rest drifts. Its longest length counts as no tension",
            own.longer_than_before,
            own.times_ms.len(),
            amount(100.0 * own.rest_raised, "%")
        ));
    }
    if own.too_short > 0 {
        words.push(format!(
            "in {} frames the cell is shorter than any tension makes it; their tension is extrapolated. Check the length at rest",
            own.too_short
        ));
    }
    words.extend(of_frames(fit));
    if fit.curves.len() == 1 {
        words.push(of_ratio(modulus, support));
        return words;
    }
    // The shape is followed frame by frame, forces need not be.
    let forces = fit.curves[1..].iter();
    let off = forces.filter(|curve| curve.verdict() > FitVerdict::Fits);
    words.extend(off.map(|curve| misfit(curve, &fit.model)));
    words.extend(of_forces(fit));
    words
}

/// What a cell's own tension is worth.
pub(crate) const OF_OWN_TENSION: &str = "this is the tension that the curve needs, frame by frame; it predicts nothing beyond this recording";

/// Frames that were left out.
fn of_frames(fit: &Fit) -> Vec<String> {
    let mut words = Vec::new();
    let bad: usize =
        fit.curves.iter().map(|curve| curve.used.iter().filter(|used| !**used).count()).sum();
    if bad > 0 {
        let frames = if bad == 1 { "frame was" } else { "frames were" };
        words.push(format!("{bad} single bad {frames} left out"));
    }
    words.extend(fit.curves.iter().filter_map(left_out));
    let found = |curve: &FittedCurve| Some(clipped(&curve.measured)?.words(&curve.unit));
    words.extend(fit.curves.iter().filter_map(found));
    words
}

/// The verdict on an estimate, unless that on the whole fit says it.
fn doubt(estimate: &Estimate) -> Option<String> {
    let Estimate { name, unit, value, .. } = estimate;
    let end = |end: usize| amount(estimate.interval[end].unwrap_or(*value), unit);
    let beyond = |end: &str| {
        let value = amount(*value, unit);
        format!(
            "{name} is at its {end} bound, {value}: a value beyond it would fit the curve better"
        )
    };
    match estimate.verdict {
        Verdict::DoesNotFit => None,
        Verdict::Determined if estimate.is_parabolic() => None,
        Verdict::Determined => Some(format!(
            "the likelihood of {name} is not a parabola: use its interval, not its standard deviation"
        )),
        Verdict::NotDetermined => {
            Some(format!("{name} is not determined by this curve: its profile is flat"))
        }
        Verdict::AtLeast => {
            Some(format!("{name} is {} or more: the curve sets no upper end", end(0)))
        }
        Verdict::AtMost => {
            Some(format!("{name} is {} or less: the curve sets no lower end", end(1)))
        }
        Verdict::AtLowerBound => Some(beyond("lower")),
        Verdict::AtUpperBound => Some(beyond("upper")),
    }
}

/// The stretches of a curve that were left out.
fn left_out(curve: &FittedCurve) -> Option<String> {
    let times = curve.left_out_ms.iter().map(|[from, to]| format!("{from:.0} to {to:.0} ms"));
    if times.len() == 0 {
        return None;
    }
    let more = match times.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let times: Vec<String> = times.take(LISTED).collect();
    Some(format!(
        "artefacts, or frames without a value, were left out of {}: {}{more}",
        curve.name,
        times.join(", ")
    ))
}

/// What can be done about a model that does not fit.
fn what_to_do(fit: &Fit, cell: &dyn CellModel) -> String {
    let other = match cell.known_departure() {
        Some(known) => {
            format!(
                "another cell model, such as {}, whose tension rises and falls more slowly",
                known.instead
            )
        }
        None => "another cell model".to_owned(),
    };
    let at_bound = fit
        .estimates
        .iter()
        .any(|estimate| matches!(estimate.verdict, Verdict::AtLowerBound | Verdict::AtUpperBound));
    let bounds = if at_bound { ", wider bounds" } else { "" };
    format!(
        "do not use these numbers: they are not the cell's and have no intervals. Try {other}, more free \
        parameters{bounds}, or a shorter part of the curve, and check that the curve's kind and unit are right. \
         --model given_tension finds the tension that the curve asks for, whatever the model"
    )
}

/// How the fitted curve differs from the measured one.
fn misfit(curve: &FittedCurve, model: &str) -> String {
    let FittedCurve { times_ms, measured, fitted, used, .. } = curve;
    let sign = if curve.scale == Scale::Length { -1.0 } else { 1.0 };
    let up = |values: &[f64], at: usize| sign * values[at];
    let peak =
        (0..fitted.len()).max_by(|a, b| up(fitted, *a).total_cmp(&up(fitted, *b))).unwrap_or(0);
    let (low, high) = (0..fitted.len())
        .map(|at| up(fitted, at))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
    let part = |at: usize| (up(fitted, at) - low) / (high - low);
    let rises = |at: usize| {
        let next = (at + 1).min(fitted.len() - 1);
        up(fitted, next) > up(fitted, at)
    };
    let mean = |which: &dyn Fn(usize) -> bool| {
        let off: Vec<f64> = (0..fitted.len())
            .filter(|&at| used[at] && which(at))
            .map(|at| up(measured, at) - up(fitted, at))
            .collect();
        if off.is_empty() { 0.0 } else { off.iter().sum::<f64>() / off.len() as f64 }
    };
    let early = mean(&|at| (0.05..0.5).contains(&part(at)) && rises(at));
    let late = mean(&|at| (0.5..0.95).contains(&part(at)) && rises(at));
    let top = mean(&|at| part(at) >= 0.95);
    let fall = mean(&|at| (0.05..0.95).contains(&part(at)) && !rises(at));
    let tail = mean(&|at| part(at) < 0.05 && times_ms[at] > times_ms[peak]);
    let all = [
        (early, "in the first half of its rise"),
        (late, "in the second half of its rise"),
        (top, "at its top"),
        (fall, "in its relaxation"),
        (tail, "on its return to rest"),
    ];
    let worst = all.into_iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let place = worst.map_or_else(String::new, |(off, what)| {
        let more = if off > 0.0 { "more" } else { "less" };
        format!(
            ": {what} the measured cell is contracted by {} {more} than in the best \
            fit",
            amount(off.abs(), &curve.unit)
        )
    });
    let verb = match curve.verdict() {
        FitVerdict::DoesNotFit => "does not fit",
        FitVerdict::FitsNearly => "nearly fits",
        FitVerdict::Fits => "fits",
    };
    let counted = match curve.verdict() {
        FitVerdict::DoesNotFit => "",
        _ => "; the intervals count this",
    };
    format!(
        "{model} {verb} `{}`: it is off by {} ({} of the height of a beat; noise {}){place}{counted}",
        curve.name,
        amount(curve.misfit, &curve.unit),
        amount(100.0 * curve.misfit / curve.height(), "%"),
        amount(curve.noise, &curve.unit),
    )
}

/// A number with its unit, three digits of it.
fn amount(value: f64, unit: &str) -> String {
    let space = if unit.is_empty() { "" } else { " " };
    let size = value.abs();
    if size > 0.0 && !(1e-4..1e6).contains(&size) {
        return format!("{value:.2e}{space}{unit}");
    }
    let digits = if size > 0.0 { (2.0 - size.log10().floor()).clamp(0.0, 9.0) } else { 0.0 };
    let digits = digits as usize;
    format!("{value:.digits$}{space}{unit}")
}
