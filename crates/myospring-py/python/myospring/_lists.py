"""Lists of cell models, their parameters, and metrics."""

from __future__ import annotations

from os import PathLike, fspath
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
        Bounds that the model accepts, in `unit`.
    meaning : str
        Meaning of the parameter.
    source : str
        Source of the value.
    """

    value: float
    unit: str
    minimum: float
    maximum: float
    meaning: str
    source: str


class Metric(NamedTuple):
    """A metric of a beat.

    Attributes
    ----------
    unit : str
        Empty for a pure number.
    definition : str
        Convention by which it is measured.
    """

    unit: str
    definition: str


def models() -> list[str]:
    """Returns the names of the cell models.

    Returns
    -------
    list of str
    """
    return _native.models()


def parameters(model: str | PathLike[str] = "coelho_2021", variables: str | None = None) -> dict[str, Parameter]:
    """Returns the parameters of a cell model, with their published values.

    Parameters
    ----------
    model : str or PathLike[str]
        One of `models()`, or the file of a published model.
    variables : str or None
        Variables that the file does not tell, as in `simulate`.

    Returns
    -------
    dict of str to Parameter

    Raises
    ------
    UnknownNameError
        No model has that name.
    ValueError
        The file cannot be read.
    """
    return {row[0]: Parameter(*row[1:]) for row in _native.parameters(fspath(model), variables)}


METRICS: Mapping[str, Metric] = {
    name: Metric(unit, definition) for name, unit, definition in _native.metrics()
}
"""Every metric of a beat by name, in the order of reading."""
