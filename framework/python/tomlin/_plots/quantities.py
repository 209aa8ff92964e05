"""The names that figures know: columns of samples, and quantities made of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tomlin._errors import QuantityError, listed, nearest_name, refusal
from tomlin._plots.labels import axis_text, column_in_words, column_text, unit_name
from tomlin._plots.runs import Run
from tomlin._record import AXES
from tomlin._tables import Array, Columns, drawable, one_line


@dataclass(frozen=True)
class Quantity:
    """A number of a sample that has a short name."""

    words: str
    symbol: str
    owner: str  #: whose column it is: "driver", "body" or empty
    column: str  #: behind the owner's name; of a vector without the axis
    summary: str
    measure: str = "component"


QUANTITIES = {
    "time": Quantity("time", "t", "", "time", "time"),
    "driver_position": Quantity("driver position", "vt", "driver", "position.x",
                                "where the driver's support is along x: v t"),
    "force": Quantity("lateral force", "F_x", "driver", "force.x",
                      "x component of the driver's force"),
    "force_size": Quantity("friction force", "F_f", "driver", "force",
                           "size of the driver's force, with the sign of its x component",
                           "signed size"),
    "position": Quantity("centre of mass", "x_c", "body", "centre_of_mass.x",
                         "the centre of mass along x"),
    "height": Quantity("centre of mass", "y_c", "body", "centre_of_mass.y",
                       "the centre of mass along y"),
    "rotation": Quantity("rotation", r"\varphi", "body", "rotation",
                         "rotation, unwrapped, counter-clockwise positive"),
    "speed": Quantity("speed", "v_c", "body", "velocity", "speed of the centre of mass", "size"),
}

#: Figures of one quantity over another: y, x, summary.
KINDS = {
    "force": ("force", "driver_position", "the friction trace: F_x versus v t"),
    "force_size": ("force_size", "driver_position",
                   "F_f versus v t: the force's size with the sign of F_x"),
    "position": ("position", "driver_position",
                 "x_c versus v t, beside a spring that is not stretched"),
    "height": ("height", "driver_position", "y_c versus v t"),
    "rotation": ("rotation", "driver_position", "the angle versus v t"),
    "speed": ("speed", "driver_position", "the speed versus v t"),
    "hysteresis": ("force", "position", "F_x over x_c, a loop when the driver turns back"),
    "path": ("height", "position", "y_c over x_c"),
}


@dataclass
class Series:
    """A quantity, or a plain column, of one run."""

    name: str
    unit: str
    values: Array
    words: str = ""  #: of a quantity; a column has none
    symbol: str = ""

    def axis(self, run: Run, in_words: bool = False) -> str:
        if self.symbol:
            return axis_text(self.words, self.symbol, unit_name(run, self.unit))
        return (column_in_words if in_words else column_text)(run, self.name, self.unit)

    @property
    def key(self) -> str:
        """The name in a key, where the axis stands for several."""
        return self.words or self.name


@dataclass
class Owners:
    """The driver and the body that are meant; empty: the only one."""

    driver: str = ""
    body: str = ""


def owners_of(table: Columns, column: str) -> list[str]:
    return [name[:-len(column) - 1] for name in table.names if name.endswith(f".{column}")]


def chosen_owner(table: Columns, kind: str, column: str, owners: Owners) -> str:
    """The driver or body whose columns are meant. Raises SceneError with the candidates."""
    wanted = owners.driver if kind == "driver" else owners.body
    candidates = owners_of(table, column)
    if not candidates:
        raise refusal("plot.no_data", table.file, f"no {kind} has a column {column}",
                      admissible=f"{listed(table.names)}; --x and --y take any of them")
    if not wanted and len(candidates) > 1:
        several = "drivers" if kind == "driver" else "bodies"
        raise refusal("command.missing_argument", table.file,
                      f"several {several} have a column {column}",
                      admissible=", ".join(f"--{kind} {one}" for one in candidates))
    if wanted and wanted not in candidates:
        raise refusal("plot.no_data", table.file, f"there is no column {wanted}.{column}",
                      key=one_line(f"--{kind} {wanted}"), admissible=listed(candidates),
                      nearest=nearest_name(wanted, candidates))
    return wanted or candidates[0]


def find_series(table: Columns, name: str, owners: Owners, option: str) -> Series:
    """A quantity or else a column. Raises SceneError with the names that there are."""
    quantity = QUANTITIES.get(name)
    if quantity is None:
        if name in table:
            return Series(name, table.units[name], drawable(table[name], table.file))
        known = table.names + [one for one in QUANTITIES if one not in table]
        raise refusal("plot.no_data", table.file, "there is no such column or quantity",
                      key=one_line(f"{option} {name}".strip()), admissible=listed(known),
                      nearest=nearest_name(name, known), kind=QuantityError)
    vector = quantity.measure != "component"
    prefix = ""
    if quantity.owner:
        first = quantity.column + (".x" if vector else "")
        prefix = chosen_owner(table, quantity.owner, first, owners) + "."
    column = prefix + quantity.column
    columns = [f"{column}.{axis}" for axis in AXES if f"{column}.{axis}" in table] if vector else [
        column]
    values = drawable(table[columns[0]], table.file)
    if vector:
        values = np.sqrt(sum(drawable(table[one], table.file) ** 2 for one in columns))
    if quantity.measure == "signed size":
        values = np.copysign(values, table[columns[0]])
    return Series(name, table.units[columns[0]], values, quantity.words, quantity.symbol)
