"""From arguments to what the library reads."""

from __future__ import annotations

import os
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from myospring import _native
from myospring._action_potential import ActionPotential
from myospring._beat import Beat
from myospring._errors import SimulationError, warn

if TYPE_CHECKING:
    from myospring._cell import Cell


# Endings of outlines.
_OUTLINES = (".geojson", ".json", ".csv", ".roi", ".zip", ".txt")


def changed(*settings: tuple[str, Any, Any]) -> dict[str, Any]:
    """Settings by key, of triples of key, value and default: a value that is the default is left out, as in a run file."""
    return {
        key: os.fspath(value) if isinstance(value, PathLike) else value
        for key, value, default in settings
        if not (value is default or (type(value) is type(default) and value == default))
    }


def floats(array: ArrayLike) -> np.ndarray[Any, np.dtype[np.float64]]:
    """An array of numbers, in order in memory; NaN where a mask hides them."""
    values = np.ascontiguousarray(array, dtype=np.float64)
    hidden: np.ndarray[Any, np.dtype[np.bool_]] = np.ma.getmaskarray(np.ma.asanyarray(array))
    return np.where(hidden, np.nan, values) if hidden.any() else values


def path_or_bytes(image: ArrayLike | str | PathLike[str], name: str) -> tuple[str, dict[str, bytes]]:
    """The path of a picture, or a name that stands for its bytes."""
    if isinstance(image, (str, PathLike)):
        return os.fspath(image), {}
    if np.ma.is_masked(image):
        raise ValueError("a picture has a value at every pixel; fill what the mask hides, as image.filled(0) does")
    return name, {name: _native.tiff(_pixels(np.asarray(image)))}


def _pixels(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """An array in one of the types of pixels that pictures have, without loss of what can be seen."""
    if array.dtype.kind == "b":
        array = array.astype(np.uint8)
    elif array.dtype.kind == "f":
        array = array.astype(np.float32)
    elif array.dtype.kind in "iu" and array.dtype not in (np.uint8, np.uint16):
        if array.size and (array.min() < 0 or array.max() > np.iinfo(np.uint32).max):
            raise ValueError("a picture of whole numbers has values from 0 to 4294967295")
        array = array.astype(np.uint16 if not array.size or array.max() < 2**16 else np.uint32)
    elif array.dtype.kind not in "iu":
        raise TypeError(f"a picture has numbers as pixels, not {array.dtype}")
    return np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))


def cell_of(cell: Cell | None) -> Cell:
    """The cell that was given, or the built-in one."""
    from myospring._cell import Cell

    if cell is None:
        return Cell.builtin()
    if isinstance(cell, Cell):
        return cell
    if isinstance(cell, (str, PathLike)):
        name = os.fspath(cell)
        make = "from_outline" if Path(name).suffix.lower() in _OUTLINES else "from_image"
        answer = f'Cell.{make}("{name}", pixel_size_um=0.27)'
    else:
        answer = "Cell.from_image(array, pixel_size_um=0.27)"
    raise TypeError(f"cell is of type {type(cell).__name__}; give a Cell, such as myospring.{answer}")


def run(cell: Cell | None, given: dict[str, Any], threads: int | None) -> Beat:
    """A beat of a cell, or the error that it stopped with."""
    cell = cell_of(cell)
    return ended(Beat(cell, _native.simulate(cell._native, given, threads)))


def ended(beat: Beat) -> Beat:
    """A beat that came to its end, with its warnings said, or the error that it stopped with."""
    # Those of the cell were said when it was made.
    warn(text for text in beat.warnings if text not in beat.cell.warnings)
    if beat.stopped is not None:
        message, time_ms = beat.stopped
        raise SimulationError(message, time_ms, beat)
    return beat


def followed(given: dict[str, Any]) -> ActionPotential:
    """The course of a cell model."""
    columns, beats = _native.action_potential(given)
    states = dict(columns)
    by_beat = [
        {name: np.nan if value is None else value for name, value, _ in beat} for beat in beats
    ]
    return ActionPotential(
        t_ms=states.pop("t_ms"),
        potential=states.pop("potential"),
        vm_mv=states.pop("vm_mv", None),
        tension=states.pop("tension"),
        states=states,
        metrics=by_beat[-1] if by_beat else {},
        units={name: unit for name, _, unit in beats[-1]} if beats else {},
        metrics_by_beat=by_beat,
    )
