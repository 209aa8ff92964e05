#!/usr/bin/env python3
"""Table I of Sircar and Patra, run and printed beside the paper's numbers.

    python3 scenarios/rolling_ring/table_1.py PROGRAM [--flexible] [--starts 20]

Exit status: 0 every number is where it should be, 1 one is not or a run failed, 2 bad arguments.
"""

import argparse
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent

# Total mean force over whole periods in steady sliding, from programs independent of this one:
# a rigid ring in three coordinates, ten digits.
STEADY = {
    "0.001": 3.803893595e-2,
    "0.01": 2.878089991e-2,
    "0.1": 9.434048101e-3,
    "1": 4.628633704e-3,
    "10": 4.587780405e-3,
    "100": 4.692426411e-3,
}

# <W_d> as the paper prints it: per particle, with the sign of a force that resists.
PRINTED = {
    "0.001": -4.445e-3,
    "0.01": -3.203e-3,
    "0.1": -9.154e-4,
    "1": -4.921e-4,
    "10": -5.771e-4,
    "100": -5.875e-4,
}
PRINTED_AT_ZERO = -7.059e-3

PARTICLES = 8
PAPERS_WINDOW = ("0", "9.77")  # in driver periods: where the paper's averages fit best

# The references have ten digits and the tolerance of the rigid runs is 1e-10 per step.
RIGID_TOLERANCE = 1e-7
# Flexible rings differ from rigid ones by a part in 1/k_wh = 1e-6 of what bends them.
FLEXIBLE_TOLERANCE = 1e-6
# The paper prints neither its window nor its damping; four digits, six rows, one fitted number.
PAPERS_TOLERANCE = 0.05

PERTURBATION = 1e-12
SEED = 20
# The undetermined row shows itself when its extremes are this far apart; they are 14 times.
CLEAR_SPREAD = 5.0


class RunFailed(Exception):
    """A run that did not end well; says why."""


class Tomlin:
    """The program, with a folder for its results."""

    def __init__(self, program, scene, folder):
        self.program = program
        self.scene = scene
        self.folder = folder

    def run(self, settings):
        """Runs the scene with {path: value} set; returns summary.json."""
        command = [str(self.program), "run", str(self.scene), "--force", "-o", str(self.folder)]
        for path, value in settings.items():
            command += ["--set", f"{path}={value}"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RunFailed(f"{' '.join(command)}\nends with status {done.returncode}:\n"
                            f"{done.stderr.strip() or done.stdout.strip()}")
        return json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))


def say(text=""):
    print(text, flush=True)


def mean_force(summary):
    return summary["drivers"]["driver"]["mean_force"][0]


def periods(summary):
    window = summary["window"]
    return (window["to"] - window["from"]) * summary["parameters"]["v"] / summary["parameters"]["a"]


def determined_rows(tomlin, tolerance, with_paper):
    """The six rows that the model determines; returns whether all are as they should be."""
    say("           steady sliding, periods 1 to 10, whole ring" +
        ("     |  per particle, periods 0 to 9.77" if with_paper else ""))
    say("  lambda   mean force      reference       rel. error  turns/period" +
        ("  |  <W_d>        paper       deviation" if with_paper else ""))
    sound = True
    wall = 0.0
    for row, reference in STEADY.items():
        summary = tomlin.run({"lambda": row})
        wall += summary["performance"]["wall_seconds"]
        force = mean_force(summary)
        error = force / reference - 1.0
        turns = summary["bodies"]["ring"]["turns"] / periods(summary)
        line = f"  {row:<7}  {force:.9e} {reference:.9e} {error:+.1e}    {turns:+.6f}  "
        faults = [] if abs(error) <= tolerance else [f"error beyond {tolerance:g}"]
        if with_paper:
            start, end = PAPERS_WINDOW
            early = tomlin.run({"lambda": row, "measure.from": start, "measure.to": end})
            work = -mean_force(early) / PARTICLES
            deviation = work / PRINTED[row] - 1.0
            line += f"   |  {work:.3e}  {PRINTED[row]:.3e}  {100.0 * deviation:+.1f} %"
            if abs(deviation) > PAPERS_TOLERANCE:
                faults.append(f"deviation beyond {100.0 * PAPERS_TOLERANCE:g} %")
        sound = sound and not faults
        say(line + "".join(f"  <- {fault}" for fault in faults))
    say(f"  wall time of the six steady runs: {wall:.3g} s on one core")
    return sound


def lower_bound(parameters):
    """Viscous loss alone of a ring that turns by 1/N per period."""
    gear = 2.0 * math.pi * parameters["R"] / (parameters["N"] * parameters["a"])
    return parameters["xi"] * parameters["v"] * (1.0 + gear**2)


def minimum(tomlin):
    """Friction is least between two rows of the table; returns whether it is."""
    forces = {}
    for between in ("2.6", "3"):
        summary = tomlin.run({"lambda": between})
        forces[between] = mean_force(summary)
    bound = lower_bound(summary["parameters"])
    say("  least between the rows: " +
        ", ".join(f"{force:.6e} at lambda = {row}" for row, force in forces.items()) +
        f"; bound for 1/8 turn per period: {bound:.6e}")
    return bound < min(forces.values()) and max(forces.values()) < min(STEADY.values())


def perturbed(number, noise):
    """Start `number` of the ring: even ones moved and pushed, odd ones with uneven particles."""
    if number % 2 == 0:
        velocity = [f"[{noise():.17g}, {noise():.17g}]" for _ in range(PARTICLES)]
        return {
            "body.ring.centre": f"[{noise():.17g}, {1.0 + noise():.17g}]",
            "body.ring.velocity": f"[{', '.join(velocity)}]",
        }
    mass = [f"{(1.0 + noise()) / PARTICLES:.17g}" for _ in range(PARTICLES)]
    return {"body.ring.particle_mass": f"[{', '.join(mass)}]"}


def undetermined_row(tomlin, starts):
    """lambda = 0 from many starts that differ by 1e-12; returns whether they spread."""
    generator = random.Random(SEED)

    def noise():
        return generator.uniform(-PERTURBATION, PERTURBATION)

    forces = {0: [], 1: []}
    for number in range(starts):
        summary = tomlin.run({"lambda": "0", **perturbed(number, noise)})
        forces[number % 2].append(mean_force(summary))
    least = min(forces[0] + forces[1])
    most = max(forces[0] + forces[1])
    say(f"  lambda = 0 is not determined: {starts} starts that differ by {PERTURBATION:g} give")
    say(f"    min {least:.4e}   max {most:.4e}   for the whole ring"
        f"   (paper: {PARTICLES} x {-PRINTED_AT_ZERO:.3e} = {-PARTICLES * PRINTED_AT_ZERO:.3e})")
    for kind, what in ((0, "place and velocity moved"), (1, "the particles' masses uneven")):
        if forces[kind]:
            say(f"    {len(forces[kind]):3} with {what + ':':29} "
                f"{min(forces[kind]):.4e} to {max(forces[kind]):.4e}")
    if starts < 2:
        return True
    if most < CLEAR_SPREAD * least:
        say(f"    <- a spread of a factor {CLEAR_SPREAD:g} and more was expected")
        return False
    return True


def number_of_starts(text):
    starts = int(text)
    if starts < 0:
        raise ValueError
    return starts


def main():
    parser = argparse.ArgumentParser(description="Table I of Sircar and Patra, run and compared.")
    parser.add_argument("program", metavar="PROGRAM", type=pathlib.Path, help="build/bin/tomlin")
    parser.add_argument("--flexible", action="store_true",
                        help="flexible rings by rk4, as the paper does it: some minutes")
    parser.add_argument("--starts", metavar="N", type=number_of_starts, default=20,
                        help="perturbed starts for lambda = 0 (20)")
    arguments = parser.parse_args()
    if not arguments.program.is_file():
        parser.error(f"{arguments.program} is not a program; ./dev build makes build/bin/tomlin")

    kind = "flexible" if arguments.flexible else "rigid"
    scene = HERE / f"table_1_{kind}.toml"
    say(f"Table I of Sircar and Patra, {kind} ring: work per distance = mean force of the driver")
    with tempfile.TemporaryDirectory(prefix="tomlin-table-1-") as folder:
        tomlin = Tomlin(arguments.program.resolve(), scene, pathlib.Path(folder) / "run")
        try:
            if arguments.flexible:
                sound = determined_rows(tomlin, FLEXIBLE_TOLERANCE, with_paper=False)
            else:
                sound = determined_rows(tomlin, RIGID_TOLERANCE, with_paper=True)
                sound = minimum(tomlin) and sound
                if arguments.starts > 0:
                    sound = undetermined_row(tomlin, arguments.starts) and sound
        except RunFailed as failure:
            print(f"table_1.py: {failure}", file=sys.stderr)
            return 1
    say("every number is where it should be" if sound else "NOT every number is where it should be")
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
