"""Where the cell of a film pulls."""

from __future__ import annotations

import html
import json
import os
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._cell import Cell
from myospring._errors import warn
from myospring._given import film_path
from myospring._progress import Progress, heard
from myospring._settings import PictureSettings, given_of_picture
from myospring._xarray import dataset

if TYPE_CHECKING:
    from typing_extensions import Unpack


@dataclass(frozen=True, repr=False)
class TensionFrames:
    """Where a cell pulls in each frame of its film that shows it.

    Attributes
    ----------
    frames : ndarray of shape (frames,)
        Their numbers in the film.
    t_ms : ndarray of shape (frames,)
        Their times.
    tension_kpa, standard_deviation_kpa : ndarray of shape (frames, triangles)
        Active tension of each triangle, NaN where the film does not show it, and its standard deviation.
    mean_tension_kpa, mean_standard_deviation_kpa : ndarray of shape (frames,)
        Mean over the cell, and its standard deviation.
    known_pct : ndarray of shape (frames,)
        Part of the cell whose tension is known.
    """

    frames: NDArray[np.int64]
    t_ms: NDArray[np.float64]
    tension_kpa: NDArray[np.float64]
    standard_deviation_kpa: NDArray[np.float64]
    mean_tension_kpa: NDArray[np.float64]
    mean_standard_deviation_kpa: NDArray[np.float64]
    known_pct: NDArray[np.float64]

    def to_xarray(self) -> Any:
        """Returns the frames as a dataset; needs xarray.

        Returns
        -------
        xarray.Dataset
            Tensions over ``frame`` and ``triangle``; units are attributes.
        """
        both, each = ("frame", "triangle"), ("frame",)
        variables = {
            "tension_kPa": (both, self.tension_kpa),
            "standard_deviation_kPa": (both, self.standard_deviation_kpa),
            "mean_tension_kPa": (each, self.mean_tension_kpa),
            "mean_standard_deviation_kPa": (each, self.mean_standard_deviation_kpa),
            "known_pct": (each, self.known_pct),
        }
        return dataset(variables, {"frame": (each, self.frames), "t_ms": (each, self.t_ms)}, {})

    def __repr__(self) -> str:
        frames, triangles = self.tension_kpa.shape
        return f"<myospring.TensionFrames: {frames} frames, {triangles} triangles>"


class TensionMap:
    """Where a cell pulls at the peak of its contraction. `tension_map` and `fit` of a film make one.

    Tensions are in proportion to the stiffness of the cell, which is that of the settings.

    Attributes
    ----------
    cell : Cell
        The cell of the film at rest: `cell.triangles` are those of the map.
    tension_kpa, standard_deviation_kpa : ndarray of shape (triangles,)
        Active tension of each triangle, and its standard deviation.
    relative_tension, relative_standard_deviation : ndarray of shape (triangles,)
        Tension over the mean one, which does not depend on the stiffness, and its standard deviation.
    resolution_um : ndarray of shape (triangles,)
        Size of what can be distinguished around each triangle, um.
    centres : ndarray of shape (triangles, 2)
        Centres of the triangles at rest, um.
    positions : ndarray of shape (nodes, 2)
        Where the map puts the masses at the peak, um.
    mean_tension_kpa, even_tension_kpa : float
        Mean over the cell, and the even tension that is nearest to the film.
    known, uneven : bool
        Whether the film says where most of the cell pulls, and whether it pulls unevenly. Do not show a map that is not
        known.
    numbers : dict
        All numbers, as ``fit.json`` has them.
    frames : list of int
        Frames of the film that it is of.
    headline : str
        The map in a sentence.
    warnings : list of str
        What a reader must know, in order of weight.
    """

    def __init__(self, native: _native.TensionMap) -> None:
        self._native = native
        columns = dict(native.columns())
        self.cell = Cell(native.cell)
        self.tension_kpa = columns["tension_kPa"]
        self.standard_deviation_kpa = columns["standard_deviation_kPa"]
        self.relative_tension = columns["relative_tension"]
        self.relative_standard_deviation = columns["relative_standard_deviation"]
        self.resolution_um = columns["resolution_um"]
        self.centres = np.column_stack([columns["x_um"], columns["y_um"]])
        self.positions: NDArray[np.float64] = native.positions
        self.numbers: dict[str, Any] = json.loads(native.numbers)
        self.mean_tension_kpa: float = self.numbers["mean_tension_kpa"]
        self.even_tension_kpa: float = self.numbers["even_tension_kpa"]
        self.known: bool = self.numbers["known"]
        self.uneven: bool = self.numbers["uneven"]
        self.frames: list[int] = self.numbers["frames"]
        self.headline = native.headline
        self.warnings = native.warnings

    @cached_property
    def over_time(self) -> TensionFrames | None:
        """The map in each frame of the film; None if the map is not known."""
        if not self.known:
            return None
        columns = dict(self._native.frame_columns())
        tension, deviation = self._native.frame_tensions()
        return TensionFrames(
            frames=columns["frame"].astype(np.int64),
            t_ms=columns["t_ms"],
            tension_kpa=tension,
            standard_deviation_kpa=deviation,
            mean_tension_kpa=columns["mean_tension_kPa"],
            mean_standard_deviation_kpa=columns["standard_deviation_kPa"],
            known_pct=columns["known_pct"],
        )

    def to_dataframe(self) -> Any:
        """The map as a table; it needs pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each triangle, as ``tension_map.csv`` has them.
        """
        import pandas

        return pandas.DataFrame(dict(self._native.columns()))

    def to_xarray(self) -> Any:
        """Returns the map as a dataset; needs xarray.

        Returns
        -------
        xarray.Dataset
            Tensions over ``triangle``, with its centre; units are attributes.
        """
        columns = {name: (("triangle",), values) for name, values in self._native.columns()}
        shapes = {
            "positions_um": (("node", "axis"), self.positions),
            "triangles": (("triangle", "corner"), self.cell.triangles),
        }
        centres = {name: columns.pop(name) for name in ("x_um", "y_um")}
        return dataset({**columns, **shapes}, centres, {"title": self.cell.name, "headline": self.headline})

    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Writes what `myospring fit` writes of a map.

        ``tension_map.json``, ``tension_map.csv``, the figure and, of a map that is known, ``tension_map.vtu``,
        ``tension_frames.csv``, ``tension_frames.npz`` and the figure ``tension_over_beat``.

        Parameters
        ----------
        folder : path
            Made if it is not there.
        force : bool
            Replaces results that the folder holds. Refused where it holds anything that no command wrote, or that was
            changed since.

        Returns
        -------
        pathlib.Path
            The folder.

        Raises
        ------
        OSError
            The folder holds files, or cannot be written to.
        """
        return Path(self._native.save(os.fspath(folder), force))

    @cached_property
    def _figure(self) -> str:
        return self._native.svg()

    def __repr__(self) -> str:
        mean = f"{self.mean_tension_kpa:.2f} kPa on average" if self.known else "not known"
        return f"<myospring.TensionMap of {self.cell.name}, {len(self.tension_kpa)} triangles: {mean}>"

    def _repr_html_(self) -> str:
        words = "".join(f"<p>{html.escape(text)}</p>" for text in (self.headline, *self.warnings))
        return f"<div>{self._figure}{words}</div>"


def tension_map(
    film: str | PathLike[str] | ArrayLike,
    *,
    pixel_size_um: float | None = None,
    frame_rate_per_s: float | None = None,
    progress: Progress = None,
    **settings: Unpack[PictureSettings],
) -> TensionMap:
    """Follows the cell of a film and maps its active tension at the peak of the contraction.

    Parameters
    ----------
    film : path, or array_like of shape (frames, rows, columns)
        A film, a folder of its frames, or grey values.
    pixel_size_um : float or None
        Side of one pixel, um. None: what the film says of itself.
    frame_rate_per_s : float or None
        Frames a second. None: what the film says of itself.
    progress : callable, bool or None
        As in `track`.
    **settings
        What is known of the cell: the settings of `simulate`, of which ``young_modulus_kpa``, ``support`` and
        ``bed_stiffness_kpa_per_um`` matter most, and those of `Cell.from_image`, which find it in the frame at rest (``outline`` says which, where there are several).

    Returns
    -------
    TensionMap
        The map, how sure it is, and what a reader must know.

    Raises
    ------
    FileNotFoundError
        There is no such film.
    UnknownNameError
        A setting that does not exist.
    ValueError
        A film without a frame rate or a pixel size, that shows no cell, or whose cell does not contract.
    KeyboardInterrupt
        Ctrl-C.
    """
    given = given_of_picture("tension_map", pixel_size_um, settings)
    with film_path(film) as path:
        found = TensionMap(_native.tension_map(path, given, frame_rate_per_s, heard(progress)))
    warn(found.warnings)
    return found
