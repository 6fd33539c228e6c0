//! Fits to films: the cell is followed, and its stretch is the curve.

use super::curves::Named;
use super::description::FitCell;
use crate::analysis::kind::Kind;

use crate::experiment::input::ChosenSetting;
use crate::experiment::tables::is_of_tables;
use crate::experiment::track::{Followed, Track, TrackReport};
use crate::experiment::{ExperimentError, Files, Folder, Observer};
use crate::measured::{Column, Curve, TableOptions};
use crate::microscopy::outlines::{NamedOutline, write_geojson};
use crate::output::json;
use crate::output::track::{self as table, TrackRow};
use crate::settings::{Run, Shaped, Source};
use std::path::{Path, PathBuf};
use std::slice;
use std::sync::Arc;

/// Where the film's results go.
const FOLDER: &str = "track";

/// Reads one curve from the rows of a film.
type Read = fn(&TrackRow) -> Option<f64>;

/// The curves of a film, by their columns in `track.csv`; the first is fitted unless another is named.
const COLUMNS: [(&str, Kind, &str, Read); 4] = [
    ("stretch_1", Kind::NormalisedLength, "", |row| Some(row.stretch_1)),
    ("length_um", Kind::Length, "um", |row| Some(row.length_um)),
    ("shortening_pct", Kind::Shortening, "%", |row| Some(row.shortening_pct)),
    ("sarcomere_um", Kind::SarcomereLength, "um", |row| row.sarcomere_um),
];

/// A film whose cell was followed.
pub struct FollowedFilm {
    /// The file or folder.
    pub path: PathBuf,
    /// The cell and its motion.
    pub followed: Arc<Followed>,
    report: TrackReport,
}

impl FitCell {
    /// The film that is fitted to, if there is one: the only file in `to`, or `cell`.
    pub(super) fn film(&self) -> Result<Option<&Path>, ExperimentError> {
        let is_film = |path: &&PathBuf| !is_of_tables(path);
        match (self.measured(), &self.cell) {
            ([], None) => Err(ExperimentError::new("there is nothing to fit to").advise(
                "name a measured curve or a film: myospring fit cell.csv, myospring fit film.avi",
            )),
            ([], Some(one)) => Ok(Some(one)),
            ([one], _) => Ok(Some(one).filter(is_film).map(PathBuf::as_path)),
            (several, _) => match several.iter().find(is_film) {
                None => Ok(None),
                Some(film) => Err(ExperimentError::new(format!(
                    "`{}` is a film, not a table of curves; fit one film alone, or tables of curves",
                    film.display()
                ))),
            },
        }
    }

    /// The files of curves, or the film: a table alone can only be a curve.
    pub(super) fn measured(&self) -> &[PathBuf] {
        match &self.cell {
            Some(table) if self.to.is_empty() && is_of_tables(table) => slice::from_ref(table),
            _ => &self.to,
        }
    }

    /// The file of the cell's shape.
    pub(super) fn shape(&self) -> Option<&Path> {
        let cell = self.cell.as_deref()?;
        (!self.to.is_empty() || !is_of_tables(cell)).then_some(cell)
    }

    /// How the film is followed.
    pub(super) fn track(&self, path: &Path, settings: &[ChosenSetting]) -> Track {
        Track {
            settings: settings.to_vec(),
            frame_rate: self.table.frame_rate_per_s,
            refused: self.refused.clone(),
            ..Track::of(path)
        }
    }

    pub(super) fn follow(
        &self,
        path: &Path,
        settings: &[ChosenSetting],
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<FollowedFilm, ExperimentError> {
        let track = self.track(path, settings);
        track.check(files)?;
        let followed = track.follow(files, observer)?;
        let report = TrackReport::of(path, &followed);
        Ok(FollowedFilm { path: path.to_owned(), report, followed: Arc::new(followed) })
    }
}

impl FollowedFilm {
    /// Warnings about its curve.
    pub fn warnings(&self) -> &[String] {
        &self.report.warnings
    }

    /// Its curve, only the part that counts.
    pub(super) fn named(&self, table: &TableOptions) -> Result<Named, ExperimentError> {
        let curve = self.curve(&table.values)?;
        let curve = curve.part(table.from_ms, table.until_ms).map_err(ExperimentError::new)?;
        Ok((curve.name.clone(), Ok(curve)))
    }

    /// Its curve: the cell's mean stretch along the contraction, unless a column of `track.csv` was named.
    fn curve(&self, columns: &[Column]) -> Result<Curve, ExperimentError> {
        let wanted = match columns {
            [] => COLUMNS[0].0.to_owned(),
            [Column::Name(name)] => name.clone(),
            [Column::Number(number)] => number.to_string(),
            _ => return Err(ExperimentError::new("--columns: give one column of a film")),
        };
        let Some((name, kind, unit, read)) = COLUMNS.into_iter().find(|(name, ..)| *name == wanted)
        else {
            let known = COLUMNS.map(|(name, ..)| name).join(", ");
            return Err(ExperimentError::new(format!("--columns: a film has no `{wanted}`"))
                .advise(format!("it has {known}")));
        };
        let points = self.report.rows.iter().filter_map(|row| Some((row.t_ms, read(row)?)));
        let (times_ms, values): (Vec<f64>, Vec<f64>) = points.unzip();
        let lines = (0..times_ms.len() as u64).map(|row| row + 2).collect();
        let stimuli_ms = Vec::new();
        Ok(Curve { name: name.to_owned(), kind, unit, times_ms, values, lines, stimuli_ms })
    }

    /// Name, run and shape of its cell at rest.
    pub(super) fn input(&self) -> (String, Run, Shaped) {
        let name = self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        (name, self.followed.run.clone(), self.followed.shaped.clone())
    }

    /// Writes the tracked film; a run of the film's own cell then has the shape of its frame at
    /// rest.
    pub(super) fn write(
        &self,
        folder: &Folder,
        name: &str,
        own: Option<&mut Run>,
    ) -> Result<(), ExperimentError> {
        let within = |file: &str| format!("{FOLDER}/{file}");
        folder.write(&within("track.csv"), table::to_csv(&self.report.rows)?)?;
        folder.write(&within("track.json"), json::for_people(&self.report)?)?;
        folder.write(&within("rest.tif"), &*self.followed.rest_picture)?;
        let outline = self.followed.shaped.outline.clone();
        let outline = NamedOutline { name: name.to_owned(), outline };
        folder.write(&within("outline.geojson"), write_geojson(&[outline]))?;
        if let Some(Source::Picture(source)) = own.map(|run| &mut run.shape.source) {
            let written =
                |file: &str| folder.target().join(within(file)).to_string_lossy().into_owned();
            source.path = written("rest.tif");
            source.outline = Some(written("outline.geojson"));
        }
        Ok(())
    }
}
