"""cleave cuts fractured rock into blocks, exactly, and says which of them will move.

    import cleave
    result = cleave.run("tunnel.toml")          # or a dict with the same keys
    print(result.summary["blocks"]["count"], result.key_blocks["factor_of_safety"])

Lengths are in metres, forces in newtons, stresses in pascals, angles in degrees, as in scene files.
"""
from __future__ import annotations

import os
from collections import namedtuple
from collections.abc import Mapping

from . import _cleave
from ._result import ROLES, Blocks, Faces, Result
from ._table import Table
from ._toml import dumps

__version__ = _cleave.version
__all__ = ["Blocks", "Faces", "MachineError", "Problem", "ROLES", "Result", "SceneError", "Table", "check", "dumps", "run"]

Problem = namedtuple("Problem", "file line key what remedy")
Problem.__doc__ = "One thing that is wrong with a scene: where, what, and what to do about it."


class SceneError(ValueError):
    """The scene cannot be run; ``problems`` has all that is wrong with it."""

    def __init__(self, problems) -> None:
        self.problems = [Problem(*p) for p in problems]
        super().__init__("\n".join(f"{p.file}:{p.line}: {p.key}: {p.what}; {p.remedy}" for p in self.problems))


class MachineError(OSError):
    """The machine failed, not the scene: a disk is full, too many files are open."""


def _refuse(problems) -> None:
    raise SceneError(problems)


def _text_of(scene, folder):
    """Text, its name in messages, and the folder that files are looked for in."""
    if isinstance(scene, Mapping):
        return dumps(scene), "scene", os.fspath(folder or ".")
    path = os.fspath(scene)
    with open(path, encoding="utf-8", errors="surrogateescape") as file:
        return file.read().encode("utf-8", "surrogateescape"), path, os.fspath(folder or os.path.dirname(path) or ".")


def run(scene, *, seed=None, threads=None, folder=None, progress=None) -> Result:
    """Runs a scene: a path to a TOML file, or a dict with the same tables and keys.

    seed      takes the place of the scene's.
    threads   as many as the machine has when not given; changes nothing but the time.
    folder    where files that the scene names are looked for: that of the file, the current one for a dict.
    progress  called as progress(stage, share) some times a second, share from 0 to 1 or None; what it raises ends the
              run, as Ctrl-C does, at its next stage or step.

    Raises SceneError when the scene is wrong, MachineError when the machine fails.
    """
    text, shown, where = _text_of(scene, folder)
    made = _cleave.run(text, shown, where, seed, threads or os.cpu_count() or 1, progress)
    return Result(made)


def check(scene, *, folder=None) -> list[Problem]:
    """All that is wrong with a scene as far as its keys and files show; nothing is run."""
    return [Problem(*p) for p in _cleave.problems(*_text_of(scene, folder))]
