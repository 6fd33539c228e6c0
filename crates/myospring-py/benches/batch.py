"""What `simulate_batch` costs beyond the same loop in Rust, and what a study takes in memory.

    pip install .                                              # or any wheel of this package
    cargo build --release -p myospring-verification --example batch_loop    # built as the wheel was
    python benches/batch.py ../../target/release/examples/batch_loop

Pairs of runs, one after the other and each first in turn, so that a busy machine is busy for both; times of the
processor and of the clock, their ratio the median over the pairs. Then the largest memory of a process that works on
studies of 1000 and of more members.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import time

import numpy as np

import myospring

NAMES = ["peak_tension_kpa", "tau_si"]
STUDY = """
kind = "{kind}"
metrics = ["peak_tension"]
[parameters]
tau_si = {{ distribution = "uniform", low = 0.98, high = 1.02, relative = true }}
peak_tension = {{ distribution = "uniform", low = 20, high = 60 }}
[sampling]
sampler = "latin-hypercube"
size = {size}
"""


def processor(who: int) -> float:
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def ours(members: int, threads: int, cell: myospring.Cell) -> tuple[float, float, float]:
    """Seconds of the clock and of the processor, and the sum of what the members shorten by."""
    share = np.arange(members) / members
    tau = myospring.parameters("coelho_2021")["tau_si"].value
    params = np.column_stack([20.0 + 40.0 * share, tau * (0.95 + 0.1 * share)])
    clock, used = time.perf_counter(), processor(resource.RUSAGE_SELF)
    values = myospring.simulate_batch(params, NAMES, cell, metrics=["peak_shortening"], threads=threads)
    return time.perf_counter() - clock, processor(resource.RUSAGE_SELF) - used, float(values.sum())


def loop(program: str, members: int, threads: int) -> tuple[float, float, float]:
    used = processor(resource.RUSAGE_CHILDREN)
    done = subprocess.run([program, str(members), str(threads)], check=True, capture_output=True, text=True)
    said = json.loads(done.stdout)
    return said["seconds"], processor(resource.RUSAGE_CHILDREN) - used, said["sum"]


def overhead(program: str, members: int, threads: int, pairs: int) -> None:
    cell = myospring.Cell.builtin()
    # The loop's processor time has its start and its mesh in it, which the cell above has had.
    start = statistics.median(loop(program, 0, threads)[1] for _ in range(5))
    ratios = []
    for pair in range(pairs):
        runs = [lambda: ours(members, threads, cell), lambda: loop(program, members, threads)]
        first, second = (run() for run in (runs if pair % 2 == 0 else runs[::-1]))
        batch, rust = (first, second) if pair % 2 == 0 else (second, first)
        assert abs(batch[2] - rust[2]) < 1e-6 * abs(rust[2]), "not the same numbers"
        ratios.append((batch[0] / rust[0], batch[1] / (rust[1] - start)))
        print(f"pair {pair + 1}: clock {batch[0]:.2f} and {rust[0]:.2f} s, processor {batch[1]:.2f} and {rust[1] - start:.2f} s")
    clock, used = (statistics.median(ratio) for ratio in zip(*ratios))
    print(f"simulate_batch of {members} members on {threads} thread(s) against the loop in Rust: "
          f"{100 * (used - 1):+.1f} % of the processor's time, {100 * (clock - 1):+.1f} % of the clock's")


MEMORY = """
import resource, sys, myospring
what, text, members = sys.argv[1], sys.argv[2], int(sys.argv[3])
if what == "batch":
    import numpy as np
    params = np.linspace(20, 60, members)[:, None]
    myospring.simulate_batch(params, ["peak_tension_kpa"], myospring.Cell.builtin(spacing_um=5), metrics=["peak_tension"])
else:
    myospring.run_study(text, progress=False)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


def memory(sizes: list[int]) -> None:
    for what, kind in [("batch", "beat"), ("study", "beat"), ("study", "cell")]:
        peaks = []
        for members in sizes if kind == "cell" else sizes[:2]:
            text = STUDY.format(kind=kind, size=members)
            if kind == "beat":
                text = text.replace("[parameters]", '[run.shape]\nspacing = "5 um"\n[parameters]')
            done = subprocess.run([sys.executable, "-c", MEMORY, what, text, str(members)], check=True, capture_output=True, text=True)
            peaks.append((members, int(done.stdout) / 1024))
        print(f"memory, {what} of {kind}s: " + ", ".join(f"{members} members {peak:.0f} MB" for members, peak in peaks))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?", help="the example batch_loop; without it only memory is looked at")
    parser.add_argument("--members", type=int, default=1000)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--sizes", type=int, nargs="+", default=[1000, 20_000, 200_000], help="members of the studies whose memory is looked at")
    given = parser.parse_args()
    print(f"myospring {myospring.__version__}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    if given.program:
        overhead(given.program, given.members, given.threads, given.pairs)
    memory(given.sizes)
