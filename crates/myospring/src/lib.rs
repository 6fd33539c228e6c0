//! Myospring: from a microscope picture of a heart cell to its beat.
//!
//! A cardiac myocyte is stimulated, builds up tension and shortens by about a tenth. Myospring
//! simulates that on the cell's real outline: a small cell model (action potential and active
//! tension, six ordinary differential equations) drives a mass-spring mesh, integrated with
//! Verlet's method. It is based on Coelho et al. 2021 (`coelho_2021` in `references.bib`) and
//! states every deviation from it.
//!
//! # Tour
//! ```
//! use myospring::prelude::*;
//!
//! // An outline becomes a mesh; a coarse one, 3 um, to be quick.
//! let outline = built_in::adult_ventricular();
//! let (mesh, report) = lattice::from_outline(&outline, Some(3.0))?;
//! assert!((report.dimensions.length_um - 140.0).abs() < 3.0);
//!
//! // The paper's experiment on it; every setting is checked before it runs.
//! let outcome = Simulation::new(mesh).build()?.run(|_progress| true);
//! assert!(outcome.stop.is_none());
//!
//! // What a laboratory measures.
//! let beats = outcome.beats();
//! assert!((beats[0].value("peak_shortening").unwrap() - 12.0).abs() < 0.2); // %
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Units
//! One coherent system of units, without hidden factors; only [`units`] reads text with units.
//!
//! | quantity | unit | | quantity | unit |
//! |---|---|---|---|---|
//! | time | ms | | pressure, tension, modulus | kPa = nN/um^2 |
//! | length | um | | stiffness | nN/um |
//! | mass | ug | | energy | fJ = nN um |
//! | force | nN = ug um/ms^2 | | potential | mV |
//!
//! # Modules in reading order
//! [`cell`] turns a stimulus into tension; [`mesh`] holds points, springs and triangles, made from
//! outlines and from masks that `microscopy` reads; [`mechanics`] has the forces, one law per file,
//! and [`integrate`] moves the masses; [`exchange`] couples cell and mesh, [`simulation`] joins
//! them and fills a [`recording`]; [`analysis`] computes metrics of it and `output` writes files
//! and figures; `measured` reads curves of real cells; `settings` lists what a user may choose, one
//! row per setting, and `run_file` reads it; `fit` estimates a cell's own parameters from its
//! curve, and `tension_map` its local tension from its film; `compare` compares runs; `study`
//! computes many runs; `experiment` does what a laboratory does in one go, from files to a folder
//! of results; [`references`] has the papers that all of these cite.
//!
//! # Features
//! `microscopy` (pictures), `output` (files and figures), `run-file` (TOML), `study` (many runs), `fit` (a cell's own
//! parameters, and where it pulls) and `experiment` (folders of results) are on by default; `testing` has conformance
//! suites for cell models and forces of your own.

#[doc(inline)]
pub use myospring_core::{
    analysis, cell, exchange, integrate, interruption, mechanics, mesh, parameter, recording,
    references, simulation, units,
};

pub mod prelude;

#[cfg(feature = "run-file")]
#[doc(inline)]
pub use myospring_cell_files as cell_files;
#[cfg(feature = "testing")]
#[doc(inline)]
pub use myospring_core::testing;
#[cfg(feature = "microscopy")]
#[doc(inline)]
pub use myospring_microscopy as microscopy;
#[cfg(feature = "output")]
#[doc(inline)]
pub use myospring_output as output;

#[cfg(feature = "study")]
mod clock;
#[cfg(feature = "run-file")]
pub mod compare;
#[cfg(feature = "experiment")]
pub mod experiment;
#[cfg(feature = "fit")]
pub mod fit;
#[cfg(feature = "run-file")]
pub mod measured;
#[cfg(feature = "run-file")]
pub mod run_file;
#[cfg(feature = "run-file")]
pub mod settings;
#[cfg(feature = "study")]
pub mod study;
#[cfg(feature = "fit")]
pub mod tension_map;
