#!/usr/bin/env python3
"""Figs. 2 to 12b of Sircar and Patra: their runs, beside what the paper says of them.

    python3 scenarios/rolling_ring/figures.py PROGRAM [FIGURE ...]

Exit status: 0 every number is where it should be, 1 one is not or a run failed, 2 bad arguments.
"""

import argparse
import math
import pathlib
import sys
import tempfile

from measures import (after_first, drag_alone, force_of_the_paper, hops, largest_step, last, loop,
                      lower_bound, max_speed, mean_force, phases, sharpest_kink, shortest_turn,
                      slips_per_period, threshold, turns_per_period)
from runs import RunFailed, Tomlin, program_argument, say

HELD = {"body.ring.hold": '["rotation"]'}

# Friction of a tip on a fast spring or a weak corrugation has this limit for v -> 0; at the
# velocities used here it is off by parts in a thousand.
QUASISTATIC_TOLERANCE = 5e-3
# Near a threshold the largest speed over v grows as v^(-2/5) and its next powers.
SMEARING = (0.34, 0.42)
# A ring without height is a tip: branches and loop of Fig. 3.
SAME_LOOP = 1e-6
KINK = 3.0  # change of the slope of F over v t,
WITHIN = 0.01  # in this part of a period


def figure_2(tomlin):
    """A small ring and a tip, which is a ring of next to no radius."""
    say("Fig. 2, R = 0.001: a Prandtl-Tomlinson tip for lambda -> 0, less and less one for larger")
    say("  lambda   mean force     against the tip  mean |x_c - x_tip|  max speed/v  turns/period")
    tip = mean_force(tomlin.run("fig_2.toml", {"R": "1e-9", **HELD}))
    place = after_first(tomlin.trace()["ring.centre_of_mass.x"], 10)
    sound = True
    nearer = 0.0
    for row in ("0", "0.001", "0.01", "0.1", "1"):
        summary = tomlin.run("fig_2.toml", {"lambda": row})
        force = mean_force(summary)
        x = after_first(tomlin.trace()["ring.centre_of_mass.x"], 10)
        away = sum(abs(p - q) for p, q in zip(x, place)) / len(x)
        say(f"  {row:<7}  {force:.7e}  {force / tip - 1.0:+.1e}         {away:.1e}"
            f"             {max_speed(summary):5.1f}      {turns_per_period(summary):+.6f}")
        # Slips: a hundred times the driver's speed.
        sound = sound and max_speed(summary) > 100.0 and abs(turns_per_period(summary)) < 1e-8
        sound = sound and away > nearer
        nearer = away
    p = summary["parameters"]
    say(f"  s = 4 pi^2 V0/(k a^2) = {4.0 * math.pi**2 * p['V0'] / (p['k'] * p['a']**2):.2f}: "
        "this is stick-slip already")
    return sound


def hysteresis(tomlin, scene, settings):
    """(force over samples, work, area between the branches, furthest place of the driver)"""
    summary = tomlin.run(scene, settings)
    trace = tomlin.trace()
    return (trace["driver.force.x"], summary["drivers"]["driver"]["work"], *loop(trace))


def figure_3(tomlin):
    """A small ring and a tip on a weak spring, there and back."""
    say("Fig. 3, R = 0.001, k = 0.1: the driver turns back when x_c exceeds 10")
    say("  lambda   work        area of the loop  furthest sample  largest |F - F_tip|/F_c  area"
        " against the tip's")
    largest = 2.0 * math.pi * 0.1
    tip, tip_work, tip_area, tip_turn = hysteresis(tomlin, "fig_3_tip.toml", {})
    sound = True
    nearer = 0.0
    for row in ("0", "1e-5", "1e-4", "0.001", "0.01", "0.1"):
        force, work, area, turn = hysteresis(tomlin, "fig_3.toml", {"lambda": row})
        away = max(abs(a - b) for a, b in zip(force, tip)) / largest
        say(f"  {row:<7}  {work:.7f}  {area:.7f}        {turn:.6f}        {away:.1e}"
            f"                  {area / tip_area - 1.0:+.1e}")
        if row == "0":
            sound = all(error < SAME_LOOP for error in (
                away, abs(work / tip_work - 1.0), abs(area / tip_area - 1.0),
                abs(turn / tip_turn - 1.0)))
        sound = sound and away > nearer
        nearer = away
    plain = hysteresis(tomlin, "fig_3_tip.toml", {"R": "0"})
    away = max(abs(a - b) for a, b in zip(plain[0], tip)) / largest
    say(f"  tip      {tip_work:.7f}  {tip_area:.7f}        {tip_turn:.6f}")
    say(f"  the plain tip, of amplitude V0, differs: {away:.1e} in the force,"
        f" {plain[2] / tip_area - 1.0:+.1e} in the area")
    return sound and away > 100.0 * SAME_LOOP


def growth(tomlin, scene, settings):
    """Largest speed over v at two velocities, and its power of 1/v."""
    fast = max_speed(tomlin.run(scene, {**settings, "v": "1e-3"}))
    slow = max_speed(tomlin.run(scene, {**settings, "v": "1e-4"}))
    return fast, slow, math.log10(slow / fast)


def thresholds(tomlin, scene, title, settings, critical, printed):
    """Runs around a threshold; returns whether they slip below it and slide above."""
    say(f"  {title}: k_crit = {critical:.3f}, the paper's formula: {printed:.3f}")
    sound = True
    for factor in (0.95, 1.0, 1.05):
        k = critical * factor
        fast, slow, power = growth(tomlin, scene, {**settings, "k": repr(k)})
        low, high = {0.95: (0.45, 1.0), 1.0: SMEARING, 1.05: (0.0, 0.3)}[factor]
        say(f"    k = {k:7.3f}   max speed/v: {fast:6.2f} at v = 1e-3, {slow:6.2f} at 1e-4"
            f"   ~ v^{-power:+.2f}")
        sound = sound and low < power < high
    return sound


def figure_4(tomlin):
    """Where sliding becomes smooth, without height."""
    say("Fig. 4: smooth sliding (power 0), threshold (-2/5), stick-slip (towards -1)")
    sound = True
    for radius in ("0.1", "0.5"):
        summary = tomlin.run("fig_4.toml", {"R": radius, "k": "100", **HELD})
        p = summary["parameters"]
        sign = sum(math.cos(2.0 * math.pi * p["R"] * math.cos(2.0 * math.pi * i / p["N"]))
                   for i in range(int(p["N"])))
        critical = threshold(p)
        sound = thresholds(tomlin, "fig_4.toml", f"lambda = 0, R = {radius}",
                           {"R": radius, **HELD}, critical, math.copysign(critical, sign)) and sound
    return sound


def figure_5a(tomlin):
    """Where sliding becomes smooth, with height."""
    say("Fig. 5a: smooth sliding (power 0), threshold (-2/5), stick-slip (towards -1)")
    sound = True
    # Folds of the path of equilibria, from an independent program (and the test of this figure).
    for decay, critical in (("0.001", 39.478), ("0.05", 56.096)):
        b = float(decay) / 0.001
        printed = max(4.0 * math.pi**2, (2.0 * b)**1.5 / math.sqrt(math.e))
        sound = thresholds(tomlin, "fig_5a.toml", f"lambda = {decay}, R = 0.001",
                           {"lambda": decay}, critical, printed) and sound
    return sound


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
        of_ff = largest_step(after_first(force_of_the_paper(trace), 10))
        of_fx = largest_step(after_first(trace["driver.force.x"], 10))
        say(f"  {row:<7}  {mean_force(summary):.4e}    {held:.4e}      "
            f"{100.0 * shortest_turn(last(trace['ring.rotation'], 10)):2.0f} % of a period"
            f"   {of_ff:.4f}         {of_fx:.4f}")
        p = summary["parameters"]
        if float(row) <= 0.01:  # where the height of the ring hardly changes
            sound = sound and abs(held / drag_alone(p) - 1.0) < QUASISTATIC_TOLERANCE
        sound = sound and held < mean_force(summary) and mean_force(summary) > lower_bound(p)
        sound = sound and abs(turns_per_period(summary) + 1.0 / p["N"]) < 1e-8
    say(f"  even rolling: 90 % of a turn in 90 % of a period, mean force {lower_bound(p):.4e}")
    return sound


def say_phases(found):
    """A line for each phase of a period; the letters are those of the paper's Fig. 5."""
    for letter, phase in zip("ABCDEF", found):
        say(f"    {letter}-{chr(ord(letter) + 1)}  {'rolls  ' if phase['rolls'] else 'dragged'}"
            f"  v t = {phase['from']:7.3f} to {phase['to']:7.3f}"
            f"   turns by {phase['rotation']:+.4f}, advances by {phase['advance']:.4f},"
            f" mean |dF/d(v t)| {phase['slope']:.3f}")


def figure_6(tomlin):
    """Phases of a ring that is dragged and rolls."""
    say("Fig. 6, R = 1: positions of the ring at the salient phases of Fig. 5")
    sound = True
    for row, count in (("0.01", 4), ("1", 1)):
        summary = tomlin.run("fig_6.toml", {"lambda": row})
        found = phases(tomlin.trace(), summary["parameters"]["R"], 3)
        say(f"  lambda = {row}")
        say_phases(found)
        sound = sound and len(found) == count
    return sound


def figure_7(tomlin):
    """Friction for different velocities."""
    say("Fig. 7, R = 1, lambda = 0.01: dragging and rolling when slow, smooth dragging when fast")
    say("  v        mean force   least of a ring that rolls  least at all: xi v  turns/period"
        "  sharpest kink")
    sound = True
    for row in ("0.0005", "0.001", "0.005", "0.01", "0.02", "0.05", "0.1"):
        summary = tomlin.run("fig_7.toml", {"v": row})
        trace = tomlin.trace()
        force = mean_force(summary)
        p = summary["parameters"]
        rolls = float(row) <= 0.01
        kink = sharpest_kink(last(trace["driver.position.x"], 20),
                             last(trace["driver.force.x"], 20), WITHIN * p["a"])
        say(f"  {row:<7}  {force:.4e}   {lower_bound(p):.4e}                  "
            f"{p['xi'] * p['v']:.4e}          {turns_per_period(summary):+.6f}     {kink:.1f}")
        turns = -1.0 / p["N"] if rolls else 0.0
        sound = sound and abs(turns_per_period(summary) - turns) < 1e-6
        sound = sound and force > (lower_bound(p) if rolls else p["xi"] * p["v"])
        sound = sound and (kink > KINK) == rolls
    return sound


def figure_8(tomlin):
    """Phases of slow and fast rings."""
    say("Fig. 8, R = 1, lambda = 0.01: positions of the ring at the salient phases of Fig. 7")
    sound = True
    for row in ("0.0005", "0.001", "0.01", "0.05", "0.1"):
        summary = tomlin.run("fig_8.toml", {"v": row})
        trace = tomlin.trace()
        found = phases(trace, summary["parameters"]["R"], 11)
        turned = last(trace["ring.rotation"], 11)
        say(f"  v = {row}: turns by {turned[-1] - turned[0]:+.4f} in a period,"
            f" {max(turned) - min(turned):.4f} at most")
        say_phases(found)
        rolls = float(row) <= 0.01
        sound = sound and len(found) == (4 if rolls else 1)
        sound = sound and (max(turned) - min(turned) < 0.02) != rolls
    return sound


def figure_9(tomlin):
    """Friction of small rings, and their height."""
    say("Fig. 9, lambda = 1: small rings are dragged and hop")
    say("  R        mean force   lowest y_c   highest y_c  turns/period  slips/period  most turned"
        "  step of F_f where")
    say(75 * " " + "in a hop     the driver overtakes")
    sound = True
    for row, slips in (("0.001", 2.0), ("0.01", 2.0), ("0.1", 1.0)):
        summary = tomlin.run("fig_9.toml", {"R": row})
        trace = tomlin.trace()
        height = after_first(trace["ring.centre_of_mass.y"], 10)
        fx, fy = (after_first(trace[f"driver.force.{axis}"], 10) for axis in "xy")
        found = slips_per_period(trace, summary["parameters"]["v"], 10)
        hop = max(turned for _, turned in hops(trace, float(row), 10))
        # F_x rises through zero where the driver overtakes, not in a slip.
        step = max(2.0 * abs(fy[n]) for n in range(len(fx) - 1) if fx[n] <= 0.0 < fx[n + 1])
        say(f"  {row:<7}  {mean_force(summary):.4e}   {min(height):.3e}    {max(height):.3e}"
            f"    {turns_per_period(summary):+.6f}     {found:.0f}             {hop:.1e}"
            f"      {step:.4f}")
        sound = sound and abs(turns_per_period(summary)) < 1e-4 and found == slips
        sound = sound and max(height) > 3.0 * min(height) and hop < 1e-3
    return sound


def figure_12b(tomlin):
    """Friction of a large ring of ten particles at two velocities."""
    say("Fig. 12b, N = 10, R = 3.191, lambda = 1: friction grows with velocity")
    say("  v        mean force   xi v (1 + (2 pi R/(2 N a))^2)  turns/period  largest F_x")
    sound = True
    slower = 0.0
    for row in ("0.001", "0.005"):
        summary = tomlin.run("fig_12b.toml", {"v": row})
        p, driver = summary["parameters"], summary["drivers"]["driver"]
        # Particles are two periods apart along the rim.
        least = lower_bound(p, gear=2)
        force = mean_force(summary)
        say(f"  {row:<7}  {force:.4e}   {least:.4e}                     "
            f"{turns_per_period(summary):+.6f}     {driver['max_force'][0]:.5f}")
        sound = sound and slower < force and least < force < 1.005 * least
        sound = sound and abs(turns_per_period(summary) + 0.5 / p["N"]) < 1e-8
        slower = force
    return sound


FIGURES = {"2": figure_2, "3": figure_3, "4": figure_4, "5a": figure_5a, "5": figure_5,
           "6": figure_6, "7": figure_7, "8": figure_8, "9": figure_9, "12b": figure_12b}


def main():
    parser = argparse.ArgumentParser(description="Figures of Sircar and Patra, run and compared.")
    program_argument(parser)
    parser.add_argument("figures", metavar="FIGURE", nargs="*",
                        help=f"{', '.join(FIGURES)}; all of them when none is given")
    arguments = parser.parse_args()
    unknown = [figure for figure in arguments.figures if figure not in FIGURES]
    if unknown:
        parser.error(f"there is no figure {unknown[0]}; expected: {', '.join(FIGURES)}")

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
