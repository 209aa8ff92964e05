"""Sweeps whose points the workers of an executor run have the bytes of those in threads."""

import json
import multiprocessing
import os
import re
import shutil
import signal
import subprocess
import sys
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from conftest import BUILD, ROOT

import tomlin

FORCE = "driver.mean_force.x"
# One value of the step is refused, another one fails.
STEPS = [1e-2, -1.0, 50.0]
FILES = ("sweep.csv", "sweep.h5", "scene.toml")
SCENE = """
[parameters]
v = 1e-2
s = 1.0
[[body]]
type = "point"
position = [0.5]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = ["v"]
[[force]]
type = "viscous_damping"
coefficient = 2.0
[[force]]
type = "sinusoidal_substrate"
amplitude = "0.1 * s"
period = 1.0
[run]
duration = 20.0
integrator = { type = "rk4", dt = 1e-2 }
[output]
every = 1.0
"""


@pytest.fixture(scope="module")
def processes():
    """Two workers that share nothing with this process."""
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield pool


@pytest.fixture
def tip():
    return tomlin.parse(SCENE)


GRIDS = {
    "statuses": {"over": {"v": np.geomspace(1e-3, 1e-1, 40), "run.integrator.dt": STEPS},
                 "observables": [FORCE, "events.slips"]},
    "refined": {"over": {"run.integrator.dt": [1e-2, -1.0], "v": "1e-3:1e-1:5:log"},
                "refine": f"{FORCE}=0.12"},
    "continued": {"over": {"run.integrator.dt": STEPS, "v": "0.01:0.1:10"},
                  "continue_from_neighbour": True, "observables": FORCE},
    "words": {"over": {"run.dynamics": ["inertial", "overdamped"], "s": [0.5, 5.0]},
              "observables": FORCE},
}


def files(folder):
    summary = json.loads((folder / "sweep.json").read_text())
    assert summary["status"] == "finished"
    del summary["performance"]
    return [summary] + [(folder / name).read_bytes() for name in FILES]


def rows(sweep):
    return [sweep.status.tolist(), sweep.reasons.tolist(),
            [values.tobytes() for values in sweep.columns.values()]]


@pytest.mark.parametrize("name", GRIDS)
def test_processes_give_the_bytes_of_threads(name, tip, processes, tmp_path):
    grid = GRIDS[name]
    in_threads = tomlin.sweep(tip, **grid, folder=tmp_path / "threads")
    if name == "statuses":
        assert set(in_threads.status.ravel()) == {"finished", "failed", "refused"}
    if name == "refined":
        assert in_threads.summary["refine"]["intervals"][0]["status"] == "found"
    for chunk in (None, 3):
        folder = tmp_path / f"chunks_{chunk}"
        in_processes = tomlin.sweep(tip, **grid, executor=processes, chunk=chunk, folder=folder)
        assert in_processes.complete
        assert rows(in_processes) == rows(in_threads)
        assert files(folder) == files(tmp_path / "threads")
    in_memory = tomlin.sweep(tip, **grid, executor=processes, threads=2)
    assert rows(in_memory) == rows(in_threads)


def test_threads_are_an_executor(tip):
    seen = []
    with ThreadPoolExecutor(2) as pool:
        sweep = tomlin.sweep(tip, **GRIDS["refined"], executor=pool,
                             progress=lambda *now: seen.append(now))
    assert rows(sweep) == rows(tomlin.sweep(tip, **GRIDS["refined"]))
    text, with_row, points = seen[-1]
    assert isinstance(text, str) and with_row == points == sweep.status.size


def test_settings_and_the_table_of_the_scene_reach_the_workers(tip, processes, tmp_path):
    file = tmp_path / "tip.toml"
    file.write_text(tip.to_toml() + f'\n[sweep]\nover = {{ v = "0.01:0.1:9" }}\n'
                    f'observables = ["{FORCE}"]\n')
    scene = tomlin.load(file).set("run.duration", 10.0)
    assert rows(tomlin.sweep(scene, executor=processes)) == rows(tomlin.sweep(scene))
    file.unlink()  # a worker needs the text alone
    assert rows(tomlin.sweep(scene, executor=processes)) == rows(tomlin.sweep(scene))


def die(*_):
    os.kill(os.getpid(), signal.SIGKILL)


class Pool(ProcessPoolExecutor):
    """Does something else in place of one of its calls."""

    def __init__(self, number, act):
        super().__init__(1, mp_context=multiprocessing.get_context("spawn"))
        self.left = number
        self.act = act

    def submit(self, function, /, *arguments):
        self.left -= 1
        return super().submit(self.act if self.left == 0 else function, *arguments)


def test_a_killed_worker_leaves_rows_and_the_same_call_continues(tip, tmp_path):
    grid = GRIDS["statuses"]
    folder = tmp_path / "killed"
    with Pool(5, die) as pool, pytest.raises(tomlin.RunError, match="lost a worker") as caught:
        tomlin.sweep(tip, **grid, executor=pool, chunk=10, folder=folder)
    kept = caught.value.result.status != "missing"
    assert not caught.value.result.complete and kept.sum() == 40  # those of four chunks
    assert f"40 of 120 rows are kept in {folder}" in str(caught.value)
    assert json.loads((folder / "sweep.json").read_text())["status"] == "interrupted"
    with Pool(5, die) as pool, pytest.raises(tomlin.RunError):
        tomlin.sweep(tip, **grid, executor=pool, chunk=10, folder=folder)
    with Pool(0, die) as pool:
        tomlin.sweep(tip, **grid, executor=pool, chunk=10, folder=folder)
    tomlin.sweep(tip, **grid, folder=tmp_path / "threads")
    assert files(folder) == files(tmp_path / "threads")


def test_a_killed_worker_of_a_sweep_in_memory(tip):
    with Pool(2, die) as pool, pytest.raises(tomlin.RunError, match="5 of 9 rows") as caught:
        tomlin.sweep(tip, {"v": "0.01:0.1:9"}, FORCE, executor=pool, chunk=5)
    assert caught.value.result.status.tolist() == 5 * ["finished"] + 4 * ["missing"]


class Promises(Executor):
    """Runs a call where it is submitted, or does what a test says in place of it."""

    def __init__(self, acts=()):
        self.acts = dict(acts)
        self.calls = 0

    def submit(self, function, /, *arguments):
        self.calls += 1
        future = Future()
        act = self.acts.get(self.calls, function)
        if act is None:
            return future  # for ever
        try:
            future.set_result(act(*arguments))
        except BaseException as error:
            future.set_exception(error)
        return future


def interrupt(*_):
    raise KeyboardInterrupt


def test_interrupts_leave_what_is_done(tip, tmp_path):
    over = {"v": "0.01:0.1:9"}
    for acts in ({2: interrupt}, {3: interrupt, 4: None}):
        folder = tmp_path / str(len(acts))
        with pytest.raises(KeyboardInterrupt) as caught:
            tomlin.sweep(tip, over, FORCE, executor=Promises(acts), chunk=2, folder=folder)
        part = caught.value.result
        assert not part.complete and part.status[0] == "finished"
        whole = tomlin.sweep(tip, over, FORCE, executor=Promises(), chunk=2, folder=folder)
        assert rows(whole) == rows(tomlin.sweep(tip, over, FORCE))


def test_ctrl_c_is_that_of_python(tip):
    with pytest.raises(KeyboardInterrupt) as caught:
        tomlin.sweep(tip, {"v": "0.01:0.1:9"}, FORCE, executor=Promises({3: None}), chunk=3,
                     progress=lambda *_: signal.raise_signal(signal.SIGINT))
    assert caught.value.result.status.tolist() == 6 * ["finished"] + 3 * ["missing"]


def test_what_a_caller_raises_ends_the_sweep(tip):
    def stop(*_):
        raise LookupError("enough")
    with pytest.raises(LookupError, match="enough"):
        tomlin.sweep(tip, {"v": "0.01:0.1:9"}, FORCE, executor=Promises({2: None}), chunk=2,
                     progress=stop)


def test_workers_without_the_files_are_refused(tip, tmp_path, monkeypatch):
    """What a worker finds is not what the process that has started the sweep has."""
    def elsewhere(function, job, *chunk):
        return function(replace(job, text=job.text.replace("position = [0.5]", "position = [0.4]")),
                        *chunk)

    class Other(Promises):
        def submit(self, function, /, job, *chunk):
            return super().submit(elsewhere, function, job, *chunk)

    with pytest.raises(tomlin.RunError, match="other files"):
        tomlin.sweep(tip, {"v": [0.01, 0.1]}, FORCE, executor=Other(), folder=tmp_path / "a")
    with pytest.raises(tomlin.SceneError):  # as the worker says it
        tomlin.sweep(tip, {"v": [0.01, 0.1]}, FORCE, 
                     executor=Promises({1: lambda *_: tomlin.load("none")}))


def test_wrong_rows_are_refused(tip):
    def short(*_):
        return [(0, 0, [], b"", "0" * 128)]
    with pytest.raises(tomlin.RunError, match="no row"):
        tomlin.sweep(tip, {"v": [0.01, 0.1]}, FORCE, executor=Promises({1: short}))


@pytest.mark.parametrize("wrong", [{"executor": 3}, {"executor": "dask"}, {"chunk": 1.5}])
def test_wrong_types(tip, wrong):
    with pytest.raises(TypeError):
        tomlin.sweep(tip, {"v": [0.1]}, FORCE, **wrong)


# ---- the script of the page

PAGE = ROOT / "framework/guide/sweeps.md"
MPI = ("from mpi4py.futures import MPIPoolExecutor", "MPIPoolExecutor()")
DASK = ("from distributed import Client",
        "Client(n_workers=2, threads_per_worker=1, dashboard_address=None).get_executor()")
SCRIPTS = {
    "mpi4py": (MPI, ["mpirun", "--oversubscribe", "-n", "3", sys.executable, "-m", "mpi4py.futures"]),
    "distributed": (DASK, [sys.executable]),
}


@pytest.mark.parametrize("package", SCRIPTS)
def test_executors_of_others(package, tmp_path):
    pytest.importorskip(package, reason=f"there is no {package} (Debian: python3-{package})")
    (imports, executor), command = SCRIPTS[package]
    if shutil.which(command[0]) is None:
        pytest.skip(f"there is no {command[0]} (Debian: openmpi-bin)")
    page = PAGE.read_text(encoding="utf-8")
    assert "mpirun -n 8 python3 -m mpi4py.futures my_sweep.py" in page
    script, = re.findall(r"^```python\n(.*?)^```$", page, flags=re.MULTILINE | re.DOTALL)
    assert all(one in script for one in MPI)
    (tmp_path / "my_sweep.py").write_text(
        script.replace(MPI[0], imports).replace(MPI[1], executor))
    (tmp_path / "scenarios").symlink_to(ROOT / "scenarios")
    clean = {name: value for name, value in os.environ.items()
             if not name.startswith(("OMPI_", "PMI", "SLURM_"))}
    done = subprocess.run(command + ["my_sweep.py"], cwd=tmp_path, text=True, capture_output=True,
                          timeout=300, env=clean | {"PYTHONPATH": str(BUILD / "python"),
                                                    "OMPI_ALLOW_RUN_AS_ROOT": "1",
                                                    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
    assert done.returncode == 0, done.stderr
    # On the same page the program runs this sweep.
    tomlin.sweep(tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml"),
                 {"s": "0.5:5:4", "v": "1e-2:1e-1:3:log"}, [FORCE, "events.slips"],
                 folder=tmp_path / "threads")
    assert files(tmp_path / "shared") == files(tmp_path / "threads")
