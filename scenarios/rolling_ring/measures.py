"""What one reads off a run of this folder's scenes."""

import cmath
import math


def max_speed(summary):
    """Largest speed of the ring's centre over the driving velocity."""
    return summary["bodies"]["ring"]["max_speed"] / summary["parameters"]["v"]


def mean_force(summary):
    return summary["drivers"]["driver"]["mean_force"][0]


def turns_per_period(summary):
    window = summary["window"]
    periods = ((window["to"] - window["from"]) * summary["parameters"]["v"]
               / summary["parameters"]["a"])
    return summary["bodies"]["ring"]["turns"] / periods


def lower_bound(parameters, gear=1):
    """Viscous loss alone of a ring that turns by 1/N in so many periods."""
    rolling = 2.0 * math.pi * parameters["R"] / (gear * parameters["N"] * parameters["a"])
    return parameters["xi"] * parameters["v"] * (1.0 + rolling**2)


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


def after_first(column, periods):
    """The samples after the first of so many periods."""
    return column[(len(column) - 1) // periods:]


def last(column, periods, number=1):
    """The samples of the last period, or the last few, of so many."""
    return column[-number * ((len(column) - 1) // periods) - 1:]


def loop(trace):
    """(area between the branches, furthest place) of a driver that goes there and back."""
    place, force = trace["driver.position.x"], trace["driver.force.x"]
    area = 0.0
    for n in range(1, len(place)):
        if place[n] < 0.0:
            break
        area += 0.5 * (force[n] + force[n - 1]) * (place[n] - place[n - 1])
    return area, max(place)


def shortest_turn(rotation):
    """Part of a period in which the ring does 90 % of its turn, from the samples of a period."""
    samples = len(rotation) - 1
    turn = rotation[-1] - rotation[0]
    twice = rotation + [angle + turn for angle in rotation[1:]]
    for width in range(1, samples):
        if any((twice[n + width] - twice[n]) / turn >= 0.9 for n in range(samples)):
            return width / samples
    return 1.0


def force_of_the_paper(trace):
    """F_f: the size of the whole force, with the sign of its x component."""
    return [math.copysign(math.hypot(x, y), x)
            for x, y in zip(trace["driver.force.x"], trace["driver.force.y"])]


def largest_step(column):
    """Between two samples."""
    return max(abs(b - a) for a, b in zip(column, column[1:]))


def phases(trace, radius, periods):
    """Phases of rolling (-R dphi/dx above 1/2) and dragging of one period, in order.

    They begin where the ring first sets out to roll in the last two periods; where it never does,
    or never stops, there is one phase.
    """
    x, turned, driver, force = (last(trace[name], periods, 2) for name in (
        "ring.centre_of_mass.x", "ring.rotation", "driver.position.x", "driver.force.x"))
    samples = (len(x) - 1) // 2
    rolls = [radius * (a - b) > 0.5 * abs(q - p)
             for a, b, p, q in zip(turned, turned[1:], x, x[1:])]
    start = next((n for n in range(1, samples) if rolls[n] > rolls[n - 1]), 0)
    borders = [n for n in range(start + 1, start + samples) if rolls[n] != rolls[n - 1]]
    found = []
    for begin, end in zip([start] + borders, borders + [start + samples]):
        way = sum(abs(b - a) for a, b in zip(force[begin:end], force[begin + 1:end + 1]))
        found.append({"rolls": rolls[begin], "from": driver[begin], "to": driver[end],
                      "advance": x[end] - x[begin], "rotation": turned[end] - turned[begin],
                      "slope": way / (driver[end] - driver[begin])})
    return found


def sharpest_kink(place, force, within):
    """Largest factor by which |dF/dX| changes within a distance; places are evenly spaced.

    The steeper slope must be at least half the mean one: where a smooth curve turns round, its
    slope passes through 0, and that is no kink.
    """
    spacing = place[1] - place[0]
    slopes = [abs(b - a) / spacing for a, b in zip(force, force[1:])]
    steep = 0.5 * sum(slopes) / len(slopes)
    apart = round(within / spacing)
    return max(max(a, b) / min(a, b) for a, b in zip(slopes, slopes[apart:]) if max(a, b) >= steep)


def hops(trace, radius, periods):
    """Rises of y_c by more than 0.2 R, after the first period: [(height, how far it turns)]."""
    height = after_first(trace["ring.centre_of_mass.y"], periods)
    turned = after_first(trace["ring.rotation"], periods)
    found = []
    begin = 0
    while begin < len(height):
        top = begin
        while top + 1 < len(height) and height[top + 1] > height[top]:
            top += 1
        if height[top] - height[begin] > 0.2 * radius:
            on_the_way = turned[begin:top + 1]
            found.append((height[top] - height[begin], max(on_the_way) - min(on_the_way)))
        begin = top + 1
    return found


def slips_per_period(trace, velocity, periods):
    """How often the ring passes twenty times the driver's speed, after the first period."""
    speed = [math.hypot(x, y) for x, y in zip(after_first(trace["ring.velocity.x"], periods),
                                              after_first(trace["ring.velocity.y"], periods))]
    rises = sum(a < 20.0 * velocity <= b for a, b in zip(speed, speed[1:]))
    return rises / (periods - 1)
