//! Why data are not a valid outline.

/// Smallest area that an outline may have, um^2.
pub const SMALLEST_AREA_UM2: f64 = 1.0;

/// Largest extent that an outline may have, um.
pub const LARGEST_EXTENT_UM: f64 = 10_000.0;

/// Remark on a list of points that seems to be a curve in time.
pub(super) const CURVE: &str = ": this seems to be a curve in time, such as a contraction, not an outline of a \
                                cell; `myospring analyse` reads curves";

/// Why a text or a list of points is not the outline of a cell.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OutlineError {
    /// The text is not GeoJSON.
    #[error("the outline is not GeoJSON: {reason}")]
    NotGeoJson {
        /// What the parser says.
        reason: String,
    },
    /// The GeoJSON has no polygon, or several.
    #[error("the GeoJSON has {found} polygons ({kinds}); exactly one, the cell, is needed")]
    NotOnePolygon {
        /// How many polygons.
        found: usize,
        /// The kinds of geometry in it.
        kinds: String,
    },
    /// The GeoJSON says that its coordinates are not micrometres.
    #[error("the outline's property `unit` is \"{unit}\", but coordinates must be in \"um\"")]
    Unit {
        /// What it says.
        unit: String,
    },
    /// The header of a list names other columns than x and y.
    #[error(
        "its columns are {columns}{curve}; a list of points of an outline has the columns x_um,y_um, one point a \
         line, in um, around the cell"
    )]
    Columns {
        /// Their names.
        columns: String,
        /// What the file seems to be instead; empty if that is not clear.
        curve: &'static str,
    },
    /// The points run in one direction and do not come back.
    #[error(
        "x only grows or only falls along its {points} points{CURVE}; the points of an outline go around the cell"
    )]
    OneWay {
        /// How many points there are.
        points: usize,
    },
    /// A line of the list of points is not two numbers.
    #[error(
        "line {line} of the list of points is `{text}`; two numbers, x and y in um, are needed"
    )]
    NotAPoint {
        /// Line number, 1 is the first.
        line: usize,
        /// The line.
        text: String,
    },
    /// A coordinate that is not finite.
    #[error("point {point} of the outline's {ring} is ({x}, {y}) um; coordinates must be finite")]
    NotFinite {
        /// Which ring: exterior or hole.
        ring: &'static str,
        /// Which of its points, 0 is the first.
        point: usize,
        /// x, um.
        x: f64,
        /// y, um.
        y: f64,
    },
    /// Too few different points.
    #[error("the outline's {ring} has {found} different points; at least 3 are needed")]
    TooFewPoints {
        /// Which ring: exterior or hole.
        ring: &'static str,
        /// How many there are.
        found: usize,
    },
    /// No area, or almost none.
    #[error(
        "the outline has an area of {area} um^2, less than {SMALLEST_AREA_UM2} um^2: coordinates \
         must be in micrometres and go around the cell"
    )]
    TooSmall {
        /// Its area, um^2.
        area: f64,
    },
    /// Larger than any heart cell.
    #[error(
        "the outline is {extent} um long, more than {LARGEST_EXTENT_UM} um: coordinates must be in \
         micrometres"
    )]
    TooLarge {
        /// Its extent, um.
        extent: f64,
    },
    /// Two edges cross.
    #[error("the outline crosses or touches itself{place}: its edges must go once around the cell")]
    SelfIntersecting {
        /// Where, if it was found: ` at (x, y) um`.
        place: String,
    },
    /// A hole that is not inside the exterior, or holes that overlap.
    #[error("the outline's holes must lie inside it and must not overlap: {reason}")]
    Holes {
        /// What is wrong.
        reason: String,
    },
}
