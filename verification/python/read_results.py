"""Reads what a run left with the programs that its users have, and compares the numbers.

    python read_results.py RESULTS GUIDE

RESULTS was written by `myospring run --outputs vtu,frames`; GUIDE is docs/reference/results.md, whose Python
examples are run in RESULTS.
"""

import csv
import json
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
# Not all of vtk: what draws needs a display's libraries.
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

# vtu holds 32-bit floats: 6e-8 of 140 um each, summed over the 2000 squares of a cell.
SINGLE = 1e-5


def close(what, found, expected, tolerance):
    off = abs(found - expected)
    assert off <= tolerance * max(1.0, abs(expected)), f"{what}: {found}, not {expected}"


def polygon_areas(points, cells):
    x, y = points[cells][..., 0], points[cells][..., 1]
    return 0.5 * np.sum(x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y, axis=1)


def frames_for_numpy(results, traces):
    """Areas and times of frames.npz against traces.csv, to the 9 digits of the table."""
    frames = np.load(results / "frames.npz", allow_pickle=False)
    positions, triangles = frames["positions_um"], frames["triangles"]
    assert positions.dtype == np.float64 and triangles.dtype == np.int32
    assert positions.shape == (len(frames["t_ms"]), len(frames["rest_um"]), 2)
    assert np.allclose(np.hypot(*frames["fibre"].T), 1.0, atol=1e-12)
    areas = polygon_areas(frames["rest_um"], triangles)
    assert (areas > 0).all()
    close("area of the masses", frames["area_um2"].sum(), (frames["weights"] * areas).sum(), 1e-9)
    for t, tension, shape in zip(frames["t_ms"], frames["tension_kPa"], positions):
        row = traces[t]
        close(f"area at {t} ms", (frames["weights"] * polygon_areas(shape, triangles)).sum(), row["area_um2"], 1e-8)
        close(f"tension at {t} ms", tension, row["ta_kPa"], 1e-8)
    return frames


def with_meshio(file, row):
    """Area of a frame as meshio sees it."""
    mesh = meshio.read(file)
    quads = mesh.cells_dict["quad"]
    close(f"{file.name}: area", polygon_areas(mesh.points, quads).sum(), row["area_um2"], SINGLE)
    return mesh, quads


def with_vtk(file):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(file))
    reader.Update()
    assert reader.GetErrorCode() == 0, file
    return reader.GetOutput()


def frames_for_paraview(results, traces, frames):
    collection = ElementTree.parse(results / "cell.pvd").findall("Collection/DataSet")
    assert len(collection) == len(frames["t_ms"])
    rest = frames["rest_um"]
    for index in sorted({0, 1, len(collection) // 3, len(collection) - 1}):
        entry = collection[index]
        file, t = results / entry.get("file"), float(entry.get("timestep"))
        row = traces[t]
        mesh, quads = with_meshio(file, row)
        grid = with_vtk(file)
        assert grid.GetNumberOfPoints() == len(rest) and grid.GetNumberOfCells() == len(quads)
        points = vtk_to_numpy(grid.GetPoints().GetData())
        data = {
            of.GetArrayName(i): vtk_to_numpy(of.GetArray(i))
            for of in (grid.GetPointData(), grid.GetCellData(), grid.GetFieldData())
            for i in range(of.GetNumberOfArrays())
        }
        # The two programs agree, to the bit.
        assert np.array_equal(points, mesh.points)
        for name, [values] in mesh.cell_data.items():
            assert np.array_equal(values, data[name]), name
        for name, values in mesh.point_data.items():
            assert np.array_equal(values, data[name]), name
        close("time", data["TimeValue"][0], t, 1e-6)

        # And with what the run says.
        shape = frames["positions_um"][index]
        assert np.abs(points[:, :2] - shape).max() < 2e-5
        assert np.abs(data["displacement_um"][:, :2] - (shape - rest)).max() < 2e-5
        assert np.allclose(np.linalg.norm(data["displacement_um"], axis=1), data["displacement_magnitude_um"], atol=1e-5)
        close("tension", data["active_stress_kPa"].mean(), row["ta_kPa"], 1e-6)
        assert np.allclose(np.linalg.norm(data["fibre"], axis=1), 1.0, atol=1e-6)
        resting = polygon_areas(rest, quads)
        close("area ratio", (data["area_ratio"] * resting).sum(), row["area_um2"], SINGLE)
        if 0 < index < len(collection) - 1:
            before, after = frames["positions_um"][index - 1], frames["positions_um"][index + 1]
            seconds = (frames["t_ms"][index + 1] - frames["t_ms"][index - 1]) / 1e3
            found, velocity = data["velocity_um_per_s"][:, :2], (after - before) / seconds
            assert np.abs(found - velocity).max() <= 1e-6 * max(1.0, np.abs(velocity).max())
    # Fibre strain and shortening are of one size: the mean over a free cell, by area, at its shortest.
    times = np.array(list(traces))
    shortening = np.array([row["shortening_pct"] for row in traces.values()])
    top = int(np.argmin(np.abs(frames["t_ms"] - times[shortening.argmax()])))
    grid = with_vtk(results / collection[top].get("file"))
    strain = vtk_to_numpy(grid.GetCellData().GetArray("fibre_strain_pct"))
    across = vtk_to_numpy(grid.GetCellData().GetArray("cross_strain_pct"))
    at_top = traces[float(frames["t_ms"][top])]["shortening_pct"]
    close("mean fibre strain", -strain.mean(), at_top, 0.05)
    assert across.mean() > 0
    return at_top


def cube_volumes(points, cubes):
    """Volume of each hexahedron: half of the tetrahedra of both ways to cut it, as the mesh has it."""
    ways = [(0, 2, 7, 5), (1, 0, 2, 5), (3, 2, 0, 7), (4, 0, 5, 7), (6, 2, 7, 5), (1, 3, 4, 6), (0, 1, 3, 4), (2, 3, 1, 6), (5, 1, 6, 4), (7, 3, 4, 6)]
    a, b, c, d = (points[cubes[:, [way[corner] for way in ways]]] for corner in range(4))
    return 0.5 * np.abs(np.einsum("ijk,ijk->ij", b - a, np.cross(c - a, d - a)) / 6.0).sum(axis=1)


def thick_cell(results):
    """Cubes of a thick cell, if there is one: without overlap, with the volumes that the file states."""
    if not (results / "thick.pvd").exists():
        return 0
    collection = ElementTree.parse(results / "thick.pvd").findall("Collection/DataSet")
    for index in sorted({0, len(collection) // 3, len(collection) - 1}):
        file = results / collection[index].get("file")
        mesh, grid = meshio.read(file), with_vtk(file)
        cubes = mesh.cells_dict["hexahedron"]
        assert grid.GetNumberOfCells() == len(cubes) and grid.GetNumberOfPoints() == len(mesh.points)
        rest = mesh.points - mesh.point_data["displacement_um"]
        now, before = cube_volumes(mesh.points, cubes), cube_volumes(rest, cubes)
        [ratio], [fibre] = mesh.cell_data["volume_ratio"], mesh.cell_data["fibre"]
        assert (before > 0).all() and np.ptp(before) < SINGLE * before.max()
        assert np.abs(now / before - ratio).max() < 1e-4
        assert np.allclose(np.linalg.norm(fibre, axis=1), 1.0, atol=1e-6)
        assert np.array_equal(ratio, vtk_to_numpy(grid.GetCellData().GetArray("volume_ratio")))
    return len(collection)


def examples(guide, results):
    """Every Python example of the guide, run where the results are."""
    code = re.findall(r"```python\n(.*?)```", guide.read_text(encoding="utf-8"), re.DOTALL)
    assert code, f"{guide} has no Python example"
    import os

    os.chdir(results)
    for example in code:
        exec(compile(example, guide.name, "exec"), {})
    return len(code)


def main():
    results, guide = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    with open(results / "traces.csv", encoding="utf-8") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    traces = {row["t_ms"]: row for row in rows}
    frames = frames_for_numpy(results, traces)
    at_top = frames_for_paraview(results, traces, frames)
    thick_cell(results)
    summary = json.loads((results / "summary.json").read_text(encoding="utf-8"))
    metrics = {row["name"]: row["value"] for group in summary["beats"][0].values() if isinstance(group, list) for row in group}
    # A frame is the nearest to the peak, not the peak.
    close("peak shortening", at_top, metrics["peak_shortening"], 0.02)
    count = examples(guide, results)
    print(f"{len(frames['t_ms'])} frames agree in NumPy {np.__version__}, VTK {vtkVersion.GetVTKVersion()}, meshio {meshio.__version__}; {count} examples ran")


if __name__ == "__main__":
    main()
