"""Texts of figures: quantities, their symbols, the names of units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from tomlin import _core
from tomlin._errors import refusal
from tomlin._tables import one_line

if TYPE_CHECKING:
    from tomlin._plots.runs import Run

# Dimensions that results spell out, by the key of `axes`.
_SPELLED = {"length/time": "velocity", "mass*length/time^2": "force",
            "mass*length^2/time^2": "energy", "temperature": "energy"}
# The symbols of metal units, in tables, by the dimension that they stand for.
_METAL = {"length": "A", "time": "ps", "mass": "u", "velocity": "A/ps", "force": "eV/A",
          "energy": "eV", "stiffness": "eV/A^2", "temperature": "K"}
_INDEXED = re.compile(r"([A-Za-z0-9]+|[^\x00-\x7f]+)([_^])(-?[A-Za-z0-9]+)")

# Columns of vectors in words; the symbol stands before the axis.
_WORDED = {"position": ("support position", ""), "force": ("force", "F_"),
           "centre_of_mass": ("centre of mass", ""), "velocity": ("velocity", "v_")}


def literal(text: str, most: int = 200) -> str:
    """A text that is shown as it is, whatever it means to matplotlib."""
    return one_line(text, most).replace("$", r"\$")


def _unit_text(unit: str) -> str:
    """"V_0/a" with an index."""
    return _INDEXED.sub(lambda found: rf"$\mathregular{{{found[1]}{found[2]}{{{found[3]}}}}}$",
                        literal(unit))


def in_brackets(unit: str) -> str:
    """A unit as a divisor has brackets if it has signs of its own."""
    return f"({unit})" if set(unit) & set("/* ") else unit


def _metal_symbol(dimension: str) -> str:
    """"eV/\u00c5^2" of "eV/A^2" or of "stiffness"; empty of a pure number and of any other text."""
    symbol = _METAL.get(dimension, _METAL.get(_SPELLED.get(dimension, ""), dimension))
    known = set(re.split(r"[*/]|\^\d+", symbol)) <= {"eV", "u", "A", "ps", "K", "1", ""}
    return re.sub(r"\bA\b", "\u00c5", symbol.replace("*", " ")) if known and symbol != "1" else ""


def unit_name(run: Run, dimension: str) -> str:
    """The name that the scene of a run gives to the unit of a table or a result; empty where it has
    none."""
    if dimension == "rad":
        return "rad"
    if run.system == "metal":
        return _metal_symbol(dimension)
    key = _SPELLED.get(dimension, dimension)
    unit = run.units.get(key, "")
    if unit or key != "velocity":
        return unit
    length, time = run.units.get("length", ""), run.units.get("time", "")
    return f"{in_brackets(length)}/{in_brackets(time)}" if length and time else ""


def dimension_words(run: Run, unit: str) -> str:
    """The words for an axis of several curves."""
    if unit == "1":
        return ""
    if run.system != "metal":
        return literal(unit)
    return next((words for words, symbol in _METAL.items() if symbol == unit), "")


def axis_text(words: str, symbol: str = "", unit: str = "") -> str:
    """"lateral force F_x / (V_0/a)" of words and a symbol in matplotlib's terms."""
    text = " ".join(filter(None, [words, f"${symbol}$" if symbol else ""]))
    return f"{text} / {_unit_text(in_brackets(unit))}" if unit else text


def column_text(run: Run, name: str, unit: str) -> str:
    """The name of a column as it is."""
    return axis_text(literal(name), "", unit_name(run, unit))


def column_in_words(run: Run, name: str, unit: str) -> str:
    """"support position y" of "driver.position.y"."""
    vector, _, axis = name.rpartition(".")
    words = _WORDED.get(vector.rpartition(".")[2]) if axis in ("x", "y", "z") else None
    if words is None or "." not in vector:
        return column_text(run, name, unit)
    return axis_text(words[0], words[1] + axis, unit_name(run, unit))


def parameter_text(name: str) -> str:
    """A letter or a word as a symbol; a dotted path as it is."""
    is_word = name.isascii() and name.isalnum()
    return axis_text("", rf"\mathit{{{name}}}") if is_word else literal(name)


def result_text(run: Run, path: str) -> str:
    """"mean force along x / (V_0/a)" of "drivers.driver.mean_force.x"."""
    for kind in ("error", "spread"):
        if path.startswith(f"{kind}."):
            return f"{kind} of the {result_text(run, path[len(kind) + 1:])}"
    found = _core.quantity(path, run.system)
    if found is None:
        return literal(path)
    key, unit = found
    axis = path[-1] if path[-2:] in (".x", ".y", ".z") else ""
    return axis_text(key.replace("_", " ") + (" along" if axis else ""), axis, unit_name(run, unit))


def check_unit_names(runs: Sequence[Run], dimension: str) -> None:
    """Raises SceneError where the scenes of the runs call the unit of an axis differently."""
    first = unit_name(runs[0], dimension)
    for run in runs:
        unit = unit_name(run, dimension)
        if unit == first:
            continue
        without, other = (run, runs[0]) if first else (runs[0], run)
        name = unit if first and unit else "no name"
        raise refusal("command.conflict", f"{without.folder}/summary.json",
                      f"{name} for the unit of {dimension}, on one axis with {first or unit} of "
                      f"{other.folder}", key="scene.axes",
                      admissible="folders whose scenes name the units of the axis alike")
