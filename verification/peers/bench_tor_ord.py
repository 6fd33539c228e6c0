"""ToR-ORd by Myokit (CVODE) and by Myospring, turn by turn in one run: beats per second of processor time.

usage: bench_tor_ord.py CELLML PROGRAM

CELLML is ToRORd_fkatp_endo.cellml of https://github.com/jtmff/torord (GPL-3, not part of this project), PROGRAM the
built example tor_ord_throughput. Both pace one endocardial cell at 1 Hz, without logging, and say how far the 20th beat
is from their own converged one: APD90 (ms) and the peak of calcium (%); Myospring also a population of 1000 cells, one
beat each, sampled. Prints a table; the ratio is over Myokit's fastest tolerance whose errors are as small.

SUNDIALS_PREFIX names where SUNDIALS is, if not in a usual place.
"""

import json
import os
import pathlib
import platform
import subprocess
import sys
import time

import myokit
import myokit.formats
import numpy as np

BEATS = 20
TURNS = 3
# Relative and absolute alike.
TOLERANCES = [1e-4, 1e-5, 1e-6, 1e-7]
CONVERGED = 1e-10

prefix = os.environ.get("SUNDIALS_PREFIX")
if prefix:
    myokit.SUNDIALS_INC = [str(pathlib.Path(prefix, "include"))]
    places = [pathlib.Path(prefix, lib) for lib in ("lib", "lib64", "lib/x86_64-linux-gnu", "lib/aarch64-linux-gnu")]
    myokit.SUNDIALS_LIB = [str(place) for place in places if place.is_dir()]


def simulation_of(file):
    """The cell with its own stimulus, -53 A/F for 1 ms, as events at which CVODE starts anew."""
    model = myokit.formats.importer("cellml").model(file)
    stimulus = model.get("membrane.Istim")
    stimulus.set_rhs(0)
    stimulus.set_binding("pace")
    protocol = myokit.Protocol()
    protocol.schedule(-53, 0, 1, 1000, 0)
    return myokit.Simulation(model, protocol)


def beat(simulation, tolerance):
    """APD90 from the stimulus, ms, and the largest calcium of the last beat, mM."""
    simulation.reset()
    simulation.set_tolerance(tolerance, tolerance)
    simulation.run(1000 * (BEATS - 1), log=myokit.LOG_NONE)
    keys = ["membrane.v", "intracellular_ions.cai"]
    v, calcium = (np.array(column) for column in simulation.run(1000, log=keys, log_interval=0.05).npview().values())
    level = v.max() - 0.9 * (v.max() - v[0])
    last = np.nonzero(v > level)[0][-1]
    part = (v[last] - level) / (v[last] - v[last + 1])
    return 0.05 * (last + part), calcium.max()


def myokit_rate(simulation, tolerance):
    """Beats per second of processor time."""
    simulation.reset()
    simulation.set_tolerance(tolerance, tolerance)
    start = time.process_time()
    simulation.run(1000 * BEATS, log=myokit.LOG_NONE)
    return BEATS / (time.process_time() - start)


def main(file, program):
    simulation = simulation_of(file)
    exact = beat(simulation, CONVERGED)
    theirs = {tolerance: [] for tolerance in TOLERANCES}
    ours = {}
    for _ in range(TURNS):
        for tolerance, rates in theirs.items():
            rates.append(myokit_rate(simulation, tolerance))
        lines = subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()
        for line in map(json.loads, lines):
            ours.setdefault((line["name"], line["tolerance"]), []).append(line)
    print(f"{platform.machine()}, {cpu()}, {os.cpu_count()} virtual cores; medians of {TURNS} turns\n")
    print("| program | tolerance | beats per second of processor time | error of APD90, ms | of calcium, % | over Myokit |")
    print("|---|---|---|---|---|---|")
    rows = []
    for tolerance, rates in theirs.items():
        apd, calcium = beat(simulation, tolerance)
        errors = abs(apd - exact[0]), 100 * abs(calcium / exact[1] - 1)
        rows.append((errors, float(np.median(rates))))
        print(line_of(f"Myokit {myokit.__version__}, CVODE", tolerance, rows[-1][1], errors, ""))
    for (name, tolerance), lines in ours.items():
        errors = lines[0]["apd90_error_ms"], lines[0]["calcium_error_percent"]
        rate = float(np.median([line["cbps_cpu"] for line in lines]))
        as_exact = [their for error, their in rows if all(e <= max(o, 1e-3) for e, o in zip(error, errors))]
        ratio = f"{rate / max(as_exact):.1f}" if as_exact else "more exact than all"
        print(line_of(name, tolerance, rate, errors, ratio))


def line_of(name, tolerance, rate, errors, ratio):
    return f"| {name} | {tolerance:.0e} | {rate:.0f} | {errors[0]:.1e} | {errors[1]:.1e} | {ratio} |"


def cpu():
    """What the system calls the processor."""
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), "")


if __name__ == "__main__":
    main(*sys.argv[1:3])
