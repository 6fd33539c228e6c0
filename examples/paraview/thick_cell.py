"""A thick cell in ParaView: its beat, the strain along the fibres on its surface and on a section, and the fibres inside.

In ParaView: File > Load State..., choose this file; then choose `cell.pvd` of your results. Without a window:

    pvpython examples/paraview/thick_cell.py results/cell/cell.pvd cell.png

The results are those of `myospring run --profile round --thickness "12 um" --outputs vtu`, or of a stack.
"""

import os
import sys

from paraview.simple import (
    ColorBy,
    Clip,
    CreateRenderView,
    GetAnimationScene,
    GetColorTransferFunction,
    GetScalarBar,
    Glyph,
    Hide,
    PVDReader,
    Render,
    ResetCamera,
    SaveScreenshot,
    Show,
)

FIELD = "fibre_strain_pct"  # or cross_strain_pct, volume_ratio, active_stress_kPa
TITLE = "Strain along the fibres (%)"


def show(results):
    """Shows the cell of a file `cell.pvd` at the largest strain of its beat; returns the view."""
    cell = PVDReader(FileName=os.path.abspath(results))
    view = CreateRenderView()
    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesLabelColor = [0.2, 0.2, 0.2]
    scene = GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    strongest, ends = 0.0, [0.0, 0.0]
    for time in cell.TimestepValues:
        cell.UpdatePipeline(time)
        low, high = cell.CellData[FIELD].GetRange()
        if low < ends[0]:
            strongest = time
        ends = [min(ends[0], low), max(ends[1], high)]
    cell.UpdatePipeline(strongest)
    scene.AnimationTime = strongest
    bounds = cell.GetDataInformation().GetBounds()
    middle = [0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]) for axis in range(3)]

    # The farther half, cut along the middle of the cell.
    half = Clip(Input=cell)
    half.ClipType = "Plane"
    half.ClipType.Origin = middle
    half.ClipType.Normal = [0.0, -1.0, 0.0]
    half.Crinkleclip = 1
    shown = Show(half, view)
    shown.Representation = "Surface With Edges"
    shown.EdgeColor = [0.35, 0.35, 0.35]
    ColorBy(shown, ("CELLS", FIELD))
    colours = GetColorTransferFunction(FIELD)
    colours.ApplyPreset("Viridis (matplotlib)", True)
    colours.InvertTransferFunction()
    colours.RescaleTransferFunction(*(round(end, 1) for end in ends))
    bar = GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = TITLE, ""
    bar.TitleColor = bar.LabelColor = [0.2, 0.2, 0.2]
    bar.TitleFontSize = bar.LabelFontSize = 12
    bar.LabelFormat = bar.RangeLabelFormat = "%.3g"
    bar.Orientation, bar.WindowLocation = "Horizontal", "Lower Center"
    bar.ScalarBarLength, bar.AddRangeLabels = 0.4, 0
    shown.SetScalarBarVisibility(view, True)

    # Fibres of the half that is cut away.
    fibres = Glyph(Input=cell, GlyphType="Line")
    fibres.OrientationArray = ["CELLS", "fibre"]
    fibres.ScaleArray = ["CELLS", "No scale array"]
    fibres.ScaleFactor = 4.0
    fibres.GlyphMode = "Uniform Spatial Distribution (Bounds Based)"
    fibres.MaximumNumberOfSamplePoints = 300
    lines = Show(fibres, view)
    ColorBy(lines, None)
    lines.AmbientColor = lines.DiffuseColor = [0.25, 0.25, 0.25]
    lines.LineWidth = 2.0

    Hide(cell, view)
    view.CameraParallelProjection = 1
    view.CameraPosition = [middle[0] - 60.0, middle[1] - 120.0, middle[2] + 90.0]
    view.CameraFocalPoint = middle
    view.CameraViewUp = [0.0, 0.0, 1.0]
    ResetCamera(view)
    view.CameraParallelScale *= 0.55
    Render(view)
    return view


if __name__ in ("__main__", "__vtkconsole__"):
    found = sys.argv[1] if len(sys.argv) > 1 else "results/adult_ventricular/cell.pvd"
    shown = show(found)
    if len(sys.argv) > 2:
        SaveScreenshot(sys.argv[2], shown, ImageResolution=[1600, 900])
