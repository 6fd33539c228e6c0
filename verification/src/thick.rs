//! A thick cell: its material, its bending, and what a bed under it does, beside closed forms and a separate program.
//!
//! The separate program (in Python) was written for the design of the lattice, before this one; its numbers were rounded as
//! given here. Timoshenko's beam of length L, section A = b d and shear factor 5/6 under a force P at its end bends by
//!
//! ```text
//! w = P L^3 / (3 E I) + P L / ((5/6) G A)
//! ```

use crate::check::{Failure, Setting, metric};
use crate::row::Row;
use myospring::integrate::Method;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::mechanics::active::Myofibrils;
use myospring::mechanics::drag::Drag;
use myospring::mechanics::material::{
    Material, Stiffness, assemble_thick, default_material, of_thick_cell,
};
use myospring::mechanics::stiffness::StiffnessMatrix;
use myospring::mechanics::support::{Support, SupportKind};
use myospring::mechanics::volume::VolumePreservation;
use myospring::mechanics::{Body, Configuration, Force, System, Vectors};
use myospring::mesh::outline::Outline;
use myospring::mesh::profile::Profile;
use myospring::mesh::thick::{self, Form};
use myospring::mesh::{Mesh, built_in, cubes};
use myospring::simulation::{Outcome, Simulation};
use std::sync::Arc;

const SEPARATE: &str = "a separate program (NumPy)";
const YOUNG: f64 = 300.0;

/// A thick cell beside closed forms and a separate program.
///
/// # Errors
/// A cell that cannot be meshed, or has no equilibrium.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = material()?;
    rows.extend(locking(setting.quick)?);
    rows.extend(beats()?);
    rows.extend(bed()?);
    Ok(rows)
}

fn of_ratio(poisson_ratio: f64) -> Material {
    Material { stiffness: Stiffness::YoungModulus(YOUNG), poisson_ratio, ..default_material() }
}

/// Young's modulus over that of the material and Poisson's ratio under a small tension along each of some directions, and the largest
/// departure from an affine map, of the length.
fn material() -> Result<Vec<Row>, Failure> {
    let mesh = cubes::block([20, 4, 3], 2.0)?;
    let directions = [
        [1.0, 0.0, 0.0],
        [0.6, 0.8, 0.0],
        [0.36, 0.48, 0.8],
        [0.0, 0.8, -0.6],
        [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0],
    ];
    let mut rows = Vec::new();
    let mut departure = 0.0_f64;
    for poisson in [0.25, 0.4, 0.49, 0.499] {
        let (mut modulus, mut ratio) = (0.0_f64, 0.0_f64);
        for fibre in directions {
            let tension = 1e-4 * YOUNG;
            let fibres = vec![fibre; mesh.simplices.len()];
            let (body, system) = assemble_thick(
                &mesh,
                &of_ratio(poisson),
                Myofibrils::from(&fibres),
                SupportKind::MassCentre,
                [1.0, 0.0, 0.0],
                40.0,
            );
            let path = Path::solve(&system, &body, tension, Tolerance::default())?;
            let now = path.positions(tension).ok_or("the path ends before the tension")?;
            let (gradient, off) = affine(&mesh, &now);
            departure = departure.max(off / 40.0);
            let strain = |u: [f64; 3]| -> f64 {
                let part = |i: usize, j: usize| gradient[i][j] - f64::from(u8::from(i == j));
                (0..9).map(|k| u[k / 3] * part(k / 3, k % 3) * u[k % 3]).sum()
            };
            let trace: f64 = (0..3).map(|i| gradient[i][i] - 1.0).sum();
            let along = strain(fibre);
            modulus = furthest(modulus, -tension / along / YOUNG - 1.0);
            ratio = furthest(ratio, 0.5 * (1.0 - trace / along) - poisson);
        }
        rows.push(Row::difference(
            format!("Young's modulus of cubes of Poisson's ratio {poisson}, five fibre directions, relative error"),
            "Hooke's law with the given modulus",
            modulus,
            1e-3,
            "",
            "strain of 1e-4, and the pressure of a nearly incompressible block",
        ));
        rows.push(Row::difference(
            format!("Poisson's ratio of cubes, minus {poisson}"),
            "the given ratio",
            ratio,
            2e-3,
            "",
            "as above",
        ));
    }
    rows.push(Row::difference(
        "patch test of cubes, four ratios, five fibre directions: departure from an affine map",
        "an affine map",
        departure,
        1e-9,
        "of the length",
        "tolerance of the equilibrium",
    ));
    Ok(rows)
}

fn furthest(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

/// `x = F X + c` by least squares over the block's opposite corners, and the largest distance of a node from it, um.
fn affine(mesh: &Mesh<3, 4>, now: &Vectors<3>) -> ([[f64; 3]; 3], f64) {
    let shape = [21, 5, 4];
    let ends = [20, 4 * shape[0], 3 * shape[0] * shape[1]];
    let size = [40.0, 8.0, 6.0];
    let origin = [0, 1, 2].map(|axis: usize| now[axis][0]);
    let gradient: [[f64; 3]; 3] =
        [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| (now[i][ends[j]] - origin[i]) / size[j]));
    let mut worst = 0.0_f64;
    for node in 0..mesh.len() {
        let rest = mesh.point(node);
        for i in 0..3 {
            let there = origin[i] + (0..3).map(|j| gradient[i][j] * rest[j]).sum::<f64>();
            worst = worst.max((now[i][node] - there).abs());
        }
    }
    (gradient, worst)
}

/// A load on some nodes that does not turn with them.
struct Load {
    nodes: Vec<(usize, f64)>,
    axis: usize,
}

impl Force<3> for Load {
    fn name(&self) -> &'static str {
        "load"
    }

    fn add_forces(&self, _at: &Configuration<'_, 3>, forces: &mut Vectors<3>) {
        for &(node, force) in &self.nodes {
            forces[self.axis][node] += force;
        }
    }

    fn energy(&self, at: &Configuration<'_, 3>) -> Option<f64> {
        Some(-self.nodes.iter().map(|&(node, f)| f * at.positions[self.axis][node]).sum::<f64>())
    }

    fn add_stiffness(&self, _: &Configuration<'_, 3>, _: &mut StiffnessMatrix<3>) -> bool {
        true
    }

    fn is_internal(&self) -> bool {
        false
    }
}

/// How far the end of a cantilever of 40 x 8 x 8 um bends, over what Timoshenko's beam does. Each `group` of tetrahedra keeps its
/// volume.
fn cantilever(across: usize, poisson: f64, group: usize) -> Result<f64, Failure> {
    let h = 8.0 / across as f64;
    let mesh = cubes::block([5 * across, across, across], h)?;
    let material = of_ratio(poisson);
    let body = Body::at_rest(&mesh, material.density(40.0), 1.0);
    let on_face = |x: f64| -> Vec<usize> {
        (0..mesh.len()).filter(|&node| (mesh.points[0][node] - x).abs() < 1e-9).collect()
    };
    let (held, end) = (on_face(0.0), on_face(40.0));
    let whole: f64 = end.iter().map(|&node| mesh.areas[node]).sum();
    let force = 1e-3;
    let load = end.iter().map(|&node| (node, force * mesh.areas[node] / whole)).collect();
    let system = System {
        passive: vec![
            Box::new(material.springs(&mesh, &body.masses)),
            Box::new(VolumePreservation::new(&mesh, group, material.volume_modulus())),
            Box::new(Load { nodes: load, axis: 2 }),
        ],
        active: Vec::new(),
        drag: Drag { rate: 0.0, masses: body.masses.clone() },
        support: Support::Clamped(held),
    };
    let path = Path::solve(&system, &body, 0.0, Tolerance::default())?;
    let now = path.positions(0.0).ok_or("the beam has no shape at rest")?;
    let moved: f64 = end
        .iter()
        .map(|&node| mesh.areas[node] / whole * (now[2][node] - mesh.points[2][node]))
        .sum();
    let shear = YOUNG / (2.0 * (1.0 + poisson));
    let (length, side): (f64, f64) = (40.0, 8.0);
    let inertia = side.powi(4) / 12.0;
    let exact = force * length.powi(3) / (3.0 * YOUNG * inertia)
        + force * length / (5.0 / 6.0 * shear * side * side);
    Ok(moved / exact)
}

fn locking(quick: bool) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let layers = [2, 4, 8];
    for (poisson, by_cube, by_tetrahedron) in [
        (0.45, [0.810, 0.914, 0.951], [0.626, 0.817, 0.914]),
        (0.49, [0.801, 0.905, 0.943], [0.436, 0.646, 0.804]),
        (0.499, [0.798, 0.903, 0.941], [0.195, 0.377, 0.556]),
    ] {
        let groups =
            [(cubes::TETRAHEDRA_OF_A_CUBE, by_cube, "cube"), (1, by_tetrahedron, "tetrahedron")];
        for (group, expected, kept) in groups {
            for (across, expected) in layers.into_iter().zip(expected) {
                if quick && across > 4 {
                    continue;
                }
                rows.push(Row::about(
                    format!(
                        "cantilever {across} cubes thick, Poisson's ratio {poisson}, volume kept by {kept}: deflection over \
                         Timoshenko's"
                    ),
                    SEPARATE,
                    cantilever(across, poisson, group)?,
                    expected,
                    0.0006,
                    "",
                    "half of the last digit",
                ));
            }
        }
    }
    Ok(rows)
}

fn cell(outline: &Outline, form: Form, spacing: f64) -> Result<Simulation, Failure> {
    let (mesh, thick, _) = thick::from_outline(outline, form, Some(spacing))?;
    let mut simulation = Simulation::new(mesh);
    simulation.thick = Some(Arc::new(thick));
    simulation.material = of_thick_cell(&default_material());
    simulation.numerics.method = Method::QuasiStatic;
    Ok(simulation)
}

fn beaten(simulation: &Simulation) -> Result<Outcome, Failure> {
    let outcome = simulation.build()?.run(|_| true);
    match outcome.stop {
        None => Ok(outcome),
        Some(stop) => Err(stop.into()),
    }
}

fn beats() -> Result<Vec<Row>, Failure> {
    let form = Form { profile: Profile::Round, thickness: 10.0 };
    let mut simulation = cell(&built_in::adult_ventricular(), form, 2.0)?;
    let mut rows = Vec::new();
    let digits = "half of the last digit";
    for (tension, expected) in [(50.0, 12.00), (40.0, 9.96), (30.0, 7.75)] {
        simulation.peak_tension = tension;
        let outcome = beaten(&simulation)?;
        rows.push(Row::about(
            format!("the built-in cell, round, 10 um thick: shortening at {tension} kPa"),
            SEPARATE,
            metric(&outcome, "peak_shortening")?,
            expected,
            0.006,
            "%",
            digits,
        ));
        if tension == 50.0 {
            for (what, name, expected) in [
                ("widening", "width_change_at_peak", 6.43),
                ("thickening", "peak_thickening", 6.43),
                ("area", "area_change_at_peak", -6.34),
                ("volume", "volume_change", -0.32),
            ] {
                let found = metric(&outcome, name)?;
                let what = format!("the same at 50 kPa: {what}");
                rows.push(Row::about(what, SEPARATE, found, expected, 0.006, "%", digits));
            }
        }
    }
    Ok(rows)
}

fn bed() -> Result<Vec<Row>, Failure> {
    let square = r#"{"type":"Polygon","coordinates":[[[0,0],[100,0],[100,20],[0,20],[0,0]]]}"#;
    let form = Form { profile: Profile::Slab, thickness: 10.0 };
    let mut simulation = cell(&Outline::from_geojson(square)?, form, 2.0)?;
    let mut rows = Vec::new();
    for (stiffness, bottom, top) in [(0.1, 11.37, 12.25), (1.0, 9.16, 11.76), (10.0, 3.96, 7.81)] {
        simulation.support = SupportKind::ElasticBed { stiffness };
        let outcome = beaten(&simulation)?;
        let frames = &outcome.recording.in_space;
        let shortest = frames.iter().max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa));
        let x = &shortest.ok_or("the beat has no shapes")?.positions[0];
        let points = &simulation.thick.as_ref().ok_or("the cell is flat")?.mesh.points;
        for (face, height, expected) in [("lower", 0.0, bottom), ("upper", 10.0, top)] {
            let middle = |node: &usize| points[1][*node] == 10.0 && points[2][*node] == height;
            let row: Vec<usize> = (0..x.len()).filter(middle).collect();
            let ends = row.first().zip(row.last()).ok_or("the slab has no middle")?;
            rows.push(Row::about(
                format!(
                    "slab of 100 x 20 x 10 um on a bed of {stiffness} kPa/um at 50 kPa: shortening of the {face} face"
                ),
                SEPARATE,
                100.0 - (x[*ends.1] - x[*ends.0]),
                expected,
                0.06,
                "%",
                "both have some ten cubes across",
            ));
        }
    }
    Ok(rows)
}
