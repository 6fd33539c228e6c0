//! A tracked cell: the film with the lattice overlaid, and a figure with its curves.

use super::chart::{Axis, Chart, Curve, ends};
use super::film::{Still, gif, mixed};
use super::lattice::{spacing, springs};
use super::photograph::{Part, embedded};
use super::raster::painted;
use super::shapes::draw_scale_bar;
use super::sheet::{Anchor, Area, Path, Picture, Sheet, Stroke, Style};
use super::theme::{
    BLACK, CURVES, Colour, DOUBLE, INK, LABEL, LETTER, MUTED, TENSION, TICK, WHITE, fixed, mm,
};
use super::{Figure, FigureError, check_mesh};
use crate::track::TrackRow;
use myospring_core::mesh::pixel_size::PixelSize;
use myospring_core::mesh::{Mesh, SpringKind};

/// Width of a frame of the film, px, and the greatest height of the picture in it.
const WIDTH: f64 = 480.0;
const HIGHEST: f64 = 480.0;
/// Height of the curve below it, px.
const CURVE: f64 = 46.0;
const MARGIN: f64 = 10.0;
/// Finer lattices are thinned to this spacing, px.
const FINEST: f64 = 13.0;
/// The lattice (Okabe-Ito yellow), and interpolated points (vermillion).
const LATTICE: Colour = Colour(0xf0e442);
const INTERPOLATED: Colour = TENSION;
/// Levels of grey in the palette of the film.
const GREYS: u8 = 48;
/// Distance between arrows, and the length of the longest, px.
const PITCH: f64 = 11.0;
const ARROW: f64 = 16.0;

/// A film with the tracked lattice of a cell.
#[derive(Debug, Clone, Copy)]
pub struct Tracked<'a> {
    /// Name of the film; may be empty.
    pub title: &'a str,
    /// Columns of the film.
    pub width: usize,
    /// Rows of the film.
    pub height: usize,
    /// Side of one pixel.
    pub pixel_size: PixelSize,
    /// The lattice at rest.
    pub mesh: &'a Mesh,
    /// The measurements, one row per frame.
    pub rows: &'a [TrackRow],
    /// Contraction of the cell in each row, %, from the column [`Tracked::by`].
    pub contraction: &'a [f64],
    /// Name of the column from which the contraction is computed.
    pub by: &'a str,
}

/// A frame of the film with the lattice in it.
#[derive(Debug, Clone, Copy)]
pub struct TrackedFrame<'a> {
    /// Grey values row by row from the top left.
    pub values: &'a [f32],
    /// Positions of the points in the picture, um, y upward.
    pub positions: &'a [Vec<f64>; 2],
    /// Which points were interpolated.
    pub interpolated: &'a [bool],
    /// Index of its row.
    pub row: usize,
}

impl Tracked<'_> {
    fn check(&self, frame: &TrackedFrame<'_>) -> Result<(), FigureError> {
        check_mesh(self.mesh)?;
        let Self { width, height, .. } = *self;
        let found = frame.values.len();
        if width.checked_mul(height) != Some(found) || found == 0 {
            return Err(FigureError::PictureShape { width, height, found });
        }
        let is_whole = self.contraction.len() == self.rows.len();
        if frame.row >= self.rows.len() || self.rows.len() < 2 || !is_whole {
            return Err(FigureError::Nothing { what: "frames" });
        }
        Ok(())
    }

    fn extent(&self) -> [f64; 2] {
        [self.width, self.height].map(|side| side as f64 * self.pixel_size.um())
    }

    /// Prepares the grey values of a frame for embedding.
    fn picture(&self, values: &[f32], wanted: f64) -> Result<Picture, FigureError> {
        let Self { width, height, .. } = *self;
        embedded(&Part { values, width, columns: [0, width], rows: [0, height] }, wanted)
    }

    /// Draws the lattice, thinned if it is fine, and the interpolated points.
    fn draw_lattice(
        &self,
        sheet: &mut Sheet,
        frame: &TrackedFrame<'_>,
        scale: f64,
        at: impl Fn([f64; 2]) -> [f64; 2],
    ) {
        let point = |node: usize| at([frame.positions[0][node], frame.positions[1][node]]);
        let every = (FINEST / (spacing(self.mesh) * scale)).ceil().max(1.0) as u32;
        let lines = springs(self.mesh, SpringKind::Axial, every, point);
        sheet.path(lines, Stroke::new(LATTICE, 0.7).opacity(0.75));
        let mut dots = Path::default();
        for (node, _) in
            frame.interpolated.iter().enumerate().filter(|(_, interpolated)| **interpolated)
        {
            dots.add_line([point(node); 2]);
        }
        sheet.path(dots, Stroke::new(INTERPOLATED, 2.2).round_ends());
    }

    /// One frame of the film as a figure, 480 px wide: the picture with the lattice, interpolated points in red, the
    /// time and the contraction so far.
    ///
    /// # Errors
    /// A picture of another size, or no rows.
    pub fn frame(&self, frame: &TrackedFrame<'_>) -> Result<Figure, FigureError> {
        self.check(frame)?;
        let extent = self.extent();
        let scale = ((WIDTH - 2.0 * MARGIN) / extent[0]).min(HIGHEST / extent[1]);
        let size = extent.map(|length| length * scale);
        let place = Area { corner: [(WIDTH - size[0]) / 2.0, 28.0], size };
        let at = |[x, y]: [f64; 2]| {
            [place.corner[0] + x * scale, place.corner[1] + (extent[1] - y) * scale]
        };
        let mut sheet = Sheet::default();
        let row = &self.rows[frame.row];
        let time = format!("{} ms", fixed(row.t_ms, 0));
        sheet.text([MARGIN, 18.0], &time, Style::new(13).bold());
        let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
        sheet.text([WIDTH - MARGIN, 17.0], &format!("frame {}", row.frame), style);
        let mut inside = Sheet::default();
        inside.picture(place, self.picture(frame.values, size[0])?);
        self.draw_lattice(&mut inside, frame, scale, at);
        sheet.window("film".to_owned(), Path::rect(place), inside);
        let below = place.corner[1] + size[1];
        draw_scale_bar(&mut sheet, [MARGIN, below + 14.0], scale, extent);
        let interpolated = format!("interpolated {} %", fixed(row.interpolated_pct, 0));
        sheet.text([WIDTH - MARGIN, below + 17.0], &interpolated, style);
        let bottom = self.draw_curve(&mut sheet, frame.row, below + 26.0);
        Ok(sheet.finish(WIDTH, bottom + 8.0))
    }

    fn draw_curve(&self, sheet: &mut Sheet, now: usize, top: f64) -> f64 {
        let rows = self.rows;
        let [first, last] = [rows[0].t_ms, rows[rows.len() - 1].t_ms];
        let values = self.contraction.iter().copied();
        let [low, high] = values.fold([0.0_f64, 0.1], |[low, high], v| [low.min(v), high.max(v)]);
        let at = |row: usize| {
            let along = (rows[row].t_ms - first) / (last - first);
            let up = (self.contraction[row] - low) / (high - low);
            [MARGIN + (WIDTH - 2.0 * MARGIN) * along, top + 16.0 + CURVE * (1.0 - up)]
        };
        sheet.path(Path::line((0..rows.len()).map(at)), Stroke::new(CURVES[0], 1.4));
        sheet.dot(at(now), CURVES[0]);
        let text = format!("contraction {} % ({})", fixed(self.contraction[now], 1), self.by);
        let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
        sheet.text([WIDTH - MARGIN, top + 9.0], &text, style);
        top + 16.0 + CURVE
    }

    /// A frame as needed by [`Tracked::gif`]; frames are independent of each other.
    ///
    /// # Errors
    /// As of [`Tracked::frame`], and more pixels than memory allows.
    pub fn still(&self, frame: &TrackedFrame<'_>) -> Result<Still, FigureError> {
        let painted = painted(&self.frame(frame)?, 96.0)?;
        Ok(gif::still(&palette(), painted.size, &painted.colours))
    }

    /// All frames as an animated GIF, each shown for `hundredths` hundredths of a second.
    ///
    /// # Errors
    /// No frame, or a GIF that cannot be written.
    pub fn gif(&self, stills: &[Still], hundredths: u16) -> Result<Vec<u8>, FigureError> {
        gif::animated(&palette(), stills, hundredths)
    }

    /// Draws the summary: the frame at rest (A), the most contracted one with its lattice and the
    /// displacements as arrows (B), and the curves of contraction, stretches and sarcomeres. Two
    /// columns wide.
    ///
    /// # Errors
    /// As of [`Tracked::frame`].
    pub fn summary(
        &self,
        rest: &TrackedFrame<'_>,
        shortest: &TrackedFrame<'_>,
    ) -> Result<Figure, FigureError> {
        self.check(rest)?;
        self.check(shortest)?;
        let mut sheet = Sheet::default();
        let extent = self.extent();
        let gap = 16.0;
        let wide = (DOUBLE - gap - 2.0 * MARGIN) / 2.0;
        // Long pictures are stacked.
        let stands = extent[0] > 2.2 * extent[1];
        let room = if stands { DOUBLE - 2.0 * MARGIN } else { wide };
        let scale = (room / extent[0]).min(mm(85.0) / extent[1]);
        let size = extent.map(|length| length * scale);
        let mut top = MARGIN;
        if !self.title.is_empty() {
            sheet.text([MARGIN, top + 8.0], self.title, Style::new(LABEL));
            top += 16.0;
        }
        let title = |frame: &TrackedFrame<'_>, what: &str| {
            let row = &self.rows[frame.row];
            format!("{what}, frame {} ({} ms)", row.frame, fixed(row.t_ms, 0))
        };
        let contraction = fixed(self.contraction[shortest.row], 1);
        let magnified = self.magnified(rest, shortest, scale);
        let panels = [
            (rest, "A", title(rest, "at rest")),
            (
                shortest,
                "B",
                format!(
                    "{}, by {contraction} %; arrows {} \u{d7}",
                    title(shortest, "contracted"),
                    fixed(magnified, 0)
                ),
            ),
        ];
        let mut bottom = top;
        for (index, (frame, letter, words)) in panels.iter().enumerate() {
            let left = if stands || index == 0 { MARGIN } else { MARGIN + wide + gap };
            let above = if stands && index == 1 { bottom + 14.0 } else { top };
            sheet.text([left, above + 11.0], letter, Style::new(LETTER).bold());
            sheet.text([left + 16.0, above + 11.0], words, Style::new(TICK));
            let place = Area { corner: [left, above + 18.0], size };
            let at = |[x, y]: [f64; 2]| {
                [place.corner[0] + x * scale, place.corner[1] + (extent[1] - y) * scale]
            };
            let mut inside = Sheet::default();
            inside.picture(place, self.picture(frame.values, 300.0 / 96.0 * size[0])?);
            if index == 0 {
                self.draw_lattice(&mut inside, frame, scale, at);
            } else {
                self.draw_arrows(&mut inside, [rest, shortest], scale, magnified, at);
            }
            sheet.window(format!("panel-{letter}"), Path::rect(place), inside);
            bottom = above + 18.0 + size[1];
        }
        draw_scale_bar(&mut sheet, [MARGIN, bottom + 12.0], scale, extent);
        let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
        let note = format!(
            "interpolated points red, {} % here",
            fixed(self.rows[rest.row].interpolated_pct, 0)
        );
        sheet.text([MARGIN + size[0], bottom + 15.5], &note, style);
        let bottom = self.draw_curves(&mut sheet, bottom + 30.0);
        Ok(sheet.finish(DOUBLE, bottom))
    }

    /// Magnification of the displacement arrows, so that nearly the longest one is well visible.
    fn magnified(&self, rest: &TrackedFrame<'_>, now: &TrackedFrame<'_>, scale: f64) -> f64 {
        let length = |node: usize| {
            let way = [0, 1].map(|a: usize| now.positions[a][node] - rest.positions[a][node]);
            way[0].hypot(way[1]) * scale
        };
        let mut lengths: Vec<f64> = (0..self.mesh.len())
            .filter(|&node| !now.interpolated.get(node).copied().unwrap_or(false))
            .map(length)
            .collect();
        lengths.sort_by(f64::total_cmp);
        // The largest 2 % are ignored, so that a few outliers do not make all others small.
        let longest = lengths.get(lengths.len() * 49 / 50).copied().unwrap_or(0.0).max(1e-9);
        let factor = (ARROW / longest).max(1.0);
        // A round number.
        let power = 10_f64.powf(factor.log10().floor());
        let round = [1.0, 2.0, 5.0].into_iter().rfind(|part| part * power <= factor).unwrap_or(1.0);
        (round * power).min(100.0)
    }

    fn draw_arrows(
        &self,
        sheet: &mut Sheet,
        [rest, now]: [&TrackedFrame<'_>; 2],
        scale: f64,
        magnified: f64,
        at: impl Fn([f64; 2]) -> [f64; 2],
    ) {
        let every = self
            .mesh
            .lattice
            .as_ref()
            .map_or(1, |lattice| (PITCH / (lattice.spacing * scale)).round().max(1.0) as u32);
        let mut path = Path::default();
        for node in 0..self.mesh.len() {
            let shown = self.mesh.lattice.as_ref().is_none_or(|lattice| {
                lattice.cells[node].iter().all(|place| place.is_multiple_of(every))
            });
            if !shown {
                continue;
            }
            let from = at([rest.positions[0][node], rest.positions[1][node]]);
            let to = at([now.positions[0][node], now.positions[1][node]]);
            let way = [0, 1].map(|a: usize| magnified * (to[a] - from[a]));
            let length = way[0].hypot(way[1]);
            if length < 1.0 {
                path.add_line([from; 2]);
                continue;
            }
            let tip = [from[0] + way[0], from[1] + way[1]];
            let head = (0.35 * length).min(4.0) / length;
            let [x, y] = way.map(|part| part * head);
            path.add_line([from, tip]);
            path.add_line([
                [tip[0] - x - 0.6 * y, tip[1] - y + 0.6 * x],
                tip,
                [tip[0] - x + 0.6 * y, tip[1] - y - 0.6 * x],
            ]);
        }
        sheet.path(path.clone(), Stroke::new(BLACK, 2.2).opacity(0.5).round_ends());
        sheet.path(path, Stroke::new(LATTICE, 1.0).round_ends());
    }

    /// Draws curves over time below each other; returns their lower end, px.
    fn draw_curves(&self, sheet: &mut Sheet, top: f64) -> f64 {
        let rows = self.rows;
        let times = [rows[0].t_ms, rows[rows.len() - 1].t_ms];
        let column = |value: &dyn Fn(&TrackRow) -> f64| -> Vec<[f64; 2]> {
            rows.iter().map(|row| [row.t_ms, value(row)]).collect()
        };
        let contraction = rows.iter().zip(self.contraction);
        let contraction = contraction.map(|(row, value)| [row.t_ms, *value]).collect();
        let mut panels = vec![(
            "Contraction (%)",
            vec![Curve::solid(contraction, CURVES[0])],
            vec![(format!("by {}", self.by), CURVES[0])],
        )];
        panels.push((
            "Stretch",
            vec![
                Curve::solid(column(&|row| row.stretch_1), CURVES[0]),
                Curve::solid(column(&|row| row.stretch_2), CURVES[1]),
            ],
            vec![("stretch 1".to_owned(), CURVES[0]), ("stretch 2".to_owned(), CURVES[1])],
        ));
        if rows.iter().any(|row| row.sarcomere_um.is_some()) {
            let lengths = column(&|row| row.sarcomere_um.unwrap_or(f64::NAN));
            panels.push((
                "Sarcomere (\u{b5}m)",
                vec![Curve::solid(lengths, CURVES[2])],
                Vec::new(),
            ));
        }
        let (height, between, left) = (72.0, 18.0, 58.0);
        let count = panels.len();
        let mut place = top;
        for (index, (label, curves, legend)) in panels.into_iter().enumerate() {
            let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]);
            let y = Axis::upright(label, ends(values), height);
            let x = Axis { labelled: index + 1 == count, ..Axis::time(times) };
            let mut chart = Chart::new(place, height, [x, y], curves);
            (chart.place[0], chart.size[0]) = (left, DOUBLE - left - MARGIN);
            chart.draw(sheet, 46.0);
            for (at, (name, colour)) in legend.into_iter().enumerate() {
                let x = DOUBLE - MARGIN - 130.0 + 68.0 * at as f64;
                sheet.line([x, place - 6.0], [x + 12.0, place - 6.0], Stroke::new(colour, 1.6));
                sheet.text([x + 15.0, place - 2.5], &name, Style::new(TICK).colour(INK));
            }
            place += height + between;
        }
        place - between + 40.0
    }
}

/// The palette: greys, the colours of lattice and interpolated points blended with them, and the
/// colour of the curve.
fn palette() -> Vec<[u8; 3]> {
    let greys = |count: u8| {
        (0..count).map(move |k| [(255.0 * f64::from(k) / f64::from(count - 1)) as u8; 3])
    };
    let mut palette: Vec<[u8; 3]> = greys(GREYS).collect();
    for (colour, parts) in
        [(LATTICE, &[0.15, 0.3, 0.45, 0.6, 0.75][..]), (INTERPOLATED, &[0.5, 1.0])]
    {
        for part in parts {
            palette.extend(greys(16).map(|grey| mixed(grey, colour.channels(), *part)));
        }
    }
    for part in [0.3, 0.6, 1.0] {
        palette.push(mixed(WHITE.channels(), CURVES[0].channels(), part));
    }
    palette
}
