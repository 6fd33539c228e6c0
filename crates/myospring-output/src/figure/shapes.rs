//! The cell at several times, coloured by strain (the paper's Fig. 5).

use super::moments::Shape;
use super::sheet::{Anchor, Look, Path, Sheet, Stroke, Style};
use super::strain::{Facet, check_frame, check_mesh, facets, fibre_strain_pct, outline};
use super::theme::{
    Colour, DOUBLE, HAIR, INK, LABEL, LETTER, MUTED, SINGLE, TICK, decimals, fixed, nice_step,
    strain_colour, time,
};
use super::{Figure, FigureError};
use myospring_core::mesh::Mesh;

/// Steps of the colour scale; more cannot be told apart.
const COLOURS: usize = 64;

/// A cell longer than this many times its height is drawn one above the other, else side by side.
pub(super) const ELONGATED: f64 = 2.2;

/// Everything the shapes of one figure share.
pub(super) struct Gallery<'a> {
    mesh: &'a Mesh,
    facets: Vec<Facet>,
    rings: Vec<Vec<u32>>,
    shapes: &'a [Shape<'a>],
    strains: Vec<Vec<f64>>,
    /// Least and greatest strain of the colour scale, per cent.
    range: [f64; 2],
    /// Corners of the box around all shapes and the resting one, um.
    low: [f64; 2],
    high: [f64; 2],
}

impl<'a> Gallery<'a> {
    pub(super) fn new(
        mesh: &'a Mesh,
        shapes: &'a [Shape<'a>],
        fibres: &[[f64; 2]],
    ) -> Result<Self, FigureError> {
        check_mesh(mesh)?;
        if mesh.simplices.is_empty() {
            return Err(FigureError::Nothing { what: "triangles" });
        }
        if shapes.is_empty() {
            return Err(FigureError::Nothing { what: "frames" });
        }
        let (found, triangles) = (fibres.len(), mesh.simplices.len());
        if found != triangles {
            return Err(FigureError::FibreCount { found, triangles });
        }
        let unit = |&[x, y]: &[f64; 2]| {
            let length = x.hypot(y);
            let direction = length.is_finite() && length > 0.0;
            direction.then_some([x / length, y / length]).ok_or(FigureError::Fibre { x, y })
        };
        let fibres = fibres.iter().map(unit).collect::<Result<Vec<_>, _>>()?;
        let facets = facets(mesh);
        let mut strains = Vec::new();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut enclose = |positions: &[Vec<f64>; 2]| {
            for axis in 0..2 {
                for &x in &positions[axis] {
                    low[axis] = low[axis].min(x);
                    high[axis] = high[axis].max(x);
                }
            }
        };
        enclose(&mesh.points);
        for shape in shapes {
            check_frame(mesh, shape.frame)?;
            enclose(&shape.frame.positions);
            strains.push(fibre_strain_pct(mesh, &facets, shape.frame, &fibres));
        }
        // The scale always holds 0, the colour of rest, and is never narrower than 1 %.
        let all = || strains.iter().flatten().copied();
        let high_strain = all().fold(0.0, f64::max);
        let range = [all().fold(0.0, f64::min).min(high_strain - 1.0), high_strain];
        let rings = outline(&facets);
        Ok(Self { mesh, facets, rings, shapes, strains, range, low, high })
    }

    /// Width and height of the box around all shapes, um.
    pub(super) fn extent(&self) -> [f64; 2] {
        [0, 1].map(|axis: usize| (self.high[axis] - self.low[axis]).max(1e-9))
    }

    pub(super) fn is_elongated(&self) -> bool {
        let [width, height] = self.extent();
        width > ELONGATED * height
    }

    /// The greatest scale, px per um, at which the box fits into a width and a height.
    pub(super) fn scale_into(&self, [width, height]: [f64; 2]) -> f64 {
        let extent = self.extent();
        (width / extent[0]).min(height / extent[1])
    }

    /// The colour at a step of the scale, from the least strain to the greatest.
    fn colour(&self, level: usize) -> Colour {
        let [low, high] = self.range;
        let part = level as f64 / (COLOURS - 1) as f64;
        strain_colour((low + part * (high - low)) / high.max(-low))
    }

    /// Draws a shape, its box centred at a point, y upward, and the resting outline over it.
    pub(super) fn draw(&self, sheet: &mut Sheet, index: usize, centre: [f64; 2], scale: f64) {
        let positions = &self.shapes[index].frame.positions;
        let [low, high] = self.range;
        let middle = [0, 1].map(|axis: usize| f64::midpoint(self.low[axis], self.high[axis]));
        let at = |positions: &[Vec<f64>; 2], node: u32| {
            let [x, y] = [0, 1].map(|axis: usize| positions[axis][node as usize] - middle[axis]);
            [centre[0] + x * scale, centre[1] - y * scale]
        };
        let mut paths = vec![Path::default(); COLOURS];
        for (facet, strain) in self.facets.iter().zip(&self.strains[index]) {
            let part = ((strain - low) / (high - low)).clamp(0.0, 1.0);
            let path = &mut paths[(part * (COLOURS - 1) as f64).round() as usize];
            path.add_ring(facet.corners.iter().map(|&node| at(positions, node)));
        }
        for (level, path) in paths.into_iter().enumerate() {
            // A stroke in the facet's own colour hides the seams that smoothing would leave between
            // neighbours.
            let colour = self.colour(level);
            sheet.path(path, Look::fill(colour).stroke(Stroke::new(colour, 0.4)));
        }
        let mut edge = |positions, stroke| {
            let mut path = Path::default();
            for ring in &self.rings {
                path.add_ring(ring.iter().map(|&node| at(positions, node)));
            }
            sheet.path(path, stroke);
        };
        edge(positions, Stroke::new(INK, 0.7));
        let moved = positions.iter().flatten().zip(self.mesh.points.iter().flatten());
        if moved.into_iter().any(|(now, rest)| (now - rest).abs() * scale > 0.5) {
            edge(&self.mesh.points, Stroke::new(Colour(0x8c8c8c), 0.8).dash(2.5, 1.8));
        }
    }

    /// A scale bar from a point to the right, its length beside it.
    pub(super) fn draw_scale_bar(&self, sheet: &mut Sheet, [x, y]: [f64; 2], scale: f64) {
        draw_scale_bar(sheet, [x, y], scale, self.extent());
    }

    /// The colour bar with its ticks below and its title above; `place` is its upper left corner.
    pub(super) fn draw_colour_bar(&self, sheet: &mut Sheet, place: [f64; 2], width: f64) {
        let height = 8.0;
        sheet.text(
            [place[0] + width / 2.0, place[1] - 5.0],
            "Fibre strain (%)",
            Style::new(TICK).anchor(Anchor::Middle),
        );
        for level in 0..COLOURS {
            // Each step reaches to the end, under the next ones, so that no seams show.
            let before = width * level as f64 / COLOURS as f64;
            let corner = [place[0] + before, place[1]];
            sheet.rect(corner, [width - before, height], Look::fill(self.colour(level)));
        }
        sheet.rect(place, [width, height], Stroke::new(INK, HAIR));
        let [low, high] = self.range;
        let step = nice_step(high - low, 5.0);
        let ticks = (low / step).ceil() as i64..=(high / step).floor() as i64;
        for value in ticks.map(|i| i as f64 * step) {
            let x = place[0] + width * (value - low) / (high - low);
            let bottom = place[1] + height;
            sheet.line([x, bottom], [x, bottom + 3.0], Stroke::new(INK, HAIR));
            let style = Style::new(TICK).anchor(Anchor::Middle);
            sheet.text([x, bottom + 13.5], &fixed(value, decimals(step)), style);
        }
    }

    /// What is written beside a shape: its name, time and tension, shortening.
    pub(super) fn notes(&self, index: usize) -> [String; 3] {
        let shape = &self.shapes[index];
        let tension = fixed(shape.frame.ta_kpa, 1);
        [
            shape.name.clone(),
            format!("{}, {tension} kPa", time(shape.frame.t_ms)),
            shape
                .shortening_pct
                .map_or_else(String::new, |s| format!("shortening {} %", fixed(s, 1))),
        ]
    }
}

/// A scale bar of about a seventh of the cell, `extent` um large, from a point to the right, its length beside it.
pub(super) fn draw_scale_bar(sheet: &mut Sheet, [x, y]: [f64; 2], scale: f64, extent: [f64; 2]) {
    let length = nice_step(extent[0].max(extent[1]), 7.0);
    let end = x + length * scale;
    sheet.line([x, y], [end, y], Stroke::new(INK, 2.5));
    let text = format!("{} \u{b5}m", fixed(length, decimals(length)));
    sheet.text([end + 5.0, y + 3.5], &text, Style::new(TICK));
}

/// The cell at several times with colours for the strain along its fibre (the paper's Fig. 5).
///
/// All shapes share one scale and one colour scale; strain is the engineering strain along `fibres`
/// (one direction for each triangle, of any length), per cent, negative where the cell is shorter than at
/// rest. The dashed line is the resting outline. Shapes stand as in the picture, y upward: long
/// cells one above the other (one column, 85 mm), others side by side (two columns, 178 mm).
///
/// # Errors
/// No shape, a frame of another mesh or with positions that are not finite, fibres of another mesh or of no
/// length.
pub fn cell_shapes(
    mesh: &Mesh,
    shapes: &[Shape<'_>],
    fibres: &[[f64; 2]],
) -> Result<Figure, FigureError> {
    let gallery = Gallery::new(mesh, shapes, fibres)?;
    Ok(if gallery.is_elongated() { stacked(&gallery) } else { side_by_side(&gallery) })
}

fn letter(index: usize) -> String {
    u8::try_from(index).ok().and_then(|i| b'A'.checked_add(i)).map_or('Z', char::from).to_string()
}

/// Height of the line above a stacked shape, px.
pub(super) const HEAD: f64 = 18.0;

impl Gallery<'_> {
    /// One stacked shape, its notes in a line above it; `letter` may be empty.
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
    // As wide as for four, so that fewer shapes are no larger than a half page.
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
