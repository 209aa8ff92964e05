"""Histograms of slips."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence

import numpy as np

from tomlin._errors import refusal
from tomlin._plots.figure import Curve, Figure, Panel, with_margin
from tomlin._plots.labels import axis_text, check_unit_names, unit_name
from tomlin._plots.runs import Run
from tomlin._tables import EVENT_FIELDS, Array, drawable, read_events

SLIP_MEASURES = {"size": ("size", "size of a slip", "length"),
                 "peak_force": ("peak_force", "peak force of a slip", "force"),
                 "energy": ("energy_lost", "energy lost in a slip", "energy")}
MOST_BINS = 1000


def _slips(run: Run, column: str, driver: str) -> Array:
    """The numbers of a run's slips; those without one, which happened before it could be known, are
    left out."""
    file = run.file("events.csv")
    if run.result is None and not os.path.exists(file):
        raise refusal("plot.no_data", file, "there are no events",
                      admissible="a run in which slips can happen")
    rows = read_events(file) if run.result is None else run.result.events.tolist()
    slips = [row for row in rows if row[1] == "slip"]
    drivers = list(dict.fromkeys(row[2] for row in slips))
    if not driver and len(drivers) > 1:
        raise refusal("command.missing_argument", file, "there are slips of several drivers",
                      admissible=", ".join(f"--driver {one}" for one in drivers))
    at = 3 + EVENT_FIELDS.index(column)
    return drawable(np.array([row[at] for row in slips if row[2] == (driver or row[2])
                              and math.isfinite(row[at])], float), file)


def _bin_edges(start: float, end: float, bins: int, logarithmic: bool) -> Array:
    if start == end:
        start, end = with_margin(start, end, logarithmic)
    edges = np.geomspace(start, end, bins + 1) if logarithmic else np.linspace(start, end, bins + 1)
    edges[0], edges[-1] = start, end
    return edges


def slips_figure(runs: Sequence[Run], labels: Sequence[str], measure: str, driver: str,
                 bins: int | None, log_x: bool, log_y: bool, notes: list[str]) -> Figure:
    """A histogram of the slips in events.csv, the runs in the same bins."""
    height, room_above, below_one = 330.0, 1.08, 0.7
    column, words, dimension = SLIP_MEASURES[measure]
    all_values = []
    for run in runs:
        values = _slips(run, column, driver)
        drawn = values[values > 0.0] if log_x else values
        if len(drawn) < len(values):
            notes.append(f"{run.folder}: {len(values) - len(drawn)} slips are not positive, and not "
                         "on a logarithmic axis")
        all_values.append(drawn)
    most = max(len(values) for values in all_values)
    if not most:
        raise refusal("plot.no_data", runs[0].file("events.csv"), "there are no slips to count",
                      admissible="a run that slips; another --driver")
    check_unit_names(runs, dimension)
    count = bins or min(max(math.ceil(math.sqrt(most)), 8), 60)
    together = np.concatenate(all_values)
    edges = _bin_edges(float(together.min()), float(together.max()), count, log_x)
    floor = below_one if log_y else 0.0
    panel, highest = Panel("number of slips", height), 1.0
    for k, (values, label) in enumerate(zip(all_values, labels)):
        counts = np.histogram(values, edges)[0]
        highest = max(highest, float(counts.max()))
        x = np.r_[edges[0], np.repeat(edges, 2)[1:-1], edges[-1]]
        y = np.r_[floor, np.repeat(np.maximum(counts, floor), 2), floor]
        panel.curves.append(Curve(x, y, label, k, filled=True))
    panel.y_range = floor, room_above * highest * (1.5 if log_y else 1.0)
    return Figure(axis_text(words, "", unit_name(runs[0], dimension)), [panel],
                  with_margin(edges[0], edges[-1], log_x), log_x, log_y)
