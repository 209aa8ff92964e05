#!/usr/bin/env python3
"""Comments are sentences: few begin with a word that needs the line above to be understood.

    python3 tests/documentation/comments_test.py SOURCE_DIR [--list]

With --list, the comments in question are printed. Exit status: 0 few do, 1 too many, 2 bad arguments.
"""

import pathlib
import re
import sys

FOLDERS = ("benchmarks", "forcefields", "framework", "integrators", "scenarios", "tests")
FRAGMENT = re.compile(r"(Of|The same|Those|What|Where|Likewise|As|Whose|Which)\b")
MOST = 0.005  # of all comments: the best-kept codes of the field have up to 0.003


def comments(text, mark):
    """The first line of each comment that has lines of its own, with its number."""
    within = False
    for number, line in enumerate(text.splitlines(), 1):
        found = re.match(rf"\s*{mark} *(?![<!])(.*)", line)
        if found and not within:
            yield number, found[1]
        within = found is not None


def fragments(path, text):
    """How many comments there are, and those that begin with half a sentence."""
    mark = "#" if path.suffix == ".py" else "///?"
    all_comments = list(comments(text, mark))
    return len(all_comments), [(number, first) for number, first in all_comments
                               if FRAGMENT.match(first)]


def check_the_check():
    planted = "/// Of the reach.\nint a;\n// A sentence is one.\n// Where it goes on.\nint b;\n"
    assert fragments(pathlib.Path("a.hpp"), planted) == (2, [(1, "Of the reach.")])
    assert fragments(pathlib.Path("a.py"), "x = 1\n# Those of it.\n")[1] == [(2, "Those of it.")]


def main():
    if len(sys.argv) < 2:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    check_the_check()
    source = pathlib.Path(sys.argv[1])
    total, found = 0, []
    for folder in FOLDERS:
        for path in sorted((source / folder).rglob("*")):
            if path.suffix not in (".cpp", ".hpp", ".py"):
                continue
            count, some = fragments(path, path.read_text())
            total += count
            found += [f"{path.relative_to(source)}:{number}: {first}" for number, first in some]
    if "--list" in sys.argv:
        print("\n".join(found))
    print(f"{len(found)} of {total} comments begin with half a sentence")
    sys.exit(0 if len(found) <= MOST * total else 1)


if __name__ == "__main__":
    main()
