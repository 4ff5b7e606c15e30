"""Blocks in contact: sliding, toppling, arches."""
import math
import tomllib

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


def end(result, name):
    return next(p for p in result.summary["contact"]["points"] if p["name"] == name)["displacement"]


def shaken():
    def values(r):
        yield "status", "converged", r.summary["contact"]["status"], 0
        yield "way down the slope after 4 s (m)", 0.2460462066, math.hypot(*end(r, "block")), 1e-4
    yield Case("shaken_slope", "Newmark's sliding block on a slope of 20 degrees under a record", "Rigid block, friction 25 degrees.",
               "Newmark (1965); equation of motion integrated in steps of 5e-6 s", ROOT / "examples/shaken_slope/shaken_slope.toml", values)


def two_layers():
    path = ROOT / "examples/two_layer_beam/two_layer_beam.toml"
    for plane, exact, text in (("strain", 0.03971, "Galerkin with 56 elements a beam"), ("stress", 0.0423, "Galerkin with 38 elements a beam")):
        scene = tomllib.loads(path.read_text())
        scene["contact"]["plane"] = plane

        def values(r, exact=exact):
            yield "status", "converged", r.summary["contact"]["status"], 0
            yield "sag by another method (m)", exact, -end(r, "middle")[1], 5e-3
            yield "sag, slender beams (m); Fu (2014) has 0.041, 0.0414 and 0.0408", 0.041, -end(r, "middle")[1], 0.05
        yield Case(f"two_layer_beam_{plane}", f"Two beams one on the other, plane {plane}", "The upper one is thinner and pushes; no friction.",
                   f"Fu (2014), 7.5.3 (beams without shear); {text}", scene, values)


def goodman_bray():
    for name, stands, text in (("stands", True, "friction above the limit of 38.151 degrees"), ("falls", False, "friction below it"),
                               ("bolted", True, "weaker, with a bolt above the limit force of 2,012.9 kN/m")):
        def values(r, stands=stands):
            yield "status", "converged", r.summary["contact"]["status"], 0
            yield "stands", stands, r.summary["contact"]["max_displacement_m"] < 1e-6, 0
        yield Case(f"goodman_bray_{name}", f"Sixteen columns that topple: {text}", "Rigid blocks on steps.",
                   "Goodman and Bray (1976); Fu (2014), 7.5.5", ROOT / f"examples/goodman_bray/{name}.toml", values)


def roof_and_columns():
    def roof(r):
        yield "status", "converged", r.summary["contact"]["status"], 0
        for layer in range(1, 5):
            yield f"layer {layer} falls on the floor (m)", -4.0, end(r, f"layer {layer}")[1], 1e-3
        yield "layer 5 stays", True, end(r, "layer 5")[1] > -1e-3, 0
    yield Case("tunnel_roof", "Roof of five layers with open joints, friction 35 degrees", "The lower layers fall, the closed one is an arch.",
               "Fu (2014), 7.5.6", ROOT / "examples/tunnel_roof/tunnel_roof.toml", roof)

    def columns_of_a_slope(r):
        turned = {b["name"]: abs(b["rotation"]) for b in r.summary["contact"]["bodies"]}
        yield "status", "converged", r.summary["contact"]["status"], 0
        for k in (3, 7, 10):
            yield f"column {k} topples", True, turned[f"column {k}"] > 15, 0
        for k in (1, 2, 11, 12, 13, 14):
            yield f"column {k} stays upright", True, turned[f"column {k}"] < 1, 0
    yield Case("toppling_columns", "Fourteen columns on a slope", "Heights so that the third, seventh and tenth topple.",
               "Fu (2014), 7.5.5", ROOT / "examples/toppling_columns/toppling_columns.toml", columns_of_a_slope)


def cases():
    yield from sliding()
    yield from columns()
    yield from arches()
    yield from shaken()
    yield from two_layers()
    yield from goodman_bray()
    yield from roof_and_columns()
