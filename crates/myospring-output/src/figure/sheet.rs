//! A sheet of drawn elements, in px with y downward; `svg` writes it and `raster` paints it.

use super::theme::{BLACK, Colour, INK, Theme, WHITE, mm};

/// A drawn figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Width and height, px.
    pub(super) size: [f64; 2],
    pub(super) paper: Colour,
    pub(super) elements: Vec<Element>,
}

impl Figure {
    /// Texts that extend beyond these sides, px, with their ends.
    #[cfg(test)]
    pub(super) fn beyond(&self, [low, high]: [f64; 2]) -> Vec<(String, [f64; 2])> {
        let reach = |element: &Element| {
            let Element::Text { at, text, style } = element else { return None };
            let (width, size) = (super::font::text_width(text, style.size), f64::from(style.size));
            let before = match style.anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => 0.5 * width,
                Anchor::End => width,
            };
            let ends = if style.upward {
                [at[0] - 0.8 * size, at[0] + 0.3 * size]
            } else {
                [at[0] - before, at[0] - before + width]
            };
            (ends[0] < low || ends[1] > high).then(|| (text.clone(), ends))
        };
        self.elements.iter().filter_map(reach).collect()
    }

    /// The figure in a theme; figures are drawn in the light one.
    #[must_use]
    pub fn themed(mut self, theme: Theme) -> Self {
        self.paper = theme.shown(self.paper);
        for element in &mut self.elements {
            match element {
                Element::Path { look, .. } | Element::Circle { look, .. } => {
                    look.fill = look.fill.map(|colour| theme.shown(colour));
                    look.stroke =
                        look.stroke.map(|pen| Stroke { colour: theme.shown(pen.colour), ..pen });
                }
                Element::Text { style, .. } => style.colour = theme.shown(style.colour),
                // Pictures and their overlays keep their colours.
                Element::Picture { .. } | Element::Window { .. } => {}
            }
        }
        self
    }
}

/// An element of a sheet.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Element {
    Path {
        path: Path,
        look: Look,
    },
    Circle {
        centre: [f64; 2],
        radius: f64,
        look: Look,
    },
    Text {
        at: [f64; 2],
        text: String,
        style: Style,
    },
    /// A grey picture stretched over an area.
    Picture {
        place: Area,
        picture: Picture,
    },
    /// Elements clipped to closed lines.
    Window {
        name: String,
        frame: Path,
        inside: Vec<Element>,
    },
}

/// Upper left corner and size, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) corner: [f64; 2],
    pub(super) size: [f64; 2],
}

/// Grey values row by row from the top left, raw and as PNG.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Picture {
    pub(super) size: [u32; 2],
    pub(super) grey: Vec<u8>,
    pub(crate) png: Vec<u8>,
}

/// Polylines in hundredths of a px, so that SVG and PNG agree exactly.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Path {
    pub(super) steps: Vec<Step>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    Move([i32; 2]),
    Line([i32; 2]),
    Close,
}

/// A length in hundredths of a px.
pub(super) fn hundredths(length: f64) -> i32 {
    (100.0 * length).round() as i32
}

impl Path {
    /// Adds lines through some points. Two equal points with round ends give a dot.
    pub(super) fn add_line(&mut self, points: impl IntoIterator<Item = [f64; 2]>) {
        for (index, point) in points.into_iter().enumerate() {
            let place = point.map(hundredths);
            self.steps.push(if index == 0 { Step::Move(place) } else { Step::Line(place) });
        }
    }

    /// Adds lines through some points and back to the first.
    pub(super) fn add_ring(&mut self, points: impl IntoIterator<Item = [f64; 2]>) {
        let before = self.steps.len();
        self.add_line(points);
        if self.steps.len() > before {
            self.steps.push(Step::Close);
        }
    }

    /// The bounding box, px; `None` for a path without lines.
    pub(super) fn bounds(&self) -> Option<Area> {
        let places = self.steps.iter().filter_map(|step| match *step {
            Step::Move(place) | Step::Line(place) => Some(place.map(|x| f64::from(x) / 100.0)),
            Step::Close => None,
        });
        let ends = places.map(|place| [place, place]).reduce(|[low, high], [place, _]| {
            let of = |pick: fn(f64, f64) -> f64, ends: [f64; 2]| {
                [0, 1].map(|axis: usize| pick(ends[axis], place[axis]))
            };
            [of(f64::min, low), of(f64::max, high)]
        });
        ends.map(|[low, high]| Area { corner: low, size: [high[0] - low[0], high[1] - low[1]] })
    }

    pub(super) fn line(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut path = Self::default();
        path.add_line(points);
        path
    }

    pub(super) fn rect(Area { corner: [x, y], size: [width, height] }: Area) -> Self {
        let (right, bottom) = (x + width, y + height);
        let mut path = Self::default();
        path.add_ring([[x, y], [right, y], [right, bottom], [x, bottom]]);
        path
    }
}

/// Style of a path; corners are round.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Look {
    pub(super) fill: Option<Colour>,
    pub(super) stroke: Option<Stroke>,
}

impl Look {
    pub(super) const fn fill(colour: Colour) -> Self {
        Self { fill: Some(colour), stroke: None }
    }

    pub(super) const fn stroke(self, stroke: Stroke) -> Self {
        Self { stroke: Some(stroke), ..self }
    }
}

impl From<Stroke> for Look {
    fn from(stroke: Stroke) -> Self {
        Self::default().stroke(stroke)
    }
}

/// Style of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stroke {
    pub(super) colour: Colour,
    pub(super) opacity: f64,
    /// Width, px.
    pub(super) width: f64,
    /// Length of dashes and of the gaps between them, px.
    pub(super) dash: Option<[f64; 2]>,
    /// Whether ends are round; otherwise they are cut off.
    pub(super) round_ends: bool,
}

impl Stroke {
    pub(super) const fn new(colour: Colour, width: f64) -> Self {
        Self { colour, opacity: 1.0, width, dash: None, round_ends: false }
    }

    pub(super) const fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    pub(super) const fn dash(self, dash: f64, gap: f64) -> Self {
        Self { dash: Some([dash, gap]), ..self }
    }

    pub(super) const fn round_ends(self) -> Self {
        Self { round_ends: true, ..self }
    }
}

/// The dark rim around text in a halo.
pub(super) const HALO: Stroke = Stroke::new(BLACK, 2.5).opacity(0.7);

/// Position of a text relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Style of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Style {
    pub(super) size: u32,
    pub(super) anchor: Anchor,
    pub(super) colour: Colour,
    pub(super) bold: bool,
    /// Written upward, as along a vertical axis.
    pub(super) upward: bool,
    /// With a dark rim, readable on black and on white.
    pub(super) halo: bool,
}

impl Style {
    pub(super) const fn new(size: u32) -> Self {
        let anchor = Anchor::Start;
        Self { size, anchor, colour: INK, bold: false, upward: false, halo: false }
    }

    pub(super) const fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub(super) const fn colour(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    pub(super) const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub(super) const fn upward(self) -> Self {
        Self { upward: true, ..self }
    }

    pub(super) const fn halo(self) -> Self {
        Self { halo: true, ..self }
    }
}

/// Elements in drawing order.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Sheet {
    elements: Vec<Element>,
}

impl Sheet {
    pub(super) fn path(&mut self, path: Path, look: impl Into<Look>) {
        if !path.steps.is_empty() {
            self.elements.push(Element::Path { path, look: look.into() });
        }
    }

    pub(super) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        self.path(Path::line([from, to]), stroke);
    }

    pub(super) fn rect(&mut self, corner: [f64; 2], size: [f64; 2], look: impl Into<Look>) {
        self.path(Path::rect(Area { corner, size }), look);
    }

    /// Draws a dot on a curve, with a ring in the paper's colour.
    pub(super) fn dot(&mut self, centre: [f64; 2], colour: Colour) {
        let look = Look::fill(colour).stroke(Stroke::new(WHITE, 1.0));
        self.elements.push(Element::Circle { centre, radius: 3.0, look });
    }

    /// Draws a small round mark, one of many.
    pub(super) fn point(&mut self, centre: [f64; 2], radius: f64, colour: Colour) {
        self.elements.push(Element::Circle { centre, radius, look: Look::fill(colour) });
    }

    pub(super) fn text(&mut self, at: [f64; 2], text: &str, style: Style) {
        if !text.is_empty() {
            self.elements.push(Element::Text { at, text: text.to_owned(), style });
        }
    }

    pub(super) fn picture(&mut self, place: Area, picture: Picture) {
        self.elements.push(Element::Picture { place, picture });
    }

    /// Adds the elements of another sheet, clipped to closed lines; the name must be unique within
    /// the figure.
    pub(super) fn window(&mut self, name: String, frame: Path, inside: Sheet) {
        self.elements.push(Element::Window { name, frame, inside: inside.elements });
    }

    /// Completes the figure, `width` by `height` px (rounded to a hundredth of a millimetre), on
    /// white.
    pub(super) fn finish(self, width: f64, height: f64) -> Figure {
        let size = [width, height].map(|length| mm((100.0 * length / mm(1.0)).round() / 100.0));
        Figure { size, paper: WHITE, elements: self.elements }
    }
}
