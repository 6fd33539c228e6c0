//! Curves over time: action potential, active tension, shortening.

use super::chart::{Axis, Chart, Curve, align, ends};
use super::font::text_width;
use super::sheet::{Anchor, Look, Sheet, Stroke, Style};
use super::theme::{
    BAND, CALCIUM, CURVE_WIDTH, CURVES, Colour, LETTER, MUTED, POTENTIAL, SINGLE, TENSION, TICK,
    fixed, time,
};
use super::{Figure, FigureError};
use myospring_core::analysis::beats::Beats;
use myospring_core::analysis::trace;
use myospring_core::recording::CALCIUM as CYTOSOL;
use myospring_core::recording::{Recording, Sample, Signal};
use std::borrow::Cow;

/// The quantity that a panel shows.
pub(super) struct Quantity {
    pub(super) label: Cow<'static, str>,
    pub(super) unit: Cow<'static, str>,
    pub(super) colour: Colour,
    /// Whether its peak is marked and labelled.
    pub(super) noted: bool,
    pub(super) value: Shown,
}

/// Where the values of a quantity are found.
pub(super) enum Shown {
    /// In the samples.
    Sample(fn(&Sample) -> f64),
    /// In the further signals of the cell model.
    Calcium,
}

/// Which drives of the tension a recording has: potential, calcium.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drives {
    potential: bool,
    millivolts: bool,
    /// Its unit.
    calcium: Option<String>,
}

impl Drives {
    /// The drives of a recording.
    pub(super) fn of(recording: &Recording) -> Self {
        let samples = &recording.samples;
        Self {
            potential: samples.iter().any(|sample| sample.u.is_some()),
            millivolts: samples.iter().any(|sample| sample.vm_mv.is_some()),
            calcium: calcium(recording).map(|(_, unit)| unit.to_owned()),
        }
    }

    /// The drives that both have.
    pub(super) fn and(self, other: &Self) -> Self {
        Self {
            potential: self.potential && other.potential,
            millivolts: self.millivolts && other.millivolts,
            calcium: self.calcium.filter(|unit| Some(unit) == other.calcium.as_ref()),
        }
    }

    /// The drives as quantities: the potential, in mV if the cell model defines it, and calcium.
    pub(super) fn quantities(&self) -> Vec<Quantity> {
        let quantity = |label: String, unit: &str, colour, value| Quantity {
            label: label.into(),
            unit: unit.to_owned().into(),
            colour,
            noted: false,
            value,
        };
        let mut quantities = Vec::new();
        if self.millivolts {
            let value = Shown::Sample(|s| s.vm_mv.unwrap_or(f64::NAN));
            quantities.push(quantity("Potential (mV)".to_owned(), "mV", POTENTIAL, value));
        } else if self.potential {
            let value = Shown::Sample(|s| s.u.unwrap_or(f64::NAN));
            quantities.push(quantity("Potential u (\u{2013})".to_owned(), "", POTENTIAL, value));
        }
        if let Some(unit) = &self.calcium {
            let label = format!("Calcium ({})", unit.replace("uM", "\u{b5}M"));
            quantities.push(quantity(label, unit, CALCIUM, Shown::Calcium));
        }
        quantities
    }
}

/// Cytosolic calcium and its unit; in a table that was read from a file, the unit is part of the
/// name.
fn calcium(recording: &Recording) -> Option<(&Signal, &str)> {
    recording.signals.iter().find_map(|signal| match signal.name.strip_prefix(CYTOSOL)? {
        "" => Some((signal, signal.unit.as_str())),
        rest => Some((signal, rest.strip_prefix('_')?)),
    })
}

/// The active tension.
pub(super) const ACTIVE_TENSION: Quantity = Quantity {
    label: Cow::Borrowed("Active tension (kPa)"),
    unit: Cow::Borrowed("kPa"),
    colour: TENSION,
    noted: true,
    value: Shown::Sample(|s| s.ta_kpa),
};

/// The shortening.
pub(super) const SHORTENING: Quantity = Quantity {
    label: Cow::Borrowed("Shortening (%)"),
    unit: Cow::Borrowed("%"),
    colour: CURVES[0],
    noted: true,
    value: Shown::Sample(|s| s.shortening_pct),
};

/// The points of a quantity over time.
pub(super) fn points(recording: &Recording, quantity: &Quantity) -> Vec<[f64; 2]> {
    let samples = &recording.samples;
    match quantity.value {
        Shown::Sample(read) => samples.iter().map(|sample| [sample.t_ms, read(sample)]).collect(),
        Shown::Calcium => {
            let values = calcium(recording).into_iter().flat_map(|(signal, _)| &signal.values);
            samples.iter().zip(values).map(|(sample, value)| [sample.t_ms, *value]).collect()
        }
    }
}

fn finite(points: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    points.iter().copied().filter(|[t, value]| t.is_finite() && value.is_finite())
}

/// Smallest and largest value of one coordinate over finite points.
pub(super) fn extent<'a>(
    curves: impl IntoIterator<Item = &'a [[f64; 2]]>,
    axis: usize,
) -> [f64; 2] {
    ends(curves.into_iter().flat_map(finite).map(|point| point[axis]))
}

/// The maximum of a curve, interpolated between samples.
pub(super) fn peak(points: &[[f64; 2]]) -> Option<[f64; 2]> {
    let (times, values): (Vec<f64>, Vec<f64>) = finite(points).map(|[t, value]| (t, value)).unzip();
    trace::peak(&times, &values).map(|top| [top.time, top.value])
}

fn check(points: &[[f64; 2]], what: impl FnOnce() -> String) -> Result<(), FigureError> {
    finite(points).next().map(|_| ()).ok_or_else(|| FigureError::NoSamples { what: what() })
}

/// Panels of one recording above each other, with one time axis.
pub(super) struct Stack<'a> {
    pub(super) recording: &'a Recording,
    pub(super) quantities: &'a [Quantity],
    pub(super) stimulus_times_ms: &'a [f64],
    /// Left and right end of the panels with their labels, px.
    pub(super) sides: [f64; 2],
    /// Upper end of the first plot and height of each, px.
    pub(super) top: f64,
    pub(super) height: f64,
    /// Distance between plots, px.
    pub(super) gap: f64,
    /// Letter of the first panel.
    pub(super) letter: char,
}

impl Stack<'_> {
    /// Draws the panels and returns the lower end of the last one with its labels, px.
    pub(super) fn draw(&self, sheet: &mut Sheet) -> Result<f64, FigureError> {
        let curves: Vec<Vec<[f64; 2]>> =
            self.quantities.iter().map(|quantity| points(self.recording, quantity)).collect();
        for (curve, quantity) in curves.iter().zip(self.quantities) {
            check(curve, || format!("the recording of \"{}\"", quantity.label))?;
        }
        let times = extent(curves.iter().map(Vec::as_slice), 0);
        let last = self.quantities.len().saturating_sub(1);
        let missed = missed(self.recording, self.stimulus_times_ms);
        let captured: Vec<f64> =
            self.stimulus_times_ms.iter().copied().filter(|t| !missed.contains(t)).collect();
        let mut charts: Vec<Chart> = Vec::new();
        for (row, quantity) in self.quantities.iter().enumerate() {
            let [low, high] = extent([curves[row].as_slice()], 1);
            // Room for the label of the peak.
            let room = if quantity.noted { 0.12 * (high - low.min(0.0)) } else { 0.0 };
            charts.push(Chart {
                marks: captured.clone(),
                ..Chart::new(
                    self.top + row as f64 * (self.height + self.gap),
                    self.height,
                    [
                        Axis { labelled: row == last, ..Axis::time(times) },
                        Axis::values(&quantity.label, [low, high + room], self.height),
                    ],
                    vec![Curve::solid(curves[row].clone(), quantity.colour)],
                )
            });
        }
        // The plots of all panels are aligned, right of the widest labels; half a tick label
        // extends beyond the time axis.
        let offset = align(&mut charts, self.sides[0] + 24.0, self.sides[1] - 11.0);
        for (row, chart) in charts.iter().enumerate() {
            chart.draw(sheet, offset);
            chart.draw_missed(sheet, &missed, if row == 0 { NOT_CAPTURED } else { "" });
            let letter = char::from_u32(self.letter as u32 + row as u32).unwrap_or(self.letter);
            let corner = [self.sides[0], chart.place[1] + 4.0];
            sheet.text(corner, &letter.to_string(), Style::new(LETTER).bold());
            if row == 0 {
                mark_stimulus(sheet, chart);
            }
            if let Some(top) = peak(&curves[row]).filter(|_| self.quantities[row].noted) {
                note_peak(sheet, chart, top, &self.quantities[row]);
            }
        }
        Ok(charts.last().map_or(self.top, |chart| chart.place[1] + self.height + 37.0))
    }
}

const NOT_CAPTURED: &str = "not captured";

/// The stimuli without an action potential.
fn missed(recording: &Recording, stimulus_times_ms: &[f64]) -> Vec<f64> {
    let beats = Beats::of(recording, stimulus_times_ms, None);
    beats.iter().filter(|beat| beat.is_missed()).map(|beat| beat.stimulus_ms).collect()
}

/// Labels the first stimulus above the plot.
fn mark_stimulus(sheet: &mut Sheet, chart: &Chart) {
    let [first, last] = chart.x.range;
    if let Some(&t) = chart.marks.iter().find(|t| (first..=last).contains(*t)) {
        let [x, _] = chart.at([t, 0.0]);
        let top = chart.place[1] - 4.0;
        sheet.text(
            [x.max(chart.place[0] + 22.0), top],
            "stimulus",
            Style::new(TICK).colour(MUTED).anchor(Anchor::Middle),
        );
    }
}

/// Draws a dot at the peak, with value and time beside it.
fn note_peak(sheet: &mut Sheet, chart: &Chart, top: [f64; 2], quantity: &Quantity) {
    if top[1] <= 0.0 {
        return;
    }
    let [x, y] = chart.at(top);
    sheet.dot([x, y], quantity.colour);
    let digits = if top[1] < 1.0 { 3 } else { 1 };
    let text = format!("{} {} at {}", fixed(top[1], digits), quantity.unit, time(top[0]));
    let width = text_width(&text, TICK);
    let right = chart.place[0] + chart.size[0];
    let style = Style::new(TICK);
    let free = |left: f64| !chart.crosses([left, y - 12.0], [left + width, y + 1.0]);
    if x + 8.0 + width <= right + 8.0 && free(x + 8.0) {
        sheet.text([x + 8.0, y - 1.0], &text, style);
    } else if x - 8.0 - width >= chart.place[0] && free(x - 8.0 - width) {
        sheet.text([x - 8.0, y - 1.0], &text, style.anchor(Anchor::End));
    } else {
        // Other beats are next to the peak.
        sheet.text([right, chart.place[1] - 2.0], &text, style.anchor(Anchor::End));
    }
}

/// Draws action potential, active tension and (if the cell has it) calcium over one time axis (the
/// paper's Fig. 3).
///
/// The potential is in mV if the cell model defines it, and dimensionless otherwise; without a
/// potential, calcium is shown instead. Dashed lines mark the stimuli, those that were not captured
/// in another colour. Width: one column, 85 mm.
///
/// # Errors
/// A recording without a finite sample.
pub fn action_potential_and_tension(
    recording: &Recording,
    stimulus_times_ms: &[f64],
) -> Result<Figure, FigureError> {
    let mut sheet = Sheet::default();
    let mut quantities = Drives::of(recording).quantities();
    quantities.push(ACTIVE_TENSION);
    let stack = Stack {
        recording,
        quantities: &quantities,
        stimulus_times_ms,
        sides: [6.0, SINGLE - 4.0],
        top: 18.0,
        height: 108.0,
        gap: 16.0,
        letter: 'A',
    };
    let bottom = stack.draw(&mut sheet)?;
    Ok(sheet.finish(SINGLE, bottom))
}

/// Options of the contraction figure.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContractionOptions<'a> {
    /// Times of the stimuli, ms, marked by dashed lines; default: none.
    pub stimulus_times_ms: Vec<f64>,
    /// A band of shortening known from experiments, per cent, and its name: `([7.0, 12.0], "adult
    /// ventricular myocytes, unloaded")`; default: none.
    pub reference_band: Option<([f64; 2], &'a str)>,
}

/// Dashes of the first, second and third curve of one colour.
const DASHES: [Option<[f64; 2]>; 3] = [None, Some([5.0, 3.0]), Some([1.5, 2.5])];

/// The line style of one of several curves.
pub(super) fn pen(index: usize) -> Stroke {
    let stroke = Stroke::new(CURVES[index % CURVES.len()], CURVE_WIDTH);
    Stroke { dash: DASHES[index / CURVES.len() % DASHES.len()], ..stroke }
}

/// An entry of the legend: text, line style, whether it is a band.
struct Entry {
    text: String,
    pen: Stroke,
    band: bool,
}

/// Draws shortening over time, one curve for each recording (the paper's Fig. 6).
///
/// The legend states each curve's greatest shortening and its time. Width: one column, 85 mm.
///
/// # Errors
/// No recording, or one without a finite sample.
pub fn contraction(
    recordings: &[(&str, &Recording)],
    options: &ContractionOptions<'_>,
) -> Result<Figure, FigureError> {
    if recordings.is_empty() {
        return Err(FigureError::Nothing { what: "recordings" });
    }
    let stimuli = &options.stimulus_times_ms;
    // A stimulus counts as missed if all runs miss it.
    let mut missed_by = recordings.iter().map(|(_, recording)| missed(recording, stimuli));
    let mut missed = missed_by.next().unwrap_or_default();
    missed_by.for_each(|by| missed.retain(|t| by.contains(t)));
    let mut curves = Vec::new();
    let mut legend = Vec::new();
    for (index, (label, recording)) in recordings.iter().enumerate() {
        let points = points(recording, &SHORTENING);
        check(&points, || format!("the recording \"{label}\""))?;
        let pen = pen(index);
        if let Some([t, value]) = peak(&points) {
            let text = format!("{label}: {} % at {}", fixed(value, 1), time(t));
            legend.push(Entry { text, pen, band: false });
        }
        curves.push(Curve { points, colour: pen.colour, dash: pen.dash });
    }
    // Sorted by peak, in the vertical order of the curves.
    let height_of = |curve: &Curve| peak(&curve.points).map_or(f64::NEG_INFINITY, |top| top[1]);
    let mut order: Vec<usize> = (0..curves.len()).collect();
    order.sort_by(|&a, &b| height_of(&curves[b]).total_cmp(&height_of(&curves[a])));
    let mut rank = vec![0; order.len()];
    for (place, &index) in order.iter().enumerate() {
        rank[index] = place;
    }
    let mut ranked: Vec<(usize, Entry)> = legend.into_iter().enumerate().collect();
    ranked.sort_by_key(|(index, _)| rank.get(*index).copied());
    let mut legend: Vec<Entry> = ranked.into_iter().map(|(_, entry)| entry).collect();
    if let Some(([low, high], name)) = options.reference_band {
        let digits = usize::from(low.fract() != 0.0 || high.fract() != 0.0);
        let range = format!("{}\u{2013}{} %", fixed(low, digits), fixed(high, digits));
        let pen = Stroke::new(BAND, CURVE_WIDTH);
        legend.push(Entry { text: format!("{name}: {range} (band)"), pen, band: true });
    }

    let values = extent(curves.iter().map(|curve| curve.points.as_slice()), 1);
    let band_top = options.reference_band.map_or(0.0, |([_, high], _)| high);
    let high = values[1].max(band_top) + 0.04 * (values[1] - values[0].min(0.0));
    let mut chart = Chart {
        place: [0.0, if options.stimulus_times_ms.is_empty() { 9.0 } else { 18.0 }],
        size: [0.0, 168.0],
        x: Axis::time(extent(curves.iter().map(|curve| curve.points.as_slice()), 0)),
        y: Axis::values(&SHORTENING.label, [values[0], high], 168.0),
        bands: options.reference_band.iter().map(|(band, _)| *band).collect(),
        marks: stimuli.iter().copied().filter(|t| !missed.contains(t)).collect(),
        curves,
    };
    let left = (chart.label_offset() + 14.0).max(44.0);
    (chart.place[0], chart.size[0]) = (left, SINGLE - left - 13.0);
    let inside = legend_inside(&chart, &legend);
    if inside.is_none() {
        chart.place[1] += 8.0 + ROW * legend.len() as f64;
    }
    let mut sheet = Sheet::default();
    chart.draw(&mut sheet, chart.label_offset());
    chart.draw_missed(&mut sheet, &missed, NOT_CAPTURED);
    mark_stimulus(&mut sheet, &chart);
    for curve in &chart.curves {
        if let Some(top) = peak(&curve.points) {
            sheet.dot(chart.at(top), curve.colour);
        }
    }
    // Above the plot, shifted left if needed.
    let above = [left.min(SINGLE - 4.0 - legend_width(&legend)).max(6.0), 6.0];
    draw_legend(&mut sheet, inside.unwrap_or(above), &legend);
    Ok(sheet.finish(SINGLE, chart.place[1] + chart.size[1] + 37.0))
}

/// Height of a row of the legend and length of its swatch with the gap after it, px.
const ROW: f64 = 14.0;
const SWATCH: f64 = 24.0;

fn legend_width(legend: &[Entry]) -> f64 {
    SWATCH + legend.iter().map(|entry| text_width(&entry.text, TICK)).fold(0.0, f64::max)
}

/// The upper right corner of the plot, if no curve or band passes there.
fn legend_inside(chart: &Chart, legend: &[Entry]) -> Option<[f64; 2]> {
    let width = legend_width(legend);
    let [left, top] = [chart.place[0] + chart.size[0] - width, chart.place[1]];
    let bottom = top + ROW * legend.len() as f64 + 4.0;
    let corners = [[left - 10.0, f64::NEG_INFINITY], [f64::INFINITY, bottom + 4.0]];
    let free = width < 0.6 * chart.size[0]
        && chart.bands.is_empty()
        && !chart.crosses(corners[0], corners[1]);
    free.then_some([left, top])
}

fn draw_legend(sheet: &mut Sheet, [left, top]: [f64; 2], legend: &[Entry]) {
    for (row, entry) in legend.iter().enumerate() {
        let middle = top + ROW * (row as f64 + 0.5);
        if entry.band {
            let look = Look::fill(entry.pen.colour);
            sheet.rect([left, middle - 4.0], [SWATCH - 6.0, 8.0], look);
        } else {
            let end = [left + SWATCH - 6.0, middle];
            sheet.line([left, middle], end, entry.pen);
        }
        sheet.text([left + SWATCH, middle + 3.5], &entry.text, Style::new(TICK));
    }
}
