//! The outputs of a run in addition to its curves and numbers: one row for each, chosen by its
//! word.

use super::finished::Finished;
use super::{activation, figures, film, on_gel, page};
use crate::clock::Stopwatch;
use crate::experiment::{ExperimentError, Folder};
use crate::output::{frames, vtu};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// The word for every output.
pub const ALL: &str = "all";
/// The word for curves and numbers alone.
pub const NONE: &str = "none";

/// One output.
pub struct Output {
    /// Its word in `--outputs`.
    pub word: &'static str,
    /// What it is, for the help.
    pub about: &'static str,
    /// The file that people open, if they open one.
    look: Option<&'static str>,
    /// Whether it is written by default.
    pub by_default: bool,
    /// Whether it is drawn from curves and shapes. Such outputs are left out if the program was
    /// interrupted and they would take long.
    is_drawn: bool,
    write: fn(&Folder, &Finished<'_>) -> Result<(), ExperimentError>,
}

/// The word for the figures.
const FIGURES: &str = "figures";

impl Output {
    /// Whether it has a figure of the mesh at rest, which [`BeatCell::mesh_figure`](super::BeatCell::mesh_figure) draws early.
    pub fn draws_mesh(&self) -> bool {
        self.word == FIGURES
    }
}

/// The outputs; people are asked to open the first that can be opened.
pub const OUTPUTS: [Output; 8] = [
    Output {
        word: "report",
        about: "the beating cell with curves, numbers and sources, a page for the browser (report.html)",
        look: Some(page::FILE),
        by_default: true,
        is_drawn: true,
        write: page::write,
    },
    Output {
        word: FIGURES,
        about: "cell, curves and lattice as in a paper, SVG and PNG (figures/)",
        look: Some("figures/overview.png"),
        by_default: true,
        is_drawn: true,
        write: figures::write,
    },
    Output {
        word: "gel",
        about: "of a cell on a gel, at its largest force: table of tractions, and displacements of the gel around it as arrays (gel/)",
        look: None,
        by_default: true,
        is_drawn: false,
        write: on_gel::write,
    },
    Output {
        word: "activation",
        about: "of a tissue: when each place was activated and for how long (activation.csv), and where waves ended (tips.csv)",
        look: None,
        by_default: true,
        is_drawn: false,
        write: activation::write,
    },
    Output {
        word: "gif",
        about: "film of the first beat (of a tissue of the whole run, at most 2 s), slowed 5 times and in real time (beat.gif, beat_real_time.gif)",
        look: Some("beat.gif"),
        by_default: false,
        is_drawn: true,
        write: film::gif,
    },
    Output {
        word: "mp4",
        about: "the same as video, where ffmpeg is installed (beat.mp4, beat_real_time.mp4)",
        look: None,
        by_default: false,
        is_drawn: true,
        write: film::mp4,
    },
    Output {
        word: "vtu",
        about: "frames for ParaView: open cell.pvd (and the folder vtu/)",
        look: None,
        by_default: false,
        is_drawn: false,
        write: vtu,
    },
    Output {
        word: "frames",
        about: "frames for NumPy: positions, mesh and fibres (frames.npz)",
        look: None,
        by_default: false,
        is_drawn: false,
        write: frames,
    },
];

/// The outputs that these words ask for, in the order of the table; those that are written by default without words.
///
/// # Errors
/// `none` beside other words.
pub fn chosen(words: Option<&[String]>) -> Result<Vec<&'static Output>, ExperimentError> {
    let Some(words) = words else {
        return Ok(OUTPUTS.iter().filter(|output| output.by_default).collect());
    };
    let named = |word: &str| words.iter().any(|other| other == word);
    if named(NONE) && words.len() > 1 {
        let message = format!("--outputs {}: `{NONE}` stands alone", words.join(","));
        return Err(
            ExperimentError::new(message).advise(format!("leave out `{NONE}` or everything else"))
        );
    }
    Ok(OUTPUTS.iter().filter(|output| named(output.word) || named(ALL)).collect())
}

/// Time from its begin to its end, beside the others, and size of an output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Written {
    seconds: f64,
    bytes: u64,
    /// Why it was not written.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// The results of all outputs of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct WrittenOutputs(BTreeMap<&'static str, Written>);

impl WrittenOutputs {
    /// What was not written, in a line each.
    pub fn errors(&self) -> Vec<String> {
        let failed =
            self.0.iter().filter_map(|(word, written)| Some((word, written.error.as_ref()?)));
        failed.map(|(word, error)| format!("{word} was not written: {error}")).collect()
    }

    /// The file that people open, if there is one.
    pub fn look(&self) -> Option<&'static str> {
        let mut there = OUTPUTS.iter().filter(|output| {
            self.0.get(output.word).is_some_and(|written| written.error.is_none())
        });
        there.find_map(|output| output.look)
    }

    /// Sizes for people: `figures 1.1 MB`.
    pub fn sizes(&self) -> Vec<String> {
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

/// Writes outputs, on all cores. One that fails leaves no file, does not affect the others,
/// and is recorded with the reason.
pub(super) fn write(
    folder: &Folder,
    outputs: &[&Output],
    finished: &Finished<'_>,
) -> WrittenOutputs {
    let one = |output: &&Output| {
        let (start, part) = (Stopwatch::start(), folder.apart());
        let outcome = if output.is_drawn && finished.observer.is_late() {
            Err(ExperimentError::new("it is left out, since the program was interrupted"))
        } else {
            (output.write)(&part, finished)
        };
        if outcome.is_err() {
            part.withdraw();
        }
        let written = Written {
            seconds: start.elapsed().as_secs_f64(),
            bytes: part.bytes(),
            error: outcome.err().map(|failure| failure.to_string()),
        };
        folder.include(&part);
        (output.word, written)
    };
    WrittenOutputs(outputs.par_iter().map(one).collect())
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

/// The frames for ParaView; the collection comes last, so that it names files that are there.
fn vtu(folder: &Folder, finished: &Finished<'_>) -> Result<(), ExperimentError> {
    let Finished { simulation, outcome, .. } = finished;
    let recording = &outcome.recording;
    if let (Some(thick), Some(cell)) = (&simulation.thick, simulation.in_space()) {
        let content = cell.myofibril_content.as_deref();
        let frames = vtu::Frames::new(&thick.mesh, &recording.in_space, &cell.fibres, content)?;
        return write_frames(folder, &frames);
    }
    let (mesh, fibres) = (&simulation.mesh, &simulation.fibres);
    let content = simulation.myofibril_content.as_deref();
    write_frames(folder, &vtu::Frames::new(mesh, &recording.frames, fibres, content)?)
}

fn write_frames<const D: usize, const N: usize>(
    folder: &Folder,
    frames: &vtu::Frames<'_, D, N>,
) -> Result<(), ExperimentError> {
    let within = "vtu";
    (0..frames.len()).into_par_iter().try_for_each(|index| {
        folder.write(&format!("{within}/{}", frames.name(index)), frames.frame(index))
    })?;
    folder.write("cell.pvd", frames.collection(within))
}

/// The frames for NumPy.
fn frames(folder: &Folder, finished: &Finished<'_>) -> Result<(), ExperimentError> {
    let Finished { simulation, outline, outcome, .. } = finished;
    let (mesh, fibres) = (&simulation.mesh, &simulation.fibres);
    let content = simulation.myofibril_content.as_deref();
    let cubes = simulation.thick.as_ref().zip(simulation.in_space());
    let thick = cubes.as_ref().map(|(thick, cell)| (&thick.mesh, &cell.fibres[..]));
    let bytes = frames::to_npz(mesh, thick, &outcome.recording, fibres, content, outline)?;
    folder.write("frames.npz", bytes)
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
