//! A finished run, with all that its outputs are made from.

use super::beaten::RunNumbers;
use crate::experiment::folder::FigureFiles;
use crate::experiment::{Inputs, Observer};
use crate::mesh::outline::Outline;
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::output::field::{Field, Fields};
use crate::output::figure::{DrawnCell, FigureError, Theme};
use crate::recording::Frame;
use crate::settings::{Fibres, Run};
use crate::simulation::{Outcome, Simulation};

/// How figures and films look.
#[derive(Debug, Clone, Copy, Default)]
pub struct Style {
    /// What the cell is coloured by; unless given, [`Field::most_telling`].
    pub colour: Option<Field>,
    /// Light or dark.
    pub theme: Theme,
}

/// A finished run, with all that an output may be made from.
pub(crate) struct Finished<'a> {
    /// Name of the results, for people.
    pub(crate) name: &'a str,
    pub(crate) run: &'a Run,
    /// The simulation, with the mesh at rest.
    pub(crate) simulation: &'a Simulation,
    /// The outline at rest, um.
    pub(crate) outline: &'a Outline,
    pub(crate) fibres: &'a Fibres,
    /// The picture with its cells, and the simulated one.
    pub(crate) picture: Option<&'a (PictureCells, PictureCell)>,
    pub(crate) outcome: &'a Outcome,
    pub(crate) numbers: &'a RunNumbers<'a>,
    /// Times of the stimuli, ms.
    pub(crate) stimuli: &'a [f64],
    pub(crate) style: Style,
    /// The figure of the mesh, if it is drawn already.
    pub(crate) mesh_figure: Option<&'a Result<FigureFiles, FigureError>>,
    /// The files that the run was made from, as its results name them.
    pub(crate) inputs: &'a Inputs,
    /// Receives a warning for each output that is left out.
    pub(crate) observer: &'a dyn Observer,
}

impl<'a> Finished<'a> {
    /// What the cell is coloured by: what was asked for, if the run has it.
    pub(crate) fn colour(&self) -> Field {
        let frames: Vec<&Frame> = self.outcome.recording.frames.iter().collect();
        let asked = self.style.colour.filter(|field| field.is_known(&frames, true));
        asked.unwrap_or_else(|| Field::most_telling(&frames))
    }

    /// The cell as figures and films draw it, with one colour scale for the whole run.
    pub(super) fn cell(&self) -> Result<DrawnCell<'a>, FigureError> {
        let Simulation { mesh, fibres, myofibril_content, .. } = self.simulation;
        let fields = Fields::new(mesh, fibres, myofibril_content.as_deref())?;
        let cell = DrawnCell::new(fields, Some(self.outline))?.coloured_by(self.colour());
        Ok(cell.scaled_to(&self.outcome.recording.frames))
    }
}
