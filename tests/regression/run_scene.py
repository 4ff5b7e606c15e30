#!/usr/bin/python3
"""Runs one scene of tests/regression and checks what its comments state.

usage: run_scene.py CLEAVE SCENE.toml FOLDER

Comments of the form `# expect: KEY = VALUE`:
    exit = 0                      how the program ends (0 when not stated)
    blocks.count = 5              any number or text of summary.json, by its path
    blocks.volume_m3 ~ 12.5       to 1e-9 of itself
    stderr contains certificate   a part of what it says
Runs with one thread and with three: the summaries agree in blocks and key blocks.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys


def value_at(summary, path):
    for key in path.split("."):
        summary = summary[int(key)] if isinstance(summary, list) else summary[key]
    return summary


def run(cleave, scene, out, threads):
    shutil.rmtree(out, ignore_errors=True)
    ended = subprocess.run([cleave, "run", scene, "-o", out, "--quiet", "--threads", str(threads)],
                           capture_output=True, text=True, timeout=600)
    file = out / "summary.json"
    return ended, json.loads(file.read_text()) if file.exists() else None


def problems(cleave, scene, folder):
    folder.mkdir(parents=True, exist_ok=True)
    expectations = re.findall(r"^# expect: (.*)$", scene.read_text(), re.M)
    if not expectations:
        yield "states no expectation: add a comment such as '# expect: blocks.count = 5'"
    ended, summary = run(cleave, scene, folder / "one", 1)
    wanted_exit = 0
    for line in expectations:
        words = re.fullmatch(r"(\S+) (=|~|contains) (.*?)\s*", line)
        if words is None:
            yield f"cannot be read: expect: {line}"
            continue
        key, relation, wanted = words.groups()
        if key == "exit":
            wanted_exit = int(wanted)
        elif key == "stderr":
            if wanted not in ended.stderr:
                yield f"stderr does not contain {wanted!r}: {ended.stderr}"
        elif summary is None:
            yield f"there is no summary.json: {ended.stderr}"
        else:
            found = value_at(summary, key)
            good = abs(found - float(wanted)) <= 1e-9 * abs(float(wanted)) if relation == "~" else str(found) == wanted
            if not good:
                yield f"{key} is {found}, expected {wanted}"
    if ended.returncode != wanted_exit:
        yield f"ended with {ended.returncode}, expected {wanted_exit}: {ended.stderr}"
    again, other = run(cleave, scene, folder / "three", 3)
    if again.returncode != ended.returncode:
        yield f"ended with {again.returncode} with three threads"
    if summary and other and any(summary.get(k) != other.get(k) for k in ("blocks", "key_blocks")):
        yield "another result with three threads"


def main():
    found = list(problems(sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])))
    for problem in found:
        print("WRONG:", problem)
    sys.exit(1 if found else 0)


main()
