//! What the page asks about tractions.

use myospring::experiment::tables::TABLES;
use myospring::experiment::traction::{Beads, CellPlace, Source, Traction};
use myospring::experiment::{ExperimentError, input};
use myospring::mechanics::gel::Gel;
use serde::Deserialize;
use std::path::PathBuf;

/// Displacements of a gel, or pictures of the beads in it, and what they do not say themselves.
#[derive(Deserialize)]
pub(crate) struct Displaced {
    /// Two arrays of displacements, to the right and downward; or a film or a picture of beads.
    files: Vec<String>,
    /// Young's modulus of the gel, kPa.
    gel_modulus_kpa: Option<f64>,
    /// Poisson's ratio of the gel; 0.49 unless stated.
    gel_poisson: Option<f64>,
    /// Thickness of the gel, um; a half-space unless stated.
    gel_thickness_um: Option<f64>,
    pixel_size_um: Option<f64>,
    /// What a displacement of 1 is, um; a pixel unless stated.
    unit_um: Option<f64>,
    /// Side of the squares in which displacements are, or were, measured, um.
    subset_um: Option<f64>,
    frame_rate_per_s: Option<f64>,
    /// A picture of the relaxed gel.
    reference: Option<String>,
    /// A film, a picture or outlines of the cell.
    cell: Option<String>,
}

impl Displaced {
    /// The experiment.
    ///
    /// # Errors
    /// A gel without a modulus, arrays without the size of a pixel, and a number of files that is neither one nor two.
    pub(crate) fn experiment(self) -> Result<Traction, ExperimentError> {
        let (pixel_size_um, subset_um) = (self.pixel_size_um, self.subset_um);
        let paths: Vec<PathBuf> = self.files.into_iter().map(PathBuf::from).collect();
        let source = match <[PathBuf; 2]>::try_from(paths) {
            Ok(files) => Source::Arrays {
                files,
                pixel_size_um: pixel_size_um.ok_or_else(|| {
                    ExperimentError::new("the arrays do not say how far apart their places are")
                        .advise("give --pixel-size")
                })?,
                unit_um: self.unit_um,
                subset_um,
            },
            Err(paths) => {
                let [film] = <[PathBuf; 1]>::try_from(paths).map_err(|_other_number| {
                    ExperimentError::new("give a film of beads, or two arrays of displacements")
                })?;
                let reference = self.reference.map(PathBuf::from);
                if TABLES.contains(&input::ending(&film).as_str()) {
                    let unit_um = self.unit_um;
                    Source::Table { file: film, pixel_size_um, unit_um, subset_um }
                } else {
                    Source::Beads(Beads { reference, pixel_size_um, subset_um, ..Beads::of(film) })
                }
            }
        };
        let modulus = self.gel_modulus_kpa.ok_or_else(|| {
            ExperimentError::new("Young's modulus of the gel is missing")
                .advise("give --gel-modulus: without it displacements say no force")
        })?;
        let gel = Gel::half_space(modulus);
        let poisson = self.gel_poisson.unwrap_or(gel.poisson);
        Ok(Traction {
            source,
            gel: Gel { poisson, thickness: self.gel_thickness_um, ..gel },
            cell: self.cell.map(CellPlace::of),
            frame_rate_per_s: self.frame_rate_per_s,
            threads: Some(1),
        })
    }
}
