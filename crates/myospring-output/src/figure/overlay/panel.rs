//! One panel: a part of the picture with overlaid lines.

use std::collections::BTreeMap;

use super::super::FigureError;
use super::super::lattice::{spacing, springs};
use super::super::photograph::{Part, embedded};
use super::super::sheet::{Anchor, Area, Path, Sheet, Stroke, Style};
use super::super::theme::{BLACK, Colour, TICK, WHITE};
use super::{CHOSEN, Contour, FIBRE, OTHER, Overlay, STAND_IN, Tick};
use myospring_core::mesh::{Mesh, SpringKind};

/// Largest useful resolution of an embedded picture, pixels per px: 300 dpi.
const SHARP: f64 = 300.0 / 96.0;
/// Distance between fibre ticks, px.
const PITCH: f64 = 10.0;
/// Lattices finer than this are not drawn, px: they would hide the cell.
const FINEST: f64 = 2.0;
/// Levels of transparency of the ticks.
const LEVELS: usize = 4;
/// Coherency at which a tick is drawn in full colour.
const CERTAIN: f64 = 0.5;

/// A rectangle of the picture, whole pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct View {
    /// First column, column after the last, first row, row after the last.
    pixels: [usize; 4],
    /// Left, right, bottom, top, um, y upward.
    bounds: [f64; 4],
}

impl View {
    /// All of a picture of this size with pixels of this side, um.
    pub(in super::super) fn whole([width, height]: [usize; 2], pixel: f64) -> Self {
        Self {
            pixels: [0, width, 0, height],
            bounds: [0.0, pixel * width as f64, 0.0, pixel * height as f64],
        }
    }

    /// The pixels around some points with a margin; `None` if no point lies in the picture.
    pub(in super::super) fn around(points: &[[f64; 2]], whole: Self, pixel: f64) -> Option<Self> {
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
        // Limits the aspect ratio.
        let wide = (across + 2.0 * margin).max(0.7 * up);
        let tall = (up + 2.0 * margin).max(0.28 * wide);
        let span = |middle: f64, length: f64, most: usize| {
            let start = (middle - 0.5 * length).clamp(0.0, most as f64);
            let end = (start + length).clamp(0.0, most as f64);
            // Shifted into the picture without shortening, if possible.
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
    pub(in super::super) fn extent(&self) -> [f64; 2] {
        let [left, right, bottom, top] = self.bounds;
        [right - left, top - bottom]
    }
}

/// A view placed on the sheet.
pub(in super::super) struct Panel {
    pub(in super::super) view: View,
    /// Upper left corner, px.
    pub(in super::super) place: [f64; 2],
    /// px per um.
    pub(in super::super) scale: f64,
}

impl Panel {
    /// Width and height, px.
    pub(in super::super) fn size(&self) -> [f64; 2] {
        self.view.extent().map(|length| length * self.scale)
    }

    pub(in super::super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [left, _, _, top] = self.view.bounds;
        [self.place[0] + (x - left) * self.scale, self.place[1] + (top - y) * self.scale]
    }

    /// Draws the picture and the lines; lattice and fibres only if `detail` is true. `name`
    /// distinguishes the panels of a figure.
    pub(super) fn draw(
        &self,
        sheet: &mut Sheet,
        overlay: &Overlay<'_>,
        detail: bool,
        name: &str,
    ) -> Result<(), FigureError> {
        let mut inside = Sheet::default();
        let picture = embedded(&self.part(overlay.values, overlay.width), SHARP * self.size()[0])?;
        inside.picture(self.area(), picture);
        if detail && let Some(mesh) = overlay.mesh {
            self.draw_lattice(&mut inside, mesh);
        }
        for cell in overlay.cells.iter().filter(|cell| !cell.chosen) {
            self.draw_outline(&mut inside, cell, OTHER, 1.0);
        }
        for cell in overlay.cells.iter().filter(|cell| cell.chosen) {
            self.draw_outline(&mut inside, cell, CHOSEN, 1.3);
        }
        if detail {
            self.draw_ticks(&mut inside, overlay.fibres);
        }
        let several = overlay.cells.len() > 1;
        for cell in overlay.cells.iter().filter(|_| several && name == "A") {
            self.draw_name(&mut inside, cell);
        }
        sheet.window(format!("panel-{name}"), Path::rect(self.area()), inside);
        Ok(())
    }

    /// Draws the frame of another view with its name, if it is much smaller than this one.
    pub(super) fn draw_frame(&self, sheet: &mut Sheet, other: View, name: &str) {
        let [wide, tall] = other.extent();
        let [width, height] = self.view.extent();
        if wide * tall > 0.6 * width * height {
            return;
        }
        let [left, _, _, top] = other.bounds;
        let size = [wide * self.scale, tall * self.scale];
        for stroke in [Stroke::new(BLACK, 2.0).opacity(0.5), Stroke::new(WHITE, 0.8).dash(4.0, 2.5)]
        {
            sheet.rect(self.at([left, top]), size, stroke);
        }
        let [x, y] = self.at([left, top]);
        sheet.text([x + 4.0, y + 11.5], name, Style::new(TICK).colour(WHITE).bold().halo());
    }

    /// Where it is on the sheet.
    pub(in super::super) fn area(&self) -> Area {
        Area { corner: self.place, size: self.size() }
    }

    /// Its part of a picture.
    pub(in super::super) fn part<'a>(&self, values: &'a [f32], width: usize) -> Part<'a> {
        let [left, right, top, bottom] = self.view.pixels;
        Part { values, width, columns: [left, right], rows: [top, bottom] }
    }

    /// Rings on the sheet, without invisibly small steps.
    pub(in super::super) fn lines(&self, rings: &[impl AsRef<[[f64; 2]]>]) -> Path {
        let mut path = Path::default();
        for ring in rings {
            let mut last: Option<[f64; 2]> = None;
            path.add_ring(ring.as_ref().iter().map(|&point| self.at(point)).filter(|&[x, y]| {
                let seen = last.is_none_or(|[a, b]| (x - a).hypot(y - b) >= 0.3);
                if seen {
                    last = Some([x, y]);
                }
                seen
            }));
        }
        path
    }

    /// Draws an outline as a thin bright line on a wider dark one.
    fn draw_outline(&self, sheet: &mut Sheet, cell: &Contour<'_>, colour: Colour, width: f64) {
        let path = self.lines(&cell.rings);
        sheet.path(path.clone(), Stroke::new(BLACK, width + 1.6).opacity(0.55));
        sheet.path(path, Stroke::new(colour, width));
    }

    fn draw_name(&self, sheet: &mut Sheet, cell: &Contour<'_>) {
        let Some(ring) = cell.rings.first().filter(|ring| !ring.is_empty()) else { return };
        let mean = |axis: usize| ring.iter().map(|p| p[axis]).sum::<f64>() / ring.len() as f64;
        let [x, y] = self.at([mean(0), mean(1)]);
        let colour = if cell.chosen { CHOSEN } else { WHITE };
        let style = Style::new(TICK).anchor(Anchor::Middle).colour(colour).bold().halo();
        sheet.text([x, y + 3.5], cell.name, style);
    }

    /// Draws the springs along the axes, faintly, unless the lattice is too fine.
    fn draw_lattice(&self, sheet: &mut Sheet, mesh: &Mesh) {
        if spacing(mesh) * self.scale < FINEST {
            return;
        }
        let lines = springs(mesh, SpringKind::Axial, 1, |node| self.at(mesh.point(node)));
        sheet.path(lines, Stroke::new(WHITE, 0.4).opacity(0.4));
    }

    /// Draws short lines along the fibres, one in each square of the drawing: the one nearest to
    /// its centre.
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
        let mut paths = vec![Path::default(); LEVELS];
        let mut stand_in = Path::default();
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
            path.add_line([[x - dx, y + dy], [x + dx, y - dy]]);
        }
        for (level, path) in paths.into_iter().enumerate() {
            let opacity = 0.4 + 0.6 * level as f64 / (LEVELS - 1) as f64;
            let halo = Stroke::new(BLACK, 2.4).opacity(0.6 * opacity).round_ends();
            sheet.path(path.clone(), halo);
            sheet.path(path, Stroke::new(FIBRE, 1.3).opacity(opacity).round_ends());
        }
        sheet.path(stand_in.clone(), Stroke::new(BLACK, 2.2).opacity(0.6));
        sheet.path(stand_in, Stroke::new(STAND_IN, 1.1));
    }
}
