#!/usr/bin/env python3
"""Relative links of all pages lead to files that exist, and to headings that exist; README and guide are short.

    python3 tests/documentation/links_test.py SOURCE_DIR

Exit status: 0 all is well, 1 a link is broken or a page too long, 2 bad arguments.
"""

import pathlib
import re
import sys
import tempfile

from pages import pages_of

# Pages that are read from the beginning to the end, and how many lines they may have.
MOST_LINES = {"README.md": 200, "framework/USER_GUIDE.md": 100, "framework/guide/*.md": 350}

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


def too_long(source):
    """Pages with more lines than they may have, and patterns that match no page."""
    complaints = []
    for pattern, most in MOST_LINES.items():
        pages = sorted(source.glob(pattern))
        if not pages:
            complaints.append(f"there is no {pattern}")
        for page in pages:
            lines = len(page.read_text(encoding="utf-8").splitlines())
            if lines > most:
                complaints.append(f"{page.relative_to(source)} has {lines} lines, more than {most}")
    return complaints


def sees_long_pages():
    """Planted pages, one of which has a line too many."""
    with tempfile.TemporaryDirectory(prefix="tomlin-lines-") as name:
        source = pathlib.Path(name)
        (source / "framework/guide").mkdir(parents=True)
        for pattern, most in MOST_LINES.items():
            (source / pattern.replace("*", "longest")).write_text("x\n" * most, encoding="utf-8")
        if too_long(source):
            return False
        most = MOST_LINES["framework/guide/*.md"]
        (source / "framework/guide/longer.md").write_text("x\n" * (most + 1), encoding="utf-8")
        return len(too_long(source)) == 1


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
    if not sees_faults() or not sees_long_pages():
        print("the test itself is broken: a planted fault was not noticed")
        return 1
    source = pathlib.Path(sys.argv[1]).resolve()
    count, complaints = broken(source)
    complaints += too_long(source)
    print(f"{len(pages_of(source))} pages, {count} links, {len(complaints)} complaints")
    if complaints:
        print("\n".join(complaints))
    return 1 if complaints or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
