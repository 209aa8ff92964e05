"""Python values as TOML."""

from __future__ import annotations

import math
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
    """NumPy's scalars and arrays as Python's."""
    return value.tolist() if hasattr(value, "tolist") else value


def value_text(value: Any) -> str:
    """A value on one line."""
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
        return repr(value)
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {value_text(v)}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(value_text(one) for one in value) + "]"
    raise TypeError(f"a scene has no values of type {type(value).__name__}: {value!r}")


def setting_text(value: Any) -> str:
    """A value as `--set` takes it: a text is a word or an expression."""
    value = _plain(value)
    return value if isinstance(value, str) else value_text(value)


def document_text(document: Mapping[str, Any]) -> str:
    """A whole scene: values, then tables, then lists of tables."""
    values, tables = [], []
    for key, value in document.items():
        value = _plain(value)
        if isinstance(value, Mapping):
            tables.append(f"\n[{_key(key)}]\n{_lines(value)}")
        elif isinstance(value, (list, tuple)) and value and all(
                isinstance(one, Mapping) for one in value):
            tables += [f"\n[[{_key(key)}]]\n{_lines(one)}" for one in value]
        else:
            values.append(f"{_key(key)} = {value_text(value)}\n")
    return "".join(values + tables)


def _lines(table: Mapping[str, Any]) -> str:
    return "".join(f"{_key(key)} = {value_text(value)}\n" for key, value in table.items())
