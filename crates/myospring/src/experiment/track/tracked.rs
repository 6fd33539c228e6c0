//! A cell that was followed, and its files.

use super::description::Output;
use super::followed::Followed;
use super::outputs;
use super::report::TrackReport;
use crate::experiment::{ExperimentError, Folder, Observer};
use crate::microscopy::outlines::{NamedOutline, write_geojson};
use crate::output::{json, track as table};
use std::sync::Arc;

/// A cell that was followed.
#[derive(Clone)]
pub struct Tracked {
    /// Name of the film, or of the cell among several.
    pub name: String,
    /// The film, the cell and its motion.
    pub followed: Arc<Followed>,
    /// Every number, and a row for each frame.
    pub report: Arc<TrackReport>,
    /// What is saved in addition to the curve.
    pub outputs: Vec<Output>,
}

impl Tracked {
    /// Writes all but the frame at rest, which cells may share.
    pub(super) fn save_cell(
        &self,
        folder: &Folder,
        observer: &dyn Observer,
    ) -> Result<(), ExperimentError> {
        let Self { name, followed, report, outputs } = self;
        folder.write("track.csv", table::to_csv(&report.rows)?)?;
        folder.write("track.json", json::for_people(&**report)?)?;
        let outline = followed.shaped.outline.clone();
        folder.write(
            "outline.geojson",
            write_geojson(&[NamedOutline { name: name.clone(), outline }]),
        )?;
        outputs::write(folder, outputs, followed, report, observer)
    }
}
