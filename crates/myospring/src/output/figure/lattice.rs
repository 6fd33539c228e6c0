//! The mesh that was made from a picture (the paper's Fig. 4a).

use std::fmt::Write;

use super::shapes::{ELONGATED, draw_scale_bar};
use super::strain::{check_mesh, facets, outline};
use super::svg::{Anchor, Sheet, Style, px};
use super::theme::{DOUBLE, INK, MUTED, POTENTIAL, SINGLE, TICK, fixed};
use super::{Figure, FigureError};
use crate::mesh::{Mesh, SpringKind};

/// Points closer than this many px are not drawn: they would hide the springs.
const CLOSEST: f64 = 5.0;

/// Points and springs of a mesh within its outline, with its numbers and a scale bar.
///
/// Long cells take two columns (178 mm), others one (85 mm). Where points lie too close to be told
/// apart, only springs are drawn.
///
/// # Errors
/// A mesh without points, with positions that are not finite, or that names points it lacks.
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
    let at = |node: u32| {
        let [x, y] = [0, 1].map(|axis: usize| mesh.points[axis][node as usize]);
        [inset + (x - left) * scale, margin + (high - y) * scale]
    };

    let mut sheet = Sheet::default();
    let rings = outline(&facets(mesh));
    let mut rim = String::new();
    for ring in &rings {
        for (corner, &node) in ring.iter().enumerate() {
            append(&mut rim, if corner == 0 { 'M' } else { 'L' }, at(node));
        }
        rim.push('z');
    }
    sheet.raw(&format!(r##"<path fill="#f3f6f9" stroke="none" d="{rim}"/>"##));
    for (kind, colour, width) in
        [(SpringKind::Diagonal, "#9dbdd6", 0.4), (SpringKind::Axial, "#4f8cba", 0.55)]
    {
        let mut path = String::new();
        for spring in mesh.springs.iter().filter(|spring| spring.kind == kind) {
            append(&mut path, 'M', at(spring.nodes[0]));
            append(&mut path, 'L', at(spring.nodes[1]));
        }
        sheet.raw(&format!(
            r#"<path fill="none" stroke="{colour}" stroke-width="{width}" d="{path}"/>"#
        ));
    }
    sheet.raw(&format!(
        r#"<path fill="none" stroke="{INK}" stroke-width="1" stroke-linejoin="round" d="{rim}"/>"#
    ));
    let points = mesh.points[0].len();
    let mean_area = extent[0] * extent[1] / points as f64;
    let spacing = mesh.lattice.as_ref().map_or(mean_area.sqrt(), |lattice| lattice.spacing);
    if spacing * scale >= CLOSEST {
        // A line of no length with round ends is a dot.
        let mut path = String::new();
        for node in (0..points).filter_map(|node| u32::try_from(node).ok()) {
            append(&mut path, 'M', at(node));
            path.push_str("h0");
        }
        let size = px((0.32 * spacing * scale).min(3.2));
        sheet.raw(&format!(
            r#"<path stroke="{POTENTIAL}" stroke-width="{size}" stroke-linecap="round" d="{path}"/>"#
        ));
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

fn append(path: &mut String, letter: char, [x, y]: [f64; 2]) {
    path.push(letter);
    path.push_str(&px(x));
    path.push(' ');
    path.push_str(&px(y));
}
