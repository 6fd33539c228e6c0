//! The built-in cell flat and thick, with straight fibres: both are homogeneous, so that they differ as their materials do.
//!
//! Fibres along x, stretch a along them and b across. Energy per volume of squares (two sides and two diagonals; `patch` has any
//! direction) and of cubes (three sides, four face diagonals of stretch r and two of stretch b):
//!
//! ```text
//! r = sqrt((a^2 + b^2)/2)
//! W_squares = 3/8 E ((a-1)^2 + (b-1)^2) + 3/4 E (r-1)^2                           + K/2 (a b - 1)^2       + Ta/2 a^2
//! W_cubes   = mu/2 ((a-1)^2 + 2 (b-1)^2) + mu (4 (r-1)^2 + 2 (b-1)^2)             + kappa/2 (a b^2 - 1)^2 + Ta/2 a^2
//! ```

use crate::check::Failure;
use crate::fit::furthest;
use crate::row::Row;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{
    Material, assemble, assemble_thick, default_material, of_thick_cell,
};
use myospring::mechanics::support::SupportKind;
use myospring::mechanics::{Body, System};
use myospring::mesh::profile::Profile;
use myospring::mesh::thick::{self, Form};
use myospring::mesh::{Mesh, built_in};

const TENSION: f64 = 50.0;
const EXACT: Tolerance = Tolerance {
    interpolation: 1e-10,
    equilibrium: 1e-13,
    smallest_step: 1e-4,
    longest_delay: f64::INFINITY,
};

/// Stretches along and across the fibres of least energy, from the energy's gradient.
fn least(gradient: impl Fn([f64; 2]) -> [f64; 2]) -> [f64; 2] {
    const SMALL: f64 = 1e-6;
    let mut at = [1.0, 1.0];
    for _ in 0..30 {
        let [along, across] = gradient(at);
        let slope = |by: [f64; 2]| {
            let (plus, minus) = (
                gradient([at[0] + by[0], at[1] + by[1]]),
                gradient([at[0] - by[0], at[1] - by[1]]),
            );
            [0, 1].map(|i| (plus[i] - minus[i]) / (2.0 * SMALL))
        };
        let (first, second) = (slope([SMALL, 0.0]), slope([0.0, SMALL]));
        let determinant = first[0] * second[1] - second[0] * first[1];
        at[0] -= (along * second[1] - across * second[0]) / determinant;
        at[1] -= (across * first[0] - along * first[1]) / determinant;
    }
    at
}

/// Of squares.
fn of_squares(material: &Material) -> [f64; 2] {
    let (young, area) = (material.young_modulus(), material.area_modulus);
    least(|[a, b]| {
        let r = (0.5 * (a * a + b * b)).sqrt();
        let diagonals = 0.75 * young * (r - 1.0) / r;
        let change = area * (a * b - 1.0);
        [
            0.75 * young * (a - 1.0) + diagonals * a + change * b + TENSION * a,
            0.75 * young * (b - 1.0) + diagonals * b + change * a,
        ]
    })
}

/// Of cubes.
fn of_cubes(material: &Material) -> [f64; 2] {
    let (shear, volume) = (material.shear_modulus(), material.volume_modulus());
    least(|[a, b]| {
        let r = (0.5 * (a * a + b * b)).sqrt();
        let diagonals = 4.0 * shear * (r - 1.0) / r;
        let change = volume * (a * b * b - 1.0);
        [
            shear * (a - 1.0) + diagonals * a + change * b * b + TENSION * a,
            6.0 * shear * (b - 1.0) + diagonals * b + change * 2.0 * a * b,
        ]
    })
}

/// How much a mesh shortens along x, and the largest departure from its closed form, both of its length. How it turned
/// as a whole is left out.
fn compared<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    (body, system): (Body<D>, System<D>),
    [along, across]: [f64; 2],
) -> Result<[f64; 2], Failure> {
    let path = Path::solve(&system, &body, TENSION, EXACT)?;
    let mut now = path.positions(TENSION).ok_or("the path ends before the tension")?;
    let mut expected = mesh.points.clone();
    for (axis, places) in expected.iter_mut().enumerate() {
        let stretch = if axis == 0 { along } else { across };
        for at in places.iter_mut() {
            *at *= stretch;
        }
    }
    for places in now.iter_mut().chain(&mut expected) {
        let mean = places.iter().sum::<f64>() / places.len() as f64;
        for at in places.iter_mut() {
            *at -= mean;
        }
    }
    // The turn that brings it nearest, in one plane after the other.
    let planes: Vec<[usize; 2]> = (0..D).flat_map(|a| (a + 1..D).map(move |b| [a, b])).collect();
    for [a, b] in std::iter::repeat_n(planes, 20).flatten() {
        let dot =
            |i: usize, j: usize| expected[i].iter().zip(&now[j]).map(|(x, y)| x * y).sum::<f64>();
        let (sine, cosine) = (dot(a, b) - dot(b, a)).atan2(dot(a, a) + dot(b, b)).sin_cos();
        for node in 0..mesh.len() {
            let [x, y] = [now[a][node], now[b][node]];
            now[a][node] = cosine * x + sine * y;
            now[b][node] = cosine * y - sine * x;
        }
    }
    let extent = |places: &[f64]| {
        let ends = places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
            [low.min(*at), high.max(*at)]
        });
        ends[1] - ends[0]
    };
    let length = extent(&mesh.points[0]);
    let apart = now.iter().flatten().zip(expected.iter().flatten()).map(|(a, b)| (a - b).abs());
    Ok([1.0 - extent(&now[0]) / length, apart.fold(0.0, f64::max) / length])
}

/// # Errors
/// A cell that has no equilibrium.
pub(super) fn rows() -> Result<Vec<Row>, Failure> {
    let outline = built_in::adult_ventricular();
    let (flat, cubes) = (default_material(), of_thick_cell(&default_material()));
    let (of_flat, of_thick) = (of_squares(&flat), of_cubes(&cubes));
    let axis = [1.0, 0.0, 0.0];
    let mut rows = Vec::new();
    let (mut difference, mut departure) = (0.0_f64, 0.0_f64);
    for profile in [Profile::Round, Profile::Dome, Profile::Slab] {
        let (mesh, thick, _) =
            thick::from_outline(&outline, Form { profile, thickness: 10.0 }, Some(2.0))?;
        let along = vec![[1.0, 0.0]; mesh.simplices.len()];
        let made = assemble(
            &mesh,
            &flat,
            ActiveLaw::Fibre,
            &along,
            SupportKind::MassCentre,
            [1.0, 0.0],
            100.0,
        );
        let [seen_flat, off_flat] = compared(&mesh, made, of_flat)?;
        let mesh = &thick.mesh;
        let along = vec![axis; mesh.simplices.len()];
        let made = assemble_thick(mesh, &cubes, &along, SupportKind::MassCentre, axis, 100.0);
        let [seen_thick, off_thick] = compared(mesh, made, of_thick)?;
        departure = departure.max(off_flat).max(off_thick);
        let own = of_thick[0] - of_flat[0];
        difference = furthest(difference, seen_flat - seen_thick - own);
    }
    let precision = "tolerance of the equilibrium";
    rows.push(Row::difference(
        "the built-in cell at 50 kPa, flat, round, dome and slab: departure of any point from a homogeneous shape",
        "minimum of the homogeneous lattice's energy",
        departure,
        1e-9,
        "of the length",
        precision,
    ));
    rows.push(Row::difference(
        "the same: shortening of the flat less that of the thick cell, less the materials' own difference",
        "minimum of the homogeneous lattice's energy",
        difference,
        1e-9,
        "",
        precision,
    ));
    Ok(rows)
}
