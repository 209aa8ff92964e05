"""Runs that wait between steps."""

from __future__ import annotations

import hashlib
import numbers
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tomlin import _core
from tomlin._errors import above_zero, core_of, core_value, typed, whole
from tomlin._record import Record, Vector, table_html
from tomlin._result import Result, Table, events_table, samples_table

if TYPE_CHECKING:
    from tomlin._scene import Scene


@dataclass(frozen=True)
class State:
    """All numbers of a run between two steps. It can be pickled, and given to any simulation of
    the same scene. Samples and events that were recorded before it are not among them: they stay
    in the simulation that has made them."""

    time: float
    _numbers: bytes = field(repr=False)
    _samples: int = field(repr=False)
    _events: int = field(repr=False)
    _is_over: bool = field(repr=False)
    _scene: str = field(repr=False)
    _digest: bytes = field(repr=False)  #: of all others, by which damage shows

    def _is_damaged(self) -> bool:
        return self._digest != _digest_of(self.time, self._numbers, self._samples, self._events,
                                          self._is_over, self._scene)


def _digest_of(*parts: Any) -> bytes:
    digest = hashlib.blake2b(digest_size=16)
    for one in parts:
        digest.update(one if isinstance(one, bytes) else repr(one).encode())
    return digest.digest()


class Simulation:
    """A run that takes steps when it is asked to, with the bits of `Scene.run`.

    It does one run as ``scene.run`` does, without what compares runs: ``perturb``, ``repeats`` and
    the errors of ``accuracy`` (whose integrator is chosen all the same). One thread uses it at a
    time; several simulations run at once.

    >>> import tomlin
    >>> sim = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml").simulation()
    >>> sim.advance(to=100.0)
    >>> sim.time >= 100.0, sim.positions.shape
    (True, (1, 1))
    >>> before = sim.state
    >>> sim.advance(to=200.0); later = sim.positions.copy()
    >>> sim.state = before; sim.advance(to=200.0)
    >>> bool((sim.positions == later).all())
    True

    ``positions``, ``velocities`` and ``forces`` are read-only views of memory that stays where it
    is: an array that was read once shows the present state whenever the property is read again.
    """

    def __init__(self, scene: Scene):
        self._scene = scene
        self._core = _core.Simulation(core_of(scene))

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self._scene

    def advance(self, to: float | None = None, *, steps: int | None = None) -> None:
        """Takes steps up to the first end of a step at time ``to`` or later, or so many steps, or
        whichever comes first; without either, to the end of the run. Where the run ends, or fails,
        is ``done``. No step is changed by where one stops. Ctrl-C raises KeyboardInterrupt between
        two steps, and the simulation can go on; handlers of other signals are called between steps
        as well, and may raise.
        """
        most = 2**63 if steps is None else min(whole(steps, "steps"), 2**63)
        time = float("inf") if to is None else float(typed(to, "to", numbers.Real, "a time"))
        if time != time:
            raise ValueError("to = nan: a time")
        self._core.advance(time, most)

    def run(self, every: float | None = None, call: Callable[[Simulation], Any] | None = None) -> Result:
        """Goes on to the end of the run and returns its result. ``call(simulation)`` is called
        each time that another ``every`` of time is over, counted from time 0, and at the end; it
        stops the run by returning True, Python's or NumPy's, and the result is then "interrupted".

        >>> import tomlin
        >>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml").set("v", 0.01)
        >>> times = []
        >>> result = tip.simulation().run(every=200.0, call=lambda sim: times.append(sim.time))
        >>> len(times), result.status
        (4, 'finished')
        """
        if call is None:
            self.advance()
            return self.result()
        every = above_zero(every, "every")
        count = int(self.time // every) + 1
        while not self.done:
            self.advance(to=count * every)
            answer = call(self)
            if isinstance(answer, (bool, np.bool_)) and answer:
                break
            count = max(count + 1, int(self.time // every) + 1)
        return self.result()

    def result(self) -> Result:
        """The result so far; where the run is not over its status is "interrupted", and what needs
        its end is None. The simulation can go on."""
        return Result._of_run(self._core.result())

    time: float = core_value("time", "Time of the state [time].")
    steps: int = core_value("steps", "Steps taken so far.")
    done: bool = core_value("done", "Whether the run has ended or failed; see ``result().status``.")
    duration: float = core_value("duration", "When the run ends, at the latest [time].")
    positions: NDArray[np.float64] = core_value(
        "positions",
        "Positions of all particles [length], of shape (particles, axes), in the coordinates of "
        "the scene; bodies one after the other, see ``bodies``. A read-only view.")
    velocities: NDArray[np.float64] = core_value(
        "velocities",
        "Velocities [length/time], likewise. Without inertia those that follow from the forces; "
        "of rigid bodies then those at the last step.")
    forces: NDArray[np.float64] = core_value(
        "forces",
        "Forces on all particles [force], likewise: the sum of all forces of the scene, without "
        "what acts on the centre of a rigid body.")

    @property
    def bodies(self) -> dict[str, slice]:
        """Rows of the particles of each body: ``sim.positions[sim.bodies["ring"]]``."""
        first, all_ = 0, {}
        for name, count in self._core.bodies:
            all_[name] = slice(first, first + count)
            first += count
        return all_

    @property
    def driver_forces(self) -> Record:
        """The force that each driver exerts [force], a `Vector` of one number per axis by its
        name."""
        return Record({name: Vector(self._core.driver_force(k))
                       for k, name in enumerate(self._core.drivers)})

    kinetic_energy: float = core_value(
        "kinetic_energy", "Of all bodies [energy]; 0 without inertia.")
    potential_energy: float = core_value(
        "potential_energy",
        "Of all forces that have one [energy]; only differences of it have a meaning.")

    @property
    def samples(self) -> Table:
        """The samples so far, of scenes with ``[output] every``: a copy of shape (samples,), as
        `Result.samples`."""
        return samples_table(self._core.samples(), self._core.layout())

    @property
    def events(self) -> Table:
        """The events so far: a copy of shape (events,), as `Result.event_table`."""
        return events_table(self._core.events())

    @property
    def state(self) -> State:
        """All numbers of the run. Assigning it back takes the run to that moment, exactly. Where a
        run ``until`` something, or a quasistatic one, was over, that takes the steps of its last
        `advance` once more. Assigning raises ValueError for the state of another scene, and for
        one that is damaged."""
        parts = (self.time, *self._core.save(), core_of(self._scene).effective_toml)
        return State(*parts, _digest_of(*parts))

    @state.setter
    def state(self, state: State) -> None:
        if not isinstance(state, State):
            raise TypeError(f"a state of a simulation, not {type(state).__name__}")
        if state._is_damaged():
            raise ValueError("the state is damaged")
        if state._scene != core_of(self._scene).effective_toml:
            raise ValueError("the state is of another scene")
        self._core.restore(state._numbers, state._samples, state._events, state._is_over)

    def __repr__(self) -> str:
        return f"<tomlin.Simulation at time {self.time:g} of {self.duration:g}>"

    def _repr_html_(self) -> str:
        return table_html({"time": self.time, "of": self.duration, "steps": self.steps,
                           **{f"{name}.force": list(force)
                              for name, force in self.driver_forces.items()}},
                          self._scene.name)
