"""Models of nanoscale friction from plain scene files, as the program ``tomlin`` runs them.

The numbers are those of the program, to the bit: the module calls the same library. A scene is a
TOML file, a text or a dict of plain Python values:

>>> import tomlin
>>> tip = tomlin.load("scenarios/prandtl_tomlinson/stick_slip.toml")
>>> result = tip.set("v", 0.01).run()
>>> result.status
'finished'
>>> round(result["driver.mean_force.x"], 3)
0.478

All numbers are in the units of the scene; angles are in rad. What a run leaves undefined is None.
"""

from tomlin._core import version as __version__
from tomlin._errors import Error, Fault, OutputError, QuantityError, RunError, SceneError
from tomlin._record import Record, Vector
from tomlin._result import Result, Table, open
from tomlin._scene import Scene, compare, load, parse
from tomlin._simulation import Simulation, State
from tomlin._studies import Check, Comparison, Explanation, Tradeoff
from tomlin._sweep import Sweep, sweep

__all__ = [
    "Check", "Comparison", "Error", "Explanation", "Fault", "OutputError", "QuantityError",
    "Record", "Result", "RunError", "Scene", "SceneError", "Simulation", "State", "Sweep", "Table",
    "Tradeoff", "Vector", "compare", "load", "open", "parse", "sweep", "__version__",
]
