#!/usr/bin/env python3
"""Kernel objects define nothing that another instruction set's objects could be linked against.

A weak symbol shared between differently compiled files (an inline function of the standard library,
say) would be taken from any one of them, and could then run instructions that the machine lacks.

usage: kernel_symbols_test.py BUILD_FOLDER
"""
import pathlib
import subprocess
import sys


def shared_symbols(path, own):
    """Defined, linkable symbols of an object that are not named after its set: by a namespace of
    tomlin's, or by the end of the function's name."""
    listing = subprocess.run(
        ["nm", "--demangle", "--defined-only", "--extern-only", str(path)],
        check=True, capture_output=True, text=True).stdout
    names = [line.split(maxsplit=2)[2] for line in listing.splitlines() if len(line.split()) > 2]
    return [name for name in names
            if not (name.startswith("tomlin::") and f"::{own}::" in name)
            and f"tomlin::{own}::" not in name and not name.partition("(")[0].endswith(f"_{own}")]


def main():
    build = pathlib.Path(sys.argv[1])
    faults = 0
    for own in ("avx2", "avx512"):
        # Kernels of the product; tests of one binary share symbols on purpose.
        objects = [path for path in build.rglob(f"*_{own}.cpp.o") if "tests" not in path.parts]
        if len(objects) < 5:
            print(f"only {len(objects)} kernel objects for {own} below {build}")
            faults += 1
        for path in objects:
            for name in shared_symbols(path, own):
                print(f"{path}: {name}")
                faults += 1
    # The check must be able to fail: an ordinary object shares a good deal.
    ordinary = next(build.rglob("engine.cpp.o"))
    if not shared_symbols(ordinary, "avx512"):
        print(f"{ordinary}: no shared symbols found, so the check sees nothing")
        faults += 1
    print("kernel objects keep to themselves" if faults == 0 else f"{faults} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
