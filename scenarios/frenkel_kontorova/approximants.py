"""Approximants of the golden mean: N particles on L periods, successive Fibonacci numbers."""

import argparse
import json
import pathlib
import subprocess

HERE = pathlib.Path(__file__).resolve().parent


def periods_of(particles):
    """The Fibonacci number before `particles`; raises ValueError if that is none."""
    before, number = 1, 2
    while number < particles:
        before, number = number, before + number
    if number != particles:
        raise ValueError
    return before


def add_arguments(parser, particles):
    """The arguments PROGRAM and --particles, with their default."""

    def program(text):
        path = pathlib.Path(text)
        if not path.is_file():
            raise argparse.ArgumentTypeError(
                f"{text} is not a program; ./dev build makes build/bin/tomlin")
        return path.resolve()

    def fibonacci_number(text):
        try:
            periods_of(int(text))
        except ValueError:
            raise argparse.ArgumentTypeError(f"{text} is no Fibonacci number from 2 on") from None
        return int(text)

    parser.add_argument("program", metavar="PROGRAM", type=program, help="build/bin/tomlin")
    parser.add_argument("--particles", type=fibonacci_number, nargs="+", default=particles,
                        help=f"Fibonacci numbers ({' '.join(map(str, particles))})")


def run(program, folder, scene, particles, settings):
    """Runs a scene of this folder; returns summary.json, or raises RuntimeError."""
    command = [str(program), "run", str(HERE / scene), "--force", "-o", str(folder)]
    for path, value in {"N": particles, "L": periods_of(particles), **settings}.items():
        command += ["--set", f"{path}={value}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}\nends with status {done.returncode}:\n"
                           f"{done.stderr}")
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))
