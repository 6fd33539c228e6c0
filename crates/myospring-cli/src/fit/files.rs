//! The files of fits.

use super::map::{self, Mapped};
use super::shapes::{self, Shapes};
use super::words;
use crate::failure::Failure;
use crate::results::Folder;
use crate::run::resolved;
use myospring::fit::{Estimate, Fit, FitVerdict, Fitter};
use myospring::integrate::Method;
use myospring::output::figure::{self, FittedCurve, LikelihoodProfile, Theme};
use myospring::output::json;
use myospring::output::page::for_markup;
use myospring::output::table::{Column, Table, column_name, write_csv};
use myospring::settings::Run;
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
    pub(super) spacing: f64,
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
    for (number, (cell, record)) in cells.iter().zip(&records).enumerate() {
        let within = if cells.len() > 1 { format!("cells/{}/", number + 1) } else { String::new() };
        let Ok(fit) = &cell.found else { continue };
        folder.write(&format!("{within}fit.json"), json::pretty(record)?)?;
        folder.write(&format!("{within}curve.csv"), curve(fit)?)?;
        let run = context.fitter.fitted(context.run.clone(), fit).map_err(Failure::new)?;
        let mut simulation = context.fitter.simulation().clone();
        simulation.cell = run.cell.clone();
        simulation.numerics.method = Method::QuasiStatic;
        folder.write(
            &format!("{within}run.toml"),
            resolved(&run, &simulation, context.spacing, None),
        )?;
        let draw = || figure::fit(&drawn(fit), &profiles(fit));
        let figure = if cells.len() > 1 { format!("fit_{}", number + 1) } else { "fit".to_owned() };
        folder.figures(Theme::Light, &[(&figure, &draw)])?;
        let svg = draw().map_or_else(|_| String::new(), |figure| figure.to_svg());
        folder.write(&format!("{within}report.html"), page(cell, fit, context, &svg))?;
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

fn drawn(fit: &Fit) -> Vec<FittedCurve> {
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

/// None of a model that does not fit.
fn profiles(fit: &Fit) -> Vec<LikelihoodProfile> {
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

/// A page with all of it, in one file.
fn page(cell: &Cell, fit: &Fit, context: &Context<'_>, svg: &str) -> String {
    let escape = for_markup;
    let mut rows = String::new();
    for row in words::table(fit) {
        rows.push_str("<tr>");
        for text in &row {
            rows.push_str(&["<td>", &escape(text), "</td>"].concat());
        }
        rows.push_str("</tr>\n");
    }
    let list = |lines: &[String]| {
        let items: Vec<String> =
            lines.iter().map(|line| ["<li>", &escape(line), "</li>\n"].concat()).collect();
        items.concat()
    };
    let inline = |svg: &str| {
        svg.split_once("<svg").map_or_else(String::new, |(_, rest)| format!("<svg{rest}"))
    };
    let map = context.mapped.map_or_else(String::new, |mapped| {
        let svg = mapped.figure().map_or_else(|_| String::new(), |figure| figure.to_svg());
        let words = escape(&mapped.words());
        let verdicts = list(mapped.verdicts());
        let svg = inline(&svg);
        format!("<h2>Where the cell pulls</h2>\n{svg}\n<p>{words}.</p>\n<ul>{verdicts}</ul>\n")
    });
    let shapes = context.shapes.map_or_else(String::new, |shapes| {
        let svg = shapes.figure().map_or_else(|_| String::new(), |figure| figure.to_svg());
        let (svg, words) = (inline(&svg), escape(&shapes.words()));
        format!("<h2>The film and the fitted cell</h2>\n{svg}\n<p>{words}.</p>\n")
    });
    let left: Vec<String> = fit.curves.iter().map(words::left).collect();
    include_str!("report.html")
        .replace("{{title}}", &escape(&format!("Fit of {}", cell.name)))
        .replace("{{shape}}", &escape(context.name))
        .replace("{{model}}", &escape(context.fitter.simulation().cell.name()))
        .replace("{{version}}", env!("CARGO_PKG_VERSION"))
        .replace("{{verdict}}", fit.verdict.word())
        .replace("{{headline}}", &escape(&words::headline(fit)))
        .replace("{{verdicts}}", &list(&fit.verdicts))
        .replace("{{rows}}", &rows)
        .replace("{{left}}", &list(&left))
        .replace("{{notes}}", &list(context.notes))
        .replace("{{shapes}}", &shapes)
        .replace("{{map}}", &map)
        .replace("{{figure}}", &inline(svg))
}
