#!/usr/bin/env python3
"""Pictures of Fu's (2014) examples of chapters 6 and 7 for the documentation: contact_figures.py PROGRAM

Runs the examples and writes docs/images/fu_*.svg: outlines at some times, stress of the two-layer beam, histories of
points. Needs nothing beside the program.
"""
import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BLACK, BLUE, GREEN, GREY, RED = "#000", "#3b6ea5", "#2e7d32", "#9aa0a6", "#b00020"


def run(program, example, folder):
    subprocess.run([program, "run", ROOT / f"examples/{example}.toml", "-o", folder, "--quiet"], check=True)
    return Path(folder)


def arrays(vtu):
    """Arrays of an ASCII .vtu by name, as flat lists."""
    return {name: [float(v) for v in values.split()]
            for name, values in re.findall(r'<DataArray[^>]*Name="(\w+)"[^>]*>([^<]*)</DataArray>', vtu.read_text())}


def bodies(vtu):
    """Outline, displacement and stress along x of each body's corners, and whether it is fixed."""
    a = arrays(vtu)
    start, out = 0, []
    for cell, end in enumerate(a["offsets"]):
        if a["types"][cell] == 7:
            nodes = [int(n) for n in a["connectivity"][start:int(end)]]
            out.append(([(a["Points"][3 * n], a["Points"][3 * n + 1]) for n in nodes],
                        [(a["displacement"][3 * n], a["displacement"][3 * n + 1]) for n in nodes],
                        [[a["stress"][9 * n + c] for c in (0, 4)] if "stress" in a else None for n in nodes],
                        a["fixed"][cell] > 0))
        start = int(end)
    return out


def frame_at(folder, time):
    found = re.findall(r'timestep="([^"]+)"[^>]*file="([^"]+)"', (folder / "contact.pvd").read_text())
    return folder / min(found, key=lambda f: abs(float(f[0]) - time))[1]


class Sheet:
    def __init__(self, width, height):
        self.width, self.height, self.parts = width, height, []

    def add(self, text):
        self.parts.append(text)

    def text(self, x, y, text, size=12, anchor="start", shade="#000"):
        self.add(f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{shade}">{text}</text>')

    def line(self, points, colour, width=1.2):
        self.add(f'<polyline fill="none" stroke="{colour}" stroke-width="{width}" points="' +
                 " ".join(f"{x:.1f},{y:.1f}" for x, y in points) + '"/>')

    def write(self, name):
        (ROOT / f"docs/images/{name}.svg").write_text(
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" font-family="sans-serif">'
            f'<rect width="100%" height="100%" fill="#fff"/>' + "\n".join(self.parts) + "</svg>\n")


def panels(name, folder, times, window, columns, width=300):
    """Outlines at some times, side by side; window: x, y from, x, y to."""
    x0, y0, x1, y1 = window
    scale = width / (x1 - x0)
    height = (y1 - y0) * scale
    rows = -(-len(times) // columns)
    sheet = Sheet(columns * (width + 10), rows * (height + 30))
    for k, time in enumerate(times):
        left, top = (k % columns) * (width + 10), (k // columns) * (height + 30) + 22
        sheet.text(left + 4, top - 6, f"{time:g} s")
        sheet.add(f'<svg x="{left}" y="{top:.1f}" width="{width}" height="{height:.1f}">')
        for outline, _, _, fixed in bodies(frame_at(folder, time)):
            points = " ".join(f"{(x - x0) * scale:.1f},{(y1 - y) * scale:.1f}" for x, y in outline)
            sheet.add(f'<polygon points="{points}" fill="{"#d7dadd" if fixed else "#cfe0f1"}" stroke="#33414e" stroke-width=".6"/>')
        sheet.add("</svg>")
    sheet.write(name)


def colour(share):
    """Blue by white to red for -1 by 0 to 1."""
    share = max(-1.0, min(1.0, share))
    low = [59, 110, 165] if share < 0 else [176, 0, 32]
    return "#" + "".join(f"{round(255 + abs(share) * (c - 255)):02x}" for c in low)


def beam(folder):
    """Contours of the lower beam's stress, between its upper and lower side as a straight line."""
    outline, moved, stress, _ = max(bodies(sorted(folder.glob("contact_*.vtu"))[-1]), key=lambda b: max(y for _, y in b[0]) < 2.5)
    start = [(x - u, y - v) for (x, y), (u, v) in zip(outline, moved)]
    upper = sorted((p[0], s) for p, s in zip(start, stress) if p[1] > 1.99)
    lower = sorted((p[0], s) for p, s in zip(start, stress) if p[1] < 0.01)
    sheet = Sheet(740, 230)
    for row, (component, title) in enumerate(((0, "stress along x"), (1, "stress along y"))):
        most = max(abs(s[component]) for _, s in upper + lower)
        top = 30 + row * 110
        sheet.text(10, top - 8, f"{title}: from -{most / 1e6:.1f} (blue) to {most / 1e6:.1f} MPa (red), lower beam, a straight line between its two sides")
        for k in range(min(len(upper), len(lower)) - 1):
            for level in range(12):
                t = (level + 0.5) / 12
                value = (1 - t) * (upper[k][1][component] + upper[k + 1][1][component]) / 2 + t * (lower[k][1][component] + lower[k + 1][1][component]) / 2
                sheet.add(f'<rect x="{10 + 20 * upper[k][0]:.1f}" y="{top + level * 5}" width="{20 * (upper[k + 1][0] - upper[k][0]) + .5:.1f}" height="5.3" fill="{colour(value / most)}"/>')
    sheet.write("fu_beam")


def curves(name, graphs):
    """graphs: title, unit, list of (label, colour, [(t, value)])."""
    sheet = Sheet(330 * len(graphs), 240)
    for k, (title, unit, lines) in enumerate(graphs):
        left = 330 * k + 60
        ts = [t for _, _, line in lines for t, _ in line]
        vs = [v for _, _, line in lines for _, v in line] + [0.0]
        low, high, end = min(vs), max(vs), max(ts)

        def place(t, v, left=left, low=low, high=high, end=end):
            return left + 210 * t / end, 200 - 160 * (v - low) / ((high - low) or 1)
        sheet.line([place(0, low), place(end, low)], GREY)
        sheet.line([place(0, low), place(0, high)], GREY)
        sheet.text(left, 24, title)
        sheet.text(left - 4, place(0, high)[1] + 4, f"{high:.3g}", 10, "end")
        sheet.text(left - 4, place(0, low)[1] + 4, f"{low:.3g}", 10, "end")
        sheet.text(left + 210, 216, f"{end:g} s", 10, "end")
        sheet.text(left, 232, unit, 10)
        for _, shade, line in lines:
            sheet.line([place(t, v) for t, v in line[::max(1, len(line) // 300)]], shade)
        # Names at the ends of the lines, none on another.
        below = 0.0
        for y, label, shade in sorted((place(*line[-1])[1] + 4, label, shade) for label, shade, line in lines):
            below = max(y, below + 12)
            sheet.text(left + 214, below, label, 10, shade=shade)
    sheet.write(name)


def history(folder, point, column):
    with open(folder / "points.csv", newline="", encoding="utf-8") as file:
        return [(float(r["time_s"]), float(r[column])) for r in csv.DictReader(file) if r["point"] == point]


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as work:
        def of(example):
            return run(program, example, f"{work}/{example.replace('/', '_')}")
        panels("fu_arch", of("arch/arch_12_100_damped"), (0, 1, 1.95, 2.25), (-1.3, -1.2, 1.3, 1.2), 4, 180)
        panels("fu_columns", of("toppling_columns/toppling_columns_damped"), (0, 4, 6, 7.4, 9, 11), (-4, -2, 16, 14), 3, 240)
        panels("fu_roof", of("tunnel_roof/tunnel_roof"), (0, 0.6, 2), (-11.5, -1.5, 11.5, 9.5), 3, 240)
        beam(of("two_layer_beam/two_layer_beam"))
        roof = of("tunnel_roof/closed_elastic")
        slides = [(f"{phi} degrees", shade, [(t, abs(x) / 0.8660254) for t, x in history(folder, "block", "displacement_x_m")])
                  for phi, shade in ((0, BLUE), (10, RED), (20, GREEN)) for folder in [of(f"sliding_block/friction_{phi:02d}")]]
        forces = [("traction", BLACK, history(of("concentrated_forces/traction"), "A", "displacement_x_m"))]
        forces += [(name, shade, history(of(f"concentrated_forces/{name}"), "A", "displacement_x_m"))
                   for name, shade in (("outer", BLUE), ("inner", RED), ("three", GREEN))]
        curves("fu_curves_7", [("7.5.1 forces for a traction", "tip (m)", forces), ("7.5.2 block on 30 degrees", "way (m)", slides),
                               ("7.5.6 elastic roof", "sag of layers 1 and 5 (m)",
                                [(f"layer {n}", BLUE if n == 1 else RED, history(roof, f"layer {n}", "displacement_y_m")) for n in (1, 5)])])
        curves("fu_curves_6", [("6.6.1 free fall", "top (m)", [("", BLUE, history(of("bem/free_fall"), "top", "displacement_y_m"))]),
                               ("6.6.2 cantilever, impulse", "A (m)", [("", BLUE, history(of("bem/cantilever"), "A", "displacement_x_m"))]),
                               ("6.6.3 bar, sudden load", "top (m)", [("", BLUE, history(of("bem/bar"), "top", "displacement_y_m"))])])


if __name__ == "__main__":
    main()
