"""Experiments are those of the program: measured curves, films and comparisons."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
import warnings

import numpy as np
import pytest

import myospring


def lengths(t_ms: np.ndarray) -> np.ndarray:
    """A cell of 120 um that shortens by 8 %, once a second."""
    phase = t_ms % 1000
    return 120 - 9.6 * np.where((phase > 300) & (phase < 700), np.sin(np.pi * (phase - 300) / 400), 0) ** 2


@pytest.fixture(scope="module")
def table(tmp_path_factory) -> str:
    path = tmp_path_factory.mktemp("curves") / "cell.csv"
    t_ms = np.arange(0, 4000, 10)
    rows = [f"{t},{length:.4f}" for t, length in zip(t_ms, lengths(t_ms))]
    path.write_text("\n".join(["t_ms,length_um", *rows]) + "\n")
    return str(path)


@pytest.fixture(scope="module")
def film() -> np.ndarray:
    """A striped ellipse of 100 um by 30 um, pixels of 0.5 um, that shortens by up to 6 %."""
    rows, columns = np.mgrid[0:100, 0:288]
    x, y = (columns - 144) * 0.5, (rows - 50) * 0.5
    frames = []
    for short in (0, 0, 0.02, 0.04, 0.06, 0.04, 0.02, 0):
        u, v = x / (1 - short), y * (1 - 0.3 * short)
        inside = 1 / (1 + np.exp(8 * ((u / 50) ** 2 + (v / 15) ** 2 - 1)))
        texture = np.cos(1.1 * u + 0.6 * v) * np.cos(0.7 * v - 0.5 * u) + 0.7 * np.cos(0.35 * u * (1 + v / 40) + v)
        frames.append(20 + inside * (130 + 40 * texture))
    noise = np.random.default_rng(2).normal(0, 2, (len(frames), *x.shape))
    return np.clip(np.array(frames) + noise, 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def motion(film) -> myospring.Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", myospring.MyospringWarning)
        return myospring.track(film, pixel_size_um=0.5, frame_rate_per_s=20, spacing_um=3)


@pytest.fixture
def small_fit(cell):
    """Fits that take many seconds: curves of a model of 49 equations."""
    t_ms = np.arange(0, 1500, 10.0)
    curves = {name: (t_ms, lengths(t_ms)) for name in ("one", "other", "third")}
    return lambda: myospring.fit_many(curves, cell, model="tor_ord_land", starts=32, progress=False)


def test_results_over_time_and_space_are_datasets_with_units(cell, beat, motion, monkeypatch):
    xarray = pytest.importorskip("xarray")
    shapes = beat.to_xarray()
    assert shapes["positions_um"].dims == ("frame_t_ms", "node", "axis") and list(shapes["axis"].values) == ["x", "y"]
    assert shapes["length_um"].attrs["units"] == "um" and shapes["t_ms"].attrs["units"] == "ms"
    at_peak = shapes["shortening_pct"].idxmax()
    assert float(shapes["shortening_pct"].sel(t_ms=at_peak)) == beat.shortening_pct.max()
    assert motion.to_xarray()["positions_um"].shape == motion.positions.shape
    course = myospring.action_potential()
    assert course.to_xarray()["tension"].sizes == {"t_ms": len(course.t_ms)}
    t_ms = np.arange(0, 3000, 10.0)
    (curve,) = myospring.analyse((t_ms, lengths(t_ms))).curves
    assert curve.to_xarray()["values"].attrs == {"units": "um"}
    assert isinstance(curve.to_xarray(), xarray.Dataset)
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError, match="pip install xarray"):
        beat.to_xarray()


def test_python_and_the_program_read_the_same_beats(table, run, tmp_path):
    found = myospring.analyse(table)
    run("analyse", table, "--output", "out", cwd=tmp_path)
    written = json.loads((tmp_path / "out" / "summary.json").read_text())
    (curve,) = found.curves
    assert found["length_um"] is curve and list(found) == [curve.title] and "Analysis: 1 curve, 4 beats" in repr(found)
    for row in written["curves"][0]["metrics"]:
        assert row["mean"] == pytest.approx(curve.metrics[row["name"]], rel=1e-5, nan_ok=True)
    assert curve.metrics["peak_shortening"] == pytest.approx(8.0, abs=0.1)
    assert curve.t_ms.shape == curve.values.shape == (400,)
    frame = found.to_dataframe()
    assert len(frame) == len(curve.beats) == 4 and frame["peak_shortening"].notna().all()
    kept = found.save(tmp_path / "kept")
    for name in ("summary.csv", "metrics.csv", "summary.json"):
        assert (kept / name).read_bytes() == (tmp_path / "out" / name).read_bytes()
    with pytest.raises(OSError, match="force=True"):
        found.save(tmp_path / "kept")


def test_arrays_are_curves_without_a_file():
    t_ms = np.arange(0, 4000, 10.0)
    found = myospring.analyse({"one": (t_ms, lengths(t_ms)), "other": (t_ms, 0.9 * lengths(t_ms))}, until_ms=3000)
    assert list(found) == ["one", "other"]
    assert found["other"].metrics["resting_length"] == pytest.approx(108, abs=0.1)
    with pytest.raises(ValueError, match="`curve`"):
        myospring.analyse((t_ms, np.full_like(t_ms, 120.0)))
    with pytest.raises(FileNotFoundError):
        myospring.analyse("nowhere.csv")
    with pytest.raises(ValueError, match="stimulus_period_ms is 1 ms.*; give it in ms"):
        myospring.analyse((t_ms, lengths(t_ms)), stimulus_period_ms=1.0)


def test_calcium_and_length_of_the_same_beats_are_paired_as_by_the_program(run, tmp_path):
    t_ms = np.arange(0, 4000, 10.0)
    calcium = 0.1 + 0.5 * (120 - lengths(t_ms + 30.0)) / 10
    rows = [f"{t},{one:.5f},{other:.4f}" for t, one, other in zip(t_ms, calcium, lengths(t_ms))]
    table = tmp_path / "both.csv"
    table.write_text("\n".join(["t_ms,Ca_uM,length_um", *rows]) + "\n")
    found = myospring.analyse(table)
    run("analyse", table, "--output", "out", cwd=tmp_path)
    (pair,) = found.pairs
    assert pair.metrics["delay_of_half_rise"] == pytest.approx(30, abs=1)
    assert pair.direction == "counter-clockwise" and pair.motion_unit == "%"
    assert len(pair.beats) == len(pair.loops) == 4 and pair.mean_loop.motion.max() == pytest.approx(8.0, abs=0.3)
    frame = pair.to_dataframe()
    assert frame["counts"].all() and frame["delay_of_half_rise"].mean() == pytest.approx(pair.metrics["delay_of_half_rise"])
    kept = found.save(tmp_path / "kept")
    for name in ("pairs.csv", "loops.csv", "summary.json"):
        assert (kept / name).read_bytes() == (tmp_path / "out" / name).read_bytes()
    assert not myospring.analyse((t_ms, lengths(t_ms))).pairs


def test_a_film_of_arrays_is_followed(motion, film, tmp_path):
    assert motion.t_ms == pytest.approx(50 * motion.frames)
    assert motion.contraction_pct.max() == pytest.approx(6, abs=0.6)
    points = motion.positions.shape[1]
    assert motion.positions.shape == (len(film), points, 2) and motion.interpolated.shape == (len(film), points)
    assert motion.triangles.max() < points
    assert motion.numbers["pixel_size_um"] == 0.5 and motion.numbers["frames_per_second"] == 20
    assert f"{len(film)} frames, contracts by" in repr(motion) and "<table>" in motion._repr_html_()
    assert list(motion.to_dataframe()["t_ms"]) == list(motion.t_ms)
    kept = motion.save(tmp_path / "kept", outputs="frames")
    assert {path.name for path in kept.iterdir()} >= {"track.csv", "track.json", "rest.tif", "frames.npz"}
    assert not (kept / "figures").exists()
    with pytest.raises(KeyError, match="gif"):
        motion.save(tmp_path / "more", outputs="gifs")


def test_a_function_hears_of_each_step_and_may_end_it(film):
    heard = []
    with pytest.raises(ZeroDivisionError):
        myospring.track(
            film,
            pixel_size_um=0.5,
            frame_rate_per_s=20,
            progress=lambda stage, done, all_: heard.append((stage, done, all_)) or (stage == "frames" and 1 / 0),
        )
    assert heard == [("frame at rest", 1, 1), ("frames", 1, len(film))]
    with pytest.raises(ValueError, match="frame_rate_per_s"):
        myospring.track(film, pixel_size_um=0.5)


def test_beats_are_compared_with_factors_and_doses(cell, beat, tmp_path):
    found = myospring.compare(
        beat,
        scale={"weaker": {"peak_tension": 0.5}},
        doses={"drug": [{"name": "blocker", "parameter": "tau_si", "concentration": ["1 uM"], "ic50": "10 uM"}]},
    )
    assert found.labels == ["control", "weaker", "blocker 1 uM"]
    assert found.metrics["peak_shortening"][0] == pytest.approx(beat.metrics["peak_shortening"], rel=1e-6)
    assert found.differences["peak_shortening"][1] < -2
    assert "cell.peak_tension" in found.settings
    assert any("phenomenological" in warning for warning in found.warnings)
    frame = found.to_dataframe()
    assert len(frame) == len(found.metrics) * len(found.labels)
    kept = found.save(tmp_path / "kept")
    assert (kept / "report.html").exists() and (kept / "runs" / "run_2.toml").exists()
    with pytest.raises(ValueError, match="two or more runs"):
        myospring.compare(beat)
    with pytest.raises(ValueError, match="3 labels and 1 runs"):
        myospring.compare(beat, labels=["a", "b", "c"])
    with pytest.raises(ValueError, match="settings do not change"):
        myospring.compare(beat, beat, beats=2)


def test_settings_override_those_of_run_files_and_runs_are_labelled_in_order(cell, beat, tmp_path):
    weak = myospring.simulate(cell, integrator="quasi-static", peak_tension_kpa=20, title="weak")
    (tmp_path / "two.toml").write_text(beat.run_file.replace("beats = 1", "beats = 2"))
    # A setting that is the default overrides a run file, too.
    found = myospring.compare(tmp_path / "two.toml", scale={"weaker": {"peak_tension": 0.5}}, beats=1, peak_tension_kpa=40)
    assert found.settings["cell.peak_tension"] == ["40 kPa", "20 kPa"]
    with pytest.raises(TypeError, match="did you mean 'peak_tension_kpa'"):
        myospring.compare(tmp_path / "two.toml", peak_tension=40)
    assert myospring.compare(weak, beat).labels == ["weak", beat.cell.name]
    assert myospring.compare(weak, tmp_path / "two.toml", labels=["a", "b"]).labels == ["a", "b"]


def test_beats_of_arrays_are_run_anew_with_factors():
    y, x = np.mgrid[:60, :160]
    masks = [((x - 80) / half) ** 2 + ((y - 30) / 14) ** 2 < 1 for half in (60, 70)]
    cells = [myospring.Cell.from_mask(mask, pixel_size_um=1, spacing_um=4) for mask in masks]
    beats = [myospring.simulate(cell, integrator="quasi-static") for cell in cells]
    found = myospring.compare(*beats, scale={"weaker": {"peak_tension": 0.5}})
    lengths = found.metrics["resting_length"]
    # Two arrays have one name, and each run has its own.
    assert lengths[0] == pytest.approx(lengths[1]) and lengths[2] == pytest.approx(lengths[3])
    assert lengths[2] - lengths[0] == pytest.approx(20, abs=3)


def test_a_saved_beat_is_read_back(cell, tmp_path):
    beat = myospring.simulate(cell, integrator="quasi-static", peak_tension_kpa=30)
    again = myospring.Beat.load(beat.save(tmp_path / "kept", outputs=["frames"]))
    assert again.metrics["peak_shortening"] == pytest.approx(beat.metrics["peak_shortening"], rel=1e-6)
    assert again.length_um == pytest.approx(beat.length_um, rel=1e-7)
    assert again.positions.shape == beat.positions.shape
    found = myospring.compare(beat, tmp_path / "kept")
    assert not found.settings and not found.differences["peak_shortening"].any()
    with pytest.raises(ValueError, match="holds no results"):
        myospring.Beat.load(tmp_path)


def test_whatever_takes_long_is_heard_of_and_ended_by_what_the_function_raises(cell):
    def ends(stage, done, of):
        heard.append((stage, done, of))
        if 2 * done > of:
            raise ZeroDivisionError

    t_ms = np.arange(0, 3000, 10.0)
    long = [
        lambda **more: myospring.simulate(cell, integrator="quasi-static", **more),
        lambda **more: myospring.simulate(cell, **more),
        lambda **more: myospring.simulate_preset("guinea-pig-unloaded", cell, **more),
        lambda **more: myospring.simulate_batch(np.full((20, 1), 20.0), ["peak_tension_kpa"], cell, **more),
        lambda **more: myospring.action_potential(beats=3, **more),
        lambda **more: myospring.fit((t_ms, lengths(t_ms)), cell, starts=2, **more),
        lambda **more: myospring.fit_many({"one": (t_ms, lengths(t_ms))}, cell, starts=1, **more),
    ]
    for number, work in enumerate(long):
        heard = []
        with warnings.catch_warnings(), pytest.raises(ZeroDivisionError):
            warnings.simplefilter("ignore", myospring.MyospringWarning)
            work(progress=ends)
        assert len({(stage, of) for stage, _, of in heard}) == 1, (number, heard)
        assert [done for _, done, _ in heard] == sorted(done for _, done, _ in heard), (number, heard)


def test_ctrl_c_ends_a_fit_in_threads_within_a_second(small_fit):
    begun = time.monotonic()
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        small_fit()
    # Half a second before Ctrl-C, and another second for a busy machine.
    assert time.monotonic() - begun < 2.5


def test_a_preset_beats_as_its_run_file_says(cell):
    assert set(myospring.presets()) >= {"adult-human", "guinea-pig-unloaded"}
    beat = myospring.simulate_preset("guinea-pig-unloaded", cell)
    assert 6 < beat.metrics["peak_shortening"] < 10
    stiffer = myospring.simulate_preset("guinea-pig-unloaded", cell, young_modulus_kpa=300)
    assert stiffer.metrics["peak_shortening"] < beat.metrics["peak_shortening"]
    with pytest.raises(KeyError, match="adult-human"):
        myospring.simulate_preset("adult")
