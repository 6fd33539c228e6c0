"""Beats of measured curves."""

from __future__ import annotations

import html
import json
import os
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Iterator, Mapping, Sequence, Union, cast

import numpy as np
from numpy.typing import NDArray

from myospring import _native
from myospring._errors import UnknownNameError, warn
from myospring._progress import Progress, heard
from myospring._reading import Curve, Reading
from myospring._xarray import dataset

# Metrics that a notebook shows, if the curve has them.
_SHOWN = 12


@dataclass(frozen=True, eq=False)
class MeasuredBeat:
    """One beat of a measured curve.

    Attributes
    ----------
    number : int
        From 1.
    state : str
        ``"whole"``, ``"cut-at-start"``, ``"cut-at-end"``, ``"disturbed"``, ``"interrupted"`` or ``"missed"``. Means
        include whole beats, and those metrics that beats cut at the end still show.
    stimulus_ms, onset_ms : float or None
        Time of its stimulus, and time at which the curve leaves rest.
    metrics : dict of str to float
        Its metrics; NaN if the curve does not show one.
    remarks : list of str
        Anything unusual about the beat.
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
        Its file (empty for arrays) and its column.
    kind, unit : str
        Kind of its values, and their unit.
    t_ms, values : ndarray of shape (frames,)
        The curve.
    metrics, standard_deviations : dict of str to float
        Mean and standard deviation of each metric over the beats that count; NaN if no beat, or for the latter only
        one, shows it.
    units : dict of str to str
        Units of the metrics.
    beats : list of MeasuredBeat
        In order.
    remarks : list of str
        Anything unusual about the curve.
    treatment : dict
        Processing of the curve before its metrics were read: baseline, drift, smoothing, ignored frames.
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

    def to_xarray(self) -> Any:
        """Returns the curve as a dataset; needs xarray.

        Returns
        -------
        xarray.Dataset
            ``values`` over ``t_ms``, with its unit as an attribute.
        """
        times = {"t_ms": (("t_ms",), self.t_ms)}
        return dataset({"values": (("t_ms",), self.values)}, times, {"title": self.title}, {"values": self.unit})

    def __repr__(self) -> str:
        found = _count(len(self.beats), "beat") if self.error is None else self.error
        return f"<myospring.AnalysedCurve {self.title}, {self.kind}: {found}>"


@dataclass(frozen=True, eq=False)
class BeatLoop:
    """Calcium and motion over one beat, or over the mean beat.

    Attributes
    ----------
    beat : int or None
        Number of the beat; None for the mean beat.
    t_ms : ndarray of shape (points,)
        Time from the onset of calcium.
    calcium, motion : ndarray of shape (points,)
        Calcium in its unit, and motion above rest: shortening in % of the length at rest for lengths; both without drift.
    """

    beat: int | None
    t_ms: NDArray[np.float64]
    calcium: NDArray[np.float64]
    motion: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PairedBeat:
    """A beat in a curve of calcium and in one of motion.

    Attributes
    ----------
    number : int
        From 1.
    calcium_beat, motion_beat : int or None
        Its number among the beats of each curve; None if that curve does not have it.
    counts : bool
        Whether it counts in means: both curves have the whole beat, or it is cut only at the end.
    metrics : dict of str to float
        Delays, calcium at half of the motion, area of the loop; NaN where one cannot be read.
    remark : str
        Why it does not count, or what is odd.
    """

    number: int
    calcium_beat: int | None
    motion_beat: int | None
    counts: bool
    metrics: dict[str, float]
    remark: str


@dataclass(frozen=True, eq=False)
class PairedCurves:
    """Calcium and a motion or tension that were recorded together.

    Attributes
    ----------
    calcium, motion : str
        Names of both curves.
    calcium_unit, motion_unit : str
        Units of calcium and of the motion in loops.
    metrics, standard_deviations : dict of str to float
        Mean and standard deviation of each metric over the beats that count; NaN where none shows it.
    units, definitions : dict of str to str
        Units and definitions of the metrics.
    direction : str
        ``"counter-clockwise"`` (motion follows calcium), ``"clockwise"``, or ``"unknown"`` where noise is larger than the
        area of the loops.
    beats : list of PairedBeat
        In order.
    mean_loop : BeatLoop or None
        The mean beat.
    loops : list of BeatLoop
        Loops of the beats that count.
    remarks : list of str
        Anything unusual about the pair.
    """

    calcium: str
    motion: str
    calcium_unit: str
    motion_unit: str
    metrics: dict[str, float]
    standard_deviations: dict[str, float]
    units: dict[str, str]
    definitions: dict[str, str]
    direction: str
    beats: list[PairedBeat]
    mean_loop: BeatLoop | None
    loops: list[BeatLoop]
    remarks: list[str]

    def to_dataframe(self) -> Any:
        """Returns every beat as a table; needs pandas.

        Returns
        -------
        pandas.DataFrame
            One row per beat: ``beat``, ``calcium_beat``, ``motion_beat``, ``counts``, then the metrics.
        """
        import pandas

        rows = [
            {
                "beat": beat.number,
                "calcium_beat": beat.calcium_beat,
                "motion_beat": beat.motion_beat,
                "counts": beat.counts,
                **beat.metrics,
            }
            for beat in self.beats
        ]
        return pandas.DataFrame(rows)

    def __repr__(self) -> str:
        counted = sum(beat.counts for beat in self.beats)
        return f"<myospring.PairedCurves {self.calcium} and {self.motion}: {_count(counted, 'beat')}, {self.direction}>"


class Analysis(Mapping[str, AnalysedCurve]):
    """Measured curves with their beats, by title; the result of `analyse`.

    Attributes
    ----------
    curves : list of AnalysedCurve
        Curves in the order of the files.
    notes : list of str
        What was detected and assumed when the files were read.
    pairs : list of PairedCurves
        Calcium with each motion or tension that was recorded together with it.
    """

    def __init__(self, native: _native.Analysis) -> None:
        self._native = native
        record = json.loads(native.numbers())
        self.notes: list[str] = record["notes"]
        self.curves = [_curve(row, *arrays) for row, arrays in zip(record["curves"], native.curves())]
        self.pairs = [_pair(row, loops) for row, loops in zip(record.get("pairs", []), native.loops())]

    @property
    def warnings(self) -> list[str]:
        """Warnings to read before the numbers are used."""
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
        """Returns every beat of every curve as a table; needs pandas.

        Returns
        -------
        pandas.DataFrame
            One row per beat: ``file``, ``curve``, ``kind``, ``beat``, ``state``, ``stimulus_ms``, ``onset_ms``, then
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
        """Writes the files of ``myospring analyse``: ``metrics.csv``, ``summary.csv``, ``summary.json``, figures,
        report; of pairs ``pairs.csv`` and ``loops.csv``.

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
        beats = sum(len(one.beats) for one in self.curves)
        return f"<myospring.Analysis: {_count(len(self.curves), 'curve')}, {_count(beats, 'beat')}>"

    def _repr_html_(self) -> str:
        parts = []
        for one in self.curves[:_SHOWN]:
            rows = "".join(
                f"<tr><td>{name.replace('_', ' ')}</td><td>{_amount(one, name)}</td></tr>"
                for name in [name for name, value in one.metrics.items() if not np.isnan(value)][:_SHOWN]
            )
            parts.append(f"<p><b>{html.escape(repr(one)[1:-1])}</b></p><table>{rows}</table>")
        warnings = "".join(f"<p>Warning: {html.escape(text)}</p>" for text in self.warnings)
        return f"<div>{''.join(parts)}{warnings}</div>"


def _count(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


def _amount(curve: AnalysedCurve, name: str) -> str:
    spread = curve.standard_deviations[name]
    more = "" if np.isnan(spread) else f" &plusmn; {spread:.3g}"
    return f"{curve.metrics[name]:.4g}{more} {html.escape(curve.units[name])}"


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def _pair(
    row: dict[str, Any],
    loops: list[tuple[int, NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]],
) -> PairedCurves:
    metrics = row["metrics"]
    mean = row["mean_loop"]
    return PairedCurves(
        calcium=row["calcium"]["curve"],
        motion=row["motion"]["curve"],
        calcium_unit=row["calcium"]["unit"],
        motion_unit=row["motion_unit"],
        metrics={metric["name"]: _number(metric["mean"]) for metric in metrics},
        standard_deviations={metric["name"]: _number(metric["standard_deviation"]) for metric in metrics},
        units={metric["name"]: metric["unit"] for metric in metrics},
        definitions={metric["name"]: metric["definition"] for metric in metrics},
        direction=row["direction"],
        beats=[
            PairedBeat(
                number=beat["number"],
                calcium_beat=beat["calcium_beat"],
                motion_beat=beat["motion_beat"],
                counts=beat["counts"],
                metrics={metric["name"]: _number(metric["value"]) for metric in beat["metrics"]},
                remark=beat["remark"],
            )
            for beat in row["beats"]
        ],
        mean_loop=mean and BeatLoop(None, *(np.array(mean[name]) for name in ("times_ms", "calcium", "motion"))),
        loops=[BeatLoop(*one) for one in loops],
        remarks=row["remarks"],
    )


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
    progress: Progress = None,
) -> Analysis:
    """Finds the beats of measured curves and returns every metric of every beat, as ``myospring analyse`` does.

    Parameters
    ----------
    curves : path, paths, two arrays, or a mapping of names to two arrays
        Tables of curves as laboratory programs export them, or folders of such tables; or times in ms and values.
    stimulus_times_ms : sequence of float
        Times of stimuli on the clock of the curve; if empty, the marks of a pacer in the file.
    stimulus_period_ms, stimulus_start_ms : float or None
        Interval of regular stimuli instead, and time of the first one; None: the first frame.
    smoothing_ms : float or None
        Half width of the window of local parabolas, 0 for no smoothing; None chooses it by the noise.
    keep_drift : bool
        Whether to keep the drift of the baseline.
    columns, sheets : sequence of str
        Columns that are curves, and sheets of a workbook, by name or by number from 1; empty: all recognised ones.
    time, kind, unit, time_unit : str or None
        Column of times, kind of the values (``"length"``, ``"sarcomere-length"``, ``"calcium"``, ...) and their unit,
        and the unit of the times; None: what the table states, and for arrays a length in um.
    frame_rate_per_s, pixel_size_um : float or None
        Frame rate in frames per second, for tables without times; pixel size in um, for lengths in pixels.
    from_ms, until_ms : float or None
        Start and end of the part of the recording to use, ms.
    ignore_marks, mean, skip_gaps : bool
        Whether to ignore the marks of a pacer; to use the mean of all columns; to skip frames without a number.
    progress : callable, bool or None
        As in `track`.

    Returns
    -------
    Analysis
        The curves with their beats.

    Raises
    ------
    ValueError
        No curve has a beat, or a curve cannot be read.
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
    analysis = Analysis(_native.analyse(paths, measured, reading.by_name(), finding, heard(progress)))
    warn(analysis.warnings)
    return analysis
