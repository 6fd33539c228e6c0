"""From tetrahedra in space to a stack in depth: 255 in each voxel whose middle is inside, 0 elsewhere.

    python mesh_to_stack.py cell.vtk cell.tif 0.25      # voxels of 0.25 um
    myospring run --stack cell.tif

Reads what meshio reads (VTK, VTU, Gmsh, Abaqus, XDMF, ...); lengths are taken as um. Needs: pip install meshio tifffile
"""

import sys

import meshio
import numpy as np
import tifffile


def stack(points: np.ndarray, tetrahedra: np.ndarray, side: float) -> np.ndarray:
    """Voxels by slice from below, row from the top of the picture, column; the outermost are empty."""
    low = points.min(axis=0) - side
    size = np.ceil((points.max(axis=0) + side - low) / side).astype(int)
    inside = np.zeros(size[::-1], np.uint8)
    for corners in points[tetrahedra]:
        first = np.floor((corners.min(axis=0) - low) / side).astype(int)
        last = np.floor((corners.max(axis=0) - low) / side).astype(int) + 1
        places = np.stack(np.meshgrid(*map(np.arange, first, last), indexing="ij"), axis=-1).reshape(-1, 3)
        middles = low + (places + 0.5) * side
        if np.linalg.matrix_rank(corners[1:] - corners[0]) < 3:
            continue
        # Barycentric coordinates of three corners; the fourth is 1 minus their sum.
        parts = np.linalg.solve((corners[1:] - corners[0]).T, (middles - corners[0]).T)
        # A middle on a face may be rounded out of both tetrahedra.
        x, y, z = places[(parts.min(axis=0) >= -1e-9) & (parts.sum(axis=0) <= 1 + 1e-9)].T
        inside[z, -1 - y, x] = 255
    return inside


def main(mesh: str, tiff: str, side: float) -> None:
    read = meshio.read(mesh)
    tetrahedra = [block.data for block in read.cells if block.type == "tetra"]
    if not tetrahedra:
        sys.exit(f"{mesh} has no tetrahedra: {sorted({block.type for block in read.cells})}")
    voxels = stack(read.points, np.concatenate(tetrahedra), side)
    metadata = {"axes": "ZYX", "spacing": side, "unit": "um"}
    tifffile.imwrite(tiff, voxels, imagej=True, resolution=(1 / side, 1 / side), metadata=metadata)
    print(f"{tiff}: {voxels.shape[0]} slices, {(voxels > 0).sum() * side**3:.0f} um^3")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], float(sys.argv[3]))
