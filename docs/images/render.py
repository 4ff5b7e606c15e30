#!/usr/bin/python3
"""Pictures of blocks.vtu files for the documentation: render.py IN.vtu OUT.png [azimuth elevation [explode [array]]]

Blocks are drawn in muted colours by number (or by a cell array), moved apart from the centre by `explode`. Needs Debian's python3-vtk9.
"""
import sys

from vtkmodules.vtkCommonColor import vtkNamedColors  # noqa: F401 (registers factories)
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)
from vtkmodules.vtkFiltersCore import vtkFeatureEdges
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
import vtkmodules.vtkCommonDataModel as dm
from vtkmodules.vtkCommonCore import vtkPoints, vtkIdList
import colorsys


def colour(n):
    h = (0.07 + 0.618033988749895 * n) % 1.0
    r, g, b = colorsys.hls_to_rgb(h, 0.66, 0.32)
    return int(255 * r), int(255 * g), int(255 * b)


def main():
    source, target = sys.argv[1:3]
    azimuth, elevation = (float(v) for v in (sys.argv[3:5] or ("35", "25")))
    explode = float(sys.argv[5]) if len(sys.argv) > 5 else 0.0
    array = sys.argv[6] if len(sys.argv) > 6 else "block"
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(source)
    reader.Update()
    grid = reader.GetOutput()
    block = grid.GetCellData().GetArray("block")
    shade = grid.GetCellData().GetArray(array)
    bounds = grid.GetBounds()
    centre = [(bounds[2 * k] + bounds[2 * k + 1]) / 2 for k in range(3)]
    # Every face of every cell on its own points, so that blocks can be moved apart.
    points, polygons = vtkPoints(), dm.vtkCellArray()
    colours = vtkUnsignedCharArray()
    colours.SetNumberOfComponents(3)
    middle = {}
    for c in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(c)
        b = cell.GetBounds()
        m = middle.setdefault(block.GetValue(c), [0.0, 0.0, 0.0, 0])
        for k in range(3):
            m[k] += (b[2 * k] + b[2 * k + 1]) / 2
        m[3] += 1
    for c in range(grid.GetNumberOfCells()):
        number = int(block.GetValue(c))
        m = middle[block.GetValue(c)]
        move = [explode * (m[k] / m[3] - centre[k]) for k in range(3)]
        value = int(shade.GetValue(c))
        rgb = (205, 205, 200) if array != "block" and value < 0 else colour(value if array != "block" else number)
        cell = grid.GetCell(c)
        for f in range(cell.GetNumberOfFaces()):
            face = cell.GetFace(f)
            ids = vtkIdList()
            for p in range(face.GetNumberOfPoints()):
                x = face.GetPoints().GetPoint(p)
                ids.InsertNextId(points.InsertNextPoint([x[k] + move[k] for k in range(3)]))
            polygons.InsertNextCell(ids)
            colours.InsertNextTuple3(*rgb)
    surface = dm.vtkPolyData()
    surface.SetPoints(points)
    surface.SetPolys(polygons)
    surface.GetCellData().SetScalars(colours)
    # Concave faces need triangles.
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter
    triangles = vtkTriangleFilter()
    triangles.SetInputData(surface)
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(triangles.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.25)
    actor.GetProperty().SetDiffuse(0.8)
    edges = vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.BoundaryEdgesOn()
    edges.FeatureEdgesOff()
    edges.ColoringOff()
    lines = vtkPolyDataMapper()
    lines.SetInputConnection(edges.GetOutputPort())
    lines.ScalarVisibilityOff()
    wire = vtkActor()
    wire.SetMapper(lines)
    wire.GetProperty().SetColor(0.15, 0.15, 0.15)
    wire.GetProperty().SetLineWidth(1.0)
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    renderer.AddActor(wire)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(900, 640)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(centre[0], centre[1] - 1, centre[2])
    camera.SetFocalPoint(*centre)
    camera.SetViewUp(0, 0, 1)
    camera.Azimuth(azimuth)
    camera.Elevation(elevation)
    camera.OrthogonalizeViewUp()
    renderer.ResetCamera()
    camera.Zoom(1.25)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtkPNGWriter()
    writer.SetFileName(target)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()


main()
