"""A matrix in, a matrix out."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
import pytest

import myospring

METRICS = ["peak_shortening", "action_potential_duration_90", "active_work"]


def test_a_row_has_the_numbers_of_the_beat_alone_whatever_else_is_in_the_batch(cell):
    tensions = np.array([70.0, 12.0, 50.0, 33.3])
    taus = np.array([1.7, 1.8, 1.9, 1.77])
    params = np.column_stack([tensions, taus])
    names = ["peak_tension_kpa", "tau_si"]
    values = myospring.simulate_batch(params, names, cell, metrics=METRICS)
    for row, (tension, tau) in zip(values, params):
        beat = myospring.simulate(
            cell, peak_tension_kpa=tension, parameters={"tau_si": tau}, integrator="quasi-static"
        )
        np.testing.assert_array_equal(row, [beat.metrics[name] for name in METRICS])
    again = myospring.simulate_batch(params[::-1], names, cell, metrics=METRICS, threads=1)
    np.testing.assert_array_equal(again[::-1], values)


def test_material_and_geometry_may_vary_too(cell):
    params = np.array([[150.0, 4.0, 5.0], [308.0, 4.0, 0.0]])
    values = myospring.simulate_batch(params, ["young_modulus_kpa", "spacing_um", "rotate_deg"], metrics=METRICS)
    soft = myospring.simulate(
        myospring.Cell.builtin(spacing_um=4.0, rotate_deg=5.0), young_modulus_kpa=150.0, integrator="quasi-static"
    )
    np.testing.assert_array_equal(values[0], [soft.metrics[name] for name in METRICS])
    assert values[0, 0] > values[1, 0]


def test_a_batch_takes_the_usual_methods_of_studies_where_the_model_allows_them(cell):
    def values(**settings):
        return myospring.simulate_batch([[50.0]], ["peak_tension_kpa"], cell, metrics=METRICS, **settings)

    np.testing.assert_array_equal(values(), values(cell_integrator="adaptive", integrator="quasi-static"))
    fixed = values(cell_integrator="runge-kutta-4")
    assert (values() != fixed).any()
    # As far as fixed steps are right themselves.
    np.testing.assert_allclose(values(), fixed, rtol=2e-3)
    # A step is that of fixed steps. Another model has its own method.
    np.testing.assert_array_equal(values(cell_step_ms=0.005), fixed)
    of_land = myospring.simulate_batch([[10.0]], ["thickness_um"], cell, metrics=METRICS[:1], model="land_2017")
    assert np.isfinite(of_land).all()


def test_a_setting_may_be_named_as_in_a_study(cell):
    of_python, of_studies = (
        myospring.simulate_batch([[30.0]], [name], cell, metrics=METRICS) for name in ("peak_tension_kpa", "peak_tension")
    )
    np.testing.assert_array_equal(of_python, of_studies)


def test_all_metrics_are_there_unless_some_are_named(cell):
    values = myospring.simulate_batch([[50.0]], ["peak_tension_kpa"], cell)
    assert values.shape == (1, len(myospring.METRICS))
    assert myospring.simulate_batch(np.empty((0, 1)), ["peak_tension_kpa"], cell).shape == (0, len(myospring.METRICS))


def test_a_member_that_fails_is_a_row_of_nan_with_a_reason(cell):
    params = [[50.0], [9999.0], [np.nan], [20.0]]
    values, reasons = myospring.simulate_batch(
        params, ["peak_tension_kpa"], cell, metrics=METRICS, return_reasons=True
    )
    assert np.isnan(values[1:3]).all() and np.isfinite(values[[0, 3]]).all()
    assert reasons[0] is None and reasons[3] is None
    assert "peak_tension_kpa" in reasons[1] and "500 kPa" in reasons[1]
    assert "not a finite number" in reasons[2]
    with pytest.warns(RuntimeWarning, match="2 of 4 members failed, the first in row 1"):
        myospring.simulate_batch(params, ["peak_tension_kpa"], cell, metrics=METRICS)


def test_what_does_not_fit_is_refused_before_anything_beats(cell):
    with pytest.raises(ValueError, match="must be .N, 1."):
        myospring.simulate_batch([[1.0, 2.0]], ["peak_tension_kpa"], cell)
    with pytest.raises(myospring.UnknownNameError, match="did you mean `tau_si`"):
        myospring.simulate_batch([[1.0]], ["tau_sii"], cell)
    with pytest.raises(KeyError, match="did you mean `peak_shortening`"):
        myospring.simulate_batch([[1.0]], ["peak_tension_kpa"], cell, metrics=["peak_shorteningg"])
    with pytest.raises(TypeError, match="did you mean 'peak_tension_kpa'"):
        myospring.simulate_batch([[1.0]], ["tau_si"], cell, peak_tension=3)
    with pytest.raises(ValueError, match="support"):
        myospring.simulate_batch([[1.0]], ["support"], cell)


def interrupted(work):
    """How long after Ctrl-C some work goes on, s: the shortest of up to three times, as others may use the machine."""
    shortest = float("inf")
    for _ in range(3):
        shortest = min(shortest, once_interrupted(work))
        if shortest < 1:
            break
    return shortest


def once_interrupted(work):
    sent = []

    def interrupt():
        time.sleep(0.5)
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        work()
    thread.join()
    return time.monotonic() - sent[0]


def test_ctrl_c_stops_a_batch_and_a_beat_within_a_second(cell):
    params = np.linspace(10, 100, 5000)[:, None]
    assert interrupted(lambda: myospring.simulate_batch(params, ["peak_tension_kpa"], cell)) < 1
    assert interrupted(lambda: myospring.simulate(cell, integrator="quasi-static", beats=2000, frame_interval_ms=500)) < 1
    # Pacing before a run, a path of equilibria that takes long, and a cell alone.
    steady = {"model": "tor_ord_land", "steady_state": 1e-6}
    assert interrupted(lambda: myospring.simulate(cell, **steady)) < 1
    fine = myospring.Cell.builtin(spacing_um=0.25)
    tall = {"integrator": "quasi-static", "support": "afterloaded-ends", "afterload_nn": 2000}
    assert interrupted(lambda: myospring.simulate(fine, **tall)) < 1
    long = {"model": "tor_ord_land", "beats": 400, "duration_ms": 4e5}
    assert interrupted(lambda: myospring.action_potential(**long)) < 1


def test_ctrl_c_stops_a_fit_within_a_second(cell):
    beat = myospring.simulate(cell, integrator="quasi-static")
    curve = (beat.t_ms[::20], beat.length_um[::20])
    assert interrupted(lambda: myospring.fit(curve, cell, model="tor_ord_land")) < 1


def test_python_goes_on_while_cells_beat(cell):
    ticks = []
    done = threading.Event()

    def tick():
        while not done.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    # 400 cells take many ticks on a fast machine, and more on a slow one.
    myospring.simulate_batch(np.linspace(10, 60, 400)[:, None], ["peak_tension_kpa"], cell, metrics=METRICS)
    done.set()
    thread.join()
    assert len(ticks) > 10
