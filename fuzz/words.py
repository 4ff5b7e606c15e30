#!/usr/bin/env python3
"""Words of scene files for libFuzzer: `words.py docs/scene.schema.json` prints every key and word that it names."""
import json
import sys


def words_of(schema):
    if isinstance(schema, list):
        return {word for part in schema for word in words_of(part)}
    if not isinstance(schema, dict):
        return set()
    found = {f'"{key}"' for key in schema.get("properties", {})}
    found |= {f'"\\"{word}\\""' for word in [*schema.get("enum", []), schema.get("const")] if isinstance(word, str)}
    return found.union(*(words_of(part) for part in schema.values()))


if __name__ == "__main__":
    with open(sys.argv[1]) as file:
        print("\n".join(sorted(words_of(json.load(file)))))
