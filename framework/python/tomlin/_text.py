"""Python values as TOML."""

from __future__ import annotations

import math
import numbers
import os
import re
from collections.abc import Mapping
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_ESCAPES = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\r": "\\r", "\t": "\\t"}


def _quoted(text: str) -> str:
    escaped = (_ESCAPES.get(c) or (f"\\u{ord(c):04x}" if ord(c) < 32 or ord(c) == 127 else c)
               for c in text)
    return '"' + "".join(escaped) + '"'


def _key(key: Any) -> str:
    if not isinstance(key, str):
        raise TypeError(f"keys of a scene are texts, not {key!r}")
    return key if _BARE.fullmatch(key) else _quoted(key)


def _plain(value: Any) -> Any:
    """NumPy's scalars and arrays as Python's, and paths as texts."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    # A number longer than a double is still a scalar of NumPy.
    return float(value) if type(value).__module__ == "numpy" and isinstance(
        value, numbers.Real) else value


def value_text(value: Any, key: str = "") -> str:
    """A value on one line. Raises TypeError, with the key, for one that TOML has no form of."""
    value = _plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if math.isnan(value):
            return "nan"
        if math.isinf(value):
            return "inf" if value > 0 else "-inf"
        return float.__repr__(value)
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {value_text(v, _below(key, k))}"
                                for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(value_text(one, key) for one in value) + "]"
    where = f"{key} = " if key else ""
    raise TypeError(f"{where}{value!r}: a scene has no values of type {type(value).__name__}; "
                    "expected: numbers, texts, paths, True, False, lists, arrays and dicts")


def _below(key: str, name: Any) -> str:
    return f"{key}.{name}" if key else str(name)


def setting_text(value: Any, key: str = "") -> str:
    """A value as `--set` takes it: a text is a word or an expression."""
    value = _plain(value)
    return value if isinstance(value, str) else value_text(value, key)


def document_text(document: Mapping[str, Any]) -> str:
    """A whole scene: values, then tables, then lists of tables."""
    values, tables = [], []
    for key, value in document.items():
        value = _plain(value)
        if isinstance(value, Mapping):
            tables.append(f"\n[{_key(key)}]\n{_lines(value, key)}")
        elif isinstance(value, (list, tuple)) and value and all(
                isinstance(one, Mapping) for one in value):
            tables += [f"\n[[{_key(key)}]]\n{_lines(one, key)}" for one in value]
        else:
            values.append(f"{_key(key)} = {value_text(value, str(key))}\n")
    return "".join(values + tables)


def _lines(table: Mapping[str, Any], above: str) -> str:
    return "".join(f"{_key(key)} = {value_text(value, _below(above, key))}\n"
                   for key, value in table.items())
