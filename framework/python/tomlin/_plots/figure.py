"""Figures before they are drawn: panels one above the other, with one axis along x."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tomlin._tables import Array

GREY = -1  #: as a colour: no data, an aid to the eye
PANEL_WIDTH = 540.0  #: of the plotted area, in points

Span = tuple[float, float]


@dataclass
class Curve:
    """Points, joined unless ``line`` is false; a curve breaks where a number is NaN."""

    x: Array
    y: Array
    label: str = ""  #: in the key; none when empty
    colour: int = 0  #: which of the palette, or GREY
    line: bool = True
    dashed: bool = False
    filled: bool = False  #: down to the lower end of the y axis
    mark: str = ""  #: as matplotlib calls it
    mark_size: float = 5.5
    error: Array | None = None  #: along y


@dataclass
class Raster:
    """Numbers in cells as colours; NaN stays white."""

    x_edges: Array
    y_edges: Array
    values: Array  #: [row, column], from below
    label: str
    grey: bool = False


@dataclass
class Arrow:
    """An arrowhead on a curve."""

    start: tuple[float, float]
    end: tuple[float, float]
    colour: int


@dataclass
class Panel:
    """One pair of axes."""

    y_label: str
    height: float  #: of the plotted area, in points
    curves: list[Curve] = field(default_factory=list)
    y_range: Span | None = None  #: by the data where it is None
    title: str = ""
    raster: Raster | None = None
    arrows: list[Arrow] = field(default_factory=list)


@dataclass
class Figure:
    """Everything but size and fonts."""

    x_label: str
    panels: list[Panel]
    x_range: Span | None = None
    log_x: bool = False
    log_y: bool = False
    to_scale: bool = False  #: a length is as long along x as along y


def with_margin(start: float, end: float, logarithmic: bool) -> Span:
    """Ends of an axis around these numbers, which may be equal and are positive on a logarithmic
    axis."""
    share = 0.04
    if logarithmic:
        factor = (end / start) ** share if end > start else 1.0 + share
        return start / factor, end * factor
    margin = share * (end - start) if end > start else share * abs(end) if end else 1.0
    return start - margin, end + margin


def _box(panel: Panel) -> tuple[float, float, float, float]:
    x = [one.x for one in panel.curves] + ([panel.raster.x_edges] if panel.raster else [])
    y = [one.y for one in panel.curves] + ([panel.raster.y_edges] if panel.raster else [])
    all_x, all_y = np.concatenate(x), np.concatenate(y)
    return (float(np.nanmin(all_x)), float(np.nanmax(all_x)), float(np.nanmin(all_y)),
            float(np.nanmax(all_y)))


def scale_equally(figure: Figure, margin_share: float) -> Figure:
    """Gives both axes one scale, all panels the same; an axis is made longer where the panel would
    be too low or too high."""
    lowest, highest = 110.0, 480.0  # of a panel, in points
    smallest = 1e-300  # width in the units of the axis: its inverse is a number
    boxes = [_box(panel) for panel in figure.panels]
    left, right = min(box[0] for box in boxes), max(box[1] for box in boxes)
    tallest = max(box[3] - box[2] for box in boxes)
    margin = margin_share * max(right - left, tallest)
    width = max(right - left + 2.0 * margin, (tallest + 2.0 * margin) * PANEL_WIDTH / highest)
    if not width > smallest:
        width = 1.0
    middle = 0.5 * (left + right)
    figure.x_range = middle - 0.5 * width, middle + 0.5 * width
    points = PANEL_WIDTH / width
    for panel, (_, _, low, high) in zip(figure.panels, boxes):
        height = max(high - low + 2.0 * margin, lowest / points)
        centre = 0.5 * (low + high)
        panel.y_range = centre - 0.5 * height, centre + 0.5 * height
        panel.height = height * points
    figure.to_scale = True
    return figure
