"""Settings by name, of a beat and of the picture of a cell. `generate.py` writes them."""

from __future__ import annotations

from os import PathLike
from typing import Any, Literal, Mapping

from myospring._functions import BEAT_KEYS, BeatSettings
from myospring._given import changed


class PictureSettings(BeatSettings, total=False):
    """The settings of `simulate` and those that find a cell in a picture, by name."""

    # <typed of film>
    any_size: bool
    profile: Literal["flat", "round", "dome", "slab"]
    spacing_um: float | None
    modality: Literal["auto", "fluorescence", "brightfield", "mask"] | None
    channel: int | None
    frame: int | None
    z: int | str | None
    threshold: float | None
    smooth_um: float | None
    min_area_um2: float | None
    max_area_um2: float | None
    allow_cut: bool
    outline: str | PathLike[str] | None
    thickness_um: float
    # </typed>


_PICTURE_KEYS: Mapping[str, tuple[str, Any]] = {
    # <keys of film>
    "any_size": ("shape.any_size", False),
    "profile": ("shape.profile", "flat"),
    "spacing_um": ("shape.spacing", None),
    "modality": ("segmentation.modality", None),
    "channel": ("segmentation.channel", None),
    "frame": ("segmentation.frame", None),
    "z": ("segmentation.z", None),
    "threshold": ("segmentation.threshold", None),
    "smooth_um": ("segmentation.smooth", None),
    "min_area_um2": ("segmentation.min_area", None),
    "max_area_um2": ("segmentation.max_area", None),
    "allow_cut": ("segmentation.allow_cut", False),
    "outline": ("segmentation.outline", None),
    "thickness_um": ("material.thickness", 10.0),
    # </keys>
}


def given_of_beat(function: str, settings: Mapping[str, Any], override: bool = False) -> dict[str, Any]:
    """Returns the settings of a beat by key; without defaults, unless they override those of a run file."""
    return _given(function, BEAT_KEYS, settings, override)


def given_of_picture(
    function: str, pixel_size_um: float | None, settings: Mapping[str, Any], override: bool = False
) -> dict[str, Any]:
    """Returns the settings of a beat and of its cell's picture by key, as `given_of_beat` does."""
    given = _given(function, {**BEAT_KEYS, **_PICTURE_KEYS}, settings, override)
    return changed(("shape.pixel_size", pixel_size_um, None)) | given


def _given(
    function: str, known: Mapping[str, tuple[str, Any]], settings: Mapping[str, Any], override: bool
) -> dict[str, Any]:
    for name in settings:
        if name not in known:
            near = next((one for one in known if one.startswith(f"{name}_")), None)
            meant = "" if near is None else f"; did you mean '{near}'?"
            raise TypeError(f"{function}() got an unexpected keyword argument '{name}'{meant}")
    return changed(
        *((known[name][0], value, None if override else known[name][1]) for name, value in settings.items())
    )
