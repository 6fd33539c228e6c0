//! From a file and settings to a run and its shape on a mesh.

use super::error::ExperimentError;
use super::files::Files;
use super::refused::{Place, Refused};
use crate::interruption::Interruption;
use crate::microscopy::read;
use crate::run_file::{Origin, Reader, Run, ShapeBytes, Shaped};
use crate::settings::{Models, OUTLINE_ENDINGS, PICTURE_ENDINGS, Setting, Value};
use std::fs;
use std::path::Path;

/// A setting that was given, with its value.
pub type ChosenSetting = (&'static Setting, Value);

/// Whether a setting asks for all cells of a picture; a run takes one cell.
pub fn is_all_cells((setting, value): &ChosenSetting) -> bool {
    setting.key == "segmentation.cell" && value.as_text() == Some("all")
}

/// A run whose settings are checked, with its shape on a mesh.
pub struct Input {
    /// Name of the results unless another is given.
    pub name: String,
    /// The settings.
    pub run: Run,
    /// The bytes of the picture or outline.
    pub bytes: ShapeBytes,
    /// The mesh, its report and outline, and the picture.
    pub shaped: Shaped,
}

/// Checks every setting, and meshes the shape. If the picture gives no cell, an overlay that shows why is written to
/// `refused`, where there is such a place.
///
/// # Errors
/// Those of [`settle`] and [`mesh`].
pub fn read(
    path: Option<&Path>,
    overrides: &[ChosenSetting],
    refused: impl FnOnce(&str) -> Option<Place>,
    files: &Files,
    interruption: &Interruption,
) -> Result<Input, ExperimentError> {
    let (name, run) = settle(path, overrides, files, interruption)?;
    let place = refused(&name);
    mesh(name, run, place, files)
}

/// Meshes the shape of a run, as [`read()`] does.
///
/// # Errors
/// Files that cannot be read, or that give no cell or no mesh.
pub fn mesh(
    name: String,
    run: Run,
    refused: Option<Place>,
    files: &Files,
) -> Result<Input, ExperimentError> {
    let bytes = run.shape.bytes(|file| files.bytes(file))?;
    let shaped = mesh_picture(&run, &bytes, refused, files)?;
    Ok(Input { name, run, bytes, shaped })
}

/// Meshes the shape of a run. If it is a picture that gives no cell, an overlay that shows why is written to `place`,
/// where there is one.
///
/// # Errors
/// Bytes that give no cell or no mesh.
pub fn mesh_picture(
    run: &Run,
    bytes: &ShapeBytes,
    place: Option<Place>,
    files: &Files,
) -> Result<Shaped, ExperimentError> {
    let flat = run.shape.source.picture().filter(|picture| picture.slices.is_none());
    let Some(source) = flat else { return Ok(run.shape.mesh(bytes)?) };
    let refused = Refused { picture: source.path.as_str(), shape: &run.shape, place, files };
    match source.cells(bytes) {
        Err(cause) => Err(refused.without_cells(cause, bytes)),
        Ok(cells) => match cells.cell(source.choice, source.allow_cut) {
            Ok(cell) => match run.shape.check_size(&cells, &cell) {
                Ok(()) => Ok(run.shape.mesh_cell(cells, cell)?),
                Err(cause) => Err(refused.with_cells(cause, &cells, false)),
            },
            Err(cause) => Err(refused.with_cells(source.failed(cause), &cells, false)),
        },
    }
}

/// Whether the settings, or the run file, give this key.
///
/// # Errors
/// A run file that cannot be read.
pub fn gives(
    path: Option<&Path>,
    overrides: &[ChosenSetting],
    key: &str,
    files: &Files,
) -> Result<bool, ExperimentError> {
    if overrides.iter().any(|(setting, _)| setting.key == key) {
        return Ok(true);
    }
    let Some(path) = path.filter(|path| ending(path) == "toml") else { return Ok(false) };
    let text = files.text(path)?;
    let read = Reader::new().text(&path.display().to_string(), &text).and_then(Reader::read);
    let read = read.map_err(|error| ExperimentError::of_run_file(&error, Some(&text)))?;
    Ok(read.0.has(key))
}

/// Reads and checks every setting; returns the name of the results, and the run.
///
/// # Errors
/// A file that is not a picture, an outline or a run file, and settings that are not possible.
pub fn settle(
    path: Option<&Path>,
    overrides: &[ChosenSetting],
    files: &Files,
    interruption: &Interruption,
) -> Result<(String, Run), ExperimentError> {
    settle_with(path, overrides, [], files, interruption)
}

/// As [`settle`], with values from elsewhere that override those that were given.
///
/// # Errors
/// Those of [`settle`].
pub fn settle_with(
    path: Option<&Path>,
    overrides: &[ChosenSetting],
    own: impl IntoIterator<Item = (Origin, &'static str, Value)>,
    files: &Files,
    interruption: &Interruption,
) -> Result<(String, Run), ExperimentError> {
    let mut reader = Reader::new().knowing(Models::default().holding(files.held()));
    let mut text = None;
    if let Some(path) = path {
        match ending(path).as_str() {
            "toml" => {
                let content = files.text(path)?;
                reader = reader
                    .text(&path.display().to_string(), &content)
                    .map_err(|error| ExperimentError::of_run_file(&error, Some(&content)))?
                    .relative_to(path.parent().unwrap_or(Path::new("")));
                text = Some(content);
            }
            kind if PICTURE_ENDINGS.contains(&kind) || OUTLINE_ENDINGS.contains(&kind) => {
                // Before anything else is said about the picture.
                fs::metadata(path).map_err(|error| ExperimentError::unread(path, &error))?;
                let is_picture = PICTURE_ENDINGS.contains(&kind);
                let key = if is_picture { "shape.picture" } else { "shape.outline" };
                let Some(name) = path.to_str() else {
                    return Err(ExperimentError::new(format!("`{}` is not UTF-8", path.display())));
                };
                reader = reader.option(name, key, name);
            }
            _ => return Err(unread(path)),
        }
    }
    for (setting, value) in overrides {
        let option = setting.option.map_or(setting.key, |option| option.name);
        reader = reader.option(option, setting.key, value.clone());
    }
    for (origin, key, value) in own {
        reader = reader.overriding(origin, key, value);
    }
    let run =
        reader.resolve().map_err(|error| ExperimentError::of_run_file(&error, text.as_deref()))?;
    let run = run.interrupted_by(interruption);
    for path in run.to_run_file().paths_mut() {
        files.note(Path::new(path));
    }
    let name = path
        .and_then(Path::file_stem)
        .map_or_else(|| run.shape.name().to_owned(), |stem| stem.to_string_lossy().into_owned());
    Ok((name, run))
}

/// Why a file with an unknown ending is not read.
fn unread(path: &Path) -> ExperimentError {
    const KNOWN: &str = "give a picture or mask (.png, .tif, .tiff), an outline (.geojson, .json, .csv, .roi, \
                         .zip, .txt) or a run file (.toml)";
    let file = path.display();
    match fs::metadata(path) {
        Ok(data) if data.is_dir() => ExperimentError::new(format!("`{file}` is a folder"))
            .advise(format!("myospring batch {file} simulates the cells of all pictures in it")),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            ExperimentError::unread(path, &error)
        }
        _ => match unread_picture(&ending(path)) {
            Some(kind) => ExperimentError::new(format!("`{file}`: this is a {kind}")).advise(KNOWN),
            None => ExperimentError::new(format!("`{file}` has an ending that is not known"))
                .advise(KNOWN),
        },
    }
}

/// What a picture of this ending is, and what to do with it, if it is one that is not read: `JPEG picture, ...`.
pub fn unread_picture(ending: &str) -> Option<String> {
    let text = read::unread_kind(ending)?.to_string();
    Some(text.trim_start_matches("this is a ").to_owned())
}

/// The ending of a file's name, in small letters and without the dot.
pub fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}
