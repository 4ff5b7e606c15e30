#!/usr/bin/python3
"""Makes a scene that goes wrong as small as it gets and still goes wrong, for tests/regression.

usage: minimise.py CLEAVE SCENE.toml SMALL.toml [--stderr TEXT | --summary PATH=VALUE] [--timeout SECONDS]

"Goes wrong" is: the program ends as it does for the whole scene (any signal counts as the same crash) with the same
message but for its numbers, or what an option says. Joint files become joints of the scene first. Then, as long as it still goes wrong: joints, joint sets,
excavations, sections and keys are left out one by one, counts of random joints are halved, polygons lose corners, and
numbers lose digits. SMALL.toml begins with a comment for tests/regression/run_scene.py: state there what should be.
"""
import argparse
import copy
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib


# ---- TOML out -------------------------------------------------------------------------------------------------------

def value_text(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list):
        return "[" + ", ".join(map(value_text, value)) + "]"
    return "{ " + ", ".join(f"{key_text(k)} = {value_text(v)}" for k, v in value.items()) + " }"


def key_text(key):
    return key if key and all(c.isascii() and (c.isalnum() or c in "-_") for c in key) else json.dumps(key)


def scene_text(scene):
    plain, tables = [], []
    for key, value in scene.items():
        if isinstance(value, dict):
            tables.append(table_text([key], value, "[", "]"))
        elif isinstance(value, list) and value and all(isinstance(v, dict) for v in value):
            tables += [table_text([key], v, "[[", "]]") for v in value]
        elif value != []:
            plain.append(f"{key_text(key)} = {value_text(value)}")
    return "\n".join(plain) + "\n\n" + "\n".join(tables)


def table_text(path, table, left, right):
    lines = [left + ".".join(map(key_text, path)) + right]
    return "\n".join(lines + [f"{key_text(k)} = {value_text(v)}" for k, v in table.items()]) + "\n"


# ---- does it still go wrong -----------------------------------------------------------------------------------------

def message(stderr):
    """What is wrong, without the place, the key and all numbers, which change as the scene gets smaller."""
    lines = [line for line in stderr.splitlines() if line.startswith("error: ")]
    return re.sub(r"-?[0-9][0-9.]*(e[-+]?[0-9]+)?", "#", lines[0].split(": ", 3)[-1]) if lines else ""


class Judge:
    def __init__(self, arguments, folder):
        self.arguments, self.folder, self.runs = arguments, folder, 0
        self.wanted = None

    def outcome(self, scene):
        file = self.folder / "scene.toml"
        file.write_text(scene_text(scene))
        out = self.folder / "out"
        shutil.rmtree(out, ignore_errors=True)
        self.runs += 1
        try:
            ended = subprocess.run([self.arguments.cleave, "run", file, "-o", out, "--quiet"], capture_output=True,
                                   text=True, timeout=self.arguments.timeout)
        except subprocess.TimeoutExpired:
            return "timeout"
        if self.arguments.stderr is not None:
            return self.arguments.stderr in ended.stderr
        if self.arguments.summary is not None:
            path, value = self.arguments.summary.split("=", 1)
            try:
                found = json.loads((out / "summary.json").read_text())
                for key in path.split("."):
                    found = found[key]
                return str(found) == value
            except (OSError, KeyError):
                return False
        return ("signal" if ended.returncode < 0 else ended.returncode), message(ended.stderr)

    def fails(self, scene):
        return self.outcome(scene) == self.wanted


# ---- smaller scenes -------------------------------------------------------------------------------------------------

def inline_obj(path, joint):
    points, joints = [], []
    for line in path.read_text().splitlines():
        words = line.split("#")[0].split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(w.split("/")[0]) for w in words[1:]]
            rest = {k: v for k, v in joint.items() if k != "file"}
            joints.append({"polygon": [points[c - 1 if c > 0 else c] for c in corners], **rest})
    return joints


def with_files(scene, folder, target):
    """Faces of OBJ files as joints of the scene; other files are copied."""
    joints = []
    for joint in scene.get("joint", []):
        if joint.get("file", "").lower().endswith(".obj"):
            joints += inline_obj(folder / joint["file"], joint)
        else:
            joints.append(joint)
    if joints:
        scene["joint"] = joints
    for place in [*scene.get("joint", []), scene.get("domain", {}), *scene.get("excavation", [])]:
        for key in ("file", "mesh"):
            if isinstance(place.get(key), str):
                shutil.copy(folder / place[key], target / pathlib.Path(place[key]).name)
                place[key] = pathlib.Path(place[key]).name
    return scene


def drop_items(scene, key, judge):
    """Leaves out runs of items, long ones first."""
    run = max(1, len(scene.get(key, [])) // 2)
    while scene.get(key):
        at = 0
        while at < len(scene.get(key, [])):
            smaller = copy.deepcopy(scene)
            del smaller[key][at : at + run]
            if not smaller[key]:
                del smaller[key]
            if judge.fails(smaller):
                scene = smaller
            else:
                at += run
        if run == 1:
            break
        run //= 2
    return scene


def drop_keys(scene, judge):
    for path in sorted(paths(scene), key=len):
        smaller = copy.deepcopy(scene)
        place = smaller
        try:
            for key in path[:-1]:
                place = place[key]
            del place[path[-1]]
        except (KeyError, IndexError, TypeError):
            continue
        if path not in (["domain"], ["schema"]) and judge.fails(smaller):
            scene = smaller
    return scene


def paths(value, before=()):
    """Of keys of tables, not of items of lists of numbers."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield [*before, key]
            yield from paths(inner, (*before, key))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for i, inner in enumerate(value):
            yield from paths(inner, (*before, i))


def halve_counts(scene, judge):
    for i, _ in enumerate(scene.get("joint_set", [])):
        while scene["joint_set"][i].get("intensity", {}).get("count", 1) > 1:
            smaller = copy.deepcopy(scene)
            smaller["joint_set"][i]["intensity"]["count"] //= 2
            if not judge.fails(smaller):
                break
            scene = smaller
    return scene


def drop_corners(scene, judge):
    for i, joint in enumerate(scene.get("joint", [])):
        at = 0
        while len(scene["joint"][i].get("polygon", [])) > 3 and at < len(scene["joint"][i]["polygon"]):
            smaller = copy.deepcopy(scene)
            del smaller["joint"][i]["polygon"][at]
            if judge.fails(smaller):
                scene = smaller
            else:
                at += 1
    return scene


def rounded(value, digits):
    if isinstance(value, float):
        return float(f"{value:.{digits}g}")
    if isinstance(value, list):
        return [rounded(v, digits) for v in value]
    if isinstance(value, dict):
        return {k: rounded(v, digits) for k, v in value.items()}
    return value


def round_numbers(scene, judge):
    for digits in (1, 2, 3, 4, 6, 9, 12):
        if judge.fails(rounded(scene, digits)):
            return rounded(scene, digits)
    for key in ("joint", "excavation"):
        for i, item in enumerate(scene.get(key, [])):
            for digits in (1, 2, 3, 4, 6, 9, 12):
                smaller = copy.deepcopy(scene)
                smaller[key][i] = rounded(item, digits)
                if judge.fails(smaller):
                    scene = smaller
                    break
    return scene


def size_of(scene):
    return len(scene_text(scene))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("cleave")
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("small", type=pathlib.Path)
    parser.add_argument("--stderr")
    parser.add_argument("--summary")
    parser.add_argument("--timeout", type=float, default=60)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        judge = Judge(arguments, pathlib.Path(folder))
        scene = with_files(tomllib.loads(arguments.scene.read_text()), arguments.scene.parent, judge.folder)
        whole = judge.outcome(scene)
        judge.wanted = whole
        if arguments.stderr is not None or arguments.summary is not None:
            judge.wanted = True
        if whole != judge.wanted or whole == (0, ""):
            sys.exit(f"error: nothing goes wrong: the scene ends with {whole}")
        before = None
        while before != size_of(scene):
            before = size_of(scene)
            for key in ("joint", "joint_set", "excavation"):
                scene = drop_items(scene, key, judge)
            scene = drop_keys(scene, judge)
            scene = halve_counts(scene, judge)
            scene = drop_corners(scene, judge)
            scene = round_numbers(scene, judge)
        note = f"# {arguments.scene.name}, made small in {judge.runs} runs: ended with {judge.outcome(scene)!s}\n"
        arguments.small.write_text(note + "# expect: exit = 0\n\n" + scene_text(scene))
        for file in judge.folder.iterdir():
            if file.is_file() and file.name != "scene.toml":
                shutil.copy(file, arguments.small.parent)
    print(f"{arguments.small}: {len(scene.get('joint', []))} joints, {judge.runs} runs")


if __name__ == "__main__":
    main()
