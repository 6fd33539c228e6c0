"""Damaged and extreme input, as a table: what is given, the exception, and what its message names.

A new function adds its rows here; those of files are in the program's table (`tests/program/damaged.rs`).
"""

from __future__ import annotations

import re

import numpy as np
import pytest

import myospring

T = np.arange(0.0, 3000.0, 20.0)
LENGTH = 100 - 8 * np.exp(-(((T % 1000 - 300) / 80) ** 2))
PICTURE = np.where((np.indices((80, 80))[1] >= 10) & (np.indices((80, 80))[1] < 70), 200.0, 20.0)
PICTURE[:20], PICTURE[60:] = 20, 20
STUDY = {
    "kind": "cell",
    "parameters": {"tau_si": {"distribution": "uniform", "low": 1.5, "high": 2.0}},
    "sampling": {"sampler": "latin-hypercube", "size": 2},
}


def study(**changes):
    """The description with other tables, two members."""
    return myospring.run_study({**STUDY, **changes})


def with_value(value):
    """The length with one other value."""
    return np.concatenate([LENGTH[:9], [value], LENGTH[10:]])


ROWS = [
    # Settings: what a file may not have, an argument may not have either.
    ("simulate", lambda cell: myospring.simulate(cell, peak_tension_kpa=1e300), ValueError, ["peak_tension_kpa", "1e300", "500 kPa"]),
    ("simulate", lambda cell: myospring.simulate(cell, peak_tension_kpa=float("nan")), ValueError, ["peak_tension_kpa"]),
    ("simulate", lambda cell: myospring.simulate(cell, young_modulus_kpa=-1e300), ValueError, ["young_modulus_kpa", "-1e300"]),
    ("simulate", lambda cell: myospring.simulate(cell, beats=2**70), (TypeError, ValueError), ["beats"]),
    ("simulate", lambda cell: myospring.simulate(cell, duration_ms=1e17), ValueError, ["duration_ms", "1000000 ms"]),
    ("simulate", lambda cell: myospring.simulate(cell, output_interval_ms=0.1), ValueError, ["output_interval_ms", "exchange_interval_ms"]),
    ("simulate", lambda cell: myospring.simulate(cell, parameters={"tau_si": 1e300}), ValueError, ["tau_si", "1e300"]),
    ("simulate", lambda cell: myospring.simulate(cell, parameters={"tau_six": 1.0}), KeyError, ["tau_six"]),
    ("simulate", lambda cell: myospring.simulate(cell, model="tor"), KeyError, ["tor"]),
    ("action_potential", lambda _: myospring.action_potential(output_interval_ms=1e-300), ValueError, ["output_interval_ms"]),
    ("action_potential", lambda _: myospring.action_potential(cycle_length_ms=1e300), ValueError, ["cycle_length_ms", "1e300"]),
    # Pictures.
    ("from_image", lambda _: myospring.Cell.from_image(np.full((9, 9), np.nan), pixel_size_um=0.5), ValueError, ["not a number"]),
    ("from_image", lambda _: myospring.Cell.from_image(PICTURE, pixel_size_um=1e-300), ValueError, ["pixel_size_um", "0.001 um"]),
    ("from_image", lambda _: myospring.Cell.from_image(PICTURE, pixel_size_um=0.5, threshold=1e300), ValueError, ["threshold", "1e300"]),
    ("from_image", lambda _: myospring.Cell.from_image(np.zeros((0, 5)), pixel_size_um=0.5), ValueError, []),
    ("from_image", lambda _: myospring.Cell.from_image(np.zeros((40, 40)), pixel_size_um=0.5), ValueError, ["same value"]),
    ("from_image", lambda _: myospring.Cell.from_image("gone.png", pixel_size_um=0.5), FileNotFoundError, ["gone.png"]),
    # Curves.
    ("fit", lambda cell: myospring.fit((T, with_value(np.inf)), cell), ValueError, []),
    ("fit", lambda cell: myospring.fit((T[::-1], LENGTH), cell), ValueError, ["rise"]),
    ("fit", lambda cell: myospring.fit((T, LENGTH[:-1]), cell), ValueError, []),
    ("fit", lambda cell: myospring.fit((T[:5], LENGTH[:5]), cell), ValueError, []),
    ("fit", lambda cell: myospring.fit((T, LENGTH), cell, bounds={"c_0": (1e-300, 1e300)}), ValueError, ["c_0", "1e300"]),
    ("fit", lambda cell: myospring.fit((T, LENGTH), cell, starts=10**30), (ValueError, OverflowError), ["starts"]),
    ("fit", lambda cell: myospring.fit("gone.csv", cell), FileNotFoundError, ["gone.csv"]),
    # Many.
    ("simulate_batch", lambda cell: myospring.simulate_batch([["a"]], ["peak_tension_kpa"], cell), (TypeError, ValueError), []),
    ("run_study", lambda _: study(sampling={"sampler": "latin-hypercube", "size": -2}), ValueError, ["[sampling]", "a whole number from 0 on"]),
    ("run_study", lambda _: study(sampling={"sampler": "latin-hypercube", "sise": 2}), ValueError, ["sise"]),
    ("run_study", lambda _: study(parameters={"tau_si": {"distribution": "uniform", "low": float("nan"), "high": 2.0}}), ValueError, ["tau_si"]),
    ("run_study", lambda _: study(keep={"peak_tension": [2.0, 1.0]}), ValueError, ["peak_tension"]),
    ("run_study", lambda _: study(nonsense=1), ValueError, ["nonsense"]),
]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_bad_input_is_refused_with_what_is_wrong_in_it(cell, row):
    what, call, exception, names = row
    with pytest.raises(exception) as refused:
        call(cell)
    said = str(refused.value)
    for name in names:
        assert name in said, f"{what}: {name} is not in: {said}"
    # Neither a number of hundreds of digits, nor an option of the program, nor a fault of ours.
    assert not re.search(r"\d{40}| --[a-z]|panicked", said), said


def test_samples_of_a_cell_alone_may_be_any_time_apart():
    found = myospring.action_potential(output_interval_ms=0.1, duration_ms=100)
    assert len(found.t_ms) == 1001
