"""How far long work has come."""

from __future__ import annotations

import sys
import time
from typing import Callable, Union

# Called with the stage, the steps of it that are done, and all of them; what it raises ends the work.
Heard = Callable[[str, int, int], object]
# A function, or whether a bar is drawn; None: what the function does unless it is told.
Progress = Union[Heard, bool, None]


class Bar:
    """A progress bar on the terminal."""

    def __init__(self) -> None:
        self._stage, self._begun, self._first, self._shown = "", 0.0, 0, -1.0

    def __call__(self, stage: str, done: int, steps: int) -> None:
        now = time.monotonic()
        if stage != self._stage:
            self._stage, self._begun, self._first = stage, now, done
        elif done < steps and now - self._shown < 0.1:
            return
        self._shown = now
        share = min(done / max(steps, 1), 1.0)
        bar = "#" * round(30 * share)
        new = done - self._first
        left = f", {_duration((now - self._begun) / new * (steps - done))} left" if new > 0 and done < steps else ""
        end = "\n" if done >= steps else ""
        print(f"\r[{bar:30}] {done}/{steps} {stage}{left}\x1b[K", end=end, file=sys.stderr, flush=True)


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.0f} h"


def heard(progress: Progress, on_terminal: bool = False) -> Heard | None:
    """Returns the function that hears of progress; `on_terminal` draws a bar on a terminal unless told otherwise."""
    if progress is None:
        progress = on_terminal and sys.stderr.isatty()
    if isinstance(progress, bool):
        return Bar() if progress else None
    return progress
