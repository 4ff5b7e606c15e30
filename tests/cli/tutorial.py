#!/usr/bin/env python3
"""docs/tutorial.md as a new user follows it: every file is written, every command run, and what the page shows of the
output is in the output, in this order. `tutorial.py CLEAVE ROOT`"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

program, root = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
page = (root / "docs/tutorial.md").read_text()
parts = re.findall(r"```(console|toml file=(\S+))\n(.*?)```", page, re.S)
wrong, commands = [], 0


def matches(shown, lines):
    """Each shown line, `...` for anything, in order among the lines."""
    at = 0
    for line in shown:
        pattern = re.compile(".*".join(re.escape(part) for part in line.split("...")) + "$")
        while at < len(lines) and not pattern.match(lines[at]):
            at += 1
        if at == len(lines):
            return line
        at += 1
    return None


with tempfile.TemporaryDirectory() as folder:
    here = Path(folder)
    (here / "bin").mkdir()
    os.symlink(program, here / "bin/cleave")
    for table in (root / "docs/tutorial").glob("*.csv"):
        shutil.copy(table, here)
    environment = dict(os.environ, PATH=f"{here / 'bin'}:{os.environ['PATH']}")
    for kind, name, text in parts:
        if kind != "console":
            (here / name).write_text(text)
            continue
        for step in re.findall(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", text, re.M):
            command, shown = step[0], [line for line in step[1].splitlines() if line]
            commands += 1
            done = subprocess.run(["bash", "-c", command], cwd=here, env=environment, capture_output=True, text=True)
            lines = (done.stdout + done.stderr).splitlines()
            expected = 2 if any(line.startswith("error:") for line in shown) else 0
            if done.returncode != expected:
                wrong.append(f"$ {command}\nexit code {done.returncode}\n" + "\n".join(lines[-20:]))
            missing = matches(shown, lines)
            if missing is not None:
                wrong.append(f"$ {command}\nno such line after those before it: {missing}\n" + "\n".join(lines))
if commands < 15:
    wrong.append(f"only {commands} commands were found in docs/tutorial.md")
print("\n\n".join(wrong) if wrong else f"{commands} commands run")
sys.exit(1 if wrong else 0)
