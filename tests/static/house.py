#!/usr/bin/env python3
"""The house in order: `house.py ROOT` prints what is not, a line each, and fails.

- every include of a module is in its USES, every entry of its USES is included, and no arrow points up (lib/CMakeLists.txt
  gives the order);
- docs/decisions: the index has every record, every record has the parts of the template;
- links between Markdown files lead somewhere, and prose has at most 120 columns;
- the version stands in one place.
"""
import re
import sys
from pathlib import Path

root = Path(sys.argv[1])
wrong = []


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
        uses = re.search(r"\bUSES\b(.*?)(?:PACKAGES|PRIVATE_PACKAGES|$)", call.group(1), re.S)
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


arrows()
decisions()
links()
lines()
version()
print("\n".join(wrong))
sys.exit(1 if wrong else 0)
