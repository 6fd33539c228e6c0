//! A metric of each member over each of its parameters.

use super::super::chart::{Axis, Chart};
use super::super::sheet::{Path, Sheet, Stroke, Style};
use super::super::theme::{Colour, DOUBLE, HAIR, INK, LABEL, POTENTIAL, TENSION, WHITE};
use super::super::{Figure, FigureError};
use super::{Mark, Numbers, REJECTED, ends, legend, quantile};
use std::collections::BTreeMap;

/// Number of panels in a row, and size of each, px.
const COLUMNS: usize = 4;
const HEIGHT: f64 = 104.0;
const GAP: f64 = 14.0;
const MARGIN: f64 = 6.0;
/// Space above all plots and below those of a row, px.
const ABOVE: f64 = 24.0;
const BELOW: f64 = 46.0;
/// Up to this number, each member is a dot; with more, the shade shows their density.
const DOTS: usize = 2500;
/// Diameter of dots if there are many and if there are few, and side of a shaded square, px.
const DOT: [f64; 2] = [2.2, 3.6];
const SQUARE: f64 = 2.5;
/// Shades from few to many members in a square: accepted ones, and others.
const KEPT_SHADES: [Colour; 4] =
    [Colour(0xa8cfe8), Colour(0x5ba7d6), Colour(0x0072b2), Colour(0x004a77)];
const REJECTED_SHADES: [Colour; 4] =
    [Colour(0xe2e2e2), Colour(0xcdcdcd), Colour(0xb0b0b0), Colour(0x8f8f8f)];
/// Up to this number of values of a parameter, each has its own median; with more, neighbours share
/// one.
const DISTINCT: usize = 12;
/// Least number of members that share a median, and largest number of medians in a panel.
const TOGETHER: usize = 20;
const MEDIANS: usize = 12;

/// A metric over parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Scatter {
    /// The metric.
    pub metric: Numbers,
    /// The parameters, in the order of reading.
    pub parameters: Vec<Numbers>,
    /// Whether each member is accepted; `None` without acceptance bands.
    pub kept: Option<Vec<bool>>,
    /// Range of the metric in which members are accepted.
    pub band: Option<[f64; 2]>,
}

/// Draws the metric of every member over each parameter, with its running median.
///
/// Up to 2500 members are drawn as dots. With more, darker places contain more members, so that the
/// file for a million members is no larger than for thousands. Four panels in a row, two columns of
/// a journal.
///
/// # Errors
/// No parameter, or no member with finite numbers.
pub fn scatter(given: &Scatter) -> Result<Figure, FigureError> {
    let nothing = FigureError::Nothing { what: "members with finite numbers" };
    let Some(range) = ends(given.metric.finite()) else { return Err(nothing) };
    if given.parameters.is_empty() {
        return Err(FigureError::Nothing { what: "parameters" });
    }
    let y = Axis::upright("", range, HEIGHT);
    let mut sheet = Sheet::default();
    let mut offset = 0.0;
    let mut charts: Vec<Chart> = Vec::new();
    for (index, parameter) in given.parameters.iter().enumerate() {
        let Some(over) = ends(parameter.finite()) else { continue };
        let y = Axis { labelled: index % COLUMNS == 0, ..y.clone() };
        let axes = [Axis::across(&parameter.label, over, 0.0), y];
        let mut chart = Chart::new(0.0, HEIGHT, axes, Vec::new());
        offset = chart.label_offset();
        let left = MARGIN + offset;
        let width = (DOUBLE - left - MARGIN - GAP * (COLUMNS - 1) as f64) / COLUMNS as f64;
        chart.place = [
            left + (index % COLUMNS) as f64 * (width + GAP),
            ABOVE + (index / COLUMNS) as f64 * (HEIGHT + BELOW),
        ];
        chart.size[0] = width;
        chart.x = Axis::across(&parameter.label, over, width);
        charts.push(chart);
    }
    let title = Style::new(LABEL).bold();
    sheet.text([MARGIN + offset, 14.0], &given.metric.label, title);
    for (chart, parameter) in charts.iter_mut().zip(&given.parameters) {
        let points: Vec<[f64; 2]> =
            parameter.values.iter().zip(&given.metric.values).map(|(&x, &y)| [x, y]).collect();
        let median = running_median(&points);
        chart.draw(&mut sheet, offset);
        cloud(&mut sheet, chart, &points, given.kept.as_deref());
        let [low, high] = chart.y.range;
        let [first, last] = chart.x.range;
        for end in given.band.into_iter().flatten().filter(|end| (low..high).contains(end)) {
            let ends = [first, last].map(|x| chart.at([x, end]));
            sheet.line(ends[0], ends[1], Stroke::new(INK, HAIR).dash(3.0, 2.0));
        }
        let line = || Path::line(median.iter().map(|&point| chart.at(point)));
        sheet.path(line(), Stroke::new(WHITE, 3.4).opacity(0.85));
        sheet.path(line(), Stroke::new(TENSION, 1.6));
    }
    let bottom = ABOVE + given.parameters.len().div_ceil(COLUMNS) as f64 * (HEIGHT + BELOW) - 6.0;
    let place = [MARGIN + offset, bottom];
    let height = legend(&mut sheet, place, DOUBLE - MARGIN, &words(given));
    Ok(sheet.finish(DOUBLE, bottom + height + 6.0))
}

/// Legend of the colours.
fn words(given: &Scatter) -> Vec<(Mark, String)> {
    let there = given.metric.finite().count();
    let mut all = Vec::new();
    if let Some(kept) = &given.kept {
        let kept = kept.iter().zip(&given.metric.values);
        let kept = kept.filter(|(kept, value)| **kept && value.is_finite()).count();
        all.push((Mark::Patch(POTENTIAL), format!("{kept} members kept")));
        all.push((Mark::Patch(REJECTED), format!("{} rejected", there - kept)));
    } else {
        all.push((Mark::Patch(POTENTIAL), format!("{there} members")));
    }
    all.push((Mark::Line(TENSION), "running median".to_owned()));
    if given.band.is_some() {
        all.push((Mark::Dashed(INK), "ends of the accepted band".to_owned()));
    }
    if there > DOTS
        && let Some((_, words)) = all.first_mut()
    {
        words.push_str(" (darker where there are more)");
    }
    all
}

/// Draws dots, or shades if there are many.
fn cloud(sheet: &mut Sheet, chart: &Chart, points: &[[f64; 2]], kept: Option<&[bool]>) {
    let many = points.len() > DOTS;
    let side = if many { SQUARE } else { 0.5 };
    // Number of accepted and of other members at each place.
    let mut places: BTreeMap<[i32; 2], [u32; 2]> = BTreeMap::new();
    for (index, point) in points.iter().enumerate() {
        if point.iter().all(|x| x.is_finite()) {
            let [x, y] = chart.at(*point);
            let other = kept.is_some_and(|kept| !kept.get(index).copied().unwrap_or(false));
            let place = [(y / side).floor() as i32, (x / side).floor() as i32];
            places.entry(place).or_default()[usize::from(other)] += 1;
        }
    }
    let most = [0, 1].map(|kind| {
        let counts = places.values().map(|counts| counts[kind]);
        f64::from(counts.max().unwrap_or(0).max(2)).ln()
    });
    let mut paths: [[Path; 4]; 2] = Default::default();
    for (&[row, column], counts) in &places {
        let kind = usize::from(counts[0] == 0);
        let shade = f64::from(counts[kind]).ln() / most[kind];
        let shade = if many { ((shade * 4.0) as usize).min(3) } else { 2 };
        let [x, y] = [column, row].map(|place| f64::from(place) * side);
        let middle = y + 0.5 * side;
        let ends = if many { [x, x + side] } else { [x + 0.5 * side; 2] };
        paths[kind][shade].add_line(ends.map(|x| [x, middle]));
    }
    let dot = (60.0 / (points.len() as f64).sqrt()).clamp(DOT[0], DOT[1]);
    let pen = |colour| {
        if many { Stroke::new(colour, SQUARE) } else { Stroke::new(colour, dot).round_ends() }
    };
    let [kept, rejected] = paths;
    for (shades, colours) in [(rejected, REJECTED_SHADES), (kept, KEPT_SHADES)] {
        for (path, colour) in shades.into_iter().zip(colours) {
            sheet.path(path, pen(colour));
        }
    }
}

/// Medians of members that are neighbours in the parameter.
fn running_median(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted: Vec<[f64; 2]> =
        points.iter().copied().filter(|point| point.iter().all(|x| x.is_finite())).collect();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let of = |group: &[[f64; 2]]| {
        [0, 1].map(|axis: usize| {
            let mut values: Vec<f64> = group.iter().map(|point| point[axis]).collect();
            values.sort_by(f64::total_cmp);
            quantile(&values, 0.5)
        })
    };
    let distinct: Vec<&[[f64; 2]]> = sorted.chunk_by(|a, b| a[0] == b[0]).collect();
    if distinct.len() <= DISTINCT {
        return distinct.into_iter().map(of).collect();
    }
    let medians = (sorted.len() / TOGETHER).clamp(1, MEDIANS);
    if medians < 3 {
        return Vec::new();
    }
    sorted.chunks(sorted.len().div_ceil(medians)).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_running_median_follows_the_members_and_not_the_outliers() {
        let mut points: Vec<[f64; 2]> =
            (0..1000).map(|i| [f64::from(i), 2.0 * f64::from(i)]).collect();
        points[500][1] = 1e9;
        let median = running_median(&points);
        assert_eq!(median.len(), MEDIANS);
        assert!(median.iter().all(|[x, y]| (y - 2.0 * x).abs() < 3.0), "{median:?}");
        // Levels have a median each.
        let levels: Vec<[f64; 2]> = (0..40).map(|i| [f64::from(i % 4), f64::from(i)]).collect();
        assert_eq!(running_median(&levels)[1], [1.0, 19.0]);
    }
}
