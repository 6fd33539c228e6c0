"""Lets pyTFM find the tractions of simulated cells on gels; verification/src/gel.rs compares ours with them.

usage: pytfm_reference.py MYOSPRING FILE

MYOSPRING is the program, FILE the table to write (verification/reference/pytfm.csv). pyTFM 1.3.5 pins versions that the other
programs of `cargo xtask verify` cannot live with, and its trackers of beads are not needed, so it has an environment of its
own (Python 3.11) and those are left out:

    pip install numpy==2.4.6 scipy==1.17.1 matplotlib
    pip install --no-deps pyTFM==1.3.5

It is given the displacements of the gel around each cell as `myospring run --support gel` writes them, without its smoothing.
Forces are sums within the cell and two pixels around it, because in a window its transforms wrap round.
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import types

import numpy as np
import scipy.ndimage as nd

for missing in ("openpiv", *(f"openpiv.{part}" for part in ("filters", "pyprocess", "scaling", "tools", "validation"))):
    sys.modules[missing] = types.ModuleType(missing)
sys.modules["openpiv.pyprocess"].extended_search_area_piv = None
sys.modules["scipy.ndimage.filters"] = nd
utilities = types.ModuleType("pyTFM.utilities_TFM")
utilities.suppress_warnings = None
sys.modules["pyTFM.utilities_TFM"] = utilities
from pyTFM.TFM_functions import ffttc_traction  # noqa: E402

MODULI_KPA = [1, 10, 100]


def forces(folder):
    """Total and axial force (nN) of the cell in a folder of results."""
    u, v = (np.load(folder / "gel" / f"{name}.npy") for name in "uv")
    about = json.loads((folder / "gel" / "gel.json").read_text())
    pixel, gel = about["pixel_size_um"], about["gel"]
    side = 1e-6 * pixel
    tx, ty = ffttc_traction(u, v, side, side, 1e3 * gel["modulus"], gel["poisson"], spatial_filter=None)
    inside = np.zeros(u.shape, bool)
    with open(folder / "gel" / "tractions.csv") as table:
        for node in csv.DictReader(table):
            column, row = (
                round((float(node[name]) - first) / pixel) for name, first in zip(("x_um", "y_um"), about["first_pixel_um"])
            )
            inside[u.shape[0] - 1 - row, column] = True
    inside = nd.binary_dilation(inside, iterations=2)
    # Pa times m^2, in nN.
    scale = 1e9 * side**2
    return np.hypot(tx, ty)[inside].sum() * scale, 0.5 * np.abs(tx)[inside].sum() * scale


def main(program, file):
    lines = ["gel_kPa,total_nN,axial_nN"]
    for modulus in MODULI_KPA:
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place, "cell")
            gel = ["--support", "gel", "--gel-modulus", f"{modulus} kPa"]
            subprocess.run([program, "run", *gel, "--outputs", "gel", "--output", folder], check=True, capture_output=True)
            total, axial = forces(folder)
        lines.append(f"{modulus},{total:.2f},{axial:.2f}")
    pathlib.Path(file).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
