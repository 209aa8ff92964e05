"""Curves of samples: a quantity over another, and friction loops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from tomlin._errors import refusal
from tomlin._plots.figure import (GREY, Arrow, Curve, Figure, Panel, Span, scale_equally,
                                  with_margin)
from tomlin._plots.labels import axis_text, check_unit_names, dimension_words, unit_name
from tomlin._plots.quantities import Owners, Series, chosen_owner, find_series
from tomlin._plots.runs import Run
from tomlin._record import AXES
from tomlin._tables import Array


@dataclass
class CurvesRequest:
    """Quantities that are drawn over another: a panel for each list of names."""

    x: str
    y: list[list[str]]
    owners: Owners = field(default_factory=Owners)
    start: float | None = None
    end: float | None = None
    log_x: bool = False
    log_y: bool = False
    to_scale: bool = False
    in_words: bool = False  #: names of columns


@dataclass
class _RunCurves:
    x: Series
    panels: list[list[Series]]


def _is_at_v_t(position: Array, time: Array) -> bool:
    """Whether the support is at v t, from the beginning."""
    rounding = 1e-9  # of the distance travelled: positions are rounded to less than that
    if not time[-1] > 0.0:
        return True
    off = np.abs(position - position[-1] / time[-1] * time)
    return bool((off <= rounding * abs(position[-1])).all())


def _read_curves(run: Run, request: CurvesRequest) -> _RunCurves:
    table = run.samples
    curves = _RunCurves(find_series(table, request.x, request.owners, "--x"),
                        [[find_series(table, name, request.owners, "--y") for name in names]
                         for names in request.y])
    for series in [curves.x, *(one for panel in curves.panels for one in panel)]:
        if series.name == "driver_position" and not _is_at_v_t(series.values, table["time"]):
            series.words, series.symbol = "support position", "X"
    return curves


def _check_unit(run: Run, option: str, first: Series, other: Series) -> None:
    """Numbers of different units have no axis in common."""
    if first.unit != other.unit:
        raise refusal("command.invalid_value", run.samples.file,
                      f"[{other.unit}], on one axis with {first.name} [{first.unit}]",
                      key=f"{option} {other.name}",
                      admissible="one unit to an axis; another --y makes another panel")


def _shown_range(all_curves: Sequence[_RunCurves], request: CurvesRequest) -> Span:
    x = np.concatenate([one.x.values for one in all_curves])
    drawn = x[x > 0.0] if request.log_x else x
    if not len(drawn):
        raise refusal("plot.no_data", "--log", "no number is positive", key=request.x,
                      admissible="a linear axis")
    if request.log_x and request.start is not None and not request.start > 0.0:
        raise refusal("command.invalid_value", "--from", "a logarithmic axis begins above zero",
                      key=f"{request.start:g}", admissible="a positive number")
    whole = float(drawn.min()), float(drawn.max())
    start = whole[0] if request.start is None else request.start
    end = whole[1] if request.end is None else request.end
    if not ((x >= start) & (x <= end)).any():
        raise refusal("plot.no_data", "--from" if request.start is not None else "--to",
                      f"there is no sample from {start:g} to {end:g}",
                      admissible=f"{request.x} from {whole[0]:g} to {whole[1]:g}")
    return (start, end) if start < end else with_margin(start, end, request.log_x)


def _cut(x: Array, y: Array, shown: Span, request: CurvesRequest) -> tuple[Array, Array, int]:
    """The part of a curve inside a range, with the neighbours that its lines lead to, and how many
    samples are left out. Logarithmic axes cannot show numbers that are not positive: the curve
    breaks there."""
    inside = (x >= shown[0]) & (x <= shown[1])
    wanted = inside | np.r_[False, inside[:-1]] | np.r_[inside[1:], False]
    fits = ((x > 0.0) | (not request.log_x)) & ((y > 0.0) | (not request.log_y))
    kept = wanted & fits
    if kept.all():
        return x, y, 0
    breaks = ~kept & np.r_[False, kept[:-1]] & (np.cumsum(kept[::-1])[::-1] > 0)
    either = kept | breaks
    return (np.where(kept, x, np.nan)[either], np.where(kept, y, np.nan)[either],
            int((wanted & ~fits).sum()))


def _y_label(run: Run, panel: Sequence[Series], alone: bool, in_words: bool) -> str:
    """Several curves' axis has only their dimension in common; a low panel has no room for words."""
    first = panel[0]
    if len(panel) > 1:
        return axis_text(dimension_words(run, first.unit), "", unit_name(run, first.unit))
    if not alone and first.symbol:
        return axis_text("", first.symbol, unit_name(run, first.unit))
    return first.axis(run, in_words)


def curves_figure(runs: Sequence[Run], labels: Sequence[str], request: CurvesRequest,
                  notes: list[str]) -> Figure:
    """One quantity over another, a curve for each run."""
    alone_height, height_of_several = 330.0, 170.0
    all_curves = [_read_curves(run, request) for run in runs]
    first = all_curves[0]
    check_unit_names(runs, first.x.unit)
    for run, curves in zip(runs, all_curves):
        _check_unit(run, "--x", first.x, curves.x)
        for panel, others in zip(first.panels, curves.panels):
            for series in others:
                _check_unit(run, "--y", panel[0], series)
    for panel in first.panels:
        check_unit_names(runs, panel[0].unit)
    shown = _shown_range(all_curves, request)
    # One name for all runs: v t only where the support is there in each.
    x = next((one.x for one in all_curves if one.x.words == "support position"), first.x)
    alone = len(first.panels) == 1
    figure = Figure(x.axis(runs[0], request.in_words), [], shown, request.log_x, request.log_y)
    left_out = 0
    for p, panel in enumerate(first.panels):
        drawn = Panel(_y_label(runs[0], panel, alone, request.in_words),
                      alone_height if alone else height_of_several)
        keys = [series.key for series in panel]
        if len(set(keys)) < len(keys):
            keys = [series.name for series in panel]
        for run_curves, label in zip(all_curves, labels):
            for key, series in zip(keys, run_curves.panels[p]):
                text = ", ".join(filter(None, [key, label])) if len(panel) > 1 else label
                x_cut, y_cut, dropped = _cut(run_curves.x.values, series.values, shown, request)
                left_out += dropped
                drawn.curves.append(Curve(x_cut, y_cut, text, len(drawn.curves)))
        y = np.concatenate([one.y[(one.x >= shown[0]) & (one.x <= shown[1])]
                            for one in drawn.curves])
        if not len(y):
            raise refusal("plot.no_data", "--log", "no number is positive", key=panel[0].name,
                          admissible="a linear axis")
        drawn.y_range = with_margin(float(y.min()), float(y.max()), request.log_y)
        if first.x.name == "driver_position" and len(panel) == 1 and panel[0].name == "position":
            ends = np.array(shown)  # where the spring is not stretched: x_c = v t
            drawn.curves.insert(0, Curve(ends, ends, "", GREY, dashed=True))
        figure.panels.append(drawn)
    if left_out:
        notes.append(f"{left_out} samples are not positive, and not on a logarithmic axis")
    if request.to_scale and first.x.unit == first.panels[0][0].unit:
        scale_equally(figure, 0.04)
    return figure


# Friction loops.

def _components(run: Run, owner: str, vector: str) -> list[Series]:
    return [find_series(run.samples, name, Owners(), "")
            for name in (f"{owner}.{vector}.{axis}" for axis in AXES) if name in run.samples]


def _pull_direction(position: Array) -> Array | None:
    """The direction in which the support first moves; None if it stays. `position` is by axis and
    sample."""
    rounding = 1e-6  # of the farthest distance: what is less is rounding
    moved = position - position[:, :1]
    distances = np.sqrt((moved ** 2).sum(axis=0))
    farthest = int(distances.argmax())
    distance = float(distances[farthest])
    if distance == 0.0:
        return None
    direction: Array = moved[:, farthest] / distance
    along = direction @ moved
    first = along[np.abs(along) > rounding * distance][0]
    return -direction if first < 0.0 else direction


@dataclass
class _Loop:
    x: Array
    y: Array
    length: str
    force: str
    along_x: bool


def _read_loop(run: Run, owners: Owners) -> _Loop:
    driver = chosen_owner(run.samples, "driver", "position.x", owners)
    positions, forces = _components(run, driver, "position"), _components(run, driver, "force")
    if len(forces) != len(positions):
        raise refusal("plot.no_data", run.samples.file, f"there is no column {driver}.force.x")
    position = np.stack([one.values for one in positions])
    direction = _pull_direction(position)
    if direction is None:
        raise refusal("plot.no_data", run.samples.file, "the support does not move",
                      key=f"{driver}.position", admissible="a run whose driver reverses")
    return _Loop(direction @ position, direction @ np.stack([one.values for one in forces]),
                 positions[0].unit, forces[0].unit, direction[0] == 1.0)


def _strokes(x: Array) -> list[tuple[int, int, bool]]:
    """First and last sample of each stroke between two reversals, and whether it goes forward."""
    steps = np.flatnonzero(np.diff(x))
    forward = np.diff(x)[steps] > 0.0
    starts = np.flatnonzero(np.r_[True, forward[1:] != forward[:-1]])
    ends = np.r_[starts[1:], len(steps)] - 1
    return [(int(steps[a]), int(steps[b]) + 1, bool(forward[a])) for a, b in zip(starts, ends)]


def _arrow_on(loop: _Loop, begin: int, last: int, colour: int, x_range: Span,
              y_range: Span) -> Arrow:
    """An arrowhead in the middle half of a stroke, where the curve is level, close to the middle."""
    x, y = loop.x[begin:last + 1], loop.y[begin:last + 1]
    off = np.abs(0.5 * (x[1:] + x[:-1]) - 0.5 * (x[0] + x[-1])) / (0.25 * abs(x[-1] - x[0]))
    across = np.abs(np.diff(x)) / (x_range[1] - x_range[0])
    up = np.abs(np.diff(y)) / (y_range[1] - y_range[0])
    with np.errstate(divide="ignore"):
        cost = np.where(across > 0.0, off + up / np.where(across > 0.0, across, 1.0), np.inf)
    middle = np.where(off <= 1.0, cost, np.inf)
    best = int((middle if np.isfinite(middle).any() else cost).argmin())
    return Arrow((float(x[best]), float(y[best])), (float(x[best + 1]), float(y[best + 1])), colour)


def loop_figure(runs: Sequence[Run], labels: Sequence[str], owners: Owners) -> Figure:
    """The friction loop of drivers that reverse, with an arrow for each direction."""
    height, long_stroke = 360.0, 0.25  # of the loop
    loops = [_read_loop(run, owners) for run in runs]
    check_unit_names(runs, loops[0].length)
    check_unit_names(runs, loops[0].force)
    x, y = np.concatenate([one.x for one in loops]), np.concatenate([one.y for one in loops])
    x_range = with_margin(float(x.min()), float(x.max()), False)
    y_range = with_margin(float(y.min()), float(y.max()), False)
    panel = Panel("", height, y_range=y_range)
    for k, (run, loop, label) in enumerate(zip(runs, loops, labels)):
        panel.curves.append(Curve(loop.x, loop.y, label, k))
        extent = loop.x.max() - loop.x.min()
        for way in (True, False):
            strokes = [(a, b) for a, b, forward in _strokes(loop.x) if forward == way
                       and abs(loop.x[b] - loop.x[a]) >= long_stroke * extent]
            if not strokes:
                raise refusal("plot.no_data", run.samples.file,
                              "the support does not go back: there is no loop",
                              admissible="a run whose driver reverses; the figure force shows this "
                              "one")
            panel.arrows.append(_arrow_on(loop, *strokes[-1], k, x_range, y_range))
    along_x = all(one.along_x for one in loops)
    panel.y_label = axis_text("lateral force" if along_x else "force along the pull",
                              "F_x" if along_x else "F", unit_name(runs[0], loops[0].force))
    words = "support position" + ("" if along_x else " along the pull")
    return Figure(axis_text(words, "X", unit_name(runs[0], loops[0].length)), [panel], x_range)
