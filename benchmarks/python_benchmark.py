#!/usr/bin/env python3
"""What a sweep costs from Python, in parts of what the program takes for the same one.

    PYTHONPATH=build/python python3 benchmarks/python_benchmark.py build/bin/tomlin [ROUNDS]

1000 points of a tip, 10^4 steps each, in one thread: the module and the program in turn, ROUNDS times (5). The module
writes to a folder as the program does ("folder"), or takes the values from an array and leaves no files ("array").
Prints CPU seconds of each, and the ratio of their minima; 1.02 is the aim. Then the CPU time of a run of one point, from
a loaded scene, in microseconds. Exit status 2: bad arguments.
"""

import pathlib
import resource
import subprocess
import sys
import tempfile

import numpy as np

import tomlin

SCENE = """
[[body]]
type = "point"
position = [0.0]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 1.0
velocity = [0.1]
[[force]]
type = "viscous_damping"
coefficient = 1.0
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
[run]
duration = 100.0
integrator = { type = "rk4", dt = 1e-2 }
"""
AXIS, VALUES, OBSERVABLE = "force.driver.stiffness", "0.3:1.2:1000", "driver.mean_force.x"
RUNS = 300


def cpu_seconds(action, who):
    before = resource.getrusage(who)
    action()
    after = resource.getrusage(who)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(arguments):
    if not 1 <= len(arguments) <= 2:
        print(__doc__, file=sys.stderr)
        return 2
    program = str(pathlib.Path(arguments[0]).resolve())
    rounds = int(arguments[1]) if len(arguments) == 2 else 5
    scene = tomlin.parse(SCENE)
    folder_form, array_form, alone = [], [], []
    array = np.linspace(0.3, 1.2, 1000)
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "tip.toml"
        file.write_text(SCENE, encoding="utf-8")
        for k in range(rounds):
            command = [program, "sweep", str(file), "--over", f"{AXIS}={VALUES}", "--observable", OBSERVABLE,
                       "--threads", "1", "--quiet", "-o", f"{folder}/program_{k}"]
            folder_form.append(cpu_seconds(
                lambda k=k: tomlin.sweep(scene, {AXIS: VALUES}, OBSERVABLE, threads=1,
                                         folder=f"{folder}/module_{k}"), resource.RUSAGE_SELF))
            array_form.append(cpu_seconds(
                lambda: tomlin.sweep(scene, {AXIS: array}, OBSERVABLE, threads=1), resource.RUSAGE_SELF))
            alone.append(cpu_seconds(lambda command=command: subprocess.run(command, check=True),
                                     resource.RUSAGE_CHILDREN))
    for name, seconds in (("folder", folder_form), ("array", array_form), ("program", alone)):
        print(f"{name:8} {' '.join(f'{one:.3f}' for one in seconds)} s; to the program {min(seconds) / min(alone):.3f}")
    runs = cpu_seconds(lambda: [scene.run()[OBSERVABLE] for _ in range(RUNS)], resource.RUSAGE_SELF)
    print(f"a run    {runs / RUNS * 1e6:.0f} us")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
