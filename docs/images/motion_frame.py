#!/usr/bin/python3
"""Puts blocks in motion and the rock about them into one file: motion_frame.py FOLDER FRAME OUT.vtu [axis least]

FOLDER is a result of `cleave run` with [motion]; blocks of the rock whose middle is below `least` on an axis (0, 1, 2) are left out,
so that one looks inside. Draw OUT.vtu by `render.py OUT.vtu OUT.png AZIMUTH ELEVATION 0 moving`: what moves has its colour, rock is grey.
"""
import csv
import sys

from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkIdList
from vtkmodules.vtkFiltersCore import vtkAppendFilter
from vtkmodules.vtkFiltersExtraction import vtkExtractCells
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter


def read(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def kept(grid, wanted, moving):
    """The cells that are wanted, with the arrays block and moving alone."""
    ids = vtkIdList()
    for c in range(grid.GetNumberOfCells()):
        if wanted(c):
            ids.InsertNextId(c)
    cells = vtkExtractCells()
    cells.SetInputData(grid)
    cells.SetCellList(ids)
    cells.Update()
    out = cells.GetOutput()
    block, number, shade = out.GetCellData().GetArray("block"), vtkDoubleArray(), vtkDoubleArray()
    number.SetName("block")
    shade.SetName("moving")
    for c in range(out.GetNumberOfCells()):
        number.InsertNextValue(block.GetTuple1(c))
        shade.InsertNextValue(block.GetTuple1(c) if moving else -1)
    for k in reversed(range(out.GetCellData().GetNumberOfArrays())):
        out.GetCellData().RemoveArray(k)
    for k in reversed(range(out.GetPointData().GetNumberOfArrays())):
        out.GetPointData().RemoveArray(k)
    out.GetCellData().AddArray(number)
    out.GetCellData().AddArray(shade)
    return out


def main():
    folder, frame, target = sys.argv[1:4]
    axis, least = (int(sys.argv[4]), float(sys.argv[5])) if len(sys.argv) > 5 else (0, float("-inf"))
    with open(f"{folder}/motion.csv", encoding="utf-8") as rows:
        gone = {int(row["block"]) for row in csv.DictReader(rows)}
    rock, moved = read(f"{folder}/blocks.vtu"), read(f"{folder}/motion_{int(frame):04d}.vtu")
    block = rock.GetCellData().GetArray("block")

    def stays(c):
        low, high = rock.GetCell(c).GetBounds()[2 * axis:2 * axis + 2]
        return int(block.GetTuple1(c)) not in gone and (low + high) / 2 >= least

    both = vtkAppendFilter()
    both.AddInputData(kept(rock, stays, False))
    both.AddInputData(kept(moved, lambda c: True, True))
    both.Update()
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(target)
    writer.SetInputData(both.GetOutput())
    writer.Write()


if __name__ == "__main__":
    main()
