"""Films of a tissue: waves in its light, and the posts that hold it."""

from __future__ import annotations

import json
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, Literal, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._errors import warn
from myospring._given import changed, film_path
from myospring._progress import Progress, heard


class TissueWaves:
    """Waves in a film of a tissue's light; the result of `map_waves`.

    Maps have one value for each pixel, or for each block of pixels of a large frame, of shape (rows, columns) with the
    first row on top; NaN where no beat was found.

    Attributes
    ----------
    numbers : dict
        All numbers by name, as ``waves.json`` has them: of each wave its conduction velocity and durations, mean and
        standard deviation over waves, noise.
    warnings : list of str
        Warnings to read before the numbers are used.
    """

    def __init__(self, native: _native.Waves) -> None:
        self._native = native
        self.warnings: list[str] = native.warnings

    @cached_property
    def numbers(self) -> dict[str, Any]:
        numbers: dict[str, Any] = json.loads(self._native.numbers)
        return numbers

    @property
    def metrics(self) -> list[dict[str, float | None]]:
        """Numbers of each wave by name, as of a simulated tissue, such as ``conduction_velocity`` in cm/s."""
        return [{metric["name"]: metric["value"] for metric in wave["metrics"]} for wave in self.numbers["waves"]]

    @property
    def t_ms(self) -> NDArray[np.float64]:
        """Time of each frame."""
        return self._native.t_ms

    @property
    def light(self) -> NDArray[np.float64]:
        """Mean light of the places that beat, one value a frame; its sign is such that it rises in a beat."""
        return self._native.light

    @property
    def activation_ms(self) -> NDArray[np.float64]:
        """When each place was activated: after the stimulus, or after the first places; the median of all waves."""
        return self._native.maps[0]

    @property
    def duration_ms(self) -> NDArray[np.float64]:
        """From there to 90 % repolarisation; the median of all waves."""
        return self._native.maps[1]

    def wave(self, number: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns the maps of activation and of duration of one wave, ms.

        Parameters
        ----------
        number : int
            From 0.
        """
        return self._native.maps_of(number)

    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Saves what ``myospring analyse`` writes of a film: report, maps, figures and numbers.

        Parameters
        ----------
        folder : path
            Where to; it must not hold results, unless ``force`` is given.
        force : bool
            Whether results in the folder are replaced.

        Returns
        -------
        Path
            The folder.
        """
        return Path(self._native.save(folder, force))

    def __repr__(self) -> str:
        return f"<myospring.TissueWaves: {len(self.numbers['waves'])} waves>"


class Posts:
    """Two posts that hold a tissue, in a film; the result of `track_posts`.

    Attributes
    ----------
    numbers : dict
        All numbers by name, as ``posts.json`` has them.
    warnings : list of str
        Warnings to read before the numbers are used.
    """

    def __init__(self, native: _native.Posts) -> None:
        self._native = native
        self.warnings: list[str] = native.warnings

    @cached_property
    def numbers(self) -> dict[str, Any]:
        numbers: dict[str, Any] = json.loads(self._native.numbers)
        return numbers

    @property
    def t_ms(self) -> NDArray[np.float64]:
        """Time of each frame."""
        return self._native.t_ms

    @property
    def approach_um(self) -> NDArray[np.float64]:
        """How much nearer the posts are than at rest, one value a frame; NaN where they were not found."""
        return self._native.approach_um

    @property
    def force_nn(self) -> NDArray[np.float64] | None:
        """Force on each post, nN; None unless the stiffness is known."""
        return self._native.force_nn

    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Saves what ``myospring track --posts`` writes: report, curves, figures and numbers.

        Parameters
        ----------
        folder : path
            Where to; it must not hold results, unless ``force`` is given.
        force : bool
            Whether results in the folder are replaced.

        Returns
        -------
        Path
            The folder.
        """
        return Path(self._native.save(folder, force))

    def __repr__(self) -> str:
        return f"<myospring.Posts: {self.numbers['frames_followed']} frames>"


def map_waves(
    film: str | PathLike[str] | ArrayLike,
    *,
    pixel_size_um: float | None = None,
    frame_rate_per_s: float | None = None,
    stimulus_times_ms: Sequence[float] = (),
    stimulus_period_ms: float | None = None,
    stimulus_start_ms: float | None = None,
    light: Literal["rises", "falls"] | None = None,
    progress: Progress = None,
) -> TissueWaves:
    """Maps waves in a film of a tissue's light (optical mapping), as ``myospring analyse`` does of a film.

    Parameters
    ----------
    film : path, or array_like of shape (frames, rows, columns)
        A film (TIFF, AVI, y4m; others if ffmpeg is installed), a folder of its pictures, or grey values.
    pixel_size_um : float or None
        Size of a pixel, um. It is never guessed. None: the size stated in the film.
    frame_rate_per_s : float or None
        Frame rate, frames per second; None: the rate stated in the film.
    stimulus_times_ms : sequence of float
        Times of stimuli from the first frame, from which activation is counted; without any, from the first places.
    stimulus_period_ms, stimulus_start_ms : float or None
        Stimuli at regular intervals instead, and the first of them; None: the first frame.
    light : {"rises", "falls"} or None
        What the light does in a beat; None: as its steepest changes do.
    progress : callable, bool or None
        Called with the stage, the number of finished steps of it, and the number of all its steps; what it raises ends
        the work. True draws a bar.

    Returns
    -------
    TissueWaves
        When each place was activated and for how long, and the numbers of each wave.

    Raises
    ------
    ValueError
        No beat is seen, or the film does not say its pixel size or frame rate.
    OSError
        The film cannot be read.
    """
    falls = None if light is None else light == "falls"
    with film_path(film) as path:
        waves = TissueWaves(
            _native.map_waves(
                path,
                frame_rate_per_s,
                pixel_size_um,
                list(stimulus_times_ms),
                stimulus_period_ms,
                stimulus_start_ms,
                falls,
                heard(progress),
            )
        )
    warn(waves.warnings)
    return waves


def track_posts(
    film: str | PathLike[str] | ArrayLike,
    *,
    pixel_size_um: float | None = None,
    frame_rate_per_s: float | None = None,
    post_stiffness_nn_per_um: float | None = None,
    posts_px: Sequence[Sequence[float]] | None = None,
    frame: int | None = None,
    channel: int | None = None,
    progress: Progress = None,
) -> Posts:
    """Tracks the two posts that hold a tissue, as ``myospring track --posts`` does.

    Parameters
    ----------
    film : path, or array_like of shape (frames, rows, columns)
        A film (TIFF, AVI, y4m; others if ffmpeg is installed), a folder of its pictures, or grey values.
    pixel_size_um : float or None
        Size of a pixel, um. It is never guessed. None: the size stated in the film.
    frame_rate_per_s : float or None
        Frame rate, frames per second; None: the rate stated in the film.
    post_stiffness_nn_per_um : float or None
        Stiffness of one post, nN/um; None gives displacements alone.
    posts_px : two sequences of float, or None
        Column, row and diameter of each post, pixels; of rectangular posts the sides along and across the tissue in place
        of the diameter. None finds them.
    frame : int or None
        The frame in which these places hold, from 0; None: the first.
    channel : int or None
        Channel of the film, from 0.
    progress : callable, bool or None
        Called with the stage, the number of finished steps of it, and the number of all its steps; what it raises ends
        the work. True draws a bar.

    Returns
    -------
    Posts
        The approach of the posts and the force on them, frame by frame.

    Raises
    ------
    ValueError
        The posts are not found or cannot be followed, or the film does not say its pixel size or frame rate.
    OSError
        The film cannot be read.
    """
    given = changed(
        ("shape.pixel_size", pixel_size_um, None),
        ("segmentation.frame", frame, None),
        ("segmentation.channel", channel, None),
    )
    places = None if posts_px is None else [list(post) for post in posts_px]
    with film_path(film) as path:
        posts = Posts(
            _native.track_posts(
                path, given, frame_rate_per_s, places, post_stiffness_nn_per_um, heard(progress)
            )
        )
    warn(posts.warnings)
    return posts
