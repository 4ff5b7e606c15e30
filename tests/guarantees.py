#!/usr/bin/env python3
"""What cleave promises, what shows it, and the page that says both.

    tests/guarantees.py [--short | --night] [--only N,N]   runs what shows each promise, writes docs/guarantees.md and the evidence
    tests/guarantees.py --page                   writes the page again from the evidence there is; runs nothing
    tests/guarantees.py --check                  the page is the one that promises and evidence make, and every test
                                                 that a promise names exists; runs nothing

The short form takes the tests of the release build; the long one (--night) adds what takes hours. A promise whose checks fail
ends the run with 1 and stands as broken on the page.
"""
import argparse
import datetime
import json
import re
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

from named_tests import alternatives, named_tests, without_tests

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "guarantees.md"
EVIDENCE = ROOT / "tests" / "guarantees.json"


@dataclass
class Promise:
    title: str
    scope: str
    limits: str
    tests: str  # a regular expression over the names of ctest
    night: list[str] = field(default_factory=list)


PROMISES = [
    Promise(
        "No input crashes, hangs or leaks",
        "Scenes, tables, meshes and survey files of any content, given to the program or to the readers of the library; "
        "calls of the cutter and of a contact step with any numbers.",
        "Files above 1 GB are refused unread. `cleave check` takes about 45 bytes of memory for each byte of a table of discs.",
        r"^(WrongInputTest|.*BadSceneTest|Refusals|replay_fuzz_|Robustness|TouchTest|FileTest)",
        ["./x test fuzz -L fast", ".ci/fuzz 600"],
    ),
    Promise(
        "No unchecked block system reaches an answer",
        "Stability, support and the figures of a run take a block system only in the type that the audit alone can make.",
        "The audit recomputes counts, closure, orientation, neighbours and volumes. Centroids, thickness and tags are checked "
        "by tests, not at run time. `section` and the export of a sequential cut take systems as they are cut.",
        r"^(Audit|Thin|SharedSides|SummaryJson\.WithoutACertificate|MotionCertificates|RestCertificates|house_test)",
        ["tests/mutations.sh"],
    ),
    Promise(
        "Same scene and seed, same bytes",
        "Over numbers of threads, ranks and shards, compilers (g++-12, clang-19) and optimisation, on x86-64 without further "
        "instruction sets.",
        "With `-march=native` elastic and contact scenes differ in the last digits: the linear algebra library then uses fused "
        "operations. In WebAssembly block systems and key blocks are the same; nothing else is built there. arm64 is not measured.",
        r"^(GoldenHashes|Golden|DeterminismTest|OrderedTest|CanonicalHash|CommandsTest\.HashFollows|Philox|MonteCarloTest\.Shards|DesignsTest\.Ranks)",
        ["tests/golden/matrix.sh", "./x browser --check"],
    ),
    Promise(
        "Killed at any moment, only work in flight is lost",
        "A run of any kind killed at any of its allocations or calls of the system is made again with the same bytes; an "
        "ensemble goes on from its last whole record.",
        "The order of writes on a disk that loses power is that of the file system; files are flushed before they are renamed.",
        r"^(Runs/FaultsTest\.AKilledRun|MonteCarloTest\.Killed|RecordFileTest|KeptRecordsTest)",
    ),
    Promise(
        "No half file under a final name",
        "Results are written beside their place and put there in one step; whatever call fails, the old result or the new one "
        "can be read.",
        "On file systems without exchange of names the step is two renamings.",
        r"^(Runs/FaultsTest\.(TheOldResult|CallsThatFail)|OutFolderTest|WriteFileTest|MachineTest)",
    ),
    Promise(
        "Limits of memory are honoured",
        "Out of memory is exit code 3 and a message, with nothing left behind, under `--memory`, `ulimit` and control groups. "
        "Out of the library comes std::bad_alloc, and what the call had taken is given back.",
        "`cleave run` and `cleave replay` take `--memory`; without it a cut that is expected to need more than the machine (or "
        "its control group) has is refused before it begins. The estimate of `cleave plan` is a guide, not a bound: on the "
        "examples it lies within five times of what they took, but for groups of blocks and motion, which it leaves out.",
        r"^(Runs/FaultsTest\.LessAndLess|LibraryMemory|MachineTest\.(Memory|TheLimit)|PeakMemoryTest|Scenes/PlannedSize|PlannedCost)",
    ),
    Promise(
        "Every error of input names file, line, key and remedy",
        "Every kind of mistake that the readers know.",
        "Files of meshes and tables name the line; binary formats the file only.",
        r"^(WrongInputTest|.*BadSceneTest|CommandsTest\.WrongCalls|JointCsvTest|DxfTest|TsurfTest|FabTest|StlTest|ObjTest)",
    ),
    Promise(
        "Filtered predicates equal exact ones",
        "Orientation, side and crossing of points and planes with coordinates of the lattice.",
        "Coordinates of input are rounded to the lattice once, where they enter.",
        r"^(Predicates|PredicatesTest|replay_fuzz_predicates)",
        ["./x fuzz fuzz_predicates 1800"],
    ),
    Promise(
        "Degenerate input is ordinary",
        "Joints that coincide, touch, share edges or corners, end on one another, lie on the border, in any order, at any "
        "place, size and turn: the blocks are those of exact arithmetic.",
        "Doubles are what a file says: surfaces that miss each other by more than rounding are open, and noted.",
        r"^(OracleTest|Degenerate|SharedSides|SharedEdges|Snapping|NearMisses|LastBits|Invariance|oracle_agreement|closed_agreement|FourUser|BerreCase)",
        [f"build/release/bin/closed_agreement 10000 {seed}" for seed in (101, 102, 103)],
    ),
    Promise(
        "No number that did not converge is printed as converged",
        "Elastic refinement, contact steps and static relaxation end with a status; residual, overlap and forces are checked "
        "apart from the solver.",
        "The error estimate of a moving elastic body is of its mesh; that of its time step is not part of it.",
        r"^(ResidualTest|OverlapTest|OverlapSceneTest|MassRatioTest|ErrorEstimate|ErrorTargetTest|RestTest|WorldTest|Contact/FamilyTest|StackTest|LooseTest)",
        ["./x study contact"],
    ),
    Promise(
        "No verdict of standing where dynamics moves",
        "Groups of blocks near free faces are judged together; \"stands\" and \"moves\" carry certificates that code apart from "
        "the search has checked; the rest is in doubt, and said so.",
        "Of 237 random assemblies of the plane one moves with blocks that are in no group, beside one: \"no group found\" is no proof. With "
        "`groups = \"note\"` more than 300 near blocks are judged in translation only, more than 3,000 not together (20,000 with "
        "`\"decide\"`), and a note says so. Blocks are rigid. What lies beyond the domain is taken to hold; blocks that only the border holds are noted.",
        r"^(Verdicts|KeyGroups|Chains|Pairs|Ploughing|SingleBlocks|BlockTheoryTest|HeldByTheBorder|MotionScene|contact_agreement)",
        ["tests/verdicts_in_motion.py build/release/bin/cleave --scenes 400"],
    ),
]


def shell(command: str) -> subprocess.CompletedProcess:
    return subprocess.run(command, shell=True, cwd=ROOT, text=True, capture_output=True, check=False)


def run_tests(expression: str) -> tuple[int, list[str]]:
    """Number of tests run, and names of those that failed. No test at all is a failure."""
    done = shell(f"ctest --preset release -j2 -R '{expression}' --no-tests=error 2>&1")
    passed = re.findall(r"Test +#\d+: (\S+).*?\.+ +Passed", done.stdout)
    failed = re.findall(r"Test +#\d+: (\S+).*?\*\*\*", done.stdout)
    skipped = set(re.findall(r"Test +#\d+: (\S+).*?\*\*\*Skipped", done.stdout))
    failed = [name for name in failed if name not in skipped]
    if done.returncode != 0 and not failed:
        failed = ["ctest itself: " + done.stdout.strip()[-200:]]
    return len(passed), failed


def show(number: int, promise: Promise, night: bool) -> dict:
    start = time.monotonic()
    tests, failed = run_tests(promise.tests)
    commands = promise.night if night else []
    for command in commands:
        done = shell(command)
        if done.returncode != 0:
            failed.append(command)
            print((done.stdout + done.stderr)[-2000:], file=sys.stderr)
    seconds = time.monotonic() - start
    print(f"{number:2} {promise.title}: {tests} tests, {len(commands)} long checks, {seconds:.0f} s"
          + ("" if not failed else ", BROKEN: " + ", ".join(failed)), flush=True)
    return {"tests": tests, "long": commands, "failed": failed}


def page(evidence: dict) -> str:
    out = [
        "# What cleave promises",
        "",
        *fold("Each promise has a scope, its limits, and the checks that hold it. `./x guarantees` runs the short ones and "
              "writes this page; `./x guarantees --night` runs the long ones as well. A broken promise is a bug: please "
              "report it."),
        "",
    ]
    for number, promise in enumerate(PROMISES, 1):
        found = evidence.get(str(number))
        held = [part.replace(".*", "").replace("\\.", ".") for part in alternatives(promise.tests)] + promise.night
        out += [f"## {number}. {promise.title}", ""]
        out += [*fold(promise.scope), "", *fold("Limits: " + promise.limits), ""]
        out += [*fold("Held by: " + ", ".join(f"`{name}`" for name in held) + "."), ""]
        if found is None:
            out += ["Last evidence: none yet.", ""]
            continue
        state = "held" if not found["failed"] else "**broken** by " + ", ".join(f"`{name}`" for name in found["failed"])
        checks = f"{found['tests']} tests" + "".join(f", `{command}`" for command in found["long"])
        out += fold(f"Last evidence: {found['date']}, {checks}: {state}.") + [""]
    return "\n".join(out)


def fold(text: str) -> list[str]:
    lines, line = [], ""
    for word in text.split():
        if len(line) + len(word) + 1 > 118 and line:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}".strip()
    return lines + [line]


def main() -> int:
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--short", action="store_true", help="the short form, as without a word")
    asked.add_argument("--night", action="store_true")
    asked.add_argument("--check", action="store_true")
    asked.add_argument("--page", action="store_true")
    asked.add_argument("--only", default="")
    options = asked.parse_args()
    if options.short and options.night:
        asked.error("--short and --night are two forms: give one")
    evidence = json.loads(EVIDENCE.read_text()) if EVIDENCE.exists() else {}
    if options.page:
        PAGE.write_text(page(evidence))
        return 0
    if options.check:
        names = named_tests(ROOT)
        lost = [(number, part) for number, promise in enumerate(PROMISES, 1) for part in without_tests(promise.tests, names)]
        for number, part in lost:
            print(f"promise {number} names a test that is not there: {part}", file=sys.stderr)
        if lost:
            return 1
        if PAGE.exists() and PAGE.read_text() == page(evidence):
            return 0
        print("docs/guarantees.md is not what tests/guarantees.py makes: run it", file=sys.stderr)
        return 1
    wanted = {int(n) for n in options.only.split(",") if n} or set(range(1, len(PROMISES) + 1))
    broken = 0
    for number, promise in enumerate(PROMISES, 1):
        if number not in wanted:
            continue
        found = show(number, promise, options.night)
        evidence[str(number)] = {"date": datetime.date.today().isoformat(), **found}
        broken += bool(found["failed"])
    EVIDENCE.write_text(json.dumps(evidence, indent=1) + "\n")
    PAGE.write_text(page(evidence))
    print(f"{len(wanted) - broken} promises held, {broken} broken")
    return 4 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
