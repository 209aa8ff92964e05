"""Is a file H5MD 1.1? Every rule that concerns trajectories of particles, in the order of the
specification (nongnu.org/h5md), and that nothing is kept in less than double precision.

As a script: h5md_check.py FILE... prints what is wrong and exits with 1 if anything is.
"""

import re
import sys

import h5py
import numpy as np

FACTOR = r"[A-Za-z]+([+-]\d+)?"
UNIT = re.compile(rf"(\d+(\.\d+)? )?{FACTOR}( {FACTOR})*")

ELEMENTS = {  # per-particle elements: kinds of numbers, and dimensions behind [N]
    "position": ("fiu", 1),
    "velocity": ("fiu", 1),
    "force": ("fiu", 1),
    "image": ("fiu", 1),
    "mass": ("f", 0),
    "species": ("iu", 0),  # enumerations are integers too
    "id": ("iu", 0),
    "body": ("iu", 0),  # of tomlin
    "charge": ("fiu", 0),
}


def faults(path):
    """All that is wrong with a file, a sentence each."""
    found = []
    try:
        with h5py.File(path, "r") as file:
            Checker(file, found).check()
    except OSError as error:
        found.append(f"does not open: {error}")
    return found


class Checker:
    def __init__(self, file, found):
        self.file = file
        self.found = found

    def check(self):
        self.check_metadata()
        if "particles" in self.file:
            groups = self.file["particles"]
            for name in groups:
                self.check_particles(groups[name])
        self.file.visititems(self.check_precision)

    def fault(self, where, what):
        self.found.append(f"{getattr(where, 'name', where)}: {what}")

    # ---- /h5md

    def check_metadata(self):
        h5md = self.file.get("h5md")
        if not isinstance(h5md, h5py.Group):
            self.fault("/h5md", "is not there")
            return
        self.check_version(h5md, [1, 1])
        for group, names in {"author": ["name"], "creator": ["name", "version"]}.items():
            if not isinstance(h5md.get(group), h5py.Group):
                self.fault(f"/h5md/{group}", "is not there")
                continue
            for name in names:
                self.check_fixed_text(h5md[group], name)
        for module in h5md.get("modules", {}).values():
            self.check_version(module, None)
        if "modules/units" in h5md:
            self.check_units(h5md["modules/units"])

    def check_version(self, group, expected):
        version = group.attrs.get("version")
        if version is None or np.shape(version) != (2,) or version.dtype.kind not in "iu":
            self.fault(group, "version is not two integers")
        elif expected is not None and list(version) != expected:
            self.fault(group, f"version is {list(version)}, not {expected}")

    def check_fixed_text(self, group, name):
        """A string of fixed length, as a scalar."""
        if name not in group.attrs:
            self.fault(group, f"has no {name}")
            return
        attribute = group.attrs.get_id(name)
        kind = h5py.check_string_dtype(attribute.dtype)
        if kind is None or kind.length is None:
            self.fault(group, f"{name} is not a string of fixed length")
        if attribute.shape != ():
            self.fault(group, f"{name} is not a scalar")

    def check_units(self, units):
        system = units.attrs.get("system")
        if not isinstance(system, str) or not system:
            self.fault(units, "system is not a scalar string of variable length")
        self.file.visititems(self.check_unit)

    def check_unit(self, _, item):
        """Unit factors, parted by spaces: symbols with a signed power."""
        unit = item.attrs.get("unit")
        if unit is None:
            return
        if not isinstance(unit, str) or not UNIT.fullmatch(unit):
            self.fault(item, f"unit is {unit!r}, not factors of symbols")

    # ---- /particles

    def check_particles(self, group):
        box = group.get("box")
        if not isinstance(box, h5py.Group):
            self.fault(group, "has no box")
            return
        counts = {}
        axes = box.attrs.get("dimension")
        if axes is None or np.shape(axes) != () or axes.dtype.kind not in "iu":
            self.fault(box, "dimension is not an integer")
            return
        self.check_boundary(box, int(axes))
        for name, (kinds, rank) in ELEMENTS.items():
            if name not in group:
                continue
            value = self.check_element(group[name])
            if value is None:
                continue
            if value.dtype.kind not in kinds:
                self.fault(value, "holds numbers of the wrong kind")
            moving = isinstance(group[name], h5py.Group)
            if value.ndim != moving + 1 + rank:
                self.fault(value, f"has {value.ndim} dimensions, not {moving + 1 + rank}")
                continue
            counts[name] = value.shape[moving]
            if rank == 1 and value.shape[-1] != axes:
                self.fault(value, f"has {value.shape[-1]} axes in a box of {axes}")
        if len(set(counts.values())) > 1:
            self.fault(group, f"numbers of particles differ: {counts}")
        if isinstance(group.get("id"), h5py.Dataset):
            ids = group["id"][()]
            if len(np.unique(ids)) != len(ids):
                self.fault(group["id"], "is not unique")
        if "edges" in box:
            self.check_edges(box, group.get("position"), int(axes))
        elif "periodic" in self.boundary(box):
            self.fault(box, "is periodic and has no edges")

    @staticmethod
    def boundary(box):
        return [word.decode() for word in np.ravel(box.attrs.get("boundary", []))
                if isinstance(word, bytes)]

    def check_boundary(self, box, axes):
        if "boundary" not in box.attrs:
            self.fault(box, "has no boundary")
            return
        kind = h5py.check_string_dtype(box.attrs.get_id("boundary").dtype)
        if kind is None or kind.length is None:
            self.fault(box, "boundary is not of strings of fixed length")
        words = self.boundary(box)
        if box.attrs["boundary"].shape != (axes,) or set(words) - {"periodic", "none"}:
            self.fault(box, f"boundary is {words}")

    def check_element(self, element):
        """Its numbers; if it depends on time, they go with step and time."""
        if isinstance(element, h5py.Dataset):
            return element
        if "value" not in element or "step" not in element:
            self.fault(element, "has no value or no step")
            return None
        value, step = element["value"], element["step"]
        if value.ndim < 1 or value.maxshape[0] is not None:
            self.fault(value, "does not grow along its first dimension")
        if step.dtype.kind not in "iu":
            self.fault(step, "is not of integers")
        for name in ("step", "time"):
            if name not in element or element[name].shape == ():
                continue
            times = element[name]
            if times.ndim != 1 or times.shape[0] != value.shape[0]:
                self.fault(times, f"has shape {times.shape}, the values {value.shape}")
            elif np.any(np.diff(times[()]) <= 0):
                self.fault(times, "does not increase")
            if times.dtype.kind not in "fiu":
                self.fault(times, "is not of numbers")
        return value

    def check_edges(self, box, position, axes):
        edges = box["edges"]
        value = self.check_element(edges)
        if value is None:
            return
        moving = isinstance(edges, h5py.Group)
        if value.shape[moving:] not in ((axes,), (axes, axes)):
            self.fault(value, f"has shape {value.shape} in a box of {axes} axes")
        if not (moving and isinstance(position, h5py.Group)):
            return
        for name in ("step", "time"):
            if name in position and edges.get(name) != position[name]:
                self.fault(edges, f"{name} is not that of the positions")

    # ---- not H5MD's, but ours

    def check_precision(self, _, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and item.dtype.itemsize < 8:
            self.fault(item, "is not in double precision")


def main(paths):
    status = 0
    for path in paths:
        for fault in faults(path):
            print(f"{path}: {fault}")
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
