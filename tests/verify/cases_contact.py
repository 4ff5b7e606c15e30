"""Blocks in contact: sliding, toppling, arches."""
import math

from case import ROOT, Case

CHAPTER = "Blocks in contact"
G = 9.81


def sliding():
    for phi in (0, 5, 10, 15, 20, 25):
        a = math.radians(30)
        way = G / 2 * (math.sin(a) - math.cos(a) * math.tan(math.radians(phi))) * 0.64

        def values(r, way=way):
            x, y = r.summary["contact"]["points"][0]["displacement"]
            yield "status", "converged", r.summary["contact"]["status"], 0
            yield "way after 0.8 s (m)", way, math.hypot(x, y), 1e-6
            yield "off the plane (m)", 0.0, abs(x * math.sin(a) + y * math.cos(a)), 1e-9
        yield Case(f"sliding_{phi}", f"Block on a plane of 30 degrees, friction {phi} degrees", "Rigid block.", "Fu (2014), 7.5.2; closed form",
                   ROOT / f"examples/sliding_block/friction_{phi:02d}.toml", values)


def column(name, tilt, thickness, height, friction, moves, how):
    t = math.radians(tilt)
    across, along = (math.cos(t), math.sin(t)), (-math.sin(t), math.cos(t))
    foot = [5 * across[0], 5 * across[1]]
    scene = {"rock": {"density": 2600}, "joints": {"default": {"friction": friction}},
             "contact": {"duration": 0.5, "step": 0.002, "rigid": True,
                         "points": [{"name": "foot", "at": [foot[0] + 1e-9, foot[1] + 1e-9], "body": "column"},
                                    {"name": "head", "at": [foot[0] + height * along[0], foot[1] + height * along[1]], "body": "column"}]},
             "body": [{"name": "slope", "fixed": True, "outline": [[0, 0], [0, -1], [10 * across[0], -1], [10 * across[0], 10 * across[1]]]},
                      {"name": "column", "rectangle": {"corner": foot, "width": thickness, "height": height, "angle": tilt}}]}
    scene["contact"]["points"] = [{"name": "head", "at": [foot[0] + height * along[0], foot[1] + height * along[1]], "body": "column"}]

    def values(r):
        body = next(b for b in r.summary["contact"]["bodies"] if b["name"] == "column")
        x, y = r.summary["contact"]["points"][0]["displacement"]
        moved = math.hypot(x, y) > 1e-6
        turned = abs(body["rotation"]) > 1e-6
        yield "status", "converged", r.summary["contact"]["status"], 0
        yield "moves", moves, moved, 0
        yield "turns", "topple" in how, turned, 0
    return Case(name, f"Column {thickness:g} by {height:g} m on {tilt:g} degrees, friction {friction:g}: {how}",
                "Stands for friction above the slope and tan(slope) below thickness / height.",
                "Closed form: slides where friction < slope, topples where tan(slope) > thickness / height", scene, values)


def columns():
    # thickness 1, height 4: topples above 14.0362 degrees; each border from both sides by 0.1 degrees.
    border = math.degrees(math.atan(1 / 4))
    yield column("column_stands", 10, 1, 4, 30, False, "stands")
    yield column("column_topples", 20, 1, 4, 45, True, "topples")
    yield column("column_slides", 25, 2, 1, 15, True, "slides")
    yield column("column_below_toppling", border - 0.1, 1, 4, 30, False, "stands")
    yield column("column_above_toppling", border + 0.1, 1, 4, 30, True, "topples")
    yield column("column_below_sliding", 20, 2, 1, 20.1, False, "stands")
    yield column("column_above_sliding", 20, 2, 1, 19.9, True, "slides")
    yield column("column_slides_and_topples", 40, 1, 4, 15, True, "slides and topples")


def arches():
    for count, ratio, stands in ((7, "100", True), (12, "100", False), (12, "112", True), (21, "100", False), (21, "112", True)):
        path = ROOT / f"examples/arch/arch_{count}_{ratio}.toml"
        if not path.exists():
            continue

        def values(r, stands=stands):
            yield "stands", stands, r.summary["contact"]["max_displacement_m"] < 1e-3, 0
        yield Case(f"arch_{count}_{ratio}", f"Semicircular arch of {count} voussoirs, thickness 0.{ratio}", "Critical ratios: 0.0957 for 7 voussoirs, 0.1049 for 12, 0.1067 for 21.",
                   "Milankovitch (1907), Heyman (1982); critical ratios of finitely many voussoirs recomputed", path, values)


def cases():
    yield from sliding()
    yield from columns()
    yield from arches()
