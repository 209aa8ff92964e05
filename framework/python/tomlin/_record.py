"""Results as objects: dicts whose keys are attributes, vectors whose components are."""

from __future__ import annotations

import html
from typing import Any

import numpy as np
from numpy.typing import NDArray

AXES = "xyz"


class Vector(tuple[Any, ...]):
    """A number per axis, which are also attributes.

    >>> force = Vector([0.4, 0.0])
    >>> force.x, force[1], len(force)
    (0.4, 0.0, 2)
    """

    def __getattr__(self, name: str) -> Any:
        axis = AXES.find(name) if len(name) == 1 else -1
        if 0 <= axis < len(self):
            return self[axis]
        raise AttributeError(f"a vector of {len(self)} components has no {name!r}")

    def __array__(self, dtype: Any = None) -> NDArray[Any]:
        return np.array([np.nan if one is None else one for one in self], dtype or float)

    def __repr__(self) -> str:
        return f"Vector{tuple.__repr__(self)}"


class Record(dict[str, Any]):
    """A dict whose keys are attributes as well.

    >>> record = Record({"window": {"from": 1.0, "to": 2.0}})
    >>> record.window.to
    2.0
    """

    def __getitem__(self, key: Any) -> Any:
        return wrapped(super().__getitem__(key))

    def get(self, key: Any, default: Any = None) -> Any:
        """The value of a key, or what is given for one that is not there."""
        return self[key] if key in self else default

    def values(self) -> list[Any]:  # type: ignore[override]
        """The values, as `[]` gives them."""
        return [self[key] for key in self]

    def items(self) -> list[tuple[Any, Any]]:  # type: ignore[override]
        """Keys and values, as `[]` gives them."""
        return [(key, self[key]) for key in self]

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"{type(self).__name__} has no {name!r}; it has "
                                 + ", ".join(map(str, self))) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(key for key in self if str(key).isidentifier())]

    def _repr_html_(self) -> str:
        return table_html(self)


def wrapped(value: Any) -> Any:
    """Hands out dicts as records, and lists of numbers as vectors."""
    if isinstance(value, dict) and not isinstance(value, Record):
        return Record(value)
    if isinstance(value, list):
        if 0 < len(value) <= 3 and all(isinstance(one, (int, float)) for one in value):
            return Vector(value)
        return [wrapped(one) for one in value]
    return value


def shown(value: Any) -> str:
    """A value in a few characters."""
    if value is None:
        return "–"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, tuple)):
        text = ", ".join(shown(one) for one in value[:4])
        return text + (", …" if len(value) > 4 else "")
    if isinstance(value, dict):
        return ", ".join(f"{key} {shown(one)}" for key, one in list(value.items())[:6])
    return str(value)


def table_html(rows: dict[str, Any], caption: str = "") -> str:
    """A small table of two columns."""
    body = "".join(f"<tr><td>{html.escape(str(key))}</td><td>{html.escape(shown(value))}</td></tr>"
                   for key, value in rows.items())
    head = f"<caption>{html.escape(caption)}</caption>" if caption else ""
    return f"<table>{head}{body}</table>"
