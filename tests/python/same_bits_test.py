"""The module and the program give the same bits."""

import json
import subprocess

import numpy as np
import pytest
from conftest import ROOT
from scenes import CHAIN, RIGID, SCENES, TIP, scene

import tomlin

NOISE = """
[[force]]
type = "langevin"
coefficient = 0.5
temperature = 0.02
"""
EULER = '{ type = "euler_maruyama", dt = 1e-3 }'
BAOAB = '{ type = "baoab", dt = 1e-2 }'
STEADY = 'until = { steady = "driver.mean_force.x", tolerance = 1e-3 }'


def without_measure(text):
    """`until` sets the window itself."""
    return text[:text.index("[measure]")] + text[text.index("[output]"):]


MORE = {
    "tip_noise": scene(TIP + NOISE, BAOAB, 20.0, 0.7),
    "chain_noise": scene(CHAIN + NOISE, BAOAB, 5.0, 0.7, "seed = 3"),
    "tip_accuracy": scene(TIP, "X", 60.0, 0.7).replace("integrator = X", "accuracy = 1e-3"),
    "tip_steady": without_measure(scene(TIP, '{ type = "rk4", dt = 1e-2 }', 400.0, 0.7, STEADY)),
    "ring_trajectory": scene(RIGID, '{ type = "rk4", dt = 1e-2 }', 10.0, 0.7) + "trajectory = true\n",
    "tip_reverses": scene(TIP.replace(
        "velocity = [0.05]",
        'velocity = [0.05]\nreverse = { when = "bodies.tip.centre_of_mass.x", above = 1.0 }'),
        '{ type = "rk4", dt = 1e-2 }', 60.0, 0.7),
    "tip_quasistatic": (ROOT / "scenarios/load/tip.toml").read_text(encoding="utf-8"),
}
ALL = {**SCENES, **MORE}
FILES = ("observables.csv", "events.csv", "scene.toml", "trajectory.xyz")


def comparable(summary):
    """All but what depends on the clock."""
    return {key: value for key, value in summary.items() if key != "performance"}


@pytest.mark.parametrize("name", ALL)
def test_run_is_that_of_the_program(name, program, tmp_path):
    file = tmp_path / f"{name}.toml"
    file.write_text(ALL[name], encoding="utf-8")
    done = subprocess.run([program, "run", str(file), "-o", str(tmp_path / "program"), "--quiet"],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    theirs = comparable(json.loads((tmp_path / "program" / "summary.json").read_text()))

    scene = tomlin.load(file)
    in_memory = scene.run()
    in_folder = scene.run(folder=tmp_path / "module")
    opened = tomlin.open(tmp_path / "program")

    assert comparable(in_memory.summary) == theirs
    assert comparable(in_folder.summary) == theirs
    assert comparable(json.loads((tmp_path / "module" / "summary.json").read_text())) == theirs
    for other in FILES:
        one, two = tmp_path / "program" / other, tmp_path / "module" / other
        assert one.exists() == two.exists(), other
        assert not one.exists() or one.read_bytes() == two.read_bytes(), other
    for column in opened.samples.columns:
        np.testing.assert_array_equal(in_memory.samples[column], opened.samples[column])
    for column in opened.events.columns:
        np.testing.assert_array_equal(in_memory.events[column], opened.events[column])


@pytest.mark.parametrize("name", [name for name in ALL if "perturbed" not in name
                                  and "accuracy" not in name])
def test_steps_one_by_one_are_those_of_a_run(name):
    """Stops at odd places and a return to an earlier state change nothing."""
    scene = tomlin.parse(ALL[name])
    at_once = scene.run()
    sim = scene.simulation()
    sim.advance(steps=7)
    sim.positions, sim.velocities, sim.forces
    sim.advance(to=0.11 * sim.duration)
    before = sim.state
    sim.advance(steps=33)
    sim.state = before
    while not sim.done:
        sim.advance(to=sim.time + 0.043 * sim.duration)
    step_by_step = sim.result()
    mine, theirs = comparable(step_by_step.summary), comparable(at_once.summary)
    assert mine == theirs
    np.testing.assert_array_equal(step_by_step.samples, at_once.samples)
    np.testing.assert_array_equal(step_by_step.events["time"], at_once.events["time"])


def test_sweep_is_that_of_the_program(program, tmp_path):
    args = [program, "sweep", "scenarios/prandtl_tomlinson/stick_slip.toml", "--over",
            "s=0.5,5", "--over", "v=1e-2:1e-1:5:log", "--observable", "driver.mean_force.x",
            "-o", str(tmp_path / "program"), "--quiet"]
    subprocess.run(args, check=True)
    tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
    over = {"s": [0.5, 5], "v": "1e-2:1e-1:5:log"}
    in_folder = tomlin.sweep(tip, over, "driver.mean_force.x", folder=tmp_path / "module")
    in_memory = tomlin.sweep(tip, over, "driver.mean_force.x", threads=1)
    for name in ("sweep.csv", "scene.toml"):
        assert (tmp_path / "program" / name).read_bytes() == (
            tmp_path / "module" / name).read_bytes()
    rows = np.genfromtxt(tmp_path / "program" / "sweep.csv", delimiter=",", skip_header=1)
    for sweep in (in_folder, in_memory):
        assert sweep.complete and sweep.shape == (2, 5)
        np.testing.assert_array_equal(sweep["driver.mean_force.x"].ravel(), rows[:, 2])
        np.testing.assert_array_equal(sweep["v"], rows[:5, 1])
    # The program goes on with the module's folder: there is nothing left to do.
    args[args.index("-o") + 1] = str(tmp_path / "module")
    args[args.index("s=0.5,5")] = "s=0.5,5.0"
    subprocess.run([one.replace("s=0.5,5.0", "s=0.5,5") for one in args], check=True)


def test_refined_sweep_needs_no_folder(program, tmp_path, tip):
    over = {"s": [0.5, 1.5, 2.5, 3.5, 4.5]}
    options = dict(refine="events.slips=0.5", refine_to=0.05)
    in_memory = tomlin.sweep(tip, over, "events.slips", **options)
    in_folder = tomlin.sweep(tip, over, "events.slips", folder=tmp_path / "refined", **options)
    assert in_memory.complete and len(in_memory["s"]) > 5
    for name in in_memory:
        np.testing.assert_array_equal(in_memory[name], in_folder[name])
    assert (np.diff(in_memory["s"]) > 0).all()
    assert len(in_memory.summary.refine.intervals if "refine" in in_memory.summary else [1]) > 0
