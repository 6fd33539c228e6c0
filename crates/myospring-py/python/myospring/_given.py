"""Converts arguments to the input of the library."""

from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any, Iterator

import numpy as np
from numpy.typing import ArrayLike

from myospring import _native

def changed(*settings: tuple[str, Any, Any]) -> dict[str, Any]:
    """Returns settings by key from triples of key, value and default; default values are omitted, as in a run file."""
    return {
        key: os.fspath(value) if isinstance(value, PathLike) else value
        for key, value, default in settings
        if not (value is default or (type(value) is type(default) and value == default))
    }


def floats(array: ArrayLike) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Returns a contiguous array of numbers; masked ones are NaN."""
    values = np.ascontiguousarray(array, dtype=np.float64)
    hidden: np.ndarray[Any, np.dtype[np.bool_]] = np.ma.getmaskarray(np.ma.asanyarray(array))
    return np.where(hidden, np.nan, values) if hidden.any() else values


def path_or_bytes(
    image: ArrayLike | str | PathLike[str], name: str, stack: bool = False
) -> tuple[str, dict[str, bytes]]:
    """Returns the path of a picture or of a stack of them, or a name that represents its bytes."""
    if isinstance(image, (str, PathLike)):
        return os.fspath(image), {}
    if np.ma.is_masked(image):
        raise ValueError("a picture has a value at every pixel; fill what the mask hides, as image.filled(0) does")
    return name, {name: _native.tiff(_pixels(np.asarray(image)), stack)}


@contextmanager
def film_path(film: str | PathLike[str] | ArrayLike) -> Iterator[str]:
    """Yields the path of a film; the frames of an array are files as long as it is read."""
    if isinstance(film, (str, PathLike)):
        yield os.fspath(film)
        return
    frames: np.ndarray[Any, Any] = np.ma.asanyarray(film)
    if frames.ndim != 3:
        raise ValueError(f"a film of the shape {frames.shape} is none; give (frames, rows, columns), in grey")
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "film"
        place.mkdir()
        for number, picture in enumerate(frames):
            _, arrays = path_or_bytes(picture, "frame.tif")
            (place / f"frame_{number:06}.tif").write_bytes(arrays["frame.tif"])
        yield os.fspath(place)


def _pixels(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Converts an array to a pixel type of pictures, without visible loss."""
    if array.dtype.kind == "b":
        array = array.astype(np.uint8)
    elif array.dtype.kind == "f":
        array = array.astype(np.float32)
    elif array.dtype.kind in "iu" and array.dtype not in (np.uint8, np.uint16):
        if array.size and (array.min() < 0 or array.max() > np.iinfo(np.uint32).max):
            raise ValueError("a picture of whole numbers has values from 0 to 4294967295")
        array = array.astype(np.uint16 if not array.size or array.max() < 2**16 else np.uint32)
    elif array.dtype.kind not in "iu":
        raise TypeError(f"a picture has numbers as pixels, not {array.dtype}")
    return np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))
