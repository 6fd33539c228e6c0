//! The files of a study that is done.

use crate::failure::Failure;
use crate::inputs::{self, Inputs};
use myospring::output::table::{write_csv, write_parquet};
use myospring::output::{files, json};
use myospring::study::parameters::{
    Acceptance, Answer, Common, ParameterStudy, Sensitivity, TRACES, TraceAxes,
};
use serde::Serialize;
use std::path::Path;

/// What is written anew, and what is drawn.
pub const RESULTS: [&str; 7] =
    ["members.csv", "members.parquet", "study.toml", "study.json", FIGURES, TRACES, inputs::FOLDER];
pub(super) const FIGURES: &str = "figures";
/// Resolution of PNG, dots per inch.
const DPI: f64 = 300.0;

/// study.json.
#[derive(Serialize)]
pub(super) struct Outcome<'a> {
    title: &'a str,
    pub(super) members: usize,
    #[serde(flatten)]
    pub(super) acceptance: Acceptance,
    /// Metrics of the run without any change.
    usual: Vec<Usual<'a>>,
    /// What the file of curves holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    traces: Option<&'a TraceAxes>,
    pub(super) sensitivity: Vec<Sensitivity>,
}

#[derive(Serialize)]
struct Usual<'a> {
    metric: &'a str,
    value: Option<f64>,
    unit: &'a str,
}

/// Writes table, description, numbers and figures of a study into a folder, as `myospring study run` does; `text` is
/// its description. What was left out, and why.
///
/// # Errors
/// A file that cannot be written, in words for people.
pub fn save(
    study: &ParameterStudy,
    common: &Common,
    answer: &Answer<'_>,
    folder: &Path,
    text: &str,
) -> Result<Vec<String>, String> {
    let written = files::create_folder(folder).map_err(Failure::from);
    let written = written.and_then(|()| write(study, common, answer, folder, text));
    written.map(|(_, left_out)| left_out).map_err(|failure| failure.in_words())
}

/// Writes all files into a folder that is there; what stands in `study.json`, and what was left out.
pub(super) fn write<'a>(
    study: &'a ParameterStudy,
    common: &'a Common,
    answer: &Answer<'_>,
    folder: &Path,
    text: &str,
) -> Result<(Outcome<'a>, Vec<String>), Failure> {
    files::write_with(&folder.join(RESULTS[0]), |file| {
        write_csv(file, answer.pieces()).map_err(Failure::from)
    })?;
    files::write_with(&folder.join(RESULTS[1]), |file| {
        write_parquet(file, answer.pieces()).map_err(Failure::new)
    })?;
    files::write(&folder.join(RESULTS[2]), with_inputs(common, folder, text)?)?;
    let mut left_out = Vec::new();
    let sensitivity = answer.sensitivity().unwrap_or_else(|error| {
        left_out.push(error.to_string());
        Vec::new()
    });
    let usual = study.metrics.iter().zip(&common.usual).zip(&common.units);
    let outcome = Outcome {
        title: &study.title,
        members: study.values.members(),
        acceptance: answer.acceptance(),
        usual: usual.map(|((metric, &value), unit)| Usual { metric, value, unit }).collect(),
        traces: common.axes.as_ref(),
        sensitivity,
    };
    files::write(&folder.join(RESULTS[3]), json::pretty(&outcome)?)?;
    left_out.extend(draw(answer, common, &outcome.sensitivity, folder)?.1);
    Ok((outcome, left_out))
}

/// Copies the files of a study into its folder; its description, which names the copies.
fn with_inputs(common: &Common, folder: &Path, text: &str) -> Result<String, Failure> {
    let (mut inputs, mut text) = (Inputs::default(), text.to_owned());
    for (path, bytes) in common.files() {
        if bytes.len() as u64 > inputs::LARGEST_COPY {
            continue;
        }
        inputs.copy(path, bytes, |name, bytes| {
            files::create_folder(&folder.join(inputs::FOLDER))?;
            Ok(files::write(&folder.join(name), bytes)?)
        })?;
        // As TOML has strings, of either kind of quote.
        let name = format!("\"{}\"", inputs.name(path, ""));
        for written in [format!("{path:?}"), format!("'{path}'")] {
            text = text.replace(&written, &name);
        }
    }
    Ok(text)
}

/// Draws the figures of a study into its folder, instead of those that are there; how many, and what was left out.
pub(super) fn draw(
    answer: &Answer<'_>,
    common: &Common,
    sensitivity: &[Sensitivity],
    folder: &Path,
) -> Result<(usize, Vec<String>), Failure> {
    let (mut count, mut left_out) = (0, Vec::new());
    let traces = answer.trace_figure(common, folder).unwrap_or_else(|error| {
        left_out.push(format!("figure traces is left out: {error}"));
        None
    });
    let folder = folder.join(FIGURES);
    files::create_folder(&folder)?;
    for drawn in answer.figures(&common.usual, sensitivity).into_iter().chain(traces) {
        match drawn.figure.and_then(|figure| Ok((figure.to_svg(), figure.to_png(DPI)?))) {
            Ok((svg, png)) => {
                files::write(&folder.join(format!("{}.svg", drawn.name)), svg)?;
                files::write(&folder.join(format!("{}.png", drawn.name)), png)?;
                count += 1;
            }
            Err(error) => left_out.push(format!("figure {} is left out: {error}", drawn.name)),
        }
    }
    Ok((count, left_out))
}
