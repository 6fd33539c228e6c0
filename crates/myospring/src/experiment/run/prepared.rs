//! A run that is about to begin.

use super::beaten::FinishedRun;
use super::record::Timings;
use super::watch;
use crate::clock::Stopwatch;
use crate::experiment::folder::FigureFiles;
use crate::experiment::input::{self, Input};
use crate::experiment::refused::Place;
use crate::experiment::{Experiment, ExperimentError, Files, Observer};
use crate::integrate::{Method, stencil};
use crate::output::figure::{self, FigureError, Theme};
use crate::settings::{MeshedRun, Run, Shaped};
use crate::simulation::{Effort, Ready, SetupError, Simulation};
use crate::study::sha256;

/// Simulates one cell.
pub struct BeatCell {
    /// Name of the results, for people.
    pub name: String,
    /// The settings.
    pub run: Run,
    /// Threads that move the masses; results do not depend on it. `None` uses one core for every
    /// 8000 masses of a flat cell or 4000 of a thick one, at most all cores.
    pub threads: Option<usize>,
    /// Where an overlay goes that shows why a picture gives no cell.
    pub refused: Option<Place>,
    /// Draws the figure of the mesh in this theme while a path of equilibria is solved. `None`: it is drawn after the beat, with the
    /// other figures.
    pub mesh_figure: Option<Theme>,
}

/// A run that is ready: its cell is meshed, and its time step is chosen or its path of equilibria
/// solved.
pub struct PreparedRun {
    name: String,
    /// The settings, with the fibres that were used.
    pub run: Run,
    shape_sha256: String,
    /// The cell on its mesh.
    pub made: MeshedRun,
    /// The prepared simulation.
    pub ready: Ready,
    /// Warnings that are known before the simulation.
    pub warnings: Vec<String>,
    timings: Timings,
    files: Files,
    mesh_figure: Option<(Theme, Result<FigureFiles, FigureError>)>,
}

/// What a run would do.
pub struct RunPlan {
    /// Its method, with the number of steps.
    pub effort: Effort,
    /// How many springs are computed, where masses move in time.
    pub spring_updates: Option<f64>,
    /// How long it would take without writing its results, s: what the mesh and the preparation took, and an estimate of the rest.
    pub estimated_s: f64,
}

impl BeatCell {
    /// Meshes the cell and makes the run ready.
    ///
    /// # Errors
    /// A shape that gives no cell, files that do not fit it, and settings that exclude each other.
    pub fn prepare(&self, files: &Files) -> Result<PreparedRun, ExperimentError> {
        let start = Stopwatch::start();
        let Input { name, run, bytes, shaped } =
            input::mesh(self.name.clone(), self.run.clone(), self.refused.clone(), files)?;
        let sha256 = sha256(&bytes.shape);
        PreparedRun::of(
            (name, run),
            (shaped, sha256),
            self.threads,
            self.mesh_figure,
            files,
            start,
            Simulation::build,
        )
    }
}

impl PreparedRun {
    /// Makes the run of a cell ready that was meshed.
    ///
    /// # Errors
    /// Those of [`BeatCell::prepare`].
    pub fn new(
        named: (String, Run),
        shape: (Shaped, String),
        threads: Option<usize>,
        files: &Files,
    ) -> Result<Self, ExperimentError> {
        Self::of(named, shape, threads, None, files, Stopwatch::start(), Simulation::build)
    }

    /// Makes a run ready by `build`.
    pub(super) fn of(
        (name, mut run): (String, Run),
        (shaped, shape_sha256): (Shaped, String),
        threads: Option<usize>,
        mesh_figure: Option<Theme>,
        files: &Files,
        start: Stopwatch,
        build: impl FnOnce(&Simulation) -> Result<Ready, SetupError> + Send,
    ) -> Result<Self, ExperimentError> {
        let mut made = run.make(shaped, |file| files.bytes(file))?;
        // The fibres that were used repeat the run.
        run.fibre = made.fibres.taken;
        let mut timings = Timings { mesh_s: start.elapsed().as_secs_f64(), ..Timings::default() };
        let stage = Stopwatch::start();
        let Simulation { mesh, thick, .. } = &made.simulation;
        let springs = thick.as_ref().map_or(&mesh.springs, |thick| &thick.mesh.springs).len();
        let threads = threads.unwrap_or_else(|| stencil::worthwhile_threads(springs));
        made.simulation.numerics.engine.threads = threads;
        let simulation = &made.simulation;
        let draw = |theme: Theme| {
            let figure = figure::mesh(&simulation.mesh).map(|figure| figure.themed(theme));
            (theme, figure.and_then(|figure| FigureFiles::of(&figure)))
        };
        let solves = simulation.numerics.method == Method::QuasiStatic;
        let (ready, mesh_figure) = match mesh_figure.filter(|_| solves) {
            Some(theme) => rayon::join(|| build(simulation), || Some(draw(theme))),
            // Without the threads of the process, which do not survive a fork.
            None => (build(simulation), None),
        };
        let ready = ready?;
        timings.preparation_s = stage.elapsed().as_secs_f64();
        timings.total_s = start.elapsed().as_secs_f64();
        let mut warnings = run.warnings(&made.report);
        warnings.extend(ready.warnings());
        let files = files.clone();
        Ok(Self { name, run, shape_sha256, made, ready, warnings, timings, files, mesh_figure })
    }

    /// What the run would do; its first interval is computed to estimate the time.
    pub fn plan(&self) -> RunPlan {
        // The first output interval gives the time of a run in time; a path is already solved.
        let start = Stopwatch::start();
        let first = self.ready.run(|progress| progress.time <= 0.0);
        let (duration, numerics) = (self.run.duration, &self.run.numerics);
        let solved = self.ready.is_solved();
        let intervals = if solved { 1.0 } else { duration / numerics.output_interval.max(1e-9) };
        let estimated_s = self.timings.total_s + start.elapsed().as_secs_f64() * intervals;
        let mut effort = first.effort;
        let mut spring_updates = None;
        if let (Some(motion), Effort::Verlet { steps, .. }) = (self.ready.motion(), &mut effort) {
            let exchanges = (duration / numerics.exchange_interval).round();
            let whole = exchanges * motion.steps_per_exchange as f64;
            *steps = whole as u64;
            spring_updates = Some(whole * self.made.report.springs as f64);
        }
        RunPlan { effort, spring_updates, estimated_s }
    }

    /// Simulates the cell. An interruption or an error ends the run early; the outcome then has
    /// what was computed.
    pub fn beat(self, observer: &dyn Observer) -> FinishedRun {
        let start = Stopwatch::start();
        let Self {
            name,
            run,
            shape_sha256,
            made,
            ready,
            mut warnings,
            mut timings,
            files,
            mesh_figure,
        } = self;
        let outcome = watch::beat(&ready, run.duration, observer, &mut timings);
        warnings.extend(ready.warnings_after(&outcome));
        timings.total_s += start.elapsed().as_secs_f64();
        let beaten = FinishedRun::of(name, run, shape_sha256, made, outcome, warnings, files);
        FinishedRun { timings, mesh_figure, ..beaten }
    }
}

impl Experiment for BeatCell {
    type Outcome = FinishedRun;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<FinishedRun, ExperimentError> {
        Ok(self.prepare(files)?.beat(observer))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::Folder;
    use crate::experiment::run::{Style, chosen};
    use crate::run_file::RunFile;

    #[test]
    fn the_figure_of_the_mesh_is_the_same_whenever_it_is_drawn() {
        let mut file = RunFile::default();
        file.set("numerics.integrator", "quasi-static").unwrap();
        file.set("shape.spacing", "4 um").unwrap();
        let run = file.resolve().unwrap();
        let outputs = chosen(Some(&["figures".to_owned()])).unwrap();
        let figures = |drawn: Option<Theme>, theme: Theme| {
            let (name, run) = ("cell".to_owned(), run.clone());
            let cell = BeatCell { name, run, threads: None, refused: None, mesh_figure: drawn };
            let beaten = cell.prepare(&Files::default()).unwrap().beat(&());
            assert_eq!(beaten.mesh_figure.is_some(), drawn.is_some());
            let folder = Folder::in_memory();
            let style = Style { theme, ..Style::default() };
            let saved = beaten.write(&folder, &outputs, style, &()).unwrap();
            assert!(saved.written.errors().is_empty());
            let mut files = folder.contents();
            files.retain(|name, _| name.starts_with("figures/"));
            files
        };
        for theme in [Theme::Light, Theme::Dark] {
            let late = figures(None, theme);
            assert!(late.contains_key("figures/mesh.svg") && late.contains_key("figures/mesh.png"));
            assert!(figures(Some(theme), theme) == late);
            assert!(figures(Some(Theme::Light), theme) == late);
        }
    }
}
