"""Fits are those of the program, here and on any executor."""

from __future__ import annotations

import json
import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import myospring


@pytest.fixture(scope="module")
def small() -> myospring.Cell:
    return myospring.Cell.builtin(spacing_um=5)


@pytest.fixture(scope="module")
def curves(small) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Three cells, 250 frames a second, and one that does not beat."""
    random = np.random.default_rng(3)
    made = {}
    for name, tension in (("weak", 25), ("usual", 40), ("strong", 55)):
        beat = myospring.simulate(small, peak_tension_kpa=tension, integrator="quasi-static")
        made[name] = (beat.t_ms[::8], beat.length_um[::8] + random.normal(0, 0.1, len(beat.t_ms[::8])))
    made["still"] = (made["weak"][0], 140 + random.normal(0, 0.1, len(made["weak"][0])))
    return made


@pytest.fixture(scope="module")
def table(curves, tmp_path_factory) -> str:
    path = tmp_path_factory.mktemp("curves") / "cells.csv"
    columns = [curves["usual"][0]] + [length for _, length in curves.values()]
    head = ",".join(["t_ms"] + [f"{name} length_um" for name in curves])
    rows = [",".join(repr(float(value)) for value in row) for row in zip(*columns)]
    path.write_text("\n".join([head, *rows]) + "\n")
    return str(path)


def same(one: myospring.Fit | None, other: myospring.Fit | None) -> bool:
    """To the last bit."""
    assert one is not None and other is not None
    return (one.parameters, one.verdicts, one.run_file) == (other.parameters, other.verdicts, other.run_file)


def test_of_several_curves_of_one_cell_the_stretch_is_fitted_over_the_part_that_is_asked_for(small, curves, tmp_path):
    times, length = curves["usual"]
    rows = [f"{t},{l},{l / 140},{2 - l / 140}" for t, l in zip(times, length)]
    path = tmp_path / "track.csv"
    path.write_text("\n".join(["t_ms,length_um,stretch_1,stretch_2", *rows]) + "\n")
    found = myospring.fit(str(path), small, starts=1, until_ms=400)
    assert found.name == "stretch_1"
    assert any("not fitted" in note and "`length_um`" in note for note in found.notes)
    assert found.curves[0].t_ms[-1] <= 400
    with pytest.raises(ValueError, match="the recording runs from"):
        myospring.fit(str(path), small, from_ms=1e6)


def test_python_and_the_program_find_the_same_numbers(small, table, run, tmp_path):
    found = myospring.fit(table, small, columns=["usual length_um"])
    run("fit", "--to", table, "--columns", "usual length_um", "--spacing", "5 um", "--output", "out", cwd=tmp_path)
    record = json.loads((tmp_path / "out" / "fit.json").read_text())
    assert [row["name"] for row in record["estimates"]] == list(found.parameters)
    for row, one in zip(record["estimates"], found.parameters.values()):
        assert (row["value"], row["interval"], row["unit"]) == (one.value, list(one.interval), one.unit)
        assert row["profile"] == [list(point) for point in one.profile]
    assert record["verdicts"] == found.verdicts
    assert record["verdict"] == found.verdict == "fits"
    # Its run is the program's, and gives the fitted height again.
    written = (tmp_path / "out" / "run.toml").read_text()
    assert written.split("\n", 1)[1].strip() == found.run_file.strip()
    height = 100 * (1 - found.curves[0].fitted.min() / found.parameters["resting_length"].value)
    assert found.simulate().metrics["peak_shortening"] == pytest.approx(height, abs=0.05)


def test_values_that_a_mask_hides_are_none(small, curves):
    times, length = curves["usual"]
    hidden = np.ma.masked_where(times == 160, length)
    with pytest.raises(ValueError, match="time 160 ms, value NaN"):
        myospring.fit((times, hidden), small)


def test_a_curve_that_cannot_be_a_length_is_refused(small, curves):
    times, length = curves["usual"]
    with pytest.raises(ValueError, match="a length is above 0; it seems to be a change of length"):
        myospring.fit((times, length - length.max()), small)


def test_a_device_is_no_table(small, tmp_path):
    link = tmp_path / "endless.csv"
    link.symlink_to("/dev/zero")
    for path in (link, "/dev/urandom"):
        with pytest.raises(OSError, match="it is a device"):
            myospring.fit(path, small)


def test_a_fit_is_numbers_a_table_and_a_figure_and_can_be_pickled(small, curves):
    found = myospring.fit(curves["strong"], small, stimulus_times_ms=[50.0])
    truth = 55 / 308
    low, high = found.parameters["tension_over_stiffness"].interval
    assert low is not None and high is not None and low < truth < high
    assert found.parameters["delay"].unit == "ms"
    assert found.correlations is not None and found.correlations.shape == (4, 4)
    again = pickle.loads(pickle.dumps(found))
    assert same(found, again) and again.simulate().metrics == found.simulate().metrics
    table = pytest.importorskip("pandas") and found.to_dataframe()
    assert table.loc["c_0", "verdict"] == "determined" and list(table.index) == list(found.parameters)
    pytest.importorskip("matplotlib").use("agg")
    assert [one.get_ylabel() for one in found.plot()] == ["curve (um)", "Residual (um)"]
    assert "c_0" in repr(found) and "<table>" in found._repr_html_()


def test_a_model_that_does_not_fit_says_so_before_its_numbers(small):
    times = np.arange(160) * 4.0
    wave = np.where((times > 120) & (times < 360), 90.0, 100.0) + np.random.default_rng(2).normal(0, 0.01, 160)
    found = myospring.fit((times, wave), small, stimulus_times_ms=[100.0], starts=2, model="coelho_2021")
    assert found.verdict == "does-not-fit" and found.curves[0].unexplained > 0.02
    assert all(one.interval == (None, None) and one.verdict != "determined" for one in found.parameters.values())
    assert "does-not-fit" in repr(found) and "..." not in repr(found)
    assert any("no intervals" in verdict for verdict in found.verdicts)


def test_what_is_held_is_not_sought(small, curves):
    own = dict(stimulus_times_ms=[50.0], starts=2)
    held = myospring.fit(curves["usual"], small, fix={"c_0": 0.0166016}, **own)
    assert "c_0" not in held.parameters
    assert "c_0" not in myospring.fit(curves["usual"], small, fix=["c_0"], **own).parameters
    more = myospring.fit(curves["usual"], small, free=["c_0", "sigma"], bounds={"sigma": (0.03, 0.08)}, **own)
    assert more.parameters["sigma"].bounds == pytest.approx((0.03, 0.08))
    with pytest.raises(myospring.UnknownNameError, match="c_00"):
        myospring.fit(curves["usual"], small, free=["c_00"], **own)
    with pytest.raises(ValueError, match="at most two"):
        myospring.fit(curves["usual"], small, free=["Ca50_ref", "k_ws"], model="land_2017", **own)
    with pytest.raises(ValueError, match="free and fixed"):
        myospring.fit(curves["usual"], small, free=["c_0"], fix={"c_0": 0.02}, **own)
    with pytest.raises(TypeError, match="modell"):
        myospring.fit(curves["usual"], small, modell="land_2017")
    with pytest.raises(ValueError, match="shapes"):
        myospring.fit((curves["usual"][0][:-1], curves["usual"][1]), small)


def test_a_loaded_curve_tells_the_stiffness(small, curves):
    held = myospring.simulate(
        small, support="spring-held-ends", end_stiffness_nn_per_um=200, peak_tension_kpa=40, integrator="quasi-static"
    )
    loaded = (held.t_ms[::8], held.length_um[::8] + np.random.default_rng(5).normal(0, 0.1, len(held.t_ms[::8])))
    found = myospring.fit(curves["usual"], small, loaded={200: loaded}, stimulus_times_ms=[50.0], starts=1)
    low, high = found.parameters["young_modulus"].interval
    assert low is not None and high is not None and low < 308 < high


@pytest.fixture(scope="module")
def serial(small, table) -> myospring.Fits:
    return myospring.fit_many(table, small, threads=1, starts=2, progress=False)


def test_many_cells_are_rows_and_one_that_cannot_be_fitted_says_why(serial, small, table, curves):
    assert len(serial) == 4 and serial.names[0] == "weak length_um"
    assert [reason is None for reason in serial.reasons] == [True, True, True, False]
    assert serial[3] is None and "beat" in (serial.reasons[3] or "")
    alone = myospring.fit(table, small, columns=["strong length_um"], starts=2)
    assert same(serial[2], alone)
    pytest.importorskip("pandas")
    rows = serial.to_dataframe()
    assert list(rows["status"]) == ["ok", "ok", "ok", "failed"]
    ratios = rows["tension_over_stiffness"][:3]
    assert list(ratios) == sorted(ratios) and np.isnan(rows["tension_over_stiffness"].iloc[3])
    with pytest.raises(ValueError, match="4 curves and 2 cells"):
        myospring.fit_many(curves, [small, small])
    with pytest.raises(ValueError, match="columns chooses one"):
        myospring.fit(table, small)


def equal(one: myospring.Fits, other: myospring.Fits) -> bool:
    assert one.reasons == other.reasons
    return all(same(a, b) for a, b in zip(one, other) if a is not None)


def test_threads_and_processes_give_the_same_bits(serial, small, table):
    assert equal(serial, myospring.fit_many(table, small, threads=2, starts=2, progress=False))
    shown = []
    processes = lambda: ProcessPoolExecutor(2)  # noqa: E731
    other = myospring.Cell.builtin(spacing_um=5)
    found = myospring.fit_many(
        table, [small, other, small, other], processes, starts=2, progress=lambda *of: shown.append(of)
    )
    assert equal(serial, found)
    assert shown[-1] == ("cells", 4, 4)


def test_dask_gives_the_same_bits(serial, small, table):
    distributed = pytest.importorskip("distributed")
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with cluster, distributed.Client(cluster) as client:
        executor = client.get_executor(pure=False)
        assert equal(serial, myospring.fit_many(table, small, executor, starts=2, progress=False))


def test_the_tension_that_a_curve_asks_for_is_found_and_repeats_it() -> None:
    cell = myospring.Cell.builtin(spacing_um=5)
    beat = myospring.simulate(cell, peak_tension_kpa=40, integrator="quasi-static")
    found = myospring.fit((beat.t_ms, beat.length_um), cell, stimulus_times_ms=[50.0], model="given_tension")
    own = found.own_tension
    assert own is not None and own.band_kpa.shape == (2, len(own.t_ms))
    # Frames every ms or denser of a curve without noise.
    assert abs(own.tension_kpa.max() - beat.ta_kpa.max()) < 4e-3
    again = found.simulate()
    assert abs(again.metrics["peak_shortening"] - beat.metrics["peak_shortening"]) < 0.01


def test_without_a_model_the_simplest_that_follows_the_curve_is_taken() -> None:
    cell = myospring.Cell.builtin(spacing_um=5)
    beat = myospring.simulate(cell, model="land_2017", integrator="quasi-static")
    found = myospring.fit((beat.t_ms[::10], beat.length_um[::10]), cell, stimulus_times_ms=[50.0])
    first, *others = found.tried
    assert (found.model, first.model, first.taken, first.verdict) == ("land_2017", "land_2017", True, "fits")
    assert {"coelho_2021", "given_tension", "tor_ord_land"} <= {row.model for row in others}
    assert not any(row.taken for row in others)
    slow = next(row for row in others if row.model == "tor_ord_land")
    assert slow.reason is not None and slow.bic is None
    # A cell that contracts slowly and relaxes fast, as no adult cell does.
    times = np.arange(0.0, 1000.0, 10.0)
    part = np.interp(times, [0, 50, 550, 650, 720, 1000], [0, 0, 1, 0.6, 0, 0])
    other = myospring.fit((times, 140 * (1 - 0.05 * part)), cell, stimulus_times_ms=[50.0])
    assert other.model == "given_tension" and other.own_tension is not None
    assert "given_tension" in repr(other)
    assert myospring.fit((times, 140 * (1 - 0.05 * part)), cell, model="coelho_2021").tried == []


def test_calcium_that_was_recorded_with_the_curve_drives_the_fit_from_arrays_as_from_a_table(tmp_path):
    cell = myospring.Cell.builtin(spacing_um=5)
    beat = myospring.simulate(cell, model="land_2017", beats=2, cycle_length_ms=1000, integrator="quasi-static")
    times, length = beat.t_ms[::5], beat.length_um[::5]
    of = {name: row.value for name, row in myospring.parameters("land_2017").items()}
    # The run stimulates at 50 ms.
    since = np.where(times < 50, np.inf, (times - 50) % 1000)
    rise, fall = of["tau_Ca_rise"], of["tau_Ca_fall"]
    shape = np.exp(-since / fall) - np.exp(-since / rise)
    calcium = of["Ca_rest"] + of["Ca_amplitude"] * shape / shape.max()
    found = myospring.fit((times, length), cell, model="land_2017", starts=1, recorded_calcium=(times, calcium))
    recorded = found.recorded_calcium
    assert recorded is not None and recorded[1].max() == pytest.approx(calcium.max(), rel=0.02)
    path = tmp_path / "both.csv"
    rows = [f"{t!r},{ca!r},{um!r}" for t, ca, um in zip(times.tolist(), calcium.tolist(), length.tolist())]
    path.write_text("\n".join(["time (ms),Ca (uM),length (um)", *rows]) + "\n")
    of_table = myospring.fit(str(path), cell, model="land_2017", starts=1)
    assert of_table.parameters == found.parameters
    with pytest.raises(ValueError, match="not recorded together"):
        myospring.fit((times, length), cell, model="land_2017", recorded_calcium=(times + 1e6, calcium))
    with pytest.raises(ValueError, match="both ends of its scale"):
        myospring.fit((times, length), cell, model="land_2017", recorded_calcium=(times, calcium), calcium_rest_um=0.1)
