"""Results as datasets of xarray."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np

# Unit that the end of a name states.
_UNITS = {
    "ms": "ms", "um": "um", "um2": "um^2", "pct": "%", "kpa": "kPa", "kPa": "kPa", "mv": "mV", "deg": "degree", "fj": "fJ"
}


def dataset(
    variables: Mapping[str, tuple[tuple[str, ...], Any]],
    coordinates: Mapping[str, tuple[tuple[str, ...], Any]],
    attributes: Mapping[str, str],
    units: Mapping[str, str] | None = None,
) -> Any:
    """Returns a dataset of arrays with their dimensions; units are `units`, or what the ends of names state.

    A dimension ``axis`` has the coordinates x and y.
    """
    try:
        import xarray
    except ImportError:
        raise ImportError("to_xarray() needs xarray, which is not installed: pip install xarray") from None

    def named(arrays: Mapping[str, tuple[tuple[str, ...], Any]]) -> dict[str, Any]:
        known = units or {}
        all_units = {name: known.get(name, _UNITS.get(name.rsplit("_", 1)[-1], "")) for name in arrays}
        return {
            name: (dimensions, np.asarray(values), {"units": all_units[name]} if all_units[name] else {})
            for name, (dimensions, values) in arrays.items()
        }

    made = xarray.Dataset(named(variables), named(coordinates), dict(attributes))
    return made.assign_coords(axis=["x", "y"]) if "axis" in made.dims else made
