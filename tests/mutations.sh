#!/usr/bin/env bash
# Plants bugs in a copy of the sources and runs the tests that should notice: tests/mutations.sh --help
exec python3 -B "$(dirname "${BASH_SOURCE[0]}")/mutations.py" "$@"
