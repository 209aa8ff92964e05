"""Long curves with no more points than can be seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tomlin._tables import Array

FEW_POINTS = 1000  #: a curve of so many is left alone
MOST_POINTS = 6000  #: no curve gets more
_FINEST_CELL = 0.5  # points of the screen: lines are drawn smoothed


@dataclass
class Window:
    """The part of the plane that is shown, and its size in points."""

    x: tuple[float, float]
    y: tuple[float, float]
    width: float
    height: float
    log_x: bool = False
    log_y: bool = False


def _cells(values: Array, span: tuple[float, float], log: bool, count: int) -> NDArray[np.int64]:
    """Numbers the part of the span, of `count` equal ones, that holds each value; the outer parts
    hold what is beyond."""
    start, end = np.asarray(span)
    with np.errstate(divide="ignore", invalid="ignore"):
        if log:
            values, start, end = np.log(values), np.log(start), np.log(end)
        share = (values - start) / (end - start if end > start else 1.0)
    cells: NDArray[np.int64] = np.clip(np.floor(np.nan_to_num(share) * count), 0, count - 1).astype(
        np.int64)
    return cells


def _by_columns(x: Array, y: Array, window: Window) -> NDArray[np.int64]:
    """Indices of the first point, the last and the outermost ones of every stretch that stays in one
    column of the screen: the drawn lines are the same."""
    gap = np.isnan(x) | np.isnan(y)
    column = np.where(gap, -1, _cells(x, window.x, window.log_x, max(1, int(window.width))))
    starts = np.flatnonzero(np.r_[True, column[1:] != column[:-1]])
    lengths = np.diff(np.r_[starts, len(x)])
    kept = [starts, starts + lengths - 1]
    for values in (x, y, -x, -y):
        least = np.repeat(np.minimum.reduceat(values, starts), lengths)
        found = np.flatnonzero(values == least)
        _, first = np.unique(np.searchsorted(starts, found, "right"), return_index=True)
        kept.append(found[first])
    indices: NDArray[np.int64] = np.unique(np.concatenate(kept))
    return indices


def _without_overdrawn(x: Array, y: Array, window: Window, cell: float) -> tuple[Array, Array]:
    """Drops lines that would be drawn over others, as in the second and all later rounds of a loop,
    by the cells in which they begin and end."""
    columns = max(1, int(np.ceil(window.width / cell)))
    rows = max(1, int(np.ceil(window.height / cell)))
    gap = np.isnan(x) | np.isnan(y)
    at = _cells(y, window.y, window.log_y, rows) * columns + _cells(x, window.x, window.log_x,
                                                                    columns)
    at[gap] = -1
    extreme = np.zeros(len(x), bool)
    extreme[[np.nanargmin(x), np.nanargmax(x), np.nanargmin(y), np.nanargmax(y)]] = True
    moved = np.r_[True, at[1:] != at[:-1]] | extreme
    x, y, at, gap, extreme = x[moved], y[moved], at[moved], gap[moved], extreme[moved]
    ends = np.sort(np.stack([at[:-1], at[1:]]), axis=0)
    joined = ~(gap[:-1] | gap[1:])
    _, first = np.unique(ends[0] * (columns * rows) + ends[1], return_index=True)
    new = np.zeros(len(joined), bool)
    new[first] = True
    drawn = joined & (new | extreme[:-1] | extreme[1:])
    before, behind = np.r_[False, drawn], np.r_[drawn, False]
    used = before | behind
    ends_here = np.flatnonzero((before & ~behind)[used]) + 1
    return (np.insert(x[used], ends_here, np.nan), np.insert(y[used], ends_here, np.nan))


def reduced(x: Array, y: Array, window: Window) -> tuple[Array, Array]:
    """The curve with every extreme that it has."""
    if len(x) <= FEW_POINTS:
        return x, y
    kept = _by_columns(x, y, window)
    x, y = x[kept], y[kept]
    # Coarser cells until it fits: a curve that fills the panel is a surface whatever is left out.
    cell = _FINEST_CELL
    while len(x) > MOST_POINTS:
        x, y = _without_overdrawn(x, y, window, cell)
        cell *= 2.0
    return x, y
