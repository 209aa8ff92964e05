"""Threads, memory, and plugins that go wrong."""

import concurrent.futures
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
    """A thousand runs; a leak of one result would be 40 kB each, 40 MB in all."""
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

    for _ in range(200):
        use()
    gc.collect()
    before = memory()
    for _ in range(1000):
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
