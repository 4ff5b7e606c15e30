"""A scene as a dict, written as TOML."""
from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence


def _plain(value):
    """NumPy numbers and arrays, paths and tuples as what TOML knows."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    return value


def _key(name) -> str:
    if not isinstance(name, str):
        raise TypeError(f"the keys of a scene are text, not {name!r}")
    bare = name and all(c.isascii() and (c.isalnum() or c in "-_") for c in name)
    return name if bare else _text(name)


def _text(value: str) -> str:
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007F")


def _inline(value, where: str) -> str:
    value = _plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if math.isinf(value):
            return "inf" if value > 0 else "-inf"
        return "nan" if math.isnan(value) else repr(value)
    if isinstance(value, Mapping):
        inner = (f"{_key(k)} = {_inline(v, f'{where}.{k}')}" for k, v in value.items() if v is not None)
        return "{ " + ", ".join(inner) + " }"
    if isinstance(value, Sequence):
        return "[" + ", ".join(_inline(v, f"{where}[{i}]") for i, v in enumerate(value, 1)) + "]"
    raise TypeError(f"{where}: a scene holds numbers, text, lists and dicts, not {type(value).__name__}")


def _tables(value) -> bool:
    value = _plain(value)
    return isinstance(value, Sequence) and not isinstance(value, str) and len(value) > 0 and all(
        isinstance(_plain(v), Mapping) for v in value)


def dumps(scene: Mapping) -> str:
    """TOML text of a scene. A value that is None counts as not given."""
    lines: list[str] = []
    later = []
    for key, value in scene.items():
        value = _plain(value)
        if value is None:
            continue
        if isinstance(value, Mapping) or _tables(value):
            later.append((key, value))
        else:
            lines.append(f"{_key(key)} = {_inline(value, str(key))}")
    for key, value in later:
        many = not isinstance(value, Mapping)
        for table in value if many else [value]:
            lines.append("")
            lines.append(f"[[{_key(key)}]]" if many else f"[{_key(key)}]")
            for name, inner in _plain(table).items():
                if _plain(inner) is not None:
                    lines.append(f"{_key(name)} = {_inline(inner, f'{key}.{name}')}")
    return "\n".join(lines) + "\n"
