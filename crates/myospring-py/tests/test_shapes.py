"""Cells from arrays and files, and what goes wrong with them."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import myospring
from myospring import _native


def ellipse(rows=120, columns=320):
    y, x = np.mgrid[:rows, :columns]
    return ((x - columns / 2) / 120) ** 2 + ((y - rows / 2) / 30) ** 2 < 1


def picture():
    noise = np.random.default_rng(0).normal(0, 3, ellipse().shape)
    return (20 + 180 * ellipse() + noise).clip(0, 255).astype(np.uint8)


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.int64, np.float32, np.float64])
def test_a_picture_is_the_same_cell_in_every_type_of_number(kind):
    cell = myospring.Cell.from_image(picture().astype(kind), pixel_size_um=0.5)
    reference = myospring.Cell.from_image(picture(), pixel_size_um=0.5)
    assert cell.dimensions == reference.dimensions
    assert cell.dimensions.length_um == pytest.approx(120, abs=2)
    assert cell.mask.shape == (120, 320) and (cell.mask == ellipse()).mean() > 0.99
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(cell)).positions, cell.positions)


def test_views_of_an_array_are_read_as_they_look():
    flipped = np.asfortranarray(ellipse()[::-1])
    cell = myospring.Cell.from_mask(flipped, pixel_size_um=0.5, spacing_um=3)
    np.testing.assert_array_equal(cell.mask, flipped)


def test_an_array_is_the_same_cell_as_its_file(tmp_path):
    path = tmp_path / "mask.tif"
    from myospring import _native

    path.write_bytes(_native.tiff(ellipse().astype(np.uint8)))
    of_array = myospring.Cell.from_mask(ellipse(), pixel_size_um=0.5)
    of_file = myospring.Cell.from_mask(path, pixel_size_um=0.5)
    np.testing.assert_array_equal(of_array.positions, of_file.positions)
    beat = myospring.simulate(of_array, integrator="quasi-static", duration_ms=200.0)
    np.testing.assert_array_equal(
        beat.shortening_pct, myospring.simulate(of_file, integrator="quasi-static", duration_ms=200.0).shortening_pct
    )


def test_a_label_chooses_the_cell():
    labels = np.zeros((60, 500), dtype=np.int32)
    labels[10:50, 10:200], labels[10:50, 210:490] = 7, 70_000
    small = myospring.Cell.from_mask(labels, pixel_size_um=0.5, label=7)
    large = myospring.Cell.from_mask(labels, pixel_size_um=0.5)
    assert small.dimensions.area_um2 == pytest.approx(1900)
    assert large.dimensions.area_um2 == pytest.approx(2800)


def test_an_outline_of_points_is_in_micrometres():
    cell = myospring.Cell.from_outline([(0, 0), (120, 0), (120, 20), (0, 20)], spacing_um=4)
    assert cell.dimensions.area_um2 == pytest.approx(2400)
    assert cell.outline[0].shape[1] == 2


def test_errors_are_pythons_own_and_say_what_to_do(cell, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nothing\.tif"):
        myospring.Cell.from_image(tmp_path / "nothing.tif", pixel_size_um=0.5)
    with pytest.raises(ValueError, match="pixel_size_um"):
        myospring.Cell.from_image(picture())
    with pytest.raises(ValueError, match="rows, columns"):
        myospring.Cell.from_image(np.zeros((2, 3, 4, 5), dtype=np.uint8), pixel_size_um=0.5)
    with pytest.raises(ValueError, match=r"points, 2"):
        myospring.Cell.from_outline([[0, 0, 0]])
    with pytest.raises(myospring.UnknownNameError, match="adult_ventricular"):
        myospring.Cell.builtin("adult_ventriculer")
    with pytest.raises(KeyError, match="did you mean `coelho_2021`"):
        myospring.simulate(cell, model="cohelo_2021")
    with pytest.raises(KeyError, match="did you mean `tau_si`"):
        myospring.simulate(cell, parameters={"tau_sii": 1.0})
    with pytest.raises(ValueError, match="`peak_tension_kpa` = 600 kPa is outside its bounds, 0 kPa to 500 kPa"):
        myospring.simulate(cell, peak_tension_kpa=600)
    with pytest.raises(ValueError, match="`thickness_um` = NaN is not a finite number"):
        myospring.simulate(cell, thickness_um=float("nan"))
    with pytest.raises(TypeError, match="`thickness_um` is of type str; give a number in um"):
        myospring.simulate(cell, thickness_um="thick")
    with pytest.raises(ValueError, match="clamped-end"):
        myospring.simulate(cell, support="clampedend")
    with pytest.raises(ValueError, match="exclude each other"):
        myospring.simulate(cell, integrator="quasi-static", area_law="barycentric")


def test_true_is_no_number_and_what_a_mask_hides_is_not_measured(cell):
    for given in (True, np.True_):
        with pytest.raises(TypeError, match="`peak_tension_kpa` is of type .*; give a number in kPa"):
            myospring.simulate(cell, peak_tension_kpa=given)
        with pytest.raises(TypeError, match="give a dict of name to number"):
            myospring.simulate(cell, parameters={"tau_si": given})
    hidden = np.ma.masked_equal([[30.0], [60.0]], 60.0)
    with pytest.warns(myospring.MyospringWarning, match="NaN"):
        beaten = myospring.simulate_batch(hidden, ["peak_tension_kpa"], cell, metrics=["peak_tension"])
    assert beaten[0, 0] == pytest.approx(30, rel=1e-2) and np.isnan(beaten[1, 0])
    picture = np.ma.masked_equal(np.tile(np.array([0, 1], dtype=np.uint8), (40, 20)), 1)
    with pytest.raises(ValueError, match="fill what the mask hides"):
        myospring.Cell.from_mask(picture, pixel_size_um=1.0)


def test_a_run_that_stops_early_has_its_time_its_place_and_what_was_computed(cell):
    with pytest.raises(myospring.SimulationError, match="t = .* ms.*kPa") as caught:
        myospring.simulate(cell, integrator="quasi-static", peak_tension_kpa=500, young_modulus_kpa=5, area_modulus_kpa=0)
    error = pickle.loads(pickle.dumps(caught.value))
    assert 50 < error.time_ms < 600
    assert error.beat.t_ms[-1] <= error.time_ms and error.beat.t_ms.size > 100
    assert "stopped" in repr(error.beat)


def test_a_sheet_is_read_without_an_outline():
    rows, columns = np.mgrid[:240, :300]
    # Stripes 1.9 um apart, 30 degrees from upright; rows count downward.
    across = 0.2 * (columns * np.cos(np.pi / 6) - rows * np.sin(np.pi / 6))
    noise = np.random.default_rng(1).normal(0, 3, rows.shape)
    picture = (100 + 80 * np.cos(2 * np.pi * across / 1.9) + noise).astype(np.uint8)
    sheet = myospring.whole_frame(picture, pixel_size_um=0.2, spacing_um=2)
    assert sheet.read_pct > 90 and sheet.sarcomere_doubt is None
    assert sheet.median_sarcomere_um == pytest.approx(1.9, abs=0.02)
    assert sheet.mean_direction_deg == pytest.approx(30, abs=1) and sheet.alignment > 0.99
    assert sheet.positions.shape == (len(sheet.direction_deg), 2) and sheet.spacing_um == 2
    assert np.nanmedian(sheet.sarcomere_um) == pytest.approx(1.9, abs=0.02)
    assert "sarcomeres 1.90 um" in repr(sheet)
    with pytest.raises(ValueError, match="pixel_size_um"):
        myospring.whole_frame(picture)
    with pytest.warns(myospring.MyospringWarning, match="no fibres"):
        assert myospring.whole_frame(ellipse(), pixel_size_um=0.2).median_sarcomere_um is None


def test_a_stack_as_an_array_or_as_a_file_gives_the_same_thick_cell(tmp_path):
    slices, rows, columns = np.mgrid[:12, :60, :140]
    inside = ((columns - 70) / 60) ** 2 + ((rows - 30) / 20) ** 2 + ((slices - 5.5) / 4) ** 2 < 1
    given = {"pixel_size_um": 0.5, "z_step_um": 1, "spacing_um": 2, "modality": "mask"}
    of_array = myospring.Cell.from_stack(inside, **given)
    path = tmp_path / "cell.tif"
    path.write_bytes(_native.tiff(inside.astype(np.uint8), True))
    of_file = myospring.Cell.from_stack(path, **given)
    np.testing.assert_array_equal(of_array.positions, of_file.positions)
    assert abs(of_array.dimensions.area_um2 / (np.pi * 30 * 10) - 1) < 0.03
    beat = myospring.simulate(of_array)
    assert abs(beat.metrics["peak_shortening"] - 12) < 0.05
    assert 7 < np.ptp(beat.positions_in_space[0, :, 2]) < 9
    with pytest.raises(ValueError, match="give \\(slices, rows, columns\\)"):
        myospring.Cell.from_stack(inside[0], pixel_size_um=0.5, z_step_um=1)
    with pytest.raises(ValueError, match="z_step_um"):
        myospring.Cell.from_stack(inside, pixel_size_um=0.5)
    with pytest.raises(ValueError, match="thickness"):
        myospring.simulate(of_array, thickness_um=6)
