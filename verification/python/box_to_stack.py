"""`examples/mesh_to_stack.py` on a box of five tetrahedra: as many voxels as it has room for, and none outside.

    python box_to_stack.py box.tif
"""

import pathlib
import sys
import tempfile

import meshio
import numpy as np
import tifffile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "examples"))

import mesh_to_stack

SIZE = np.array([60.0, 20.0, 10.0])
CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
TETRAHEDRA = [[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]]

with tempfile.TemporaryDirectory() as folder:
    mesh = f"{folder}/box.vtk"
    meshio.Mesh(CORNERS * SIZE + 5.0, [("tetra", np.array(TETRAHEDRA))]).write(mesh)
    mesh_to_stack.main(mesh, sys.argv[1], 0.5)
with tifffile.TiffFile(sys.argv[1]) as file:
    voxels = file.asarray()
z, y, x = np.nonzero(voxels)
assert (voxels > 0).sum() == SIZE.prod() / 0.5**3, (voxels > 0).sum()
assert [np.ptp(along) + 1 for along in (x, y, z)] == list(SIZE / 0.5)
