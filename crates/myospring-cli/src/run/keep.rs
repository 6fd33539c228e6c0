//! What a run leaves in its folder.

use super::record::{Record, Stop, Timings, resolved};
use crate::failure::Failure;
use crate::look::Look;
use crate::outputs::{self, Finished, Output};
use crate::summary::{self, Numbers};
use crate::terminal::Terminal;
use myospring::experiment::Inputs;
use myospring::experiment::{Files, Folder};
use myospring::mesh::outline::Outline;
use myospring::mesh::quality::MeshReport;
use myospring::microscopy::cells::{PictureCell, PictureCells};
use myospring::output::json;
use myospring::output::report::Summary;
use myospring::settings::{Fibres, Run, ShapeBytes};
use myospring::simulation::{Outcome, Simulation};
use myospring::study::sha256;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A run that is over, with all that its results are made from.
pub struct Over<'a> {
    /// Name of the results, for people.
    pub name: &'a str,
    /// What was asked for, with the fibres that were taken.
    pub run: &'a Run,
    /// The bytes of the shape.
    pub bytes: &'a ShapeBytes,
    /// With the mesh at rest.
    pub simulation: &'a Simulation,
    /// What the mesh is like.
    pub report: &'a MeshReport,
    /// The outline at rest, um.
    pub outline: &'a Outline,
    /// The fibres, and what the picture shows of them.
    pub fibres: &'a Fibres,
    /// The picture with its cells, and the one that beat.
    pub picture: Option<&'a (PictureCells, PictureCell)>,
    /// What came of it.
    pub outcome: &'a Outcome,
    /// Reads a file by its name as the run has it.
    pub read: &'a (dyn Fn(&str) -> io::Result<Vec<u8>> + Sync),
}

/// What was written beside curves and numbers, and whether `run.json` tells of it.
pub(super) struct Kept {
    pub(super) written: outputs::Record,
    pub(super) recorded: Result<(), Failure>,
}

impl Over<'_> {
    /// The numbers of the run, with all warnings.
    pub fn summary(&self, warnings: Vec<String>) -> Summary {
        let stimuli = self.run.stimulus_times();
        let s2_ms = self.run.s2_ms();
        Summary::new(&self.outcome.recording, &stimuli, s2_ms, self.report.clone(), warnings)
            .with_pace(&self.simulation.pace(&self.outcome.beats()))
    }

    /// Writes all that `myospring run` writes into a folder, and gives its path; `outputs` are the words of its
    /// option, `None` for those that it writes unless told otherwise.
    ///
    /// # Errors
    /// In words, with advice: a folder that holds files, unless `force`; words that name no output; what the disk says.
    pub fn save(
        &self,
        target: &Path,
        force: bool,
        outputs: Option<&[String]>,
        warnings: Vec<String>,
    ) -> Result<PathBuf, String> {
        let start = Instant::now();
        let write = || {
            let outputs = outputs::chosen(outputs)?;
            let files = Files::default();
            let mut file = self.run.to_run_file();
            for path in file.paths_mut() {
                files.note(Path::new(path));
            }
            let folder = Folder::claim(target, force, &files)?;
            let summary = self.summary(warnings);
            let fibres = self.picture.map(|_| self.fibres.report());
            let integration = self.outcome.effort;
            let numbers = Numbers { summary: &summary, fibres: fibres.as_ref(), integration };
            let timings = (&mut Timings::default(), start, start);
            let Kept { written, recorded } =
                self.keep(&folder, &numbers, &outputs, Look::default(), timings)?;
            recorded?;
            match written.errors().first() {
                Some(error) => Err(Failure::new(error)),
                None => folder.finish(&Terminal::new(true)),
            }
        };
        write().map_err(|failure: Failure| failure.in_words())
    }

    /// Writes curves, numbers, the record and the outputs.
    pub(super) fn keep(
        &self,
        folder: &Folder,
        numbers: &Numbers<'_>,
        outputs: &[&Output],
        look: Look,
        (timings, start, stage): (&mut Timings, Instant, Instant),
    ) -> Result<Kept, Failure> {
        let Self { name, run, simulation, outline, fibres, picture, outcome, .. } = *self;
        summary::write(folder, run, simulation, fibres, outcome, numbers)?;
        let mut inputs = Inputs::default();
        inputs.keep(folder, run.to_run_file(), self.read)?;
        let step = outcome.effort.time_step();
        let run_file = resolved(run, (&inputs, ""), simulation, self.report.spacing_um, step);
        folder.write("run.toml", &run_file)?;
        let hashes = [sha256(&self.bytes.shape), sha256(run_file.as_bytes())];
        let record = |timings, outputs: &outputs::Record| {
            let [shape_sha256, run_file_sha256] = hashes.clone();
            json::pretty(&Record {
                program: "myospring",
                version: env!("CARGO_PKG_VERSION"),
                input: run.shape.file().map(|file| inputs.name(file, "")),
                shape_sha256,
                run_file_sha256,
                stop: Stop::of(outcome),
                effort: outcome.effort,
                engine: outcome.engine.clone(),
                machine_threads: std::thread::available_parallelism().map_or(1, usize::from),
                timings,
                outputs,
            })
        };
        // From here on there is a whole result, whatever becomes of the outputs.
        folder.write("run.json", record(*timings, &outputs::Record::default())?)?;
        let stimuli = run.stimulus_times();
        let finished = Finished {
            name,
            run,
            simulation,
            outline,
            fibres,
            picture,
            outcome,
            numbers,
            stimuli: &stimuli,
            look,
            inputs: &inputs,
        };
        let written = outputs::write(folder, outputs, &finished);
        timings.outputs_s = stage.elapsed().as_secs_f64();
        timings.total_s = start.elapsed().as_secs_f64();
        // On a full disk the one without outputs stays.
        let recorded = folder.write("run.json", record(*timings, &written)?);
        Ok(Kept { written, recorded })
    }
}
