"""Many runs: from a matrix of parameters to a matrix of metrics."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Sequence, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._cell import Cell, cell_of
from myospring._errors import warn
from myospring._functions import BeatSettings
from myospring._given import floats
from myospring._lists import METRICS
from myospring._progress import Progress, heard
from myospring._settings import given_of_beat

if TYPE_CHECKING:
    from typing_extensions import Unpack


@overload
def simulate_batch(
    params: ArrayLike,
    names: Sequence[str],
    cell: Cell | None = None,
    *,
    metrics: Sequence[str] | None = None,
    threads: int | None = None,
    progress: Progress = None,
    return_reasons: Literal[False] = False,
    **settings: Unpack[BeatSettings],
) -> NDArray[np.float64]: ...
@overload
def simulate_batch(
    params: ArrayLike,
    names: Sequence[str],
    cell: Cell | None = None,
    *,
    metrics: Sequence[str] | None = None,
    threads: int | None = None,
    progress: Progress = None,
    return_reasons: Literal[True],
    **settings: Unpack[BeatSettings],
) -> tuple[NDArray[np.float64], list[str | None]]: ...
def simulate_batch(
    params: ArrayLike,
    names: Sequence[str],
    cell: Cell | None = None,
    *,
    metrics: Sequence[str] | None = None,
    threads: int | None = None,
    progress: Progress = None,
    return_reasons: bool = False,
    **settings: Any,
) -> NDArray[np.float64] | tuple[NDArray[np.float64], list[str | None]]:
    """Simulates a cell once for each row of a matrix.

    The mesh follows the tension along its equilibria (``integrator="quasi-static"``), unless another method is given.
    Members that differ only in the cell model share the mechanics. The metrics of a member do not depend, to the last bit, on the other members, their
    order or the number of threads.

    Parameters
    ----------
    params : array_like of shape (N, K)
        One member per row.
    names : sequence of K str
        Names of the columns: settings of `simulate` or of a built-in cell that are numbers, such as
        ``peak_tension_kpa``, or parameters of the cell model, such as ``tau_si``. Settings may be named as in a study,
        without the unit: ``peak_tension``.
    cell : Cell or None
        The cell; None: the built-in one.
    metrics : sequence of M str or None
        Names of `METRICS`; None: all. For several beats, the mean.
    threads : int or None
        Number of members computed at a time; None: the number of cores.
    progress : callable, bool or None
        As in `track`, called with ``("members", done, all)`` after each member.
    return_reasons : bool
        Whether to return why members failed.
    **settings
        Settings of all members: those of `simulate`, with its names, units and defaults except for the two integrators.

    Returns
    -------
    values : ndarray of shape (N, M)
        One row per member; the row of a failed member is NaN.
    reasons : list of N str or None
        Why a member failed, or None; only with ``return_reasons=True``. Without it, a warning states how many members
        failed, and why the first did.

    Raises
    ------
    UnknownNameError
        A column, a metric or a setting that does not exist.
    ValueError
        A matrix of the wrong shape, or an invalid shared setting.
    KeyboardInterrupt
        Ctrl-C, within a second.

    Examples
    --------
    >>> import myospring
    >>> values = myospring.simulate_batch([[30.0], [60.0]], ["peak_tension_kpa"], metrics=["peak_shortening"])
    >>> values.shape, bool(values[0, 0] < values[1, 0])
    ((2, 1), True)
    """
    matrix = floats(params)
    if matrix.ndim != 2 or matrix.shape[1] != len(names):
        raise ValueError(f"params has the shape {matrix.shape}; with {len(names)} names it must be (N, {len(names)})")
    if len(set(names)) != len(names):
        raise ValueError(f"names has one name twice: {', '.join(names)}")
    given = given_of_beat("simulate_batch", settings)
    wanted = list(METRICS) if metrics is None else list(metrics)
    cell = cell_of(cell)
    values, reasons = _native.simulate_batch(cell._native, given, list(names), matrix, wanted, threads, heard(progress))
    if return_reasons:
        return values, reasons
    failed = [(row, reason) for row, reason in enumerate(reasons) if reason is not None]
    if failed:
        row, reason = failed[0]
        text = f"{len(failed)} of {len(reasons)} members failed, the first in row {row}: {reason}"
        warn([f"{text}; return_reasons=True gives all reasons"])
    return values
