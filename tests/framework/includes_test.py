#!/usr/bin/env python3
"""Every part includes only what it depends on by ARCHITECTURE.md, directly or in turn.
No part depends on itself in turn. Nothing includes the insides of a library, which change with its
versions.

usage: includes_test.py SOURCE_DIR

Exit status: 0 it does, 1 an include leads elsewhere, 2 bad arguments.
"""
import pathlib
import re
import sys

INCLUDE = re.compile(r'^#include "((?:framework|forcefields|integrators)/[^"]+)"', re.MULTILINE)
ROW = re.compile(r"^\| ((?:`\w+`(?:, )?)+) \| ((?:`\w+`(?:, )?)*) *\|$", re.MULTILINE)
LIBRARY_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"]', re.MULTILINE)
INSIDES = {"impl", "detail", "details", "internal", "bits", "src"}  # folders of a library's own
OWN = ("framework/", "forcefields/", "integrators/", "tests/", "benchmarks/", "scenarios/")
PAGE = "framework/ARCHITECTURE.md"
TABLE = "| part | depends on |"


def part_of(path):
    """framework/run/run.hpp: run; framework/tomlin.hpp: tomlin; integrators/rk4.cpp: integrators.

    The folders of core are parts of their own: framework/core/text/utf8.hpp: text.
    """
    parts = path.split("/")
    if parts[0] != "framework":
        return parts[0]
    if parts[1] == "core":
        return parts[2]
    return parts[1] if len(parts) > 2 else "tomlin"


def allowed(page):
    """By part: all that it depends on, from the table in a page."""
    table = page[page.index(TABLE):].split("\n\n", 1)[0]
    below = {}
    for parts, others in ROW.findall(table):
        for part in re.findall(r"\w+", parts):
            below[part] = set(re.findall(r"\w+", others))
    changed = True
    while changed:
        changed = False
        for part, others in below.items():
            wider = others.union(*(below.get(other, set()) for other in others))
            changed = changed or wider != others
            below[part] = wider
    return below


def circles(below):
    """Parts that depend on themselves in turn: of those the table forbids nothing."""
    return sorted(part for part, others in below.items() if part in others)


def includes(source):
    """Path and text of each source file, tests and benchmarks included."""
    for folder in OWN:
        for path in sorted((source / folder).rglob("*.[ch]pp")):
            yield path.relative_to(source).as_posix(), path.read_text(encoding="utf-8")


def faults(files, below):
    found = []
    for name, text in files:
        for target in LIBRARY_INCLUDE.findall(text):
            if not target.startswith(OWN) and INSIDES.intersection(target.split("/")[:-1]):
                found.append(f"{name} includes {target}, which is the inside of a library")
        part = part_of(name)
        if part not in below:
            continue
        for target in INCLUDE.findall(text):
            other = part_of(target)
            if other != part and other not in below.get(part, set()):
                found.append(f"{name} includes {target}: {part} does not depend on {other}")
    return found


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    source = pathlib.Path(sys.argv[1])
    below = allowed((source / PAGE).read_text(encoding="utf-8"))
    files = list(includes(source))
    found = faults(files, below)
    found += [f"{PAGE}: {part} depends on itself" for part in circles(below)]
    for fault in found:
        print(fault)
    # Planted: arrows that lead upwards, and one to the side.
    planted = [("framework/core/system/planted.hpp", '#include "framework/scene/scene.hpp"\n'),
               ("framework/core/numbers/planted.hpp",
                '#include "framework/core/system/system.hpp"\n'),
               ("integrators/planted.cpp", '#include "forcefields/register_forces.hpp"\n'),
               # The insides of libraries.
               ("framework/scene/planted.cpp", "#include <toml++/impl/preprocessor.h>\n"),
               ("tests/planted.cpp", "# include <bits/stdc++.h>\n")]
    if len(faults(planted, below)) != len(planted):
        print("a planted fault was not seen")
        return 1
    circle = allowed(f"{TABLE}\n|---|---|\n| `a` | `b` |\n| `b`, `c` | `a` |\n")
    if circles(circle) != ["a", "b"]:
        print("a planted circle was not seen")
        return 1
    print(f"{len(files)} files, {len(below)} parts, {len(found)} wrong includes")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
