"""All cells of a picture, and the cells of many pictures."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import myospring
from myospring import _native

QUICK = {"pixel_size_um": 0.5, "spacing_um": 6.0, "integrator": "quasi-static", "duration_ms": 300.0}


def labels(shift=0):
    """Two cells of 120 um and 100 um, 1 and 2."""
    rows, columns = np.mgrid[:200, :320]

    def ellipse(row, half):
        return ((columns - 160 - shift) / half) ** 2 + ((rows - row) / 28) ** 2 < 1

    return (ellipse(50, 120) + 2 * ellipse(150, 100)).astype(np.uint8)


@pytest.fixture
def folder(tmp_path):
    from myospring import _native

    pictures = tmp_path / "pictures"
    pictures.mkdir()
    for name, shift in [("a.tif", 0), ("b.tif", 8)]:
        (pictures / name).write_bytes(_native.tiff(labels(shift)))
    return pictures


def test_a_picture_gives_all_its_cells_with_outlines_masks_and_numbers():
    found = myospring.segment(labels(), pixel_size_um=0.5)
    assert [cell.number for cell in found] == [1, 2] and found.left_out == {}
    assert repr(found) == "<myospring.Segmentation of array.tif: 2 cells, mask>"
    large, small = found
    assert large.shape["length_um"] == pytest.approx(120, abs=2)
    assert small.shape["length_um"] == pytest.approx(100, abs=2)
    assert large.outline[0].shape[1] == 2 and large.confidence == 1.0
    np.testing.assert_array_equal(large.mask, labels() == 1)
    with pytest.warns(myospring.MyospringWarning, match="2 cells"):
        assert myospring.segment(labels(), pixel_size_um=0.5, cell=2)[0].shape == small.shape
    table = found.to_dataframe()
    assert table["area_um2"].is_monotonic_decreasing and len(table) == 2
    assert "<table>" in found._repr_html_() and found._repr_svg_().startswith("<svg")


def test_cells_that_are_left_out_say_why():
    cut = np.pad(labels(), ((0, 0), (0, 0)))
    cut[40:60, :60] = 1
    with pytest.warns(myospring.MyospringWarning, match="cut by the frame"):
        found = myospring.segment(cut, pixel_size_um=0.5)
    assert len(found) == 1 and "frame" in found.left_out[1]
    with pytest.raises(ValueError, match="pixel_size_um"):
        myospring.segment(labels())
    with pytest.raises(FileNotFoundError, match=r"nothing\.tif"):
        myospring.segment("nothing.tif", pixel_size_um=0.5)


def test_outlines_are_saved_in_any_format_and_come_back_the_same(tmp_path):
    found = myospring.segment(labels(), pixel_size_um=0.5)
    for name in ["cells.zip", "cells.geojson", "cells.txt", "cells.png"]:
        assert found.save(tmp_path / name, force=True).is_file()
    again = myospring.segment(labels(), pixel_size_um=0.5, outline=tmp_path / "cells.zip")
    assert again[0].shape["area_um2"] == pytest.approx(found[0].shape["area_um2"], rel=0.01)
    with pytest.raises(OSError, match="already exists"):
        found.save(tmp_path / "cells.zip")
    with pytest.raises(OSError, match="one outline"):
        found.save(tmp_path / "one.roi")
    results = found.save(tmp_path / "results")
    assert {"outline.geojson", "overlay.png", "report.json"} <= {path.name for path in results.iterdir()}


def test_the_cells_of_a_folder_are_a_table_that_goes_on_where_it_was(folder, tmp_path, caplog):
    told = []
    first = myospring.batch(folder, output=tmp_path / "beats", progress=lambda *step: told.append(step), **QUICK)
    assert told[-1] == ("pictures", 2, 2) and first.resumed == 0
    assert first.counts == {"ok": 4} and first["picture"] == ["a.tif", "a.tif", "b.tif", "b.tif"]
    assert (first["peak_shortening_pct"] > 5).all()
    with caplog.at_level("INFO", logger="myospring"):
        again = myospring.batch(folder, output=tmp_path / "beats", **QUICK)
    assert again.resumed == 2 and "2 of 2 pictures are done" in caplog.text
    np.testing.assert_array_equal(again["peak_shortening_pct"], first["peak_shortening_pct"])
    assert len(again.to_dataframe()) == len(again) == 4 and "<table>" in again._repr_html_()
    assert (tmp_path / "beats" / "cells.csv").is_file() and (tmp_path / "beats" / "overlays" / "a_tif.png").is_file()
    with pytest.raises(OSError, match="other settings"):
        myospring.batch(folder, output=tmp_path / "beats", **QUICK, peak_tension_kpa=30.0)


def test_a_list_of_pictures_needs_no_folder_and_a_bad_picture_is_a_row(folder, tmp_path):
    bad = tmp_path / "bad.tif"
    bad.write_bytes(b"no picture")
    with pytest.warns(myospring.MyospringWarning, match="1 rows failed"):
        made = myospring.batch([folder / "a.tif", bad], cell=1, **QUICK)
    assert made.counts == {"ok": 1, "failed": 1} and made.folder is None
    assert list(made.failed) == [str(bad)] and np.isnan(made["peak_shortening_pct"][1])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        one = myospring.batch([folder / "a.tif"], cell=1, **QUICK)
    assert one["peak_shortening_pct"][0] == made["peak_shortening_pct"][0]


def test_a_batch_of_stacks_has_a_thick_cell_in_each_row_and_the_turn_of_its_fibres(tmp_path):
    slices, rows, columns = np.mgrid[:12, :120, :280]
    x, y = 0.25 * (columns - 140), 0.25 * (60 - rows)
    inside = ((x / 30) ** 4 + (y / 10) ** 4 < 1) & (slices >= 2) & (slices < 10)
    # Sarcomeres of 1.8 um, turned by 4 degrees from slice to slice.
    turn = np.radians(4 * (slices - 5.5))
    wave = np.sin(2 * np.pi * (np.cos(turn) * x + np.sin(turn) * y) / 1.8)
    grey = np.where(inside, 140 + 60 * wave, 5) + 10 * np.random.default_rng(1).random(inside.shape)
    (tmp_path / "stacks").mkdir()
    for name in ("a.tif", "b.tif"):
        (tmp_path / "stacks" / name).write_bytes(_native.tiff(grey.astype(np.uint8), True))
    given = {"stacks": True, "pixel_size_um": 0.25, "z_step_um": 1, "spacing_um": 2, "output": tmp_path / "beats"}
    first = myospring.batch(tmp_path / "stacks", **given).columns
    assert first["status"] == ["ok", "ok"]
    for column, value, within in (
        ("slices_with_fibres", 8, 0),
        ("fibre_turn_deg", 28, 2),
        ("sarcomere_um", 1.8, 0.03),
        ("largest_thickness_um", 8, 0.6),
    ):
        np.testing.assert_allclose(first[column], value, atol=within, err_msg=column)
    # What is done is not done again.
    (tmp_path / "stacks" / "c.tif").write_bytes(_native.tiff(grey.astype(np.uint8), True))
    again = myospring.batch(tmp_path / "stacks", **given)
    assert again.resumed == 2 and again.columns["status"] == ["ok"] * 3
    np.testing.assert_array_equal(again.columns["peak_shortening_pct"][:2], first["peak_shortening_pct"])


def test_what_is_wrong_with_a_batch_is_said_before_it_begins(folder):
    with pytest.raises(TypeError, match="peak_tenson_kpa"):
        myospring.batch(folder, peak_tenson_kpa=3)
    with pytest.raises(ValueError, match="thickness_um"):
        myospring.batch(folder, thickness_um=-1.0, **QUICK)
    with pytest.raises(FileNotFoundError, match="nothing"):
        myospring.batch(folder / "nothing", **QUICK)
    with pytest.raises(ValueError, match="no file like"):
        myospring.batch(folder, pattern="*.png", **QUICK)

    def refuse(*_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        myospring.batch(folder, progress=refuse, **QUICK)
