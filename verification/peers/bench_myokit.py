"""Myokit (CVODE): 1000 beats of the minimal model with tension at 1 Hz, at several tolerances, with their errors.

usage: bench_myokit.py

Prints one JSON line a tolerance. The beats are timed without logging, though numbers such as the action potential's
duration would need it; errors of peak tension and APD90 are the largest over five beats, against the converged
solution by SciPy that the Rust tests compare with.

SUNDIALS_PREFIX names where SUNDIALS is, if not in a usual place.
"""

import csv
import os
import pathlib

import myokit
import numpy as np

import quiet

BEATS = 1000
START_MS, CYCLE_MS = 50, 1000
# Absolute and relative alike; 1e-6 and 1e-4 are Myokit's own.
TOLERANCES = [(1e-6, 1e-4), (1e-5, 1e-5), (1e-6, 1e-6), (1e-7, 1e-7), (1e-8, 1e-8)]
HERE = pathlib.Path(__file__).parent
CONVERGED = HERE.parent.parent / "crates/myospring/tests/reference/cell_converged.csv"

prefix = os.environ.get("SUNDIALS_PREFIX")
if prefix:
    myokit.SUNDIALS_INC = [str(pathlib.Path(prefix, "include"))]
    places = [pathlib.Path(prefix, lib) for lib in ("lib", "lib64", "lib/x86_64-linux-gnu", "lib/aarch64-linux-gnu")]
    myokit.SUNDIALS_LIB = [str(place) for place in places if place.is_dir()]

model = myokit.load_model(str(HERE / "minimal_model_epi.mmt"))
model.validate()
protocol = myokit.Protocol()
# 0.5 per ms for 1 ms, at the start of each second.
protocol.schedule(0.5, START_MS, 1, CYCLE_MS, 0)
simulation = myokit.Simulation(model, protocol)


def converged():
    """Peak tension and APD90 (ms) of each beat."""
    with open(CONVERGED) as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        own = [row for row in rows if row["model"] == model.name() and float(row["cycle_length_ms"]) == CYCLE_MS]
    return [(float(row["peak_ta"]), float(row["apd90_ms"])) for row in own]


def errors():
    """Largest errors of peak tension (%) and APD90 (ms)."""
    known = converged()
    step = 0.05
    simulation.reset()
    log = simulation.run(START_MS + CYCLE_MS * len(known), log=["mv.u", "tension.Ta"], log_interval=step).npview()
    tension, apd = 0.0, 0.0
    for beat, (peak, duration) in enumerate(known):
        first = round((START_MS + beat * CYCLE_MS) / step)
        u, ta = (log[name][first : first + round(CYCLE_MS / step)] for name in ("mv.u", "tension.Ta"))
        top = int(np.argmax(u))
        level = u[0] + 0.1 * (u[top] - u[0])
        below = top + int(np.argmax(u[top:] < level))
        found = (below - (level - u[below]) / (u[below - 1] - u[below])) * step
        tension = max(tension, 100 * abs(ta.max() / peak - 1))
        apd = max(apd, abs(found - duration))
    return {"tension_error_percent": tension, "apd90_error_ms": apd}


def run():
    simulation.reset()
    simulation.run(CYCLE_MS * BEATS, log=myokit.LOG_NONE)


for absolute, relative in TOLERANCES:
    simulation.set_tolerance(absolute, relative)
    of = {"absolute_tolerance": absolute, "relative_tolerance": relative, **errors()}
    quiet.report("Myokit", myokit.__version__, 1, BEATS, "cbps", run, of)
