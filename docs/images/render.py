#!/usr/bin/python3
"""Pictures of blocks.vtu files for the documentation: render.py IN.vtu OUT.png [azimuth elevation [explode [array]]] [--bare]

Blocks are drawn in muted colours by number (or by a cell array), moved apart from the centre by `explode`. With --bare
the faces on the sides of the whole are left open, so that one looks at the openings within. Needs Debian's python3-vtk9; without a
display run it by xvfb-run.
"""
import collections
import colorsys
import sys

import vtkmodules.vtkCommonDataModel as dm
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (registers the renderer)
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints, vtkUnsignedCharArray
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)


def colour(n):
    h = (0.07 + 0.618033988749895 * n) % 1.0
    r, g, b = colorsys.hls_to_rgb(h, 0.66, 0.32)
    return int(255 * r), int(255 * g), int(255 * b)


def main():
    bare = "--bare" in sys.argv
    words = [word for word in sys.argv[1:] if word != "--bare"]
    source, target = words[:2]
    azimuth, elevation = (float(v) for v in (words[2:4] or ("35", "25")))
    explode = float(words[4]) if len(words) > 4 else 0.0
    array = words[5] if len(words) > 5 else "block"
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(source)
    reader.Update()
    grid = reader.GetOutput()
    block = grid.GetCellData().GetArray("block")
    shade = grid.GetCellData().GetArray(array)
    bounds = grid.GetBounds()
    centre = [(bounds[2 * k] + bounds[2 * k + 1]) / 2 for k in range(3)]
    points, polygons, lines = vtkPoints(), dm.vtkCellArray(), dm.vtkCellArray()
    colours = vtkUnsignedCharArray()
    colours.SetNumberOfComponents(3)
    middle = {}
    for c in range(grid.GetNumberOfCells()):
        b = grid.GetCell(c).GetBounds()
        m = middle.setdefault(block.GetValue(c), [0.0, 0.0, 0.0, 0])
        for k in range(3):
            m[k] += (b[2 * k] + b[2 * k + 1]) / 2
        m[3] += 1
    faces_of_block = collections.Counter()

    def place(number, corners):
        return number, frozenset(tuple(round(v, 6) for v in x) for x in corners)

    for c in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(c)
        for f in range(cell.GetNumberOfFaces()):
            p = cell.GetFace(f).GetPoints()
            faces_of_block[place(int(block.GetValue(c)), [p.GetPoint(k) for k in range(p.GetNumberOfPoints())])] += 1
    for c in range(grid.GetNumberOfCells()):
        number = int(block.GetValue(c))
        m = middle[block.GetValue(c)]
        move = [explode * (m[k] / m[3] - centre[k]) for k in range(3)]
        value = int(shade.GetValue(c))
        rgb = (205, 205, 200) if array != "block" and value < 0 else colour(value if array != "block" else number)
        cell = grid.GetCell(c)
        normals = {}  # of the faces at each edge: flat ones are no edges of the block
        for f in range(cell.GetNumberOfFaces()):
            face = cell.GetFace(f)
            ids = vtkIdList()
            corners = [face.GetPoints().GetPoint(p) for p in range(face.GetNumberOfPoints())]
            numbers = [face.GetPointId(p) for p in range(face.GetNumberOfPoints())]
            normal = [0.0, 0.0, 0.0]
            for p in range(len(corners)):
                a, b = corners[p], corners[(p + 1) % len(corners)]
                normal[0] += (a[1] - b[1]) * (a[2] + b[2])
                normal[1] += (a[2] - b[2]) * (a[0] + b[0])
                normal[2] += (a[0] - b[0]) * (a[1] + b[1])
            length = sum(v * v for v in normal) ** 0.5 or 1.0
            normal = [v / length for v in normal]
            for p in range(len(corners)):
                q = (p + 1) % len(corners)
                key = (min(numbers[p], numbers[q]), max(numbers[p], numbers[q]))
                normals.setdefault(key, []).append((normal, corners[p], corners[q]))
            if faces_of_block[place(number, corners)] > 1:
                continue  # between two cells of one block
            if bare and any(all(abs(x[k // 2] - bounds[k]) < 1e-6 for x in corners) for k in range(6)):
                continue
            for x in corners:
                ids.InsertNextId(points.InsertNextPoint([x[k] + move[k] for k in range(3)]))
            polygons.InsertNextCell(ids)
            colours.InsertNextTuple3(*rgb)
        for faces in normals.values():
            if len(faces) == 2 and sum(u * v for u, v in zip(faces[0][0], faces[1][0])) > 0.9998:
                continue
            ids = vtkIdList()
            for x in faces[0][1:]:
                ids.InsertNextId(points.InsertNextPoint([x[k] + move[k] for k in range(3)]))
            lines.InsertNextCell(ids)
    surface = dm.vtkPolyData()
    surface.SetPoints(points)
    surface.SetPolys(polygons)
    surface.GetCellData().SetScalars(colours)
    edges = dm.vtkPolyData()
    edges.SetPoints(points)
    edges.SetLines(lines)
    triangles = vtkTriangleFilter()  # concave faces need triangles
    triangles.SetInputData(surface)
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(triangles.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.25)
    actor.GetProperty().SetDiffuse(0.8)
    drawn = vtkPolyDataMapper()
    drawn.SetInputData(edges)
    drawn.SetRelativeCoincidentTopologyLineOffsetParameters(-1, -1)
    wire = vtkActor()
    wire.SetMapper(drawn)
    wire.GetProperty().SetColor(0.15, 0.15, 0.15)
    wire.GetProperty().SetLineWidth(1.0)
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    renderer.AddActor(wire)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(640, 460)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(centre[0], centre[1] - 1, centre[2])
    camera.SetFocalPoint(*centre)
    camera.SetViewUp(0, 0, 1)
    camera.Azimuth(azimuth)
    camera.Elevation(elevation)
    camera.OrthogonalizeViewUp()
    renderer.ResetCamera()
    camera.Zoom(1.1)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtkPNGWriter()
    writer.SetFileName(target)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()


main()
