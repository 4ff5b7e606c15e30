#!/usr/bin/env bash
# Plants the bugs of tests/mutations.list one by one in a copy of the sources and runs the tests that should notice.
# Prints what killed each; fails when one survives.
#
#   tests/mutations.sh [PATTERN]      only the mutations whose name matches (grep -E)
#   tests/mutations.sh --check        only looks whether every mutation still has a place in the sources; a test does so
#
# Stored hashes do not count: they notice every change, right or wrong.
# The copy is kept in build/mutations, so that a second run compiles only what a mutation touches.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$root/build/mutations
copy=$work/source
pattern=${1:-.}
[[ $pattern == --check ]] || mkdir -p "$copy"

python3 - "$copy" "$work" "$root" "$pattern" <<'PYTHON'
import os, re, shutil, subprocess, sys

copy, work, root, pattern = sys.argv[1:]
build = os.path.join(work, "build")

mutations = []
lines = [l for l in open(os.path.join(root, "tests/mutations.list")).read().split("\n") if not l.startswith("#")]
for group in re.split(r"\n\s*\n", "\n".join(lines).strip("\n")):
    rows = group.strip("\n").split("\n")
    if len(rows) != 3:
        sys.exit("error: tests/mutations.list: three lines make a mutation, not:\n" + group)
    name, path, programs = (part.strip() for part in rows[0].split("|"))
    mutations.append((name, path, programs.split(), rows[1].replace("\\n", "\n"), rows[2].replace("\\n", "\n")))
if pattern == "--check":
    lost = [m for m in mutations if open(os.path.join(root, m[1])).read().count(m[3]) != 1]
    for name, path, *_ in lost:
        print("error: %s: the text of '%s' does not occur once" % (path, name))
    print("%d mutations, %d without a place" % (len(mutations), len(lost)))
    sys.exit(1 if lost else 0)
chosen = [m for m in mutations if re.search(pattern, m[0])]
if not chosen:
    sys.exit("error: no mutation matches " + repr(pattern))

def run(command, **more):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", **more)

def restore(path):
    source = os.path.join(root, path)
    target = os.path.join(copy, path)
    content = open(source, "rb").read()
    os.makedirs(os.path.dirname(target), exist_ok=True)
    if not os.path.exists(target) or open(target, "rb").read() != content:
        open(target, "wb").write(content)

# Only what differs is written, so that nothing else is compiled again.
wanted = {"CMakeLists.txt"}
for part in ("lib", "tests", "fuzz", "bench"):
    for folder, _, files in os.walk(os.path.join(root, part)):
        wanted |= {os.path.relpath(os.path.join(folder, f), root) for f in files}
for path in sorted(wanted):
    restore(path)
for folder, _, files in os.walk(copy):
    for f in files:
        if os.path.relpath(os.path.join(folder, f), copy) not in wanted:
            os.remove(os.path.join(folder, f))
configured = run(["cmake", "-G", "Ninja", "-S", copy, "-B", build, "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O1",
                  "-DCLEAVE_WERROR=OFF", "-DCLEAVE_EXAMPLES=OFF", "-DCMAKE_CXX_COMPILER=g++-12"]
                 + (["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []))
if configured.returncode:
    sys.exit(configured.stdout + "error: cannot configure " + build)

def make(programs):
    return run(["ninja", "-C", build] + programs)

def verdict(programs):
    """What noticed: the program and its first failing test; nothing when all pass."""
    for program in programs:
        try:
            ran = run([os.path.join(build, "bin", program), "--gtest_fail_fast", "--gtest_brief=1",
                       "--gtest_filter=-GoldenHashes.*"], timeout=600)
        except subprocess.TimeoutExpired:
            return program + ": does not end"
        if ran.returncode:
            failed = re.search(r"^\[  FAILED  \] ([^\s,]+)", ran.stdout, re.M)
            if failed:
                return program + ": " + failed.group(1)
            says = re.search(r"internal error: (.*? does not hold)", ran.stdout)
            return program + ": " + (says.group(1) if says else "aborts with %d" % ran.returncode)
    return None

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
    target = os.path.join(copy, path)
    text = open(target).read()
    if text.count(old) != 1:
        result, errors = "ERROR: its text occurs %d times in %s" % (text.count(old), path), errors + 1
    else:
        open(target, "w").write(text.replace(old, new))
        made = make(tests)
        if made.returncode:
            first = re.search(r"error: .*", made.stdout)
            result, errors = "ERROR: does not build: " + (first.group(0) if first else "?"), errors + 1
        else:
            killer = verdict(tests)
            result = "killed by " + killer if killer else "SURVIVES"
            survivors += killer is None
        open(target, "w").write(text)
    print("%-*s  %s" % (width, name, result), flush=True)
print("%d mutations, %d killed, %d survive, %d in error" %
      (len(chosen), len(chosen) - survivors - errors, survivors, errors))
sys.exit(1 if survivors or errors else 0)
PYTHON
