"""Published experiments to start from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from myospring import _native
from myospring._beat import Beat, ended
from myospring._cell import Cell
from myospring._functions import BeatSettings
from myospring._progress import Progress, heard
from myospring._settings import given_of_beat

if TYPE_CHECKING:
    from typing_extensions import Unpack


def presets() -> dict[str, str]:
    """Published experiments to start from, as ``myospring init --preset`` has them.

    Returns
    -------
    dict of str to str
        What each preset is, by its name.

    Examples
    --------
    >>> import myospring
    >>> "adult-human" in myospring.presets()
    True
    """
    return {name: about for name, about, _ in _native.presets()}


def simulate_preset(
    name: str,
    cell: Cell | None = None,
    *,
    threads: int | None = None,
    progress: Progress = None,
    **settings: Unpack[BeatSettings],
) -> Beat:
    """Beats a cell as a published experiment does.

    Parameters
    ----------
    name : str
        One of `presets`.
    cell : Cell or None
        The cell's shape; None takes that of the preset.
    threads : int or None
        Threads of the beat; None takes what its mesh is worth.
    progress : callable, bool or None
        As in `simulate`.
    **settings
        Settings of `simulate`, instead of those of the preset.

    Returns
    -------
    Beat
        The beat.

    Raises
    ------
    UnknownNameError
        There is no such preset.
    SimulationError
        The run stopped before its end.
    """
    given = given_of_beat("simulate_preset", settings, override=True)
    cell = Cell(_native.preset_cell(name)) if cell is None else cell
    return ended(Beat(cell, _native.simulate_preset(name, cell._native, given, threads, heard(progress))))
