//! Where a cell pulls: the map of its active tension, from the way its points went in a film.
//!
//! The active forces of the triangles are linear in their tensions, so at given positions an equilibrium is, too. The
//! positions of a film have noise, though, and the cell's stiff springs make much force of little noise; so a misfit is
//! not counted in force but in um: the way from where the points were seen to where the tensions would have them, by the
//! cell's own compliance. [`TensionMap::of`] seeks the tensions `T >= 0` with the least
//!
//! ```text
//! |u - u(T)|^2 + lambda |grad T|^2
//! ```
//!
//! over the squares of [`ObservedPeak::alike_um`], each of which has one error; how the whole cell was shifted and turned is left
//! open. `u(T)` is the equilibrium under T, made linear where the last round has led (Gauss and Newton), and T is bilinear
//! between the points of a grid.
//!
//! - `lambda` is that of least generalised cross-validation (`golub_1979`); the even tension is its limit.
//! - The standard deviations are those of the posterior of which this is the top (`wahba_1983`), which count what is too
//!   small to be seen as well as noise.
//! - Where the frame cuts the cell ([`ObservedPeak::cut`]) the part that is not seen pulls at it. The points there are held where
//!   they were seen, whatever force it takes.
//! - Whether the cell pulls unevenly at all is tested: how often an even tension with such noise would gain as much.
//!
//! The map rests on the cell's stiffness, and on that of its support: all tensions are in proportion to them. And whatever
//! else makes the cell move unlike its model, such as a stiffer nucleus, is taken for tension.
//!
//! # Example
//! ```
//! use myospring::integrate::quasi_static::{Equilibrium, Tolerance};
//! use myospring::mechanics::Tension;
//! use myospring::prelude::*;
//! use myospring::tension_map::{ObservedPeak, TensionMap};
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

mod cut;
mod error;
mod grid;
mod least;
mod map;
mod observed_peak;
mod peak_shapes;
mod smoothing;
mod words;

pub use error::TensionMapError;
pub use map::{EVEN, TensionMap};
pub use observed_peak::ObservedPeak;
pub use peak_shapes::PeakShapes;
