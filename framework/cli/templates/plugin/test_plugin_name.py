#!/usr/bin/env python3
"""Runs the scene and holds its result against the closed form.

    python3 test_plugin_name.py PROGRAM SCENE

Exit status: 0 they agree, 1 they do not.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

TOLERANCE = 1e-9  # the integrator keeps 1e-12 a step, over some dozens of steps


def main():
    program, scene = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "out"
        subprocess.run([program, "run", scene, "-o", str(folder), "--quiet"], check=True)
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    numbers = summary["parameters"]
    body = summary["bodies"]["point"]
    # x = A cos(w t), v = -A w sin(w t) with w = sqrt(k/m), at w t = pi/2.
    speed = numbers["A"] * math.sqrt(numbers["k"] / numbers["m"])
    errors = [abs(body["centre_of_mass"][0]), abs(body["velocity"][0] + speed) / speed]
    print(f"position and velocity are off by {errors[0]:.1e} and {errors[1]:.1e}")
    return 0 if max(errors) < TOLERANCE else 1


if __name__ == "__main__":
    sys.exit(main())
