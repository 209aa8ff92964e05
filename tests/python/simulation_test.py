"""A step at a time."""

import pickle
import threading
import os
import signal

import numpy as np
import pytest
from scenes import FLEXIBLE, PUSHED, RIGID, TIP, scene

import tomlin
from same_bits_test import MORE, comparable

ENDLESS = {"run.duration": 1e9, "run.integrator": {"type": "rk4", "dt": 0.01},
           "measure.from": 0.0, "measure.to": 1e9, "measure.in": "time", "output.every": 1e6}
RK4 = '{ type = "rk4", dt = 2e-3 }'


def test_views_are_read_only_and_show_the_present(tip):
    sim = tip.simulation()
    view = sim.positions
    start = view.copy()
    with pytest.raises(ValueError):
        view[0, 0] = 1.0
    sim.advance(to=100.0)
    assert np.shares_memory(view, sim.positions) and view[0, 0] != start[0, 0]
    del sim
    assert np.isfinite(view).all()


@pytest.mark.parametrize("body", [FLEXIBLE, RIGID], ids=["flexible", "rigid"])
def test_positions_velocities_forces_are_consistent(body):
    """Velocities and forces are differences of positions and velocities, by central differences of
    a short step: their error is h^2/6 times the third derivative, below 1e-4 of the scale here."""
    sim = tomlin.parse(scene(body, '{ type = "rk4", dt = 1e-4 }', 1.0, 0.5)).simulation()
    sim.advance(steps=1000)
    before, speed_before = sim.positions.copy(), sim.velocities.copy()
    sim.advance(steps=1)
    velocities, forces = sim.velocities.copy(), sim.forces.copy()
    sim.advance(steps=1)
    h = 1e-4
    slope = (sim.positions - before) / (2 * h)
    assert np.abs(slope - velocities).max() < 1e-4 * np.abs(velocities).max()
    change = (sim.velocities - speed_before) / (2 * h)
    mass = 1 / 8
    if body is FLEXIBLE:
        assert np.abs(mass * change - forces).max() < 1e-4 * np.abs(forces).max()
    else:  # the sum over a rigid body moves its centre, with what the spring does to the centre
        total = forces.sum(axis=0) + np.array(sim.driver_forces.driver)
        assert np.abs(change.mean(axis=0) - total)[0] < 1e-3 * np.abs(total).max()


def test_bodies_and_energies():
    sim = tomlin.parse(scene(PUSHED, RK4, 1.0, 0.5)).simulation()
    assert sim.bodies == {"tip": slice(0, 3), "hand": slice(3, 4)}
    assert sim.positions[sim.bodies["hand"]].shape == (1, 2)
    conservative = TIP.replace('coefficient = "sqrt(0.1) * 2.7"', "coefficient = 0.0").replace(
        "velocity = [0.05]", "velocity = [0.0]")
    sim = tomlin.parse(scene(conservative, RK4, 20.0, 0.5)).simulation()
    start = sim.kinetic_energy + sim.potential_energy
    sim.advance(to=10.0)
    moved = sim.kinetic_energy
    # rk4 with this step conserves energy to some 1e-12 of it.
    assert moved > 0.0 and abs(moved + sim.potential_energy - start) < 1e-9


def test_states_are_exact_and_can_be_kept(tip):
    one = tip.simulation()
    one.advance(to=300.0)
    state = pickle.loads(pickle.dumps(one.state))
    events = len(one.events)
    one.advance()
    other = tip.simulation()
    other.state = state
    assert other.time == state.time
    other.advance()
    assert (one.positions == other.positions).all()
    assert one.result()["driver.mean_force.x"] == other.result()["driver.mean_force.x"]
    one.state = state
    assert len(one.events) == events and not one.done
    with pytest.raises(ValueError, match="another scene"):
        tip.set("v", 0.02).simulation().state = state
    with pytest.raises(TypeError):
        one.state = b"nothing"


@pytest.mark.parametrize("looked_at", [False, True])
@pytest.mark.parametrize("kind", ["plain", "until", "quasistatic"])
def test_states_of_runs_that_are_over(tip, kind, looked_at):
    if kind == "until":
        tip = tomlin.parse(MORE["tip_steady"])
    elif kind == "quasistatic":
        tip = tomlin.load("scenarios/load/tip.toml")
    sim = tip.simulation()
    sim.advance(to=0.1 * sim.duration)
    middle = sim.state
    sim.advance()
    if looked_at:
        sim.result()
    end = pickle.loads(pickle.dumps(sim.state))
    whole = sim.result()
    sim.state = end
    assert sim.done and (sim.samples == whole.samples).all()
    for other in (sim, tip.simulation()):
        other.state = middle
        assert not other.done
        other.state = end
        assert other.done and other.time == end.time == sim.time
        found = other.result()
        assert found.status == "finished"
        assert comparable(found.summary) == comparable(whole.summary)


def test_result_so_far_leaves_the_run_as_it_is(tip):
    sim = tip.simulation()
    sim.advance(to=123.0)
    part = sim.result()
    assert part.status == "interrupted" and part["driver.mean_force.x"] is None
    assert part["time.end"] == sim.time and len(part.samples) > 10
    sim.advance()
    assert sim.done and sim.result()["driver.mean_force.x"] == tip.run()["driver.mean_force.x"]
    assert sim.result().status == "finished"


def test_callbacks(tip):
    times = []
    result = tip.simulation().run(every=50.0, call=lambda sim: times.append(sim.time))
    assert len(times) == 16 and times[-1] == result["time.end"]
    assert all(t >= 50.0 * (k + 1) for k, t in enumerate(times))
    stopped = tip.simulation().run(every=50.0, call=lambda sim: sim.time > 150.0)
    assert stopped.status == "interrupted" and stopped["time.end"] < 250.0

    def fail(sim):
        raise RuntimeError("in the callback")

    with pytest.raises(RuntimeError, match="in the callback"):
        tip.simulation().run(every=50.0, call=fail)
    with pytest.raises(ValueError):
        tip.simulation().run(every=0.0, call=fail)


def test_fixed_steps_stop_where_they_should():
    sim = tomlin.parse(scene(TIP, '{ type = "rk4", dt = 0.1 }', 60.0, 0.7)).simulation()
    for k in range(1, 8):
        sim.advance(to=0.1 * k)
        assert sim.steps == k
    sim.advance(to=0.7)
    assert sim.steps == 7
    sim.advance(to=0.75)
    assert sim.steps == 8
    sim.advance(steps=0)
    sim.advance(to=0.0)
    assert sim.steps == 8
    sim.advance(to=3.0, steps=2)
    assert sim.steps == 10
    sim.advance()
    assert sim.done and sim.time == 60.0 and sim.steps == 600


def test_interrupt_between_steps(tip):
    sim = tip.set(ENDLESS).simulation()
    threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        sim.advance()
    time = sim.time
    sim.advance(to=time + 1.0)
    assert sim.time > time > 0.0


def test_handlers_of_signals_are_called_between_steps(tip):
    """Each time that one comes, long before the end; what one raises ends it."""
    sim = tip.set(ENDLESS).simulation()
    called = []

    def send_soon():
        threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGUSR1)).start()

    def handle(number, frame):
        called.append(number)
        if len(called) == 3:
            raise ArithmeticError("enough")
        send_soon()

    before = signal.signal(signal.SIGUSR1, handle)
    try:
        send_soon()
        with pytest.raises(ArithmeticError, match="enough"):
            sim.advance()
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert len(called) == 3 and not sim.done
    time = sim.time
    sim.advance(to=time + 1.0)
    assert sim.time > time > 0.0


def test_two_threads_are_not_let_in(tip):
    sim = tip.set(ENDLESS).simulation()
    thread = threading.Thread(target=lambda: sim.advance(steps=3_000_000))
    thread.start()
    refused = 0
    while thread.is_alive():
        try:
            sim.positions
        except RuntimeError:
            refused += 1
            thread.join()
    assert refused == 1 and sim.steps == 3_000_000


def test_callbacks_stop_by_numpys_true_as_well(tip):
    for true in (True, np.True_):
        sim = tip.simulation()
        result = sim.run(every=10.0, call=lambda sim: true if sim.time > 50.0 else np.False_)
        assert result.status == "interrupted" and sim.time < 70.0
    assert tip.simulation().run(every=10.0, call=lambda sim: "True").status == "finished"
