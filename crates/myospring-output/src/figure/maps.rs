//! One shape of a cell, coloured by several quantities, side by side: maps and their uncertainty,
//! measured and simulated.

use super::cell::{DrawnCell, closed, draw_titled_bar};
use super::font::text_width;
use super::shapes::{ELONGATED, draw_scale_bar, extremes};
use super::sheet::{Anchor, Area, Sheet, Stroke, Style};
use super::theme::{DOUBLE, INK, LABEL, LETTER, MUTED, REST, TICK, decimals, fixed, mm};
use super::{Figure, FigureError};
use crate::field::{ColourScale, Field};

/// A cell coloured by a quantity.
#[derive(Debug, Clone)]
pub struct Map<'a> {
    /// Its title.
    pub name: String,
    /// Positions of the points, um.
    pub positions: &'a [Vec<f64>; 2],
    /// The quantity at each point.
    pub values: Vec<f64>,
    /// Its name and unit.
    pub quantity: String,
    /// Limits of the colour scale; `None` takes the range of the values and 0.
    pub limits: Option<[f64; 2]>,
    /// Relative standard deviation of the value at each point, if known; where it exceeds one half the
    /// map is hatched instead of coloured.
    pub doubts: Option<Vec<f64>>,
    /// What is said of hatched places: [`NOT_KNOWN`] of doubts.
    pub hatched: &'static str,
    /// Places that are marked by dots, um, and what they are.
    pub dots: Option<(Vec<[f64; 2]>, &'static str)>,
}

/// What is said of places whose value is doubtful.
pub const NOT_KNOWN: &str = "not known";

/// Relative standard deviation from which on a place is hatched.
const DOUBTFUL: f64 = 0.5;

const MARGIN: f64 = 8.0;
const GAP: f64 = 14.0;
/// Height of the line above a map, and of its colour bar with labels, px.
const HEAD: f64 = 19.0;
const BAR: f64 = 46.0;
/// Height of the line below a map of several times, px, and of the highest of them.
const NOTE: f64 = 24.0;
const TALLEST: f64 = mm(60.0);
/// Radius of a dot, px.
const DOT: f64 = 1.2;
/// Width of a colour bar, px.
const BAR_WIDTH: f64 = 170.0;

impl Map<'_> {
    fn colours(&self) -> ColourScale {
        let values = self.values.iter().copied().filter(|value| value.is_finite());
        let widest = || values.fold([0.0_f64; 2], |[low, high], v| [low.min(v), high.max(v)]);
        let [low, high] = self.limits.unwrap_or_else(widest);
        // A quantity with both signs has the colours of a strain: light at 0; any other is light at the limit that is nearest to 0.
        let high = high.max(low + 1e-9);
        ColourScale::new(Field::FibreStrain, [low, high]).light_at(0.0_f64.clamp(low, high))
    }
}

/// Draws maps of one cell, all to one scale: long cells one above the other, others side by side;
/// two columns wide (178 mm). A `least` length (um), the resolution of the map, is drawn beside the
/// scale bar. The dashed line is the cell at rest.
///
/// # Errors
/// No map, or one of another mesh or with positions that are not finite.
pub fn maps(
    cell: &DrawnCell<'_>,
    maps: &[Map<'_>],
    least: Option<f64>,
) -> Result<Figure, FigureError> {
    checked(cell, maps)?;
    let shapes = maps.iter().map(|map| map.positions).chain([&cell.mesh().points]);
    let [low, high] = extremes(cell, shapes);
    let extent = [0, 1].map(|axis: usize| (high[axis] - low[axis]).max(1e-9));
    let stands = extent[0] > ELONGATED * extent[1];
    let columns = if stands { 1 } else { maps.len() };
    // Two maps are drawn no larger than three would be.
    let fitting = if stands { 1.0 } else { columns.max(2) as f64 };
    let width = (DOUBLE - 2.0 * MARGIN - (fitting - 1.0) * GAP) / fitting;
    let scale = width / extent[0];
    let height = extent[1] * scale;
    let mut sheet = Sheet::default();
    let middle = [0, 1].map(|axis: usize| f64::midpoint(low[axis], high[axis]));
    for (index, map) in maps.iter().enumerate() {
        let left = MARGIN + (index % columns) as f64 * (width + GAP);
        let top = 4.0 + (index / columns) as f64 * (HEAD + height + BAR);
        let letter = char::from(b'A' + (index % 26) as u8).to_string();
        sheet.text([left, top + 11.0], &letter, Style::new(LETTER).bold());
        sheet.text([left + 16.0, top + 11.0], &map.name, Style::new(LABEL));
        let centre = [left + width / 2.0, top + HEAD + height / 2.0];
        let at = |[x, y]: [f64; 2]| {
            [centre[0] + (x - middle[0]) * scale, centre[1] - (y - middle[1]) * scale]
        };
        let colours = map.colours();
        cell.fill_with(
            &mut sheet,
            format!("map-{index}"),
            map.positions,
            &map.values,
            &colours,
            at,
        );
        if let Some(doubts) = &map.doubts {
            let name = format!("doubt-{index}");
            cell.hatch_above(&mut sheet, &name, map.positions, (doubts, DOUBTFUL), at);
            if doubts.iter().any(|doubt| *doubt > DOUBTFUL) {
                let style = Style::new(TICK).colour(MUTED).anchor(Anchor::End);
                let words = format!("hatched: {}", map.hatched);
                sheet.text([left + width, top + 11.0], &words, style);
            }
        }
        sheet.path(closed(&cell.rings(map.positions), at), Stroke::new(INK, 0.7));
        let rest = closed(&cell.rings(&cell.mesh().points), at);
        sheet.path(rest, Stroke::new(REST, 0.8).dash(2.5, 1.8));
        if let Some((places, what)) = &map.dots {
            for place in places {
                sheet.point(at(*place), DOT, INK);
            }
            let style = Style::new(TICK).colour(MUTED);
            sheet.text([left, top + HEAD + height + 13.0], &format!("dots: {what}"), style);
        }
        let bar = BAR_WIDTH.min(width - 20.0);
        let corner = [left + width - bar - 10.0, top + HEAD + height + 18.0];
        let place = Area { corner, size: [bar, 8.0] };
        draw_titled_bar(&mut sheet, place, &colours, &map.quantity);
    }
    let rows = maps.len().div_ceil(columns) as f64;
    let bottom = 4.0 + rows * (HEAD + height + BAR);
    // For long cells, there is room beside the last colour bar.
    let beside = stands;
    let y = if beside { bottom - BAR + 22.0 } else { bottom + 4.0 };
    draw_scale_bar(&mut sheet, [MARGIN, y], scale, extent);
    if let Some(least) = least.filter(|least| least.is_finite() && *least < extent[0]) {
        let start = if beside { [MARGIN, y + 15.0] } else { [MARGIN + width + GAP, y] };
        let end = start[0] + least * scale;
        sheet.line(start, [end, start[1]], Stroke::new(MUTED, 2.5));
        let words =
            format!("{} \u{b5}m: smaller details are not resolved", fixed(least, decimals(1.0)));
        let style = Style::new(TICK).colour(MUTED).anchor(Anchor::Start);
        sheet.text([end + 5.0, start[1] + 3.5], &words, style);
    }
    Ok(sheet.finish(DOUBLE, if beside { bottom } else { bottom + 14.0 }))
}

/// Draws maps of one cell at several times, all to one scale and one colour scale with the quantity of the first; two columns
/// wide (178 mm). Each has a line below it, from `notes`. Places with doubts are hatched, and it is said.
///
/// # Errors
/// As of [`maps()`].
pub fn map_series(
    cell: &DrawnCell<'_>,
    maps: &[Map<'_>],
    title: &str,
    notes: &[String],
) -> Result<Figure, FigureError> {
    let first = checked(cell, maps)?;
    let [low, high] = extremes(cell, maps.iter().map(|map| map.positions));
    let extent = [0, 1].map(|axis: usize| (high[axis] - low[axis]).max(1e-9));
    let columns = if extent[0] > ELONGATED * extent[1] { 2 } else { 3 };
    let width = (DOUBLE - 2.0 * MARGIN - (columns - 1) as f64 * GAP) / columns as f64;
    let scale = (width / extent[0]).min(TALLEST / extent[1]);
    let height = extent[1] * scale;
    let middle = [0, 1].map(|axis: usize| f64::midpoint(low[axis], high[axis]));
    let above = if title.is_empty() { 4.0 } else { 22.0 };
    let mut sheet = Sheet::default();
    sheet.text([MARGIN, 13.0], title, Style::new(LABEL));
    let corner = |index: usize| {
        let left = MARGIN + (index % columns) as f64 * (width + GAP);
        [left, above + (index / columns) as f64 * (HEAD + height + NOTE)]
    };
    let colours = first.colours();
    for (index, map) in maps.iter().enumerate() {
        let [left, top] = corner(index);
        let letter = char::from(b'A' + (index % 26) as u8).to_string();
        sheet.text([left, top + 11.0], &letter, Style::new(LETTER).bold());
        sheet.text([left + 16.0, top + 11.0], &map.name, Style::new(LABEL));
        let centre = [left + width / 2.0, top + HEAD + height / 2.0];
        let at = |[x, y]: [f64; 2]| {
            [centre[0] + (x - middle[0]) * scale, centre[1] - (y - middle[1]) * scale]
        };
        let name = format!("map-{index}");
        cell.fill_with(&mut sheet, name, map.positions, &map.values, &colours, at);
        if let Some(doubts) = &map.doubts {
            let name = format!("doubt-{index}");
            cell.hatch_above(&mut sheet, &name, map.positions, (doubts, DOUBTFUL), at);
        }
        sheet.path(closed(&cell.rings(map.positions), at), Stroke::new(INK, 0.7));
        let note = notes.get(index).map_or("", String::as_str);
        sheet.text([left, top + HEAD + height + 13.0], note, Style::new(TICK).colour(MUTED));
    }
    // The scales are in the place after the last map.
    let [left, top] = corner(maps.len());
    let bar = Area { corner: [left + 4.0, top + HEAD + 20.0], size: [BAR_WIDTH, 8.0] };
    draw_titled_bar(&mut sheet, bar, &colours, &first.quantity);
    draw_scale_bar(&mut sheet, [left + 4.0, top + HEAD + 58.0], scale, extent);
    let is_doubtful = |map: &Map<'_>| map.doubts.iter().flatten().any(|doubt| *doubt > DOUBTFUL);
    if maps.iter().any(is_doubtful) {
        let words = format!("hatched: {}", first.hatched);
        sheet.text([left + 4.0, top + HEAD + 82.0], &words, Style::new(TICK).colour(MUTED));
    }
    let rows = (maps.len() + 1).div_ceil(columns) as f64;
    let bottom = above + rows * (HEAD + height + NOTE);
    let scales = top + HEAD + 90.0;
    Ok(sheet.finish(DOUBLE, bottom.max(scales)))
}

/// Checks that there is a map and that all are of the cell's mesh; the first.
fn checked<'m, 'f>(cell: &DrawnCell<'_>, maps: &'m [Map<'f>]) -> Result<&'m Map<'f>, FigureError> {
    let first = maps.first().ok_or(FigureError::Nothing { what: "maps" })?;
    let points = cell.mesh().len();
    for map in maps {
        let doubts = map.doubts.iter().map(Vec::len);
        if let Some(found) = doubts.chain([map.values.len()]).find(|found| *found != points) {
            return Err(FigureError::PictureShape { width: points, height: 1, found });
        }
        cell.check(map.positions)?;
    }
    Ok(first)
}

/// Draws the outline of a cell without a map, with the reason below; two columns wide (178 mm). The
/// dashed line is the cell at rest.
///
/// # Errors
/// Positions of another mesh, or that are not finite.
pub fn no_map(
    cell: &DrawnCell<'_>,
    positions: &[Vec<f64>; 2],
    why: &str,
) -> Result<Figure, FigureError> {
    cell.check(positions)?;
    let [low, high] = extremes(cell, [positions, &cell.mesh().points]);
    let extent = [0, 1].map(|axis: usize| (high[axis] - low[axis]).max(1e-9));
    let room = DOUBLE - 2.0 * MARGIN;
    let scale = (room / extent[0]).min(0.35 * room / extent[1]);
    let middle = [0, 1].map(|axis: usize| f64::midpoint(low[axis], high[axis]));
    let height = extent[1] * scale;
    let at = |[x, y]: [f64; 2]| {
        [DOUBLE / 2.0 + (x - middle[0]) * scale, MARGIN + height / 2.0 - (y - middle[1]) * scale]
    };
    let mut sheet = Sheet::default();
    sheet.path(closed(&cell.rings(positions), at), Stroke::new(INK, 0.7));
    let rest = closed(&cell.rings(&cell.mesh().points), at);
    sheet.path(rest, Stroke::new(REST, 0.8).dash(2.5, 1.8));
    let mut y = MARGIN + height + 24.0;
    for line in lines(why, room) {
        sheet.text([MARGIN, y], &line, Style::new(LABEL));
        y += 16.0;
    }
    draw_scale_bar(&mut sheet, [MARGIN, y + 6.0], scale, extent);
    Ok(sheet.finish(DOUBLE, y + 20.0))
}

/// Breaks a sentence into lines of at most this width, px.
fn lines(text: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), LABEL) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
