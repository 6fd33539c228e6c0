"""The motion of a cell through a film."""

from __future__ import annotations

import html
import json
import os
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, Iterator, Literal, Sequence, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._errors import warn
from myospring._given import changed, film_path
from myospring._progress import Progress, heard
from myospring._xarray import dataset


class Motion:
    """The motion of a cell in a film; the result of `track`.

    Arrays have one entry per tracked frame. Positions are in um, with y upward from the lower left corner of the film,
    and without the motion of the stage.

    Attributes
    ----------
    numbers : dict
        All numbers by name, as ``track.json`` has them: rest frame, frame rate, pixel size, noise, sarcomeres with their
        intervals, the shape of the cell.
    warnings : list of str
        Warnings to read before the numbers are used.
    """

    def __init__(self, native: _native.Motion) -> None:
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
        """Time from the first frame of the film."""
        return self._native.column("t_ms")

    @property
    def contraction_pct(self) -> NDArray[np.float64]:
        """Contraction by the most reliable measure in this film, per cent: ``numbers["headline"]`` states which, and
        why."""
        return self._native.contraction_pct

    @property
    def length_um(self) -> NDArray[np.float64]:
        """Length along the long axis."""
        return self._native.column("length_um")

    @property
    def shortening_pct(self) -> NDArray[np.float64]:
        """Shortening of the length against the frame at rest."""
        return self._native.column("shortening_pct")

    @property
    def width_um(self) -> NDArray[np.float64]:
        """Largest extent across the long axis."""
        return self._native.column("width_um")

    @property
    def area_um2(self) -> NDArray[np.float64]:
        """Projected area."""
        return self._native.column("area_um2")

    @property
    def stretch_1(self) -> NDArray[np.float64]:
        """Smaller principal stretch of the whole cell."""
        return self._native.column("stretch_1")

    @property
    def stretch_2(self) -> NDArray[np.float64]:
        """Larger principal stretch of the whole cell."""
        return self._native.column("stretch_2")

    @property
    def sarcomere_um(self) -> NDArray[np.float64]:
        """Mean length of the sarcomeres; NaN if the film shows none."""
        return self._native.column("sarcomere_um")

    @property
    def interpolated_pct(self) -> NDArray[np.float64]:
        """Points that were not found again but interpolated from their neighbours, per cent."""
        return self._native.column("interpolated_pct")

    @property
    def positions(self) -> NDArray[np.float64]:
        """Positions of the points, of shape (frames, points, 2)."""
        return self._native.positions

    @property
    def interpolated(self) -> NDArray[np.bool_]:
        """Which points were interpolated from their neighbours, of shape (frames, points)."""
        return self._native.interpolated

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Points of each triangle, of shape (triangles, 3)."""
        return self._native.triangles

    @property
    def stage_um(self) -> NDArray[np.float64]:
        """Motion of the stage that was subtracted, of shape (frames, 2)."""
        return self._native.stage_um

    def to_dataframe(self) -> Any:
        """Returns the curves as a table; needs pandas.

        Returns
        -------
        pandas.DataFrame
            One row per frame; the columns have the names of the arrays.
        """
        import pandas

        columns = {name: self._native.column(name) for name in self._native.columns()}
        return pandas.DataFrame({"frame": self.frames, **columns})

    def to_xarray(self) -> Any:
        """Returns curves and shapes as a dataset; needs xarray.

        Returns
        -------
        xarray.Dataset
            Curves over ``t_ms``; positions over ``t_ms``, ``node`` and ``axis``; units are attributes.
        """
        columns = [name for name in self._native.columns() if name != "t_ms"]
        curves = {name: (("t_ms",), self._native.column(name)) for name in columns}
        shapes = {
            "contraction_pct": (("t_ms",), self.contraction_pct),
            "positions_um": (("t_ms", "node", "axis"), self.positions),
            "interpolated": (("t_ms", "node"), self.interpolated),
            "stage_um": (("t_ms", "axis"), self.stage_um),
            "triangles": (("triangle", "corner"), self.triangles),
        }
        times = {"t_ms": (("t_ms",), self.t_ms), "frame": (("t_ms",), self.frames)}
        return dataset({**curves, **shapes}, times, {"title": Path(self.numbers["film"]).name})

    def plot(self, axes: Any = None) -> Any:
        """Draws the contraction over time, and the sarcomeres if there are any; needs matplotlib.

        Parameters
        ----------
        axes : sequence of two matplotlib axes, or None
            Axes to draw on; None creates a figure.

        Returns
        -------
        array of matplotlib.axes.Axes
            The two axes.
        """
        if axes is None:
            from matplotlib import pyplot

            _, axes = pyplot.subplots(2, 1, sharex=True, figsize=(5.5, 4.5), layout="constrained")
        column = self.numbers["headline"]["column"]
        curves = ((self.contraction_pct, f"Contraction by {column} (%)"), (self.sarcomere_um, "Sarcomere (um)"))
        for one, (values, label) in zip(axes, curves):
            one.plot(self.t_ms, values, color="#2a6099")
            one.set_ylabel(label)
            one.spines[["top", "right"]].set_visible(False)
        axes[-1].set_xlabel("Time (ms)")
        return axes

    def save(
        self, folder: str | PathLike[str], *, force: bool = False, outputs: Sequence[str] | str | None = None
    ) -> Path:
        """Writes the files of ``myospring track``: ``track.csv``, ``track.json``, the cell at rest, figures.

        Parameters
        ----------
        folder : path
            Created if it does not exist.
        force : bool
            Whether to replace results in the folder. Refused if the folder contains files that no command wrote, or
            files changed since; an input file is never replaced.
        outputs : sequence of str, str or None
            What to write besides the curve: "figures", "gif", "frames", "vtu"; None writes the first three.

        Returns
        -------
        pathlib.Path
            The folder.

        Raises
        ------
        UnknownNameError
            An unknown word.
        OSError
            The folder contains files, or cannot be written to.
        """
        words = outputs.split(",") if isinstance(outputs, str) else None if outputs is None else list(outputs)
        return Path(self._native.save(os.fspath(folder), force, words))

    def _facts(self) -> str:
        headline = self.numbers["headline"]
        peak = headline["peak_contraction_pct"]
        return f"{len(self.frames)} frames, contracts by {peak:.2f} % ({headline['column']})"

    def __repr__(self) -> str:
        return f"<myospring.Motion of {Path(self.numbers['film']).name}: {self._facts()}>"

    def _repr_html_(self) -> str:
        headline = self.numbers["headline"]
        rows = {
            "contraction": f"{headline['peak_contraction_pct']:.2f} %, read from {headline['column']}: {headline['because']}",
            "length at rest": f"{self.numbers['resting_length_um']:.1f} um",
            "frames": f"{len(self.frames)} at {self.numbers['frames_per_second']:g} /s",
        }
        if self.numbers["sarcomere_rest_um"] is not None:
            rows["sarcomeres at rest"] = f"{self.numbers['sarcomere_rest_um']:.3f} um"
        table = "".join(f"<tr><td>{name}</td><td>{html.escape(text)}</td></tr>" for name, text in rows.items())
        warnings = "".join(f"<p>Warning: {html.escape(text)}</p>" for text in self.warnings)
        return f"<div><b>{html.escape(repr(self)[1:-1])}</b><table>{table}</table>{warnings}</div>"


class FilmCells(Sequence[Motion]):
    """The cells of a film, the largest first; the result of ``track(..., cell="all")``.

    They share the frame at rest and the motion of the stage.

    Attributes
    ----------
    names : list of str
        Name of each cell, in the same order: its number by size, or the label or name that a file gives.
    left_out : dict of str to str
        Why a cell was not followed, by its name.
    numbers : dict
        All numbers by name, as ``cells.json`` has them.
    warnings : list of str
        Warnings to read before the numbers are used.
    """

    def __init__(self, native: _native.Motions) -> None:
        self._native = native
        cells = native.cells
        self.names: list[str] = [name for name, _ in cells]
        self._cells = [Motion(motion) for _, motion in cells]
        self.left_out: dict[str, str] = dict(native.left_out)
        self.warnings: list[str] = native.warnings

    @cached_property
    def numbers(self) -> dict[str, Any]:
        numbers: dict[str, Any] = json.loads(self._native.numbers)
        return numbers

    def __len__(self) -> int:
        return len(self._cells)

    def __getitem__(self, index: Any) -> Any:
        return self._cells[index]

    def __iter__(self) -> Iterator[Motion]:
        return iter(self._cells)

    def to_dataframe(self) -> Any:
        """Returns the contraction of every cell over time as a table; needs pandas.

        Returns
        -------
        pandas.DataFrame
            One row per frame, by ``t_ms``, and one column per cell: its contraction by the most reliable measure, per cent.
        """
        import pandas

        index = pandas.Index(self._cells[0].t_ms if self._cells else [], name="t_ms")
        return pandas.DataFrame({name: one.contraction_pct for name, one in zip(self.names, self._cells)}, index=index)

    def save(
        self, folder: str | PathLike[str], *, force: bool = False, outputs: Sequence[str] | str | None = None
    ) -> Path:
        """Writes the files of ``myospring track --cell all``.

        Parameters
        ----------
        folder : path
            Created if it does not exist.
        force : bool
            Whether to replace results in the folder, as in `Motion.save`.
        outputs : sequence of str, str or None
            What to write of each cell, as in `Motion.save`.

        Returns
        -------
        pathlib.Path
            The folder.

        Raises
        ------
        UnknownNameError
            An unknown word.
        OSError
            The folder contains files, or cannot be written to.
        """
        words = outputs.split(",") if isinstance(outputs, str) else None if outputs is None else list(outputs)
        return Path(self._native.save(os.fspath(folder), force, words))

    def __repr__(self) -> str:
        return f"<myospring.FilmCells: {self._native.headline}>"


@overload
def track(
    film: str | PathLike[str] | ArrayLike, *, cell: Literal["all"], **given: Any
) -> FilmCells: ...


@overload
def track(
    film: str | PathLike[str] | ArrayLike, *, cell: int | str | None = None, **given: Any
) -> Motion: ...


def track(  # type: ignore[misc]
    film: str | PathLike[str] | ArrayLike,
    *,
    pixel_size_um: float | None = None,
    frame_rate_per_s: float | None = None,
    subset_um: float | None = None,
    frame: int | None = None,
    outline: str | PathLike[str] | None = None,
    cell: int | str | None = None,
    seed: tuple[float, float] | None = None,
    modality: Literal["auto", "fluorescence", "brightfield", "mask"] | None = None,
    channel: int | None = None,
    allow_cut: bool = False,
    spacing_um: float | None = None,
    stain: Literal["z-disc", "filament"] | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Motion | FilmCells:
    """Tracks a cell in a film by digital image correlation, as ``myospring track`` does.

    Parameters
    ----------
    film : path, or array_like of shape (frames, rows, columns)
        A film (TIFF, OME-TIFF, AVI, y4m; others if ffmpeg is installed), a folder of its pictures, or grey values.
    pixel_size_um : float or None
        Size of a pixel, um. It is never guessed. None: the size stated in the film.
    frame_rate_per_s : float or None
        Frame rate, frames per second; None: the rate stated in the film.
    subset_um : float or None
        Side of the square subsets that are found again in each frame, um; None: 4 um.
    frame : int or None
        The frame at rest, from 0; None finds it.
    outline : path or None
        Outline of the cell, drawn on the frame at rest.
    cell, seed, modality : int or str, tuple of two floats, str or None
        Choice of the cell in the frame at rest, and how it is found, as in `Cell.from_image`. "all" follows every cell.
    channel : int or None
        Channel of the film, from 0.
    allow_cut : bool
        Whether to accept a cell that is cut by the frame.
    spacing_um : float or None
        Spacing of the tracked points, um; None chooses it by the size of the cell.
    stain : {"z-disc", "filament"} or None
        Stained structure: stripes across the fibre or filaments along it. None: z-disc.
    threads : int or None
        Number of threads; the results do not depend on it.
    progress : callable, bool or None
        Called with the stage, the number of finished steps of it, and the number of all its steps; what it raises ends
        the work. True draws a bar.

    Returns
    -------
    Motion or FilmCells
        The cell, frame by frame; for ``cell="all"`` all cells of the film.

    Raises
    ------
    ValueError
        The film shows no cell, does not say its pixel size or frame rate, or cannot be followed.
    OSError
        The film cannot be read.
    """
    given = changed(
        ("shape.pixel_size", pixel_size_um, None),
        ("shape.spacing", spacing_um, None),
        ("segmentation.outline", outline, None),
        ("segmentation.frame", frame, None),
        ("segmentation.cell", None if cell == "all" else cell, None),
        ("segmentation.seed", seed, None),
        ("segmentation.modality", modality, None),
        ("segmentation.channel", channel, None),
        ("segmentation.allow_cut", allow_cut, False),
        ("mechanics.stain", stain, None),
    )
    every = cell == "all"
    with film_path(film) as path:
        asked = (path, given, frame_rate_per_s, subset_um, threads, heard(progress))
        motion = FilmCells(_native.track_all(*asked)) if every else Motion(_native.track(*asked))
    warn(motion.warnings)
    return motion
