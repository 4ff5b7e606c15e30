#!/usr/bin/env python3
"""Writes what the examples cost on this machine: costs.csv, which the plan's estimates are compared with.

  tests/golden/costs.py PROGRAM > tests/golden/costs.csv

Stages whose cost the joints do not tell (groups of blocks in `stability`, motion in `contact`) are left out.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

LEFT_OUT = {"stability", "contact"}
LONGEST_S = 300


def measured(program, scene):
    """(MB, seconds of CPU) of a run of blocks, or None for other scenes and those that take too long."""
    if "[[body]]" in scene.read_text(encoding="utf-8") or "[domain]" not in scene.read_text(encoding="utf-8"):
        return None
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = subprocess.run([program, "run", scene, "-o", folder + "/out", "--quiet", "--threads", "1"],
                                  timeout=LONGEST_S, capture_output=True, check=False)
        except subprocess.TimeoutExpired:
            return None
        if done.returncode:
            return None
        cost = json.loads(pathlib.Path(folder, "out", "summary.json").read_text(encoding="utf-8"))["cost"]
    seconds = cost["cpu_s"] - sum(s["cpu_s"] for s in cost["stages"] if s["stage"] in LEFT_OUT)
    return cost["peak_rss_mb"], seconds


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    print("scene,memory_mb,cpu_s")
    for scene in sorted((root / "examples").rglob("*.toml")):
        found = measured(sys.argv[1], scene)
        if found:
            print(f"{scene.relative_to(root)},{found[0]:.0f},{found[1]:.3g}", flush=True)


main()
