//! The files of a study that is done.

use super::found::{Found, Usual};
use super::page;
use crate::experiment::inputs::LARGEST_COPY;
use crate::experiment::{ExperimentError, Inputs};
use crate::output::figure::Figure;
use crate::output::files::{FileError, Manifest};
use crate::output::json;
use crate::output::table::write_csv;
#[cfg(feature = "parquet")]
use crate::output::table::write_parquet;
use crate::study::parameters::{Answer, Common, ParameterStudy, Sensitivity, TRACES};
use std::fs::File;
use std::io;
use std::path::Path;

/// The table, a row for each member.
pub const TABLE: &str = "members.csv";
/// The folder of the figures.
pub const FIGURES: &str = "figures";
/// Resolution of PNG, dots per inch.
const DPI: f64 = 300.0;

/// Writes table, description, numbers and figures of a study into a folder, as `myospring study
/// run` does; `text` is its description, `traces` the place of the curves. Returns what was left
/// out, and why.
///
/// # Errors
///
/// A file that cannot be written, or that would replace a file of something other than an earlier
/// study.
pub fn save(
    study: &ParameterStudy,
    common: &Common,
    answer: &Answer<'_>,
    folder: &Path,
    text: &str,
    traces: Option<&Path>,
) -> Result<Vec<String>, ExperimentError> {
    let manifest = Manifest::of(folder);
    if let Some(from) = traces {
        let failed = |source| FileError::Write { path: folder.join(TRACES), source };
        manifest.write_with(TRACES, |file| {
            io::copy(&mut File::open(from).map_err(failed)?, file).map_err(failed)?;
            Ok::<_, FileError>(())
        })?;
    }
    Ok(write(study, common, answer, &manifest, text)?.1)
}

/// Writes all files into a folder; returns the content of `study.json`, and what was left out.
pub(super) fn write<'a>(
    study: &'a ParameterStudy,
    common: &'a Common,
    answer: &Answer<'_>,
    manifest: &Manifest,
    text: &str,
) -> Result<(Found<'a>, Vec<String>), ExperimentError> {
    manifest.write_with(TABLE, |file| {
        write_csv(file, answer.pieces()).map_err(ExperimentError::from)
    })?;
    #[cfg(feature = "parquet")]
    manifest.write_with("members.parquet", |file| {
        write_parquet(file, answer.pieces()).map_err(ExperimentError::new)
    })?;
    let description = with_inputs(common, manifest, text)?;
    manifest.write("study.toml", &description)?;
    let mut left_out = Vec::new();
    let sensitivity = answer.sensitivity().unwrap_or_else(|error| {
        left_out.push(error.to_string());
        Vec::new()
    });
    let usual = study.metrics.iter().zip(&common.usual).zip(&common.units);
    let found = Found {
        title: &study.title,
        members: study.values.members(),
        acceptance: answer.acceptance(),
        usual: usual.map(|((metric, &value), unit)| Usual { metric, value, unit }).collect(),
        traces: common.axes.as_ref(),
        sensitivity,
    };
    manifest.write("study.json", json::pretty(&found)?)?;
    let (figures, missing) = draw(answer, common, &found.sensitivity, manifest)?;
    left_out.extend(missing);
    match page::html(study, answer, &found, &figures, (&description, &left_out)) {
        Ok(page) => manifest.write(page::FILE, page)?,
        Err(error) => left_out.push(format!("{} is left out: {error}", page::FILE)),
    }
    manifest.settle()?;
    Ok((found, left_out))
}

/// Copies the files of a study into its folder; returns its description, which names the copies.
fn with_inputs(
    common: &Common,
    manifest: &Manifest,
    text: &str,
) -> Result<String, ExperimentError> {
    let (mut inputs, mut text) = (Inputs::default(), text.to_owned());
    for (path, bytes) in common.files() {
        if bytes.len() as u64 > LARGEST_COPY {
            continue;
        }
        inputs.copy(path, bytes, |name, bytes| Ok(manifest.write(name, bytes)?))?;
        // As TOML has strings, of either kind of quote.
        let name = format!("\"{}\"", inputs.name(path, ""));
        for written in [format!("{path:?}"), format!("'{path}'")] {
            text = text.replace(&written, &name);
        }
    }
    Ok(text)
}

/// Figures by name, and what was left out.
type Drawn = (Vec<(String, Figure)>, Vec<String>);

/// Draws the figures of a study into its folder and replaces those there; returns the figures by
/// name, and what was left out.
pub(super) fn draw(
    answer: &Answer<'_>,
    common: &Common,
    sensitivity: &[Sensitivity],
    manifest: &Manifest,
) -> Result<Drawn, ExperimentError> {
    let (mut figures, mut left_out) = (Vec::new(), Vec::new());
    let traces = answer.trace_figure(common, &manifest.folder()).unwrap_or_else(|error| {
        left_out.push(format!("figure traces is left out: {error}"));
        None
    });
    for drawn in answer.figures(&common.usual, sensitivity).into_iter().chain(traces) {
        match drawn.figure.and_then(|figure| Ok((figure.to_png(DPI)?, figure))) {
            Ok((png, figure)) => {
                manifest.write(&format!("{FIGURES}/{}.svg", drawn.name), figure.to_svg())?;
                manifest.write(&format!("{FIGURES}/{}.png", drawn.name), png)?;
                figures.push((drawn.name, figure));
            }
            Err(error) => left_out.push(format!("figure {} is left out: {error}", drawn.name)),
        }
    }
    Ok((figures, left_out))
}
