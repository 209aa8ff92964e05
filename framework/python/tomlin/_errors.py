"""Exceptions of tomlin, and checks of arguments."""

from __future__ import annotations

import difflib
import numbers
import operator
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from tomlin import _core


class Error(Exception):
    """Everything that tomlin raises, but for wrong types of arguments."""


@dataclass(frozen=True)
class Fault:
    """One fault of the input. ``str(fault)`` is the line that the program prints."""

    code: str  #: stable identifier, "scene.unknown_key"
    file: str  #: the file, or the argument, where it was written
    line: int  #: from 1; 0: unknown
    column: int  #: from 1; 0: unknown
    key: str  #: dotted path, "force.driver.stiffness"
    value: str  #: as it was written, of a file that is no TOML the line; empty: there is none
    message: str  #: what is wrong
    admissible: str  #: what would be right; empty when obvious
    nearest: str  #: nearest valid name; empty when there is none
    text: str  #: all of it in one line

    def __str__(self) -> str:
        return self.text


class SceneError(Error, ValueError):
    """Bad input: a scene, a setting, an axis of a sweep, an observable, a folder.

    >>> import tomlin
    >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
    >>> try:
    ...     tip.set("run.duratoin", 1.0)
    ... except tomlin.SceneError as error:
    ...     fault = error.faults[0]
    >>> fault.key, fault.code, fault.nearest
    ('run.duratoin', 'scene.unknown_key', 'duration')
    """

    faults: list[Fault]  #: every fault that was found

    def __init__(self, faults: list[dict[str, Any]] | list[Fault]):
        self.faults = [one if isinstance(one, Fault) else Fault(**one) for one in faults]
        super().__init__("\n".join(str(one) for one in self.faults))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.faults,)


def interrupted(result: Any) -> KeyboardInterrupt:
    """Ctrl-C, with what is known so far as its ``result``: a loop of runs ends as well."""
    error = KeyboardInterrupt(f"{result!r} is the result of this exception")
    error.result = result  # type: ignore[attr-defined]
    return error


class QuantityError(SceneError, KeyError):
    """A result has no quantity of that name; the message has the nearest one."""

    __str__ = Exception.__str__


def core_of(scene: Any) -> _core.Scene:
    """Raises TypeError for what is no scene."""
    core = getattr(scene, "_core", None)
    if not isinstance(core, _core.Scene):
        raise TypeError(f"a tomlin.Scene, not {type(scene).__name__}; tomlin.load reads files")
    return core


def core_value(name: str, doc: str) -> Any:
    """A property that hands out what the extension module has under this name."""
    return property(operator.attrgetter(f"_core.{name}"), doc=doc)


def typed(value: Any, name: str, types: type | tuple[type, ...], what: str) -> Any:
    """An argument. Raises TypeError, with its name, where it is of another type."""
    if not isinstance(value, types):
        raise TypeError(f"{name} = {value!r}: {what}, not {type(value).__name__}")
    return value


def whole(value: Any, name: str, least: int = 0) -> int:
    """An argument that is an integer, NumPy's as well. Raises TypeError or ValueError."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} = {value!r}: an integer, not {type(value).__name__}") from None
    if number < least:
        raise ValueError(f"{name} = {value!r}: at least {least}")
    return number


def above_zero(value: Any, name: str) -> float:
    """An argument that is a finite number above 0. Raises TypeError or ValueError."""
    number = float(typed(value, name, numbers.Real, "a number"))
    if not 0.0 < number < float("inf"):
        raise ValueError(f"{name} = {value!r}: a finite number above 0")
    return number


def refusal(code: str, file: str, why: str, *, key: str = "", value: str = "", admissible: str = "",
            nearest: str = "", line: int = 0, column: int = 0,
            kind: type[SceneError] = SceneError) -> SceneError:
    """An error with one fault, whose text is put together as the program does it."""
    location = f"{file}:{line}:{column}" if line else file
    text = f"{location}: error: " + (f"{key}{f' = {value}' if value else ''}: " if key else "") + why
    text += f"; expected: {admissible}" if admissible else ""
    text += f'; did you mean "{nearest}"?' if nearest else ""
    return kind([Fault(code, file, line, column, key, value, why, admissible, nearest,
                       f"{text} [{code}]")])


def nearest_name(name: str, known: Iterable[str]) -> str:
    """The known name that was probably meant; empty where none is close."""
    return next(iter(difflib.get_close_matches(name, list(known), 1)), "")


def listed(names: Iterable[str], most: int = 20) -> str:
    """The first names, for a message."""
    all_names = list(names)
    return ", ".join(all_names[:most]) + (", ..." if len(all_names) > most else "")


def no_such_name(name: str, known: Iterable[str], owner: str) -> QuantityError:
    """Of a sweep or a result, with the nearest name."""
    names = list(known)
    nearest = nearest_name(name, names)
    why = f"the {owner} has no such name"
    admissible = listed(names)
    hint = f'; did you mean "{nearest}"?' if nearest else f"; expected: {admissible}"
    return QuantityError([Fault("observable.unknown", owner, 0, 0, name, "", why, admissible, nearest,
                                f"{owner}: error: {name}: {why}{hint}")])


class OutputError(Error, OSError):
    """A file could not be written or read."""


class RunError(Error, RuntimeError):
    """A run has failed, the code of a plugin has thrown, or a sweep has lost a worker."""
