"""What a cell model does alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping

import numpy as np
from numpy.typing import NDArray

from myospring import _native


@dataclass(frozen=True)
class ActionPotential:
    """The course of a cell model without a mesh.

    Attributes
    ----------
    t_ms : ndarray of shape (samples,)
        Times, ms.
    potential : ndarray of shape (samples,)
        The potential variable, in the model's own unit; NaN where it has none.
    vm_mv : ndarray of shape (samples,) or None
        Membrane potential, mV, where the model defines it.
    tension : ndarray of shape (samples,)
        Active tension as the model has it: relative, or in kPa.
    states : dict of str to ndarray of shape (samples,)
        Every state variable and what the model tells besides.
    metrics : dict of str to float
        Numbers of the last action potential; NaN where the course does not show one.
    units : dict of str to str
        Their units.
    metrics_by_beat : list of dict of str to float
        Numbers of each action potential.
    """

    t_ms: NDArray[np.float64]
    potential: NDArray[np.float64]
    vm_mv: NDArray[np.float64] | None
    tension: NDArray[np.float64]
    states: Mapping[str, NDArray[np.float64]]
    metrics: Mapping[str, float]
    units: Mapping[str, str]
    metrics_by_beat: list[dict[str, float]]

    def to_dataframe(self) -> Any:
        """The course as a table.

        Returns
        -------
        pandas.DataFrame
            A row for each sample.
        """
        import pandas

        columns = {"t_ms": self.t_ms, "potential": self.potential}
        if self.vm_mv is not None:
            columns["vm_mv"] = self.vm_mv
        return pandas.DataFrame({**columns, "tension": self.tension, **self.states})


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
