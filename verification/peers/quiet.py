"""Wall times on a machine that others use, too: waits for the others, and keeps the quietest runs."""

import json
import os
import resource
import statistics
import time

# What other processes may take while a program runs, in cores.
TOLERATED = 0.12
PATIENCE_S = 5.0
RUNS, MOST_RUNS = 3, 7


def busy_s():
    """Processor seconds of the whole machine since it started; 0 where the system does not tell."""
    try:
        with open("/proc/stat") as file:
            fields = [int(field) for field in file.readline().split()[1:]]
    except OSError:
        return 0.0
    # User, nice, system, interrupts and what other virtual machines took.
    return (sum(fields[:3]) + sum(fields[5:8])) / os.sysconf("SC_CLK_TCK")


def own_s():
    """Processor seconds of this process."""
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


class Others:
    """Within `with`, how many cores other processes take on average: `cores`."""

    def __enter__(self):
        self.begin = busy_s(), own_s(), time.perf_counter()
        return self

    def __exit__(self, *_):
        busy, own, start = self.begin
        elapsed = max(time.perf_counter() - start, 1e-3)
        self.cores = max(0.0, (busy_s() - busy - (own_s() - own)) / elapsed)


def wait(limit):
    """Waits, within reason, until the others take at most `limit` cores."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        with Others() as others:
            time.sleep(0.4)
        if others.cores <= limit:
            return


def report(peer, version, threads, work, rate, run, known=None):
    """Runs `run`, which does `work`, several times and prints a JSON line with the median of `work` per second.

    `rate` names that number; `known` is more for the line.
    """
    # They may have the cores that we leave free.
    limit = (os.cpu_count() or 1) - threads + TOLERATED
    runs = []
    for _ in range(MOST_RUNS):
        wait(limit)
        with Others() as others:
            start, start_own = time.perf_counter(), own_s()
            run()
            elapsed, own = time.perf_counter() - start, own_s() - start_own
        runs.append((others.cores, work / elapsed, work / own))
        if sum(cores <= limit for cores, *_ in runs) >= RUNS:
            break
    runs = sorted(runs, key=lambda run: max(run[0], limit))[:RUNS]
    rates = [found for _, found, _ in runs]
    line = {
        "peer": peer,
        "version": str(version),
        "threads": threads,
        rate: statistics.median(rates),
        # Per second of processor time, of all threads together.
        f"{rate}_cpu": statistics.median(found for *_, found in runs),
        "least": min(rates),
        "most": max(rates),
        "others": [round(cores, 2) for cores, *_ in runs],
        **(known or {}),
    }
    print(json.dumps(line), flush=True)


def springs_per_second(peer, version, threads, springs, run, seconds=2.0):
    """Prints the spring updates per second of `run(steps)`, which moves the lattice by so many steps."""
    run(2)
    steps, elapsed = 2, 0.0
    while elapsed < 0.25 * seconds:
        steps *= 2
        start = time.perf_counter()
        run(steps)
        elapsed = time.perf_counter() - start
    steps = max(2, int(steps * seconds / elapsed))
    report(peer, version, threads, springs * steps, "sups", lambda: run(steps))
