"""Figures by matplotlib."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tomlin._errors import refusal
from tomlin._plots.figure import (GREY, PANEL_WIDTH, Curve, Figure, Panel, Raster, Span,
                                  with_margin)
from tomlin._plots.labels import literal
from tomlin._plots.reduce import Window, reduced

POINTS_PER_INCH = 72.0
PIXELS_PER_POINT = 2.0  #: of a PNG

# M. Okabe and K. Ito, Color Universal Design (2008): colour-blind eyes can distinguish them, too.
_PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
_GREY = "#999999"
_DASHES = ("-", (0, (6, 3)), (0, (2, 2)), (0, (6, 3, 1.5, 3)))  # when the colours are used up
_LIGHTEST_GREYS = (0.55, 1.0)  # curves are to be seen on them
_EDGE = "#333333"
_MOST_CELLS = 2500  # of a raster that is drawn cell by cell
_FEW_DECADES = 2.5  # a logarithmic axis of fewer decades has numbers at 1, 2 and 5 times the powers of ten


def missing_matplotlib() -> ImportError:
    return ImportError("figures need matplotlib (Debian: python3-matplotlib)")


@dataclass
class PageFormat:
    """Size and fonts of a picture, in points."""

    title: str = ""
    size: tuple[float, float] | None = None  #: as large as panels and texts need where None
    font: str = "sans-serif"
    font_size: float = 12.0

    def settings(self) -> dict[str, Any]:
        from matplotlib import cycler

        families = [self.font] if self.font == "sans-serif" else [self.font, "sans-serif"]
        return {
            "font.family": families, "font.size": self.font_size, "axes.titlesize": "medium",
            "axes.prop_cycle": cycler(color=_PALETTE), "axes.edgecolor": _EDGE,
            "axes.linewidth": 0.8, "axes.spines.top": False, "axes.spines.right": False,
            "axes.unicode_minus": True, "axes.formatter.useoffset": False,
            "axes.axisbelow": True, "grid.color": "#E6E6E6", "grid.linewidth": 0.6,
            "lines.linewidth": 1.2, "legend.frameon": False, "legend.borderaxespad": 0.0,
            "xtick.color": _EDGE, "ytick.color": _EDGE, "svg.fonttype": "none",
            "svg.hashsalt": "tomlin", "path.simplify": False}


class _Drawing:
    """One panel on one pair of axes. Colours are those of matplotlib's settings, in their order,
    behind those of the lines that are there already."""

    def __init__(self, ax: Any, panel: Panel, **options: Any):
        from matplotlib import cbook, lines, rcParams

        self.ax, self.panel = ax, panel
        self.options = cbook.normalize_kwargs(options, lines.Line2D)  # "c" is "color"
        self.palette = rcParams["axes.prop_cycle"].by_key().get("color", _PALETTE)
        self.before = len(ax.lines)
        self.handles: list[tuple[Any, str]] = []
        self.bar: Any = None

    def draw(self, window: Window | None) -> None:
        if self.panel.raster is not None:
            self._raster(self.panel.raster)
        for curve in self.panel.curves:
            self._curve(curve, window)
        for arrow in self.panel.arrows:
            self.ax.annotate("", xy=arrow.end, xytext=arrow.start, zorder=3, arrowprops={
                "arrowstyle": "-|>,head_width=0.45,head_length=1.0", "shrinkA": 0, "shrinkB": 0,
                "color": self._colour(arrow.colour), "linewidth": 1.2})

    def _colour(self, k: int) -> str:
        return _GREY if k == GREY else str(self.palette[(self.before + k) % len(self.palette)])

    def _curve(self, curve: Curve, window: Window | None) -> None:
        x, y = (curve.x, curve.y) if window is None else reduced(curve.x, curve.y, window)
        dashes = max(curve.colour, 0) // len(self.palette) % len(_DASHES)
        style: dict[str, Any] = {"color": self._colour(curve.colour),
                                 "label": literal(curve.label) or None,
                                 "linestyle": (0, (5, 4)) if curve.dashed else _DASHES[dashes]}
        if not curve.line:
            style["linestyle"] = "none"
        if curve.mark:
            style.update(marker=curve.mark, markersize=curve.mark_size)
        if curve.mark == "^":
            style["markerfacecolor"] = "none"
        style.update(self.options)
        [line] = self.ax.plot(x, y, **style)
        if curve.error is not None and np.isfinite(curve.error).any():
            self.ax.errorbar(curve.x, curve.y, yerr=curve.error, fmt="none", capsize=2.5,
                             ecolor=line.get_color(), elinewidth=1.0)
        if curve.filled and self.panel.y_range is not None:
            self.ax.fill_between(x, y, self.panel.y_range[0], color=line.get_color(), alpha=0.25,
                                 linewidth=0.0)
        if curve.label:
            self.handles.append((line, curve.label))

    def _raster(self, raster: Raster) -> None:
        from matplotlib.colors import LinearSegmentedColormap

        colours: Any = "viridis"
        if raster.grey:
            colours = LinearSegmentedColormap.from_list("light", [str(one)
                                                                  for one in _LIGHTEST_GREYS])
        # Lines of their own colour cover the seams between few cells; many are one image.
        few = raster.values.size <= _MOST_CELLS
        mesh = self.ax.pcolormesh(raster.x_edges, raster.y_edges, raster.values, cmap=colours,
                                  rasterized=not few, linewidth=0.5 if few else 0.0,
                                  edgecolors="face" if few else "none")
        self.ax.grid(False)
        self.bar = (mesh, raster.label)

    def key(self, **where: Any) -> Any:
        """The legend; nothing where no curve has a label. Labels are shown as they are."""
        if not self.handles:
            return None
        legend = self.ax.legend([line for line, _ in self.handles], ["-"] * len(self.handles),
                                **where)
        for text, (_, label) in zip(legend.get_texts(), self.handles):
            text.set_text(literal(label))
        return legend


def _needs_many_digits(span: Span) -> bool:
    """Whether the numbers along an axis are long: it is short and far from zero."""
    digits = 5
    return max(abs(span[0]), abs(span[1])) > 10.0 ** digits * (span[1] - span[0])


def _scale(ax: Any, letter: str, log: bool, span: Span | None, limits: bool) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

    axis = getattr(ax, f"{letter}axis")
    if log:
        getattr(ax, f"set_{letter}scale")("log")
    if span is None:
        return
    if limits:
        getattr(ax, f"set_{letter}lim")(*span)
    if log and np.log10(span[1] / span[0]) < _FEW_DECADES:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
    elif not log and letter == "x" and _needs_many_digits(span):
        axis.set_major_locator(MaxNLocator(4, prune="both"))


def _set_up(ax: Any, figure: Figure, panel: Panel, limits: bool = True) -> None:
    _scale(ax, "x", figure.log_x, figure.x_range, limits)
    _scale(ax, "y", figure.log_y, panel.y_range, limits)
    ax.set_xlabel(figure.x_label)
    ax.set_ylabel(panel.y_label)
    if panel.title:
        ax.set_title(literal(panel.title))


def draw_on(ax: Any, figure: Figure, **options: Any) -> Any:
    """A figure of one panel on axes of somebody else or of a new figure, every point of it. Curves
    leave the range to matplotlib, which has it grow with what is drawn on the same axes later."""
    if ax is None:
        try:
            from matplotlib import pyplot
        except ImportError as error:
            raise missing_matplotlib() from error
        ax = pyplot.subplots()[1]
    [panel] = figure.panels
    drawing = _Drawing(ax, panel, **options)
    drawing.draw(None)
    filled = any(curve.filled for curve in panel.curves)
    _set_up(ax, figure, panel, limits=figure.to_scale or filled or panel.raster is not None)
    if figure.to_scale:
        ax.set_aspect("equal")
    if drawing.bar:
        ax.figure.colorbar(drawing.bar[0], ax=ax, label=drawing.bar[1])
    drawing.key(**({"loc": "upper left", "bbox_to_anchor": (1.02, 1.0)} if figure.to_scale else {}))
    return ax


def _window(figure: Figure, panel: Panel, width: float) -> Window | None:
    if figure.x_range is None or panel.y_range is None:
        return None
    return Window(figure.x_range, panel.y_range, width, panel.height * width / PANEL_WIDTH,
                  figure.log_x, figure.log_y)


class _Page:
    """Panels one above the other on a picture of their own, bars of colours and keys to their
    right. Lengths are in points, from the upper left corner."""

    _GAP = 16.0  # between panels
    _MARGIN = 10.0  # around everything
    _BAR = 14.0  # width of a bar of colours
    _SMALLEST = 40.0  # a panel, either way
    _ROUNDS = 3  # until the numbers along axes, and so the room beside panels, no longer change

    def __init__(self, figure: Figure, form: PageFormat):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure as Canvas

        self.figure, self.form = figure, form
        self.canvas = Canvas(figsize=(12.0, 12.0), dpi=POINTS_PER_INCH)
        self.renderer = FigureCanvasAgg(self.canvas).get_renderer()
        self.axes: list[Any] = []
        self.bars: list[Any] = []
        self.keys: list[Any] = []
        labels: list[str] = []
        for panel in figure.panels:
            labels = self._add(panel, labels)
        self.title = self.canvas.text(0.0, 0.0, literal(form.title), ha="center",
                                      va="top")
        self.canvas.align_ylabels()
        heights = [panel.height for panel in figure.panels]
        width, size = PANEL_WIDTH, form.size
        for _ in range(self._ROUNDS):
            whole = self._arrange(width, heights)
        for _ in range(self._ROUNDS if size else 0):
            width, heights = self._fitted(size or whole, whole, width, heights)
            whole = self._arrange(width, heights, size)

    def _add(self, panel: Panel, before: list[str]) -> list[str]:
        """Draws a panel. Panels with the labels of the one before have no key. Returns the labels."""
        figure, form = self.figure, self.form
        ax = self.canvas.add_axes((0.1, 0.1, 0.5, 0.5))
        drawing = _Drawing(ax, panel)
        ax.grid(panel.raster is None)
        drawing.draw(_window(figure, panel, max(form.size[0] if form.size else 0.0, PANEL_WIDTH)))
        _set_up(ax, figure, panel)
        if panel is not figure.panels[-1]:
            ax.set_xlabel("")
            ax.tick_params(labelbottom=False)
            ax.xaxis.offsetText.set_visible(False)
        self.axes.append(ax)
        bar = None
        if drawing.bar:
            bar = self.canvas.add_axes((0.8, 0.1, 0.02, 0.5))
            self.canvas.colorbar(drawing.bar[0], cax=bar, label=drawing.bar[1])
        self.bars.append(bar)
        labels = [label for _, label in drawing.handles]
        key = drawing.key(loc="upper left") if labels != before else None
        if key is not None:
            key.set_in_layout(False)
        self.keys.append(key)
        return labels

    def _beside(self, ax: Any) -> tuple[float, float, float, float]:
        """Room that texts take to the left, to the right, above and below of axes."""
        frame, whole = ax.get_window_extent(), ax.get_tightbbox(self.renderer)
        return (frame.x0 - whole.x0, whole.x1 - frame.x1, max(whole.y1 - frame.y1, 0.0),
                frame.y0 - whole.y0)

    def _arrange(self, width: float, heights: Sequence[float],
                 size: tuple[float, float] | None = None) -> tuple[float, float]:
        """Puts panels of this size beside their texts. Returns the size of the whole, which is that
        of the picture unless a size is given."""
        rooms = [self._beside(ax) for ax in self.axes]
        bars = [self._GAP + self._BAR + self._beside(bar)[1] for bar in self.bars if bar is not None]
        left = self._MARGIN + max(room[0] for room in rooms)
        beside = max([room[1] for room in rooms] + bars)
        keys = [key.get_window_extent(self.renderer) for key in self.keys if key is not None]
        to_keys = self._GAP + (beside if bars else 0.0)
        right = max([beside] + [to_keys + key.width for key in keys]) + self._MARGIN
        above = self._MARGIN
        if self.form.title:
            above += self.title.get_window_extent(self.renderer).height + 0.5 * self._GAP
        tops: list[float] = []
        end_of_keys, y = 0.0, above
        for room, key, height in zip(rooms, self.keys, heights):
            y = max(y + room[2], end_of_keys if key is not None else 0.0)
            tops.append(y)
            if key is not None:
                end_of_keys = y + keys.pop(0).height + 0.5 * self._GAP
            y += height + self._GAP
        whole = (left + width + right,
                 max(y - self._GAP + rooms[-1][3], end_of_keys) + self._MARGIN)
        w, h = size or whole
        self.canvas.set_size_inches(w / POINTS_PER_INCH, h / POINTS_PER_INCH)
        for ax, bar, key, top, height in zip(self.axes, self.bars, self.keys, tops, heights):
            low = 1.0 - (top + height) / h
            ax.set_position((left / w, low, width / w, height / h))
            if bar is not None:
                bar.set_position(((left + width + self._GAP) / w, low, self._BAR / w, height / h))
            if key is not None:
                key.set_bbox_to_anchor(((left + width + to_keys) / w, 1.0 - top / h),
                                       self.canvas.transFigure)
        self.title.set_position(((left + 0.5 * width) / w, 1.0 - self._MARGIN / h))
        return whole

    def _fitted(self, size: tuple[float, float], whole: tuple[float, float], width: float,
                heights: Sequence[float]) -> tuple[float, list[float]]:
        """Panels as large as texts leave room for."""
        texts = whole[0] - width, whole[1] - sum(heights)
        least = texts[0] + self._SMALLEST, texts[1] + self._SMALLEST * len(heights)
        if size[0] < least[0] or size[1] < least[1]:
            raise refusal("command.invalid_value", "--size", "too small for the texts of the figure",
                          key=f"{size[0]:g}x{size[1]:g}",
                          admissible=f"at least {np.ceil(least[0]):.0f}x{np.ceil(least[1]):.0f}")
        wider, higher = (size[0] - texts[0]) / width, (size[1] - texts[1]) / sum(heights)
        if self.figure.to_scale:
            wider = higher = min(wider, higher)
        return wider * width, [higher * height for height in heights]


def page(figure: Figure, form: PageFormat) -> Any:
    """A figure of matplotlib as large as its panels and texts need, or of the given size."""
    try:
        from matplotlib import style
    except ImportError as error:
        raise missing_matplotlib() from error
    for panel in figure.panels:
        if panel.y_range is None and panel.curves:
            y = np.concatenate([one.y for one in panel.curves])
            panel.y_range = with_margin(float(np.nanmin(y)), float(np.nanmax(y)), figure.log_y)
    with style.context(["default", form.settings()]):
        return _Page(figure, form).canvas


def picture(figure: Figure, form: PageFormat, suffix: str) -> bytes:
    """The bytes of an SVG, PNG or PDF; the same figure gives the same bytes."""
    canvas = page(figure, form)
    from matplotlib import style

    file = io.BytesIO()
    undated = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with style.context(["default", form.settings()]):
        canvas.savefig(file, format=suffix, dpi=PIXELS_PER_POINT * POINTS_PER_INCH,
                       metadata=undated[suffix])
    return file.getvalue()
