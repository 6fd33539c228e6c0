//! Fits and their inputs.

use super::cell::{FittableCell, FittedCell};
use super::curves::Named;
use super::film::FollowedFilm;
use super::shapes::Shapes;
use crate::experiment::tension_map::FilmMap;
use crate::experiment::traction::FoundTractions;
use crate::experiment::{Files, Inputs};
use crate::mechanics::material::Material;
use crate::mesh::outline::Outline;
use crate::mesh::quality::MeshReport;
use crate::settings::Run;
use crate::simulation::SharedPath;

/// What is to be fitted.
pub(super) struct Work {
    pub(super) cell: FittableCell,
    pub(super) report: MeshReport,
    pub(super) outline: Outline,
    pub(super) curves: Vec<Named>,
    /// Whether the cell is that of the film.
    pub(super) own: bool,
    /// Of films of beads.
    pub(super) tractions: Vec<FoundTractions>,
    pub(super) threads: Option<usize>,
    pub(super) files: Files,
}

/// The result of fits.
pub struct Fits {
    /// Name of the cell's shape.
    pub name: String,
    /// A cell for each curve, in their order; fewer where the work was interrupted.
    pub cells: Vec<FittedCell>,
    /// The film that was followed.
    pub film: Option<FollowedFilm>,
    /// Where the film's cell pulls.
    pub map: Option<FilmMap>,
    /// The shapes of the film's cell and of the fitted one at their peak.
    pub shapes: Option<Shapes>,
    /// Assumptions and remarks from reading the files.
    pub notes: Vec<String>,
    pub(super) work: Option<Work>,
}

/// What the files of all cells have in common.
pub(super) struct Shared<'a> {
    pub(super) fits: &'a Fits,
    pub(super) work: &'a Work,
    /// The run of the cell before it was fitted.
    pub(super) run: &'a Run,
    pub(super) inputs: Inputs,
    /// Equilibria of all cells of this material.
    pub(super) path: Option<(SharedPath, &'a Material)>,
}
