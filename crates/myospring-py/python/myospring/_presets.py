"""Published experiments to start from."""

from __future__ import annotations

import os
from os import PathLike
from typing import TYPE_CHECKING

from myospring import _native
from myospring._beat import Beat, ended
from myospring._cell import Cell
from myospring._functions import BEAT_KEYS, BeatSettings

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
    name: str, cell: Cell | None = None, *, threads: int | None = None, **settings: Unpack[BeatSettings]
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
    unknown = [one for one in settings if one not in BEAT_KEYS]
    if unknown:
        raise TypeError(f"simulate_preset() got an unexpected keyword argument '{unknown[0]}'")
    given = {
        BEAT_KEYS[one][0]: os.fspath(value) if isinstance(value, PathLike) else value
        for one, value in settings.items()
        if value is not None
    }
    cell = Cell(_native.preset_cell(name)) if cell is None else cell
    return ended(Beat(cell, _native.simulate_preset(name, cell._native, given, threads)))
