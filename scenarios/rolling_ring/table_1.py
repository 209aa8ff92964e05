#!/usr/bin/env python3
"""Table I of Sircar and Patra, run and printed beside the paper's numbers.

    python3 scenarios/rolling_ring/table_1.py PROGRAM [--flexible] [--starts 20]

Exit status: 0 every number is where it should be, 1 one is not or a run failed, 2 bad arguments.
"""

import argparse
import pathlib
import sys
import tempfile

from measures import lower_bound, mean_force, turns_per_period
from runs import RunFailed, Tomlin, program_argument, say

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
FORCE = "drivers.driver.mean_force.x"


def determined_rows(tomlin, scene, tolerance, with_paper):
    """The six rows that the model determines; returns whether all are as they should be."""
    say("           steady sliding, periods 1 to 10, whole ring" +
        ("     |  per particle, periods 0 to 9.77" if with_paper else ""))
    say("  lambda   mean force      reference       rel. error  turns/period" +
        ("  |  <W_d>        paper       deviation" if with_paper else ""))
    sound = True
    wall = 0.0
    for row, reference in STEADY.items():
        summary = tomlin.run(scene, {"lambda": row})
        wall += summary["performance"]["wall_seconds"]
        force = mean_force(summary)
        error = force / reference - 1.0
        turns = turns_per_period(summary)
        line = f"  {row:<7}  {force:.9e} {reference:.9e} {error:+.1e}    {turns:+.6f}  "
        faults = [] if abs(error) <= tolerance else [f"error beyond {tolerance:g}"]
        if with_paper:
            start, end = PAPERS_WINDOW
            early = tomlin.run(scene,
                               {"lambda": row, "measure.from": start, "measure.to": end})
            work = -mean_force(early) / PARTICLES
            deviation = work / PRINTED[row] - 1.0
            line += f"   |  {work:.3e}  {PRINTED[row]:.3e}  {100.0 * deviation:+.1f} %"
            if abs(deviation) > PAPERS_TOLERANCE:
                faults.append(f"deviation beyond {100.0 * PAPERS_TOLERANCE:g} %")
        sound = sound and not faults
        say(line + "".join(f"  <- {fault}" for fault in faults))
    say(f"  wall time of the six steady runs: {wall:.3g} s on one core")
    return sound


def minimum(tomlin, scene):
    """Friction is least between two rows of the table; returns whether it is."""
    forces = {}
    for between in ("2.6", "3"):
        summary = tomlin.run(scene, {"lambda": between})
        forces[between] = mean_force(summary)
    bound = lower_bound(summary["parameters"])
    say("  least between the rows: " +
        ", ".join(f"{force:.6e} at lambda = {row}" for row, force in forces.items()) +
        f"; bound for 1/8 turn per period: {bound:.6e}")
    return bound < min(forces.values()) and max(forces.values()) < min(STEADY.values())


def perturbed(tomlin, scene, row, starts):
    """How far a row's mean force is determined, and whether the program warns that it is not."""
    summary = tomlin.run(scene, {
        "lambda": row,
        "run.perturb": f"{{ size = {PERTURBATION!r}, repeats = {starts} }}",
    })
    warned = any(warning.startswith(f"{FORCE} is not determined")
                 for warning in summary["warnings"])
    return summary["determined"][FORCE], warned


def undetermined_row(tomlin, scene, starts):
    """lambda = 0 and 1 from many starts; returns whether the first is named not determined only."""
    zero, zero_warned = perturbed(tomlin, scene, "0", starts)
    one, one_warned = perturbed(tomlin, scene, "1", starts)
    say(f"  lambda = 0 is {'not ' if zero_warned else ''}determined: "
        f"{starts} starts that differ by {PERTURBATION:g} give")
    say(f"    min {zero['min']:.4e}   max {zero['max']:.4e}   for the whole ring"
        f"   (paper: {PARTICLES} x {-PRINTED_AT_ZERO:.3e} = {-PARTICLES * PRINTED_AT_ZERO:.3e})")
    say(f"  lambda = 1 is {'not ' if one_warned else ''}determined: "
        f"they share {one['digits']:.0f} digits")
    if not zero_warned:
        say("    <- lambda = 0 was expected to be named not determined")
    if one_warned:
        say("    <- lambda = 1 was expected to be determined")
    return zero_warned and not one_warned


def number_of_starts(text):
    starts = int(text)
    if starts < 0:
        raise ValueError
    return starts


def main():
    parser = argparse.ArgumentParser(description="Table I of Sircar and Patra, run and compared.")
    program_argument(parser)
    parser.add_argument("--flexible", action="store_true",
                        help="flexible rings by rk4, as the paper does it: some minutes")
    parser.add_argument("--starts", metavar="N", type=number_of_starts, default=20,
                        help="perturbed starts for lambda = 0 and 1 (20); 0 leaves them out")
    arguments = parser.parse_args()

    kind = "flexible" if arguments.flexible else "rigid"
    scene = f"table_1_{kind}.toml"
    say(f"Table I of Sircar and Patra, {kind} ring: work per distance = mean force of the driver")
    with tempfile.TemporaryDirectory(prefix="tomlin-table-1-") as folder:
        tomlin = Tomlin(arguments.program, pathlib.Path(folder) / "run")
        try:
            if arguments.flexible:
                sound = determined_rows(tomlin, scene, FLEXIBLE_TOLERANCE, with_paper=False)
            else:
                sound = determined_rows(tomlin, scene, RIGID_TOLERANCE, with_paper=True)
                sound = minimum(tomlin, scene) and sound
                if arguments.starts > 0:
                    sound = undetermined_row(tomlin, scene, arguments.starts) and sound
        except RunFailed as failure:
            print(f"table_1.py: {failure}", file=sys.stderr)
            return 1
    say("every number is where it should be" if sound else "NOT every number is where it should be")
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
