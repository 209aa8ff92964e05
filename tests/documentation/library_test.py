#!/usr/bin/env python3
"""Follows the pages about tomlin as a library to the letter.

    python3 tests/documentation/library_test.py SOURCE_DIR BUILD_DIR

A block fenced as ```LANGUAGE FILE is written to that file; then the blocks fenced as ```sh library
are run by bash, from a folder in which `build` is the project's. Home is a temporary folder, so that
what a page installs there is all that it finds. The last thing that a page prints is a number that
this test knows in closed form.

Exit status: 0 all went well, 1 something did not, 2 bad arguments.
"""

import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FENCE = re.compile(r"^```(\S+) (\S+)\n(.*?)^```$", flags=re.MULTILINE | re.DOTALL)
SECONDS_PER_PAGE = 500


class Page:
    """A page, the number that it ends with, and how far off it may be."""

    def __init__(self, path, number, tolerance):
        self.path = path
        self.number = number
        self.tolerance = tolerance


PAGES = [
    # Steady drag, coefficient * velocity; what is left of the start is exp(-30), and the window's
    # integral is as good as the standard tolerance of dopri5.
    Page("README.md", 3.0 * 0.5, 1e-8),
    # Energy of the quartic trap: v = -A^2 sqrt(s / (2 m)); tolerance 1e-12 a step, some dozens.
    Page("forcefields/README.md", -1.0 * math.sqrt(2.0 / (2.0 * 1.0)), 1e-10),
]


def follow(text, folder, build):
    """What the page prints when it is done as it says; raises RuntimeError when it cannot be."""
    (folder / "build").symlink_to(build)
    commands = []
    for language, name, content in FENCE.findall(text):
        if (language, name) == ("sh", "library"):
            commands.append(content)
        elif "." in name:
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(content, encoding="utf-8")
    if not commands:
        raise RuntimeError("there is nothing to do")
    home = folder / "home"
    home.mkdir()
    environment = {**os.environ, "HOME": str(home)}
    for leak in ("CMAKE_PREFIX_PATH", "tomlin_DIR", "tomlin_ROOT", "CPATH", "CPLUS_INCLUDE_PATH"):
        environment.pop(leak, None)
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", "".join(commands)], cwd=folder,
                          env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False,
                          timeout=SECONDS_PER_PAGE)
    if done.returncode != 0:
        raise RuntimeError(f"ends with status {done.returncode}:\n{done.stdout}")
    return done.stdout


def complaint(page, text, build):
    """Why a page is wrong, or None."""
    with tempfile.TemporaryDirectory(prefix="tomlin-library-") as name:
        try:
            printed = follow(text, pathlib.Path(name), build)
        except RuntimeError as error:
            return str(error)
    last = printed.splitlines()[-1]
    try:
        number = float(last)
    except ValueError:
        return f"ends with \"{last}\", which is no number"
    if not abs(number - page.number) <= page.tolerance:
        return f"gives {number!r} for {page.number!r}"
    return None


def sees_a_fault(text, build):
    """The page on forces says what happens when a sign is wrong: its claim does not hold."""
    faulty = text.replace("return -(p.strength", "return (p.strength")
    if faulty == text:
        return "there is no sign to change"
    with tempfile.TemporaryDirectory(prefix="tomlin-library-") as name:
        try:
            follow(faulty, pathlib.Path(name), build)
        except RuntimeError as error:
            return None if "does not hold: gradient" in str(error) else str(error)
    return "a wrong sign goes unnoticed"


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    source = pathlib.Path(sys.argv[1]).resolve()
    build = pathlib.Path(sys.argv[2]).resolve()
    failed = False
    for page in PAGES:
        why = complaint(page, (source / page.path).read_text(encoding="utf-8"), build)
        print(f"{page.path}: {why or 'as it says'}", flush=True)
        failed = failed or why is not None
    why = sees_a_fault((source / PAGES[-1].path).read_text(encoding="utf-8"), build)
    print(f"{PAGES[-1].path} with a wrong sign: {why or 'seen'}", flush=True)
    return 1 if failed or why else 0


if __name__ == "__main__":
    sys.exit(main())
