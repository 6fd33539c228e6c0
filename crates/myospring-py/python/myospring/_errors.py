"""What goes wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from myospring._beat import Beat


class UnknownNameError(KeyError):
    """A name that does not exist: of a model, a parameter, a metric, a built-in cell.

    The message says which names there are, and which may be meant.
    """

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class SimulationError(RuntimeError):
    """A run that stopped before its end.

    Attributes
    ----------
    time_ms : float or None
        When, on the run's clock; None where a cell model failed that does not tell.
    beat : Beat
        What was computed up to there.
    """

    def __init__(self, message: str, time_ms: float | None, beat: Beat) -> None:
        super().__init__(message, time_ms, beat)
        self.time_ms = time_ms
        self.beat = beat

    def __str__(self) -> str:
        return str(self.args[0])
