//! A metric over one parameter, or over two.

use super::super::chart::{Axis, Chart, Curve};
use super::super::sheet::{Anchor, Look, Sheet, Stroke, Style};
use super::super::theme::{
    BAND, Colour, DOUBLE, HAIR, INK, MUTED, POTENTIAL, TICK, decimals, fixed, nice_step,
};
use super::super::{Figure, FigureError};
use super::{Mark, ends, legend};
use crate::field::light_to_dark;

/// Number of panels in a row, and sizes, px.
const COLUMNS: usize = 3;
const HEIGHT: f64 = 112.0;
const GAP: f64 = 18.0;
const MARGIN: f64 = 8.0;
const BELOW: f64 = 46.0;
/// Up to this number of values of a second parameter, each is a line; with more, a map is drawn.
const LINES: usize = 6;
/// Number of steps of a colour bar; its width and its distance from the map, px.
const COLOURS: usize = 48;
const BAR: [f64; 2] = [8.0, 7.0];

/// One metric over one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberResponse {
    /// The parameter, with its unit.
    pub parameter: String,
    /// The metric, with its unit.
    pub metric: String,
    /// Values of parameter and metric, sorted by the parameter; the metric is NaN if it is missing.
    pub points: Vec<[f64; 2]>,
    /// The parameter's reference value.
    pub usual: Option<f64>,
    /// Band of the metric in which members are accepted, such as a measured one.
    pub band: Option<[f64; 2]>,
}

/// Metrics over two parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseMap {
    /// Both parameters, with their units: horizontal and vertical.
    pub parameters: [String; 2],
    /// Their values, ascending.
    pub values: [Vec<f64>; 2],
    /// Each metric, with its unit, and its values; the second parameter varies fastest.
    pub metrics: Vec<(String, Vec<f64>)>,
}

/// Position and width of a plot in the grid of panels, given the space to its left and right.
fn placed(index: usize, left_room: f64, right_room: f64) -> ([f64; 2], f64) {
    let pitch = (DOUBLE - 2.0 * MARGIN + GAP) / COLUMNS as f64;
    let left = MARGIN + (index % COLUMNS) as f64 * pitch + left_room;
    let top = 16.0 + (index / COLUMNS) as f64 * (HEIGHT + BELOW + 12.0);
    ([left, top], pitch - GAP - left_room - right_room)
}

/// Draws the name of the metric above its plot.
fn head(sheet: &mut Sheet, [left, top]: [f64; 2], metric: &str) {
    sheet.text([left, top - 5.0], metric, Style::new(TICK).bold());
}

fn bottom(panels: usize) -> f64 {
    16.0 + panels.div_ceil(COLUMNS) as f64 * (HEIGHT + BELOW + 12.0) - 22.0
}

/// Draws response curves; those of one metric share their vertical axis, so that their slopes can
/// be compared. Three panels in a row, two columns of a journal.
///
/// # Errors
/// No curve, or none with a finite number.
pub fn responses(curves: &[MemberResponse]) -> Result<Figure, FigureError> {
    let finite = |one: &&MemberResponse| one.points.iter().any(|point| point[1].is_finite());
    let curves: Vec<&MemberResponse> = curves.iter().filter(finite).collect();
    if curves.is_empty() {
        return Err(FigureError::Nothing { what: "response curves with finite numbers" });
    }
    let chart = |one: &&MemberResponse| {
        let same = curves.iter().filter(|other| other.metric == one.metric);
        let values = same.clone().flat_map(|one| &one.points).map(|point| point[1]);
        let range = ends(values.chain(same.filter_map(|one| one.band).flatten()));
        let over = ends(one.points.iter().map(|point| point[0]));
        let x = Axis::across(&one.parameter, over.unwrap_or([0.0, 1.0]), 150.0);
        let axes = [x, Axis::upright("", range.unwrap_or([0.0, 1.0]), HEIGHT)];
        Chart {
            bands: one.band.into_iter().collect(),
            marks: one.usual.into_iter().collect(),
            ..Chart::new(0.0, HEIGHT, axes, vec![Curve::solid(one.points.clone(), POTENTIAL)])
        }
    };
    let mut charts: Vec<Chart> = curves.iter().map(chart).collect();
    let mut sheet = Sheet::default();
    let offset = charts.iter().map(Chart::label_offset).fold(0.0, f64::max);
    for (index, chart) in charts.iter_mut().enumerate() {
        (chart.place, chart.size[0]) = placed(index, offset, 4.0);
        chart.draw(&mut sheet, offset);
        let metric = &curves[index].metric;
        if index == 0 || curves[index - 1].metric != *metric {
            head(&mut sheet, chart.place, metric);
        }
        for point in chart.curves[0].points.iter().filter(|point| point[1].is_finite()) {
            sheet.dot(chart.at(*point), POTENTIAL);
        }
    }
    let mut height = bottom(charts.len());
    let usual = curves.iter().any(|one| one.usual.is_some());
    let banded = curves.iter().any(|one| one.band.is_some());
    let words: Vec<(Mark, String)> = usual
        .then(|| (Mark::Dashed(MUTED), "usual value".to_owned()))
        .into_iter()
        .chain(banded.then(|| (Mark::Patch(BAND), "accepted band".to_owned())))
        .collect();
    if !words.is_empty() {
        height += legend(&mut sheet, [MARGIN, height], DOUBLE, &words);
    }
    Ok(sheet.finish(DOUBLE, height + 6.0))
}

/// Draws metrics over two parameters: a line for each value of the second if these are few, else a
/// colour map. Three panels in a row, two columns of a journal.
///
/// # Errors
/// No metric, or one without a finite number.
pub fn response_map(map: &ResponseMap) -> Result<Figure, FigureError> {
    let whole = |values: &Vec<f64>| values.iter().any(|value| value.is_finite());
    if map.metrics.is_empty() || !map.metrics.iter().all(|(_, values)| whole(values)) {
        return Err(FigureError::Nothing { what: "metrics with finite numbers" });
    }
    let mut sheet = Sheet::default();
    let mut height = bottom(map.metrics.len());
    if map.values[1].len() <= LINES {
        height += lines(&mut sheet, map, height);
    } else {
        for (index, (metric, values)) in map.metrics.iter().enumerate() {
            coloured(&mut sheet, map, index, metric, values);
        }
    }
    Ok(sheet.finish(DOUBLE, height + 6.0))
}

/// Draws a line for each value of the second parameter; returns the height of the legend, px.
fn lines(sheet: &mut Sheet, map: &ResponseMap, bottom: f64) -> f64 {
    let [first, second] = &map.values;
    let last = second.len().saturating_sub(1).max(1) as f64;
    let colour = |line: usize| Colour::from_channels(light_to_dark(0.3 + 0.7 * line as f64 / last));
    let chart = |(_, values): &(String, Vec<f64>)| {
        let curve = |line: usize| {
            let at = |(place, &x): (usize, &f64)| {
                [x, values.get(place * second.len() + line).copied().unwrap_or(f64::NAN)]
            };
            Curve::solid(first.iter().enumerate().map(at).collect(), colour(line))
        };
        let over = ends(first.iter().copied()).unwrap_or([0.0, 1.0]);
        let range = ends(values.iter().copied()).unwrap_or([0.0, 1.0]);
        let axes =
            [Axis::across(&map.parameters[0], over, 150.0), Axis::upright("", range, HEIGHT)];
        Chart::new(0.0, HEIGHT, axes, (0..second.len()).map(curve).collect())
    };
    let mut charts: Vec<Chart> = map.metrics.iter().map(chart).collect();
    let offset = charts.iter().map(Chart::label_offset).fold(0.0, f64::max);
    for (index, chart) in charts.iter_mut().enumerate() {
        (chart.place, chart.size[0]) = placed(index, offset, 4.0);
        chart.draw(sheet, offset);
        head(sheet, chart.place, &map.metrics[index].0);
    }
    let digits = digits(second);
    let mut words = vec![(Mark::None, format!("{}:", map.parameters[1]))];
    words.extend(
        second
            .iter()
            .enumerate()
            .map(|(line, value)| (Mark::Line(colour(line)), fixed(*value, digits))),
    );
    legend(sheet, [MARGIN, bottom], DOUBLE - MARGIN, &words)
}

/// Number of decimals that distinguish the values.
fn digits(values: &[f64]) -> usize {
    let [low, high] = ends(values.iter().copied()).unwrap_or([0.0, 1.0]);
    let step = (high - low) / values.len().saturating_sub(1).max(1) as f64;
    decimals(nice_step(step, 5.0))
}

/// Draws one metric as a colour map, with its colour bar.
fn coloured(sheet: &mut Sheet, map: &ResponseMap, index: usize, metric: &str, values: &[f64]) {
    let [low, high] = ends(values.iter().copied()).unwrap_or([0.0, 1.0]);
    let part = |value: f64| if high > low { (value - low) / (high - low) } else { 0.5 };
    let shown = |value: f64| Colour::from_channels(light_to_dark(part(value)));
    // Each value is the centre of its field.
    let [across, upward] = [0, 1].map(|axis: usize| fields(&map.values[axis]));
    let ticks = Axis::upright("", [low, high], HEIGHT);
    let (place, width) = placed(index, 46.0, 46.0);
    let spread = |fields: &[f64]| [fields[0], fields[fields.len() - 1]];
    let exactly = |axis: Axis, range: [f64; 2]| Axis { range, ..axis };
    let axes = [
        exactly(Axis::across(&map.parameters[0], spread(&across), width), spread(&across)),
        exactly(Axis::upright(&map.parameters[1], spread(&upward), HEIGHT), spread(&upward)),
    ];
    let chart = Chart { place, size: [width, HEIGHT], ..Chart::new(0.0, HEIGHT, axes, Vec::new()) };
    for column in 0..map.values[0].len() {
        for row in 0..map.values[1].len() {
            let value = values.get(column * map.values[1].len() + row).copied();
            let Some(value) = value.filter(|value| value.is_finite()) else { continue };
            let [left, lower] = chart.at([across[column], upward[row]]);
            let [right, upper] = chart.at([across[column + 1], upward[row + 1]]);
            // Overlaps its neighbours slightly, so that no seams show.
            let size = [right - left + 0.3, lower - upper + 0.3];
            sheet.rect([left, upper - 0.3], size, Look::fill(shown(value)));
        }
    }
    chart.draw(sheet, 36.0);
    let style = Style::new(TICK);
    head(sheet, place, metric);
    let [left, top] = [place[0] + width + BAR[1], place[1]];
    for step in 0..COLOURS {
        let lower = HEIGHT * (1.0 - step as f64 / COLOURS as f64);
        let colour = Colour::from_channels(light_to_dark((step as f64 + 0.5) / COLOURS as f64));
        sheet.rect([left, top], [BAR[0], lower], Look::fill(colour));
    }
    sheet.rect([left, top], [BAR[0], HEIGHT], Stroke::new(INK, HAIR));
    let step = ticks.step;
    for count in (low / step).ceil() as i64..=(high / step).floor() as i64 {
        let value = count as f64 * step;
        let y = top + HEIGHT * (1.0 - part(value));
        sheet.line([left + BAR[0], y], [left + BAR[0] + 3.0, y], Stroke::new(INK, HAIR));
        let text = fixed(value, decimals(step));
        sheet.text([left + BAR[0] + 5.0, y + 3.6], &text, style.anchor(Anchor::Start));
    }
}

/// The edges of fields around ascending values.
fn fields(values: &[f64]) -> Vec<f64> {
    let [Some(&first), Some(&last)] = [values.first(), values.last()] else {
        return vec![0.0, 1.0];
    };
    if values.len() == 1 {
        return vec![first - 0.5, first + 0.5];
    }
    let count = values.len();
    let mut ends = vec![1.5 * first - 0.5 * values[1]];
    ends.extend(values.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])));
    ends.push(1.5 * last - 0.5 * values[count - 2]);
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_a_map_lie_around_their_values() {
        assert_eq!(fields(&[1.0, 2.0, 4.0]), [0.5, 1.5, 3.0, 5.0]);
        assert_eq!(fields(&[3.0]), [2.5, 3.5]);
    }
}
