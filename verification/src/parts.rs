//! Parts of a cell that differ in their content of myofibrils: strain beside a closed form and a finer mesh.
//!
//! - A bar with half the myofibrils in one half: away from the border each half is as short as a bar that has its
//!   content everywhere (Saint-Venant).
//! - The built-in cell with a nucleus that has none: the map of strain along the fibre beside that of a mesh four times
//!   finer, on the same equilibrium.

use crate::check::{Failure, Setting};
use crate::row::Row;
use myospring::analysis::shape;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::mechanics::active::{ActiveLaw, FibreStretch, Myofibrils};
use myospring::mechanics::material::{assemble, myofilament_material};
use myospring::mechanics::support::SupportKind;
use myospring::mesh::{Mesh, built_in, lattice};

/// About the peak of an unloaded twitch, kPa.
const TENSION: f64 = 12.0;
const AXIS: [f64; 2] = [1.0, 0.0];
/// Half axes of the nucleus, um.
const NUCLEUS: [f64; 2] = [9.0, 3.6];

/// The strain of parts that differ.
///
/// # Errors
/// A cell that cannot be meshed, or has no equilibrium.
pub fn rows(_setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = halves()?;
    rows.extend(nucleus()?);
    Ok(rows)
}

/// Strain of each triangle along the long axis at the equilibrium of a tension.
fn strain(mesh: &Mesh, content: impl Fn([f64; 2]) -> f64) -> Result<Vec<f64>, Failure> {
    let fibres = vec![AXIS; mesh.simplices.len()];
    let content: Vec<f64> =
        mesh.simplices.iter().map(|triangle| content(mesh.centre(triangle))).collect();
    let (body, system) = assemble(
        mesh,
        &myofilament_material(),
        ActiveLaw::Fibre,
        Myofibrils { directions: &fibres, content: Some(&content) },
        SupportKind::MassCentre,
        AXIS,
        shape::extent(&mesh.points, AXIS),
    );
    let path = Path::solve(&system, &body, TENSION, Tolerance::default())?;
    let positions = path.positions(TENSION).ok_or("the path ends before the tension")?;
    let stretches = FibreStretch::new(mesh, &fibres).stretches(&positions);
    Ok(stretches.into_iter().map(|stretch| 100.0 * (stretch - 1.0)).collect())
}

/// Mean over the triangles about a place.
fn about(mesh: &Mesh, strain: &[f64], near: impl Fn([f64; 2]) -> bool) -> f64 {
    let of = mesh.simplices.iter().zip(strain);
    let of = of.filter(|(triangle, _)| near(mesh.centre(triangle)));
    let (sum, weight) = of.fold((0.0, 0.0), |(sum, weight), (triangle, strain)| {
        (sum + triangle.weight * strain, weight + triangle.weight)
    });
    sum / weight
}

fn halves() -> Result<Vec<Row>, Failure> {
    let mesh = lattice::rectangle(60, 4, 2.0)?;
    let weak = strain(&mesh, |[x, _]| if x < 60.0 { 1.0 } else { 0.5 })?;
    [(1.0, 30.0), (0.5, 90.0)]
        .into_iter()
        .map(|(content, middle)| {
            let there = |[x, _]: [f64; 2]| (x - middle).abs() < 2.0;
            let alone = strain(&mesh, |_| content)?;
            Ok(Row::difference(
                format!(
                    "weak half of a bar: strain in the middle of the half with content {content}"
                ),
                "a bar with that content everywhere, which deforms homogeneously",
                (about(&mesh, &weak, there) - about(&mesh, &alone, there)).abs(),
                1e-4,
                "%",
                "the effect of the border decays within a few widths (Saint-Venant)",
            ))
        })
        .collect()
}

fn nucleus() -> Result<Vec<Row>, Failure> {
    let outline = built_in::adult_ventricular();
    let (usual, _) = lattice::from_outline(&outline, None)?;
    let spacing = usual.lattice.as_ref().ok_or("no lattice")?.spacing;
    let inside = |[x, y]: [f64; 2], grown: f64| {
        let [a, b] = NUCLEUS.map(|half| half + grown);
        (x / a).powi(2) + (y / b).powi(2) < 1.0
    };
    let content = |centre| if inside(centre, 0.0) { 0.0 } else { 1.0 };
    let map = |finer: f64| -> Result<(Mesh, Vec<f64>), Failure> {
        let (mesh, _) = lattice::from_outline(&outline, Some(spacing / finer))?;
        let strain = strain(&mesh, content)?;
        Ok((mesh, strain))
    };
    // Squares of the usual mesh: their means are what two meshes can be compared by.
    let square = |[x, y]: [f64; 2]| [x, y].map(|at| (at / spacing).floor() as i64);
    let means = |(mesh, strain): &(Mesh, Vec<f64>)| {
        let mut sums = std::collections::BTreeMap::<[i64; 2], [f64; 2]>::new();
        for (triangle, strain) in mesh.simplices.iter().zip(strain) {
            let area = triangle.weight
                * myospring::mesh::simplex::measure_at(&mesh.points, triangle.nodes);
            let sum = sums.entry(square(mesh.centre(triangle))).or_default();
            *sum = [sum[0] + area * strain, sum[1] + area];
        }
        sums
    };
    let reference = map(4.0)?;
    let fine = means(&reference);
    let mut rows = Vec::new();
    let mut off = Vec::new();
    for finer in [1.0, 2.0] {
        let own = map(finer)?;
        let own_means = means(&own);
        let both = own_means.iter().filter_map(|(at, own)| Some((own, fine.get(at)?)));
        let whole = both.clone().map(|(_, [_, area])| area).sum::<f64>();
        let mean = both.map(|(a, b)| b[1] * (a[0] / a[1] - b[0] / b[1]).abs()).sum::<f64>() / whole;
        off.push(mean);
        if finer == 1.0 {
            let there = |centre| inside(centre, -2.5);
            rows.push(Row::about(
                "passive nucleus: strain along the fibre within it",
                "a mesh four times finer",
                about(&own.0, &own.1, there),
                about(&reference.0, &reference.1, there),
                0.2,
                "%",
                "the rim of the nucleus consists of squares",
            ));
            let beside = |[x, y]: [f64; 2]| (x.abs() - 12.0).abs() < 1.5 && y.abs() < 1.5;
            rows.push(Row::about(
                "passive nucleus: strain 3 um beyond its ends",
                "a mesh four times finer",
                about(&own.0, &own.1, beside),
                about(&reference.0, &reference.1, beside),
                0.2,
                "%",
                "as above",
            ));
        }
    }
    rows.push(Row::difference(
        "passive nucleus: mean difference of the map of strain over the cell",
        "a mesh four times finer",
        off[0],
        0.1,
        "%",
        "1 % of the strain of the cell",
    ));
    rows.push(Row::difference(
        "the same of a mesh twice as fine, over that of the usual one",
        "below a half where the map converges",
        off[1] / off[0],
        0.6,
        "",
        "the rim of the nucleus converges with order 1",
    ));
    Ok(rows)
}
