"""Threads, memory, and plugins that go wrong."""

import concurrent.futures
import dataclasses
import gc
import os
import resource
import subprocess
import sys

import pytest
from conftest import BUILD

import tomlin

PLUGINS = BUILD / "tests" / "framework" / "plugin"
FAULTY = """
plugins = ["{library}"]
body = [{{ name = "tip", type = "point", position = [1.0], particle_mass = 1.0 }}]
force = [{{ type = "faulty", strength = 1.0 }}]
run = {{ duration = 10.0, integrator = {{ type = "rk4", dt = 0.01 }} }}
"""


def test_four_threads_at_once(tip):
    scenes = [tip.set("v", 0.01 + 0.002 * k) for k in range(8)]
    alone = [scene.run() for scene in scenes]

    def step_by_step(scene):
        sim = scene.simulation()
        while not sim.done:
            sim.advance(to=sim.time + 17.0)
        return sim.result()

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        at_once = list(pool.map(tomlin.Scene.run, scenes)) + list(pool.map(step_by_step, scenes))
    for one, other in zip(alone + alone, at_once):
        assert {k: v for k, v in one.summary.items() if k != "performance"} == {
            k: v for k, v in other.summary.items() if k != "performance"}
        assert (one.samples == other.samples).all()


def test_folders_from_threads(tip, tmp_path):
    """Trajectories too, whose library serves one thread at a time."""
    from scenes import RIGID, scene

    text = scene(RIGID, '{ type = "rk4", dt = 1e-2 }', 10.0, 0.7) + "trajectory = true\n"
    ring = tomlin.parse(text)
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        jobs = [pool.submit(ring.run, folder=tmp_path / str(k)) for k in range(4)]
        jobs += [pool.submit(tomlin.sweep, tip, {"v": [0.05, 0.1]}, "driver.mean_force.x",
                             folder=tmp_path / f"sweep{k}", threads=1) for k in range(4)]
        done = [job.result() for job in jobs]
    assert all(one.status == "finished" for one in done[:4]) and all(one.complete for one in done[4:])


def memory():
    """Bytes of this process that are in memory now."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def test_memory_is_flat(tip):
    """Four hundred runs; a leak of one result would be 40 kB each, 16 MB in all."""
    short = tip.set("v", 0.1)

    def use():
        scene = short.set("s", 4.0)
        result = scene.run()
        result.samples["time"], result.events, result.summary
        sim = scene.simulation()
        sim.advance(steps=20)
        sim.positions, sim.state
        try:
            scene.set("nothing", 1.0)
        except tomlin.SceneError:
            pass

    for _ in range(100):
        use()
    gc.collect()
    before = memory()
    for _ in range(400):
        use()
    gc.collect()
    assert memory() - before < 8e6


def test_memory_of_folders_and_sweeps_is_flat(tip, tmp_path):
    """What writes files and starts threads: 200 of each; 40 kB lost by each would be 8 MB."""
    short = tip.set({"v": 0.1, "output.every": 1.0})

    def use():
        short.run(folder=tmp_path / "run", force=True, progress=lambda now: None)
        tomlin.open(tmp_path / "run").samples
        friction = tomlin.sweep(short, {"s": [4.0, 5.0]}, "driver.mean_force.x", threads=2)
        friction["driver.mean_force.x"], friction.summary

    for _ in range(60):
        use()
    gc.collect()
    before = memory()
    for _ in range(200):
        use()
    gc.collect()
    assert memory() - before < 4e6


def faulty(code, **environment):
    """In a process of its own: a library is loaded once, and reads its fault there."""
    library = PLUGINS / "libfaulty.so"
    if not library.exists():
        pytest.skip("no plugins are built")
    return subprocess.run([sys.executable, "-c", code.format(scene=FAULTY.format(library=library))],
                          env={**os.environ, **environment}, capture_output=True, text=True)


def test_plugin_that_throws_while_it_runs():
    done = faulty('import tomlin\n'
                  'scene = tomlin.parse("""{scene}""")\n'
                  'result = scene.run()\n'
                  'assert result.status == "failed", result.status\n'
                  'print(result.failure.message)\n'
                  'sim = scene.simulation()\n'
                  'try: sim.advance()\n'
                  'except tomlin.Error as error: print(error)\n'
                  'try: sim.positions\n'
                  'except tomlin.Error as error: print("typed")\n'
                  'print(sim.done)\n', FAULT="throw", FAULT_AFTER="100")
    assert done.returncode == 0, done.stderr + done.stdout
    assert "faulty" in done.stdout and "True" in done.stdout


def test_plugin_that_throws_in_studies():
    """Points of a sweep have failed, with its words; everything else raises them."""
    done = faulty('import tomlin\n'
                  'scene = tomlin.parse("""{scene}""")\n'
                  'sweep = tomlin.sweep(scene, {{"force.faulty.strength": [1.0, 2.0]}},\n'
                  '                     "tip.centre_of_mass.x")\n'
                  'assert list(sweep.status) == ["failed", "failed"], sweep.status\n'
                  'print(sweep.reasons[0])\n'
                  'for call in (scene.check, lambda: scene.tradeoff("tip.centre_of_mass.x", budget=1.0),\n'
                  '             lambda: tomlin.compare([scene, scene], "tip.centre_of_mass.x")):\n'
                  '    try: call()\n'
                  '    except tomlin.Error as error: print("typed")\n', FAULT="throw", FAULT_AFTER="100")
    assert done.returncode == 0, done.stderr + done.stdout
    assert "planned" in done.stdout and "typed" in done.stdout


@pytest.mark.parametrize("fault", ["throw_binding", "nothing_bound"])
def test_plugin_that_fails_to_bind(fault):
    done = faulty('import tomlin\n'
                  'calls = [lambda scene: scene.run(), lambda scene: scene.simulation(),\n'
                  '         lambda scene: scene.explain(), lambda scene: scene.check()]\n'
                  'for call in calls:\n'
                  '    try: call(tomlin.parse("""{scene}"""))\n'
                  '    except tomlin.Error as error: print("typed", error)\n', FAULT=fault)
    assert done.returncode == 0, done.stderr + done.stdout
    assert done.stdout.count("typed") == 4 and "faulty" in done.stdout


def test_library_that_is_none(tmp_path):
    file = tmp_path / "libnone.so"
    file.write_text("no library")
    with pytest.raises(tomlin.SceneError) as raised:
        tomlin.parse(FAULTY.format(library=file))
    assert any(fault.code.startswith("plugin.") for fault in raised.value.faults)
    with pytest.raises(tomlin.SceneError):
        tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml", plugins=[file])


def test_plugin_of_a_scene():
    library = PLUGINS / "libmorse.so"
    if not library.exists():
        pytest.skip("no plugins are built")
    scene = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml", plugins=[library])
    assert scene.set("v", 0.1).run().status == "finished"


@pytest.mark.parametrize("call", ["tip.run()", "tip.simulation().run(every=1.0, call=lambda sim: None)"])
def test_threads_that_nobody_waits_for(call):
    """The interpreter ends while they run."""
    code = ("import threading, time, tomlin\n"
            "tip = tomlin.load('scenarios/prandtl_tomlinson/stick_slip.toml').set('v', 0.05)\n"
            "def endless():\n"
            f"    while True: {call}\n"
            "for _ in range(3): threading.Thread(target=endless, daemon=True).start()\n"
            "time.sleep(0.3)\n"
            "print('over')\n")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600)
    assert (done.returncode, done.stdout, done.stderr) == (0, "over\n", "")


def signalled(body):
    """A process in which a signal is on its way; the run would take minutes."""
    code = ("import os, signal, threading, time, tomlin\n"
            "tip = tomlin.load('scenarios/prandtl_tomlinson/stick_slip.toml')\n"
            "tip = tip.set({'v': 1e-7, 'output.every': 'a/v'})\n"
            "def send(which):\n"
            "    threading.Timer(0.3, lambda: os.kill(os.getpid(), which)).start()\n") + body
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600)


def test_signals_have_the_handlers_of_the_program():
    done = signalled("def end(*_): raise SystemExit(7)\n"
                     "signal.signal(signal.SIGTERM, end)\n"
                     "send(signal.SIGTERM)\n"
                     "tip.run()\n")
    assert done.returncode == 7, done.stderr
    done = signalled("seen = []\n"
                     "def stop(*_): seen.append(1); raise RuntimeError('enough')\n"
                     "signal.signal(signal.SIGINT, stop)\n"
                     "send(signal.SIGINT)\n"
                     "try: tip.run()\n"
                     "except RuntimeError as error: print(error, len(seen))\n")
    assert (done.returncode, done.stdout) == (0, "enough 1\n"), done.stderr


def test_a_check_can_be_interrupted():
    """All of it would take longer than the process has."""
    done = signalled("tube = tomlin.load('scenarios/nanotube/pull.toml').set('cells', 60)\n"
                     "send(signal.SIGINT)\n"
                     "try: tube.check()\n"
                     "except KeyboardInterrupt: print('interrupted')\n")
    assert (done.returncode, done.stdout) == (0, "interrupted\n"), done.stderr


@pytest.mark.parametrize("fault", ["throw_traits", "throw_period", "throw_element"])
def test_plugin_whose_declarations_throw(fault):
    done = faulty('import tomlin\n'
                  'try:\n'
                  '    scene = tomlin.parse("""{scene}""")\n'
                  '    scene.set("run.accuracy", 1e-6)\n'
                  '    scene.explain()\n'
                  '    scene.tradeoff("tip.centre_of_mass.x", budget=0.5)\n'
                  'except tomlin.Error as error: print("typed", error)\n', FAULT=fault)
    assert done.returncode == 0, done.stderr + done.stdout
    assert "typed" in done.stdout and "as planned" in done.stdout


def test_damaged_states_are_refused(tip):
    one = tip.simulation()
    one.advance(to=300.0)
    state = one.state
    damaged = bytearray(state._numbers)
    damaged[-66] ^= 1
    with pytest.raises(ValueError, match="damaged"):
        one.state = dataclasses.replace(state, _numbers=bytes(damaged))
    with pytest.raises(ValueError, match="damaged"):
        one.state = dataclasses.replace(state, time=state.time + 1.0)
    one.state = state
    assert one.time == state.time


def test_samples_that_memory_has_no_room_for(tip):
    with pytest.raises(tomlin.SceneError) as raised:
        tip.set("output.every", 1e-8).run()  # 4e10 samples
    assert raised.value.faults[0].code == "output.too_large"


@pytest.mark.parametrize("call", [
    lambda tip: tip.simulation().advance(steps=1.5), lambda tip: tip.simulation().advance(to="5"),
    lambda tip: tip.run(threads=1.5), lambda tip: tip.run(progress=3), lambda tip: tip.check(1.5),
    lambda tip: tip.tradeoff(3), lambda tip: tip.tradeoff("driver.mean_force.x", tolerance="1e-3"),
    lambda tip: tomlin.compare([tip, tip], 3), lambda tip: tip.set(3, 1.0),
    lambda tip: tomlin.sweep(tip, {"v": [0.1]}, [3]), lambda tip: tomlin.sweep(tip, {"v": b"12"}, "x"),
    lambda tip: tomlin.sweep(tip, {"v": [0.1]}, "driver.mean_force.x", threads="2")])
def test_wrong_types_name_the_argument(tip, call):
    with pytest.raises(TypeError) as raised:
        call(tip)
    assert "tomlin._core" not in str(raised.value) and "incompatible" not in str(raised.value)


def test_names_of_files_are_bytes(tmp_path):
    name = os.path.join(os.fsencode(tmp_path), b"\xff.toml")
    for path in (name, os.fsdecode(name)):
        with pytest.raises(tomlin.SceneError, match=r"\\xff.toml.*no such file"):
            tomlin.load(path)
    with open(name, "wb") as file, open("scenarios/prandtl_tomlinson/stick_slip.toml", "rb") as scene:
        file.write(scene.read())
    assert "\\xff" in repr(tomlin.load(os.fsdecode(name)))
