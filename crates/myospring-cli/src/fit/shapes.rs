//! The cell of a film beside the fitted one, both at their peak.

use super::files::fitted;
use crate::failure::Failure;
use crate::terminal::Terminal;
use myospring::analysis::shape::laid_upon;
use myospring::experiment::Folder;
use myospring::experiment::track::Followed;
use myospring::fit::{Fit, Fitter};
use myospring::integrate::quasi_static::Tolerance;
use myospring::output::field::{Field, Fields};
use myospring::output::figure::{self, Figure, FigureError, Map, Theme};
use myospring::recording::Frame;
use myospring::settings::Run;
use myospring::tension_map::{NEAR, ObservedPeak};
use serde::Serialize;

/// Both shapes, um, the fitted one shifted and turned as a whole to where it is nearest to the measured one.
pub(super) struct Shapes<'a> {
    followed: &'a Followed,
    seen: ObservedPeak,
    measured: Frame,
    fitted: Frame,
    /// Of each point, um.
    distances: Vec<f64>,
    /// Strain along the fibre at each point, %: measured, fitted.
    strains: [Vec<f64>; 2],
}

/// What is said of them in `fit.json`.
#[derive(Serialize)]
pub(super) struct Record<'a> {
    /// Of the film.
    frames: &'a [usize],
    distance_root_mean_square_um: f64,
    distance_largest_um: f64,
    measured_fibre_strain_mean_pct: f64,
    fitted_fibre_strain_mean_pct: f64,
    fibre_strain_difference_root_mean_square_pct: f64,
}

impl<'a> Shapes<'a> {
    /// `None` where the fitted cell makes no beat.
    pub(super) fn of(
        followed: &'a Followed,
        fitter: &Fitter,
        run: &Run,
        fit: &Fit,
    ) -> Result<Option<Self>, Failure> {
        let motion = &followed.motion;
        let mesh = &motion.mesh;
        let seen = ObservedPeak::at_peak(motion);
        let run = fitter.fitted(run.clone(), fit).map_err(Failure::new)?;
        let simulation = fitted(fitter, &run);
        let outcome =
            simulation.run_quasi_static(Tolerance::default(), |_| true).map_err(Failure::new)?;
        let square = |[x, y]: [f64; 2]| x * x + y * y;
        let moved = |frame: &Frame| {
            let way = |node: usize| {
                square([0, 1].map(|axis| frame.positions[axis][node] - mesh.points[axis][node]))
            };
            (0..mesh.len()).map(way).sum::<f64>()
        };
        // The mean of those near the peak, as of the film.
        let frames = outcome.recording.frames;
        let most = frames.iter().map(moved).fold(0.0, f64::max);
        let near = |frame: &&Frame| moved(frame).sqrt() >= (1.0 - NEAR) * most.sqrt();
        let near: Vec<&Frame> = frames.iter().filter(near).collect();
        let Some(peak) = near.iter().max_by(|a, b| moved(a).total_cmp(&moved(b))) else {
            return Ok(None);
        };
        let mean = |axis: usize, node: usize| {
            near.iter().map(|frame| frame.positions[axis][node]).sum::<f64>() / near.len() as f64
        };
        let positions =
            [0, 1].map(|axis: usize| (0..mesh.len()).map(|node| mean(axis, node)).collect());
        let peak = Frame { positions, ..(*peak).clone() };
        let positions = [0, 1].map(|axis: usize| {
            let points = mesh.points[axis].iter().zip(&seen.displacements_um[axis]);
            points.map(|(rest, way)| rest + way).collect()
        });
        let measured = Frame { positions, ..peak.clone() };
        let weights = seen.weights(mesh);
        let positions = laid_upon(&peak.positions, &measured.positions, &weights);
        let fitted = Frame { positions, ..peak };
        let distances = (0..mesh.len())
            .map(|node| {
                let [a, b] = [&measured, &fitted];
                square([0, 1].map(|axis| a.positions[axis][node] - b.positions[axis][node])).sqrt()
            })
            .collect();
        let fields = Fields::new(mesh, &followed.fibres.directions, None).map_err(Failure::new)?;
        let strains = [&measured, &fitted].map(|it| fields.on_nodes(Field::FibreStrain, it));
        Ok(Some(Self { followed, seen, measured, fitted, distances, strains }))
    }

    /// Mean over the points that were found, each by its area.
    fn mean(&self, of: impl Fn(usize) -> f64) -> f64 {
        let weights = self.seen.weights(&self.followed.motion.mesh);
        let sum: f64 = weights.iter().enumerate().map(|(node, weight)| weight * of(node)).sum();
        sum / weights.iter().sum::<f64>()
    }

    pub(super) fn record(&self) -> Record<'_> {
        let found = |&node: &usize| self.seen.found[node];
        let [measured, fitted] = &self.strains;
        Record {
            frames: &self.seen.frames,
            distance_root_mean_square_um: self.mean(|node| self.distances[node].powi(2)).sqrt(),
            distance_largest_um: (0..self.distances.len())
                .filter(found)
                .map(|node| self.distances[node])
                .fold(0.0, f64::max),
            measured_fibre_strain_mean_pct: self.mean(|node| measured[node]),
            fitted_fibre_strain_mean_pct: self.mean(|node| fitted[node]),
            fibre_strain_difference_root_mean_square_pct: self
                .mean(|node| (measured[node] - fitted[node]).powi(2))
                .sqrt(),
        }
    }

    /// In a line.
    pub(super) fn words(&self) -> String {
        let record = self.record();
        format!(
            "shapes at the peak: the fitted cell's points are {:.2} um (root mean square) from the measured ones, {:.2} um at \
             most; strain along the fibres {:.2} % measured, {:.2} % fitted",
            record.distance_root_mean_square_um,
            record.distance_largest_um,
            record.measured_fibre_strain_mean_pct,
            record.fitted_fibre_strain_mean_pct,
        )
    }

    pub(super) fn figure(&self) -> Result<Figure, FigureError> {
        let Followed { motion, shaped, fibres, .. } = self.followed;
        let fields = Fields::new(&motion.mesh, &fibres.directions, None)?;
        let [measured, fitted] = &self.strains;
        let limits = usual(measured.iter().chain(fitted));
        let maps = [
            strain("Measured, at its peak", &self.measured, measured, limits),
            strain("Fitted, at its peak", &self.fitted, fitted, limits),
            Map {
                name: "How far apart they are".to_owned(),
                positions: &self.fitted.positions,
                values: self.distances.clone(),
                quantity: "Distance (\u{b5}m)".to_owned(),
                limits: None,
                doubts: None,
            },
        ];
        let cell = figure::Cell::new(fields, Some(&shaped.outline))?;
        figure::maps(&cell, &maps, None)
    }

    pub(super) fn write(&self, folder: &Folder) -> Result<(), Failure> {
        let draw = || self.figure();
        folder.figures(Theme::Light, &[("shapes", &draw)], &Terminal::new(true))
    }
}

/// The share of the points at each end whose colour is that of the end: few points that were followed badly leave the
/// others their colours.
const BEYOND: f64 = 0.01;

/// Least and greatest of all strains but the outermost, with 0.
fn usual<'v>(strains: impl Iterator<Item = &'v f64>) -> [f64; 2] {
    let mut sorted: Vec<f64> = strains.copied().filter(|strain| strain.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return [0.0; 2] };
    let beyond = (BEYOND * last as f64).floor() as usize;
    [sorted[beyond].min(0.0), sorted[last - beyond].max(0.0)]
}

fn strain<'f>(name: &str, frame: &'f Frame, values: &[f64], limits: [f64; 2]) -> Map<'f> {
    Map {
        name: name.to_owned(),
        positions: &frame.positions,
        values: values.to_vec(),
        quantity: "Strain along the fibre (%)".to_owned(),
        limits: Some(limits),
        doubts: None,
    }
}

#[cfg(test)]
mod tests {
    use super::usual;

    #[test]
    fn a_few_points_that_were_followed_badly_leave_the_others_their_colours() {
        let mut strains: Vec<f64> = (0..1000).map(|i| -6.0 + 0.007 * f64::from(i)).collect();
        assert_eq!(usual([].iter()), [0.0; 2]);
        strains.extend([80.0, 90.0, -70.0, f64::NAN]);
        let [low, high] = usual(strains.iter());
        // One per cent of the points is 0.07 of the range.
        assert!((-6.0..-5.8).contains(&low) && (0.8..1.0).contains(&high), "{low} {high}");
    }
}
