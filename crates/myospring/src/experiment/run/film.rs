//! Films of a beat: GIF, and MP4 by ffmpeg where it is installed.

use super::finished::Finished;
use crate::experiment::{ExperimentError, Folder};
use crate::output::figure::{BeatFilm, FRAMES_PER_SECOND, FigureError};
use rayon::prelude::*;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::process::{Command, Stdio};

/// Names without endings, and how many times slower than the cell each film runs.
const FILMS: [(&str, f64); 2] = [("beat", 5.0), ("beat_real_time", 1.0)];
/// Pixels of video for each px of a frame.
const VIDEO_SCALE: f64 = 2.0;

/// Draws the films of a run one after the other.
fn each(
    finished: &Finished<'_>,
    mut write: impl FnMut(&str, &BeatFilm<'_>) -> Result<(), ExperimentError>,
) -> Result<(), ExperimentError> {
    let cell = finished.cell()?;
    let recording = &finished.outcome.recording;
    // In a tissue, waves go on between stimuli.
    let stimuli = if recording.wave.is_some() { &[] } else { finished.stimuli };
    for (name, slowed) in FILMS {
        write(name, &BeatFilm::new(&cell, recording, stimuli, slowed, finished.style.theme)?)?;
    }
    Ok(())
}

/// `beat.gif` and the same in real time.
pub(super) fn gif(folder: &Folder, finished: &Finished<'_>) -> Result<(), ExperimentError> {
    each(finished, |name, film| {
        let stills: Result<Vec<_>, FigureError> =
            (0..film.len()).into_par_iter().map(|index| film.still(index)).collect();
        folder.write(&format!("{name}.gif"), film.gif(&stills?)?)
    })
}

/// `beat.mp4` and the same in real time, by ffmpeg; where there is none, a warning.
pub(super) fn mp4(folder: &Folder, finished: &Finished<'_>) -> Result<(), ExperimentError> {
    let mut asking = Command::new("ffmpeg");
    asking.arg("-version").stdout(Stdio::null()).stderr(Stdio::null());
    if !asking.status().is_ok_and(|status| status.success()) {
        finished.observer.warn(
            "mp4 is left out: there is no program `ffmpeg` (https://ffmpeg.org, or `apt install ffmpeg`, \
             `brew install ffmpeg`, `winget install ffmpeg`); --outputs gif needs none",
        );
        return Ok(());
    }
    each(finished, |name, film| {
        folder.write_with(&format!("{name}.mp4"), |path| encode(film, path))
    })
}

/// Encodes a film with ffmpeg and writes it to a path.
fn encode(film: &BeatFilm<'_>, path: &Path) -> Result<(), ExperimentError> {
    let frames: Result<Vec<_>, FigureError> =
        (0..film.len()).into_par_iter().map(|index| film.pixels(index, VIDEO_SCALE)).collect();
    let frames = frames?;
    let Some(([width, height], _)) = frames.first() else { return Ok(()) };
    let failed = |reason: &str| ExperimentError::new(format!("ffmpeg made no film: {reason}"));
    let mut ffmpeg = Command::new("ffmpeg")
        .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pixel_format", "rgb24"])
        .args(["-video_size", &format!("{width}x{height}")])
        .args(["-framerate", &FRAMES_PER_SECOND.to_string(), "-i", "-"])
        // Formats that all players show, from the first byte on.
        .args(["-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4"])
        .arg(path)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| failed(&error.to_string()))?;
    let mut written = Ok(());
    if let Some(mut stdin) = ffmpeg.stdin.take() {
        written = frames.iter().try_for_each(|(_, colours)| stdin.write_all(colours));
    }
    let done = ffmpeg.wait_with_output().map_err(|error| failed(&error.to_string()))?;
    if !done.status.success() {
        let said = String::from_utf8_lossy(&done.stderr);
        // A line that ends in `--` announces a reason that does not follow.
        let tells = |line: &str| !line.is_empty() && !line.ends_with("--");
        let last = said.lines().map(str::trim).rfind(|line| tells(line));
        return Err(failed(last.unwrap_or("it says nothing more")));
    }
    match written {
        // ffmpeg had read all that it needed.
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(failed(&error.to_string())),
        _ => Ok(()),
    }
}
