"""The cells of a picture. `generate.py` writes what it takes of settings."""

from __future__ import annotations

import html
import json
import os
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, Iterator, Literal, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from myospring import _native
from myospring._errors import warn
from myospring._given import changed, path_or_bytes
from myospring._progress import Progress, heard

# What a report has of a cell that is none of its shape in numbers.
_OTHER = ("number", "name", "confidence", "warnings", "lattice", "fibres")


@dataclass(frozen=True, eq=False)
class SegmentedCell:
    """A cell that was found in a picture.

    Attributes
    ----------
    name : str
        Its number by size, or the label or name that a file gives.
    number : int
        Its number by size, 1 being the largest.
    confidence : float
        How sure its outline is, from 0 to 1.
    doubts : list of str
        What speaks against the outline.
    contrast : float or None
        How far it stands out, in units of the noise; None for a mask or a drawn outline.
    outline : list of ndarray of shape (points, 2)
        The rings of its outline, um, the outer one first; x to the right, y upward.
    mask : ndarray of shape (rows, columns)
        Its pixels in the picture.
    shape : dict of str to float
        Size and shape in numbers: ``area_um2``, ``length_um``, ``width_um``, ``aspect_ratio``, ``solidity`` and others.
    sarcomere_um : float or None
        Median length of its sarcomeres, um; None where the picture shows none.
    """

    name: str
    number: int
    confidence: float
    doubts: list[str]
    contrast: float | None
    outline: list[NDArray[np.float64]] = field(repr=False)
    mask: NDArray[np.bool_] = field(repr=False)
    shape: dict[str, float] = field(repr=False)
    sarcomere_um: float | None

    def __repr__(self) -> str:
        area, length = self.shape["area_um2"], self.shape["length_um"]
        return (
            f"<myospring.SegmentedCell {self.name}: {area:.0f} um^2, {length:.0f} um long, "
            f"confidence {self.confidence:.2f}>"
        )


class Segmentation(Sequence[SegmentedCell]):
    """The cells of a picture, the largest first. `segment` makes one.

    Attributes
    ----------
    picture : str
        The picture.
    modality : str
        What it was taken for: fluorescence, brightfield, mask or drawn outlines.
    pixel_size_um : float
        Side of a pixel, um.
    left_out : dict of int to str
        Why a cell is not among them, by its number.
    warnings : list of str
        What a person should look at.
    """

    def __init__(self, native: _native.Segmentation) -> None:
        self._native = native
        report = json.loads(native.numbers)
        self.picture: str = report["picture"]
        self.modality: str = report["modality"]
        self.pixel_size_um: float = report["pixel_size_um"]
        self.left_out: dict[int, str] = {cell["number"]: cell["reason"] for cell in report["left_out"]}
        self.warnings: list[str] = native.warnings
        self._cells = [_cell(*cell) for cell in zip(report["cells"], native.outlines, native.masks)]

    def __len__(self) -> int:
        return len(self._cells)

    def __getitem__(self, index: Any) -> Any:
        return self._cells[index]

    def __iter__(self) -> Iterator[SegmentedCell]:
        return iter(self._cells)

    def to_dataframe(self) -> Any:
        """Shape and confidence of each cell as a table; it needs pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each cell, whose name is the index.
        """
        import pandas

        rows = [
            {"confidence": cell.confidence, "contrast": cell.contrast, **cell.shape, "sarcomere_um": cell.sarcomere_um}
            for cell in self
        ]
        return pandas.DataFrame(rows, index=pandas.Index([cell.name for cell in self], name="cell"))

    def save(self, target: str | PathLike[str], *, force: bool = False) -> Path:
        """Writes the outlines: all results into a folder, or a file in the format of its ending.

        Parameters
        ----------
        target : path
            A name without an ending is a folder, for what ``myospring segment`` writes: outlines, masks, overlay and
            report. Else the ending says what the file holds: ``.geojson`` (um), ``.roi`` or ``.zip`` (ImageJ), ``.txt``
            (Cellpose), ``.png`` (mask; of several cells a label mask); an overlay is written beside it.
        force : bool
            Replaces what is there.

        Returns
        -------
        pathlib.Path
            The folder or the file.

        Raises
        ------
        OSError
            It is there, or cannot be written.
        """
        path = Path(target)
        if path.suffix:
            self._native.write(os.fspath(path), force)
            return path
        return Path(self._native.save(os.fspath(path), force))

    def __repr__(self) -> str:
        count = "1 cell" if len(self) == 1 else f"{len(self)} cells"
        return f"<myospring.Segmentation of {self.picture}: {count}, {self.modality}>"

    def _repr_svg_(self) -> str:
        return self._native.overlay_svg()

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(cell.name)}</td><td>{cell.confidence:.2f}</td>"
            f"<td>{cell.shape['area_um2']:.0f}</td><td>{cell.shape['length_um']:.1f}</td></tr>"
            for cell in self
        )
        heading = "<tr><th>cell</th><th>confidence</th><th>area (um²)</th><th>length (um)</th></tr>"
        warnings = "".join(f"<p>Warning: {html.escape(text)}</p>" for text in self.warnings)
        title = html.escape(repr(self)[1:-1])
        return f"<div><b>{title}</b>{self._repr_svg_()}<table>{heading}{rows}</table>{warnings}</div>"


def _cell(row: dict[str, Any], outline: list[NDArray[np.float64]], mask: NDArray[np.bool_]) -> SegmentedCell:
    sure, fibres = row["confidence"], row.get("fibres") or {}
    return SegmentedCell(
        name=row["name"],
        number=row["number"],
        confidence=sure["score"],
        doubts=sure["reasons"],
        contrast=sure["contrast"],
        outline=outline,
        mask=mask,
        shape={name: value for name, value in row.items() if name not in _OTHER},
        sarcomere_um=fibres.get("sarcomere_um"),
    )


def segment(
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
    stain: Literal["z-disc", "filament"] | None = None,
    progress: Progress = None,
) -> Segmentation:
    """The cells of a picture: outlines, how sure they are, shape in numbers. Nothing beats.

    All cells, unless `cell` or `seed` names one. Cells that the frame cuts, and those whose size no heart cell has, are
    left out with the reason.

    Parameters
    ----------
    image : array_like of shape (rows, columns) or (rows, columns, 3), or path
        Grey values or colours, the first row on top; or a file: PNG, TIFF or OME-TIFF.
    pixel_size_um : float or None
        Side of one pixel of a picture, or of an outline in pixels. Never guessed. In um, 0.001 um
        to 50 um. None: the picture's own.
    any_size : bool, default False
        Accepts a cell whose size is impossible for a heart cell: longer than 400 um, shorter than
        15 um, or with an area outside of `min_area_um2` to `max_area_um2`. Such a size usually
        means a wrong pixel size.
    profile : {"flat", "round", "dome", "slab"}, default "flat"
        Section of the cell across its plane. A thick cell is made of cubes; its greatest thickness
        is `thickness_um` in [material], and what a picture does not show of it is assumed.
    spacing_um : float or None
        Distance between neighbouring masses. In um, above 0 um, at most 1000 um. None: such that a
        flat cell has about 2000 of them, a thick one about 4000 and 4 cubes across its thickness.
    modality : {"auto", "fluorescence", "brightfield", "mask"} or None
        How the picture was taken. None: auto.
    channel : int or None
        Channel of the picture, from 0. 0 to 10000. None: the first, or the luminance of a colour
        picture.
    frame : int or None
        Frame (time point) of the picture, from 0. 0 to 1000000. None: 0.
    z : int or str or None
        How a stack in depth is reduced: "max", "mean", or the number of a slice, from 0. None: max.
    threshold : float or None
        Threshold; a lower one includes more. Fluorescence: grey value above which a pixel belongs
        to the cell. Brightfield: least relative change of brightness per um of an edge. None:
        determined from the picture, and printed.
    smooth_um : float or None
        Scale of smoothing. In um, 0 um to 20 um. None: "0.5 um" for fluorescence, "0.8 um" for
        brightfield.
    seed : tuple[float, float] or None
        Takes the cell at this place: column and row in pixels from the top left.
    cell : int or str or None
        Which cell: "largest", or its number by size, 1 being the largest. None: largest; batch:
        all.
    min_area_um2 : float or None
        Smallest expected area of a cell: studies leave out smaller ones (debris); elsewhere they
        are errors unless any size is allowed. In um^2, 0 um^2 to 100000000 um^2. None: "500 um^2".
    max_area_um2 : float or None
        Largest expected area of a cell: studies leave out larger ones (sheets, clumps); elsewhere
        they are errors unless any size is allowed. In um^2, above 0 um^2, at most 100000000 um^2.
        None: "20000 um^2".
    allow_cut : bool, default False
        Accepts a cell although the frame of the picture cuts it.
    outline : str or PathLike[str] or None
        Outline of the cell drawn on the picture in another program, instead of segmentation:
        GeoJSON, ImageJ's .roi or RoiSet .zip, Cellpose's _outlines.txt.
    thickness_um : float, default 10.0
        Thickness of the cell; where it varies, the greatest. In um, above 0 um, at most 5000 um.
    stain : {"z-disc", "filament"} or None
        What the picture shows: stripes across the fibre or threads along it. None: z-discs, if stripes as far apart as
        sarcomeres are found.
    progress : callable, bool or None
        As in `track`.

    Returns
    -------
    Segmentation
        A sequence of `SegmentedCell`, the largest first.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        No cell was found, or a setting is not possible; the message says how to mend it.

    Examples
    --------
    >>> import numpy as np, myospring
    >>> rows, columns = np.mgrid[:200, :320]
    >>> def inside(row):
    ...     return ((columns - 160) / 120) ** 2 + ((rows - row) / 30) ** 2 < 1
    >>> noise = np.random.default_rng(0).normal(0, 3, rows.shape)
    >>> picture = (20 + 180 * (inside(50) | inside(150)) + noise).clip(0, 255).astype(np.uint8)
    >>> cells = myospring.segment(picture, pixel_size_um=0.5)
    >>> len(cells), bool(abs(cells[0].shape["length_um"] - 120) < 3)
    (2, True)
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
    given |= changed(("mechanics.stain", stain, None))
    every = cell is None and seed is None
    found = Segmentation(_native.segment({"shape.picture": path, **given}, arrays, every, heard(progress)))
    warn(found.warnings)
    return found
