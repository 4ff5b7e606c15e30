#!/usr/bin/python3
"""The six stages of the cutter as a drawing: cutter_stages.py > cutter_stages.svg"""
import math

W, H, GAP = 250, 190, 14
INK, GREY, JOINT = "#333", "#b8b8b8", ["#b5533c", "#2f6f8f", "#5a8a3a", "#8a5a9a"]
FILL = ["#e9c9bf", "#c3dbe6", "#cfe2c2", "#e0cfe6", "#efe2b8"]
out = []


def panel(k, title, note):
    x, y = GAP + (k % 3) * (W + GAP), GAP + (k // 3) * (H + 66)
    out.append(f'<g transform="translate({x},{y})">')
    out.append(f'<rect width="{W}" height="{H}" rx="6" fill="#fff" stroke="#ddd"/>')
    out.append(f'<text x="2" y="{H + 19}" font-size="14" font-weight="600">{k + 1}. {title}</text>')
    for i, line in enumerate(note):
        out.append(f'<text x="2" y="{H + 36 + 15 * i}" font-size="12" fill="#555">{line}</text>')


def end():
    out.append("</g>")


def line(a, b, colour=INK, width=2.0, dash=""):
    d = f' stroke-dasharray="{dash}"' if dash else ""
    out.append(f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" stroke="{colour}" stroke-width="{width}"{d}/>')


def dot(p, colour=INK, r=4.0):
    out.append(f'<circle cx="{p[0]:.1f}" cy="{p[1]:.1f}" r="{r}" fill="{colour}"/>')


def text(p, s, colour=INK, size=12, anchor="start"):
    out.append(f'<text x="{p[0]:.1f}" y="{p[1]:.1f}" font-size="{size}" fill="{colour}" text-anchor="{anchor}">{s}</text>')


def poly(points, fill, stroke="none"):
    out.append(f'<polygon points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in points)}" fill="{fill}" stroke="{stroke}" stroke-width="2"/>')


def meet(a, b):
    (x1, y1), (x2, y2), (x3, y3), (x4, y4) = *a, *b
    d = (x1 - x2) * (y3 - y4) - (y1 - y2) * (x3 - x4)
    t = ((x1 - x3) * (y3 - y4) - (y1 - y3) * (x3 - x4)) / d
    return x1 + t * (x2 - x1), y1 + t * (y2 - y1)


# What other joints leave in one joint's plane.
border = [(28, 22), (222, 22), (222, 168), (28, 168)]
traces = [((28, 60), (222, 96)), ((84, 22), (120, 168)), ((196, 22), (150, 168)), ((50, 124), (130, 146)), ((140, 40), (176, 44))]
x01, x02 = meet(traces[0], traces[1]), meet(traces[0], traces[2])
x13 = meet(traces[1], traces[3])

panel(0, "Prepare", ["corners to the lattice; a polygon is a plane", "and one edge plane a side"])
for i in range(16, W, 18):
    for j in range(14, H, 18):
        dot((i, j), "#d5d5d5", 1.4)
corners = [(52, 50), (178, 32), (214, 122), (106, 158)]
poly(corners, "#f3e3dc", JOINT[0])
for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1]):
    mx, my, l = (ax + bx) / 2, (ay + by) / 2, math.hypot(bx - ax, by - ay)
    nx, ny = (by - ay) / l, -(bx - ax) / l
    line((mx, my), (mx + 20 * nx, my + 20 * ny), JOINT[1], 1.5)
    dot((mx + 20 * nx, my + 20 * ny), JOINT[1], 2.5)
for c in corners:
    dot(c, JOINT[0])
end()

panel(1, "Traces", ["each other polygon leaves an interval", "of a line in this polygon's plane"])
poly(border, "#fbfbfb", GREY)
for k, (a, b) in enumerate(traces):
    line(a, b, JOINT[k % 4], 2.4)
end()

panel(2, "Vertices", ["where intervals cross: three planes,", "no coordinates"])
poly(border, "#fbfbfb", GREY)
for k, (a, b) in enumerate(traces):
    line(a, b, JOINT[k % 4], 1.4)
for p, name, shift in ((x01, "(this, a, b)", (8, -7)), (x02, "(this, a, c)", (-8, 18)), (x13, "(this, b, d)", (9, 2))):
    dot(p)
    text((p[0] + shift[0], p[1] + shift[1]), name, anchor="start" if shift[0] > 0 else "end", size=11)
for a, b in traces[:3]:
    dot(a, GREY, 3)
    dot(b, GREY, 3)
text((32, 74), "a", JOINT[0])
text((90, 36), "b", JOINT[1])
text((178, 36), "c", JOINT[2])
text((54, 120), "d", JOINT[3])
end()

panel(3, "Edges", ["between vertices in a row on a line; what", "dangles beyond the last is never made"])
poly(border, "#fbfbfb", GREY)
for a, b in traces[:3]:
    line(a, b, INK, 2)
for a, b in traces[3:]:
    line(a, b, GREY, 1.6, "5 4")
for p in (x01, x02):
    dot(p)
text((46, 118), "dangles", "#888", 11)
text((134, 34), "isolated", "#888", 11)
end()

panel(4, "Faces", ["loops of edges by exact directions;", "outer loops and holes by their turning"])
a, b, c = traces[:3]
regions = [
    [border[0], b[0], x01, a[0]],
    [b[0], c[0], x02, x01],
    [c[0], border[1], a[1], x02],
    [a[0], x01, b[1], border[3]],
    [x01, x02, c[1], b[1]],
    [x02, a[1], border[2], c[1]],
]
for k, region in enumerate(regions):
    poly(region, FILL[k % 5], "#fff")
hole = [(118, 112), (142, 116), (138, 136), (116, 132)]
poly(hole, "#fff", INK)
text((129, 128), "hole", "#555", 10, "middle")
end()

panel(5, "Cells and blocks", ["round an edge faces are in exact order;", "neighbours see the same cell"])
m, r = (125, 96), 78
angles = [12, 95, 160, 215, 300]
for k, (s, t) in enumerate(zip(angles, angles[1:] + [angles[0] + 360])):
    steps = [math.radians(s + (t - s) * i / 12) for i in range(13)]
    poly([m] + [(m[0] + r * math.cos(q), m[1] - r * math.sin(q)) for q in steps], FILL[k])
    q = math.radians((s + t) / 2)
    text((m[0] + 0.62 * r * math.cos(q), m[1] - 0.62 * r * math.sin(q) + 4), f"block {k + 1}", "#555", 11, "middle")
for k, s in enumerate(angles):
    q = math.radians(s)
    line(m, (m[0] + r * math.cos(q), m[1] - r * math.sin(q)), JOINT[k % 4], 2.4)
dot(m, INK, 5)
end()

width, height = 3 * W + 4 * GAP, 2 * (H + 66) + GAP
print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" fill="{INK}">')
print(f'<rect width="{width}" height="{height}" fill="#fafafa"/>')
print("\n".join(out))
print("</svg>")
