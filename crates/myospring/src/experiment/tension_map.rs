//! The map of tension of a film's cell.

use super::film_beat::FilmBeat;
use super::track::{Followed, Track, TrackReport};
use super::{Experiment, ExperimentError, Files, Folder, Observer, Outcome};
use crate::output::field::Fields;
use crate::output::figure::{self, Figure, FigureError, Map, Theme};
use crate::output::json;
use crate::output::npz::{self, Array};
use crate::output::table::{Column, Table};
use crate::output::vtu;
use crate::recording::Frame;
use crate::simulation::Simulation;
use crate::tension_map::{TensionFilm, TensionMap, TensionMapError};
use serde::Serialize;
use std::sync::Arc;

/// Maps where the cell of a film pulls, without a fit; stiffness and support are those of the
/// settings.
pub struct MapTension {
    /// The film, with every setting of its cell.
    pub track: Track,
}

/// A map with its film.
#[derive(Clone)]
pub struct FilmMap {
    /// The map at the peak.
    pub map: TensionMap,
    /// The map in each frame.
    pub film: TensionFilm,
    /// The film's cell.
    pub followed: Arc<Followed>,
    verdicts: Vec<String>,
    notes: Vec<String>,
}

impl Experiment for MapTension {
    type Outcome = FilmMap;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<FilmMap, ExperimentError> {
        self.track.check(files)?;
        let followed = self.track.follow(files, observer)?;
        let run = &followed.run;
        let made = run.make(followed.shaped.clone(), |file| files.bytes(file))?;
        let mut notes = TrackReport::of(&self.track.film, &followed).warnings;
        notes.extend(run.assumed.iter().cloned());
        let map = FilmMap::of(Arc::new(followed), &made.simulation);
        Ok(FilmMap { notes, ..map.map_err(ExperimentError::new)? })
    }
}

impl Outcome for FilmMap {
    fn numbers(&self) -> impl Serialize {
        self.record()
    }

    fn warnings(&self) -> Vec<String> {
        self.notes.iter().chain(&self.verdicts).cloned().collect()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        folder.write("tension_map.json", json::for_people(&self.record())?)?;
        self.write(folder, observer)
    }
}

/// The map in `fit.json`.
#[derive(Serialize)]
pub struct TensionMapRecord<'a> {
    /// Of the film.
    frames: &'a [usize],
    mean_tension_kpa: f64,
    mean_tension_standard_deviation_kpa: f64,
    /// Whether it is known in most of the cell, and in which part of the cell the standard
    /// deviation is above half of the tension.
    known: bool,
    doubtful_part: f64,
    /// The 5 and 95 % quantiles over the triangles; `None` if the map is not known.
    tension_range_kpa: Option<[f64; 2]>,
    even_tension_kpa: f64,
    /// Whether the film shows that the cell pulls unevenly, and how often a uniform tension would
    /// look as uneven.
    uneven: bool,
    chance_even: f64,
    /// Smaller parts are not resolved.
    resolution_um: f64,
    numbers: f64,
    lambda_um2_per_kpa2: f64,
    /// Root mean square distance of the points from their measured positions.
    misfit_um: f64,
    even_misfit_um: f64,
    /// Modes of the map over the whole film that exceed noise; 1 where the pattern stays the same.
    modes: usize,
    verdicts: &'a [String],
}

impl FilmMap {
    /// The map of a tracked cell, with the stiffness and the support of this simulation.
    ///
    /// # Errors
    /// Those of [`TensionMap::of`].
    pub fn of(followed: Arc<Followed>, simulation: &Simulation) -> Result<Self, TensionMapError> {
        let (map, film) = TensionFilm::of(simulation, &followed.motion)?;
        let mut verdicts = map.verdicts(simulation);
        if film.modes > 1 && map.is_known() {
            verdicts.push(format!(
                "the pattern of tension changes during the film: {} modes exceed noise, so the map of the peak is not \
                that of other frames",
                film.modes
            ));
        }
        Ok(Self { map, film, followed, verdicts, notes: Vec::new() })
    }

    /// Warnings for a reader of the map.
    pub fn verdicts(&self) -> &[String] {
        &self.verdicts
    }

    pub(super) fn record(&self) -> TensionMapRecord<'_> {
        let map = &self.map;
        TensionMapRecord {
            frames: &map.frames,
            mean_tension_kpa: map.mean_kpa,
            mean_tension_standard_deviation_kpa: map.mean_deviation_kpa,
            known: map.is_known(),
            doubtful_part: map.doubtful_part(),
            tension_range_kpa: map
                .is_known()
                .then(|| [map.quantile_kpa(0.05), map.quantile_kpa(0.95)]),
            even_tension_kpa: map.even_kpa,
            uneven: map.is_uneven(),
            chance_even: map.chance_even,
            resolution_um: map.resolution_um(),
            numbers: map.numbers,
            lambda_um2_per_kpa2: map.lambda,
            misfit_um: map.misfit_um,
            even_misfit_um: map.even_misfit_um,
            modes: self.film.modes,
            verdicts: &self.verdicts,
        }
    }

    /// One line for people.
    pub fn words(&self) -> String {
        let map = &self.map;
        if !map.is_known() {
            return format!(
                "tension at the peak ({}): the film does not show where the cell pulls; the uniform tension that \
                fits it best is {:.2} kPa",
                frames(&map.frames),
                map.even_kpa
            );
        }
        format!(
            "tension at the peak ({}): {:.2} kPa on average, {:.2} to {:.2} kPa in nine tenths of the cell; \
            residual of the motion {:.3} um, with a uniform tension {:.3} um",
            frames(&map.frames),
            map.mean_kpa,
            map.quantile_kpa(0.05),
            map.quantile_kpa(0.95),
            map.misfit_um,
            map.even_misfit_um
        )
    }

    /// The cell coloured by its tension, and by the standard deviation; if the map is not known,
    /// the reason.
    ///
    /// # Errors
    /// A cell that cannot be drawn.
    pub fn figure(&self) -> Result<Figure, FigureError> {
        let Followed { motion, shaped, fibres, .. } = &*self.followed;
        let map = &self.map;
        let fields = Fields::new(&motion.mesh, &fibres.directions, None)?;
        let cell = figure::DrawnCell::new(fields.clone(), Some(&shaped.outline))?;
        if !map.is_known() {
            return figure::no_map(&cell, &map.positions_um, &map.why_not_known());
        }
        let one = |name: String, values: &[f64], quantity: &str| Map {
            name,
            positions: &map.positions_um,
            values: fields.from_triangles(values),
            quantity: quantity.to_owned(),
            limits: None,
            doubts: None,
            hatched: figure::NOT_KNOWN,
            dots: None,
        };
        let tension =
            one("Where the cell pulls".to_owned(), &map.tensions_kpa, "Active tension (kPa)");
        let maps = [
            Map { doubts: Some(fields.from_triangles(&map.doubts())), ..tension },
            one("How sure that is".to_owned(), &map.deviations_kpa, "Standard deviation (kPa)"),
        ];
        figure::maps(&cell, &maps, Some(map.resolution_um()))
    }

    /// The map at rest, while the tension rises, at its peak, while it falls, and at the end of one beat; `None` if the map
    /// is not known.
    ///
    /// # Errors
    /// A cell that cannot be drawn.
    pub fn beat_figure(&self) -> Result<Option<Figure>, FigureError> {
        let Followed { motion, shaped, fibres, .. } = &*self.followed;
        let (film, shown) = (&self.film, motion.frames_with_cell());
        let Some(beat) = FilmBeat::of(motion, &shown).filter(|_| self.map.is_known()) else {
            return Ok(None);
        };
        let fields = Fields::new(&motion.mesh, &fibres.directions, None)?;
        let cell = figure::DrawnCell::new(fields.clone(), Some(&shaped.outline))?;
        let places = beat.moments.iter().filter_map(|(at, name)| {
            let place = film.frames.iter().position(|frame| *frame == motion.frames[*at])?;
            Some((*at, *name, place))
        });
        let places: Vec<(usize, &str, usize)> = places.collect();
        let positions: Vec<_> = places.iter().map(|(at, ..)| motion.positions(*at)).collect();
        let known = places
            .iter()
            .flat_map(|&(_, _, place)| film.tensions_kpa(place).into_iter().zip(film.known(place)));
        let most =
            known.filter(|(_, known)| *known).map(|(tension, _)| tension).fold(0.0, f64::max);
        let maps = places.iter().zip(&positions).map(|(&(_, name, place), positions)| Map {
            name: format!("{name}, {:.0} ms", film.times_ms[place]),
            positions,
            values: fields.from_triangles(&film.tensions_kpa(place)),
            quantity: "Active tension (kPa)".to_owned(),
            limits: Some([0.0, most]),
            doubts: Some(fields.from_triangles(&film.doubts(place))),
            hatched: figure::NOT_KNOWN,
            dots: None,
        });
        let maps: Vec<Map<'_>> = maps.collect();
        let note = |&(_, _, place): &(usize, &str, usize)| {
            let (mean, deviation) = (film.means_kpa[place], film.mean_deviations_kpa[place]);
            let known = self.known_pct(place);
            format!("mean {mean:.1} \u{b1} {deviation:.1} kPa, {known:.0} % of the cell known")
        };
        let notes: Vec<String> = places.iter().map(note).collect();
        let title = format!("Active tension over {}", beat.words());
        figure::map_series(&cell, &maps, &title, &notes).map(Some)
    }

    /// Part of the cell whose tension is known in a frame, by its place in the film of the map, %.
    fn known_pct(&self, frame: usize) -> f64 {
        let known = self.film.known(frame);
        let places = known.iter().filter(|known| **known).count();
        100.0 * places as f64 / known.len().max(1) as f64
    }

    pub(super) fn write(
        &self,
        folder: &Folder,
        observer: &dyn Observer,
    ) -> Result<(), ExperimentError> {
        folder.write("tension_map.csv", self.table().to_csv()?)?;
        // The grid is written only if the map is known.
        if self.map.is_known() {
            folder.write("tension_map.vtu", self.grid()?)?;
            folder.write("tension_frames.csv", self.frames_table().to_csv()?)?;
            folder.write("tension_frames.npz", self.arrays()?)?;
        }
        let draw = || self.figure();
        folder.figures(Theme::Light, &[("tension_map", &draw)], observer)?;
        if let Some(figure) = self.beat_figure()? {
            let draw = || Ok(figure.clone());
            folder.figures(Theme::Light, &[("tension_over_beat", &draw)], observer)?;
        }
        Ok(())
    }

    /// A row for each triangle.
    pub fn table(&self) -> Table {
        let (map, mesh) = (&self.map, &self.followed.motion.mesh);
        let column = |name: &str, values: &mut dyn Iterator<Item = f64>| Column::Number {
            name: name.to_owned(),
            values: values.map(Some).collect(),
        };
        let centres: Vec<[f64; 2]> = mesh.simplices.iter().map(|it| mesh.centre(it)).collect();
        let columns = vec![
            column("triangle", &mut (0..centres.len()).map(|at| at as f64)),
            column("x_um", &mut centres.iter().map(|centre| centre[0])),
            column("y_um", &mut centres.iter().map(|centre| centre[1])),
            column("tension_kPa", &mut map.tensions_kpa.iter().copied()),
            column("standard_deviation_kPa", &mut map.deviations_kpa.iter().copied()),
            column("relative_tension", &mut map.relative().into_iter()),
            column("relative_standard_deviation", &mut map.relative_deviations.iter().copied()),
            column("resolution_um", &mut map.resolutions_um.iter().copied()),
            column("standard_deviation_over_tension", &mut map.doubts().into_iter()),
        ];
        Table { columns }
    }

    /// A row for each frame: the mean over the cell and how much of it is known.
    pub fn frames_table(&self) -> Table {
        let film = &self.film;
        let column = |name: &str, values: Vec<f64>| Column::Number {
            name: name.to_owned(),
            values: values.into_iter().map(Some).collect(),
        };
        let columns = vec![
            column("frame", film.frames.iter().map(|frame| *frame as f64).collect()),
            column("t_ms", film.times_ms.clone()),
            column("mean_tension_kPa", film.means_kpa.clone()),
            column("standard_deviation_kPa", film.mean_deviations_kpa.clone()),
            column(
                "known_pct",
                (0..film.frames.len()).map(|frame| self.known_pct(frame)).collect(),
            ),
        ];
        Table { columns }
    }

    /// Tension of each triangle in a frame, kPa, not a number where it is not known; by its place in the film of the map.
    pub fn known_tensions_kpa(&self, frame: usize) -> Vec<f64> {
        let values = self.film.tensions_kpa(frame).into_iter().zip(self.film.known(frame));
        values.map(|(value, known)| if known { value } else { f64::NAN }).collect()
    }

    /// The tensions of all frames for NumPy.
    fn arrays(&self) -> Result<Vec<u8>, ExperimentError> {
        let film = &self.film;
        let shape = [film.frames.len(), self.followed.motion.mesh.simplices.len()];
        let frames = 0..film.frames.len();
        let tensions = frames.clone().flat_map(|frame| self.known_tensions_kpa(frame));
        let deviations = frames.flat_map(|frame| film.deviations_kpa(frame));
        let arrays = vec![
            ("t_ms", Array::floats([shape[0]], film.times_ms.iter().copied())),
            ("tension_kpa", Array::floats(shape, tensions)),
            ("standard_deviation_kpa", Array::floats(shape, deviations)),
        ];
        npz::to_bytes(&arrays).map_err(ExperimentError::new)
    }

    /// The cell under the map, for ParaView.
    fn grid(&self) -> Result<String, ExperimentError> {
        let Followed { motion, fibres, .. } = &*self.followed;
        let map = &self.map;
        let time =
            |frame: &usize| motion.times_ms[motion.frames.partition_point(|one| one < frame)];
        let peak = map.frames.first().map_or(0.0, time);
        let frame = Frame {
            ta_by_triangle_kpa: Some(map.tensions_kpa.clone()),
            ..Frame::new(peak, map.mean_kpa, map.positions_um.clone())
        };
        Ok(vtu::Frames::new(&motion.mesh, &[frame], &fibres.directions, None)?.frame(0))
    }
}

/// `frame 12`, `frames 12 to 14`, `6 frames from 12 to 80`.
fn frames(frames: &[usize]) -> String {
    match frames {
        [] => "no frame".to_owned(),
        [one] => format!("frame {one}"),
        [first, .., last] if last - first + 1 == frames.len() => {
            format!("frames {first} to {last}")
        }
        [first, .., last] => format!("{} frames from {first} to {last}", frames.len()),
    }
}
