#!/usr/bin/env python3
"""Opens blocks.vtu with VTK 9 and checks that every polyhedron is closed and has the stated volume.

usage: check_vtu.py FILE.vtu     (needs python3-vtk9)
Ends with 1 when a cell is open or its volume is off by more than 1e-9 of its own.
"""
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

reader = vtk.vtkXMLUnstructuredGridReader()
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput()
points = vtk_to_numpy(grid.GetPoints().GetData())
volumes = vtk_to_numpy(grid.GetCellData().GetArray("volume"))
blocks = vtk_to_numpy(grid.GetCellData().GetArray("block"))
ids = vtk.vtkIdList()
open_cells, worst = 0, 0.0
for cell in range(grid.GetNumberOfCells()):
    grid.GetFaceStream(cell, ids)
    stream = [ids.GetId(i) for i in range(ids.GetNumberOfIds())]
    at, uses, volume, origin = 1, {}, 0.0, points[stream[2]]
    for _ in range(stream[0]):
        n = stream[at]
        face = stream[at + 1 : at + 1 + n]
        at += n + 1
        for i in range(n):
            edge = (face[i], face[(i + 1) % n])
            uses[edge] = uses.get(edge, 0) + 1
        for i in range(1, n - 1):
            a, b, c = (points[face[k]] - origin for k in (0, i, i + 1))
            volume += np.dot(a, np.cross(b, c)) / 6
    if any(count != 1 or (b, a) not in uses for (a, b), count in uses.items()):
        open_cells += 1
    worst = max(worst, abs(volume - volumes[cell]) / volumes[cell])
print(f"{grid.GetNumberOfCells()} cells of {len(set(blocks.tolist()))} blocks, {open_cells} not closed, "
      f"largest relative error of a volume {worst:.1e}, sum {volumes.sum():.17g} m3")
sys.exit(1 if open_cells or worst > 1e-9 or grid.GetNumberOfCells() == 0 else 0)
