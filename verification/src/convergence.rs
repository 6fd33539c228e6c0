//! Convergence of the peak shortening with the spacing of the lattice.

use crate::fit::{order, slope};
use crate::row::Row;
use crate::{Failure, Setting};
use myospring::analysis::shape::ShapeMeter;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::mechanics::Vectors;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{assemble, default_material};
use myospring::mechanics::support::SupportKind;
use myospring::mesh::{Mesh, built_in, lattice, quality};

const TENSION: f64 = 50.0;

const EXACT: Tolerance = Tolerance {
    interpolation: 1e-8,
    equilibrium: 1e-12,
    smallest_step: 1e-4,
    longest_delay: f64::INFINITY,
};

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
    let spacing = 8.0 / across as f64;
    let mesh = lattice::rectangle(5 * across, across, spacing)?;
    let middle = |nodes: [u32; 3]| {
        nodes.iter().map(|&node| mesh.points[0][node as usize]).sum::<f64>() / 3.0
    };
    let fibres: Vec<[f64; 2]> = mesh
        .simplices
        .iter()
        .map(|simplex| {
            (0.5 * (std::f64::consts::TAU * middle(simplex.nodes) / 40.0).sin()).sin_cos()
        })
        .map(|(sine, cosine)| [cosine, sine])
        .collect();
    let shape = contracted(&mesh, &fibres, [1.0, 0.0])?;
    let face = |x: f64| -> [f64; 2] {
        let (mut sum, mut total) = ([0.0; 2], 0.0);
        for node in (0..mesh.len()).filter(|&node| (mesh.points[0][node] - x).abs() < 1e-9) {
            for axis in 0..2 {
                sum[axis] += mesh.areas[node] * shape[axis][node];
            }
            total += mesh.areas[node];
        }
        sum.map(|value| value / total)
    };
    let (start, end) = (face(0.0), face(40.0));
    Ok(1.0 - (end[0] - start[0]).hypot(end[1] - start[1]) / 40.0)
}

/// Shortening of the built-in cell, %.
fn cell(spacing: Option<f64>) -> Result<f64, Failure> {
    let mesh = lattice::from_outline(&built_in::adult_ventricular(), spacing)?.0;
    let axis = quality::long_axis(&mesh);
    let shape = contracted(&mesh, &vec![axis; mesh.simplices.len()], axis)?;
    let meter = ShapeMeter::new(mesh.points.clone(), axis, mesh.areas.clone());
    let (rest, now) = (meter.measure(&mesh.points).length, meter.measure(&shape).length);
    Ok(100.0 * (1.0 - now / rest))
}

/// Shortening on finer and finer lattices.
///
/// # Errors
/// A mesh or an equilibrium that cannot be found.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let first = if setting.quick { 4 } else { 8 };
    let strips = [strip(first)?, strip(2 * first)?, strip(4 * first)?];
    let spacings: &[f64] =
        if setting.quick { &[4.8, 2.4, 1.2] } else { &[4.8, 3.4, 2.4, 1.7, 1.2, 0.85, 0.6] };
    let finest = cell(Some(if setting.quick { 0.8 } else { 0.3 }))?;
    let default = cell(None)?;
    let (mut sizes, mut errors, mut largest) = (Vec::new(), Vec::new(), 0.0_f64);
    for &spacing in spacings {
        let error = (cell(Some(spacing))? - finest).abs();
        sizes.push(spacing.ln());
        errors.push(error.ln());
        if spacing <= 2.4 {
            largest = largest.max(error);
        }
    }
    Ok(vec![
        Row::about(
            "strip with winding fibres at 50 kPa: order of its shortening in the spacing",
            "theory: order 2 where geometry and fibres are smooth",
            order(strips),
            2.0,
            0.1,
            "",
            "three lattices, not yet in the limit",
        ),
        Row::difference(
            "built-in cell at 50 kPa: shortening on the default lattice less that on the finest",
            "our own lattice of spacing 0.3 um",
            (default - finest).abs(),
            0.1,
            "percentage points",
            "half of the band of 0.2 that the default material is fitted to",
        ),
        Row::difference(
            "built-in cell at 50 kPa: the same, spacing 2.4 um and below",
            "our own lattice of spacing 0.3 um",
            largest,
            0.3,
            "percentage points",
            "a rim of squares changes with the spacing, a step of half a square at each end",
        ),
        Row::noted(
            "built-in cell at 50 kPa: order of its shortening in the spacing",
            "theory: about order 1 where a rim of squares stands for a smooth outline",
            slope(&sizes, &errors),
            1.0,
            "",
            "slope of a line through errors that scatter, since the steps of the rim fall differently on \
             each lattice; no tolerance can be stated",
        ),
    ])
}
