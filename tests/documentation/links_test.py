#!/usr/bin/env python3
"""Relative links of all pages lead to files that exist, and to headings that exist; the README is short.

    python3 tests/documentation/links_test.py SOURCE_DIR

Exit status: 0 all is well, 1 a link is broken or the README too long, 2 bad arguments.
"""

import pathlib
import re
import sys
import tempfile

from pages import pages_of

MOST_LINES_OF_README = 200

LINK = re.compile(r"\]\(<?([^)\s>]+)>?(?: \"[^\"]*\")?\)")
ELSEWHERE = re.compile(r"^[a-z]+:")
FENCE = re.compile(r"^```.*?^```$", flags=re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`[^`\n]*`")
HEADING = re.compile(r"^#{1,6} +(.+?) *#*$", flags=re.MULTILINE)


def slug(heading):
    """The anchor that GitHub gives a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    text = re.sub(r"[^\w\- ]", "", text.lower())
    return text.replace(" ", "-")


def anchors(text):
    """All anchors of a page; a repeated heading is numbered."""
    found = set()
    for heading in HEADING.findall(FENCE.sub("", text)):
        name, number = slug(heading), 0
        while (name if number == 0 else f"{name}-{number}") in found:
            number += 1
        found.add(name if number == 0 else f"{name}-{number}")
    return found


def links(text):
    """Link targets in a page, those in code left out."""
    return LINK.findall(CODE.sub("", FENCE.sub("", text)))


def broken(source):
    """How many relative links there are, and what is wrong with them."""
    count, complaints = 0, []
    for page in pages_of(source):
        for link in links(page.read_text(encoding="utf-8")):
            if ELSEWHERE.match(link):
                continue
            count += 1
            file, _, anchor = link.partition("#")
            target = (page.parent / file) if file else page
            where = f"{page.relative_to(source)}: {link}"
            if not target.exists():
                complaints.append(f"{where}: there is no such file")
            elif anchor and target.suffix == ".md":
                if anchor not in anchors(target.read_text(encoding="utf-8")):
                    complaints.append(f"{where}: there is no such heading")
    return count, complaints


def sees_faults():
    """Planted links, broken and valid."""
    with tempfile.TemporaryDirectory(prefix="tomlin-links-") as name:
        source = pathlib.Path(name)
        (source / "other.md").write_text("# One two\n\n## One two\n\n## `a` (b), c\n", encoding="utf-8")
        (source / "page.md").write_text(
            "# Here\n[a](other.md) [b](other.md#one-two) [c](other.md#one-two-1) [d](#here)\n"
            "[e](other.md#a-b-c) [f](https://example.org/x#y) `[g](none.md)`\n"
            "```text\n[h](none.md)\n```\n"
            "[i](none.md) ![j](none.svg) [k](other.md#three) [l](#there)\n", encoding="utf-8")
        count, complaints = broken(source)
        return count == 9 and len(complaints) == 4


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if not sees_faults():
        print("the test itself is broken: planted links are not told apart")
        return 1
    source = pathlib.Path(sys.argv[1]).resolve()
    count, complaints = broken(source)
    lines = len((source / "README.md").read_text(encoding="utf-8").splitlines())
    if lines > MOST_LINES_OF_README:
        complaints.append(f"README.md has {lines} lines, more than {MOST_LINES_OF_README}")
    print(f"{len(pages_of(source))} pages, {count} links, {len(complaints)} complaints")
    if complaints:
        print("\n".join(complaints))
    return 1 if complaints or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
