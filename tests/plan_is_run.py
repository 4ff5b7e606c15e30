#!/usr/bin/env python3
"""What the plan says is what runs: tests/plan_is_run.py CLEAVE [PATTERN] [--limit S] [--all]

Runs scenes of examples and of `cleave init` whose path holds PATTERN and compares the stages that `plan` of
summary.json says with those that `cost` has booked; `cleave plan` must say the same. Stages of the realizations of an
ensemble are booked together as monte_carlo and apart in `realization_cost`; of an ensemble one realization is replayed
and, where it has enough, one shard is run, by the same rule. Of the examples that are planned alike and have the same
tables the quickest is run, with --all (at night) every one. Scenes that take longer than S seconds (20) are left out;
kinds of which two were are counted. What `cleave check` takes for a scene must be planned; of `cleave init` these must
end well, however long they take.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
OF_A_REALIZATION = {"draw", "cut", "audit", "flow", "stability", "support"}


def booked_as_planned(folder):
    summary = json.loads((folder / "summary.json").read_text())
    stated = [stage["stage"] for stage in summary["plan"] if stage["run"]]
    ensemble = "monte_carlo" in stated and "monte_carlo" in summary
    expected = [s for s in stated if not ensemble or s not in OF_A_REALIZATION]
    booked = [stage["stage"] for stage in summary["cost"]["stages"]]
    told = [] if expected == booked else [f"planned {expected}, done {booked}"]
    if ensemble:
        inside = [s for s in stated if s in OF_A_REALIZATION]
        made = [stage["stage"] for stage in summary.get("realization_cost", [])]
        # Where only key blocks are cut, the certificate is a part of the cut.
        if made != inside and made != [s for s in inside if s != "audit"]:
            told.append(f"planned {inside} of each realization, done {made}")
    return stated, ensemble, told


def plan_of(program, scene):
    """Stages planned and seconds estimated; None where the file is no scene of its own, what was said where it is one."""
    said = subprocess.run([program, "plan", scene], capture_output=True, text=True)
    if said.returncode != 0:
        checked = subprocess.run([program, "check", scene], capture_output=True, text=True)
        return f"cleave plan ended with {said.returncode}: {said.stderr.strip()}" if checked.returncode == 0 else None
    estimate = re.search(r"^estimated size: .*? ([0-9.e+-]+) s of CPU", said.stdout, re.M)
    return re.findall(r"^  (\w+) +run ", said.stdout, re.M), float(estimate.group(1)) if estimate else 0.0


def by_kind(scenes):
    """The examples that are planned alike and have the same tables, the quickest first; those of `cleave init` alone."""
    kinds = {}
    for scene, (planned, seconds) in scenes.items():
        tables = frozenset(re.findall(r"^\[+([\w.]+)\]", scene.read_text(), re.M))
        kind = (tuple(planned), tables) if scene.is_relative_to(ROOT) else scene
        kinds.setdefault(kind, []).append((seconds, scene))
    return [[scene for _, scene in sorted(kind)] for kind in kinds.values()]


def differences(program, scene, planned, limit):
    """What was found, nothing where all is well; None where it took too long. No limit: it must end well."""
    with tempfile.TemporaryDirectory() as place:
        out = pathlib.Path(place)

        def run(*arguments):
            return subprocess.run([program, *arguments, "--quiet"], capture_output=True, text=True, timeout=limit)

        try:
            done = run("run", scene, "-o", out / "out")
            if limit is None and done.returncode != 0:
                return [f"ended with {done.returncode}: {done.stderr}"]
            stated, ensemble, told = booked_as_planned(out / "out")
            if stated != planned:
                told.append(f"cleave plan says {planned}, summary.json {stated}")
            if ensemble:
                run("replay", out / "out", "--realization", "0", "-o", out / "one")
                replayed = json.loads((out / "one/summary.json").read_text())
                booked = {stage["stage"] for stage in replayed["cost"]["stages"]}
                if not booked - {"read", "write", "report", "monte_carlo"} <= set(stated):
                    told.append(f"replay did {booked}, planned {stated}")
                # Small shards: what a shard does shows in a few realizations.
                shards = max(2, min(16, json.loads((out / "out/summary.json").read_text())["monte_carlo"]["realizations"] // 2))
                run("run", scene, "--shard", f"1/{shards}", "-o", out / "part")
                if (out / "part/summary.json").exists():
                    told += [f"shard: {line}" for line in booked_as_planned(out / "part")[2]]
        except subprocess.TimeoutExpired:
            return None
    return told


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--limit", type=float, default=20)
    parser.add_argument("--all", action="store_true")
    given = parser.parse_args()
    wrong = left_out = same = 0
    help_text = subprocess.run([given.program, "init", "?"], capture_output=True, text=True).stderr
    kinds = re.search(r"one of: (.*)", help_text).group(1).split(", ")
    with tempfile.TemporaryDirectory() as place:
        scenes = sorted((ROOT / "examples").rglob("*.toml"))
        for kind in kinds:
            made = pathlib.Path(place) / f"init_{kind}.toml"
            made.write_text(subprocess.run([given.program, "init", kind], capture_output=True, text=True).stdout)
            scenes.append(made)
        plans = {scene: plan_of(given.program, scene) for scene in scenes if given.pattern in str(scene)}
        for scene, refused in plans.items():
            if isinstance(refused, str):
                wrong += 1
                print(f"{scene.name}: {refused}")
        plans = {scene: plan for scene, plan in plans.items() if isinstance(plan, tuple)}
        for kind in [[scene] for scene in plans] if given.all else by_kind(plans):
            for scene in kind[:2]:
                planned, seconds = plans[scene]
                limit = given.limit if scene.is_relative_to(ROOT) else None
                too_long = limit is not None and seconds > 2 * limit
                told = None if too_long else differences(given.program, scene, planned, limit)
                if told is not None:
                    break
            else:
                left_out += 1
                continue
            same, wrong = same + (not told), wrong + bool(told)
            for line in told:
                print(f"{scene.name}: {line}")
    print(f"{same} as planned, {wrong} not, {left_out} left out")
    return 1 if wrong or same == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
