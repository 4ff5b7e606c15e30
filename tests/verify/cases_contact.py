"""Blocks in contact: sliding, toppling, arches."""
import csv
import math
import tempfile
import tomllib
from pathlib import Path

import cleave

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
                   ROOT / f"examples/sliding_block/friction_{phi:02d}.toml", values, "7.5.2")
    for phi in (10, 20):
        a = math.radians(30)
        rate = G / 2 * (math.sin(a) - math.cos(a) * math.tan(math.radians(phi)))

        def elastic(r, rate=rate):
            yield "status", "converged", r.summary["contact"]["status"], 0
            time = r.summary["contact"]["end_time_s"]
            yield "way over the closed form's", 1.0, math.hypot(*r.summary["contact"]["points"][0]["displacement"]) / (rate * time**2), 5e-3
        yield Case(f"sliding_elastic_{phi}", f"Elastic block on a plane of 30 degrees, friction {phi} degrees", "Elastic block.",
                   "Fu (2014), 7.5.2; closed form of the rigid block", ROOT / f"examples/sliding_block/elastic_{phi}.toml", elastic, "7.5.2")


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
                   "Milankovitch (1907), Heyman (1982); critical ratios of finitely many voussoirs recomputed", path, values, "7.5.4")
    for ratio, stands in (("100", False), ("112", True)):
        def elastic(r, stands=stands):
            yield "stands", stands, abs(end(r, "crown")[1]) < 1e-3, 0
        yield Case(f"arch_12_{ratio}_elastic", f"Semicircular arch of 12 elastic voussoirs, thickness 0.{ratio}", "Six shapes a stone.",
                   "Fu (2014), 7.5.4", ROOT / f"examples/arch/arch_12_{ratio}_elastic.toml", elastic, "7.5.4")

    def damped(r):
        way = {t: at_time(r, "crown", t)[1] for t in (1.0, 2.25)}
        yield "hinges are seen at 1.0 s (crown down by 0.1 m or more)", True, way[1.0] < -0.1, 0
        yield "not yet down at 1.0 s", True, way[1.0] > -1.0, 0
        yield "down at 2.25 s (crown below the springings)", True, way[2.25] < -1.0, 0
    yield Case("arch_12_100_damped", "Semicircular arch of 12 voussoirs, damped", "Damping in proportion to mass, 10 1/s, gives the published times.",
               "Fu (2014), 7.5.4, times of figure 7-21", ROOT / "examples/arch/arch_12_100_damped.toml", damped, "7.5.4")


def end(result, name):
    return next(p for p in result.summary["contact"]["points"] if p["name"] == name)["displacement"]


def at_time(result, name, time):
    """Displacement of a point at the recorded time nearest to this one."""
    h = result.point_history
    mine = [k for k in range(len(h["time_s"])) if h["point"][k] == name]
    k = min(mine, key=lambda k: abs(h["time_s"][k] - time))
    return float(h["displacement_x_m"][k]), float(h["displacement_y_m"][k])


def concentrated():
    """Largest difference of the tip's motion from that under the traction, over its largest."""
    def moved(name):
        h = cleave.run(ROOT / f"examples/concentrated_forces/{name}.toml").point_history
        return dict(zip([float(t) for t in h["time_s"]], [float(x) for x in h["displacement_x_m"]]))
    for name, text, tolerance in (("middle", "one at 1 m, on the point itself", 0.04), ("outer", "two at 0.5 and 1.5 m", 0.01),
                                  ("inner", "two at 0.75 and 1.25 m", 0.01), ("off_middle", "one at 1.25 m", 0.01), ("three", "three", 0.01)):
        def values(_, name=name, tolerance=tolerance):
            whole, ours = moved("traction"), moved(name)
            most = max(abs(x) for x in whole.values())
            yield "largest difference from the traction over 0.3 s", 0.0, max(abs(ours[t] - whole[t]) for t in whole) / most, tolerance
        yield Case(f"concentrated_{name}", f"Concentrated forces: {text}", "The same resultant as point forces and as a traction.",
                   "Fu (2014), 7.5.1: all agree", ROOT / f"examples/concentrated_forces/{name}.toml", values, "7.5.1")


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
                   f"Fu (2014), 7.5.3 (beams without shear); {text}", scene, values, "7.5.3")

    def stresses(r):
        # The lower beam's share of the weight bends it: gamma L^2 / (4 t) in the middle; beams without shear.
        share = 9.81 * 2600 * 2.0**2 * 3.5 / (1.5**3 + 2.0**3)
        with tempfile.TemporaryDirectory() as folder:
            r.write(folder)
            with open(Path(folder) / "stress.csv", newline="", encoding="utf-8") as file:
                low = [s for s in csv.DictReader(file) if s["body"] == "thick" and float(s["y_m"]) < 0.5]
        s = min(low, key=lambda s: abs(float(s["x_m"]) - 18))
        yield "stress along x, middle of the lower beam's underside (Pa)", share * 36**2 / (4 * 2.0), float(s["stress_xx_pa"]), 0.03
        yield "stress along y there (Pa)", 0.0, float(s["stress_yy_pa"]), 1e5
    yield Case("two_layer_beam_contours", "Two beams one on the other: stress of the lower one", "Contours: figures 7-18 and 7-19.",
               "Fu (2014), 7.5.3, figures 7-18, 7-19; beams without shear", path, stresses, "7.5.3")


def goodman_bray():
    for name, stands, text in (("stands", True, "friction above the limit of 38.151 degrees"), ("falls", False, "friction below it"),
                               ("bolted", True, "weaker, with a bolt above the limit force of 2,012.9 kN/m")):
        def values(r, stands=stands):
            yield "status", "converged", r.summary["contact"]["status"], 0
            yield "stands", stands, r.summary["contact"]["max_displacement_m"] < 1e-6, 0
        yield Case(f"goodman_bray_{name}", f"Sixteen columns that topple: {text}", "Rigid blocks on steps.",
                   "Goodman and Bray (1976); Fu (2014), 7.5.5", ROOT / f"examples/goodman_bray/{name}.toml", values, "7.5.5")


def roof_and_columns():
    def roof(r):
        yield "status", "converged", r.summary["contact"]["status"], 0
        for layer in range(1, 5):
            yield f"layer {layer} falls on the floor (m)", -4.0, end(r, f"layer {layer}")[1], 1e-3
        yield "layer 5 stays", True, end(r, "layer 5")[1] > -1e-3, 0
    yield Case("tunnel_roof", "Roof of five layers with open joints, friction 35 degrees", "The lower layers fall, the closed one is an arch.",
               "Fu (2014), 7.5.6", ROOT / "examples/tunnel_roof/tunnel_roof.toml", roof, "7.5.6")

    def closed(r):
        yield "status", "converged", r.summary["contact"]["status"], 0
        for layer in (1, 5):
            yield f"layer {layer} stays up", True, -0.02 < end(r, f"layer {layer}")[1] < 0, 0
        up = -sum(b["contact_force"][1] for b in r.summary["contact"]["bodies"] if b["name"].endswith("abutment"))
        yield "weight borne by the abutments (N/m)", 5 * 18 * 2600 * 9.81, up, 1e-2
    yield Case("tunnel_roof_elastic", "Elastic roof of five layers with closed joints, friction 35 degrees", "An arch between the abutments.",
               "Fu (2014), 7.5.6: an arch forms, the roof is stable", ROOT / "examples/tunnel_roof/closed_elastic.toml", closed, "7.5.6")

    def columns_of_a_slope(r):
        turned = {b["name"]: abs(b["rotation"]) for b in r.summary["contact"]["bodies"]}
        yield "status", "converged", r.summary["contact"]["status"], 0
        for k in (3, 7, 10):
            yield f"column {k} topples", True, turned[f"column {k}"] > 15, 0
        for k in (1, 2, 11, 12, 13, 14):
            yield f"column {k} stays upright", True, turned[f"column {k}"] < 1, 0
    yield Case("toppling_columns", "Fourteen columns on a slope", "Heights so that the third, seventh and tenth topple.",
               "Fu (2014), 7.5.5", ROOT / "examples/toppling_columns/toppling_columns.toml", columns_of_a_slope, "7.5.5")

    def elastic_columns(r):
        for k in (3, 7, 10):
            yield f"top of column {k} is down by more than 1 m", True, end(r, f"top of {k}")[1] < -1, 0
    yield Case("toppling_columns_elastic", "Fourteen elastic columns on a slope", "Young's modulus 20 GPa, Poisson's ratio 0.25.",
               "Fu (2014), 7.5.5", ROOT / "examples/toppling_columns/toppling_columns_elastic.toml", elastic_columns, "7.5.5")

    def slow(r):
        yield "top of column 10 at 4 s, still leaning (down by less than 1 m)", True, at_time(r, "top of 10", 4)[1] > -1, 0
        yield "top of column 10 at 11 s, down by more than 2 m", True, at_time(r, "top of 10", 11)[1] < -2, 0
    yield Case("toppling_columns_damped", "Fourteen columns on a slope, damped", "Damping in proportion to mass, 10 1/s, gives the published times.",
               "Fu (2014), 7.5.5, times of figure 7-26", ROOT / "examples/toppling_columns/toppling_columns_damped.toml", slow, "7.5.5")


def cases():
    yield from sliding()
    yield from columns()
    yield from arches()
    yield from shaken()
    yield from concentrated()
    yield from two_layers()
    yield from goodman_bray()
    yield from roof_and_columns()
