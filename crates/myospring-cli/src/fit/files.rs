//! The files of fits.

use super::map::{self, Mapped};
use super::page;
use super::shapes::{self, Shapes};
use crate::failure::Failure;
use crate::files::FILES;
use crate::interrupt;
use crate::terminal::Terminal;
use myospring::experiment::Folder;
use myospring::experiment::Inputs;
use myospring::experiment::run::{FILE, resolved};
use myospring::fit::{Estimate, Fit, FitVerdict, Fitter};
use myospring::integrate::quasi_static::Tolerance;
use myospring::mesh::outline::Outline;
use myospring::mesh::quality::MeshReport;
use myospring::output::figure::{self, FittedCurve, LikelihoodProfile, Theme};
use myospring::output::json;
use myospring::output::table::{Column, Table, column_name, write_csv};
use myospring::settings::Run;
use myospring::simulation::Simulation;
use serde::Serialize;

/// A cell and its fit, or why there is none.
pub(super) struct Cell {
    pub(super) name: String,
    pub(super) found: Result<Fit, String>,
}

/// What all cells have in common.
pub(super) struct Context<'a> {
    pub(super) run: &'a Run,
    pub(super) fitter: &'a Fitter,
    /// The mesh, and the outline that it was made from.
    pub(super) report: &'a MeshReport,
    pub(super) outline: &'a Outline,
    pub(super) name: &'a str,
    pub(super) notes: &'a [String],
    pub(super) mapped: Option<&'a Mapped<'a>>,
    pub(super) shapes: Option<&'a Shapes<'a>>,
}

/// fit.json.
#[derive(Serialize)]
pub(super) struct Record<'a> {
    program: &'static str,
    version: &'static str,
    /// The curve.
    cell: &'a str,
    /// Whose shape it has.
    shape: &'a str,
    model: &'a str,
    #[serde(flatten)]
    fit: Option<&'a Fit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<&'a str>,
    /// Of a film: the measured and the fitted cell at their peak.
    #[serde(skip_serializing_if = "Option::is_none")]
    shapes: Option<shapes::Record<'a>>,
    /// Of a film: where the cell pulls.
    #[serde(skip_serializing_if = "Option::is_none")]
    tension_map: Option<map::Record<'a>>,
    notes: &'a [String],
}

pub(super) fn records<'a>(cells: &'a [Cell], context: &'a Context<'a>) -> Vec<Record<'a>> {
    let record = |cell: &'a Cell| Record {
        program: "myospring",
        version: env!("CARGO_PKG_VERSION"),
        cell: &cell.name,
        shape: context.name,
        model: context.fitter.simulation().cell.name(),
        fit: cell.found.as_ref().ok(),
        reason: cell.found.as_ref().err().map(String::as_str),
        shapes: context.shapes.map(Shapes::record),
        tension_map: context.mapped.map(Mapped::record),
        notes: context.notes,
    };
    cells.iter().map(record).collect()
}

/// Writes what is to be written of all cells.
pub(super) fn write(folder: &Folder, cells: &[Cell], context: &Context<'_>) -> Result<(), Failure> {
    let records = records(cells, context);
    let shared = context.fitter.simulation().shared_path(Tolerance::default()).ok();
    let mut inputs = Inputs::default();
    inputs.keep(folder, context.run.to_run_file(), |file| FILES.bytes(file))?;
    for (number, (cell, record)) in cells.iter().zip(&records).enumerate() {
        let within = if cells.len() > 1 { format!("cells/{}/", number + 1) } else { String::new() };
        let up = if within.is_empty() { "" } else { "../../" };
        let Ok(fit) = &cell.found else { continue };
        folder.write(&format!("{within}fit.json"), json::pretty(record)?)?;
        folder.write(&format!("{within}curve.csv"), curve(fit)?)?;
        let run = context.fitter.fitted(context.run.clone(), fit).map_err(Failure::new)?;
        let simulation = fitted(context.fitter, &run);
        let run_file = resolved(&run, (&inputs, up), &simulation, context.report.spacing_um, None);
        folder.write(&format!("{within}run.toml"), &run_file)?;
        if interrupt::is_late() {
            continue;
        }
        let draw = || figure::fit(&drawn(fit), &profiles(fit));
        let figure = if cells.len() > 1 { format!("fit_{}", number + 1) } else { "fit".to_owned() };
        folder.figures(Theme::Light, &[(&figure, &draw)], &Terminal::new(true))?;
        match page::beaten(&simulation, shared.as_ref()) {
            Ok(outcome) => {
                let beat = (&simulation, &outcome);
                let page = page::html(cell, fit, context, &run, (&run_file, &inputs), beat)?;
                folder.write(&format!("{within}{FILE}"), page)?;
            }
            Err(error) => {
                crate::print::warn(&format!("{}: there is no {FILE}: {error}", cell.name));
            }
        }
    }
    if let Some(shapes) = context.shapes {
        shapes.write(folder)?;
    }
    if let Some(mapped) = context.mapped {
        mapped.write(folder)?;
    }
    if cells.len() > 1 {
        folder.write("fits.csv", rows(cells)?)?;
    }
    Ok(())
}

/// The simulation of a run with what was found.
pub(super) fn fitted(fitter: &Fitter, run: &Run) -> Simulation {
    let mut simulation = fitter.simulation().clone();
    simulation.cell = run.cell.clone();
    simulation.peak_tension = run.peak_tension;
    simulation.material = run.material.clone();
    simulation.protocol = run.protocol;
    simulation.duration = run.duration;
    simulation.numerics.method = run.numerics.method;
    simulation
}

pub(super) fn csv(table: &Table) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    write_csv(&mut bytes, [table.clone()]).map_err(Failure::new)?;
    Ok(bytes)
}

/// Every frame of every curve.
fn curve(fit: &Fit) -> Result<Vec<u8>, Failure> {
    let mut columns = Vec::new();
    let several = fit.curves.len() > 1;
    let number = |name: String, values: Vec<f64>| Column::Number {
        name,
        values: values.into_iter().map(Some).collect(),
    };
    let all = |of: &dyn Fn(&myospring::fit::FittedCurve) -> Vec<f64>| -> Vec<f64> {
        fit.curves.iter().flat_map(of).collect()
    };
    if several {
        let names = fit
            .curves
            .iter()
            .flat_map(|curve| curve.times_ms.iter().map(|_| Some(curve.name.clone())));
        columns.push(Column::Text { name: "curve".to_owned(), values: names.collect() });
    }
    let unit = fit.curves.first().map_or("", |curve| curve.unit.as_str());
    columns.push(number("t_ms".to_owned(), all(&|curve| curve.times_ms.clone())));
    columns.push(number(column_name("measured", unit), all(&|curve| curve.measured.clone())));
    columns.push(number(column_name("fitted", unit), all(&|curve| curve.fitted.clone())));
    let left = |curve: &myospring::fit::FittedCurve| {
        curve.measured.iter().zip(&curve.fitted).map(|(a, b)| a - b).collect()
    };
    columns.push(number(column_name("left", unit), all(&left)));
    let used =
        fit.curves.iter().flat_map(|curve| curve.used.iter().map(|used| Some(used.to_string())));
    columns.push(Column::Text { name: "used".to_owned(), values: used.collect() });
    csv(&Table { columns })
}

/// One row a cell.
fn rows(cells: &[Cell]) -> Result<Vec<u8>, Failure> {
    let text = |name: &str, of: &dyn Fn(&Cell) -> String| Column::Text {
        name: name.to_owned(),
        values: cells.iter().map(|cell| Some(of(cell))).collect(),
    };
    let mut columns = vec![text("cell", &|cell| cell.name.clone())];
    let mut names: Vec<(String, String)> = Vec::new();
    for (_, fit) in super::fits(cells) {
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
        let verdict = |cell: &Cell| {
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
        Err(reason) => reason.clone(),
    }));
    csv(&Table { columns })
}

fn micro(unit: &str) -> String {
    unit.replace("um", "\u{b5}m")
}

pub(super) fn drawn(fit: &Fit) -> Vec<FittedCurve> {
    let one = |curve: &myospring::fit::FittedCurve| {
        let unit = micro(&curve.unit);
        let what = match curve.scale {
            myospring::fit::Scale::Length => "Length",
            myospring::fit::Scale::Percent => "Shortening",
            myospring::fit::Scale::Arbitrary => "Contraction",
        };
        let label = if unit.is_empty() { what.to_owned() } else { format!("{what} ({unit})") };
        FittedCurve {
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
