"""Studies: many runs with different parameter values, here or on any executor."""

from __future__ import annotations

import html
import json
import logging
import os
from concurrent.futures import Executor
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._engine import Run, StudyTasks
from myospring._errors import warn
from myospring._given import floats
from myospring._progress import Progress, heard

ROWS = "rows.csv"


class Index(NamedTuple):
    """An estimated index.

    Attributes
    ----------
    value : float
        The estimate.
    confidence : float
        Half of its 95 % confidence interval, by bootstrap.
    """

    value: float
    confidence: float


class Sobol(NamedTuple):
    """Share of a metric's variance that a parameter causes.

    Attributes
    ----------
    first : Index
        Share of the parameter alone.
    total : Index
        Share including all its interactions.
    """

    first: Index
    total: Index


class Morris(NamedTuple):
    """The elementary effects of a parameter, in the metric's unit over the parameter's range.

    Attributes
    ----------
    mean_size : Index
        Mean of their sizes.
    mean, spread : float
        Mean and standard deviation.
    """

    mean_size: Index
    mean: float
    spread: float


class StudyResult:
    """The result of `run_study`. It can be pickled."""

    def __init__(self, native: _native.Study) -> None:
        self._native = native

    @cached_property
    def _table(self) -> tuple[NDArray[np.float64], list[str], list[str | None], NDArray[np.bool_]]:
        metrics, status, reasons, kept = self._native.table()
        metrics.flags.writeable = kept.flags.writeable = False
        return metrics, status, reasons, kept

    @property
    def title(self) -> str:
        """Title of the study."""
        return self._native.title

    @cached_property
    def names(self) -> list[str]:
        """Names of the varied parameters: the columns of `values`."""
        return [name for name, _, _ in self._native.varied]

    @cached_property
    def metric_names(self) -> list[str]:
        """Names of the columns of `metrics`."""
        return [name for name, _, _ in self._native.metrics]

    @cached_property
    def units(self) -> dict[str, str]:
        """Units of parameters and metrics by name; empty for a pure number."""
        metrics = {name: unit for name, unit, _ in self._native.metrics}
        return {**{name: unit for name, _, unit in self._native.varied}, **metrics}

    @cached_property
    def usual(self) -> dict[str, float]:
        """Metrics of the run with unchanged parameters; NaN if its curves do not show one."""
        return {name: np.nan if value is None else value for name, _, value in self._native.metrics}

    @cached_property
    def values(self) -> NDArray[np.float64]:
        """Parameter values of each member, of shape (members, parameters)."""
        values = self._native.values()
        values.flags.writeable = False
        return values

    @property
    def metrics(self) -> NDArray[np.float64]:
        """Metrics of each member, of shape (members, metrics); NaN if it failed or does not show one."""
        return self._table[0]

    @property
    def status(self) -> list[str]:
        """Status of each member: ``"ok"`` or ``"failed"``."""
        return self._table[1]

    @property
    def reasons(self) -> list[str | None]:
        """Why a member failed, or None."""
        return self._table[2]

    @property
    def kept(self) -> NDArray[np.bool_]:
        """Whether a member succeeded and its metrics lie within every band of ``[keep]``, of shape (members,)."""
        return self._table[3]

    @cached_property
    def _found(self) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = json.loads(self._native.sensitivity())
        return found

    def _name(self, key: str) -> str:
        return next(name for name, known, _ in self._native.varied if known == key)

    @cached_property
    def sensitivity(self) -> dict[str, dict[str, Sobol | Morris]]:
        """How much each metric depends on each parameter, the most important first: ``sensitivity[metric][parameter]``.

        Empty if the sampler is not suitable. Failed members are skipped with their whole base point or trajectory, and
        so is a metric that is equal for all members.
        """

        def of(row: dict[str, Any]) -> Sobol | Morris:
            if "total" in row:
                return Sobol(Index(**row["first"]), Index(**row["total"]))
            return Morris(Index(**row["mean_size"]), row["mean"], row["spread"])

        return {
            one["metric"]: {self._name(row["parameter"]): of(row) for row in one["parameters"]}
            for one in self._found
        }

    @cached_property
    def interactions(self) -> dict[str, dict[tuple[str, str], Index]]:
        """Share that two parameters cause together beyond the shares of each alone, for a sampler with ``pairs =
        true``."""
        return {
            one["metric"]: {(self._name(a), self._name(b)): Index(**index) for (a, b), index in one["pairs"]}
            for one in self._found
            if one.get("pairs")
        }

    def to_dataframe(self) -> Any:
        """Returns values, metrics, status and reason of each member as a table; needs pandas.

        Returns
        -------
        pandas.DataFrame
            One row per member, indexed by its number.
        """
        import pandas

        columns: dict[str, Any] = dict(zip(self.names, self.values.T))
        columns.update(zip(self.metric_names, self.metrics.T))
        columns.update(kept=self.kept, status=self.status, reason=self.reasons)
        return pandas.DataFrame(columns, index=pandas.RangeIndex(1, self._native.size + 1, name="member"))

    def save(self, folder: str | PathLike[str]) -> Path:
        """Writes the files of ``myospring study run``: ``members.csv``, ``members.parquet``, ``study.json``, figures.

        Parameters
        ----------
        folder : path
            Created if it does not exist; files of an earlier study in it are replaced if they were not changed since.

        Returns
        -------
        pathlib.Path
            The folder.

        Raises
        ------
        OSError
            The folder cannot be written to, or another file has the name of a result.
        """
        warn(self._native.save(os.fspath(folder)))
        return Path(folder)

    def _in_words(self) -> str:
        failed = len(self.status) - self.status.count("ok")
        text = f"{len(self.status)} members"
        text += f", {failed} failed" if failed else ""
        return text + (f", {self.kept.sum()} kept" if self.kept.sum() < len(self.status) - failed else "")

    def __repr__(self) -> str:
        return f"<myospring.StudyResult: {self._in_words()}; {', '.join(self.metric_names)}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{metric.replace('_', ' ')}</td><td>{name}</td><td>{index.value:.3f} &plusmn; "
            f"{index.confidence:.3f}</td></tr>"
            for metric, of in self.sensitivity.items()
            for name, index in [
                (name, one.total if isinstance(one, Sobol) else one.mean_size) for name, one in list(of.items())[:3]
            ]
        )
        return f"<div><b>{html.escape(self.title or 'Study')}</b>: {self._in_words()}<table>{rows}</table></div>"

    def __reduce__(self) -> tuple[Any, ...]:
        numbers = np.arange(1, self._native.size + 1, dtype=np.uint64)
        return _restored, (self._native.text, self._native.files, numbers, self.metrics, self.reasons)


def _restored(
    text: str,
    files: dict[str, bytes],
    numbers: NDArray[np.uint64],
    metrics: NDArray[np.float64],
    reasons: list[str | None],
) -> StudyResult:
    native = _native.Study(text, files, "", None, False, True, None)
    native.note(numbers, metrics, reasons, np.empty((len(numbers), 0), dtype=np.float32))
    return StudyResult(native)


def _read(study: str | PathLike[str] | Mapping[str, Any]) -> tuple[str, str, str | None]:
    """Returns the text of a description, the folder of its files, and its own file if it has one."""
    if isinstance(study, Mapping):
        _check_finite(study, "")
        return _native.study_toml(json.dumps(study, default=_plain)), "", None
    if isinstance(study, str) and ("\n" in study or "=" in study):
        return study, "", None
    path = Path(study)
    return path.read_text(encoding="utf-8"), os.fspath(path.parent), os.fspath(path)


def _check_finite(value: Any, place: str) -> None:
    """Refuses numbers that are not finite, with their key."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            _check_finite(inner, f"{place}.{key}" if place else str(key))
    elif isinstance(value, (list, tuple)):
        for number, inner in enumerate(value, 1):
            _check_finite(inner, f"{place}, entry {number},")
    elif isinstance(value, (float, np.floating)) and not np.isfinite(value):
        raise ValueError(f"{place} is {value}; a study has finite numbers")


def _plain(value: Any) -> Any:
    """Converts numbers and arrays of NumPy, and paths, to JSON values."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    if isinstance(value, PathLike):
        return os.fspath(value)
    raise TypeError(f"a study has text, numbers, lists and tables, not {type(value).__name__}")


def _csv(rows: ArrayLike, names: Sequence[str] | None) -> bytes:
    """Returns rows as CSV, with every number to the last bit."""
    columns = getattr(rows, "columns", None)
    names = list(columns) if names is None and columns is not None else names
    matrix = floats(rows)
    if names is None or matrix.ndim != 2 or matrix.shape[1] != len(names):
        known = "no names" if names is None else f"{len(names)} names"
        raise ValueError(f"rows has the shape {matrix.shape} and {known}; give (N, K) with K names")
    lines = [",".join(names), *(",".join(map(repr, row)) for row in matrix.tolist())]
    return ("\n".join(lines) + "\n").encode()


def run_study(
    study: str | PathLike[str] | Mapping[str, Any],
    executor: Executor | Callable[[], Executor] | None = None,
    output: str | PathLike[str] | None = None,
    *,
    rows: ArrayLike | None = None,
    names: Sequence[str] | None = None,
    force: bool = False,
    threads: int | None = None,
    batch_seconds: float = 2.0,
    tries: int = 3,
    progress: Progress = None,
) -> StudyResult:
    """Runs or resumes a study, here or on any executor.

    The result of a member depends only on its values: batches, workers, interruptions and machines of one kind do not
    change a bit of it, and ``myospring study run`` returns the same.

    Parameters
    ----------
    study : path, str or mapping
        A description as ``myospring study init`` writes it: its file, its text (TOML), or a dict of the same tables.
        Files that it names are searched in the folder of its file, else in the current folder.
    executor : concurrent.futures.Executor, function that makes one, or None
        Executor of the work; None: threads of this process; otherwise for instance ``client.get_executor(pure=False)``
        of
        ``dask.distributed``, ``mpi4py.futures.MPIPoolExecutor()`` or ``concurrent.futures.ProcessPoolExecutor()``. A
        function creates another executor if one breaks; a ``ProcessPoolExecutor`` needs no function for that.
    output : path or None
        Folder of the results of ``myospring study run``. Finished members are recorded there from the start, so that
        the same call, or the program, resumes a study that was interrupted or killed. None writes nothing, and omits
        the curves.
    rows : array_like of shape (N, K) or None
        Your own members, one per row. The description then has neither ``[parameters]`` nor ``[sampling]``.
    names : sequence of K str or None
        Names of the columns of `rows`; a DataFrame has them already.
    force : bool
        Whether to start again in a folder with results. Refused if it contains files that no command wrote, or files
        changed since.
    threads : int or None
        Without an executor, number of members computed at a time, None: the number of cores. With one, threads per
        batch, None: one, for as many workers as there are cores; give all cores to a single worker on a machine.
    batch_seconds : float
        Intended duration of a batch, 0.5 to 30 s; the faster the members, the more a batch has.
    tries : int
        Number of attempts at a batch whose worker died before its members fail. Such failures are not recorded in
        `output`, so that the same call tries again.
    progress : callable, bool or None
        Called with ``("members", done, all)``; True draws a bar, None does so on a terminal, False shows nothing. What
        it raises ends the study.

    Returns
    -------
    StudyResult
        Values, metrics, status and reason of each member, and how much each metric depends on each parameter.

    Raises
    ------
    ValueError
        An invalid description, with the position of the error.
    UnknownNameError
        A parameter or a metric that does not exist.
    OSError
        An output folder that contains other files, that contains an input file of the study, or that cannot be written
        to.
    RuntimeError
        Workers that die with every task, or an executor that accepts no more work.
    KeyboardInterrupt
        Ctrl-C; without an executor within a second. Finished members are kept.

    Examples
    --------
    >>> import myospring
    >>> result = myospring.run_study({
    ...     "kind": "cell",
    ...     "parameters": {"tau_si": {"distribution": "uniform", "low": 0.99, "high": 1.01, "relative": True}},
    ...     "sampling": {"sampler": "latin-hypercube", "size": 8},
    ... })
    >>> result.values.shape, result.metrics.shape, set(result.status)
    ((8, 1), (8, 5), {'ok'})
    """
    if not 0.5 <= batch_seconds <= 30:
        raise ValueError(f"batch_seconds = {batch_seconds} is outside its bounds, 0.5 to 30 s")
    if tries < 1:
        raise ValueError(f"tries = {tries} is below 1")
    text, folder, description = _read(study)
    files: dict[str, bytes] = {}
    if rows is not None:
        files[ROWS] = _csv(rows, names)
        text = _native.with_rows(text, ROWS)
    results = None if output is None else os.fspath(output)
    native = _native.Study(text, files, folder, results, force, not isinstance(study, Mapping), description)
    try:
        if native.damaged:
            warn([f"the stored results of {native.damaged} members in {results} were changed or damaged; they are computed again"])
        if native.changed:
            warn([f"the study's parameters or sampling changed: {native.changed} stored members in {results} had other values; they are computed again"])
        done = native.size - len(native.left())
        if done:
            logging.getLogger("myospring").info("continuing: %d of %d members are done", done, native.size)
        run = Run(StudyTasks(native), threads or 1, batch_seconds, tries, heard(progress, on_terminal=True))
        if executor is None:
            cores = os.cpu_count() or 1
            run.here(min(threads or cores, cores))
        else:
            run.on(executor)
        result = StudyResult(native)
        if output is not None:
            result.save(output)
    finally:
        # An interpreter may keep a reference to an error, and with it to all of this.
        native.close()
    return result
