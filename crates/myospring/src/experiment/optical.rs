//! Waves in a film of tissue whose light shows its potential or its calcium: when each place is activated, and for how long.

mod report;

use super::analyse::{Analyse, Analysed, Shown};
use super::track::{film_name, frame_rate, is_film, open_film};
use super::{
    BeatOptions, Draw, Experiment, ExperimentError, Files, Folder, Observer, Outcome, waves,
};
use crate::analysis::kind::Kind;
use crate::analysis::{Metric, Spread, value};
use crate::experiment::legible::number;
use crate::measured::Curve;
use crate::microscopy::film::FEWEST_FRAMES;
use crate::microscopy::optical::{OpticalMap, OpticalSettings};
use crate::microscopy::picture::Selection;
use crate::output::field::Fields;
use crate::output::figure::{DrawnCell, Figure, FigureError, Theme};
use crate::output::json;
use crate::output::page::{TableCell, Tile};
use crate::output::table::{Column, Table, column_name};
pub use report::{OpticalReport, WaveReport};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What the figure shows.
const SHOWN: &str = "The frame, coloured by the time of activation, and by the action potential duration: medians of all waves.";

/// Maps the waves of a film.
#[derive(Debug, Clone, Default)]
pub struct MapWaves {
    /// The film.
    pub film: PathBuf,
    /// Frames a second; `None` uses that of the film.
    pub frame_rate: Option<f64>,
    /// Side of a pixel, um; `None` uses that of the film.
    pub pixel_size_um: Option<f64>,
    /// Times of stimuli, on the clock of the film.
    pub beats: BeatOptions,
    /// Whether the light falls in a beat, as with some dyes; `None` finds out.
    pub falls: Option<bool>,
}

impl MapWaves {
    /// Whether a file is a film, by its ending, or a folder holds the pictures of one.
    pub fn takes(path: &Path) -> bool {
        is_film(path)
    }
}

/// Waves that were mapped.
pub struct MappedWaves {
    /// Name of the film.
    pub name: String,
    /// Every wave.
    pub map: OpticalMap,
    /// Every number.
    pub report: OpticalReport,
    /// The beats of the mean light.
    pub beats: Analysed,
}

impl Experiment for MapWaves {
    type Outcome = MappedWaves;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<MappedWaves, ExperimentError> {
        let name = film_name(&self.film, files)?;
        let failed = |error: &dyn std::fmt::Display| {
            ExperimentError::new(format!("`{}`: {error}", self.film.display()))
        };
        self.beats.check()?;
        if let Some(size) = self.pixel_size_um.filter(|size| !(size.is_finite() && *size > 0.0)) {
            return Err(failed(&format!("the side of a pixel is {size} um; it must be above 0"))
                .advise("give it like --pixel-size \"100 um\""));
        }
        let film = open_film(&self.film, &Selection::default(), FEWEST_FRAMES, files)?;
        let frames_per_second = frame_rate(self.frame_rate, &film).map_err(|message| {
            failed(&message).advise("give it like --frame-rate 500, as the camera was set")
        })?;
        let pixel_um = self.pixel_size_um.or(film.pixel_size.map(|stated| stated.size.um()));
        let Some(pixel_um) = pixel_um else {
            return Err(failed(&"the film does not say how large its pixels are")
                .advise("give it like --pixel-size \"100 um\""));
        };
        let times_ms: Vec<f64> =
            (0..film.len()).map(|frame| 1000.0 * frame as f64 / frames_per_second).collect();
        let clock = light(times_ms.clone(), vec![0.0; times_ms.len()]);
        let stimuli_ms = self.beats.within(&clock).stimuli_ms;
        let settings =
            OpticalSettings { frames_per_second, pixel_um, stimuli_ms, falls: self.falls };
        observer.keeps("the frames that were read are mapped");
        let interruption = observer.interruption();
        let mut begun = false;
        let goes_on = |(done, all): (usize, usize)| {
            if !begun {
                observer.stage("frames", all as u64);
                begun = true;
            }
            observer.reached(done as u64);
            !interruption.is_requested()
        };
        let advise = "look at the film: is the tissue in it and does its light change in a beat? --frame-rate says how fast it \
                      was recorded, --stimulus-times when it was stimulated";
        let map = OpticalMap::of(&film, &settings, goes_on)
            .map_err(|error| failed(&error).advise(advise))?;
        let report = OpticalReport::of(&self.film, &film, &settings, &map);
        let curve = Curve {
            stimuli_ms: settings.stimuli_ms,
            ..light(map.times_ms.clone(), map.mean.clone())
        };
        let analyse = Analyse { curves: vec![curve], ..Analyse::default() };
        let beats = analyse.run(files, &())?;
        let mut mapped = MappedWaves { name, map, report, beats };
        mapped.beats.notes.extend(mapped.report.warnings.iter().cloned());
        mapped.beats.shown = Some(Shown {
            of: mapped.name.clone(),
            id: "activation",
            title: "How the beat spreads",
            words: SHOWN.to_owned(),
            figure: mapped.draw()?,
            tiles: mapped.tiles(),
        });
        Ok(mapped)
    }
}

/// Light over time as a curve.
fn light(times_ms: Vec<f64>, values: Vec<f64>) -> Curve {
    Curve {
        name: "light".to_owned(),
        kind: Kind::Potential,
        unit: "",
        // The names of the columns are the first line of a table.
        lines: (2..times_ms.len() as u64 + 2).collect(),
        values,
        times_ms,
        stimuli_ms: Vec::new(),
    }
}

impl MappedWaves {
    /// Draws when each place was activated, and for how long.
    fn draw(&self) -> Result<Figure, FigureError> {
        let mesh = &self.map.mesh;
        let fibres = vec![[1.0, 0.0]; mesh.simplices.len()];
        let cell = DrawnCell::new(Fields::new(mesh, &fibres, None)?, None)?;
        let since =
            if self.report.stimulated { "After the stimulus (ms)" } else { "After the first (ms)" };
        waves::draw(&cell, &self.map.wave, &self.map.typical, since)
    }

    /// The numbers of the waves: of several, their mean and standard deviation.
    fn tiles(&self) -> Vec<Tile> {
        let OpticalReport { waves, spread, .. } = &self.report;
        let metrics = waves.first().into_iter().flat_map(|wave| &wave.metrics);
        let tile = |metric: &Metric| {
            let all = spread.iter().find(|all| all.name == metric.name);
            let shown = all.map(|all| all.mean).or(metric.value)?;
            let lines = all.map(|Spread { standard_deviation, beats, .. }| {
                let deviation = number(*standard_deviation);
                TableCell::text(format!("\u{b1} {deviation} {} ({beats} waves)", metric.unit))
            });
            Some(Tile {
                definition: metric.definition.to_owned(),
                lines: lines.into_iter().collect(),
                ..Tile::new(
                    metric.name.replace('_', " "),
                    TableCell { unit: metric.unit.to_owned(), ..TableCell::number(Some(shown)) },
                )
            })
        };
        metrics.filter_map(tile).collect()
    }

    /// A row for each wave.
    fn table(&self) -> Table {
        let all = &self.report.waves;
        let number = |name: String, of: &dyn Fn(&WaveReport) -> Option<f64>| Column::Number {
            name,
            values: all.iter().map(of).collect(),
        };
        let metrics = all.first().into_iter().flat_map(|first| &first.metrics);
        let metrics = metrics.map(|metric| {
            let name = column_name(metric.name, metric.unit);
            number(name, &|wave| value(&wave.metrics, metric.name))
        });
        let begins = number("begins_ms".to_owned(), &|wave| Some(wave.begins_ms));
        Table { columns: std::iter::once(begins).chain(metrics).collect() }
    }
}

impl Outcome for MappedWaves {
    fn numbers(&self) -> impl Serialize {
        &self.report
    }

    fn warnings(&self) -> Vec<String> {
        self.beats.warnings()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        folder.write(waves::FILE, waves::table(&self.map.wave, &self.map.typical)?)?;
        folder.write("waves.csv", self.table().for_people().to_csv()?)?;
        folder.write("waves.json", json::for_people(&self.report)?)?;
        let draw = || self.draw();
        let figures: [(&str, Draw<'_>); 1] = [("activation", &draw)];
        folder.figures(Theme::Light, &figures, observer)?;
        self.beats.save(folder, observer)
    }
}
