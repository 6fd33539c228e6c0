//! A cell to be drawn, and the field by which it is coloured.

use super::FigureError;
use super::facets::{check_frame, check_mesh, facets};
use super::sheet::{Anchor, Area, Look, Path, Sheet, Stroke, Style};
use super::skin::{Rings, Skin};
use super::theme::{Colour, HAIR, INK, TICK, WHITE, decimals, fixed, nice_step};
use crate::field::{ColourScale, Field, Fields};
use myospring_core::mesh::Mesh;
use myospring_core::mesh::outline::Outline;
use myospring_core::recording::Frame;

/// Number of steps of the colour scale; more cannot be distinguished.
pub(super) const COLOURS: usize = 64;

/// A cell as it is drawn: its outline, filled with the colours of a field.
#[derive(Debug, Clone)]
pub struct DrawnCell<'a> {
    fields: Fields<'a>,
    skin: Skin,
    field: Field,
    limits: Option<[f64; 2]>,
}

impl<'a> DrawnCell<'a> {
    /// A cell with its fields and its outline at rest, um, which moves with its lattice. Without an
    /// outline, or if its mesh is not a lattice, the rim of the mesh is drawn.
    ///
    /// # Errors
    /// A mesh without triangles, with positions that are not finite, or that refers to points it
    /// does not have.
    pub fn new(fields: Fields<'a>, outline: Option<&Outline>) -> Result<Self, FigureError> {
        let mesh = fields.mesh();
        check_mesh(mesh)?;
        if mesh.simplices.is_empty() {
            return Err(FigureError::Nothing { what: "triangles" });
        }
        let skin = Skin::new(mesh, &facets(mesh), outline);
        Ok(Self { fields, skin, field: Field::default(), limits: None })
    }

    /// Sets the field by which the cell is coloured; the default is the strain along the fibre.
    #[must_use]
    pub fn coloured_by(self, field: Field) -> Self {
        Self { field, limits: None, ..self }
    }

    /// Fixes one colour scale for all of these frames, whichever of them are drawn.
    #[must_use]
    pub fn scaled_to<'f>(self, frames: impl IntoIterator<Item = &'f Frame>) -> Self {
        let whole = frames.into_iter().filter(|frame| check_frame(self.mesh(), frame).is_ok());
        let limits = Some(self.fields.limits(self.field, whole));
        Self { limits, ..self }
    }

    pub(super) fn mesh(&self) -> &'a Mesh {
        self.fields.mesh()
    }

    /// The colour scale of some checked frames, or the fixed one.
    pub(super) fn colours<'f>(&self, frames: impl IntoIterator<Item = &'f Frame>) -> ColourScale {
        let limits = self.limits.unwrap_or_else(|| self.fields.limits(self.field, frames));
        ColourScale::new(self.field, limits)
    }

    /// Checks that positions fit the mesh and are finite.
    pub(super) fn check(&self, positions: &[Vec<f64>; 2]) -> Result<(), FigureError> {
        let positions = positions.clone();
        let frame = Frame::new(f64::NAN, f64::NAN, positions);
        check_frame(self.mesh(), &frame)
    }

    pub(super) fn rings(&self, positions: &[Vec<f64>; 2]) -> Rings {
        self.skin.rings(positions)
    }

    /// Fills the outline of a checked frame; `at` maps a point to the sheet.
    pub(super) fn fill(
        &self,
        sheet: &mut Sheet,
        name: String,
        frame: &Frame,
        colours: &ColourScale,
        at: impl Fn([f64; 2]) -> [f64; 2],
    ) {
        let values = self.fields.on_nodes(colours.field(), frame);
        self.fill_with(sheet, name, &frame.positions, &values, colours, at);
    }

    /// Fills the outline of checked positions with the colours of values at the points.
    pub(super) fn fill_with(
        &self,
        sheet: &mut Sheet,
        name: String,
        positions: &[Vec<f64>; 2],
        values: &[f64],
        colours: &ColourScale,
        at: impl Fn([f64; 2]) -> [f64; 2],
    ) {
        let rim = closed(&self.rings(positions), &at);
        let Some(area) = rim.bounds() else { return };
        let shaped = self.skin.shaped(positions, values);
        let [low, high] = colours.limits();
        let [least, greatest] = shaped.range();
        let colour = |step: usize| Colour::from_channels(colours.step(step, COLOURS));
        let part = ((least - low) / (high - low)).clamp(0.0, 1.0);
        let first = ((part * COLOURS as f64) as usize).min(COLOURS - 1);
        // Steps are drawn from the lowest on; each covers the previous ones where the field is
        // higher, so there are no seams.
        let mut inside = Sheet::default();
        inside.path(Path::rect(area), Look::fill(colour(first)));
        for step in first + 1..COLOURS {
            let level = colours.value(step as f64 / COLOURS as f64);
            if level >= greatest {
                break;
            }
            inside.path(closed(&shaped.above(level), &at), Look::fill(colour(step)));
        }
        sheet.window(name, rim, inside);
    }

    /// Hatches the outline of checked positions where values at the points are above a level.
    pub(super) fn hatch_above(
        &self,
        sheet: &mut Sheet,
        name: &str,
        positions: &[Vec<f64>; 2],
        (values, level): (&[f64], f64),
        at: impl Fn([f64; 2]) -> [f64; 2],
    ) {
        let rim = closed(&self.rings(positions), &at);
        let shaped = self.skin.shaped(positions, values);
        let [least, greatest] = shaped.range();
        if greatest <= level {
            return;
        }
        let above = if least > level { rim.clone() } else { closed(&shaped.above(level), &at) };
        let Some(area) = above.bounds() else { return };
        let mut lines = Sheet::default();
        // Colours of what is not known are not shown.
        lines.rect(area.corner, area.size, Look::fill(WHITE));
        lines.path(hatching(area), Stroke::new(INK, 0.7));
        let mut inside = Sheet::default();
        inside.window(format!("{name}-lines"), above, lines);
        sheet.window(name.to_owned(), rim, inside);
    }
}

/// Distance between hatching lines, px.
const HATCHED: f64 = 5.0;

/// Lines from the lower left to the upper right of an area.
fn hatching(Area { corner: [left, top], size: [width, height] }: Area) -> Path {
    let mut lines = Path::default();
    let count = ((width + height) / HATCHED).ceil() as usize;
    for at in (0..=count).map(|line| HATCHED * line as f64) {
        lines.add_line([[left + at - height, top + height], [left + at, top]]);
    }
    lines
}

/// Rings as a closed path on a sheet.
pub(super) fn closed(rings: &Rings, at: impl Fn([f64; 2]) -> [f64; 2]) -> Path {
    let mut path = Path::default();
    for ring in rings {
        path.add_ring(ring.iter().map(|&point| at(point)));
    }
    path
}

/// The colour bar of a field with its ticks below and its title above.
pub(super) fn draw_colour_bar(sheet: &mut Sheet, place: Area, colours: &ColourScale) {
    let field = colours.field();
    let unit = match field.unit() {
        "" => String::new(),
        "um" => " (\u{b5}m)".to_owned(),
        unit => format!(" ({unit})"),
    };
    draw_titled_bar(sheet, place, colours, &format!("{}{unit}", field.title()));
}

/// A colour bar with its ticks below and a title above.
pub(super) fn draw_titled_bar(sheet: &mut Sheet, place: Area, colours: &ColourScale, title: &str) {
    let Area { corner: [left, top], size: [width, height] } = place;
    let style = Style::new(TICK).anchor(Anchor::Middle);
    sheet.text([left + width / 2.0, top - 5.0], title, style);
    for step in 0..COLOURS {
        // Each step extends under the next ones, so that no seams show.
        let before = width * step as f64 / COLOURS as f64;
        let look = Look::fill(Colour::from_channels(colours.step(step, COLOURS)));
        sheet.rect([left + before, top], [width - before, height], look);
    }
    sheet.rect([left, top], [width, height], Stroke::new(INK, HAIR));
    let [low, high] = colours.limits();
    let step = nice_step(high - low, 5.0);
    let ticks = (low / step).ceil() as i64..=(high / step).floor() as i64;
    for value in ticks.map(|i| i as f64 * step) {
        let x = left + width * (value - low) / (high - low);
        let bottom = top + height;
        sheet.line([x, bottom], [x, bottom + 3.0], Stroke::new(INK, HAIR));
        sheet.text([x, bottom + 13.5], &fixed(value, decimals(step)), style);
    }
}
