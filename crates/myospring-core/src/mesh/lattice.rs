//! Turns a mask or outline into a Moore lattice of masses and springs.
//!
//! A cell is filled with lattice **squares** of side `h`. The exact fraction of each square that
//! lies inside the cell is computed, and the most covered squares are kept, as many as give the
//! mesh the cell's area; the threshold is near one half. Squares not connected to the largest piece
//! by a side are dropped and counted. Two squares of one piece may still share only a corner; the
//! mesh then has a hinge of one node, which does no harm, since both squares are connected
//! elsewhere.
//!
//! A square contributes four nodes with a quarter of its area each, four sides (axial springs), two
//! diagonals, and four triangles (both ways of halving it, each with weight 1/2). A side between
//! two squares is one spring of share 1, a side on the rim one of share 1/2. Hence every node has
//! at least three springs.
//!
//! # Order, guaranteed
//! Nodes run row by row, x fastest, from the bottom. Springs run by direction, east, north,
//! north-east, north-west; triangles by type; within each, row by row. The force kernels use the
//! long runs of neighbours in these lists. A spring's first node is the one in the lower row (the
//! left one if both are in one row).

use super::coverage::{Grid, Shape, Source};
use super::mask::Mask;
use super::outline::Outline;
use super::quality::{MeshReport, dimensions};
use super::selection::choose;
use super::{Lattice, Mesh, MeshError, Simplex, Spring, SpringKind};

/// Number of masses that the default spacing aims at.
pub const DEFAULT_MASSES: usize = 2_000;

/// Largest number of masses. A mesh takes 1.6 kB of memory for each, a run 3 to 5 kB.
pub const MOST_MASSES: usize = 2_500_000;

/// Least number of pixels of a cell.
pub const FEWEST_PIXELS: usize = 25;

/// Area error above which the report warns, per cent.
pub const AREA_WARNING_PCT: f64 = 1.0;

/// Area error above which there is no mesh, per cent.
pub const AREA_BOUND_PCT: f64 = 10.0;

/// Largest number of squares in the bounding box, so that a thin slanted cell cannot exhaust the
/// memory.
const MOST_SQUARES: f64 = 4e7;

/// Why a mask or outline cannot be meshed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// The spacing is not a positive number.
    #[error("spacing {spacing} um is not a positive length; leave it out for {default} um")]
    Spacing {
        /// The given spacing, um.
        spacing: f64,
        /// The default spacing of this cell, um.
        default: f64,
    },
    /// Too few squares across the cell.
    #[error(
        "spacing {spacing} um exceeds {bound:.3} um, a third of the cell's width of {width:.3} um; \
         give less, or leave it out for {default} um"
    )]
    TooCoarse {
        /// The given spacing, um.
        spacing: f64,
        /// Largest spacing, um.
        bound: f64,
        /// Extent of the cell across its long axis, um.
        width: f64,
        /// The default spacing of this cell, um.
        default: f64,
    },
    /// Too many masses.
    #[error(
        "spacing {spacing:?} um would give about {masses:.1e} masses, more than {bound}; give more than \
         {smallest:.2} um, or leave it out for {default} um"
    )]
    TooFine {
        /// The given spacing, um.
        spacing: f64,
        /// Approximate number of masses.
        masses: f64,
        /// Largest number of masses.
        bound: usize,
        /// Approximate smallest possible spacing, um.
        smallest: f64,
        /// The default spacing of this cell, um.
        default: f64,
    },
    /// The cell in the mask is too small.
    #[error(
        "the cell has only {pixels} pixels ({area:.3} um^2); at least {bound} are needed: is this \
         the right mask and label?"
    )]
    TooSmall {
        /// Pixels of the largest island.
        pixels: usize,
        /// Their area, um^2.
        area: f64,
        /// Number of pixels needed.
        bound: usize,
    },
    /// The squares are too coarse for the cell's shape.
    #[error(
        "spacing {spacing} um is too coarse for this shape: the mesh has {area:.1} um^2 where the \
         cell has {source_area:.1} um^2, off by more than {bound} %; give less"
    )]
    AreaLost {
        /// Spacing, um.
        spacing: f64,
        /// Area of the mesh, um^2.
        area: f64,
        /// Area of the cell, um^2.
        source_area: f64,
        /// Largest error, per cent.
        bound: f64,
    },
    /// The thickness is not a positive number.
    #[error("a thickness of {thickness} um is not a positive length")]
    Thickness {
        /// The given thickness, um.
        thickness: f64,
    },
    /// Voxels that have no outline seen from above.
    #[error("seen from above the cell has no outline: {0}")]
    Above(String),
    /// Not a single cube across the thickness.
    #[error(
        "spacing {spacing} um exceeds the cell's thickness of {thickness} um; give less, or leave it out for {default} um"
    )]
    TooThin {
        /// The given spacing, um.
        spacing: f64,
        /// The greatest thickness, um.
        thickness: f64,
        /// The default spacing of this cell, um.
        default: f64,
    },
    /// The cubes are too coarse for the cell's shape.
    #[error(
        "spacing {spacing} um is too coarse for this shape: the mesh has {volume:.1} um^3 where the cell has {source_volume:.1} um^3, off \
         by more than {bound} %; give less"
    )]
    VolumeLost {
        /// Spacing, um.
        spacing: f64,
        /// Volume of the mesh, um^3.
        volume: f64,
        /// Volume of the cell, um^3.
        source_volume: f64,
        /// Largest error, per cent.
        bound: f64,
    },
    /// The squares are not a valid mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// The spacing, um, at which an area of `area_um2` contains about `masses` masses: `h = sqrt(A /
/// masses)`, rounded up to two digits (the rim has more masses than squares).
///
/// # Example
/// ```
/// use myospring::mesh::lattice::default_spacing;
/// assert_eq!(default_spacing(2600.0, 2000), 1.2);
/// assert_eq!(default_spacing(2880.0, 2000), 1.2);
/// ```
pub fn default_spacing(area_um2: f64, masses: usize) -> f64 {
    let spacing = (area_um2 / masses.max(1) as f64).sqrt();
    two_digits(spacing, |digits| (digits - 1e-9).ceil())
}

/// A length with two digits, which `round` makes whole.
pub(super) fn two_digits(length: f64, round: impl Fn(f64) -> f64) -> f64 {
    let digit = 10_f64.powf(length.log10().floor() - 1.0);
    let rounded = round(length / digit) * digit;
    // Through text, to get a number that prints with two digits.
    format!("{rounded:.1e}").parse().unwrap_or(rounded)
}

/// Fills the largest island of a mask with a lattice of `spacing` um (by default about
/// [`DEFAULT_MASSES`] masses).
///
/// Coordinates are um from the lower left corner of the picture, y upward.
///
/// # Errors
/// A cell of fewer than [`FEWEST_PIXELS`] pixels; a spacing that is not positive, is more than a
/// third of the cell's width, or gives more than [`MOST_MASSES`] masses; a mesh whose area is off
/// by more than [`AREA_BOUND_PCT`]. Above [`AREA_WARNING_PCT`] the report warns.
///
/// # Example
/// ```
/// use myospring::mesh::{lattice, mask::Mask, pixel_size::PixelSize};
/// let disc = |i: usize| (i % 60).abs_diff(30).pow(2) + (i / 60).abs_diff(30).pow(2) < 600;
/// let pixel = PixelSize::new(0.5).unwrap();
/// let mask = Mask::new(60, 60, pixel, (0..3600).map(disc).collect()).unwrap();
/// let (mesh, report) = lattice::from_mask(&mask, Some(1.0)).unwrap();
/// assert_eq!(mesh.len(), report.masses);
/// assert!(report.area_error_pct.abs() < 1.0);
/// ```
pub fn from_mask(mask: &Mask, spacing: Option<f64>) -> Result<(Mesh, MeshReport), LatticeError> {
    of_largest_part(mask, |cell| fill(cell, spacing))
}

/// Fills the largest island of a mask; the report says what else there was.
pub(super) fn of_largest_part<T>(
    mask: &Mask,
    fill: impl FnOnce(&Mask) -> Result<(T, MeshReport), LatticeError>,
) -> Result<(T, MeshReport), LatticeError> {
    let (cell, dropped) = mask.largest_part();
    let pixels = cell.cell_pixels();
    if pixels < FEWEST_PIXELS {
        let (area, bound) = (cell.area_um2(), FEWEST_PIXELS);
        return Err(LatticeError::TooSmall { pixels, area, bound });
    }
    let (mesh, mut report) = fill(&cell)?;
    report.dropped_components = dropped.components;
    report.dropped_pixels = dropped.pixels;
    report.touches_frame = cell.touches_frame();
    if report.touches_frame {
        report.warnings.push(
            "the cell touches the frame of the picture and may be cut: its length, width and \
             shortening are then not those of a whole cell"
                .to_owned(),
        );
    }
    if dropped.pixels * 20 > pixels {
        report.warnings.push(format!(
            "{} islands with {} pixels other than the cell of {pixels} pixels were dropped: is it one \
             cell?",
            dropped.components, dropped.pixels
        ));
    }
    if report.spacing_um < mask.pixel_size().um() {
        report.warnings.push(format!(
            "spacing {} um is finer than a pixel of {} um: the mesh shows the steps of the pixels",
            report.spacing_um,
            mask.pixel_size().um()
        ));
    }
    Ok((mesh, report))
}

/// Fills an outline with a lattice of `spacing` um (by default about [`DEFAULT_MASSES`] masses).
///
/// # Errors
/// Those of [`from_mask`], except for pixels.
///
/// # Example
/// ```
/// use myospring::mesh::{built_in, lattice};
/// let (mesh, report) = lattice::from_outline(&built_in::adult_ventricular(), None).unwrap();
/// assert!((1_800..2_400).contains(&mesh.len()));
/// assert!((report.dimensions.length_um - 140.0).abs() < 2.0);
/// ```
pub fn from_outline(
    outline: &Outline,
    spacing: Option<f64>,
) -> Result<(Mesh, MeshReport), LatticeError> {
    fill(outline, spacing)
}

/// A rectangle of `columns` x `rows` squares with its lower left corner at the origin.
///
/// With `n` columns and `m` rows it has `(n + 1)(m + 1)` masses, `n (m + 1) + m (n + 1) + 2 n m`
/// springs and `4 n m` triangles.
///
/// # Errors
/// A spacing that is not positive, no square, or more than [`MOST_MASSES`] masses.
///
/// # Example
/// ```
/// use myospring::mesh::lattice::rectangle;
/// let mesh = rectangle(70, 10, 2.0).unwrap();
/// assert_eq!((mesh.len(), mesh.area()), (71 * 11, 140.0 * 20.0));
/// ```
pub fn rectangle(columns: usize, rows: usize, spacing: f64) -> Result<Mesh, LatticeError> {
    if !(spacing.is_finite() && spacing > 0.0) {
        return Err(LatticeError::Spacing { spacing, default: 1.0 });
    }
    let masses = (columns as f64 + 1.0) * (rows as f64 + 1.0);
    if masses > MOST_MASSES as f64 {
        return Err(too_fine(spacing, |at| masses * (spacing / at).powi(2), 1.0));
    }
    let grid = Grid { spacing, origin: [0.0; 2], columns, rows };
    Ok(from_squares(&grid, &vec![true; columns * rows])?)
}

fn too_fine(spacing: f64, masses: impl Fn(f64) -> f64, default: f64) -> LatticeError {
    let smallest = default * (masses(default) / MOST_MASSES as f64).sqrt();
    // A spacing near 0 would give more masses than a number can say.
    let masses = masses(spacing).min(f64::MAX);
    LatticeError::TooFine { spacing, masses, bound: MOST_MASSES, smallest, default }
}

fn fill(source: &impl Source, spacing: Option<f64>) -> Result<(Mesh, MeshReport), LatticeError> {
    let shape = source.shape();
    let spacing = check_spacing(&shape, spacing)?;
    let grid = cover(&shape, spacing);
    let target = shape.area / (spacing * spacing);
    let choice = choose(&source.coverage(&grid), [grid.columns, grid.rows, 1], target);
    let area = choice.count as f64 * spacing * spacing;
    let area_error_pct = 100.0 * (area - shape.area) / shape.area;
    if area_error_pct.abs() > AREA_BOUND_PCT {
        let (source_area, bound) = (shape.area, AREA_BOUND_PCT);
        return Err(LatticeError::AreaLost { spacing, area, source_area, bound });
    }
    let mesh = from_squares(&grid, &choice.kept)?;
    let mut warnings = Vec::new();
    if area_error_pct.abs() > AREA_WARNING_PCT {
        warnings.push(format!(
            "the mesh's area is {area_error_pct:+.2} % off the cell's, more than {AREA_WARNING_PCT} \
             %: spacing {spacing} um is too coarse for this shape"
        ));
    }
    let report = MeshReport {
        masses: mesh.len(),
        springs: mesh.springs.len(),
        triangles: mesh.simplices.len(),
        squares: choice.count,
        spacing_um: spacing,
        area_um2: area,
        source_area_um2: shape.area,
        area_error_pct,
        dimensions: dimensions(&mesh),
        thick: None,
        dropped_pixels: 0,
        dropped_components: 0,
        dropped_squares: choice.dropped,
        touches_frame: false,
        warnings,
    };
    Ok((mesh, report))
}

fn check_spacing(shape: &Shape, spacing: Option<f64>) -> Result<f64, LatticeError> {
    let default = default_spacing(shape.area, DEFAULT_MASSES);
    let given = spacing.is_some();
    let spacing = spacing.unwrap_or(default);
    if !(spacing.is_finite() && spacing > 0.0) {
        return Err(LatticeError::Spacing { spacing, default });
    }
    let bound = shape.width / 3.0;
    // Rounding of the width must not reject exactly a third.
    if given && spacing > bound * (1.0 + 1e-9) {
        return Err(LatticeError::TooCoarse { spacing, bound, width: shape.width, default });
    }
    let [low, high] = shape.bounds;
    let box_area = (high[0] - low[0]) * (high[1] - low[1]);
    let area = shape.area.max(box_area * MOST_MASSES as f64 / MOST_SQUARES);
    let masses = |at: f64| area / (at * at);
    if masses(spacing) > MOST_MASSES as f64 {
        return Err(too_fine(spacing, masses, default));
    }
    Ok(spacing)
}

/// The block of squares, centred on the bounding box, that covers a cell.
pub(super) fn cover(shape: &Shape, spacing: f64) -> Grid {
    let [low, high] = shape.bounds;
    // A width of a whole number of squares, except for rounding, needs no additional square.
    let count = |axis: usize| ((high[axis] - low[axis]) / spacing - 1e-6).ceil().max(1.0);
    let [columns, rows] = [count(0), count(1)];
    let origin = [(0, columns), (1, rows)]
        .map(|(axis, count)| 0.5 * (low[axis] + high[axis] - count * spacing));
    Grid { spacing, origin, columns: columns as usize, rows: rows as usize }
}

/// Nodes, springs and triangles of filled squares, in the guaranteed order.
pub(super) fn from_squares(grid: &Grid, filled: &[bool]) -> Result<Mesh, MeshError> {
    const NONE: u32 = u32::MAX;
    let (columns, rows, h) = (grid.columns, grid.rows, grid.spacing);
    // Square (i, j), which may lie outside the block.
    let square =
        |i: usize, j: usize| usize::from(i < columns && j < rows && filled[j * columns + i]);
    // The square to the left of it.
    let before = |i: usize, j: usize| if i > 0 { square(i - 1, j) } else { 0 };

    let mut number = vec![NONE; (columns + 1) * (rows + 1)];
    let mut points = [Vec::new(), Vec::new()];
    let (mut areas, mut cells) = (Vec::new(), Vec::new());
    for j in 0..=rows {
        for i in 0..=columns {
            let mut around = square(i, j) + before(i, j);
            if j > 0 {
                around += square(i, j - 1) + before(i, j - 1);
            }
            if around > 0 {
                number[j * (columns + 1) + i] = areas.len() as u32;
                points[0].push(grid.origin[0] + h * i as f64);
                points[1].push(grid.origin[1] + h * j as f64);
                areas.push(around as f64 * h * h / 4.0);
                cells.push([i as u32, j as u32]);
            }
        }
    }
    let node = |i: usize, j: usize| number[j * (columns + 1) + i];

    let mut springs = Vec::new();
    let mut axial = |a: u32, b: u32, sides: usize| {
        if sides > 0 {
            let share = sides as f64 / 2.0;
            springs.push(Spring { nodes: [a, b], kind: SpringKind::Axial, share });
        }
    };
    for j in 0..=rows {
        for i in 0..columns {
            let below = if j > 0 { square(i, j - 1) } else { 0 };
            axial(node(i, j), node(i + 1, j), square(i, j) + below);
        }
    }
    for j in 0..rows {
        for i in 0..=columns {
            axial(node(i, j), node(i, j + 1), square(i, j) + before(i, j));
        }
    }
    let each_square = || {
        (0..rows)
            .flat_map(move |j| (0..columns).map(move |i| (i, j)))
            .filter(|&(i, j)| square(i, j) > 0)
    };
    // The corners of a square: a lower left, b lower right, c upper right, d upper left.
    let corners =
        |(i, j): (usize, usize)| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
    for pick in [[0, 2], [1, 3]] {
        springs.extend(each_square().map(|place| {
            let nodes = pick.map(|corner| corners(place)[corner]);
            Spring { nodes, kind: SpringKind::Diagonal, share: 1.0 }
        }));
    }
    let mut simplices = Vec::new();
    for pick in [[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]] {
        simplices.extend(each_square().map(|place| Simplex {
            nodes: pick.map(|corner| corners(place)[corner]),
            weight: 0.5,
        }));
    }
    let shape = [columns + 1, rows + 1];
    let lattice = Lattice { spacing: h, shape, origin: grid.origin, cells };
    Mesh::new(points, areas, springs, simplices, Some(lattice))
}
