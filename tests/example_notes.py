#!/usr/bin/env python3
"""No example says a note that nobody expects: tests/example_notes.py [--night] [--write] CLEAVE [PATTERN]

Runs the scenes under examples/ whose path holds PATTERN, ensembles with few realizations, and compares the notes in
log.txt with tests/golden/example_notes.txt, figures left out. Scenes that are marked there as long run with --night
alone. A note that is new is to be looked at: where nobody who uses the example needs it, the scene or the rule of the
note is corrected; where it is true and belongs there, the comment of the example says so, and --write keeps it.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIST = ROOT / "tests/golden/example_notes.txt"
HEAD = "# Notes of each example, figures left out (tests/example_notes.py). (long): run at night alone.\n"
REALIZATIONS = 12
LONG = 6.0  # s


def without_figures(note):
    return re.sub(r"(?<![\w.])[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?", "#", note)


def notes_in(log):
    """Those of bodies stand each in its line, those of blocks in a section at the end."""
    section = re.search(r"^notes\n((?:  .*\n)*)", log, re.M)
    lines = [line.strip() for line in section.group(1).splitlines()] if section else []
    lines += re.findall(r"^note: (.*)", log, re.M)
    return sorted(set(map(without_figures, lines)))


def run(program, scene, folder):
    """Notes of a scene and how long it took; None where it is none (a survey, a file that scenes include)."""
    begun = time.monotonic()
    out = folder / "out" / scene.replace("/", "_")
    done = subprocess.run([program, "run", scene, "-o", out, "--quiet"], cwd=folder, capture_output=True, text=True)
    took = time.monotonic() - begun
    if done.returncode == 2 and ("survey file" in done.stderr or "joint sets alone" in done.stderr):
        return None, took
    if done.returncode != 0:
        return [f"ended with {done.returncode}: {done.stderr.strip()}"], took
    notes = notes_in((out / "log.txt").read_text())
    shutil.rmtree(out)
    return notes, took


def read_list():
    """By scene: whether it is long, and its notes."""
    held, scene = {}, None
    for line in LIST.read_text().splitlines() if LIST.exists() else []:
        if line.startswith("  "):
            held[scene][1].append(line[2:])
        elif line and not line.startswith("#"):
            scene = line.removesuffix(" (long)")
            held[scene] = (line.endswith(" (long)"), [])
    return held


def write_list(held):
    LIST.write_text(HEAD + "".join(name + (" (long)" if long else "") + "\n" + "".join(f"  {n}\n" for n in notes)
                                   for name, (long, notes) in sorted(held.items())))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--night", action="store_true")
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args()
    program = os.path.abspath(given.program)
    held, wrong, looked = read_list(), 0, 0
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        shutil.copytree(ROOT / "examples", folder / "examples")
        for scene in sorted((folder / "examples").rglob("*.toml")):
            name = str(scene.relative_to(folder / "examples"))
            long, expected = held.get(name, (False, None))
            if given.pattern not in name or (long and not given.night):
                continue
            text = scene.read_text()
            scene.write_text(re.sub(r"^realizations = \d+", f"realizations = {REALIZATIONS}", text, flags=re.M))
            notes, took = run(program, str(scene.relative_to(folder)), folder)
            if notes is None:
                continue
            looked += 1
            if given.write:
                held[name] = (long or took > LONG, notes)
                write_list(held)
            elif notes != expected:
                wrong += 1
                print(f"{name}:" if expected is not None else f"{name}: is not in {LIST.name}")
                for note in sorted(set(notes) | set(expected or [])):
                    if note not in notes or note not in (expected or []):
                        print(f"  {'new' if note in notes else 'gone'}: {note}")
    print(f"{looked} examples, {wrong} with other notes")
    return 1 if wrong or looked == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
