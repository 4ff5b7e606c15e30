#!/usr/bin/env python3
"""Every test that a page of docs/theory names exists.

    tests/theory.py [FOLDER]     reads the section "Tests" of each page of FOLDER (docs/theory); runs nothing

A name stands in backticks, as `Suite.Test` or `Suite.*`. A page without such a section fails, but for index.md.
"""
import re
import sys
from pathlib import Path

from named_tests import named_tests

ROOT = Path(__file__).resolve().parent.parent


def lost_names(text: str, names: set[str]) -> list[str]:
    """What the section "Tests" names and no test has; None named counts as lost."""
    section = re.search(r"^## Tests$(.*?)(?=^## |\Z)", text, re.M | re.S)
    named = re.findall(r"`([^`]+)`", section.group(1)) if section else []
    if not named:
        return ["(no test named under \"## Tests\")"]
    return [name for name in named
            if not (name in names or (name.endswith(".*") and any(other.startswith(name[:-1]) for other in names)))]


def main() -> int:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "theory"
    pages = [page for page in sorted(folder.glob("*.md")) if page.name != "index.md"]
    names = named_tests(ROOT)
    lost = [(page, name) for page in pages for name in lost_names(page.read_text(), names)]
    for page, name in lost:
        print(f"{page.name} names a test that is not there: {name}", file=sys.stderr)
    if not pages:
        print(f"no page in {folder}", file=sys.stderr)
    return 1 if lost or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
