#!/usr/bin/env python3
"""Runs the scene and holds its result against the closed form.

    python3 test_plugin_name.py PROGRAM SCENE

Exit status: 0 they agree, 1 they do not.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

TOLERANCE = 1e-9  # the integrator keeps 1e-12 a step, over some hundred steps


def main():
    program, scene = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "out"
        subprocess.run([program, "run", scene, "-o", str(folder), "--quiet"], check=True)
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    speed = summary["parameters"]["v"]
    bodies = summary["bodies"]
    # Momentum and energy are kept, and beyond the cutoff there is no force.
    errors = [abs(bodies["first"]["velocity"][0]), abs(bodies["second"]["velocity"][0] - speed)]
    print(f"velocities are off by {errors[0]:.1e} and {errors[1]:.1e}")
    return 0 if max(errors) < TOLERANCE else 1


if __name__ == "__main__":
    sys.exit(main())
