"""Myokit (CVODE): 1000 beats of the minimal model at 1 Hz, without logging, tolerances at their defaults.

usage: bench_myokit.py

SUNDIALS_PREFIX names where SUNDIALS is, if not in a usual place. Prints one JSON line.
"""

import os
import pathlib

import myokit

import quiet

BEATS = 1000

prefix = os.environ.get("SUNDIALS_PREFIX")
if prefix:
    myokit.SUNDIALS_INC = [str(pathlib.Path(prefix, "include"))]
    places = [pathlib.Path(prefix, lib) for lib in ("lib", "lib64", "lib/x86_64-linux-gnu", "lib/aarch64-linux-gnu")]
    myokit.SUNDIALS_LIB = [str(place) for place in places if place.is_dir()]

model = myokit.load_model(str(pathlib.Path(__file__).with_name("minimal_model_epi.mmt")))
model.validate()
protocol = myokit.Protocol()
# 0.5 per ms for 1 ms, 10 ms after each second.
protocol.schedule(0.5, 10, 1, 1000, 0)
simulation = myokit.Simulation(model, protocol)


def run():
    simulation.reset()
    simulation.run(1000 * BEATS, log=myokit.LOG_NONE)


run()
quiet.report("Myokit", myokit.__version__, 1, BEATS, "cbps", run)
