"""The lattice that all mass-spring programs move.

Spacing 1, springs of stiffness 1 to all eight neighbours (in space to those along the axes and across the faces of
the cubes, eighteen), axial dashpots of 0.1, masses 1, time step 0.05,
a smooth displacement of 0.05 at the start. Velocity Verlet with one evaluation of the force a step and the
dashpots on the velocity at the half step. The pull of neighbour j on node i, d = x_j - x_i, l = |d|:

    (K (l - r) + DASHPOT (d/l . (v_j - v_i))) d/l
"""

import itertools
import math

import numpy as np

K, DASHPOT, TIME_STEP = 1.0, 0.1, 0.05
SIZES = {"2k": (100, 20), "20k": (320, 64), "200k": (1000, 200), "2M": (2000, 1000)}

# Steps after which the squared displacements of the 2k lattice add up to this number, by NumPy, Numba and
# C++ alike.
CHECK_STEPS, CHECK_SUM = 200, 1.22231411297


def shape(size):
    """Masses along each axis, of a size by name or such as "100x20x10"."""
    return SIZES[size] if size in SIZES else tuple(map(int, size.split("x")))


def springs(columns, rows):
    """The number of springs."""
    return (columns - 1) * rows + columns * (rows - 1) + 2 * (columns - 1) * (rows - 1)


def start(columns, rows, layers=None):
    """Coordinates of all masses at the start, by layer (if there are any), row and column."""
    counts = (layers or 1, rows, columns)
    layer, row, column = np.meshgrid(*map(np.arange, counts), indexing="ij")
    x = column + 0.05 * np.sin(0.37 * column + 0.61 * row + 0.43 * layer)
    y = row + 0.05 * np.sin(0.53 * column - 0.29 * row + 0.71 * layer + 1.0)
    return (x[0], y[0]) if layers is None else (x, y, layer.astype(float))


def ends(*counts):
    """The two masses of each spring, its resting length; masses along x, y and, in space, z."""
    counts = counts[::-1]
    index = np.arange(math.prod(counts)).reshape(counts)
    steps = [
        step
        for step in itertools.product((-1, 0, 1), repeat=len(counts))
        # One of each pair of opposite directions, along one axis or across two.
        if step > (0,) * len(counts) and sum(map(abs, step)) <= 2
    ]
    pairs, length = [], []
    for step in steps:
        first = tuple(slice(max(0, -s), n - max(0, s)) for s, n in zip(step, counts))
        second = tuple(slice(max(0, s), n - max(0, -s)) for s, n in zip(step, counts))
        pairs.append(np.stack([index[first].ravel(), index[second].ravel()], -1))
        length.append(np.full(len(pairs[-1]), math.sqrt(sum(map(abs, step)))))
    pairs, length = np.concatenate(pairs), np.concatenate(length)
    # In the order of the nodes, as a mesh generator would list them.
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    return pairs[order], length[order]


def displacement(x, y):
    """The sum of the squared displacements from the undeformed lattice."""
    row, column = np.meshgrid(np.arange(x.shape[0]), np.arange(x.shape[1]), indexing="ij")
    return float(((x - column) ** 2 + (y - row) ** 2).sum())
