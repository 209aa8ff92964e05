#!/usr/bin/env python3
"""The pages of reference that are checked in are those that the program makes; the guide names all types.

    python3 tests/documentation/reference_test.py SOURCE_DIR PROGRAM

Exit status: 0 they are, 1 one is stale, 2 bad arguments.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

RENEW = "build/bin/tomlin describe --markdown --force -o ."

LINK = re.compile(r"\]\(([^)#:]+)\)")  # to files; not to sections, nor elsewhere
TYPE = re.compile(r"^## (\w+)$", flags=re.MULTILINE)
PAGES_OF_TYPES = ("forcefields/REFERENCE.md", "integrators/REFERENCE.md",
                  "framework/bodies/REFERENCE.md")


def stale(source, made):
    """What is wrong with the pages below `source`, given those that were made."""
    complaints = []
    for page in sorted(made.glob("**/*.md")):
        name = page.relative_to(made)
        kept = source / name
        if not kept.is_file():
            complaints.append(f"{name} is not there")
        elif kept.read_bytes() != page.read_bytes():
            complaints.append(f"{name} is stale")
    return complaints


def broken_links(source, made):
    """Links of the pages to files that are not there."""
    return [f"{page.relative_to(made)}: {target} is not there"
            for page in sorted(made.glob("**/*.md"))
            for target in LINK.findall(page.read_text(encoding="utf-8"))
            if not (source / page.relative_to(made).parent / target).exists()]


def without_guide(guide, made):
    """Types of components that the text of the guide does not name."""
    return [f"the user guide does not name `{name}`"
            for page in PAGES_OF_TYPES
            for name in TYPE.findall((made / page).read_text(encoding="utf-8"))
            if f"`{name}`" not in guide]


def sees_types(made):
    """A planted guide that names all types but one."""
    names = [name for page in PAGES_OF_TYPES
             for name in TYPE.findall((made / page).read_text(encoding="utf-8"))]
    named = [f"`{name}`" for name in names]
    return (len(names) > len(PAGES_OF_TYPES) and not without_guide(" ".join(named), made)
            and len(without_guide(" ".join(named[1:]), made)) == 1)


def sees_faults(made):
    """Planted faults, which must all be noticed."""
    with tempfile.TemporaryDirectory(prefix="tomlin-reference-") as name:
        source = pathlib.Path(name) / "source"
        shutil.copytree(made, source)
        page = sorted(source.glob("**/*.md"))[0]
        whole = page.read_bytes()
        if stale(source, made):
            return False
        page.write_bytes(whole.replace(b"default", b"defualt", 1))
        if len(stale(source, made)) != 1:
            return False
        page.unlink()
        return len(stale(source, made)) == 1


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 2
    source = pathlib.Path(sys.argv[1]).resolve()
    program = pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory(prefix="tomlin-reference-") as name:
        made = pathlib.Path(name)
        subprocess.run([program, "describe", "--markdown", "-o", made], check=True,
                       stdout=subprocess.DEVNULL)
        if not sees_faults(made) or not sees_types(made):
            print("the test itself is broken: a planted fault was not noticed")
            return 1
        guide = "".join(page.read_text(encoding="utf-8")
                        for page in sorted((source / "framework/guide").glob("*.md")))
        complaints = stale(source, made) + broken_links(source, made) + without_guide(guide, made)
        print(f"{len(list(made.glob('**/*.md')))} pages, {len(complaints)} complaints")
    if complaints:
        print("\n".join(complaints) + f"\n\nin the project's folder, this renews them:\n  {RENEW}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
