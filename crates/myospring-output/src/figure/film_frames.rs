//! Frames of a film with the outline of its cell and that of a simulated one, as a figure and as a GIF.

use super::cell::{DrawnCell, closed, draw_colour_bar};
use super::film::{Still, gif, mixed};
use super::overlay::{CHOSEN, Panel, View, draw_lines_legend};
use super::photograph::between;
use super::raster::painted;
use super::shapes::{ELONGATED, draw_scale_bar};
use super::sheet::{Anchor, Area, Path, Sheet, Stroke, Style};
use super::theme::{
    BLACK, CURVES, Colour, DOUBLE, INK, LABEL, LETTER, MUTED, REST, TICK, WHITE, fixed, mm,
};
use super::{Figure, FigureError};
use crate::field::Field;
use myospring_core::mesh::pixel_size::PixelSize;
use myospring_core::recording::Frame;

/// Space at the sides and between panels, px.
const MARGIN: f64 = 8.0;
const GAP: f64 = 12.0;
/// Height of the line above a panel, and of those below, px.
const HEAD: f64 = 18.0;
const FOOT: f64 = 38.0;
/// Greatest height of a panel, px.
const TALLEST: f64 = mm(70.0);
/// Levels of grey of the frames: more cannot be seen, and noise in them makes files large.
const LEVELS: u8 = 63;
/// The simulated cell (Okabe-Ito sky blue), dashed over the yellow line of the film's.
const SIMULATED: Colour = CURVES[4];
/// Width of a frame of the GIF, px, and the largest area of the picture in it, px^2.
const WIDTH: f64 = 420.0;
const LARGEST: f64 = 110_000.0;
/// Levels of grey in the palette of the GIF.
const GREYS: u8 = 40;

/// A film whose cell is compared with a simulated one.
#[derive(Debug, Clone, Copy)]
pub struct FilmFrames<'a> {
    /// The line above: name of the film, which beat.
    pub title: &'a str,
    /// Columns of the film.
    pub width: usize,
    /// Rows of the film.
    pub height: usize,
    /// Side of one pixel.
    pub pixel_size: PixelSize,
    /// The cell of the film at rest, on the mesh of both.
    pub cell: &'a DrawnCell<'a>,
}

/// A frame of the film, and both cells in it.
#[derive(Debug, Clone)]
pub struct ComparedFrame<'a> {
    /// What it is: `at rest`.
    pub name: &'a str,
    /// Its number in the film.
    pub frame: usize,
    /// Its time from the first frame of the film, ms.
    pub t_ms: f64,
    /// Grey values row by row from the top left.
    pub values: &'a [f32],
    /// Points of the film's cell in the picture, um, y upward.
    pub measured: [Vec<f64>; 2],
    /// Those of the simulated cell.
    pub simulated: [Vec<f64>; 2],
    /// Distance between the two, root mean square, um.
    pub distance_um: f64,
    /// How far the film's cell has moved from rest, um.
    pub movement_um: f64,
}

impl FilmFrames<'_> {
    fn check(&self, frames: &[ComparedFrame<'_>]) -> Result<(), FigureError> {
        let Self { width, height, cell, .. } = *self;
        if frames.is_empty() {
            return Err(FigureError::Nothing { what: "frames" });
        }
        for frame in frames {
            let found = frame.values.len();
            if width.checked_mul(height) != Some(found) || found == 0 {
                return Err(FigureError::PictureShape { width, height, found });
            }
            cell.check(&frame.measured)?;
            cell.check(&frame.simulated)?;
        }
        Ok(())
    }

    /// The part of the film with the cell in all frames.
    fn view(&self, frames: &[ComparedFrame<'_>]) -> View {
        let whole = View::whole([self.width, self.height], self.pixel_size.um());
        let shapes = frames.iter().flat_map(|frame| [&frame.measured, &frame.simulated]);
        let points: Vec<[f64; 2]> =
            shapes.flat_map(|shape| self.cell.rings(shape)).flatten().collect();
        View::around(&points, whole, self.pixel_size.um()).unwrap_or(whole)
    }

    /// Draws a frame with both outlines; `sharp` is the largest number of pixels per px, `ends` are the values that become
    /// black and white.
    fn draw_frame(
        &self,
        sheet: &mut Sheet,
        panel: &Panel,
        (frame, name): (&ComparedFrame<'_>, &str),
        (ends, sharp, levels): ([f32; 2], f64, u8),
    ) -> Result<(), FigureError> {
        let mut inside = Sheet::default();
        let part = panel.part(frame.values, self.width);
        inside.picture(panel.area(), between(&part, ends, sharp * panel.size()[0], levels)?);
        let [measured, simulated] =
            [&frame.measured, &frame.simulated].map(|shape| panel.lines(&self.cell.rings(shape)));
        for path in [&measured, &simulated] {
            inside.path(path.clone(), Stroke::new(BLACK, 3.0).opacity(0.45));
        }
        inside.path(measured, followed());
        inside.path(simulated, fitted());
        sheet.window(name.to_owned(), Path::rect(panel.area()), inside);
        Ok(())
    }

    /// Draws frames with both outlines, and the simulated cell in the frame at place `shown` coloured by its strain; two
    /// columns wide (178 mm). `sharp` is the largest number of pixels of a frame per px of the figure: 3 for print.
    ///
    /// # Errors
    /// No frame, pictures of another size, or shapes of another mesh or with positions that are not finite.
    pub fn figure(
        &self,
        frames: &[ComparedFrame<'_>],
        shown: usize,
        sharp: f64,
    ) -> Result<Figure, FigureError> {
        self.check(frames)?;
        let view = self.view(frames);
        let extent = view.extent();
        let columns = if extent[0] > ELONGATED * extent[1] { 2 } else { 3 };
        let wide = (DOUBLE - 2.0 * MARGIN - (columns - 1) as f64 * GAP) / columns as f64;
        let scale = (wide / extent[0]).min(TALLEST / extent[1]);
        let size = extent.map(|length| length * scale);
        let mut sheet = Sheet::default();
        sheet.text([MARGIN, 13.0], self.title, Style::new(LABEL));
        let above = if self.title.is_empty() { 4.0 } else { 22.0 };
        let corner = |index: usize| {
            let left = MARGIN + (index % columns) as f64 * (wide + GAP);
            [left, above + (index / columns) as f64 * (HEAD + size[1] + FOOT)]
        };
        let head = |sheet: &mut Sheet, index: usize, words: &str| {
            let [left, top] = corner(index);
            let letter = char::from(b'A' + (index % 26) as u8).to_string();
            sheet.text([left, top + 11.0], &letter, Style::new(LETTER).bold());
            sheet.text([left + 16.0, top + 11.0], words, Style::new(LABEL));
        };
        let panel = |index: usize| {
            let [left, top] = corner(index);
            Panel { view, place: [left, top + HEAD], scale }
        };
        let ends = panel(0).part(frames[0].values, self.width).ends();
        for (index, frame) in frames.iter().enumerate() {
            head(&mut sheet, index, &format!("{}, {} ms", frame.name, fixed(frame.t_ms, 0)));
            let panel = panel(index);
            let name = format!("frame-{index}");
            self.draw_frame(&mut sheet, &panel, (frame, &name), (ends, sharp, LEVELS))?;
            let below = panel.place[1] + size[1];
            let style = Style::new(TICK);
            sheet.text([panel.place[0], below + 13.0], &distance(frame), style);
            let words = format!("frame {}, moved {} \u{b5}m", frame.frame, um(frame.movement_um));
            sheet.text([panel.place[0], below + 26.0], &words, style.colour(MUTED));
        }
        let (index, frame) = (frames.len(), &frames[shown.min(frames.len() - 1)]);
        head(&mut sheet, index, &format!("the fitted cell, {}", frame.name));
        self.draw_cell(&mut sheet, &panel(index), frame);
        let rows = (frames.len() + 1).div_ceil(columns) as f64;
        let bottom = above + rows * (HEAD + size[1] + FOOT) + 9.0;
        draw_scale_bar(&mut sheet, [MARGIN, bottom + 5.0], scale, extent);
        let bottom = draw_legend(&mut sheet, MARGIN + wide + GAP, bottom);
        Ok(sheet.finish(DOUBLE, bottom + 4.0))
    }

    /// Draws the simulated cell coloured by its strain, with its colours below.
    fn draw_cell(&self, sheet: &mut Sheet, panel: &Panel, frame: &ComparedFrame<'_>) {
        let cell = self.cell.clone().coloured_by(Field::FibreStrain);
        let shape = Frame::new(frame.t_ms, f64::NAN, frame.simulated.clone());
        let colours = cell.colours([&shape]);
        let mut inside = Sheet::default();
        cell.fill(&mut inside, "fitted".to_owned(), &shape, &colours, |point| panel.at(point));
        let rest = panel.lines(&cell.rings(&cell.mesh().points));
        sheet.window("fitted-cell".to_owned(), Path::rect(panel.area()), inside);
        sheet.path(
            closed(&cell.rings(&shape.positions), |point| panel.at(point)),
            Stroke::new(INK, 0.8),
        );
        sheet.path(rest, Stroke::new(REST, 0.8).dash(2.5, 1.8));
        let [width, height] = panel.size();
        let bar = (width - 40.0).min(150.0);
        let corner = [panel.place[0] + 8.0, panel.place[1] + height + 16.0];
        draw_colour_bar(sheet, Area { corner, size: [bar, 7.0] }, &colours);
    }

    /// A frame of the GIF: the picture with both outlines, the time and the distance; `ends` are the grey values that become
    /// black and white in all frames (`ends`), `all` are the frames between which the view does not move.
    ///
    /// # Errors
    /// As of [`FilmFrames::figure`].
    pub fn still(&self, frame: &ComparedFrame<'_>, view: &FilmView) -> Result<Still, FigureError> {
        let painted = painted(&self.moving(frame, view)?, 96.0)?;
        Ok(gif::still(&palette(), painted.size, &painted.colours))
    }

    /// What the frames of a GIF have in common.
    ///
    /// # Errors
    /// As of [`FilmFrames::figure`].
    pub fn common(&self, frames: &[ComparedFrame<'_>]) -> Result<FilmView, FigureError> {
        self.check(frames)?;
        let view = self.view(frames);
        let whole = Panel { view, place: [0.0; 2], scale: 1.0 };
        Ok(FilmView { view, ends: whole.part(frames[0].values, self.width).ends() })
    }

    /// All frames as an endless GIF, each shown for `hundredths` hundredths of a second.
    ///
    /// # Errors
    /// No frame, or a GIF that cannot be written.
    pub fn gif(&self, stills: &[Still], hundredths: u16) -> Result<Vec<u8>, FigureError> {
        gif::animated(&palette(), stills, hundredths)
    }

    fn moving(&self, frame: &ComparedFrame<'_>, common: &FilmView) -> Result<Figure, FigureError> {
        let extent = common.view.extent();
        let room = WIDTH - 2.0 * MARGIN;
        let scale = (room / extent[0]).min((LARGEST / (extent[0] * extent[1])).sqrt());
        let size = extent.map(|length| length * scale);
        let mut sheet = Sheet::default();
        sheet.text([MARGIN, 18.0], &format!("{} ms", fixed(frame.t_ms, 0)), Style::new(13).bold());
        let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
        sheet.text([WIDTH - MARGIN, 17.0], &format!("frame {}", frame.frame), style);
        let place = [(WIDTH - size[0]) / 2.0, 26.0];
        let panel = Panel { view: common.view, place, scale };
        self.draw_frame(&mut sheet, &panel, (frame, "frame"), (common.ends, 1.0, GREYS))?;
        let below = place[1] + size[1];
        draw_scale_bar(&mut sheet, [MARGIN, below + 13.0], scale, extent);
        sheet.text([WIDTH - MARGIN, below + 16.0], &distance(frame), style.colour(INK));
        let bottom = draw_legend(&mut sheet, MARGIN, below + 22.0);
        Ok(sheet.finish(WIDTH, bottom + 4.0))
    }
}

/// What the frames of a GIF have in common: the part of the film, and the values that become black and white.
#[derive(Debug, Clone, Copy)]
pub struct FilmView {
    view: View,
    ends: [f32; 2],
}

fn followed() -> Stroke {
    Stroke::new(CHOSEN, 1.5)
}

fn fitted() -> Stroke {
    Stroke::new(SIMULATED, 1.5).dash(4.0, 3.0)
}

fn draw_legend(sheet: &mut Sheet, left: f64, top: f64) -> f64 {
    let entries = [(followed(), "followed in the film"), (fitted(), "fitted cell")];
    draw_lines_legend(sheet, [left, DOUBLE], top, entries.into_iter())
}

fn distance(frame: &ComparedFrame<'_>) -> String {
    format!("distance {} \u{b5}m", um(frame.distance_um))
}

fn um(length: f64) -> String {
    fixed(length, if length < 10.0 { 2 } else { 1 })
}

/// Greys, the colours of both lines and blends of these with black, and of ink with paper.
fn palette() -> Vec<[u8; 3]> {
    let steps = |count: u8| (0..count).map(move |k| f64::from(k) / f64::from(count - 1));
    let mut palette: Vec<[u8; 3]> =
        steps(GREYS + 1).map(|part| mixed(BLACK.channels(), WHITE.channels(), part)).collect();
    palette.extend([INK, MUTED, Colour(0x333333)].map(Colour::channels));
    for colour in [CHOSEN, SIMULATED] {
        for part in [0.35, 0.7, 1.0] {
            palette.extend(steps(12).map(|level| {
                let grey = mixed(BLACK.channels(), WHITE.channels(), level);
                mixed(grey, colour.channels(), part)
            }));
        }
    }
    palette.push(mixed(CHOSEN.channels(), SIMULATED.channels(), 0.5));
    palette
}
