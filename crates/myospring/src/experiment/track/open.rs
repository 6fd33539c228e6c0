//! Opening films: files and folders that the library reads, all others through ffmpeg.

use crate::experiment::input::{ending, unread_picture};
use crate::experiment::{ExperimentError, Files};
use crate::microscopy::film::{Film, FilmError};
use crate::microscopy::picture::Selection;
use crate::settings::PICTURE_ENDINGS;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};

/// Endings of films that the library reads.
const FILM_ENDINGS: [&str; 4] = ["tif", "tiff", "avi", "y4m"];

/// Whether a file is a film by its ending, also one that only ffmpeg reads; and whether a folder holds nothing but pictures.
pub(in crate::experiment) fn is_film(path: &Path) -> bool {
    if let Ok(entries) = fs::read_dir(path) {
        let mut endings = entries.filter_map(|entry| Some(ending(&entry.ok()?.path()))).peekable();
        return endings.peek().is_some()
            && endings.all(|ending| PICTURE_ENDINGS.contains(&ending.as_str()));
    }
    let ending = ending(path);
    FILM_ENDINGS.iter().chain(&["mp4", "mov", "m4v", "mkv", "webm"]).any(|film| *film == ending)
}

/// A name for results: that of the film without its ending.
pub(in crate::experiment) fn name(path: &Path, files: &Files) -> Result<String, ExperimentError> {
    // Before anything else is said about it.
    let is_folder = files.is_folder(path).map_err(|error| ExperimentError::unread(path, &error))?;
    files.note(path);
    // The folder `.` has a name, too.
    let whole = fs::canonicalize(path).unwrap_or_else(|_held| path.to_owned());
    let name = if is_folder { whole.file_name() } else { whole.file_stem() };
    Ok(name.unwrap_or_default().to_string_lossy().trim_end_matches(".ome").to_owned())
}

/// Opens a film of at least this many frames; a picture has one.
pub(in crate::experiment) fn open(
    path: &Path,
    selection: &Selection,
    fewest: usize,
    files: &Files,
) -> Result<Film, ExperimentError> {
    let failed = |error: FilmError| {
        let picture = matches!(error, FilmError::TooFew { frames: 1 });
        let failure = ExperimentError::new(format!("`{}`: {error}", path.display()));
        if !picture {
            return failure;
        }
        let file = path.display();
        failure.advise(format!(
            "give a film, or the folder that holds all its pictures; for a picture `myospring run {file}` simulates \
            the cell, and `myospring fit {file} --to CURVE.csv` fits it to a curve"
        ))
    };
    if files.is_folder(path).map_err(|error| ExperimentError::unread(path, &error))? {
        let read = if fewest > 1 { Film::of_pictures } else { Film::of_any_pictures };
        return read(pictures(path, files)?, selection).map_err(failed);
    }
    let kind = ending(path);
    if !FILM_ENDINGS.contains(&kind.as_str()) {
        if let Some(format) = unread_picture(&kind).filter(|_| kind != "gif") {
            let message = format!("`{}`: this is a {format}", path.display());
            return Err(ExperimentError::new(message));
        }
        if PICTURE_ENDINGS.contains(&kind.as_str()) && fewest > 1 {
            return Err(failed(FilmError::TooFew { frames: 1 }));
        }
        if !PICTURE_ENDINGS.contains(&kind.as_str()) {
            return Film::read(through_ffmpeg(path, None)?, selection).map_err(failed);
        }
    }
    let bytes = files.bytes(path).map_err(|error| ExperimentError::unread(path, &error))?;
    let read = if fewest > 1 { Film::read } else { Film::read_any };
    match read(bytes, selection) {
        Err(FilmError::Codec { codec }) => {
            Film::read(through_ffmpeg(path, Some(&codec))?, selection).map_err(failed)
        }
        film => film.map_err(failed),
    }
}

/// The pictures of a folder, without its subfolders.
fn pictures(folder: &Path, files: &Files) -> Result<Vec<(String, Vec<u8>)>, ExperimentError> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| ExperimentError::unread(folder, &error))? {
        let path = entry.map_err(|error| ExperimentError::unread(folder, &error))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_picture = PICTURE_ENDINGS.contains(&ending(&path).as_str());
        if is_picture && path.is_file() && !name.starts_with('.') {
            found.push((
                name,
                files.bytes(&path).map_err(|error| ExperimentError::unread(&path, &error))?,
            ));
        }
    }
    if found.is_empty() {
        let message = format!("the folder `{}` holds no pictures", folder.display());
        return Err(ExperimentError::new(message)
            .advise("give a folder of .png or .tif files, one a frame"));
    }
    Ok(found)
}

/// The film as a stream of grey frames, by ffmpeg; `codec` is the codec that the library cannot
/// read.
fn through_ffmpeg(path: &Path, codec: Option<&str>) -> Result<Vec<u8>, ExperimentError> {
    let what = match codec {
        Some(codec) => format!("`{}`: the frames are compressed with {codec}", path.display()),
        None => format!("`{}` is no TIFF, AVI or .y4m", path.display()),
    };
    let made = Command::new("ffmpeg")
        .args(["-nostdin", "-loglevel", "error", "-i"])
        .arg(path)
        .args(["-map", "0:v:0", "-pix_fmt", "gray", "-f", "yuv4mpegpipe", "-"])
        .stdin(Stdio::null())
        .output();
    let made = made.map_err(|error| match error.kind() {
        // A browser starts no programs.
        ErrorKind::Unsupported => ExperimentError::new(format!("{what}, which a page cannot read"))
            .advise(
                "save the film as TIFF or uncompressed AVI (Fiji: File > Save As), or follow it with the program, for which ffmpeg reads it",
            ),
        _ => ExperimentError::new(format!("{what}, which only ffmpeg reads, and it does not start: {error}")).advise(
            "install ffmpeg (https://ffmpeg.org, or `apt install ffmpeg`, `brew install ffmpeg`, `winget install \
             ffmpeg`), or save the film as TIFF or uncompressed AVI (Fiji: File > Save As)",
        ),
    })?;
    if made.stdout.is_empty() {
        let said = String::from_utf8_lossy(&made.stderr);
        let last = said.lines().map(str::trim).rfind(|line| !line.is_empty());
        let last = last.unwrap_or("it says nothing more");
        return Err(ExperimentError::new(format!(
            "{what}, and ffmpeg reads no film from it: {last}"
        ))
        .advise("is this a film? save it as TIFF or AVI"));
    }
    Ok(made.stdout)
}
