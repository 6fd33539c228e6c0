"""Compares many cells of a model read from a file with Myokit's CVODE, one beat each, in one run; prints JSON lines.

    pip install myokit==1.39.2 numpy       # and SUNDIALS, for example Debian's libsundials-dev
    cargo build --release -p myospring-verification --example cell_file_throughput
    python verification/cell-models/compare_speed.py target/release/examples/cell_file_throughput FILE...

Both beat once for 1000 ms on one core, with a value each ms and the same tolerance. Myospring's cells go side by side;
Myokit runs one after the other. The two take turns three times, and the fastest of each counts.
"""

import json
import subprocess
import sys
import time
import warnings
from pathlib import Path

import myokit
import myokit.formats
import numpy as np

warnings.simplefilter("ignore")
ROUNDS = 3
# Cells of Myokit a round.
CELLS = 20


def simulation_of(path: Path) -> myokit.Simulation:
    """The model; CellML files of ToR-ORd have their stimulus in their equations."""
    if path.suffix == ".mmt":
        model, protocol, _ = myokit.load(path)
        return myokit.Simulation(model, protocol)
    return myokit.Simulation(myokit.formats.importer("cellml").model(str(path)))


def cells_per_s(simulation: myokit.Simulation, tolerance: float) -> float:
    simulation.set_tolerance(tolerance, tolerance)
    times, start = np.arange(1000.0), time.process_time()
    for _ in range(CELLS):
        simulation.reset()
        simulation.run(1000.0, log_times=times)
    return CELLS / (time.process_time() - start)


def main() -> None:
    program, *files = sys.argv[1:]
    for path in map(Path, files):
        simulation = simulation_of(path)
        best: dict[float, list[float]] = {}
        for _ in range(ROUNDS):
            printed = subprocess.run([program, path], capture_output=True, text=True, check=True).stdout
            for own in map(json.loads, printed.replace("NaN", "null").splitlines()):
                tolerance = own["tolerance"]
                pair = best.setdefault(tolerance, [0.0, 0.0])
                pair[0] = max(pair[0], own["cells_per_s"])
                # CVODE's tolerance is absolute, too: 1e-6 is its usual one.
                pair[1] = max(pair[1], cells_per_s(simulation, min(tolerance, 1e-6)))
        for tolerance, (ours, theirs) in best.items():
            found = {"model": path.name, "tolerance": tolerance, "cells_per_s": ours, "myokit_cells_per_s": theirs}
            print(json.dumps(found | {"ratio": round(ours / theirs, 2)}), flush=True)


if __name__ == "__main__":
    main()
