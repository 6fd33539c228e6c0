//! What a gel is, and where a cell adheres to it.

use super::wave;
use crate::mesh::{Lattice, Mesh};
use serde::Serialize;

/// Part of the cell's length that adheres at either end, where only its ends adhere.
pub const ADHERING_END: f64 = 0.2;
/// Width of the rim that adheres, um, where only the rim does: that of mature focal adhesions.
pub const ADHERING_RIM: f64 = 3.0;

/// A gel, and how the cell adheres to it; a list of [`GelBed::adhering`](super::GelBed::adhering) says more.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gel {
    /// Young's modulus, kPa.
    pub modulus: f64,
    /// Poisson's ratio, at least 0 and below 0.5.
    pub poisson: f64,
    /// Thickness of a layer that is bonded to glass, um; `None` is a half-space.
    pub thickness: Option<f64>,
    /// Where the cell adheres.
    pub adhesion: Adhesion,
    /// Traction per distance between cell and surface, kPa/um; `None` does not give way.
    pub adhesion_stiffness: Option<f64>,
}

/// Where a cell adheres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Adhesion {
    /// In every place.
    Everywhere,
    /// In the outer [`ADHERING_END`] of its length at either end.
    Ends,
    /// Within [`ADHERING_RIM`] of its outline.
    Rim,
}

/// Why there is no such gel under a mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GelError {
    /// A layer thinner than the spacing of the nodes.
    #[error(
        "the gel thickness is {thickness} um, less than the spacing of its places, {spacing} um; give a finer spacing, or let \
         a run have support = \"elastic-bed\" with bed_stiffness = G/h, the shear modulus over the thickness"
    )]
    ThinLayer {
        /// Its thickness, um.
        thickness: f64,
        /// The spacing, um.
        spacing: f64,
    },
    /// A mesh without a lattice.
    #[error(
        "a gel needs a mesh on a lattice; this one has its nodes anywhere: take support = \"elastic-bed\""
    )]
    NoLattice,
}

impl Gel {
    /// A half-space of this modulus (kPa) that is all but incompressible, to which a cell adheres in every place.
    pub fn half_space(modulus: f64) -> Self {
        Self {
            modulus,
            poisson: 0.49,
            thickness: None,
            adhesion: Adhesion::Everywhere,
            adhesion_stiffness: None,
        }
    }

    /// Shear modulus, kPa: `E / (2 (1 + nu))`.
    pub fn shear_modulus(&self) -> f64 {
        self.modulus / (2.0 * (1.0 + self.poisson))
    }

    /// Whether it can be under a mesh.
    ///
    /// # Errors
    /// A layer thinner than the spacing of the nodes, a mesh that is no lattice.
    pub fn check<const D: usize, const N: usize>(&self, mesh: &Mesh<D, N>) -> Result<(), GelError> {
        let &Lattice { spacing, .. } = mesh.lattice.as_ref().ok_or(GelError::NoLattice)?;
        self.check_spacing(spacing)
    }

    pub(super) fn check_spacing(&self, spacing: f64) -> Result<(), GelError> {
        match self.thickness {
            Some(thickness) if thickness < spacing => {
                Err(GelError::ThinLayer { thickness, spacing })
            }
            _ => Ok(()),
        }
    }

    /// Traction per displacement, kPa/um, of waves of traction across the wave vector with this wave number, 1/um.
    pub(super) fn stiffness_of_waves(&self, number: f64) -> f64 {
        let shear = match self.thickness {
            Some(thickness) => wave::compliance(self.poisson, number * thickness)[1],
            None => 1.0,
        } / (self.shear_modulus() * number);
        (shear + self.adhesion_stiffness.map_or(0.0, f64::recip)).recip()
    }
}
