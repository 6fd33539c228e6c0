//! A tissue: cells that stimulate each other.

use crate::cell::CellModel;
use crate::cell::solve::SolverSettings;
use crate::exchange::{Conduction, Coupling, StimulusPlace, StretchCurrent, TissueError};
use std::sync::Arc;

/// How a tissue conducts, as it is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Conducts {
    /// With this velocity along the fibres, um/ms.
    Velocity(f64),
    /// With this diffusion coefficient along the fibres, um^2/ms.
    Diffusion(f64),
}

/// The settings of a tissue.
#[derive(Debug, Clone, PartialEq)]
pub struct TissueSettings {
    /// How it conducts; `None` while only other settings of it are known.
    pub conducts: Option<Conducts>,
    /// Conduction velocity along the fibres over that across them.
    pub velocity_ratio: f64,
    /// The file that says where it conducts, as written; `None` is everywhere alike.
    pub conductivity: Option<String>,
    /// What the stimuli reach.
    pub stimulated: StimulusPlace,
    /// What an extra stimulus S2 reaches; `None` is the same.
    pub s2_stimulated: Option<StimulusPlace>,
    /// The current through channels that stretch opens; without conductance there is none.
    pub stretch_current: StretchCurrent,
}

impl Default for TissueSettings {
    /// A tissue that conducts alike in all directions and is stimulated at its end.
    fn default() -> Self {
        Self {
            conducts: None,
            velocity_ratio: 1.0,
            conductivity: None,
            stimulated: StimulusPlace::End,
            s2_stimulated: None,
            stretch_current: StretchCurrent { conductance: 0.0, reversal_mv: REVERSAL_MV },
        }
    }
}

/// Conduction velocity of a piece of tissue unless stated, um/ms: the upper end of cultures of stem-cell-derived myocytes. A run says
/// that it was assumed.
const USUAL_VELOCITY: f64 = 200.0;
/// Reversal potential of stretch-activated channels unless stated, mV: the middle of 0 to -20 mV, which were measured (`kohl_1999`).
const REVERSAL_MV: f64 = -10.0;

impl TissueSettings {
    /// Takes the usual velocity where none is stated.
    pub(crate) fn assume_velocity(&mut self) {
        self.conducts.get_or_insert(Conducts::Velocity(USUAL_VELOCITY));
    }

    /// How cells of this model are coupled on a lattice of this spacing, um, where the tissue conducts everywhere alike.
    ///
    /// # Errors
    /// Cells that cannot be coupled, and a velocity at which no wave goes along this lattice.
    pub fn coupling(
        &self,
        model: &Arc<dyn CellModel>,
        settings: SolverSettings,
        spacing: f64,
    ) -> Result<Coupling, TissueError> {
        let ratio = self.velocity_ratio;
        let of = |velocity| Conduction::diffusion_of(model, settings, velocity, spacing);
        let conduction = match self.conducts {
            None => Conduction::even(0.0),
            Some(Conducts::Diffusion(along)) => {
                Conduction { along, ..Conduction::even(along / ratio.powi(2)) }
            }
            Some(Conducts::Velocity(velocity)) => {
                let along = of(velocity)?;
                let across = if ratio == 1.0 { along } else { of(velocity / ratio)? };
                Conduction { along, ..Conduction::even(across) }
            }
        };
        let Self { stimulated, s2_stimulated, stretch_current, .. } = *self;
        let s2_stimulated = s2_stimulated.unwrap_or(stimulated);
        let stretch_current = (stretch_current.conductance > 0.0).then_some(stretch_current);
        Ok(Coupling { conduction, stimulated, s2_stimulated, stretch_current })
    }
}
