"""Random scenes of friction, for measurements over many of them: the same seed is the same scene."""

import math
import random

KINDS = ("tip", "overdamped tip", "chain", "rigid ring", "flexible ring", "two drivers", "memory",
         "formula", "fast tip", "slow tip")


class Writer:
    """The lines of a scene."""

    def __init__(self):
        self.lines = []

    def table(self, heading, **keys):
        self.lines.append(heading)
        for key, value in keys.items():
            self.lines.append(f"{key} = {text_of(value)}")

    def body(self, kind, **keys):
        self.table("[[body]]", type=kind, **keys)

    def force(self, kind, **keys):
        self.table("[[force]]", type=kind, **keys)

    def text(self):
        return "\n".join(self.lines) + "\n"


def text_of(value):
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(text_of(one) for one in value) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {text_of(one)}" for key, one in value.items()) + " }"
    return repr(value)


def logarithmic(rng, low, high):
    """Three digits of a number between two, its logarithm uniform."""
    return float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.3g}")


def uniform(rng, low, high):
    return float(f"{rng.uniform(low, high):.3g}")


def sliding(rng, w, mass, particles, speed, dimension=1, damping=None, body=None):
    """A driver, friction and a substrate: stick-slip or smooth, under- or overdamped."""
    stiffness = logarithmic(rng, 0.3, 3.0)
    smoothness = logarithmic(rng, 0.2, 6.0)  # 4 pi^2 V / (k a^2)
    amplitude = smoothness * stiffness / (4.0 * math.pi**2)
    frequency = math.sqrt(stiffness * max(1.0, smoothness) / mass)
    ratio = damping if damping is not None else logarithmic(rng, 0.1, 3.0)
    named = {} if body is None else {"body": body}
    w.force("driving_spring", name="driver", stiffness=stiffness,
            velocity=[speed] + [0.0] * (dimension - 1), **named)
    w.force("viscous_damping", coefficient=2.0 * ratio * frequency * mass / particles, **named)
    return amplitude, frequency


def scene(kind, seed):
    """A scene of that kind without its integrator, and its duration."""
    rng = random.Random(f"{kind} {seed}")
    w = Writer()
    dynamics = "inertial"
    speed = logarithmic(rng, 0.01, 0.3)
    periods = rng.randint(3, 7)
    if kind == "fast tip":
        speed = logarithmic(rng, 0.5, 5.0)
        periods = rng.randint(6, 20)
    if kind == "slow tip":
        speed = logarithmic(rng, 1e-4, 3e-3)
    if kind in ("tip", "overdamped tip", "fast tip", "slow tip", "memory", "formula"):
        w.body("point", name="tip", position=[uniform(rng, 0.0, 1.0)], particle_mass=1.0)
        amplitude, frequency = sliding(rng, w, 1.0, 1, speed)
        if kind == "memory":
            w.force("memory_damping", coefficient=logarithmic(rng, 0.1, 2.0),
                    memory_time=logarithmic(rng, 0.1, 10.0))
        if kind == "formula":
            harmonic = uniform(rng, 0.1, 0.5)
            phase = uniform(rng, 0.0, 6.0)
            shake = uniform(rng, 0.0, 0.3)
            rate = frequency * uniform(rng, 0.3, 2.0)
            w.force("expression", name="law", energy=(
                f"{amplitude} * (1 + {shake} * sin({rate} * t)) * (cos(2*pi*x) + {harmonic} * "
                f"cos(4*pi*x + {phase}))"))
        else:
            w.force("sinusoidal_substrate", amplitude=amplitude, period=1.0)
        if kind == "overdamped tip":
            dynamics = "overdamped"
    elif kind in ("chain", "two drivers"):
        count = rng.randint(2, 6)
        w.body("chain", name="chain", count=count, spacing=uniform(rng, 0.5, 1.5),
               particle_mass=1.0)
        bond = logarithmic(rng, 1.0, 30.0)
        w.force("harmonic_bonds", pairs="neighbours", stiffness=bond)
        amplitude, frequency = sliding(rng, w, float(count), count, speed)
        w.force("sinusoidal_substrate", amplitude=amplitude / count, period=1.0)
        if kind == "two drivers":
            w.force("driving_spring", name="second", stiffness=logarithmic(rng, 0.1, 1.0),
                    velocity=[speed * uniform(rng, 0.3, 1.5)], attach={})
            w.lines[-1] = f"attach = {{ particle = {rng.randrange(count)} }}"
    else:
        count = rng.randint(3, 8)
        radius = uniform(rng, 0.3, 1.0)
        rigid = kind == "rigid ring"
        w.body("ring", name="ring", count=count, radius=radius, particle_mass=1.0 / count,
               centre=[uniform(rng, 0.0, 1.0), radius],
               coordinates="rigid" if rigid else "particles")
        if not rigid:
            w.force("harmonic_bonds", pairs="all", stiffness=logarithmic(rng, 10.0, 1e3))
        amplitude, frequency = sliding(rng, w, 1.0, count, speed, dimension=2)
        w.force("sinusoidal_substrate", amplitude=amplitude / count, period=1.0,
                decay=logarithmic(rng, 0.01, 3.0) / radius)
    w.lines.append("[run]")
    w.lines.append(f'dynamics = "{dynamics}"')
    w.lines.append(f"duration = {periods / speed!r}")
    w.lines.append("ledger = true")
    if kind == "formula":
        start = f'[measure]\nfrom = {1.0 / speed!r}\nin = "time"'
    else:
        start = '[measure]\nfrom = 1.0\nin = "driver_periods"\ndriver = "driver"'
    return w.text(), start


SLOW_KINDS = ("memory", "soft chain", "weak friction", "soft driver", "shaken", "plain")


def slow_scene(kind, seed):
    """A scene whose mean force takes long to become steady, or does not, without its [run]; the
    driver's period is 1."""
    rng = random.Random(f"slow {kind} {seed}")
    w = Writer()
    amplitude = logarithmic(rng, 3e-3, 0.05)
    friction = logarithmic(rng, 0.1, 1.0)
    stiffness = logarithmic(rng, 0.3, 3.0)
    speed = 1.0
    if kind == "soft chain":
        count = rng.randint(4, 12)
        w.body("chain", name="tip", count=count, spacing=uniform(rng, 0.8, 1.2), particle_mass=1.0)
        w.force("harmonic_bonds", pairs="neighbours", stiffness=logarithmic(rng, 0.05, 1.0))
        w.force("driving_spring", name="driver", stiffness=stiffness, velocity=[speed], attach={})
        w.lines[-1] = f"attach = {{ particle = {rng.choice((0, count - 1))} }}"
        w.force("viscous_damping", coefficient=friction)
    else:
        w.body("point", name="tip", position=[uniform(rng, 0.0, 1.0)], particle_mass=1.0)
        if kind == "weak friction":
            friction = logarithmic(rng, 3e-3, 0.05)
        if kind == "soft driver":
            stiffness = logarithmic(rng, 1e-3, 0.03)
        w.force("driving_spring", name="driver", stiffness=stiffness, velocity=[speed])
        w.force("viscous_damping", coefficient=friction)
        if kind == "memory":
            for number in range(rng.choice((1, 1, 2))):
                w.force("memory_damping", name=f"memory{number}",
                        coefficient=logarithmic(rng, 0.03, 1.0),
                        memory_time=logarithmic(rng, 5.0, 300.0))
    if kind == "shaken":
        # At half or a third of the washboard frequency, or at none that fits: periods alternate.
        rate = rng.choice((0.5, 1.0 / 3.0, 0.5, uniform(rng, 0.2, 0.8)))
        amplitude = logarithmic(rng, 0.01, 0.1)
        w.force("expression", name="shake",
                energy=f"{uniform(rng, 0.01, 0.3)} * x * sin(2*pi*{rate}*t)")
    w.force("sinusoidal_substrate", amplitude=amplitude, period=1.0)
    return w.text()
