"""The cells of many pictures. `generate.py` writes what it takes of settings."""

from __future__ import annotations

import html
import json
import os
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterable, Literal

import numpy as np
from numpy.typing import NDArray

from myospring import _native
from myospring._errors import warn
from myospring._functions import BeatSettings
from myospring._given import changed
from myospring._progress import Progress, heard
from myospring._settings import given_of_beat

if TYPE_CHECKING:
    from typing_extensions import Unpack

# Rows and columns that a notebook shows.
_SHOWN = 12
_COLUMNS = ("picture", "cell", "status", "confidence", "length_um", "peak_shortening_pct", "reason")


class Batch:
    """The cells of many pictures, a row for each. `batch` makes one.

    Attributes
    ----------
    columns : dict of str to ndarray or list
        Numbers by column, with the unit in its name, NaN where there is none; ``picture``, ``cell``, ``status`` and the
        other words are lists.
    pictures : int
        How many pictures there were.
    resumed : int
        How many of them were done before, in the folder of the results.
    folder : pathlib.Path or None
        The folder of the results.
    warnings : list of str
        What a person should look at.
    """

    def __init__(self, columns: dict[str, Any], numbers: str, warnings: list[str]) -> None:
        told = json.loads(numbers)
        self.columns: dict[str, NDArray[np.float64] | list[str | None]] = columns
        self.pictures: int = told["pictures"]
        self.resumed: int = told["resumed"]
        self.folder = None if told["results"] is None else Path(told["results"])
        self.warnings = warnings

    def __len__(self) -> int:
        return len(self.columns["status"])

    def __getitem__(self, column: str) -> NDArray[np.float64] | list[str | None]:
        return self.columns[column]

    @property
    def counts(self) -> dict[str, int]:
        """How many rows there are of each status: ``ok``, ``left-out``, ``failed``."""
        statuses = list(self.columns["status"])
        return {str(status): statuses.count(status) for status in dict.fromkeys(statuses)}

    @property
    def failed(self) -> dict[str, str]:
        """Why a picture or a cell failed, by its name."""
        rows = zip(*(self.columns[name] for name in ("status", "picture", "cell", "reason")))
        failed = (row for row in rows if row[0] == "failed")
        return {str(picture if cell is None else f"{picture}, cell {cell}"): str(why) for _, picture, cell, why in failed}

    def to_dataframe(self) -> Any:
        """The table; it needs pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each cell, and for each picture that failed, as ``cells.csv`` has them.
        """
        import pandas

        return pandas.DataFrame(self.columns)

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {status}" for status, count in self.counts.items())
        return f"<myospring.Batch of {self.pictures} pictures: {counts}>"

    def _repr_html_(self) -> str:
        names = [name for name in _COLUMNS if name in self.columns]
        heading = "".join(f"<th>{name}</th>" for name in names)
        rows = "".join(
            "<tr>" + "".join(f"<td>{_shown(self.columns[name][row])}</td>" for name in names) + "</tr>"
            for row in range(min(len(self), _SHOWN))
        )
        more = len(self) - _SHOWN
        rest = f"<p>and {more} more rows</p>" if more > 0 else ""
        title = html.escape(repr(self)[1:-1])
        return f"<div><b>{title}</b><table><tr>{heading}</tr>{rows}</table>{rest}</div>"


def _shown(value: Any) -> str:
    if value is None:
        return ""
    return html.escape(value) if isinstance(value, str) else f"{value:.4g}"


def batch(
    pictures: str | PathLike[str] | Iterable[str | PathLike[str]],
    *,
    pattern: str | None = None,
    stacks: bool = False,
    output: str | PathLike[str] | None = None,
    figures: bool = False,
    threads: int | None = None,
    force: bool = False,
    progress: Progress = None,
    # <signature of image_and_beat>
    pixel_size_um: float | None = None,
    any_size: bool = False,
    profile: Literal["flat", "round", "dome", "slab"] = "flat",
    spacing_um: float | None = None,
    modality: Literal["auto", "fluorescence", "brightfield", "mask"] | None = None,
    channel: int | None = None,
    frame: int | None = None,
    z: int | str | None = None,
    threshold: float | None = None,
    smooth_um: float | None = None,
    seed: tuple[float, float] | None = None,
    cell: int | str | None = None,
    min_area_um2: float | None = None,
    max_area_um2: float | None = None,
    allow_cut: bool = False,
    outline: str | PathLike[str] | None = None,
    z_step_um: float | None = None,
    first_slice: Literal["bottom", "top"] | None = None,
    stack_stain: Literal["auto", "filled", "membrane"] | None = None,
    # </signature>
    **settings: Unpack[BeatSettings],
) -> Batch:
    """Beats the cells of many pictures: one row a cell.

    All cells of each picture, unless `cell` or `seed` names one. Cells that the frame cuts, doubtful ones and those of an
    unusual area are left out with the reason; a picture that cannot be used is a row with the reason.

    Parameters
    ----------
    pictures : path or sequence of paths
        A folder, searched with all folders in it; a table (.csv) with a line for each picture, whose columns are its file
        and settings of its own; or the files themselves.
    pattern : str or None
        In a folder, only files whose name matches: ``"*_actinin.tif"``.
    stacks : bool
        Whether each file is a stack of slices, with one thick cell. In a table, a column ``stack`` instead of ``file`` says so.
    output : path or None
        Folder in which all that is done is kept, with overlays and tables: the same call goes on where it was. None
        keeps nothing.
    figures : bool
        Whether curves and figures of each cell are written into `output`.
    threads : int or None
        Pictures at a time; None takes as many as there are cores.
    force : bool
        Begins anew in `output`.
    progress : callable, bool or None
        As in `track`, called with ``("pictures", done, all)`` after each picture.
    pixel_size_um : float or None
        Side of one pixel of a picture, or of an outline in pixels. Never guessed. In um, 0.001 um
        to 50 um. None: the picture's own.
    any_size : bool, default False
        Accepts a cell whose size is impossible for a heart cell: longer than 400 um, shorter than
        15 um, or with an area outside of `min_area_um2` to `max_area_um2`. Such a size usually
        means a wrong pixel size.
    profile : {"flat", "round", "dome", "slab"}, default "flat"
        Section of the cell across its plane. A thick cell is made of cubes; its greatest thickness
        is `thickness_um` in [material], and what a picture does not show of it is assumed.
    spacing_um : float or None
        Distance between neighbouring masses. In um, above 0 um, at most 1000 um. None: such that a
        flat cell has about 2000 of them, a thick one about 4000 and 4 cubes across its thickness.
    modality : {"auto", "fluorescence", "brightfield", "mask"} or None
        How the picture was taken. None: auto.
    channel : int or None
        Channel of the picture, from 0. 0 to 10000. None: the first, or the luminance of a colour
        picture.
    frame : int or None
        Frame (time point) of the picture, from 0. 0 to 1000000. None: 0.
    z : int or str or None
        How a stack in depth is reduced: "max", "mean", or the number of a slice, from 0. None: max.
    threshold : float or None
        Threshold; a lower one includes more. Fluorescence: grey value above which a pixel belongs
        to the cell. Brightfield: least relative change of brightness per um of an edge. None:
        determined from the picture, and printed.
    smooth_um : float or None
        Scale of smoothing. In um, 0 um to 20 um. None: "0.5 um" for fluorescence, "0.8 um" for
        brightfield.
    seed : tuple[float, float] or None
        Takes the cell at this place: column and row in pixels from the top left.
    cell : int or str or None
        Which cell: "largest", or its number by size, 1 being the largest. None: largest; batch:
        all.
    min_area_um2 : float or None
        Smallest expected area of a cell: studies leave out smaller ones (debris); elsewhere they
        are errors unless any size is allowed. In um^2, 0 um^2 to 100000000 um^2. None: "500 um^2".
    max_area_um2 : float or None
        Largest expected area of a cell: studies leave out larger ones (sheets, clumps); elsewhere
        they are errors unless any size is allowed. In um^2, above 0 um^2, at most 100000000 um^2.
        None: "20000 um^2".
    allow_cut : bool, default False
        Accepts a cell although the frame of the picture cuts it.
    outline : str or PathLike[str] or None
        Outline of the cell drawn on the picture in another program, instead of segmentation:
        GeoJSON, ImageJ's .roi or RoiSet .zip, Cellpose's _outlines.txt.
    z_step_um : float or None
        Distance of two slices of a stack. What the file states are steps of the stage; through a
        dry objective the focus moves further. In um, 0.001 um to 50 um. None: the stack's own.
    first_slice : {"bottom", "top"} or None
        Where the first slice of a stack lies: bottom, where the cell stands on its support, or top.
        None: bottom.
    stack_stain : {"auto", "filled", "membrane"} or None
        What of the cell is bright in a stack. None: auto.
    **settings
        How the cells beat: the settings of `simulate`, with its names, units and defaults.

    Returns
    -------
    Batch

    Raises
    ------
    FileNotFoundError
        There is no such folder, table or picture.
    OSError
        `output` holds other files, or cannot be written to.
    ValueError
        A setting that is not possible, or a folder without pictures.
    KeyboardInterrupt
        Ctrl-C, within a second; what is done stays in `output`.
    """
    # <given of image_and_beat>
    given = changed(
        ("shape.pixel_size", pixel_size_um, None),
        ("shape.any_size", any_size, False),
        ("shape.profile", profile, "flat"),
        ("shape.spacing", spacing_um, None),
        ("segmentation.modality", modality, None),
        ("segmentation.channel", channel, None),
        ("segmentation.frame", frame, None),
        ("segmentation.z", z, None),
        ("segmentation.threshold", threshold, None),
        ("segmentation.smooth", smooth_um, None),
        ("segmentation.seed", seed, None),
        ("segmentation.cell", cell, None),
        ("segmentation.min_area", min_area_um2, None),
        ("segmentation.max_area", max_area_um2, None),
        ("segmentation.allow_cut", allow_cut, False),
        ("segmentation.outline", outline, None),
        ("shape.z_step", z_step_um, None),
        ("shape.first_slice", first_slice, None),
        ("shape.stack_stain", stack_stain, None),
    )
    # </given>
    given |= given_of_beat("batch", settings)
    folder, table, files = _found(pictures)
    results = None if output is None else os.fspath(output)
    done = _native.beat_pictures(
        folder, pattern, table, files, stacks, given, figures, threads, results, force, heard(progress)
    )
    made = Batch(*done)
    failed = made.failed
    first = next(iter(failed.items()), None)
    told = [] if first is None else [f"{len(failed)} rows failed, the first of {first[0]}: {first[1]}"]
    warn([*made.warnings, *told])
    return made


def _found(pictures: str | PathLike[str] | Iterable[str | PathLike[str]]) -> tuple[str | None, str | None, list[str]]:
    """A folder, a table or files."""
    if isinstance(pictures, (str, PathLike)):
        path = Path(pictures)
        if path.is_dir():
            return os.fspath(path), None, []
        if path.suffix.lower() == ".csv":
            return None, os.fspath(path), []
        if not path.exists():
            raise FileNotFoundError(f"cannot read `{path}`: there is no such folder, table or picture")
        return None, None, [os.fspath(path)]
    return None, None, [os.fspath(path) for path in pictures]
