"""Compares trains of cell models read from files with Myokit's CVODE; prints a table in Markdown.

    pip install myokit==1.39.2 numpy       # and SUNDIALS, for example Debian's libsundials-dev
    cargo build --release -p myospring-verification --example cell_file_train
    python verification/cell-models/compare_trains.py target/release/examples/cell_file_train FILE...

Each model is paced at 1 Hz with the stimulus that Myospring found in its file. Differences are those of the potential in
the last of five beats, each ms, as a part of its range, without the ms around the upstroke, where a shift by some
microseconds is a large difference: there the time of the upstroke is compared, in ms. CVODE has a tolerance of 1e-8.
"""

import json
import multiprocessing
import subprocess
import sys
import time
import warnings
from pathlib import Path

import myokit
import myokit.formats
import numpy as np

warnings.simplefilter("ignore")
BEATS = 5
# CVODE may need very long where equations jump.
LONGEST_S = 90


def simulation_of(path: Path, own: dict) -> tuple[myokit.Simulation, float]:
    """The model with the stimulus as a paced variable, and ms per unit of its time."""
    model = myokit.load_model(path) if path.suffix == ".mmt" else myokit.formats.importer("cellml").model(str(path))
    to_ms = 1e3 if str(model.time().unit()) == "[s]" else 1.0
    for bound in list(model.bindings()):
        if bound[0] == "pace":
            bound[1].set_binding(None)
    potential = model.get(own["potential"])
    if own["stimulus"] is None:
        pace = potential.parent().add_variable("paced_here")
        pace.set_rhs(0)
        potential.set_rhs(myokit.Plus(potential.rhs(), myokit.Name(pace)))
        sign = to_ms
    else:
        pace = model.get(own["stimulus"])

        def rate(value: float) -> float:
            pace.set_rhs(value)
            return model.evaluate_derivatives(ignore_errors=True)[potential.index()]

        sign = 1 if rate(1.0) > rate(0.0) else -1
        pace.set_rhs(0)
    pace.set_binding("pace")
    protocol = myokit.Protocol()
    start, duration, cycle = (own[key] / to_ms for key in ("start_ms", "duration_ms", "cycle_ms"))
    protocol.schedule(sign * own["amplitude"], start, duration, cycle, 0)
    return myokit.Simulation(model, protocol), to_ms


def last_beat(simulation, to_ms: float, own: dict, tolerance: float) -> tuple[np.ndarray, float]:
    """The potential each ms of the last beat, and ms of computing a beat."""
    simulation.reset()
    simulation.set_tolerance(tolerance, tolerance)
    cycle = own["cycle_ms"] / to_ms
    start = time.process_time()
    simulation.run(cycle * (BEATS - 1), log=myokit.LOG_NONE)
    log = simulation.run(cycle * 1.001, log=[own["potential"]], log_times=cycle * (BEATS - 1) + np.arange(1001) / to_ms)
    return np.array(log[own["potential"]]), 1e3 * (time.process_time() - start) / BEATS


def crossing(values: np.ndarray) -> float:
    """When it first passes the middle of its range, ms."""
    middle = 0.5 * (values.min() + values.max())
    after = int(np.argmax(values > middle))
    if after == 0:
        return 0.0
    return after - (values[after] - middle) / (values[after] - values[after - 1])


def row(program: str, path: Path) -> str:
    done = subprocess.run([program, path, str(BEATS)], capture_output=True, text=True)
    if done.returncode:
        return f"| {path.name} | | | | {' '.join(done.stderr.split())[:150]} |"
    own = json.loads(done.stdout)
    simulation, to_ms = simulation_of(path, own)
    exact, _ = last_beat(simulation, to_ms, own, 1e-8)
    _, theirs = last_beat(simulation, to_ms, own, 1e-6)
    size = exact.max() - exact.min()
    cells = []
    for run in own["runs"]:
        values = np.array(run["potential"])
        near = np.abs(np.gradient(exact)) > 0.05 * size
        near = np.convolve(near, np.ones(5), "same") > 0
        off = np.abs(values - exact)[~near].max() / size
        cells.append(f"{off:.1e}, {crossing(values) - crossing(exact):+.4f} ms")
    return f"| {path.name} | {cells[0]} | {cells[1]} | {own['runs'][0]['ms_a_beat']:.1f} | {theirs:.1f} |"


def printed(program: str, path: Path) -> None:
    try:
        print(row(program, path), flush=True)
    except Exception as error:  # A model that Myokit cannot run.
        print(f"| {path.name} | | | | Myokit: {' '.join(str(error).split())[:120]} |", flush=True)


def main() -> None:
    program, *files = sys.argv[1:]
    print("| model | tolerance 1e-5 | 1e-7 | ms a beat | CVODE 1e-6 |\n|---|---|---|---|---|", flush=True)
    for path in sorted(map(Path, files), key=lambda path: (path.suffix, path.name.lower())):
        process = multiprocessing.Process(target=printed, args=(program, path))
        process.start()
        process.join(LONGEST_S)
        if process.is_alive():
            process.kill()
            print(f"| {path.name} | | | | CVODE is not done after {LONGEST_S} s |", flush=True)


if __name__ == "__main__":
    main()
