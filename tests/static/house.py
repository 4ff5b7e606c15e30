#!/usr/bin/env python3
"""The house in order: `house.py ROOT` prints what is not, a line each, and fails.

- every include of a module is in its USES, every entry of its USES is included, and no arrow points up (lib/CMakeLists.txt
  gives the order); scenes in three dimensions, in two and field data do not include each other;
- docs/decisions: the index has every record, every record has the parts of the template;
- links between Markdown files lead somewhere, and prose has at most 120 columns;
- the version stands in one place;
- every header is public (HEADERS, installed) or shared between modules (SHARED), a public one includes no shared one, and
  each has a user outside its module;
- no module has more than 9 % of the lines of lib;
- a number with a unit has a type at the border: bare `double`s whose comment or name gives a unit are counted by module.
"""
import re
import sys
from pathlib import Path

root = Path(sys.argv[1])
wrong = []


# Each reads scenes of one problem; what a second one needs moves down into scene.
wings = {"scene3d", "scene2d", "field_data"}


def arrows():
    text = (root / "lib/CMakeLists.txt").read_text()
    order = re.search(r"foreach\(module ([^)]*)\)", text).group(1).split()
    for module in order:
        folder = root / "lib" / module
        listed = folder / "CMakeLists.txt"
        if not listed.exists():
            continue
        call = re.search(r"cleave_module\(%s\b(.*?)\)" % module, listed.read_text(), re.S)
        if not call:
            continue
        uses = re.search(r"\bUSES\b(.*?)(?:PACKAGES|HEADER_PACKAGES|$)", call.group(1), re.S)
        uses = set(uses.group(1).split()) if uses else set()
        included = {}
        for source in [*folder.rglob("*.hpp"), *folder.rglob("*.cpp")]:
            for other in re.findall(r'^#include "cleave/(\w+)/', source.read_text(), re.M):
                included.setdefault(other, source.relative_to(root))
        included.pop(module, None)
        for other, source in sorted(included.items()):
            if other not in uses:
                wrong.append(f"lib/{module}: {source} includes cleave/{other}, which is not in USES")
            if other in order and order.index(other) > order.index(module):
                wrong.append(f"lib/{module}: {source} includes cleave/{other}, against the arrows")
            if module in wings and other in wings:
                wrong.append(f"lib/{module}: {source} includes cleave/{other}, another wing")
        for other in sorted(uses - set(included)):
            wrong.append(f"lib/{module}: USES {other}, which nothing includes")


def decisions():
    folder = root / "docs/decisions"
    index = (folder / "README.md").read_text()
    for record in sorted(folder.glob("[0-9]*.md")):
        text = record.read_text()
        head = re.match(r"# (\d+)\. .+\n\nStatus: (accepted|replaced by)", text)
        if not head or int(head.group(1)) != int(record.name[:4]):
            wrong.append(f"{record.relative_to(root)}: no heading `# N. ...` and status as in record 1")
        if "\n## Decision\n" not in text:
            wrong.append(f"{record.relative_to(root)}: no part `## Decision`")
        if len(text.split()) < 95:
            wrong.append(f"{record.relative_to(root)}: a note of under 95 words belongs on the page of its module")
        if len(re.findall(rf"^\| \[\d+\]\({re.escape(record.name)}\) \|", index, re.M)) != 1:
            wrong.append(f"docs/decisions/README.md: {record.name} does not stand there once")


def links():
    for page in [root / "README.md", *sorted((root / "docs").rglob("*.md"))]:
        for target in re.findall(r"\]\(([^)#\s:]+)(?:#[^)]*)?\)", page.read_text()):
            if not (page.parent / target).exists():
                wrong.append(f"{page.relative_to(root)}: links to {target}, which is not there")


def lines():
    for page in [*sorted(root.glob("*.md")), *sorted((root / "docs").rglob("*.md"))]:
        code = False
        for number, line in enumerate(page.read_text().splitlines(), 1):
            if line.lstrip().startswith("```"):
                code = not code
            if len(line) > 120 and not code and not line.startswith(("|", "#", "![")):
                wrong.append(f"{page.relative_to(root)}:{number}: prose of {len(line)} columns, 120 at the most")


def version():
    header = "lib/core/include/cleave/core/version.hpp"
    number = re.search(r'CLEAVE_VERSION "([^"]*)"', (root / header).read_text()).group(1)
    for source in [*(root / "lib").rglob("*.hpp"), *(root / "lib").rglob("*.cpp"), *root.rglob("CMakeLists.txt")]:
        if "build" in source.relative_to(root).parts or str(source.relative_to(root)) == header:
            continue
        if number in source.read_text():
            wrong.append(f"{source.relative_to(root)}: names version {number}, which stands in {header}")


# Headers that no other module, program or example includes by name, and why they are not in src.
own_use = {
    "cleave/exchange/triangulate.hpp": "part of exchange/polygons.hpp",
    "cleave/scene/toml_tree.hpp": "part of scene/table_reader.hpp",
}
most_public = 70


def sizes():
    """No module is more than 9 % of the library: what is, is two."""
    kinds = {".hpp", ".cpp", ".js"}
    lines = {}
    for source in (root / "lib").rglob("*"):
        if source.suffix in kinds and source.is_file():
            module = source.relative_to(root).parts[1]
            lines[module] = lines.get(module, 0) + source.read_text().count("\n")
    for module, count in lines.items():
        if count > 0.09 * sum(lines.values()):
            wrong.append(f"lib/{module}: {count} lines are {100 * count / sum(lines.values()):.1f} % of lib, 9 at the most")


# Functions have at most so many lines, signature and braces included; what is split further may only get shorter.
longest_function = {"dbem": 60, "motion": 60, "scene2d": 180}
longest_elsewhere = 88


def functions(source):
    """(first line, lines) of each function, by the columns of clang-format: a block ends where its statement began."""
    blocks = []  # what is open: column where it ends, column of what is inside, first line, whether a function
    start = (0, "")
    for number, line in enumerate(source.read_text().splitlines(), 1):
        text = re.sub(r"\s*//.*", "", line.lstrip())
        column = len(line) - len(line.lstrip())
        if not text or text.startswith("#"):
            continue
        inside = blocks[-1][1] if blocks else 0
        if text.startswith("}"):
            while blocks and blocks[-1][0] > column:
                blocks.pop()
            if blocks and blocks[-1][0] == column:
                _, _, first, function = blocks.pop()
                if function and not any(other[3] for other in blocks):
                    yield first, number - first + 1
            inside = column
        elif column == inside:
            start = (number, text)
        if text.endswith("{"):
            scope = re.match(r"(template <.*> )?(namespace|struct|class|enum|union|extern)\b", start[1])
            own = 0 if start[1].startswith("namespace") else 2
            blocks.append((inside, inside + own, start[0], not scope))


def lengths():
    for module in sorted(path.name for path in (root / "lib").iterdir() if path.is_dir()):
        most = longest_function.get(module, longest_elsewhere)
        for source in [*(root / "lib" / module).rglob("*.hpp"), *(root / "lib" / module).rglob("*.cpp")]:
            for first, count in functions(source):
                if count > most:
                    wrong.append(f"{source.relative_to(root)}:{first}: a function of {count} lines, {most} at the most")


def headers():
    """Public headers by name, and the shared ones."""
    public, shared = {}, {}
    for module in sorted(path.name for path in (root / "lib").iterdir() if (path / "CMakeLists.txt").exists()):
        listed = (root / "lib" / module / "CMakeLists.txt").read_text()
        for kind, into in (("HEADERS", public), ("SHARED", shared)):
            block = re.search(rf"\b{kind}\s+((?:cleave/\S+\.hpp\s+)+)", listed)
            into.update({name: module for name in (block.group(1).split() if block else [])})
        include = root / "lib" / module / "include"
        for header in include.rglob("*.hpp"):
            name = str(header.relative_to(include))
            if name not in public and name not in shared:
                wrong.append(f"lib/{module}: {name} is neither in HEADERS nor in SHARED")
    return public, shared


def users():
    public, shared = headers()
    place = lambda name: root / "lib" / name.split("/")[1] / "include" / name
    used = {name: set() for name in [*public, *shared]}
    for top in ("lib", "examples", "python"):
        for source in (root / top).rglob("*.[ch]pp"):
            who = source.relative_to(root).parts[1] if top == "lib" else top
            for name in re.findall(r'^#include "(cleave/[^"]+)"', source.read_text(), re.M):
                used.get(name, set()).add(who)
    for name, module in {**public, **shared}.items():
        inside = re.findall(r'^#include "(cleave/[^"]+)"', place(name).read_text(), re.M)
        if name in public:
            wrong.extend(f"{name}: is public and includes {other}, which is not" for other in inside if other in shared)
        outside = used[name] - {module}
        if not outside and name not in own_use:
            wrong.append(f"{name}: nothing outside lib/{module} includes it: move it to lib/{module}/src")
        if outside and name in own_use:
            wrong.append(f"{name}: has users outside its module and needs no exception in own_use")
    wrong.extend(f"own_use names {name}, which is no header" for name in own_use if name not in used)
    if len(public) > most_public:
        wrong.append(f"{len(public)} public headers, {most_public} at the most: merge one or keep it in src")


# Bare doubles with a unit that stand in public headers, at the most; a count may only fall. Why they are there:
bare = {
    "assembly": 6,  # rows of a linear problem: lengths and forces of one system
    "bem": 25,  # values of kernels and of meshes, scaled to the problem inside; materials and conditions have types
    "core": 6,  # seconds and megabytes of what a run costs
    "dbem": 20,  # the same of contact: one system of units in a world
    "dfn": 2,  # shape of polygons of the MIT model
    "geometry": 7,  # sines of degrees; grids of heights
    "io": 7,  # what stands in a file, in the file's numbers
    "exchange": 1,  # a field of cells
    "field_data": 3,
    "realize": 13,  # figures of results, which are written with their unit in the name
    "scene": 11,  # costs of runs, and degrees that orientations are turned by
    "scene2d": 23,  # bodies and their results, in the units of the solvers
    "scene3d": 6,
    "stability": 24,  # support plans, kinds of bolts and their figures
    "stochastic": 15,  # records, which are written with their unit in the name
    "survey": 2,
    "topology": 5,  # figures of a cut, with the unit in the name
}
unit = r"(?:(?:m[234]?|mm|k?N|[kMG]?Pa|kg|s|Hz|J|rad|1)(?:/(?:m|s)[234]?)?|kg/m3|m/m2|rad/s|N m|per m|degrees|radians)"


def units():
    found = {}
    for header in sorted((root / "lib").glob("*/include/cleave/*/*.hpp")):
        for line in header.read_text().splitlines():
            code, _, comment = line.partition("//")
            if not re.search(r"\bdouble\b", code):
                continue
            said = re.match(rf"/?<?\s*(?:the\s+)?{unit}(?:[\s,;:.)]|$)", comment)
            named = re.search(r"\bdouble\s+\w+_(m|m2|m3|n|pa|s|deg|degrees|mb|radians)\b", code)
            if said or named:
                found.setdefault(header.relative_to(root).parts[1], []).append(f"{header.name}: {line.strip()}")
    for module in sorted({*found, *bare}):
        lines = found.get(module, [])
        if len(lines) > bare.get(module, 0):
            wrong.append(f"lib/{module}: {len(lines)} bare doubles with a unit, {bare.get(module, 0)} at the most; give the "
                         "new one a type of cleave/core/quantity.hpp:\n  " + "\n  ".join(lines))


arrows()
decisions()
links()
lines()
version()
sizes()
lengths()
users()
units()
print("\n".join(wrong))
sys.exit(1 if wrong else 0)
