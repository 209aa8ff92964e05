#!/usr/bin/env python3
"""The depinning force of golden-mean approximants: bisection, a run for each force.

    python3 scenarios/frenkel_kontorova/depinning.py PROGRAM [-K 1.05 ...] [--particles 21 34 55]
                                                     [--digits 3]

A chain that moves by more than 1/N, the period of its landscape, in the window of a run is sliding;
the run is long enough for twice that just above the force looked for, to the digits asked for.

Exit status: 0 done, 1 a run failed, 2 bad arguments.
"""

import argparse
import math
import pathlib
import sys
import tempfile

from approximants import add_arguments, periods_of, run

SETTLED = 3000.0  # by then the chain has found its shape
SMALLEST = 1e-6  # what needs less force than this is called sliding


def slides(program, folder, K, particles, force, digits):
    """Whether the chain slides under `force` per particle."""
    # Just above F_c the chain crosses the bottleneck at about sqrt(F^2 - F_c^2).
    speed = force * math.sqrt(2.0 * 10.0**-digits)
    window = 2.0 / (particles * speed)
    summary = run(program, folder, "golden_mean.toml", particles, {
        "K": K, "F": f"{force:.17g}", "run.duration": SETTLED + window, "measure.from": SETTLED,
        "measure.to": SETTLED + window})
    moved = summary["bodies"]["chain"]["mean_velocity"][0] * window
    return moved * particles > 1.0


def depinning_force(program, folder, K, particles, digits):
    """The force per particle, or None if it is below SMALLEST."""
    pinned, sliding = SMALLEST, K / (2.0 * math.pi)  # no chain holds more than a single particle
    if slides(program, folder, K, particles, pinned, digits):
        return None
    while sliding / pinned > 1.0 + 10.0**-digits:
        middle = math.sqrt(pinned * sliding)
        if slides(program, folder, K, particles, middle, digits):
            sliding = middle
        else:
            pinned = middle
    return math.sqrt(pinned * sliding)


def main():
    parser = argparse.ArgumentParser(description="Depinning forces of golden-mean chains.")
    add_arguments(parser, [21, 34, 55])
    parser.add_argument("-K", type=float, nargs="+", default=[0.9, 1.05])
    parser.add_argument("--digits", type=int, default=2, help="of the force (2)")
    arguments = parser.parse_args()

    print("      K   L/N      depinning force, per particle", flush=True)
    with tempfile.TemporaryDirectory(prefix="tomlin-depinning-") as name:
        for K in arguments.K:
            for particles in arguments.particles:
                try:
                    force = depinning_force(arguments.program,
                                            pathlib.Path(name) / "run", K, particles,
                                            arguments.digits)
                except RuntimeError as failure:
                    print(f"depinning.py: {failure}", file=sys.stderr)
                    return 1
                found = f"below {SMALLEST:g}" if force is None else f"{force:.{arguments.digits}e}"
                print(f"  {K:5g}   {f'{periods_of(particles)}/{particles}':7}  {found}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
