#!/usr/bin/env python3
"""The verification manual: published and closed-form answers beside ours. `verify.py -o FOLDER [FILTER]`.

Writes verify.csv (case,quantity,published,ours,difference,tolerance,ok,source), index.html, a page a case with its
input, and chapters_6_7.md: the examples of those chapters of Fu (2014) in one table. Exit code 4 when a row is not ok. Needs the Python module of cleave (PYTHONPATH).
"""
import argparse
import csv
import html
import sys
import time
from pathlib import Path

import cleave

import cases_blocks
import cases_contact
import cases_elastic
import cases_flow
import cases_key_blocks
from case import ROOT

STYLE = """body{font:16px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;padding:0 1rem;color:#1c1e21;background:#fff}
table{border-collapse:collapse;width:100%;font-size:.9rem}th,td{text-align:left;padding:.25rem .6rem;border-bottom:1px solid #d7dadd}
td.n{text-align:right;font-variant-numeric:tabular-nums}pre{background:#f3f4f6;padding:.8rem;overflow:auto}.no{color:#b00020;font-weight:700}
.scroll{overflow-x:auto}@media(prefers-color-scheme:dark){body{color:#e4e6e9;background:#17191c}pre{background:#22252a}th,td{border-color:#3a3e44}a{color:#8ab4f8}}
@media print{a{color:inherit;text-decoration:none}}"""


def shown(value):
    return f"{value:.12g}" if isinstance(value, float) else str(value)


def judged(row):
    """Difference and whether it is within the tolerance; numbers relative to the published one where that is not 0."""
    quantity, published, ours, tolerance = row
    if isinstance(published, str) or isinstance(published, bool):
        return ("" if published == ours else "differs"), published == ours
    if ours is None:
        return "no value", False
    difference = float(ours) - float(published)
    relative = difference / abs(published) if published else difference
    return relative, abs(relative) <= tolerance


def page(title, body):
    return (f'<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
            f"<title>{html.escape(title)}</title><style>{STYLE}</style><h1>{html.escape(title)}</h1>{body}</html>\n")


def table(rows, link=False):
    head = "<tr><th>case</th>" if link else "<tr>"
    text = head + "<th>quantity</th><th>published</th><th>ours</th><th>difference</th><th>tolerance</th><th></th></tr>"
    for name, (quantity, published, ours, tolerance), difference, ok in rows:
        cell = f'<td><a href="cases/{name}.html">{name}</a></td>' if link else ""
        text += (f'<tr>{cell}<td>{html.escape(quantity)}</td><td class="n">{html.escape(shown(published))}</td>'
                 f'<td class="n">{html.escape(shown(ours))}</td><td class="n">{difference if isinstance(difference, str) else f"{difference:.1e}"}</td>'
                 f'<td class="n">{tolerance:g}</td><td class="{"" if ok else "no"}">{"ok" if ok else "not ok"}</td></tr>')
    return f'<div class="scroll"><table>{text}</table></div>'


SECTIONS = {"6.6.1": "Free fall", "6.6.2": "Cantilever under an impulse", "6.6.3": "Bar under a sudden load",
            "7.5.1": "Concentrated forces", "7.5.2": "Block on an incline", "7.5.3": "Two-layer roof beam", "7.5.4": "Masonry arch",
            "7.5.5": "Toppling", "7.5.6": "Tunnel roof in layered rock"}


def table_of_chapters(rows):
    """Chapters 6 and 7 of Fu (2014) in one table of Markdown, example by example."""
    text = "| section | example | quantity | published | ours | difference |\n|---|---|---|---|---|---|\n"

    def short(value):
        return f"{value:.5g}" if isinstance(value, float) else {True: "yes", False: "no"}.get(value, str(value)) if isinstance(value, bool) else str(value)
    for section, title in SECTIONS.items():
        for case, _, (quantity, published, ours, _), difference, ok in rows:
            if case.section != section or (ok and quantity == "status"):
                continue
            example = case.scene.relative_to(ROOT) if isinstance(case.scene, Path) else case.name
            shown_difference = difference if isinstance(difference, str) else f"{difference:.1e}"
            text += (f"| {section} {title} | {example} | {quantity} | {short(published)} | {short(ours)} | "
                     f"{shown_difference}{'' if ok else ' (not ok)'} |\n")
    return text


def scene_text(scene):
    return cleave.dumps(scene) if isinstance(scene, dict) else Path(scene).read_text()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--out", required=True, type=Path)
    parser.add_argument("filter", nargs="?", default="", help="only cases with this in their name; or \"chapters\": those of 6 and 7")
    arguments = parser.parse_args()
    (arguments.out / "cases").mkdir(parents=True, exist_ok=True)
    all_rows, chapters, names = [], [], set()
    for module in (cases_blocks, cases_key_blocks, cases_flow, cases_elastic, cases_contact):
        start, chapter = time.monotonic(), []
        for case in module.cases():
            if not (case.section if arguments.filter == "chapters" else arguments.filter in case.name):
                continue
            if case.name in names:
                sys.exit(f"two cases are named {case.name}")
            names.add(case.name)
            rows = []
            for row in case.rows():
                difference, ok = judged(row)
                rows.append((case.name, row, difference, ok))
                if not ok:
                    print(f"not ok: {case.name}: {row[0]}: published {shown(row[1])}, ours {shown(row[2])}", file=sys.stderr)
            chapter += rows
            all_rows += [(case, *r) for r in rows]
            text = f"<p>{html.escape(case.text)}</p><p>Source: {html.escape(case.source)}</p>{table(rows)}"
            text += f"<h2>Input</h2><pre>{html.escape(scene_text(case.scene))}</pre>" if case.scene else ""
            (arguments.out / "cases" / f"{case.name}.html").write_text(page(case.title, text + '<p><a href="../index.html">all cases</a></p>'))
        if chapter:
            chapters.append(f"<h2>{html.escape(module.CHAPTER)}</h2>{table(chapter, link=True)}")
        print(f"{module.CHAPTER}: {len(chapter)} values, {time.monotonic() - start:.1f} s", file=sys.stderr)
    with open(arguments.out / "verify.csv", "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow("case quantity published ours difference tolerance ok source".split())
        for case, _, (quantity, published, ours, tolerance), difference, ok in all_rows:
            out.writerow([case.name, quantity, shown(published), shown(ours),
                          difference if isinstance(difference, str) else f"{difference:.3e}", f"{tolerance:g}", int(ok), case.source])
    (arguments.out / "chapters_6_7.md").write_text(table_of_chapters(all_rows), encoding="utf-8")
    wrong = sum(not row[-1] for row in all_rows)
    said = (f"<p>cleave {cleave.__version__}: {len(names)} cases, {len(all_rows)} values, {wrong} outside their tolerance. Differences are "
            "relative to the published value, or absolute where that is 0. Made by <code>./x verify</code>.</p>")
    (arguments.out / "index.html").write_text(page("Verification of cleave", said + "".join(chapters)))
    print(f"{len(names)} cases, {len(all_rows)} values, {wrong} outside their tolerance: {arguments.out / 'index.html'}")
    return 4 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
