"""Bodies in the plane: their particles at some moments, and their path over a potential."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tomlin._errors import SceneError, refusal
from tomlin._plots.figure import GREY, PANEL_WIDTH, Curve, Figure, Panel, Raster, scale_equally
from tomlin._plots.labels import axis_text, check_unit_names, unit_name
from tomlin._plots.quantities import Owners, Series, chosen_owner, find_series, owners_of
from tomlin._plots.runs import Run
from tomlin._tables import Array, Columns, drawable

_MOMENTS_BY_DEFAULT = 5
_MARGIN = 0.06  # around everything, as a share of the width
_SHORT = {"time": "t", "driver_position": "vt"}  # as moments usually are named by


def marks(points: Array, label: str, colour: int, mark: str) -> Curve:
    """Points [axis][point] that no line joins."""
    size = {"o": 5.4, "s": 4.2, "^": 6.6}[mark]
    return Curve(points[0].reshape(-1), points[1].reshape(-1), label, colour, False, mark=mark,
                 mark_size=size)


def _column(table: Columns, name: str) -> Array:
    if name not in table:
        raise refusal("plot.no_data", table.file, f"there is no column {name}")
    return drawable(table[name], table.file)


def _shape(run: Run, body: str, notes: list[str]) -> tuple[Array, bool]:
    """Particles seen from the centre of mass, and whether a line joins them."""
    arms, is_round, keeps_shape = run.scene._core.shape_of(body)
    if not keeps_shape:
        notes.append(f"{run.folder}: {body} is flexible, and is drawn in the shape it starts with")
    return np.asarray(arms), is_round


def _row_at(clock: Series, value: float, file: str) -> tuple[int, int, float]:
    """Finds where the clock first shows a value: the rows around it, and the share between them."""
    rising = clock.values[0] <= value
    beyond = np.flatnonzero(clock.values >= value if rising else clock.values <= value)
    if not len(beyond):
        raise refusal("plot.no_data", "--at", f"outside the samples of {file}", key=f"{value:g}",
                      admissible=f"from {clock.values.min():g} to {clock.values.max():g}")
    upper = int(beyond[0])
    lower = max(upper - 1, 0)
    step = clock.values[upper] - clock.values[lower]
    return lower, upper, float((value - clock.values[lower]) / step) if step else 0.0


def _moment(panel: Panel, shape: tuple[Array, bool], centre: Array, angle: float, drivers: Array,
            label: str, colour: int) -> None:
    arms, is_round = shape
    sine, cosine = np.sin(angle), np.cos(angle)
    particles = centre[:, None] + np.array([[cosine, -sine], [sine, cosine]]) @ arms.T
    ring = np.append(particles, particles[:, :1], axis=1) if is_round else particles

    panel.curves += [Curve(ring[0], ring[1], label, colour, is_round, mark="o", mark_size=2.7),
                     marks(particles[:, :1], "", colour, "o"), marks(centre, "", colour, "s")]
    if drivers.size:
        panel.curves.append(marks(drivers, "", colour, "^"))


def ring_figure(runs: Sequence[Run], labels: Sequence[str], x: str, at: Sequence[float],
                owners: Owners, notes: list[str]) -> Figure:
    """The particles of a planar body with its centre of mass and its drivers, at some moments; a
    panel for each run."""
    check_unit_names(runs, "length")
    unit = unit_name(runs[0], "length")
    figure = Figure(axis_text("", "x", unit), [])
    for run, label in zip(runs, labels):
        table = run.samples
        body = chosen_owner(table, "body", "rotation", owners)
        shape = _shape(run, body, notes)
        clock = find_series(table, x, owners, "--x")
        centre = np.stack([_column(table, f"{body}.centre_of_mass.{axis}") for axis in "xy"])
        angle = _column(table, f"{body}.rotation")
        drivers = np.array([[_column(table, f"{name}.position.{axis}")
                             for name in owners_of(table, "position.y")] for axis in "xy"])
        drivers = drivers.reshape(2, -1, len(angle))  # there may be none
        panel = Panel(axis_text("", "y", unit), 0.0, title=label)
        ends = float(clock.values.min()), float(clock.values.max())
        for k, value in enumerate(at or np.linspace(*ends, _MOMENTS_BY_DEFAULT)):
            lower, upper, share = _row_at(clock, value, table.file)

            def between(values: Array) -> Any:
                return values[..., lower] + share * (values[..., upper] - values[..., lower])

            _moment(panel, shape, between(centre), float(between(angle)), between(drivers),
                    f"{_SHORT.get(clock.name, clock.name)} = {value:g}", k)
        entries = [("o", "particle 0"), ("s", "centre of mass"), ("^", "driver")]
        for mark, text in entries[:3 if drivers.size else 2]:
            panel.curves.append(marks(np.full((2, 1), np.nan), text, GREY, mark))
        figure.panels.append(panel)
    return scale_equally(figure, _MARGIN)


def _edges_around(path: Array, period: float) -> tuple[Array, Array]:
    """The rectangle around a path, in square pixels: the edges along x and y."""
    periods_around, share_around, pixels_per_period = 0.75, 0.06, 48.0
    fewest, most = 320.0, 640.0  # pixels along the longer side
    low, high = path.min(axis=1), path.max(axis=1)
    margin = max(periods_around * period, share_around * float((high - low).max())) or 1.0
    low, high = low - margin, high + margin
    longer = float((high - low).max())
    wanted = pixels_per_period * longer / period if period > 0.0 else most
    pixel = longer / min(max(wanted, fewest), most)
    x, y = (np.linspace(a, b, max(1, round((b - a) / pixel)) + 1) for a, b in zip(low, high))
    return x, y


def surface_figure(run: Run, owners: Owners, start: float | None, end: float | None) -> Figure:
    """The path of a body over the potential of one particle on the substrates of the body."""
    table = run.samples
    body = chosen_owner(table, "body", "centre_of_mass.y", owners)
    name = f"{body}.centre_of_mass."
    whole = np.stack([_column(table, name + axis) for axis in "xy"])
    shown = np.ones(whole.shape[1], bool)
    shown &= whole[0] >= (-np.inf if start is None else start)
    shown &= whole[0] <= (np.inf if end is None else end)
    path = whole[:, shown]
    if not path.size:
        raise refusal("plot.no_data", "--from" if start is not None else "--to",
                      "there is no sample in this range",
                      admissible=f"{name}x from {whole[0].min():g} to {whole[0].max():g}")
    height = float(table[f"{name}z"][0]) if f"{name}z" in table else None
    scene = run.scene._core
    try:
        x_edges, y_edges = _edges_around(path, scene.substrate_period(body))
        x, y = 0.5 * (x_edges[1:] + x_edges[:-1]), 0.5 * (y_edges[1:] + y_edges[:-1])
        values = np.asarray(scene.substrate_potential(body, x, y, height or 0.0))
    except SceneError as error:
        fault = error.faults[0]
        raise refusal("plot.no_data", run.file("scene.toml"), fault.message, key=fault.key,
                      admissible=fault.admissible) from None
    unit = unit_name(run, table.units[f"{name}x"])
    panel = Panel(axis_text("", "y", unit), PANEL_WIDTH,
                  title="" if height is None else f"z = {height:g}",
                  raster=Raster(x_edges, y_edges, values,
                                axis_text("potential energy", "V", unit_name(run, "energy")), True))
    panel.curves = [Curve(path[0], path[1], "path", 1), marks(path[:, :1], "start", 1, "o"),
                    marks(path[:, -1:], "end", 1, "s")]
    return scale_equally(Figure(axis_text("", "x", unit), [panel]), 0.0)
