"""Cell models from files stand wherever a model's name does."""

from pathlib import Path

import numpy as np
import pytest

import myospring

FILE = Path(__file__).parents[2] / "myospring" / "tests" / "study" / "aliev_panfilov.mmt"
CALCIUM = "calcium=calcium.level"


def test_a_file_beats_a_cell_with_the_calcium_that_the_user_names() -> None:
    with pytest.warns(myospring.MyospringWarning, match="driven by the calcium of aliev_panfilov"):
        beat = myospring.simulate(model=FILE, variables=CALCIUM, integrator="quasi-static")
    assert beat.metrics["peak_shortening"] > 1
    membrane = myospring.action_potential(model=FILE)
    both = myospring.action_potential(model=str(FILE), variables=CALCIUM)
    assert np.allclose(membrane.potential, both.potential, atol=1e-2)
    assert membrane.tension.max() == 0 < both.tension.max()
    stronger = myospring.action_potential(model=FILE, parameters={"membrane_k": 8.5}, stimulus_amplitude="30 A/F")
    assert stronger.metrics["maximum_upstroke_velocity"] > membrane.metrics["maximum_upstroke_velocity"]


def test_its_constants_are_parameters_by_name_in_batches_too() -> None:
    rows = myospring.parameters(FILE)
    assert rows["membrane_k"].value == 8 and rows["calcium_peak"].unit == "mM" and "T_ref" not in rows
    assert myospring.parameters(FILE, CALCIUM)["T_ref"].value == 120
    names, values = ["membrane_k", "T_ref"], [[8, 120], [8.5, 120], [8, 60]]
    metrics = ["action_potential_duration_90", "peak_tension"]
    found = myospring.simulate_batch(values, names, model=FILE, variables=CALCIUM, metrics=metrics)
    assert found[0, 0] == found[2, 0] != found[1, 0]
    assert found[0, 1] > found[2, 1]


def test_what_cannot_be_read_says_so() -> None:
    with pytest.raises(ValueError, match="absent.mmt: cannot be opened"):
        myospring.simulate(model="absent.mmt")
    with pytest.raises(ValueError, match="no variable is named `calcium.Cai`"):
        myospring.simulate(model=FILE, variables="calcium=calcium.Cai")
    with pytest.raises(ValueError, match="names no role"):
        myospring.parameters(FILE, "calcium.level")
    with pytest.raises(ValueError, match="myofilaments"):
        myospring.simulate(model="coelho_2021", myofilaments="none")
