//! Measures of a mesh, and its report.

use std::fmt;

use serde::Serialize;

use super::Mesh;
use super::outline::Outline;

/// The long axis of a cell: the unit vector along which its area spreads most.
///
/// It is the principal axis of the area's second moments, at the angle
/// `theta = atan2(2 M_xy, M_xx - M_yy) / 2` from x, and points to positive x (to positive y when it
/// is vertical). A shape without a long axis, such as a circle or a square, gives `[1, 0]`.
///
/// # Example
/// ```
/// use myospring::mesh::{lattice, quality};
/// let strip = lattice::rectangle(2, 30, 1.0).unwrap();
/// assert_eq!(quality::long_axis(&strip), [0.0, 1.0]);
/// ```
pub fn long_axis(mesh: &Mesh) -> [f64; 2] {
    let centre = mesh.centroid();
    let [mut xx, mut yy, mut xy] = [0.0; 3];
    for (node, area) in mesh.areas.iter().enumerate() {
        let [x, y] = mesh.point(node);
        let (dx, dy) = (x - centre[0], y - centre[1]);
        xx += area * dx * dx;
        yy += area * dy * dy;
        xy += area * dx * dy;
    }
    principal_axis(xx, yy, xy)
}

/// Principal axis of second moments, oriented as in [`long_axis`].
pub(super) fn principal_axis(xx: f64, yy: f64, xy: f64) -> [f64; 2] {
    // Rounding of the sums, well below any anisotropy that a picture can show.
    const ROUND: f64 = 1e-9;
    if (xx - yy).hypot(2.0 * xy) <= ROUND * (xx + yy) {
        return [1.0, 0.0];
    }
    if xy.abs() <= ROUND * (xx + yy) {
        return if xx > yy { [1.0, 0.0] } else { [0.0, 1.0] };
    }
    let theta = 0.5 * (2.0 * xy).atan2(xx - yy);
    [theta.cos(), theta.sin()]
}

/// Extent of a mesh along a unit vector, um: `max(X . a) - min(X . a)` over its points.
///
/// # Example
/// ```
/// use myospring::mesh::{lattice, quality};
/// let strip = lattice::rectangle(30, 2, 1.5).unwrap();
/// assert_eq!(quality::extent(&strip, [1.0, 0.0]), 45.0);
/// assert_eq!(quality::extent(&strip, [0.0, 1.0]), 3.0);
/// ```
pub fn extent(mesh: &Mesh, axis: [f64; 2]) -> f64 {
    extent_along((0..mesh.len()).map(|node| mesh.point(node)), axis)
}

pub(super) fn extent_along(points: impl Iterator<Item = [f64; 2]>, axis: [f64; 2]) -> f64 {
    let (low, high) = points
        .map(|point| point[0] * axis[0] + point[1] * axis[1])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    high - low
}

/// Size of a cell at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Dimensions {
    /// Extent along the long axis, end to end, um.
    pub length_um: f64,
    /// Largest extent across the long axis, um.
    pub width_um: f64,
    /// Area divided by length, um: the usual definition of width for an irregular cell.
    pub mean_width_um: f64,
    /// Length divided by mean width.
    pub aspect_ratio: f64,
    /// Long axis, degrees counter-clockwise from x, above -90 and up to 90.
    pub long_axis_deg: f64,
}

/// Measures a mesh along and across its [`long_axis`].
///
/// # Example
/// ```
/// use myospring::mesh::{lattice, quality};
/// let size = quality::dimensions(&lattice::rectangle(70, 10, 2.0).unwrap());
/// assert_eq!((size.length_um, size.width_um, size.aspect_ratio), (140.0, 20.0, 7.0));
/// ```
pub fn dimensions(mesh: &Mesh) -> Dimensions {
    let axis = long_axis(mesh);
    let length_um = extent(mesh, axis);
    let mean_width_um = mesh.area() / length_um;
    Dimensions {
        length_um,
        width_um: extent(mesh, [-axis[1], axis[0]]),
        mean_width_um,
        aspect_ratio: length_um / mean_width_um,
        long_axis_deg: axis[1].atan2(axis[0]).to_degrees(),
    }
}

/// Measures an outline along and across the principal axis of its area, like [`dimensions`] for a
/// mesh.
///
/// # Example
/// ```
/// use myospring::mesh::{built_in, quality};
/// let size = quality::outline_dimensions(&built_in::adult_ventricular());
/// assert_eq!(size.length_um.round(), 140.0);
/// ```
pub fn outline_dimensions(outline: &Outline) -> Dimensions {
    let [xx, yy, xy] = outline.second_moments();
    let axis = principal_axis(xx, yy, xy);
    let along = |axis| extent_along(outline.exterior().iter().copied(), axis);
    let length_um = along(axis);
    let mean_width_um = outline.area() / length_um;
    Dimensions {
        length_um,
        width_um: along([-axis[1], axis[0]]),
        mean_width_um,
        aspect_ratio: length_um / mean_width_um,
        long_axis_deg: axis[1].atan2(axis[0]).to_degrees(),
    }
}

/// Report on a mesh made from a picture or outline; prints as a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshReport {
    /// Point masses.
    pub masses: usize,
    /// Springs.
    pub springs: usize,
    /// Triangles, of both diagonals of every square.
    pub triangles: usize,
    /// Filled lattice squares.
    pub squares: usize,
    /// Lattice spacing, um.
    pub spacing_um: f64,
    /// Area of the mesh, um^2.
    pub area_um2: f64,
    /// Area of the cell in the mask (its largest island) or outline, um^2.
    pub source_area_um2: f64,
    /// Mesh area above the source's, per cent of the latter.
    pub area_error_pct: f64,
    /// Length, width and long axis.
    #[serde(flatten)]
    pub dimensions: Dimensions,
    /// Thickness of a thick cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thick: Option<ThickReport>,
    /// Number of pixels of other islands, which were left out.
    pub dropped_pixels: usize,
    /// Number of other islands, which were left out.
    pub dropped_components: usize,
    /// Number of squares left out because no side connects them to the rest.
    pub dropped_squares: usize,
    /// Whether the cell reaches the frame of the picture.
    pub touches_frame: bool,
    /// Warnings; empty if nothing is unusual.
    pub warnings: Vec<String>,
}

/// What a mesh says of the thickness of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ThickReport {
    /// Number of cubes.
    pub cubes: usize,
    /// Cubes across the thickness, where it is greatest.
    pub layers: usize,
    /// Their height, um.
    pub thickness_um: f64,
    /// Volume of the mesh, um^3.
    pub volume_um3: f64,
    /// Volume of the cell, um^3.
    pub source_volume_um3: f64,
    /// Deviation of the first from the second, per cent.
    pub volume_error_pct: f64,
    /// Number of cubes left out because no face connects them to the rest.
    pub dropped_cubes: usize,
}

impl ThickReport {
    fn rows(&self) -> [ReportRow; 7] {
        let Self { cubes, layers, thickness_um, .. } = self;
        [
            ("cubes", cubes.to_string(), ""),
            ("cubes in thickness", layers.to_string(), ""),
            ("thickness, greatest", format!("{thickness_um:.2}"), "um"),
            ("volume", format!("{:.1}", self.volume_um3), "um^3"),
            ("volume of the source", format!("{:.1}", self.source_volume_um3), "um^3"),
            ("volume error", format!("{:+.2}", self.volume_error_pct + 0.0), "%"),
            ("dropped cubes", self.dropped_cubes.to_string(), ""),
        ]
    }
}

/// A line of a report: name, value, unit.
pub type ReportRow = (&'static str, String, &'static str);

impl Dimensions {
    /// Lines of a report, in the order of the fields.
    pub fn rows(&self) -> [ReportRow; 5] {
        let Self { length_um, width_um, mean_width_um, aspect_ratio, long_axis_deg } = self;
        [
            ("length", format!("{length_um:.1}"), "um"),
            ("width, largest", format!("{width_um:.1}"), "um"),
            ("width, mean", format!("{mean_width_um:.1}"), "um"),
            ("length / mean width", format!("{aspect_ratio:.2}"), ""),
            ("long axis", format!("{:.1}", long_axis_deg + 0.0), "deg"),
        ]
    }
}

/// Writes rows with right-aligned values, and the warnings below.
///
/// # Errors
/// Errors of the formatter.
pub fn write_report(
    out: &mut fmt::Formatter<'_>,
    rows: impl IntoIterator<Item = ReportRow>,
    warnings: &[String],
) -> fmt::Result {
    let rows: Vec<ReportRow> = rows.into_iter().collect();
    let widest = rows.iter().map(|row| row.1.len()).max().unwrap_or(0);
    for (index, (name, value, unit)) in rows.iter().enumerate() {
        let line = format!("{name:<20} {value:>widest$} {unit}");
        let end = if index + 1 < rows.len() { "\n" } else { "" };
        write!(out, "{}{end}", line.trim_end())?;
    }
    for warning in warnings {
        write!(out, "\nwarning: {warning}")?;
    }
    Ok(())
}

impl fmt::Display for MeshReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let before = [
            ("masses", self.masses.to_string(), ""),
            ("springs", self.springs.to_string(), ""),
            ("triangles", self.triangles.to_string(), ""),
            ("squares", self.squares.to_string(), ""),
            ("spacing", self.spacing_um.to_string(), "um"),
        ];
        let after = [
            ("area", format!("{:.1}", self.area_um2), "um^2"),
            ("area of the source", format!("{:.1}", self.source_area_um2), "um^2"),
            ("area error", format!("{:+.2}", self.area_error_pct + 0.0), "%"),
            ("dropped islands", self.dropped_components.to_string(), ""),
            ("dropped pixels", self.dropped_pixels.to_string(), ""),
            ("dropped squares", self.dropped_squares.to_string(), ""),
            ("touches the frame", if self.touches_frame { "yes" } else { "no" }.to_owned(), ""),
        ];
        let thick = self.thick.iter().flat_map(ThickReport::rows);
        write_report(
            out,
            before.into_iter().chain(self.dimensions.rows()).chain(thick).chain(after),
            &self.warnings,
        )
    }
}
