"""Comparison of runs."""

from __future__ import annotations

import html
import json
import os
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from myospring import _native
from myospring._beat import Beat
from myospring._errors import warn
from myospring._progress import Progress, heard
from myospring._settings import PictureSettings, given_of_picture

if TYPE_CHECKING:
    from typing_extensions import Unpack

# A beat, or a run file, a picture, an outline or a folder of results.
Run = Union[Beat, str, PathLike[str]]

# Metrics that a notebook shows.
_SHOWN = ("peak_tension", "peak_shortening", "time_to_peak_from_stimulus", "relaxation_time_50", "action_potential_duration_90")


class Comparison:
    """Compared runs; the result of `compare`. Differences are from the first run.

    Attributes
    ----------
    labels : list of str
        Names of the runs.
    metrics, differences, differences_pct : dict of str to ndarray of shape (runs,)
        Each metric, its difference from the first run, and that in per cent; NaN if a run does not show it.
    units, definitions : dict of str to str
        Unit and definition of each metric.
    settings : dict of str to list of str
        The settings in which the runs differ, with the value of each.
    warnings : list of str
        Warnings to read before the metrics are compared.
    """

    def __init__(self, native: _native.Comparison) -> None:
        self._native = native
        record = json.loads(native.numbers)
        rows = record["metrics"]
        self.labels: list[str] = [run["label"] for run in record["runs"]]
        self.metrics = {row["name"]: _numbers(row["values"]) for row in rows}
        self.differences = {row["name"]: _numbers(row["differences"]) for row in rows}
        self.differences_pct = {row["name"]: _numbers(row["differences_pct"]) for row in rows}
        self.units: dict[str, str] = {row["name"]: row["unit"] for row in rows}
        self.definitions: dict[str, str] = {row["name"]: row["definition"] for row in rows}
        self.settings: dict[str, list[str]] = dict(native.settings)
        self.warnings: list[str] = native.warnings

    def to_dataframe(self) -> Any:
        """The numbers as a table; it needs pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each metric and run: ``metric``, ``run``, ``value``, ``unit``, ``difference``, ``difference_pct``.
        """
        import pandas

        rows = [
            (name, label, values[at], self.units[name], self.differences[name][at], self.differences_pct[name][at])
            for name, values in self.metrics.items()
            for at, label in enumerate(self.labels)
        ]
        return pandas.DataFrame(rows, columns=["metric", "run", "value", "unit", "difference", "difference_pct"])

    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Writes what ``myospring compare`` writes: ``comparison.json``, ``metrics.csv``, the runs, figures, report.

        Parameters
        ----------
        folder : path
            Made if it is not there.
        force : bool
            Replaces results that the folder holds. Refused where it holds anything that no command wrote, or that was
            changed since; a file that was read is never replaced.

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

    def __repr__(self) -> str:
        return f"<myospring.Comparison of {', '.join(self.labels)}>"

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{html.escape(label)}</th>" for label in self.labels)
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td>{''.join(f'<td>{html.escape(value)}</td>' for value in values)}</tr>"
            for name, values in self.settings.items()
        )
        rows += "".join(
            f"<tr><td>{name.replace('_', ' ')} ({html.escape(self.units[name])})</td>"
            f"{''.join(f'<td>{value:.4g}</td>' for value in self.metrics[name])}</tr>"
            for name in _SHOWN
            if name in self.metrics
        )
        warnings = "".join(f"<p>Warning: {html.escape(text)}</p>" for text in self.warnings)
        return f"<div><table><tr><th></th>{head}</tr>{rows}</table>{warnings}</div>"


def _numbers(values: Sequence[float | None]) -> NDArray[np.float64]:
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def compare(
    *runs: Run,
    scale: Mapping[str, Mapping[str, float]] | None = None,
    doses: str | PathLike[str] | Mapping[str, Any] | None = None,
    labels: Sequence[str] | None = None,
    threads: int | None = None,
    progress: Progress = None,
    pixel_size_um: float | None = None,
    **settings: Unpack[PictureSettings],
) -> Comparison:
    """Compares the settings and metrics of runs, as ``myospring compare`` does.

    Parameters
    ----------
    runs : Beat or path
        Beats, run files, pictures, outlines or folders of results; without any, the built-in cell.
    scale : mapping or None
        Factors on numbers of each run, by label: ``{"weaker": {"peak_tension": 0.7}}`` runs each again with them.
    doses : path, mapping or None
        Doses of drugs: a TOML file as ``myospring compare --help`` describes it, or its content. Each dose is run.
    labels : sequence of str or None
        Names of the runs, in their order; None: their titles, or else the names of their folders, files or cells.
    threads : int or None
        Number of runs computed at a time; None: the number of cores.
    progress : callable, bool or None
        As in `track`.
    pixel_size_um : float or None
        Side of a pixel of pictures among the runs, um.
    **settings
        Settings of `simulate` and `Cell.from_image` that override those of each run file or picture. Beats and folders
        of results are finished, and take none.

    Returns
    -------
    Comparison
        Settings and numbers of each run.

    Raises
    ------
    ValueError
        Less than two runs, or settings that are not possible.
    OSError
        A file that cannot be read.

    Examples
    --------
    >>> import myospring
    >>> cell = myospring.Cell.builtin(spacing_um=5)
    >>> weak, strong = (
    ...     myospring.simulate(cell, peak_tension_kpa=tension, integrator="quasi-static") for tension in (20, 40)
    ... )
    >>> found = myospring.compare(weak, strong, labels=["weak", "strong"])
    >>> found.settings
    {'cell.peak_tension': ['20 kPa', '40 kPa']}
    >>> bool(found.differences["peak_shortening"][1] > 4)
    True
    """
    if labels is not None and len(labels) != len(runs):
        raise ValueError(f"there are {len(labels)} labels and {len(runs)} runs")
    inputs = [run._native if isinstance(run, Beat) else os.fspath(run) for run in runs]
    given = given_of_picture("compare", pixel_size_um, settings, override=True)
    factors = [(label, [(name, float(factor)) for name, factor in one.items()]) for label, one in (scale or {}).items()]
    if isinstance(doses, Mapping):
        text: str | None = _native.study_toml(json.dumps(doses))
    else:
        text = None if doses is None else Path(doses).read_text(encoding="utf-8")
    comparison = Comparison(_native.compare(inputs, list(labels or []), given, factors, text, threads, heard(progress)))
    warn(comparison.warnings)
    return comparison
