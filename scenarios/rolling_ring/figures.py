#!/usr/bin/env python3
"""Figs. 2, 4, 5, 7 and 9 of Sircar and Patra: their runs, beside what the paper says of them.

    python3 scenarios/rolling_ring/figures.py PROGRAM [FIGURE ...]

Exit status: 0 every number is where it should be, 1 one is not or a run failed, 2 bad arguments.
"""

import argparse
import cmath
import math
import pathlib
import sys
import tempfile

from runs import (RunFailed, Tomlin, lower_bound, mean_force, program_argument, say,
                  turns_per_period)

HELD = {"body.ring.hold": '["rotation"]'}
PERIODS = 10  # in the traces of Figs. 2, 5 and 9

# Friction of a tip on a fast spring or a weak corrugation has this limit for v -> 0; at the
# velocities used here it is off by parts in a thousand.
QUASISTATIC_TOLERANCE = 5e-3
# Near a threshold the largest speed over v grows as v^(-2/5) and its next powers.
SMEARING = (0.34, 0.42)


def max_speed(summary):
    """Largest speed of the ring's centre over the driving velocity."""
    return summary["bodies"]["ring"]["max_speed"] / summary["parameters"]["v"]


def steady(column):
    """The samples after the first period."""
    return column[len(column) // PERIODS:]


def share_of_corrugation(parameters):
    """|(1/N) sum exp(-b y^2) exp(i 2 pi x/a)| over a ring at its height that does not turn."""
    count, radius = int(parameters["N"]), parameters["R"]
    total = 0.0
    for i in range(count):
        angle = 2.0 * math.pi * i / count
        height = radius * (1.0 + math.sin(angle))
        total += (math.exp(-parameters["lambda"] / radius * height**2)
                  * cmath.exp(2j * math.pi * radius / parameters["a"] * math.cos(angle)))
    return abs(total) / count


def threshold(parameters):
    """k_crit of a ring that does not turn and stays at its height: (16), for any N."""
    return (4.0 * math.pi**2 * parameters["V0"] / parameters["a"]**2
            * share_of_corrugation(parameters))


def drag_alone(parameters):
    """Mean force of smooth sliding for v -> 0."""
    s = threshold(parameters) / parameters["k"]
    return parameters["xi"] * parameters["v"] / math.sqrt(1.0 - s**2)


def figure_2(tomlin):
    """A small ring and a tip, which is a ring of next to no radius."""
    say("Fig. 2, R = 0.001: a Prandtl-Tomlinson tip for lambda -> 0, less and less one for larger")
    say("  lambda   mean force     against the tip  mean |x_c - x_tip|  max speed/v  turns/period")
    tip = mean_force(tomlin.run("fig_2.toml", {"R": "1e-9", **HELD}))
    place = steady(tomlin.trace()["ring.centre_of_mass.x"])
    sound = True
    last = 0.0
    for row in ("0", "0.001", "0.01", "0.1", "1"):
        summary = tomlin.run("fig_2.toml", {"lambda": row})
        force = mean_force(summary)
        x = steady(tomlin.trace()["ring.centre_of_mass.x"])
        away = sum(abs(p - q) for p, q in zip(x, place)) / len(x)
        say(f"  {row:<7}  {force:.7e}  {force / tip - 1.0:+.1e}         {away:.1e}"
            f"             {max_speed(summary):5.1f}      {turns_per_period(summary):+.6f}")
        # Slips: a hundred times the driver's speed.
        sound = sound and max_speed(summary) > 100.0 and abs(turns_per_period(summary)) < 1e-8
        sound = sound and away > last
        last = away
    p = summary["parameters"]
    say(f"  s = 4 pi^2 V0/(k a^2) = {4.0 * math.pi**2 * p['V0'] / (p['k'] * p['a']**2):.2f}: "
        "this is stick-slip already")
    return sound


def growth(tomlin, settings):
    """Largest speed over v at two velocities, and its power of 1/v."""
    fast = max_speed(tomlin.run("fig_4.toml", {**settings, "v": "1e-3"}))
    slow = max_speed(tomlin.run("fig_4.toml", {**settings, "v": "1e-4"}))
    return fast, slow, math.log10(slow / fast)


def thresholds(tomlin, title, settings, critical, printed):
    """Runs around a threshold; returns whether they slip below it and slide above."""
    say(f"  {title}: k_crit = {critical:.3f}, the paper's formula: {printed:.3f}")
    sound = True
    for factor in (0.95, 1.0, 1.05):
        k = critical * factor
        fast, slow, power = growth(tomlin, {**settings, "k": repr(k)})
        low, high = {0.95: (0.45, 1.0), 1.0: SMEARING, 1.05: (0.0, 0.3)}[factor]
        say(f"    k = {k:7.3f}   max speed/v: {fast:6.2f} at v = 1e-3, {slow:6.2f} at 1e-4"
            f"   ~ v^{-power:+.2f}")
        sound = sound and low < power < high
    return sound


def figure_4(tomlin):
    """Where sliding becomes smooth, without height (Fig. 4) and with it (Fig. 5a)."""
    say("Figs. 4 and 5a: smooth sliding (power 0), threshold (-2/5), stick-slip (towards -1)")
    sound = True
    for radius in ("0.1", "0.5"):
        summary = tomlin.run("fig_4.toml", {"R": radius, "k": "100", **HELD})
        p = summary["parameters"]
        sign = sum(math.cos(2.0 * math.pi * p["R"] * math.cos(2.0 * math.pi * i / p["N"]))
                   for i in range(int(p["N"])))
        critical = threshold(p)
        sound = thresholds(tomlin, f"lambda = 0, R = {radius}", {"R": radius, **HELD}, critical,
                           math.copysign(critical, sign)) and sound
    # Folds of the path of equilibria, from an independent program (and rolling_ring_figures_test).
    for decay, critical in (("0.001", 39.478), ("0.05", 56.096)):
        b = float(decay) / 0.001
        printed = max(4.0 * math.pi**2, (2.0 * b)**1.5 / math.sqrt(math.e))
        sound = thresholds(tomlin, f"lambda = {decay}, R = 0.001",
                           {"R": "0.001", "lambda": decay}, critical, printed) and sound
    return sound


def shortest_turn(rotation):
    """Part of a period in which the ring does 90 % of its turn, from the last period's samples."""
    samples = len(rotation) // PERIODS
    period = rotation[-samples - 1:]
    turn = period[-1] - period[0]
    twice = period + [angle + turn for angle in period[1:]]
    for width in range(1, samples):
        if any((twice[n + width] - twice[n]) / turn >= 0.9 for n in range(samples)):
            return width / samples
    return 1.0


def jump(trace):
    """The step in the paper's F_f, and in the x force, between two samples."""
    fx = steady(trace["driver.force.x"])
    ff = [math.copysign(math.hypot(x, y), x) for x, y in zip(fx, steady(trace["driver.force.y"]))]
    return tuple(max(abs(b - a) for a, b in zip(f, f[1:])) for f in (ff, fx))


def figure_5(tomlin):
    """Friction for different lambda, free to turn and held."""
    say("Fig. 5, R = 1: dragging and rolling for small lambda, rolling for large")
    say("  lambda   mean force    the same, held  90 % of a turn   largest step   largest step")
    say("           free to turn  from turning    in this part     of F_f         of F_x")
    sound = True
    for row in ("0.001", "0.01", "0.1", "1", "10", "100"):
        held = mean_force(tomlin.run("fig_5.toml", {"lambda": row, **HELD}))
        summary = tomlin.run("fig_5.toml", {"lambda": row})
        trace = tomlin.trace()
        of_ff, of_fx = jump(trace)
        say(f"  {row:<7}  {mean_force(summary):.4e}    {held:.4e}      "
            f"{100.0 * shortest_turn(trace['ring.rotation']):2.0f} % of a period"
            f"   {of_ff:.4f}         {of_fx:.4f}")
        p = summary["parameters"]
        if float(row) <= 0.01:  # where the height of the ring hardly changes
            sound = sound and abs(held / drag_alone(p) - 1.0) < QUASISTATIC_TOLERANCE
        sound = sound and held < mean_force(summary) and mean_force(summary) > lower_bound(p)
        sound = sound and abs(turns_per_period(summary) + 1.0 / p["N"]) < 1e-8
    say(f"  even rolling: 90 % of a turn in 90 % of a period, mean force {lower_bound(p):.4e}")
    return sound


def figure_7(tomlin):
    """Friction for different velocities."""
    say("Fig. 7, R = 1, lambda = 0.01: dragging and rolling when slow, smooth dragging when fast")
    say("  v        mean force   least of a ring that rolls  least at all: xi v  turns/period")
    sound = True
    for row in ("0.0005", "0.001", "0.005", "0.01", "0.02", "0.05", "0.1"):
        summary = tomlin.run("fig_7.toml", {"v": row})
        force = mean_force(summary)
        p = summary["parameters"]
        rolls = float(row) <= 0.01
        say(f"  {row:<7}  {force:.4e}   {lower_bound(p):.4e}                  "
            f"{p['xi'] * p['v']:.4e}          {turns_per_period(summary):+.6f}")
        turns = -1.0 / p["N"] if rolls else 0.0
        sound = sound and abs(turns_per_period(summary) - turns) < 1e-6
        sound = sound and force > (lower_bound(p) if rolls else p["xi"] * p["v"])
    return sound


def slips_per_period(trace, velocity):
    """How often the ring passes twenty times the driver's speed, after the first period."""
    speed = [math.hypot(x, y) for x, y in zip(steady(trace["ring.velocity.x"]),
                                              steady(trace["ring.velocity.y"]))]
    rises = sum(a < 20.0 * velocity <= b for a, b in zip(speed, speed[1:]))
    return rises / (PERIODS - 1)


def figure_9(tomlin):
    """Friction of small rings, and their height."""
    say("Fig. 9, lambda = 1: small rings are dragged and hop")
    say("  R        mean force   lowest y_c   highest y_c  turns/period  slips/period  step of F_f"
        " where the driver overtakes")
    sound = True
    for row, slips in (("0.001", 2.0), ("0.01", 2.0), ("0.1", 1.0)):
        summary = tomlin.run("fig_9.toml", {"R": row})
        trace = tomlin.trace()
        height = steady(trace["ring.centre_of_mass.y"])
        fx, fy = (steady(trace[f"driver.force.{axis}"]) for axis in "xy")
        found = slips_per_period(trace, summary["parameters"]["v"])
        # Where the driver overtakes, not in a slip: F_x rises through zero.
        step = max(2.0 * abs(fy[n]) for n in range(len(fx) - 1) if fx[n] <= 0.0 < fx[n + 1])
        say(f"  {row:<7}  {mean_force(summary):.4e}   {min(height):.3e}    {max(height):.3e}"
            f"    {turns_per_period(summary):+.6f}     {found:.0f}             {step:.4f}")
        sound = sound and abs(turns_per_period(summary)) < 1e-4 and found == slips
        sound = sound and max(height) > 3.0 * min(height)
    return sound


FIGURES = {"2": figure_2, "4": figure_4, "5": figure_5, "7": figure_7, "9": figure_9}


def main():
    parser = argparse.ArgumentParser(description="Figures of Sircar and Patra, run and compared.")
    program_argument(parser)
    parser.add_argument("figures", metavar="FIGURE", nargs="*",
                        help=f"{', '.join(FIGURES)}; all of them when none is given")
    arguments = parser.parse_args()
    unknown = [figure for figure in arguments.figures if figure not in FIGURES]
    if unknown:
        parser.error(f"there is no figure {unknown[0]}; admissible: {', '.join(FIGURES)}")

    status = 0
    with tempfile.TemporaryDirectory(prefix="tomlin-figures-") as folder:
        tomlin = Tomlin(arguments.program, pathlib.Path(folder) / "run")
        for figure in arguments.figures or FIGURES:
            try:
                sound = FIGURES[figure](tomlin)
            except RunFailed as failure:
                print(f"figures.py: {failure}", file=sys.stderr)
                return 1
            say("  every number is where it should be" if sound
                else "  NOT every number is where it should be")
            status = status if sound else 1
    return status


if __name__ == "__main__":
    sys.exit(main())
