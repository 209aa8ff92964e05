"""Random valid scenes of every body, force and kind of coordinates, with parameters over decades: the
same seed is the same scene. Nobody would run them; whatever is said of a scene has to hold in them."""

import math
import random
import sys

from random_scenes import Writer, logarithmic, uniform

AXES = "xyz"
PLANAR = ("ring", "ellipse", "polygon", "flake")
SPATIAL = ("graphene", "nanotube")
MOST_PARTICLES = 8  # of a body: most that can go wrong does so in a few

ENERGIES = ("{a} * cos(2*pi*x/{l})", "{a} * x^2 / {l}^2", "{a} * exp(-(x/{l})^2)",
            "{a} * (1 + 0.3*sin({w}*t)) * cos(2*pi*x/{l} + 0.4)", "{a} / (1 + (x/{l})^2)",
            "{a} * log(1 + (x/{l})^2)", "{a} * tanh(x/{l})^2", "{a} * sin({w}*t) * x / {l}",
            "{a} * sqrt(1 + (x/{l})^2)")
PAIR_ENERGIES = ("{a} * (r/{l} - 1)^2", "{a} * exp(-r/{l})", "{a} * ({l}/r)^3", "{a} * cos(r/{l})")
FORCES = ("-{a} * x / {l}", "-{c} * vx", "{a} * sin({w}*t)", "{a} * cos(2*pi*x/{l}) - {c} * vx")
STEADY_FORCES = ("-{a} * x / {l}", "{a} * sin({w}*t)", "{a} * cos(2*pi*x/{l})")
WEAKENING = "-{c} * vx / (1 + abs(vx) / {s})"


class ValidScene:
    """Lengths and times scale with the scene's own, and forces with both and its mass."""

    def __init__(self, seed):
        self.rng = random.Random(f"valid {seed}")
        self.dimension = self.rng.choice((1, 1, 2, 2, 2, 3))
        self.length = self.magnitude(4)
        self.time = self.magnitude(4)
        self.mass = self.magnitude(4)
        self.writer = Writer()
        self.offset = self.rng.choice((0.0, 0.0, 0.0, 1e3, -1e5)) * self.length
        self.box = 64.0 * self.length if self.rng.random() < 0.15 else 0.0
        if self.box:
            self.offset = 0.0
            self.writer.table("[box]", lengths=[self.box] * self.dimension,
                              periodic=[self.rng.random() < 0.7 for _ in range(self.dimension)])
        self.bodies = []  # name, number of particles, coordinates
        self.heated = set()  # bodies with a temperature
        self.scheme = self.rng.choice(("rk4", "velocity_verlet"))
        for number in range(self.rng.choice((1, 1, 2, 2, 3))):
            self.add_body(f"b{number}")
        for number in range(self.rng.randint(1, 4)):
            self.add_force(f"f{number}")
        self.add_run()

    def magnitude(self, decades):
        """1 in one scene of three."""
        if self.rng.random() < 1 / 3:
            return 1.0
        return logarithmic(self.rng, 10.0 ** -decades, 10.0 ** decades)

    def of(self, unit, low=0.05, high=20.0):
        return float(f"{unit * logarithmic(self.rng, low, high):.4g}")

    def vector(self, unit):
        return [float(f"{unit * self.rng.uniform(-1.0, 1.0):.4g}") for _ in range(self.dimension)]

    # Units of the scene.
    def stiffness(self):
        return self.mass / self.time**2

    def energy(self):
        return self.mass * (self.length / self.time)**2

    def force_unit(self):
        return self.mass * self.length / self.time**2

    def drag(self):
        return self.mass / self.time

    def speed(self):
        return self.length / self.time

    def add_body(self, name):
        kinds = ["point", "particles", "chain"]
        kinds += PLANAR if self.dimension >= 2 else []
        kinds += SPATIAL if self.dimension == 3 else []
        kind = self.rng.choice(kinds)
        # Heights are near those at which a substrate decays.
        centre = [float(f"{(self.offset if d == 0 else 0.0) + x:.9g}")
                  for d, x in enumerate(self.vector(3.0 * self.length))]
        count = self.rng.randint(2, MOST_PARTICLES)
        keys = {}
        if kind == "point":
            count = 1
            keys["position"] = centre
        elif kind == "particles":
            positions = [[float(f"{c + self.length * (i if d == 0 else 0) * 0.8 + x:.9g}")
                          for d, (c, x) in enumerate(zip(centre, self.vector(0.3 * self.length)))]
                         for i in range(count)]
            keys["positions"] = [p[0] for p in positions] if self.dimension == 1 else positions
        elif kind == "chain":
            keys = {"count": count, "spacing": self.of(self.length, 0.5, 1.5), "origin": centre}
        elif kind == "ring":
            count = max(count, 3)
            keys = {"count": count, "radius": self.of(self.length, 0.3, 2.0), "centre": centre}
        elif kind == "ellipse":
            count = max(count, 3)
            keys = {"count": count, "semi_axes": [self.of(self.length, 0.5, 2.0),
                                                  self.of(self.length, 0.5, 2.0)], "centre": centre}
        elif kind == "polygon":
            count = 6
            keys = {"corners": 3, "count": 6, "radius": self.of(self.length, 0.5, 2.0),
                    "centre": centre}
        elif kind == "flake":
            count = 7
            keys = {"lattice": "hexagonal", "shape": "hexagon", "size": 1,
                    "lattice_constant": self.of(self.length, 0.7, 1.5), "centre": centre}
        elif kind == "graphene":
            count = 4
            keys = {"bond_length": self.of(self.length, 0.7, 1.5), "cells": [1, 1],
                    "centre": centre}
        else:
            count = 16
            keys = {"chirality": [4, 0], "bond_length": self.of(self.length, 0.7, 1.5), "cells": 1,
                    "centre": centre}
        keys["particle_mass"] = self.of(self.mass)
        if self.rng.random() < 0.5:
            keys["velocity"] = self.vector(self.speed())
        if count > 1 and self.rng.random() < 0.5:
            keys["displacement"] = [self.vector(0.1 * self.length) for _ in range(count)]
        coordinates = "particles"
        if self.bodies or self.rng.random() < 0.5:
            coordinates = self.rng.choice(("particles", "particles", "rigid", "fixed", "prescribed"))
        planar = self.dimension == 2
        if coordinates == "fixed":
            keys.pop("velocity", None)
        if coordinates == "rigid":
            if "displacement" in keys:
                keys["displacement"] = keys["displacement"][0]
            if self.dimension == 3 or count == 1:
                coordinates = "particles"
        if coordinates == "prescribed":
            keys.pop("velocity", None)
            law = "{:.4g} * cos({:.4g} * t)".format(self.of(self.speed(), 0.1, 1.0),
                                                    self.of(1.0 / self.time))
            motion = self.vector(self.speed())
            if self.rng.random() < 0.5:
                motion[0] = law
            keys["motion"] = {"velocity": motion}
            if planar and count > 1 and self.rng.random() < 0.3:
                keys["motion"]["angular_velocity"] = self.of(1.0 / self.time, 0.1, 1.0)
        if coordinates in ("particles", "rigid") and self.rng.random() < 0.25:
            held = [self.rng.choice(AXES[:self.dimension])]
            if coordinates == "rigid" and self.rng.random() < 0.5:
                held = ["rotation"]
            if self.dimension > 1 or coordinates == "rigid":
                keys["hold"] = held
                keys.pop("velocity", None)
        keys["coordinates"] = coordinates
        self.writer.body(kind, name=name, **keys)
        self.bodies.append((name, count, coordinates))

    def heat(self, body):
        self.heated.add(body[0])
        self.scheme = "baoab"

    def period(self):
        """That of a box's side, where there is one."""
        period = self.of(self.length, 0.3, 3.0)
        return self.box / round(self.box / period) if self.box else period

    def add_force(self, name):
        moving = [b for b in self.bodies if b[2] != "fixed"] or self.bodies
        body = self.rng.choice(self.bodies if self.rng.random() < 0.1 else moving)
        pairs = [(a, b) for a in self.bodies for b in self.bodies if a is not b and
                 (a[2] != "fixed" or b[2] != "fixed")]
        kinds = ["driving_spring", "driving_spring", "viscous_damping", "sinusoidal_substrate",
                 "constant_force", "memory_damping", "lattice_substrate", "formula",
                 "formula force"]
        if self.scheme == "rk4":  # others lose orders by friction that is not linear
            kinds += ["coulomb_friction", "velocity_weakening", "velocity weakening formula"]
        heatable = (body[2] == "particles" and body[0] not in self.heated and self.scheme != "rk4")
        if heatable:
            kinds += ["langevin"]
        if body[1] > 1 and body[2] == "particles":
            kinds += ["harmonic_bonds", "morse_bonds", "lennard_jones", "pair formula"]
        if heatable and self.scheme == "velocity_verlet" and \
                not any(b[2] == "prescribed" for b in self.bodies):
            kinds.append("nose_hoover_chain")
        if pairs:
            kinds += ["bonds between", "morse between", "contact", "contact"]
        kind = self.rng.choice(kinds)
        write = lambda type_name, **keys: self.writer.force(type_name, name=name, **keys)
        of_one = {"body": body[0]}
        many = self.rng.random() < 0.3
        per_particle = lambda unit: [self.of(unit) for _ in range(body[1])] if many else self.of(unit)
        if kind == "driving_spring":
            attach = self.rng.choice(("centre_of_mass", "centre_of_mass", "each_particle", "one"))
            keys = {"stiffness": self.of(self.stiffness()), "velocity": self.vector(self.speed())}
            if attach == "one":
                keys["attach"] = {"particle": self.rng.randrange(body[1])}
            else:
                keys["attach"] = attach
            if self.rng.random() < 0.2:
                keys["axes"] = ["x"]
            elif self.rng.random() < 0.3 and attach == "centre_of_mass":
                keys["start"] = self.vector(3.0 * self.length)
            write(kind, **keys, **of_one)
        elif kind == "viscous_damping":
            write(kind, coefficient=per_particle(self.drag()), **of_one)
        elif kind == "sinusoidal_substrate":
            keys = {"amplitude": per_particle(self.energy()), "period": self.period()}
            if self.dimension > 1 and self.rng.random() < 0.5:
                keys["decay"] = self.of(1.0 / self.length**2, 0.01, 1.0)
            write(kind, **keys, **of_one)
        elif kind == "constant_force":
            write(kind, force=self.vector(self.force_unit()), **of_one)
        elif kind == "coulomb_friction":
            write(kind, force=per_particle(self.force_unit()), width=self.of(self.speed(), 1e-3, 1.0),
                  **of_one)
        elif kind == "velocity_weakening":
            write(kind, force=per_particle(self.force_unit()),
                  weakening_velocity=self.of(self.speed(), 0.5, 5.0),
                  width=self.of(self.speed(), 1e-3, 0.1), **of_one)
        elif kind == "memory_damping":
            keys = {"coefficient": self.of(self.drag()), "memory_time": self.of(self.time)}
            if self.rng.random() < 0.3 and heatable:
                keys["temperature"] = self.of(self.energy(), 0.01, 1.0)
                self.heat(body)
            write(kind, **keys, **of_one)
        elif kind == "langevin":
            self.heat(body)
            write(kind, coefficient=self.of(self.drag()), temperature=self.of(self.energy(), 0.01, 1.0),
                  **of_one)
        elif kind == "lattice_substrate":
            if self.dimension == 1:
                keys = {"lattice": "line", "period": self.period()}
            else:
                keys = {"lattice": self.rng.choice(("square", "hexagonal", "honeycomb")),
                        "period": self.period()}
                if self.rng.random() < 0.5:
                    keys["misfit"] = uniform(self.rng, -1.0, 1.0)
            if self.dimension == 3:
                keys["decay"] = self.of(1.0 / self.length, 0.05, 1.0)
            if self.rng.random() < 0.3 and self.dimension == 2:
                keys["energies"] = [[uniform(self.rng, -1.0, 1.0) for _ in range(4)]
                                    for _ in range(4)]
                keys["energy_scale"] = self.of(self.energy())
            else:
                keys["amplitude"] = self.of(self.energy())
            write(kind, **keys, **of_one)
        elif kind == "nose_hoover_chain":
            self.heated.add(body[0])
            write(kind, temperature=self.of(self.energy(), 0.01, 1.0), period=self.of(self.time, 1, 20),
                  **of_one)
        elif kind in ("formula", "pair formula", "formula force", "velocity weakening formula"):
            numbers = {"a": self.of(self.energy()), "l": self.of(self.length, 0.3, 3.0),
                       "w": self.of(1.0 / self.time), "c": self.of(self.drag())}
            if "force" in kind or "velocity" in kind:
                numbers["a"] = self.of(self.force_unit())
                numbers["s"] = self.of(self.speed())
                law = (WEAKENING if "velocity" in kind else
                       self.rng.choice(FORCES if self.scheme == "rk4" else STEADY_FORCES))
                write("expression", force=[law.format(**numbers)] +
                      ["0"] * (self.dimension - 1), **of_one)
            elif kind == "formula":
                write("expression", energy=self.rng.choice(ENERGIES).format(**numbers), **of_one)
            elif kind == "pair formula":
                write("expression", energy=self.rng.choice(PAIR_ENERGIES).format(**numbers),
                      pairs=self.rng.choice(("all", "neighbours")), **of_one)
        else:
            both = self.rng.choice(pairs) if pairs else None
            between = {"bodies": [one[0] for one in both]} if both else {}
            if kind in ("harmonic_bonds", "bonds between"):
                law, keys = "harmonic_bonds", {"stiffness": self.of(self.stiffness())}
            elif kind in ("morse_bonds", "morse between"):
                law, keys = "morse_bonds", {"depth": self.of(self.energy()),
                                            "inverse_width": self.of(1.0 / self.length, 0.3, 3.0)}
            else:
                law = "lennard_jones"
                sigma = self.of(self.length, 0.2, 0.8)
                keys = {"epsilon": self.of(self.energy(), 0.01, 1.0), "sigma": sigma,
                        "cutoff": float(f"{sigma * self.rng.uniform(2.0, 4.0):.4g}"),
                        "at_cutoff": self.rng.choice(("smooth", "smooth", "smooth", "shift", "cut"))}
            if law != "lennard_jones":
                keys["pairs"] = self.rng.choice(("all", "neighbours"))
                if "between" in kind:
                    keys["pairs"] = self.rng.choice(("all", [[self.rng.randrange(both[0][1]),
                                                              self.rng.randrange(both[1][1])]]))
                if self.rng.random() < 0.4:
                    keys["rest_lengths"] = self.of(self.length, 0.3, 3.0)
            write(law, **keys, **(between if kind in ("bonds between", "morse between", "contact")
                                  else of_one))

    def add_run(self):
        dt = f"{1e-6 * self.time:.4g}"
        self.writer.lines += [
            "[run]", f"duration = {self.of(self.time, 0.3, 30.0)!r}", "allow_unstable = true",
            f'integrator = {{ type = "{self.scheme}", dt = {dt} }}']

    def text(self):
        return self.writer.text()


if __name__ == "__main__":
    for number in range(*(int(given) for given in sys.argv[1:3])):
        print("# next")
        print(ValidScene(number).text(), end="")
