"""Cells and beats go to other processes, however these are started."""

from __future__ import annotations

import multiprocessing
import pickle

import numpy as np
import pytest

import myospring

NAMES = ["peak_tension_kpa"]


def work(arguments):
    cell, params = arguments
    return myospring.simulate_batch(params, NAMES, cell, metrics=["peak_shortening"], threads=2)


def beat_of(cell):
    return myospring.simulate(cell, integrator="quasi-static", duration_ms=200.0)


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_a_batch_has_the_same_bits_in_processes_of_every_kind(cell, method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system has no {method}")
    parts = [np.array([[20.0], [40.0]]), np.array([[60.0]])]
    # This process has had threads before it forks.
    here, beat_here = [work((cell, part)) for part in parts], beat_of(cell)
    with multiprocessing.get_context(method).Pool(2) as pool:
        there = pool.map(work, [(cell, part) for part in parts])
        beat = pool.apply(beat_of, (cell,))
    for own, other in zip(here, there):
        np.testing.assert_array_equal(own, other)
    np.testing.assert_array_equal(beat.shortening_pct, beat_here.shortening_pct)


def test_a_cell_and_a_beat_come_back_from_a_pickle(cell, beat):
    again = pickle.loads(pickle.dumps(cell))
    np.testing.assert_array_equal(again.positions, cell.positions)
    assert again.dimensions == cell.dimensions
    same = pickle.loads(pickle.dumps(beat))
    np.testing.assert_array_equal(same.positions, beat.positions)
    assert same.metrics == pytest.approx(beat.metrics, rel=0, nan_ok=True)
    assert same.run_file == beat.run_file and repr(same) == repr(beat)
