"""How far something is, shown to whoever asked."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from tomlin._errors import typed


@contextmanager
def shown(progress: bool | None | Callable[..., Any]) -> Iterator[Callable[..., Any] | None]:
    """The function that the library calls: None, the caller's own, or one that writes a line."""
    if not progress:
        yield None
        return
    if callable(progress):
        yield progress
        return
    typed(progress, "progress", bool, "True, False or a callable")

    width = 0

    def write(now: Any, *_: Any) -> None:
        nonlocal width
        line = str(now)
        sys.stderr.write("\r" + line.ljust(width))
        sys.stderr.flush()
        width = len(line)

    try:
        yield write
    finally:
        if width:
            sys.stderr.write("\n")
