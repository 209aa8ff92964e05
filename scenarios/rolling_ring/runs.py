"""Running the scenes of this folder from a script."""

import argparse
import csv
import json
import pathlib
import subprocess

HERE = pathlib.Path(__file__).resolve().parent


class RunFailed(Exception):
    """A run that did not end well; says why."""


class Tomlin:
    """The program, with a folder for its results."""

    def __init__(self, program, folder):
        self.program = program.resolve()
        self.folder = folder

    def run(self, scene, settings):
        """Runs a scene of this folder with {path: value} set; returns summary.json."""
        command = [str(self.program), "run", str(HERE / scene), "--force", "-o", str(self.folder)]
        for path, value in settings.items():
            command += ["--set", f"{path}={value}"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RunFailed(f"{' '.join(command)}\nends with status {done.returncode}:\n"
                            f"{done.stderr.strip() or done.stdout.strip()}")
        return json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))

    def trace(self):
        """The samples of the last run: {column: list of numbers}."""
        with open(self.folder / "observables.csv", newline="", encoding="utf-8") as file:
            names, *rows = csv.reader(file)
        columns = zip(*(map(float, row) for row in rows))
        return {name.split()[0]: list(column) for name, column in zip(names, columns)}


def say(text=""):
    print(text, flush=True)


def program_argument(parser):
    """The argument PROGRAM, a file that is there."""

    def program(text):
        path = pathlib.Path(text)
        if not path.is_file():
            raise argparse.ArgumentTypeError(
                f"{text} is not a program; ./dev build makes build/bin/tomlin")
        return path

    parser.add_argument("program", metavar="PROGRAM", type=program, help="build/bin/tomlin")
