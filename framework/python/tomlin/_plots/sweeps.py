"""Sweeps: curves of observables over an axis, and maps over two."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from tomlin._errors import QuantityError, listed, nearest_name, refusal
from tomlin._plots.figure import Curve, Figure, Panel, Raster, with_margin
from tomlin._plots.images import MOST_PIXELS
from tomlin._plots.labels import axis_text, dimension_words, parameter_text, result_text, unit_name
from tomlin._plots.results import range_with_errors
from tomlin._plots.runs import Run, read_json, read_toml
from tomlin._tables import Array, TextTable, drawable, number_in, one_line

if TYPE_CHECKING:
    from tomlin._sweep import Sweep

_HEIGHT, _HEIGHT_OF_SEVERAL, _MAP_HEIGHT = 360.0, 170.0, 400.0
_MOST_CURVES = 50
_MOST_MARKS = 100  # of a curve; a longer one is a line alone
_SAME_NUMBER = 5e-3  # relative: nobody writes all digits of a grid's
_ENDING = ("status", "reason")


@dataclass
class Axis:
    """One name with its values at all points of the sweep: numbers, or words."""

    name: str
    dimension: int
    logarithmic: bool
    at_points: NDArray[Any]

    def __post_init__(self) -> None:
        #: The values that there are, in the order in which they come, and which of them a point has.
        values, first, index = np.unique(self.at_points, return_index=True, return_inverse=True)
        order = np.argsort(first)
        self.values = values[order]
        self.index: NDArray[Any] = np.argsort(order)[index]

    @property
    def is_numeric(self) -> bool:
        return self.at_points.dtype.kind == "f"

    def shown(self, k: int) -> str:
        return f"{self.values[k]:.6g}" if self.is_numeric else str(self.values[k])


@dataclass
class StoredSweep:
    """A sweep as a table: a row for each point."""

    run: Run  #: what all points share: folder and names of units
    axes: list[Axis]
    units: dict[str, str]  #: of each observable, errors and spreads among them
    columns: dict[str, Array]
    refined: str = ""  #: the axis along which points were added: they make no grid

    def axis(self, name: str) -> Axis | None:
        return next((one for one in self.axes if one.name == name), None)


def holds_sweep(folder: str) -> bool:
    """Whether this is the folder of a sweep, finished or not."""
    return any(os.path.isfile(os.path.join(folder, name))
               for name in ("sweep.journal", "sweep.csv"))


def read_sweep(folder: str) -> StoredSweep:
    """Raises SceneError when the sweep is not finished, or its files do not belong together."""
    file, about = os.path.join(folder, "sweep.csv"), os.path.join(folder, "sweep.json")
    if not os.path.isfile(file):
        raise refusal("plot.no_data", folder, "the sweep is not finished; the same `tomlin sweep` "
                      "command continues it")
    summary = read_json(about)
    try:
        axes = [(str(one["name"]), int(one["dimension"]), one["spacing"] == "logarithmic",
                 [type(value) for value in one.get("values", [0.0])]) for one in summary["axes"]]
        points = int(summary["points"])
        refine = summary.get("refine")
        refined = str(refine["along"]) if refine else ""
    except (TypeError, LookupError, ValueError):
        raise refusal("file.invalid", about, "this is not the summary of a sweep") from None
    table = TextTable(file)
    if table.names[-2:] != list(_ENDING):
        raise table.invalid("this is not the table of a sweep", 'a header that ends with "reason"')
    names = [name for name, *_ in axes]
    if not axes or table.names[:len(axes)] != names or len(table.names) <= len(axes) + len(_ENDING):
        raise refusal("file.damaged", file, "it is not the table of the sweep of sweep.json")
    if len(table.rows) != points:
        raise refusal("file.damaged", file,
                      f"{len(table.rows)} rows, and sweep.json has {points} points")
    found = [Axis(name, dimension, log, table.numbers(k) if set(types) <= {int, float}
                  else np.array(table.words(k)))
             for k, (name, dimension, log, types) in enumerate(axes)]
    scene = read_toml(os.path.join(folder, "scene.toml")).get("scene", {})
    units = scene.get("axes", {}) if isinstance(scene, dict) else {}
    run = Run(folder, system="metal" if scene.get("units") == "metal" else "reduced",
              units={key: unit for key, unit in units.items() if isinstance(unit, str)})
    observables = range(len(axes), len(table.names) - len(_ENDING))
    return StoredSweep(run, found, {table.columns[k][0]: table.columns[k][1] for k in observables},
                       {table.names[k]: table.numbers(k) for k in observables}, refined)


def sweep_in_memory(sweep: Sweep) -> StoredSweep:
    """A sweep of this process."""
    core = sweep._scene._core
    grid = np.indices(sweep.shape).reshape(len(sweep.shape), -1)
    axes = []
    refined = str(sweep.summary.get("refine", {}).get("along", "")) if sweep._summary else ""
    for d, names in enumerate(sweep._of_dimension):
        for k, name in enumerate(names):
            values = np.asarray(sweep.axes[name])
            # Points of a refined sweep are in one dimension, each axis is one of its own.
            axes.append(Axis(name, k if refined else d, _is_logarithmic(values),
                             (values.astype(float) if values.dtype.kind in "iuf" else values)[
                                 grid[d]]))
    return StoredSweep(Run(str(sweep.folder or "the sweep"), system=core.units,
                           units={key: unit for key, unit in core.axes.items() if unit}),
                       axes, sweep.units, {name: np.asarray(values).ravel()
                                           for name, values in sweep.columns.items()}, refined)


def _is_logarithmic(values: NDArray[Any]) -> bool:
    """Whether numbers are spaced so."""
    if values.dtype.kind not in "fi" or len(values) < 3 or not (values > 0).all():
        return False
    ratios = values[1:] / values[:-1]
    return bool(np.ptp(ratios) < 1e-6 * abs(ratios[0]) and abs(ratios[0] - 1.0) > 1e-6)


@dataclass
class SweepRequest:
    """The axes and observables that are drawn, by name; empty: the default."""

    x: str = ""
    y: list[list[str]] = field(default_factory=list)  #: an axis, or observables by panel
    value: str = ""
    minimum_along: str = ""
    at: list[tuple[str, str]] = field(default_factory=list)
    log: str | None = None  #: "x", "y", "xy", "none"; None: as the grids are


class _Drawing:
    def __init__(self, sweep: StoredSweep, request: SweepRequest, notes: list[str]):
        self.sweep, self.request, self.notes = sweep, request, notes
        self.shown = np.ones(len(sweep.axes[0].at_points), bool)  # by point
        self.fixed: dict[int, str] = {}  # by dimension: "k = 2"
        for numbers in [*sweep.columns.values(), *(one.at_points for one in sweep.axes
                                                   if one.is_numeric)]:
            drawable(numbers, sweep.run.file("sweep.csv"))
        self.counts = {"undefined": 0, "not positive": 0, "all": 0}
        for name, value in request.at:
            self._fix(name, value)

    def figure(self) -> Figure:
        request = self.request
        for_map = "--value" if request.value else "--minimum-along" if request.minimum_along else ""
        upwards = len(request.y) == 1 and len(request.y[0]) == 1 and self.sweep.axis(
            request.y[0][0]) is not None
        many = [one for one in self._free() if len(one.values) > 1]
        is_map = not request.y and (bool(for_map) or (len(many) > 1 and not self.sweep.refined))
        if upwards or is_map:
            return self._map(request.y[0][0] if upwards else "")
        if for_map:
            raise refusal("command.conflict", "tomlin", "not for curves of observables",
                          key=for_map, admissible="--y with an axis, or without --y")
        return self._curves()

    def _refuse_name(self, name: str, why: str, known: Sequence[str]) -> NoReturn:
        raise refusal("plot.no_data", self.sweep.run.folder, why, key=one_line(name),
                      admissible=listed(known), nearest=nearest_name(name, known),
                      kind=QuantityError)

    def _axis_named(self, name: str) -> Axis:
        axis = self.sweep.axis(name)
        if axis is None:
            self._refuse_name(name, "the sweep has no such axis",
                              [one.name for one in self.sweep.axes])
        return axis

    def _observable_named(self, name: str) -> str:
        """A column by its name, or with the family of the result in front of it."""
        columns = self.sweep.columns
        names = [name, name.partition(".")[2], f"drivers.{name}", f"bodies.{name}"]
        for one in names:
            if one in columns:
                return one
        self._refuse_name(name, "the sweep has no such observable",
                          [*columns, *(one.name for one in self.sweep.axes)])

    def _fix(self, name: str, text: str) -> None:
        axis = self._axis_named(name)
        if axis.dimension in self.fixed:
            raise refusal("command.conflict", self.sweep.run.folder, f"two values for {name}",
                          key="--at", admissible="one")
        known = [axis.shown(k) for k in range(len(axis.values))]
        if axis.is_numeric:
            wanted = number_in(text)
            off = np.abs(axis.values - wanted)
            same = (off == 0.0) | (off < _SAME_NUMBER * np.abs(axis.values))
            found = int(np.where(same, off, np.inf).argmin())
        else:
            same = np.array([one == text for one in known])
            found = int(same.argmax())
        if not same.any():
            self._refuse_name(f"{name}={text}", "the axis has no such value", known)
        self.shown &= axis.index == found
        self.fixed[axis.dimension] = f"{name} = {known[found]}"

    def _free(self) -> list[Axis]:
        """An axis with numbers of each dimension that is not fixed; those with several values
        first."""
        first: dict[int, Axis] = {}
        for axis in self.sweep.axes:
            if axis.is_numeric and axis.dimension not in self.fixed:
                first.setdefault(axis.dimension, axis)
        return sorted(first.values(), key=lambda axis: len(axis.values) == 1)

    def _refuse_axes(self, why: str) -> NoReturn:
        counts = [(one.name, len(one.values)) for one in self.sweep.axes]
        all_axes = ", ".join(f"{name} ({n} value{'s' * (n != 1)})" for name, n in counts)
        raise refusal("command.missing_argument", self.sweep.run.folder,
                      f"{why}; the sweep is over {all_axes}",
                      admissible="--at NAME=VALUE for an axis that is not shown; a sweep with fewer "
                      "axes")

    def _drawn(self, name: str, other: int | None) -> Axis:
        """The axis of this name, or the first that is free and not along `other`."""
        if not name:
            found = [one for one in self._free() if one.dimension != other]
            if not found:
                self._refuse_axes("no axis is left" if other is None else "a map takes two axes")
            return found[0]
        axis = self._axis_named(name)
        for wrong, why, admissible in (
                (axis.dimension in self.fixed, "--at gives this axis one value", "another axis"),
                (axis.dimension == other, "both axes have their values together", "another axis"),
                (not axis.is_numeric, "its values are not numbers", "an axis of numbers")):
            if wrong:
                raise refusal("command.conflict", self.sweep.run.folder, why, key=name,
                              admissible=admissible)
        return axis

    def _is_log(self, axis: Axis, letter: str) -> bool:
        return axis.logarithmic if self.request.log is None else letter in self.request.log

    def _lines(self, along: Sequence[Axis]) -> list[NDArray[Any]]:
        """The points that are shown, by line: they differ along these axes alone."""
        dimensions = {axis.dimension for axis in along}
        others = [axis.index for axis in self.sweep.axes if axis.dimension not in dimensions]
        keys = np.stack([*others, np.zeros(len(self.shown), int)], axis=1)[self.shown]
        points = np.flatnonzero(self.shown)
        _, first, group = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        group = group.ravel()
        return [points[group == group[at]] for at in np.sort(first)]

    def _note(self, what: str, text: str) -> None:
        if self.counts[what] == self.counts["all"]:
            raise refusal("plot.no_data", self.sweep.run.folder, "there is no number to draw")
        if self.counts[what]:
            self.notes.append(f"{self.counts[what]} of {self.counts['all']} numbers {text}")

    def _label(self, x: Axis, line: NDArray[Any]) -> str:
        """"k = 2, v = 0.1": the axes that are neither along x nor fixed."""
        return ", ".join(f"{one.name} = {one.shown(one.index[line[0]])}" for one in self.sweep.axes
                         if one.dimension != x.dimension and one.dimension not in self.fixed
                         and len(one.values) > 1)

    def _curve(self, column: str, x: Axis, line: NDArray[Any], log_x: bool, log_y: bool) -> Curve:
        """The points of a line, broken where there is no number to draw."""
        line = line[np.argsort(x.at_points[line], kind="stable")]
        across, numbers = x.at_points[line].astype(float), self.sweep.columns[column][line]
        undefined = np.isnan(numbers)
        off = ~undefined & (((across <= 0.0) & log_x) | ((numbers <= 0.0) & log_y))
        self.counts["all"] += len(line)
        self.counts["undefined"] += int(undefined.sum())
        self.counts["not positive"] += int(off.sum())
        y = np.where(undefined | off, np.nan, numbers)
        across = np.where(off & (across <= 0.0), np.nan, across)
        errors = self.sweep.columns.get(f"error.{column}")
        return Curve(across, y, self._label(x, line), error=None if errors is None else errors[line],
                     mark="" if len(x.values) > _MOST_MARKS else "o")

    def _panel(self, names: Sequence[str], x: Axis, lines: Sequence[NDArray[Any]], height: float,
               log_x: bool) -> Panel:
        sweep, log_y = self.sweep, "y" in (self.request.log or "")
        columns = [self._observable_named(name) for name in names]
        unit = sweep.units[columns[0]]
        for column in columns:
            if sweep.units[column] != unit:
                raise refusal("command.invalid_value", sweep.run.file("sweep.csv"),
                              f"[{sweep.units[column]}], on one axis with [{unit}]",
                              key=f"--y {column}",
                              admissible="one unit to an axis; another --y makes another panel")
        label = (result_text(sweep.run, columns[0]) if len(columns) == 1 else
                 axis_text(dimension_words(sweep.run, unit), "", unit_name(sweep.run, unit)))
        panel = Panel(label, height)
        for line in lines:
            for column in columns:
                curve = self._curve(column, x, line, log_x, log_y)
                if len(columns) > 1:
                    curve.label = ", ".join(filter(None, [column, curve.label]))
                if np.isnan(curve.y).all():
                    curve.label = ""
                curve.colour = len(panel.curves)
                panel.curves.append(curve)
        if all(np.isnan(one.y).all() for one in panel.curves):
            raise refusal("plot.no_data", sweep.run.folder, "there is no number to draw")
        panel.y_range = range_with_errors(panel.curves, log_y)
        return panel

    def _curves(self) -> Figure:
        sweep, request = self.sweep, self.request
        refined = sweep.axis(sweep.refined) if sweep.refined else None
        name = request.x
        if refined is not None and not name and refined.dimension not in self.fixed:
            name = refined.name
        x = self._drawn(name, None)
        lines = self._lines([x])
        if len(lines) > _MOST_CURVES:
            self._refuse_axes(f"more than {_MOST_CURVES} curves")
        panels = request.y or [[next(iter(sweep.columns))]]
        log_x = self._is_log(x, "x")
        height = _HEIGHT if len(panels) == 1 else _HEIGHT_OF_SEVERAL
        figure = Figure(parameter_text(x.name),
                        [self._panel(names, x, lines, height, log_x) for names in panels],
                        log_x=log_x, log_y="y" in (request.log or ""))
        figure.panels[0].title = ", ".join(self.fixed.values())
        all_x = np.concatenate([one.x[~np.isnan(one.y)] for panel in figure.panels
                                for one in panel.curves])
        figure.x_range = with_margin(float(all_x.min()), float(all_x.max()), log_x)
        self._note("undefined", "are undefined, and left out")
        self._note("not positive", "are not positive, and not on a logarithmic axis")
        return figure

    def _edges(self, axis: Axis, logarithmic: bool) -> Array:
        """Limits of cells around values that rise: halfway between neighbours, as the axis counts."""
        values = np.sort(axis.values)
        below_zero = logarithmic and values[0] <= 0.0
        if below_zero or len(values) > MOST_PIXELS:
            why = (f"{values[0]:g} is on no logarithmic axis" if below_zero else
                   f"{len(values)} values: a map has at most {MOST_PIXELS} along an axis")
            raise refusal("command.conflict", self.sweep.run.folder, why, key=axis.name,
                          admissible="--log none; curves, by --y")
        if len(values) == 1:
            return np.array(with_margin(values[0], values[0], logarithmic))
        if logarithmic:
            values = np.log(values)
        middle = 0.5 * (values[1:] + values[:-1])
        edges: Array = np.r_[1.5 * values[0] - 0.5 * values[1], middle,
                             1.5 * values[-1] - 0.5 * values[-2]]
        return np.exp(edges) if logarithmic else edges

    def _map(self, above: str) -> Figure:
        sweep, request = self.sweep, self.request
        if sweep.refined:
            raise refusal("command.conflict", sweep.run.folder,
                          "the sweep is refined along it, and its points make no grid for a map",
                          key=sweep.refined, admissible="curves, by --y with an observable")
        known = None
        if above and not request.x:
            known = self._axis_named(above).dimension
        x = self._drawn(request.x, known)
        y = self._drawn(above, x.dimension)
        if len(self._lines([x, y])) > 1:
            self._refuse_axes("a map has no third axis")
        column = self._observable_named(request.value or next(iter(sweep.columns)))
        log_x, log_y = self._is_log(x, "x"), self._is_log(y, "y")
        points = np.flatnonzero(self.shown)
        if len(points) > len(x.values) * len(y.values):
            twice = x if len(np.unique(x.at_points)) * len(y.values) < len(points) else y
            raise refusal("command.conflict", sweep.run.folder,
                          "it has a value twice: a map shows each value once", key=twice.name,
                          admissible="another axis; curves, by --y")
        x_edges, y_edges = self._edges(x, log_x), self._edges(y, log_y)
        values = np.full((len(y.values), len(x.values)), np.nan)
        values[np.searchsorted(np.sort(y.values), y.at_points[points]),
               np.searchsorted(np.sort(x.values), x.at_points[points])] = sweep.columns[column][
                   points]
        self.counts.update(undefined=int(np.isnan(values).sum()), all=values.size)
        self._note("undefined", "are undefined, and their cells stay white")
        panel = Panel(parameter_text(y.name), _MAP_HEIGHT, y_range=(y_edges[0], y_edges[-1]),
                      title=", ".join(self.fixed.values()),
                      raster=Raster(x_edges, y_edges, values, result_text(sweep.run, column)))
        if request.minimum_along:
            panel.curves = [self._minimum(x, y, values)]
        return Figure(parameter_text(x.name), [panel], (x_edges[0], x_edges[-1]), log_x, log_y)

    def _minimum(self, x: Axis, y: Axis, values: Array) -> Curve:
        """The point of the least value along one axis, for each value of the other."""
        name = self.request.minimum_along
        axis = self._axis_named(name)
        if axis not in (x, y):
            self._refuse_name(name, "the map has no such axis", [x.name, y.name])
        along, other = (x, y) if axis is x else (y, x)
        rows = values if axis is x else values.T
        least = np.where(np.isnan(rows), np.inf, rows).argmin(axis=1)
        empty = np.isnan(rows).all(axis=1)
        here = np.where(empty, np.nan, np.sort(along.values)[least])
        there = np.where(empty, np.nan, np.sort(other.values))
        at_an_end = int((((least == 0) | (least == len(along.values) - 1)) & ~empty).sum())
        if at_an_end:
            self.notes.append(f"at {at_an_end} of {len(other.values)} values of {other.name} the "
                              f"least number is at an end of {name}")
        mark = "" if len(other.values) > _MOST_MARKS else "o"
        # The second colour is seen on dark ones.
        return Curve(*((here, there) if axis is x else (there, here)), f"minimum along {name}", 1,
                     mark=mark)


def sweep_figure(sweep: StoredSweep, request: SweepRequest, notes: list[str]) -> Figure:
    """Curves or a map, as the request and the axes have it."""
    return _Drawing(sweep, request, notes).figure()
