"""Cell models without a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping

import numpy as np
from numpy.typing import NDArray

from myospring import _native
from myospring._progress import Progress, heard
from myospring._xarray import dataset


@dataclass(frozen=True)
class ActionPotential:
    """Time course of a cell model without a mesh.

    Attributes
    ----------
    t_ms : ndarray of shape (samples,)
        Times, ms.
    potential : ndarray of shape (samples,)
        The model's potential variable, in the model's own unit; NaN if it has none.
    vm_mv : ndarray of shape (samples,) or None
        Membrane potential, mV; None if the model does not define it.
    tension : ndarray of shape (samples,)
        Active tension in the model's own unit: relative, or kPa.
    states : dict of str to ndarray of shape (samples,)
        Every state variable and the model's further outputs.
    metrics : dict of str to float
        Metrics of the last action potential; NaN if the time course does not show one.
    units : dict of str to str
        Units of the metrics.
    metrics_by_beat : list of dict of str to float
        Metrics of each action potential.
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
        """Returns the time course as a table.

        Returns
        -------
        pandas.DataFrame
            One row per sample.
        """
        import pandas

        columns = {"t_ms": self.t_ms, "potential": self.potential}
        if self.vm_mv is not None:
            columns["vm_mv"] = self.vm_mv
        return pandas.DataFrame({**columns, "tension": self.tension, **self.states})

    def to_xarray(self) -> Any:
        """Returns the time course as a dataset; needs xarray.

        Returns
        -------
        xarray.Dataset
            Every variable over ``t_ms``; units are attributes where the name states one.
        """
        columns = {"potential": self.potential, "tension": self.tension, **self.states}
        if self.vm_mv is not None:
            columns["vm_mv"] = self.vm_mv
        over_time = {name: (("t_ms",), values) for name, values in columns.items()}
        return dataset(over_time, {"t_ms": (("t_ms",), self.t_ms)}, {})


def followed(given: dict[str, Any], progress: Progress) -> ActionPotential:
    """Returns the time course of a cell model."""
    columns, beats = _native.action_potential(given, heard(progress))
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
