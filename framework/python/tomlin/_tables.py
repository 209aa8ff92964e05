"""Tables that runs and sweeps have left: columns by their names, with their units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tomlin._errors import SceneError, refusal

Array = NDArray[np.float64]

EVENT_FIELDS = ("duration", "size", "energy_lost", "peak_force")
_HEADING = re.compile(r"(.*) \[([^\[\]]*)\]")
_LONGEST_SHOWN_VALUE = 60


class Columns:
    """Columns of numbers. ``file`` is what messages call them."""

    def __init__(self, file: str, units: Mapping[str, str], values: Any):
        self.file = file
        self.units = dict(units)
        self._values = values

    @property
    def names(self) -> list[str]:
        return list(self.units)

    def __contains__(self, name: str) -> bool:
        return name in self.units

    def __getitem__(self, name: str) -> Array:
        return np.asarray(self._values[name])


def one_line(text: str, most: int = _LONGEST_SHOWN_VALUE) -> str:
    """A text as it may stand in a message or a figure: breaks are spaces, and it has an end."""
    line = "".join(c if c.isprintable() else " " if c.isspace() else "?" for c in text)
    return line if len(line) <= most else line[:most] + "..."


def drawable(values: Array, source: str) -> Array:
    """Numbers of a figure. Raises SceneError where differences of them may be beyond a double."""
    largest = 1e300
    if (np.abs(values[~np.isnan(values)]) > largest).any():
        raise refusal("plot.no_data", source, f"numbers beyond {largest:g} cannot be drawn")
    return values


def read_text(file: str, most_bytes: int | None = None) -> str:
    """Raises SceneError for a file that cannot be read, a pipe among them, which might never end."""
    try:
        if Path(file).exists() and not Path(file).is_file():
            raise refusal("file.cannot_read", file, "this is no regular file")
        if most_bytes is not None and Path(file).stat().st_size > most_bytes:
            raise refusal("file.invalid", file, "this is too large for such a file")
        return Path(file).read_bytes().decode("utf-8")
    except OSError as error:
        raise refusal("file.cannot_read", file, str(error.strerror)) from None
    except UnicodeDecodeError:
        raise refusal("file.invalid", file, "this is no text in UTF-8") from None


def _fields(line: str) -> list[tuple[str, int]]:
    """The fields of a line as they are written, and where they begin, from 1. A comma inside of
    quotes separates nothing."""
    fields: list[tuple[str, int]] = []
    parts: list[str] = []
    quotes, column = 0, 1
    for part in line.split(","):
        parts.append(part)
        quotes += part.count('"')
        if quotes % 2 == 0:
            fields.append((",".join(parts), column))
            column += len(fields[-1][0]) + 1
            parts = []
    return [*fields, (",".join(parts), column)] if parts else fields


def _without_quotes(field: str) -> str:
    quoted = len(field) > 1 and field[0] == field[-1] == '"'
    return field[1:-1].replace('""', '"') if quoted else field


class TextTable:
    """A table with a header, read field by field. Raises SceneError with line and column of
    damage."""

    def __init__(self, file: str):
        self.file = file
        header, *lines = read_text(file).split("\n")
        if lines and lines.pop():
            raise self.damaged(len(lines) + 2, 1, "the last line is not whole")
        self.header = header
        #: "driver.force.x [force]" as name and unit.
        self.columns = [(found[1], found[2]) if (found := _HEADING.fullmatch(one)) else (one, "")
                        for one in (_without_quotes(field) for field, _ in _fields(header))]
        self.names = [name for name, _ in self.columns]
        self.lines = lines

    def damaged(self, line: int, column: int, why: str, key: str = "") -> SceneError:
        return refusal("file.damaged", self.file, why, line=line, column=column, key=key)

    def invalid(self, why: str, admissible: str = "") -> SceneError:
        """A fault of the header."""
        return refusal("file.invalid", self.file, why, line=1, column=1, key=one_line(self.header),
                       admissible=admissible)

    @cached_property
    def rows(self) -> list[list[tuple[str, int]]]:
        rows = [_fields(line) for line in self.lines]
        for k, row in enumerate(rows):
            if len(row) != len(self.columns):
                raise self.damaged(k + 2, 1, f"{len(row)} fields in a table of {len(self.columns)} "
                                   "columns")
        return rows

    def words(self, column: int) -> list[str]:
        return [_without_quotes(row[column][0]) for row in self.rows]

    def numbers(self, column: int, may_be_empty: bool = True) -> Array:
        """NaN where a field is empty."""
        values = np.full(len(self.rows), np.nan)
        for k, row in enumerate(self.rows):
            field, at = row[column]
            if field or not may_be_empty:
                values[k] = number_in(field)
                if not np.isfinite(values[k]):
                    raise self.damaged(k + 2, at, "not a finite number", one_line(field) or '""')
        return values


def number_in(field: str) -> float:
    """NaN of what is no number: Python takes 1_000 for one."""
    try:
        return float("nan") if "_" in field else float(field)
    except ValueError:
        return float("nan")


def read_events(file: str) -> list[tuple[Any, ...]]:
    """Reads `events.csv`: time, kind and name of each event, and the numbers of `EVENT_FIELDS`, NaN
    where a kind has none. Raises SceneError with line and column of damage."""
    table = TextTable(file)
    if table.names != ["time", "event", "name", *EVENT_FIELDS]:
        raise table.invalid("this is no table of events")
    return list(zip(table.numbers(0, False), table.words(1), table.words(2),
                    *(table.numbers(3 + k) for k in range(len(EVENT_FIELDS)))))


def read_samples(file: str) -> Columns:
    """Reads `observables.csv`. Raises SceneError with line and column of damage."""
    table = TextTable(file)
    if table.names[0] != "time":
        raise table.invalid("this is not a table of observables",
                            'a header that begins with "time [time]"')
    if not table.lines:
        return Columns(file, dict(table.columns), dict.fromkeys(table.names, np.empty(0)))
    try:
        numbers = np.loadtxt(table.lines, delimiter=",", comments=None, ndmin=2).T
        if numbers.shape != (len(table.names), len(table.lines)) or not np.isfinite(numbers).all():
            raise ValueError
    except ValueError:  # NumPy does not say where
        numbers = np.array([table.numbers(k, False) for k in range(len(table.names))])
    return Columns(file, dict(table.columns), dict(zip(table.names, numbers)))
