"""Short scenes that between them take every path on which bits could go astray: each integrator
and number type, rigid and flexible bodies, a box, a prescribed motion, samples, the ledger."""

TIP = """
[[body]]
name = "tip"
type = "point"
position = [0.3]
particle_mass = 1.0

[[force]]
name = "driver"
type = "driving_spring"
stiffness = "4 * pi^2 * 0.1 / 5"
velocity = [0.05]

[[force]]
type = "viscous_damping"
coefficient = "sqrt(0.1) * 2.7"

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
"""

MEMORY = """
[[force]]
type = "memory_damping"
coefficient = 0.4
memory_time = 0.3
"""

SURFACE = """
[[body]]
name = "tip"
type = "point"
position = [0.3, 0.1, 0.2]
particle_mass = 1.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.4, 0.2, 0.0]

[[force]]
type = "viscous_damping"
coefficient = 0.5

[[force]]
type = "lattice_substrate"
lattice = "honeycomb"
period = 1.0
misfit = 0.2
amplitudes = [0.1, 0.03]
decay = [2.0, 3.0]
repulsion = 0.5
repulsion_decay = 2.5
"""

MAP = """
[[body]]
name = "tip"
type = "point"
position = [0.3, 0.1, 1.5]
velocity = [0.2, 0.1, -0.1]
particle_mass = 1.0

[[force]]
name = "driver"
type = "driving_spring"
stiffness = [1.0, 1.0, 0.5]
velocity = [0.3, 0.1, 0.0]

[[force]]
type = "viscous_damping"
coefficient = 0.5

[[force]]
type = "lattice_substrate"
lattice = "hexagonal"
period = 1.0
misfit = 0.2
energies = [[0.3, 0.1, -0.2, 0.05, 0.0], [0.1, 0.2, 0.3, -0.1, 0.1], [0.0, -0.3, 0.1, 0.2, 0.1],
            [-0.1, 0.1, 0.1, 0.2, -0.2]]
decay = 2.0
repulsion = 0.5
repulsion_decay = 2.5
"""

CHAIN = """
[box]
lengths = [13.0]
periodic = [true]

[[body]]
name = "chain"
type = "chain"
count = 21
spacing = "13 / 21"
particle_mass = 1.0

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 1.0

[[force]]
name = "driver"
type = "driving_spring"
stiffness = 0.01
velocity = [0.1]
attach = "each_particle"

[[force]]
type = "viscous_damping"
coefficient = 0.1

[[force]]
type = "sinusoidal_substrate"
amplitude = "0.3 / (4 * pi^2)"
period = 1.0
"""

RING = """
[[body]]
name = "ring"
type = "ring"
count = 8
radius = 1.0
centre = [0.1, 1.0]
particle_mass = "1 / 8"
coordinates = "{coordinates}"

[[force]]
type = "harmonic_bonds"
pairs = "all"
stiffness = 1e3

[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [0.1, 0.0]

[[force]]
type = "viscous_damping"
coefficient = "2 * sqrt(2) / 8"

[[force]]
type = "sinusoidal_substrate"
amplitude = "0.1 / 8"
period = 1.0
decay = 1.0
"""

PUSHED = """
[[body]]
name = "tip"
type = "particles"
positions = [[0.0, 0.0], [0.7, 0.1], [0.2, 0.9]]
particle_mass = [1.0, 0.3, 0.7]

[[body]]
name = "hand"
type = "point"
position = [1.0, 2.0]
particle_mass = 1.0
coordinates = "prescribed"
motion = { velocity = ["0.3 * cos(t)", "exp(-t) / 7"] }

[[force]]
name = "within"
type = "harmonic_bonds"
body = "tip"
pairs = "all"
stiffness = 3.0

[[force]]
name = "between"
type = "harmonic_bonds"
bodies = ["tip", "hand"]
pairs = "all"
stiffness = 0.7

[[force]]
type = "viscous_damping"
body = "tip"
coefficient = 0.2
"""

RK4 = '{{ type = "rk4", dt = {dt} }}'
DOPRI5 = '{ type = "dopri5", absolute_tolerance = 1e-9, relative_tolerance = 1e-9 }'
RADAU9 = DOPRI5.replace("dopri5", "radau9")
DOP853 = DOPRI5.replace("dopri5", "dop853")
VERLET = '{ type = "velocity_verlet", dt = 1e-2 }'
EXPONENTIAL = VERLET.replace("velocity", "exponential")
MIDPOINT = VERLET.replace("velocity_verlet", "midpoint")


def scene(bodies, integrator, duration, every, *more):
    keys = "\n".join(more)
    return f"""{bodies}
[run]
duration = {duration}
integrator = {integrator}
{keys}

[measure]
from = {duration / 3}
to = {duration}

[output]
every = {every}
"""


LEDGER = "ledger = true"
QUADRUPLE = 'number_type = "quadruple"'
PERTURB = "perturb = { size = 1e-9, repeats = 2 }\nseed = 5"
OVERDAMPED = 'dynamics = "overdamped"'
RIGID = RING.format(coordinates="rigid")
FLEXIBLE = RING.format(coordinates="particles")

SCENES = {
    "tip_fixed_step": scene(TIP, RK4.format(dt=1e-2), 60.0, 0.7),
    "tip_adaptive": scene(TIP, DOPRI5, 60.0, 0.7, LEDGER),
    "tip_verlet": scene(TIP, VERLET, 30.0, 0.7),
    "tip_overdamped": scene(TIP, DOPRI5, 60.0, 0.7, OVERDAMPED),
    "tip_quadruple": scene(TIP, RK4.format(dt=2e-2), 2.0, 0.3, QUADRUPLE, LEDGER),
    "tip_perturbed": scene(TIP, DOPRI5, 20.0, 0.7, PERTURB),
    "chain_fixed_step": scene(CHAIN, RK4.format(dt=2e-2), 20.0, 0.7, LEDGER),
    "chain_verlet": scene(CHAIN, VERLET, 20.0, 0.7),
    "ring_rigid_adaptive": scene(RIGID, DOPRI5, 40.0, 0.7, LEDGER),
    "ring_rigid_quadruple": scene(RIGID, DOPRI5, 1.0, 0.3, QUADRUPLE),
    "ring_flexible": scene(FLEXIBLE, RK4.format(dt=2e-3), 5.0, 0.7, LEDGER),
    "ring_flexible_adaptive": scene(FLEXIBLE, DOPRI5, 2.0, 0.7),
    "tip_eighth_order": scene(TIP, DOP853, 60.0, 0.7, LEDGER),
    "tip_memory": scene(TIP + MEMORY, RK4.format(dt=1e-2), 30.0, 0.7, LEDGER),
    "ring_rigid_memory": scene(RIGID + MEMORY, DOPRI5, 20.0, 0.7, LEDGER),
    "tip_midpoint": scene(TIP, MIDPOINT, 30.0, 0.7),
    "ring_flexible_exponential": scene(FLEXIBLE, EXPONENTIAL, 10.0, 0.7, LEDGER),
    "chain_exponential": scene(CHAIN, EXPONENTIAL, 20.0, 0.7),
    "tip_implicit": scene(TIP, RADAU9, 60.0, 0.7, LEDGER),
    "tip_implicit_overdamped": scene(TIP, RADAU9, 60.0, 0.7, OVERDAMPED),
    "chain_implicit": scene(CHAIN, RADAU9, 20.0, 0.7),
    "ring_rigid_implicit": scene(RIGID, RADAU9, 40.0, 0.7, LEDGER),
    "surface": scene(SURFACE, DOPRI5, 20.0, 0.7, LEDGER),
    "surface_from_map": scene(MAP, DOPRI5, 20.0, 0.7, LEDGER),
    "two_bodies": scene(PUSHED, DOPRI5, 10.0, 0.7, LEDGER),
}
