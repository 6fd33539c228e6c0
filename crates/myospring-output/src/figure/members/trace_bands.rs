//! Curves of many members over time: median, and bands of 50 % and 90 % of the members.

use super::super::chart::{Axis, Chart, Curve, align};
use super::super::sheet::{Look, Path, Sheet, Style};
use super::super::theme::{Colour, INK, LETTER, POTENTIAL, SHORTENING, SINGLE, TENSION};
use super::super::{Figure, FigureError};
use super::{Mark, ends, legend};

/// Quantiles of the members that a [`TraceBand`] consists of.
pub const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// Size of a plot and gap between two, px.
const HEIGHT: f64 = 96.0;
const GAP: f64 = 16.0;
/// Colours of the median, of the band of 50 % and of that of 90 %.
const COLOURS: [[Colour; 3]; 3] = [
    [POTENTIAL, Colour(0x80b9d9), Colour(0xcce3f0)],
    [TENSION, Colour(0xeaaf80), Colour(0xf7dfcc)],
    [SHORTENING, Colour(0x80cfb9), Colour(0xccece3)],
];

/// One quantity over time.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceBand {
    /// Its name and unit: `Active tension (kPa)`.
    pub label: String,
    /// The [`QUANTILES`] over the members, at each time.
    pub quantiles: [Vec<f64>; 5],
    /// Its curve in the reference run; empty if it was not recorded.
    pub usual: Vec<f64>,
}

/// Draws bands of several quantities over one time axis, with their medians: at each time, 50 % of
/// the members lie in the darker band and 90 % in the lighter one. One column of a journal.
///
/// `words` says which members these are: `2000 members`.
///
/// # Errors
/// No quantity, or one without a finite number.
pub fn trace_bands(
    times_ms: &[f64],
    panels: &[TraceBand],
    words: &str,
) -> Result<Figure, FigureError> {
    let nothing = FigureError::Nothing { what: "quantities" };
    let Some(times) = ends(times_ms.iter().copied()).filter(|_| !panels.is_empty()) else {
        return Err(nothing);
    };
    let over = |values: &[f64]| times_ms.iter().zip(values).map(|(&t, &x)| [t, x]).collect();
    let mut charts: Vec<Chart> = Vec::new();
    for (row, panel) in panels.iter().enumerate() {
        let values = panel.quantiles.iter().chain([&panel.usual]).flatten().copied();
        let Some(range) = ends(values) else {
            return Err(FigureError::NoSamples { what: format!("\"{}\"", panel.label) });
        };
        let [median, ..] = COLOURS[row % COLOURS.len()];
        let mut curves = vec![Curve::solid(over(&panel.quantiles[2]), median)];
        if !panel.usual.is_empty() {
            let dash = Some([3.0, 2.0]);
            curves.push(Curve { points: over(&panel.usual), colour: INK, dash });
        }
        let x = Axis { labelled: row + 1 == panels.len(), ..Axis::time(times) };
        let axes = [x, Axis::values(&panel.label, range, HEIGHT)];
        charts.push(Chart::new(8.0 + row as f64 * (HEIGHT + GAP), HEIGHT, axes, curves));
    }
    let offset = align(&mut charts, 30.0, SINGLE - 15.0);
    let mut sheet = Sheet::default();
    for (row, (chart, panel)) in charts.iter().zip(panels).enumerate() {
        let [_, half, most] = COLOURS[row % COLOURS.len()];
        for ([low, high], colour) in [([0, 4], most), ([1, 3], half)] {
            let there = |values: &[f64]| -> Vec<[f64; 2]> {
                let points: Vec<[f64; 2]> = over(values);
                points.into_iter().filter(|point| point[1].is_finite()).collect()
            };
            let back = there(&panel.quantiles[high]).into_iter().rev();
            let ring = there(&panel.quantiles[low]).into_iter().chain(back);
            let mut path = Path::default();
            path.add_ring(ring.map(|point| chart.at(point)));
            sheet.path(path, Look::fill(colour));
        }
        chart.draw(&mut sheet, offset);
        let letter = char::from(b'A' + (row % 26) as u8).to_string();
        sheet.text([6.0, chart.place[1] + 4.0], &letter, Style::new(LETTER).bold());
    }
    let bottom = 8.0 + panels.len() as f64 * (HEIGHT + GAP) - GAP + 38.0;
    let [median, half, most] = COLOURS[0];
    let mut entries = vec![
        (Mark::Line(median), format!("median of {words}")),
        (Mark::Patch(half), "middle half".to_owned()),
        (Mark::Patch(most), "middle 90 %".to_owned()),
    ];
    if panels.iter().any(|panel| !panel.usual.is_empty()) {
        entries.push((Mark::Dashed(INK), "unchanged run".to_owned()));
    }
    let height = legend(&mut sheet, [30.0 + offset, bottom], SINGLE - 4.0, &entries);
    Ok(sheet.finish(SINGLE, bottom + height + 6.0))
}
