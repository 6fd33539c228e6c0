//! The beating cell as a film: frames at regular times, each as a figure, or all as an animated
//! GIF.

pub(super) mod gif;

use super::cell::{COLOURS, DrawnCell, closed, draw_colour_bar};
use super::facets::check_frame;
use super::moments::LEAST_SHORTENING;
use super::raster::painted;
use super::shapes::{draw_scale_bar, extremes};
use super::sheet::{Anchor, Area, Path, Sheet, Stroke, Style};
use super::theme::{Colour, INK, MUTED, REST, SHORTENING, TICK, Theme, WHITE, fixed};
use super::{Figure, FigureError};
use crate::field::ColourScale;
use myospring_core::recording::{Frame, Recording};

/// Frames per second of the film; GIF counts hundredths of a second.
pub const FRAMES_PER_SECOND: u32 = 25;
/// The longest time that is filmed, ms.
const LONGEST: f64 = 2000.0;
/// Width of a frame, and the greatest height of the cell in it, px.
const WIDTH: f64 = 480.0;
const HIGHEST: f64 = 320.0;
/// Space at the sides, px.
const MARGIN: f64 = 10.0;
/// Height of the curve of shortening, px.
const CURVE: f64 = 40.0;

/// A film of one beat: the cell in its outline, the time, a scale bar, the colours and the shortening so far.
#[derive(Debug, Clone)]
pub struct BeatFilm<'a> {
    cell: &'a DrawnCell<'a>,
    recording: &'a Recording,
    frames: Vec<&'a Frame>,
    colours: ColourScale,
    theme: Theme,
    slowed: f64,
    /// First and last time, ms.
    span: [f64; 2],
    /// Corners of the box around all shapes, um.
    low: [f64; 2],
    high: [f64; 2],
}

impl<'a> BeatFilm<'a> {
    /// The first beat of a recording, up to its second stimulus or to its end, at most 2 s; `slowed` 1 is real time.
    ///
    /// # Errors
    /// No frame with finite positions, frames of another mesh, or a factor that is not at least 1.
    pub fn new(
        cell: &'a DrawnCell<'a>,
        recording: &'a Recording,
        stimulus_times_ms: &[f64],
        slowed: f64,
        theme: Theme,
    ) -> Result<Self, FigureError> {
        if !(slowed.is_finite() && slowed >= 1.0) {
            return Err(FigureError::Slowed { slowed });
        }
        let mut frames: Vec<&Frame> = Vec::new();
        for frame in &recording.frames {
            match check_frame(cell.mesh(), frame) {
                Ok(()) => frames.push(frame),
                // Frames after a simulation broke are left out.
                Err(FigureError::NotFinite { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        let (Some(first), Some(last)) = (frames.first(), frames.last()) else {
            return Err(FigureError::Nothing { what: "frames" });
        };
        let mut stimuli: Vec<f64> =
            stimulus_times_ms.iter().copied().filter(|t| t.is_finite()).collect();
        stimuli.sort_by(f64::total_cmp);
        let end = stimuli.get(1).copied().unwrap_or(f64::INFINITY);
        let span = [first.t_ms, last.t_ms.min(end).min(first.t_ms + LONGEST).max(first.t_ms)];
        let filmed = frames.iter().filter(|frame| frame.t_ms <= span[1]);
        let colours = cell.colours(filmed.clone().copied());
        let [low, high] = extremes(cell, filmed.map(|frame| &frame.positions));
        Ok(Self { cell, recording, frames, colours, theme, slowed, span, low, high })
    }

    /// Time between two frames, ms of the beat.
    fn interval(&self) -> f64 {
        1000.0 / f64::from(FRAMES_PER_SECOND) / self.slowed
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        // A last time that is a multiple of the interval except for rounding is included.
        ((self.span[1] - self.span[0]) / self.interval() + 1e-6) as usize + 1
    }

    /// Whether there are no frames; always false.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The time of a frame, ms.
    pub fn time(&self, index: usize) -> f64 {
        (self.span[0] + index as f64 * self.interval()).min(self.span[1])
    }

    /// The shape at a time, interpolated linearly between frames.
    fn shape(&self, time: f64) -> Frame {
        let after =
            self.frames.partition_point(|frame| frame.t_ms < time).min(self.frames.len() - 1);
        let (next, last) = (self.frames[after], self.frames[after.saturating_sub(1)]);
        let way = next.t_ms - last.t_ms;
        let part = if way > 0.0 { ((time - last.t_ms) / way).clamp(0.0, 1.0) } else { 1.0 };
        let between = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| a + part * (b - a)).collect()
        };
        let tensions = last.ta_by_triangle_kpa.as_ref().zip(next.ta_by_triangle_kpa.as_ref());
        Frame {
            t_ms: time,
            ta_kpa: last.ta_kpa + part * (next.ta_kpa - last.ta_kpa),
            ta_by_triangle_kpa: tensions.map(|(a, b)| between(a, b)),
            on_gel_nn: last
                .on_gel_nn
                .as_ref()
                .zip(next.on_gel_nn.as_ref())
                .map(|(a, b)| [0, 1].map(|axis: usize| between(&a[axis], &b[axis]))),
            potential_mv: last
                .potential_mv
                .as_ref()
                .zip(next.potential_mv.as_ref())
                .map(|(a, b)| between(a, b)),
            positions: [0, 1]
                .map(|axis: usize| between(&last.positions[axis], &next.positions[axis])),
        }
    }

    /// A frame as a figure, 480 px wide.
    pub fn figure(&self, index: usize) -> Figure {
        let time = self.time(index);
        let frame = self.shape(time);
        let mut sheet = Sheet::default();
        let extent = [0, 1].map(|axis: usize| (self.high[axis] - self.low[axis]).max(1e-9));
        let wide = WIDTH - 2.0 * MARGIN;
        let scale = (wide / extent[0]).min(HIGHEST / extent[1]);
        let pace = if self.slowed > 1.0 {
            format!("slowed {} \u{d7}", fixed(self.slowed, usize::from(self.slowed.fract() != 0.0)))
        } else {
            "real time".to_owned()
        };
        sheet.text([MARGIN, 19.0], &format!("{} ms", fixed(time, 0)), Style::new(13).bold());
        let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
        sheet.text([WIDTH - MARGIN, 18.0], &pace, style);

        let (top, height) = (30.0, extent[1] * scale);
        let middle = [0, 1].map(|axis: usize| f64::midpoint(self.low[axis], self.high[axis]));
        let at = |[x, y]: [f64; 2]| {
            [WIDTH / 2.0 + (x - middle[0]) * scale, top + height / 2.0 - (y - middle[1]) * scale]
        };
        self.cell.fill(&mut sheet, "cell".to_owned(), &frame, &self.colours, at);
        let [now, rest] = [&frame.positions, &self.cell.mesh().points]
            .map(|positions| self.cell.rings(positions));
        sheet.path(closed(&rest, at), Stroke::new(REST, 1.0).dash(3.0, 2.4));
        sheet.path(closed(&now, at), Stroke::new(INK, 1.1));

        let below = top + height;
        draw_scale_bar(&mut sheet, [MARGIN, below + 32.0], scale, extent);
        let bar = Area { corner: [WIDTH - MARGIN - 196.0, below + 28.0], size: [188.0, 8.0] };
        draw_colour_bar(&mut sheet, bar, &self.colours);
        let bottom = self.draw_curve(&mut sheet, time, below + 60.0);
        sheet.finish(WIDTH, bottom + 8.0).themed(self.theme)
    }

    /// The curve of shortening, or of the tension of a cell that is held, with a dot at a time; returns its lower end.
    fn draw_curve(&self, sheet: &mut Sheet, time: f64, top: f64) -> f64 {
        let [first, last] = self.span;
        let wide = WIDTH - 2.0 * MARGIN;
        let samples = &self.recording.samples;
        let held = samples.iter().all(|sample| sample.shortening_pct.abs() < LEAST_SHORTENING);
        let points: Vec<[f64; 2]> = samples
            .iter()
            .map(|sample| [sample.t_ms, if held { sample.ta_kpa } else { sample.shortening_pct }])
            .filter(|[t, value]| (first..=last).contains(t) && value.is_finite())
            .collect();
        let [low, high] = points
            .iter()
            .fold([0.0_f64, 0.0_f64], |[low, high], point| [low.min(point[1]), high.max(point[1])]);
        if points.is_empty() || last <= first {
            return top;
        }
        let at = |[t, value]: [f64; 2]| {
            let part = (value - low) / (high - low).max(0.1);
            [MARGIN + wide * (t - first) / (last - first), top + 16.0 + CURVE * (1.0 - part)]
        };
        // About one point per pixel.
        let every = (points.len() / wide as usize).max(1);
        sheet.path(
            Path::line(points.iter().step_by(every).map(|&p| at(p))),
            Stroke::new(SHORTENING, 1.4),
        );
        let now = points.partition_point(|point| point[0] < time - 1e-6).min(points.len() - 1);
        sheet.dot(at([time, points[now][1]]), SHORTENING);
        let value = fixed(points[now][1], 1);
        let text =
            if held { format!("tension {value} kPa") } else { format!("shortening {value} %") };
        let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
        sheet.text([WIDTH - MARGIN, top + 10.0], &text, style);
        top + CURVE + 20.0
    }

    /// A frame as red, green and blue of each pixel, row by row from the top left, and its size;
    /// `scale` pixels per px. Both sides are even, as video wants it.
    ///
    /// # Errors
    /// More pixels than memory allows.
    pub fn pixels(&self, index: usize, scale: f64) -> Result<([u32; 2], Vec<u8>), FigureError> {
        let painted = painted(&self.figure(index), 96.0 * scale)?;
        let [width, height] = painted.size.map(|side| side as usize);
        let even = [width & !1, height & !1];
        let rows = painted.colours.chunks_exact(3 * width).take(even[1]);
        let colours = rows.flat_map(|row| &row[..3 * even[0]]).copied().collect();
        Ok((even.map(|side| side as u32), colours))
    }

    /// A frame as needed by [`BeatFilm::gif`]: one byte per pixel. Frames are independent of each
    /// other.
    ///
    /// # Errors
    /// More pixels than memory allows.
    pub fn still(&self, index: usize) -> Result<Still, FigureError> {
        let (size, colours) = self.pixels(index, 1.0)?;
        Ok(gif::still(&self.palette(), size, &colours))
    }

    /// All frames as an animated GIF, which repeats forever.
    ///
    /// # Errors
    /// No frame, or a GIF that cannot be written.
    ///
    /// # Example
    /// ```
    /// use myospring::output::field::Fields;
    /// use myospring::output::figure::{DrawnCell, BeatFilm, Theme};
    /// use myospring::prelude::*;
    /// let simulation = Simulation::new(built_in::adult_ventricular_mesh());
    /// # let mut simulation = simulation;
    /// # simulation.numerics.method = Method::QuasiStatic;
    /// let recording = simulation.build()?.run(|_| true).recording;
    /// let fields = Fields::new(&simulation.mesh, &simulation.fibres, None)?;
    /// let outline = built_in::adult_ventricular();
    /// let cell = DrawnCell::new(fields, Some(&outline))?;
    /// let film = BeatFilm::new(&cell, &recording, &[50.0], 5.0, Theme::Light)?;
    /// let stills: Vec<_> = (0..3).map(|index| film.still(index)).collect::<Result<_, _>>()?;
    /// assert!(film.gif(&stills)?.starts_with(b"GIF89a"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn gif(&self, stills: &[Still]) -> Result<Vec<u8>, FigureError> {
        gif::animated(&self.palette(), stills, 100 / FRAMES_PER_SECOND as u16)
    }

    /// The palette of the film: the colours of the field, pure and mixed with ink, and blends of
    /// ink and curve with paper.
    fn palette(&self) -> Vec<[u8; 3]> {
        let shown = |colour: Colour| self.theme.shown(colour).channels();
        let [paper, ink, curve] = [WHITE, INK, SHORTENING].map(shown);
        let field = self.colours.steps(COLOURS);
        let steps: Vec<[u8; 3]> =
            (0..COLOURS).map(|step| self.colours.step(step, COLOURS)).collect();
        let ramp = |from: [u8; 3], to: [u8; 3], count: u8| {
            (0..count).map(move |k| mixed(from, to, f64::from(k) / f64::from(count - 1)))
        };
        let mut palette: Vec<[u8; 3]> = ramp(paper, ink, 28).chain(ramp(curve, paper, 8)).collect();
        palette.push(REST.channels());
        for part in [1.0 / 3.0, 2.0 / 3.0] {
            palette.extend(field.iter().map(|&colour| mixed(colour, ink, part)));
        }
        palette.extend(steps);
        palette
    }
}

/// A colour between two.
pub(super) fn mixed(a: [u8; 3], b: [u8; 3], part: f64) -> [u8; 3] {
    let of = |channel: usize| {
        let (a, b) = (f64::from(a[channel]), f64::from(b[channel]));
        (a + part * (b - a)).round() as u8
    };
    [of(0), of(1), of(2)]
}

pub use gif::Still;
