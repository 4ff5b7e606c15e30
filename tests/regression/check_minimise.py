#!/usr/bin/python3
"""The minimiser finds what matters: of thirty joints, the one that is bent.

usage: check_minimise.py CLEAVE FOLDER
"""
import pathlib
import subprocess
import sys
import tomllib

cleave, folder = sys.argv[1], pathlib.Path(sys.argv[2])
folder.mkdir(parents=True, exist_ok=True)
points, faces = [], []
for i in range(30):
    z = 0.2 + 0.3 * i
    bend = 0.731 if i == 17 else 0
    points += [(0.123456, 0, z), (10, 0, z), (10, 10, z), (5, 12, z), (0, 10, z + bend)]
    faces.append([5 * i + k + 1 for k in range(5)])
(folder / "many.obj").write_text("".join("v {} {} {}\n".format(*p) for p in points)
                                 + "".join("f " + " ".join(map(str, f)) + "\n" for f in faces))
(folder / "many.toml").write_text("""schema = 1
title = "many"
seed = 5
[domain]
box = { min = [0, 0, 0], max = [10, 10, 10] }
[[joint]]
file = "many.obj"
set = "A"
[[joint_set]]
name = "B"
orientation = { dip = 30, dip_direction = 30, distribution = "fisher", kappa = 40 }
shape = "rectangle"
size = 3
intensity = { count = 20 }
[joints.A]
friction = 30
[rock]
density = 2700
""")
minimise = [sys.executable, pathlib.Path(__file__).with_name("minimise.py"), cleave, folder / "many.toml", folder / "small.toml"]
subprocess.run(minimise, check=True)
small = tomllib.loads((folder / "small.toml").read_text())
assert len(small["joint"]) == 1, small
assert len(small["joint"][0]["polygon"]) == 4, small
assert set(small) == {"schema", "domain", "joint"}, small
assert subprocess.run([cleave, "check", folder / "small.toml"], capture_output=True).returncode == 2
# nothing to find where nothing goes wrong
good = folder / "good.toml"
good.write_text("[domain]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n")
assert subprocess.run([*minimise[:3], good, folder / "none.toml"], capture_output=True).returncode == 1
