//! The cell at several times, coloured by a field (the paper's Fig. 5).

use super::cell::{DrawnCell, closed, draw_colour_bar};
use super::facets::check_frame;
use super::moments::Shape;
use super::sheet::{Anchor, Area, Sheet, Stroke, Style};
use super::theme::{
    DOUBLE, INK, LABEL, LETTER, MUTED, REST, SINGLE, TICK, decimals, fixed, nice_step, time,
};
use super::{Figure, FigureError};
use crate::field::ColourScale;

/// The shapes of a cell with a larger ratio of length to height are stacked, those of others are
/// side by side.
pub(super) const ELONGATED: f64 = 2.2;

/// Everything that the shapes of one figure share.
pub(super) struct Gallery<'a> {
    cell: &'a DrawnCell<'a>,
    shapes: &'a [Shape<'a>],
    colours: ColourScale,
    /// Corners of the bounding box of all shapes, including that at rest, um.
    low: [f64; 2],
    high: [f64; 2],
}

impl<'a> Gallery<'a> {
    pub(super) fn new(
        cell: &'a DrawnCell<'a>,
        shapes: &'a [Shape<'a>],
    ) -> Result<Self, FigureError> {
        if shapes.is_empty() {
            return Err(FigureError::Nothing { what: "frames" });
        }
        for shape in shapes {
            check_frame(cell.mesh(), shape.frame)?;
        }
        let colours = cell.colours(shapes.iter().map(|shape| shape.frame));
        let frames = shapes.iter().map(|shape| &shape.frame.positions);
        let [low, high] = extremes(cell, frames.chain([&cell.mesh().points]));
        Ok(Self { cell, shapes, colours, low, high })
    }

    /// Width and height of the bounding box of all shapes, um.
    pub(super) fn extent(&self) -> [f64; 2] {
        [0, 1].map(|axis: usize| (self.high[axis] - self.low[axis]).max(1e-9))
    }

    pub(super) fn is_elongated(&self) -> bool {
        let [width, height] = self.extent();
        width > ELONGATED * height
    }

    /// The greatest scale, px per um, at which the bounding box fits into a width and a height.
    pub(super) fn scale_into(&self, [width, height]: [f64; 2]) -> f64 {
        let extent = self.extent();
        (width / extent[0]).min(height / extent[1])
    }

    /// Where a point (um) is on the sheet if the middle of the bounding box is at `centre`.
    pub(super) fn at(&self, centre: [f64; 2], scale: f64) -> impl Fn([f64; 2]) -> [f64; 2] + use<> {
        let middle = [0, 1].map(|axis: usize| f64::midpoint(self.low[axis], self.high[axis]));
        move |[x, y]| [centre[0] + (x - middle[0]) * scale, centre[1] - (y - middle[1]) * scale]
    }

    /// Draws a shape, with the bounding box centred at a point and y upward, and the resting
    /// outline over it.
    pub(super) fn draw(&self, sheet: &mut Sheet, index: usize, centre: [f64; 2], scale: f64) {
        let frame = self.shapes[index].frame;
        let at = self.at(centre, scale);
        self.cell.fill(sheet, format!("cell-{index}"), frame, &self.colours, &at);
        let [now, rest] = [&frame.positions, &self.cell.mesh().points]
            .map(|positions| self.cell.rings(positions));
        sheet.path(closed(&now, &at), Stroke::new(INK, 0.7));
        let away = |(p, q): (&[f64; 2], &[f64; 2])| (p[0] - q[0]).hypot(p[1] - q[1]) * scale > 0.5;
        if now.iter().flatten().zip(rest.iter().flatten()).any(away) {
            sheet.path(closed(&rest, &at), Stroke::new(REST, 0.8).dash(2.5, 1.8));
        }
    }

    /// Draws a scale bar from a point to the right, with its length beside it.
    pub(super) fn draw_scale_bar(&self, sheet: &mut Sheet, [x, y]: [f64; 2], scale: f64) {
        draw_scale_bar(sheet, [x, y], scale, self.extent());
    }

    /// Draws the colour bar with its ticks below and its title above; `corner` is its upper left
    /// corner.
    pub(super) fn draw_colour_bar(&self, sheet: &mut Sheet, corner: [f64; 2], width: f64) {
        draw_colour_bar(sheet, Area { corner, size: [width, 8.0] }, &self.colours);
    }

    /// Labels of a shape: its name, time and tension, shortening.
    pub(super) fn notes(&self, index: usize) -> [String; 3] {
        let shape = &self.shapes[index];
        // Neither is known of every film.
        let tension = Some(shape.frame.ta_kpa).filter(|tension| !tension.is_nan());
        let moment = Some(shape.frame.t_ms).filter(|t_ms| !t_ms.is_nan()).map(time);
        let tension = tension.map(|tension| format!("{} kPa", fixed(tension, 1)));
        [
            shape.name.clone(),
            moment.into_iter().chain(tension).collect::<Vec<_>>().join(", "),
            shape
                .shortening_pct
                .map_or_else(String::new, |s| format!("shortening {} %", fixed(s, 1))),
        ]
    }
}

/// Corners of the bounding box of the outline over some shapes, um.
pub(super) fn extremes<'f>(
    cell: &DrawnCell<'_>,
    shapes: impl IntoIterator<Item = &'f [Vec<f64>; 2]>,
) -> [[f64; 2]; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for positions in shapes {
        for point in cell.rings(positions).iter().flatten() {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
    }
    [low, high]
}

/// Draws a scale bar of a tenth to a quarter of the cell, whose size is `extent` (um), from a point
/// to the right, with its length beside it.
pub(super) fn draw_scale_bar(sheet: &mut Sheet, [x, y]: [f64; 2], scale: f64, extent: [f64; 2]) {
    let length = nice_step(extent[0].max(extent[1]), 10.0);
    let end = x + length * scale;
    sheet.line([x, y], [end, y], Stroke::new(INK, 2.5));
    let text = format!("{} \u{b5}m", fixed(length, decimals(length)));
    sheet.text([end + 5.0, y + 3.5], &text, Style::new(TICK));
}

/// Draws the cell at several times, its outline filled with the colours of a field (the paper's
/// Fig. 5).
///
/// All shapes share one scale and one colour scale. The dashed line is the resting outline. Shapes
/// are oriented as in the picture, y upward: long cells one above the other (one column, 85 mm),
/// others side by side (two columns, 178 mm).
///
/// # Errors
/// No shape, or a frame of another mesh or with positions that are not finite.
pub fn cell_shapes(cell: &DrawnCell<'_>, shapes: &[Shape<'_>]) -> Result<Figure, FigureError> {
    let gallery = Gallery::new(cell, shapes)?;
    Ok(if gallery.is_elongated() { stacked(&gallery) } else { side_by_side(&gallery) })
}

fn letter(index: usize) -> String {
    u8::try_from(index).ok().and_then(|i| b'A'.checked_add(i)).map_or('Z', char::from).to_string()
}

/// Height of the line above a stacked shape, px.
pub(super) const HEAD: f64 = 18.0;

impl Gallery<'_> {
    /// Draws one stacked shape, with its labels in a line above it; `letter` may be empty.
    pub(super) fn draw_row(
        &self,
        sheet: &mut Sheet,
        index: usize,
        [left, top]: [f64; 2],
        [width, scale]: [f64; 2],
        letter: &str,
    ) {
        let [name, moment, shortening] = self.notes(index);
        let baseline = top + 11.0;
        sheet.text([left, baseline], letter, Style::new(LETTER).bold());
        sheet.text([left + 16.0, baseline], &name, Style::new(LABEL));
        let facts = [moment, shortening].into_iter().filter(|text| !text.is_empty());
        let facts = facts.collect::<Vec<_>>().join(", ");
        let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
        sheet.text([left + width, baseline], &facts, style);
        let centre = [left + width / 2.0, top + HEAD + self.extent()[1] * scale / 2.0];
        self.draw(sheet, index, centre, scale);
    }
}

fn stacked(gallery: &Gallery<'_>) -> Figure {
    let mut sheet = Sheet::default();
    let (left, width) = (8.0, SINGLE - 16.0);
    let scale = gallery.scale_into([width, f64::INFINITY]);
    let pitch = HEAD + gallery.extent()[1] * scale + 9.0;
    for index in 0..gallery.shapes.len() {
        let top = 4.0 + index as f64 * pitch;
        gallery.draw_row(&mut sheet, index, [left, top], [width, scale], &letter(index));
    }
    let bottom = 4.0 + gallery.shapes.len() as f64 * pitch;
    gallery.draw_scale_bar(&mut sheet, [left, bottom + 19.0], scale);
    gallery.draw_colour_bar(&mut sheet, [SINGLE - 8.0 - 160.0, bottom + 15.0], 152.0);
    sheet.finish(SINGLE, bottom + 43.0)
}

fn side_by_side(gallery: &Gallery<'_>) -> Figure {
    let mut sheet = Sheet::default();
    let count = gallery.shapes.len();
    let columns = count.min(4);
    let (left, gap) = (8.0, 12.0);
    // Fewer than two shapes are not enlarged, so that they take at most half a page.
    let fitting = columns.max(2) as f64;
    let width = (DOUBLE - 2.0 * left - (fitting - 1.0) * gap) / fitting;
    let scale = gallery.scale_into([width, 1.4 * width]);
    let height = gallery.extent()[1] * scale;
    let (head, row_gap) = (44.0, 12.0);
    let mut bottom = 0.0;
    for index in 0..count {
        let [name, moment, shortening] = gallery.notes(index);
        let x = left + (index % columns) as f64 * (width + gap);
        let top = 4.0 + (index / columns) as f64 * (head + height + row_gap);
        sheet.text([x, top + 11.0], &letter(index), Style::new(LETTER).bold());
        sheet.text([x + 16.0, top + 11.0], &name, Style::new(LABEL));
        sheet.text([x + 16.0, top + 24.0], &moment, Style::new(TICK).colour(MUTED));
        sheet.text([x + 16.0, top + 36.5], &shortening, Style::new(TICK).colour(MUTED));
        let centre = [x + width / 2.0, top + head + height / 2.0];
        gallery.draw(&mut sheet, index, centre, scale);
        bottom = top + head + height;
    }
    gallery.draw_scale_bar(&mut sheet, [left, bottom + 28.0], scale);
    gallery.draw_colour_bar(&mut sheet, [DOUBLE - left - 8.0 - 220.0, bottom + 24.0], 220.0);
    sheet.finish(DOUBLE, bottom + 52.0)
}
