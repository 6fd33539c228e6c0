//! Where a cell pulls: the map of its active tension, from the displacements of its points in a
//! film.
//!
//! The active forces of the triangles are linear in their tensions, so at given positions an
//! equilibrium is, too. But the positions in a film have noise, and the cell's stiff springs turn
//! little noise into large forces. So the misfit is measured in um, not in force: the distance
//! between the measured positions and the equilibrium under the tensions. [`TensionMap::of`] finds
//! the tensions `T >= 0` that minimise
//!
//! ```text
//! |u - u(T)|^2 + lambda |grad T|^2
//! ```
//!
//! over squares of half of [`ObservedPeak::alike_um`]; shift and rotation of the whole cell are free. A film shows each
//! point's motion as a mean over its surroundings ([`Blur`]), so `u(T)` is averaged in the same way, and the
//! correlation that this gives the errors of neighbouring squares is removed before they are summed.
//! `u(T)` is the equilibrium under T, linearised at the last iterate
//! (Gauss and Newton), and T is bilinear between the points of a grid.
//!
//! - `lambda` minimises the generalised cross-validation score (`golub_1979`); a uniform tension is
//!   the limit of large `lambda`.
//! - The standard deviations are those of the posterior whose maximum this is (`wahba_1983`); they include noise and
//!   details too small to be resolved.
//! - Where the frame cuts the cell ([`ObservedPeak::cut`]) the part beyond the frame pulls at it. The points there are
//!   held at their measured positions.
//! - A test decides whether the cell pulls unevenly: how often a uniform tension with such noise
//!   would look as uneven.
//!
//! The map depends on the assumed stiffness of the cell and of its support: all tensions are
//! proportional to them. Anything else that makes the cell move unlike its model, such as a stiffer
//! nucleus, counts as tension.
//!
//! # Example
//! ```
//! use myospring::integrate::quasi_static::{Equilibrium, Tolerance};
//! use myospring::mechanics::Tension;
//! use myospring::prelude::*;
//! use myospring::tension_map::{Blur, ObservedPeak, TensionMap};
//!
//! // A strip of 100 x 20 um whose right half pulls half as hard.
//! let simulation = Simulation::new(lattice::rectangle(25, 5, 4.0)?);
//! let mesh = &simulation.mesh;
//! let truth: Vec<f64> =
//!     mesh.simplices.iter().map(|it| if mesh.centre(it)[0] < 50.0 { 40.0 } else { 20.0 }).collect();
//! let (body, system) = simulation.mechanics();
//! let mut equilibrium = Equilibrium::new(&system, &body, Tolerance::default())?;
//! let moved = equilibrium.find(&body.positions, Tension::PerElement(&truth))?;
//! let displacements_um =
//!     [0, 1].map(|a| moved[a].iter().zip(&mesh.points[a]).map(|(now, rest)| now - rest).collect());
//! let seen = ObservedPeak {
//!     displacements_um,
//!     found: vec![true; mesh.len()],
//!     cut: vec![false; mesh.len()],
//!     alike_um: 4.0,
//!     blur: Blur::default(),
//!     frames: Vec::new(),
//! };
//! let map = TensionMap::of(&simulation, &seen)?;
//! assert!(map.is_uneven());
//! let mean = |side: bool| {
//!     let there = mesh.simplices.iter().map(|it| (mesh.centre(it)[0] < 50.0) == side);
//!     let (sum, count) = there.zip(&map.tensions_kpa).filter(|(there, _)| *there).fold((0.0, 0), |s, t| (s.0 + t.1, s.1 + 1));
//!     sum / f64::from(count)
//! };
//! assert!((mean(false) / mean(true) - 0.5).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod blur;
mod cut;
mod error;
mod film;
mod frame_shapes;
mod grid;
mod least;
mod map;
mod observed_peak;
mod peak_shapes;
mod smoothing;
mod words;

pub use blur::Blur;
pub use error::TensionMapError;
pub use film::TensionFilm;
pub use frame_shapes::FrameShape;
pub use map::{EVEN, TensionMap};
pub use observed_peak::ObservedPeak;
pub use peak_shapes::PeakShapes;
