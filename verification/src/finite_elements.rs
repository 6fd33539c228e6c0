//! A twitch that others computed with finite elements, beside ours.
//!
//! `fe_twitch_reference.csv` is from emimechanicalmodel (MIT licence; `telle_2023`): one
//! idealised myocyte, about 100 x 18 x 18 um, in a matrix, over 500 ms: the active tension that was put
//! in, the fibre strain that came out. The file says no more than that; by the program's public source the
//! strain is Green's, `E_ff = (|F f|^2 - 1)/2`, a mean over the cell, the material incompressible and
//! exponential (`holzapfel_ogden_2009`), and the active stress, which it offers beside an active strain,
//! that of our fibre law. That the curve comes back so well below speaks for all three.
//!
//! Ours is a strip of that length and width, as thick as keeps the volume, in an elastic bed. Two of its
//! constants are fitted to two numbers: Young's modulus to the peak of the strain, the bed to the mean
//! fibre stress at that peak (what the cell pulls on its surroundings with). All else is comparison.
//!
//! Where the two differ, the law of the material is the reason: for one incompressible fibre of an
//! exponential material,
//!
//! ```text
//! Ta = a (lambda^-3 - 1) exp(b (lambda^2 + 2/lambda - 3))
//! ```
//!
//! with a and b fitted gives the finite elements' curve back from the tension alone.

use crate::check::{Failure, Setting};
use crate::fit::slope;
use crate::row::Row;
use myospring::analysis::trace;
use myospring::integrate::quasi_static::{Path, Tolerance};
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::{Material, Stiffness, assemble, default_material};
use myospring::mechanics::stability::StabilityLimit;
use myospring::mechanics::support::SupportKind;
use myospring::mechanics::{Body, System, Vectors};
use myospring::mesh::{Mesh, lattice};
use myospring::output::figure::{ContractionOptions, contraction};
use myospring::recording::{Recording, Sample};
use serde::Deserialize;

/// Length and width, um, and volume, um^3, of the finite elements' cell.
pub(crate) const LENGTH: f64 = 100.0;
const WIDTH: f64 = 18.0;
pub(crate) const VOLUME: f64 = 22_429.0;

const FILE: &str = "meshes/fe_twitch_reference.csv";
pub(crate) const SOURCE: &str = "finite elements (emimechanicalmodel, Telle et al. 2023)";

/// One line of their file.
#[derive(Debug, Clone, Copy, Deserialize)]
pub(crate) struct Line {
    pub(crate) time_ms: f64,
    #[serde(rename = "active_tension_kPa")]
    pub(crate) tension: f64,
    #[serde(rename = "fiber_strain_subdomain1_intracellular")]
    pub(crate) strain: f64,
    #[serde(rename = "fiber_stress_1")]
    pub(crate) stress: f64,
}

/// Our strip: a modulus and a bed away from being a system.
struct Strip {
    mesh: Mesh,
    /// Young's modulus, kPa.
    young: f64,
    /// Stiffness of the bed, kPa/um.
    bed: f64,
}

impl Strip {
    fn made(&self) -> (Body, System) {
        let material = default_material();
        let area_modulus = material.area_modulus / material.young_modulus() * self.young;
        let material = Material {
            stiffness: Stiffness::YoungModulus(self.young),
            thickness: VOLUME / (LENGTH * WIDTH),
            area_modulus,
            ..material
        };
        let fibres = vec![[1.0, 0.0]; self.mesh.simplices.len()];
        let support = SupportKind::ElasticBed { stiffness: self.bed };
        let along = [1.0, 0.0];
        assemble(&self.mesh, &material, ActiveLaw::Fibre, &fibres, support, along, LENGTH)
    }

    /// Mean of Green's fibre strain over the area.
    fn strain(&self, positions: &Vectors) -> f64 {
        let (mut sum, mut total) = (0.0, 0.0);
        for simplex in &self.mesh.simplices {
            let [a, b, c] = simplex.nodes.map(|node| node as usize);
            let rest = |node: usize| self.mesh.point(node);
            let from = |at: [f64; 2], origin: [f64; 2]| [at[0] - origin[0], at[1] - origin[1]];
            let (p, q) = (from(rest(b), rest(a)), from(rest(c), rest(a)));
            let now = |node: usize| [positions[0][node], positions[1][node]];
            let (r, s) = (from(now(b), now(a)), from(now(c), now(a)));
            let determinant = p[0] * q[1] - p[1] * q[0];
            // F e_x, from F p = r and F q = s
            let column = [0, 1].map(|k| (r[k] * q[1] - s[k] * p[1]) / determinant);
            let weight = 0.5 * simplex.weight * determinant;
            sum += weight * 0.5 * (column[0] * column[0] + column[1] * column[1] - 1.0);
            total += weight;
        }
        sum / total
    }

    /// Mean Cauchy stress along the fibre, kPa, from what the bed does (the virial).
    fn stress(&self, positions: &Vectors) -> f64 {
        let virial: f64 = (0..self.mesh.len())
            .map(|i| {
                let (rest, now) = (self.mesh.points[0][i], positions[0][i]);
                -self.bed * self.mesh.areas[i] * (now - rest) * (now - 0.5 * LENGTH)
            })
            .sum();
        virial / VOLUME
    }

    /// Fits modulus and bed to strain and stress under a tension.
    fn fit(&mut self, tension: f64, strain: f64, stress: f64) -> Result<(), Failure> {
        for _ in 0..40 {
            let (body, system) = self.made();
            let path = Path::solve(&system, &body, tension, Tolerance::default())?;
            let shape = path.positions(tension).ok_or("the path has no shape at its end")?;
            let (ours, pull) = (self.strain(&shape), self.stress(&shape));
            if (ours / strain - 1.0).abs() < 1e-6 && (pull / stress - 1.0).abs() < 1e-6 {
                return Ok(());
            }
            self.young *= ours / strain;
            self.bed *= stress / pull;
        }
        Err("modulus and bed were not found in 40 rounds".into())
    }

    /// Strains at the times of their twitch, driven by their tension, linear in between.
    fn twitch(&self, lines: &[Line]) -> Result<Vec<f64>, Failure> {
        let (body, system) = self.made();
        let most = lines.iter().map(|line| line.tension).fold(0.0, f64::max);
        let limit = StabilityLimit::of(&system, &body, most).time_step;
        let interval = lines[1].time_ms - lines[0].time_ms;
        let steps = (interval / (0.9 * limit)).ceil() as usize;
        let step = interval / steps as f64;
        let mut motion = Motion::new(&system, body, Integrator::StoermerVerlet, step);
        let mut strains = vec![self.strain(&motion.body.positions)];
        for pair in lines.windows(2) {
            motion.advance(steps, [pair[0].tension, pair[1].tension])?;
            strains.push(self.strain(&motion.body.positions));
        }
        Ok(strains)
    }
}

/// Strains of one incompressible exponential fibre under tensions, its two constants fitted to the lines.
fn exponential(lines: &[Line]) -> Vec<f64> {
    let stretch = |strain: f64| (1.0 + 2.0 * strain).sqrt();
    let exponent = |lambda: f64| lambda * lambda + 2.0 / lambda - 3.0;
    let resistance = |lambda: f64| lambda.powi(-3) - 1.0;
    // ln (Ta/(lambda^-3 - 1)) = ln a + b (lambda^2 + 2/lambda - 3), above the noise of small tensions.
    let points = lines.iter().filter(|line| line.tension > 0.5);
    let (x, y): (Vec<f64>, Vec<f64>) = points
        .map(|line| {
            let lambda = stretch(line.strain);
            (exponent(lambda), (line.tension / resistance(lambda)).ln())
        })
        .unzip();
    let b = slope(&x, &y);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let a = (mean(&y) - b * mean(&x)).exp();
    let under = |tension: f64| {
        let (mut low, mut high) = (0.5, 1.0);
        for _ in 0..60 {
            let lambda = 0.5 * (low + high);
            let held = a * resistance(lambda) * (b * exponent(lambda)).exp();
            if held > tension { low = lambda } else { high = lambda }
        }
        0.5 * (low * low - 1.0)
    };
    lines.iter().map(|line| under(line.tension)).collect()
}

/// Shape of a twitch: time of its peak, of half its peak before and after, ms.
pub(crate) fn timing(times: &[f64], shortening: &[f64]) -> Result<[f64; 3], Failure> {
    let top = trace::peak(times, shortening).ok_or("the twitch has no peak")?;
    let half = 0.5 * top.value;
    let rise = trace::rises_through(times, shortening, half, 0.0);
    let fall = trace::falls_through(times, shortening, half, top.time);
    let missing = "the twitch does not pass half of its peak";
    Ok([top.time, rise.ok_or(missing)?, fall.ok_or(missing)?])
}

/// The largest distance between two twitches, each over its own peak.
pub(crate) fn apart(a: &[f64], b: &[f64]) -> f64 {
    let peak = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let (pa, pb) = (peak(a), peak(b));
    a.iter().zip(b).map(|(a, b)| (a / pa - b / pb).abs()).fold(0.0, f64::max)
}

/// The largest difference, over the peak, between falling and rising tension at equal tension.
fn hysteresis(tensions: &[f64], shortening: &[f64]) -> f64 {
    let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let most = largest(tensions);
    let top = tensions.iter().position(|&tension| tension == most).unwrap_or_default();
    let mut worst = 0.0_f64;
    for percent in 2..98 {
        let level = 0.01 * f64::from(percent) * most;
        let at = |index: usize| {
            let part = (level - tensions[index]) / (tensions[index + 1] - tensions[index]);
            shortening[index] + part * (shortening[index + 1] - shortening[index])
        };
        let up = (0..top).rev().find(|&i| tensions[i] < level);
        let down = (top..tensions.len() - 1).find(|&i| tensions[i + 1] < level);
        if let (Some(up), Some(down)) = (up, down) {
            worst = worst.max((at(up) - at(down)).abs());
        }
    }
    worst / largest(shortening)
}

/// Their twitch, if the file is there.
///
/// # Errors
/// A file that cannot be read.
pub(crate) fn lines(setting: &Setting<'_>) -> Result<Option<Vec<Line>>, Failure> {
    let file = setting.data.join(FILE);
    if !file.exists() {
        return Ok(None);
    }
    Ok(Some(csv::Reader::from_path(file)?.deserialize().collect::<Result<_, _>>()?))
}

/// Our twitch beside theirs.
///
/// # Errors
/// A file that cannot be read, a strip without equilibrium.
pub fn rows(setting: &Setting<'_>) -> Result<Vec<Row>, Failure> {
    if let Some(lines) = lines(setting)? {
        return compared(setting, &lines);
    }
    let missing = format!(
        "no {FILE}: set MYOSPRING_SHARED_DATA to a folder that has it (a twitch of emimechanicalmodel, \
         github.com/aashildte/emimechanicalmodel)"
    );
    Ok(vec![Row::skipped("a twitch in an elastic bed", SOURCE, &missing)])
}

/// Our twitch beside the one of these lines.
fn compared(setting: &Setting<'_>, lines: &[Line]) -> Result<Vec<Row>, Failure> {
    let times: Vec<f64> = lines.iter().map(|line| line.time_ms).collect();
    let tensions: Vec<f64> = lines.iter().map(|line| line.tension).collect();
    let most = tensions.iter().copied().fold(0.0, f64::max);
    let top = lines.iter().find(|line| line.tension == most).ok_or("no line at all")?;

    let spacing = if setting.quick { 6.0 } else { 2.0 };
    let columns = (LENGTH / spacing).round() as usize;
    let mesh =
        lattice::rectangle(columns, (WIDTH / spacing).round() as usize, LENGTH / columns as f64)?;
    let mut strip = Strip { mesh, young: 900.0, bed: 0.2 };
    strip.fit(top.tension, top.strain, top.stress)?;

    // As shortening, 1 - lambda, in per cent.
    let shortening = |strains: &[f64]| -> Vec<f64> {
        strains.iter().map(|strain| 100.0 * (1.0 - (1.0 + 2.0 * strain).sqrt())).collect()
    };
    let theirs = shortening(&lines.iter().map(|line| line.strain).collect::<Vec<_>>());
    let ours = shortening(&strip.twitch(lines)?);
    let law = shortening(&exponential(lines));
    draw(setting, &times, &[("finite elements", &theirs), ("Myospring", &ours)])?;

    let (them, us) = (timing(&times, &theirs)?, timing(&times, &ours)?);
    let fitted = format!(
        "ours: E = {:.0} kPa fitted to their peak strain, bed {:.2} kPa/um to their peak stress of {:.2} kPa",
        strip.young, strip.bed, top.stress
    );
    let law_reason = "their material is exponential: half of the tension already gives most of the strain; ours is \
                      nearly Hookean, so strain follows tension";
    Ok(vec![
        Row::about(
            "twitch in an elastic bed: time of the peak of shortening",
            SOURCE,
            us[0],
            them[0],
            1.0,
            "ms",
            format!("both follow the tension; one sample is 1 ms; {fitted}"),
        ),
        Row::difference(
            "the same of the finite elements: largest difference between rise and fall at equal tension",
            "a quasi-static twitch has none",
            hysteresis(&tensions, &theirs),
            5e-3,
            "of the peak",
            "shows that their shape depends on tension alone, as assumed; linear between samples of 1 ms",
        ),
        Row::difference(
            "the same, ours",
            "a quasi-static twitch has none",
            hysteresis(&tensions, &ours),
            5e-3,
            "of the peak",
            "as above; numerical mass and drag may delay by some 0.1 ms",
        ),
        Row::noted("half of the peak, rising", SOURCE, us[1], them[1], "ms", law_reason),
        Row::noted("half of the peak, falling", SOURCE, us[2], them[2], "ms", law_reason),
        Row::noted(
            "duration at half of the peak",
            SOURCE,
            us[2] - us[1],
            them[2] - them[1],
            "ms",
            law_reason,
        ),
        Row::noted(
            "largest difference of the shortening, each over its peak",
            SOURCE,
            apart(&ours, &theirs),
            0.0,
            "",
            law_reason,
        ),
        Row::difference(
            "the explanation: one incompressible exponential fibre under the same tension, largest difference \
             from the finite elements, each over its peak",
            SOURCE,
            apart(&law, &theirs),
            0.03,
            "",
            "two constants for a whole cell in a matrix; small compared with the difference above, so that \
             difference comes from the material's law, not from geometry, supports or time",
        ),
    ])
}

/// The curves as a figure.
fn draw(setting: &Setting<'_>, times: &[f64], curves: &[(&str, &Vec<f64>)]) -> Result<(), Failure> {
    let blank = Sample {
        t_ms: 0.0,
        u: None,
        vm_mv: None,
        ta_kpa: f64::NAN,
        length_um: f64::NAN,
        width_um: f64::NAN,
        area_um2: f64::NAN,
        shortening_pct: f64::NAN,
        elastic_energy_fj: f64::NAN,
        kinetic_energy_fj: f64::NAN,
        active_work_fj: f64::NAN,
        dissipated_energy_fj: f64::NAN,
        momentum_nn_ms: f64::NAN,
        angular_momentum_nn_um_ms: f64::NAN,
    };
    let recordings: Vec<(&str, Recording)> = curves
        .iter()
        .map(|(name, values)| {
            let sample = |(&t_ms, &shortening_pct)| Sample { t_ms, shortening_pct, ..blank };
            let samples = times.iter().zip(*values).map(sample).collect();
            (*name, Recording { samples, ..Recording::default() })
        })
        .collect();
    let named: Vec<(&str, &Recording)> = recordings.iter().map(|(name, r)| (*name, r)).collect();
    let figure = contraction(&named, &ContractionOptions::default())?;
    std::fs::write(setting.folder.join("finite_elements.svg"), figure.to_svg())?;
    std::fs::write(setting.folder.join("finite_elements.png"), figure.to_png(300.0)?)?;
    Ok(())
}
