#!/usr/bin/env python3
"""Compares what two builds of cleave make of the same scenes: tests/compare_builds.py OLD NEW [--check] [--limit S] [--old-root DIR] [PATTERN]

Runs every scene of examples, tests/regression and tests/workloads whose path holds PATTERN with both programs and
compares exit code, messages, summary.json (but cost and version) and every CSV file, column by column, to the last digit. With --check
only `cleave check` and `cleave plan` are compared. Keys and columns that only NEW has are listed, and no difference. A scene that
takes longer than S seconds (60) in both is left out and counted. Ends with 1 when anything differs. --old-root
is the checkout whose scenes OLD runs, where keys were renamed since.
"""
import argparse
import csv
import io
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def scenes(pattern):
    found = []
    for folder in ("examples", "tests/regression", "tests/workloads"):
        found += sorted((ROOT / folder).rglob("*.toml"))
    return [path for path in (p.relative_to(ROOT) for p in found) if pattern in str(path)]


def call(arguments, limit, root):
    try:
        done = subprocess.run(arguments, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return None
    return done.returncode, done.stdout.replace(str(root), ""), done.stderr.replace(str(root), "")


def flat(value, path=""):
    if isinstance(value, dict):
        return {k: v for key, item in value.items() for k, v in flat(item, f"{path}.{key}").items()}
    if isinstance(value, list):
        return {k: v for i, item in enumerate(value) for k, v in flat(item, f"{path}[{i}]").items()}
    return {path: value}


def summary_of(folder):
    file = folder / "summary.json"
    if not file.exists():
        return {}
    summary = json.loads(file.read_text())
    return {k: v for k, v in flat(summary).items() if not k.startswith((".cost", ".cleave", ".scene_sha256")) and not k.endswith("_s")}


def differences(old, new):
    told = []
    for key in sorted(old.keys() | new.keys()):
        if key not in new:
            told.append(f"lost {key}")
        elif key not in old:
            told.append(f"+ {key}")
        elif old[key] != new[key]:
            told.append(f"{key}: {old[key]} -> {new[key]}")
    return told


def table_differences(name, old, new):
    """Column by column: columns that only the new table has are no difference."""
    if old == new:
        return []
    if old is None or new is None:
        return [f"+ {name}"] if old is None else [f"lost {name}"]
    rows = [list(csv.reader(io.StringIO(text.decode()))) for text in (old, new)]
    if not rows[0] or not rows[1] or len(rows[0]) != len(rows[1]):
        return [f"{name}: {len(rows[0])} lines -> {len(rows[1])}"]
    told = [f"+ {name}: {column}" for column in rows[1][0] if column not in rows[0][0]]
    for i, column in enumerate(rows[0][0]):
        if column not in rows[1][0]:
            told.append(f"{name}: lost column {column}")
            continue
        k = rows[1][0].index(column)
        changed = [n for n, (a, b) in enumerate(zip(*rows)) if a[i] != b[k]]
        if changed:
            told.append(f"{name}: {column} differs in {len(changed)} rows, first {rows[0][changed[0]][i]} -> {rows[1][changed[0]][k]}")
    return told


def run_both(scene, roots, programs, limit):
    with tempfile.TemporaryDirectory() as place:
        folders = [pathlib.Path(place) / name for name in ("old", "new")]
        ends = [
            call([p, "run", str(root / scene), "-o", str(f), "--quiet"], limit, root)
            for p, f, root in zip(programs, folders, roots)
        ]
        if None in ends:
            return None if ends[0] == ends[1] else ["only one of the two ends in time"]
        told = [] if ends[0][0] == ends[1][0] else [f"exit code {ends[0][0]} -> {ends[1][0]}"]
        if ends[0][2] != ends[1][2]:
            told.append(f"stderr:\n{ends[0][2]}->\n{ends[1][2]}")
        told += differences(*(summary_of(f) for f in folders))
        tables = [{f.name: f.read_bytes() for f in folder.glob("*.csv")} for folder in folders]
        for name in sorted(tables[0].keys() | tables[1].keys()):
            told += table_differences(name, tables[0].get(name), tables[1].get(name))
        return told


def check_both(scene, roots, programs, limit):
    told = []
    for command in ("check", "plan"):
        ends = [call([p, command, str(root / scene)], limit, root) for p, root in zip(programs, roots)]
        if ends[0] != ends[1]:
            told.append(f"{command}:\n{ends[0]}->\n{ends[1]}")
    return told


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--old-root", type=pathlib.Path, default=ROOT)
    parser.add_argument("--limit", type=float, default=60)
    given = parser.parse_args()
    compare = check_both if given.check else run_both
    different = left_out = same = 0
    for scene in scenes(given.pattern):
        told = compare(scene, [given.old_root, ROOT], [given.old, given.new], given.limit)
        if told is None:
            left_out += 1
            print(f"left out  {scene}: longer than {given.limit:g} s")
            continue
        added = [t for t in told if t.startswith("+ ")]
        told = [t for t in told if not t.startswith("+ ")]
        different, same = different + bool(told), same + (not told)
        print(f"{'DIFFERENT' if told else 'same'}  {scene}" + "".join(f"\n    {t}" for t in told + added))
    print(f"{same} same, {different} different, {left_out} left out")
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
