"""Names of all tests as ctest lists them, read from the sources: nothing has to be built."""
import re
from pathlib import Path


def named_tests(root: Path) -> set[str]:
    names, instances = set(), []
    for file in sorted([*root.glob("tests/**/*.cpp"), *root.glob("bench/**/*.cpp")]):
        text = file.read_text(errors="replace")
        for kind, suite, name in re.findall(r"^\s*(TEST|TEST_F|TEST_P|TYPED_TEST)\(\s*(\w+),\s*(\w+)", text, re.M):
            names.add(f"{suite}.{name}" if kind != "TYPED_TEST" else f"{suite}/0.{name}")
        instances += re.findall(r"^\s*INSTANTIATE_(?:TYPED_)?TEST_SUITE_P\(\s*(\w+),\s*(\w+)", text, re.M)
    for prefix, suite in instances:
        names |= {f"{prefix}/{name}" for name in names if name.startswith(suite + ".")}
    for file in sorted(root.glob("*/**/CMakeLists.txt")):
        if file.relative_to(root).parts[0] == "build":
            continue
        text = file.read_text()
        names |= set(re.findall(r"add_test\(NAME\s+(\w+)", text))
        names |= {f"replay_{target}" for target in re.findall(r"^cleave_fuzz\((\w+)", text, re.M)}
    return names


def alternatives(expression: str) -> list[str]:
    """The parts of `^(a|b\\.(c|d))`, each a pattern of its own: a, b\\.c, b\\.d."""
    body = re.fullmatch(r"\^\((.*)\)", expression)
    if body is None:
        raise ValueError(f"an expression of a promise is ^(a|b), not {expression}")
    parts = []
    for part in re.findall(r"(?:[^|()]|\([^()]*\))+", body.group(1)):
        group = re.fullmatch(r"(.*)\(([^()]*)\)", part)
        parts += [group.group(1) + end for end in group.group(2).split("|")] if group else [part]
    return parts


def without_tests(expression: str, names: set[str]) -> list[str]:
    """Parts of the expression that no test has as the beginning of its name."""
    return [part for part in alternatives(expression) if not any(re.match(part, name) for name in names)]
