"""Fits several cells, each to its own curve, here or on any executor."""

from __future__ import annotations

import hashlib
import os
import pickle
import threading
import time
from collections import OrderedDict
from concurrent.futures import CancelledError, Executor
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterator, Mapping, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from myospring import _native
from myospring._cell import Cell, cell_of
from myospring._engine import Answer, Run
from myospring._errors import warn
from myospring._fit import Fit, asked_and_given
from myospring._functions import BeatSettings
from myospring._progress import Progress, heard
from myospring._reading import Curve, Read, Reading

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Fits(Sequence[Union[Fit, None]]):
    """Fits of several cells in the order of the curves, None for a cell that was not fitted; the result of `fit_many`.

    Attributes
    ----------
    names : list of str
        Names of the curves.
    reasons : list of str or None
        Why a cell was not fitted, or None.
    """

    def __init__(self, names: list[str], fits: list[Fit | None], reasons: list[str | None]) -> None:
        self.names, self._fits, self.reasons = names, fits, reasons

    def __len__(self) -> int:
        return len(self._fits)

    def __getitem__(self, place: Any) -> Any:
        return self._fits[place]

    def __iter__(self) -> Iterator[Fit | None]:
        return iter(self._fits)

    def to_dataframe(self) -> Any:
        """Returns one row per cell; needs pandas.

        Returns
        -------
        pandas.DataFrame
            Columns: ``model``, each parameter with the ends of its interval and its verdict, then
            ``reduced_chi_squared``, ``verdict``, ``status`` and ``reason``. The name of the curve is the index.
        """
        import pandas

        rows: list[dict[str, Any]] = []
        for fit, reason in zip(self._fits, self.reasons):
            row: dict[str, Any] = {}
            if fit is not None:
                row["model"] = fit.model
                for name, one in fit.parameters.items():
                    row[name] = one.value
                    row[f"{name}_from"], row[f"{name}_to"] = one.interval
                    row[f"{name}_verdict"] = one.verdict
                row["reduced_chi_squared"] = fit.reduced_chi_squared
                row["verdict"] = fit.verdict
            row["status"] = "ok" if reason is None else "failed"
            row["reason"] = reason
            rows.append(row)
        table = pandas.DataFrame(rows, index=pandas.Index(self.names, name="cell"))
        last = ["reduced_chi_squared", "verdict", "status", "reason"]
        return table[[name for name in table if name not in last] + [name for name in last if name in table]]

    def __repr__(self) -> str:
        failed = sum(reason is not None for reason in self.reasons)
        return f"<myospring.Fits: {len(self)} cells, {failed} failed>"


# Result of a worker for each of its cells: a fit and its run file, or the reason for its failure.
_Outcome = tuple[Union[str, None], Union[str, None], Union[str, None]]

_made: OrderedDict[str, _native.Fitter] = OrderedDict()
_making = threading.Lock()


def work(
    key: str, head: bytes, numbers: NDArray[np.uint64], curves: list[Read], threads: int, _try: int
) -> tuple[NDArray[np.uint64], list[_Outcome], float]:
    """Fits some cells of one shape, in a worker; the shape's equilibria are solved once per process."""
    begun = time.monotonic()
    with _making:
        fitter = _made.pop(key, None)
        if fitter is None:
            cell, given, asked = pickle.loads(head)
            fitter = _native.Fitter(cell._native, given, asked, [], ([], 0.0), None)
        _made[key] = fitter
        while len(_made) > 4:
            _made.popitem(last=False)
    return numbers, [_outcome(fitter, curve, threads) for curve in curves], time.monotonic() - begun


def _outcome(fitter: _native.Fitter, curve: Read, threads: int) -> _Outcome:
    name, kind, unit, times, values, stimuli = curve
    times, values = (np.require(array, requirements=["C", "A"]) for array in (times, values))
    own = (name, kind, unit, times, values, stimuli)
    try:
        text, run_file = fitter.fit(own, threads, None)
    except ValueError as error:
        return None, None, str(error)
    return text, run_file, None


@dataclass
class _Tasks:
    """Cells to fit, one per member."""

    heads: list[tuple[str, bytes]]
    curves: list[Read]
    outcomes: dict[int, _Outcome] = field(default_factory=dict)
    kind: str = "fit"
    stopped: bool = False

    @property
    def size(self) -> int:
        return len(self.curves)

    def left(self) -> NDArray[np.uint64]:
        return np.arange(self.size, dtype=np.uint64)

    def work(self, numbers: NDArray[np.uint64]) -> Answer:
        if self.stopped:
            raise CancelledError
        call, *arguments = self.call(numbers, 1, 0)
        answer: Answer = call(*arguments)
        return answer

    def stop(self) -> None:
        """Ends the fits that this process works on."""
        self.stopped = True
        with _making:
            for key, _ in self.heads:
                fitter = _made.pop(key, None)
                if fitter is not None:
                    fitter.stop()

    def call(self, numbers: NDArray[np.uint64], threads: int, tries: int) -> tuple[Any, ...]:
        # The cells of a batch have one shape; others are returned as not finished.
        key, head = self.heads[int(numbers[0])]
        same = np.array([number for number in numbers if self.heads[int(number)][0] == key], dtype=np.uint64)
        curves = [self.curves[int(number)] for number in same]
        return work, key, head, same, curves, threads, tries

    def take(self, answer: Answer) -> None:
        numbers, outcomes, _ = answer
        self.outcomes.update((int(number), outcome) for number, outcome in zip(numbers, outcomes))

    def lose(self, numbers: NDArray[np.uint64], reason: str) -> None:
        self.outcomes.update((int(number), (None, None, reason)) for number in numbers)


def fit_many(
    curves: Curve | Sequence[str | PathLike[str]] | Mapping[str, Curve],
    cell: Cell | Sequence[Cell] | None = None,
    executor: Executor | Callable[[], Executor] | None = None,
    *,
    free: Sequence[str] | None = None,
    fix: Sequence[str] | Mapping[str, float | str] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
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
    skip_gaps: bool = False,
    threads: int | None = None,
    batch_seconds: float = 2.0,
    tries: int = 3,
    progress: Progress = None,
    **settings: Unpack[BeatSettings],
) -> Fits:
    """Fits several cells, each to its own curve, here or on any executor; a cell that cannot be fitted becomes a row.

    A fit depends only on its curve and its cell: batches and workers do not change it, and `fit` returns the same.

    Parameters
    ----------
    curves : path, sequence of paths, or mapping of name to curve
        A table with one column per cell, several tables, or curves by name: tables, or times in ms and values.
    cell : Cell, sequence of Cells or None
        Shape of all cells, or of each cell in the order of the curves; None: the built-in one.
    executor : concurrent.futures.Executor, function that makes one, or None
        Executor of the work, as in `run_study`; None: threads of this process.
    free, fix, bounds, stimulus_times_ms, peak_shortening_pct, starts, seed
        As in `fit`, for all cells.
    columns, time, kind, unit, time_unit, frame_rate_per_s, pixel_size_um, sheets, skip_gaps
        How tables are read, as in `fit`.
    from_ms, until_ms, ignore_marks
        The part of each recording to use, and whether to ignore marks of a pacer, as in `fit`.
    threads : int or None
        Without an executor, number of cells fitted at a time, None: the number of cores. With one, threads per cell,
        None: one.
    batch_seconds, tries, progress
        As in `run_study`, for cells instead of members.
    **settings
        Known properties of the cells: the settings of `simulate`; without ``model`` each cell has the simplest that follows
        its curve, as in `fit`.

    Returns
    -------
    Fits
        A fit for each curve, or the reason why it failed.

    Raises
    ------
    UnknownNameError
        A parameter or a setting that does not exist.
    ValueError
        A table that cannot be read, or different numbers of cells and curves.
    RuntimeError
        Workers that die with every task.
    KeyboardInterrupt
        Ctrl-C.

    Examples
    --------
    >>> import myospring, numpy
    >>> cell = myospring.Cell.builtin(spacing_um=5)
    >>> beat = myospring.simulate(cell, integrator="quasi-static")
    >>> curves = {"own": (beat.t_ms, beat.length_um), "still": (beat.t_ms, numpy.full(len(beat.t_ms), 140.0))}
    >>> fits = myospring.fit_many(curves, cell, stimulus_times_ms=[50.0], starts=2, progress=False)
    >>> fits, [reason is None for reason in fits.reasons]
    (<myospring.Fits: 2 cells, 1 failed>, [True, False])
    """
    reading = Reading.among(locals())
    if not 0.5 <= batch_seconds <= 30:
        raise ValueError(f"batch_seconds = {batch_seconds} is outside its bounds, 0.5 to 30 s")
    if tries < 1:
        raise ValueError(f"tries = {tries} is below 1")
    asked, given = asked_and_given(
        "fit_many", free, fix, bounds, starts, seed, stimulus_times_ms, peak_shortening_pct, dict(settings)
    )
    read, notes = _all(reading, curves)
    if cell is None or isinstance(cell, (Cell, str, PathLike)):
        cells = [cell_of(cell)] * len(read)
    else:
        cells = [cell_of(one) for one in cell]
    if len(cells) != len(read):
        raise ValueError(f"there are {len(read)} curves and {len(cells)} cells; give one cell, or one for each curve")
    heads: dict[int, tuple[str, bytes]] = {}
    for one in cells:
        if id(one) not in heads:
            # Invalid settings are an error here, not in each worker.
            _native.Fitter(one._native, given, asked, [], ([], 0.0), None)
            head = pickle.dumps((one, given, asked))
            heads[id(one)] = (hashlib.sha256(head).hexdigest(), head)
    tasks = _Tasks([heads[id(one)] for one in cells], read)
    run = Run(tasks, threads or 1, batch_seconds, tries, heard(progress, on_terminal=True))
    if executor is None:
        cores = os.cpu_count() or 1
        run.here(min(threads or cores, cores))
    else:
        run.on(executor)
    fits: list[Fit | None] = []
    reasons: list[str | None] = []
    for number, (one, curve) in enumerate(zip(cells, read)):
        text, run_file, reason = tasks.outcomes[number]
        none = text is None or run_file is None
        fits.append(None if none else Fit(one, curve[0], str(text), str(run_file), notes[number]))
        reasons.append(reason)
    found = Fits([curve[0] for curve in read], fits, reasons)
    failed = [f"{name}: {reason}" for name, reason in zip(found.names, reasons) if reason is not None]
    if failed:
        warn([f"{len(failed)} of {len(found)} cells were not fitted, the first, {failed[0]}; `reasons` has all"])
    read_this = [f"{fit.name}: {fit.verdicts[0]}" for fit in fits if fit is not None and fit.verdicts]
    if read_this:
        warn([f"{len(read_this)} of {len(found)} fits have verdicts, the first, {read_this[0]}; `verdicts` has all"])
    return found


def _all(
    reading: Reading, curves: Curve | Sequence[str | PathLike[str]] | Mapping[str, Curve]
) -> tuple[list[Read], list[list[str]]]:
    """Returns every curve, and what was assumed about each."""
    if isinstance(curves, (str, PathLike)):
        named: list[tuple[str, Curve]] = [("", curves)]
    elif isinstance(curves, Mapping):
        named = list(curves.items())
    elif isinstance(curves, tuple):
        raise TypeError("curves are a path, several paths, or a mapping of name to curve; fit takes times and values")
    else:
        named = [(Path(path).stem, path) for path in curves]
    read: list[Read] = []
    notes: list[list[str]] = []
    for name, curve in named:
        found, more = reading.curves(curve, name)
        for own, kind, unit, times, values, stimuli in found:
            label = own if not name or name == own else name if len(found) == 1 else f"{name} {own}"
            read.append((label, kind, unit, times, values, stimuli))
            notes.append(more)
    return read, notes
