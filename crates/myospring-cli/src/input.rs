//! From what stands on the command line to a run and the bytes of its shape.

use crate::failure::Failure;
use myospring::mesh::Mesh;
use myospring::mesh::quality::MeshReport;
use myospring::run_file::{Reader, Run};
use std::fs;
use std::path::{Path, PathBuf};

type Overrides = Vec<(&'static str, &'static str, toml::Value)>;

/// A run that was resolved, with its shape meshed.
pub(crate) struct Input {
    /// Name of the results unless another is given.
    pub(crate) name: String,
    pub(crate) run: Run,
    /// The bytes of the picture or outline.
    pub(crate) bytes: Vec<u8>,
    pub(crate) mesh: Mesh,
    pub(crate) report: MeshReport,
}

/// Reads and checks everything and meshes the shape.
pub(crate) fn read(path: Option<&Path>, overrides: Overrides) -> Result<Input, Failure> {
    let mut reader = Reader::new();
    let mut text = None;
    let mut base = PathBuf::new();
    if let Some(path) = path {
        match ending(path).as_str() {
            "toml" => {
                let content =
                    fs::read_to_string(path).map_err(|error| cannot_read(path, &error))?;
                base = path.parent().map(Path::to_owned).unwrap_or_default();
                reader = reader
                    .text(&path.display().to_string(), &content)
                    .map_err(|error| Failure::of_run_file(&error, Some(&content)))?;
                text = Some(content);
            }
            kind @ ("png" | "tif" | "tiff" | "geojson" | "json" | "csv") => {
                // Before anything else is said about the picture.
                fs::metadata(path).map_err(|error| cannot_read(path, &error))?;
                let is_picture = matches!(kind, "png" | "tif" | "tiff");
                let key = if is_picture { "shape.picture" } else { "shape.outline" };
                let Some(name) = path.to_str() else {
                    return Err(Failure::new(format!("`{}` is not UTF-8", path.display())));
                };
                reader = reader.option(name, key, name);
                if is_picture && !overrides.iter().any(|row| row.1 == "shape.pixel_size") {
                    let message = format!("`{name}`: the size of the picture's pixels is missing");
                    return Err(Failure::new(message).advise(
                        "say how wide one pixel is, like --pixel-size \"0.27 um\"; it is never \
                         guessed",
                    ));
                }
            }
            _ => {
                let message = format!("`{}` has an ending that is not known", path.display());
                return Err(Failure::new(message).advise(
                    "give a mask (.png, .tif, .tiff), an outline (.geojson, .json, .csv) or a run \
                     file (.toml)",
                ));
            }
        }
    }
    for (option, key, value) in overrides {
        reader = reader.option(option, key, value);
    }
    let mut run =
        reader.resolve().map_err(|error| Failure::of_run_file(&error, text.as_deref()))?;
    run.shape.resolve_path(&base);
    let bytes = run.shape.bytes(|file| fs::read(file))?;
    let (mesh, report) = run.shape.mesh(&bytes)?;
    let name = path
        .and_then(Path::file_stem)
        .map_or_else(|| run.shape.name().to_owned(), |stem| stem.to_string_lossy().into_owned());
    Ok(Input { name, run, bytes, mesh, report })
}

fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}

fn cannot_read(path: &Path, error: &std::io::Error) -> Failure {
    Failure::new(format!("cannot read `{}`: {error}", path.display()))
        .advise("check the path and its spelling")
}
