#!/usr/bin/env python3
"""A configuration goes on where mpirun is installed without its headers.

usage: mpi_test.py SOURCE_FOLDER CMAKE
"""
import os
import pathlib
import subprocess
import sys
import tempfile

PROJECT = """cmake_minimum_required(VERSION 3.25)
project(planted LANGUAGES CXX)
list(APPEND CMAKE_MODULE_PATH {source}/cmake)
{find}
message(STATUS "found: ${{MPI_CXX_FOUND}}")
"""
# A wrapper as Open MPI's, whose folder of headers does not exist.
WRAPPER = """#!/bin/sh
case "$1" in
  -showme:compile | --showme:compile | -showme:incdirs) echo -I/nowhere/openmpi/include ;;
  -showme:link | --showme:link) echo -lm ;;
  -showme:* | --showme:*) echo ;;
  *) exec c++ -I/nowhere/openmpi/include "$@" ;;
esac
"""


def configure(folder, cmake, source, find):
    (folder / "CMakeLists.txt").write_text(PROJECT.format(source=source, find=find))
    bin_folder = folder / "bin"
    bin_folder.mkdir()
    wrapper = bin_folder / "mpicxx"
    wrapper.write_text(WRAPPER)
    wrapper.chmod(0o755)
    environment = {**os.environ, "PATH": f"{bin_folder}:{os.environ['PATH']}"}
    return subprocess.run([cmake, "-S", folder, "-B", folder / "build",
                           f"-DMPI_CXX_COMPILER={wrapper}"], env=environment, capture_output=True,
                          text=True)


def main():
    source, cmake = sys.argv[1:]
    outcomes = {}
    for name, find in (("ours", "include(TomlinMpi)"), ("planted", "find_package(MPI COMPONENTS CXX)")):
        with tempfile.TemporaryDirectory() as folder:
            outcomes[name] = configure(pathlib.Path(folder), cmake, source, find)
    ours, planted = outcomes["ours"], outcomes["planted"]
    if ours.returncode != 0 or "found: FALSE" not in ours.stdout:
        sys.exit(f"MPI without headers is not left out:\n{ours.stdout}{ours.stderr}")
    if planted.returncode == 0:
        sys.exit(f"FindMPI alone is expected to fail here, and did not:\n{planted.stdout}")


if __name__ == "__main__":
    main()
