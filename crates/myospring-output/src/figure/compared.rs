//! Several runs in one figure: their curves on one time axis, their cells at rest and at peak.

use super::chart::{Axis, Chart, Curve, align};
use super::font::text_width;
use super::shapes::draw_scale_bar;
use super::sheet::{Path, Sheet, Stroke, Style};
use super::theme::{CURVES, DOUBLE, LABEL, LETTER, MUTED, TICK, fixed, time};
use super::traces::{ACTIVE_TENSION, Drives, Quantity, SHORTENING, extent, peak, pen, points};
use super::{Figure, FigureError};
use myospring_core::recording::Recording;

/// Closed lines of points, um; the first is the rim of a cell, the others those of its holes.
pub type Rings<'a> = &'a [Vec<[f64; 2]>];

/// A run to compare.
#[derive(Debug, Clone, Copy)]
pub struct ComparedRun<'a> {
    /// Its name in the legend.
    pub label: &'a str,
    /// Its curves.
    pub recording: &'a Recording,
    /// Rings of its outline at rest and at its peak, um, the first ring the rim; `None` if they
    /// were not recorded.
    pub cell: Option<[Rings<'a>; 2]>,
}

/// Height of each chart and gap between two, px.
const HEIGHT: f64 = 92.0;
const GAP: f64 = 16.0;
/// Height of a row of the legend and length of its swatch with the gap after it, px.
const ROW: f64 = 14.0;
const SWATCH: f64 = 24.0;
/// Letters of the panels: charts above each other, then cells.
const LETTERS: [&str; 6] = ["A", "B", "C", "D", "E", "F"];
/// Potential, calcium, tension and shortening of several runs over one time axis, and their
/// outlines over each other at rest and at peak, each centred on its own shape at rest.
///
/// The potential is in mV if all runs have it in mV; potential and calcium are shown if all runs
/// have them. Width: two columns, 178 mm.
///
/// # Errors
/// No run, or one without a finite sample.
pub fn compared(runs: &[ComparedRun<'_>]) -> Result<Figure, FigureError> {
    if runs.is_empty() {
        return Err(FigureError::Nothing { what: "runs" });
    }
    let mut sheet = Sheet::default();
    let common = runs.iter().map(|run| Drives::of(run.recording)).reduce(|all, one| all.and(&one));
    let mut quantities = common.map_or_else(Vec::new, |drives| drives.quantities());
    quantities.extend([ACTIVE_TENSION, SHORTENING]);
    let top = draw_legend(&mut sheet, runs);
    let cells: Vec<(usize, [Rings<'_>; 2])> = runs
        .iter()
        .enumerate()
        .filter_map(|(index, run)| Some((index, run.cell?)))
        .filter(|(_, [rest, _])| rest.first().is_some_and(|ring| !ring.is_empty()))
        .collect();
    let width = if cells.is_empty() { DOUBLE } else { 0.56 * DOUBLE };
    let bottom = draw_curves(&mut sheet, runs, &quantities, [width, top])?;
    if !cells.is_empty() {
        let letters = LETTERS.iter().skip(quantities.len());
        draw_cells(&mut sheet, &cells, letters, [width, top], bottom);
    }
    Ok(sheet.finish(DOUBLE, bottom))
}

/// Dashes of the lines of all runs but the first, px, so that coinciding curves remain visible.
const DASHES: [[f64; 2]; 3] = [[6.0, 2.5], [1.5, 2.0], [9.0, 4.0]];

/// The line style of a run; up to 18 runs have different ones.
fn line_of(index: usize) -> Stroke {
    let dash =
        index.checked_sub(1).map(|other| DASHES[(other + other / CURVES.len()) % DASHES.len()]);
    Stroke { dash, ..pen(index) }
}

/// Draws the legend, with the greatest shortening of each run; returns its lower end, px.
fn draw_legend(sheet: &mut Sheet, runs: &[ComparedRun<'_>]) -> f64 {
    let texts: Vec<String> = runs
        .iter()
        .map(|run| match peak(&points(run.recording, &SHORTENING)) {
            Some([t, value]) => format!("{}: {} % at {}", run.label, fixed(value, 1), time(t)),
            None => run.label.to_owned(),
        })
        .collect();
    let widest = texts.iter().map(|text| text_width(text, TICK)).fold(0.0, f64::max);
    let column = SWATCH + widest + 16.0;
    let columns = ((DOUBLE - 16.0) / column).floor().max(1.0) as usize;
    for (index, text) in texts.iter().enumerate() {
        let left = 8.0 + (index % columns) as f64 * column;
        let middle = 6.0 + ROW * ((index / columns) as f64 + 0.5);
        sheet.line([left, middle], [left + SWATCH - 6.0, middle], line_of(index));
        sheet.text([left + SWATCH, middle + 3.5], text, Style::new(TICK));
    }
    14.0 + ROW * texts.len().div_ceil(columns) as f64
}

/// Draws the charts above each other; returns the lower end of the last with its labels, px.
fn draw_curves(
    sheet: &mut Sheet,
    runs: &[ComparedRun<'_>],
    quantities: &[Quantity],
    [right, top]: [f64; 2],
) -> Result<f64, FigureError> {
    let curves: Vec<Vec<Vec<[f64; 2]>>> = quantities
        .iter()
        .map(|quantity| runs.iter().map(|run| points(run.recording, quantity)).collect())
        .collect();
    for (run, index) in runs.iter().zip(0..) {
        let finite = |curve: &Vec<[f64; 2]>| curve.iter().flatten().all(|x| x.is_finite());
        if !curves.iter().any(|of_runs: &Vec<_>| {
            of_runs.get(index).is_some_and(|curve| !curve.is_empty() && finite(curve))
        }) {
            return Err(FigureError::NoSamples { what: format!("the run \"{}\"", run.label) });
        }
    }
    let times = extent(curves.iter().flatten().map(Vec::as_slice), 0);
    let mut charts: Vec<Chart> = Vec::new();
    for (row, (quantity, curves)) in quantities.iter().zip(&curves).enumerate() {
        let range = extent(curves.iter().map(Vec::as_slice), 1);
        let curve = |(index, points): (usize, &Vec<[f64; 2]>)| Curve {
            points: points.clone(),
            colour: line_of(index).colour,
            dash: line_of(index).dash,
        };
        let x = Axis { labelled: row + 1 == quantities.len(), ..Axis::time(times) };
        let axes = [x, Axis::values(&quantity.label, range, HEIGHT)];
        let curves = curves.iter().enumerate().map(curve).collect();
        charts.push(Chart::new(top + row as f64 * (HEIGHT + GAP), HEIGHT, axes, curves));
    }
    let offset = align(&mut charts, 30.0, right - 15.0);
    for (chart, letter) in charts.iter().zip(LETTERS) {
        chart.draw(sheet, offset);
        sheet.text([6.0, chart.place[1] + 4.0], letter, Style::new(LETTER).bold());
    }
    Ok(top + quantities.len() as f64 * (HEIGHT + GAP) - GAP + 37.0)
}

/// Draws the outlines, at rest above and at peak below.
fn draw_cells(
    sheet: &mut Sheet,
    cells: &[(usize, [Rings<'_>; 2])],
    letters: impl Iterator<Item = &'static &'static str>,
    [left, top]: [f64; 2],
    bottom: f64,
) {
    let middle = |rest: Rings<'_>| {
        let ring = &rest[0];
        [0, 1].map(|axis: usize| {
            let of = |pick: fn(f64, f64) -> f64, from: f64| {
                ring.iter().map(|point| point[axis]).fold(from, pick)
            };
            f64::midpoint(of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY))
        })
    };
    // Half of the largest extent about the centres, um.
    let mut half = [1e-9_f64; 2];
    for (_, shapes) in cells {
        let centre = middle(shapes[0]);
        for point in shapes.iter().flat_map(|rings| rings.iter().flatten()) {
            for axis in 0..2 {
                let reach = (point[axis] - centre[axis]).abs();
                half[axis] = half[axis].max(if reach.is_finite() { reach } else { 0.0 });
            }
        }
    }
    let extent = half.map(|reach| 2.0 * reach);
    let width = DOUBLE - left - 20.0;
    let height = (bottom - top - 37.0 - 2.0 * 22.0) / 2.0;
    let scale = (width / extent[0]).min(height / extent[1]);
    let drawn = extent[1] * scale;
    for ((row, name), letter) in ["at rest", "at peak"].into_iter().enumerate().zip(letters) {
        let head = top + row as f64 * (drawn + 34.0);
        sheet.text([left + 6.0, head + 4.0], letter, Style::new(LETTER).bold());
        sheet.text([left + 22.0, head + 4.0], name, Style::new(LABEL));
        let centre = [left + 8.0 + width / 2.0, head + 14.0 + drawn / 2.0];
        for (index, shapes) in cells {
            let origin = middle(shapes[0]);
            let mut path = Path::default();
            for ring in shapes[row] {
                path.add_ring(ring.iter().filter(|point| point.iter().all(|x| x.is_finite())).map(
                    |&[x, y]| {
                        [centre[0] + (x - origin[0]) * scale, centre[1] - (y - origin[1]) * scale]
                    },
                ));
            }
            sheet.path(path, line_of(*index));
        }
    }
    let below = top + 2.0 * (drawn + 34.0) - 2.0;
    draw_scale_bar(sheet, [left + 8.0, below], scale, extent);
    let note = "each centred at rest";
    let style = Style::new(TICK).colour(MUTED);
    sheet.text([DOUBLE - 12.0 - text_width(note, TICK), below + 3.5], note, style);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_with_equal_curves_are_all_seen_and_no_two_lines_are_alike() {
        let lines: Vec<String> =
            (0..18).map(line_of).map(|line| format!("{:?} {:?}", line.colour, line.dash)).collect();
        let different: std::collections::BTreeSet<&String> = lines.iter().collect();
        assert_eq!(different.len(), lines.len());
        assert!((1..18).all(|index| line_of(index).dash.is_some()));
    }
}
