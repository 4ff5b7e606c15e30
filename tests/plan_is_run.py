#!/usr/bin/env python3
"""What the plan says is what runs: tests/plan_is_run.py CLEAVE [PATTERN] [--limit S]

Runs every scene of examples whose path holds PATTERN and compares the stages that `plan` of summary.json says with those
that `cost` has booked; `cleave plan` must say the same. Stages of the realizations of an ensemble are booked as
monte_carlo. Scenes that take longer than S seconds (20) are left out and counted.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
OF_A_REALIZATION = {"draw", "cut", "audit", "stability", "support"}


def differences(program, scene, limit):
    said = subprocess.run([program, "plan", scene], capture_output=True, text=True)
    if said.returncode != 0:
        return []  # no scene of its own
    planned = re.findall(r"^  (\w+) +run ", said.stdout, re.M)
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place) / "out"
        try:
            subprocess.run([program, "run", scene, "--quiet", "-o", folder], capture_output=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return None
        summary = json.loads((folder / "summary.json").read_text())
    stated = [stage["stage"] for stage in summary["plan"] if stage["run"]]
    expected = [s for s in stated if "monte_carlo" not in stated or s not in OF_A_REALIZATION]
    booked = [stage["stage"] for stage in summary["cost"]["stages"]]
    told = [] if stated == planned else [f"cleave plan says {planned}, summary.json {stated}"]
    return told + ([] if expected == booked else [f"planned {expected}, done {booked}"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--limit", type=float, default=20)
    given = parser.parse_args()
    wrong = left_out = same = 0
    for scene in sorted((ROOT / "examples").rglob("*.toml")):
        if given.pattern not in str(scene):
            continue
        told = differences(given.program, scene, given.limit)
        if told is None:
            left_out += 1
            continue
        same, wrong = same + (not told), wrong + bool(told)
        for line in told:
            print(f"{scene.relative_to(ROOT)}: {line}")
    print(f"{same} as planned, {wrong} not, {left_out} left out")
    return 1 if wrong or same == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
