"""A ring of eight particles that drags or rolls: how far has it turned, and what does each particle
do between steps? Cells of a notebook; as a script from the project's folder:

    PYTHONPATH=build/python python3 scenarios/rolling_ring/ring_notebook.py
"""

# %% The rigid ring of the paper's Table I
import numpy as np

import tomlin

ring = tomlin.load("scenarios/rolling_ring/table_1_rigid.toml")
print(ring.parameters)

# %% Look at the particles between steps
sim = ring.simulation()
radius = ring.parameters["R"]
snapshots = []
sim.run(every=sim.duration / 50, call=lambda sim: snapshots.append(sim.positions.copy()))
frames = np.array(snapshots)  # (frame, particle, axis)
centres = frames.mean(axis=1)
distances = np.linalg.norm(frames - centres[:, None, :], axis=2)
# A rigid body stays one, to rounding.
assert np.abs(distances - radius).max() < 1e-9 * radius

# %% The same numbers as those of the run as a whole
result = ring.run()
assert sim.result()["ring.turns"] == result["ring.turns"]
print("revolutions", result["ring.turns"], "rolling", result["ring.rolling"])

# %% Go back and try something else: a state is exact
sim = ring.simulation()
sim.advance(to=0.5 * sim.duration)
half = sim.state
sim.advance()
first = sim.positions.copy()
sim.state = half
sim.advance()
assert (sim.positions == first).all()
