"""How tables of measured curves are read, and what arrays mean."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields
from os import PathLike
from typing import Any, Mapping, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._given import floats

# An exported table, or times in ms and values.
Curve = Union[str, PathLike[str], tuple[ArrayLike, ArrayLike]]
# Name, kind, unit, times (ms), values, and times of stimuli (ms) if the file has marks of a pacer.
Read = tuple[str, str, str, NDArray[np.float64], NDArray[np.float64], list[float]]

# Unit of an array of each kind; a table states its own.
_UNITS = {"length": "um", "sarcomere-length": "um", "normalised-length": "", "shortening": "%"}


@dataclass(frozen=True)
class Reading:
    """How tables are read, and the meaning of arrays."""

    columns: Sequence[str] = ()
    time: str | None = None
    kind: str | None = None
    unit: str | None = None
    time_unit: str | None = None
    frame_rate_per_s: float | None = None
    pixel_size_um: float | None = None
    sheets: Sequence[str] = ()
    from_ms: float | None = None
    until_ms: float | None = None
    ignore_marks: bool = False
    mean: bool = False
    skip_gaps: bool = False

    @classmethod
    def among(cls, arguments: Mapping[str, Any]) -> Reading:
        """Returns those arguments of a function that state how a table is read."""
        return cls(**{one.name: arguments[one.name] for one in fields(cls) if one.name in arguments})

    def by_name(self) -> dict[str, Any]:
        """Returns the options in the form that the Rust part expects."""
        return {**self.__dict__, "columns": list(self.columns), "sheets": list(self.sheets)}

    def curves(self, curve: Curve, name: str) -> tuple[list[Read], list[str]]:
        """Returns the curves of a table, or the curve of two arrays, and what was assumed."""
        if isinstance(curve, (str, PathLike)):
            return _native.read_curves(os.fspath(curve), self.by_name())
        times, values = (floats(array) for array in curve)
        if times.ndim != 1 or times.shape != values.shape:
            raise ValueError(
                f"times and values have the shapes {times.shape} and {values.shape}; give two of shape (frames,)"
            )
        kind = self.kind or "length"
        unit = _UNITS.get(kind, "a.u.") if self.unit is None else self.unit
        first = -np.inf if self.from_ms is None else self.from_ms
        last = np.inf if self.until_ms is None else self.until_ms
        part = (times >= first) & (times <= last)
        if not part.any():
            raise ValueError(f"no frame lies from {first} to {last} ms")
        return [(name, kind, unit, times[part], values[part], [])], []
