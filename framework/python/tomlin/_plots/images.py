"""Images of scan lines: a column in colours over two others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tomlin._errors import refusal
from tomlin._plots.figure import Figure, Panel, Raster, scale_equally
from tomlin._plots.labels import check_unit_names
from tomlin._plots.quantities import Owners, Series, find_series
from tomlin._plots.runs import Run
from tomlin._tables import Array

MOST_PIXELS = 1000  #: along an axis
_MOST_BY_DEFAULT = 256
SCANS = ("forward", "backward", "both")


@dataclass
class RasterRequest:
    """A column as colours over two others."""

    x: str
    y: str
    value: str
    owners: Owners = field(default_factory=Owners)
    scan: str = "both"
    pixels: tuple[int, int] | None = None


def _of_scan(x: Array, scan: str) -> tuple[Any, int]:
    """Selects the samples that are shown, and counts the strokes in which they were taken. The first
    samples count to the stroke of those that follow."""
    change = np.r_[0.0, np.diff(x)]
    moves = np.flatnonzero(change)
    last = np.maximum.accumulate(np.where(change != 0.0, np.arange(len(x)), -1))
    last[last < 0] = moves[0] if len(moves) else 0
    forward = change[last] >= 0.0
    shown = np.ones(len(x), bool) if scan == "both" else forward == (scan == "forward")
    begins = np.r_[True, forward[1:] != forward[:-1]]
    return shown, int((begins & shown).sum())


def _line_count(y: Array) -> int:
    """How many values of y there are; values closer than rounding are one."""
    rounding = 1e-9
    values = np.sort(y)
    return 1 + int((np.diff(values) > rounding * (values[-1] - values[0])).sum())


def _edges_of_lines(low: float, high: float, lines: int) -> Array:
    """Pixels whose outer centres are at the ends: the values are those of lines."""
    half = 0.5 * (high - low) / (lines - 1)
    return np.linspace(low - half, high + half, lines + 1)


def raster_figure(runs: Sequence[Run], request: RasterRequest, notes: list[str]) -> Figure:
    """The samples of all runs on a grid; a pixel has the mean of the samples in it."""
    height, fewest, per_pixel = 400.0, 2, 2
    found: list[list[Series]] = []
    points: list[Array] = []
    strokes = 0
    for run in runs:
        series = [find_series(run.samples, name, request.owners, option) for name, option in (
            (request.x, "--x"), (request.y, "--y"), (request.value, "--value"))]
        for first, other in zip(found[0] if found else series, series):
            if first.unit != other.unit:
                raise refusal("command.invalid_value", run.samples.file,
                              f"[{other.unit}], beside [{first.unit}] of another folder",
                              key=other.name, admissible="one unit to an axis")
        found.append(series)
        shown, count = _of_scan(series[0].values, request.scan)
        strokes += count
        points.append(np.stack([one.values[shown] for one in series]))
    for one in found[0]:
        check_unit_names(runs, one.unit)
    x, y, values = np.concatenate(points, axis=1)
    if not len(x):
        raise refusal("plot.no_data", "--scan", f"{request.x} never goes this way",
                      key=request.scan, admissible="the other direction, or both")
    for option, name, numbers in (("--x", request.x, x), ("--y", request.y, y)):
        if numbers.min() == numbers.max():
            raise refusal("plot.no_data", option,
                          f"it is {numbers[0]:g} in every sample: an image has two extents",
                          key=name,
                          admissible="a column that differs between samples or folders")
    low, high, lines = float(y.min()), float(y.max()), _line_count(y)
    if request.pixels:
        columns, rows = request.pixels
        of_lines = lines == rows
    else:
        of_lines = lines <= _MOST_BY_DEFAULT
        rows = lines if of_lines else min(max(strokes, fewest), _MOST_BY_DEFAULT)
        columns = min(max(len(x) // (per_pixel * rows), fewest), _MOST_BY_DEFAULT)
    y_edges = _edges_of_lines(low, high, rows) if of_lines else np.linspace(low, high, rows + 1)
    x_edges = np.linspace(float(x.min()), float(x.max()), columns + 1)

    def pixel(numbers: Array, edges: Array) -> Any:
        share = (numbers - edges[0]) / (edges[-1] - edges[0])
        return np.clip(np.floor(share * (len(edges) - 1)), 0, len(edges) - 2).astype(int)

    at = pixel(y, y_edges) * columns + pixel(x, x_edges)
    counts = np.bincount(at, minlength=rows * columns)
    sums = np.bincount(at, weights=values, minlength=rows * columns)
    means = np.where(counts > 0, sums / np.maximum(counts, 1), np.nan).reshape(rows, columns)
    if (counts == 0).any():
        notes.append(f"{int((counts == 0).sum())} of {counts.size} pixels ({columns}x{rows}) have no "
                     "sample in them and stay white")
    labels = [one.axis(runs[0], in_words=True) for one in found[0]]
    panel = Panel(labels[1], height, y_range=(y_edges[0], y_edges[-1]),
                  raster=Raster(x_edges, y_edges, means, labels[2]))
    figure = Figure(labels[0], [panel], (x_edges[0], x_edges[-1]))
    same = found[0][0].unit == found[0][1].unit
    return scale_equally(figure, 0.0) if same else figure
