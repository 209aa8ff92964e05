#!/usr/bin/env python3
"""Lists what a run of ctest left out, and why: tests that ended as skipped, and parts of tests that their
own frameworks skipped, which ctest counts as passed.

usage: skipped_tests.py JUNIT [--required]

JUNIT is what `ctest --output-junit` writes. With --required the exit status is 1 where something was
skipped for another reason than the machine's own, such as an oracle that is not installed.
"""
import re
import sys
from xml.etree import ElementTree

# By scripts; by pytest; by GoogleTest, with the reason in the line that follows.
REASON = re.compile(r"^(?:skipped[^:\n]*: (.*)|SKIPPED \[\d+\] \S+ (.*)|\S+:\d+: Skipped\n(.*))$",
                    re.MULTILINE)
# No package cures these, or none that is worth its size: openkim-models takes 245 MB, and
# python3-distributed brings some forty others.
ALLOWED = ("this processor lacks the instructions", "only one instruction set",
           "builds with assertions only", "mounting a file system is not allowed",
           "the superuser may read everything", "root may write everywhere",
           "no locale with a decimal comma", "the sanitizers need memory", "there is no /proc",
           "there is no /dev/full", "it is in openkim-models", "there is no mypy",
           "there is no distributed")


def skips(suite):
    """Pairs of a test of ctest and a reason."""
    found = []
    for case in suite.iter("testcase"):
        output = case.findtext("system-out") or ""
        reasons = ["".join(one).strip() for one in REASON.findall(output)]
        if case.find("skipped") is not None and not reasons:
            reasons = ["no reason is given"]
        found += [(case.get("name"), reason) for reason in reasons]
    return found


def avoidable(found):
    return [one for one in found if not any(allowed in one[1] for allowed in ALLOWED)]


PLANTED = """<testsuite>
<testcase name="oracle_tests"><system-out>/tests/lammps_test.cpp:33: Skipped
there is no program lmp (Debian's package lammps)
[  SKIPPED ] Lammps.Energies (0 ms)</system-out></testcase>
<testcase name="geometry_oracle"><skipped message="SKIP_RETURN_CODE=77"/>
<system-out>skipped: No module named 'ase' (Debian: python3-ase)</system-out></testcase>
<testcase name="silent"><skipped message="SKIP_RETURN_CODE=77"/><system-out/></testcase>
<testcase name="python_result"><system-out>.s.
SKIPPED [1] tests/python/result_test.py:120: could not import 'pandas'</system-out></testcase>
<testcase name="scene_tests"><system-out>/tests/hostile_input_test.cpp:276: Skipped
the superuser may read everything</system-out></testcase>
<testcase name="model_tests"><system-out>all is well</system-out></testcase>
</testsuite>"""


def main():
    arguments = sys.argv[1:]
    required = "--required" in arguments
    files = [one for one in arguments if one != "--required"]
    if len(files) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    planted = skips(ElementTree.fromstring(PLANTED))
    if len(planted) != 5 or len(avoidable(planted)) != 4:
        print("planted skips were not seen:", planted)
        return 1
    found = skips(ElementTree.parse(files[0]).getroot())
    wrong = avoidable(found)
    for test, reason in sorted(set(found)):
        times = found.count((test, reason))
        mark = "error: " if required and (test, reason) in wrong else ""
        print(f"{mark}skipped in {test}{f' ({times} times)' if times > 1 else ''}: {reason}")
    print(f"{len(found)} skipped, {len(wrong)} of them for want of something that can be installed")
    return 1 if required and wrong else 0


if __name__ == "__main__":
    sys.exit(main())
