"""The lattice that all mass-spring programs move.

Spacing 1, springs of stiffness 1 to all eight neighbours, axial dashpots of 0.1, masses 1, time step 0.05,
a smooth displacement of 0.05 at the start. Velocity Verlet with one evaluation of the force a step and the
dashpots on the velocity at the half step. The pull of neighbour j on node i, d = x_j - x_i, l = |d|:

    (K (l - r) + DASHPOT (d/l . (v_j - v_i))) d/l
"""

import math

import numpy as np

K, DASHPOT, TIME_STEP = 1.0, 0.1, 0.05
SIZES = {"2k": (100, 20), "20k": (320, 64), "200k": (1000, 200), "2M": (2000, 1000)}

# Steps after which the squared displacements of the 2k lattice add up to this number, by NumPy, Numba and
# C++ alike.
CHECK_STEPS, CHECK_SUM = 200, 1.22231411297


def springs(columns, rows):
    """The number of springs."""
    return (columns - 1) * rows + columns * (rows - 1) + 2 * (columns - 1) * (rows - 1)


def start(columns, rows):
    """x and y of all masses at the start, by row and column."""
    row, column = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    x = column + 0.05 * np.sin(0.37 * column + 0.61 * row)
    y = row + 0.05 * np.sin(0.53 * column - 0.29 * row + 1.0)
    return x, y


def ends(columns, rows):
    """The two masses of each spring, its resting length."""
    index = np.arange(columns * rows).reshape(rows, columns)
    kinds = [
        (index[:, :-1], index[:, 1:], 1.0),
        (index[:-1], index[1:], 1.0),
        (index[:-1, :-1], index[1:, 1:], math.sqrt(2.0)),
        (index[:-1, 1:], index[1:, :-1], math.sqrt(2.0)),
    ]
    pairs = np.concatenate([np.stack([a.ravel(), b.ravel()], -1) for a, b, _ in kinds])
    length = np.concatenate([np.full(a.size, r) for a, _, r in kinds])
    # In the order of the nodes, as a mesh generator would list them.
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    return pairs[order], length[order]


def displacement(x, y):
    """The sum of the squared displacements from the undeformed lattice."""
    row, column = np.meshgrid(np.arange(x.shape[0]), np.arange(x.shape[1]), indexing="ij")
    return float(((x - column) ** 2 + (y - row) ** 2).sum())
