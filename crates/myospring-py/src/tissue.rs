//! Films of a tissue: waves in its light, and the posts that hold it.

use crate::errors;
use crate::experiment::{self, Progress};
use crate::settings;
use myospring::experiment::optical::{MapWaves, MappedWaves};
use myospring::experiment::posts::{FollowPosts, FollowedPosts};
use myospring::experiment::track::Track;
use myospring::experiment::{BeatOptions, Files};
use myospring::microscopy::posts::{Post, PostShape};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Activation and duration.
type Maps<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// Waves that were mapped.
#[pyclass(module = "myospring._native")]
pub(crate) struct Waves {
    files: Files,
    outcome: MappedWaves,
}

/// Posts that were followed.
#[pyclass(module = "myospring._native")]
pub(crate) struct Posts {
    files: Files,
    outcome: FollowedPosts,
}

/// Maps the waves of a film.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "each is a name of Python's function")]
pub(crate) fn map_waves(
    py: Python<'_>,
    film: PathBuf,
    frame_rate: Option<f64>,
    pixel_size_um: Option<f64>,
    stimuli_ms: Vec<f64>,
    period_ms: Option<f64>,
    start_ms: Option<f64>,
    falls: Option<bool>,
    progress: Progress,
) -> PyResult<Waves> {
    let beats = BeatOptions { stimuli_ms, period_ms, start_ms, ..BeatOptions::default() };
    let description = MapWaves { film, frame_rate, pixel_size_um, beats, falls };
    let files = Files::default();
    let outcome = experiment::run(py, &description, &files, progress)?;
    Ok(Waves { files, outcome })
}

/// Follows the posts of a film; `posts` has column, row and the sides along and across the tissue of each, pixels.
#[pyfunction]
pub(crate) fn track_posts(
    py: Python<'_>,
    film: PathBuf,
    given: &Bound<'_, PyDict>,
    frame_rate: Option<f64>,
    posts: Option<[Vec<f64>; 2]>,
    stiffness: Option<f64>,
    progress: Progress,
) -> PyResult<Posts> {
    let post = |numbers: Vec<f64>| match numbers[..] {
        [column, row, diameter_px] => {
            Ok(Post { middle_px: [column, row], shape: PostShape::Round { diameter_px } })
        }
        [column, row, along_px, across_px] => Ok(Post {
            middle_px: [column, row],
            shape: PostShape::Rectangle { along_px, across_px },
        }),
        _ => Err(errors::value(format!(
            "a post has {} numbers; it must have column, row and diameter, or column, row and the sides along and across the tissue",
            numbers.len()
        ))),
    };
    let posts = match posts {
        Some([one, two]) => Some([post(one)?, post(two)?]),
        None => None,
    };
    let track = Track { settings: settings::list(given)?, frame_rate, ..Track::of(film) };
    let description = FollowPosts { track, posts, stiffness };
    let files = Files::default();
    let outcome = experiment::run(py, &description, &files, progress)?;
    Ok(Posts { files, outcome })
}

#[pymethods]
impl Waves {
    /// All numbers, JSON.
    #[getter]
    fn numbers(&self) -> PyResult<String> {
        experiment::numbers(&self.outcome)
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        experiment::warnings(&self.outcome)
    }

    #[getter]
    fn t_ms<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.outcome.map.times_ms)
    }

    /// Mean light, one value a frame; rises in a beat.
    #[getter]
    fn light<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.outcome.map.mean)
    }

    /// When each place was activated, ms, and for how long: (rows, columns), NaN where it was not.
    #[getter]
    fn maps<'py>(&self, py: Python<'py>) -> PyResult<Maps<'py>> {
        let map = &self.outcome.map;
        let of = |values: &[Option<f64>]| PyArray2::from_vec2(py, &map.in_frame(values));
        Ok((of(&map.typical.activation_ms)?, of(&map.typical.duration_ms)?))
    }

    /// The same of one wave, from 0.
    fn maps_of<'py>(&self, py: Python<'py>, wave: usize) -> PyResult<Maps<'py>> {
        let map = &self.outcome.map;
        let count = map.beats.len();
        let beat = map.beats.get(wave);
        let beat = beat.ok_or_else(|| errors::value(format!("there are {count} waves, from 0")))?;
        let of = |values: &[Option<f64>]| PyArray2::from_vec2(py, &map.in_frame(values));
        Ok((of(&beat.map.activation_ms)?, of(&beat.map.duration_ms)?))
    }

    /// Writes what `myospring analyse` writes of a film; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        experiment::save(py, &self.outcome, &folder, force, &self.files)
    }
}

#[pymethods]
impl Posts {
    /// All numbers, JSON.
    #[getter]
    fn numbers(&self) -> PyResult<String> {
        experiment::numbers(&self.outcome)
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        experiment::warnings(&self.outcome)
    }

    #[getter]
    fn t_ms<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.outcome.times_ms())
    }

    /// How much nearer the posts are than at rest, um; NaN where they were not found.
    #[getter]
    fn approach_um<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, known(self.outcome.approach_um()))
    }

    /// Force on each post, nN; `None` where the stiffness is not known.
    #[getter]
    fn force_nn<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.outcome.force_nn().map(|force| PyArray1::from_vec(py, known(force)))
    }

    /// Writes what `myospring track --posts` writes; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        experiment::save(py, &self.outcome, &folder, force, &self.files)
    }
}

/// NaN for what is not known.
fn known(values: Vec<Option<f64>>) -> Vec<f64> {
    values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect()
}
