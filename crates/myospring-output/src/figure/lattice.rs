//! The mesh that was made from a picture (the paper's Fig. 4a).

use std::collections::{HashMap, HashSet};
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
///
/// Springs of a lattice that follow each other in one direction are one line, which takes less to draw than each alone.
pub(super) fn springs(
    mesh: &Mesh,
    kind: SpringKind,
    every: u32,
    at: impl Fn(usize) -> [f64; 2],
) -> Path {
    let mut lines = Path::default();
    let all = mesh.springs.iter().filter(|spring| spring.kind == kind);
    let all = all.map(|spring| spring.nodes.map(|node| node as usize));
    let Some(lattice) = &mesh.lattice else {
        all.for_each(|nodes| lines.add_line(nodes.map(&at)));
        return lines;
    };
    let shown = all.filter_map(|[a, b]| {
        let (from, to) = (lattice.cells[a], lattice.cells[b]);
        // A spring along x belongs to a row, one along y to a column.
        let across = usize::from(from[0] == to[0]);
        if !from[1 - across].is_multiple_of(every) {
            return None;
        }
        let [x, y] = [0, 1].map(|axis: usize| i64::from(to[axis]) - i64::from(from[axis]));
        Some(if (x, y) > (0, 0) { ([x, y], a, b) } else { ([-x, -y], b, a) })
    });
    let shown: Vec<_> = shown.collect();
    let next: HashMap<_, _> = shown.iter().map(|&(way, from, to)| ((way, from), to)).collect();
    let reached: HashSet<_> = shown.iter().map(|&(way, _, to)| (way, to)).collect();
    for &(way, first, _) in shown.iter().filter(|&&(way, from, _)| !reached.contains(&(way, from)))
    {
        let follow = |&node: &usize| next.get(&(way, node)).copied();
        let line: Vec<[f64; 2]> =
            std::iter::successors(Some(first), follow).take(mesh.len()).map(&at).collect();
        match line[..] {
            [from, .., to] if is_straight(&line) => lines.add_line([from, to]),
            _ => lines.add_line(line),
        }
    }
    lines
}

/// Whether points lie on the line from the first to the last, to half a hundredth of a px.
fn is_straight(line: &[[f64; 2]]) -> bool {
    let [Some(from), Some(to)] = [line.first(), line.last()] else { return true };
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    let off = |point: &[f64; 2]| (point[0] - from[0]) * along[1] - (point[1] - from[1]) * along[0];
    line.iter().all(|point| off(point).abs() <= 0.005 * length)
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

#[cfg(test)]
mod tests {
    use super::super::sheet::{Step, hundredths};
    use super::*;
    use myospring_core::mesh::lattice;

    type Piece = [[i32; 2]; 2];

    /// The pieces of lines between neighbouring ones of these points, in order.
    fn pieces(lines: &Path, points: &[[i32; 2]]) -> Vec<Piece> {
        let (mut all, mut from) = (Vec::new(), [0; 2]);
        for step in &lines.steps {
            if let Step::Line(to) = *step {
                let [x, y] = [0, 1].map(|axis: usize| f64::from(to[axis] - from[axis]));
                let length = x.hypot(y);
                let is_on = |point: &&[i32; 2]| {
                    let [a, b] = [0, 1].map(|axis: usize| f64::from(point[axis] - from[axis]));
                    let [along, off] = [(x * a + y * b) / length, (x * b - y * a) / length];
                    off.abs() < 2.0 && (-1.0..=length + 1.0).contains(&along)
                };
                let mut on: Vec<[i32; 2]> = points.iter().filter(is_on).copied().collect();
                on.sort_unstable();
                all.extend(on.windows(2).map(|pair| [pair[0], pair[1]]));
            }
            if let Step::Move(to) | Step::Line(to) = *step {
                from = to;
            }
        }
        all.sort_unstable();
        all
    }

    #[test]
    fn joined_springs_are_all_springs_of_a_lattice_at_rest_and_moved() {
        let whole = lattice::rectangle(9, 6, 5.0).unwrap();
        // A hole and a notch, which part lines.
        let mut cut = whole.clone();
        cut.springs.retain(|spring| {
            let [[a, b], [c, d]] = spring.nodes.map(|node| whole.point(node as usize));
            let [x, y] = [0.5 * (a + c), 0.5 * (b + d)];
            !(x > 10.0 && x < 20.0 && y > 10.0 && y < 20.0 || x > 30.0 && y < 10.0)
        });
        for (mesh, bent) in [(&whole, 0.0), (&whole, 0.2), (&cut, 0.0), (&cut, 0.2)] {
            let at = |node: usize| {
                let [x, y] = mesh.point(node);
                [20.0 * x, 20.0 * y + bent * x * x]
            };
            let points: Vec<[i32; 2]> =
                (0..mesh.len()).map(|node| at(node).map(hundredths)).collect();
            for kind in [SpringKind::Axial, SpringKind::Diagonal] {
                let all = |every: u32| {
                    let of_kind = mesh.springs.iter().filter(|spring| spring.kind == kind);
                    let alone = of_kind.filter_map(|spring| {
                        let [a, b] = spring.nodes.map(|node| node as usize);
                        let [from, to] =
                            [a, b].map(|node| mesh.lattice.as_ref().unwrap().cells[node]);
                        let line = if from[0] == to[0] { from[0] } else { from[1] };
                        let mut ends = [points[a], points[b]];
                        ends.sort_unstable();
                        line.is_multiple_of(every).then_some(ends)
                    });
                    let mut all: Vec<Piece> = alone.collect();
                    all.sort_unstable();
                    all
                };
                let lines = springs(mesh, kind, 1, at);
                assert_eq!(pieces(&lines, &points), all(1), "{kind:?}, bent by {bent}");
                assert!(lines.steps.len() < all(1).len() * 3 / 2);
                if kind == SpringKind::Axial {
                    assert_eq!(pieces(&springs(mesh, kind, 2, at), &points), all(2));
                }
            }
        }
    }
}
