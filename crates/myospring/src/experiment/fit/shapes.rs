//! The cell of a film compared with the fitted one, both at their peak.

use super::cell::Candidate;
use super::simulation::simulation;
use crate::experiment::track::Followed;
use crate::experiment::{ExperimentError, Folder, Observer};
use crate::fit::Fit;
use crate::integrate::quasi_static::Tolerance;
use crate::output::field::{Field, Fields};
use crate::output::figure::{self, Figure, FigureError, Map, Theme};
use crate::recording::Frame;
use crate::tension_map::{ObservedPeak, PeakShapes};
use serde::Serialize;
use std::sync::Arc;

/// Both shapes, um; the fitted one is shifted and rotated as a whole to fit the measured one best.
pub struct Shapes {
    followed: Arc<Followed>,
    /// Of the film.
    frames: Vec<usize>,
    /// Both, and the distance between them.
    pub peak: PeakShapes,
    /// Strain along the fibre at each point, %: measured, fitted.
    strains: [Vec<f64>; 2],
}

/// Their entry in `fit.json`.
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

impl Shapes {
    /// `None` if the fitted cell does not beat.
    pub(super) fn of(
        followed: Arc<Followed>,
        cell: &Candidate,
        fit: &Fit,
    ) -> Result<Option<Self>, ExperimentError> {
        let mesh = &followed.motion.mesh;
        let seen = ObservedPeak::at_peak(&followed.motion);
        let run = cell.fitter.fitted(cell.run.clone(), fit).map_err(ExperimentError::new)?;
        let outcome = simulation(cell.fitter.simulation(), &run)
            .run_quasi_static(Tolerance::default(), |_| true)?;
        let Some(peak) = PeakShapes::of(mesh, &seen, &outcome.recording.frames) else {
            return Ok(None);
        };
        let fields =
            Fields::new(mesh, &followed.fibres.directions, None).map_err(ExperimentError::new)?;
        let strains =
            [&peak.measured, &peak.simulated].map(|it| fields.on_nodes(Field::FibreStrain, it));
        Ok(Some(Self { frames: seen.frames, followed, peak, strains }))
    }

    pub(super) fn record(&self) -> Record<'_> {
        let Self { peak, strains: [measured, fitted], .. } = self;
        let apart = |node: usize| (measured[node] - fitted[node]).powi(2);
        Record {
            frames: &self.frames,
            distance_root_mean_square_um: peak.root_mean_square_um(),
            distance_largest_um: peak.largest_um(),
            measured_fibre_strain_mean_pct: peak.mean(|node| measured[node]),
            fitted_fibre_strain_mean_pct: peak.mean(|node| fitted[node]),
            fibre_strain_difference_root_mean_square_pct: peak.mean(apart).sqrt(),
        }
    }

    /// One line for people.
    pub fn words(&self) -> String {
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

    /// Both cells coloured by the strain along the fibres, and the distance between them.
    ///
    /// # Errors
    /// A cell that cannot be drawn.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        let Followed { motion, shaped, fibres, .. } = &*self.followed;
        let fields = Fields::new(&motion.mesh, &fibres.directions, None)?;
        let Self { peak, strains: [measured, fitted], .. } = self;
        let limits = usual(measured.iter().chain(fitted));
        let maps = [
            strain("Measured, at its peak", &peak.measured, measured, limits),
            strain("Fitted, at its peak", &peak.simulated, fitted, limits),
            Map {
                name: "Distance between the two".to_owned(),
                positions: &peak.simulated.positions,
                values: peak.distances_um.clone(),
                quantity: "Distance (\u{b5}m)".to_owned(),
                limits: None,
                doubts: None,
            },
        ];
        let cell = figure::DrawnCell::new(fields, Some(&shaped.outline))?;
        figure::maps(&cell, &maps, None)
    }

    pub(super) fn write(
        &self,
        folder: &Folder,
        observer: &dyn Observer,
    ) -> Result<(), ExperimentError> {
        let draw = || self.figure();
        folder.figures(Theme::Light, &[("shapes", &draw)], observer)
    }
}

/// The share of points at each end of the range that get the end's colour, so that a few badly
/// tracked points do not change the scale.
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
