//! What every run starts from: forces assembled, an activation in its first state, a meter.

use super::{SetupError, Simulation, TensionScale};
use crate::analysis::shape::{self, ShapeMeter};
use crate::cell;
use crate::cell::solve::{self, SolveError};
use crate::exchange::{Activation, Sites, Strongest, WholeCell};
use crate::mechanics::active::{FibreStretch, Myofibrils};
use crate::mechanics::material::assemble;
use crate::mechanics::support::{Support, SupportKind};
use crate::mechanics::{Body, Following, System, Tension};
use crate::mesh::simplex::content_at;

/// What every run starts from.
pub(super) struct Setup {
    pub(super) simulation: Simulation,
    pub(super) activation: Box<dyn Activation>,
    pub(super) assembly: Assembly,
    /// The most that is to be expected of the activation.
    pub(super) strongest: Strongest,
    /// Tension of a default beat relative to that of the parameters that are scaled to the peak tension.
    pub(super) strength: f64,
    /// What sites in the triangles feel.
    pub(super) fibre_stretch: Option<FibreStretch>,
    /// Resting volume of each triangle times its content of myofibrils, up to the thickness, um^2.
    pub(super) volumes: Vec<f64>,
}

/// The mesh with its forces, and what measures it.
pub(super) struct Assembly {
    pub(super) body: Body,
    pub(super) system: System,
    pub(super) meter: ShapeMeter,
    pub(super) resting_length: f64,
}

impl Simulation {
    pub(super) fn set_up(&self) -> Result<Setup, SetupError> {
        self.check()?;
        let assembly = self.assembled();
        let (activation, strength) = self.activation()?;
        let strongest = activation.strongest();
        let field = matches!(activation.sites(), Sites::PerElement(_));
        let volumes = self.mesh.simplices.iter().enumerate().map(|(element, simplex)| {
            let content = self.myofibril_content.as_ref().map_or(1.0, |content| content[element]);
            simplex.weight * content_at(&self.mesh.points, simplex.nodes) * content
        });
        Ok(Setup {
            activation,
            assembly,
            strongest,
            strength,
            fibre_stretch: field.then(|| FibreStretch::new(&self.mesh, &self.fibres)),
            volumes: volumes.collect(),
            simulation: self.clone(),
        })
    }

    /// What makes the tension, and how strong it is relative to what is scaled to the peak tension.
    fn activation(&self) -> Result<(Box<dyn Activation>, f64), SetupError> {
        if let Some(activation) = &self.activation {
            return Ok((activation.boxed(), 1.0));
        }
        let failed = |error: SolveError| SetupError::CellModel {
            model: self.cell.name().to_owned(),
            cause: error.to_string(),
        };
        let [peak, highest] = self.peaks().map_err(failed)?;
        let strength = highest / peak;
        let strongest =
            Strongest { tension: self.peak_tension * strength.max(1.0), ..Strongest::default() };
        let scale = self.peak_tension / peak;
        let model = self.cell.clone();
        let cell = WholeCell::new(model, self.protocol, self.numerics.cell, scale, strongest);
        Ok((Box::new(cell.map_err(failed)?), strength))
    }

    /// The tension of the model that is scaled to the peak tension, and the highest of a default beat. A
    /// model with its published parameters needs no beat for it.
    fn peaks(&self) -> Result<[f64; 2], SolveError> {
        let own = || solve::reference_beat(&*self.cell, self.numerics.cell);
        if self.tension_scale == TensionScale::OwnPeak {
            return own().map(|beat| [beat.peak_tension; 2]);
        }
        let published = self.cell.published_peak_tension();
        if cell::is_as_published(&*self.cell) {
            return Ok([published; 2]);
        }
        match own() {
            Ok(beat) => Ok([published, beat.peak_tension]),
            // Too weak to peak, or too slow to peak in time: not for us to refuse.
            Err(SolveError::NoPeak { value, .. }) => Ok([published, value.max(0.0)]),
            Err(error) => Err(error),
        }
    }

    pub(super) fn assembled(&self) -> Assembly {
        let resting_length = shape::extent(&self.mesh.points, self.long_axis);
        let (body, system) = assemble(
            &self.mesh,
            &self.material,
            self.active,
            Myofibrils { directions: &self.fibres, content: self.myofibril_content.as_deref() },
            self.support,
            self.long_axis,
            resting_length,
        );
        // A free cell turns as its mass does; a clamped one cannot turn, whatever it does inside. One that is
        // clamped at one end swings aside, though, and takes its width along.
        let areas = self.mesh.areas.clone();
        let meter = |weights| ShapeMeter::new(self.mesh.points.clone(), self.long_axis, weights);
        let meter = match &system.support {
            Support::Clamped(nodes) => {
                let mut held = vec![0.0; areas.len()];
                for &node in nodes {
                    held[node] = 1.0;
                }
                let meter = meter(held);
                if self.support == SupportKind::ClampedEnd {
                    meter.width_turned_by(areas)
                } else {
                    meter
                }
            }
            _ => meter(areas),
        };
        Assembly { body, system, meter, resting_length }
    }
}

impl Setup {
    /// The sites of the activation.
    pub(super) fn sites(&self) -> Sites {
        self.activation.sites()
    }

    /// Does something with the strongest tension to be expected, as the forces take it.
    pub(super) fn under_strongest<T>(&self, what: impl FnOnce(Tension<'_>) -> T) -> T {
        let Strongest { tension, per_stretch, per_rate } = self.strongest;
        match self.sites() {
            Sites::Whole => what(tension.into()),
            Sites::PerElement(count) => {
                let list = |value: f64| vec![value; count];
                let [tension, per_stretch, per_rate] = [tension, per_stretch, per_rate].map(list);
                what(Tension::Following(Following {
                    tension: &tension,
                    per_stretch: &per_stretch,
                    per_rate: &per_rate,
                    stretch: &list(1.0),
                    rate: &list(0.0),
                }))
            }
        }
    }
}
