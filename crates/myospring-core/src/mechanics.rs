//! Mechanics: point masses and the forces between them.
//!
//! A [`Force`] adds its vectors to a sum; each law has its own file. Units: um, ms, ug, nN, kPa,
//! fJ. Sign convention: the vector added to a node is the force that acts **on** that node. `D` is
//! the number of axes: 2 unless stated, for a cell as flat as its picture; 3 for a thick one.
//!
//! | file | law | source |
//! |---|---|---|
//! | [`spring`] | Hooke springs and axial dashpots | `coelho_2021`, Eqs (7)-(9), (11) |
//! | [`area`] | area preservation | `coelho_2021`, Eqs (12)-(13), and an energy |
//! | [`volume`] | the same energy for areas and volumes of any groups of simplices | |
//! | [`active`] | active tension along the fibre or at the ends | `coelho_2021`, section 3 |
//! | [`fibre_stiffness`] | stiffness along the fibre | |
//! | [`drag`] | viscous drag | `coelho_2021`, Eq. (10) |
//! | [`support`] | what holds the cell | `coelho_2021`, section 2.1 |
//! | [`anchor`] | elastic supports: elastic bed, spring-held ends | `edwards_schwarz_2011` |
//! | [`gel`] | a gel, half-space or layer | `butler_2002` |
//! | [`loaded_end`] | an end under a constant load | |
//! | [`stability`] | the largest stable time step | |
//! | [`stiffness`] | the tangent stiffness, for equilibria | |
//! | [`lattice_law`] | laws as data, for a kernel that sweeps a lattice | |

pub mod active;
pub mod anchor;
pub mod area;
mod body;
pub mod compliance;
pub mod drag;
pub mod fibre_stiffness;
mod force;
pub mod gel;
pub mod lattice_law;
pub mod loaded_end;
pub mod material;
pub mod post;
pub(crate) mod runs;
pub mod spring;
pub mod stability;
pub mod stiffness;
pub mod support;
mod system;
mod tension;
mod vectors;
pub mod volume;

pub use body::Body;
pub use force::{Configuration, Force};
pub use system::System;
pub use tension::{Following, Tension};
pub use vectors::{Vectors, zeros};
pub(crate) use vectors::{add_scaled, largest, product, sum};
