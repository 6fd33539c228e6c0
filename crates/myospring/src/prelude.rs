//! What most programs need: `use myospring::prelude::*;`

pub use crate::cell::CellModel;
pub use crate::cell::pacing::{Protocol, Stimulus};
pub use crate::integrate::Method;
pub use crate::mechanics::material::default_material;
pub use crate::mechanics::support::SupportKind;
pub use crate::mesh::outline::Outline;
pub use crate::mesh::{Mesh, built_in, lattice};
pub use crate::simulation::{Effort, Outcome, Simulation};
