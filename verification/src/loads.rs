//! A strip of cell whose ends are held: at its length, against loads, and between carbon fibres.
//!
//! The independent programs have a homogeneous block of Poisson's ratio 0.49, 140 um long with a section of 157 um^2.
//! Ours is the flat cell as any run has it, with that section and that length between what holds it, so a few per
//! cent are the two laws of elasticity: under one tension the sheet shortens by 3 % less than the block where both
//! shorten little, and as much at a tenth.

use crate::check::{Failure, Setting, metric};
use crate::row::Row;
use myospring::cell::CellModel;
use myospring::cell::calcium::CalciumTrace;
use myospring::cell::land_2017::Land2017;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::solve;
use myospring::cell::tomek_2019::{Layer, TomekModel, Variant};
use myospring::integrate::Method;
use myospring::mechanics::material::myofilament_material;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::ends::{END_PART, end_zones};
use myospring::mesh::{Mesh, lattice};
use myospring::recording::END_FORCE;
use myospring::simulation::{Numerics, Outcome, Simulation};
use std::sync::Arc;

const PEER: &str = "NumPy and SciPy, an independent program for a block";
const SECTION_UM2: f64 = 157.0;
const LENGTH_UM: f64 = 140.0;
/// Young's modulus of that program's block.
const BLOCK_KPA: f64 = 100.0;
/// Time from beat to beat, ms, and which beat is compared where that program compares its tenth: by then forces are
/// within 0.05 % of steady.
const CYCLE_MS: f64 = 1000.0;
const PEER_BEATS: u32 = 3;
const AXIS: [f64; 2] = [1.0, 0.0];
/// Isometric peak of the myofilaments on the calcium of ToR-ORd, kPa.
const ISOMETRIC: f64 = 24.03;

/// Force at constant length, force clamps, and carbon fibres.
///
/// # Errors
/// A beat that stops, or lacks a number.
pub fn rows(_setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let myofilaments: Arc<dyn CellModel> = Arc::new(Land2017::published().with_trace(calcium()?));
    let mut rows = isometric(&myofilaments)?;
    rows.extend(against_loads(&myofilaments)?);
    rows.extend(between_fibres()?);
    Ok(rows)
}

/// Of the first beat of ToR-ORd with these myofilaments.
fn calcium() -> Result<CalciumTrace, Failure> {
    let model = TomekModel::published(Layer::Endo, Variant::Land);
    let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
    let trace = solve(&model, protocol, model.usual_settings(), 700.0, 0.5)?;
    Ok(CalciumTrace::new(&trace.time_ms, trace.variable("Ca_i").ok_or("no calcium")?)?)
}

/// Seven squares wide and 10 um thick; what holds its ends takes a part of the length.
fn strip(taken: f64) -> Result<Mesh, Failure> {
    let spacing = SECTION_UM2 / 10.0 / 7.0;
    let columns = (LENGTH_UM / (1.0 - taken) / spacing).round() as usize;
    Ok(lattice::rectangle(columns, 7, spacing)?)
}

fn beat(
    mesh: Mesh,
    cell: &Arc<dyn CellModel>,
    support: SupportKind,
    end_stretch: f64,
) -> Result<Outcome, Failure> {
    beats(mesh, cell, support, end_stretch, 1)
}

/// A number of beats, one a second; the last is recorded for 600 ms.
fn beats(
    mesh: Mesh,
    cell: &Arc<dyn CellModel>,
    support: SupportKind,
    end_stretch: f64,
    beats: u32,
) -> Result<Outcome, Failure> {
    let usual = Simulation::new(mesh);
    let once = Protocol::once(cell.default_stimulus());
    let simulation = Simulation {
        protocol: Protocol { start_ms: 0.0, cycle_length_ms: CYCLE_MS, beats, ..once },
        material: myofilament_material(),
        numerics: Numerics {
            method: Method::QuasiStatic,
            exchange_interval: 1.0,
            output_interval: 1.0,
            frame_interval: 600.0,
            ..usual.numerics.clone()
        },
        duration: CYCLE_MS * f64::from(beats - 1) + 600.0,
        cell: cell.clone(),
        support,
        end_stretch,
        ..usual
    };
    let outcome = simulation.build()?.run(|_progress| true);
    match &outcome.stop {
        Some(reason) => Err(format!("the beat stopped: {reason}").into()),
        None => Ok(outcome),
    }
}

/// The largest force from a time on, nN.
fn largest_force(outcome: &Outcome, from_ms: f64) -> Result<f64, Failure> {
    let signals = &outcome.recording.signals;
    let force = signals.iter().find(|signal| signal.name == END_FORCE).ok_or("no force")?;
    let samples = outcome.recording.samples.iter().zip(&force.values);
    Ok(samples
        .filter(|(sample, _)| sample.t_ms >= from_ms)
        .map(|(_, force)| *force)
        .fold(0.0, f64::max))
}

/// Of the samples, kPa.
fn largest_tension(outcome: &Outcome) -> f64 {
    outcome.recording.samples.iter().map(|sample| sample.ta_kpa).fold(0.0, f64::max)
}

/// The whole length over that between the clamps: a run's shortening is that of the whole cell.
fn of_between(mesh: &Mesh) -> f64 {
    let [[start, low], [high, end]] = end_zones(mesh, AXIS);
    (end - start) / (high - low)
}

/// Stretched so that what lies between the clamps has this stretch, the cell is held there.
fn isometric(myofilaments: &Arc<dyn CellModel>) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for (stretch, expected) in [(1.0, ISOMETRIC), (1.1, 56.12)] {
        let mesh = strip(2.0 * END_PART)?;
        let whole = 1.0 + (stretch - 1.0) / of_between(&mesh);
        let outcome = beat(mesh, myofilaments, SupportKind::ClampedEnds, whole)?;
        rows.push(Row::about(
            format!("land_2017 between clamps at a stretch of {stretch}: peak tension"),
            PEER,
            metric(&outcome, "peak_tension")?,
            expected,
            2e-3 * expected,
            "kPa",
            "calcium comes from another implementation of ToR-ORd, which differs by 0.1 %",
        ));
        if stretch == 1.0 {
            rows.push(Row::about(
                "the same: force at its ends over tension times section",
                "the active stress is the same everywhere, so the clamps bear it alone",
                largest_force(&outcome, 0.0)? / (largest_tension(&outcome) * SECTION_UM2),
                1.0,
                1e-6,
                "",
                "tolerance of the equilibrium",
            ));
        }
    }
    Ok(rows)
}

/// Force clamps: it pulls until it bears the load, then shortens under it.
fn against_loads(myofilaments: &Arc<dyn CellModel>) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let (mut works, mut ends) = (Vec::new(), Vec::new());
    for (part, shortening, rate) in [
        (0.1, 8.95, 1.16),
        (0.2, 7.88, 1.10),
        (0.4, 5.74, 0.89),
        (0.6, 3.68, 0.65),
        (0.8, 1.71, 0.39),
    ] {
        let mesh = strip(2.0 * END_PART)?;
        let of_between = of_between(&mesh);
        let load = part * ISOMETRIC * SECTION_UM2;
        let support = SupportKind::AfterloadedEnds { load };
        let outcome = beat(mesh, myofilaments, support, 1.0)?;
        let what = |what: &str| format!("force clamp at {part} of the isometric force: {what}");
        let peak = of_between * metric(&outcome, "peak_shortening")?;
        rows.push(Row::about(
            what("shortening"),
            PEER,
            peak,
            shortening,
            0.03 * shortening,
            "%",
            "the sheet shortens by up to 3 % less than the block, and clamps keep its width",
        ));
        rows.push(Row::about(
            what("largest rate"),
            PEER,
            of_between * metric(&outcome, "maximum_shortening_rate")?,
            rate,
            0.03 * rate,
            "lengths/s",
            "as above",
        ));
        works.push(part * ISOMETRIC * peak / 100.0);
        ends.push(metric(&outcome, "time_of_peak")?);
    }
    let most = works.iter().copied().fold(0.0, f64::max);
    rows.push(Row::about(
        "force clamps: largest work on the load, per volume, at 0.4 of the isometric force",
        PEER,
        works[2],
        0.552,
        0.03 * 0.552,
        "kPa",
        "as for the shortening",
    ));
    rows.push(Row::about(
        "the same over the largest of the five",
        "work is largest near half of the isometric force",
        works[2] / most,
        1.0,
        0.0,
        "",
        "in the other program it is largest there, too",
    ));
    rows.push(Row::about(
        "force clamps: latest end of systole",
        PEER,
        ends.iter().copied().fold(0.0, f64::max),
        182.0,
        4.0,
        "ms",
        "its five lie from 170 to 182 ms; ours are read with an exchange interval of 1 ms",
    ));
    Ok(rows)
}

/// Springs at either end, which hold a twentieth of the length each.
fn between_fibres() -> Result<Vec<Row>, Failure> {
    let cell: Arc<dyn CellModel> = Arc::new(TomekModel::published(Layer::Endo, Variant::Land));
    let mut rows = Vec::new();
    for (stiffness, block) in [(20.0, 148.0), (100.0, 633.0), (500.0, 1854.0), (2000.0, 2968.0)] {
        let support = SupportKind::SpringHeldEnds { stiffness };
        let outcome = beats(strip(END_PART)?, &cell, support, 1.0, PEER_BEATS)?;
        let expected = block * held_over_its_ends(stiffness);
        rows.push(Row::about(
            format!("tor_ord_land between carbon fibres of {stiffness} nN/um: largest force"),
            format!("{PEER}, corrected for ends that springs hold over their length"),
            largest_force(&outcome, CYCLE_MS * f64::from(PEER_BEATS - 1))?,
            expected,
            0.01 * expected,
            "nN",
            "another elasticity, as with force clamps",
        ));
    }
    Ok(rows)
}

/// How much harder a bar pulls whose springs act along its ends than one whose springs act at two points as far apart as
/// the middles of those ends, both under the same tension.
///
/// Within the end `0 < x < z` springs of `k/z` per length hold the bar, so its displacement `u` obeys
/// `E A u'' = (k/z) u`. The tip is free, `E u'(0) = -T`; the middle, `2 h` long, is strained evenly, `u(z) = -h u'(z)`.
/// With `q^2 = k/(z E A)` the force is `T A (1 - 1/(cosh qz + h q sinh qz))`. Between two points `L` apart it is
/// `T A/(1 + 2 E A/(k L))`.
fn held_over_its_ends(stiffness: f64) -> f64 {
    let whole = LENGTH_UM / (1.0 - END_PART);
    let end = END_PART * whole;
    let half_of_middle = whole / 2.0 - end;
    let bar = BLOCK_KPA * SECTION_UM2;
    let q = (stiffness / end / bar).sqrt();
    let along = 1.0 - ((q * end).cosh() + half_of_middle * q * (q * end).sinh()).recip();
    along * (1.0 + 2.0 * bar / (stiffness * LENGTH_UM))
}
