//! From what stands on the command line to a run and the bytes of its shape.

use crate::args::OutputArgs;
use crate::failure::Failure;
use crate::files::FILES;
use crate::interrupt;
use crate::options::Given;
use crate::refused::{Place, Refused};
use crate::segment;
use myospring::microscopy::read;
use myospring::run_file::{Origin, Reader, Run, ShapeBytes, Shaped, Source};
use myospring::settings::{OUTLINE_ENDINGS, PICTURE_ENDINGS, Value};
use std::fs;
use std::path::Path;

/// A run that was resolved, with its shape meshed.
pub(crate) struct Input {
    /// Name of the results unless another is given.
    pub(crate) name: String,
    pub(crate) run: Run,
    /// The bytes of the picture or outline.
    pub(crate) bytes: ShapeBytes,
    pub(crate) shaped: Shaped,
}

/// Reads and checks everything and meshes the shape. Of a picture that gives no cell an overlay is written beside
/// the results that there will not be, unless nothing is to be written.
pub(crate) fn read(
    path: Option<&Path>,
    overrides: Vec<Given>,
    results: Option<&OutputArgs>,
) -> Result<Input, Failure> {
    let (name, run) = settle(path, overrides)?;
    mesh(name, run, results)
}

/// Meshes the shape of a run, as [`read()`] does.
pub(crate) fn mesh(name: String, run: Run, results: Option<&OutputArgs>) -> Result<Input, Failure> {
    let bytes = run.shape.bytes(|file| FILES.bytes(file))?;
    let shaped = match (&run.shape.source, results) {
        (Source::Picture(_), Some(args)) => mesh_picture(&run, &bytes, refusals(args, &name))?,
        _ => run.shape.mesh(&bytes)?,
    };
    Ok(Input { name, run, bytes, shaped })
}

/// Where the overlay of a picture goes that is refused: beside the results that there will not be.
pub(crate) fn refusals(args: &OutputArgs, name: &str) -> Place {
    let folder = args.output.as_ref().and_then(|output| {
        let beside = output.file_name()?.to_string_lossy();
        Some(output.with_file_name(format!("{beside}_outline")))
    });
    Place::Folder(folder.unwrap_or_else(|| segment::folder(name)))
}

/// Meshes the cell of a picture; of one that gives none an overlay is written to `place`.
pub(crate) fn mesh_picture(run: &Run, bytes: &ShapeBytes, place: Place) -> Result<Shaped, Failure> {
    let Source::Picture(source) = &run.shape.source else { return Ok(run.shape.mesh(bytes)?) };
    let refused = Refused { picture: source.path.as_str(), shape: &run.shape, place };
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

/// Reads and checks every setting; the name of the results, and the run.
pub(crate) fn settle(path: Option<&Path>, overrides: Vec<Given>) -> Result<(String, Run), Failure> {
    settle_with(path, overrides, [])
}

/// As [`settle`], with values from elsewhere that override the options.
pub(crate) fn settle_with(
    path: Option<&Path>,
    overrides: Vec<Given>,
    own: impl IntoIterator<Item = (Origin, &'static str, Value)>,
) -> Result<(String, Run), Failure> {
    let mut reader = Reader::new();
    let mut text = None;
    if let Some(path) = path {
        match ending(path).as_str() {
            "toml" => {
                let content = FILES.text(path)?;
                reader = reader
                    .text(&path.display().to_string(), &content)
                    .map_err(|error| Failure::of_run_file(&error, Some(&content)))?
                    .beside(path.parent().unwrap_or(Path::new("")));
                text = Some(content);
            }
            kind if PICTURE_ENDINGS.contains(&kind) || OUTLINE_ENDINGS.contains(&kind) => {
                // Before anything else is said about the picture.
                fs::metadata(path).map_err(|error| Failure::unread(path, &error))?;
                let is_picture = PICTURE_ENDINGS.contains(&kind);
                let key = if is_picture { "shape.picture" } else { "shape.outline" };
                let Some(name) = path.to_str() else {
                    return Err(Failure::new(format!("`{}` is not UTF-8", path.display())));
                };
                reader = reader.option(name, key, name);
            }
            _ => {
                return Err(unread(path));
            }
        }
    }
    for (setting, value) in overrides {
        let option = setting.option.map_or(setting.key, |option| option.name);
        reader = reader.option(option, setting.key, value);
    }
    for (origin, key, value) in own {
        reader = reader.overriding(origin, key, value);
    }
    let mut run =
        reader.resolve().map_err(|error| Failure::of_run_file(&error, text.as_deref()))?;
    run.interruption = interrupt::interruption();
    for path in run.to_run_file().paths_mut() {
        FILES.note(Path::new(path));
    }
    let name = path
        .and_then(Path::file_stem)
        .map_or_else(|| run.shape.name().to_owned(), |stem| stem.to_string_lossy().into_owned());
    Ok((name, run))
}

/// Refuses `--cell all` where one cell is needed.
pub(crate) fn one_cell(all: bool) -> Result<(), Failure> {
    if !all {
        return Ok(());
    }
    let advice =
        "give --cell largest or a number, or beat every cell of a folder with myospring batch";
    Err(Failure::new("--cell all names several cells, but one is wanted here".to_owned())
        .advise(advice))
}

/// Why a file is not read whose ending is none of those that are.
fn unread(path: &Path) -> Failure {
    const KNOWN: &str = "give a picture or mask (.png, .tif, .tiff), an outline (.geojson, .json, .csv, .roi, \
                         .zip, .txt) or a run file (.toml)";
    let file = path.display();
    match fs::metadata(path) {
        Ok(data) if data.is_dir() => Failure::new(format!("`{file}` is a folder"))
            .advise(format!("myospring batch {file} beats the cells of all pictures in it")),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Failure::unread(path, &error),
        _ => match unread_picture(&ending(path)) {
            Some(kind) => Failure::new(format!("`{file}`: this is a {kind}")).advise(KNOWN),
            None => Failure::new(format!("`{file}` has an ending that is not known")).advise(KNOWN),
        },
    }
}

/// What a picture of this ending is, and what to do with it, if it is one that is not read: `JPEG picture, ...`.
pub(crate) fn unread_picture(ending: &str) -> Option<String> {
    let text = read::unread_kind(ending)?.to_string();
    Some(text.trim_start_matches("this is a ").to_owned())
}

pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default()
}
