//! A cell with thickness: cubes above the squares of the cell as it is seen from above.
//!
//! The lattice of cubes has the columns and rows of the flat lattice, so that each cube lies above one square, and each of its
//! points above one point. The cubes that are covered most by the cell are kept, as many as give the mesh the cell's volume; the
//! flat mesh has the squares below them.

use super::coverage::Source;
use super::cubes::{self, Grid};
use super::lattice::{self, AREA_BOUND_PCT, AREA_WARNING_PCT, LatticeError};
use super::mask::Mask;
use super::outline::Outline;
use super::profile::{Heights, Profile};
use super::quality::{MeshReport, ThickReport, dimensions};
use super::selection::choose;
use super::simplex::measure_at;
use super::voxels::Voxels;
use super::{Mesh, coverage};
use serde::Serialize;

/// Number of points that the default spacing aims at.
pub const DEFAULT_POINTS: usize = 4_000;

/// Largest number of points. A run takes some 10 kB of memory for each.
pub const MOST_POINTS: usize = 400_000;

/// Cubes across the thickness below which the mesh bends too stiffly, and the report warns: a beam of four cubes has 0.9 of the
/// deflection of a fine one.
pub const ENOUGH_LAYERS: usize = 4;

/// How far the thickness of the mesh may be off the stated one without a warning, per cent.
const THICKNESS_WARNING_PCT: f64 = 4.0;

/// The form of a cell of which only the outline is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Form {
    /// How its thickness varies.
    pub profile: Profile,
    /// Its greatest thickness, um.
    pub thickness: f64,
}

/// The thickness of a cell, above its flat mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Thick {
    /// Cubes, each cut into ten tetrahedra of weight 1/2, which are consecutive.
    pub mesh: Mesh<3, 4>,
    /// The square of the flat mesh below each cube.
    pub squares: Vec<u32>,
    /// The points above each point of the flat mesh, from the lowest.
    pub columns: Vec<Vec<u32>>,
}

impl Thick {
    /// The mean over each column of points, weighted by their volumes: positions in the plane of the flat mesh, um.
    pub fn seen_from_above(&self, positions: &[Vec<f64>; 3]) -> [Vec<f64>; 2] {
        let mean = |axis: usize, column: &Vec<u32>| {
            let weight = |node: &u32| self.mesh.areas[*node as usize];
            let sum = column.iter().map(|node| weight(node) * positions[axis][*node as usize]);
            sum.sum::<f64>() / column.iter().map(weight).sum::<f64>()
        };
        [0, 1].map(|axis| self.columns.iter().map(|column| mean(axis, column)).collect())
    }

    /// One value for each point, from one for each point of the flat mesh below it.
    pub fn of_nodes(&self, nodes: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.mesh.len()];
        for (column, value) in self.columns.iter().zip(nodes) {
            for &node in column {
                values[node as usize] = *value;
            }
        }
        values
    }

    /// One value for each tetrahedron, from one for each triangle of the flat mesh: the mean of the four triangles of the square below.
    pub fn of_triangles(&self, triangles: &[f64]) -> Vec<f64> {
        let squares = triangles.len() / 4;
        let mean = |square: u32| {
            (0..4).map(|of| triangles[of * squares + square as usize]).sum::<f64>() / 4.0
        };
        let each = |square: &u32| std::iter::repeat_n(mean(*square), cubes::TETRAHEDRA_OF_A_CUBE);
        self.squares.iter().flat_map(each).collect()
    }

    /// The direction in each tetrahedron, unit vectors in the plane, from one for each triangle of the flat mesh: as axes, the mean of the
    /// square below. From the lowest to the highest point of the cell they turn by `angle`, rad, counter-clockwise as seen from above; at
    /// half the height they are those of the flat mesh.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::profile::Profile;
    /// use myospring::mesh::{built_in, thick};
    /// let form = thick::Form { profile: Profile::Slab, thickness: 10.0 };
    /// let (above, thick, _) = thick::from_outline(&built_in::adult_ventricular(), form, Some(5.0))?;
    /// let along = vec![[1.0, 0.0]; above.simplices.len()];
    /// let turned = thick.turned(&along, 1.0);
    /// let angles = thick.mesh.simplices.iter().zip(&turned).map(|(tetrahedron, [x, y, _])| {
    ///     (y.atan2(*x), thick.mesh.centre(tetrahedron)[2] / 10.0 - 0.5)
    /// });
    /// assert!(angles.into_iter().all(|(angle, above)| (angle - above).abs() < 1e-12));
    /// # Ok::<(), myospring::mesh::lattice::LatticeError>(())
    /// ```
    pub fn turned(&self, triangles: &[[f64; 2]], angle: f64) -> Vec<[f64; 3]> {
        let squares = triangles.len() / 4;
        // Axes have no sign, so doubled angles are averaged.
        let of_square = |square: usize| {
            let of = |k: usize| triangles[k * squares + square];
            let first = of(0);
            if (1..4).all(|k| of(k) == first) {
                return first;
            }
            let doubled = (0..4)
                .map(of)
                .fold([0.0; 2], |[c, s], [x, y]| [c + x * x - y * y, s + 2.0 * x * y]);
            let angle = 0.5 * doubled[1].atan2(doubled[0]);
            [angle.cos(), angle.sin()]
        };
        let z = &self.mesh.points[2];
        let range = |[low, high]: [f64; 2], z: &f64| [low.min(*z), high.max(*z)];
        let [low, high] = z.iter().fold([f64::INFINITY, f64::NEG_INFINITY], range);
        let (middle, height) = (0.5 * (low + high), high - low);
        let tetrahedra = self.mesh.simplices.chunks(cubes::TETRAHEDRA_OF_A_CUBE);
        let turned = tetrahedra.zip(&self.squares).flat_map(|(tetrahedra, square)| {
            let [x, y] = of_square(*square as usize);
            tetrahedra.iter().map(move |tetrahedron| {
                let above = (self.mesh.centre(tetrahedron)[2] - middle) / height;
                let (sine, cosine) = (angle * above).sin_cos();
                [cosine * x - sine * y, sine * x + cosine * y, 0.0]
            })
        });
        turned.collect()
    }

    /// One value for each of `triangles` triangles of the flat mesh, from one for each tetrahedron: the mean above its square, weighted by
    /// volume.
    pub fn to_triangles(&self, tetrahedra: &[f64], triangles: usize) -> Vec<f64> {
        let squares = triangles / 4;
        let mut sums = vec![[0.0; 2]; squares];
        let values = self.mesh.simplices.iter().zip(tetrahedra);
        for (at, (simplex, value)) in values.enumerate() {
            let volume = simplex.weight * measure_at(&self.mesh.points, simplex.nodes);
            let [sum, whole] = &mut sums[self.squares[at / cubes::TETRAHEDRA_OF_A_CUBE] as usize];
            *sum += volume * value;
            *whole += volume;
        }
        (0..triangles).map(|at| sums[at % squares][0] / sums[at % squares][1]).collect()
    }
}

/// Fills an outline of a form with cubes of `spacing` um (by default about [`DEFAULT_POINTS`] points, and at least
/// [`ENOUGH_LAYERS`] cubes across the thickness); returns the cell from above, its thickness and the report.
///
/// # Errors
/// A spacing or thickness that is not positive, a spacing above a third of the width or above the thickness, more than
/// [`MOST_POINTS`] points; a mesh whose volume is off by more than [`AREA_BOUND_PCT`].
///
/// # Example
/// ```
/// use myospring::mesh::profile::Profile;
/// use myospring::mesh::{built_in, thick};
/// let form = thick::Form { profile: Profile::Round, thickness: 10.0 };
/// let (above, thick, report) = thick::from_outline(&built_in::adult_ventricular(), form, Some(2.0))?;
/// assert_eq!((above.len(), report.thick.unwrap().layers), (thick.columns.len(), 5));
/// # Ok::<(), myospring::mesh::lattice::LatticeError>(())
/// ```
pub fn from_outline(
    outline: &Outline,
    form: Form,
    spacing: Option<f64>,
) -> Result<(Mesh, Thick, MeshReport), LatticeError> {
    fill(outline, form, spacing)
}

/// As [`from_outline`], for the largest island of a mask.
///
/// # Errors
/// Those of [`from_outline`], and a cell of too few pixels.
pub fn from_mask(
    mask: &Mask,
    form: Form,
    spacing: Option<f64>,
) -> Result<(Mesh, Thick, MeshReport), LatticeError> {
    let filled = lattice::of_largest_part(mask, |cell| {
        let (above, thick, report) = fill(cell, form, spacing)?;
        Ok(((above, thick), report))
    });
    let ((above, thick), report) = filled?;
    Ok((above, thick, report))
}

/// As [`from_outline`], for the voxels of a cell, whose form they show.
///
/// # Errors
/// Those of [`from_outline`], and voxels that have no outline seen from above.
///
/// # Example
/// ```
/// use myospring::mesh::{thick, voxels::Voxels};
/// // A ball of 20 um in voxels of 0.5 x 0.5 x 1 um.
/// let inside = |at: usize| {
///     let [x, y, z] = [at % 44, at / 44 % 44, at / (44 * 44)].map(|place| place as f64 + 0.5);
///     (0.5 * x - 11.0).powi(2) + (0.5 * y - 11.0).powi(2) + (z - 11.0).powi(2) < 100.0
/// };
/// let voxels = Voxels::new([44, 44, 22], [0.5, 0.5, 1.0], (0..44 * 44 * 22).map(inside).collect())?;
/// let (_, thick, report) = thick::from_voxels(&voxels, Some(1.0))?;
/// assert!((thick.mesh.area() / voxels.volume_um3() - 1.0).abs() < 0.01);
/// assert_eq!(report.thick.unwrap().layers, 20);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn from_voxels(
    voxels: &Voxels,
    spacing: Option<f64>,
) -> Result<(Mesh, Thick, MeshReport), LatticeError> {
    let seen = voxels.above().map_err(|cause| LatticeError::Above(cause.to_string()))?;
    let shape = Source::shape(&seen);
    let [low, high] = voxels.bounds_um();
    let (thickness, volume) = (high[2] - low[2], voxels.volume_um3());
    let default = default_spacing(volume, thickness);
    let spacing = check_spacing(&shape, thickness, volume, spacing, default)?;
    let flat = lattice::cover(&shape, spacing);
    let layers = (thickness / spacing - 1e-6).ceil().max(1.0) as usize;
    let grid = Grid {
        spacing,
        origin: [flat.origin[0], flat.origin[1], low[2]],
        shape: [flat.columns, flat.rows, layers],
    };
    made(&grid, &voxels.coverage(grid.origin, spacing, grid.shape), &shape, Vec::new())
}

/// The spacing, um, at which a volume contains about [`DEFAULT_POINTS`] points and the thickness enough cubes.
fn default_spacing(volume: f64, thickness: f64) -> f64 {
    let spacing = (volume / DEFAULT_POINTS as f64).cbrt().min(thickness / ENOUGH_LAYERS as f64);
    lattice::two_digits(spacing, |digits| (digits + 1e-9).floor())
}

/// The spacing near this one of which whole cubes make up the thickness, um.
fn dividing(thickness: f64, spacing: f64) -> f64 {
    let layers = (thickness / spacing).round().max(ENOUGH_LAYERS as f64);
    // Rounded up, so that no further layer begins.
    let digits = 1e4 * thickness / layers;
    (digits - 1e-6).ceil() / 1e4
}

fn fill(
    source: &impl Source,
    form: Form,
    spacing: Option<f64>,
) -> Result<(Mesh, Thick, MeshReport), LatticeError> {
    let Form { profile, thickness } = form;
    if !(thickness.is_finite() && thickness > 0.0) {
        return Err(LatticeError::Thickness { thickness });
    }
    let shape = source.shape();
    // An elliptic section has pi/4 of its box.
    let part = if profile == Profile::Slab { 1.0 } else { std::f64::consts::FRAC_PI_4 };
    let volume = part * shape.area * thickness;
    let default = dividing(thickness, default_spacing(volume, thickness));
    let spacing = check_spacing(&shape, thickness, volume, spacing, default)?;
    let flat = lattice::cover(&shape, spacing);
    let layers = (thickness / spacing - 1e-6).ceil().max(1.0);
    // A cell that lies on something begins where that ends; a rounded one is in the middle of its layers.
    let below = if profile == Profile::Round { 0.5 * (layers * spacing - thickness) } else { 0.0 };
    let grid = Grid {
        spacing,
        origin: [flat.origin[0], flat.origin[1], -below],
        shape: [flat.columns, flat.rows, layers as usize],
    };
    let heights = profile.heights(source, &flat, thickness);
    let made = made(&grid, &coverage_of(&heights, &grid), &shape, Vec::new());
    made.map(|(above, thick, mut report)| {
        let warnings =
            [off_thickness(&report, thickness), thicker_than_wide(thickness, shape.width)];
        report.warnings.extend(warnings.into_iter().flatten());
        (above, thick, report)
    })
}

/// Says that whole cubes are thicker or thinner than the cell, if they are.
fn off_thickness(report: &MeshReport, thickness: f64) -> Option<String> {
    let meshed = report.thick.as_ref()?.thickness_um;
    let off_pct = 100.0 * (meshed / thickness - 1.0);
    (off_pct.abs() > THICKNESS_WARNING_PCT).then(|| {
        let spacing = dividing(thickness, report.spacing_um);
        format!(
            "the mesh is {meshed:.2} um thick, {off_pct:+.1} % off the {thickness} um of the cell, as cubes are whole, and bends as that; a \
             spacing of {spacing} um has whole cubes in {thickness} um"
        )
    })
}

/// Says that a cell is thicker than wide, if it is.
fn thicker_than_wide(thickness: f64, width: f64) -> Option<String> {
    (thickness > 1.1 * width).then(|| {
        format!(
            "the cell is {thickness} um thick and {width:.1} um wide; cells that lie on a dish are thinner than wide: check the unit of \
             the thickness"
        )
    })
}

fn check_spacing(
    shape: &coverage::Shape,
    thickness: f64,
    volume: f64,
    spacing: Option<f64>,
    default: f64,
) -> Result<f64, LatticeError> {
    let given = spacing.is_some();
    let spacing = spacing.unwrap_or(default);
    if !(spacing.is_finite() && spacing > 0.0) {
        return Err(LatticeError::Spacing { spacing, default });
    }
    let bound = shape.width / 3.0;
    if given && spacing > bound * (1.0 + 1e-9) {
        return Err(LatticeError::TooCoarse { spacing, bound, width: shape.width, default });
    }
    if spacing > thickness * (1.0 + 1e-9) {
        return Err(LatticeError::TooThin { spacing, thickness, default });
    }
    let points = volume / spacing.powi(3);
    if points > MOST_POINTS as f64 {
        let smallest = (volume / MOST_POINTS as f64).cbrt();
        let (masses, bound) = (points.min(f64::MAX), MOST_POINTS);
        return Err(LatticeError::TooFine { spacing, masses, bound, smallest, default });
    }
    Ok(spacing)
}

/// The part of each cube that lies between both faces of a cell.
fn coverage_of(heights: &Heights, grid: &Grid) -> Vec<f64> {
    let Heights { finer, columns, inside, faces } = heights;
    let [across, along, layers] = grid.shape;
    let mut coverage = vec![0.0; grid.len()];
    let part = 1.0 / (finer * finer) as f64;
    for row in 0..along * finer {
        for column in 0..across * finer {
            let at = row * columns + column;
            if inside[at] <= 0.0 {
                continue;
            }
            let square = row / finer * across + column / finer;
            // In cubes above the lowest.
            let [low, high] = faces[at].map(|face| (face - grid.origin[2]) / grid.spacing);
            for layer in low.max(0.0) as usize..layers {
                let [bottom, top] = [layer as f64, layer as f64 + 1.0];
                let filled = high.min(top) - low.max(bottom);
                if filled <= 0.0 {
                    break;
                }
                coverage[layer * across * along + square] += part * inside[at] * filled;
            }
        }
    }
    coverage
}

/// The mesh of the cubes that are covered most, as many as give it the volume.
fn made(
    grid: &Grid,
    coverage: &[f64],
    shape: &coverage::Shape,
    mut warnings: Vec<String>,
) -> Result<(Mesh, Thick, MeshReport), LatticeError> {
    let spacing = grid.spacing;
    let target: f64 = coverage.iter().sum();
    let choice = choose(coverage, grid.shape, target);
    let volume_error_pct = 100.0 * (choice.count as f64 - target) / target;
    let source_volume_um3 = target * spacing.powi(3);
    if volume_error_pct.abs() > AREA_BOUND_PCT {
        return Err(LatticeError::VolumeLost {
            spacing,
            volume: choice.count as f64 * spacing.powi(3),
            source_volume: source_volume_um3,
            bound: AREA_BOUND_PCT,
        });
    }
    let mesh = cubes::filled(grid, &choice.kept)?;
    let [columns, rows, layers] = grid.shape;
    let mut below = vec![false; columns * rows];
    let mut above_each = vec![0_usize; columns * rows];
    for cube in (0..grid.len()).filter(|&cube| choice.kept[cube]) {
        below[cube % (columns * rows)] = true;
        above_each[cube % (columns * rows)] += 1;
    }
    let flat = coverage::Grid { spacing, origin: [grid.origin[0], grid.origin[1]], columns, rows };
    let above = lattice::from_squares(&flat, &below)?;
    let mut number = vec![0; columns * rows];
    for (count, square) in (0..columns * rows).filter(|&square| below[square]).enumerate() {
        number[square] = count as u32;
    }
    let kept = (0..grid.len()).filter(|&cube| choice.kept[cube]);
    let squares = kept.map(|cube| number[cube % (columns * rows)]).collect();
    let thick = Thick { squares, columns: columns_of(&above, &mesh), mesh };
    let most = above_each.into_iter().max().unwrap_or(0);
    if volume_error_pct.abs() > AREA_WARNING_PCT {
        warnings.push(format!(
            "the mesh's volume is {volume_error_pct:+.2} % off the cell's, more than {AREA_WARNING_PCT} %: spacing {spacing} um is too \
             coarse for this shape"
        ));
    }
    if most < ENOUGH_LAYERS {
        warnings.push(format!(
            "only {most} {} across the thickness: with fewer than {ENOUGH_LAYERS} the mesh bends too stiffly; take a spacing of {:.2} um \
             or less",
            if most == 1 { "cube" } else { "cubes" },
            most as f64 * spacing / ENOUGH_LAYERS as f64
        ));
    }
    let area_um2 = above.area();
    let report = MeshReport {
        masses: thick.mesh.len(),
        springs: thick.mesh.springs.len(),
        triangles: above.simplices.len(),
        squares: above.simplices.len() / 4,
        spacing_um: spacing,
        area_um2,
        source_area_um2: shape.area,
        area_error_pct: 100.0 * (area_um2 - shape.area) / shape.area,
        dimensions: dimensions(&above),
        thick: Some(ThickReport {
            cubes: choice.count,
            layers: most,
            thickness_um: most as f64 * spacing,
            volume_um3: thick.mesh.area(),
            source_volume_um3,
            volume_error_pct,
            dropped_cubes: choice.dropped,
        }),
        dropped_pixels: 0,
        dropped_components: 0,
        dropped_squares: 0,
        touches_frame: false,
        warnings,
    };
    debug_assert!(layers >= most, "a column is no higher than the grid");
    Ok((above, thick, report))
}

/// The points above each point of the flat mesh.
fn columns_of(above: &Mesh, mesh: &Mesh<3, 4>) -> Vec<Vec<u32>> {
    let (Some(flat), Some(cubes)) = (&above.lattice, &mesh.lattice) else { return Vec::new() };
    let mut number = vec![usize::MAX; flat.shape[0] * flat.shape[1]];
    let at = |x: u32, y: u32| y as usize * flat.shape[0] + x as usize;
    for (node, [x, y]) in flat.cells.iter().enumerate() {
        number[at(*x, *y)] = node;
    }
    let mut columns = vec![Vec::new(); above.len()];
    // Points run from the lowest layer upward.
    for (node, [x, y, _]) in cubes.cells.iter().enumerate() {
        columns[number[at(*x, *y)]].push(node as u32);
    }
    columns
}

#[cfg(test)]
mod tests;
