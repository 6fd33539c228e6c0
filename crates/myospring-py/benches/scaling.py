"""How a study speeds up from one worker of Dask to two, and what it costs per member.

    pip install . distributed
    python benches/scaling.py

Runs alternate, and each says how many cores others took meanwhile: on a busy machine two workers cannot be twice as
fast as one. `work` is what the workers say that they worked, so `clock x workers / work` is what the engine costs.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time

import myospring

STUDY = """
kind = "{kind}"
metrics = ["peak_tension"]
[run.stimulus]
beats = {beats}
[parameters]
tau_si = {{ distribution = "uniform", low = 0.98, high = 1.02, relative = true }}
peak_tension = {{ distribution = "uniform", low = 20, high = 60 }}
[sampling]
sampler = "latin-hypercube"
size = {size}
"""


def busy() -> float:
    """Processor seconds of the whole machine."""
    with open("/proc/stat") as file:
        fields = [int(field) for field in file.readline().split()[1:]]
    return (sum(fields[:3]) + sum(fields[5:8])) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    from distributed import Client, LocalCluster

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, default=20_000)
    parser.add_argument("--beats", type=int, default=600)
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    print(f"myospring {myospring.__version__}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    for kind, size, beats in [("cell", given.cells, 5), ("beat", given.beats, 1)]:
        text = STUDY.format(kind=kind, size=size, beats=beats)
        clocks: dict[int, list[float]] = {1: [], 2: []}
        for _ in range(given.rounds):
            for workers in (1, 2):
                cluster = LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
                with cluster, Client(cluster) as client:
                    executor = client.get_executor(pure=False)
                    # What each worker makes once is not counted.
                    myospring.run_study(STUDY.format(kind=kind, size=32 * workers, beats=beats), executor)
                    start, before = time.perf_counter(), busy()
                    myospring.run_study(text, executor, batch_seconds=1.0, progress=False)
                    clock = time.perf_counter() - start
                    clocks[workers].append(clock)
                    cores = (busy() - before) / clock
                    print(f"{kind}: {size} members, {workers} worker(s): {clock:.2f} s, {cores:.2f} cores busy in all")
        one, two = (statistics.median(clocks[workers]) for workers in (1, 2))
        print(f"{kind}: {1000 * one / size:.2f} ms a member with one worker; two are {one / two:.2f} times as fast")


if __name__ == "__main__":
    main()
