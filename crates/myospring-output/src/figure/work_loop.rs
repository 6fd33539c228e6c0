//! Work loop: force at the ends over length, for a beat with held ends.

use super::chart::{Axis, Chart, Curve, align};
use super::font::text_width;
use super::sheet::{Anchor, Sheet, Style};
use super::theme::{CURVES, LETTER, MUTED, SINGLE, TENSION, TICK, fixed};
use super::traces::extent;
use super::{Figure, FigureError};
use myospring_core::analysis::{load, value};
use myospring_core::recording::{END_FORCE, Recording, Sample};

/// Heights of the plots, px.
const HEIGHTS: [f64; 2] = [90.0, 150.0];

/// Draws the force with which a cell pulls its ends inward, over time and over its length, with the
/// end of systole of its first beat.
///
/// Width: one column, 85 mm.
///
/// # Errors
/// A recording without a force at the ends (the ends were not held), or without a finite sample.
pub fn work_loop(recording: &Recording, stimulus_times_ms: &[f64]) -> Result<Figure, FigureError> {
    let nothing = FigureError::Nothing { what: "forces at the ends" };
    let force = recording.signals.iter().find(|signal| signal.is(END_FORCE)).ok_or(nothing)?;
    let over = |read: fn(&Sample) -> f64| -> Vec<[f64; 2]> {
        let pairs = recording.samples.iter().zip(&force.values);
        pairs.map(|(sample, force)| [read(sample), *force]).collect()
    };
    let (in_time, along) = (over(|sample| sample.t_ms), over(|sample| sample.length_um));
    if !in_time.iter().any(|[_, force]| force.is_finite()) {
        return Err(FigureError::NoSamples { what: "the force at the ends".to_owned() });
    }
    let forces = extent([in_time.as_slice()], 1);
    let high = forces[1] + 0.08 * (forces[1] - forces[0].min(0.0));
    let axis = |height| Axis::values("Force at the ends (nN)", [forces[0], high], height);
    let lengths = extent([along.as_slice()], 0);
    let mut charts = [
        Chart {
            marks: stimulus_times_ms.to_vec(),
            ..Chart::new(
                18.0,
                HEIGHTS[0],
                [Axis::time(extent([in_time.as_slice()], 0)), axis(HEIGHTS[0])],
                vec![Curve::solid(in_time, TENSION)],
            )
        },
        Chart::new(
            18.0 + HEIGHTS[0] + 52.0,
            HEIGHTS[1],
            [Axis::across("Length (\u{b5}m)", lengths, SINGLE - 75.0), axis(HEIGHTS[1])],
            vec![Curve::solid(along, CURVES[0])],
        ),
    ];
    let offset = align(&mut charts, 30.0, SINGLE - 15.0);
    let mut sheet = Sheet::default();
    for (chart, letter) in charts.iter().zip(["A", "B"]) {
        chart.draw(&mut sheet, offset);
        sheet.text([6.0, chart.place[1] + 4.0], letter, Style::new(LETTER).bold());
    }
    let [_, chart] = &charts;
    if let Some((end, work)) = end_of_systole(recording, &force.values, stimulus_times_ms) {
        let [x, y] = chart.at(end);
        sheet.dot([x, y], CURVES[0]);
        let text =
            format!("end of systole, {} nN at {} \u{b5}m", fixed(end[1], 0), fixed(end[0], 1));
        let lines = [text, format!("work on the load {} pJ", fixed(work / 1000.0, 2))];
        // To the right of the point, above the loop, if there is room in the plot.
        let widest = lines.iter().map(|line| text_width(line, TICK)).fold(0.0, f64::max);
        let right = chart.place[0] + chart.size[0];
        let (at, anchor) =
            if x + 8.0 + widest <= right { (x + 8.0, Anchor::Start) } else { (right, Anchor::End) };
        for (row, line) in lines.iter().rev().enumerate() {
            let style = Style::new(TICK).colour(MUTED).anchor(anchor);
            sheet.text([at, y - 8.0 - 12.0 * row as f64], line, style);
        }
    }
    Ok(sheet.finish(SINGLE, chart.place[1] + chart.size[1] + 37.0))
}

/// Length and force at the end of systole of the first beat, um and nN, and the work on the load, fJ.
fn end_of_systole(
    recording: &Recording,
    forces: &[f64],
    stimulus_times_ms: &[f64],
) -> Option<([f64; 2], f64)> {
    let first = *stimulus_times_ms.first()?;
    let end = stimulus_times_ms.get(1).copied().unwrap_or(f64::INFINITY);
    let samples = recording.samples.iter().take_while(|sample| sample.t_ms < end);
    let (times, lengths): (Vec<f64>, Vec<f64>) =
        samples.map(|sample| (sample.t_ms, sample.length_um)).unzip();
    let metrics = load::metrics(&times, &lengths, forces.get(..times.len())?, first);
    let of = |name| value(&metrics, name);
    Some(([of("end_systolic_length")?, of("end_systolic_force")?], of("work_on_load")?))
}
