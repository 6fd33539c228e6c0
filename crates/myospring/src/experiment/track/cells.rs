//! All cells of a film, followed together: a row a cell.

mod found;
mod page;
mod table;

pub use found::{FilmCell, TrackedCells};

use super::description::Track;
use super::followed::{AtRest, FrameCells};
use super::report::TrackReport;
use super::tracked::Tracked;
use crate::experiment::{Draw, Experiment, ExperimentError, Files, Folder, Observer, Outcome};
use crate::microscopy::cells::PictureCell;
use crate::microscopy::outlines::{NamedOutline, write_geojson};
use crate::output::figure::Theme;
use crate::output::json;
use crate::study::Status;
use serde::Serialize;
use std::sync::Arc;

/// Follows all cells of a film. They share the frame at rest and the motion of the stage.
pub struct TrackCells(pub Track);

/// All numbers: `cells.json`.
#[derive(Serialize)]
struct Numbers<'a> {
    program: &'static str,
    version: &'static str,
    film: &'a str,
    rest_frame: Option<usize>,
    stage: Option<&'a str>,
    cells: Vec<CellNumbers<'a>>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct CellNumbers<'a> {
    cell: &'a str,
    number: u32,
    status: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<&'a str>,
    /// As `track.json` of the cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    track: Option<&'a TrackReport>,
}

impl<'a> CellNumbers<'a> {
    fn of(cell: &'a FilmCell) -> Self {
        Self {
            cell: &cell.name,
            number: cell.number,
            status: cell.status().to_string(),
            reason: cell.found.as_ref().err().map(|(_, reason)| reason.as_str()),
            track: cell.found.as_ref().ok().map(|tracked| &*tracked.report),
        }
    }
}

impl Experiment for TrackCells {
    type Outcome = TrackedCells;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<TrackedCells, ExperimentError> {
        let Self(track) = self;
        let name = track.check(files)?;
        let at_rest = AtRest::find(track, files, observer)?;
        let FrameCells { cells: frame, shapes, left_out } =
            at_rest.cells(track, files, observer)?;
        observer.keeps("the frames that are done are written");
        let rest_picture = Arc::new(at_rest.rest_picture.clone());
        let (mut to_follow, mut cells) = (Vec::new(), Vec::new());
        let mut followed: Vec<PictureCell> = Vec::new();
        for (cell, shape) in shapes {
            match shape {
                Ok(shape) => {
                    to_follow.push(shape);
                    followed.push(cell);
                }
                Err(reason) => {
                    cells.push(FilmCell::of(&frame, cell.number, Err((Status::Failed, reason))));
                }
            }
        }
        let motions = at_rest.follow(to_follow, track, observer)?;
        for (cell, motion) in followed.into_iter().zip(motions) {
            let found = motion.map_err(|cause| (Status::Failed, cause.to_string()));
            let found = found.map(|motion| {
                let report = Arc::new(TrackReport::of(&track.film, &motion));
                let (name, outputs) = (cell.name.clone(), track.outputs.clone());
                Tracked { name, followed: Arc::new(motion), report, outputs }
            });
            cells.push(FilmCell::of(&frame, cell.number, found));
        }
        for left in left_out {
            cells.push(FilmCell::of(&frame, left.number, Err((Status::LeftOut, left.reason))));
        }
        cells.sort_by_key(|cell| cell.number);
        let none = cells.iter().all(|cell| cell.found.is_err());
        if let (true, Some(first)) = (none, cells.iter().find(|it| it.status() == Status::Failed)) {
            let (film, cell, reason) = (track.film.display(), &first.name, first.reason());
            return Err(ExperimentError::new(format!(
                "`{film}`: no cell can be followed; cell {cell}: {reason}"
            )));
        }
        let film = track.film.display().to_string();
        Ok(TrackedCells { film, name, cells, frame, rest_picture })
    }
}

impl Outcome for TrackedCells {
    fn numbers(&self) -> impl Serialize {
        Numbers {
            program: "myospring",
            version: env!("CARGO_PKG_VERSION"),
            film: &self.film,
            rest_frame: self.of_film().map(|film| film.rest_frame),
            stage: self.of_film().map(|film| film.stage.as_str()),
            cells: self.cells.iter().map(CellNumbers::of).collect(),
            warnings: self.common_warnings(),
        }
    }

    fn warnings(&self) -> Vec<String> {
        let common = self.common_warnings();
        let own = self.cells.iter().flat_map(|cell| {
            let (name, failed) = (&cell.name, cell.found.is_err());
            let why = failed.then(|| format!("cell {name}: {}: {}", cell.status(), cell.reason()));
            let warnings = cell.warnings(&common).into_iter();
            why.into_iter().chain(warnings.map(move |warning| format!("cell {name}: {warning}")))
        });
        let own: Vec<String> = own.collect();
        common.iter().cloned().chain(own).collect()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        let all = table::of_cells(self);
        folder.write("cells.csv", all.clone().for_people().to_csv()?)?;
        folder.write("cells.json", json::for_people(&self.numbers())?)?;
        folder.write("shortenings.csv", table::of_shortenings(self).to_csv()?)?;
        folder.write("rest.tif", &*self.rest_picture)?;
        let outline = |(cell, tracked): (&FilmCell, &Tracked)| NamedOutline {
            name: cell.name.clone(),
            outline: tracked.followed.shaped.outline.clone(),
        };
        let outlines: Vec<NamedOutline> = self.followed().map(outline).collect();
        folder.write("outline.geojson", write_geojson(&outlines))?;
        let draw = || self.overlay();
        let figures: [(&str, Draw<'_>); 1] = [("cells", &draw)];
        folder.figures(Theme::default(), &figures, observer)?;
        folder.write("report.html", page::html(self, &all)?)?;
        for (cell, tracked) in self.followed() {
            let place = format!("cells/{}", cell.name.replace('/', "_"));
            tracked.save_cell(&folder.within(&place), observer)?;
        }
        Ok(())
    }
}
