"""Many beats in one process of Python: its memory stays what it was after the first of them.

usage: many_beats.py [BEATS]

Each beat is that of the built-in cell with another peak tension, on a coarse mesh, along its equilibria; 10 000 unless
stated. Prints the memory in use after each tenth (Linux), and fails if the last is more than 1 MB above the first.
"""

import pathlib
import sys

import myospring

MOST_KB = 1000


def resident_kb():
    status = pathlib.Path("/proc/self/status").read_text()
    return int(next(line for line in status.splitlines() if line.startswith("VmRSS:")).split()[1])


beats = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
cell = myospring.Cell.builtin(spacing_um=4.0)
in_use = []
print("| beats | memory, kB |\n|---|---|")
for number in range(1, beats + 1):
    beat = myospring.simulate(cell, peak_tension_kpa=30 + 40 * (number % 97) / 97, integrator="quasi-static")
    assert beat.metrics["peak_shortening"] > 5
    if number % max(beats // 10, 1) == 0:
        in_use.append(resident_kb())
        print(f"| {number} | {in_use[-1]} |", flush=True)
grown = in_use[-1] - in_use[0]
print(f"\ngrown by {grown} kB since the first tenth")
sys.exit(grown > MOST_KB)
