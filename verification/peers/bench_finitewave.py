"""Finitewave (Numba) on a sheet of human epicardial tissue: steps of a node per second, and the velocity of the wave.

usage: bench_finitewave.py COLUMNS THREADS

COLUMNS x COLUMNS nodes 0.25 mm apart, the minimal model EPI (Bueno-Orovio 2008), diffusion 1.171 cm^2/s, forward Euler
with steps of 0.02 ms, 100 ms of a wave from the left edge. Prints one JSON line.
"""

import os
import sys
from importlib.metadata import version

columns, threads = int(sys.argv[1]), int(sys.argv[2])
# Read when numba is imported.
os.environ["NUMBA_NUM_THREADS"] = str(threads)

import finitewave as fw

import quiet

SPACING_MM, STEP_MS, DIFFUSION = 0.25, 0.02, 0.1171


def sheet(until_ms, tracked):
    model = fw.BuenoOrovio()
    model.dt, model.dr, model.t_max, model.D_model, model.prog_bar = STEP_MS, SPACING_MM, until_ms, DIFFUSION, False
    # A rim of one node on each side is not tissue.
    model.cardiac_tissue = fw.CardiacTissue([columns + 2, columns + 2])
    model.stim_sequence = fw.StimSequence()
    model.stim_sequence.add_stim(fw.StimVoltageCoord(0, 1.0, 1, 4, 1, columns + 1))
    if tracked:
        model.tracker_sequence = fw.TrackerSequence()
        tracker = fw.ActivationTimeTracker()
        tracker.threshold = 0.5
        model.tracker_sequence.add_tracker(tracker)
    model.run(num_of_threads=threads)
    return tracker if tracked else model


def velocity():
    """Between a half and three quarters of the middle row, cm/s."""
    times = sheet(1000 * SPACING_MM * columns / 500, True).act_t[:, columns // 2]
    start, end = 1 + columns // 2, 1 + 3 * columns // 4
    return 100 * SPACING_MM * (end - start) / (times[end] - times[start])


# It compiles in the first run.
wave = velocity()
UNTIL_MS = 100.0
quiet.report(
    "finitewave",
    version("finitewave"),
    threads,
    columns * columns * UNTIL_MS / STEP_MS,
    "node_steps",
    lambda: sheet(UNTIL_MS, False),
    {"velocity_cm_per_s": wave},
)
