#!/usr/bin/env python3
"""Whether runs `until` steady end neither too early nor far too late, over random slow scenes.

    python3 tests/properties/steady_runs.py PROGRAM [--seeds FROM TO] [--table]

Scenes with long memories, soft chains, weak friction, soft drivers, shaking at a part of the washboard
frequency, and plain ones (random_scenes.py) are run until the mean force is steady to 1e-1, 1e-2 and
1e-3. The truth is the mean force of each of the last ten of 2000 periods: a run that says "reached" must
have come as near to one of them as its tolerance, but for what an estimate may be off. How many periods
it took is held against the run of a scene as long as the tolerance needs.

Exit status: 0 none has ended too early, and most of those that become steady did in time; 1 not so.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import random_scenes

TOLERANCES = (1e-1, 1e-2, 1e-3)
PERIODS = 2000
SAMPLES = 20  # of a period: means to 1e-6 and less for what is smooth
TAIL = 10
ESTIMATE = 1.25  # a distance is estimated, and the truth is a mean of samples
# At the least: nothing is known before two of the slowest times have passed.
MOST_LATE = 4.0
LEAST_IN_TIME = 0.7


def run(program, folder, text):
    scene = folder / "scene.toml"
    scene.write_text(text, encoding="utf-8")
    done = subprocess.run([program, "run", str(scene), "-o", str(folder / "out"), "--force",
                           "--quiet"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    return json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))


RUN = f"""[run]
duration = {PERIODS}.0
integrator = {{ type = "dopri5", absolute_tolerance = 1e-7, relative_tolerance = 1e-7 }}
"""


def means_by_period(program, folder, text):
    run(program, folder, f"{text}{RUN}[output]\nevery = {1.0 / SAMPLES!r}\n")
    with open(folder / "out" / "observables.csv", encoding="utf-8", newline="") as table:
        rows = csv.reader(table)
        column = next(rows).index("driver.force.x [force]")
        force = [float(row[column]) for row in rows]
    ends = range(0, PERIODS * SAMPLES, SAMPLES)
    return [(sum(force[k:k + SAMPLES]) + 0.5 * (force[k + SAMPLES] - force[k])) / SAMPLES
            for k in ends]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program")
    parser.add_argument("--seeds", nargs=2, type=int, default=(100, 102), metavar=("FROM", "TO"))
    parser.add_argument("--table", action="store_true", help="a line for each run")
    given = parser.parse_args()
    reached = false = steady = in_time = 0
    worst = 0.0
    with tempfile.TemporaryDirectory(prefix="tomlin-steady-") as name:
        folder = pathlib.Path(name)
        for seed in range(*given.seeds):
            for kind in random_scenes.SLOW_KINDS:
                text = random_scenes.slow_scene(kind, seed)
                means = means_by_period(given.program, folder, text)
                tail = means[-TAIL:]
                low, high = min(tail), max(tail)
                for tolerance in TOLERANCES:
                    until = f'until = {{ steady = "driver.mean_force.x", tolerance = {tolerance} }}\n'
                    summary = run(given.program, folder, text + RUN + until)
                    periods = summary["until"]["periods"]
                    value = summary["drivers"]["driver"]["mean_force"][0]
                    off = max(0.0, low - value, value - high) / abs(value)
                    middle = sum(tail) / TAIL
                    last = max((k + 1 for k, mean in enumerate(means)
                                if abs(mean - middle) > tolerance * abs(middle)), default=0)
                    said = summary["until"]["reached"]
                    reached += said
                    wrong = said and off > ESTIMATE * tolerance
                    false += wrong
                    worst = max(worst, off / tolerance if said else 0.0)
                    # A mean that is steady in the first quarter of the run has to be found steady.
                    if last < PERIODS / 4:
                        steady += 1
                        in_time += said and periods <= MOST_LATE * (last + 4)
                    if given.table or wrong:
                        print(f"{kind} {seed}, {tolerance:g}: {'reached' if said else '-'} after "
                              f"{periods}, within from {last} on, off by {off:.2e}"
                              f"{' FALSE' if wrong else ''}")
    print(f"reached {reached}, falsely {false}; worst {worst:.2g} of the tolerance; of {steady} that "
          f"become steady soon {in_time} were seen in time")
    return 0 if false == 0 and in_time >= LEAST_IN_TIME * steady else 1


if __name__ == "__main__":
    sys.exit(main())
