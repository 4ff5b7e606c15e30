"""The API reference: every public header through Doxygen, into FOLDER.

Fails on what Doxygen warns of, but for names without a comment of their own: those are counted.
"""
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

SETTINGS = """PROJECT_NAME = cleave
PROJECT_NUMBER = {version}
PROJECT_BRIEF = "Fractured rock: blocks, stability, contact"
INPUT = {files} {front}
USE_MDFILE_AS_MAINPAGE = {front}
OUTPUT_DIRECTORY = {out}
HTML_OUTPUT = .
STRIP_FROM_PATH = {lib}
STRIP_FROM_INC_PATH = {includes}
GENERATE_LATEX = NO
HAVE_DOT = NO
QUIET = YES
JAVADOC_AUTOBRIEF = YES
EXTRACT_ALL = NO
HIDE_UNDOC_MEMBERS = NO
HIDE_UNDOC_CLASSES = NO
HIDE_FRIEND_COMPOUNDS = YES
WARN_IF_INCOMPLETE_DOC = NO
MACRO_EXPANSION = YES
SORT_MEMBER_DOCS = NO
EXCLUDE_SYMBOLS = *::detail std::hash* std
HTML_COLORSTYLE_SAT = 40
"""


FRONT = """# The library, name by name

The public headers of cleave {version}: what `cmake --install` installs. <a href="../library.html">The library in your
project</a> says how to get it, what the modules are for, and what holds for threads, progress and errors. Good places to
begin:

- cleave::topology::CutInput, cleave::topology::cut, cleave::topology::audit, cleave::topology::BlockComplex
- cleave::stability::Settings, cleave::stability::Analysis, cleave::stability::KeyGroups
- cleave::dfn::JointSet, cleave::dfn::sample, cleave::dfn::joint_of
- cleave::bem::Problem, cleave::dbem::World, cleave::motion::World
- cleave::scene::run, cleave::scene::RunResult
"""


def headers() -> list[Path]:
    """What is installed: HEADERS of every module."""
    out = []
    for module in sorted((ROOT / "lib").glob("*/CMakeLists.txt")):
        listed = re.search(r"\n  HEADERS\n((?:\s+[\w/.]+\.hpp\)?\n?)+)", module.read_text())
        if listed:
            out += [module.parent / "include" / name for name in re.findall(r"[\w/]+\.hpp", listed.group(1))]
    return out


def make(out: Path) -> tuple[list[str], int]:
    """Writes the reference; what is wrong, and how many names have no comment."""
    files = headers()
    version = re.search(r'^#define CLEAVE_VERSION "(.*)"$', (ROOT / "lib/core/include/cleave/core/version.hpp").read_text(), re.M).group(1)
    out.mkdir(parents=True, exist_ok=True)
    front = out / "front.md"
    front.write_text(FRONT.format(version=version))
    settings = SETTINGS.format(version=version, front=front, files=" ".join(map(str, files)), out=out, lib=ROOT / "lib",
                               includes=" ".join(str(p) for p in sorted((ROOT / "lib").glob("*/include"))))
    done = subprocess.run(["doxygen", "-"], input=settings, capture_output=True, text=True)
    front.unlink()
    warnings = [line for line in done.stderr.splitlines() if "warning:" in line or "error:" in line]
    # Of a specialisation in namespace std: a fault of Doxygen's own.
    warnings = [line for line in warnings if "Internal inconsistency" not in line]
    bare = [line for line in warnings if "is not documented" in line]
    wrong = [line for line in warnings if line not in set(bare)]
    if done.returncode != 0 and not wrong:
        wrong.append(f"doxygen ended with {done.returncode}")
    return wrong, len(bare)
