"""Tractions of a cell on a gel."""

import numpy as np
import pytest

import myospring
from myospring import _native


def pulled(rows: int = 40, columns: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """Displacements (um) of a gel that is drawn together in the middle, places 1 um apart."""
    y, x = np.mgrid[:rows, :columns].astype(float)
    x, y = x - columns / 2, y - rows / 2
    size = 0.2 * np.exp(-(x**2 + y**2) / 60)
    return -x * size / 3, -y * size / 3


def beads(u: np.ndarray, v: np.ndarray, part: float) -> np.ndarray:
    """A picture of beads that moved by a part of the displacements: four pixels a um."""
    random = np.random.default_rng(3)
    rows, columns = u.shape
    place = random.uniform((0, 0), (columns, rows), (int(0.6 * rows * columns), 2))
    light = random.uniform(0.5, 1.5, len(place))
    column, row = place.astype(int).T
    x, y = place.T + part * np.array([u[row, column], v[row, column]])
    picture = np.full((4 * rows, 4 * columns), 10.0)
    at_y, at_x = np.mgrid[-4:5, -4:5]
    for x, y, brightness in zip(4 * x, 4 * y, light):
        r, c = int(y) + at_y, int(x) + at_x
        spot = 80 * brightness * np.exp(-((c + 0.5 - x) ** 2 + (r + 0.5 - y) ** 2) / 2)
        inside = (r >= 0) & (c >= 0) & (r < picture.shape[0]) & (c < picture.shape[1])
        np.add.at(picture, (r[inside], c[inside]), spot[inside])
    return np.clip(picture + random.normal(0, 1, picture.shape), 0, 255).astype(np.uint8)


def test_tractions_of_arrays_in_any_order_and_their_table(tmp_path):
    u, v = pulled()
    with pytest.warns(myospring.MyospringWarning, match="whole window"):
        found = myospring.traction((u, v), spacing_um=1.0, gel_modulus_kpa=10)
        turned = myospring.traction((np.asfortranarray(u), v), spacing_um=1.0, gel_modulus_kpa=10)
    assert found.axial_force_nn.shape == (1,) and found.axial_force_nn[0] > 0
    assert np.array_equal(found.axial_force_nn, turned.axial_force_nn)
    assert found.contractile_moment_fj[0] > 0 and np.isnan(found.t_ms[0])
    x, y = found.tractions_pa
    assert x.shape == (1, 40, 60)
    # Drawn together: to the right on the left, and downward above.
    assert x[0, 20, 25] > 0 > x[0, 20, 35] and y[0, 15, 30] > 0 > y[0, 25, 30]
    assert np.allclose(found.displacements_um[0][0], u)
    np.save(tmp_path / "u.npy", np.asfortranarray(u))
    np.save(tmp_path / "v.npy", v)
    saved = found.save(tmp_path / "found")
    assert {"traction.csv", "summary.json", "tractions.npz"} <= {path.name for path in saved.iterdir()}


def test_tractions_of_pictures_of_beads_are_those_of_their_displacements():
    u, v = pulled()
    relaxed, now = beads(u, v, 0.0), beads(u, v, 1.0)
    with pytest.warns(myospring.MyospringWarning, match="whole window"):
        found = myospring.traction(now, reference=relaxed, pixel_size_um=0.25, gel_modulus_kpa=10)
        known = myospring.traction((u, v), spacing_um=1.0, gel_modulus_kpa=10)
    assert found.numbers["beads"]["relative_to_rest"] is False
    assert found.contractile_moment_fj[0] == pytest.approx(known.contractile_moment_fj[0], rel=0.3)
    film = np.stack([beads(u, v, part) for part in (0, 0, 0, 0.5, 1, 0.5, 0, 0)])
    with pytest.warns(myospring.MyospringWarning, match="whole window"):
        found = myospring.traction(film, pixel_size_um=0.25, frame_rate_per_s=10, gel_modulus_kpa=10)
    assert int(np.argmax(found.axial_force_nn)) == 4
    assert found.to_dataframe()["t_ms"].iloc[-1] == pytest.approx(700)


def test_what_does_not_go_together_is_refused():
    u, v = pulled()
    with pytest.raises(ValueError, match="spacing_um is missing"):
        myospring.traction((u, v), gel_modulus_kpa=10)
    with pytest.raises(ValueError, match="shape"):
        myospring.traction((u[0], v[0]), spacing_um=1.0, gel_modulus_kpa=10)
    with pytest.raises(ValueError, match="one picture"):
        myospring.traction(beads(u, v, 0.0), pixel_size_um=0.25, gel_modulus_kpa=10)


def test_a_table_is_as_good_as_arrays_and_a_mask_says_where_the_cell_is(tmp_path):
    u, v = pulled()
    y, x = np.mgrid[:40, :60]
    table = np.column_stack([4 * x.ravel(), 4 * y.ravel(), 4 * u.ravel(), 4 * v.ravel()])
    np.savetxt(tmp_path / "piv.csv", table, delimiter=",", header="x,y,u,v", comments="")
    middle = np.hypot(x - 30, y - 20) < 14
    cell = tmp_path / "cell.tif"
    cell.write_bytes(_native.tiff(255 * middle.astype(np.uint8)))
    found = myospring.traction(tmp_path / "piv.csv", pixel_size_um=0.25, gel_modulus_kpa=10, cell=cell)
    known = myospring.traction((u, v), spacing_um=1.0, gel_modulus_kpa=10, cell=cell)
    assert found.numbers["confined_to_a_region"] is True
    assert found.axial_force_nn[0] == pytest.approx(known.axial_force_nn[0], rel=1e-6)
