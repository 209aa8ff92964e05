#!/usr/bin/env python3
"""The pull of scenarios/nanotube, one core, in turn with LAMMPS: microseconds of processor time a step.

    python3 benchmarks/lammps_pull.py [TOMLIN] [CELLS ROWS] [ROUNDS]

TOMLIN is build/bin/tomlin, CELLS and ROWS are those of the scene (8 and 16; the paper's are 23 and
200), ROUNDS is 5. The scene is the pull without its thermostat, whose equilibration LAMMPS would
have to repeat; LAMMPS gets what `tomlin export` writes. Start-up cancels: each time is the
difference of a long and a short run. Needs LAMMPS (`lmp`)."""

import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

SCENE = Path(__file__).resolve().parent.parent / "scenarios/nanotube/pull.toml"
STEPS = {"LAMMPS": 1000, "pairs": 5000, "field": 8000}


def pull(field: bool) -> str:
    """The scene from the moment of the pull on; with the sheet as a field of position."""
    blocks = SCENE.read_text(encoding="utf-8").split("\n\n")
    blocks = [block for block in blocks if "nose_hoover_chain" not in block
              and not block.startswith(("[measure]", "[output]"))]
    lines = [line for line in "\n\n".join(blocks).splitlines() if not line.startswith("active")]
    text = "\n".join(lines).replace('"equilibration + 4 * a / v"', "1.0")
    if field:
        text = text.replace('type = "lennard_jones"', 'type = "sheet_field"\ntolerance = 1e-4')
    return text + "\n"


def processor_time(command: list[str], folder: Path) -> float:
    """Seconds of a command in a folder."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    tomlin = str(Path(sys.argv[1] if len(sys.argv) > 1 else "build/bin/tomlin").resolve())
    size = sys.argv[2:4] or ["8", "16"]
    rounds = int(sys.argv[4]) if len(sys.argv) > 4 else 5
    sets = ["--set", f"cells={size[0]}", "--set", f"rows={size[1]}"]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for kind in ("pairs", "field"):
            (folder / f"{kind}.toml").write_text(pull(kind == "field"), encoding="utf-8")
        processor_time([tomlin, "export", "pairs.toml", *sets, "--to", "lammps", "-o", "lammps"],
                       folder)

        def run(kind: str, steps: int) -> float:
            if kind == "LAMMPS":
                return processor_time(["lmp", "-in", "in.lmp", "-var", "steps", str(steps)],
                                      folder / "lammps")
            return processor_time([tomlin, "run", f"{kind}.toml", *sets, "--force", "--quiet",
                                   "--set", f"run.duration={steps * 1e-3}", "-o", "out"], folder)

        found: dict[str, list[float]] = {kind: [] for kind in STEPS}
        for _ in range(rounds):
            for kind, steps in STEPS.items():
                short = steps // 10
                seconds = run(kind, steps) - run(kind, short)
                found[kind].append(seconds / (steps - short) * 1e6)
    lammps = statistics.median(found["LAMMPS"])
    for kind, times in found.items():
        median = statistics.median(times)
        print(f"{kind:7} {median:8.1f} us a step, {min(times):.1f} to {max(times):.1f}; "
              f"LAMMPS takes {lammps / median:.1f} times as long")


if __name__ == "__main__":
    main()
