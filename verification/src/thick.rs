//! A thick cell: its material, its bending, and what a bed under it does, beside closed forms and a separate program.
//!
//! The separate program (in Python) was written for the design of the lattice, before this one; its numbers were rounded as
//! given here. Timoshenko's beam of length L, section A = b d and shear factor 5/6 under a force P at its end bends by
//!
//! ```text
//! w = P L^3 / (3 E I) + P L / ((5/6) G A)
//! ```

mod beam;
mod flat;

use crate::check::{Failure, Setting, metric};
use crate::fit::furthest;
use crate::random::Random;
use crate::row::Row;
use myospring::integrate::Method;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::interruption::Interruption;
use myospring::mechanics::active::Myofibrils;
use myospring::mechanics::drag::Drag;
use myospring::mechanics::material::{
    Material, Stiffness, assemble_thick, default_material, of_thick_cell,
};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::stiffness::StiffnessMatrix;
use myospring::mechanics::support::{Support, SupportKind};
use myospring::mechanics::volume::VolumePreservation;
use myospring::mechanics::{Body, Configuration, Force, System, Vectors};
use myospring::mesh::outline::Outline;
use myospring::mesh::profile::Profile;
use myospring::mesh::thick::{self, Form};
use myospring::mesh::{Mesh, built_in, cubes};
use myospring::simulation::{Outcome, Simulation};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

const SEPARATE: &str = "a separate program (NumPy)";
const YOUNG: f64 = 300.0;
/// Small strains, at which the material is measured.
const STRAIN: f64 = 1e-4;

/// A thick cell beside closed forms and a separate program.
///
/// # Errors
/// A cell that cannot be meshed, or has no equilibrium.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = material(setting.quick)?;
    rows.extend(locking(setting.quick)?);
    rows.extend(bar(setting.quick)?);
    if !setting.quick {
        rows.extend(inclusion()?);
        rows.extend(flat::rows()?);
    }
    rows.extend(beats()?);
    rows.extend(bed()?);
    rows.extend(beam::rows(setting.quick)?);
    Ok(rows)
}

fn of_ratio(poisson_ratio: f64) -> Material {
    Material { stiffness: Stiffness::YoungModulus(YOUNG), poisson_ratio, ..default_material() }
}

/// Directions evenly spread over the sphere, at random: Marsaglia, Ann. Math. Stat. 43:645 (1972).
fn directions(random: &mut Random, count: usize) -> Vec<[f64; 3]> {
    let mut found = Vec::new();
    while found.len() < count {
        let [a, b] = [0, 1].map(|_| 2.0 * random.uniform() - 1.0);
        let square = a * a + b * b;
        if square < 1.0 {
            let across = 2.0 * (1.0 - square).sqrt();
            found.push([a * across, b * across, 1.0 - 2.0 * square]);
        }
    }
    found
}

/// Young's modulus over that of the material and Poisson's ratio under a small tension along each of some random directions, and the
/// largest departure from an affine map, of the length.
fn material(quick: bool) -> Result<Vec<Row>, Failure> {
    let mesh = cubes::block([20, 4, 3], 2.0)?;
    let count = if quick { 4 } else { 25 };
    let random = &mut Random::new(2026);
    let tolerance = Tolerance { equilibrium: 1e-12, ..Tolerance::default() };
    let mut rows = Vec::new();
    let mut departure = 0.0_f64;
    for poisson in [0.25, 0.4, 0.49, 0.499] {
        let (mut modulus, mut ratio) = (0.0_f64, 0.0_f64);
        for fibre in directions(random, count) {
            let fibres = vec![fibre; mesh.simplices.len()];
            let (body, system) = assemble_thick(
                &mesh,
                &of_ratio(poisson),
                Myofibrils::from(&fibres),
                SupportKind::MassCentre,
                [1.0, 0.0, 0.0],
                40.0,
            );
            let mut path = Path::start(&system, &body, tolerance, &Interruption::default())?;
            let mut measured = |tension: f64| -> Result<[f64; 2], Failure> {
                path.extend(tension)?;
                let now = path.positions(tension).ok_or("the path ends before the tension")?;
                let (gradient, off) = affine(&mesh, &now);
                departure = departure.max(off / 40.0);
                let strain = |u: [f64; 3]| -> f64 {
                    let part = |i: usize, j: usize| gradient[i][j] - f64::from(u8::from(i == j));
                    (0..9).map(|k| u[k / 3] * part(k / 3, k % 3) * u[k % 3]).sum()
                };
                let trace: f64 = (0..3).map(|i| gradient[i][i] - 1.0).sum();
                let along = strain(fibre);
                Ok([-tension / along / YOUNG - 1.0, 0.5 * (1.0 - trace / along) - poisson])
            };
            // Hooke's law is that of no strain: from both signs of a small one, whose square is left.
            let (pull, push) = (measured(STRAIN * YOUNG)?, measured(-STRAIN * YOUNG)?);
            modulus = furthest(modulus, 0.5 * (pull[0] + push[0]));
            ratio = furthest(ratio, 0.5 * (pull[1] + push[1]));
        }
        rows.push(Row::difference(
            format!("Young's modulus of cubes of Poisson's ratio {poisson}, {count} random fibre directions, relative error"),
            "Hooke's law with the given modulus",
            modulus,
            1e-4,
            "",
            "strains of 1e-4 and -1e-4",
        ));
        rows.push(Row::difference(
            format!("Poisson's ratio of cubes, minus {poisson}"),
            "the given ratio",
            ratio,
            1e-4,
            "",
            "as above",
        ));
    }
    rows.push(Row::difference(
        format!("patch test of cubes, four ratios, {count} random fibre directions each: departure from an affine map"),
        "an affine map",
        departure,
        1e-12,
        "of the length",
        "tolerance of the equilibrium",
    ));
    Ok(rows)
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

/// The lowest frequency of a free bar of 128 x 8 x 8 um along its length, over that of a rod whose sides move with it (Rayleigh's).
fn frequency(across: usize, poisson: f64) -> Result<f64, Failure> {
    const HALF_PERIODS: usize = 40;
    let [length, side] = [128.0, 8.0];
    let mesh = cubes::block([16 * across, across, across], side / across as f64)?;
    let material = of_ratio(poisson);
    let density = material.density(length);
    let mut body = Body::at_rest(&mesh, density, 1.0);
    let system = System {
        passive: vec![
            Box::new(material.springs(&mesh, &body.masses)),
            Box::new(VolumePreservation::new(
                &mesh,
                cubes::TETRAHEDRA_OF_A_CUBE,
                material.volume_modulus(),
            )),
        ],
        active: Vec::new(),
        drag: Drag { rate: 0.0, masses: body.masses.clone() },
        support: Support::Free,
    };
    // The rod's own motion, small enough for lengths to change in proportion.
    let wave = PI / length;
    let shape: Vec<f64> = mesh.points[0].iter().map(|x| (wave * x).cos()).collect();
    let amplitude = 1e-6 * length;
    for node in 0..mesh.len() {
        let bulge = amplitude * poisson * wave * (wave * mesh.points[0][node]).sin();
        body.positions[0][node] += amplitude * shape[node];
        for axis in [1, 2] {
            body.positions[axis][node] += bulge * (mesh.points[axis][node] - 0.5 * side);
        }
    }
    let gyration = poisson.powi(2) * side.powi(2) / 6.0 * wave.powi(2);
    let exact = wave * (YOUNG / density).sqrt() * (1.0 - 0.5 * gyration);
    let masses = body.masses.clone();
    let step = 0.2 * StabilityLimit::of(&system, &body, 0.0).time_step;
    let mut motion = Motion::new(&system, body, Integrator::StoermerVerlet, step);
    let along = |positions: &Vectors<3>| -> f64 {
        let moved = positions[0].iter().zip(&mesh.points[0]).map(|(x, rest)| x - rest);
        moved.zip(&masses).zip(&shape).map(|((moved, mass), shape)| mass * moved * shape).sum()
    };
    // Times at which it crosses rest. Other vibrations shift each of them, but hardly the mean of many periods.
    let (mut before, mut crossings) = (along(&motion.body.positions), Vec::new());
    for at in 1_u32.. {
        motion.advance(1, [0.0; 2])?;
        let now = along(&motion.body.positions);
        if before * now <= 0.0 {
            crossings.push((f64::from(at) - now / (now - before)) * step);
        }
        if crossings.len() > HALF_PERIODS {
            break;
        }
        before = now;
    }
    Ok(HALF_PERIODS as f64 * PI / (crossings[HALF_PERIODS] - crossings[0]) / exact)
}

fn bar(quick: bool) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for (poisson, separate) in [(0.25, [0.99967, 0.99992]), (0.45, [0.99976, 0.99994])] {
        for (across, separate) in [2, 4].into_iter().zip(separate) {
            if quick && across > 2 {
                continue;
            }
            rows.push(Row::about(
                format!(
                    "free bar 128 x 8 x 8 um, {across} cubes across, Poisson's ratio {poisson}: lowest frequency along it over \
                     Rayleigh's"
                ),
                SEPARATE,
                frequency(across, poisson)?,
                separate,
                5e-5,
                "",
                "the step in time",
            ));
        }
    }
    Ok(rows)
}

/// A ball that pulls along x within a cube of the same material.
///
/// J. D. Eshelby, Proc. R. Soc. Lond. A 241:376 (1957): in an endless body the strain in the ball is uniform, of the strain that the ball
/// would have alone the part (1 + nu) / (3 (1 - nu)) of its volume and the part 2 (4 - 5 nu) / (15 (1 - nu)) of its shape. Free sides add the
/// same part of what is missing as the ball has of the cube, since the mean strain is that of the ball alone times this part.
fn inclusion() -> Result<Vec<Row>, Failure> {
    const CUBES: usize = 24;
    const RADIUS: f64 = 5.0;
    let poisson = 0.4;
    let mesh = cubes::block([CUBES; 3], 1.0)?;
    let middle = 0.5 * CUBES as f64;
    // The part of a cube that is in the ball, by 8^3 of its points.
    let covered = |corner: [usize; 3]| {
        let inside = |at: &usize| {
            let place = [at % 8, at / 8 % 8, at / 64];
            let square =
                |k: usize| (corner[k] as f64 + (place[k] as f64 + 0.5) / 8.0 - middle).powi(2);
            square(0) + square(1) + square(2) < RADIUS * RADIUS
        };
        (0..512).filter(inside).count() as f64 / 512.0
    };
    let side = CUBES + 1;
    let corner = |node: usize| [node % side, node / side % side, node / (side * side)];
    let parts: Vec<([usize; 3], f64)> = (0..side.pow(3))
        .map(corner)
        .filter(|corner| corner.iter().all(|&at| at < CUBES))
        .map(|corner| (corner, covered(corner)))
        .collect();
    let of_corner: BTreeMap<[usize; 3], f64> = parts.iter().copied().collect();
    let content: Vec<f64> = mesh
        .simplices
        .chunks(cubes::TETRAHEDRA_OF_A_CUBE)
        .flat_map(|tetrahedra| {
            let nodes = tetrahedra.iter().flat_map(|tetrahedron| tetrahedron.nodes);
            let lowest = nodes.map(|node| corner(node as usize)).min().unwrap_or_default();
            vec![of_corner[&lowest]; tetrahedra.len()]
        })
        .collect();
    let directions = vec![[1.0, 0.0, 0.0]; mesh.simplices.len()];
    let myofibrils = Myofibrils { directions: &directions, content: Some(&content) };
    let material = of_ratio(poisson);
    let axis = [1.0, 0.0, 0.0];
    let (body, system) =
        assemble_thick(&mesh, &material, myofibrils, SupportKind::MassCentre, axis, CUBES as f64);
    let tension = STRAIN * YOUNG;
    let path = Path::solve(&system, &body, tension, Tolerance::default())?;
    let now = path.positions(tension).ok_or("the path ends before the tension")?;
    // Means over the ball: of a cube the strain along an axis is that of its four edges.
    let strain = |corner: [usize; 3], axis: usize| {
        let step = side.pow(axis as u32);
        let node = corner[0] + side * (corner[1] + side * corner[2]);
        let across: Vec<usize> = (0..3).filter(|other| *other != axis).collect();
        let edges = (0..4).map(|edge| {
            let from = node
                + (edge % 2) * side.pow(across[0] as u32)
                + (edge / 2) * side.pow(across[1] as u32);
            now[axis][from + step] - now[axis][from] - 1.0
        });
        edges.sum::<f64>() / 4.0
    };
    let whole: f64 = parts.iter().map(|(_, part)| part).sum();
    let mean = |axis: usize| {
        parts.iter().map(|(corner, part)| part * strain(*corner, axis)).sum::<f64>() / whole
    };
    let alone = [-STRAIN, poisson * STRAIN, poisson * STRAIN];
    let volume = alone.iter().sum::<f64>() / 3.0;
    let share = whole / mesh.area();
    let within = |part: f64| share + (1.0 - share) * part;
    let of_volume = within((1.0 + poisson) / (3.0 * (1.0 - poisson)));
    let of_shape = within(2.0 * (4.0 - 5.0 * poisson) / (15.0 * (1.0 - poisson)));
    let rows = [(0, "along"), (1, "across")].map(|(axis, name)| {
        let exact = of_volume * volume + of_shape * (alone[axis] - volume);
        Row::about(
            format!(
                "a ball of 10 um that pulls in a cube of 24 um, Poisson's ratio {poisson}: strain {name} the fibre, over that along it \
                 without the cube"
            ),
            "Eshelby (1957), with free sides",
            mean(axis) / STRAIN,
            exact / STRAIN,
            0.3 * share,
            "",
            "the ball is 4 % of the cube, whose sides do not add an even strain",
        )
    });
    Ok(rows.into())
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
