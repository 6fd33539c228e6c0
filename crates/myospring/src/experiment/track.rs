//! The motion of a cell through a film: its length, width, strains and sarcomeres, frame by frame.

mod description;
mod followed;
mod open;
mod outputs;
mod page;
mod report;

pub use description::{Output, Track};
pub use followed::Followed;
pub use report::{HeadlineReport, TrackReport};

use super::{Experiment, ExperimentError, Files, Folder, Observer, Outcome};
use crate::microscopy::outlines::{NamedOutline, write_geojson};
use crate::output::{json, track as table};
use followed::AtRest;
use serde::Serialize;

/// A cell that was followed.
pub struct Tracked {
    /// Name of the film.
    pub name: String,
    /// The film, the cell and its motion.
    pub followed: Followed,
    /// Every number, and a row for each frame.
    pub report: TrackReport,
    /// What is saved in addition to the curve.
    pub outputs: Vec<Output>,
}

impl Track {
    /// Checks the settings and that the film exists; returns the name of the results.
    ///
    /// # Errors
    /// Settings that are not possible, and a film that is not there.
    pub fn check(&self, files: &Files) -> Result<String, ExperimentError> {
        followed::settled(self, files, &())?;
        open::name(&self.film, files)
    }

    /// Finds the cell in the frame at rest and follows it. If it is interrupted, the frames that are done are kept.
    ///
    /// # Errors
    /// A film that cannot be read, that does not say its frame rate or its pixel size, or that shows no cell; a cell
    /// that cannot be followed.
    pub fn follow(
        &self,
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<Followed, ExperimentError> {
        let at_rest = AtRest::find(self, files, observer)?;
        observer.keeps("the frames that are done are written");
        at_rest.follow(self, observer)
    }
}

impl Experiment for Track {
    type Outcome = Tracked;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<Tracked, ExperimentError> {
        let name = self.check(files)?;
        let followed = self.follow(files, observer)?;
        let report = TrackReport::of(&self.film, &followed);
        Ok(Tracked { name, followed, report, outputs: self.outputs.clone() })
    }
}

impl Outcome for Tracked {
    fn numbers(&self) -> impl Serialize {
        &self.report
    }

    fn warnings(&self) -> Vec<String> {
        self.report.warnings.clone()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        let Self { name, followed, report, outputs } = self;
        folder.write("track.csv", table::to_csv(&report.rows)?)?;
        folder.write("track.json", json::for_people(report)?)?;
        folder.write("rest.tif", &followed.rest_picture)?;
        let outline = followed.shaped.outline.clone();
        folder.write(
            "outline.geojson",
            write_geojson(&[NamedOutline { name: name.clone(), outline }]),
        )?;
        outputs::write(folder, outputs, followed, report, observer)
    }
}
