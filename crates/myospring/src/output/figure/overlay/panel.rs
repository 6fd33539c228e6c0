//! One panel: a part of the picture with lines over it.

use std::collections::BTreeMap;

use super::super::FigureError;
use super::super::svg::{Anchor, Sheet, Style, px};
use super::super::theme::TICK;
use super::photograph::data_uri;
use super::{CHOSEN, Contour, FIBRE, OTHER, Overlay, STAND_IN, Tick};
use crate::mesh::{Mesh, SpringKind};

/// Pixels per px of the drawing that are worth embedding: 300 dpi.
const SHARP: f64 = 300.0 / 96.0;
/// Distance of fibre ticks, px.
const PITCH: f64 = 10.0;
/// Lattices finer than this are not drawn, px: they would hide the cell.
const FINEST: f64 = 2.0;
/// Levels of transparency of the ticks.
const LEVELS: usize = 4;
/// Coherency at which a tick is drawn in full colour.
const CERTAIN: f64 = 0.5;

/// A rectangle of the picture, whole pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    /// First column, column behind the last, first row, row behind the last.
    pixels: [usize; 4],
    /// Left, right, bottom, top, um, y upward.
    bounds: [f64; 4],
}

impl View {
    pub(super) fn whole(overlay: &Overlay<'_>) -> Self {
        let pixel = overlay.pixel_size_um;
        let [width, height] = [overlay.width, overlay.height];
        Self {
            pixels: [0, width, 0, height],
            bounds: [0.0, pixel * width as f64, 0.0, pixel * height as f64],
        }
    }

    /// The pixels around some points with a margin; `None` where no point lies in the picture.
    pub(super) fn around(points: &[[f64; 2]], whole: Self, pixel: f64) -> Option<Self> {
        let [_, width, _, height] = whole.pixels;
        let ends = |axis: usize| {
            let along = points.iter().map(|point| point[axis] / pixel);
            [along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max)]
        };
        let [[left, right], [low, high]] = [ends(0), ends(1)];
        let (across, up) = (right - left, high - low);
        if !(across.is_finite() && up.is_finite()) {
            return None;
        }
        let margin = 0.07 * across.max(up) + 2.0;
        // Neither a thread nor a needle.
        let wide = (across + 2.0 * margin).max(0.7 * up);
        let tall = (up + 2.0 * margin).max(0.28 * wide);
        let span = |middle: f64, length: f64, most: usize| {
            let start = (middle - 0.5 * length).clamp(0.0, most as f64);
            let end = (start + length).clamp(0.0, most as f64);
            // Pushed back into the picture at full length where that is possible.
            [(end - length).max(0.0).min(start).floor() as usize, end.ceil() as usize]
        };
        let [left, right] = span(f64::midpoint(left, right), wide, width);
        let [top, bottom] = span(height as f64 - f64::midpoint(low, high), tall, height);
        if right <= left || bottom <= top {
            return None;
        }
        let up = |row: usize| pixel * (height as f64 - row as f64);
        let bounds = [pixel * left as f64, pixel * right as f64, up(bottom), up(top)];
        Some(Self { pixels: [left, right, top, bottom], bounds })
    }

    /// Width and height, um.
    pub(super) fn extent(&self) -> [f64; 2] {
        let [left, right, bottom, top] = self.bounds;
        [right - left, top - bottom]
    }
}

/// A view on the sheet.
pub(super) struct Panel {
    pub(super) view: View,
    /// Upper left corner, px.
    pub(super) place: [f64; 2],
    /// px per um.
    pub(super) scale: f64,
}

impl Panel {
    /// Width and height, px.
    pub(super) fn size(&self) -> [f64; 2] {
        self.view.extent().map(|length| length * self.scale)
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, _, _, top] = self.view.bounds;
        [self.place[0] + (x - left) * self.scale, self.place[1] + (top - y) * self.scale]
    }

    /// The picture and the lines; lattice and fibres only where `detail` is asked for. `name` tells the
    /// panels of a figure apart.
    pub(super) fn draw(
        &self,
        sheet: &mut Sheet,
        overlay: &Overlay<'_>,
        detail: bool,
        name: &str,
    ) -> Result<(), FigureError> {
        let [width, height] = self.size();
        let box_of = format!(
            r#"x="{}" y="{}" width="{}" height="{}""#,
            px(self.place[0]),
            px(self.place[1]),
            px(width),
            px(height)
        );
        sheet.raw(&format!(
            r#"<clipPath id="panel-{name}"><rect {box_of}/></clipPath><g clip-path="url(#panel-{name})" fill="none" stroke-linejoin="round">"#
        ));
        let picture = data_uri(overlay, self.view.pixels, SHARP * width)?;
        sheet.raw(&format!(
            r#"<image {box_of} preserveAspectRatio="none" style="image-rendering:smooth" xmlns:xlink="http://www.w3.org/1999/xlink" xlink:href="{picture}"/>"#
        ));
        if detail && let Some(mesh) = overlay.mesh {
            self.draw_lattice(sheet, mesh);
        }
        for cell in overlay.cells.iter().filter(|cell| !cell.chosen) {
            self.draw_outline(sheet, cell, OTHER, 1.0);
        }
        for cell in overlay.cells.iter().filter(|cell| cell.chosen) {
            self.draw_outline(sheet, cell, CHOSEN, 1.3);
        }
        if detail {
            self.draw_ticks(sheet, overlay.fibres);
        }
        let several = overlay.cells.len() > 1;
        for cell in overlay.cells.iter().filter(|_| several && name == "A") {
            self.draw_name(sheet, cell);
        }
        sheet.raw("</g>");
        Ok(())
    }

    /// The frame of another view with its name, if that is much smaller than this one.
    pub(super) fn draw_frame(&self, sheet: &mut Sheet, other: View, name: &str) {
        let [wide, tall] = other.extent();
        let [width, height] = self.view.extent();
        if wide * tall > 0.6 * width * height {
            return;
        }
        let [left, _, _, top] = other.bounds;
        let size = [wide * self.scale, tall * self.scale];
        for line in [
            r##" stroke="#000000" stroke-opacity=".5" stroke-width="2""##,
            r##" stroke="#ffffff" stroke-width=".8" stroke-dasharray="4 2.5""##,
        ] {
            sheet.rect(self.at([left, top]), size, "none", line);
        }
        let [x, y] = self.at([left, top]);
        let style = Style::new(TICK).colour("#ffffff").bold();
        in_halo(sheet, |sheet| sheet.text([x + 4.0, y + 11.5], name, style));
    }

    /// A thin bright line on a wider dark one.
    fn draw_outline(&self, sheet: &mut Sheet, cell: &Contour<'_>, colour: &str, width: f64) {
        let mut path = String::new();
        for ring in &cell.rings {
            let mut last: Option<[f64; 2]> = None;
            for &point in *ring {
                let [x, y] = self.at(point);
                // Steps too small to be seen are left out.
                if last.is_some_and(|[a, b]| (x - a).hypot(y - b) < 0.3) {
                    continue;
                }
                append(&mut path, if last.is_none() { 'M' } else { 'L' }, [x, y]);
                last = Some([x, y]);
            }
            if last.is_some() {
                path.push('z');
            }
        }
        let halo = width + 1.6;
        sheet.raw(&format!(
            r##"<path stroke="#000000" stroke-opacity=".55" stroke-width="{halo}" d="{path}"/><path stroke="{colour}" stroke-width="{width}" d="{path}"/>"##
        ));
    }

    fn draw_name(&self, sheet: &mut Sheet, cell: &Contour<'_>) {
        let Some(ring) = cell.rings.first().filter(|ring| !ring.is_empty()) else { return };
        let mean = |axis: usize| ring.iter().map(|p| p[axis]).sum::<f64>() / ring.len() as f64;
        let [x, y] = self.at([mean(0), mean(1)]);
        let colour = if cell.chosen { CHOSEN } else { "#ffffff" };
        let style = Style::new(TICK).anchor(Anchor::Middle).colour(colour).bold();
        in_halo(sheet, |sheet| sheet.text([x, y + 3.5], cell.name, style));
    }

    /// The springs along the axes, faint; lattices too fine to be seen are left out.
    fn draw_lattice(&self, sheet: &mut Sheet, mesh: &Mesh) {
        let mean = (mesh.area() / mesh.len() as f64).sqrt();
        let spacing = mesh.lattice.as_ref().map_or(mean, |lattice| lattice.spacing);
        if spacing * self.scale < FINEST {
            return;
        }
        let mut path = String::new();
        for spring in mesh.springs.iter().filter(|spring| spring.kind == SpringKind::Axial) {
            let [from, to] = spring.nodes.map(|node| self.at(mesh.point(node as usize)));
            append(&mut path, 'M', from);
            append(&mut path, 'L', to);
        }
        sheet.raw(&format!(
            r##"<path stroke="#ffffff" stroke-opacity=".4" stroke-width=".4" d="{path}"/>"##
        ));
    }

    /// Short lines along the fibres, one in each square of the drawing: the one nearest its middle.
    fn draw_ticks(&self, sheet: &mut Sheet, ticks: &[Tick]) {
        let mut nearest: BTreeMap<[i64; 2], (f64, &Tick)> = BTreeMap::new();
        for tick in ticks {
            let [x, y] = self.at(tick.point_um);
            let [column, row] = [x, y].map(|at| (at / PITCH).floor());
            let off = (x - (column + 0.5) * PITCH).hypot(y - (row + 0.5) * PITCH);
            let place = nearest.entry([row as i64, column as i64]).or_insert((off, tick));
            if off < place.0 {
                *place = (off, tick);
            }
        }
        let mut paths = vec![String::new(); LEVELS];
        let mut stand_in = String::new();
        for (_, tick) in nearest.values() {
            let [x, y] = self.at(tick.point_um);
            let length = tick.direction[0].hypot(tick.direction[1]);
            let [dx, dy] = tick.direction.map(|part| 0.37 * PITCH * part / length);
            let path = if tick.from_picture {
                let part = (tick.coherency / CERTAIN).clamp(0.0, 1.0);
                &mut paths[(part * (LEVELS - 1) as f64).round() as usize]
            } else {
                &mut stand_in
            };
            append(path, 'M', [x - dx, y + dy]);
            append(path, 'L', [x + dx, y - dy]);
        }
        for (level, path) in paths.iter().enumerate().filter(|(_, path)| !path.is_empty()) {
            let opacity = 0.4 + 0.6 * level as f64 / (LEVELS - 1) as f64;
            let halo = px(0.6 * opacity);
            sheet.raw(&format!(
                r##"<g stroke-linecap="round"><path stroke="#000000" stroke-opacity="{halo}" stroke-width="2.4" d="{path}"/><path stroke="{FIBRE}" stroke-opacity="{}" stroke-width="1.3" d="{path}"/></g>"##,
                px(opacity)
            ));
        }
        if !stand_in.is_empty() {
            sheet.raw(&format!(
                r##"<path stroke="#000000" stroke-opacity=".6" stroke-width="2.2" d="{stand_in}"/><path stroke="{STAND_IN}" stroke-width="1.1" d="{stand_in}"/>"##
            ));
        }
    }
}

/// Text with a dark rim, readable on black and on white.
fn in_halo(sheet: &mut Sheet, text: impl FnOnce(&mut Sheet)) {
    sheet.raw(
        r##"<g stroke="#000000" stroke-opacity=".7" stroke-width="2.5" paint-order="stroke">"##,
    );
    text(sheet);
    sheet.raw("</g>");
}

fn append(path: &mut String, letter: char, [x, y]: [f64; 2]) {
    path.push(letter);
    path.push_str(&px(x));
    path.push(' ');
    path.push_str(&px(y));
}
