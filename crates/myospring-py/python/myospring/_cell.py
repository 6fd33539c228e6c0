"""A cell. `generate.py` writes what it takes of settings."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import lru_cache
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._errors import warn
from myospring._given import changed, floats, path_or_bytes
from myospring._svg import outline_svg


@dataclass(frozen=True)
class Dimensions:
    """How large a cell is.

    Attributes
    ----------
    length_um, width_um : float
        Extent along and across the long axis, um.
    mean_width_um : float
        Area over length, um.
    aspect_ratio : float
        Length over mean width.
    long_axis_deg : float
        Direction of the long axis, degrees counter-clockwise from x.
    spacing_um : float
        Distance of neighbouring masses, um.
    area_um2 : float
        Area of the outline, um^2.
    """

    length_um: float
    width_um: float
    mean_width_um: float
    aspect_ratio: float
    long_axis_deg: float
    spacing_um: float
    area_um2: float


class Cell:
    """A cell that was found and meshed, at rest; `from_image` and its like make one.

    It does not change, and can be pickled.

    Attributes
    ----------
    name : str
        For people and folders.
    positions : ndarray of shape (nodes, 2)
        The masses, um; x to the right, y upward.
    triangles : ndarray of shape (triangles, 3)
        Nodes of each triangle.
    outline : list of ndarray of shape (points, 2)
        The rings of the outline, um, the outer one first.
    dimensions : Dimensions
        Length, width and their like.
    warnings : list of str
        What a person should look at.
    """

    __slots__ = ("_native",)

    def __init__(self, native: _native.Cell) -> None:
        self._native = native

    @classmethod
    def _made(cls, given: dict[str, Any], arrays: dict[str, bytes]) -> Cell:
        """The cell of these settings, by key; its warnings are Python's, too."""
        cell = cls(_native.Cell(given, arrays))
        warn(cell.warnings)
        return cell

    @classmethod
    def from_image(
        cls,
        image: ArrayLike | str | PathLike[str],
        *,
        # <signature of image>
        pixel_size_um: float | None = None,
        any_size: bool = False,
        profile: Literal["flat", "round", "dome", "slab"] = "flat",
        spacing_um: float | None = None,
        modality: Literal["auto", "fluorescence", "brightfield", "mask"] | None = None,
        channel: int | None = None,
        frame: int | None = None,
        z: int | str | None = None,
        threshold: float | None = None,
        smooth_um: float | None = None,
        seed: tuple[float, float] | None = None,
        cell: int | str | None = None,
        min_area_um2: float | None = None,
        max_area_um2: float | None = None,
        allow_cut: bool = False,
        outline: str | PathLike[str] | None = None,
        thickness_um: float = 10.0,
        # </signature>
    ) -> Cell:
        """The cell of a picture from a microscope.

        Parameters
        ----------
        image : array_like of shape (rows, columns) or (rows, columns, 3), or path
            Grey values or colours, the first row on top; or a file: PNG, TIFF or OME-TIFF.
        pixel_size_um : float or None
            Side of one pixel of a picture, or of an outline in pixels. Never guessed. In um, 0.001
            um to 50 um. None: the picture's own.
        any_size : bool, default False
            Accepts a cell whose size is impossible for a heart cell: longer than 400 um, shorter
            than 15 um, or with an area outside of `min_area_um2` to `max_area_um2`. Such a size
            usually means a wrong pixel size.
        profile : {"flat", "round", "dome", "slab"}, default "flat"
            Section of the cell across its plane. A thick cell is made of cubes; its greatest
            thickness is `thickness_um` in [material], and what a picture does not show of it is
            assumed.
        spacing_um : float or None
            Distance between neighbouring masses. In um, above 0 um, at most 1000 um. None: such
            that a flat cell has about 2000 of them, a thick one about 4000 and 4 cubes across its
            thickness.
        modality : {"auto", "fluorescence", "brightfield", "mask"} or None
            How the picture was taken. None: auto.
        channel : int or None
            Channel of the picture, from 0. 0 to 10000. None: the first, or the luminance of a
            colour picture.
        frame : int or None
            Frame (time point) of the picture, from 0. 0 to 1000000. None: 0.
        z : int or str or None
            How a stack in depth is reduced: "max", "mean", or the number of a slice, from 0. None:
            max.
        threshold : float or None
            Threshold; a lower one includes more. Fluorescence: grey value above which a pixel
            belongs to the cell. Brightfield: least relative change of brightness per um of an edge.
            None: determined from the picture, and printed.
        smooth_um : float or None
            Scale of smoothing. In um, 0 um to 20 um. None: "0.5 um" for fluorescence, "0.8 um" for
            brightfield.
        seed : tuple[float, float] or None
            Takes the cell at this place: column and row in pixels from the top left.
        cell : int or str or None
            Which cell: "largest", or its number by size, 1 being the largest. None: largest; batch:
            all.
        min_area_um2 : float or None
            Smallest expected area of a cell: studies leave out smaller ones (debris); elsewhere
            they are errors unless any size is allowed. In um^2, 0 um^2 to 100000000 um^2. None:
            "500 um^2".
        max_area_um2 : float or None
            Largest expected area of a cell: studies leave out larger ones (sheets, clumps);
            elsewhere they are errors unless any size is allowed. In um^2, above 0 um^2, at most
            100000000 um^2. None: "20000 um^2".
        allow_cut : bool, default False
            Accepts a cell although the frame of the picture cuts it.
        outline : str or PathLike[str] or None
            Outline of the cell drawn on the picture in another program, instead of segmentation:
            GeoJSON, ImageJ's .roi or RoiSet .zip, Cellpose's _outlines.txt.
        thickness_um : float, default 10.0
            Thickness of the cell; where it varies, the greatest. In um, above 0 um, at most 5000
            um.

        Returns
        -------
        Cell

        Raises
        ------
        FileNotFoundError
            There is no such file.
        ValueError
            No cell was found, or a setting is not possible; the message says how to mend it.

        Examples
        --------
        >>> import numpy as np, myospring
        >>> rows, columns = np.mgrid[:120, :320]
        >>> inside = ((columns - 160) / 120) ** 2 + ((rows - 60) / 30) ** 2 < 1
        >>> noise = np.random.default_rng(0).normal(0, 3, inside.shape)
        >>> picture = (20 + 180 * inside + noise).clip(0, 255).astype(np.uint8)
        >>> cell = myospring.Cell.from_image(picture, pixel_size_um=0.5)
        >>> bool(abs(cell.dimensions.length_um - 120) < 3)
        True
        """
        path, arrays = path_or_bytes(image, "array.tif")
        # <given of image>
        given = changed(
            ("shape.pixel_size", pixel_size_um, None),
            ("shape.any_size", any_size, False),
            ("shape.profile", profile, "flat"),
            ("shape.spacing", spacing_um, None),
            ("segmentation.modality", modality, None),
            ("segmentation.channel", channel, None),
            ("segmentation.frame", frame, None),
            ("segmentation.z", z, None),
            ("segmentation.threshold", threshold, None),
            ("segmentation.smooth", smooth_um, None),
            ("segmentation.seed", seed, None),
            ("segmentation.cell", cell, None),
            ("segmentation.min_area", min_area_um2, None),
            ("segmentation.max_area", max_area_um2, None),
            ("segmentation.allow_cut", allow_cut, False),
            ("segmentation.outline", outline, None),
            ("material.thickness", thickness_um, 10.0),
        )
        # </given>
        return cls._made({"shape.picture": path, **given}, arrays)

    @classmethod
    def from_mask(
        cls,
        mask: ArrayLike | str | PathLike[str],
        *,
        # <signature of mask>
        pixel_size_um: float | None = None,
        label: int | None = None,
        cell: int | str | None = None,
        seed: tuple[float, float] | None = None,
        channel: int | None = None,
        frame: int | None = None,
        z: int | str | None = None,
        min_area_um2: float | None = None,
        max_area_um2: float | None = None,
        allow_cut: bool = False,
        spacing_um: float | None = None,
        any_size: bool = False,
        profile: Literal["flat", "round", "dome", "slab"] = "flat",
        thickness_um: float = 10.0,
        # </signature>
    ) -> Cell:
        """The cell of a mask, or of a mask with labels.

        Parameters
        ----------
        mask : array_like of shape (rows, columns), or path
            False or 0 is background, all else a cell; the first row is on top.
        pixel_size_um : float or None
            Side of one pixel of a picture, or of an outline in pixels. Never guessed. In um, 0.001
            um to 50 um. None: the picture's own.
        label : int or None
            In a label mask, the grey value of the cell. 1 to 16777215. None: the largest cell.
        cell : int or str or None
            Which cell: "largest", or its number by size, 1 being the largest. None: largest; batch:
            all.
        seed : tuple[float, float] or None
            Takes the cell at this place: column and row in pixels from the top left.
        channel : int or None
            Channel of the picture, from 0. 0 to 10000. None: the first, or the luminance of a
            colour picture.
        frame : int or None
            Frame (time point) of the picture, from 0. 0 to 1000000. None: 0.
        z : int or str or None
            How a stack in depth is reduced: "max", "mean", or the number of a slice, from 0. None:
            max.
        min_area_um2 : float or None
            Smallest expected area of a cell: studies leave out smaller ones (debris); elsewhere
            they are errors unless any size is allowed. In um^2, 0 um^2 to 100000000 um^2. None:
            "500 um^2".
        max_area_um2 : float or None
            Largest expected area of a cell: studies leave out larger ones (sheets, clumps);
            elsewhere they are errors unless any size is allowed. In um^2, above 0 um^2, at most
            100000000 um^2. None: "20000 um^2".
        allow_cut : bool, default False
            Accepts a cell although the frame of the picture cuts it.
        spacing_um : float or None
            Distance between neighbouring masses. In um, above 0 um, at most 1000 um. None: such
            that a flat cell has about 2000 of them, a thick one about 4000 and 4 cubes across its
            thickness.
        any_size : bool, default False
            Accepts a cell whose size is impossible for a heart cell: longer than 400 um, shorter
            than 15 um, or with an area outside of `min_area_um2` to `max_area_um2`. Such a size
            usually means a wrong pixel size.
        profile : {"flat", "round", "dome", "slab"}, default "flat"
            Section of the cell across its plane. A thick cell is made of cubes; its greatest
            thickness is `thickness_um` in [material], and what a picture does not show of it is
            assumed.
        thickness_um : float, default 10.0
            Thickness of the cell; where it varies, the greatest. In um, above 0 um, at most 5000
            um.

        Returns
        -------
        Cell

        Raises
        ------
        FileNotFoundError
            There is no such file.
        ValueError
            There is no such cell, or a setting is not possible.

        Examples
        --------
        >>> import numpy as np, myospring
        >>> mask = np.zeros((60, 240), dtype=bool)
        >>> mask[10:50, 20:220] = True
        >>> cell = myospring.Cell.from_mask(mask, pixel_size_um=0.5)
        >>> cell.dimensions.area_um2
        2000.0
        """
        path, arrays = path_or_bytes(mask, "mask.tif")
        # <given of mask>
        given = changed(
            ("shape.pixel_size", pixel_size_um, None),
            ("shape.label", label, None),
            ("segmentation.cell", cell, None),
            ("segmentation.seed", seed, None),
            ("segmentation.channel", channel, None),
            ("segmentation.frame", frame, None),
            ("segmentation.z", z, None),
            ("segmentation.min_area", min_area_um2, None),
            ("segmentation.max_area", max_area_um2, None),
            ("segmentation.allow_cut", allow_cut, False),
            ("shape.spacing", spacing_um, None),
            ("shape.any_size", any_size, False),
            ("shape.profile", profile, "flat"),
            ("material.thickness", thickness_um, 10.0),
        )
        # </given>
        given["segmentation.modality"] = "mask"
        return cls._made({"shape.picture": path, **given}, arrays)

    @classmethod
    def from_stack(
        cls,
        stack: ArrayLike | str | PathLike[str],
        *,
        # <signature of stack>
        pixel_size_um: float | None = None,
        z_step_um: float | None = None,
        first_slice: Literal["bottom", "top"] | None = None,
        stack_stain: Literal["auto", "filled", "membrane"] | None = None,
        spacing_um: float | None = None,
        any_size: bool = False,
        modality: Literal["auto", "fluorescence", "brightfield", "mask"] | None = None,
        channel: int | None = None,
        frame: int | None = None,
        threshold: float | None = None,
        smooth_um: float | None = None,
        seed: tuple[float, float] | None = None,
        cell: int | str | None = None,
        label: int | None = None,
        min_area_um2: float | None = None,
        max_area_um2: float | None = None,
        allow_cut: bool = False,
        # </signature>
    ) -> Cell:
        """The thick cell that a stack of pictures in depth shows: fluorescence, a mask or labels.

        Parameters
        ----------
        stack : array_like of shape (slices, rows, columns), or path
            Grey values, the lowest slice first and the first row on top; or a TIFF, OME-TIFF or ImageJ stack. In an array of bool,
            or of a mask, 0 is background.
        pixel_size_um : float or None
            Side of one pixel of a picture, or of an outline in pixels. Never guessed. In um, 0.001
            um to 50 um. None: the picture's own.
        z_step_um : float or None
            Distance of two slices of a stack. What the file states are steps of the stage; through
            a dry objective the focus moves further. In um, 0.001 um to 50 um. None: the stack's
            own.
        first_slice : {"bottom", "top"} or None
            Where the first slice of a stack lies: bottom, where the cell stands on its support, or
            top. None: bottom.
        stack_stain : {"auto", "filled", "membrane"} or None
            What of the cell is bright in a stack. None: auto.
        spacing_um : float or None
            Distance between neighbouring masses. In um, above 0 um, at most 1000 um. None: such
            that a flat cell has about 2000 of them, a thick one about 4000 and 4 cubes across its
            thickness.
        any_size : bool, default False
            Accepts a cell whose size is impossible for a heart cell: longer than 400 um, shorter
            than 15 um, or with an area outside of `min_area_um2` to `max_area_um2`. Such a size
            usually means a wrong pixel size.
        modality : {"auto", "fluorescence", "brightfield", "mask"} or None
            How the picture was taken. None: auto.
        channel : int or None
            Channel of the picture, from 0. 0 to 10000. None: the first, or the luminance of a
            colour picture.
        frame : int or None
            Frame (time point) of the picture, from 0. 0 to 1000000. None: 0.
        threshold : float or None
            Threshold; a lower one includes more. Fluorescence: grey value above which a pixel
            belongs to the cell. Brightfield: least relative change of brightness per um of an edge.
            None: determined from the picture, and printed.
        smooth_um : float or None
            Scale of smoothing. In um, 0 um to 20 um. None: "0.5 um" for fluorescence, "0.8 um" for
            brightfield.
        seed : tuple[float, float] or None
            Takes the cell at this place: column and row in pixels from the top left.
        cell : int or str or None
            Which cell: "largest", or its number by size, 1 being the largest. None: largest; batch:
            all.
        label : int or None
            In a label mask, the grey value of the cell. 1 to 16777215. None: the largest cell.
        min_area_um2 : float or None
            Smallest expected area of a cell: studies leave out smaller ones (debris); elsewhere
            they are errors unless any size is allowed. In um^2, 0 um^2 to 100000000 um^2. None:
            "500 um^2".
        max_area_um2 : float or None
            Largest expected area of a cell: studies leave out larger ones (sheets, clumps);
            elsewhere they are errors unless any size is allowed. In um^2, above 0 um^2, at most
            100000000 um^2. None: "20000 um^2".
        allow_cut : bool, default False
            Accepts a cell although the frame of the picture cuts it.

        Returns
        -------
        Cell

        Raises
        ------
        FileNotFoundError
            There is no such file.
        ValueError
            No cell was found, or a setting is not possible; the message says how to mend it.

        Examples
        --------
        >>> import numpy as np, myospring
        >>> slices, rows, columns = np.mgrid[:12, :60, :140]
        >>> ellipsoid = ((columns - 70) / 60) ** 2 + ((rows - 30) / 20) ** 2 + ((slices - 5.5) / 4) ** 2 < 1
        >>> cell = myospring.Cell.from_stack(ellipsoid, pixel_size_um=0.5, z_step_um=1, modality="mask")
        >>> beat = myospring.simulate(cell)
        >>> bool(abs(beat.metrics["peak_shortening"] - 12) < 0.1)
        True
        """
        path, arrays = path_or_bytes(stack, "stack.tif", stack=True)
        # <given of stack>
        given = changed(
            ("shape.pixel_size", pixel_size_um, None),
            ("shape.z_step", z_step_um, None),
            ("shape.first_slice", first_slice, None),
            ("shape.stack_stain", stack_stain, None),
            ("shape.spacing", spacing_um, None),
            ("shape.any_size", any_size, False),
            ("segmentation.modality", modality, None),
            ("segmentation.channel", channel, None),
            ("segmentation.frame", frame, None),
            ("segmentation.threshold", threshold, None),
            ("segmentation.smooth", smooth_um, None),
            ("segmentation.seed", seed, None),
            ("segmentation.cell", cell, None),
            ("shape.label", label, None),
            ("segmentation.min_area", min_area_um2, None),
            ("segmentation.max_area", max_area_um2, None),
            ("segmentation.allow_cut", allow_cut, False),
        )
        # </given>
        return cls._made({"shape.stack": path, **given}, arrays)

    @classmethod
    def from_outline(
        cls,
        outline: ArrayLike | str | PathLike[str],
        *,
        # <signature of outline>
        pixel_size_um: float | None = None,
        cell: int | str | None = None,
        label: int | None = None,
        rotate_deg: float = 0.0,
        spacing_um: float | None = None,
        any_size: bool = False,
        profile: Literal["flat", "round", "dome", "slab"] = "flat",
        thickness_um: float = 10.0,
        # </signature>
    ) -> Cell:
        """The cell within an outline.

        Parameters
        ----------
        outline : array_like of shape (points, 2), or path
            Corners, um, y upward; or a file: GeoJSON, CSV, ImageJ's .roi or .zip, Cellpose's _outlines.txt.
        pixel_size_um : float or None
            Side of one pixel of a picture, or of an outline in pixels. Never guessed. In um, 0.001
            um to 50 um. None: the picture's own.
        cell : int or str or None
            Which cell: "largest", or its number by size, 1 being the largest. None: largest; batch:
            all.
        label : int or None
            In a label mask, the grey value of the cell. 1 to 16777215. None: the largest cell.
        rotate_deg : float, default 0.0
            Rotates an outline or built-in cell counter-clockwise before it is meshed. In deg, -360
            deg to 360 deg.
        spacing_um : float or None
            Distance between neighbouring masses. In um, above 0 um, at most 1000 um. None: such
            that a flat cell has about 2000 of them, a thick one about 4000 and 4 cubes across its
            thickness.
        any_size : bool, default False
            Accepts a cell whose size is impossible for a heart cell: longer than 400 um, shorter
            than 15 um, or with an area outside of `min_area_um2` to `max_area_um2`. Such a size
            usually means a wrong pixel size.
        profile : {"flat", "round", "dome", "slab"}, default "flat"
            Section of the cell across its plane. A thick cell is made of cubes; its greatest
            thickness is `thickness_um` in [material], and what a picture does not show of it is
            assumed.
        thickness_um : float, default 10.0
            Thickness of the cell; where it varies, the greatest. In um, above 0 um, at most 5000
            um.

        Returns
        -------
        Cell

        Raises
        ------
        FileNotFoundError
            There is no such file.
        ValueError
            The outline crosses itself, or a setting is not possible.

        Examples
        --------
        >>> import myospring
        >>> cell = myospring.Cell.from_outline([[0, 0], [120, 0], [120, 20], [0, 20]])
        >>> cell.dimensions.area_um2
        2400.0
        """
        arrays: dict[str, bytes] = {}
        if isinstance(outline, (str, PathLike)):
            path = os.fspath(outline)
        else:
            points = floats(outline)
            if points.ndim != 2 or points.shape[1] != 2:
                raise ValueError(f"an outline has the shape (points, 2), not {points.shape}")
            rows = "".join(f"{float(x)!r},{float(y)!r}\n" for x, y in points)
            path, arrays = "outline.csv", {"outline.csv": f"x_um,y_um\n{rows}".encode()}
        # <given of outline>
        given = changed(
            ("shape.pixel_size", pixel_size_um, None),
            ("segmentation.cell", cell, None),
            ("shape.label", label, None),
            ("shape.rotate", rotate_deg, 0.0),
            ("shape.spacing", spacing_um, None),
            ("shape.any_size", any_size, False),
            ("shape.profile", profile, "flat"),
            ("material.thickness", thickness_um, 10.0),
        )
        # </given>
        return cls._made({"shape.outline": path, **given}, arrays)

    @classmethod
    def builtin(
        cls,
        name: str | None = None,
        *,
        # <signature of built_in>
        rotate_deg: float = 0.0,
        spacing_um: float | None = None,
        profile: Literal["flat", "round", "dome", "slab"] = "flat",
        thickness_um: float = 10.0,
        # </signature>
    ) -> Cell:
        """A cell that comes with the package.

        Parameters
        ----------
        name : str or None
            Its name; None is the first, an adult ventricular cell.
        rotate_deg : float, default 0.0
            Rotates an outline or built-in cell counter-clockwise before it is meshed. In deg, -360
            deg to 360 deg.
        spacing_um : float or None
            Distance between neighbouring masses. In um, above 0 um, at most 1000 um. None: such
            that a flat cell has about 2000 of them, a thick one about 4000 and 4 cubes across its
            thickness.
        profile : {"flat", "round", "dome", "slab"}, default "flat"
            Section of the cell across its plane. A thick cell is made of cubes; its greatest
            thickness is `thickness_um` in [material], and what a picture does not show of it is
            assumed.
        thickness_um : float, default 10.0
            Thickness of the cell; where it varies, the greatest. In um, above 0 um, at most 5000
            um.

        Returns
        -------
        Cell

        Raises
        ------
        UnknownNameError
            There is no such cell.

        Examples
        --------
        >>> import myospring
        >>> round(myospring.Cell.builtin().dimensions.length_um)
        140
        """
        # <given of built_in>
        given = changed(
            ("shape.rotate", rotate_deg, 0.0),
            ("shape.spacing", spacing_um, None),
            ("shape.profile", profile, "flat"),
            ("material.thickness", thickness_um, 10.0),
        )
        # </given>
        if name is not None:
            given["shape.built_in"] = name
        return cls._made(given, {})

    @property
    def name(self) -> str:
        return self._native.name

    @property
    def positions(self) -> NDArray[np.float64]:
        return self._native.positions

    @property
    def triangles(self) -> NDArray[np.uint32]:
        return self._native.triangles

    @property
    def outline(self) -> list[NDArray[np.float64]]:
        return self._native.outline

    @property
    def mask(self) -> NDArray[np.bool_] | None:
        """The pixels of the cell in its picture, of shape (rows, columns); None without a picture."""
        found = self._native.mask
        return None if found is None else found[0]

    @property
    def dimensions(self) -> Dimensions:
        return Dimensions(*self._native.dimensions)

    @property
    def warnings(self) -> list[str]:
        return self._native.warnings

    def __repr__(self) -> str:
        size = self.dimensions
        masses, _, triangles = self._native.counts
        return (
            f"<myospring.Cell {self.name}: {size.length_um:.1f} x {size.width_um:.1f} um, "
            f"{size.area_um2:.0f} um^2, {masses} masses, {triangles} triangles>"
        )

    def _repr_svg_(self) -> str:
        return outline_svg(self.name, self.outline)

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        return _restored, (self._native.state(),)


@lru_cache(maxsize=8)
def _restored(state: bytes) -> Cell:
    """The cell of a state; a worker that gets it again and again finds it once."""
    return Cell(_native.Cell.of_state(state))


# Endings of outlines.
_OUTLINES = (".geojson", ".json", ".csv", ".roi", ".zip", ".txt")


def cell_of(cell: Cell | None) -> Cell:
    """The cell that was given, or the built-in one."""
    if cell is None:
        return Cell.builtin()
    if isinstance(cell, Cell):
        return cell
    if isinstance(cell, (str, PathLike)):
        name = os.fspath(cell)
        make = "from_outline" if Path(name).suffix.lower() in _OUTLINES else "from_image"
        answer = f'Cell.{make}("{name}", pixel_size_um=0.27)'
    else:
        answer = "Cell.from_image(array, pixel_size_um=0.27)"
    raise TypeError(f"cell is of type {type(cell).__name__}; give a Cell, such as myospring.{answer}")
