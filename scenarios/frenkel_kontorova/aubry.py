#!/usr/bin/env python3
"""Aubry's transition of the golden mean by Greene's residue.

    python3 scenarios/frenkel_kontorova/aubry.py PROGRAM [--particles 34 55 89 144 233]
                                                 [--residue -0.255426]

The residue of an approximant's ground state, R = -det(H)/4 with H the second derivatives of its
energy, goes to 0 with the number of particles below K_c and to minus infinity above; at K_c it goes
to a number of its own. Solved for K at each approximant, by secants in ln(-R); Aitken's rule gives
the limit from the last three.

Exit status: 0 done, 1 a run failed, 2 bad arguments.
"""

import argparse
import math
import pathlib
import sys
import tempfile

from approximants import add_arguments, periods_of, run

FIRST = (0.965, 0.975)  # between which secants begin
CLOSE = 1e-11
MOST = 30


def log_residue(program, folder, K, particles):
    """ln(-R) of the ground state."""
    summary = run(program, folder, "ground_state.toml", particles, {"K": f"{K:.17g}"})
    return summary["equilibrium"]["log_determinant"] - math.log(4.0)


def strength_at(program, folder, residue, particles):
    """The K at which the ground state has this residue."""
    wanted = math.log(-residue)
    K = list(FIRST)
    off = [log_residue(program, folder, one, particles) - wanted for one in K]
    while abs(K[-1] - K[-2]) > CLOSE:
        if len(K) == MOST:
            raise RuntimeError(f"{particles} particles: no K has the residue {residue}")
        K.append(K[-1] - off[-1] * (K[-1] - K[-2]) / (off[-1] - off[-2]))
        off.append(log_residue(program, folder, K[-1], particles) - wanted)
    return K[-1]


def limit(a, b, c):
    """Aitken's rule for a sequence with geometric differences."""
    return c - (c - b) ** 2 / ((c - b) - (b - a))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_arguments(parser, [34, 55, 89, 144, 233])
    parser.add_argument("--residue", type=float, default=-0.255426)
    arguments = parser.parse_args()
    if arguments.residue >= 0.0:
        parser.error("the residue of a ground state is negative")
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for particles in arguments.particles:
            try:
                found.append(strength_at(arguments.program, pathlib.Path(folder) / "run",
                                         arguments.residue, particles))
            except RuntimeError as error:
                print(error, file=sys.stderr)
                return 1
            tends_to = f"  limit {limit(*found[-3:]):.9f}" if len(found) > 2 else ""
            print(f"{periods_of(particles)}/{particles}: K = {found[-1]:.9f}{tends_to}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
