#!/usr/bin/env python3
"""No block that moves is called stable: tests/verdicts_in_motion.py CLEAVE [--first SEED] [--scenes N] [--seconds S]

Draws small scenes of rock (slopes, trenches, boxes with open sides; two to four joint sets, some with cohesion; half of
the scenes with water, a surcharge or a seismic force), judges them with groups = "decide" and lets all their blocks go
in motion, in the same run. A block that motion moves must be a key block, of a group, or in doubt. Motion knows nothing of the verdicts and shares the law of the contacts alone. Scenes
that take longer than S seconds (60) are counted, and so are those that motion could not follow. Ends with 1 when a
moving block has no verdict, and keeps its scene.
"""
import argparse
import csv
import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile

# A tenth of free fall from rest over the duration, and a displacement that is no rounding.
MOVES_M_S, MOVES_M = 0.01, 1e-4


def joint_set(draw, number, length):
    dip = draw.choice([draw.uniform(0, 90), draw.uniform(0, 30), draw.uniform(55, 90)])
    attitude = f"dip = {dip:.2f}, dip_direction = {draw.uniform(0, 360):.2f}"
    scatter = f', distribution = "fisher", kappa = {draw.uniform(20, 300):.1f}'
    lines = ["[[joint_set]]", f'name = "S{number}"']
    if draw.random() < 0.75:
        spacing = draw.uniform(0.14, 0.35) * length
        lines += [
            f"orientation = {{ {attitude}{scatter if draw.random() < 0.5 else ''} }}",
            'size = "persistent"',
            f"intensity = {{ spacing = {spacing:.3f} }}",
        ]
    else:
        lines += [
            f"orientation = {{ {attitude}{scatter} }}",
            f"size = {draw.uniform(3, 10):.3f}",
            f"intensity = {{ p32 = {draw.uniform(3, 6) / length:.3f} }}",
        ]
    if draw.random() < 0.4:
        cohesion = draw.choice([0, 0, draw.uniform(1e3, 2e4)])
        lines += [f"[joints.S{number}]", f"friction = {draw.uniform(8, 50):.2f}", f"cohesion = {cohesion:.1f}"]
    return lines


def excavation(draw, kind, length):
    if kind == "slope":
        crest, foot = draw.uniform(0.2, 0.5) * length, draw.uniform(0.02, 0.3) * length
        points = [(0, 0.9), (crest / length, 0.9), ((crest + foot) / length, 0.3), (1.2, 0.3)]
    elif kind == "trench":
        points = [(0, 0.95), (0.3, 0.95), (0.36, 0.3), (0.7, 0.3), (0.75, 0.95), (2, 0.95)]
    else:
        return []
    profile = ", ".join(f"[{x * length:.3f}, {z * length:.3f}]" for x, z in points)
    return [
        "[[excavation]]",
        f'name = "{kind}"',
        'kind = "slope"',
        f"profile = {{ direction = 90, points = [{profile}] }}",
    ]


def acting(draw, length):
    """Lines of [stability], none in half of the scenes, and whether the seismic force is to act in motion."""
    if draw.random() < 0.5:
        return [], "false"
    lines, seismic = [], "false"
    kind = draw.choice(["table", "pressures", "lake", "dry"])
    if kind == "table":
        lines.append(f"water = {{ table = {draw.uniform(0.3, 0.95) * length:.3f} }}")
    elif kind == "pressures":
        lines.append(f"water = {{ pressures = {{ S0 = {draw.uniform(1e3, 4e4):.1f} }} }}")
    elif kind == "lake":
        lines.append(f"water = {{ table = {draw.uniform(0.3, 1.2) * length:.3f}, free_faces = true }}")
    if draw.random() < 0.4:
        push = ", ".join(f"{draw.uniform(-0.15, 0.15):.3f}" for _ in range(3))
        lines.append(f"seismic = [{push}]")
        seismic = "true"
    if draw.random() < 0.4:
        traction = ", ".join(f"{draw.uniform(-2e4, 2e4):.1f}" for _ in range(3))
        lines.append(f"surcharge = [{{ traction = [{traction}] }}]")
    return lines, seismic


def scene(seed):
    draw = random.Random(seed)
    kind = draw.choice(["slope", "trench", "box", "box", "box"])
    length = draw.uniform(10, 16)
    friction = draw.choice([draw.uniform(5, 20), draw.uniform(10, 30), draw.uniform(20, 50)])
    lines = [
        "schema = 1",
        f"seed = {draw.randrange(1, 10**6)}",
        "[domain]",
        f"box = {{ min = [0, 0, 0], max = [{length:.3f}, {draw.uniform(0.5, 1) * length:.3f}, {length:.3f}] }}",
    ]
    for number in range(draw.choice([2, 3, 3, 3, 4])):
        lines += joint_set(draw, number, length)
    cohesion = draw.choice([0, 0, 0, draw.uniform(1e3, 3e4)])
    lines += ["[joints.default]", f"friction = {friction:.2f}", f"cohesion = {cohesion:.1f}"]
    lines += ["[rock]", "density = 2600", *excavation(draw, kind, length), "[stability]", 'groups = "decide"']
    if kind == "box":
        sides = draw.choice(
            ['"top", "east"', '"top", "east", "west"', '"top", "east", "west", "north", "south"', '"bottom"', '"east"']
        )
        lines.append(f"free = [{sides}]")
    loads, seismic = acting(draw, length)
    lines += loads
    lines += ["[motion]", f"seismic = {seismic}", 'release = "all"', "duration = 0.06", "step = 0.02", "frame = 0.06", "error = false"]
    lines.append(f"surface_friction = {friction:.2f}")
    return "\n".join(lines) + "\n"


def rows(path):
    if not path.exists():
        return []
    with path.open() as file:
        return list(csv.DictReader(file))


def moving_without_verdict(out):
    """Blocks that move in motion and are named by no verdict; and how many move."""
    moving = {
        int(row["block"])
        for row in rows(out / "motion.csv")
        if float(row["speed_m_s"]) > MOVES_M_S and max(abs(float(row["fall_m"])), float(row["runout_m"])) > MOVES_M
    }
    named = {int(row["block"]) for row in rows(out / "key_blocks.csv") if row["batch"]}
    for row in rows(out / "key_groups.csv"):
        named.update(int(number) for number in re.findall(r"\d+", row["blocks"]))
    return sorted(moving - named), len(moving)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=60)
    given = parser.parse_args()
    counts = {"with blocks that move": 0, "at rest": 0, "too long": 0, "not followed": 0, "refused": 0}
    wrong = 0
    with tempfile.TemporaryDirectory() as place:
        for seed in range(given.first, given.first + given.scenes):
            text = scene(seed)
            file, out = pathlib.Path(place) / "scene.toml", pathlib.Path(place) / f"out_{seed}"
            file.write_text(text)
            try:
                run = subprocess.run(
                    [given.program, "run", file, "-o", out, "--quiet"], capture_output=True, timeout=given.seconds
                )
            except subprocess.TimeoutExpired:
                counts["too long"] += 1
                continue
            if run.returncode not in (0, 4):
                counts["refused"] += 1
                print(f"seed {seed}: exit code {run.returncode}: {run.stderr.decode().strip()[:200]}")
                continue
            motion = json.loads((out / "summary.json").read_text()).get("motion")
            if motion and motion["status"] not in ("converged", "rough"):
                counts["not followed"] += 1
                continue
            nameless, moving = moving_without_verdict(out)
            counts["with blocks that move" if moving else "at rest"] += 1
            if nameless:
                wrong += 1
                kept = pathlib.Path(f"verdict_{seed}.toml").resolve()
                kept.write_text(text)
                print(f"seed {seed}: blocks {nameless} move and are in no batch, group or doubt: {kept}")
    print(", ".join(f"{count} {what}" for what, count in counts.items()) + f"; {wrong} with a verdict too good")
    return 1 if wrong or counts["refused"] else 0


if __name__ == "__main__":
    sys.exit(main())
