"""Fits of films and maps of tension are those of the program."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import myospring
from myospring import _native

try:
    import xarray
except ImportError:
    xarray = None

# One beat of 5 %, before and after it rest.
BEAT = [0.01, 0.03, 0.045, 0.05, 0.05, 0.048, 0.04, 0.03, 0.02, 0.012, 0.006, 0.003]
REST = [1e-4 * (frame % 5) for frame in range(12)]


@pytest.fixture(scope="module")
def film(tmp_path_factory) -> str:
    """A striped cell of 50 um, 40 frames a second, whose grains differ from frame to frame."""
    folder = tmp_path_factory.mktemp("film")
    column, row = np.meshgrid(np.arange(240), np.arange(110))
    for at, shortening in enumerate([*REST, *BEAT, *REST]):
        x = 0.25 * (column - 120.0) / (1 - shortening)
        y = 0.25 * (row - 55.0) / (1 + 0.4 * shortening)
        edge = 1 / (1 + np.exp(((x / 25) ** 4 + (y / 10) ** 4) * 8 - 8))
        phase = 1.3 * np.sin(0.9 * y + 0.23 * x) + 0.8 * np.cos(1.7 * y - 0.11 * x)
        stripes = 0.55 + 0.35 * np.cos(2 * np.pi * x / 1.9 + phase)
        uneven = 0.75 + 0.25 * np.sin(0.31 * x + 1.1 * y) * np.cos(0.17 * x - 0.6 * y)
        grain = (column * 7919 + row * 104_729 + int(1e4 * shortening) * 31) % 7
        values = (12 + 200 * edge * stripes * uneven + grain).astype(np.uint8)
        (folder / f"t{at:02}.tif").write_bytes(_native.tiff(values))
    return str(folder)


GIVEN = {"pixel_size_um": 0.25, "frame_rate_per_s": 40, "spacing_um": 2}


@pytest.fixture(scope="module")
def found(film) -> myospring.Fit:
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        fit = myospring.fit(film=film, starts=1, model="coelho_2021", **GIVEN)
    assert any("proportional to the assumed stiffness" in str(one.message) for one in said)
    return fit


def test_a_fit_of_a_film_has_numbers_its_cell_and_a_map_and_saves_itself(found, film, tmp_path):
    assert found.name == "stretch_1" and found.verdict in ("fits", "fits-nearly", "does-not-fit")
    assert found.parameters["tension_over_stiffness"].value > 0.02
    assert abs(found.cell.dimensions.length_um - 50) < 2.5
    assert found.shapes is not None and "um" in found.shapes
    beat = found.simulate()
    assert 2 < beat.metrics["peak_shortening"] < 8
    saved = found.save(tmp_path / "fit")
    names = {path.name for path in saved.iterdir()}
    assert {"fit.json", "curve.csv", "run.toml", "tension_map.csv", "report.html", "figures", "track"} <= names
    figures = {path.name for path in (saved / "figures").iterdir()}
    assert {"overlay.png", "overlay.gif", "tension_over_beat.png"} <= figures
    rows = np.genfromtxt(saved / "distances.csv", delimiter=",", names=True)
    np.testing.assert_allclose(rows["distance_um"], found.distances.distance_um, rtol=1e-6)
    with pytest.raises(OSError, match="already holds files"):
        found.save(saved)


def test_every_frame_of_a_film_has_its_distance_and_its_tensions_as_arrays(found):
    far, tension = found.distances, found.tension_map.over_time
    nodes, triangles = len(found.cell.positions), len(found.cell.triangles)
    assert far.positions.shape == (len(far.frames), nodes, 2) and far.frames.dtype == np.int64
    np.testing.assert_allclose(far.t_ms, 25.0 * far.frames)
    assert np.isfinite(far.distance_um).all() and far.distance_um.max() < 0.4 * far.movement_um.max()
    # The fitted cell contracts with the film: by about 5 % of 50 um.
    extent = np.ptp(far.positions[:, :, 0], axis=1)
    assert 1.5 < extent.max() - extent.min() < 3.5
    assert list(far.to_dataframe().columns) == ["t_ms", "distance_um", "movement_um"] and "frames" in repr(far)
    assert tension.tension_kpa.shape == tension.standard_deviation_kpa.shape == (len(tension.frames), triangles)
    peak = tension.mean_tension_kpa.argmax()
    assert tension.mean_tension_kpa[peak] == pytest.approx(found.tension_map.mean_tension_kpa, rel=0.1)
    # A place that is not known has no number.
    known = np.isfinite(tension.tension_kpa).mean(axis=1)
    np.testing.assert_allclose(100 * known, tension.known_pct)
    assert 12 <= tension.frames[peak] < 24 and "triangles" in repr(tension)
    if xarray is not None:
        assert tension.to_xarray()["tension_kPa"].dims == ("frame", "triangle")


def test_a_film_of_an_array_is_fitted_as_its_files_are(found, film):
    frames = np.array([np.asarray(Image.open(path)) for path in sorted(Path(film).iterdir())])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        fit = myospring.fit(film=frames, starts=1, model="coelho_2021", **GIVEN)
    assert fit.parameters["tension_over_stiffness"] == found.parameters["tension_over_stiffness"]
    np.testing.assert_array_equal(fit.tension_map.tension_kpa, found.tension_map.tension_kpa)
    with pytest.raises(ValueError, match=r"give \(frames, rows, columns\)"):
        myospring.fit(film=frames[0], **GIVEN)


def test_a_map_has_an_entry_for_each_triangle_and_is_that_of_the_fit(found, film):
    steps = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        alone = myospring.tension_map(film, progress=lambda *step: steps.append(step), **GIVEN)
        stiffer = myospring.tension_map(film, young_modulus_kpa=616, area_modulus_kpa=350, **GIVEN)
    of_fit = found.tension_map
    assert np.array_equal(alone.tension_kpa, of_fit.tension_kpa)
    assert len(alone.tension_kpa) == len(alone.cell.triangles) == len(alone.centres) == len(alone.to_dataframe())
    assert len(alone.positions) == len(alone.cell.positions)
    # Tensions are in proportion to both moduli; the solver's tolerance is 1e-6.
    assert stiffer.mean_tension_kpa == pytest.approx(2 * alone.mean_tension_kpa, rel=1e-2)
    assert ("frames", 36, 36) in steps
    if xarray is not None:
        assert alone.to_xarray()["tension_kPa"].sizes == {"triangle": len(alone.tension_kpa)}
    assert "<svg" in alone._repr_html_() and "TensionMap of" in repr(alone)


def test_what_is_no_film_or_no_setting_of_one_is_refused(film, tmp_path):
    with pytest.raises(TypeError, match="spacing_umm"):
        myospring.tension_map(film, spacing_umm=2)
    with pytest.raises(FileNotFoundError):
        myospring.tension_map(tmp_path / "none.avi")
    with pytest.raises(ValueError, match="frame_rate_per_s=30"):
        myospring.tension_map(film, pixel_size_um=0.25)
    with pytest.raises(ValueError, match="leave curve, cell, loaded and recorded_calcium out"):
        myospring.fit(film, film=film)
    with pytest.raises(ValueError, match="nothing to fit to"):
        myospring.fit()

    def stops(*_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        myospring.tension_map(film, progress=stops, **GIVEN)


def test_waves_in_an_array_of_light_are_mapped_and_saved(tmp_path):
    # 20 cm/s to the right, 500 frames a second, pixels of 0.1 mm; the light falls by a tenth for 150 ms.
    t, x = 2.0 * np.arange(200)[:, None, None], np.arange(30)[None, None, :]
    since = t - 80 - 100 * x / 200 + np.zeros((1, 16, 1))
    up = 1 / (1 + np.exp(-since / 2)) / (1 + np.exp((since - 130) / 8))
    film = (20000 - 2000 * up + np.random.default_rng(1).normal(0, 20, up.shape)).astype(np.uint16)
    given = {"pixel_size_um": 100, "frame_rate_per_s": 500}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        waves = myospring.map_waves(film, stimulus_times_ms=[70], **given)
    assert waves.activation_ms.shape == waves.duration_ms.shape == (16, 30)
    np.testing.assert_allclose(waves.activation_ms[:, 5:25], (10 + x[0] / 2 + np.zeros((16, 1)))[:, 5:25], atol=1)
    assert waves.metrics[0]["conduction_velocity"] == pytest.approx(20, rel=0.05)
    assert waves.light.shape == waves.t_ms.shape == (200,) and waves.numbers["falls"]
    np.testing.assert_array_equal(waves.wave(0)[0].shape, (16, 30))
    saved = waves.save(tmp_path / "waves")
    assert {"activation.csv", "waves.csv", "waves.json", "report.html"} <= {path.name for path in saved.iterdir()}
    with pytest.raises(ValueError, match="there are 1 waves"):
        waves.wave(1)
    with pytest.raises(ValueError, match="frame_rate_per_s"):
        myospring.map_waves(film, pixel_size_um=100)


def test_posts_in_an_array_are_tracked(tmp_path):
    y, x = np.mgrid[0:80, 0:160]

    def frame(pull):
        posts = [(35 + pull, 40), (125 - pull, 40)]
        dark = sum(1 / (1 + np.exp((np.hypot(x - a, y - b) - 10) / 0.7)) for a, b in posts)
        return (200 - 120 * dark).astype(np.uint8)

    pulls = 2 * np.sin(np.pi * np.clip((np.arange(40) % 20 - 4) / 10, 0, 1)) ** 2
    film = np.array([frame(pull) for pull in pulls])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        posts = myospring.track_posts(
            film,
            pixel_size_um=4,
            frame_rate_per_s=20,
            post_stiffness_nn_per_um=400,
            posts_px=[(35, 40, 20), (125, 40, 20)],
        )
    np.testing.assert_allclose(posts.approach_um, 2 * 4 * pulls, atol=0.3)
    np.testing.assert_allclose(posts.force_nn, 200 * posts.approach_um)
    assert (posts.save(tmp_path / "posts") / "posts.csv").exists()
    with pytest.raises(ValueError, match="a post has 2 numbers"):
        myospring.track_posts(film, pixel_size_um=4, frame_rate_per_s=20, posts_px=[(35, 40), (125, 40)])
