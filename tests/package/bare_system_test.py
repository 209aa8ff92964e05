#!/usr/bin/env python3
"""Both first commands of the README in a bare system made by debootstrap: `./dev demo`, which installs
what it needs and reproduces Table I, without a warning of the compiler; then `./dev test`.

usage: bare_system_test.py SOURCE_FOLDER SUITE [demo]

With demo, `./dev test` is left out. It takes root, a network, and up to an hour on two cores: exit status
77, skipped, where a bare system cannot be made.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from package_test import make_bare_system, output_of

# A mount that is undone with its process, so that nothing of this machine is below the folder.
IN_ROOT = 'mount -t proc proc "$0/proc" && exec chroot "$0" sh -ec "$1"'


def run_in(root, command):
    done = subprocess.run(["unshare", "--mount", "sh", "-ec", IN_ROOT, root, command],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"{command} ended with {done.returncode}\n{done.stdout[-10000:]}")
    return done.stdout


def copy_sources(source, target):
    """What git has of the checkout, with changes that are not committed; all but builds without git."""
    target.mkdir()
    names = output_of("git", "-c", "safe.directory=*", "ls-files", "-z", "--cached", "--others",
                      "--exclude-standard", cwd=source).split("\0")
    there = "\0".join(name for name in names if name and (source / name).exists())
    archive = subprocess.run(["tar", "c", "--null", "-T", "-"], cwd=source, input=there.encode(),
                             stdout=subprocess.PIPE, check=True)
    subprocess.run(["tar", "x"], cwd=target, input=archive.stdout, check=True)


def main():
    source, suite = Path(sys.argv[1]).resolve(), sys.argv[2]
    with tempfile.TemporaryDirectory() as folder:
        root = make_bare_system(suite, Path(folder))
        copy_sources(source, root / "tomlin")
        demo = run_in(root, "cd /tomlin && ./dev demo")
        assert "warning:" not in demo, [line for line in demo.splitlines() if "warning:" in line]
        if sys.argv[3:] != ["demo"]:
            # The oracles are required, and a compiler's warning is an error.
            print(run_in(root, "cd /tomlin && TOMLIN_ORACLES=required TOMLIN_STRICT=1 ./dev test")[-3000:])


if __name__ == "__main__":
    main()
