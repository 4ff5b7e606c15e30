"""Water in the joints: Darcy's law, joints side by side and in a row, the capacitance of the square line, Thiem."""
import math

from case import Case, box, plane

CHAPTER = "Water in the joints"
CUBIC = 9.81 / (12 * 1.004e-6)


def sides(**levels):
    return [{"face": face, "level": level} for face, level in levels.items()]


def out(result, name):
    return next(s for s in result.summary["flow"]["surfaces"] if s["name"] == name)["out_m3_s"]


def level(z, **more):
    return plane([2, 2, z], 0, 0, **more)


def darcy():
    scene = {"domain": box([4, 3, 2]), "joint": [level(1)], "joints": {"default": {"aperture": 1e-3}},
             "flow": {"side": sides(west=10, east=4)}}

    def values(r):
        yield "through the joint (m3/s)", CUBIC * 1e-9 * 3 * (10 - 4) / 4, out(r, "east"), 1e-12
        yield "status", "converged", r.summary["flow"]["status"], 0
    return Case("darcy", "One joint between two levels", "3 m wide, 4 m long, 1 mm wide open, heads 10 and 4 m.", "Cubic law; closed form",
                scene, values)


def side_by_side():
    scene = {"domain": box([4, 3, 2]), "joint": [level(0.5, set="A"), level(1.5, set="B"), normal_across()],
             "joints": {"default": {"aperture": 1e-3}, "B": {"aperture": 2e-3}}, "flow": {"side": sides(west=10, east=4)}}

    def values(r):
        yield "through both (m3/s)", CUBIC * (1e-9 + 8e-9) * 3 * 6 / 4, out(r, "east"), 1e-12
    return Case("parallel_joints", "Joints side by side, and one across", "Conductances add up; the joint across the flow changes nothing.",
                "Cubic law; closed form", scene, values)


def normal_across():
    return plane([2, 2, 1], 90, 90)


def in_a_row():
    scene = {"domain": box([4, 3, 2]),
             "joint": [{"polygon": [[0, 0, 1.5], [2, 0, 1.5], [2, 3, 1.5], [0, 3, 1.5]], "set": "A"},
                       {"polygon": [[2, 0, 0.5], [2, 3, 0.5], [2, 3, 1.5], [2, 0, 1.5]], "set": "B"},
                       {"polygon": [[2, 0, 0.5], [4, 0, 0.5], [4, 3, 0.5], [2, 3, 0.5]], "set": "C"}],
             "joints": {"A": {"aperture": 1e-3}, "B": {"aperture": 5e-4}, "C": {"aperture": 2e-3}},
             "flow": {"side": sides(west=10, east=4)}}

    def values(r):
        resistance = 2 / 1e-9 + 1 / 1.25e-10 + 2 / 8e-9
        yield "through all (m3/s)", CUBIC * 3 * 6 / resistance, out(r, "east"), 1e-9
    return Case("joints_in_a_row", "Three joints in a row", "Two level ones joined by an upright one: resistances add up.",
                "Cubic law; closed form", scene, values)


def square_line():
    scene = {"domain": box([4, 4, 2]), "joint": [level(1)], "joints": {"default": {"aperture": 1e-3}},
             "excavation": [{"kind": "polyhedron", "box": {"min": [1, 1, 0.5], "max": [3, 3, 1.5]}, "name": "chamber"}],
             "flow": {"tolerance": 0.002, "side": sides(west=7, east=7, south=7, north=7)}}

    def values(r):
        flow, exact = r.summary["flow"], 10.234092569 * CUBIC * 1e-9 * (7 - 1)
        yield "inflow (m3/s)", exact, flow["inflow_m3_s"], 0.002
        yield "the bounds hold it", True, flow["inflow_low_m3_s"] <= exact <= flow["inflow_high_m3_s"], 0
    return Case("square_line", "A square chamber in a square",
                "Sides 2 and 4 m, heads 1 and 7 m: the capacitance of the square coaxial line of ratio 2 (36.81 ohm).",
                "Capacitance of concentric squares, 10.2341 per unit length", scene, values)


def thiem():
    def ring(r):
        return {"shape": "circle", "diameter": 2 * r}
    scene = {"domain": box([32, 32, 2], [0, 0, 0]), "joint": [plane([0, 0, 0], 0, 0)], "joints": {"default": {"aperture": 1e-3}},
             "excavation": [{"kind": "tunnel", "section": ring(0.5), "axis": [[0, 0, -0.5], [0, 0, 0.5]], "up": [0, 1, 0], "name": "borehole"}],
             "flow": {"tolerance": 0.002, "side": sides(west=5, east=5, south=5, north=5)}}

    def values(r):
        # Far from it the square is a circle of 1.0787 times its half side (its conformal radius).
        yield "inflow (m3/s)", 2 * math.pi * CUBIC * 1e-9 * 5 / math.log(1.0787 * 16 / 0.5), r.summary["flow"]["inflow_m3_s"], 0.004
    return Case("thiem", "A borehole in a square", "Diameter 1 m in a square of 32 m, heads 0 and 5 m.",
                "Thiem (1906), with the conformal radius of the square", scene, values)


def cases():
    yield darcy()
    yield side_by_side()
    yield in_a_row()
    yield square_line()
    yield thiem()
