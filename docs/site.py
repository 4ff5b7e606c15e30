#!/usr/bin/env python3
"""The site of cleave: every page of docs, the gallery of examples, and nothing from the network.

    site.py -o FOLDER [--program CLEAVE [--seconds N]] [--api]

Markdown is rendered by cmark-gfm. With a program every scene under examples is run (each at most N seconds) and the
gallery shows its figures and links its report; without, it only lists the scenes. With --api Doxygen makes the
reference of the library. Ends with 1 when a link leads nowhere, or Doxygen finds a comment that is wrong.
"""
import argparse
import html
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import api

ROOT = Path(__file__).resolve().parents[1]
CHAPTERS = [
    ("Start", ["README.md", "docs/tutorial.md", "docs/coming_from.md", "docs/glossary.md", "docs/python.md", "docs/library.md"]),
    ("Scenes and results", ["docs/scene.md", "docs/results.md", "docs/geometry.md", "docs/formats.md"]),
    ("Methods", ["docs/cutter.md", "docs/stability.md", "docs/survey.md", "docs/monte_carlo.md", "docs/bem.md", "docs/contact.md", "docs/theory/index.md"]),
    ("How far to trust it", ["docs/guarantees.md", "docs/degenerate-counts.md", "docs/monte_carlo_results.md"]),
    ("For developers", ["docs/contributing.md", "docs/decisions/README.md", "CHANGELOG.md"]),
]
STYLE = """:root{--ink:#1c1e21;--soft:#5c6470;--line:#d9dde2;--back:#fff;--code:#f4f5f7;--link:#0b57a4}
@media(prefers-color-scheme:dark){:root{--ink:#e4e6e9;--soft:#9aa3ad;--line:#3a3e44;--back:#17191c;--code:#22252a;--link:#8ab4f8}}
*{box-sizing:border-box}body{margin:0;font:16px/1.6 system-ui,sans-serif;color:var(--ink);background:var(--back)}
a{color:var(--link)}.page{display:grid;grid-template-columns:15rem minmax(0,1fr);max-width:78rem;margin:0 auto}
nav{padding:1.5rem 1rem;border-right:1px solid var(--line);font-size:.92rem}nav b{display:block;margin:.9rem 0 .2rem;color:var(--soft);font-weight:600}
nav a{display:block;padding:.1rem 0;text-decoration:none}nav a.here{font-weight:700;color:var(--ink)}
main{padding:1.5rem 2rem;min-width:0}h1{line-height:1.2}h2{margin-top:2.2rem;border-bottom:1px solid var(--line);padding-bottom:.2rem}
code{background:var(--code);padding:.1em .3em;border-radius:3px;font-size:.9em}pre{background:var(--code);padding:.8rem 1rem;overflow-x:auto;border-radius:4px}
pre code{padding:0;background:none}.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.92rem}th,td{text-align:left;vertical-align:top;
padding:.3rem .7rem;border-bottom:1px solid var(--line)}img{max-width:100%}.cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(17rem,1fr));gap:1rem}
.card{border:1px solid var(--line);border-radius:6px;padding:.8rem 1rem}.card h3{margin:.1rem 0 .4rem}.card p{margin:.2rem 0;font-size:.92rem}.soft{color:var(--soft)}
@media(max-width:760px){.page{display:block}nav{border-right:0;border-bottom:1px solid var(--line);columns:2}main{padding:1rem}}
@media print{nav{display:none}.page{display:block}}"""


def place(source: Path) -> Path:
    """Where a page of the tree stands on the site."""
    relative = source.relative_to(ROOT)
    if relative == Path("README.md"):
        return Path("index.html")
    parts = relative.parts[1:] if relative.parts[0] == "docs" else relative.parts
    target = Path(*parts)
    if target.suffix == ".md":
        target = target.with_suffix(".html")
        if target.name == "README.html":
            target = target.with_name("index.html")
    return target


def pages() -> list[Path]:
    return [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]


def title_of(source: Path) -> str:
    heading = re.search(r"^# (.+)$", source.read_text(), re.M)
    return re.sub(r"[`*]", "", heading.group(1)) if heading else source.stem


def slug(text: str, seen: dict) -> str:
    """Anchors as the usual hosts of Markdown make them."""
    name = re.sub(r"[^\w\- ]", "", html.unescape(re.sub(r"<[^>]+>", "", text)).lower()).replace(" ", "-")
    count = seen.get(name, 0)
    seen[name] = count + 1
    return name if count == 0 else f"{name}-{count}"


def up(target: Path) -> str:
    return "../" * (len(target.parts) - 1)


with_api = False


def navigation(target: Path) -> str:
    text = ""
    for chapter, sources in CHAPTERS:
        text += f"<b>{chapter}</b>"
        for source in sources:
            to = place(ROOT / source)
            label = "cleave" if source == "README.md" else title_of(ROOT / source)
            here = ' class="here"' if to == target else ""
            text += f'<a href="{up(target)}{to}"{here}>{html.escape(label)}</a>'
        if chapter == "Start":
            here = ' class="here"' if target == Path("gallery.html") else ""
            text += f'<a href="{up(target)}gallery.html"{here}>Gallery of examples</a>'
            if with_api:
                text += f'<a href="{up(target)}api/index.html">API reference</a>'
    return text


def page(target: Path, title: str, body: str) -> str:
    return (f'<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width,initial-scale=1">'
            f'<title>{html.escape(title)}</title><link rel="stylesheet" href="{up(target)}site.css"></head><body><div class="page">'
            f"<nav>{navigation(target)}</nav><main>{body}</main></div></body></html>\n")


def render(source: Path) -> str:
    raw = subprocess.run(["cmark-gfm", "--unsafe", "-e", "table", "-e", "autolink", "-e", "strikethrough", str(source)],
                         check=True, capture_output=True, text=True).stdout
    seen: dict = {}
    raw = re.sub(r"<h([1-6])>(.*?)</h\1>", lambda m: f'<h{m[1]} id="{slug(m[2], seen)}">{m[2]}</h{m[1]}>', raw, flags=re.S)
    raw = re.sub(r"<table>.*?</table>", lambda m: f'<div class="wide">{m[0]}</div>', raw, flags=re.S)
    target = place(source)

    def moved(match):
        name, link = match[1], html.unescape(match[2])
        if re.match(r"[a-z]+:", link) or link.startswith("#"):
            return match[0]
        path, _, anchor = link.partition("#")
        to = (source.parent / unquote(path)).resolve()
        if not to.exists() or ROOT not in to.parents:
            return f'{name}="MISSING:{html.escape(link)}"'
        if to.is_dir():
            to = to / "README.md" if (to / "README.md").exists() else to
        if to.suffix != ".md":
            assets.add(to)
        return f'{name}="{up(target)}{place(to)}{"#" + anchor if anchor else ""}"'
    return re.sub(r'\b(href|src)="([^"]*)"', moved, raw)


assets: set[Path] = set()


def about(scene: Path) -> tuple[str, str]:
    """Title and the first sentences of the comment at the head of a scene."""
    text = scene.read_text()
    title = re.search(r'^title = "(.*)"', text, re.M)
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.lstrip("# "))
    said = " ".join(lines).strip()
    return (title.group(1) if title else scene.stem), " ".join(re.split(r"(?<=[.!?]) ", said)[:2])


def figures(summary: dict) -> str:
    parts = []
    if "blocks" in summary:
        parts.append(f'{summary["blocks"]["count"]:,} blocks')
    if "key_blocks" in summary:
        parts.append(f'{summary["key_blocks"]["count"]:,} key blocks')
    if "monte_carlo" in summary:
        parts.append(f'{summary["monte_carlo"]["realizations"]:,} realizations')
    for kind in ("elastic", "contact"):
        if kind in summary:
            parts.append(f'{len(summary[kind]["bodies"])} bodies, {summary[kind]["status"]}')
    parts.append(f'{summary["cost"]["wall_s"]:.2g} s')
    return ", ".join(parts)


def gallery(out: Path, program: str | None, seconds: float) -> str:
    cards = ""
    for scene in sorted((ROOT / "examples").glob("*/*.toml")):
        title, said = about(scene)
        relative = scene.relative_to(ROOT)
        name = f"{scene.parent.name}-{scene.stem}" if scene.stem != scene.parent.name else scene.stem
        card = f"<h3>{html.escape(title)}</h3><p>{html.escape(said)}</p>"
        if program:
            folder = out / "gallery" / name
            try:
                done = subprocess.run([program, "run", str(scene), "-o", str(folder), "--quiet"], timeout=seconds, capture_output=True, text=True)
                kind = f"exit code {done.returncode}"
            except subprocess.TimeoutExpired:
                kind = f"not done in {seconds:g} s"
            summary = folder / "summary.json"
            if summary.exists():
                card += f'<p class="soft">{figures(json.loads(summary.read_text()))}</p>'
                if (folder / "report.html").exists():
                    card += f'<p><a href="gallery/{name}/report.html">report</a></p>'
                for extra in folder.iterdir():
                    if extra.name not in ("report.html", "summary.json"):
                        shutil.rmtree(extra) if extra.is_dir() else extra.unlink()
            else:
                card += f'<p class="soft">{kind}</p>'
        target = out / "gallery" / "scenes" / f"{name}.toml"
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(scene, target)
        card += f'<p><a href="gallery/scenes/{name}.toml">{html.escape(str(relative))}</a></p>'
        cards += f'<div class="card">{card}</div>'
    return f'<h1>Gallery of examples</h1><p>Each scene is a file under <code>examples</code>; <code>./x cleave run FILE -o out</code> runs it.</p><div class="cards">{cards}</div>'


def broken(out: Path) -> list[str]:
    """Links of the site that lead nowhere, and anchors that are not there."""
    wrong, anchors = [], {}
    for source in out.rglob("*.html"):
        if {"gallery", "api"} & set(source.relative_to(out).parts[:-1]):
            continue  # reports and the reference: whole by themselves
        anchors[source] = set(re.findall(r'\bid="([^"]*)"', source.read_text()))
    for source in anchors:
        for link in re.findall(r'\b(?:href|src)="([^"]*)"', source.read_text()):
            link = html.unescape(link)
            if link.startswith("MISSING:"):
                wrong.append(f"{source.relative_to(out)}: {link[8:]} is not in the tree")
            elif not re.match(r"[a-z]+:", link):
                path, _, anchor = link.partition("#")
                to = (source.parent / unquote(path)).resolve() if path else source
                if to.is_dir():
                    continue
                if not to.exists():
                    wrong.append(f"{source.relative_to(out)}: {link} leads nowhere")
                elif anchor and to in anchors and anchor not in anchors[to]:
                    wrong.append(f"{source.relative_to(out)}: {link}: no such heading")
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--program")
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--api", action="store_true")
    arguments = parser.parse_args()
    global with_api
    with_api = arguments.api
    out = arguments.out.resolve()
    if out.exists():
        if not (out / "site.css").exists() and any(out.iterdir()):
            print(f"{out} is not a site of ours: name a new folder", file=sys.stderr)
            return 2
        shutil.rmtree(out)
    out.mkdir(parents=True)
    (out / "site.css").write_text(STYLE)
    for source in pages():
        target = place(source)
        (out / target).parent.mkdir(parents=True, exist_ok=True)
        (out / target).write_text(page(target, f"{title_of(source)} - cleave", render(source)))
    (out / "gallery.html").write_text(page(Path("gallery.html"), "Gallery - cleave", gallery(out, arguments.program, arguments.seconds)))
    for asset in sorted(assets):
        target = out / place(asset)
        target.parent.mkdir(parents=True, exist_ok=True)
        if asset.is_dir():
            shutil.copytree(asset, target, dirs_exist_ok=True)
        else:
            shutil.copyfile(asset, target)
    told = ""
    wrong = []
    if with_api:
        wrong, bare = api.make(out / "api")
        told = f"; {len(api.headers())} headers in the reference, {bare} names in them without a comment"
    wrong += broken(out)
    for line in wrong:
        print(line, file=sys.stderr)
    print(f"{len(pages()) + 1} pages, {len(wrong)} links that lead nowhere{told}: {out / 'index.html'}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
