//! A cell on a gel: closed forms of the gel, balance of forces and energy, pyTFM, and measured forces.
//!
//! `reference/pytfm.csv` has the forces that pyTFM finds in the displacements of the gel around the built-in cell, made by
//! `python/pytfm_reference.py`: Fourier transforms of a window, where ours is a sum in space. The measured forces are
//! those of cells from stem cells on two gels (CONTRAX 2024, Table 1), of which the preset `hipsc-on-gel` has the first.

use crate::check::{Failure, Setting, metric};
use crate::row::Row;
use myospring::experiment::traction::{Beads, CellPlace, Traction};
use myospring::experiment::{Experiment, Files};
use myospring::mechanics::compliance::Compliance;
use myospring::mechanics::gel::{Gel, GelBed, cytometry};
use myospring::mechanics::support::SupportKind;
use myospring::mesh::outline::Outline;
use myospring::mesh::{Mesh, built_in, lattice};
use myospring::prelude::*;
use myospring::recording::{AXIAL_FORCE, CONTRACTILE_MOMENT};
use myospring::run_file::{PRESETS, RunFile};
use myospring::simulation::Outcome;
use serde::Deserialize;
use std::f64::consts::{PI, TAU};

/// Forces of pyTFM, nN.
#[derive(Debug, Clone, Copy, Deserialize)]
#[allow(non_snake_case, reason = "the table's own names")]
struct Found {
    gel_kPa: f64,
    total_nN: f64,
    axial_nN: f64,
}

fn disc(radius: f64, spacing: f64) -> Result<Mesh, Failure> {
    let corner = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / 360.0).sin_cos();
        [radius * cos, radius * sin]
    };
    let outline = Outline::new((0..360).map(corner).collect(), Vec::new())?;
    Ok(lattice::from_outline(&outline, Some(spacing))?.0)
}

/// Displacement of the middle of a mesh under an even traction of 1 kPa along x, um.
fn middle(gel: Gel, mesh: &Mesh) -> Result<f64, Failure> {
    let bed = GelBed::new(gel, mesh, [1.0, 0.0])?;
    let [moved, _] = bed.displaced(&[mesh.areas.clone(), vec![0.0; mesh.len()]]);
    let away = |node: &usize| mesh.point(*node).iter().map(|x| x * x).sum::<f64>();
    let node = (0..mesh.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
    Ok(moved[node.ok_or("a mesh without nodes")?])
}

/// The beat of the built-in cell on a gel of this modulus, kPa.
fn beat(modulus: f64, spacing: f64) -> Result<(Simulation, Outcome), Failure> {
    let (mesh, _) = lattice::from_outline(&built_in::adult_ventricular(), Some(spacing))?;
    let support = SupportKind::Gel(Gel::half_space(modulus));
    let mut simulation = Simulation { support, ..Simulation::new(mesh) };
    simulation.numerics.method = Method::QuasiStatic;
    let outcome = simulation.build()?.run(|_| true);
    Ok((simulation, outcome))
}

/// The sum of absolute tractions, nN, that displacements of the gel around a cell at its largest force give, in a region 2 um
/// wider than the cell.
fn back(simulation: &Simulation, outcome: &Outcome) -> Result<f64, Failure> {
    let SupportKind::Gel(gel) = simulation.support else { return Err("no gel".into()) };
    let bed = GelBed::new(gel, &simulation.mesh, simulation.long_axis)?;
    let frames = outcome.recording.frames.iter();
    let frame = frames.max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa)).ok_or("no frames")?;
    let forces = frame.on_gel_nn.as_ref().ok_or("no forces")?;
    let attached = |axis: usize| bed.nodes().iter().map(|&node| forces[axis][node]).collect();
    let surface = bed.surface(&[attached(0), attached(1)], 0.5);
    let mesh = &simulation.mesh;
    let inside = surface.within(|[x, y]| {
        (0..mesh.len()).any(|node| {
            let [a, b] = mesh.point(node);
            (x - a).hypot(y - b) < 2.0
        })
    });
    let spacing = surface.spacing;
    let found =
        cytometry::tractions(&gel, &[surface], Some(&inside), cytometry::Errors::default())?;
    Ok(found.first().ok_or("nothing found")?.force_nn(spacing, None))
}

/// Makes the rows.
///
/// # Errors
/// A mesh or run that breaks off, a table that cannot be read.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = closed_forms(setting.quick)?;
    rows.extend(balances()?);
    rows.extend(spacing(setting.quick)?);
    let table = include_str!("../reference/pytfm.csv");
    for found in csv::Reader::from_reader(table.as_bytes()).deserialize() {
        let Found { gel_kPa, total_nN, axial_nN } = found?;
        let (simulation, outcome) = beat(gel_kPa, 1.2)?;
        let back = back(&simulation, &outcome)?;
        rows.push(Row::difference(
            format!("displacements around that cell on {gel_kPa} kPa, back to forces: sum of absolute tractions"),
            "the forces that made them",
            back / metric(&outcome, "peak_traction_force")? - 1.0,
            0.05,
            "of them",
            "the map is smoothed",
        ));
        rows.push(Row::difference(
            format!("the same on {gel_kPa} kPa, beside pyTFM on these displacements"),
            "pyTFM 1.3.5",
            back / total_nN - 1.0,
            0.05,
            "of its",
            "two ways to smooth",
        ));
        for (name, what, theirs) in [
            ("peak_traction_force", "sum of absolute tractions", total_nN),
            ("peak_axial_force", "force of half the cell along it", axial_nN),
        ] {
            rows.push(Row::difference(
                format!("built-in cell on a gel of {gel_kPa} kPa: {what}"),
                "pyTFM 1.3.5",
                theirs / metric(&outcome, name)? - 1.0,
                0.05,
                "of ours",
                "its window wraps round, and its pixels blur tractions at the rim of the cell",
            ));
        }
    }
    rows.extend(measured()?);
    rows.extend(beads()?);
    Ok(rows)
}

fn closed_forms(quick: bool) -> Result<Vec<Row>, Failure> {
    let half = Gel::half_space(5.0);
    let spacing = if quick { 0.5 } else { 0.25 };
    let mesh = disc(10.0, spacing)?;
    let radius = (mesh.area() / PI).sqrt();
    let mut rows = Vec::new();
    for poisson in [0.0, 0.3, 0.49] {
        let gel = Gel { poisson, ..half };
        rows.push(Row::difference(
            format!("even traction on a disc, nu = {poisson}: displacement of its middle"),
            "half-space: q a (1 + nu)(2 - nu)/E (Cerruti; Landau and Lifshitz 1986, section 8)",
            middle(gel, &mesh)? / (radius * (1.0 + poisson) * (2.0 - poisson) / 5.0) - 1.0,
            3e-3,
            "",
            "a disc of squares: its rim is rough by a part of the spacing",
        ));
        let thin = Gel { thickness: Some(1.0), ..gel };
        rows.push(Row::difference(
            format!("even traction on a disc, layer of a tenth of its radius, nu = {poisson}: displacement of its middle"),
            "thin layer: q h/G",
            middle(thin, &mesh)? * thin.shear_modulus() - 1.0,
            2e-3,
            "",
            "the rim is ten thicknesses away",
        ));
        let of = |thickness| middle(Gel { thickness, ..gel }, &mesh);
        let ratio = (of(None)? - of(Some(500.0))?) / (of(None)? - of(Some(1000.0))?);
        rows.push(Row::about(
            format!("thick layers, nu = {poisson}: what is missing to a half-space, of one over one twice as thick"),
            "theory: goes as radius over thickness",
            ratio,
            2.0,
            0.02,
            "",
            "the next term is of the order of the cube of radius over thickness",
        ));
    }
    Ok(rows)
}

fn balances() -> Result<Vec<Row>, Failure> {
    let (simulation, outcome) = beat(10.0, 1.2)?;
    let (_, system) = simulation.mechanics();
    let gel = system.compliance().ok_or("the cell is on no gel")?;
    let frames = outcome.recording.frames.iter();
    let peak = frames.max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa)).ok_or("no frames")?;
    let forces = gel.forces(&gel.displacements(&peak.positions));
    let size: f64 = forces.iter().flatten().map(|force| force.abs()).sum();
    let net = forces.each_ref().map(|axis| axis.iter().sum::<f64>());
    let turn = |(place, &node): (usize, &usize)| {
        peak.positions[0][node] * forces[1][place] - peak.positions[1][node] * forces[0][place]
    };
    let torque: f64 = gel.nodes().iter().enumerate().map(turn).sum();
    let samples = outcome.recording.samples.iter();
    let last = samples.max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa)).ok_or("no samples")?;
    let law = "law of conservation";
    Ok(vec![
        Row::difference(
            "built-in cell on a gel of 10 kPa at its peak: sum of tractions",
            law,
            net[0].hypot(net[1]) / size,
            1e-6,
            "of the sum of their sizes",
            "what Newton's method leaves",
        ),
        Row::difference(
            "the same: moment of tractions",
            law,
            torque / (140.0 * size),
            1e-6,
            "of size times length",
            "what Newton's method leaves",
        ),
        Row::difference(
            "the same: work of tension, less the energy of cell and gel",
            law,
            last.active_work_fj / last.elastic_energy_fj - 1.0,
            1e-3,
            "of the energy",
            "work is a sum over eight parts of a load step",
        ),
    ])
}

fn spacing(quick: bool) -> Result<Vec<Row>, Failure> {
    let force = |spacing| metric(&beat(10.0, spacing)?.1, "peak_traction_force");
    let finest = if quick { 0.8 } else { 0.5 };
    let reason = "a mesh this much finer differs by about a quarter of that";
    let difference = force(1.2)? / force(finest)? - 1.0;
    let what = format!(
        "built-in cell on a gel of 10 kPa: force at the usual spacing, 1.2 um, beside {finest} um"
    );
    Ok(vec![Row::difference(what, "convergence", difference, 0.02, "", reason)])
}

/// The preset of a cell from stem cells, on the gel that it was fitted to, and on the stiffer one.
fn measured() -> Result<Vec<Row>, Failure> {
    let preset = PRESETS.iter().find(|preset| preset.name == "hipsc-on-gel").ok_or("no preset")?;
    let none = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    let force = |gel: &str| -> Result<f64, Failure> {
        let mut file = RunFile::from_text(preset.text)?;
        file.set("mechanics.gel_modulus", gel)?;
        let run = file.resolve()?;
        let made = run.make(run.shape.mesh(&run.shape.bytes(none)?)?, none)?;
        metric(&made.simulation.build()?.run(|_| true), "peak_axial_force")
    };
    let against = "CONTRAX 2024, Table 1";
    Ok(vec![
        Row::about(
            "cell from stem cells on a gel of 10 kPa: force of half the cell",
            against,
            force("10 kPa")?,
            13.9,
            0.05,
            "nN",
            "fitted to it by T_ref",
        ),
        Row::about(
            "the same cell on a gel of 35 kPa, predicted",
            against,
            force("35 kPa")?,
            23.7,
            4.2,
            "nN",
            "measured: 23.3 nN, 95 % from 19.5 to 27.9",
        ),
    ])
}

/// The cell that the film of beads of the tutorial was made from (`examples/bead_tutorial.rs`).
const FILMED: &str = "shape.built_in = \"hipsc_derived\"\nmaterial.young_modulus = \"40 kPa\"\nmaterial.area_modulus = \
                      \"22.7 kPa\"\nmaterial.thickness = \"5 um\"\ncell.peak_tension = \"2.7 kPa\"\nmechanics.support = \
                      \"gel\"\nmechanics.gel_modulus = \"10 kPa\"\nnumerics.integrator = \"quasi-static\"";

/// A film of beads with noise, made from a simulated cell: what it gives back.
fn beads() -> Result<Vec<Row>, Failure> {
    let held = [
        ("beads.tif", &include_bytes!("../../examples/tutorial/beads.tif")[..]),
        ("around.geojson", include_bytes!("../../examples/tutorial/around.geojson")),
    ];
    let files = Files::holding(held.map(|(name, bytes)| (name.to_owned(), bytes.to_vec())).into());
    let description = Traction::of_beads(Beads::of("beads.tif"), Gel::half_space(10.0));
    let found =
        Traction { cell: Some(CellPlace::of("around.geojson")), ..description }.run(&files, &())?;
    let frame = found.strongest();
    let none = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    let run = RunFile::from_text(FILMED)?.resolve()?;
    let made = run.make(run.shape.mesh(&run.shape.bytes(none)?)?, none)?;
    let recording = made.simulation.build()?.run(|_| true).recording;
    let time = frame.t_ms.ok_or("a film without times")?;
    let place = recording.samples.iter().position(|sample| sample.t_ms >= time - 1e-6);
    let place = place.ok_or("the run is shorter than the film")?;
    let truth = |name: &str| -> Result<f64, Failure> {
        let signal = recording.signals.iter().find(|signal| signal.name == name);
        Ok(signal.ok_or("no force")?.values[place])
    };
    let row = |what: &str, measured: f64, truth: f64| {
        Row::difference(
            format!("film of beads with noise under a simulated cell, its peak: {what}"),
            "the cell that it was made from",
            measured / truth - 1.0,
            0.1,
            "of it",
            "squares of 5.2 um; the shortest wave that the map resolves is 7.1 um",
        )
    };
    Ok(vec![
        row("axial force", frame.axial_force_nn, truth(AXIAL_FORCE)?),
        row("contractile moment", frame.contractile_moment_fj, truth(CONTRACTILE_MOMENT)?),
    ])
}
