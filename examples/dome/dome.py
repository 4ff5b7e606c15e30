#!/usr/bin/env python3
"""Writes dome.obj (the shell and its foot) and dome_joints.obj (what parts the voussoirs), beside itself.

  examples/dome/dome.py [INNER OUTER]

Radii in steps of 325/256 m; 12 and 13, as shipped, give a thickness of 0.08 of the mean radius. Every corner lies on
rational points of circles (3-4-5 triangles around the axis, those with hypotenuse 65 along a meridian), so that all faces
are exactly flat and all neighbours share their corners exactly.
"""
import pathlib
import sys

ALONG = [(16, 63), (25, 60), (33, 56), (39, 52), (52, 39), (56, 33), (60, 25), (63, 16), (65, 0)]  # sine, cosine, * 65
AROUND = [(5, 0), (4, 3), (3, 4), (0, 5), (-3, 4), (-4, 3), (-5, 0), (-4, -3), (-3, -4), (0, -5), (3, -4), (4, -3)]  # * 5
METRES = 1 / 256
BASE = len(ALONG) - 1


def main():
    inner, outer = (int(word) for word in sys.argv[1:3]) if len(sys.argv) > 2 else (12, 13)

    def corner(radius, course, meridian):
        sine, cosine = ALONG[course]
        x, y = AROUND[meridian % len(AROUND)]
        return radius * sine * x, radius * sine * y, radius * cosine * 5

    def foot(radius, meridian):
        x, y, _ = corner(radius, BASE, meridian)
        return x, y, -(outer - inner) * 325 // 2

    free, ground, joints = [], [], []
    for k in range(len(AROUND)):
        for j in range(BASE):
            free.append([corner(outer, j, k), corner(outer, j + 1, k), corner(outer, j + 1, k + 1), corner(outer, j, k + 1)])
            free.append([corner(inner, j, k), corner(inner, j, k + 1), corner(inner, j + 1, k + 1), corner(inner, j + 1, k)])
            joints.append([corner(inner, j, k), corner(outer, j, k), corner(outer, j + 1, k), corner(inner, j + 1, k)])
            joints.append([corner(inner, j + 1, k), corner(outer, j + 1, k), corner(outer, j + 1, k + 1),
                           corner(inner, j + 1, k + 1)])
        free.append([corner(outer, 0, k), corner(outer, 0, k + 1), corner(inner, 0, k + 1), corner(inner, 0, k)])
        free.append([corner(outer, BASE, k), foot(outer, k), foot(outer, k + 1), corner(outer, BASE, k + 1)])
        free.append([corner(inner, BASE, k), corner(inner, BASE, k + 1), foot(inner, k + 1), foot(inner, k)])
        ground.append([foot(inner, k), foot(inner, k + 1), foot(outer, k + 1), foot(outer, k)])
        joints.append([corner(inner, BASE, k), corner(outer, BASE, k), foot(outer, k), foot(inner, k)])
    here = pathlib.Path(__file__).parent
    write(here / "dome.obj", {"free": free, "ground": ground})
    write(here / "dome_joints.obj", {"joints": joints})


def write(path, groups):
    numbers, lines = {}, []
    for name, faces in groups.items():
        lines.append(f"g {name}")
        for face in faces:
            lines.append("f " + " ".join(str(numbers.setdefault(point, len(numbers) + 1)) for point in face))
    points = ["v " + " ".join(repr(x * METRES) for x in point) for point in numbers]
    path.write_text("\n".join(points + lines) + "\n", encoding="utf-8")


main()
