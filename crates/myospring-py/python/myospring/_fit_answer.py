"""What a fit has found: estimates, curves, models that were tried, and a curve's own tension."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from myospring._xarray import dataset


class Estimate(NamedTuple):
    """An estimated parameter.

    Attributes
    ----------
    value : float
        The most likely value.
    unit : str
        Unit; empty for a pure number.
    interval : tuple of two floats or None
        Ends of the 95 % interval by profile likelihood; None where the curve does not limit it, and for a fit whose
        `verdict` is "does-not-fit".
    standard_deviation : float or None
        Standard deviation from the curvature at the most likely value, in its unit.
    verdict : str
        How well the curve determines it: ``"determined"``, ``"not determined by this curve"``, or an intermediate
        verdict.
    bounds : tuple of two floats
        Bounds of the search.
    profile : list of tuples
        Value and rise of chi squared for values around the answer.
    """

    value: float
    unit: str
    interval: tuple[float | None, float | None]
    standard_deviation: float | None
    verdict: str
    bounds: tuple[float, float]
    profile: list[tuple[float, float]]


@dataclass(frozen=True, repr=False)
class FilmDistances:
    """The fitted cell laid over its film: how far it is from the film's cell in each frame that it reaches.

    Attributes
    ----------
    frames : ndarray of shape (frames,)
        Their numbers in the film.
    t_ms : ndarray of shape (frames,)
        Their times.
    distance_um : ndarray of shape (frames,)
        Distance of the points of the two cells, root mean square, after the best shift and rotation of the whole cell.
    movement_um : ndarray of shape (frames,)
        How far the film's cell has moved from rest, in the same way.
    positions : ndarray of shape (frames, nodes, 2)
        Masses of the fitted cell, um, shifted and rotated to the film's cell in each frame.
    """

    frames: NDArray[np.int64]
    t_ms: NDArray[np.float64]
    distance_um: NDArray[np.float64]
    movement_um: NDArray[np.float64]
    positions: NDArray[np.float64]

    def to_dataframe(self) -> Any:
        """Returns a row for each frame; needs pandas.

        Returns
        -------
        pandas.DataFrame
            Time, distance and movement, indexed by the frame.
        """
        import pandas

        columns = {"t_ms": self.t_ms, "distance_um": self.distance_um, "movement_um": self.movement_um}
        return pandas.DataFrame(columns, index=pandas.Index(self.frames, name="frame"))

    def __repr__(self) -> str:
        most = f"{self.distance_um.max():.2f} um apart at most"
        return f"<myospring.FilmDistances: {len(self.frames)} frames, {most}>"


class TriedModel(NamedTuple):
    """What a cell model leaves of a curve, or why it was not fitted.

    Attributes
    ----------
    model : str
        Name of the model.
    taken : bool
        Whether the fit is of this model.
    reason : str or None
        Why the model was not fitted; all that follows is then None.
    verdict : str or None
        Whether it follows the curve, as `Fit.verdict`.
    numbers : int or None
        Number of fitted numbers; for the curve's own tension one for each frame.
    chi_squared : float or None
        Squared residuals over squared noise, summed over the frames that every model used.
    frames : int or None
        Number of these frames.
    bic : float or None
        Bayesian information criterion: chi squared plus `numbers` times the logarithm of `frames`.
    misfit_pct : float or None
        Structure in the residuals, root mean square, % of the height of a beat; 0 if they look like noise.
    frames_together : float or None
        Neighbouring frames that count as one, since their residuals are correlated.
    as_good : bool or None
        Whether the curve does not tell it from the model that was taken.
    """

    model: str
    taken: bool
    reason: str | None = None
    verdict: str | None = None
    numbers: int | None = None
    chi_squared: float | None = None
    frames: int | None = None
    bic: float | None = None
    misfit_pct: float | None = None
    frames_together: float | None = None
    as_good: bool | None = None


@dataclass(frozen=True, eq=False)
class FittedCurve:
    """A measured curve and that of the fitted cell.

    Attributes
    ----------
    name, unit : str
        Name, and unit of its values.
    t_ms, measured, fitted : ndarray of shape (frames,)
        Times, the measured values, and those of the fitted cell.
    used : ndarray of bool, of shape (frames,)
        Whether each frame was used; the others are single bad frames.
    stimuli_ms : list of float
        Stimuli with the fitted delays.
    noise, residual : float
        Standard deviation of the noise of the cell at rest, and of the residuals.
    misfit, unexplained : float
        Root mean square of the structure in the residuals, 0 if they look like noise; and the share of the curve's
        variance that this structure makes up.
    """

    name: str
    unit: str
    t_ms: NDArray[np.float64]
    measured: NDArray[np.float64]
    fitted: NDArray[np.float64]
    used: NDArray[np.bool_]
    stimuli_ms: list[float]
    noise: float
    residual: float
    misfit: float
    unexplained: float

    def to_xarray(self) -> Any:
        """Returns both curves as a dataset; needs xarray.

        Returns
        -------
        xarray.Dataset
            ``measured``, ``fitted`` and ``used`` over ``t_ms``; units are attributes.
        """
        over_time = {name: (("t_ms",), getattr(self, name)) for name in ("measured", "fitted", "used")}
        units = {"measured": self.unit, "fitted": self.unit}
        return dataset(over_time, {"t_ms": (("t_ms",), self.t_ms)}, {"title": self.name}, units)


@dataclass(frozen=True, eq=False)
class OwnTension:
    """The active tension that a curve asks for, frame by frame.

    Attributes
    ----------
    t_ms : ndarray of shape (frames,)
        Times since the first frame.
    tension_kpa, standard_deviation_kpa : ndarray of shape (frames,)
        Tension, 0 where the cell is longer than at rest, and its standard deviation.
    band_kpa : ndarray of shape (2, frames)
        Ends of the 95 % band.
    young_modulus_kpa : float
        The assumed Young's modulus: a free cell determines tension over stiffness only.
    mean_beat : dict of str to ndarray, or None
        ``t_ms`` since the onset, ``tension_kpa`` and ``standard_error_kpa`` of the mean of the whole beats.
    """

    t_ms: NDArray[np.float64]
    tension_kpa: NDArray[np.float64]
    standard_deviation_kpa: NDArray[np.float64]
    band_kpa: NDArray[np.float64]
    young_modulus_kpa: float
    mean_beat: dict[str, NDArray[np.float64]] | None
