//! Runs one after another, as when a slider moves.

use super::prepared::{BeatCell, PreparedRun};
use crate::clock::Stopwatch;
use crate::experiment::{ExperimentError, Files, input};
use crate::integrate::Method;
use crate::integrate::quasi_static::Tolerance;
use crate::settings::{Shape, ShapeBytes, Shaped};
use crate::simulation::{Ready, SetupError, SharedPath, Simulation};
use crate::study::sha256;

/// Keeps what the next run may share with the last one: the meshed shape; the path of equilibria, which cell model,
/// strength and pacing do not change; the course of a cell that does not feel stretch, which strength and mechanics do
/// not change. Each run has the bits that it has alone.
#[derive(Default)]
pub struct RunSeries {
    shape: Option<(Shape, ShapeBytes, Shaped)>,
    path: Option<SharedPath>,
}

impl RunSeries {
    /// Meshes the cell and makes the run ready, as [`BeatCell::prepare`] does.
    ///
    /// # Errors
    /// Those of [`BeatCell::prepare`].
    pub fn prepare(
        &mut self,
        BeatCell { name, run, threads, refused, mesh_figure }: BeatCell,
        files: &Files,
    ) -> Result<PreparedRun, ExperimentError> {
        let start = Stopwatch::start();
        let bytes = run.shape.bytes(|file| files.bytes(file))?;
        let known = self.shape.take().filter(|(shape, of, _)| *shape == run.shape && *of == bytes);
        let shaped = match known {
            Some((.., shaped)) => shaped,
            None => input::mesh_picture(&run, &bytes, refused, files)?,
        };
        let sha256 = sha256(&bytes.shape);
        self.shape = Some((run.shape.clone(), bytes, shaped.clone()));
        let build = |simulation: &Simulation| self.build(simulation);
        PreparedRun::of((name, run), (shaped, sha256), threads, mesh_figure, files, start, build)
    }

    /// As [`Simulation::build`], on the path of the last run where that serves.
    fn build(&mut self, simulation: &Simulation) -> Result<Ready, SetupError> {
        if simulation.numerics.method != Method::QuasiStatic || simulation.has_sites_in_triangles()
        {
            return simulation.build();
        }
        let path = match self.path.take() {
            Some(path) => path.for_mechanics_of(simulation, Tolerance::default())?,
            None => simulation.shared_path(Tolerance::default())?,
        };
        let path = self.path.insert(path);
        path.prepare(simulation)
    }
}
