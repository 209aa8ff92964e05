#!/usr/bin/env python3
"""The version of the build, the newest release of the changelog and the citation are the same.

    python3 tests/documentation/version_test.py SOURCE_DIR

Exit status: 0 they are, 1 they are not, 2 bad arguments.
"""

import pathlib
import re
import sys

BUILD = re.compile(r"^project\(tomlin VERSION (\S+)", flags=re.MULTILINE)
RELEASE = re.compile(r"^## \[(\d[^\]]*)\] - (\d{4}-\d\d-\d\d)$", flags=re.MULTILINE)
CITED = re.compile(r"^version: (\S+)\ndate-released: (\S+)$", flags=re.MULTILINE)


def disagreement(build, changelog, citation):
    """What does not agree in these texts; empty where all do."""
    version, release, cited = BUILD.search(build), RELEASE.search(changelog), CITED.search(citation)
    if not (version and release and cited):
        return "a file names no version"
    if not version[1] == release[1] == cited[1] or release[2] != cited[2]:
        return f"{version[1]}, {release.groups()} and {cited.groups()} differ"
    return ""


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    source = pathlib.Path(sys.argv[1])
    texts = [(source / name).read_text(encoding="utf-8")
             for name in ("CMakeLists.txt", "CHANGELOG.md", "CITATION.cff")]
    if not disagreement(texts[0], texts[1], texts[2].replace("version: ", "version: 9")):
        sys.exit("a planted difference is not seen")
    complaint = disagreement(*texts)
    if complaint:
        sys.exit(f"CMakeLists.txt, CHANGELOG.md, CITATION.cff: {complaint}")


if __name__ == "__main__":
    main()
