"""Key blocks: modes, directions and factors of safety in closed form, and published wedges."""
import math
import random

import numpy as np

from case import ROOT, Case, box, plane

CHAPTER = "Key blocks"
DENSITY, GRAVITY = 2700.0, 9.81


def upward(dip, dip_direction):
    d, a = math.radians(dip), math.radians(dip_direction)
    return np.array([math.sin(d) * math.sin(a), math.sin(d) * math.cos(a), math.cos(d)])


def row_of(result):
    """The row of the largest block that is key or would be; None without one."""
    rows = list(result.key_blocks.rows())
    return max(rows, key=lambda r: r["volume_m3"]) if rows else None


def wedge_factor(n1, n2, phi1, phi2):
    """Mode, direction and factor of a wedge under its weight without cohesion, by vectors."""
    line = np.cross(n1, n2)
    line /= np.linalg.norm(line)
    if line[2] > 0:
        line = -line
    weight = np.array([0.0, 0.0, -1.0])
    drive = weight @ line
    across = weight - drive * line
    # across = -(N1 n1 + N2 n2)
    forces, *_ = np.linalg.lstsq(np.column_stack([n1, n2]), -across, rcond=None)
    if (forces > 1e-3).all():
        return "wedge", line, (forces[0] * math.tan(phi1) + forces[1] * math.tan(phi2)) / drive
    return None


def clean(value):
    """Rounding of what is 0."""
    return float(value) if abs(value) > 1e-12 else 0.0


def wedge_scene(first, second, phi1, phi2, side, through):
    return {"domain": box([40, 40, 10]), "stability": {"free": [side, "top"]},
            "joint": [plane(through, *first, set="one"), plane(through, *second, set="two")],
            "joints": {"one": {"friction": phi1}, "two": {"friction": phi2}}, "rock": {"density": DENSITY}}


def wedge(name, title, first, second, phi1, phi2, side, through, source, text, factor=None, tolerance=1e-9):
    mode, line, closed = wedge_factor(upward(*first), upward(*second), math.radians(phi1), math.radians(phi2))

    def values(r):
        row = row_of(r)
        if row is None:
            yield "mode", mode, "no block", 0
            return
        yield "mode", mode, row["mode"], 0
        for axis, value in zip("xyz", line):
            yield f"direction {axis}", clean(value), float(row[f"direction_{axis}"]), tolerance
        yield "factor of safety", factor if factor is not None else float(closed), float(row["factor_of_safety"]), tolerance
    return Case(name, title, text, source, wedge_scene(first, second, phi1, phi2, side, through), values)


def random_wedges(count):
    draw, made = random.Random(11), 0
    while made < count:
        first = draw.uniform(35, 85), draw.uniform(5, 85)
        second = draw.uniform(35, 85), draw.uniform(95, 175)
        phi1, phi2 = draw.uniform(10, 45), draw.uniform(10, 45)
        answer = wedge_factor(upward(*first), upward(*second), math.radians(phi1), math.radians(phi2))
        if answer is None:
            continue
        _, line, _ = answer
        plunge = math.degrees(math.asin(-line[2]))
        if not (30 < plunge < 60 and line[0] > 0.4 and abs(line[1]) < 0.25):
            continue
        # Where the traces on the top meet the east face: within it, or the wedge hangs on the sides of the box.
        through = np.array([39.7, 20.0, 8.0])
        ends = [through[1] - (n[0] * 0.3 + n[2] * 2) / n[1] for n in (upward(*first), upward(*second))]
        if not all(1 < y < 39 for y in ends):
            continue
        made += 1
        yield wedge(f"wedge_{made}", f"Wedge between {first[0]:.1f}/{first[1]:.1f} and {second[0]:.1f}/{second[1]:.1f}", first, second, phi1, phi2,
                    "east", [39.7, 20, 8], "Closed form: the weight along the line and across it", "Two joints through a point below the crest of a vertical face; friction only.")


def slabs():
    """A slab with open sides on a plane: friction and cohesion."""
    for i, (dip, phi, cohesion) in enumerate(((20, 10, 0), (20, 30, 0), (35, 25, 0), (35, 35, 0), (45, 30, 0), (45, 30, 2e4), (50, 20, 1e4),
                                              (50, 40, 5e4), (30, 0, 1e4), (30, 15, 3e3)), 1):
        t = math.tan(math.radians(dip))
        section = (8 + (8 - 6 * t)) / 2 * 6
        volume, area = section * 4, 6 * 4 / math.cos(math.radians(dip))
        weight = volume * DENSITY * GRAVITY
        drive, press = weight * math.sin(math.radians(dip)), weight * math.cos(math.radians(dip))
        resist = press * math.tan(math.radians(phi)) + cohesion * area
        scene = {"domain": box([10, 10, 10]), "stability": {"free": ["east", "top"]}, "rock": {"density": DENSITY},
                 "joint": [plane([10, 5, 2], dip, 90, set="base"), plane([4, 5, 5], 90, 90, set="side"), plane([5, 3, 5], 90, 0, set="side"),
                           plane([5, 7, 5], 90, 0, set="side")],
                 "joints": {"base": {"friction": phi, "cohesion": cohesion}, "side": {"friction": 0}}}

        def values(r, volume=volume, drive=drive, resist=resist):
            row = row_of(r)
            yield "mode", "sliding", row["mode"], 0
            yield "volume (m3)", volume, float(row["volume_m3"]), 1e-10
            yield "net force over driving force", clean(1 - resist / drive), float(row["net_force_n"]) / drive, 1e-9
            yield "factor of safety", resist / drive, float(row["factor_of_safety"]), 1e-9
        yield Case(f"slab_{i}", f"Slab on a plane of {dip} degrees", "Sides and back are open or smooth.", "Closed form: (c A + W cos tan phi) / (W sin)", scene, values)


def roofs():
    for dip in (30, 45, 60, 75):
        height = math.tan(math.radians(dip))
        volume = math.sqrt(3) * height
        joints = [plane([math.sin(math.radians(a)), math.cos(math.radians(a)), 0], dip, a) for a in (0, 120, 240)]
        scene = {"domain": {"box": {"min": [-4, -4, 0], "max": [4, 4, 5]}}, "stability": {"free": ["bottom"]}, "joint": joints,
                 "joints": {"default": {"friction": 35}}, "rock": {"density": DENSITY}}

        def values(r, volume=volume):
            rows = [x for x in r.key_blocks.rows() if x["mode"] == "falling"]
            best = min(rows, key=lambda x: abs(x["volume_m3"] - volume)) if rows else None
            yield "volume (m3)", volume, float(best["volume_m3"]) if best else None, 1e-12
            yield "net force (N)", volume * DENSITY * GRAVITY, float(best["net_force_n"]) if best else None, 1e-12
            yield "factor of safety", 0.0, float(best["factor_of_safety"]) if best else None, 0
        yield Case(f"roof_{dip}", f"Roof tetrahedron, joints of {dip} degrees",
                   "Three joints 120 degrees apart above a roof, their traces an equilateral triangle of inradius 1: nothing presses on a joint, so friction does not help.",
                   "Closed form: V = sqrt 3 tan(dip)", scene, values)


def plane_failure():
    height, face, dip = 60.0, math.radians(50), math.radians(35)
    depth = height * (1 - math.sqrt(math.tan(dip) / math.tan(face)))
    run, toe = height / math.tan(face), 150.0
    back = toe - (height - depth) / math.tan(dip)
    corners = [[0, 0, 0], [toe, 0, 0], [0, 1, 0], [toe, 1, 0], [0, 0, height], [toe - run, 0, height], [0, 1, height], [toe - run, 1, height]]
    for seismic, factor in ((0.0, 1.584331028), (0.08, 1.37160592367)):
        scene = {"domain": {"corners": corners}, "rock": {"density": 26000 / 9.81},
                 "stability": {"free": ["east", "top", "north", "south"], "seismic": [seismic, 0, 0]},
                 "joint": [plane([toe, 0.5, 0], 35, 90, set="plane"), plane([back, 0.5, 50], 90, 90, set="crack")],
                 "joints": {"plane": {"friction": 35, "cohesion": 1e5}, "crack": {"friction": 0}}}

        def values(r, factor=factor):
            row = row_of(r)
            yield "weight (N per m)", 23923783.0693, float(row["weight_n"]) if row else None, 1e-9
            yield "factor of safety", factor, float(row["factor_of_safety"]) if row else None, 1e-9
        yield Case(f"plane_failure_{'dry' if not seismic else 'earthquake'}", "Plane failure with a tension crack (Sau Mau Ping)",
                   "Slope of 60 m and 50 degrees, plane of 35 degrees, dry, per metre" + (", earthquake 0.08 g." if seismic else "."),
                   "Hoek, Practical Rock Engineering; digits recomputed", scene, values)


def cases():
    thesis = (60, 45), (60, 135)
    yield Case("wedge_fu", "Wedge on a slope (Fu 2014, 4.5.1)", "Joints 60/045 and 60/135.", "Fu (2014), 4.5.1; digits recomputed",
               ROOT / "examples/wedge_slope/wedge_slope.toml",
               lambda r: [("mode", "wedge", row_of(r)["mode"], 0), ("direction x", 0.632455532034, float(row_of(r)["direction_x"]), 1e-11),
                          ("direction z", -0.774596669241, float(row_of(r)["direction_z"]), 1e-11),
                          ("factor of safety", 0.596284794, float(row_of(r)["factor_of_safety"]), 1e-9)])
    for phi in (20.0, 44.0757141774):
        yield wedge(f"wedge_fu_{phi:.0f}", f"The same at a friction of {phi} degrees", *thesis, phi, phi, "east", [39.7, 20, 8],
                    "Closed form: 4 / sqrt 15 tan(phi); critical friction 44.0757141774 degrees", "Two joints of equal friction.",
                    4 / math.sqrt(15) * math.tan(math.radians(phi)))
    yield wedge("wedge_3dec", "Sliding wedge of the 3DEC manual", (40, 130), (60, 220), 33.3572214088, 33.3572214088, "south", [20, 0.5, 7],
                "Itasca, 3DEC verification, sliding wedge; critical friction recomputed", "At the critical friction the factor is 1; a distinct-element run finds 33.19 degrees.", 1.0)
    yield from random_wedges(40)
    yield from slabs()
    yield from roofs()
    yield from plane_failure()
    yield Case("slab_behind_toe", "A slab behind its toe", "A slab of 312 m3 on 55 degrees pushes a toe of 19 m3: block by block nothing moves, together they do.",
               "Limit equilibrium of two blocks (active and passive wedge); digits recomputed", ROOT / "examples/slab_behind_toe/slab_behind_toe.toml",
               lambda r: [("key groups", 1, r.summary["key_groups"]["count"], 0), ("factor of safety of the group", 0.942790, r.summary["key_groups"]["factor"], 2e-6)])
