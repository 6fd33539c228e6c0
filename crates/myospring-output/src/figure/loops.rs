//! Calcium and motion of the same beats: over time, and the loop that they make.

use super::chart::{Axis, Chart, Curve, ends};
use super::font::text_width;
use super::measured::{colour, label};
use super::sheet::{Anchor, Figure, Path, Sheet, Stroke, Style};
use super::theme::{CURVES, Colour, DOUBLE, INK, LETTER, MUTED, REST, TICK};
use super::{FigureError, theme};
use myospring_core::analysis::kind::Kind;
use myospring_core::analysis::paired::{Loop, Paired};

/// Heights of the curves over time, and of the loop, px.
const HEIGHTS: [f64; 2] = [86.0, 224.0];
/// Loops of single beats.
const SINGLE_BEATS: Colour = Colour(0xc4c4c4);
/// Parts of the mean beat's points at which an arrow shows which way round its loop goes.
const ARROWS: usize = 3;

/// Calcium and motion of the same beats.
#[derive(Debug, Clone, Copy)]
pub struct DrawnLoops<'a> {
    /// Its title.
    pub title: &'a str,
    /// Kind and unit of calcium.
    pub calcium: (Kind, &'a str),
    /// Kind of the motion.
    pub motion: Kind,
    /// Their beats.
    pub paired: &'a Paired,
}

/// Draws calcium and motion of the mean beat over time at the left, and the loops of single beats and of the mean beat
/// at the right, with calcium at half of the motion.
///
/// # Errors
/// No beat has a loop.
pub fn loops(drawn: &DrawnLoops) -> Result<Figure, FigureError> {
    let DrawnLoops { title, paired, .. } = drawn;
    let mean = paired.mean_loop.as_ref().ok_or(FigureError::Nothing { what: "loops" })?;
    let all: Vec<&Loop> = paired.loops.iter().map(|(_, one)| one).collect();
    let motion = if drawn.motion.is_length() { Kind::Shortening } else { drawn.motion };
    let words = [label(drawn.calcium.0, drawn.calcium.1), label(motion, paired.motion_unit)];
    let values: [fn(&Loop) -> &Vec<f64>; 2] = [|one| &one.calcium, |one| &one.motion];
    let mut sheet = Sheet::default();
    sheet.text([8.0, 16.0], title, Style::new(LETTER).bold());
    let span = [mean.times_ms[0], mean.times_ms[mean.times_ms.len() - 1]];
    let over_time = |side: usize| {
        let read = values[side];
        let points = |one: &Loop, within: [f64; 2]| -> Vec<[f64; 2]> {
            let pairs = one.times_ms.iter().zip(read(one));
            let pairs = pairs.filter(|(time, _)| (within[0]..=within[1]).contains(*time));
            pairs.map(|(time, value)| [*time, *value]).collect()
        };
        let range = ends(all.iter().flat_map(|one| read(one).iter().copied()));
        let y = Axis::upright(&words[side], range, HEIGHTS[0]);
        let x = Axis::time(span);
        let x = Axis {
            label: "Time from the onset of calcium (ms)".to_owned(),
            labelled: side == 1,
            ..x
        };
        let mut curves: Vec<Curve> =
            all.iter().map(|one| Curve::solid(points(one, span), SINGLE_BEATS)).collect();
        let tone = colour(if side == 0 { drawn.calcium.0 } else { motion });
        curves.push(Curve::solid(points(mean, span), tone));
        let top = 40.0 + side as f64 * (HEIGHTS[0] + 52.0 - 8.0);
        Chart::new(top, HEIGHTS[0], [x, y], curves)
    };
    let around = |one: &Loop| -> Vec<[f64; 2]> {
        one.calcium.iter().zip(&one.motion).map(|(x, y)| [*x, *y]).collect()
    };
    let extent = |side: usize| ends(all.iter().flat_map(|one| values[side](one).iter().copied()));
    let half = 0.5 * DOUBLE;
    let mut curves: Vec<Curve> =
        all.iter().map(|one| Curve::solid(around(one), SINGLE_BEATS)).collect();
    curves.push(Curve::solid(around(mean), CURVES[0]));
    let axes = [
        Axis::across(&words[0], extent(0), half - 90.0),
        Axis::upright(&words[1], extent(1), HEIGHTS[1]),
    ];
    let mut charts = [over_time(0), over_time(1), Chart::new(40.0, HEIGHTS[1], axes, curves)];
    let left = charts[..2].iter().map(Chart::label_offset).fold(0.0, f64::max);
    for chart in &mut charts[..2] {
        (chart.place[0], chart.size[0]) = (18.0 + left, half - 40.0 - left);
    }
    let offset = charts[2].label_offset();
    (charts[2].place[0], charts[2].size[0]) = (half + 18.0 + offset, half - 32.0 - offset);
    for (chart, (letter, offset)) in charts.iter().zip([("A", left), ("B", left), ("C", offset)]) {
        chart.draw(&mut sheet, offset);
        let [x, y] = [chart.place[0] - offset - 12.0, chart.place[1] - 8.0];
        sheet.text([x, y], letter, Style::new(LETTER).bold());
    }
    arrows(&mut sheet, &charts[2], mean);
    halves(&mut sheet, &charts[2], mean);
    let [_, _, chart] = &charts;
    let words = format!("{} beats; blue: mean; {}", all.len(), paired.direction.words());
    let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
    sheet.text([chart.place[0] + chart.size[0], chart.place[1] - 8.0], &words, style);
    Ok(sheet.finish(DOUBLE, 40.0 + HEIGHTS[1] + 44.0))
}

/// Small arrows along the mean loop.
fn arrows(sheet: &mut Sheet, chart: &Chart, mean: &Loop) {
    let points: Vec<[f64; 2]> =
        mean.calcium.iter().zip(&mean.motion).map(|(x, y)| chart.at([*x, *y])).collect();
    let ways: Vec<f64> = points
        .windows(2)
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
        .collect();
    let whole: f64 = ways.iter().sum();
    let mut past = 0.0;
    let mut next = 1;
    for (at, way) in ways.iter().enumerate() {
        past += way;
        // In the middle of each third of the way.
        if next > ARROWS || past < whole * (next as f64 - 0.5) / ARROWS as f64 {
            continue;
        }
        next += 1;
        let (from, tip) = (points[at], points[at + 1]);
        let angle = (tip[1] - from[1]).atan2(tip[0] - from[0]);
        let barb = |turn: f64| {
            let angle = angle + turn;
            [tip[0] - 7.0 * angle.cos(), tip[1] - 7.0 * angle.sin()]
        };
        let head = Path::line([barb(0.45), tip, barb(-0.45)]);
        sheet.path(head, Stroke::new(CURVES[0], theme::CURVE_WIDTH).round_ends());
    }
}

/// Where the mean motion passes half of its height.
fn halves(sheet: &mut Sheet, chart: &Chart, mean: &Loop) {
    let top = mean.motion.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let crossings = (1..mean.motion.len()).filter(|&at| {
        let [before, after] =
            [mean.motion[at - 1], mean.motion[at]].map(|value| value >= 0.5 * top);
        before != after
    });
    let crossings: Vec<usize> = crossings.collect();
    let sides = [
        crossings.first().map(|at| (*at, "half up")),
        crossings.last().map(|at| (*at, "half back")),
    ];
    for (at, words) in sides.into_iter().flatten() {
        let [x, y] = chart.at([mean.calcium[at], mean.motion[at]]);
        sheet.dot([x, y], INK);
        let style = Style::new(TICK).colour(REST);
        let has_room = x - 8.0 - text_width(words, TICK) > chart.place[0];
        let (x, style) =
            if has_room { (x - 8.0, style.anchor(Anchor::End)) } else { (x + 8.0, style) };
        sheet.text([x, y + 4.0], words, style);
    }
}
