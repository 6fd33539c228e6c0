//! Tractions of a cell on its gel: a map with arrows, and forces over time.

use super::cell::DrawnCell;
use super::chart::{Axis, Chart, Curve, align};
use super::moments::Shape;
use super::shapes::{Gallery, HEAD};
use super::sheet::{Path, Sheet, Stroke, Style};
use super::theme::{CURVES, INK, LETTER, SINGLE, TENSION, TICK};
use super::traces::extent;
use super::{Figure, FigureError};
use crate::field::Field;
use myospring_core::recording::{AXIAL_FORCE, Frame, Recording, TRACTION_FORCE};

/// Height of the plot, px.
const HEIGHT: f64 = 100.0;
/// Distance between arrows, px, and the length of the longest.
const APART: f64 = 11.0;
const LONGEST: f64 = 20.0;
/// Arrows shorter than this are left out, px.
const SHORTEST: f64 = 1.5;

/// Draws the tractions at the frame of the largest force, their size as colours and their direction as arrows, and the
/// forces on the gel over time.
///
/// Width: one column, 85 mm.
///
/// # Errors
/// A recording without forces on a gel, or frames of another mesh.
pub fn traction(
    cell: &DrawnCell<'_>,
    recording: &Recording,
    stimulus_times_ms: &[f64],
) -> Result<Figure, FigureError> {
    let nothing = || FigureError::Nothing { what: "forces on a gel" };
    let size = |frame: &Frame| {
        let forces = frame.on_gel_nn.as_ref()?;
        Some(forces[0].iter().zip(&forces[1]).map(|(x, y)| x.hypot(*y)).sum::<f64>())
    };
    let frames = recording.frames.iter().filter(|frame| size(frame).is_some_and(f64::is_finite));
    let frame = frames.max_by(|a, b| size(a).unwrap_or(0.0).total_cmp(&size(b).unwrap_or(0.0)));
    let frame = frame.ok_or_else(nothing)?;
    let forces = frame.on_gel_nn.as_ref().ok_or_else(nothing)?;
    let cell = cell.clone().coloured_by(Field::Traction).scaled_to([frame]);
    let shape = Shape { name: "largest force on the gel".to_owned(), frame, shortening_pct: None };
    let shapes = [shape];
    let gallery = Gallery::new(&cell, &shapes)?;
    let mut sheet = Sheet::default();
    let (left, width) = (8.0, SINGLE - 16.0);
    let scale = gallery.scale_into([width, 260.0]);
    gallery.draw_row(&mut sheet, 0, [left, 4.0], [width, scale], "A");
    let centre = [left + width / 2.0, 4.0 + HEAD + gallery.extent()[1] * scale / 2.0];
    arrows(&mut sheet, frame, forces, &cell.mesh().areas, (centre, gallery.at(centre, scale)));
    let bottom = 4.0 + HEAD + gallery.extent()[1] * scale + 9.0;
    gallery.draw_scale_bar(&mut sheet, [left, bottom + 19.0], scale);
    gallery.draw_colour_bar(&mut sheet, [SINGLE - 8.0 - 160.0, bottom + 15.0], 152.0);

    let curve = |name: &str| -> Option<Vec<[f64; 2]>> {
        let signal = recording.signals.iter().find(|signal| signal.is(name))?;
        let pairs = recording.samples.iter().zip(&signal.values);
        Some(pairs.map(|(sample, value)| [sample.t_ms, *value]).collect())
    };
    let total = curve(TRACTION_FORCE).ok_or_else(nothing)?;
    let axial = curve(AXIAL_FORCE);
    if total.len() < 2 {
        return Ok(sheet.finish(SINGLE, bottom + 43.0));
    }
    let [low, high] = extent(std::iter::once(&total).chain(&axial).map(Vec::as_slice), 1);
    let axis = Axis::values("Force on the gel (nN)", [low.min(0.0), high * 1.08], HEIGHT);
    let times = Axis::time(extent([total.as_slice()], 0));
    let legend = [("all directions", TENSION), ("half the cell, along it", CURVES[0])];
    let legend = &legend[..if axial.is_some() { 2 } else { 0 }];
    let mut lines = vec![Curve::solid(total, TENSION)];
    lines.extend(axial.map(|axial| Curve::solid(axial, CURVES[0])));
    let top = bottom + 62.0;
    let mut charts = [Chart {
        marks: stimulus_times_ms.to_vec(),
        ..Chart::new(top, HEIGHT, [times, axis], lines)
    }];
    let offset = align(&mut charts, 30.0, SINGLE - 15.0);
    let [chart] = &charts;
    chart.draw(&mut sheet, offset);
    sheet.text([6.0, top + 4.0], "B", Style::new(LETTER).bold());
    for (row, (text, colour)) in legend.iter().enumerate() {
        let y = top + 10.0 + 13.0 * row as f64;
        let right = chart.place[0] + chart.size[0];
        sheet.line([right - 122.0, y - 3.5], [right - 108.0, y - 3.5], Stroke::new(*colour, 1.5));
        sheet.text([right - 104.0, y], text, Style::new(TICK));
    }
    Ok(sheet.finish(SINGLE, top + HEIGHT + 37.0))
}

/// Draws the mean traction in squares of the sheet as arrows, with the size of the longest below.
fn arrows(
    sheet: &mut Sheet,
    frame: &Frame,
    forces: &[Vec<f64>; 2],
    areas: &[f64],
    (centre, at): ([f64; 2], impl Fn([f64; 2]) -> [f64; 2]),
) {
    let mut squares = std::collections::BTreeMap::<[i64; 2], ([f64; 2], [f64; 2], f64, f64)>::new();
    for (node, area) in areas.iter().enumerate() {
        let [x, y] = at([frame.positions[0][node], frame.positions[1][node]]);
        // Alike on either side of the middle.
        let square = [x - centre[0], y - centre[1]].map(|part| (part / APART).round() as i64);
        let (place, force, total, count) = squares.entry(square).or_default();
        *place = [place[0] + x, place[1] + y];
        *force = [force[0] + forces[0][node], force[1] + forces[1][node]];
        *total += area;
        *count += 1.0;
    }
    let means: Vec<([f64; 2], [f64; 2])> = squares
        .into_values()
        .map(|(place, force, area, count)| (place.map(|p| p / count), force.map(|f| f / area)))
        .collect();
    let most = means.iter().map(|(_, [x, y])| x.hypot(*y)).fold(0.0, f64::max);
    if most == 0.0 {
        return;
    }
    for ([x, y], traction) in means {
        // Down the sheet is down the picture.
        let [u, v] = [traction[0], -traction[1]].map(|part| part / most * LONGEST);
        let length = u.hypot(v);
        if length < SHORTEST {
            continue;
        }
        let (start, end) = ([x, y], [x + u, y + v]);
        let head = (0.4 * length).min(4.0) / length;
        let side = |turn: f64| [end[0] - head * (u - turn * v), end[1] - head * (v + turn * u)];
        let mut path = Path::line([start, end]);
        path.add_line([side(0.6), end, side(-0.6)]);
        sheet.path(path, Stroke::new(INK, 0.8));
    }
}
