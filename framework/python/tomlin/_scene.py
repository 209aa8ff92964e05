"""Scenes: what is run."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from tomlin import _core
from tomlin._errors import above_zero, core_of, core_value, interrupted, typed, whole
from tomlin._progress import shown
from tomlin._record import table_html
from tomlin._result import Result, open as open_folder
from tomlin._simulation import Simulation
from tomlin._studies import Check, Comparison, Explanation, Tradeoff
from tomlin._text import document_text, setting_text

Progress = bool | Callable[..., Any] | None


def load(path: str | os.PathLike[str], *, plugins: Sequence[str | os.PathLike[str]] = ()) -> Scene:
    """Reads and checks a scene file.

    ``plugins`` are shared libraries with further components, by paths from the current folder;
    those that the scene names are loaded as well. Raises `SceneError` with every fault.

    >>> import tomlin
    >>> tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
    <tomlin.Scene 'Prandtl-Tomlinson: stick-slip', scenarios/prandtl_tomlinson/stick_slip.toml>
    >>> tomlin.load("no_such_file.toml")
    Traceback (most recent call last):
    tomlin._errors.SceneError: no_such_file.toml:1:1: error: there is no such file [file.cannot_read]
    """
    return Scene(_core.read_file(os.fsencode(path), _paths(plugins)))


def parse(scene: str | Mapping[str, Any], file: str | os.PathLike[str] = "scene.toml", *,
          plugins: Sequence[str | os.PathLike[str]] = ()) -> Scene:
    """A scene from its text, or from a dict of plain Python values with the same keys.

    ``file`` stands in messages, and paths in the scene are relative to its folder. Texts where
    numbers are expected are expressions, as in a file. Raises `SceneError` with every fault, whose
    lines are those of the text, and those of the text that a dict is written as; their keys are
    dotted paths in either. Raises TypeError for values that TOML has no form of, such as None.

    >>> import tomlin
    >>> tip = tomlin.parse({
    ...     "parameters": {"k": 2.0},
    ...     "body": [{"name": "tip", "type": "point", "position": [0.0], "particle_mass": 1.0}],
    ...     "force": [
    ...         {"name": "driver", "type": "driving_spring", "stiffness": "k", "velocity": [0.5]},
    ...         {"type": "viscous_damping", "coefficient": 3.0},
    ...     ],
    ...     "run": {"duration": 40.0, "integrator": {"type": "dopri5"}},
    ...     "measure": {"from": 30.0, "to": 40.0, "in": "time"},
    ... })
    >>> round(tip.run()["driver.mean_force.x"], 9)
    1.5
    """
    if not isinstance(scene, (str, Mapping)):
        raise TypeError(f"a scene is a text or a dict, not {type(scene).__name__}; "
                        "tomlin.load reads files")
    text = scene if isinstance(scene, str) else document_text(scene)
    return Scene(_core.read_text(text, os.fsencode(file), _paths(plugins)))


def _paths(plugins: Sequence[str | os.PathLike[str]]) -> list[bytes]:
    if isinstance(plugins, (str, os.PathLike)):
        plugins = [plugins]
    return [os.fsencode(one) for one in plugins]


class Scene:
    """A checked scene. It never changes: `set` returns another one."""

    __slots__ = ("_core",)

    def __init__(self, core: _core.Scene):
        self._core = core

    def set(self, name: str | Mapping[str, Any] | None = None, value: Any = None,
            /, **values: Any) -> Scene:
        """The scene with another value, as with ``--set`` of the program, or with several.

        A name is that of a parameter or a dotted path (``run.integrator.dt``,
        ``force.driver.stiffness``); a text is a word or an expression over the parameters, an array
        or a tuple a list. Raises `SceneError`, or TypeError for a value that TOML has no form of.

        >>> import tomlin
        >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
        >>> tip.set("s", 0.5).parameters["s"]
        0.5
        >>> tip.set(v="V0/10", s=2).parameters["v"]
        0.01
        >>> tip.set({"run.integrator.relative_tolerance": 1e-12, "v": 1e-2}).parameters["v"]
        0.01
        """
        given: dict[str, Any] = dict(values)
        if isinstance(name, Mapping):
            given = {**name, **given}
        elif name is not None:
            given = {name: value, **given}
        return Scene(self._core.with_settings(
            [(typed(path, "a name", str, "a text"), setting_text(one, path))
             for path, one in given.items()]))

    parameters: dict[str, float] = core_value(
        "parameters",
        "The values of ``[parameters]``, expressions evaluated, in the order of the scene.")
    name: str = core_value("name", "``name`` of ``[scene]``.")
    source: str = core_value(
        "source", "``source`` of ``[scene]``: the work that the model is taken from.")
    file: str = core_value("file", "The file that it was read from, as given.")
    dimension: int = core_value("dimension", "Number of axes of positions and forces, 1 to 3.")
    units: str = core_value("units", '"reduced" or "metal" (eV, Angstrom, ps, u, K).')
    duration: float = core_value(
        "duration", "Of a run, in the scene's time unit; with ``until`` its latest end.")

    def to_toml(self) -> str:
        """The scene with all defaults filled in, as TOML; running it gives the same bits. Its
        ``[sweep]`` is as it was written.

        >>> import tomlin
        >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
        >>> tomlin.parse(tip.to_toml()).to_toml() == tip.to_toml()
        True
        """
        sweep = tomllib.loads(self._core.text).get("sweep")
        return self._core.effective_toml + (document_text({"sweep": sweep}) if sweep else "")

    def to_dict(self) -> dict[str, Any]:
        """The scene as `to_toml` has it, as a dict of plain Python values, which `parse` takes."""
        return tomllib.loads(self.to_toml())

    def run(self, *, folder: str | os.PathLike[str] | None = None, resume: bool = False,
            force: bool = False, threads: int = 1,
            progress: Progress = None) -> Result:
        """Runs the scene from its start to its end, and returns what it found.

        With a ``folder`` it leaves there what ``tomlin run`` does. A folder that is not empty is
        refused unless ``resume``, which continues the run that was stopped there (or starts it, or
        returns the result of one that is over), or ``force``, which replaces it.

        ``progress=True`` writes a line to ``sys.stderr``; a callable gets an object with ``time``,
        ``duration``, ``steps`` and ``elapsed_seconds`` a few times a second, and stops the run by
        raising. The interpreter's lock is released, so that several runs may take their steps at
        once; ``threads``, 1 to 4096, share the evaluations of forces between particles, without a
        change of a bit: worth while for some thousand atoms.

        Ctrl-C, in the main thread, ends the run between two steps and raises KeyboardInterrupt,
        which has the result so far, of the status "interrupted", as its ``result``. A run that
        fails numerically raises nothing: its status is "failed", and ``failure`` says why. Raises
        `SceneError` for what only shows when the scene is bound, and `OutputError` for files that
        cannot be written or read.

        >>> import tomlin
        >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
        >>> tip.set("v", 0.01).run().events["event"][:2]
        array(['slip', 'slip'], dtype='<U4')
        """
        if not 1 <= whole(threads, "threads") <= 4096:
            raise ValueError(f"threads = {threads}: 1 to 4096")
        if folder is None and (resume or force):
            raise ValueError("resume and force are about a folder, and none is given")
        with shown(progress) as show:
            path = None if folder is None else os.path.abspath(os.fsdecode(folder))
            run = (_core.run(self._core, threads, show) if path is None else
                   _core.run_in_folder(self._core, os.fsencode(path), resume, force, threads, show))
        if run is None:
            assert path is not None
            return open_folder(path)
        result = Result._of_run(run, path)
        if result.status == "interrupted":
            raise interrupted(result)
        return result

    def simulation(self) -> Simulation:
        """The run as an object that takes steps when it is asked to. Raises `SceneError` for what
        only shows when the scene is bound."""
        return Simulation(self)

    def explain(self, seconds: float = 0.1) -> Explanation:
        """Shows what the scene builds and leaves out, its scales, its stable step and its cost,
        which is tried out for so many seconds. Raises `SceneError` for what a run would refuse.

        >>> import tomlin
        >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
        >>> round(tip.explain(seconds=0.01).sliding[0].stick_slip, 6)
        5.0
        """
        if seconds != 0:
            above_zero(seconds, "seconds")
        return Explanation(json.loads(self._core.explain_json(seconds)))

    def check(self, seed: int = 1) -> Check:
        """Verifies what every force declares about itself, at random states of this scene that
        ``seed`` determines. Ctrl-C raises KeyboardInterrupt between two of them. Raises
        `SceneError` for what a run would refuse.

        >>> import tomlin
        >>> tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml").check().holds
        True
        """
        return Check(json.loads(self._core.check_json(min(whole(seed, "seed"), 2**64 - 1))))

    def tradeoff(self, observable: str, *, tolerance: float = 1e-3, budget: float = 60.0,
                 progress: Progress = None) -> Tradeoff:
        """Measures what accuracy of an observable costs, and finds the cheapest setting whose error
        is below ``tolerance`` (relative; where the observable is zero, in its unit). ``budget`` is
        in seconds. Ctrl-C ends it with what is known, its ``status`` is then "interrupted". A callable
        ``progress`` gets a text. Raises `SceneError` for a path that is no observable, ValueError
        for a tolerance or a budget that is not above 0."""
        typed(observable, "observable", str, "a dotted path")
        above_zero(tolerance, "tolerance")
        above_zero(budget, "budget")
        with shown(progress) as show:
            text = self._core.tradeoff_json(observable, tolerance, budget, show)
        tradeoff = Tradeoff(json.loads(text))
        tradeoff._scene = self
        return tradeoff

    def __repr__(self) -> str:
        return f"<tomlin.Scene {self.name!r}, {self.file}>"

    def _repr_html_(self) -> str:
        return table_html(self.parameters, self.name or self.file)

    def __copy__(self) -> Scene:
        return self

    def __deepcopy__(self, _: Any) -> Scene:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_effective, (self.to_toml(), self.file)


def _from_effective(text: str, file: str) -> Scene:
    return parse(text, file)


def compare(scenes: Sequence[Scene], observable: str, *, tolerance: float = 1e-2,
            progress: Progress = None) -> Comparison:
    """Models side by side: which is the simplest whose observable agrees within ``tolerance`` with
    that of the model with the most coordinates? "driver" and "body" stand for the only ones of
    each scene. ``tolerance`` is relative. A callable ``progress`` gets a text. Raises `SceneError`
    for scenes that are not comparable, ValueError for fewer than two of them.

    >>> import tomlin
    >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml").set("v", 0.1)
    >>> both = tomlin.compare([tip, tip.set("run.integrator", {"type": "rk4", "dt": 0.01})],
    ...                       "driver.mean_force.x")
    >>> [model.verdict for model in both.models]
    ['agrees', 'reference']
    """
    if len(scenes) < 2:
        raise ValueError("one scene cannot be compared: two or more")
    typed(observable, "observable", str, "a dotted path")
    above_zero(tolerance, "tolerance")
    with shown(progress) as show:
        text, curves = _core.compare([core_of(one) for one in scenes], observable, tolerance, show)
    comparison = Comparison(json.loads(text))
    comparison._curves = curves
    comparison._axes = scenes[0]._core.axes
    return comparison
