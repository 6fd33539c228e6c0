//! A lattice in motion, for LAMMPS to repeat: what it is made of, and where our masses are after
//! thousands of steps. `verification/python/lammps_check.py` reads it.
//!
//! Everything LAMMPS needs is computed here from the mesh and the material's stated constants, not
//! taken from our force laws.

use crate::check::{Failure, Setting};
use crate::engine::Engine;
use crate::row::Row;
use myospring::mechanics::Vectors;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{Material, assemble, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::{Support, SupportKind};
use myospring::mesh::lattice;
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
    rest: Vectors,
    start: Vectors,
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
    pub positions: Vectors,
}

fn case(
    name: &'static str,
    [columns, rows]: [usize; 2],
    damping_ratio: f64,
    drag_ratio: f64,
    finer: &[u32],
    steps: usize,
) -> Result<Case, Failure> {
    let spacing = 1.5;
    let mesh = lattice::rectangle(columns, rows, spacing)?;
    let material = Material { area_modulus: 0.0, damping_ratio, drag_ratio, ..default_material() };
    let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
    let kind = SupportKind::MassCentre;
    let (mut body, mut system) = assemble(
        &mesh,
        &material,
        ActiveLaw::Fibre,
        &fibres,
        kind,
        [1.0, 0.0],
        columns as f64 * spacing,
    );
    system.support = Support::Free;
    let time_step = 0.25 * StabilityLimit::of(&system, &body, 0.0).time_step;
    // A smooth start, so that the motion stays regular.
    for node in 0..mesh.len() {
        let [i, j] = mesh.point(node).map(|x| x / spacing);
        body.positions[0][node] += 0.05 * spacing * (0.37 * i + 0.61 * j).sin();
        body.positions[1][node] += 0.05 * spacing * (0.53 * i - 0.29 * j + 1.0).sin();
    }
    let springs = mesh
        .springs
        .iter()
        .map(|spring| {
            let [a, b] = spring.nodes.map(|node| node as usize);
            let stiffness = spring.share * material.spring_stiffness(spring.kind);
            let rest_length = (mesh.points[0][b] - mesh.points[0][a])
                .hypot(mesh.points[1][b] - mesh.points[1][a]);
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
            let positions = motion.body().positions.clone();
            runs.push(Run { engine: engine.name(), finer, steps, positions });
        }
    }
    Ok(Case {
        name,
        spacing,
        masses: body.masses,
        rest: mesh.points,
        start: body.positions,
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
        case("small, undamped", size, 0.0, 0.0, &[1], 500)?,
        case("small, drag", size, 0.0, 0.05, &[1], 500)?,
        case("small, dashpots", size, 0.01, 0.0, &[1], 500)?,
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
        case("undamped", size, 0.0, 0.0, &[1], steps)?,
        case("drag", size, 0.0, 0.05, &[1], steps)?,
        case("drag, order", size, 0.0, 0.3, &[1, 2, 4], 200)?,
        case("dashpots", size, 0.01, 0.0, &[1], steps)?,
    ];
    cases.extend(small_cases()?);
    let file = std::fs::File::create(setting.folder.join("lammps-ours.json"))?;
    serde_json::to_writer(std::io::BufWriter::new(file), &cases)?;
    Ok(Vec::new())
}
