//! Tractions of a cell on a gel, from pictures of beads in the gel or from displacements: force, contractile moment and energy
//! over time, and maps.
//!
//! # Example
//! ```
//! use myospring::experiment::traction::Traction;
//! use myospring::experiment::{Experiment, Files};
//! use myospring::mechanics::gel::Gel;
//! use myospring::output::npz::{self, Array};
//!
//! // A gel that is drawn together in the middle of the window, in pixels.
//! let (rows, columns) = (40, 60);
//! let field = |along: usize| {
//!     (0..rows * columns).map(move |place| {
//!         let at = [(place % columns) as f64 - 30.0, (place / columns) as f64 - 20.0];
//!         -at[along] * (-(at[0] * at[0] + at[1] * at[1]) / 50.0).exp() * 0.2
//!     })
//! };
//! let array = |along| npz::to_npy(&Array::floats([rows, columns], field(along)));
//! let held = [("u.npy".to_owned(), array(0)), ("v.npy".to_owned(), array(1))];
//!
//! let description = Traction::of(["u.npy".into(), "v.npy".into()], 0.5, Gel::half_space(10.0));
//! let found = description.run(&Files::holding(held.into()), &())?;
//! let frame = &found.frames[0];
//! assert!(frame.force_nn > 3.0 * frame.noise_floor_nn && frame.contractile_moment_fj > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arrays;
mod beats;
mod cell;
mod follow;
mod followed;
mod found;
mod frame;
mod measured;
mod page;
mod table;

pub use cell::{CellPlace, MARGIN_UM};
pub use follow::Beads;
pub use followed::Followed;
pub use found::FoundTractions;
pub use frame::TractionFrame;

use super::{Experiment, ExperimentError, Files, Observer};
use crate::mechanics::gel::cytometry::{self, Errors, Tractions};
use crate::mechanics::gel::pull::{PullAxis, energy_fj, moments_fj};
use crate::mechanics::gel::{Gel, Surface};
use cell::Following;
use measured::{Displacements, Grid};
use std::path::PathBuf;

/// Finds the tractions that displaced a gel.
#[derive(Debug, Clone)]
pub struct Traction {
    /// Where the displacements come from.
    pub source: Source,
    /// The gel; where a cell adheres to it is not used.
    pub gel: Gel,
    /// Where the cell is; tractions are 0 elsewhere. `None` seeks them in the whole window.
    pub cell: Option<CellPlace>,
    /// Frames a second; `None` takes those of the film.
    pub frame_rate_per_s: Option<f64>,
    /// Threads; `None` uses all cores. The numbers do not depend on it.
    pub threads: Option<usize>,
}

/// Where displacements of a gel come from.
#[derive(Debug, Clone)]
pub enum Source {
    /// Two NumPy arrays.
    Arrays {
        /// The displacements to the right and downward, rows from the top: of rows and columns, or of frames, rows and
        /// columns.
        files: [PathBuf; 2],
        /// Distance of neighbouring places, um.
        pixel_size_um: f64,
        /// What a displacement of 1 is, um: the distance of places, unless stated.
        unit_um: Option<f64>,
        /// Side of the squares in which they were measured, um. Places nearer than that share their errors; `None` if each has
        /// its own.
        subset_um: Option<f64>,
    },
    /// A table of places and displacements, to the right and downward, in pixels unless the names of its columns say um.
    Table {
        /// The table: columns x, y, u, v, and perhaps frame; its places form a lattice.
        file: PathBuf,
        /// Side of a pixel, um; not needed for columns in um.
        pixel_size_um: Option<f64>,
        /// What a displacement of 1 is, um: a pixel, unless stated.
        unit_um: Option<f64>,
        /// As of arrays.
        subset_um: Option<f64>,
    },
    /// Pictures of beads.
    Beads(Beads),
}

impl Traction {
    /// Of these arrays, with places at this distance (um), which is also what a displacement of 1 is.
    pub fn of(files: [PathBuf; 2], pixel_size_um: f64, gel: Gel) -> Self {
        Self::from(Source::Arrays { files, pixel_size_um, unit_um: None, subset_um: None }, gel)
    }

    /// Of a film of beads.
    pub fn of_beads(beads: Beads, gel: Gel) -> Self {
        Self::from(Source::Beads(beads), gel)
    }

    fn from(source: Source, gel: Gel) -> Self {
        Self { source, gel, cell: None, frame_rate_per_s: None, threads: None }
    }

    /// The files that it reads.
    pub fn files(&self) -> Vec<&PathBuf> {
        let of_source: Vec<&PathBuf> = match &self.source {
            Source::Arrays { files, .. } => files.iter().collect(),
            Source::Table { file, .. } => vec![file],
            Source::Beads(beads) => std::iter::once(&beads.film).chain(&beads.reference).collect(),
        };
        of_source.into_iter().chain(self.cell.as_ref().and_then(CellPlace::path)).collect()
    }

    fn check(&self) -> Result<(), ExperimentError> {
        let Gel { modulus, poisson, thickness, .. } = self.gel;
        let lengths = match &self.source {
            Source::Arrays { pixel_size_um, unit_um, subset_um, .. } => [
                ("the pixel size", Some(*pixel_size_um), "um"),
                ("the unit of displacements", *unit_um, "um"),
                ("the side of a subset", *subset_um, "um"),
            ],
            Source::Table { pixel_size_um, unit_um, subset_um, .. } => [
                ("the pixel size", *pixel_size_um, "um"),
                ("the unit of displacements", *unit_um, "um"),
                ("the side of a subset", *subset_um, "um"),
            ],
            Source::Beads(beads) => [
                ("the pixel size", beads.pixel_size_um, "um"),
                ("the unit of displacements", None, "um"),
                ("the side of a subset", beads.subset_um, "um"),
            ],
        };
        let others = [
            ("Young's modulus of the gel", Some(modulus), "kPa"),
            ("the thickness of the gel", thickness, "um"),
            ("the frame rate", self.frame_rate_per_s, "/s"),
        ];
        for (what, value, unit) in lengths.into_iter().chain(others) {
            if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
                return Err(ExperimentError::new(format!(
                    "{what} is {value} {unit}; it must be above 0 {unit}"
                )));
            }
        }
        if !(0.0..0.5).contains(&poisson) {
            let message =
                format!("Poisson's ratio of the gel is {poisson}; it must be from 0 to below 0.5");
            return Err(
                ExperimentError::new(message).advise("0.49 stands for a gel that keeps its volume")
            );
        }
        Ok(())
    }

    /// The displacements, and where tractions are sought.
    fn displacements(
        &self,
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<(Displacements, Option<Vec<bool>>), ExperimentError> {
        let (rate, threads) = (self.frame_rate_per_s, self.threads);
        let region = |grid: &Grid, frame_rate_per_s: Option<f64>| {
            let following = Following { frame_rate_per_s, threads, observer };
            self.cell.as_ref().map(|cell| cell.places(grid, files, &following)).transpose()
        };
        let (read, subset_um) = match &self.source {
            Source::Beads(beads) => {
                return follow::follow((beads, threads), rate, region, files, observer);
            }
            Source::Arrays { files: paths, pixel_size_um, unit_um, subset_um } => {
                let unit = unit_um.unwrap_or(*pixel_size_um);
                (arrays::read(paths, *pixel_size_um, unit, files)?, subset_um)
            }
            Source::Table { file, pixel_size_um, unit_um, subset_um } => {
                (table::read(file, (*pixel_size_um, *unit_um), files)?, subset_um)
            }
        };
        let overlap = subset_um.map_or(1.0, |side| (side / read.grid.pixel_um).round());
        // No array has as many places.
        let errors = Errors { overlap: overlap.clamp(1.0, 1e6) as usize, ..Errors::default() };
        let region = region(&read.grid, rate)?;
        Ok((Displacements { frame_rate_per_s: rate, errors, ..read }, region))
    }
}

impl Experiment for Traction {
    type Outcome = FoundTractions;

    fn run(
        &self,
        files: &Files,
        observer: &dyn Observer,
    ) -> Result<FoundTractions, ExperimentError> {
        self.check()?;
        for path in self.files() {
            files.is_folder(path).map_err(|error| ExperimentError::unread(path, &error))?;
        }
        let (measured, region) = self.displacements(files, observer)?;
        if measured.followed.is_none() {
            observer.interruption().check().map_err(ExperimentError::new)?;
        }
        let surfaces = &measured.surfaces;
        let tractions =
            cytometry::tractions(&self.gel, surfaces, region.as_deref(), measured.errors)
                .map_err(ExperimentError::new)?;
        let all = measured.grid.shape[0] * measured.grid.shape[1];
        let places =
            region.as_ref().map_or(all, |region| region.iter().filter(|in_it| **in_it).count());
        let moment = |(surface, found): (&Surface, &Tractions)| {
            let [xx, _, yy] = moments_fj(surface, &found.tractions_pa);
            xx + yy
        };
        let moments: Vec<f64> = surfaces.iter().zip(&tractions).map(moment).collect();
        let strongest = (0..moments.len()).max_by(|a, b| moments[*a].total_cmp(&moments[*b]));
        let strongest = strongest.unwrap_or(0);
        let axis = PullAxis::of(&surfaces[strongest], &tractions[strongest].tractions_pa);
        let frame = |(at, (surface, found)): (usize, (&Surface, &Tractions))| {
            let noise = |axis: &PullAxis| {
                cytometry::axial_noise_nn(&self.gel, surface, found, axis, region.as_deref())
            };
            let number = measured.frames[at];
            TractionFrame {
                frame: number,
                t_ms: measured.frame_rate_per_s.map(|rate| 1e3 * number as f64 / rate),
                force_nn: found.force_nn(surface.spacing, None),
                axial_force_nn: axis
                    .map_or(0.0, |axis| axis.force_nn(surface, &found.tractions_pa)),
                contractile_moment_fj: moments[at],
                energy_fj: energy_fj(surface, &found.tractions_pa),
                noise_floor_nn: found.noise_floor_nn(surface.spacing, places),
                axial_noise_floor_nn: axis.as_ref().map_or(0.0, noise),
            }
        };
        let frames: Vec<TractionFrame> =
            surfaces.iter().zip(&tractions).enumerate().map(frame).collect();
        let beats = beats::of(&frames);
        let is_confined = region.is_some();
        Ok(FoundTractions { frames, tractions, axis, beats, gel: self.gel, measured, is_confined })
    }
}
