//! A thick cell from above and from the side, and sections through its middle.

use super::cell::{COLOURS, draw_colour_bar};
use super::facets::{check_frame, check_mesh};
use super::moments::Shape;
use super::shapes::draw_scale_bar;
use super::sheet::{Anchor, Area, Look, Path, Sheet, Stroke, Style};
use super::slices::{Between, area, cut_mesh, cut_surface, silhouette};
use super::theme::{Colour, DOUBLE, INK, LABEL, LETTER, MUTED, REST, TICK, fixed, mm, time};
use super::{Figure, FigureError};
use crate::field::{ColourScale, Field, Fields};
use crate::surface::{SmoothSurface, unit};
use std::collections::BTreeMap;

const MARGIN: f64 = 8.0;
const GAP: f64 = 16.0;
/// Height of the heads of columns and of the line above each view, px.
const HEAD: f64 = 34.0;
const TITLE: f64 = 19.0;
/// Greatest height of all views together, px.
const TALLEST: f64 = mm(180.0);
/// Points of a surface that is drawn with all of them.
const FINE: usize = 2500;
/// Where light comes from: right, up, towards the viewer; and the light of what it does not reach.
const LIGHT: [f64; 3] = [-0.3, 0.5, 0.812];
const SHADE: f64 = 0.72;
/// How far a section lies from the middle, of the spacing, so that it meets no node.
const ASIDE: f64 = 1e-6;

/// A thick cell as it is drawn: its surface and sections, coloured by a field.
#[derive(Debug, Clone)]
pub struct DrawnThickCell<'a> {
    fields: Fields<'a, 3, 4>,
    surface: SmoothSurface,
    field: Field,
    long_axis: [f64; 2],
}

impl<'a> DrawnThickCell<'a> {
    /// A cell with its fields and the direction of its long axis seen from above, of any length. It is
    /// coloured by the strain along the fibre.
    ///
    /// # Errors
    /// A mesh without cubes, with positions that are not finite, or that refers to points it does not
    /// have.
    pub fn new(fields: Fields<'a, 3, 4>, long_axis: [f64; 2]) -> Result<Self, FigureError> {
        check_mesh(fields.mesh())?;
        let finest = SmoothSurface::new(fields.mesh()).ok_or(FigureError::NoCubes)?;
        let by = (finest.len() as f64 / FINE as f64).sqrt().ceil().max(1.0) as u32;
        let surface = finest.coarser(by);
        Ok(Self { fields, surface, field: Field::default(), long_axis: unit(long_axis) })
    }

    /// Sets the field by which the cell is coloured, one of [`Field::THICK`].
    #[must_use]
    pub fn coloured_by(self, field: Field) -> Self {
        Self { field, ..self }
    }

    /// A point along the long axis, across it, and upward, um.
    fn turned(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [cos, sin] = self.long_axis;
        [x * cos + y * sin, y * cos - x * sin, z]
    }

    fn placed(&self, positions: &[Vec<f64>; 3], values: Vec<f64>) -> Placed {
        let [xs, ys, zs] = positions;
        let nodes = xs.iter().zip(ys).zip(zs).map(|((x, y), z)| self.turned([*x, *y, *z]));
        let points = self.surface.positions(positions).into_iter();
        Placed {
            nodes: nodes.collect(),
            points: points.map(|point| self.turned(point)).collect(),
            on_points: self.surface.means(&values),
            values,
        }
    }
}

/// A cell at one time, along its own axes, um.
struct Placed {
    nodes: Vec<[f64; 3]>,
    /// Points of the surface.
    points: Vec<[f64; 3]>,
    /// Of the field, at the nodes and at the points of the surface.
    values: Vec<f64>,
    on_points: Vec<f64>,
}

/// What is seen of a cell: which of its axes (length, width, thickness) runs to the right and which upward.
struct View {
    title: &'static str,
    right: usize,
    up: usize,
    /// The axis across which it is cut.
    cut: Option<usize>,
}

const VIEWS: [View; 4] = [
    View { title: "from above", right: 0, up: 1, cut: None },
    View { title: "from the side", right: 0, up: 2, cut: None },
    View { title: "section along the middle", right: 0, up: 2, cut: Some(1) },
    View { title: "section across the middle", right: 1, up: 2, cut: Some(0) },
];

/// Draws a thick cell from above, from the side, and in sections along and across its long axis through
/// the middle, at each of some times (at most four) side by side: as a rule at rest and at its largest
/// shortening. All views have one scale and one colour scale; two columns wide (178 mm).
///
/// The surface is smoothed over the steps of the cubes. A section shows the same part of the cell at
/// every time. The dashed line is the cell at rest.
///
/// # Errors
/// No shape, or a frame of another mesh or with positions that are not finite.
///
/// # Example
/// ```
/// use myospring::mesh::cubes;
/// use myospring::output::field::Fields;
/// use myospring::output::figure::{DrawnThickCell, Shape, thick_cell};
/// use myospring::recording::Frame;
/// let mesh = cubes::block([24, 8, 4], 2.0)?;
/// let fibres = vec![[1.0, 0.0, 0.0]; mesh.simplices.len()];
/// let cell = DrawnThickCell::new(Fields::new(&mesh, &fibres, None)?, [1.0, 0.0])?;
/// let stretches = [0.88, 1.066, 1.066];
/// let positions = [0, 1, 2].map(|axis: usize| mesh.points[axis].iter().map(|x| stretches[axis] * x).collect());
/// let peak = Frame::new(171.0, 50.0, positions);
/// let shape = Shape { name: "peak".to_owned(), frame: &peak, shortening_pct: Some(12.0) };
/// assert!(thick_cell(&cell, &[shape])?.to_svg().contains("section across the middle"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn thick_cell(
    cell: &DrawnThickCell<'_>,
    shapes: &[Shape<'_, 3>],
) -> Result<Figure, FigureError> {
    if shapes.is_empty() {
        return Err(FigureError::Nothing { what: "frames" });
    }
    let mesh = cell.fields.mesh();
    for shape in shapes {
        check_frame(mesh, shape.frame)?;
    }
    let placed: Vec<Placed> = shapes
        .iter()
        .map(|shape| {
            let values = cell.fields.on_nodes(cell.field, shape.frame);
            cell.placed(&shape.frame.positions, values)
        })
        .collect();
    let rest = cell.placed(&mesh.points, vec![0.0; mesh.len()]);
    let all = || placed.iter().chain([&rest]).flat_map(|placed| &placed.points);
    let low = [0, 1, 2].map(|axis: usize| all().fold(f64::INFINITY, |low, at| low.min(at[axis])));
    let high =
        [0, 1, 2].map(|axis: usize| all().fold(f64::NEG_INFINITY, |high, at| high.max(at[axis])));
    let extent = [0, 1, 2].map(|axis: usize| (high[axis] - low[axis]).max(1e-9));

    // A single shape is drawn no larger than two would be.
    let columns = shapes.len().max(2) as f64;
    let width = (DOUBLE - 2.0 * MARGIN - (columns - 1.0) * GAP) / columns;
    let widest = VIEWS.iter().map(|view| extent[view.right]).fold(0.0, f64::max);
    let tall: f64 = VIEWS.iter().map(|view| extent[view.up]).sum();
    let scale = (width / widest).min(TALLEST / tall);
    let limits = cell.field.limits(placed.iter().flat_map(|placed| placed.values.iter().copied()));
    let drawing = Drawing {
        cell,
        rest: &rest,
        colours: ColourScale::new(cell.field, limits),
        middle: [0, 1, 2].map(|axis: usize| f64::midpoint(low[axis], high[axis])),
        scale,
    };
    let mut sheet = Sheet::default();
    let left = |column: usize| MARGIN + column as f64 * (width + GAP);
    for (column, shape) in shapes.iter().enumerate() {
        draw_head(&mut sheet, shape, left(column));
    }
    let mut top = HEAD;
    for (row, view) in VIEWS.iter().enumerate() {
        let letter = char::from(b'A' + row as u8).to_string();
        sheet.text([MARGIN, top + 11.0], &letter, Style::new(LETTER).bold());
        sheet.text([MARGIN + 16.0, top + 11.0], view.title, Style::new(TICK).colour(MUTED));
        let height = extent[view.up] * scale;
        for (column, placed) in placed.iter().enumerate() {
            let centre = [left(column) + width / 2.0, top + TITLE + height / 2.0];
            drawing.draw(&mut sheet, view, placed, (centre, &format!("{row}-{column}")));
        }
        top += TITLE + height + 6.0;
    }
    draw_scale_bar(&mut sheet, [MARGIN, top + 26.0], scale, [extent[0], extent[1]]);
    let bar = Area { corner: [DOUBLE - MARGIN - 228.0, top + 22.0], size: [220.0, 8.0] };
    draw_colour_bar(&mut sheet, bar, &drawing.colours);
    Ok(sheet.finish(DOUBLE, top + 50.0))
}

/// Name, time and shortening above a column.
fn draw_head(sheet: &mut Sheet, shape: &Shape<'_, 3>, left: f64) {
    sheet.text([left, 14.0], &shape.name, Style::new(LABEL).bold());
    let shortening = shape.shortening_pct.map(|part| format!("shortening {} %", fixed(part, 1)));
    let moment = Some(shape.frame.t_ms).filter(|t_ms| !t_ms.is_nan()).map(time);
    let facts = moment.into_iter().chain(shortening).collect::<Vec<_>>().join(", ");
    sheet.text([left, 27.0], &facts, Style::new(TICK).colour(MUTED).anchor(Anchor::Start));
}

/// What all views share.
struct Drawing<'a> {
    cell: &'a DrawnThickCell<'a>,
    rest: &'a Placed,
    colours: ColourScale,
    /// Of the box around all shapes, um.
    middle: [f64; 3],
    /// px in um.
    scale: f64,
}

impl Drawing<'_> {
    fn draw(&self, sheet: &mut Sheet, view: &View, now: &Placed, (centre, name): ([f64; 2], &str)) {
        let at = |point: [f64; 3]| {
            let [right, up] = [view.right, view.up].map(|axis| point[axis] - self.middle[axis]);
            [centre[0] + right * self.scale, centre[1] - up * self.scale]
        };
        let (rim, rest) = match view.cut {
            None => {
                self.fill_surface(sheet, view, now, at);
                [now, self.rest].map(|placed| self.seen(view, placed, at)).into()
            }
            Some(axis) => {
                let section = Section::new(self, axis);
                let [rim, rest] = [now, self.rest].map(|placed| section.rim(&placed.points, at));
                section.fill(sheet, name, now, (rim.clone(), at));
                (rim, rest)
            }
        };
        sheet.path(rim, Stroke::new(INK, 0.7));
        let away = |(now, rest): (&[f64; 3], &[f64; 3])| {
            let [now, rest] = [*now, *rest].map(at);
            (now[0] - rest[0]).hypot(now[1] - rest[1]) > 0.5
        };
        if now.points.iter().zip(&self.rest.points).any(away) {
            sheet.path(rest, Stroke::new(REST, 0.8).dash(2.5, 1.8));
        }
    }

    /// The line around a surface.
    fn seen(&self, view: &View, placed: &Placed, at: impl Fn([f64; 3]) -> [f64; 2]) -> Path {
        let point = |point: u32| placed.points[point as usize];
        let flat = |index: u32| [view.right, view.up].map(|axis| point(index)[axis]);
        let mut path = Path::default();
        path.add_ring(silhouette(&self.cell.surface, flat).into_iter().map(|[right, up]| {
            let mut place = [0.0; 3];
            (place[view.right], place[view.up]) = (right, up);
            at(place)
        }));
        path
    }

    /// Patches that face the viewer, from far to near, darker where they face the light less.
    fn fill_surface(
        &self,
        sheet: &mut Sheet,
        view: &View,
        now: &Placed,
        at: impl Fn([f64; 3]) -> [f64; 2],
    ) {
        let toward = 3 - view.right - view.up;
        // Right, up and towards the viewer are right-handed: from the side he stands where the width begins.
        let sign = if (view.right + 1) % 3 == view.up { 1.0 } else { -1.0 };
        let seen = |point: u32| {
            let place = now.points[point as usize];
            [place[view.right], place[view.up], sign * place[toward]]
        };
        let quads = self.cell.surface.quads().iter();
        let facing = quads.filter(|quad| area(&quad.map(|p| [seen(p)[0], seen(p)[1]])) > 0.0);
        let mut facing: Vec<(f64, &[u32; 4])> =
            facing.map(|quad| (quad.iter().map(|&p| seen(p)[2]).sum(), quad)).collect();
        facing.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, quad) in facing {
            let value = quad.iter().map(|&p| now.on_points[p as usize]).sum::<f64>() / 4.0;
            let light = SHADE + (1.0 - SHADE) * lit(quad.map(seen));
            let shaded = |channel: u8| (f64::from(channel) * light).round() as u8;
            let colour = Colour::from_channels(self.colours.colour(value).map(shaded));
            let mut patch = Path::default();
            patch.add_ring(quad.iter().map(|&p| at(now.points[p as usize])));
            sheet.path(patch, Look::fill(colour).stroke(Stroke::new(colour, 0.7)));
        }
    }
}

/// How much a patch faces the light, 0 to 1.
fn lit([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
    let diagonal =
        |from: [f64; 3], to: [f64; 3]| [0, 1, 2].map(|axis: usize| to[axis] - from[axis]);
    let (u, v) = (diagonal(a, c), diagonal(b, d));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let [length, along] =
        [normal, LIGHT].map(|other| normal.iter().zip(other).map(|(x, y)| x * y).sum::<f64>());
    if length > 0.0 { (along / length.sqrt()).max(0.0) } else { 0.0 }
}

/// A section through the middle of the cell at rest.
struct Section<'a> {
    drawing: &'a Drawing<'a>,
    rings: Vec<Vec<Between>>,
    polygons: Vec<Vec<Between>>,
}

impl<'a> Section<'a> {
    fn new(drawing: &'a Drawing<'a>, axis: usize) -> Self {
        let Drawing { cell: DrawnThickCell { fields, surface, .. }, rest, .. } = drawing;
        let ends = rest.nodes.iter().map(|node| node[axis]);
        let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
            [low.min(at), high.max(at)]
        });
        let level = f64::midpoint(low, high) + ASIDE * surface.spacing();
        let heights = |places: &[[f64; 3]]| -> Vec<f64> {
            places.iter().map(|place| place[axis] - level).collect()
        };
        Self {
            drawing,
            rings: cut_surface(surface, &heights(&rest.points)),
            polygons: cut_mesh(fields.mesh(), &heights(&rest.nodes)),
        }
    }

    fn rim(&self, points: &[[f64; 3]], at: impl Fn([f64; 3]) -> [f64; 2]) -> Path {
        let mut path = Path::default();
        for ring in &self.rings {
            path.add_ring(ring.iter().map(|place| at(placed(*place, points))));
        }
        path
    }

    /// Fills the rim with the colours of the polygons in it.
    fn fill(
        &self,
        sheet: &mut Sheet,
        name: &str,
        now: &Placed,
        (rim, at): (Path, impl Fn([f64; 3]) -> [f64; 2]),
    ) {
        let colours = &self.drawing.colours;
        let [low, high] = colours.limits();
        let mut steps: BTreeMap<usize, Path> = BTreeMap::new();
        for polygon in &self.polygons {
            let values = polygon.iter().map(|place| place.of(|node| now.values[node]));
            let value = values.sum::<f64>() / polygon.len() as f64;
            let part = (COLOURS as f64 * (value - low) / (high - low)).max(0.0);
            let path = steps.entry((part as usize).min(COLOURS - 1)).or_default();
            path.add_ring(polygon.iter().map(|place| at(placed(*place, &now.nodes))));
        }
        // The smooth rim lies up to a cube outside of the polygons: their colours reach there.
        let wide = 2.0 * self.drawing.cell.surface.spacing() * self.drawing.scale;
        let mut inside = Sheet::default();
        for width in [wide, 0.4] {
            for (&step, path) in &steps {
                let colour = Colour::from_channels(colours.step(step, COLOURS));
                inside.path(path.clone(), Look::fill(colour).stroke(Stroke::new(colour, width)));
            }
        }
        sheet.window(format!("section-{name}"), rim, inside);
    }
}

fn placed(place: Between, points: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|axis: usize| place.of(|point| points[point][axis]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use myospring_core::mesh::cubes;
    use myospring_core::recording::Frame;

    #[test]
    fn views_and_sections_have_their_size_to_one_scale_whatever_the_cells() {
        for (cubes, spacing) in [([30, 8, 4], 2.0), ([12, 12, 12], 1.0), ([6, 20, 3], 4.0)] {
            let mesh = cubes::block(cubes, spacing).unwrap();
            let fibres = vec![[1.0, 0.0, 0.0]; mesh.simplices.len()];
            let fields = Fields::new(&mesh, &fibres, None).unwrap();
            let cell = DrawnThickCell::new(fields, [-2.0, 0.0]).unwrap();
            let rest = cell.placed(&mesh.points, vec![0.0; mesh.len()]);
            let drawing = Drawing {
                cell: &cell,
                rest: &rest,
                colours: ColourScale::new(Field::FibreStrain, [-12.0, 0.0]),
                middle: [0.0; 3],
                scale: 3.0,
            };
            for view in VIEWS {
                let at = |point: [f64; 3]| [view.right, view.up].map(|axis| 3.0 * point[axis]);
                let rim = match view.cut {
                    None => drawing.seen(&view, &rest, at),
                    Some(axis) => Section::new(&drawing, axis).rim(&rest.points, at),
                };
                let size = rim.bounds().unwrap().size;
                for (found, axis) in size.into_iter().zip([view.right, view.up]) {
                    let whole = 3.0 * spacing * cubes[axis] as f64;
                    // The rims of a block are rounded.
                    assert!(
                        (found - whole).abs() < 3.0 * spacing,
                        "{}: {found}, {whole}",
                        view.title
                    );
                }
            }
        }
    }

    #[test]
    fn a_cell_without_cubes_or_shapes_is_refused() {
        let mut mesh = cubes::block([4, 2, 2], 2.0).unwrap();
        let fibres = vec![[1.0, 0.0, 0.0]; mesh.simplices.len()];
        let cell = DrawnThickCell::new(Fields::new(&mesh, &fibres, None).unwrap(), [1.0, 0.0]);
        let nothing = FigureError::Nothing { what: "frames" };
        assert_eq!(thick_cell(&cell.unwrap(), &[]).unwrap_err(), nothing);
        let frame = Frame::new(5.0, 0.0, [vec![0.0], vec![0.0], vec![f64::NAN]]);
        let cell = DrawnThickCell::new(Fields::new(&mesh, &fibres, None).unwrap(), [1.0, 0.0]);
        let shape = Shape { name: String::new(), frame: &frame, shortening_pct: None };
        let error = thick_cell(&cell.unwrap(), &[shape]).unwrap_err();
        assert!(matches!(error, FigureError::WrongMesh { axis: 0, found: 1, points: 45, .. }));
        mesh.lattice = None;
        let fields = Fields::new(&mesh, &fibres, None).unwrap();
        assert_eq!(DrawnThickCell::new(fields, [1.0, 0.0]).unwrap_err(), FigureError::NoCubes);
    }
}
