//! Fits as tables, and as figures have them.

use super::cell::FittedCell;
use super::traction;
use crate::fit::{
    self, Estimate, Fit, FitVerdict, Left, MeanBeat, OwnTension, RecordedCourse, TriedModel,
};
use crate::output::figure::{DrawnFit, DrawnTension, LikelihoodProfile};
use crate::output::table::{Column, Table, column_name};

/// Every frame of every curve.
pub(super) fn curves(fit: &Fit) -> Table {
    let mut columns = Vec::new();
    let several = fit.curves.len() > 1;
    let number = |name: String, values: Vec<f64>| Column::Number {
        name,
        values: values.into_iter().map(Some).collect(),
    };
    let all = |of: &dyn Fn(&fit::FittedCurve) -> Vec<f64>| -> Vec<f64> {
        fit.curves.iter().flat_map(of).collect()
    };
    if several {
        let names = fit
            .curves
            .iter()
            .flat_map(|curve| curve.times_ms.iter().map(|_| Some(curve.name.clone())));
        columns.push(Column::Text { name: "curve".to_owned(), values: names.collect() });
    }
    if fit.curves.iter().any(|curve| curve.unit != fit.curves[0].unit) {
        let units = fit
            .curves
            .iter()
            .flat_map(|curve| curve.times_ms.iter().map(|_| Some(curve.unit.clone())));
        columns.push(Column::Text { name: "unit".to_owned(), values: units.collect() });
    }
    let is_one = columns.len() < 2;
    let unit = fit.curves.first().filter(|_| is_one).map_or("", |curve| curve.unit.as_str());
    columns.push(number("t_ms".to_owned(), all(&|curve| curve.times_ms.clone())));
    columns.push(number(column_name("measured", unit), all(&|curve| curve.measured.clone())));
    columns.push(number(column_name("fitted", unit), all(&|curve| curve.fitted.clone())));
    let left = |curve: &fit::FittedCurve| {
        curve.measured.iter().zip(&curve.fitted).map(|(a, b)| a - b).collect()
    };
    columns.push(number(column_name("left", unit), all(&left)));
    let used =
        fit.curves.iter().flat_map(|curve| curve.used.iter().map(|used| Some(used.to_string())));
    columns.push(Column::Text { name: "used".to_owned(), values: used.collect() });
    Table { columns }
}

/// What each model that was tried leaves of the curve.
pub(super) fn tried(fit: &Fit) -> Table {
    let text = |name: &str, of: &dyn Fn(&TriedModel) -> Option<String>| Column::Text {
        name: name.to_owned(),
        values: fit.tried.iter().map(of).collect(),
    };
    let number = |name: &str, of: &dyn Fn(&Left) -> f64| Column::Number {
        name: name.to_owned(),
        values: fit.tried.iter().map(|row| row.left.as_ref().map(of)).collect(),
    };
    Table {
        columns: vec![
            text("model", &|row| Some(row.model.clone())),
            text("taken", &|row| Some(row.taken.to_string())),
            text("verdict", &|row| row.left.as_ref().map(|left| left.verdict.word().to_owned())),
            text("as_good", &|row| row.left.as_ref().map(|left| left.as_good.to_string())),
            number("numbers", &|left| left.numbers as f64),
            number("chi_squared", &|left| left.chi_squared),
            number("frames", &|left| left.frames as f64),
            number("bic", &|left| left.bic),
            number("misfit_pct", &|left| left.misfit_pct),
            number("frames_together", &|left| left.frames_together),
            text("reason", &|row| row.reason.clone()),
        ],
    }
}

/// A tension that a curve asks for, as a run reads it.
pub(super) fn tension(own: &OwnTension) -> Table {
    let [low, high] = &own.band_kpa;
    let columns = [
        ("t_ms", &own.times_ms),
        ("tension_kPa", &own.tension_kpa),
        ("lower_95_kPa", low),
        ("upper_95_kPa", high),
        ("standard_deviation_kPa", &own.standard_deviation_kpa),
    ];
    numbers(&columns)
}

/// Calcium that drove a model, as a run reads it: time counts from its first sample.
pub(super) fn calcium(course: &RecordedCourse) -> Table {
    let first = course.times_ms.first().copied().unwrap_or_default();
    let since = course.times_ms.iter().map(|time| time - first).collect();
    numbers(&[("t_ms", &since), ("calcium_uM", &course.calcium_um)])
}

/// Its mean beat, since the onset.
pub(super) fn mean_beat(beat: &MeanBeat) -> Table {
    let columns = [
        ("t_ms", &beat.times_ms),
        ("tension_kPa", &beat.tension_kpa),
        ("standard_error_kPa", &beat.standard_error_kpa),
    ];
    numbers(&columns)
}

fn numbers(columns: &[(&str, &Vec<f64>)]) -> Table {
    let column = |(name, values): &(&str, &Vec<f64>)| Column::Number {
        name: (*name).to_owned(),
        values: values.iter().copied().map(Some).collect(),
    };
    Table { columns: columns.iter().map(column).collect() }
}

/// A tension that a curve asks for, on the clock of the curve.
pub(super) fn drawn_tension(fit: &Fit) -> Option<DrawnTension> {
    let (own, curve) = (fit.own_tension.as_ref()?, fit.curves.first()?);
    let first = *curve.times_ms.first()?;
    Some(DrawnTension {
        times_ms: own.times_ms.iter().map(|time| first + time).collect(),
        tension_kpa: own.tension_kpa.clone(),
        band_kpa: own.band_kpa.clone(),
        true_kpa: None,
        stimuli_ms: curve.stimuli_ms.clone(),
    })
}

/// One row a cell.
pub(super) fn cells(cells: &[FittedCell]) -> Table {
    let text = |name: &str, of: &dyn Fn(&FittedCell) -> String| Column::Text {
        name: name.to_owned(),
        values: cells.iter().map(|cell| Some(of(cell))).collect(),
    };
    let model = |cell: &FittedCell| {
        cell.found.as_ref().map_or_else(|_| String::new(), |fit| fit.model.clone())
    };
    let mut columns = vec![text("cell", &|cell| cell.name.clone()), text("model", &model)];
    let mut names: Vec<(String, String)> = Vec::new();
    for fit in cells.iter().filter_map(|cell| cell.found.as_ref().ok()) {
        for estimate in &fit.estimates {
            let named = (estimate.name.clone(), estimate.unit.clone());
            if !names.contains(&named) {
                names.push(named);
            }
        }
    }
    for (name, unit) in &names {
        let number = |what: &str, of: &dyn Fn(&Estimate) -> Option<f64>| Column::Number {
            name: column_name(&format!("{name}{what}"), unit),
            values: cells
                .iter()
                .map(|cell| cell.found.as_ref().ok()?.estimate(name).and_then(of))
                .collect(),
        };
        columns.push(number("", &|estimate| Some(estimate.value)));
        columns.push(number("_from", &|estimate| estimate.interval[0]));
        columns.push(number("_to", &|estimate| estimate.interval[1]));
        let verdict = |cell: &FittedCell| {
            let found = cell.found.as_ref().ok().and_then(|fit| fit.estimate(name));
            found.map_or_else(String::new, |estimate| estimate.verdict.words().to_owned())
        };
        columns.push(text(&format!("{name}_verdict"), &verdict));
    }
    let fits = |of: &dyn Fn(&Fit) -> f64| -> Vec<Option<f64>> {
        cells.iter().map(|cell| cell.found.as_ref().ok().map(of)).collect()
    };
    columns.push(Column::Number {
        name: "reduced_chi_squared".to_owned(),
        values: fits(&|fit| fit.reduced_chi_squared),
    });
    columns.push(Column::Number {
        name: "unexplained".to_owned(),
        values: fits(&|fit| fit.curves.iter().map(|curve| curve.unexplained).fold(0.0, f64::max)),
    });
    columns.push(text("verdict", &|cell| match &cell.found {
        Ok(fit) => fit.verdict.word().to_owned(),
        Err(_) => String::new(),
    }));
    columns
        .push(text("status", &|cell| if cell.found.is_ok() { "ok" } else { "failed" }.to_owned()));
    columns.push(text("reason", &|cell| match &cell.found {
        Ok(fit) => fit.verdicts.join("; "),
        Err(reason) => reason.to_string(),
    }));
    Table { columns }
}

fn micro(unit: &str) -> String {
    unit.replace("um", "\u{b5}m")
}

pub(super) fn drawn(fit: &Fit) -> Vec<DrawnFit> {
    let one = |curve: &fit::FittedCurve| {
        let unit = micro(&curve.unit);
        let what = match curve.scale {
            fit::Scale::Length => "Length",
            fit::Scale::Percent => "Shortening",
            fit::Scale::Arbitrary => "Contraction",
            fit::Scale::Load(load) => traction::label(load),
        };
        let label = if unit.is_empty() { what.to_owned() } else { format!("{what} ({unit})") };
        DrawnFit {
            label,
            unit,
            times_ms: curve.times_ms.clone(),
            measured: curve.measured.clone(),
            fitted: curve.fitted.clone(),
            used: curve.used.clone(),
            noise: curve.noise,
            warning: (curve.verdict() == FitVerdict::DoesNotFit).then(|| {
                let off = 100.0 * curve.misfit / curve.height();
                format!("The model does not fit: it is off by {off:.0} % of the height of a beat")
            }),
            stimuli_ms: curve.stimuli_ms.clone(),
        }
    };
    fit.curves.iter().map(one).collect()
}

/// The likelihood profile of each parameter; empty where the model does not fit.
pub(super) fn profiles(fit: &Fit) -> Vec<LikelihoodProfile> {
    let one = |estimate: &Estimate| {
        let (name, unit) = (estimate.name.replace('_', " "), micro(&estimate.unit));
        let symbol = estimate.name.len() <= 5;
        let name = if symbol { estimate.name.clone() } else { name };
        LikelihoodProfile {
            label: if unit.is_empty() { name } else { format!("{name} ({unit})") },
            value: estimate.value,
            interval: estimate.interval,
            points: estimate.profile.clone(),
            at_ends: fit.rise_at_ends,
        }
    };
    let sure = fit.estimates.iter().filter(|estimate| !estimate.profile.is_empty());
    sure.map(one).collect()
}
