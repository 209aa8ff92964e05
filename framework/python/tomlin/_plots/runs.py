"""Runs as they lie in their folders or in memory, and their names."""

from __future__ import annotations

import json
import math
import os
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from tomlin._errors import SceneError, refusal
from tomlin._record import AXES
from tomlin._result import Result
from tomlin._tables import Columns, read_samples, read_text

_LARGEST_SUMMARY = 8 << 20  # bytes
_FAMILIES = ("drivers.", "bodies.", "observers.", "forces.")
# Parts of a summary that describe the scene and are no results.
_NO_RESULTS = {"program", "scene", "integrator", "parameters", "warnings", "warning_codes",
               "left_out", "plugins", "references"}


def number_of(value: Any) -> float | None:
    """A number of JSON as a float, NaN where it is beyond one; None of anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        number = float(value)
    except OverflowError:
        return math.nan
    return number if math.isfinite(number) else math.nan


def _results(node: Any, path: str, found: dict[str, float]) -> None:
    number = math.nan if node is None else number_of(node)
    if number is not None:
        found[path] = number
    elif isinstance(node, dict):
        for key, value in node.items():
            _results(value, f"{path}.{key}", found)
    elif isinstance(node, list) and len(node) <= len(AXES):
        for axis, value in zip(AXES, node):
            _results(value, f"{path}.{axis}", found)


def read_json(file: str) -> dict[str, Any]:
    """Raises SceneError for what is no object in JSON."""
    try:
        found = json.loads(read_text(file, _LARGEST_SUMMARY))
    except (ValueError, RecursionError) as error:
        if isinstance(error, SceneError):
            raise
        found = None
    if not isinstance(found, dict):
        raise refusal("file.invalid", file, "this is not the summary of a run")
    return found


def read_toml(file: str) -> dict[str, Any]:
    """Empty where there is no such file: figures can do without."""
    try:
        return tomllib.loads(read_text(file))
    except (ValueError, RecursionError):
        return {}


def _as_written(value: Any) -> str:
    return value if isinstance(value, str) else str(number_of(value))


@dataclass
class Run:
    """One run with what figures need of it."""

    folder: str  #: as it was given, for messages
    status: str = "finished"
    parameters: dict[str, float] = field(default_factory=dict)
    written: dict[str, str] = field(default_factory=dict)  #: parameters as the scene has them
    results: dict[str, float] = field(default_factory=dict)  #: by dotted path; NaN is undefined
    units: dict[str, str] = field(default_factory=dict)
    system: str = "reduced"
    result: Result | None = None  #: of a run in memory

    @property
    def name(self) -> str:
        """The last part of the path, which may end with a slash; the name of the folder of "."."""
        return os.path.basename(os.path.abspath(self.folder)) or self.folder

    def file(self, name: str) -> str:
        return os.path.join(self.folder, name)

    @cached_property
    def samples(self) -> Columns:
        if self.result is None:
            columns = read_samples(self.file("observables.csv"))
        else:
            samples = self.result.samples
            columns = Columns(self.folder, {name: samples.units.get(name, "")
                                            for name in samples.columns if name != "positions"},
                              samples)
        if not len(columns["time"]):
            raise refusal("plot.no_data", columns.file,
                          "there are no samples: the scene has no [output] every")
        return columns

    @cached_property
    def scene(self) -> Any:
        """Raises SceneError where the scene cannot be read again."""
        if self.result is not None:
            return self.result.scene
        from tomlin._scene import load

        return load(self.file("scene.toml"))

    def find(self, path: str) -> str | None:
        """The result of this name; the family may be left out where that is clear."""
        if path in self.results:
            return path
        found = [family + path for family in _FAMILIES if family + path in self.results]
        return found[0] if len(found) == 1 else None


def run_of(summary: Mapping[str, Any], scene: Mapping[str, Any], folder: str,
           result: Result | None = None) -> Run:
    run = Run(folder, str(summary["status"]), result=result)
    parameters = summary.get("parameters")
    for name, value in parameters.items() if isinstance(parameters, dict) else ():
        number = number_of(value)
        if number is not None and math.isfinite(number):
            run.parameters[name] = number
    for key, value in summary.items():
        if key not in _NO_RESULTS:
            _results(value, key, run.results)
    about = summary.get("scene")
    if isinstance(about, dict):
        if about.get("units") in ("reduced", "metal"):
            run.system = about["units"]
        axes = about.get("axes")
        run.units = {key: unit for key, unit in axes.items() if isinstance(unit, str)} if isinstance(
            axes, dict) else {}
    parameters = scene.get("parameters")
    if isinstance(parameters, dict):
        run.written = {name: _as_written(value) for name, value in parameters.items()}
    return run


def read_run(folder: str) -> Run:
    """Raises SceneError for a folder without a summary of a run."""
    summary = read_json(os.path.join(folder, "summary.json"))
    if not isinstance(summary.get("status"), str):
        raise refusal("file.invalid", os.path.join(folder, "summary.json"), "there is no status in it")
    return run_of(summary, read_toml(os.path.join(folder, "scene.toml")), folder)


def run_in_memory(result: Result) -> Run:
    """A result of this process, or one that was opened."""
    text = result.scene._core.text
    return run_of(result.summary, tomllib.loads(text), str(result.folder or "this run"), result)


def _differs(runs: Sequence[Run], parameter: str) -> bool:
    """Whether the runs that have this parameter give it different values of its own, which do not
    follow from others."""
    having = [run for run in runs if parameter in run.parameters]
    texts = {run.written.get(parameter) for run in having}
    return len({run.parameters[parameter] for run in having}) > 1 and (
        len(texts) > 1 or None in texts)


def differing_parameters(runs: Sequence[Run]) -> list[str]:
    names = dict.fromkeys(name for run in runs for name in run.parameters)
    return [name for name in names if _differs(runs, name)]


def label_of(run: Run, parameters: Sequence[str]) -> str:
    return ", ".join(f"{name} = {run.parameters[name]:.6g}" for name in parameters
                     if name in run.parameters)


def in_order_of_parameters(runs: Sequence[Run]) -> list[Run]:
    """A run without a parameter comes first."""
    names = differing_parameters(runs)
    return sorted(runs, key=lambda run: [(name in run.parameters, run.parameters.get(name, 0.0))
                                         for name in names])


def curve_labels(runs: Sequence[Run]) -> list[str]:
    """The parameters that differ; names of folders where these do not tell runs apart."""
    if len(runs) < 2:
        return [""] * len(runs)
    names = differing_parameters(runs)
    labels = [label_of(run, names) for run in runs]
    for other in ([run.name for run in runs], [run.folder for run in runs]):
        labels = [label if label and labels.count(label) == 1 else text
                  for label, text in zip(labels, other)]
    return labels
