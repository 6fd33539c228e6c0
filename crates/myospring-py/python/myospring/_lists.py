"""What there is: cell models, their parameters, metrics."""

from __future__ import annotations

from typing import Mapping, NamedTuple

from myospring import _native


class Parameter(NamedTuple):
    """A parameter of a cell model with its published value.

    Attributes
    ----------
    value : float
        In `unit`.
    unit : str
        Empty for a pure number.
    minimum, maximum : float
        What the model accepts, in `unit`.
    meaning : str
        What it does.
    source : str
        Where the value comes from.
    """

    value: float
    unit: str
    minimum: float
    maximum: float
    meaning: str
    source: str


class Metric(NamedTuple):
    """A number that a beat is read by.

    Attributes
    ----------
    unit : str
        Empty for a pure number.
    definition : str
        The convention it is taken by.
    """

    unit: str
    definition: str


def models() -> list[str]:
    """Names of the cell models.

    Returns
    -------
    list of str
    """
    return _native.models()


def parameters(model: str = "coelho_2021") -> dict[str, Parameter]:
    """The parameters of a cell model, with their published values.

    Parameters
    ----------
    model : str
        One of `models()`.

    Returns
    -------
    dict of str to Parameter

    Raises
    ------
    UnknownNameError
        No model has that name.
    """
    return {row[0]: Parameter(*row[1:]) for row in _native.parameters(model)}


METRICS: Mapping[str, Metric] = {
    name: Metric(unit, definition) for name, unit, definition in _native.metrics()
}
"""Every metric of a beat by name, in the order of reading."""
