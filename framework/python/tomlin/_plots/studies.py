"""Figures of studies: error against cost, and models side by side."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tomlin._errors import refusal
from tomlin._plots.figure import GREY, Curve, Figure, Panel
from tomlin._plots.labels import literal
from tomlin._tables import Array, TextTable

_FLOOR = 0.1  # of the reference's own error: what is below has no meaning
_SMALLEST = 1e-17  # of an error


def _decades(values: Sequence[float]) -> tuple[float, float]:
    """Whole powers of ten around numbers."""
    return (10.0 ** math.floor(math.log10(min(values))), 10.0 ** math.ceil(math.log10(max(values))))


def tradeoff_figure(tradeoff: Mapping[str, Any]) -> Figure:
    """The work-precision diagram: error against cost, a line for each method, with the tolerance,
    the reference's own error and the recommended point."""
    points, reference = tradeoff["points"], tradeoff["reference"]
    if not points or reference is None:
        raise refusal("plot.no_data", "tradeoff", "there is no point to draw")
    unit = tradeoff["error_unit"]
    floor = max(_FLOOR * reference["error"] / unit, _SMALLEST)

    def position(point: Mapping[str, Any]) -> tuple[float, float]:
        return float(max(point["cost"], 1)), max(float(point["error"]) / unit, floor)

    tolerance = float(tradeoff["tolerance"])
    positions = [position(one) for one in points]
    x_range = _decades([x for x, _ in positions])
    y_range = _decades([*(y for _, y in positions), tolerance])
    error = "relative error" if tradeoff["relative"] else "error"
    panel = Panel(f"{error} of {literal(str(tradeoff['observable']))}", 400.0, y_range=y_range)
    colours: dict[str, int] = {}
    for method in dict.fromkeys(one["rung"] for one in points):
        x, y = np.array([at for one, at in zip(points, positions) if one["rung"] == method]).T
        # Another number type lies on the line of its scheme: no more than marks.
        scheme, _, number_type = str(method).partition(" in ")
        colour = colours.setdefault(scheme, len(colours))
        doubles = not number_type
        panel.curves.append(Curve(x, y, str(method), colour, line=doubles,
                                  mark="o" if doubles else "s", mark_size=2.7 if doubles else 5.5))
    for level, label, dashed in ((tolerance, f"tolerance {tolerance:g}", True),
                                 (reference["error"] / unit, "error of the reference", False)):
        if y_range[0] <= level <= y_range[1]:
            panel.curves.append(Curve(np.array(x_range), np.full(2, level), label, GREY,
                                      dashed=dashed))
    if tradeoff["recommendation"]:
        at = position(tradeoff["recommendation"])
        panel.curves.append(Curve(np.array(at[:1]), np.array(at[1:]), "recommended", 1, line=False,
                                  mark="^", mark_size=9.5))
    return Figure("force evaluations and Jacobian columns", [panel], x_range, True, True)


def compare_figure(curves: Sequence[tuple[str, Array, Array]], length: str, force: str) -> Figure:
    """The forces of the drivers along the pull over their displacement; models without a driver
    have no curve."""
    drawn = [Curve(way, force_along, name, k) for k, (name, way, force_along) in enumerate(curves)
             if len(way)]
    if not drawn:
        raise refusal("plot.no_data", "compare", "no model has a driver")
    return Figure(f"displacement of the driver [{length}]",
                  [Panel(f"lateral force along the pull [{force}]", 360.0, drawn)])


def read_comparison(file: str) -> Figure:
    """Reads `curves.csv`: number and name of a model, displacement and force."""
    table = TextTable(file)
    if table.names != ["model", "name", "displacement", "force"]:
        raise table.invalid("this is no table of curves")
    models, names = table.numbers(0), table.words(1)
    way, force = table.numbers(2), table.numbers(3)
    curves = [(names[int(np.flatnonzero(models == one)[0])], way[models == one], force[models == one])
              for one in np.unique(models)]
    return compare_figure(curves, table.columns[2][1], table.columns[3][1])
