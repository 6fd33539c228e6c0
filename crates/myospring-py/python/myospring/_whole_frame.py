"""Fibres and sarcomeres of a whole picture, without an outline."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._errors import warn
from myospring._given import changed, path_or_bytes
from myospring._xarray import dataset


@dataclass(frozen=True, eq=False)
class WholeFrame:
    """Fibres and sarcomeres of a whole frame; the result of `whole_frame`.

    Arrays have one entry per position, NaN where nothing was read.

    Attributes
    ----------
    width_um, height_um : float
        Size of the frame, um.
    pixel_size_um, spacing_um : float
        Size of a pixel, and distance of neighbouring positions, um.
    read_pct : float
        Share of the frame in which fibres were read, per cent.
    mean_direction_deg : float or None
        Their mean direction, degrees counter-clockwise from x, above -90 and up to 90.
    alignment : float or None
        Alignment of the fibres: 1 for parallel fibres, 0 for all directions equally.
    median_sarcomere_um, sarcomere_q1_um, sarcomere_q3_um : float or None
        Median and quartiles of the length of a sarcomere, um.
    sarcomere_doubt : str or None
        Why that length is doubtful, if it is.
    positions : ndarray of shape (places, 2)
        Positions, um; x to the right, y upward from the lower left corner.
    direction_deg : ndarray of shape (places,)
        Direction of the fibres, degrees counter-clockwise from x.
    sarcomere_um : ndarray of shape (places,)
        Length of a sarcomere, um.
    sarcomere_doubtful : ndarray of bool of shape (places,)
        Whether that length is doubtful.
    order : ndarray of shape (places,)
        How distinct the direction and the period are, 0 to 1.
    coverage : ndarray of shape (places,)
        Share of the neighbourhood in which fibres were found, 0 to 1.
    warnings : list of str
        Warnings for the user.
    """

    width_um: float
    height_um: float
    pixel_size_um: float
    spacing_um: float
    read_pct: float
    mean_direction_deg: float | None
    alignment: float | None
    median_sarcomere_um: float | None
    sarcomere_q1_um: float | None
    sarcomere_q3_um: float | None
    sarcomere_doubt: str | None
    positions: NDArray[np.float64]
    direction_deg: NDArray[np.float64]
    sarcomere_um: NDArray[np.float64]
    sarcomere_doubtful: NDArray[np.bool_]
    order: NDArray[np.float64]
    coverage: NDArray[np.float64]
    warnings: list[str]

    def to_xarray(self) -> Any:
        """Returns fibres and sarcomeres as a dataset; needs xarray.

        Returns
        -------
        xarray.Dataset
            Numbers over ``place``, with its coordinates; units are attributes.
        """
        names = ("direction_deg", "sarcomere_um", "sarcomere_doubtful", "order", "coverage")
        places = {"x_um": (("place",), self.positions[:, 0]), "y_um": (("place",), self.positions[:, 1])}
        return dataset({name: (("place",), getattr(self, name)) for name in names}, places, {})

    def __repr__(self) -> str:
        size = f"{self.width_um:.0f} x {self.height_um:.0f} um"
        length = self.median_sarcomere_um
        sarcomeres = "no sarcomeres" if length is None else f"sarcomeres {length:.2f} um"
        return f"WholeFrame({size}, {self.read_pct:.0f} % read, {sarcomeres})"


def whole_frame(
    image: ArrayLike | str | PathLike[str],
    *,
    pixel_size_um: float | None = None,
    stain: Literal["z-disc", "filament"] | None = None,
    fibre_smoothing_um: float | None = None,
    spacing_um: float | None = None,
    channel: int | None = None,
    frame: int | None = None,
    z: int | str | None = None,
) -> WholeFrame:
    """Reads fibres and sarcomeres of a sheet or a tissue, in which no single cell has an outline.

    Does the same as ``myospring segment --whole-frame``. Scale bars and letters are ignored.

    Parameters
    ----------
    image : array_like of shape (rows, columns) or (rows, columns, 3), or path
        Grey values or colours, with the top row first; or a file: PNG, TIFF or OME-TIFF.
    pixel_size_um : float or None
        Size of a pixel, um. It is never guessed. None: the size stated in the file.
    stain : {"z-disc", "filament"} or None
        Stained structure: stripes across the fibre or filaments along it. None: z-disc.
    fibre_smoothing_um : float or None
        Scale over which directions are averaged, um. None: 3 um.
    spacing_um : float or None
        Distance of neighbouring positions, um. None: 1 um, and more if that gives more than 20 000 positions.
    channel, frame, z : int or None
        Channel, time point and slice of the picture, from 0; z also "max" or "mean".

    Returns
    -------
    WholeFrame

    Raises
    ------
    FileNotFoundError
        The file does not exist.
    ValueError
        The pixels are too coarse, or a setting is invalid.

    Examples
    --------
    >>> import numpy as np, myospring
    >>> columns = np.arange(300) * 0.2
    >>> stripes = 100 + 80 * np.cos(2 * np.pi * columns / 1.9)
    >>> noise = np.random.default_rng(0).normal(0, 3, (200, 300))
    >>> sheet = myospring.whole_frame((stripes + noise).astype(np.uint8), pixel_size_um=0.2)
    >>> round(sheet.median_sarcomere_um, 1), sheet.read_pct > 90
    (1.9, True)
    """
    path, arrays = path_or_bytes(image, "array.tif")
    given = changed(
        ("shape.pixel_size", pixel_size_um, None),
        ("shape.spacing", spacing_um, None),
        ("mechanics.fibre", "picture", None),
        ("mechanics.stain", stain, None),
        ("mechanics.fibre_smoothing", fibre_smoothing_um, None),
        ("segmentation.channel", channel, None),
        ("segmentation.frame", frame, None),
        ("segmentation.z", z, None),
    )
    (positions, columns), numbers, notes = _native.whole_frame({"shape.picture": path, **given}, arrays)
    warn(notes)
    numbers["mean_direction_deg"] = numbers.pop("direction_deg")
    numbers["median_sarcomere_um"] = numbers.pop("sarcomere_um")
    return WholeFrame(**numbers, **columns, positions=positions, warnings=notes)
