//! The cell of a film compared with the fitted one, both at their peak.

use super::cell::Candidate;
use super::over_film::OverFilm;
use super::simulation::simulation;
use crate::experiment::track::Followed;
use crate::experiment::{ExperimentError, Folder, Observer};
use crate::fit::Fit;
use crate::integrate::quasi_static::Tolerance;
use crate::output::field::{Field, Fields};
use crate::output::figure::{self, Figure, FigureError, Map, Theme};
use crate::output::page::{Chart, Series, Tone};
use crate::output::table::{Column, Table};
use crate::recording::Frame;
use crate::tension_map::{FrameShape, ObservedPeak, PeakShapes};
use serde::Serialize;
use std::fmt::Write as _;
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
    /// Both in each frame of the film that the run of the fitted cell reaches; may be empty.
    pub film: Vec<FrameShape>,
    /// Times of the film when the run begins and ends, ms.
    span_ms: [f64; 2],
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
    /// Over all frames that the run reaches: the distance, how far the cell moves, and the one in parts of the other.
    film_frames: usize,
    film_distance_root_mean_square_um: Option<f64>,
    film_movement_root_mean_square_um: Option<f64>,
    film_distance_pct_of_movement: Option<f64>,
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
        let outcome = simulation(cell.fitter.simulation(), &run)?
            .run_quasi_static(Tolerance::default(), |_| true)?;
        let Some(peak) = PeakShapes::of(mesh, &seen, &outcome.recording.frames) else {
            return Ok(None);
        };
        let fields =
            Fields::new(mesh, &followed.fibres.directions, None).map_err(ExperimentError::new)?;
        let strains =
            [&peak.measured, &peak.simulated].map(|it| fields.on_nodes(Field::FibreStrain, it));
        let first = |times: &[f64]| times.first().copied().unwrap_or_default();
        let stimulus = fit.curves.first().map_or(0.0, |curve| first(&curve.stimuli_ms));
        let start_ms = stimulus - first(&outcome.stimulus_times_ms);
        let end_ms = start_ms + outcome.recording.frames.last().map_or(0.0, |last| last.t_ms);
        let from_ms = fit.curves.first().map_or(start_ms, |curve| first(&curve.times_ms));
        let frames = &outcome.recording.frames;
        let film = FrameShape::all(&followed.motion, frames, start_ms, from_ms.min(start_ms));
        let span_ms = [start_ms, end_ms];
        Ok(Some(Self { frames: seen.frames, followed, peak, strains, film, span_ms }))
    }

    /// The fitted cell, to be drawn over the film; `None` if it reaches no frame.
    pub(super) fn over_film(&self) -> Result<Option<OverFilm<'_>>, ExperimentError> {
        OverFilm::of(&self.followed, &self.film)
    }

    /// What a reader must know: that the fitted cell is not laid over the film, or that it moves unlike the film's.
    pub(super) fn remark(&self) -> Option<String> {
        let [start, end] = self.span_ms;
        let Some([distance, movement]) = self.over_the_film() else {
            return Some(format!(
                "no frame of the film that shows the cell lies within the beat of the fitted cell ({start:.0} to {end:.0} ms of the \
                film): their shapes are compared at the peak only"
            ));
        };
        part_pct([distance, movement]).filter(|part| *part > UNLIKE_PCT).map(|part| {
            format!(
                "the fitted cell does not move as the film's cell does: over the film its points are \
                {distance:.2} um from the measured ones, which move {movement:.2} um ({part:.0} %). What the model does not know may be the \
                reason: a cell that the frame cuts, that sticks to its dish, or that pulls unevenly"
            )
        })
    }

    pub(super) fn record(&self) -> Record<'_> {
        let Self { peak, strains: [measured, fitted], .. } = self;
        let over = self.over_the_film();
        let apart = |node: usize| (measured[node] - fitted[node]).powi(2);
        Record {
            frames: &self.frames,
            distance_root_mean_square_um: peak.root_mean_square_um(),
            distance_largest_um: peak.largest_um(),
            measured_fibre_strain_mean_pct: peak.mean(|node| measured[node]),
            fitted_fibre_strain_mean_pct: peak.mean(|node| fitted[node]),
            fibre_strain_difference_root_mean_square_pct: peak.mean(apart).sqrt(),
            film_frames: self.film.len(),
            film_distance_root_mean_square_um: over.map(|[distance, _]| distance),
            film_movement_root_mean_square_um: over.map(|[_, movement]| movement),
            film_distance_pct_of_movement: over.and_then(part_pct),
        }
    }

    /// Root mean square over the frames of the distance and of the movement, um; `None` without a frame.
    fn over_the_film(&self) -> Option<[f64; 2]> {
        let mean = |of: fn(&FrameShape) -> f64| {
            let sum: f64 = self.film.iter().map(|frame| of(frame).powi(2)).sum();
            (sum / self.film.len() as f64).sqrt()
        };
        (!self.film.is_empty())
            .then(|| [mean(|frame| frame.distance_um), mean(|frame| frame.movement_um)])
    }

    /// A row for each frame: how far the fitted cell is from that of the film, and how far that one has moved.
    pub fn table(&self) -> Table {
        let moved = self.film.iter().map(|frame| frame.movement_um).fold(0.0, f64::max);
        let column = |name: &str, of: &dyn Fn(&FrameShape) -> f64| Column::Number {
            name: name.to_owned(),
            values: self
                .film
                .iter()
                .map(|frame| Some(of(frame)).filter(|value| value.is_finite()))
                .collect(),
        };
        let columns = vec![
            column("frame", &|frame| frame.frame as f64),
            column("t_ms", &|frame| frame.t_ms),
            column("distance_um", &|frame| frame.distance_um),
            column("movement_um", &|frame| frame.movement_um),
            column("distance_pct_of_largest_movement", &|frame| 100.0 * frame.distance_um / moved),
        ];
        Table { columns }
    }

    /// The distance and the movement over the run of the fitted cell; `None` without a frame.
    pub(super) fn chart(&self) -> Option<Chart> {
        let series = |label: &str, tone, of: &dyn Fn(&FrameShape) -> f64| Series {
            label: label.to_owned(),
            tone,
            dotted: false,
            times_ms: self.film.iter().map(|frame| frame.t_ms - self.span_ms[0]).collect(),
            values: self.film.iter().map(of).collect(),
        };
        let chart = Chart {
            name: "Distance to the film".to_owned(),
            unit: "um".to_owned(),
            note: "dashed: the cell's movement".to_owned(),
            series: vec![
                series("distance", Tone::Run(0), &|frame| frame.distance_um),
                series("movement", Tone::Run(1), &|frame| frame.movement_um),
            ],
            ..Chart::default()
        };
        (!self.film.is_empty()).then_some(chart)
    }

    /// One line for people.
    pub fn words(&self) -> String {
        let record = self.record();
        let mut words = format!(
            "shapes at the peak: the fitted cell's points are {:.2} um (root mean square) from the measured ones, {:.2} um at \
             most; strain along the fibres {:.2} % measured, {:.2} % fitted",
            record.distance_root_mean_square_um,
            record.distance_largest_um,
            record.measured_fibre_strain_mean_pct,
            record.fitted_fibre_strain_mean_pct,
        );
        if let Some(distance) = record.film_distance_root_mean_square_um {
            let _ = write!(words, "; over the film {distance:.2} um");
        }
        if let Some(part) = record.film_distance_pct_of_movement {
            let _ = write!(words, ", {part:.0} % of the movement");
        }
        words
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
                hatched: figure::NOT_KNOWN,
                dots: None,
            },
        ];
        let cell = figure::DrawnCell::new(fields, Some(&shaped.outline))?;
        figure::maps(&cell, &maps, None)
    }

    /// The fitted cell over the frames of one beat of the film; `None` if the fitted beat reaches no frame. `sharp` is the
    /// largest number of pixels of the film per px of the figure: 3 for print.
    ///
    /// # Errors
    /// A frame that cannot be read, or a cell that cannot be drawn.
    pub fn overlay(&self, sharp: f64) -> Result<Option<Figure>, ExperimentError> {
        let over = self.over_film()?;
        Ok(over.map(|over| over.figure(sharp)).transpose()?)
    }

    pub(super) fn write(
        &self,
        folder: &Folder,
        observer: &dyn Observer,
    ) -> Result<(), ExperimentError> {
        let draw = || self.figure();
        folder.figures(Theme::Light, &[("shapes", &draw)], observer)?;
        if self.film.is_empty() {
            return Ok(());
        }
        folder.write("distances.csv", self.table().to_csv()?)?;
        let Some(over) = self.over_film()? else { return Ok(()) };
        let draw = || over.figure(SHARP);
        folder.figures(Theme::Light, &[("overlay", &draw)], observer)?;
        if observer.is_late() { Ok(()) } else { over.write_gif(folder, "figures/overlay.gif") }
    }
}

/// Distance over the film, per cent of the movement, from which on the fitted cell moves unlike the film's: a map of tension that
/// leaves as much of the motion explains little, too.
const UNLIKE_PCT: f64 = 70.0;

/// Pixels of the film per px of a figure in print: 300 per inch.
const SHARP: f64 = 300.0 / 96.0;

/// A distance in per cent of a movement.
fn part_pct([distance, movement]: [f64; 2]) -> Option<f64> {
    Some(100.0 * distance / movement).filter(|part| part.is_finite())
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
        hatched: figure::NOT_KNOWN,
        dots: None,
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
