//! The motion of a cell through a film: its length, width, strains and sarcomeres, frame by frame.

mod cells;
mod description;
mod followed;
mod open;
mod outputs;
mod page;
mod report;
mod tracked;

pub use cells::{FilmCell, TrackCells, TrackedCells};
pub(in crate::experiment) use followed::{OpenedFilm, rate as frame_rate};
pub(in crate::experiment) use open::{is_film, name as film_name, open as open_film};

pub use description::{Output, Track};
pub use followed::Followed;
pub use report::{HeadlineReport, TrackReport};
pub use tracked::Tracked;

use super::{Experiment, ExperimentError, Files, Folder, Observer, Outcome};
use crate::settings::Run;
use followed::AtRest;
use serde::Serialize;
use std::sync::Arc;

impl Track {
    /// Checks the settings and that the film exists; returns the name of the results.
    ///
    /// # Errors
    /// Settings that are not possible, and a film that is not there.
    pub fn check(&self, files: &Files) -> Result<String, ExperimentError> {
        self.settled(files)?;
        open::name(&self.film, files)
    }

    /// The run of its settings.
    pub(super) fn settled(&self, files: &Files) -> Result<Run, ExperimentError> {
        followed::settled(self, files, &())
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
        let cell = at_rest.cell(self, files)?;
        observer.keeps("the frames that are done are written");
        let one = at_rest.follow(vec![cell], self, observer)?.into_iter();
        let one: Result<Vec<Followed>, _> = one.collect();
        one.map(|mut one| one.swap_remove(0)).map_err(|cause| followed::unfollowed(self, &cause))
    }
}

impl Experiment for Track {
    type Outcome = Tracked;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<Tracked, ExperimentError> {
        let name = self.check(files)?;
        let followed = Arc::new(self.follow(files, observer)?);
        let report = Arc::new(TrackReport::of(&self.film, &followed));
        Ok(Tracked { name, followed, report, outputs: self.outputs.clone() })
    }
}

impl Outcome for Tracked {
    fn numbers(&self) -> impl Serialize {
        &*self.report
    }

    fn warnings(&self) -> Vec<String> {
        self.report.warnings.clone()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        folder.write("rest.tif", &*self.followed.rest_picture)?;
        self.save_cell(folder, observer)
    }
}
