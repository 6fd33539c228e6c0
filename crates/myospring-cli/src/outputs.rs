//! What a run leaves beside its curves and numbers: one row for each output, chosen by its word.

use crate::failure::Failure;
use crate::film;
use crate::interrupt;
use crate::look::Look;
use crate::overlay::{self, Lattice};
use crate::page;
use crate::print;
use crate::summary::Numbers;
use crate::terminal::Terminal;
use clap::builder::{PossibleValue, PossibleValuesParser};
use myospring::analysis::beat::{Band, band};
use myospring::experiment::Inputs;
use myospring::experiment::{Draw, Folder};
use myospring::mesh::outline::Outline;
use myospring::microscopy::cells::{PictureCell, PictureCells};
use myospring::output::field::Fields;
use myospring::output::figure::{self, Cell, ContractionOptions, FigureError};
use myospring::output::{frames, vtu};
use myospring::settings::{Fibres, Run};
use myospring::simulation::{Outcome, Simulation};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Words that stand for several outputs.
const ALL: &str = "all";
const NONE: &str = "none";

/// A run that is over, with all that an output may be made from.
pub(crate) struct Finished<'a> {
    /// Name of the results, for people.
    pub(crate) name: &'a str,
    pub(crate) run: &'a Run,
    /// With the mesh at rest.
    pub(crate) simulation: &'a Simulation,
    /// The outline at rest, um.
    pub(crate) outline: &'a Outline,
    pub(crate) fibres: &'a Fibres,
    /// The picture with its cells, and the one that beat.
    pub(crate) picture: Option<&'a (PictureCells, PictureCell)>,
    pub(crate) outcome: &'a Outcome,
    pub(crate) numbers: &'a Numbers<'a>,
    /// Times of the stimuli, ms.
    pub(crate) stimuli: &'a [f64],
    /// How figures and films look.
    pub(crate) look: Look,
    /// The files that the run was made from, as its results name them.
    pub(crate) inputs: &'a Inputs,
}

impl<'a> Finished<'a> {
    /// The cell as figures and films draw it, with one colour scale for the whole run.
    pub(crate) fn cell(&self) -> Result<Cell<'a>, FigureError> {
        let Simulation { mesh, fibres, myofibril_content, .. } = self.simulation;
        let fields = Fields::new(mesh, fibres, myofibril_content.as_deref())?;
        let cell = Cell::new(fields, Some(self.outline))?.coloured_by(self.look.colour);
        Ok(cell.scaled_to(&self.outcome.recording.frames))
    }
}

/// One output.
pub(crate) struct Output {
    /// Its word in `--outputs`.
    pub(crate) word: &'static str,
    /// What it is, for the help.
    about: &'static str,
    /// The file that people open, if they open one.
    look: Option<&'static str>,
    /// Whether it is written unless others are asked for.
    by_default: bool,
    /// Whether it is drawn from curves and shapes; that is left out where the program was interrupted and would take long
    /// to end.
    is_drawn: bool,
    /// Whether it can be written here; asked before anything beats.
    available: fn() -> Result<(), Failure>,
    write: fn(&Folder, &Finished<'_>) -> Result<(), Failure>,
}

/// In the order in which they are written; people are told to open the first that has something to open.
const OUTPUTS: [Output; 6] = [
    Output {
        word: "report",
        about: "the beating cell with curves, numbers and sources, a page for the browser (report.html)",
        look: Some(page::FILE),
        by_default: true,
        is_drawn: true,
        available: || Ok(()),
        write: page::write,
    },
    Output {
        word: "figures",
        about: "cell, curves and lattice as in a paper, SVG and PNG (figures/)",
        look: Some("figures/overview.png"),
        by_default: true,
        is_drawn: true,
        available: || Ok(()),
        write: figures,
    },
    Output {
        word: "gif",
        about: "film of the first beat, slowed 5 times and in real time (beat.gif, beat_real_time.gif)",
        look: Some("beat.gif"),
        by_default: false,
        is_drawn: true,
        available: || Ok(()),
        write: film::gif,
    },
    Output {
        word: "mp4",
        about: "the same as video, where ffmpeg is installed (beat.mp4, beat_real_time.mp4)",
        look: None,
        by_default: false,
        is_drawn: true,
        available: || Ok(()),
        write: film::mp4,
    },
    Output {
        word: "vtu",
        about: "frames for ParaView: open cell.pvd (and the folder vtu/)",
        look: None,
        by_default: false,
        is_drawn: false,
        available: || Ok(()),
        write: vtu,
    },
    Output {
        word: "frames",
        about: "frames for NumPy: positions, mesh and fibres (frames.npz)",
        look: None,
        by_default: false,
        is_drawn: false,
        available: || Ok(()),
        write: frames,
    },
];

/// What `--outputs` takes.
pub(crate) fn words() -> PossibleValuesParser {
    let some = OUTPUTS.iter().map(|output| PossibleValue::new(output.word).help(output.about));
    let every = [
        PossibleValue::new(ALL).help("all of them, as far as they can be made here"),
        PossibleValue::new(NONE).help("curves and numbers only"),
    ];
    some.chain(every).collect::<Vec<_>>().into()
}

/// The words of outputs, for whoever checks them elsewhere.
pub fn output_words() -> Vec<&'static str> {
    OUTPUTS.iter().map(|output| output.word).chain([ALL, NONE]).collect()
}

/// What the help says of `--outputs`.
pub(crate) fn help() -> String {
    let default: Vec<&str> =
        OUTPUTS.iter().filter(|output| output.by_default).map(|output| output.word).collect();
    format!(
        "What to write beside curves and numbers, parted by commas [default: {}]",
        default.join(",")
    )
}

/// The outputs that these words ask for, in the order of the table. One that was named and cannot be made here is
/// refused; of all, it is left out with a warning.
pub(crate) fn chosen(words: Option<&[String]>) -> Result<Vec<&'static Output>, Failure> {
    let Some(words) = words else {
        return Ok(OUTPUTS.iter().filter(|output| output.by_default).collect());
    };
    let named = |word: &str| words.iter().any(|other| other == word);
    if named(NONE) && words.len() > 1 {
        return Err(Failure::new(format!("--outputs {}: `{NONE}` stands alone", words.join(",")))
            .advise(format!("leave out `{NONE}` or everything else")));
    }
    let mut chosen = Vec::new();
    for output in &OUTPUTS {
        match (output.available)() {
            _ if !named(output.word) && !named(ALL) => {}
            Ok(()) => chosen.push(output),
            Err(failure) if named(output.word) => return Err(failure),
            Err(failure) => print::warn(&format!("{} is left out: {failure}", output.word)),
        }
    }
    Ok(chosen)
}

/// What an output took.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Written {
    seconds: f64,
    bytes: u64,
    /// Why it is not there.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// What became of the outputs of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub(crate) struct Record(BTreeMap<&'static str, Written>);

impl Record {
    /// What was not written, in a line each.
    pub(crate) fn errors(&self) -> Vec<String> {
        let failed =
            self.0.iter().filter_map(|(word, written)| Some((word, written.error.as_ref()?)));
        failed.map(|(word, error)| format!("{word} is not among the results: {error}")).collect()
    }

    /// The file that people open, if there is one.
    pub(crate) fn look(&self) -> Option<&'static str> {
        let mut there = OUTPUTS.iter().filter(|output| {
            self.0.get(output.word).is_some_and(|written| written.error.is_none())
        });
        there.find_map(|output| output.look)
    }

    /// Sizes for people: `figures 1.1 MB`.
    pub(crate) fn sizes(&self) -> Vec<String> {
        let of = |output: &Output| {
            let written = self.0.get(output.word)?;
            if written.error.is_some() || written.bytes == 0 {
                return None;
            }
            Some(format!("{} {}", output.word, size(written.bytes)))
        };
        OUTPUTS.iter().filter_map(of).collect()
    }
}

/// Writes outputs one after the other. One that fails leaves no file of its own, takes nothing from the others, and
/// stands in the record with the reason.
pub(crate) fn write(folder: &Folder, outputs: &[&Output], finished: &Finished<'_>) -> Record {
    let mut record = Record::default();
    for output in outputs {
        let (start, before, names) = (Instant::now(), folder.bytes(), folder.names());
        let outcome = if output.is_drawn && interrupt::is_late() {
            Err(Failure::new("it is left out, since the program was interrupted"))
        } else {
            (output.write)(folder, finished)
        };
        if outcome.is_err() {
            folder.withdraw_all_but(&names);
        }
        let written = Written {
            seconds: start.elapsed().as_secs_f64(),
            bytes: folder.bytes() - before,
            error: outcome.err().map(|failure| failure.to_string()),
        };
        record.0.insert(output.word, written);
    }
    record
}

/// A size for people: `8 kB`, `1.2 MB`.
fn size(bytes: u64) -> String {
    let kilobytes = bytes as f64 / 1e3;
    if kilobytes < 1000.0 {
        format!("{:.0} kB", kilobytes.ceil())
    } else {
        format!("{:.1} MB", kilobytes / 1e3)
    }
}

/// The figures of a run.
pub(crate) fn figures(folder: &Folder, finished: &Finished<'_>) -> Result<(), Failure> {
    let Finished { name, run, simulation, fibres, picture, outcome, numbers, stimuli, .. } =
        finished;
    let recording = &outcome.recording;
    let mesh = &simulation.mesh;
    let cell = finished.cell();
    let cell = || cell.as_ref().map_err(Clone::clone);
    let reference = band("peak_shortening")
        .map(|Band { low, high, .. }| ([*low, *high], "adult ventricular myocytes, unloaded"));
    let held = simulation.support.holds_both_ends();
    let options = ContractionOptions {
        stimulus_times_ms: stimuli.to_vec(),
        reference_band: reference.filter(|_| !held),
    };
    let label = run.strength();
    let overlay = || {
        let (cells, cell) = picture.as_ref().ok_or(FigureError::Nothing { what: "pictures" })?;
        let lattice = Some(Lattice { mesh, fibres });
        overlay::draw(name, cells, &[cell], lattice, &numbers.summary.warnings)
    };
    let figures: [(&str, Draw<'_>); 7] = [
        ("overlay", &overlay),
        ("overview", &|| figure::overview(cell()?, recording, stimuli)),
        ("cell", &|| figure::cell_shapes(cell()?, &figure::key_shapes(recording, stimuli))),
        ("mesh", &|| figure::mesh(mesh)),
        ("action_potential_and_tension", &|| {
            figure::action_potential_and_tension(recording, stimuli)
        }),
        ("contraction", &|| figure::contraction(&[(&label, recording)], &options)),
        ("work_loop", &|| figure::work_loop(recording, stimuli)),
    ];
    // Only of a picture, and only of a cell whose ends are held.
    let from = usize::from(picture.is_none());
    let to = figures.len() - usize::from(!held);
    folder.figures(finished.look.theme, &figures[from..to], &Terminal::new(true))
}

/// The frames for ParaView; the collection comes last, so that it names files that are there.
fn vtu(folder: &Folder, finished: &Finished<'_>) -> Result<(), Failure> {
    let Finished { simulation, outcome, .. } = finished;
    let (mesh, fibres) = (&simulation.mesh, &simulation.fibres);
    let content = simulation.myofibril_content.as_deref();
    let frames = vtu::Frames::new(mesh, &outcome.recording.frames, fibres, content)?;
    let within = "vtu";
    (0..frames.len()).into_par_iter().try_for_each(|index| {
        folder.write(&format!("{within}/{}", frames.name(index)), frames.frame(index))
    })?;
    folder.write("cell.pvd", frames.collection(within))
}

/// The frames for NumPy.
fn frames(folder: &Folder, finished: &Finished<'_>) -> Result<(), Failure> {
    let Finished { simulation, outline, outcome, .. } = finished;
    let (mesh, fibres) = (&simulation.mesh, &simulation.fibres);
    let content = simulation.myofibril_content.as_deref();
    folder.write("frames.npz", frames::to_npz(mesh, &outcome.recording, fibres, content, outline)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_written_for_people() {
        for (bytes, text) in [(1, "1 kB"), (999_000, "999 kB"), (1_250_000, "1.2 MB")] {
            assert_eq!(size(bytes), text);
        }
    }
}
