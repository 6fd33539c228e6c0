//! The mesh that was made from a picture (the paper's Fig. 4a).

use std::fmt::Write;

use super::facets::{check_mesh, facets, outline};
use super::shapes::{ELONGATED, draw_scale_bar};
use super::sheet::{Anchor, Look, Path, Sheet, Stroke, Style};
use super::theme::{Colour, DOUBLE, INK, LATTICE, MUTED, POTENTIAL, SINGLE, TICK, fixed};
use super::{Figure, FigureError};
use myospring_core::mesh::{Mesh, SpringKind};

/// Points closer than this are not drawn, px; they would hide the springs.
const CLOSEST: f64 = 5.0;

/// Distance between neighbouring points, um; of a mesh that is no lattice the mean.
pub(super) fn spacing(mesh: &Mesh) -> f64 {
    let mean = (mesh.area() / mesh.len() as f64).sqrt();
    mesh.lattice.as_ref().map_or(mean, |lattice| lattice.spacing)
}

/// Lines along the springs of one kind, in every n-th row and column of a lattice; `at` is where a point is drawn.
pub(super) fn springs(
    mesh: &Mesh,
    kind: SpringKind,
    every: u32,
    at: impl Fn(usize) -> [f64; 2],
) -> Path {
    let mut lines = Path::default();
    for spring in mesh.springs.iter().filter(|spring| spring.kind == kind) {
        let [a, b] = spring.nodes.map(|node| node as usize);
        let shown = mesh.lattice.as_ref().is_none_or(|lattice| {
            let (from, to) = (lattice.cells[a], lattice.cells[b]);
            let across = usize::from(from[0] == to[0]);
            // A spring along x belongs to a row, one along y to a column.
            from[1 - across].is_multiple_of(every)
        });
        if shown {
            lines.add_line([at(a), at(b)]);
        }
    }
    lines
}

/// Points and springs of a mesh within its outline, with its numbers and a scale bar.
///
/// Long cells take two columns (178 mm), others one (85 mm). If points are too close to be
/// distinguished, only springs are drawn.
///
/// # Errors
/// A mesh without points, with positions that are not finite, or that refers to points it does not
/// have.
pub fn mesh(mesh: &Mesh) -> Result<Figure, FigureError> {
    check_mesh(mesh)?;
    let ends = |axis: usize| {
        let points = mesh.points[axis].iter().copied();
        [points.clone().fold(f64::INFINITY, f64::min), points.fold(f64::NEG_INFINITY, f64::max)]
    };
    let [[left, right], [low, high]] = [ends(0), ends(1)];
    let extent = [(right - left).max(1e-9), (high - low).max(1e-9)];
    let page = if extent[0] > ELONGATED * extent[1] { DOUBLE } else { SINGLE };
    let margin = 8.0;
    let scale = ((page - 2.0 * margin) / extent[0]).min(1.2 * page / extent[1]);
    let inset = (page - extent[0] * scale) / 2.0;
    let at = |node: usize| {
        let [x, y] = mesh.point(node);
        [inset + (x - left) * scale, margin + (high - y) * scale]
    };

    let mut sheet = Sheet::default();
    let mut rim = Path::default();
    for ring in outline(&facets(mesh)) {
        rim.add_ring(ring.into_iter().map(|node| at(node as usize)));
    }
    sheet.path(rim.clone(), Look::fill(LATTICE));
    for (kind, colour, width) in
        [(SpringKind::Diagonal, 0x9dbdd6, 0.4), (SpringKind::Axial, 0x4f8cba, 0.55)]
    {
        sheet.path(springs(mesh, kind, 1, at), Stroke::new(Colour(colour), width));
    }
    sheet.path(rim, Stroke::new(INK, 1.0));
    let (points, spacing) = (mesh.len(), spacing(mesh));
    if spacing * scale >= CLOSEST {
        let mut path = Path::default();
        for node in 0..points {
            path.add_line([at(node); 2]);
        }
        let size = (0.32 * spacing * scale).min(3.2);
        sheet.path(path, Stroke::new(POTENTIAL, size).round_ends());
    }
    let bottom = margin + extent[1] * scale;
    draw_scale_bar(&mut sheet, [margin, bottom + 16.0], scale, extent);
    let mut numbers = format!("{points} points, {} springs", mesh.springs.len());
    if let Some(lattice) = &mesh.lattice {
        let spacing = fixed(lattice.spacing, 2);
        let spacing = spacing.trim_end_matches('0').trim_end_matches('.');
        write!(numbers, ", spacing {spacing} \u{b5}m").ok();
    }
    let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
    sheet.text([page - margin, bottom + 19.5], &numbers, style);
    Ok(sheet.finish(page, bottom + 28.0))
}
