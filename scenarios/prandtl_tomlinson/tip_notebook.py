"""A tip on a corrugated substrate: friction loop, stick-slip to smooth sliding, friction against
velocity. Cells of a notebook; as a script from the project's folder:

    PYTHONPATH=build/python python3 scenarios/prandtl_tomlinson/tip_notebook.py
"""

# %% The scene of this folder
import numpy as np

import tomlin

tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
print(tip.parameters)

# %% What to expect: s > 1, stick-slip
explanation = tip.explain()
print("stick-slip parameter", explanation.sliding[0].stick_slip)

# %% The friction trace, and the loop of a driver that reverses
tip = tip.set("v", 0.01)
trace = tip.run()
assert trace["events.slips"] > 3
trace.plot().figure.savefig("trace.png")
loop = tip.set("force.driver.reverse",
               {"when": "bodies.tip.centre_of_mass.x", "above": 3.0}).run()
loop.plot().figure.savefig("loop.png")

# %% The energy of each slip is dissipated: the mean of the force is work per distance
driver = trace.driver
print("mean force", driver.mean_force.x, "work per distance", driver.work_per_distance)
assert abs(driver.mean_force.x - driver.work_per_distance) < 1e-6 * driver.mean_force.x

# %% From smooth sliding to stick-slip: friction at low velocity begins where s exceeds 1
softness = tomlin.sweep(tip.set("v", 0.002), over={"s": [0.5, 0.8, 1.5, 3.0, 5.0]},
                        observables=["driver.mean_force.x", "events.slips"])
print(dict(zip(softness["s"], softness["driver.mean_force.x"])))
assert (softness["events.slips"][:2] == 0).all() and (softness["events.slips"][3:] > 0).all()
softness.plot().figure.savefig("softness.png")

# %% Friction against velocity, for both
velocities = tomlin.sweep(tip, over={"s": [0.5, 5.0], "v": np.geomspace(0.002, 0.1, 7)},
                          observables=["driver.mean_force.x"])
velocities.plot().figure.savefig("velocities.png")
smooth, sticking = velocities["driver.mean_force.x"]
# Smooth sliding is viscous: in proportion to the velocity; stick-slip hardly depends on it.
assert smooth[-1] / smooth[0] > 20.0 and sticking[3] / sticking[0] < 2.0
