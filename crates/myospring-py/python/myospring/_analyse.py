"""Beats of measured curves."""

from __future__ import annotations

import html
import json
import os
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Callable, Iterator, Mapping, Sequence, Union, cast

import numpy as np
from numpy.typing import NDArray

from myospring import _native
from myospring._errors import UnknownNameError, warn
from myospring._fit import Curve, Reading

# Metrics that a notebook shows, as far as a curve has them.
_SHOWN = 12


@dataclass(frozen=True, eq=False)
class MeasuredBeat:
    """One beat of a measured curve.

    Attributes
    ----------
    number : int
        From 1.
    state : str
        ``"whole"``, ``"cut-at-start"``, ``"cut-at-end"``, ``"disturbed"``, ``"interrupted"`` or ``"missed"``. Means are
        over whole beats, and over what those cut at the end still show.
    stimulus_ms, onset_ms : float or None
        Its stimulus, and when the curve leaves its rest.
    metrics : dict of str to float
        Its metrics; NaN where the curve does not show one.
    remarks : list of str
        What is odd about it.
    """

    number: int
    state: str
    stimulus_ms: float | None
    onset_ms: float | None
    metrics: dict[str, float]
    remarks: list[str]


@dataclass(frozen=True, eq=False)
class AnalysedCurve:
    """A measured curve with its beats.

    Attributes
    ----------
    file, name : str
        Its file, empty of arrays, and its column.
    kind, unit : str
        What its values are, and their unit.
    t_ms, values : ndarray of shape (frames,)
        The curve.
    metrics, standard_deviations : dict of str to float
        Mean of each metric over the beats that count, and how much they differ; NaN where no beat shows it, or one.
    units : dict of str to str
        Units of the metrics.
    beats : list of MeasuredBeat
        In order.
    remarks : list of str
        What is odd about the curve.
    treatment : dict
        What was done to the curve before it was read: baseline, drift, smoothing, frames that were left out.
    error : str or None
        Why no beat was found.
    """

    file: str
    name: str
    kind: str
    unit: str
    t_ms: NDArray[np.float64]
    values: NDArray[np.float64]
    metrics: dict[str, float]
    standard_deviations: dict[str, float]
    units: dict[str, str]
    beats: list[MeasuredBeat]
    remarks: list[str]
    treatment: dict[str, Any]
    error: str | None

    @property
    def title(self) -> str:
        """File and column."""
        return f"{Path(self.file).name}: {self.name}" if self.file else self.name

    def __repr__(self) -> str:
        found = f"{len(self.beats)} beats" if self.error is None else self.error
        return f"<myospring.AnalysedCurve {self.title}, {self.kind}: {found}>"


class Analysis(Mapping[str, AnalysedCurve]):
    """Measured curves with their beats, by their titles. `analyse` makes one.

    Attributes
    ----------
    curves : list of AnalysedCurve
        In the order of the files.
    notes : list of str
        What was found and assumed when the files were read.
    """

    def __init__(self, native: _native.Analysis) -> None:
        self._native = native
        record = json.loads(native.numbers())
        self.notes: list[str] = record["notes"]
        self.curves = [_curve(row, *arrays) for row, arrays in zip(record["curves"], native.curves())]

    @property
    def warnings(self) -> list[str]:
        """What a person should look at before the numbers are used."""
        return self._native.warnings

    def __getitem__(self, title: str) -> AnalysedCurve:
        named = [one for one in self.curves if title in (one.title, one.name)]
        if len(named) != 1:
            known = ", ".join(one.title for one in self.curves)
            raise UnknownNameError(f"{'several curves are' if named else 'no curve is'} named `{title}`; there are: {known}")
        return named[0]

    def __iter__(self) -> Iterator[str]:
        return (one.title for one in self.curves)

    def __len__(self) -> int:
        return len(self.curves)

    def to_dataframe(self) -> Any:
        """Every beat of every curve as a table; it needs pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each beat: ``file``, ``curve``, ``kind``, ``beat``, ``state``, ``stimulus_ms``, ``onset_ms``, then
            the metrics.
        """
        import pandas

        rows = [
            {
                "file": curve.file,
                "curve": curve.name,
                "kind": curve.kind,
                "beat": beat.number,
                "state": beat.state,
                "stimulus_ms": beat.stimulus_ms,
                "onset_ms": beat.onset_ms,
                **beat.metrics,
            }
            for curve in self.curves
            for beat in curve.beats
        ]
        return pandas.DataFrame(rows)

    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Writes what ``myospring analyse`` writes: ``metrics.csv``, ``summary.csv``, ``summary.json``, figures, report.

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
        saved, said = self._native.save(os.fspath(folder), force)
        warn(said)
        return Path(saved)

    def __repr__(self) -> str:
        beats = sum(len(one.beats) for one in self.curves)
        return f"<myospring.Analysis: {len(self.curves)} curves, {beats} beats>"

    def _repr_html_(self) -> str:
        parts = []
        for one in self.curves[:_SHOWN]:
            rows = "".join(
                f"<tr><td>{name.replace('_', ' ')}</td><td>{_amount(one, name)}</td></tr>"
                for name in list(one.metrics)[:_SHOWN]
            )
            parts.append(f"<p><b>{html.escape(repr(one)[1:-1])}</b></p><table>{rows}</table>")
        warnings = "".join(f"<p>Warning: {html.escape(text)}</p>" for text in self.warnings)
        return f"<div>{''.join(parts)}{warnings}</div>"


def _amount(curve: AnalysedCurve, name: str) -> str:
    spread = curve.standard_deviations[name]
    more = "" if np.isnan(spread) else f" &plusmn; {spread:.3g}"
    return f"{curve.metrics[name]:.4g}{more} {html.escape(curve.units[name])}"


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def _curve(
    row: dict[str, Any], file: str, t_ms: NDArray[np.float64], values: NDArray[np.float64]
) -> AnalysedCurve:
    beats = [
        MeasuredBeat(
            number=beat["number"],
            state=beat["state"],
            stimulus_ms=beat["stimulus_ms"],
            onset_ms=beat["onset_ms"],
            metrics={metric["name"]: _number(metric["value"]) for metric in beat["metrics"]},
            remarks=beat["remarks"],
        )
        for beat in row["beats"]
    ]
    metrics = row["metrics"]
    return AnalysedCurve(
        file=file,
        name=row["curve"],
        kind=row["kind"],
        unit=row["unit"],
        t_ms=t_ms,
        values=values,
        metrics={metric["name"]: _number(metric["mean"]) for metric in metrics},
        standard_deviations={metric["name"]: _number(metric["standard_deviation"]) for metric in metrics},
        units={metric["name"]: metric["unit"] for metric in metrics},
        beats=beats,
        remarks=row["remarks"],
        treatment=row.get("treatment", {}),
        error=row.get("error"),
    )


def analyse(
    curves: Curve | Sequence[str | PathLike[str]] | Mapping[str, Curve],
    *,
    stimulus_times_ms: Sequence[float] = (),
    stimulus_period_ms: float | None = None,
    stimulus_start_ms: float | None = None,
    smoothing_ms: float | None = None,
    keep_drift: bool = False,
    columns: Sequence[str] = (),
    time: str | None = None,
    kind: str | None = None,
    unit: str | None = None,
    time_unit: str | None = None,
    frame_rate_per_s: float | None = None,
    pixel_size_um: float | None = None,
    sheets: Sequence[str] = (),
    from_ms: float | None = None,
    until_ms: float | None = None,
    ignore_marks: bool = False,
    mean: bool = False,
    skip_gaps: bool = False,
    progress: Callable[[str, int, int], object] | None = None,
) -> Analysis:
    """Finds the beats of measured curves and reads every metric, beat by beat: what ``myospring analyse`` does.

    Parameters
    ----------
    curves : path, paths, two arrays, or a mapping of names to two arrays
        Tables of curves as the laboratory's program exports them, or folders of them; or times in ms and values.
    stimulus_times_ms : sequence of float
        When stimuli fell, on the clock of the curve; without any, those that a file has marks of.
    stimulus_period_ms, stimulus_start_ms : float or None
        Stimuli at regular intervals instead, and the first of them; None: the first frame.
    smoothing_ms : float or None
        Half of the window of local parabolas, 0 for none; None chooses it by the noise.
    keep_drift : bool
        Leaves the drift of the baseline in.
    columns, sheets : sequence of str
        Columns that are curves, and sheets of a workbook, by name or by number from 1; empty: all that are known.
    time, kind, unit, time_unit : str or None
        Column of times, what the values are (``"length"``, ``"sarcomere-length"``, ``"calcium"``, ...) and their unit,
        and the unit of the times; None: what the table says, of arrays a length in um.
    frame_rate_per_s, pixel_size_um : float or None
        Frames a second, where there are no times; size of a pixel, where lengths are in pixels.
    from_ms, until_ms : float or None
        The part of the recording that counts.
    ignore_marks, mean, skip_gaps : bool
        Leaves out a pacer's marks; takes the mean of all columns; leaves out frames without a number.
    progress : callable or None
        Hears the stage, how many of its steps are done, and how many there are.

    Returns
    -------
    Analysis
        The curves with their beats.

    Raises
    ------
    ValueError
        Curves none of which has a beat, or that cannot be read.
    OSError
        A file that cannot be read.

    Examples
    --------
    >>> import numpy, myospring
    >>> t_ms = numpy.arange(0.0, 4000.0, 10.0)
    >>> beat = numpy.clip(numpy.sin(numpy.pi * ((t_ms % 1000) - 300) / 400), 0, None) * (t_ms % 1000 < 700)
    >>> found = myospring.analyse((t_ms, 120 - 10 * beat**2))
    >>> curve = found.curves[0]
    >>> len(curve.beats)
    4
    >>> round(curve.metrics["peak_shortening"], 1)
    8.3
    """
    reading = Reading.among(locals())
    paths: list[str] = []
    measured = []
    if isinstance(curves, (str, PathLike)):
        paths = [os.fspath(curves)]
    elif isinstance(curves, Mapping):
        for name, curve in curves.items():
            measured += reading.curves(curve, name)[0]
    elif isinstance(curves, tuple) and len(curves) == 2 and not any(isinstance(one, (str, PathLike)) for one in curves):
        measured, _ = reading.curves(cast(Curve, curves), "curve")
    else:
        paths = [os.fspath(path) for path in cast(Sequence[Union[str, PathLike[str]]], curves)]
    finding = {
        "stimulus_times_ms": [float(one) for one in stimulus_times_ms],
        "stimulus_period_ms": stimulus_period_ms,
        "stimulus_start_ms": stimulus_start_ms,
        "smoothing_ms": smoothing_ms,
        "keep_drift": keep_drift,
    }
    analysis = Analysis(_native.analyse(paths, measured, reading.by_name(), finding, progress))
    warn(analysis.warnings)
    return analysis
