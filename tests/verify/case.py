"""One case of the verification manual."""
from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

import cleave

ROOT = Path(os.environ.get("CLEAVE_ROOT", Path(__file__).resolve().parents[2]))


@dataclass
class Case:
    name: str  # of its page
    title: str
    text: str
    source: str
    scene: dict | Path | None
    values: Callable  # of the result: (quantity, published, ours, tolerance)
    section: str = ""  # of Fu (2014), chapters 6 and 7

    def rows(self):
        if self.scene is None:
            return list(self.values())
        return list(self.values(cleave.run(self.scene)))


def box(size, centre=None):
    """A box of the given size with a corner in the origin, or about a centre."""
    low = [0.0, 0.0, 0.0] if centre is None else [c - s / 2 for c, s in zip(centre, size)]
    return {"box": {"min": low, "max": [a + s for a, s in zip(low, size)]}}


def plane(through, dip, dip_direction, **more):
    return {"plane": {"through": list(through), "dip": dip, "dip_direction": dip_direction}, **more}


def normal_plane(through, normal, **more):
    """A plane by its normal, as dip and dip direction (degrees; x east, y north)."""
    from math import atan2, degrees, hypot

    x, y, z = normal if normal[2] >= 0 else [-c for c in normal]
    return plane(through, degrees(atan2(hypot(x, y), z)), degrees(atan2(x, y)) % 360, **more)
