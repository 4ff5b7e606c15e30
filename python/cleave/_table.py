"""Tables of results as columns."""
from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import numpy as np


def _column(cells: list[str]) -> np.ndarray:
    for kind in (int, float):
        try:
            if kind is int:
                return np.array([int(c) for c in cells], dtype=np.int64)
            return np.array([float(c) if c else np.nan for c in cells], dtype=np.float64)
        except (ValueError, OverflowError):
            continue
    return np.array(cells, dtype=object)


class Table:
    """Columns by name, each an array; the names (with units) are those of the CSV file, in its order.

    Numbers are int64 or float64 (an empty cell is NaN), all else is text. ``table["volume_m3"]`` is a column,
    ``table.rows()`` gives a dict for each row.
    """

    def __init__(self, text: str) -> None:
        lines = [line for line in text.splitlines() if not line.startswith("#")]
        rows = list(csv.reader(io.StringIO("\n".join(lines))))
        header, body = (rows[0], rows[1:]) if rows else ([], [])
        self._columns = {name: _column([row[i] for row in body]) for i, name in enumerate(header)}
        self._count = len(body)
        for column in self._columns.values():
            column.setflags(write=False)

    def __getitem__(self, name: str) -> np.ndarray:
        return self._columns[name]

    def __contains__(self, name: str) -> bool:
        return name in self._columns

    def __len__(self) -> int:
        """Number of rows."""
        return self._count

    @property
    def columns(self) -> list[str]:
        return list(self._columns)

    def __repr__(self) -> str:
        return f"<cleave table: {self._count} rows of {', '.join(self._columns)}>"

    def rows(self) -> Iterator[dict]:
        """A dict for each row."""
        for i in range(self._count):
            yield {name: column[i] for name, column in self._columns.items()}
