"""The functions that take settings. `generate.py` makes `python/myospring/_functions.py` of `templates/_functions.py`."""

from __future__ import annotations

from os import PathLike
from typing import Any, Literal, Mapping, TypedDict

from myospring._action_potential import ActionPotential
from myospring._beat import Beat
from myospring._cell import Cell
from myospring._given import changed, followed, run


class BeatSettings(TypedDict, total=False):
    """The settings of `simulate`, by name."""

    <typed of beat>


BEAT_KEYS: Mapping[str, tuple[str, Any]] = {
    <keys of beat>
}
"""Key and default of each of them."""


def simulate(
    cell: Cell | None = None,
    *,
    <signature of beat>
    threads: int | None = None,
) -> Beat:
    """Beats a cell: stimulus, action potential, tension, and the shape that follows it.

    Parameters
    ----------
    cell : Cell or None
        The cell; None takes the built-in one.
    <documentation of beat>
    threads : int or None
        Most threads that move the masses; None takes as many as pay. The numbers are the same to the last bit.

    Returns
    -------
    Beat
        Curves, shapes and numbers.

    Raises
    ------
    UnknownNameError
        A cell model or a parameter that does not exist.
    ValueError
        A value outside its bounds, or settings that exclude each other.
    FileNotFoundError
        A file that is not there.
    SimulationError
        The run stopped before its end; it has the time, and what was computed.
    KeyboardInterrupt
        Ctrl-C, within a second.

    Examples
    --------
    >>> import myospring
    >>> beat = myospring.simulate(peak_tension_kpa=30, integrator="quasi-static")
    >>> beat.shortening_pct.shape == beat.t_ms.shape
    True
    """
    <given of beat>
    return run(cell, given, threads)


def action_potential(
    <signature of model>
    *,
    <signature of potential>
) -> ActionPotential:
    """Follows a cell model alone, at its resting length: potential and tension without a mesh.

    Parameters
    ----------
    <documentation of model_and_potential>

    Returns
    -------
    ActionPotential
        The course of every variable, and its numbers.

    Raises
    ------
    UnknownNameError
        A cell model or a parameter that does not exist.
    ValueError
        A value outside its bounds.

    Examples
    --------
    >>> import myospring
    >>> course = myospring.action_potential("bueno_orovio_2008_epi")
    >>> bool(260 < course.metrics["action_potential_duration_90"] < 280)
    True
    """
    <given of model_and_potential>
    return followed(given)
