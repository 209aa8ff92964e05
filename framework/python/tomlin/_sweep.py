"""Sweeps over values of parameters."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tomlin import _core
from tomlin._errors import OutputError, core_of, interrupted, no_such_name, typed, whole
from tomlin._executor import Dispatch, Job, request_of
from tomlin._progress import shown
from tomlin._record import Record, table_html
from tomlin._text import setting_text

if TYPE_CHECKING:
    from tomlin._scene import Progress, Scene


class Sweep(Mapping[str, Any]):
    """The results of a sweep: arrays by name, over the axes in the order in which they were given.

    ``sweep["v"]`` are the values of an axis, ``sweep["driver.mean_force.x"]`` those of an
    observable, of the shape of all axes, NaN where a point has none. With ``refine`` points make no
    grid, and all arrays have one dimension.
    """

    def __init__(self, core: _core.Sweep, scene: Scene, folder: Path | None):
        self._scene = scene
        self._folder = folder
        self._axes: dict[str, NDArray[Any]] = {}
        self._of_dimension: list[list[str]] = [[] for _ in core.shape]
        for name, dimension, values in core.axes():
            self._axes[name] = np.asarray(values)
            self._of_dimension[dimension].append(name)
        self._columns = {name: core.column(k) for k, (name, _, _) in enumerate(core.columns)}
        self._units = {name: unit for name, unit, _ in core.columns}
        self._meanings = {name: meaning for name, _, meaning in core.columns}
        #: "finished", "failed", "refused" or "missing", for each point.
        self.status = np.array(core.status).reshape(core.shape)
        #: Why a point has not finished; empty where it has.
        self.reasons = np.array(core.reasons).reshape(core.shape)
        #: Whether every point has a row; False of a sweep that was interrupted.
        self.complete: bool = core.complete
        self._summary = core.summary_json

    def __getitem__(self, name: str) -> NDArray[Any]:
        for arrays in (self._axes, self._columns):
            if name in arrays:
                return arrays[name]
        short = name.removeprefix("drivers.").removeprefix("bodies.")
        for other in (f"drivers.{name}", f"bodies.{name}", short):
            if other in self._columns:
                return self._columns[other]
        raise no_such_name(name, self, "sweep")

    def __iter__(self) -> Iterator[str]:
        yield from self._axes
        yield from self._columns

    def __len__(self) -> int:
        return len(self._axes) + len(self._columns)

    @property
    def axes(self) -> dict[str, NDArray[Any]]:
        """The values of each axis: arrays of one dimension, of numbers or texts."""
        return dict(self._axes)

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """The observables, and their errors and spreads where the scene asks for them: arrays of
        the shape of the sweep, in `units`."""
        return dict(self._columns)

    @property
    def units(self) -> dict[str, str]:
        """The unit of each observable."""
        return dict(self._units)

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of values along the axes."""
        return self.status.shape

    @property
    def folder(self) -> Path | None:
        """The folder of its files; None of a sweep in memory."""
        return self._folder

    @property
    def summary(self) -> Record:
        """The content of ``sweep.json``: counts, warnings, intervals of ``refine``."""
        text = self._summary
        if not text and self._folder is not None:
            file = self._folder / "sweep.json"
            try:
                text = file.read_text(encoding="utf-8")
            except OSError as error:
                raise OutputError(f"cannot read {file}: {error.strerror}") from None
        return Record(json.loads(text))

    def to_xarray(self) -> Any:
        """A Dataset with a dimension for each axis. Needs xarray."""
        import xarray

        dims = [names[0] if len(names) == 1 else f"point_{k}" if k else "point"
                for k, names in enumerate(self._of_dimension)]
        if len(self.shape) == 1 and len(self._axes) > 1:
            dims = ["point"]
        data = xarray.Dataset()
        for k, names in enumerate(self._of_dimension):
            for name in names:
                data = data.assign_coords({name: ((dims[k],), self._axes[name])})
        for name, values in self._columns.items():
            data[name] = (dims, np.array(values), {"units": self._units[name],
                                                   "long_name": self._meanings[name]})
        data["status"] = (dims, self.status)
        return data

    def to_pandas(self) -> Any:
        """A DataFrame with a row for each point, its status and its reason. Needs pandas."""
        import pandas

        grid = np.indices(self.shape)
        rows = {name: self._axes[name][grid[k]].ravel()
                for k, names in enumerate(self._of_dimension) for name in names}
        rows.update({name: np.array(values).ravel() for name, values in self._columns.items()})
        return pandas.DataFrame({**rows, "status": self.status.ravel(),
                                 "reason": self.reasons.ravel()})

    def plot(self, y: str | None = None, x: str | None = None, ax: Any = None, **options: Any) -> Any:
        """Draws an observable over an axis by matplotlib, a curve for each combination of the
        others, and returns the axes. By default the first observable over the last axis, which is
        logarithmic where its values are spaced so. Errors that the sweep has are bars. Needs
        matplotlib; raises `QuantityError` for names that the sweep has not."""
        from tomlin._plots import plot_sweep

        return plot_sweep(self, y, x, ax, **options)

    def __repr__(self) -> str:
        state = "" if self.complete else ", interrupted"
        axes = ", ".join(f"{name}: {len(values)}" for name, values in self._axes.items())
        return f"<tomlin.Sweep over {axes}{state}>"

    def _repr_html_(self) -> str:
        rows: dict[str, Any] = {name: values.tolist() for name, values in self._axes.items()}
        rows.update({name: values.ravel().tolist() for name, values in self._columns.items()})
        return table_html(rows, repr(self)[1:-1])


def sweep(scene: Scene, over: Mapping[str, Any] | None = None,
          observables: Sequence[str] | str = (), *, zip: Sequence[Sequence[str]] = (),
          repeats: int | None = None, continue_from_neighbour: bool | None = None,
          refine: str | None = None, refine_along: str | None = None,
          refine_to: float | None = None, threads: int | None = None,
          executor: Executor | None = None, chunk: int | None = None,
          folder: str | os.PathLike[str] | None = None, force: bool = False,
          progress: Progress = None) -> Sweep:
    """Runs a scene for all combinations of values, as ``tomlin sweep`` does: in threads, in lanes,
    with the bits of ``scene.set(...).run()`` at every point.

    ``over`` has the values of each name, a parameter or a dotted path: numbers, words, expressions,
    or a grid as the program takes it ("1e-3:1e-1:21:log"). The first axis is the outermost.
    ``zip`` names axes that take their values together. ``observables`` are dotted paths. What is
    not given is taken from ``[sweep]`` of the scene. The other options are those of the program.

    With an ``executor`` of ``concurrent.futures``, such as a pool of processes or one of mpi4py, its
    workers run the points, each in one thread unless ``threads`` says how many. They get ``chunk``
    points at once, by default so many that all are busy to the end. The results have the same bytes.
    Where a worker is lost, `RunError` says how many rows are kept, and has the sweep so far as its
    ``result``; with a ``folder`` the same call continues.

    With a ``folder`` it leaves there what the program does, and continues a sweep of the same
    input that was stopped there; ``force`` begins anew. ``threads`` is one for each processor by
    default; a callable ``progress`` gets a text, the number of points that have a row, and that of
    all. A point that fails or is refused is NaN, with its reason. Ctrl-C raises
    KeyboardInterrupt, whose ``result`` is the sweep so far: its ``complete`` is False. Raises
    `SceneError` for axes and observables that are none, `OutputError`, and TypeError for values that
    TOML has no form of.

    >>> import tomlin
    >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
    >>> friction = tomlin.sweep(tip, over={"s": [0.5, 5.0], "v": [0.05, 0.1]},
    ...                         observables=["driver.mean_force.x"])
    >>> friction["driver.mean_force.x"].shape
    (2, 2)
    >>> bool(friction["driver.mean_force.x"][1, 1]
    ...      == tip.set(s=5.0, v=0.1).run()["driver.mean_force.x"])
    True
    """
    if over is not None and not isinstance(over, Mapping):
        raise TypeError(f"over: a dict of names and values, not {type(over).__name__}")
    names = [observables] if isinstance(observables, str) else list(observables)
    for one in names:
        typed(one, "observables", str, "dotted paths")
    asked = {
        "over": [(name, _values(values, name)) for name, values in (over or {}).items()],
        "zips": [list(one) for one in zip],
        "observables": names,
        "repeats": None if repeats is None else str(repeats),
        "refine": refine,
        "refine_along": refine_along,
        "refine_to": None if refine_to is None else setting_text(refine_to),
        "continues": continue_from_neighbour,
    }
    request = request_of(asked)
    at_once = 1 if executor is not None else 0
    request.threads = at_once if threads is None else whole(threads, "threads", 1)
    path = None if folder is None else os.path.abspath(os.fsdecode(folder))
    request.folder = None if path is None else os.fsencode(path)
    request.force = force
    most = None if chunk is None else whole(chunk, "chunk", 1)
    core = core_of(scene)
    dispatch = None
    with shown(progress) as show, tempfile.TemporaryDirectory(prefix="tomlin-") as scratch:
        request.journal = os.path.join(scratch, "sweep.journal")
        request.progress = show
        if executor is not None:
            typed(executor, "executor", Executor, "an executor of concurrent.futures")
            job = Job(core.text, core.file_bytes, core.plugins, core.settings, asked,
                      request.folder, request.threads)
            request.run_points = dispatch = Dispatch(executor, job, most, show)
        swept = _core.sweep(core, request)
    result = Sweep(swept, scene, None if path is None else Path(path))
    if dispatch is not None:
        dispatch.raise_error(result)
    if not result.complete:
        raise interrupted(result)
    return result


def _values(values: Any, name: str) -> str | list[str]:
    if isinstance(values, str):
        return values
    if hasattr(values, "tolist"):
        values = values.tolist()
    if isinstance(values, (int, float)):
        values = [values]
    if isinstance(values, (bytes, bytearray)):
        raise TypeError(f"over: {name} = {values!r}: a text or values, not bytes")
    return [setting_text(one, name) for one in values]
