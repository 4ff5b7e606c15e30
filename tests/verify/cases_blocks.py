"""Cutting: counts and volumes that are known exactly."""
import itertools
import math
import random

import numpy as np

from case import ROOT, Case, box, normal_plane, plane

CHAPTER = "Blocks"


def grid(n):
    axes = ((90, 90), (90, 0), (0, 0))
    joints = [plane([k / n] * 3, *axis) for axis in axes for k in range(1, n)]

    def values(r):
        yield "blocks", n**3, len(r.blocks), 0
        yield "faces of all blocks", 6 * n**3, int(r.blocks.faces.sum()), 0
        yield "vertices of all blocks", 8 * n**3, int(r.blocks.vertices.sum()), 0
        yield "volume (m3)", 1.0, float(r.blocks.volume.sum()), 1e-12
    return Case(f"grid_{n}", f"Regular grid of {n} x {n} x {n}", "A unit cube cut by equally spaced persistent planes along each axis.",
                "Fu (2014), figure 3-9; closed form", {"domain": box([1, 1, 1]), "joint": joints}, values)


def volumes(name, title, scene, expected, source, text=""):
    """`expected`: [(count, volume)]."""
    wanted = sorted(v for count, v in expected for _ in range(count))

    def values(r):
        ours = sorted(r.blocks.volume)
        yield "blocks", len(wanted), len(ours), 0
        yield "largest difference of a volume (m3)", 0.0, float(np.abs(np.array(ours) - wanted).max()) if len(ours) == len(wanted) else None, 1e-12
        yield "certificate", True, r.summary["blocks"]["certificate"]["passed"], 0
    return Case(name, title, text, source, scene, values)


def mirrors():
    cube = box([2, 2, 2], [0, 0, 0])
    diagonal = [[1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]]
    axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    corner = [[1, s, t] for s in (1, -1) for t in (1, -1)]
    source = "Group theory: mirror planes of the cube; closed form"
    for name, normals, expected in (
            ("mirrors_6", diagonal, [(24, 1 / 3)]), ("mirrors_9", diagonal + axes, [(48, 1 / 6)]),
            ("mirrors_13", diagonal + axes + corner, [(96, 1 / 12)]), ("mirrors_4", corner, [(8, 1 / 2), (6, 2 / 3)])):
        yield volumes(name, f"{len(normals)} mirror planes of the cube", {"domain": cube, "joint": [normal_plane([0, 0, 0], n) for n in normals]},
                      expected, source, "All planes go through one point, the middle of the cube.")
    octant = [{"polygon": [[x, y, 0], [0, y, z], [x, 0, z]]} for x, y, z in itertools.product((1, -1), repeat=3)]
    yield volumes("cuboctahedron", "Cuboctahedron", {"domain": cube, "joint": octant}, [(1, 20 / 3), (8, 1 / 6)], "Closed form",
                  "Eight triangles cut the corners of a cube through the middles of its edges.")


def general(seed):
    """Cells of planes in general position: 1 + planes + lines that meet the body + points inside it."""
    draw = random.Random(seed)
    n = draw.randrange(5, 12)
    normals, throughs = [], []
    while len(normals) < n:
        v = np.array([draw.gauss(0, 1) for _ in range(3)])
        normals.append(v / np.linalg.norm(v))
        throughs.append(np.array([draw.uniform(1, 9) for _ in range(3)]))
    d = [float(a @ p) for a, p in zip(normals, throughs)]

    def line_meets(i, j):
        direction = np.cross(normals[i], normals[j])
        point = np.linalg.lstsq(np.array([normals[i], normals[j]]), np.array([d[i], d[j]]), rcond=None)[0]
        low, high = -math.inf, math.inf
        for c in range(3):
            a, b = sorted(((0 - point[c]) / direction[c], (10 - point[c]) / direction[c]))
            low, high = max(low, a), min(high, b)
        return low < high
    lines = sum(line_meets(i, j) for i, j in itertools.combinations(range(n), 2))
    inside = sum(bool(((p := np.linalg.solve(np.array([normals[i] for i in t]), np.array([d[i] for i in t]))) > 0).all() and (p < 10).all())
                 for t in itertools.combinations(range(n), 3))

    def values(r):
        yield "blocks", 1 + n + lines + inside, len(r.blocks), 0
        yield "convex blocks", 1 + n + lines + inside, int(r.blocks.convex.sum()), 0
        yield "volume (m3)", 1000.0, float(r.blocks.volume.sum()), 1e-12
    return Case(f"general_position_{seed}", f"{n} planes in general position", "Cells of an arrangement in a convex body, counted by a formula.",
                "Zaslavsky (1975); Schneider & Weil (2008)", {"domain": box([10, 10, 10]), "joint": [normal_plane(p, a) for p, a in zip(throughs, normals)]}, values)


def genus(k):
    """A slab with k rectangular holes through it: one block of genus k."""
    def values(r):
        b = r.blocks
        yield "blocks", 1, len(b), 0
        yield "volume (m3)", 10.0 * (4 * k + 2) * 2 - k * 2 * 2 * 2, float(b.volume[0]), 1e-12
        faces, edges, vertices = 6 + 4 * k, 12 + 12 * k, 8 + 8 * k
        yield "faces", faces, int(b.faces[0]), 0
        yield "edges", edges, int(b.edges[0]), 0
        yield "vertices", vertices, int(b.vertices[0]), 0
    openings = [{"name": f"shaft {i}", "kind": "polyhedron", "box": {"min": [4, 4 * i + 2, -1], "max": [6, 4 * i + 4, 3]}} for i in range(k)]
    return Case(f"genus_{k}", f"A slab with {k} shafts", "One block with holes through it: V - E + F - (L - F) = 2 (1 - genus).", "Euler-Poincare; closed form",
                {"domain": box([10, 4 * k + 2, 2]), "excavation": openings}, values)


def cases():
    for n in (1, 2, 3, 5, 8, 12, 20):
        yield grid(n)
    yield from mirrors()
    yield volumes("berre_case_2", "Network of nine fractures", ROOT / "examples/berre_case2/berre_case2.toml", [(7, 1 / 8), (7, 1 / 64), (8, 1 / 512)],
                  "Berre et al. (2021), Adv. Water Resour. 147:103759, section 4.2", "Coordinates as published.")
    yield volumes("dfnworks_4_rects", "Four rectangles of a user", ROOT / "examples/dfnworks_4_user_rects/dfnworks_4_user_rects.toml",
                  [(2, 0.25), (1, 0.2), (2, 0.15)], "Hyman et al. (2015), dfnWorks, Comput. Geosci. 84:10-19")
    for seed in range(1, 41):
        yield general(seed)
    for k in (1, 2, 3, 5):
        yield genus(k)
