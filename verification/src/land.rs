//! Land's myofilaments: numbers that programs of others and of a second typing gave, and a twitch at any interval of
//! exchange.

use crate::check::{Failure, Setting};
use crate::row::Row;
use myospring::cell::CellModel as _;
use myospring::cell::land_2017::{Land2017, Myofilaments};
use myospring::cell::pacing::Protocol;
use myospring::integrate::Method;
use myospring::mechanics::material::myofilament_material;
use myospring::mesh::{built_in, lattice};
use myospring::simulation::{Numerics, Simulation};
use std::sync::Arc;

const PEER: &str = "NumPy and SciPy, an independent implementation of land_2017";

/// Equations, steady states and an unloaded twitch.
///
/// # Errors
/// A cell that cannot be meshed, or a beat that stops.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    let mut rows = equations();
    rows.extend(steady());
    rows.extend(twitch(setting.quick)?);
    Ok(rows)
}

/// One state in which every term counts.
fn equations() -> Vec<Row> {
    let myofilaments = Myofilaments::published();
    let state = [0.03, 0.05, 0.4, 0.8, 0.1, -0.2];
    let expected = [3.45e-5, 6.59e-3, -0.028_780_131_48, -0.004_595_447_061, -0.006_014, 0.079_172];
    let rates = myofilaments.rates(&state, 0.4, 0.95, -2e-4);
    let off = rates.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    vec![
        Row::difference(
            "land_2017: worst of six rates at a stretch of 0.95 that falls by 0.2 1/s",
            PEER,
            off,
            1e-11,
            "1/ms",
            "the digits of the other program",
        ),
        Row::difference(
            "land_2017: tension in that state",
            PEER,
            (myofilaments.tension(&state, 0.95) - 9.7704).abs(),
            5e-5,
            "kPa",
            "half of the last digit of 9.7704 kPa",
        ),
    ]
}

/// Held at three lengths.
fn steady() -> Vec<Row> {
    let myofilaments = Myofilaments::published();
    let held =
        |calcium, stretch| myofilaments.tension(&myofilaments.steady(calcium, stretch), stretch);
    let lengths = [(0.9, 82.63, 0.7097), (1.0, 107.32, 0.5469), (1.1, 132.02, 0.3836)];
    let half = |stretch: f64| {
        let (mut low, mut high): (f64, f64) = (1e-3, 30.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if held(middle, stretch) < 0.5 * held(30.0, stretch) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    };
    let worst = |off: &dyn Fn(&(f64, f64, f64)) -> f64| lengths.iter().map(off).fold(0.0, f64::max);
    vec![
        Row::difference(
            "land_2017: greatest steady tension at stretches of 0.9, 1 and 1.1",
            PEER,
            worst(&|(stretch, most, _)| (held(30.0, *stretch) - most).abs()),
            5e-3,
            "kPa",
            "half of the last digit of 82.63, 107.32 and 132.02 kPa",
        ),
        Row::difference(
            "land_2017: calcium at half of that tension",
            PEER,
            worst(&|(stretch, _, calcium)| (half(*stretch) / calcium - 1.0).abs()),
            1e-3,
            "",
            "the other program read it off a grid",
        ),
    ]
}

/// The built-in cell, free, on its path of equilibria.
fn twitch(quick: bool) -> Result<Vec<Row>, Failure> {
    let (mesh, _) = lattice::from_outline(&built_in::adult_ventricular(), quick.then_some(5.0))?;
    let model = Land2017::published();
    let run = |exchange_interval: f64| -> Result<Vec<f64>, Failure> {
        let usual = Simulation::new(mesh.clone());
        let simulation = Simulation {
            protocol: Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) },
            cell: Arc::new(model.clone()),
            material: myofilament_material(),
            numerics: Numerics {
                method: Method::QuasiStatic,
                exchange_interval,
                output_interval: 1.0,
                frame_interval: 600.0,
                ..usual.numerics.clone()
            },
            ..usual
        };
        let outcome = simulation.build()?.run(|_progress| true);
        match &outcome.stop {
            Some(reason) => Err(format!("the beat stopped: {reason}").into()),
            None => Ok(outcome.recording.samples.iter().map(|s| s.shortening_pct).collect()),
        }
    };
    let fine = run(0.05)?;
    let peak = fine.iter().copied().fold(0.0, f64::max);
    let rate = fine.windows(2).map(|pair| 10.0 * (pair[1] - pair[0])).fold(0.0, f64::max);
    let mut rows = Vec::new();
    for interval in [1.0, 0.25] {
        let off = run(interval)?.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        rows.push(Row::difference(
            format!(
                "land_2017, unloaded twitch: worst shortening with exchange each {interval} ms"
            ),
            "the same each 0.05 ms",
            off / peak,
            1e-3,
            "of the peak",
            "tension and stretch are solved together, so the result must not depend on the interval",
        ));
    }
    // The block of Poisson's ratio 0.49 of the other programs widens a little otherwise than the flat cell.
    rows.push(Row::about(
        "land_2017, unloaded twitch: peak shortening",
        "two programs, a block of the same stiffness with Poisson's ratio 0.49",
        peak - fine[0],
        10.12,
        0.1,
        "%",
        "the flat cell widens a little otherwise, and has no lag of 1 ms",
    ));
    rows.push(Row::about(
        "land_2017, unloaded twitch: largest rate",
        "two programs, 1.134 and 1.132 lengths/s",
        rate,
        1.133,
        0.02,
        "lengths/s",
        "as above",
    ));
    Ok(rows)
}
