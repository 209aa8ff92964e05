"""Figures, where matplotlib is installed; nothing else depends on it."""

from __future__ import annotations

import base64
import io
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tomlin._errors import no_such_name

if TYPE_CHECKING:
    from tomlin._result import Result
    from tomlin._sweep import Sweep

_WORDS = {"force": "lateral force", "position": "displacement of the driver",
          "centre_of_mass": "position", "velocity": "velocity", "rotation": "rotation",
          "mean_force": "mean lateral force", "time": "time", "v": "driving velocity"}


def new_axes(ax: Any = None) -> Any:
    """The axes to draw on: the caller's, or those of a figure that no window knows."""
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("figures need matplotlib (Debian: python3-matplotlib)") from error
    return pyplot.subplots()[1]


def label(name: str, unit: str = "", axes: dict[str, str] | None = None) -> str:
    """"driver.force.x": "lateral force x, driver (force)"; with the scene's names of units."""
    if name == "time":
        text = "time"
    else:
        parts = name.split(".")
        letter = parts.pop() if len(parts) > 1 and parts[-1] in ("x", "y", "z") else ""
        word = _WORDS.get(parts[-1], parts[-1].replace("_", " "))
        owner = ".".join(parts[:-1]).removeprefix("drivers.").removeprefix("bodies.")
        text = word + (f" {letter}" if letter else "") + (f", {owner}" if owner else "")
    unit = (axes or {}).get({"length/time": "velocity"}.get(unit, unit)) or unit
    return f"{text} ({unit})" if unit and unit != "1" else text


def _default_columns(samples: Any) -> tuple[str, str]:
    names = samples.columns
    forces = [name for name in names if ".force." in name]
    if not forces:
        return (names[1] if len(names) > 1 else names[0]), "time"
    # Along the pull: where the end of the driver moves.
    moved = [name.replace(".position.", ".force.") for name in names
             if ".position." in name and np.ptp(samples[name]) > 0.0]
    y = next((name for name in moved if name in forces), forces[0])
    x = y.replace(".force.", ".position.")
    return y, (x if x in names else "time")


def plot_samples(result: Result, y: str | None, x: str | None, ax: Any, **options: Any) -> Any:
    samples = result.samples
    if not len(samples):
        raise ValueError("there are no samples: the scene has no [output] every")
    default_y, default_x = _default_columns(samples)
    y = y or default_y
    x = x or (default_x if y == default_y else "time")
    for name in (x, y):
        if name not in samples.columns:
            raise KeyError(f"{name}: the samples have {', '.join(samples.columns)}")
    ax = new_axes(ax)
    ax.plot(samples[x], samples[y], **options)
    axes = result.scene._core.axes
    ax.set_xlabel(label(x, samples.units.get(x, ""), axes))
    ax.set_ylabel(label(y, samples.units.get(y, ""), axes))
    return ax


def _is_logarithmic(values: NDArray[Any]) -> bool:
    if values.dtype.kind not in "fi" or len(values) < 3 or not (values > 0).all():
        return False
    ratios = values[1:] / values[:-1]
    return bool(np.ptp(ratios) < 1e-6 * abs(ratios[0]) and abs(ratios[0] - 1.0) > 1e-6)


def plot_sweep(sweep: Sweep, y: str | None, x: str | None, ax: Any, **options: Any) -> Any:
    axes = sweep.axes
    x = x or list(axes)[-1]
    y = y or next(iter(sweep.columns))
    if x not in axes:
        raise no_such_name(x, axes, "sweep")
    along = next(k for k, names in enumerate(sweep._of_dimension) if x in names)
    values = axes[x]
    numbers = np.moveaxis(np.asarray(sweep[y]), along, -1).reshape(-1, len(values))
    others = [names[0] for k, names in enumerate(sweep._of_dimension) if k != along and names]
    points = np.array(np.meshgrid(*(axes[name] for name in others), indexing="ij")).reshape(
        len(others), -1) if others else np.empty((0, 1))
    ax = new_axes(ax)
    for k, row in enumerate(numbers):
        text = ", ".join(f"{name} = {point[k]:.4g}" if point.dtype.kind == "f"
                         else f"{name} = {point[k]}" for name, point in zip(others, points))
        ax.plot(values, row, **{"marker": "o", "label": text or None, **options})
    if _is_logarithmic(values):
        ax.set_xscale("log")
    names = sweep._scene._core.axes
    ax.set_xlabel(label(x))
    ax.set_ylabel(label(y, sweep.units.get(y, ""), names))
    if others:
        ax.legend()
    return ax


def trace_html(result: Result) -> str:
    """The friction trace as a picture inside a page; nothing where there is none to draw."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return ""
    if not len(result.samples):
        return ""
    figure = Figure(figsize=(5.0, 2.5), layout="tight")
    plot_samples(result, None, None, figure.subplots(), linewidth=0.8)
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=90)
    return f'<img src="data:image/png;base64,{base64.b64encode(image.getvalue()).decode()}">'
