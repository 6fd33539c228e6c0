//! A cell that never was: lattice meshes and a beat from formulas, to try the output with.

use myospring::mesh::{Lattice, Mesh, Simplex, Spring, SpringKind};
use myospring::recording::{Frame, Recording, Sample};

/// Time of the stimulus, ms.
pub(crate) const STIMULUS: f64 = 50.0;
/// Time of the greatest tension, ms.
pub(crate) const PEAK: f64 = 171.5;

/// A Moore lattice over the squares whose middle lies in the cell.
pub(crate) fn lattice(size: [f64; 2], spacing: f64, inside: impl Fn(f64, f64) -> bool) -> Mesh {
    let shape = size.map(|length| (length / spacing).round() as usize + 1);
    let origin = size.map(|length| -length / 2.0);
    let at = |column: usize, row: usize| {
        [origin[0] + column as f64 * spacing, origin[1] + row as f64 * spacing]
    };
    let mut node = vec![None; shape[0] * shape[1]];
    let mut mesh = Mesh {
        points: [vec![], vec![]],
        areas: vec![],
        springs: vec![],
        simplices: vec![],
        lattice: None,
    };
    let mut cells = vec![];
    let mut springs = std::collections::BTreeMap::new();
    for row in 0..shape[1] - 1 {
        for column in 0..shape[0] - 1 {
            let [x, y] = at(column, row);
            if !inside(x + spacing / 2.0, y + spacing / 2.0) {
                continue;
            }
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, up)| {
                let (column, row) = (column + right, row + up);
                *node[row * shape[0] + column].get_or_insert_with(|| {
                    let [x, y] = at(column, row);
                    mesh.points[0].push(x);
                    mesh.points[1].push(y);
                    mesh.areas.push(0.0);
                    cells.push([column as u32, row as u32]);
                    cells.len() as u32 - 1
                })
            });
            let [a, b, c, d] = corners;
            for corner in corners {
                mesh.areas[corner as usize] += spacing * spacing / 4.0;
            }
            for nodes in [[a, b, c], [a, c, d], [a, b, d], [b, c, d]] {
                mesh.simplices.push(Simplex { nodes, weight: 0.5 });
            }
            for (i, j, kind, share) in [
                (a, b, SpringKind::Axial, 0.5),
                (b, c, SpringKind::Axial, 0.5),
                (d, c, SpringKind::Axial, 0.5),
                (a, d, SpringKind::Axial, 0.5),
                (a, c, SpringKind::Diagonal, 1.0),
                (b, d, SpringKind::Diagonal, 1.0),
            ] {
                springs.entry([i, j]).or_insert((kind, 0.0)).1 += share;
            }
        }
    }
    mesh.springs =
        springs.into_iter().map(|(nodes, (kind, share))| Spring { nodes, kind, share }).collect();
    mesh.lattice = Some(Lattice { spacing, shape, origin, cells });
    mesh
}

/// A long, brick-like myocyte, 140 um x 21 um.
pub(crate) fn elongated(spacing: f64) -> Mesh {
    lattice([140.0, 22.0], spacing, |x, y| {
        (x / 70.0).abs().powi(8) + (y / (10.6 + 0.6 * (x / 15.0).sin())).abs().powi(6) < 1.0
    })
}

/// A roundish cell, 110 um x 77 um, its long axis turned by 25 degrees, and that axis.
pub(crate) fn roundish(spacing: f64) -> (Mesh, [f64; 2]) {
    let (sin, cos) = 25f64.to_radians().sin_cos();
    let mesh = lattice([112.0, 84.0], spacing, |x, y| {
        let (a, b) = (cos * x + sin * y, cos * y - sin * x);
        let r = 1.0 + 0.05 * (3.0 * b.atan2(a)).cos();
        (a / 57.0).powi(2) + (b / 34.0).powi(2) < r * r
    });
    (mesh, [cos, sin])
}

/// Active tension relative to its peak: rises within 120 ms, falls more slowly.
pub(crate) fn tension(t: f64) -> f64 {
    let x = (t - STIMULUS - 15.0) / (PEAK - STIMULUS - 15.0);
    if x <= 0.0 { 0.0 } else { (x * (1.0 - x).exp()).powf(2.4) }
}

/// The dimensionless potential of one action potential.
pub(crate) fn potential(t: f64) -> f64 {
    let x = t - STIMULUS;
    if x < 0.0 {
        0.0
    } else {
        let plateau = 1.0 / (1.0 + ((x - 240.0) / 18.0).exp());
        let notch = 0.2 * (-x / 6.0).exp() - 0.16 * (-(x - 14.0).powi(2) / 120.0).exp();
        (1.0 - (-x / 0.4).exp()) * plateau * (1.0 + notch - 0.0006 * x)
    }
}

/// A beat of `peak_tension` kPa: 12 % shorter and 6.6 % wider at 50 kPa, along `fibre`.
pub(crate) fn recording(mesh: &Mesh, fibre: [f64; 2], peak_tension: f64, in_mv: bool) -> Recording {
    let scale = peak_tension / 50.0;
    // The ends of a cell shorten a little more than its middle.
    let along = |a: f64, s: f64| a * (1.0 - s * (0.88 + 0.12 * (a / 60.0).powi(2)));
    let samples = (0..=1200)
        .map(|i| {
            let t = 0.5 * f64::from(i);
            let s = scale * tension(t);
            let u = potential(t);
            let (length, width) = (140.0 * (1.0 - 0.12 * s), 21.0 * (1.0 + 0.066 * s));
            Sample {
                t_ms: t,
                u: Some(u),
                vm_mv: in_mv.then_some(85.7 * u - 84.0),
                ta_kpa: 50.0 * s,
                length_um: length,
                width_um: width,
                area_um2: length * width,
                shortening_pct: 12.0 * s,
                elastic_energy_fj: 3.1e4 * s * s,
                kinetic_energy_fj: 0.2 * s,
                active_work_fj: 3.3e4 * s * s,
                dissipated_energy_fj: 2e3 * s,
                ..Sample::STILL
            }
        })
        .collect();
    let frames = (0..=120)
        .map(|i| {
            let t = 5.0 * f64::from(i);
            let s = scale * tension(t);
            let (xs, ys) = mesh.points[0]
                .iter()
                .zip(&mesh.points[1])
                .map(|(&x, &y)| {
                    let (a, b) = (fibre[0] * x + fibre[1] * y, fibre[0] * y - fibre[1] * x);
                    let (a, b) = (along(a, 0.12 * s), b * (1.0 + 0.066 * s));
                    (fibre[0] * a - fibre[1] * b, fibre[1] * a + fibre[0] * b)
                })
                .unzip();
            Frame { t_ms: t, ta_kpa: 50.0 * s, ta_by_triangle_kpa: None, positions: [xs, ys] }
        })
        .collect();
    Recording { samples, frames, ..Recording::default() }
}
