//! A lattice in motion, for LAMMPS to repeat: what it is made of, and where our masses are after
//! thousands of steps. `verification/python/lammps_check.py` reads it.
//!
//! Everything LAMMPS needs is computed here from the mesh and the material's stated constants, not
//! taken from our force laws.

use crate::check::{Failure, Setting};
use crate::engine::Engine;
use crate::row::Row;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{Material, assemble, assemble_thick, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::{Support, SupportKind};
use myospring::mechanics::{Body, System};
use myospring::mesh::{Mesh, SpringKind, cubes, lattice};
use serde::Serialize;

/// A motion that LAMMPS can repeat.
#[derive(Serialize)]
pub struct Case {
    /// Which forces act.
    pub name: &'static str,
    /// um.
    spacing: f64,
    /// ug.
    masses: Vec<f64>,
    /// Resting positions and those at the start, um, by axis; velocities are zero at the start.
    rest: Vec<Vec<f64>>,
    start: Vec<Vec<f64>>,
    springs: Vec<Link>,
    /// 1/ms.
    drag_rate: f64,
    /// ms.
    time_step: f64,
    /// Ours.
    pub runs: Vec<Run>,
}

#[derive(Serialize)]
struct Link {
    nodes: [u32; 2],
    /// nN/um.
    stiffness: f64,
    /// um.
    rest_length: f64,
    /// nN ms/um.
    damping: f64,
}

/// Our positions after a number of steps, um.
#[derive(Serialize)]
pub struct Run {
    /// What made the steps.
    pub engine: String,
    /// The case's time step over that of this run.
    pub finer: u32,
    /// How many there were.
    pub steps: usize,
    /// um, by axis.
    pub positions: Vec<Vec<f64>>,
}

/// Masses, springs and drag to be moved.
struct Lattice<const D: usize, const N: usize> {
    mesh: Mesh<D, N>,
    body: Body<D>,
    system: System<D>,
    damping_ratio: f64,
    /// Stiffness of a full spring, nN/um.
    stiffness: fn(&Material, SpringKind) -> f64,
    material: Material,
}

/// Distance of neighbours along the axes, um.
const SPACING: f64 = 1.5;

fn squares(
    [columns, rows]: [usize; 2],
    damping_ratio: f64,
    drag_ratio: f64,
) -> Result<Lattice<2, 3>, Failure> {
    let mesh = lattice::rectangle(columns, rows, SPACING)?;
    let material = Material { area_modulus: 0.0, damping_ratio, drag_ratio, ..default_material() };
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let (kind, length) = (SupportKind::MassCentre, columns as f64 * SPACING);
    let (body, system) =
        assemble(&mesh, &material, ActiveLaw::Fibre, &fibres, kind, [1.0, 0.0], length);
    let stiffness = |material: &Material, kind| material.spring_stiffness(kind);
    Ok(Lattice { mesh, body, system, damping_ratio, stiffness, material })
}

fn cubes(shape: [usize; 3], damping_ratio: f64, drag_ratio: f64) -> Result<Lattice<3, 4>, Failure> {
    let mesh = cubes::block(shape, SPACING)?;
    // Poisson's ratio of springs alone: no law of volume.
    let (poisson_ratio, usual) = (0.25, default_material());
    let material = Material { poisson_ratio, damping_ratio, drag_ratio, ..usual };
    let fibres = vec![[1.0, 0.0, 0.0]; mesh.simplices.len()];
    let (kind, length) = (SupportKind::MassCentre, shape[0] as f64 * SPACING);
    let (body, system) = assemble_thick(&mesh, &material, &fibres, kind, [1.0, 0.0, 0.0], length);
    // k = (2/5) E h of all springs: see the mesh of cubes.
    let stiffness = |material: &Material, _| 0.4 * material.young_modulus() * SPACING;
    Ok(Lattice { mesh, body, system, damping_ratio, stiffness, material })
}

fn case<const D: usize, const N: usize>(
    name: &'static str,
    lattice: Lattice<D, N>,
    finer: &[u32],
    steps: usize,
) -> Result<Case, Failure> {
    let Lattice { mesh, mut body, mut system, damping_ratio, stiffness, material } = lattice;
    system.support = Support::Free;
    let time_step = 0.25 * StabilityLimit::of(&system, &body, 0.0).time_step;
    // A smooth start, so that the motion stays regular.
    for node in 0..mesh.len() {
        let place = mesh.point(node).map(|x| x / SPACING);
        let (i, j) = (place[0], place[1]);
        let k = place.get(2).copied().unwrap_or(0.0);
        body.positions[0][node] += 0.05 * SPACING * (0.37 * i + 0.61 * j + 0.43 * k).sin();
        body.positions[1][node] += 0.05 * SPACING * (0.53 * i - 0.29 * j + 0.71 * k + 1.0).sin();
    }
    let springs = mesh
        .springs
        .iter()
        .map(|spring| {
            let [a, b] = spring.nodes.map(|node| node as usize);
            let stiffness = spring.share * stiffness(&material, spring.kind);
            let parts = mesh.points.iter().map(|x| x[b] - x[a]);
            let rest_length = parts.fold(0.0, f64::hypot);
            // c = xi 2 sqrt(k m), coelho_2021, Eqs (9) and (11), m the mean of both masses
            let mass = 0.5 * (body.masses[a] + body.masses[b]);
            let damping = damping_ratio * 2.0 * (stiffness * mass).sqrt();
            Link { nodes: spring.nodes, stiffness, rest_length, damping }
        })
        .collect();
    let mut runs = Vec::new();
    for engine in Engine::ALL {
        for &finer in finer {
            let steps = steps * finer as usize;
            let step = time_step / f64::from(finer);
            let mut motion = engine.motion(&mesh, &system, body.clone(), step)?;
            motion.advance(steps, [0.0.into(); 2])?;
            let positions = motion.body().positions.to_vec();
            runs.push(Run { engine: engine.name(), finer, steps, positions });
        }
    }
    Ok(Case {
        name,
        spacing: SPACING,
        masses: body.masses,
        rest: mesh.points.to_vec(),
        start: body.positions.to_vec(),
        springs,
        drag_rate: system.drag.rate,
        time_step,
        runs,
    })
}

/// The motions of a small lattice, whose positions by LAMMPS stand in `verification/reference`.
///
/// # Errors
/// A mesh that cannot be made, forces that an engine does not take.
pub fn small_cases() -> Result<Vec<Case>, Failure> {
    let size = [14, 6];
    Ok(vec![
        case("small, undamped", squares(size, 0.0, 0.0)?, &[1], 500)?,
        case("small, drag", squares(size, 0.0, 0.05)?, &[1], 500)?,
        case("small, dashpots", squares(size, 0.01, 0.0)?, &[1], 500)?,
    ])
}

/// Writes `lammps-ours.json` for the script; gives no rows itself.
///
/// # Errors
/// A mesh that cannot be made, forces that an engine does not take, a file that cannot be written.
pub fn write(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let steps = if setting.quick { 500 } else { 5000 };
    let size = [100, 20];
    let mut cases = vec![
        case("undamped", squares(size, 0.0, 0.0)?, &[1], steps)?,
        case("drag", squares(size, 0.0, 0.05)?, &[1], steps)?,
        case("drag, order", squares(size, 0.0, 0.3)?, &[1, 2, 4], 200)?,
        case("dashpots", squares(size, 0.01, 0.0)?, &[1], steps)?,
    ];
    let size = [24, 8, 6];
    cases.extend([
        case("cubes, undamped", cubes(size, 0.0, 0.0)?, &[1], steps / 5)?,
        case("cubes, drag", cubes(size, 0.0, 0.05)?, &[1], steps / 5)?,
        case("cubes, dashpots", cubes(size, 0.01, 0.0)?, &[1], steps / 5)?,
    ]);
    cases.extend(small_cases()?);
    let file = std::fs::File::create(setting.folder.join("lammps-ours.json"))?;
    serde_json::to_writer(std::io::BufWriter::new(file), &cases)?;
    Ok(Vec::new())
}
