//! Convergence of the peak shortening with the spacing of the lattice.
//!
//! A free cell under one tension and one fibre direction deforms homogeneously on any lattice (the patch
//! test), so its shortening does not depend on the spacing at all. To see the discretisation, the fibres
//! wind to and fro: by up to 29 degrees, over 40 um.

use crate::check::{Failure, Setting};
use crate::fit::{affine, order, right_stretch, slope};
use crate::row::Row;
use myospring::analysis::shape::ShapeMeter;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::mechanics::Vectors;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{assemble, assemble_thick, default_material};
use myospring::mechanics::support::SupportKind;
use myospring::mesh::{Mesh, built_in, cubes, lattice, quality};
use std::f64::consts::TAU;

const TENSION: f64 = 50.0;

const EXACT: Tolerance = Tolerance {
    interpolation: 1e-8,
    equilibrium: 1e-12,
    smallest_step: 1e-4,
    longest_delay: f64::INFINITY,
};

/// Fibres that wind along x, in the plane of x and y.
fn winding<const D: usize, const N: usize>(mesh: &Mesh<D, N>) -> Vec<[f64; D]> {
    let middle = |nodes: [u32; N]| {
        nodes.iter().map(|&node| mesh.points[0][node as usize]).sum::<f64>() / N as f64
    };
    let angle = |x: f64| 0.5 * (TAU * x / 40.0).sin();
    let along = |angle: f64| {
        let mut direction = [0.0; D];
        [direction[0], direction[1]] = [angle.cos(), angle.sin()];
        direction
    };
    mesh.simplices.iter().map(|simplex| along(angle(middle(simplex.nodes)))).collect()
}

/// The shape at peak tension, um.
fn contracted(mesh: &Mesh, fibres: &[[f64; 2]], axis: [f64; 2]) -> Result<Vectors, Failure> {
    let length = quality::extent(mesh, axis);
    let support = SupportKind::MassCentre;
    let (body, system) =
        assemble(mesh, &default_material(), ActiveLaw::Fibre, fibres, support, axis, length);
    let path = Path::solve(&system, &body, TENSION, EXACT)?;
    Ok(path.positions(TENSION).ok_or("the path has no shape at its last tension")?)
}

/// Shortening of a 40 x 8 um strip whose fibres wind, from the mean positions of its end faces.
fn strip(across: usize) -> Result<f64, Failure> {
    let mesh = lattice::rectangle(5 * across, across, 8.0 / across as f64)?;
    let shape = contracted(&mesh, &winding(&mesh), [1.0, 0.0])?;
    Ok(end_to_end(&mesh, &shape))
}

/// The same of a block of 40 x 8 x 4 um in cubes.
fn block(across: usize) -> Result<f64, Failure> {
    let mesh = cubes::block([5 * across, across, across / 2], 8.0 / across as f64)?;
    let (material, support, axis) = (default_material(), SupportKind::MassCentre, [1.0, 0.0, 0.0]);
    let (body, system) = assemble_thick(&mesh, &material, &winding(&mesh), support, axis, 40.0);
    let path = Path::solve(&system, &body, TENSION, EXACT)?;
    let shape = path.positions(TENSION).ok_or("the path has no shape at its last tension")?;
    Ok(end_to_end(&mesh, &shape))
}

/// Shortening of a body that is 40 um long, from the mean positions of its end faces.
fn end_to_end<const D: usize, const N: usize>(mesh: &Mesh<D, N>, shape: &Vectors<D>) -> f64 {
    let face = |x: f64| -> [f64; D] {
        let (mut sum, mut total) = ([0.0; D], 0.0);
        for node in (0..mesh.len()).filter(|&node| (mesh.points[0][node] - x).abs() < 1e-9) {
            for axis in 0..D {
                sum[axis] += mesh.areas[node] * shape[axis][node];
            }
            total += mesh.areas[node];
        }
        sum.map(|value| value / total)
    };
    let (start, end) = (face(0.0), face(40.0));
    let apart = end.iter().zip(start).map(|(end, start)| end - start);
    1.0 - apart.fold(0.0, f64::hypot) / 40.0
}

/// Shortening of the built-in cell, %: with straight fibres, from the homogeneous stretch along them;
/// with fibres that wind, from end to end.
fn cell(spacing: Option<f64>) -> Result<[f64; 2], Failure> {
    let mesh = lattice::from_outline(&built_in::adult_ventricular(), spacing)?.0;
    let straight = vec![[1.0, 0.0]; mesh.simplices.len()];
    let shape = contracted(&mesh, &straight, [1.0, 0.0])?;
    let along = right_stretch(affine(&mesh.points, &shape).0)[0];
    let axis = quality::long_axis(&mesh);
    let meter = ShapeMeter::new(mesh.points.clone(), axis, &mesh.areas);
    let shape = contracted(&mesh, &winding(&mesh), axis)?;
    let stretch = meter.measure(&shape).length / meter.measure(&mesh.points).length;
    Ok([1.0 - along, 1.0 - stretch].map(|part| 100.0 * part))
}

/// Shortening on finer and finer lattices.
///
/// # Errors
/// A mesh or an equilibrium that cannot be found.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let strips = [strip(8)?, strip(16)?, strip(32)?];
    let blocks = [block(4)?, block(8)?, block(16)?];
    let (finest_spacing, spacings): (f64, &[f64]) = if setting.quick {
        (0.6, &[4.8, 2.4, 1.2])
    } else {
        (0.35, &[4.8, 3.4, 2.4, 1.7, 1.2, 0.85, 0.6])
    };
    let [straight, winding] = cell(Some(finest_spacing))?;
    let default = cell(None)?[1];
    let (mut sizes, mut errors) = (Vec::new(), Vec::new());
    let (mut by_straight, mut by_winding) = (0.0_f64, 0.0_f64);
    for &spacing in spacings {
        let found = cell(Some(spacing))?;
        by_straight = by_straight.max((found[0] - straight).abs());
        let error = (found[1] - winding).abs();
        sizes.push(spacing.ln());
        errors.push(error.ln());
        if spacing <= 2.4 {
            by_winding = by_winding.max(error);
        }
    }
    let finest = format!("our own lattice of {finest_spacing} um");
    Ok(vec![
        Row::about(
            "strip with winding fibres at 50 kPa: order of its shortening in the spacing",
            "theory: order 2 where geometry and fibres are smooth",
            order(strips),
            2.0,
            0.1,
            "",
            "three lattices, not yet in the limit; corners lower the order a little",
        ),
        Row::about(
            "block of cubes with winding fibres at 50 kPa: order of its shortening in the spacing",
            "theory: order 2 where geometry and fibres are smooth",
            order(blocks),
            2.0,
            0.2,
            "",
            "as of the strip, with 4, 8 and 16 cubes across",
        ),
        Row::difference(
            "built-in cell, straight fibres, 50 kPa, spacing 4.8 um and below: shortening",
            finest.clone(),
            by_straight,
            1e-6,
            "percentage points",
            "homogeneous on any lattice: the tolerance of the equilibrium",
        ),
        Row::difference(
            "built-in cell, winding fibres, 50 kPa, default spacing: shortening",
            finest.clone(),
            (default - winding).abs(),
            0.1,
            "percentage points",
            "half of the band of 0.2 that the default material is fitted to",
        ),
        Row::difference(
            "the same, spacing 2.4 um and below",
            finest,
            by_winding,
            0.3,
            "percentage points",
            "the rim of squares moves by up to half a square at each end",
        ),
        Row::noted(
            "the same: order of the shortening in the spacing",
            "theory: between 1 (a rim of squares for a smooth outline) and 2 (inside)",
            slope(&sizes, &errors),
            1.0,
            "",
            "slope of a line through errors that scatter, since the rim's steps fall differently on each \
             lattice: no tolerance can be stated",
        ),
    ])
}
