#!/usr/bin/env python3
"""sweep.h5 as others read it: h5py, and xarray with both of its engines for netCDF-4 where they are
installed. The arrays hold what sweep.csv does.

usage: sweep_arrays_test.py TOMLIN

Exit status: 0 they do, 1 they do not, 77 there is no h5py.
"""
import csv
import importlib.util
import math
import pathlib
import subprocess
import sys
import tempfile

SCENE = """
[scene]
name = "a tip"
[parameters]
v = 1e-2
k = 2.0
V0 = 0.1
[[body]]
name = "tip"
type = "point"
position = [0.5]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = "k"
velocity = ["v"]
[[force]]
type = "viscous_damping"
coefficient = 2.0
[[force]]
type = "sinusoidal_substrate"
amplitude = "V0"
period = 1.0
[run]
duration = 5.0
integrator = { type = "rk4", dt = 2e-2 }
"""

FORCE = "driver.mean_force.x"

# Options, then dimension by dimension its name and its length.
SWEEPS = {
    "line": (["--over", "v=1e-2:1:9:log"], [("v", 9)]),
    "grid": (["--over", "v=0.1,0.2", "--over", "run.integrator.dt=1e-2,2e-2,-1",
              "--over", "run.dynamics=inertial,overdamped"],
             [("v", 2), ("run.integrator.dt", 3), ("run.dynamics", 2)]),
    "zipped": (["--over", "v=0.1,0.2,0.3", "--over", "k=1,2", "--over", "V0=0.1:0.3:3",
                "--zip", "v,V0"], [("point", 3), ("k", 2)]),
    # No grid: what bisection adds stands between its neighbours.
    "refined": (["--over", "run.dynamics=inertial,overdamped", "--over", "v=0.1:0.9:3",
                 "--refine", FORCE + "=1.0", "--refine-to", "0.1"], [("point", 10)]),
    # More than one block of rows, and in parts of the innermost axis.
    "long": (["--over", "k=1,2", "--over", "v=0.1:1:5000", "--set", "run.duration=2e-2"],
             [("k", 2), ("v", 5000)]),
}


REFINED = ("run.dynamics", "v")


def rows_of(folder):
    with open(folder / "sweep.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(cell):
    return float(cell) if cell else math.nan


def same(a, b):
    return a == b or (math.isnan(a) and math.isnan(b))


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def check(condition, *what):
    if not condition:
        print("failed:", *what)
        sys.exit(1)


def check_values(name, shape, rows, axes, force, status, reason):
    """Arrays, flattened, against the rows of the table."""
    check(len(rows) == math.prod(shape), name, "rows")
    for k, row in enumerate(rows):
        check(same(force[k], number(row[FORCE + " [force]"])), name, k, force[k], row)
        check(["finished", "failed", "refused"][status[k]] == row["status"], name, k, row)
        check(text(reason[k]) == row["reason"], name, k, reason[k], row)
        rest = k
        for (axis, length, values) in reversed(axes):
            value = values[rest % length]
            rest //= length
            cell = row.get(axis)
            if cell is None:
                continue  # numbers of points
            check(text(value) == cell if isinstance(value, (str, bytes)) else value == float(cell),
                  name, k, axis, value, cell)


def check_h5py(name, folder, dimensions):
    import h5py
    with h5py.File(folder / "sweep.h5", "r") as file:
        for number_of, (axis, length) in enumerate(dimensions):
            scale = file[axis]
            check(scale.shape == (length,), name, axis, scale.shape)
            check(scale.attrs["CLASS"] == b"DIMENSION_SCALE", name, axis, "CLASS")
            check(text(scale.attrs["NAME"]) == axis, name, axis, "NAME")
            check(scale.attrs["_Netcdf4Dimid"] == number_of, name, axis, "_Netcdf4Dimid")
        shape = tuple(length for _, length in dimensions)
        for variable in (FORCE, "status", "reason"):
            check(file[variable].shape == shape, name, variable, file[variable].shape)
            for k, (axis, _) in enumerate(dimensions):
                check(file[variable].dims[k][0] == file[axis], name, variable, axis)
        check(text(file[FORCE].attrs["units"]) == "force", name, "units")
        axes = [(axis, length, file[axis][()]) for axis, length in dimensions]
        if name == "refined":
            for axis in REFINED:
                check(file[axis].dims[0][0] == file["point"], name, axis)
                for value, row in zip(file[axis][()], rows_of(folder), strict=True):
                    is_text = isinstance(value, (str, bytes))
                    check(text(value) == row[axis] if is_text else f"{value:.17g}" == row[axis],
                          name, axis, value, row)
        check_values(name, shape, rows_of(folder), axes, file[FORCE][()].ravel(),
                     file["status"][()].ravel(), file["reason"][()].ravel())


def check_xarray(name, folder, dimensions, engine):
    import xarray
    with xarray.open_dataset(folder / "sweep.h5", engine=engine) as data:
        check(dict(data[FORCE].sizes) == dict(dimensions), name, engine, data[FORCE].sizes)
        check(data[FORCE].dims == tuple(axis for axis, _ in dimensions), name, engine)
        axes = [(axis, length, data[axis].values) for axis, length in dimensions]
        if name == "refined":
            for axis in REFINED:
                check(data[axis].dims == ("point",), name, engine, axis)
        check_values(name, [length for _, length in dimensions], rows_of(folder), axes,
                     data[FORCE].values.ravel(), data["status"].values.ravel(),
                     data["reason"].values.ravel())
        if name == "zipped":
            check(list(data["V0"].values) == [0.1, 0.2, 0.3], name, engine, data["V0"])
            check(data["V0"].dims == ("point",), name, engine)


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    if importlib.util.find_spec("h5py") is None:
        print("skipped: no h5py")
        return 77
    engines = []
    if importlib.util.find_spec("xarray"):
        engines = [engine for engine, module in (("h5netcdf", "h5netcdf"), ("netcdf4", "netCDF4"))
                   if importlib.util.find_spec(module)]
    for missing in {"h5netcdf", "netcdf4"} - set(engines):
        print("not checked: xarray's engine", missing)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        (folder / "tip.toml").write_text(SCENE, encoding="utf-8")
        for name, (options, dimensions) in SWEEPS.items():
            subprocess.run([program, "sweep", "tip.toml", *options, "--observable", FORCE, "-o",
                            name, "--quiet"], cwd=folder, check=True)
            check_h5py(name, folder / name, dimensions)
            for engine in engines:
                check_xarray(name, folder / name, dimensions, engine)
    return 0


if __name__ == "__main__":
    sys.exit(main())
