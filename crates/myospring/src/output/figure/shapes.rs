//! The cell at several times, coloured by strain (the paper's Fig. 5).

use std::fmt::Write;

use super::moments::Shape;
use super::strain::{Facet, check_frame, check_mesh, facets, fibre_strain_pct, outline};
use super::svg::{Anchor, Sheet, Style, px};
use super::theme::{
    DOUBLE, HAIR, INK, LABEL, LETTER, MUTED, SINGLE, TICK, decimals, fixed, nice_step,
    strain_colour, time,
};
use super::{Figure, FigureError};
use crate::mesh::Mesh;

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

    /// The colour at a part of the scale, 0 for the least strain and 1 for the greatest.
    fn colour(&self, part: f64) -> String {
        let [low, high] = self.range;
        strain_colour((low + part * (high - low)) / high.max(-low))
    }

    /// Draws a shape, its box centred at a point, y upward, and the resting outline over it.
    pub(super) fn draw(&self, sheet: &mut Sheet, index: usize, centre: [f64; 2], scale: f64) {
        let positions = &self.shapes[index].frame.positions;
        let mut paths = vec![String::new(); COLOURS];
        let [low, high] = self.range;
        for (facet, strain) in self.facets.iter().zip(&self.strains[index]) {
            let part = ((strain - low) / (high - low)).clamp(0.0, 1.0);
            let path = &mut paths[(part * (COLOURS - 1) as f64).round() as usize];
            self.append_ring(path, &facet.corners, positions, scale);
        }
        // Coordinates in hundredths of a px are short and exact enough. The stroke in the facet's
        // own colour hides the seams that smoothing would leave between neighbours.
        sheet.raw(&format!(
            r#"<g transform="translate({} {}) scale(.01)" stroke-linejoin="round" stroke-width="40">"#,
            px(centre[0]),
            px(centre[1])
        ));
        for (level, path) in paths.iter().enumerate().filter(|(_, path)| !path.is_empty()) {
            let colour = self.colour(level as f64 / (COLOURS - 1) as f64);
            sheet.raw(&format!(r#"<path fill="{colour}" stroke="{colour}" d="{path}"/>"#));
        }
        let mut edge = |positions, colour: &str, width: f64, more: &str| {
            let mut path = String::new();
            for ring in &self.rings {
                self.append_ring(&mut path, ring, positions, scale);
            }
            sheet.raw(&format!(
                r#"<path fill="none" stroke="{colour}" stroke-width="{}"{more} d="{path}"/>"#,
                px(100.0 * width)
            ));
        };
        edge(positions, INK, 0.7, "");
        let moved = positions.iter().flatten().zip(self.mesh.points.iter().flatten());
        if moved.into_iter().any(|(now, rest)| (now - rest).abs() * scale > 0.5) {
            edge(&self.mesh.points, "#8c8c8c", 0.8, r#" stroke-dasharray="250 180""#);
        }
        sheet.raw("</g>");
    }

    /// Adds a closed ring of nodes to a path, in hundredths of a px from the box's centre.
    fn append_ring(&self, path: &mut String, ring: &[u32], positions: &[Vec<f64>; 2], scale: f64) {
        let place = |node: u32| {
            [0, 1].map(|axis: usize| {
                let middle = f64::midpoint(self.low[axis], self.high[axis]);
                let sign = if axis == 0 { 1.0 } else { -1.0 };
                (100.0 * sign * (positions[axis][node as usize] - middle) * scale).round() as i64
            })
        };
        let mut last = [0, 0];
        for (corner, &node) in ring.iter().enumerate() {
            let [x, y] = place(node);
            let (letter, from) = if corner == 0 { ('M', [0, 0]) } else { ('l', last) };
            // Writing to a String cannot fail.
            write!(path, "{letter}{} {}", x - from[0], y - from[1]).ok();
            last = [x, y];
        }
        path.push('z');
    }

    /// A scale bar from a point to the right, its length beside it.
    pub(super) fn draw_scale_bar(&self, sheet: &mut Sheet, [x, y]: [f64; 2], scale: f64) {
        draw_scale_bar(sheet, [x, y], scale, self.extent());
    }

    /// The colour bar with its ticks below and its title above; `place` is its upper left corner.
    pub(super) fn draw_colour_bar(&self, sheet: &mut Sheet, place: [f64; 2], width: f64) {
        let height = 8.0;
        let stop = |i: i32| {
            let part = f64::from(i) / 32.0;
            format!(r#"<stop offset="{part}" stop-color="{}"/>"#, self.colour(part))
        };
        let stops = (0..=32).map(stop).collect::<Vec<_>>().concat();
        sheet.raw(&format!(r#"<defs><linearGradient id="strain">{stops}</linearGradient></defs>"#));
        sheet.text(
            [place[0] + width / 2.0, place[1] - 5.0],
            "Fibre strain (%)",
            Style::new(TICK).anchor(Anchor::Middle),
        );
        let edge = format!(r#" stroke="{INK}" stroke-width="{HAIR}""#);
        sheet.rect(place, [width, height], "url(#strain)", &edge);
        let [low, high] = self.range;
        let step = nice_step(high - low, 5.0);
        let ticks = (low / step).ceil() as i64..=(high / step).floor() as i64;
        for value in ticks.map(|i| i as f64 * step) {
            let x = place[0] + width * (value - low) / (high - low);
            let bottom = place[1] + height;
            sheet.line([x, bottom], [x, bottom + 3.0], INK, HAIR, "");
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
    sheet.line([x, y], [end, y], INK, 2.5, "");
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
