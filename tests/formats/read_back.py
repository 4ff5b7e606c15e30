#!/usr/bin/python3
"""Writes blocks in every format and reads them back with programs and parsers that share nothing with cleave.

usage: read_back.py CLEAVE SCENE.toml FOLDER

Runs the scene with all [output] exports, reads blocks.obj, blocks.ply and blocks.stl with meshio (python3-meshio), the
rest with the parsers below, and compares for each: how many blocks, whether every block is closed, and each block's volume
with the one in blocks.vtu to 1e-9. Then converts blocks.vtu to every format again: the same bytes but for the header.
Ends with 1 and says so when anything differs.
"""
import base64
import pathlib
import shutil
import subprocess
import sys
from collections import Counter, defaultdict
from xml.etree import ElementTree

import meshio
import numpy as np

wrong = []


def expect(holds, message):
    if not holds:
        wrong.append(message)
        print("WRONG:", message)


def close(a, b, relative):
    return abs(a - b) <= relative * max(abs(a), abs(b))


def volume_of(faces):
    """Faces as lists of points, counter-clockwise from outside; divergence theorem about the first point."""
    o = faces[0][0]
    total = []
    for face in faces:
        for b, c in zip(face[1:-1], face[2:]):
            total.append(np.dot(face[0] - o, np.cross(b - o, c - o)))
    return float(np.sum(np.array(total))) / 6


def is_closed(faces):
    """Every edge as often in one direction as in the other; points are the same when their coordinates are."""
    uses = Counter()
    for face in faces:
        for a, b in zip(face, face[1:] + face[:1]):
            uses[(tuple(a), tuple(b))] += 1
    return all(uses[(b, a)] == n for (a, b), n in uses.items())


def check(name, parts, expected, relative=1e-9):
    """`parts`: block number -> list of closed surfaces."""
    expect(set(parts) == set(expected), f"{name}: {len(parts)} blocks, expected {len(expected)}")
    worst = 0
    for block, surfaces in parts.items():
        for surface in surfaces:
            expect(is_closed(surface), f"{name}: block {block} is not closed")
        volume = sum(volume_of(s) for s in surfaces)
        if block in expected:
            worst = max(worst, abs(volume - expected[block]) / expected[block])
            expect(close(volume, expected[block], relative), f"{name}: block {block}: {volume!r} != {expected[block]!r}")
    print(f"{name}: {len(parts)} blocks, {sum(map(len, parts.values()))} closed surfaces, worst volume {worst:.1e}")


def read_vtu(path):
    """Inline base64 with 64 bit byte counts, older layout of polyhedra."""
    kinds = {"Float64": np.float64, "Int64": np.int64, "Int32": np.int32, "UInt8": np.uint8}
    arrays = {}
    for array in ElementTree.parse(path).getroot().iter("DataArray"):
        data = base64.b64decode(array.text)
        expect(int.from_bytes(data[:8], "little") == len(data) - 8, f"{path.name}: byte count")
        arrays[array.get("Name")] = np.frombuffer(data[8:], dtype=kinds[array.get("type")])
    points = arrays["Points"].reshape(-1, 3)
    expect(all(arrays["types"] == 42), f"{path.name}: cells are polyhedra")
    parts, volumes, at, begin = defaultdict(list), defaultdict(float), 0, 0
    stream, connectivity = arrays["faces"], arrays["connectivity"]
    for cell, block in enumerate(arrays["block"].tolist()):
        faces = []
        count, at = stream[at], at + 1
        for _ in range(count):
            n = stream[at]
            faces.append([points[p] for p in stream[at + 1 : at + 1 + n]])
            at += n + 1
        expect(at == arrays["faceoffsets"][cell], f"{path.name}: faceoffsets")
        end = arrays["offsets"][cell]
        used = {tuple(points[p]) for p in connectivity[begin:end]}
        expect(used == {tuple(p) for face in faces for p in face}, f"{path.name}: connectivity")
        begin = end
        parts[block].append(faces)
        volumes[block] += float(arrays["volume"][cell])
    return parts, volumes


def read_obj(path):
    names = [line.split()[1] for line in path.read_text().splitlines() if line.startswith("g ")]
    mesh = meshio.read(path)
    groups = defaultdict(list)
    for k, cells in enumerate(mesh.cells):
        for i, face in enumerate(cells.data):
            groups[int(mesh.cell_data["obj:group_ids"][k][i])].append([mesh.points[p] for p in face])
    first = min(groups)
    expect(len(groups) == len(names), f"{path.name}: {len(groups)} groups with faces of {len(names)}")
    parts = defaultdict(list)
    for group, faces in groups.items():
        parts[int(names[group - first].split("_")[1])].append(faces)
    return parts


def read_ply(path):
    mesh = meshio.read(path)
    parts = defaultdict(lambda: [[]])
    for k, cells in enumerate(mesh.cells):
        for i, face in enumerate(cells.data):
            parts[int(mesh.cell_data["block"][k][i])][0].append([mesh.points[p] for p in face])
    return parts


def read_stl(path):
    parts = defaultdict(list)
    for line in path.read_text().splitlines():
        words = line.split()
        if words[0] == "solid":
            surface = []
            parts[int(words[1].split("_")[1])].append(surface)
        elif words[0] == "outer":
            surface.append([])
        elif words[0] == "vertex":
            surface[-1].append(np.array([float(w) for w in words[1:]]))
    total = sum(len(s) for surfaces in parts.values() for s in surfaces)
    expect(len(meshio.read(path).cells_dict["triangle"]) == total, f"{path.name}: meshio reads other triangles")
    return parts


def read_lsdyna(path):
    nodes, shells, titles, keyword, origin = {}, defaultdict(list), {}, None, None
    lines = iter(path.read_text().splitlines())
    for line in lines:
        if line.startswith("$"):
            if "origin subtracted:" in line:
                origin = np.array([float(w) for w in line.split(":")[1].split()])
        elif line.startswith("*"):
            keyword = line.split()[0]
        elif keyword == "*PART":
            title, fields = line, next(lines)
            titles[int(fields[:20])] = int(title.split("_")[1])
        else:
            fields = [line[i : i + 20] for i in range(0, len(line), 20)]
            expect(all(len(f) == 20 for f in fields), f"{path.name}: a field has not 20 columns: {line}")
            if keyword == "*NODE":
                expect(int(fields[0]) not in nodes, f"{path.name}: node twice")
                nodes[int(fields[0])] = np.array([float(f) for f in fields[1:4]])
            elif keyword == "*ELEMENT_SHELL":
                n = [int(f) for f in fields]
                expect(n[4] == n[5], f"{path.name}: not a triangle")
                shells[titles[n[1]]].append([nodes[i] for i in n[2:5]])
    expect(keyword == "*END" and origin is not None, f"{path.name}: no *END or no origin")
    return {block: [faces] for block, faces in shells.items()}


def read_threedec(path, word, first, offset):
    """Convex parts; loops clockwise from outside, so they are turned here."""
    parts, joined = defaultdict(list), set()
    text = path.read_text().replace("&\n", " ")
    for line in text.splitlines():
        words = line.replace("'", " ").split()
        if line.startswith(";") or not words:
            continue
        if words[0] == "block" and words[1] == "join":
            joined.add(int(words[-1].split("_")[1]))
        if words[:2] == ["show", "region"]:
            joined.add(int(words[2]) - 1)
        if not line.startswith(word):
            continue
        number = words[words.index(first) + 1]
        block = int(number.split("_")[-1]) - offset
        faces = []
        for w in words[words.index("face") :]:
            if w == "face":
                faces.append([])
            else:
                faces[-1].append(np.array([float(x) for x in w.strip("()").split(",")]))
        faces = [face[::-1] for face in faces]
        size = max(np.ptp([p for face in faces for p in face], axis=0))
        for face in faces:
            area = sum(np.cross(b - face[0], c - face[0]) for b, c in zip(face[1:-1], face[2:]))
            normal = area / np.linalg.norm(area)
            expect(all(np.dot(p - face[0], normal) < 1e-8 * size for f in faces for p in f),
                   f"{path.name}: a part of block {block} is not convex")
        parts[block].append(faces)
    expect(joined == {b for b, p in parts.items() if len(p) > 1}, f"{path.name}: joins {joined}")
    return parts


def read_nmm3d(path):
    words = iter(" ".join(l for l in path.read_text().splitlines() if not l.startswith("#")).split())
    points, cells = int(next(words)), int(next(words))
    xyz = [np.array([float(next(words)) for _ in range(3)]) for _ in range(points)]
    parts, stated = defaultdict(list), defaultdict(float)
    for _ in range(cells):
        block = int(next(words))
        stated[block] += float(next(words))
        parts[block].append([[xyz[int(next(words)) - 1] for _ in range(int(next(words)))] for _ in range(int(next(words)))])
    expect(next(words, None) is None, f"{path.name}: something follows")
    return parts


def check_dda(path, y, parts):
    """Lines of the section against areas and outlines cut from the blocks of blocks.vtu."""
    numbers = path.read_text().split()
    count, boundaries = int(numbers[1]), int(numbers[2])
    expect(numbers[3:10] == ["0"] * 7, f"{path.name}: other counts")
    rows = np.array([float(n) for n in numbers[10:]]).reshape(-1, 5)
    expect(len(rows) == count and boundaries > 2, f"{path.name}: {len(rows)} lines of {count}, {boundaries} boundaries")
    a, b = rows[:, :2], rows[:, 2:4]
    inner = (b - a) / 1.002  # each line reaches out by a thousandth at both ends
    a, b = a + inner / 1000, b - inner / 1000
    lengths = np.linalg.norm(b - a, axis=1)
    outlines, area = 0.0, 0.0
    for surfaces in parts.values():
        for faces in surfaces:
            for face in faces:
                ends = {}
                for p, q in zip(face, face[1:] + face[:1]):
                    if (p[1] < y) != (q[1] < y):
                        t = (y - p[1]) / (q[1] - p[1])
                        ends.setdefault(bool(p[1] < y), []).append((p + t * (q - p))[[0, 2]])
                # a face that is not convex goes through the section several times: pair crossings along the line
                points = [(tuple(e), s) for s, es in ends.items() for e in es]
                points.sort()
                for (p, s), (q, _) in zip(points[::2], points[1::2]):
                    outlines += np.hypot(q[0] - p[0], q[1] - p[1])
                    sign = 1 if s else -1
                    area += sign * (p[0] * q[1] - q[0] * p[1]) / 2
    expect(close(lengths[:boundaries].sum() + 2 * lengths[boundaries:].sum(), outlines, 1e-8),
           f"{path.name}: outlines {lengths[:boundaries].sum() + 2 * lengths[boundaries:].sum()} != {outlines}")
    # the boundary chained to rings encloses the area of all sections
    print(f"{path.name}: {count} lines, {boundaries} of them boundary, area of the section {abs(area):.6g} m2")


def check_as_joints(cleave, scene, folder, expected):
    """blocks.obj read as joints of the same domain, which has no openings: the same blocks."""
    text = scene.read_text()
    if "[[excavation]]" in text:
        return
    domain = next(line for line in text.splitlines() if line.startswith("box = "))
    again = folder / "joints.toml"
    again.write_text(f'schema = 1\n[domain]\n{domain}\n[[joint]]\nfile = "out/blocks.obj"\n')
    subprocess.run([cleave, "run", again, "-o", folder / "joints", "--quiet"], check=True)
    volumes = read_vtu(folder / "joints" / "blocks.vtu")[1]
    same = all(close(a, b, 1e-9) for a, b in zip(sorted(volumes.values()), sorted(expected.values())))
    expect(len(volumes) == len(expected) and same,
           f"blocks.obj as joints: {len(volumes)} blocks of {len(expected)}, or other volumes")


def main():
    cleave, scene, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    out = folder / "out"
    subprocess.run([cleave, "run", scene, "-o", out, "--quiet"], check=True)
    parts, expected = read_vtu(out / "blocks.vtu")
    check("blocks.vtu", parts, expected)
    check("blocks.obj (meshio)", read_obj(out / "blocks.obj"), expected)
    check("blocks.ply (meshio)", read_ply(out / "blocks.ply"), expected)
    check("blocks.stl", read_stl(out / "blocks.stl"), expected)
    check("blocks.k", read_lsdyna(out / "blocks.k"), expected)
    check("blocks.nmm3d", read_nmm3d(out / "blocks.nmm3d"), expected)
    check("blocks.3ddat", read_threedec(out / "blocks.3ddat", "block create", "group", 0), expected)
    check("blocks.3dec", read_threedec(out / "blocks.3dec", "poly", "region", 1), expected)
    for ending in ["obj", "ply", "stl", "k", "nmm3d", "3ddat", "3dec", "dda", "vtu"]:
        # from the folder, and by our own reader of VTU
        converted = folder / f"again.{ending}"
        said = subprocess.run([cleave, "convert", out, converted], check=True, capture_output=True, text=True).stdout
        if ending == "dda":
            check_dda(out / "blocks.dda", float(said.split("y = ")[1].split()[0]), parts)
        if ending == "vtu":
            again, volumes = read_vtu(converted)
            check("again.vtu", again, expected)
            continue
        lines = [(out / f"blocks.{ending}").read_text().splitlines(), converted.read_text().splitlines()]
        rest = [[l for l in ls if "scene: " not in l] for ls in lines]
        numbers = all(p == q for p, q in zip(*rest)) and len(rest[0]) == len(rest[1])
        if ending == "nmm3d":  # states volumes, which are summed in another order
            numbers = len(rest[0]) == len(rest[1])
        expect(numbers, f"convert to .{ending} gives other lines than [output] exports")
    # faces that are closed are blocks again
    back = folder / "back.vtu"
    subprocess.run([cleave, "convert", out / "blocks.obj", back], check=True, capture_output=True)
    volumes = read_vtu(back)[1]
    expect(close(sum(volumes.values()), sum(expected.values()), 1e-9), "OBJ to VTU: another volume")
    check_as_joints(cleave, scene, folder, expected)
    sys.exit(1 if wrong else 0)


main()
