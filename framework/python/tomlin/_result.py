"""Results of runs."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tomlin import _core
from tomlin._errors import OutputError, QuantityError, RunError, SceneError, no_such_name
from tomlin._record import AXES, Record, shown, table_html, wrapped
from tomlin._tables import EVENT_FIELDS, read_events, read_samples

if TYPE_CHECKING:
    from tomlin._scene import Scene


class Table(np.ndarray[Any, Any]):
    """A one-dimensional structured array: a row for each sample or event, a field for each column.

    ``table["time"]`` is a column, a plain array; ``units`` has the unit of each. The field
    ``positions``, of runs with ``[output] trajectory``, has the shape (rows, particles, axes).
    """

    units: dict[str, str]

    def __new__(cls, array: NDArray[Any], units: dict[str, str]) -> Table:
        table = np.asarray(array).view(cls)
        table.units = units
        return table

    def __array_finalize__(self, other: Any) -> None:
        self.units = getattr(other, "units", {})

    def __reduce__(self) -> Any:
        reduced: Any = super().__reduce__()
        make, arguments, state = reduced
        return make, arguments, (state, self.units)

    def __setstate__(self, state: Any) -> None:
        super().__setstate__(state[0])
        self.units = state[1]

    def __getitem__(self, key: Any) -> Any:
        found = super().__getitem__(key)
        return found.view(np.ndarray) if isinstance(key, str) else found

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        return self.dtype.names or ()

    def to_pandas(self) -> Any:
        """A DataFrame of the columns that are numbers or texts. Needs pandas."""
        import pandas

        return pandas.DataFrame({name: self[name] for name in self.columns
                                 if self[name].ndim == 1})

    def to_xarray(self) -> Any:
        """A Dataset over the dimension ``time`` with the units as attributes. Needs xarray."""
        import xarray

        data = xarray.Dataset()
        for name in self.columns:
            dims = ("time", "particle", "axis")[:self[name].ndim]
            data[name] = (dims, np.array(self[name]), {"units": self.units.get(name, "")})
        return data.set_coords("time") if "time" in self.columns else data

    def _repr_html_(self) -> str:
        names = [name for name in self.columns if self[name].ndim == 1]
        rows = list(range(min(5, len(self)))) + ([len(self) - 1] if len(self) > 5 else [])
        cells = "".join("<tr>" + "".join(f"<td>{shown(self[name][row].item())}</td>"
                                         for name in names) + "</tr>" for row in rows)
        head = "".join(f"<th>{name}</th>" for name in names)
        return f"<table><caption>{len(self)} rows</caption><tr>{head}</tr>{cells}</table>"


def samples_table(numbers: NDArray[np.float64], layout: dict[str, Any]) -> Table:
    """The memory of the samples as it is, seen as columns."""
    columns = layout["columns"]
    fields: list[tuple[Any, ...]] = [(name, "f8") for name, _ in columns]
    units = dict(columns)
    particles = sum(count for _, count in layout["bodies"])
    if particles:
        fields.append(("positions", "f8", (particles, layout["dimension"])))
        units["positions"] = "length"
    if not fields:
        fields, numbers = [("time", "f8")], np.empty((0, 1))
    if not len(numbers):
        return Table(np.empty(0, dtype=fields), units)
    return Table(numbers.view(np.dtype(fields)).reshape(-1), units)


def events_table(events: Sequence[tuple[Any, ...]]) -> Table:
    """Columns time, event, name, duration, size, energy_lost and peak_force; NaN where a kind of
    event has no such number."""
    width = [max([1, *(len(one[k]) for one in events)]) for k in (1, 2)]
    fields = [("time", "f8"), ("event", f"U{width[0]}"), ("name", f"U{width[1]}"),
              *((name, "f8") for name in EVENT_FIELDS)]
    units = {"time": "time", "duration": "time", "energy_lost": "energy", "peak_force": "force"}
    return Table(np.array(events, dtype=fields), units)


class Result:
    """The result of a run.

    Every number of ``summary.json`` is found by its dotted path, with the leading "drivers." or
    "bodies." optional and components by letter, and the same as attributes; None is undefined.

    >>> import tomlin
    >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
    >>> result = tip.set("v", 0.01).run()
    >>> result["driver.mean_force.x"] == result.driver.mean_force.x
    True
    >>> result["driver.mean_force"]
    Vector(0.478...,)
    >>> result["events.slips"], result.events["event"].size
    (7, 7)
    >>> result["driver.mean_farce"]
    Traceback (most recent call last):
    tomlin._errors.QuantityError: observable: error: driver.mean_farce: ...
    """

    _run: _core.Run | None = None
    _failure: dict[str, Any] | None = None  #: of a run of another process
    _folder: Path | None = None
    _identity: tuple[int, ...] | None = None  #: of the summary in the folder

    @classmethod
    def _of_run(cls, run: _core.Run, folder: str | os.PathLike[str] | None = None) -> Result:
        result = cls()
        result._run = run
        if folder is not None:
            result._folder = Path(folder).absolute()
            result._identity = _identity_of(result._folder)
        return result

    @classmethod
    def _of_folder(cls, folder: str | os.PathLike[str]) -> Result:
        result = cls()
        result._folder = Path(os.fsdecode(folder)).absolute()
        result._identity = _identity_of(result._folder)
        result.summary  # which has to be there
        return result

    def __getstate__(self) -> dict[str, Any]:
        """All that it can say without the run itself; of a folder what its files do not say."""
        names = ("summary", "scene") if self._folder else ("summary", "scene", "samples",
                                                           "event_table")
        failure = self._run.failure if self._run is not None else self._failure
        return {**{name: getattr(self, name) for name in names}, "_failure": failure,
                "_folder": self._folder, "_identity": self._identity}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        if "samples" in state:
            self.samples.setflags(write=False)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The content of ``summary.json`` as a dict of plain Python values; None is undefined."""
        if self._run is not None:
            return dict(json.loads(self._run.summary_json()))
        assert self._folder is not None
        file = self._folder / "summary.json"
        try:
            found = json.loads(file.read_text(encoding="utf-8"))
            if not isinstance(found["status"], str):
                raise TypeError
            return dict(found)
        except OSError as error:
            hint = ""
            if (self._folder / "sweep.json").exists():
                hint = "; the folder is of a sweep, which tomlin.sweep(..., folder=...) reads again"
            raise OutputError(f"cannot read {file}: {error.strerror}{hint}") from None
        except (ValueError, TypeError, LookupError):
            raise OutputError(f"{file} is no summary of a run") from None

    def _files(self) -> Path:
        """The folder. Raises OutputError where it no longer has the files of this run."""
        assert self._folder is not None
        if _identity_of(self._folder) != self._identity:
            raise OutputError(f"{self._folder} is gone, or has another run than when this result "
                              "was made; tomlin.open reads what is there")
        return self._folder

    @property
    def status(self) -> str:
        """"finished", "interrupted" or "failed"."""
        return self._run.status if self._run is not None else str(self.summary["status"])

    @property
    def failure(self) -> Record | None:
        """Why the run failed, or None: ``message`` is one sentence with everything in it, and
        ``step``, ``time``, ``body``, ``particle``, ``force``, ``what``, ``cause``, ``code`` are its
        parts."""
        found = (self._run.failure if self._run is not None else
                 self._failure or self.summary.get("failure"))
        return Record(found) if isinstance(found, dict) else found

    def require_finished(self) -> Result:
        """Itself. Raises `RunError` with the program's message where the run did not finish."""
        if self.status == "finished":
            return self
        failure = self.failure
        if isinstance(failure, Record):
            raise RunError(str(failure.get("message", failure)))
        raise RunError(str(failure) if failure else f"the run was {self.status}")

    @property
    def folder(self) -> Path | None:
        """The folder of its files; None of a run in memory."""
        return self._folder

    @cached_property
    def scene(self) -> Scene:
        """The scene that was run, with the integrator that ``accuracy`` has chosen. Of a folder it
        is read from its ``scene.toml``; raises `SceneError` where a plugin is not found again."""
        from tomlin._scene import Scene, load

        if self._run is not None:
            return Scene(self._run.scene)
        return load(self._files() / "scene.toml")

    def __getitem__(self, path: str) -> Any:
        if not isinstance(path, str):
            raise TypeError(f"a dotted path, not {path!r}")
        # A single number costs less than the whole summary.
        if self._run is not None and "summary" not in self.__dict__:
            try:
                return self._run.observable(path)
            except SceneError:
                pass
        candidates = [path, f"drivers.{path}", f"bodies.{path}"]
        head, _, rest = path.partition(".")
        if head in ("error", "determined"):
            candidates += [f"{head}.drivers.{rest}", f"{head}.bodies.{rest}"]
        for one in candidates:
            found, value = _find(self.summary, one)
            if found:
                return wrapped(value)
        if self._run is not None:
            try:
                return self._run.observable(path)
            except SceneError as error:
                raise QuantityError(error.faults) from None
        raise no_such_name(path, _paths(self.summary), "result")

    def __contains__(self, path: object) -> bool:
        try:
            self[path]  # type: ignore[index]
        except (QuantityError, TypeError):
            return False
        return True

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except QuantityError:
            raise AttributeError(f"a result has no {name!r}") from None

    def __dir__(self) -> list[str]:
        summary = self.summary
        names = [*summary, *summary.get("drivers", {}), *summary.get("bodies", {})]
        return [*super().__dir__(), *(name for name in names if name.isidentifier())]

    @cached_property
    def samples(self) -> Table:
        """The samples in time, of scenes with ``[output] every``: a structured array of shape
        (samples,), read-only, in the units of ``samples.units``; empty of other scenes. Of a run
        in memory it is the memory of the run itself, no copy; of one with a folder it is read from
        ``observables.csv`` and, with ``[output] trajectory``, from the file of the trajectory.
        Raises `OutputError` for files that are damaged, or are those of another run by now.

        >>> import tomlin
        >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
        >>> samples = tip.set("v", 0.01).run().samples
        >>> samples.columns[:3], samples["driver.force.x"].shape
        (('time', 'driver.force.x', 'driver.position.x'), (801,))
        """
        if self._run is not None and self._folder is None:
            return samples_table(self._run.samples(), self._run.layout())
        folder = self._files()
        table = _samples_in(folder / "observables.csv")
        positions = _positions_in(folder)
        if positions is not None:
            if len(positions) != len(table):
                raise OutputError(f"{folder}: {len(table)} samples, but positions of "
                                  f"{len(positions)}")
            table = _with_positions(table, positions[:, :, :self.scene.dimension])
        table.setflags(write=False)
        return table

    @cached_property
    def event_table(self) -> Table:
        """Slips, hops, turns, reversals in the order of time: columns ``time``, ``event``,
        ``name`` (of the driver or the body), ``duration``, ``size``, ``energy_lost`` and
        ``peak_force``, NaN where a kind has no such number; shape (events,), in the units of
        ``event_table.units``. At most a million."""
        if self._run is not None and self._folder is None:
            return events_table(self._run.events())
        file = self._files() / "events.csv"
        return events_table(_read(read_events, file) if file.exists() else [])

    @property
    def events(self) -> Table:
        """See `event_table`; the counts of events are ``result["events.slips"]`` and the like."""
        return self.event_table

    def quantities(self) -> dict[str, tuple[float | None, str, str]]:
        """Value, unit and meaning of every declared quantity, by its path in full. Raises
        `OutputError` for results that were opened, whose numbers are in `summary`."""
        if self._run is None:
            raise OutputError("of runs of this process only: summary.json has the numbers")
        return {path: (value, unit, meaning)
                for path, value, unit, meaning in self._run.quantities()}

    def plot(self, y: str | None = None, x: str | None = None, ax: Any = None, **options: Any) -> Any:
        """Draws a figure by matplotlib, and returns the axes.

        ``y`` over ``x`` are columns of the samples or quantities of ``tomlin plot``, as
        "force_size"; ``y`` alone may be one of its figures, "hysteresis", "loop", "path", "ring",
        "slips" or "surface". By default the force of the first driver along its pull, over the
        position of the driver's end or else over time: the friction trace, or the friction loop of
        a driver that reverses. ``options`` are those of ``Axes.plot``. Raises `SceneError` where
        there are no samples, `QuantityError` for a column that there is not, ImportError without
        matplotlib; warns of a flexible body, which "ring" draws in the shape that it starts with.
        """
        from tomlin._plots import plot_result

        return plot_result(self, y, x, ax, **options)

    def _rows(self) -> dict[str, Any]:
        summary = self.summary
        rows: dict[str, Any] = {"status": self.status}
        if self.failure:
            rows["failure"] = getattr(self.failure, "message", None) or self.failure
        for family, keys in (("drivers", ("mean_force", "static_force", "work_per_distance")),
                             ("bodies", ("mean_velocity", "turns", "rolling"))):
            for name, group in summary.get(family, {}).items():
                rows.update({f"{name}.{key}": group[key] for key in keys
                             if group.get(key) is not None})
        events = {key: count for key, count in summary.get("events", {}).items() if count}
        if events:
            rows["events"] = events
        rows["time"] = summary.get("time", {})
        for k, warning in enumerate(summary.get("warnings", [])):
            rows[f"warning {k + 1}"] = warning
        return rows

    def __str__(self) -> str:
        if self._run is not None:
            return self._run.text(f"{self._folder}/" if self._folder else "in memory").rstrip()
        return "\n".join(f"{key:>24}  {shown(value)}" for key, value in self._rows().items())

    def __repr__(self) -> str:
        where = f" in {self._folder}" if self._folder else ""
        return f"<tomlin.Result {self.status}{where}>"

    def _repr_html_(self) -> str:
        from tomlin._plots import trace_html

        return table_html(self._rows(), str(self.summary.get("name") or "")) + trace_html(self)


def _identity_of(folder: Path) -> tuple[int, ...] | None:
    """Of the summary that stands there: another one is another file."""
    try:
        found = (folder / "summary.json").stat()
    except OSError:
        return None
    return found.st_dev, found.st_ino, found.st_mtime_ns, found.st_size


def _read(reader: Callable[[str], Any], file: Path) -> Any:
    """Raises OutputError, with the location of what is damaged."""
    try:
        return reader(str(file))
    except SceneError as error:
        raise OutputError(str(error)) from None


def _samples_in(file: Path) -> Table:
    if not file.exists():
        return samples_table(np.empty((0, 0)), {"columns": [], "bodies": []})
    columns = _read(read_samples, file)
    numbers = np.stack([columns[name] for name in columns.names], axis=1)
    return samples_table(numbers, {"columns": list(columns.units.items()), "bodies": []})


def _positions_in(folder: Path) -> NDArray[np.float64] | None:
    """Of the trajectory [sample, particle, axis], with three axes; None where there is none."""
    if (folder / "trajectory.h5").exists():
        return _core.positions_in(os.fsencode(folder / "trajectory.h5"))
    file = folder / "trajectory.xyz"
    if not file.exists():
        return None
    with file.open(encoding="utf-8") as stream:
        try:
            # Each frame: the number of particles, a line about the frame, a line for each.
            count = int(stream.readline())
            stream.seek(0)
            rows = (line for k, line in enumerate(stream) if k % (count + 2) > 1)
            return np.array([line.split()[1:4] for line in rows], float).reshape(-1, count, 3)
        except ValueError:
            raise OutputError(f"{file} is no trajectory of a run") from None


def _with_positions(table: Table, positions: NDArray[np.float64]) -> Table:
    fields = [*((name, "f8") for name in table.columns), ("positions", "f8", positions.shape[1:])]
    whole = np.empty(len(table), dtype=fields)
    for name in table.columns:
        whole[name] = table[name]
    whole["positions"] = positions
    return Table(whole, {**table.units, "positions": "length"})


def _paths(node: Any, above: str = "") -> list[str]:
    """Of all numbers, without the leading "drivers." and "bodies."."""
    if isinstance(node, list) and 0 < len(node) <= len(AXES):
        return [f"{above}.{axis}" for axis, _ in zip(AXES, node)]
    if not isinstance(node, dict):
        return [above]
    return [path for key, value in node.items()
            for path in _paths(value, f"{above}.{key}" if above else
                               "" if key in ("drivers", "bodies") else key)]


def _find(node: Any, path: str) -> tuple[bool, Any]:
    """Names may have dots in them: the longest key goes first."""
    if isinstance(node, list) and len(path) == 1 and path in AXES[:len(node)]:
        return True, node[AXES.index(path)]
    if node is None and len(path) == 1 and path in AXES:
        return True, None  # of a vector that is undefined
    if not isinstance(node, dict):
        return False, None
    if path in node:
        return True, node[path]
    for key in sorted((key for key in node if path.startswith(key + ".")), key=len, reverse=True):
        found, value = _find(node[key], path[len(key) + 1:])
        if found:
            return True, value
    return False, None


def open(folder: str | os.PathLike[str]) -> Result:
    """The result of a run in a folder, as ``tomlin run`` or ``scene.run(folder=...)`` left it.
    Samples and events are read when they are asked for. Raises `OutputError`.

    >>> import tempfile, tomlin
    >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml").set("v", 0.1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     force = tip.run(folder=folder)["driver.mean_force.x"]
    ...     force == tomlin.open(folder)["driver.mean_force.x"]
    True
    """
    return Result._of_folder(folder)
