#!/usr/bin/env python3
"""The mesh of joints for other programs, read as they would read it: weights made anew from the triangles of
flow_mesh.inp, heads and rates from flow_mesh.uge and the .ex files alone, by a solver of its own, beside the bounds of
summary.json. `flow_mesh.py CLEAVE`"""
import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile

program = os.path.abspath(sys.argv[1])
NU, G = 1.004e-6, 9.81
wrong = 0


def expect(true, what):
    global wrong
    if not true:
        wrong += 1
        print("wrong:", what)


def near(a, b, tolerance, what):
    expect(abs(a - b) <= tolerance * max(abs(a), abs(b), 1e-300), f"{what}: {a!r} and {b!r}")


def section(lines, word):
    """The rows that `WORD n` announces; takes them off the list."""
    name, count = lines.pop(0).split()
    expect(name == word, f"{word} is announced")
    rows = [[float(x) for x in line.split()] for line in lines[:int(count)]]
    del lines[:int(count)]
    return rows


def read_ucd(path):
    lines = open(path).read().splitlines()
    nodes, cells, of_node, of_cell, _ = map(int, lines[0].split())
    points = [tuple(map(float, line.split()[1:])) for line in lines[1:1 + nodes]]
    triangles = [line.split() for line in lines[1 + nodes:1 + nodes + cells]]
    at = 1 + nodes + cells
    expect(lines[at] == "1" + " 1" * of_node, "one figure of each node")
    heads = [float(line.split()[1]) for line in lines[at + 1 + of_node:at + 1 + of_node + nodes]]
    at += 1 + of_node + nodes
    expect(lines[at] == "3" + " 1" * of_cell, "three figures of each triangle")
    data = [list(map(float, line.split()[1:])) for line in lines[at + 1 + of_cell:]]
    expect(len(data) == cells, "the file ends with its last triangle")
    for k, row in enumerate(triangles):
        expect(row[0] == str(k + 1) and row[2] == "tri" and int(row[1]) == data[k][0] + 1, f"triangle {k + 1}")
    return points, [[int(x) - 1 for x in row[3:]] for row in triangles], heads, data


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def solve(count, links, held):
    """Potentials by conjugate gradients: links (a, b, c), held (a, c, potential outside)."""
    diagonal, right = [0.0] * count, [0.0] * count
    for a, b, c in links:
        diagonal[a] += c
        diagonal[b] += c
    for a, c, h in held:
        diagonal[a] += c
        right[a] += c * h

    def image(x):
        y = [0.0] * count
        for a, b, c in links:
            flow = c * (x[a] - x[b])
            y[a] += flow
            y[b] -= flow
        for a, c, _ in held:
            y[a] += c * x[a]
        return y

    # From a mean head: what is left is small, and so are its roundings.
    mean = sum(h for _, _, h in held) / len(held)
    x = [mean] * count
    rest = minus(right, image(x))
    ready = [r / d for r, d in zip(rest, diagonal)]
    along, size = ready[:], dot(rest, ready)
    first = size
    for _ in range(6000):
        if size <= 1e-26 * first:
            break
        y = image(along)
        step = size / dot(along, y)
        x = [a + step * b for a, b in zip(x, along)]
        rest = [a - step * b for a, b in zip(rest, y)]
        ready = [r / d for r, d in zip(rest, diagonal)]
        size, before = dot(rest, ready), size
        along = [a + size / before * b for a, b in zip(ready, along)]
    return x


def check(scene, folder):
    """Runs a scene and reads its mesh; what leaves through each file of a boundary, and the summary's part."""
    open(folder + ".toml", "w").write(scene)
    run = subprocess.run([program, "run", folder + ".toml", "--quiet", "-o", folder], capture_output=True, text=True)
    expect(run.returncode == 0, folder + ": " + run.stderr)
    flow = json.load(open(f"{folder}/summary.json"))["flow"]
    mesh = flow["mesh"]
    lines = open(f"{folder}/flow_mesh.uge").read().splitlines()
    cells, connections = section(lines, "CELLS"), section(lines, "CONNECTIONS")
    expect(not lines, "nothing else is in the grid")
    expect([int(c[0]) for c in cells] == list(range(1, mesh["cells"] + 1)), "cells are numbered from 1")
    points = [c[1:4] for c in cells]
    conductivity = mesh["permeability_m2"] * G / NU

    # Volumes: of the joints, and a third of each triangle.
    with open(f"{folder}/flow_joints.csv") as file:
        joints = list(csv.DictReader(file))
    water = sum(float(j["aperture_m"]) * float(j["wet_area_m2"]) for j in joints)
    near(sum(c[4] for c in cells), water, 1e-9, "water in all cells")
    nodes, triangles, heads, data = read_ucd(f"{folder}/flow_mesh.inp")
    expect([list(p) for p in nodes] == points, "nodes are where cells are")
    volume, conductance = [0.0] * len(cells), {}
    for corners, (joint, aperture, transmissivity) in zip(triangles, data):
        near(transmissivity, G * aperture**3 / 12 / NU, 1e-12, "transmissivity")
        near(aperture, float(next(j for j in joints if j["joint"] == str(int(joint)))["aperture_m"]), 1e-15, "aperture")
        for k in range(3):
            a, b, c = corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]
            u, v = minus(nodes[b], nodes[a]), minus(nodes[c], nodes[a])
            twice = math.sqrt(dot(cross(u, v), cross(u, v)))
            volume[a] += aperture * twice / 6
            side = min(b, c), max(b, c)
            conductance[side] = conductance.get(side, 0) + transmissivity * dot(u, v) / twice / 2
    expect(all(abs(v - c[4]) <= 1e-9 * v for v, c in zip(volume, cells)), "water of each cell")
    expect(len(conductance) == len(connections) == mesh["connections"], "a connection a side")
    most, links, negative, below, sizes = max(conductance.values()), [], 0, 0.0, 0.0
    for a, b, x, y, z, area in connections:
        a, b = int(a) - 1, int(b) - 1
        length = math.dist(points[a], points[b])
        links.append((a, b, conductivity * area / length))
        expect(abs(conductance[min(a, b), max(a, b)] - links[-1][2]) <= 1e-9 * most, "weights are cotangents")
        expect(math.dist([x, y, z], [(p + q) / 2 for p, q in zip(points[a], points[b])]) < 1e-9, "faces lie in the middle")
        negative += area < 0
        below += max(-links[-1][2], 0)
        sizes += abs(links[-1][2])
    expect(negative == mesh["negative"], "negative areas are counted")
    near(below / sizes, mesh["negative_share"], 1e-6, "their share")

    # Boundaries: heads beside the cells.
    with open(f"{folder}/flow_mesh_heads.csv") as file:
        given = {int(row["node"]): row for row in csv.DictReader(file)}
    cards = open(f"{folder}/flow_mesh.in").read()
    held, of_file = [], {}
    for boundary in mesh["boundaries"]:
        name = boundary["file"]
        lines = open(f"{folder}/{name}").read().splitlines()
        rows = section(lines, "CONNECTIONS")
        expect(not lines and len(rows) == boundary["cells"], name + " has its cells")
        expect(f"FILE {name}\n" in cards, name + " is in the cards")
        for cell, x, y, z, area in rows:
            at, row = points[int(cell) - 1], given.pop(int(cell))
            expect(row["file"] == name and row["surface"] in boundary["surfaces"], "heads name file and surface")
            expect(x > at[0] and [y, z] == at[1:], "faces lie to the side, no higher and no lower")
            head = boundary.get("level_m", at[2])
            near(float(row["head_m"]), head, 1e-9, "head")
            expect(abs(float(row["pressure_head_m"]) - (head - at[2])) < 1e-9, "pressure head")
            held.append((int(cell) - 1, conductivity * area / (x - at[0]), head))
            of_file.setdefault(name, []).append(held[-1])
        if "level_m" in boundary:
            expect(re.search(rf"DATUM 0 0 {re.escape(repr(boundary['level_m']).removesuffix('.0'))}\n", cards), "datum")
    expect(not given, "every head is in a file")
    near(float(re.search(r"PERM_ISO (\S+)", cards)[1]), mesh["permeability_m2"], 1e-15, "permeability in the cards")
    near(float(re.search(r"VISCOSITY CONSTANT (\S+)", cards)[1]), 1000 * NU, 1e-12, "viscosity in the cards")
    raised = float(re.search(r"LIQUID_PRESSURE ([0-9]\S*)", cards)[1]) - 101325
    expect(raised + 1000 * G * min(h - p[2] for h, p in zip(heads, points)) >= 0, "no cell empties")

    x = solve(len(cells), links, held)
    expect(max(abs(a - b) for a, b in zip(x, heads)) < 1e-4, "heads found are those of flow_mesh.inp")
    out = {name: sum(c * (x[a] - h) for a, c, h in rows) for name, rows in of_file.items()}
    for boundary in mesh["boundaries"]:
        near(out[boundary["file"]], boundary["out_m3_s"], 1e-5, boundary["file"])
    if "flow_mesh_drained.ex" in out:
        found = out["flow_mesh_drained.ex"]
        slack = 1e-5 * found
        expect(flow["inflow_low_m3_s"] - slack <= found <= flow["inflow_high_m3_s"] + slack, "inflow within its bounds")
        for cell, c, head in of_file["flow_mesh_drained.ex"]:
            expect(head == points[cell][2], "drained cells have their own height for head")
            expect(c * (x[cell] - head) > -1e-7 * found, "water goes into no drained surface")
    print(f"{folder}: {len(cells)} cells, {negative} of {len(connections)} areas below 0, {out}")
    return out, flow


def scene(joints, flow, more=""):
    return ('schema = 1\n[domain]\nbox = { min = [0, 0, 0], max = [8, 6, 6] }\n' + joints +
            f'[flow]\nexports = ["pflotran"]\n{flow}' + more)


LEVEL = '[[joint]]\nset = "A"\nplane = { through = [4, 3, 3], dip = 0, dip_direction = 0 }\n'
CROSSING = (LEVEL + '[[joint]]\nset = "B"\nplane = { through = [4, 3, 3], dip = 30, dip_direction = 75 }\n'
            '[[joint]]\nset = "C"\ndisc = { centre = [4, 3, 3], radius = 2.5, dip = 70, dip_direction = 200 }\n'
            '[[joint]]\nset = "C"\ndisc = { centre = [2, 2, 2], radius = 2, dip = 45, dip_direction = 10 }\n')
APERTURES = "[joints.default]\naperture = 1e-3\n[joints.B]\naperture = 4e-4\n[joints.C]\naperture = 2e-3\n"
SIDES = '[[flow.side]]\nface = "west"\nlevel = 10\n[[flow.side]]\nface = "east"\nlevel = 7\n'
SEEPING = ('[[joint]]\nset = "A"\nplane = { through = [4, 3, 3], dip = 90, dip_direction = 0 }\n'
           '[[joint]]\nset = "B"\nplane = { through = [4, 3, 3], dip = 80, dip_direction = 75 }\n'
           '[[joint]]\nset = "C"\ndisc = { centre = [2, 2, 2], radius = 2, dip = 45, dip_direction = 10 }\n')


def on_hall(x, y, z):
    beyond = max(3 - x, x - 5, 2 - y, y - 4, 2 - z, z - 4)
    return abs(beyond) < 1e-9


CHAMBER = ('[[excavation]]\nname = "hall"\nkind = "polyhedron"\nbox = { min = [3, 2, 2], max = [5, 4, 4] }\n')

with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    cubic = G / (12 * NU)
    out, flow = check(scene(LEVEL + "[joints.default]\naperture = 1e-3\n", "", SIDES), "darcy")
    east = next(b["file"] for b in flow["mesh"]["boundaries"] if b["surfaces"] == ["east"])
    near(out[east], cubic * 1e-9 * 6 * 3 / 8, 1e-5, "Darcy's law")
    out, flow = check(scene(CROSSING + APERTURES, "tolerance = 0.05\n", SIDES), "crossing")
    bounds = next(s for s in flow["surfaces"] if s["name"] == "east")
    east = next(b["file"] for b in flow["mesh"]["boundaries"] if b["surfaces"] == ["east"])
    expect(bounds["high_m3_s"] > 1.002 * bounds["low_m3_s"], "bounds that tell the two apart")
    middle = 0.5 * (bounds["high_m3_s"] + bounds["low_m3_s"])
    expect(middle < out[east] < bounds["high_m3_s"] * (1 + 1e-5), "between two levels: no worse than the upper bound")
    check(scene(CROSSING + APERTURES + CHAMBER, "tolerance = 0.05\nlevel = 20\n"), "hall")
    # The hall's floor is below the water, its roof above: what is dry is in no file, and no head is above it.
    out, flow = check(scene(SEEPING + APERTURES + CHAMBER, "tolerance = 0.05\nlevel = 3\n"), "seeping")
    expect(next(s for s in flow["surfaces"] if s["name"] == "hall")["dry_m"] > 0.1, "some of the hall is dry")
    expect(out["flow_mesh_drained.ex"] > 0, "and water comes out of the rest")
    points, _, heads, _ = read_ucd("seeping/flow_mesh.inp")
    with open("seeping/flow_mesh_heads.csv") as file:
        given = {int(row["node"]) - 1 for row in csv.DictReader(file)}
    dry = [k for k, (x, y, z) in enumerate(points) if k not in given and on_hall(x, y, z)]
    expect(dry, "closed cells at the hall")
    expect(all(heads[k] <= points[k][2] + 1e-9 for k in dry), "no head above a dry place")
    # A later run into the same folder knows all files for its own, and takes away those it does not write.
    again = subprocess.run([program, "run", "hall.toml", "--quiet", "-o", "hall"], capture_output=True, text=True)
    expect(again.returncode == 0, "the second run: " + again.stderr)
    plain = open("hall.toml").read().replace('exports = ["pflotran"]\n', "")
    open("plain.toml", "w").write(plain)
    subprocess.run([program, "run", "plain.toml", "--quiet", "-o", "hall"], check=True)
    expect(not [name for name in os.listdir("hall") if name.startswith("flow_mesh")], "nothing of the mesh is left")
print("wrong:", wrong)
sys.exit(wrong != 0)
