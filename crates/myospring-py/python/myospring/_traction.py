"""Tractions of a cell on a gel."""

from __future__ import annotations

import json
import os
import tempfile
from contextlib import contextmanager
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, Iterator

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._errors import warn
from myospring._given import film_path, floats, path_or_bytes
from myospring._progress import Progress, heard


class Tractions:
    """The tractions of a cell on a gel; the result of `traction`.

    Curves have one entry per frame. Maps have the shape (frames, rows, columns), rows from the top; their components point to
    the right and downward.

    Attributes
    ----------
    numbers : dict
        All numbers by name, as ``summary.json`` has them: how displacements were found, noise, smoothing, beats of the axial
        force, definitions.
    warnings : list of str
        Warnings to read before the numbers are used.
    """

    def __init__(self, native: _native.Tractions) -> None:
        self._native = native
        self.warnings: list[str] = native.warnings

    @cached_property
    def numbers(self) -> dict[str, Any]:
        numbers: dict[str, Any] = json.loads(self._native.numbers)
        return numbers

    @property
    def frames(self) -> NDArray[np.uint64]:
        """Number of each frame in the film, from 0."""
        return self._native.frames

    @property
    def t_ms(self) -> NDArray[np.float64]:
        """Time from the first frame; NaN where the frame rate is not known."""
        return self._native.column("t_ms")

    @property
    def force_nn(self) -> NDArray[np.float64]:
        """Sum of the absolute tractions, whatever their direction, nN."""
        return self._native.column("traction_force_nN")

    @property
    def axial_force_nn(self) -> NDArray[np.float64]:
        """Force across the middle of the cell along the direction in which it pulls, nN."""
        return self._native.column("axial_force_nN")

    @property
    def contractile_moment_fj(self) -> NDArray[np.float64]:
        """Minus the sum of traction times place, fJ."""
        return self._native.column("contractile_moment_fJ")

    @property
    def gel_energy_fj(self) -> NDArray[np.float64]:
        """Half of the sum of traction times displacement, fJ."""
        return self._native.column("gel_energy_fJ")

    @property
    def noise_floor_nn(self) -> NDArray[np.float64]:
        """Sum of absolute tractions that noise alone would make, nN."""
        return self._native.column("noise_floor_nN")

    @property
    def axial_noise_floor_nn(self) -> NDArray[np.float64]:
        """Standard deviation of the axial force that noise alone would make, nN."""
        return self._native.column("axial_noise_floor_nN")

    @property
    def displacements_um(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Displacements of the gel to the right and downward, um."""
        return self._native.field("u_um"), self._native.field("v_um")

    @property
    def tractions_pa(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Tractions to the right and downward, Pa."""
        return self._native.field("traction_x_Pa"), self._native.field("traction_y_Pa")

    @property
    def spacing_um(self) -> float:
        """Distance of neighbouring places of the maps, um."""
        return self._native.spacing_um

    def to_dataframe(self) -> Any:
        """Returns the curves as a table; needs pandas.

        Returns
        -------
        pandas.DataFrame
            One row per frame; the columns have the names of ``traction.csv``.
        """
        import pandas

        columns = {name: self._native.column(name) for name in self._native.columns()}
        return pandas.DataFrame({"frame": self.frames, **columns})

    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Writes the files of ``myospring traction``: ``traction.csv``, ``summary.json``, ``tractions.npz``, a map.

        Parameters
        ----------
        folder : path
            Created if it does not exist.
        force : bool
            Whether to replace results in the folder. Refused if the folder contains files that no command wrote, or
            files changed since; an input file is never replaced.

        Returns
        -------
        pathlib.Path
            The folder.

        Raises
        ------
        OSError
            The folder contains files, or cannot be written to.
        """
        return Path(self._native.save(os.fspath(folder), force))

    def __repr__(self) -> str:
        peak = float(np.max(self.axial_force_nn))
        return f"<myospring.Tractions: {len(self.frames)} frames, axial force up to {peak:.3g} nN>"


@contextmanager
def _picture_path(picture: str | PathLike[str] | ArrayLike) -> Iterator[str]:
    """Yields the path of a film or of one picture; those of an array are files as long as they are read."""
    if isinstance(picture, (str, PathLike)) or np.ndim(picture) != 2:
        with film_path(picture) as path:
            yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "picture.tif"
        _, arrays = path_or_bytes(picture, place.name)
        place.write_bytes(arrays[place.name])
        yield os.fspath(place)


def _film(array: ArrayLike, name: str) -> NDArray[np.float64]:
    """Returns displacements of the shape (frames, rows, columns)."""
    values = floats(array)
    if values.ndim not in (2, 3):
        raise ValueError(f"`{name}` has the shape {values.shape}; give (rows, columns) or (frames, rows, columns)")
    return np.ascontiguousarray(values[np.newaxis] if values.ndim == 2 else values)


def traction(
    source: str | PathLike[str] | ArrayLike | tuple[ArrayLike, ArrayLike],
    *,
    gel_modulus_kpa: float,
    gel_poisson: float = 0.49,
    gel_thickness_um: float | None = None,
    pixel_size_um: float | None = None,
    spacing_um: float | None = None,
    frame_rate_per_s: float | None = None,
    reference: str | PathLike[str] | ArrayLike | None = None,
    frame: int | None = None,
    subset_um: float | None = None,
    channel: int | None = None,
    cell: str | PathLike[str] | None = None,
    cell_channel: int | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Tractions:
    """Finds the tractions of a cell on a gel, from pictures of beads or from displacements, as ``myospring traction`` does.

    Parameters
    ----------
    source : path, array_like, or tuple of two array_like
        A film of beads in the gel (or a folder of its pictures, or grey values of the shape (frames, rows, columns)); with
        `reference` also one picture of the pulled gel; or two arrays of displacements, um, to the right and downward, of the
        shape (rows, columns) or (frames, rows, columns), rows from the top; or a table of them (.csv, .txt) with the columns x, y,
        u, v and perhaps frame, in pixels or um.
    gel_modulus_kpa, gel_poisson, gel_thickness_um : float
        Young's modulus, kPa, and Poisson's ratio of the gel; its thickness, um, if it is a layer bonded to glass.
    pixel_size_um : float or None
        Size of a pixel of the pictures, um; None: the size stated in the file.
    spacing_um : float or None
        Distance of neighbouring displacements, um; needed for arrays of displacements, and only for these.
    frame_rate_per_s : float or None
        Frame rate, frames per second; None: the rate stated in the film.
    reference : path, array_like or None
        Picture of the beads without the cell, or with the cell relaxed; None: a frame of the film, at rest.
    frame : int or None
        The frame at rest, from 0; None finds it.
    subset_um : float or None
        Side of the squares that are matched, um; None: the smallest that hold nine beads. Of arrays, the side of the windows
        in which they were measured; None: these do not overlap.
    channel : int or None
        Channel of the beads, from 0.
    cell : path or None
        Where the cell is: a film or picture of it in the same window, in which it is found and 2 um around it are added; or a file of
        outlines, or a picture that is black elsewhere, a little larger than the cell (of arrays with a pixel for each
        displacement).
    cell_channel : int or None
        Channel that shows the cell, from 0.
    threads : int or None
        Number of threads; the results do not depend on it.
    progress : callable, bool or None
        Called with the stage, the number of finished steps of it, and the number of all its steps; what it raises ends
        the work. True draws a bar.

    Returns
    -------
    Tractions
        Forces, moment and energy over time, and maps.

    Raises
    ------
    ValueError
        Pictures that do not say their pixel size or frame rate, show no beads, or cannot be followed; arrays that do not fit.
    OSError
        A file cannot be read.
    """
    gel = (gel_modulus_kpa, gel_poisson, gel_thickness_um)
    place = None if cell is None else (os.fspath(cell), cell_channel)
    if isinstance(source, tuple):
        if len(source) != 2:
            raise ValueError(f"there are {len(source)} arrays; give displacements to the right and downward")
        if spacing_um is None:
            raise ValueError("spacing_um is missing: arrays do not say how far apart their displacements are")
        pair = (_film(source[0], "u"), _film(source[1], "v"))
        found = _native.traction_of_arrays(
            pair, spacing_um, subset_um, gel, place, frame_rate_per_s, threads, heard(progress)
        )
    elif spacing_um is not None:
        raise ValueError("spacing_um is for arrays of displacements; pictures of beads have pixel_size_um")
    else:
        with _picture_path(source) as film, _picture_path(film if reference is None else reference) as relaxed:
            found = _native.traction_of_beads(
                film,
                None if reference is None else relaxed,
                frame,
                pixel_size_um,
                subset_um,
                channel,
                gel,
                place,
                frame_rate_per_s,
                threads,
                heard(progress),
            )
    tractions = Tractions(found)
    warn(tractions.warnings)
    return tractions
