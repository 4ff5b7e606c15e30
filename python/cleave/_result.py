"""What a run came to."""
from __future__ import annotations

import json
from functools import cached_property

import numpy as np

from ._table import Table

ROLES = ("joint", "fixed", "free", "window")


class Blocks:
    """All blocks, one entry an array element; arrays look into the result's memory and cannot be written.

    ``volume`` m3 · ``centroid`` m, (n, 3) · ``thickness`` m · ``convex`` ``fixed`` ``free`` bool ·
    ``vertices`` ``edges`` ``faces`` counts.
    """

    def __init__(self, arrays: dict) -> None:
        self.__dict__.update(arrays)

    def __len__(self) -> int:
        return len(self.volume)

    def __repr__(self) -> str:
        return f"<cleave blocks: {len(self)}, {float(np.sum(self.volume)):g} m3>"


class Faces:
    """All faces, those of a block in a row.

    ``block`` ``plane`` numbers · ``role`` index into ``cleave.ROLES`` · ``joint`` ``excavation`` numbers, -1: none ·
    ``area`` m2 · ``centroid`` m · ``normal`` unit, out of the block. ``loops(i)``: corners of face i as indices into
    ``Result.points``, the outer loop first (counter-clockwise from outside), then holes.
    """

    def __init__(self, result) -> None:
        self.__dict__.update(result.face_arrays())
        self._result = result

    def __len__(self) -> int:
        return len(self.block)

    def loops(self, face: int) -> list[list[int]]:
        return self._result.loops(face)


class Result:
    """What ``cleave.run`` gives. What a scene did not ask for is None."""

    def __init__(self, made) -> None:
        self._made = made

    @property
    def kind(self) -> str:
        """"blocks", "monte_carlo", "elastic" or "contact"."""
        return self._made.kind

    @cached_property
    def summary(self) -> dict:
        """summary.json as a dict; docs/summary.schema.json says what stands in it."""
        return json.loads(self._made.summary_json)

    @property
    def notes(self) -> list[str]:
        """What a user should know."""
        return self._made.notes

    @property
    def complaint(self) -> str:
        """Why the result is not to be used as it is; empty when all is well."""
        return self._made.complaint

    @property
    def points(self) -> np.ndarray:
        """Corners of all blocks, m, (n, 3)."""
        return self._made.points

    @cached_property
    def blocks(self) -> Blocks:
        return Blocks(self._made.block_arrays())

    @cached_property
    def faces(self) -> Faces:
        return Faces(self._made)

    def _table(self, name: str) -> Table | None:
        text = self._made.text(name)
        return None if text is None else Table(text)

    @cached_property
    def key_blocks(self) -> Table | None:
        """key_blocks.csv: removable blocks that would move without friction; ``key`` 1 where they are unstable."""
        return self._table("key_blocks.csv")

    @cached_property
    def bolts(self) -> Table | None:
        return self._table("bolts.csv")

    @cached_property
    def support_blocks(self) -> Table | None:
        return self._table("support_blocks.csv")

    @cached_property
    def records(self) -> Table | None:
        """realizations.csv of a Monte Carlo run: a row a realization."""
        return self._table("realizations.csv")

    @cached_property
    def bodies(self) -> Table | None:
        """bodies.csv of a contact run."""
        return self._table("bodies.csv")

    @cached_property
    def point_history(self) -> Table | None:
        """points.csv of elastic and contact runs: the points that the scene names."""
        return self._table("points.csv")

    @cached_property
    def history(self) -> Table | None:
        """history.csv of a contact run."""
        return self._table("history.csv")

    def write(self, folder) -> None:
        """Writes what the program writes (but log.txt and scene.toml) into a folder, made when it is missing."""
        self._made.write(folder)

    def to_pyvista(self):
        """The blocks as a pyvista.UnstructuredGrid of polyhedra with cell arrays ``block`` and ``volume``."""
        import pyvista

        cells = self._made.cell_arrays()
        ends = cells["face_ends"]
        starts = np.concatenate(([0], ends[:-1])) if len(ends) else ends
        stream = cells["face_stream"]
        # Each cell: how many numbers follow, then faces as in the stream.
        packed = np.concatenate([np.concatenate(([b - a], stream[a:b])) for a, b in zip(starts, ends)]) if len(ends) else stream
        polyhedron = 42
        grid = pyvista.UnstructuredGrid(packed, np.full(len(ends), polyhedron, dtype=np.uint8), cells["points"])
        grid.cell_data["block"] = cells["block"]
        grid.cell_data["volume"] = cells["volume"]
        return grid

    def __repr__(self) -> str:
        return f"<cleave result: {self.kind}, {self.summary.get('title') or 'untitled'}>"
