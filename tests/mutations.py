#!/usr/bin/env python3
"""Plants bugs in a copy of the sources and runs the tests that should notice.

  tests/mutations.py [PATTERN]      the bugs of tests/mutations.list whose name matches (regular expression)
  tests/mutations.py --check        only looks whether every one still has a place in the sources; a test does so
  tests/mutations.py --sample N [--seed S] [--modules exact,geometry,...]
                                    N systematic ones, drawn at random: operators, constants, conditions, returns,
                                    deleted statements of lib/*/src; prints the share killed by module

Prints what killed each; fails when a named one survives. Stored hashes do not count: they notice every change, right
or wrong. Of a sample the test programs of the module come first, then all that link it, their fast tests only. What
tests/mutants_explained.list names changes nothing that can be seen, and is not counted.
The copy is kept in build/mutations, so that a second run compiles only what a mutation touches.
"""

import argparse
import json
import os
import random
import re
import shutil
import subprocess
import sys
import time

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
work = os.path.join(root, "build", "mutations")
copy = os.path.join(work, "source")
build = os.path.join(work, "build")

# Test programs that are closest to a module, where they are not in the folder of its name.
CLOSEST = {
    "exchange": ["io_test"],
    "facets": ["topology_test", "scene_test"],
    "field_data": ["field_tables_test", "scene_test", "survey_test"],
    "linear": ["bem_test", "dbem_test"],
    "load": ["stability_test", "scene_test"],
    "realize": ["cli_test"],
    "report": ["report_test"],
    "scene": ["scene_test", "key_reference_test"],
    "scene2d": ["scene_test", "elastic_scene_test", "contact_state_test"],
    "scene3d": ["scene_test"],
}


def run(command, **more):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", **more)


def named_mutations():
    text = "\n".join(l for l in open(os.path.join(root, "tests/mutations.list")).read().split("\n") if not l.startswith("#"))
    for group in re.split(r"\n\s*\n", text.strip("\n")):
        rows = group.strip("\n").split("\n")
        if len(rows) != 3:
            sys.exit("error: tests/mutations.list: three lines make a mutation, not:\n" + group)
        name, path, programs = (part.strip() for part in rows[0].split("|"))
        yield name, path, programs.split(), rows[1].replace("\\n", "\n"), rows[2].replace("\\n", "\n")


def check_places():
    mutations = list(named_mutations())
    lost = [m for m in mutations if open(os.path.join(root, m[1])).read().count(m[3]) != 1]
    for name, path, *_ in lost:
        print("error: %s: the text of '%s' does not occur once" % (path, name))
    known = set()
    for folder, _, files in os.walk(os.path.join(root, "tests")):
        if "CMakeLists.txt" in files:
            text = open(os.path.join(folder, "CMakeLists.txt")).read()
            known |= set(re.findall(r"\b(?:cleave_test|add_executable)\(\s*(\w+)", text))
    strange = [(program, m[0]) for m in mutations for program in m[2] if program not in known]
    for program, name in strange:
        print("error: there is no test program %s that '%s' names" % (program, name))
    print("%d mutations, %d without a place" % (len(mutations), len(lost)))
    sys.exit(1 if lost or strange else 0)


def restore(path):
    content = open(os.path.join(root, path), "rb").read()
    target = os.path.join(copy, path)
    os.makedirs(os.path.dirname(target), exist_ok=True)
    if not os.path.exists(target) or open(target, "rb").read() != content:
        open(target, "wb").write(content)


def prepare():
    """The copy as the sources are: only what differs is written, so that nothing else is compiled again."""
    os.makedirs(copy, exist_ok=True)
    wanted = {"CMakeLists.txt"}
    for part in ("lib", "tests", "fuzz", "bench"):
        for folder, _, files in os.walk(os.path.join(root, part)):
            wanted |= {os.path.relpath(os.path.join(folder, f), root) for f in files if "__pycache__" not in folder}
    for path in sorted(wanted):
        restore(path)
    for folder, _, files in os.walk(copy):
        for f in files:
            if os.path.relpath(os.path.join(folder, f), copy) not in wanted:
                os.remove(os.path.join(folder, f))
    configured = run(["cmake", "-G", "Ninja", "-S", copy, "-B", build, "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O1",
                      "-DCLEAVE_WERROR=OFF", "-DCLEAVE_EXAMPLES=OFF", "-DCLEAVE_BATCHES=ON", "-DCMAKE_CXX_COMPILER=g++-12"]
                     + (["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []))
    if configured.returncode:
        sys.exit(configured.stdout + "error: cannot configure " + build)


def make(programs):
    return run(["ninja", "-C", build] + programs)


def verdict(programs, without="GoldenHashes.*", limits=None):
    """What noticed: the program and its first failing test; nothing when all pass."""
    for program in programs:
        skipped = without if isinstance(without, str) else without.get(program, "GoldenHashes.*")
        try:
            ran = run([os.path.join(build, "bin", program), "--gtest_fail_fast", "--gtest_brief=1",
                       "--gtest_filter=-" + skipped], timeout=(limits or {}).get(program, 600))
        except subprocess.TimeoutExpired:
            return program + ": does not end"
        if ran.returncode:
            failed = re.search(r"^\[  FAILED  \] ([^\s,]+)", ran.stdout, re.M)
            if failed:
                return program + ": " + failed.group(1)
            says = re.search(r"internal error: (.*? does not hold)", ran.stdout)
            return program + ": " + (says.group(1) if says else "aborts with %d" % ran.returncode)
    return None


def planted(path, text, programs, judge):
    """(what killed it or None, or an error) with `text` in the file of the copy."""
    target = os.path.join(copy, path)
    kept = open(target).read()
    open(target, "w").write(text)
    try:
        made = make(programs)
        if made.returncode:
            first = re.search(r"error: .*", made.stdout)
            return None, first.group(0) if first else "?"
        return judge(programs), None
    finally:
        open(target, "w").write(kept)


def run_named(pattern):
    chosen = [m for m in named_mutations() if re.search(pattern, m[0])]
    if not chosen:
        sys.exit("error: no mutation matches " + repr(pattern))
    prepare()
    programs = sorted({p for m in chosen for p in m[2]})
    made = make(programs)
    if made.returncode:
        sys.exit(made.stdout + "error: the sources do not build")
    broken = verdict(programs)
    if broken:
        sys.exit("error: tests fail without any mutation: " + broken)
    survivors = errors = 0
    width = max(len(m[0]) for m in chosen)
    for name, path, tests, old, new in chosen:
        text = open(os.path.join(copy, path)).read()
        if text.count(old) != 1:
            result, errors = "ERROR: its text occurs %d times in %s" % (text.count(old), path), errors + 1
        else:
            killer, error = planted(path, text.replace(old, new), tests, verdict)
            if error:
                result, errors = "ERROR: does not build: " + error, errors + 1
            else:
                result = "killed by " + killer if killer else "SURVIVES"
                survivors += killer is None
        print("%-*s  %s" % (width, name, result), flush=True)
    print("%d mutations, %d killed, %d survive, %d in error" %
          (len(chosen), len(chosen) - survivors - errors, survivors, errors))
    sys.exit(1 if survivors or errors else 0)


# ---- systematic ones ------------------------------------------------------------------------------------------------
SWAPS = {
    "operator": [(" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "), (" == ", " != "), (" != ", " == "),
                 (" + ", " - "), (" - ", " + "), (" * ", " / "), (" / ", " * "), (" += ", " -= "), (" -= ", " += "),
                 (" && ", " || "), (" || ", " && ")],
    "constant": [("true", "false"), ("false", "true")],
}


def without_text(line):
    """The line with its comments, texts and characters blanked out."""
    line = re.sub(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])*\'', lambda m: "~" * len(m.group()), line)
    return re.sub(r"//.*|/\*.*?\*/", lambda m: " " * len(m.group()), line)


def mutants_of(line):
    """(kind, new line) of every systematic mutant of one line."""
    seen = without_text(line)
    if re.match(r"\s*(#|//|using |template|static_assert|namespace|CLEAVE_ASSERT|///)", seen) or "operator" in seen:
        return
    for kind, pairs in SWAPS.items():
        for old, new in pairs:
            for m in re.finditer(re.escape(old) if old[0] == " " else r"\b%s\b" % old, seen):
                yield kind, line[:m.start()] + new + line[m.end():]
    for m in re.finditer(r"(?<![\w.'])(\d+(?:\.\d+)?)(?![\w.'])", seen):
        value = m.group(1)
        yield "constant", line[:m.start()] + ("1" if value == "0" else "%s * 2" % value if "." in value else str(int(value) + 1)) + line[m.end():]
    m = re.match(r"(\s*(?:\} else )?if \()((?!const |auto )[^;=]*(?:[=!<>]=[^;=]*)*)(\)(?: \{| [a-z].*;))$", seen)
    if m and m.group(2).count("(") == m.group(2).count(")"):
        yield "condition", line[:m.start(2)] + "!(" + line[m.start(2):m.end(2)] + ")" + line[m.end(2):]
    m = re.match(r"(\s*return )([^{}]+)(;\s*)$", seen)
    if m and m.group(2) not in ("true", "false"):
        yield "return", line[:m.start(2)] + "{}" + line[m.end(2):]
    if re.match(r"\s+[\w.\[\]()>:-]+ (=|\+=|-=|\*=|/=) [^;]*;\s*$", seen) or re.match(r"\s+[\w.\[\]>:-]+\([^;]*\);\s*$", seen):
        if not re.match(r"\s*(return|throw|co_|break|continue|std::unreachable)", seen):
            yield "statement", re.match(r"\s*", line).group() + ";"


def modules():
    return sorted(m for m in os.listdir(os.path.join(root, "lib")) if os.path.isdir(os.path.join(root, "lib", m, "src")))


def sites(module):
    """(path, number of the line, kind, new line) of every mutant of a module."""
    folder = os.path.join(copy, "lib", module, "src")
    for base, _, files in sorted(os.walk(folder)):
        for file in sorted(f for f in files if f.endswith((".cpp", ".hpp"))):
            path = os.path.join(base, file)
            for number, line in enumerate(open(path).read().split("\n")):
                for kind, new in mutants_of(line):
                    if new != line:
                        yield os.path.relpath(path, copy), number, kind, new


def draw(count, seed, wanted):
    """As many of each module as its share of the sites says, its kinds in turn."""
    chance = random.Random(seed)
    pools = {m: list(sites(m)) for m in wanted}
    total = sum(map(len, pools.values()))
    order = []
    for module, pool in pools.items():
        chance.shuffle(pool)
        kinds = {}
        for site in pool:
            kinds.setdefault(site[2], []).append(site)
        turns = [s for row in zip(*(list(v) + [None] * (len(pool) - len(v)) for v in kinds.values())) for s in row if s]
        share = len(pool) / total
        order += [((k + chance.random()) / (share * count), module, s) for k, s in enumerate(turns)]
    return [(module, s) for _, module, s in sorted(order, key=lambda o: o[0])]


def explained():
    path = os.path.join(root, "tests", "mutants_explained.list")
    rows = [l.split(" | ") for l in open(path).read().split("\n") if l.strip() and not l.startswith("#")]
    return {(r[0].strip(), r[1].strip(), r[2].strip()) for r in rows}


def fast_programs():
    for folder, _, files in sorted(os.walk(os.path.join(copy, "tests"))):
        if "CMakeLists.txt" in files:
            text = open(os.path.join(folder, "CMakeLists.txt")).read()
            for call in re.findall(r"^ *cleave_test\((\w+\s[^()]*(?:\([^()]*\)[^()]*)*)\)", text, re.M):
                if not re.search(r"LABELS slow", call):
                    yield call.split()[0]


def test_programs():
    """Of every program of fast tests what of it is not to be run."""
    shown = json.loads(run(["ctest", "--test-dir", build, "--show-only=json-v1"]).stdout)
    fast, slow = set(), {}
    for test in shown["tests"]:
        command = test.get("command") or [""]
        program = os.path.basename(command[0])
        chosen = next((c.split("=", 1)[1] for c in command if c.startswith("--gtest_filter=")), None)
        if not chosen or os.path.dirname(command[0]) != os.path.join(build, "bin"):
            continue
        labels = next((p["value"] for p in test["properties"] if p["name"] == "LABELS"), [])
        if "fast" in labels:
            fast.add(program)
        else:
            slow.setdefault(program, []).append(chosen)
    return {p: ":".join(["GoldenHashes.*"] + slow.get(p, [])) for p in sorted(fast)}


def run_sample(count, seed, wanted):
    unknown = set(wanted) - set(modules())
    if unknown:
        sys.exit("error: no module %s; there are: %s" % (", ".join(sorted(unknown)), ", ".join(modules())))
    prepare()
    made = make(list(fast_programs()))
    if made.returncode:
        sys.exit(made.stdout + "error: the sources do not build")
    without = test_programs()
    limits = {}
    for program in without:
        begin = time.monotonic()
        broken = verdict([program], without)
        if broken:
            sys.exit("error: tests fail without any mutation: " + broken)
        limits[program] = 60 + 5 * (time.monotonic() - begin)
    inputs = {p: set(run(["ninja", "-C", build, "-t", "inputs", p]).stdout.split("\n")) for p in without}
    linked = {m: [p for p in without if any(i.endswith("/libcleave_%s.a" % m) for i in inputs[p])] for m in wanted}

    def judge(programs):
        return verdict(programs, without, limits)

    known, score, survivors = explained(), {}, []
    for module, (path, number, kind, new) in draw(count, seed, wanted):
        done = sum(k + s for k, s in score.values())
        if done >= count:
            break
        text = open(os.path.join(copy, path)).read().split("\n")
        old = text[number]
        if (path, old.strip(), new.strip()) in known:
            continue
        text[number] = new
        own = [p for p in CLOSEST.get(module, [module + "_test"]) if p in without]
        others = sorted((p for p in linked[module] if p not in own), key=lambda p: limits[p])
        killer, error = planted(path, "\n".join(text), own, judge)
        if not error and not killer and others:
            killer, error = planted(path, "\n".join(text), others, judge)
        if error:
            continue  # the compiler notices it
        score.setdefault(module, [0, 0])[killer is None] += 1
        print("%s:%d  %s  %s" % (path, number + 1, kind, "killed by " + killer if killer else "SURVIVES"), flush=True)
        if not killer:
            survivors.append("%s:%d\n-%s\n+%s" % (path, number + 1, old, new))
            print("  -%s\n  +%s" % (old.strip(), new.strip()), flush=True)
    for module, (killed, survive) in sorted(score.items()):
        print("%-12s %3d of %3d killed" % (module, killed, killed + survive))
    killed = sum(k for k, _ in score.values())
    print("%d mutants (seed %d), %d killed (%.0f %%)" % (killed + len(survivors), seed, killed,
                                                       100 * killed / max(1, killed + len(survivors))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pattern", nargs="?", default=".")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--sample", type=int, metavar="N")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--modules", default="")
    options = parser.parse_args()
    if options.check:
        check_places()
    elif options.sample is not None:
        run_sample(options.sample, options.seed, [m for m in options.modules.split(",") if m] or modules())
    else:
        run_named(options.pattern)


if __name__ == "__main__":
    main()
