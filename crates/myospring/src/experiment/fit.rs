//! A cell's own parameters from its measured curves, or from a film of its beat.

mod calcium;
mod cell;
mod curves;
mod description;
mod files;
mod film;
mod models;
mod outcome;
mod over_film;
mod page;
mod shapes;
mod simulation;
mod tables;
mod traction;
pub mod words;

use super::input::{self, ChosenSetting, Input};
use super::tension_map::FilmMap;
use super::{Experiment, ExperimentError, Files, Folder, Observer, Outcome};
use crate::cell as cells;
use crate::fit::Loaded;
use crate::interruption::Interruption;
use crate::settings::{self, PICTURE_ENDINGS, Run, Shaped, Value};
use crate::study::Threads;
pub use calcium::{DrivingCalcium, RecordedCalcium};
pub use cell::{FittableCell, FittedCell};
pub use curves::{EndSprings, Named, between_springs, of_table};
pub use description::FitCell;
pub use film::FollowedFilm;
pub use models::Models;
pub use outcome::Fits;
use outcome::Work;
use serde::Serialize;
pub use shapes::Shapes;
use std::path::Path;
use std::sync::Arc;
use traction::{ForceReader, ReadForce};
pub use traction::{SCALE_ERROR, TractionCurve, on_gel, scale_error};

/// A fit whose files are read, and whose film is followed.
pub struct PreparedFit {
    /// Name of the cell's shape.
    name: String,
    /// Stem of the first file with curves, where that names the results.
    stem: Option<String>,
    film: Option<FollowedFilm>,
    /// `None` where following the film was interrupted.
    work: Option<Work>,
    notes: Vec<String>,
}

impl Experiment for FitCell {
    type Outcome = Fits;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<Fits, ExperimentError> {
        self.ready(files, observer)?.run(observer)
    }
}

impl FitCell {
    /// Reads every file, follows the film, and checks all that can be checked before the work of the fits.
    ///
    /// # Errors
    /// Files that cannot be read, a film whose cell cannot be followed, a run that cannot be
    /// fitted, and names of parameters that are not fitted.
    pub fn ready(
        &self,
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<PreparedFit, ExperimentError> {
        self.cell.iter().chain(&self.to).for_each(|path| files.note(path));
        let film = self.film()?;
        let (mut settings, seeks_tension) = self.settings();
        let models = self.models(&settings, seeks_tension, film, files)?;
        // Before the others, which it would put out of force.
        settings.splice(0..0, models.first().and_then(model_named));
        let film = film.map(|path| self.follow(path, &settings, files, observer)).transpose()?;
        let stem = self.measured().first().filter(|_| self.shape().is_none());
        let stem = stem.and_then(|path| path.file_stem());
        let stem = stem.map(|stem| stem.to_string_lossy().into_owned());
        let interruption = observer.interruption();
        if film.is_some() && interruption.is_requested() {
            let name = self.cell.as_ref().or(self.to.first()).and_then(|path| path.file_stem());
            let name = name.unwrap_or_default().to_string_lossy().into_owned();
            return Ok(PreparedFit { name, stem, film, work: None, notes: Vec::new() });
        }
        let (curves, own, mut notes) = match &film {
            Some(film) => (vec![film.named(&self.table)?], Vec::new(), film.warnings().to_vec()),
            None => curves::of_tables(self.measured(), &self.table, files)?,
        };
        let mut loaded = self.between_springs(curves.len(), files)?;
        let (calcium, more) = self.calcium.of(&curves, own, (&self.table, &self.beats), files)?;
        notes.extend(more);
        // A film without another picture gives the cell itself.
        let own = film.as_ref().filter(|film| self.shape().is_none_or(|cell| cell == film.path));
        let (name, mut run, shaped) = match own {
            Some(film) => film.input(),
            None => self.input(&settings, files, &interruption)?,
        };
        notes.extend(run.assumed.iter().cloned());
        let own = own.is_some();
        let scale_error = traction::scale_error(self.traction_error)?;
        let reader = ForceReader {
            support: run.support,
            options: &self.table,
            beats: &self.beats,
            film: film.as_ref().map(|film| &film.followed),
            picture: self.shape().filter(|cell| is_picture(cell)),
            threads: self.threads,
            files,
            observer,
        };
        let mut tractions = Vec::new();
        for curve in &self.traction {
            let ReadForce { loaded: found, notes: more, tractions: own } = reader.read(curve)?;
            loaded.push(Loaded { scale_error, ..found });
            notes.extend(more);
            tractions.extend(own);
        }
        let made = run.make(shaped, |file| files.bytes(file))?;
        run.fibre = made.fibres.taken;
        let (report, outline) = (made.report.clone(), made.outline.clone());
        let cell = FittableCell::new(
            run,
            made,
            models,
            &self.sought,
            (self.beats.clone(), loaded, calcium),
        )?;
        let (threads, files) = (self.threads, files.clone());
        let work = Work { cell, report, outline, curves, own, tractions, threads, files };
        Ok(PreparedFit { name, stem, film, work: Some(work), notes })
    }

    /// The settings that were given, and whether the tension itself is sought. Fits are quasi-static, so a viscous cell needs
    /// no integrator.
    fn settings(&self) -> (Vec<ChosenSetting>, bool) {
        const METHOD: &str = "numerics.integrator";
        let has = |key: &str| self.settings.iter().any(|(setting, _)| setting.key == key);
        let mut settings = self.settings.clone();
        let seeks_tension = seeks_tension(&mut settings);
        if has("material.retardation_time") && !has(METHOD) {
            let method = settings::find(METHOD);
            settings.extend(method.map(|it| (it, Value::Text("quasi-static".to_owned()))));
        }
        (settings, seeks_tension)
    }

    /// The cell models that are fitted: that which was asked for, or all.
    fn models(
        &self,
        settings: &[ChosenSetting],
        seeks_tension: bool,
        film: Option<&Path>,
        files: &Files,
    ) -> Result<Models, ExperimentError> {
        if seeks_tension {
            return Ok(Models::Tension);
        }
        let of_cell = self.shape().filter(|cell| film != Some(*cell));
        if input::gives(of_cell, settings, MODEL, files)? {
            return Ok(Models::OfRun);
        }
        let resolve = |name: &str| {
            let settings: Vec<_> = model_named(name).into_iter().chain(settings.to_vec()).collect();
            match (film, of_cell) {
                (Some(film), None) => self.track(film, &settings).settled(files),
                _ => Ok(input::settle(of_cell, &settings, files, &Interruption::default())?.1),
            }
        };
        Models::all(resolve, |file| files.bytes(file))
    }

    fn between_springs(
        &self,
        curves: usize,
        files: &Files,
    ) -> Result<Vec<Loaded>, ExperimentError> {
        let loaded = self.loaded.iter();
        let loaded = loaded.map(|spring| spring.read(&self.table, &self.beats, files));
        let loaded: Vec<Loaded> = loaded.collect::<Result<_, _>>()?;
        let option = if loaded.is_empty() { "--traction" } else { "--loaded" };
        if curves > 1 && !(loaded.is_empty() && self.traction.is_empty()) {
            return Err(ExperimentError::new(format!(
                "{option} needs one cell, but --to has {curves} curves"
            ))
            .advise("--columns chooses the curve of that cell"));
        }
        Ok(loaded)
    }

    fn input(
        &self,
        settings: &[ChosenSetting],
        files: &Files,
        interruption: &Interruption,
    ) -> Result<(String, Run, Shaped), ExperimentError> {
        let place = |_: &str| self.refused.clone();
        let read = input::read(self.shape(), settings, place, files, interruption)?;
        let Input { name, run, shaped, .. } = read;
        Ok((name, run, shaped))
    }
}

fn is_picture(path: &Path) -> bool {
    PICTURE_ENDINGS.contains(&input::ending(path).as_str())
}

/// The setting of the cell model.
const MODEL: &str = "cell.model";

fn model_named(name: &str) -> Option<ChosenSetting> {
    Some((settings::find(MODEL)?, Value::Text(name.to_owned())))
}

/// Whether settings ask for the tension itself: by a model whose tension is given, which nobody gave. It is then no longer
/// among them.
pub fn seeks_tension(settings: &mut Vec<ChosenSetting>) -> bool {
    let is_given = |(setting, value): &ChosenSetting| {
        let model = value.as_text().filter(|_| setting.key == MODEL);
        model.is_some_and(|name| cells::model(name).is_ok_and(|model| model.given_peak().is_some()))
    };
    let has_table = settings.iter().any(|(setting, _)| setting.key == "cell.tension");
    let seeks = !has_table && settings.iter().any(is_given);
    if seeks {
        settings.retain(|setting| !is_given(setting));
    }
    seeks
}

impl PreparedFit {
    /// A name for the folder of the results: `cell_fit`, for several cells `cells_fits`.
    pub fn results(&self) -> String {
        let of = self.stem.as_ref().unwrap_or(&self.name);
        let many = self.work.as_ref().is_some_and(|work| work.curves.len() > 1);
        format!("{of}_{}", if many { "fits" } else { "fit" })
    }

    /// Fits every cell.
    ///
    /// # Errors
    ///
    /// For a single curve, why it cannot be fitted; for several, the reason is in the cell's row.
    pub fn run(self, observer: &dyn Observer) -> Result<Fits, ExperimentError> {
        let Self { name, film, work, mut notes, .. } = self;
        let cells = match &work {
            Some(work) => {
                work.cell.fit(&work.curves, &notes, &Threads::new(work.threads)?, observer)?
            }
            None => Vec::new(),
        };
        let (mut map, mut shapes) = (None, None);
        // Only for the film's own shape: another picture has other points.
        if let (Some(work), Some(film), Some(first)) =
            (work.as_ref().filter(|work| work.own), &film, cells.first())
        {
            let followed = &film.followed;
            let candidate = first.found.as_ref().map_or(work.cell.first(), |fit| work.cell.of(fit));
            match FilmMap::of(Arc::clone(followed), candidate.fitter.simulation()) {
                Ok(found) => map = Some(found),
                Err(error) => notes.push(format!("the map of tension is left out: {error}")),
            }
            if let (Ok(fit), false) = (&first.found, observer.interruption().is_requested()) {
                shapes = Shapes::of(Arc::clone(followed), candidate, fit)?;
                notes.extend(shapes.as_ref().and_then(Shapes::remark));
            }
        }
        Ok(Fits { name, cells, film, map, shapes, notes, work })
    }
}

impl Fits {
    /// The cells that were fitted.
    pub fn fitted(&self) -> impl Iterator<Item = (&FittedCell, &crate::fit::Fit)> {
        self.cells.iter().filter_map(|cell| Some((cell, cell.found.as_ref().ok()?)))
    }

    /// The run that beats like a fitted cell, and the spacing of its mesh, um.
    ///
    /// # Errors
    /// Numbers that the model does not take.
    pub fn fitted_run(&self, fit: &crate::fit::Fit) -> Result<(Run, f64), ExperimentError> {
        let work = self.work.as_ref().ok_or_else(|| ExperimentError::new("nothing was fitted"))?;
        work.cell.fitted_run(fit)
    }

    /// Whether there is a fit of every curve.
    pub fn is_whole(&self) -> bool {
        self.work.as_ref().is_some_and(|work| self.fitted().count() == work.curves.len())
    }
}

impl Outcome for Fits {
    fn numbers(&self) -> impl Serialize {
        files::records(self)
    }

    fn warnings(&self) -> Vec<String> {
        let several = self.work.as_ref().is_some_and(|work| work.curves.len() > 1);
        let of_fits = self.fitted().flat_map(|(cell, fit)| {
            let of = if several { format!("{}: ", cell.name) } else { String::new() };
            fit.verdicts.iter().map(move |verdict| format!("{of}{verdict}"))
        });
        let of_map = self.map.iter().flat_map(FilmMap::verdicts);
        let of_map = of_map.map(|verdict| format!("map of tension: {verdict}"));
        self.notes.iter().cloned().chain(of_fits).chain(of_map).collect()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        let mut run = self.work.as_ref().map(|work| work.cell.first().run.clone());
        if let Some(film) = &self.film {
            let own = self.work.as_ref().is_some_and(|work| work.own);
            film.write(folder, &self.name, run.as_mut().filter(|_| own))?;
        }
        let tractions = self.work.iter().flat_map(|work| &work.tractions);
        for (number, found) in (1..).zip(tractions) {
            let place =
                if number == 1 { "traction".to_owned() } else { format!("traction_{number}") };
            found.save(&folder.within(&place), observer)?;
        }
        match (&self.work, run) {
            (Some(work), Some(run)) if !self.cells.is_empty() => {
                files::write(folder, self, work, &run, observer)
            }
            _ => Ok(()),
        }
    }
}
