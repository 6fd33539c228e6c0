//! A cell on its mesh, with its fibres, without a simulation.

use super::error::ExperimentError;
use super::files::Files;
use super::folder::Folder;
use super::input::{self, Input};
use super::observer::Observer;
use super::overlay::{self, Lattice};
use super::refused::Place;
use super::{Experiment, Outcome, fibres};
use crate::mesh::quality::MeshReport;
use crate::output::figure::{self, Theme};
use crate::output::json;
use crate::run_file::Shaped;
use crate::settings::{FibreReport, Fibres, Run};
use serde::Serialize;

/// Meshes a cell.
pub struct MeshCell {
    /// Name of the cell, for people.
    pub name: String,
    /// Its shape and fibres.
    pub run: Run,
    /// Where an overlay goes that shows why a picture gives no cell.
    pub refused: Option<Place>,
}

/// A cell on its mesh.
pub struct Meshed {
    name: String,
    /// The mesh with its outline and picture; the report has the warnings of the fibres, too.
    pub shaped: Shaped,
    /// The fibres, and what the picture shows of them.
    pub fibres: Fibres,
}

/// mesh.json.
#[derive(Serialize)]
struct Numbers<'a> {
    #[serde(flatten)]
    mesh: &'a MeshReport,
    /// Of a picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    fibres: Option<FibreReport>,
}

impl Experiment for MeshCell {
    type Outcome = Meshed;

    fn run(&self, files: &Files, _: &dyn Observer) -> Result<Meshed, ExperimentError> {
        let (name, refused) = (self.name.clone(), self.refused.clone());
        let Input { name, run, mut shaped, .. } =
            input::mesh(name, self.run.clone(), refused, files)?;
        let fibres = run.fibres(&shaped)?;
        shaped.report.warnings.extend(fibres.warnings.iter().cloned());
        Ok(Meshed { name, shaped, fibres })
    }
}

impl Meshed {
    /// What the picture or the stack shows of the fibres, where there is one.
    pub fn fibres_of_picture(&self) -> Option<FibreReport> {
        self.shaped.shown().map(|_| self.fibres.report())
    }
}

impl Outcome for Meshed {
    fn numbers(&self) -> impl Serialize {
        Numbers { mesh: &self.shaped.report, fibres: self.fibres_of_picture() }
    }

    fn warnings(&self) -> Vec<String> {
        self.shaped.report.warnings.clone()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        let Shaped { mesh, report, outline, picture, .. } = &self.shaped;
        folder.write("mesh.json", json::for_people(&self.numbers())?)?;
        folder.write("outline.geojson", outline.to_geojson())?;
        folder.figures(Theme::default(), &[("mesh", &|| figure::mesh(mesh))], observer)?;
        if let Some((cells, cell)) = picture {
            let lattice = Some(Lattice { mesh, fibres: &self.fibres });
            let draw = || overlay::draw(&self.name, cells, &[cell], lattice, &report.warnings);
            folder.figures(Theme::default(), &[("overlay", &draw)], observer)?;
        }
        fibres::write(folder, [(self.name.as_str(), mesh, &self.fibres)])
    }
}
