"""Myospring: from a microscope picture of a heart cell to its beat.

>>> import myospring
>>> beat = myospring.simulate(peak_tension_kpa=30, integrator="quasi-static")
>>> bool(7 < beat.metrics["peak_shortening"] < 8)
True

Every name ends in its unit: ``peak_tension_kpa`` is in kPa, ``t_ms`` in ms. Names, defaults and numbers are those of
the program ``myospring``, which comes with this package. What it notes while it works goes to the logger
``myospring``, what to look at before numbers are used is a warning, `MyospringWarning`.
"""

import logging

from myospring._action_potential import ActionPotential
from myospring._analyse import AnalysedCurve, Analysis, BeatLoop, MeasuredBeat, PairedBeat, PairedCurves, analyse
from myospring._batch import simulate_batch
from myospring._beat import Beat, SimulationError
from myospring._cell import Cell
from myospring._compare import Comparison, compare
from myospring._errors import MyospringWarning, UnknownNameError
from myospring._fit import Fit, fit
from myospring._fit_answer import Estimate, FilmDistances, FittedCurve, OwnTension, TriedModel
from myospring._fit_many import Fits, fit_many
from myospring._functions import action_potential, simulate
from myospring._lists import METRICS, Metric, Parameter, models, parameters
from myospring._native import __version__
from myospring._pictures import Batch, batch
from myospring._presets import presets, simulate_preset
from myospring._segment import SegmentedCell, Segmentation, segment
from myospring._study import Index, Morris, Sobol, StudyResult, run_study
from myospring._tension_map import TensionFrames, TensionMap, tension_map
from myospring._tissue import Posts, TissueWaves, map_waves, track_posts
from myospring._track import FilmCells, Motion, track
from myospring._traction import Tractions, traction
from myospring._whole_frame import WholeFrame, whole_frame

# Without a handler of the user's, nothing is shown.
logging.getLogger("myospring").addHandler(logging.NullHandler())

__all__ = [
    "METRICS",
    "ActionPotential",
    "AnalysedCurve",
    "Analysis",
    "Batch",
    "Beat",
    "BeatLoop",
    "Cell",
    "Comparison",
    "Estimate",
    "FilmCells",
    "FilmDistances",
    "Fit",
    "Fits",
    "FittedCurve",
    "Index",
    "MeasuredBeat",
    "Metric",
    "Morris",
    "Motion",
    "MyospringWarning",
    "OwnTension",
    "PairedBeat",
    "PairedCurves",
    "Parameter",
    "Posts",
    "Segmentation",
    "SegmentedCell",
    "SimulationError",
    "Sobol",
    "StudyResult",
    "TensionFrames",
    "TensionMap",
    "TissueWaves",
    "Tractions",
    "TriedModel",
    "UnknownNameError",
    "WholeFrame",
    "__version__",
    "action_potential",
    "analyse",
    "batch",
    "compare",
    "fit",
    "fit_many",
    "map_waves",
    "models",
    "parameters",
    "presets",
    "run_study",
    "segment",
    "simulate",
    "simulate_batch",
    "tension_map",
    "simulate_preset",
    "track",
    "track_posts",
    "traction",
    "whole_frame",
]
