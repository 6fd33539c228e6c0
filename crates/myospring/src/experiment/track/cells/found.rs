//! What was found of the cells of a film.

use crate::experiment::overlay;
use crate::experiment::track::report::TrackReport;
use crate::experiment::track::tracked::Tracked;
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::report::ShapeReport;
use crate::microscopy::segment::Choice;
use crate::output::figure::{Figure, FigureError};
use crate::study::Status;
use std::sync::Arc;

/// The warning where all cells were asked for and one is found.
const ONE: &str = "one cell was found in the film. Cells that touch or overlap without a visible border count as one: look at the \
                   outline in `figures/cells`; if there are several, draw them and give --outline";

/// One of the cells of a film.
pub struct FilmCell {
    /// Its name: its number by size, or the label or name that a file gives.
    pub name: String,
    /// Its number by size, from 1.
    pub number: u32,
    /// The confidence of its outline, 0 to 1.
    pub confidence: Option<f64>,
    /// Its size and shape at rest.
    pub shape: Option<ShapeReport>,
    /// Its motion, or whether it was left out or failed, and why.
    pub found: Result<Tracked, (Status, String)>,
}

/// The cells of a film.
pub struct TrackedCells {
    /// The film, as it was named.
    pub film: String,
    /// Name of its results.
    pub name: String,
    /// Every cell, the largest first.
    pub cells: Vec<FilmCell>,
    /// The frame at rest with its cells.
    pub(super) frame: PictureCells,
    pub(super) rest_picture: Arc<Vec<u8>>,
}

impl FilmCell {
    pub(super) fn of(
        frame: &PictureCells,
        number: u32,
        found: Result<Tracked, (Status, String)>,
    ) -> Self {
        let cell = frame.cell(Choice::Number(number), true).ok();
        let name = cell.as_ref().map_or_else(|| number.to_string(), |cell| cell.name.clone());
        let confidence = cell.as_ref().map(|cell| cell.confidence.score);
        Self { name, number, confidence, shape: cell.map(|cell| cell.shape), found }
    }

    /// How it came out.
    pub fn status(&self) -> Status {
        self.found.as_ref().map_or_else(|(status, _)| *status, |_| Status::Ok)
    }

    /// Why it was not followed; empty if it was.
    pub fn reason(&self) -> &str {
        self.found.as_ref().map_or_else(|(_, reason)| reason.as_str(), |_| "")
    }

    /// What is true of it alone: warnings that not all cells of the film have.
    pub fn warnings<'a>(&'a self, common: &[String]) -> Vec<&'a str> {
        let own = self.found.iter().flat_map(|tracked| &tracked.report.warnings);
        own.filter(|warning| !common.contains(warning)).map(String::as_str).collect()
    }
}

impl TrackedCells {
    /// The cells that were followed.
    pub fn followed(&self) -> impl Iterator<Item = (&FilmCell, &Tracked)> {
        self.cells.iter().filter_map(|cell| Some((cell, cell.found.as_ref().ok()?)))
    }

    /// How many cells have this status.
    pub fn count(&self, status: Status) -> usize {
        self.cells.iter().filter(|cell| cell.status() == status).count()
    }

    /// The report of the first cell that was followed: what it says of the film holds for all.
    pub fn of_film(&self) -> Option<&TrackReport> {
        self.followed().next().map(|(_, tracked)| &*tracked.report)
    }

    /// The warnings about the film: that it shows a single cell, and those that all cells share.
    pub fn common_warnings(&self) -> Vec<String> {
        let Some(first) = self.of_film() else { return Vec::new() };
        // Of a mask or an outline that was given, the number of cells is known.
        let single = self.cells.len() == 1 && self.frame.segmentation().is_some();
        let several = self.followed().count() > 1;
        let everywhere = |warning: &&String| {
            several && self.followed().all(|(_, it)| it.report.warnings.contains(warning))
        };
        let shared = first.warnings.iter().filter(everywhere).cloned();
        single.then(|| ONE.to_owned()).into_iter().chain(shared).collect()
    }

    /// In a sentence: how many cells were followed, and how much they contract.
    pub fn words(&self) -> String {
        let contractions: Vec<f64> = self
            .followed()
            .filter(|(_, it)| !it.followed.motion.hardly_moves())
            .map(|(_, it)| it.report.headline.peak_contraction_pct)
            .collect();
        let low = contractions.iter().copied().fold(f64::INFINITY, f64::min);
        let high = contractions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let contract = match contractions.len() {
            0 => "none moves more than its noise".to_owned(),
            1 => format!("one contracts, by {high:.1} %"),
            beating => format!("{beating} contract, by {low:.1} to {high:.1} %"),
        };
        let (count, all) = (self.followed().count(), self.cells.len());
        let others = [(Status::LeftOut, "left out"), (Status::Failed, "failed")];
        let others = others.map(|(status, what)| match self.count(status) {
            0 => String::new(),
            number => format!("; {number} {what}"),
        });
        format!("{count} of {all} cells were followed: {contract}{}", others.concat())
    }

    /// The frame at rest with the outlines, which are numbered.
    pub(super) fn overlay(&self) -> Result<Figure, FigureError> {
        let chosen: Vec<&PictureCell> = self
            .followed()
            .filter_map(|(_, tracked)| Some(&tracked.followed.shaped.picture.as_ref()?.1))
            .collect();
        overlay::draw(&self.name, &self.frame, &chosen, None, &[])
    }
}
