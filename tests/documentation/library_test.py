#!/usr/bin/env python3
"""Follows the pages about tomlin as a library to the letter.

    python3 tests/documentation/library_test.py SOURCE_DIR BUILD_DIR

A block fenced as ```LANGUAGE FILE is written to that file; then the blocks fenced as ```sh library
are run by bash, from a folder in which `build` is the project's. Home is a temporary folder, so that
what a page installs there is all that it finds. The numbers that blocks end with are known here in
closed form.

Exit status: 0 all went well, 1 something did not, 2 bad arguments.
"""

import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

FENCE = re.compile(r"^```(\S+) (\S+)\n(.*?)^```$", flags=re.MULTILINE | re.DOTALL)
SECONDS_PER_PAGE = 1500


class Page:
    """A page, and the numbers that its blocks end with: each with how far off it may be."""

    def __init__(self, path, numbers):
        self.path = path
        self.numbers = numbers


J_1_OF_0_8 = 0.36884204609417003
POWER = (0.5 * math.pi**2 * J_1_OF_0_8 / math.pi) ** 2 * 3000.0 / 4.0

PAGES = [
    # Steady drag, coefficient * velocity; what is left of the start is exp(-30), and the window's
    # integral is as good as the standard tolerance of dopri5.
    # The second program prints what its mean force is off by, at an accuracy of 1e-4.
    Page("framework/LIBRARY.md", [(3.0 * 0.5, 1e-8), (0.0, 3.0 * 0.5 * 1e-4)]),
    Page("forcefields/README.md", [
        # Energy of the quartic trap: v = -A^2 sqrt(s / (2 m)); tolerance 1e-12 a step, some dozens.
        (-1.0 * math.sqrt(2.0 / (2.0 * 1.0)), 1e-10),
        # Three ways to one force: the last bits of some thousand steps, which motion that is damped
        # does not amplify much.
        (0.0, 1e-12),
    ]),
    # (k a J_1(s) / pi)^2 T / 4 with s = 0.8, k = pi^2 / 2, T = 3000; the driver is slow, not
    # infinitely slow. (The plugin of the page's first part ends with a text.)
    Page("framework/plugin/README.md", [(POWER, 1e-3 * POWER)]),
]
END_OF_BLOCK = "--- end of a block ---"


def lay_out(text, folder, build):
    """Writes the files of a page; returns its blocks of commands."""
    (folder / "build").symlink_to(build)
    (folder / "home").mkdir()
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
    return commands


def follow(commands, folder):
    """What each block prints; raises RuntimeError when one of them fails."""
    environment = {**os.environ, "HOME": str(folder / "home")}
    for leak in ("CMAKE_PREFIX_PATH", "tomlin_DIR", "tomlin_ROOT", "CPATH", "CPLUS_INCLUDE_PATH"):
        environment.pop(leak, None)
    script = "".join(f"{block}echo '{END_OF_BLOCK}'\n" for block in commands)
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", script], cwd=folder,
                          env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False,
                          timeout=SECONDS_PER_PAGE)
    if done.returncode != 0:
        raise RuntimeError(f"ends with status {done.returncode}:\n{done.stdout}")
    return done.stdout.split(END_OF_BLOCK)[:-1]


def last_numbers(printed):
    """The numbers that blocks end with."""
    numbers = []
    for text in printed:
        try:
            numbers.append(float((text.strip().splitlines() or [""])[-1]))
        except ValueError:
            pass
    return numbers


def differs(expected, numbers):
    """Why numbers are not what is expected, or None."""
    if len(numbers) != len(expected):
        return f"blocks end with {numbers}, and {len(expected)} numbers are expected"
    for (number, tolerance), given in zip(expected, numbers):
        if not abs(given - number) <= tolerance:
            return f"gives {given!r} for {number!r}"
    return None


def complaint(page, text, build):
    """Why a page is wrong, or None."""
    with tempfile.TemporaryDirectory(prefix="tomlin-library-") as name:
        folder = pathlib.Path(name)
        try:
            commands = lay_out(text, folder, build)
            why = differs(page.numbers, last_numbers(follow(commands, folder)))
            if why is None and (folder / "morse").is_dir():
                why = sees_another_bond(page, folder, commands) or sees_a_wrong_sign(folder, commands)
            return why
        except RuntimeError as error:
            return str(error)


def sees_another_bond(page, folder, commands):
    """Once all is built: what compares the three ways sees one that is wrong."""
    formula = folder / "morse" / "as_formula.toml"
    sound = formula.read_text(encoding="utf-8")
    formula.write_text(sound.replace("r - r0", "r - 1.000001 * r0"), encoding="utf-8")
    for way in ("formula", "plugin", "tree"):
        shutil.rmtree(folder / "morse" / way)
    first = next(k for k, block in enumerate(commands) if "as_formula.toml" in block)
    printed = follow(commands[first:], folder)
    return None if differs(page.numbers[-1:], last_numbers(printed)) else "a wrong bond is not seen"


def sees_a_wrong_sign(folder, commands):
    """The page on forces says what happens when a sign is wrong: a property does not hold."""
    sign = "return -(p.strength"
    faulty = [file for file in folder.glob("trap/*.?pp")
              if sign in file.read_text(encoding="utf-8")]
    if not faulty:
        return "there is no sign to change"
    for file in faulty:
        text = file.read_text(encoding="utf-8")
        file.write_text(text.replace(sign, "return (p.strength"), encoding="utf-8")
    try:
        follow(commands[:1], folder)
    except RuntimeError as error:
        return None if "does not hold: conservative" in str(error) else str(error)
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
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
