"""Numba, the fastest that we know how to write: each spring once, row by row, rows in blocks for threads.

usage: bench_numba.py SIZE THREADS

Leapfrog, which gives the same positions as velocity Verlet. Compiled with fast mathematics, so that the
loops over a row become vector instructions. Prints one JSON line.
"""

import math
import os
import sys

size, threads = sys.argv[1], int(sys.argv[2])
# Read when numba is imported.
os.environ["NUMBA_NUM_THREADS"] = str(threads)
os.environ.setdefault("NUMBA_THREADING_LAYER", "omp")

import numba
import numpy as np
from numba import njit, prange

import lattice
import quiet

columns, rows = lattice.SIZES[size]
K, DASHPOT, TIME_STEP = lattice.K, lattice.DASHPOT, lattice.TIME_STEP
SIDE, DIAGONAL = 1.0, math.sqrt(2.0)


@njit(fastmath=True, error_model="numpy", inline="always")
def pull(dx, dy, du, dv, rest):
    """The pull along (dx, dy), divided by the length."""
    inverse = 1.0 / np.sqrt(dx * dx + dy * dy)
    return K * (1.0 - rest * inverse) + DASHPOT * (dx * du + dy * dv) * inverse * inverse


@njit(fastmath=True, error_model="numpy", inline="always")
def between_rows(
    x, y, u, v, x_up, y_up, u_up, v_up, up_x, up_y, right_x, right_y, left_x, left_y, columns
):
    """Pulls of the springs from a row to the one above: upright, to the right, to the left.

    An array for each, not one for all: a quarter faster.
    """
    for j in range(columns):
        dx = x_up[j] - x[j]
        dy = y_up[j] - y[j]
        s = pull(dx, dy, u_up[j] - u[j], v_up[j] - v[j], SIDE)
        up_x[j] = s * dx
        up_y[j] = s * dy
    for j in range(columns - 1):
        dx = x_up[j + 1] - x[j]
        dy = y_up[j + 1] - y[j]
        s = pull(dx, dy, u_up[j + 1] - u[j], v_up[j + 1] - v[j], DIAGONAL)
        right_x[j + 1] = s * dx
        right_y[j + 1] = s * dy
        dx = x_up[j] - x[j + 1]
        dy = y_up[j] - y[j + 1]
        s = pull(dx, dy, u_up[j] - u[j + 1], v_up[j] - v[j + 1], DIAGONAL)
        left_x[j + 1] = s * dx
        left_y[j + 1] = s * dy


@njit(parallel=threads > 1, fastmath=True, error_model="numpy")
def advance(x, y, u, v, x_out, y_out, u_out, v_out, scratch, blocks, steps):
    rows, columns = x.shape
    for _ in range(steps):
        for block in prange(blocks):
            first = block * rows // blocks
            end = (block + 1) * rows // blocks
            # Twice six pulls between rows, two along a row; places 0 and `columns` stay 0.
            q = scratch[block]
            q[:] = 0.0
            at = 0
            if first > 0:
                between_rows(
                    x[first - 1], y[first - 1], u[first - 1], v[first - 1],
                    x[first], y[first], u[first], v[first],
                    q[0], q[1], q[2], q[3], q[4], q[5], columns,
                )
            for i in range(first, end):
                below = q[6 * at : 6 * at + 6]
                above = q[6 * (1 - at) : 6 * (1 - at) + 6]
                along_x = q[12]
                along_y = q[13]
                xi, yi, ui, vi = x[i], y[i], u[i], v[i]
                for j in range(columns - 1):
                    dx = xi[j + 1] - xi[j]
                    dy = yi[j + 1] - yi[j]
                    s = pull(dx, dy, ui[j + 1] - ui[j], vi[j + 1] - vi[j], SIDE)
                    along_x[j + 1] = s * dx
                    along_y[j + 1] = s * dy
                if i + 1 < rows:
                    between_rows(
                        xi, yi, ui, vi, x[i + 1], y[i + 1], u[i + 1], v[i + 1],
                        above[0], above[1], above[2], above[3], above[4], above[5], columns,
                    )
                else:
                    above[:] = 0.0
                b0, b1, b2, b3, b4, b5 = below[0], below[1], below[2], below[3], below[4], below[5]
                a0, a1, a2, a3, a4, a5 = above[0], above[1], above[2], above[3], above[4], above[5]
                xo, yo, uo, vo = x_out[i], y_out[i], u_out[i], v_out[i]
                for j in range(columns):
                    from_x = a0[j] - b0[j] + a2[j + 1] - b2[j] + a4[j] - b4[j + 1]
                    from_y = a1[j] - b1[j] + a3[j + 1] - b3[j] + a5[j] - b5[j + 1]
                    u_next = ui[j] + TIME_STEP * (along_x[j + 1] - along_x[j] + from_x)
                    v_next = vi[j] + TIME_STEP * (along_y[j + 1] - along_y[j] + from_y)
                    uo[j] = u_next
                    vo[j] = v_next
                    xo[j] = xi[j] + TIME_STEP * u_next
                    yo[j] = yi[j] + TIME_STEP * v_next
                at = 1 - at
        x, x_out = x_out, x
        y, y_out = y_out, y
        u, u_out = u_out, u
        v, v_out = v_out, v


class Motion:
    """Positions and velocities of the lattice, after its first step."""

    def __init__(self):
        x, y = lattice.start(columns, rows)
        pairs, rest = lattice.ends(columns, rows)
        flat = x.ravel(), y.ravel()
        dx, dy = (axis[pairs[:, 1]] - axis[pairs[:, 0]] for axis in flat)
        length = np.sqrt(dx * dx + dy * dy)
        s = K * (length - rest) / length
        # The first half kick, then a drift.
        u, v = (0.5 * TIME_STEP * self.sum_of(s * d, pairs) for d in (dx, dy))
        self.now = [x + TIME_STEP * u, y + TIME_STEP * v, u, v]
        self.next = [array.copy() for array in self.now]
        self.scratch = np.zeros((threads, 14, columns + 2))

    @staticmethod
    def sum_of(pulls, pairs):
        count = columns * rows
        total = np.bincount(pairs[:, 0], pulls, count) - np.bincount(pairs[:, 1], pulls, count)
        return total.reshape(rows, columns)

    def run(self, steps):
        advance(*self.now, *self.next, self.scratch, threads, steps)
        if steps % 2:
            self.now, self.next = self.next, self.now


motion = Motion()
if size == "2k":
    motion.run(lattice.CHECK_STEPS - 1)
    found = lattice.displacement(*motion.now[:2])
    if abs(found / lattice.CHECK_SUM - 1) > 1e-10:
        sys.exit(f"the squared displacements add up to {found!r}, not to {lattice.CHECK_SUM!r}")
quiet.springs_per_second(
    "numba", numba.__version__, threads, lattice.springs(columns, rows), motion.run
)
