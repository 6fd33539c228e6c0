"""Errors and warnings."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from typing import Iterable


class UnknownNameError(KeyError):
    """A name that does not exist: of a model, a parameter, a metric, a built-in cell.

    The message lists the existing names and the nearest ones.
    """

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class MyospringWarning(RuntimeWarning):
    """Something to check in a cell, a beat, a batch or a fit before its numbers are used.

    ``warnings.filterwarnings("ignore", category=myospring.MyospringWarning)`` hides them; the objects keep them in
    ``warnings`` or ``verdicts``.
    """


_HERE = str(Path(__file__).parent)


def warn(messages: Iterable[str]) -> None:
    """Issues each warning, at the line that called this package."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_HERE):
        frame, level = frame.f_back, level + 1
    for message in messages:
        warnings.warn(message, MyospringWarning, stacklevel=level)
