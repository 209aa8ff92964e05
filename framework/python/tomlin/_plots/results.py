"""Results of several runs: a point for each, with its error."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from tomlin._errors import SceneError, listed, nearest_name, refusal
from tomlin._plots.figure import Curve, Figure, Panel, Span, with_margin
from tomlin._plots.labels import parameter_text, result_text
from tomlin._plots.runs import Run, differing_parameters, in_order_of_parameters, label_of
from tomlin._tables import drawable, one_line


def _refuse_path(run: Run, option: str, path: str, parameters: Sequence[str]) -> SceneError:
    shorts = [path.partition(".")[2] for path in run.results]
    known = [*parameters, *(short if run.find(short) == whole else whole
                            for short, whole in zip(shorts, run.results))]
    return refusal("plot.no_data", run.file("summary.json"), "there is no such number in the summary",
                   key=one_line(f"{option} {path}"), admissible=listed(known),
                   nearest=nearest_name(path, known))


def _parameters_of_curves(runs: Sequence[Run], against: str) -> list[str]:
    """The parameters that tell curves apart. One that all runs have alike varies along no curve;
    along a result the one with the most values does."""
    names = differing_parameters(runs)
    along = against if against in names else None
    if along is None and against not in runs[0].parameters and names:
        along = max(names, key=lambda name: len({run.parameters.get(name) for run in runs}))
    return [name for name in names if name != along]


def result_figure(runs: Sequence[Run], result: str, against: str, log_x: bool, log_y: bool,
                  notes: list[str]) -> Figure:
    """A point for each run: a result over a parameter or another result, with its error where the
    run states one."""
    height = 360.0
    names = _parameters_of_curves(runs, against)
    points: dict[str, list[tuple[float, float, float]]] = {}
    for run in in_order_of_parameters(runs):
        x_name, y_name = run.find(against), run.find(result)
        if against in run.parameters:
            x = run.parameters[against]
        elif x_name is not None:
            x = run.results[x_name]
        else:
            raise _refuse_path(run, "--against", against, list(run.parameters))
        if y_name is None:
            raise _refuse_path(run, "--result", result, [])
        y = run.results[y_name]
        if not (math.isfinite(x) and math.isfinite(y)):
            notes.append(f"{run.folder}: undefined, and left out")
        elif (log_x and not x > 0.0) or (log_y and not y > 0.0):
            notes.append(f"{run.folder}: not positive, and not on a logarithmic axis")
        else:
            drawable(np.array([x, y]), run.file("summary.json"))
            error = run.results.get(f"error.{y_name}", math.nan)
            points.setdefault(label_of(run, names), []).append((x, y, error))
    if not points:
        raise refusal("plot.no_data", "--result", "there is no number to draw in any of the folders",
                      key=result)
    panel = Panel(result_text(runs[0], runs[0].find(result) or result), height)
    for k, (label, rows) in enumerate(points.items()):
        x_values, y_values, errors = np.array(sorted(rows, key=lambda row: row[0])).T
        panel.curves.append(Curve(x_values, y_values, label if len(points) > 1 else "", k, mark="o",
                                  error=errors))
    x_all = np.concatenate([one.x for one in panel.curves])
    panel.y_range = range_with_errors(panel.curves, log_y)
    x_label = (parameter_text(against) if against in runs[0].parameters
               else result_text(runs[0], runs[0].find(against) or against))
    return Figure(x_label, [panel], with_margin(float(x_all.min()), float(x_all.max()), log_x),
                  log_x, log_y)


def range_with_errors(curves: Sequence[Curve], logarithmic: bool) -> Span:
    """Ends of the y axis around numbers and their errors."""
    ends = [one.y for one in curves]
    for one in curves:
        if one.error is not None:
            error = np.nan_to_num(one.error)
            ends += [one.y + error, np.where((one.y > error) | (not logarithmic), one.y - error,
                                             one.y)]
    y = np.concatenate(ends)
    return with_margin(float(np.nanmin(y)), float(np.nanmax(y)), logarithmic)
