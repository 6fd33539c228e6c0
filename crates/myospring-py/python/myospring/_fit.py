"""A cell's own parameters from its measured curve."""

from __future__ import annotations

import html
import json
import os
import tempfile
from dataclasses import dataclass, fields, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._beat import Beat, ended
from myospring._cell import Cell, cell_of
from myospring._errors import warn
from myospring._fit_answer import Estimate, FilmDistances, FittedCurve, OwnTension, TriedModel
from myospring._functions import BEAT_KEYS
from myospring._given import film_path
from myospring._progress import Progress, heard
from myospring._reading import Curve, Read, Reading
from myospring._settings import PictureSettings, given_of_beat, given_of_picture
from myospring._tension_map import TensionMap

if TYPE_CHECKING:
    from typing_extensions import Unpack

_VERDICTS = {
    "determined": "determined",
    "at-least": "at least; larger values follow this curve as well",
    "at-most": "at most; smaller values follow this curve as well",
    "not-determined": "not determined by this curve",
    "at-lower-bound": "at its lower bound",
    "at-upper-bound": "at its upper bound",
    "does-not-fit": "no interval: the model does not fit",
}


class Fit:
    """A cell fitted to its curve; the result of `fit`. It can be pickled.

    Attributes
    ----------
    cell : Cell
        The cell with the shape that was used.
    name : str
        Name of the curve.
    run_file : str
        Run file (TOML) of the fitted cell, for ``myospring run``.
    notes : list of str
        What was assumed when the curve was read; of a film what is odd about it.
    tension_map : TensionMap or None
        Of a film where its cell pulls.
    shapes : str or None
        Of a film how far the fitted cell is from the measured one at the peak, in a sentence.
    distances : FilmDistances or None
        Of a film how far the fitted cell is from the film's in each frame; None if the fitted beat reaches no frame.
    """

    def __init__(self, cell: Cell, name: str, text: str, run_file: str, notes: Sequence[str] = ()) -> None:
        self.cell = cell
        self.name = name
        self.run_file = run_file
        self.notes = list(notes)
        self.tension_map: TensionMap | None = None
        self.shapes: str | None = None
        self.distances: FilmDistances | None = None
        self._text = text
        self._native: _native.FilmFit | None = None

    @classmethod
    def _of_film(cls, native: _native.FilmFit) -> Fit:
        made = cls(Cell(native.cell), *native.found, native.notes)
        made.tension_map = None if native.tension_map is None else TensionMap(native.tension_map)
        made.shapes = native.shapes
        columns = dict(native.distances())
        if len(columns.get("frame", ())):
            made.distances = FilmDistances(
                frames=columns["frame"].astype(np.int64),
                t_ms=columns["t_ms"],
                distance_um=columns["distance_um"],
                movement_um=columns["movement_um"],
                positions=native.laid_over(),
            )
        made._native = native
        return made

    @cached_property
    def _record(self) -> dict[str, Any]:
        record: dict[str, Any] = json.loads(self._text)
        return record

    @cached_property
    def parameters(self) -> dict[str, Estimate]:
        """The fitted parameters of the cell, then delays and levels, by name."""
        return {
            row["name"]: Estimate(
                value=row["value"],
                unit=row["unit"],
                interval=(row["interval"][0], row["interval"][1]),
                standard_deviation=row["standard_deviation"],
                verdict=_VERDICTS[row["verdict"]],
                bounds=(row["bounds"][0], row["bounds"][1]),
                profile=[(value, rise) for value, rise in row["profile"]],
            )
            for row in self._record["estimates"]
        }

    @property
    def verdict(self) -> str:
        """Whether the fitted cell follows its curves, to be read before any number: ``"fits"``, ``"fits-nearly"`` (the
        intervals count the misfit) or ``"does-not-fit"`` (there are no intervals)."""
        return str(self._record["verdict"])

    @property
    def model(self) -> str:
        """Name of the cell model; ``"given_tension"`` if the fit found the tension that the curve needs."""
        return str(self._record["model"])

    @cached_property
    def tried(self) -> list[TriedModel]:
        """What each cell model leaves of the curve, the one that was taken first; empty if ``model`` was given."""
        return [TriedModel(**row) for row in self._record.get("tried", [])]

    @property
    def verdicts(self) -> list[str]:
        """Findings on the fit, the most important first."""
        return list(self._record["verdicts"])

    @property
    def reduced_chi_squared(self) -> float:
        """Squared residuals over squared noise per degree of freedom: about 1 if the cell can follow the curve."""
        return float(self._record["reduced_chi_squared"])

    @cached_property
    def correlations(self) -> NDArray[np.float64] | None:
        """Correlations of the parameters, in their order; None if one of them has no curvature."""
        rows = self._record["correlations"]
        return None if rows is None else np.array(rows, dtype=np.float64)

    @cached_property
    def curves(self) -> list[FittedCurve]:
        """Each curve with the fitted one: first the unloaded one, then those under known loads."""
        return [
            FittedCurve(
                name=row["name"],
                unit=row["unit"],
                t_ms=np.array(row["times_ms"]),
                measured=np.array(row["measured"]),
                fitted=np.array(row["fitted"]),
                used=np.array(row["used"]),
                stimuli_ms=row["stimuli_ms"],
                noise=row["noise"],
                residual=row["residual"],
                misfit=row["misfit"],
                unexplained=row["unexplained"],
            )
            for row in self._record["curves"]
        ]

    @property
    def recorded_calcium(self) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
        """Times (ms on the clock of the curve) and calcium (uM) that was recorded with the curve; None without any."""
        row = self._record.get("calcium")
        return None if row is None else (np.array(row["times_ms"]), np.array(row["calcium_um"]))

    @cached_property
    def own_tension(self) -> OwnTension | None:
        """The tension that the curve asks for; None unless `model` is ``"given_tension"``."""
        row = self._record.get("own_tension")
        if row is None:
            return None
        beat = row["mean_beat"]
        names = {"t_ms": "times_ms", "tension_kpa": "tension_kpa", "standard_error_kpa": "standard_error_kpa"}
        return OwnTension(
            t_ms=np.array(row["times_ms"]),
            tension_kpa=np.array(row["tension_kpa"]),
            standard_deviation_kpa=np.array(row["standard_deviation_kpa"]),
            band_kpa=np.array(row["band_kpa"]),
            young_modulus_kpa=float(row["young_modulus_kpa"]),
            mean_beat=None if beat is None else {name: np.array(beat[key]) for name, key in names.items()},
        )

    def to_dataframe(self) -> Any:
        """Returns value, unit, interval and verdict of each parameter as a table; needs pandas.

        Returns
        -------
        pandas.DataFrame
            One row per parameter, indexed by its name.
        """
        import pandas

        rows = [
            (one.value, one.unit, one.interval[0], one.interval[1], one.standard_deviation, one.verdict)
            for one in self.parameters.values()
        ]
        columns = ["value", "unit", "from", "to", "standard_deviation", "verdict"]
        return pandas.DataFrame(rows, columns=columns, index=pandas.Index(list(self.parameters), name="parameter"))

    def plot(self, axes: Any = None) -> Any:
        """Draws the measured and fitted curve, and the residuals below; needs matplotlib. A fit that fails says so.

        Parameters
        ----------
        axes : sequence of two matplotlib axes, or None
            Axes on which to draw the first curve; None creates a figure.

        Returns
        -------
        array of matplotlib.axes.Axes
            The two axes.
        """
        if axes is None:
            from matplotlib import pyplot

            _, axes = pyplot.subplots(
                2, 1, sharex=True, figsize=(5.5, 4.5), height_ratios=[3, 1], layout="constrained"
            )
        curve = self.curves[0]
        above, below = axes
        left = curve.measured - curve.fitted
        for used, colour in ((curve.used, "#4d4d4d"), (~curve.used, "#b5532a")):
            above.plot(curve.t_ms[used], curve.measured[used], ".", ms=4, color=colour)
            below.plot(curve.t_ms[used], left[used], ".", ms=3, color=colour)
        above.plot(curve.t_ms, curve.fitted, color="#2a6099")
        reach = 1.1 * float(np.max(np.abs(left[curve.used]), initial=curve.noise))
        below.axhspan(-curve.noise, curve.noise, color="#2a6099", alpha=0.15, lw=0)
        below.set_ylim(-reach, reach)
        if self.verdict == "does-not-fit":
            above.fill_between(curve.t_ms, curve.measured, curve.fitted, color="#b5532a", alpha=0.25, lw=0)
            above.set_title("The model does not fit", color="#b5532a")
        unit = f" ({curve.unit})" if curve.unit else ""
        above.set_ylabel(f"{curve.name}{unit}")
        below.set_ylabel(f"Residual{unit}")
        below.set_xlabel("Time (ms)")
        for one in axes:
            one.spines[["top", "right"]].set_visible(False)
        return axes

    def simulate(self, *, threads: int | None = None, progress: Progress = None) -> Beat:
        """Simulates the fitted cell: the run of `run_file`.

        Parameters
        ----------
        threads : int or None
            Threads of the run; None chooses their number by the size of the mesh.
        progress : callable, bool or None
            As in `myospring.simulate`.

        Returns
        -------
        Beat
            The beat.

        Raises
        ------
        SimulationError
            A run that stopped before its end.
        """
        own, calcium = self.own_tension, self.recorded_calcium
        if own is not None:
            key, header, rows = "tension", "t_ms,tension_kPa", np.c_[own.t_ms, own.tension_kpa]
        elif calcium is not None:
            key, header, rows = "calcium", "t_ms,calcium_uM", np.c_[calcium[0] - calcium[0][0], calcium[1]]
        else:
            return ended(Beat(self.cell, _native.repeat(self.cell._native, self.run_file, threads, heard(progress))))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, f"{key}.csv")
            np.savetxt(path, rows, fmt="%.17g", delimiter=",", header=header, comments="")
            text = self.run_file.replace(f'{key} = "{key}.csv"', f"{key} = {json.dumps(path.as_posix())}")
            return ended(Beat(self.cell, _native.repeat(self.cell._native, text, threads, heard(progress))))

    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Writes what ``myospring fit`` writes of a film: numbers, curves, run file, figures, report, map and track.

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
        ValueError
            The fit is of a curve, not of a film, or it was pickled.
        """
        if self._native is None:
            raise ValueError(
                "only a fit of a film is saved, by the process that made it; of others `run_file` repeats the beat, and "
                "simulate().save(folder) writes it"
            )
        return Path(self._native.save(os.fspath(folder), force))

    def __repr__(self) -> str:
        numbers = ", ".join(f"{name} {self._amount(one)}" for name, one in self.parameters.items())
        return f"<myospring.Fit of {self.name}, {self.model}, {self.verdict}: {numbers}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{name}</td><td>{html.escape(self._amount(one))}</td><td>{html.escape(one.verdict)}</td></tr>"
            for name, one in self.parameters.items()
        )
        words = "".join(f"<p>{html.escape(text)}</p>" for text in self.verdicts)
        return f"<div><b>Fit of {html.escape(self.name)}: {self.verdict}</b><table>{rows}</table>{words}</div>"

    def _amount(self, one: Estimate) -> str:
        low, high = ("..." if end is None else f"{end:.4g}" for end in one.interval)
        interval = "" if self.verdict == "does-not-fit" else f" ({low} to {high})"
        unit = f" {one.unit}" if one.unit else ""
        return f"{one.value:.4g}{interval}{unit}"

    def __reduce__(self) -> tuple[Any, ...]:
        return Fit, (self.cell, self.name, self._text, self.run_file, self.notes)


# What parameters that are no cell model's are held by, and those of models that are sought unless others are named.
_OF_RUN = {"tension_over_stiffness": "peak_tension_kpa (or T_ref)", "young_modulus": "young_modulus_kpa"}
_USUAL = ("c_0", "k_ws")


def asked_and_given(
    function: str,
    free: Sequence[str] | None,
    fix: Sequence[str] | Mapping[str, float | str] | None,
    bounds: Mapping[str, tuple[float, float]] | None,
    starts: int,
    seed: int,
    stimulus_times_ms: Sequence[float] | None,
    peak_shortening_pct: float | None,
    settings: dict[str, Any],
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Returns the parameters to fit, and the settings of the run by key."""
    if starts < 1:
        raise ValueError(f"starts = {starts} is below 1")
    if starts > 10_000:
        raise ValueError(f"starts = {starts} is above 10000; tens of starts find what there is to find")
    if not 0 <= seed < 2**64:
        raise ValueError(f"seed = {seed} is outside its bounds, 0 to 2**64 - 1")
    names = list(free or [])
    held = dict(fix) if isinstance(fix, Mapping) else {}
    for name in held:
        if name in _OF_RUN:
            raise ValueError(f"fix: {name} is held at what {_OF_RUN[name]} says; name it in a list")
        if name in names:
            raise ValueError(f"{name} is free and fixed at once")
    fixed = [name for name in held if name in _USUAL and not names] if isinstance(fix, Mapping) else list(fix or [])
    asked = {
        "free": names,
        "fix": fixed,
        "bounds": [(name, (float(low), float(high))) for name, (low, high) in (bounds or {}).items()],
        "starts": starts,
        "seed": seed,
        "peak_shortening_pct": None if peak_shortening_pct is None else float(peak_shortening_pct),
        "stimulus_times_ms": None if stimulus_times_ms is None else [float(time) for time in stimulus_times_ms],
    }
    settings.setdefault("integrator", "quasi-static")
    if held:
        settings["parameters"] = {**(settings.get("parameters") or {}), **held}
    # A model that is named is meant, also if it is the default of a beat.
    return asked, given_of_beat(function, settings, override=True)


def fit(
    curve: Curve | None = None,
    cell: Cell | None = None,
    *,
    film: str | PathLike[str] | ArrayLike | None = None,
    free: Sequence[str] | None = None,
    fix: Sequence[str] | Mapping[str, float | str] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    loaded: Mapping[float, Curve] | None = None,
    traction: Curve | Mapping[float, Curve] | None = None,
    traction_error: float = 0.05,
    recorded_calcium: Curve | None = None,
    calcium_rest_um: float | None = None,
    calcium_peak_um: float | None = None,
    stimulus_times_ms: Sequence[float] | None = None,
    peak_shortening_pct: float | None = None,
    starts: int = 8,
    seed: int = 1,
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
    threads: int | None = None,
    progress: Progress = None,
    **settings: Unpack[PictureSettings],
) -> Fit:
    """Fits a cell's own parameters to its measured curve, with confidence intervals, as ``myospring fit`` does.

    Parameters
    ----------
    curve : path, or times and values
        A table of one curve, as laboratory programs export it; or two arrays, times in ms and values. None: `film` gives
        it.
    cell : Cell or None
        The cell's shape; None: the built-in one, or that of the film.
    film : path, array_like of shape (frames, rows, columns), or None
        A film, a folder of its frames, or grey values, instead of a curve: its cell is followed, fitted to its own stretch (`columns`
        names another curve of ``track.csv``), compared with the fitted one, and mapped (`Fit.tension_map`).
    free : sequence of str or None
        Parameters to fit besides tension over stiffness, delays and the length at rest; None: those that a curve
        determines, ``c_0`` or ``k_ws``.
    fix : sequence of str, mapping or None
        Parameters that are not fitted; a mapping gives parameters of the cell model other values.
    bounds : mapping or None
        Lowest and highest value of a parameter in its unit; by default a factor of 4 in both directions.
    loaded : mapping or None
        Curves of the same cell between two springs, such as carbon fibres, by the stiffness of each spring, nN/um.
    traction : path, times and values, mapping, or None
        Force of the same cell on a gel, which gives tension and stiffness in kPa: a table (``traction.csv``), or times in
        ms and the sum of the absolute forces in nN; with `film` also a film of the beads in the gel, in the same window. It was
        measured on the gel of the settings (``support="gel"``); a mapping gives
        curves by Young's modulus of their gel, kPa.
    traction_error : float
        Relative standard deviation of the scale of these forces, apart from noise. That of the gel's modulus does not count, since it
        scales every answer in kPa alike.
    recorded_calcium : path, times and values, or None
        Calcium that was recorded together with the curve, on its clock: a table, or times in ms and calcium in uM. It drives
        ``land_2017``, beat for beat. None: a column of calcium in the table of the curve, if there is one.
    calcium_rest_um, calcium_peak_um : float or None
        Calcium at rest and at the peak of its mean beat, uM, where the recording is a ratio or a fluorescence.
    stimulus_times_ms : sequence of float or None
        Times at which the cell was stimulated; None finds the beats in the curve.
    peak_shortening_pct : float or None
        How far the cell shortens at the peak of its beat, %, for a curve in arbitrary units (kind ``"contraction"``), which
        does not say so; tensions depend on it. None: only the timing of such a curve is fitted.
    starts, seed : int
        Number of starts of the search, and the seed of their positions: thresholds in the equations make local minima.
    columns : sequence of str
        Column of a table with several curves, by name or number. In a table with several kinds of curve, such as
        ``track.csv``, the stretch is used, or else the length; `Fit.notes` states which.
    time, time_unit : str or None
        Column of times and its unit, if the table does not state them.
    kind, unit : str or None
        Kind of the values (``"length"``, ``"sarcomere-length"``, ``"normalised-length"``, ``"shortening"``,
        ``"contraction"``) and their unit. None: what the table states, and for arrays a length in um.
    frame_rate_per_s : float or None
        Frame rate of a table without times, frames per second.
    pixel_size_um : float or None
        Pixel size in um, for lengths in pixels.
    sheets : sequence of str
        Sheets of a workbook (.xlsx), by name or number; by default all.
    from_ms, until_ms : float or None
        Start and end of the part of the recording to use, ms on its own clock.
    ignore_marks : bool
        Whether to ignore the marks of a pacer in a table, which otherwise are the stimuli.
    mean, skip_gaps : bool
        Whether to use the mean of all columns; whether to skip frames without a number.
    threads : int or None
        Number of starts and profiles computed at a time; None: the number of cores. It does not change the results.
    progress : callable, bool or None
        As in `track`.
    **settings
        Known properties of the cell: the settings of `simulate`, with its names, units and defaults. Without ``model`` every
        model whose fit takes seconds is tried, and the simplest that follows the curve is taken (`Fit.tried`); if there is
        none, the tension that the curve needs. For a film also those of `Cell.from_image`, which find the cell in the frame at rest; ``outline`` says which, where
        there are several.

    Returns
    -------
    Fit
        Parameters with their intervals, curves, and the run of the fitted cell.

    Raises
    ------
    UnknownNameError
        A parameter or a setting that does not exist.
    ValueError
        A table or a curve that cannot be fitted, with the reason.
    KeyboardInterrupt
        Ctrl-C, within a second.

    Examples
    --------
    >>> import myospring
    >>> cell = myospring.Cell.builtin(spacing_um=5)
    >>> beat = myospring.simulate(cell, peak_tension_kpa=40, integrator="quasi-static")
    >>> found = myospring.fit((beat.t_ms, beat.length_um), cell, stimulus_times_ms=[50.0])
    >>> estimate = found.parameters["tension_over_stiffness"]
    >>> bool(abs(estimate.value / (40 / 308) - 1) < 0.01), estimate.verdict
    (True, 'determined')
    """
    reading = Reading.among(locals())
    named: dict[str, Any] = dict(settings)
    of_film = {} if film is None else {name: named.pop(name) for name in list(named) if name not in BEAT_KEYS}
    asked, given = asked_and_given(
        "fit", free, fix, bounds, starts, seed, stimulus_times_ms, peak_shortening_pct, named
    )
    if film is not None:
        if not (curve is None and cell is None and not loaded and recorded_calcium is None):
            raise ValueError("film gives the curve and the cell; leave curve, cell, loaded and recorded_calcium out")
        given |= given_of_picture("fit", pixel_size_um, of_film)
        pulls: list[tuple[float | None, str]] = []
        for modulus, force in _by_modulus(traction).items():
            if not isinstance(force, (str, PathLike)):
                raise ValueError("traction of a film is a table or a film of beads; give its path")
            pulls.append((modulus, os.fspath(force)))
        with film_path(film) as path:
            native = _native.fit_film(
                path, given, reading.by_name(), asked, (pulls, traction_error), threads, heard(progress)
            )
        found = Fit._of_film(native)
        warn([*found.notes, *found.verdicts, *(found.tension_map.warnings if found.tension_map else ())])
        return found
    if curve is None:
        raise ValueError("there is nothing to fit to: give a curve, or a film")
    one, notes = _single(reading, curve, "curve")
    between = []
    for stiffness, other in (loaded or {}).items():
        held_curve, more = _single(reading, other, "loaded")
        between.append((float(stiffness), held_curve))
        notes += more
    forces = []
    for modulus, force in _by_modulus(traction).items():
        own = replace(reading, columns=(), kind="force", unit="nN", mean=False)
        if isinstance(force, (str, PathLike)) and _native.is_film(os.fspath(force)):
            name = os.fspath(force)
            raise ValueError(
                f"it is not known where in {name} the cell is, so its force is not either; give film= in the same window, or the "
                f"traction.csv that myospring.traction({name!r}, cell=...).save(...) writes"
            )
        own = replace(own, kind=None, unit=None) if isinstance(force, (str, PathLike)) else own
        forces.append((modulus, own.curves(force, "traction")[0]))
    cell = cell_of(cell)
    calcium = _calcium(reading, curve, one, recorded_calcium, [calcium_rest_um, calcium_peak_um])
    fitter = _native.Fitter(cell._native, given, asked, between, (forces, traction_error), calcium)
    notes += fitter.notes
    text, run_file = fitter.fit(one, threads, heard(progress))
    found = Fit(cell, one[0], text, run_file, notes)
    warn([*notes, *found.verdicts])
    return found


def _by_modulus(traction: Curve | Mapping[float, Curve] | None) -> dict[float | None, Curve]:
    """Returns curves by Young's modulus of their gel, kPa; None: the gel of the settings."""
    found: dict[float | None, Curve] = {}
    if isinstance(traction, Mapping):
        for modulus, force in traction.items():
            found[modulus] = force
    elif traction is not None:
        found[None] = traction
    return found


def _calcium(
    reading: Reading, curve: Curve, one: Read, recorded: Curve | None, scale: list[float | None]
) -> tuple[str | None, list[Read], Read, list[float | None]] | None:
    """Returns the calcium that was recorded together with a curve, as the Rust part expects it."""
    source = curve if recorded is None else recorded
    if isinstance(source, (str, PathLike)):
        plain = replace(reading, columns=(), kind=None, unit=None, mean=False)
        path = None if recorded is None else os.fspath(source)
        return path, _native.read_calcium(os.fspath(source), plain.by_name()), one, scale
    if recorded is None:
        return None
    kind = "calcium" if scale == [None, None] else "fluorescence"
    arrays = replace(reading, kind=kind, unit="uM" if kind == "calcium" else "a.u.")
    return "recorded_calcium", arrays.curves(recorded, "recorded_calcium")[0], one, scale


def _single(reading: Reading, curve: Curve, name: str) -> tuple[Read, list[str]]:
    curves, notes = reading.curves(curve, name)
    if len(curves) != 1:
        names = ", ".join(one[0] for one in curves)
        raise ValueError(
            f"`{curve}` has {len(curves)} curves ({names}); columns chooses one, mean=True takes their mean, "
            "fit_many fits each"
        )
    return curves[0], notes
