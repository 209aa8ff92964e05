"""Figures by matplotlib, for results in Python and for `tomlin plot`; nothing else depends on it."""

from __future__ import annotations

import base64
import io
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from tomlin._plots.bodies import ring_figure, surface_figure
from tomlin._plots.draw import draw_on
from tomlin._plots.figure import Figure
from tomlin._plots.quantities import KINDS, Owners
from tomlin._plots.runs import Run, run_in_memory
from tomlin._plots.slips import slips_figure
from tomlin._plots.studies import compare_figure, tradeoff_figure
from tomlin._plots.sweeps import SweepRequest, sweep_figure, sweep_in_memory
from tomlin._plots.traces import CurvesRequest, curves_figure, loop_figure
from tomlin._result import Result

if TYPE_CHECKING:
    from tomlin._studies import Comparison, Tradeoff
    from tomlin._sweep import Sweep


def _default_columns(run: Run) -> tuple[str, str]:
    """The force of the first driver along its pull, where its end moves, over the position of that
    end; over time where there is none."""
    samples = run.samples
    forces = [name for name in samples.names if ".force." in name]
    if not forces:
        return samples.names[min(1, len(samples.names) - 1)], "time"
    moved = [name.replace(".position.", ".force.") for name in samples.names
             if ".position." in name and np.ptp(samples[name]) > 0.0]
    y = next((name for name in moved if name in forces), forces[0])
    x = y.replace(".force.", ".position.")
    return y, (x if x in samples else "time")


def figure_of_result(result: Result, y: str | None, x: str | None, notes: list[str]) -> Figure:
    """A figure by its name, or a quantity over another."""
    run = run_in_memory(result)
    if x is None and y == "ring":
        return ring_figure([run], [""], "time", [], Owners(), notes)
    if x is None and y == "surface":
        return surface_figure(run, Owners(), None, None)
    if x is None and y == "loop":
        return loop_figure([run], [""], Owners())
    if x is None and y == "slips":
        return slips_figure([run], [""], "size", "", None, False, False, notes)
    default_y, default_x = _default_columns(run)
    if y in KINDS and x is None:
        y, x = KINDS[y][:2]
        x = "time" if x == "driver_position" and default_x == "time" else x
    y = y or default_y
    x = x or (default_x if y == default_y else "time")
    request = CurvesRequest(x, [[y]], in_words=True)
    return curves_figure([run], [""], request, notes)


def plot_result(result: Result, y: str | None, x: str | None, ax: Any, **options: Any) -> Any:
    notes: list[str] = []
    axes = draw_on(ax, figure_of_result(result, y, x, notes), **options)
    for note in notes:
        warnings.warn(note, stacklevel=3)
    return axes


def plot_sweep(sweep: Sweep, y: str | None, x: str | None, ax: Any, **options: Any) -> Any:
    stored = sweep_in_memory(sweep)
    request = SweepRequest(x or list(sweep.axes)[-1], [[y or next(iter(sweep.columns))]])
    return draw_on(ax, sweep_figure(stored, request, []), **options)


def plot_tradeoff(tradeoff: Tradeoff, ax: Any, **options: Any) -> Any:
    return draw_on(ax, tradeoff_figure(tradeoff), **options)


def plot_comparison(comparison: Comparison, ax: Any, **options: Any) -> Any:
    names = [model.get("name") or model.get("file") for model in comparison["models"]]
    curves = [(name, *curve) for name, curve in zip(names, comparison.curves)]
    length, force = (comparison._axes.get(key) or key for key in ("length", "force"))
    return draw_on(ax, compare_figure(curves, length, force), **options)


def trace_html(result: Result) -> str:
    """The friction trace as a picture inside a page; nothing where there is none to draw."""
    try:
        from matplotlib.figure import Figure as Canvas
    except ImportError:
        return ""
    if not len(result.samples):
        return ""
    canvas = Canvas(figsize=(5.0, 2.5), layout="tight")
    plot_result(result, None, None, canvas.subplots(), linewidth=0.8)
    image = io.BytesIO()
    canvas.savefig(image, format="png", dpi=90)
    return f'<img src="data:image/png;base64,{base64.b64encode(image.getvalue()).decode()}">'
