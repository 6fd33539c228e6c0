//! A cell that never was: lattice meshes and a beat from formulas, to try the output with.

use myospring::mesh::outline::Outline;
use myospring::mesh::{Mesh, lattice};
use myospring::recording::{Frame, Recording, Sample};
use std::f64::consts::TAU;

/// Time of the stimulus, ms.
pub(crate) const STIMULUS: f64 = 50.0;
/// Time of the greatest tension, ms.
pub(crate) const PEAK: f64 = 171.5;

/// The lattice of a cell that is seen whole from its middle.
fn filled(spacing: f64, inside: impl Fn(f64, f64) -> bool) -> Mesh {
    let ring = (0..400).map(|step| {
        let (sin, cos) = (f64::from(step) / 400.0 * TAU).sin_cos();
        let (mut within, mut beyond) = (0.0, 100.0);
        for _ in 0..40 {
            let middle = f64::midpoint(within, beyond);
            let side = if inside(middle * cos, middle * sin) { &mut within } else { &mut beyond };
            *side = middle;
        }
        [within * cos, within * sin]
    });
    let outline = Outline::new(ring.collect(), Vec::new()).unwrap();
    lattice::from_outline(&outline, Some(spacing)).unwrap().0
}

/// A long, brick-like myocyte, 140 um x 21 um.
pub(crate) fn elongated(spacing: f64) -> Mesh {
    filled(spacing, |x, y| {
        (x / 70.0).abs().powi(8) + (y / (10.6 + 0.6 * (x / 15.0).sin())).abs().powi(6) < 1.0
    })
}

/// A roundish cell, 110 um x 77 um, its long axis turned by 25 degrees, and that axis.
pub(crate) fn roundish(spacing: f64) -> (Mesh, [f64; 2]) {
    let (sin, cos) = 25f64.to_radians().sin_cos();
    let mesh = filled(spacing, |x, y| {
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
            Frame::new(t, 50.0 * s, [xs, ys])
        })
        .collect();
    Recording { samples, frames, ..Recording::default() }
}
